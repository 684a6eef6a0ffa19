// SPDX-License-Identifier: MIT
// Where a ray runs inside a quadric: the common solver of every surface of second degree.
#ifndef SAGI_SHAPES_QUADRIC_SOLVE_H
#define SAGI_SHAPES_QUADRIC_SOLVE_H

#include "math/dd.h"
#include "math/real.h"
#include "shapes/common.h"

// The coefficients of
//     F(y) = Σ squareᵢ yᵢ² + 2 (cross₀ y₁y₂ + cross₁ y₂y₀ + cross₂ y₀y₁) + 2 Σ linearᵢ yᵢ + constant,
// to about 400 bits.
typedef struct sagi_quadric_exact {
    sagi_real square[3], cross[3], linear[3], constant;
} sagi_quadric_exact;

// The same in double-double (relative error of each at most 32·2⁻¹⁰⁶), with where its coordinates come from:
// y = (x − center) / 2^exponent. The exponent keeps the products of very large and very small shapes in range
// (sagi_size_exponent).
typedef struct sagi_quadric_form {
    sagi_dd square[3], cross[3], linear[3], constant;
    sag_vec3 center;
    int exponent;
    bool mixed; // some of cross, linear[0], linear[1] is not zero; else they are not looked at
    // Writes the exact coefficients, for the few rays that need them. `shape` is handed to it.
    void (*exact)(const void *shape, sagi_quadric_exact *coefficients);
    const void *shape;
} sagi_quadric_form;

// The values of t with F(origin + t·direction) ≤ 0: up to two intervals in order. An end is −∞, +∞ or a root
// of F. Roots that lie in the ray's [t_min, t_max] are within 2 ulp of the exact root; others may be coarse,
// but are on the right side of the range. An interval that has no part in the range may be left out. A
// tangent from outside is an interval of one point, from inside two that touch. count 0: outside everywhere.
typedef struct sagi_spans {
    int count;
    double enter[2], leave[2];
} sagi_spans;

// The ray must be valid (sag_ray_is_valid).
sagi_spans sagi_quadric_spans(const sagi_quadric_form *form, const sag_ray *ray);

// The sign of F at a point (finite): exact up to the 400 bits of the coefficients.
int sagi_quadric_sign(const sagi_quadric_form *form, sag_vec3 point);

// position, position_error and geometric_normal (the gradient's direction) of the point of the surface
// nearest to a point that is on it but for rounding: that of the ray at t, or `point`.
void sagi_quadric_place_hit(const sagi_quadric_form *form, const sag_ray *ray, double t,
                            sag_surface *surface);
void sagi_quadric_place_point(const sagi_quadric_form *form, sag_vec3 point, sag_surface *surface);

// 0 for a size within 2^±40, else its binary exponent.
int sagi_size_exponent(double size);

// The point origin + t·direction − center in double-double, exact to 3·2⁻¹⁰⁶.
static inline sagi_dd sagi_ray_coordinate(double origin, double center, double t, double direction) {
    return sagi_dd_add(sagi_two_sum(origin, -center), sagi_two_prod_any(t, direction));
}

#endif
