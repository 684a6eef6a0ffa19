// SPDX-License-Identifier: MIT
// One sphere of a set, for the scene's leaves: get it, then ask sphere.h.
#ifndef SAGI_SHAPES_SPHERES_H
#define SAGI_SHAPES_SPHERES_H

#include "math/simd.h"
#include "shapes/sphere.h"

// A whole sphere as the lanes of a vector: centre and radius.
SAGI_INLINE sagi_d4 sagi_sphere_load(const sag_sphere *s) {
    return sagi_d4_of(s->center.x, s->center.y, s->center.z, s->radius);
}

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

// Centre and radius, whatever they are.
typedef struct sagi_ball {
    double center[3], radius;
} sagi_ball;

static inline sagi_ball sagi_spheres_ball(const sag_spheres *s, uint32_t i) {
    size_t at = (size_t)i * 3;
    double radius = s->radii_f32 ? (double)s->radii_f32[i] : s->radius;
    if (s->centers_f64)
        return (sagi_ball){{s->centers_f64[at], s->centers_f64[at + 1], s->centers_f64[at + 2]}, radius};
    return (sagi_ball){
        {(double)s->centers_f32[at], (double)s->centers_f32[at + 1], (double)s->centers_f32[at + 2]}, radius};
}

static inline sagi_ball sagi_sphere_ball(const sag_sphere *s) {
    return (sagi_ball){{s->center.x, s->center.y, s->center.z}, s->radius};
}

// The same as the lanes of a vector, of a sphere that is known to be there.
SAGI_INLINE sagi_d4 sagi_spheres_load(const sag_spheres *s, uint32_t i) {
    size_t at = (size_t)i * 3;
    if (s->radii_f32 && s->centers_f32)
        return sagi_f4_to_d4(
            (sagi_f4){s->centers_f32[at], s->centers_f32[at + 1], s->centers_f32[at + 2], s->radii_f32[i]});
    double radius = s->radii_f32 ? (double)s->radii_f32[i] : s->radius;
    if (s->centers_f64)
        return sagi_d4_of(s->centers_f64[at], s->centers_f64[at + 1], s->centers_f64[at + 2], radius);
    return sagi_d4_of((double)s->centers_f32[at], (double)s->centers_f32[at + 1],
                      (double)s->centers_f32[at + 2], radius);
}

#endif
