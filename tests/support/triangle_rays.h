// SPDX-License-Identifier: MIT
// Triangles, and rays of every awkward kind that are aimed somewhere near them.
#ifndef TESTS_SUPPORT_TRIANGLE_RAYS_H
#define TESTS_SUPPORT_TRIANGLE_RAYS_H

#include "support/random.h"
#include <stddef.h>

typedef struct triangle_ray {
    sag_vec3 a, b, c;
    sag_ray ray;
} triangle_ray;

#define TRIANGLE_RAY_KINDS 7
typedef struct triangle_ray_kind {
    const char *name;
    void (*make)(rng *r, double scale, triangle_ray *s); // sets all but t_min, t_max and the mask
    size_t count;                                        // how many make a fair sample
} triangle_ray_kind;
extern const triangle_ray_kind triangle_ray_kinds[TRIANGLE_RAY_KINDS];

#endif
