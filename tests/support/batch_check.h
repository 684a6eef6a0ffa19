// SPDX-License-Identifier: MIT
// A batch's answers beside those of single calls.
#ifndef TESTS_SUPPORT_BATCH_CHECK_H
#define TESTS_SUPPORT_BATCH_CHECK_H

#include <sagitta/scene.h>

typedef struct batch_counts {
    size_t met, flipped, missed; // flipped: of those met
} batch_counts;

// Asserts that the closest hits of a batch have the bits of single calls, and counts them.
void batch_check(const sag_scene *scene, const sag_ray *rays, size_t count, batch_counts *counts);

#endif
