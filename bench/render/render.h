// SPDX-License-Identifier: MIT
// bench-render: what its files share. Scenes rendered whole (main.c), beside the time pbrt-v4 took for the
// same and beside the image it made (agree.c).
#ifndef BENCH_RENDER_RENDER_H
#define BENCH_RENDER_RENDER_H

#include <sagitta/render.h>

// A scene to render, and what is known of pbrt-v4's rendering of it.
typedef struct subject_scene {
    const char *name; // of the folder in scenes/ and of the image in scenes/reference/
    uint32_t width, height;
    double pbrt_seconds; // for 1024 samples a pixel on two cores; 0: not known
} subject_scene;

// How far two pictures of the same size are apart.
typedef struct agreement {
    double luminance;   // mean of ours over mean of theirs
    double channels[3]; // the same for R, G and B
    double blocks;      // mean |difference| of 8 × 8 block means over the mean of theirs
    double error;       // root of the mean square of what pixels differ by, over the mean of theirs
} agreement;

// Pictures of three channels or more. False when the sizes differ.
bool agree(const sag_image *ours, const sag_image *theirs, agreement *a);

#endif
