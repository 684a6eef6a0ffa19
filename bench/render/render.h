// SPDX-License-Identifier: MIT
// bench-render: what its files share. Scenes rendered whole (main.c), beside pbrt-v4 (pbrt.c) or the time it
// once took for the same, and beside the image it made (agree.c).
#ifndef BENCH_RENDER_RENDER_H
#define BENCH_RENDER_RENDER_H

#include <sagitta/render.h>

// A scene to render, and what is known of pbrt-v4's rendering of it.
typedef struct subject_scene {
    const char *name; // of the folder in scenes/ and of the image in scenes/reference/
    uint32_t width, height;
    double pbrt_seconds; // for 1024 samples a pixel on two cores
} subject_scene;

// A scene made ready for pbrt-v4.
typedef struct pbrt_scene {
    char folder[32];
} pbrt_scene;

bool pbrt_prepare(pbrt_scene *p, const subject_scene *scene);
// Seconds of rendering alone; threads 0: one a core.
bool pbrt_run(const pbrt_scene *p, const char *program, unsigned spp, unsigned threads, double *seconds,
              size_t *peak_bytes);
void pbrt_forget(pbrt_scene *p);

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
