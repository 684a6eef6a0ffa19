// SPDX-License-Identifier: MIT
// Rays that are hard on a shape: through its special points (vertices, edges, ends), along axes, within
// faces, from inside, on and behind, from up to 1e9 sizes away, with directions of any length, ±0 and
// denormals.
#ifndef TESTS_SUPPORT_ADVERSARIAL_H
#define TESTS_SUPPORT_ADVERSARIAL_H

#include "random.h"

typedef struct adversary {
    sag_vec3 center;
    double size;
    const sag_vec3 *points; // special ones
    uint32_t point_count;
} adversary;

sag_ray adversarial_ray(rng *r, const adversary *a);

#endif
