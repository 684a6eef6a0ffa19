// SPDX-License-Identifier: MIT
// One sphere of a set, for the scene's leaves: get it, then ask sphere.h.
#ifndef SAGI_SHAPES_SPHERES_H
#define SAGI_SHAPES_SPHERES_H

#include "shapes/sphere.h"

// Sphere number i < count; false when it is not finite or has no positive radius, and so is not there.
static inline bool sagi_spheres_get(const sag_spheres *s, uint32_t i, sag_vec3 *center, double *radius) {
    size_t at = (size_t)i * 3;
    if (s->centers_f64)
        *center = sag_vec3_make(s->centers_f64[at], s->centers_f64[at + 1], s->centers_f64[at + 2]);
    else
        *center = sag_vec3_make(s->centers_f32[at], s->centers_f32[at + 1], s->centers_f32[at + 2]);
    *radius = s->radii_f32 ? s->radii_f32[i] : s->radius;
    return fabs(center->x) <= SAG_MAX_COORDINATE && fabs(center->y) <= SAG_MAX_COORDINATE &&
           fabs(center->z) <= SAG_MAX_COORDINATE && *radius > 0 && *radius <= SAG_MAX_COORDINATE;
}

#endif
