// SPDX-License-Identifier: MIT
/// @file film.h
/// The film: how large the picture is, how samples become pixels, what sensor takes the light and which
/// layers are kept beside the picture.
#ifndef SAGITTA_RENDER_FILM_H
#define SAGITTA_RENDER_FILM_H

#include <sagitta/image.h>

#ifdef __cplusplus
extern "C" {
#endif

/// How samples around a pixel count towards it: pbrt's curves (src/render/filter.c has them). Samples are
/// drawn as the curve is high, and count alike, those where it is negative negatively. Test:
/// tests/render/test_filter.c.
typedef enum sag_filter_kind {
    SAG_FILTER_BOX,      ///< default radius 0.5
    SAG_FILTER_TRIANGLE, ///< 2
    SAG_FILTER_GAUSSIAN, ///< 1.5
    SAG_FILTER_MITCHELL, ///< 2
    SAG_FILTER_SINC,     ///< sinc in Lanczos’ window; 4
} sag_filter_kind;

/// What can be kept beside the picture, from the same samples; bits of sag_film.layers. What the camera's ray
/// meets first counts, after surfaces that are not there.
typedef enum sag_layer {
    SAG_LAYER_ALBEDO = 1 << 0,   ///< Albedo.R/G/B: reflectance; 1 for glass, 0 where nothing is
    SAG_LAYER_NORMAL = 1 << 1,   ///< N.X/Y/Z and Ns.X/Y/Z: geometric and shading normal, units, on the
                                 ///< camera's side
    SAG_LAYER_DEPTH = 1 << 2,    ///< Z: along the viewing direction (cameras that see all around: distance)
    SAG_LAYER_POSITION = 1 << 3, ///< P.X/Y/Z
    SAG_LAYER_UV = 1 << 4,       ///< u, v
    SAG_LAYER_ID = 1 << 5, ///< id.geometry, id.instance, id.material, counted from 1 (0: none), those of
                           ///< most of the pixel's samples
    SAG_LAYER_VARIANCE = 1 << 6, ///< Variance.R/G/B: of the samples; divided by their number, of the pixel
    SAG_LAYER_PICTURE = 1 << 7,  ///< R, G, B: always there
    SAG_LAYER_ALL = 0xFF,
} sag_layer;

typedef struct sag_film {
    uint32_t width, height;
    sag_filter_kind filter;
    double filter_radius_x, filter_radius_y; ///< in pixels; 0: pbrt's default for the kind
    double filter_sigma;                     ///< Gaussian; 0 counts as 0.5
    sag_color_space color_space;             ///< of the picture
    char sensor[64]; ///< "" or "cie1931": the eye's; or one of pbrt-v4's cameras, such as "canon_eos_5d_mkiv"
    double iso;      ///< 0 counts as 100
    double exposure_seconds;     ///< 0 counts as 1. The picture is scaled by this · iso/100
    double white_balance_kelvin; ///< daylight that becomes white; 0: none for the eye, 6500 for cameras
    double filter_b, filter_c;   ///< Mitchell; both 0 count as 1/3
    double filter_tau;           ///< sinc; 0 counts as 3
    /// What part of the picture is made: x_min x_max y_min y_max as shares of width and height, each edge
    /// rounded up to a pixel; all 0: all of it. Each pixel has the bits that it has in the whole picture.
    double crop_window[4];
    /// The same in pixels, first and past the last, for what the crop window leaves open; beyond the film
    /// counts as its edge.
    uint32_t pixel_bounds[4];
    double max_component; ///< a brighter sample is dimmed until its largest component is this; 0: never.
                          ///< Distances (SAG_INTEGRATOR_DEPTH) are not
    uint32_t layers;      ///< bits of sag_layer
    bool layers_in_camera_space; ///< positions and normals; else in the scene's space
    char file[512];              ///< the name the scene asks for; may be empty
} sag_film;

/// Whether sag_film.sensor may have this name.
SAG_API bool sag_sensor_is_known(const char *name);

#ifdef __cplusplus
}
#endif
#endif
