// SPDX-License-Identifier: MIT
// The exact ray/triangle test, shared by triangle, mesh and the scene's kernels; what it does and why is said
// in triangle_test.c (the decision) and triangle_solve.h (t, u and v).
//
// A caller that tests many triangles prepares the ray once:
//
//     sagi_triangle_ray prepared = sagi_triangle_prepare(&ray);
//     if (sagi_triangle_hit(&prepared, &a, &b, &c, one_sided, &t, &u, &v)) …
//
// A kernel that knows for certain, from a filter of its own, that the line pierces the triangle's interior
// may leave out the decision and call sagi_triangle_solve; the answer is the same.
#ifndef SAGI_SHAPES_TRIANGLE_H
#define SAGI_SHAPES_TRIANGLE_H

#include "math/simd.h"
#include <sagitta/shapes.h>

SAGI_INLINE sag_vec3 sagi_d4_vec3(sagi_d4 a) { return sag_vec3_make(a[0], a[1], a[2]); }

typedef struct sagi_triangle_ray {
    sag_vec3 o;
    sag_vec3 d;          // the direction times 2^-exponent
    double d1;           // |d.x| + |d.y| + |d.z|
    double t_min, t_max; // the ray's own, in unscaled directions
    int exponent;        // 0 unless the direction is very short or very long
} sagi_triangle_ray;

// Directions whose largest coordinate is within these are taken as they are.
#define SAGI_TRIANGLE_SHORT 0x1p-64
#define SAGI_TRIANGLE_LONG  0x1p64

// The ray must be valid (sag_ray_is_valid).
static inline sagi_triangle_ray sagi_triangle_prepare(const sag_ray *ray) {
    sagi_triangle_ray r = {.o = ray->origin, .d = ray->direction, .t_min = ray->t_min, .t_max = ray->t_max};
    double x = fabs(r.d.x), y = fabs(r.d.y), z = fabs(r.d.z), largest = x > y ? x : y;
    largest = z > largest ? z : largest;
    if (!(largest >= SAGI_TRIANGLE_SHORT && largest <= SAGI_TRIANGLE_LONG)) {
        r.exponent = ilogb(largest);
        r.d = sag_vec3_make(ldexp(r.d.x, -r.exponent), ldexp(r.d.y, -r.exponent), ldexp(r.d.z, -r.exponent));
    }
    r.d1 = fabs(r.d.x) + fabs(r.d.y) + fabs(r.d.z);
    return r;
}

// Which way the ray's line pierces the triangle a b c: −1 against the normal (b − a) × (c − a), that is from
// the front; +1 along it; 0: not at all. Exact, ties included; t_min and t_max are not looked at. A triangle
// with a NaN, infinite or too large vertex, or without area: 0.
int sagi_triangle_side(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c);

// For a line that pierces the triangle (side not 0): whether t, as rounded, lies in [t_min, t_max],
// and then t (error below 4 ulp) and the weights u of b and v of c (absolute error below 2⁻⁴²; ≥ 0, u + v ≤
// 1). The bits of t, u, v depend on neither t_min nor t_max.
bool sagi_triangle_solve(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                         const sag_vec3 *c, double *t, double *u, double *v);

static inline bool sagi_triangle_hit(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                                     const sag_vec3 *c, bool one_sided, double *t, double *u, double *v) {
    int side = sagi_triangle_side(ray, a, b, c);
    if (side == 0 || (one_sided && side > 0)) return false;
    return sagi_triangle_solve(ray, a, b, c, t, u, v);
}

// Whether a b c is a triangle that can be hit: finite, within SAG_MAX_COORDINATE and (decided exactly) of an
// area above 0.
bool sagi_triangle_is_finite(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c);
bool sagi_triangle_has_area(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c);

// n = ab × ac in doubles has an error below 8ε E², E being the largest coordinate of an edge: good to 2⁻³⁰
// and more when n, whose largest coordinate is asked for, is not much smaller than E². Needles and tiny
// triangles, whose products may underflow, are done in expansions.
static inline bool sagi_cross_is_good(double largest, double edge) {
    return largest > 0x1p-20 * edge * edge && largest > 0x1p-400;
}
// Twice the area, and the unit normal when it is above 0; accurate for needles too.
double sagi_triangle_normal(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c, sag_vec3 *unit);
// Fills position, position_error, geometric_normal, dpdu, dpdv, u and v for the weights u, v: what mesh and
// triangle begin a surface with, before sagi_surface_finish.
void sagi_triangle_point(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c, double u, double v,
                         sag_surface *surface);
// Uniform weights from two numbers in [0, 1).
void sagi_triangle_sample_weights(sag_vec2 random, double *u, double *v);
// The point of the triangle nearest to `point`.
sag_vec3 sagi_triangle_closest_point(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c, sag_vec3 point);

#endif
