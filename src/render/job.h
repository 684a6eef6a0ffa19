// SPDX-License-Identifier: MIT
// A render under way: everything prepared, and the sums of the pixels.
#ifndef SAGI_RENDER_JOB_H
#define SAGI_RENDER_JOB_H

#include "camera.h"
#include "film.h"
#include "light.h"
#include "sampler.h"

#include <stdatomic.h>

#define SAGI_TILE_SIZE 16u

struct sag_render {
    sag_world *world;
    sag_context *context;
    const sag_scene *scene;
    sag_settings settings;
    sagi_camera camera;
    sagi_filter filter;
    sagi_sampler sampler; // as it stands before the first pixel
    sagi_lights lights;
    bool see_through; // some geometry has alpha or an interface material: rays may have to go on

    uint32_t width, height, tiles_x, tiles_y;
    sagi_pixel *pixels;  // width·height
    uint32_t *tile_done; // samples taken of each pixel of a tile
    atomic_uint_fast64_t rays, camera_samples, bad_samples;
    double build_seconds, trace_seconds;

    // Of the pass that is running.
    uint32_t pass_end; // samples per pixel when it is over
    double run_start;  // clock seconds
    sag_progress_callback progress;
    void *progress_user;
    atomic_flag reporting; // the lock of the callback and of next_report
    double next_report;
    atomic_bool cancelled;
};

// What follows one path: its random numbers, and how many rays it took.
typedef struct sagi_tracer {
    const sag_render *render;
    sagi_sampler sampler;
    uint64_t rays;
} sagi_tracer;

// The nearest surface that is really there (see sag_appearance.alpha and SAG_MATERIAL_INTERFACE), its normals
// turned to the front; *distance is in ray directions from the ray's origin. bsdf may be NULL.
bool sagi_trace(sagi_tracer *tracer, sag_ray ray, sag_hit *hit, sag_surface *surface,
                const sagi_appearance **appearance, sagi_bsdf *bsdf, double *distance);
// Whether light of this sample reaches the surface.
bool sagi_visible(sagi_tracer *tracer, const sag_surface *from, const sagi_light_sample *sample);

// The integrators: radiance (or what they show) along a camera ray.
sag_rgb sagi_path_radiance(sagi_tracer *tracer, sag_ray ray);
sag_rgb sagi_shown_value(sagi_tracer *tracer, sag_ray ray);

#endif
