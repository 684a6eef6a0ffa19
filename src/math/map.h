// SPDX-License-Identifier: MIT
// Maps of points, directions and rays, and normalisation, for the loops that are little more than these:
// sag_affine_point and its like (affine.c, ray.c, vector.c) are the same calculations as functions.
#ifndef SAGI_MATH_MAP_H
#define SAGI_MATH_MAP_H

#include <sagitta/math.h>

static inline sag_vec3 sagi_affine_vector(const sag_affine *a, sag_vec3 v) {
    return sag_vec3_make(a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                         a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                         a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z);
}

static inline sag_vec3 sagi_affine_point(const sag_affine *a, sag_vec3 p) {
    return sag_vec3_make(a->m[0][0] * p.x + a->m[0][1] * p.y + a->m[0][2] * p.z + a->m[0][3],
                         a->m[1][0] * p.x + a->m[1][1] * p.y + a->m[1][2] * p.z + a->m[1][3],
                         a->m[2][0] * p.x + a->m[2][1] * p.y + a->m[2][2] * p.z + a->m[2][3]);
}

static inline sag_ray sagi_ray_transform(const sag_affine *a, const sag_ray *ray) {
    return (sag_ray){
        .origin = sagi_affine_point(a, ray->origin),
        .direction = sagi_affine_vector(a, ray->direction),
        .t_min = ray->t_min,
        .t_max = ray->t_max,
        .mask = ray->mask,
    };
}

static inline bool sagi_ray_is_valid(const sag_ray *ray) {
    sag_vec3 o = ray->origin, d = ray->direction;
    // x − x is 0 for finite x, else NaN.
    double zero = ((o.x - o.x) + (o.y - o.y) + (o.z - o.z)) + ((d.x - d.x) + (d.y - d.y) + (d.z - d.z));
    double length = fabs(d.x) + fabs(d.y) + fabs(d.z);
    return zero == 0 && length > 0 && ray->t_min <= ray->t_max;
}

// Between these bounds the sum of squares neither overflows nor loses bits that matter to underflow: a square
// that is flushed is below 2⁻¹⁰²² and the sum is at least 2⁻⁹⁰⁰, so it is smaller than a rounding.
static inline bool sagi_square_is_safe(double squared) { return squared > 0x1p-900 && squared < 0x1p1000; }

static inline void sagi_frame(sag_vec3 n, sag_vec3 *s, sag_vec3 *t) {
    const double sign = copysign(1, n.z);
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    *s = sag_vec3_make(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *t = sag_vec3_make(b, sign + n.y * n.y * a, -n.y);
}

static inline sag_vec3 sagi_normalize(sag_vec3 a) {
    const double squared = sag_dot(a, a), length = sqrt(squared);
    if (!sagi_square_is_safe(squared)) return sag_normalize(a);
    return sag_vec3_make(a.x / length, a.y / length, a.z / length);
}

#endif
