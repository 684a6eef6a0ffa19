// SPDX-License-Identifier: MIT
// A render under way: everything prepared, and the sums of the pixels.
#ifndef SAGI_RENDER_JOB_H
#define SAGI_RENDER_JOB_H

#include "camera.h"
<<<<<<< HEAD
#include "sensor.h"
=======
#include "filter.h"
>>>>>>> a3b08b4 (render: filters by importance with weights; equal-area camera)
#include "wave.h"

#include <stdatomic.h>

#define SAGI_TILE_SIZE 16u

struct sag_render {
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
    sagi_sensor sensor;
    sagi_wavelength_table wavelengths;
    bool see_through; // some geometry has alpha or an interface material: rays may have to go on

    uint32_t width, height, tiles_x, tiles_y;
    sagi_pixel *pixels;  // width·height
    uint32_t *tile_done; // samples taken of each pixel of a tile
    atomic_uint_fast64_t rays, camera_samples, bad_samples;
    double build_seconds, trace_seconds;
    sagi_wave *waves;    // one for each thread that takes part
    uint32_t wave_count; // of threads
    uint32_t wave_size;  // paths to a wave: SAGI_WAVE_SIZE, but for tests

    // Of the pass that is running.
    uint32_t pass_end;       // samples per pixel when it is over
    double run_start;        // clock seconds
    atomic_size_t next_tile; // the first one no thread took yet
    sag_progress_callback progress;
    void *progress_user;
    atomic_flag reporting; // the lock of the callback and of next_report
    double next_report;
    atomic_bool cancelled;
};

// Whether samples are light by wavelength, which the sensor makes numbers of.
static inline bool sagi_is_spectral(const sag_render *render) {
    return render->settings.integrator == SAG_INTEGRATOR_PATH ||
           render->settings.integrator == SAG_INTEGRATOR_DIRECT;
}

#endif
