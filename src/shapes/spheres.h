// SPDX-License-Identifier: MIT
// One sphere of a set at a time.
#ifndef SAGI_SHAPES_SPHERES_H
#define SAGI_SHAPES_SPHERES_H

#include <sagitta/shapes.h>

static inline void sagi_spheres_get(const sag_spheres *set, uint32_t i, sag_vec3 *center, double *radius) {
    size_t at = 3 * (size_t)i;
    if (set->centers_f64)
        *center = sag_vec3_make(set->centers_f64[at], set->centers_f64[at + 1], set->centers_f64[at + 2]);
    else
        *center = sag_vec3_make(set->centers_f32[at], set->centers_f32[at + 1], set->centers_f32[at + 2]);
    *radius = set->radii_f32 ? set->radii_f32[i] : set->radius;
}

#endif
