// SPDX-License-Identifier: MIT
// A render under way: everything prepared, and the sums of the pixels.
#ifndef SAGI_RENDER_JOB_H
#define SAGI_RENDER_JOB_H

#include "camera.h"
#include "filter.h"
#include "sensor.h"
#include "wave.h"

#include <stdatomic.h>

#define SAGI_TILE_SIZE 16u

// Every second bit, from the lowest: pixels in Morton's order, so that any sixteen one after the other are
// neighbours, whose rays run together.
static inline uint32_t sagi_along(uint32_t i) {
    i &= 0x55;
    i = (i | i >> 1) & 0x33;
    return (i | i >> 2) & 0x0F;
}
_Static_assert(SAGI_TILE_SIZE == 16, "sagi_along takes four bits");

struct sag_render {
    sagi_sensor sensor; // its vectors are the most aligned: first, so that there are no gaps
    sag_world *world;
    sag_context *context;
    const sag_scene *scene;
    sag_settings settings;
    sagi_camera camera;
    sagi_footprint footprint;
    sagi_filter filter;
    sagi_sampler_plan sampler_plan;
    sagi_sampler sampler; // as it stands before the first pixel
    sagi_lights lights;
    sagi_wavelength_table wavelengths;

    uint32_t width, height, tiles_x, tiles_y; // of what is made of the film
    uint32_t first_x, first_y;                // its first pixel on the film
    uint32_t wave_count;                      // of threads
    uint32_t wave_size;                       // paths to a wave: SAGI_WAVE_SIZE, but for tests
    sagi_wave *waves;                         // one for each thread that takes part
    double max_component;                     // of a sample
    sagi_pixel *pixels;                       // width·height
    sagi_splat *splats;                       // as many, of light followed from the lamps; else NULL
    sagi_layer_pixel *layers;                 // as many, or NULL when the film asks for none
    uint32_t *tile_done;                      // samples taken of each pixel of a tile
    atomic_uint_fast64_t rays, camera_samples, bad_samples, thread_ns, traversal_ns, texture_ns;
    atomic_uint_fast64_t first_bad[SAG_BAD_SAMPLES]; // row, column and number, sorted; all ones: none
    double build_seconds, trace_seconds;

    // Of the pass that is running.
    double run_start;        // clock seconds
    atomic_size_t next_tile; // the first one no thread took yet
    sag_progress_callback progress;
    void *progress_user;
    double next_report;
    uint32_t pass_end;     // samples per pixel when it is over
    atomic_flag reporting; // the lock of the callback and of next_report
    atomic_bool cancelled;

    bool has_media;   // and they are to be seen
    bool see_through; // some geometry has alpha or an interface material: rays may have to go on
};

// What of the film is to be made: the first column and row, and the size. SAG_ERROR_ARGUMENT when nothing is
// left of it.
typedef struct sagi_bounds {
    uint32_t x, y, width, height;
} sagi_bounds;
sag_status sagi_film_bounds(const sag_film *film, sagi_bounds *bounds, sag_error *error);
// Adds a sample to its pixel; one that is not finite is noted instead.
void sagi_film_add(sag_render *render, sagi_pixel *pixel, uint32_t sample, double weight, sag_rgb value);
void sagi_film_note_bad(sag_render *render, const sagi_pixel *pixel, uint32_t sample);
// Adds what a path from a lamp brings to a place of the film; and what all so far make of a pixel.
void sagi_splat_add(sag_render *render, const sagi_path *path, sag_vec2 place, sagi_spectrum light);
sag_rgb sagi_splat_value(const sag_render *render, size_t pixel);
// What all samples so far make of a pixel.
sag_rgb sagi_film_value(const sag_render *render, const sagi_pixel *pixel);
// The first few samples that were not finite, as sag_render_stats has them.
uint32_t sagi_film_first_bad(const sag_render *render, sag_bad_sample bad[SAG_BAD_SAMPLES]);

// Notes the first surface of a path, whose ray met it; adds that and the sample's value to its pixel.
void sagi_layers_note(const sag_render *render, const sagi_path *path, const sag_ray *ray,
                      const sagi_meeting *meeting, sagi_first *first);
void sagi_layers_add(sag_render *render, const sagi_pixel *at, const sagi_first *first, double weight,
                     sag_rgb value);

// Whether samples are light by wavelength, which the sensor makes numbers of.
static inline bool sagi_is_spectral(const sag_render *render) {
    return render->settings.integrator == SAG_INTEGRATOR_PATH ||
           render->settings.integrator == SAG_INTEGRATOR_DIRECT ||
           render->settings.integrator == SAG_INTEGRATOR_VOLPATH ||
           render->settings.integrator == SAG_INTEGRATOR_LIGHTPATH;
}

#endif
