// SPDX-License-Identifier: MIT
/// @file render.h
/// From a scene to a picture (libsagitta-render). A world (world.h) is a scene with materials, textures,
/// lights, a camera and a film; a render, here, makes its picture. This one header brings all of them:
///
///     render/spectrum.h   colours, and numbers by wavelength
///     render/texture.h    colours and numbers that vary over a surface
///     render/material.h   what surfaces do to light
///     render/light.h      where light comes from, and media
///     render/camera.h     where the picture is seen from
///     render/film.h       size, filter, sensor and layers of the picture
///     render/settings.h   these two, the sampler and the integrator
///     render/world.h      all of it together; loading a file
///
/// A world is built by one thread at a time; once rendering it must not change. Light is followed by
/// wavelength; plain colours are linear RGB with Rec. 709 primaries and the white of D65, and stand for
/// smooth spectra that look so (Jakob & Hanika 2019): reflectances, indices and other amounts, or light of
/// which (1, 1, 1) is D65 at luminance 1.
#ifndef SAGITTA_RENDER_H
#define SAGITTA_RENDER_H

#include <sagitta/render/world.h>

#ifdef __cplusplus
extern "C" {
#endif

/// How far a render is; samples counts camera samples over all pixels.
typedef struct sag_progress {
    uint64_t samples_done, samples_total;
    double seconds; ///< spent in sag_render_run so far
} sag_progress;

/// Called now and then, one call at a time, from any of the context's threads. Return false to stop the
/// render.
typedef bool (*sag_progress_callback)(void *user, const sag_progress *progress);

/// A sample of a pixel of the (whole) film: `sagitta render --crop 1x1+X+Y` takes it again.
typedef struct sag_bad_sample {
    uint32_t x, y, sample;
} sag_bad_sample;

/// How many of the bad samples are told.
#define SAG_BAD_SAMPLES 8

typedef struct sag_render_stats {
    uint32_t width, height;  ///< of the picture: what is made of the film
    uint64_t rays;           ///< traced, shadow rays included
    uint64_t camera_samples; ///< taken
    uint64_t bad_samples;    ///< NaN or infinite: counted and dropped, the pixel is the mean of the others
    uint32_t bad_told;       ///< how many are in bad[]
    sag_bad_sample bad[SAG_BAD_SAMPLES]; ///< the first ones, by row, column and sample
    double build_seconds, trace_seconds;
    double thread_seconds;    ///< of tracing, all threads together
    double traversal_seconds; ///< of those, in finding what rays hit
    double texture_seconds;   ///< of those, in looking up textures: told by one surface of 64
} sag_render_stats;

typedef struct sag_render sag_render;

/// Prepares a picture of the world as it is now: commits its scene, sorts its lights. NULL with *error on
/// failure. The world must outlive the render and not change meanwhile.
SAG_API sag_render *sag_render_create(sag_world *world, sag_error *error);
/// Frees the render, not its world. NULL does nothing. It must not be running.
SAG_API void sag_render_destroy(sag_render *render);
/// Takes the samples that are not taken yet, on all the context's threads. SAG_ERROR_CANCELLED when the
/// callback stopped it; what is done stays, and a further call goes on from there. The same bits however many
/// threads there are.
SAG_API sag_status sag_render_run(sag_render *render, sag_progress_callback progress, void *user,
                                  sag_error *error);
/// The picture from the samples taken so far: linear RGB of the film's colour space; black where there are
/// none yet. Makes *image (sag_image_clear it). Between runs.
SAG_API sag_status sag_render_get_image(const sag_render *render, sag_image *image, sag_error *error);
/// Room for all layers' channels.
#define SAG_MAX_CHANNELS 32

/// The picture and its layers, pixel by pixel from the top left, each pixel's channels one after the other.
typedef struct sag_layers {
    uint32_t width, height;           ///< of what was made of the film
    uint32_t x, y;                    ///< its first column and row there
    uint32_t full_width, full_height; ///< of the film
    uint32_t channel_count;
    const char *names[SAG_MAX_CHANNELS]; ///< constant strings, such as "Albedo.R"
    bool is_id[SAG_MAX_CHANNELS];        ///< the floats are the bits of a uint32_t
    sag_color_space color_space;         ///< of R G B
    float *pixels;                       ///< width · height · channel_count
} sag_layers;

/// The picture as sag_render_get_image has it and the layers that the film asks for, from the samples taken
/// so far; all means are weighted by the filter. Makes *layers (sag_layers_clear it). Between runs. Test:
/// tests/render/test_layers.c.
SAG_API sag_status sag_render_get_layers(const sag_render *render, sag_layers *layers, sag_error *error);
/// Frees the pixels and zeroes the rest. Zeroed ones are left alone.
SAG_API void sag_layers_clear(const sag_context *context, sag_layers *layers);
/// Writes an OpenEXR file of one part with these channels: 32-bit floats, ids 32-bit whole numbers, ZIP. The
/// data window is what was made, the display window the film. The file appears whole or not at all.
/// SAG_ERROR_ARGUMENT for another ending than .exr or a build without OpenEXR, SAG_ERROR_IO with the system's
/// reason.
SAG_API sag_status sag_layers_write(const sag_context *context, const sag_layers *layers, const char *path,
                                    sag_error *error);
/// Counts and times so far. Between runs or from the progress callback.
SAG_API void sag_render_get_stats(const sag_render *render, sag_render_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
