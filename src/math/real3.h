// SPDX-License-Identifier: MIT
// Vectors of 400-bit reals (real.h), for the last resort of shapes whose equations are made of vectors.
#ifndef SAGI_MATH_REAL3_H
#define SAGI_MATH_REAL3_H

#include "math/real.h"
#include <sagitta/math.h>

typedef struct sagi_real3 {
    sagi_real x, y, z;
} sagi_real3;

static inline sagi_real3 sagi_real3_from(sag_vec3 a) {
    return (sagi_real3){sagi_real_from(a.x), sagi_real_from(a.y), sagi_real_from(a.z)};
}
static inline sagi_real sagi_real_from_scaled_diff(double a, double b, int exponent) {
    sagi_real r = sagi_real_from_diff(a, b);
    for (int i = 0; i < r.count; i++) r.terms[i] = ldexp(r.terms[i], -exponent);
    return r;
}
// (a − b) / 2^exponent, exactly.
static inline sagi_real3 sagi_real3_from_diff(sag_vec3 a, sag_vec3 b, int exponent) {
    return (sagi_real3){sagi_real_from_scaled_diff(a.x, b.x, exponent),
                        sagi_real_from_scaled_diff(a.y, b.y, exponent),
                        sagi_real_from_scaled_diff(a.z, b.z, exponent)};
}
static inline sagi_real3 sagi_real3_add(const sagi_real3 *a, const sagi_real3 *b) {
    return (sagi_real3){sagi_real_add(a->x, b->x), sagi_real_add(a->y, b->y), sagi_real_add(a->z, b->z)};
}
static inline sagi_real3 sagi_real3_sub(const sagi_real3 *a, const sagi_real3 *b) {
    return (sagi_real3){sagi_real_sub(a->x, b->x), sagi_real_sub(a->y, b->y), sagi_real_sub(a->z, b->z)};
}
// a + s b
static inline sagi_real3 sagi_real3_madd(const sagi_real3 *a, sagi_real s, const sagi_real3 *b) {
    return (sagi_real3){sagi_real_add(a->x, sagi_real_mul(s, b->x)),
                        sagi_real_add(a->y, sagi_real_mul(s, b->y)),
                        sagi_real_add(a->z, sagi_real_mul(s, b->z))};
}
static inline sagi_real sagi_real_det(const sagi_real *a, const sagi_real *b, const sagi_real *c,
                                      const sagi_real *d) {
    return sagi_real_sub(sagi_real_mul(*a, *d), sagi_real_mul(*b, *c));
}
static inline sagi_real3 sagi_real3_cross(const sagi_real3 *a, const sagi_real3 *b) {
    return (sagi_real3){sagi_real_det(&a->y, &a->z, &b->y, &b->z), sagi_real_det(&a->z, &a->x, &b->z, &b->x),
                        sagi_real_det(&a->x, &a->y, &b->x, &b->y)};
}
static inline sagi_real sagi_real3_dot(const sagi_real3 *a, const sagi_real3 *b) {
    sagi_real xy = sagi_real_add(sagi_real_mul(a->x, b->x), sagi_real_mul(a->y, b->y));
    return sagi_real_add(xy, sagi_real_mul(a->z, b->z));
}

#endif
