// SPDX-License-Identifier: MIT
// Where a line that pierces a triangle does so: t and the barycentric weights u (of b) and v (of c).
//
// With n = (b − a) × (c − a), D = d · n and e the edge functions of triangle_test.c,
//
//     t = (a − o) · n / D,    u = e(c, a) / D,    v = e(a, b) / D.
//
// With S(x) the sum of the absolute values of all products in x · n, the numerator of t has in doubles an
// error of 8u S(a − o) and D one of 7u S(d) (so many roundings lie on a path): enough to see that t is
// certainly out of range, as it is for most rays that leave this very triangle, but not for 4 ulp. So:
//
// 1. One Newton step. P = a − o − t₀ d, the way from the first estimate back to a, is at most as long as the
//    triangle, and with error-free transforms its components come out within 2u |P| + 2u² (|a − o| + |t₀ d|).
//    t = t₀ + n·P / D exactly, for any t₀. In doubles n·P has an error of 9u S(P) + 2u² (S(a − o) + |t₀|
//    S(d)), which is a small part of u |t D| unless the triangle is large beside the distance. The weights
//    follow from the same P, corrected: Q = n·P/D · d − P = u (b − a) + v (c − a), so u = (Q × (c − a)) · n /
//    n², v = ((b − a) × Q) · n / n².
// 2. The same step with n·P in double-doubles from exact differences: products and sums there are good to 7 ·
//    2⁻¹⁰⁶ and 3 · 2⁻¹⁰⁶, so n·P to 2⁻¹⁰⁰ S(P), and only D is still a double. Where that is not enough
//    either, all of it in double-doubles, good to 46 · 2⁻¹⁰⁶ (2⁻¹⁰⁰ is used) of E² |a − o|₁ and so on, E
//    being the longer edge in the maximum norm.
// 3. Expansions: exact numerators and denominators, two roundings. For an origin almost in the plane, rays
//    almost parallel to it, needles, and magnitudes beyond the other two's limits.
//
// Each step checks its own bound and hands over to the next when t could be off by more than 3u |t| with its
// last rounding (4 ulp are at least 4u |t|), or u and v by more than 2⁻⁴². So the result is within 4 ulp
// always, and its bits depend on the ray's line and the triangle only.
//
// The first step stands here, for the kernels: with an instruction for fused multiply-add an error-free
// product takes two operations in place of 17, and its bits are the same. The others are in triangle_solve.c.
#ifndef SAGI_SHAPES_TRIANGLE_SOLVE_H
#define SAGI_SHAPES_TRIANGLE_SOLVE_H

#include "math/dd.h"
#include "math/simd.h"
#include "shapes/common.h"
#include "shapes/triangle.h"

static inline double sagi_norm1(sag_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }
static inline double sagi_larger(double a, double b) { return a > b ? a : b; }
static inline double sagi_norm_max(sag_vec3 a) {
    return sagi_larger(sagi_larger(fabs(a.x), fabs(a.y)), fabs(a.z));
}

// Writes the answer when t, back in the caller's directions, is in range and a number: very short directions
// may put it beyond the doubles.
static inline bool sagi_triangle_accept(const sagi_triangle_ray *ray, double t_scaled, double beta,
                                        double gamma, double *t, double *u, double *v) {
    double value = ray->exponent ? ldexp(t_scaled, -ray->exponent) : t_scaled;
    if (!(value >= ray->t_min && value <= ray->t_max) || isinf(value)) return false;
    *t = value;
    *u = beta > 0 ? (beta < 1 ? beta : 1) : 0;
    double room = 1 - *u;
    *v = gamma > 0 ? (gamma < room ? gamma : room) : 0;
    return true;
}

// Steps 2 and 3. `far` is |a − o|₁, `size` the longer edge in the maximum norm.
double sagi_triangle_residual(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                              const sag_vec3 *c, double t);
bool sagi_triangle_solve_dd(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                            const sag_vec3 *c, double far, double size, double *t, double *u, double *v);
bool sagi_triangle_solve_exact(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                               const sag_vec3 *c, double *t, double *u, double *v);

// Vectors of three in four places; the fourth holds 0.
static inline sagi_d4 sagi_d4_from(sag_vec3 a) { return (sagi_d4){a.x, a.y, a.z, 0}; }
static inline sagi_d4 sagi_d4_turn(sagi_d4 a) { return SAGI_D4_SHUFFLE(a, 1, 2, 0, 3); } // y z x
static inline sagi_d4 sagi_d4_cross(sagi_d4 a, sagi_d4 b) {
    return sagi_d4_turn(a * sagi_d4_turn(b) - sagi_d4_turn(a) * b);
}
static inline double sagi_d4_sum(sagi_d4 a) { return (a[0] + a[1]) + a[2]; }
static inline double sagi_d4_largest(sagi_d4 a) { return sagi_larger(a[0], sagi_larger(a[1], a[2])); }

// sagi_triangle_solve, wherever it is asked for: step 1.
static inline bool sagi_triangle_solve_here(const sagi_triangle_ray *ray, const sag_vec3 *a,
                                            const sag_vec3 *b, const sag_vec3 *c, double *t, double *u,
                                            double *v) {
    const double eps = SAGI_EPSILON;
    sagi_d4 o = sagi_d4_from(ray->o), d = sagi_d4_from(ray->d), at_a = sagi_d4_from(*a);
    sagi_d4 ao = at_a - o, ab = sagi_d4_from(*b) - at_a, ac = sagi_d4_from(*c) - at_a;
    sagi_d4 plus = ab * sagi_d4_turn(ac), minus = sagi_d4_turn(ab) * ac, n = sagi_d4_turn(plus - minus);
    double far =
        sagi_d4_sum(sagi_d4_abs(ao)) + 0x1p-300; // with the limits below, the bounds cover all underflow
    double size = sagi_d4_largest(sagi_d4_max(sagi_d4_abs(ab), sagi_d4_abs(ac)));
    if (!(far <= 0x1p400 && size >= 0x1p-200 && size <= 0x1p200))
        return sagi_triangle_solve_exact(ray, a, b, c, t, u, v);

    // Σ|x_i| s_i is the sum of the absolute values of all products in x · n; the last term is for underflow.
    double square = size * size;
    sagi_d4 s = sagi_d4_turn(sagi_d4_abs(plus) + sagi_d4_abs(minus)) + sagi_d4_fill(0x1p-100 * square);
    double numerator = sagi_d4_sum(ao * n), denominator = sagi_d4_sum(d * n);
    double ao_sum = sagi_d4_sum(sagi_d4_abs(ao) * s) + 0x1p-300 * square;
    double d_sum = sagi_d4_sum(sagi_d4_abs(d) * s), denominator_error = 7.1 * eps * d_sum;
    if (!(denominator_error <= 0x1p-10 * fabs(denominator)))
        return sagi_triangle_solve_dd(ray, a, b, c, far, size, t, u, v);

    // The margin of 8u |t| makes sure that what is turned away here would be when rounded, too.
    double inverse = 1 / denominator, estimate = numerator * inverse;
    double scale = 1.01 * fabs(inverse);
    double estimate_error = (8.1 * eps * ao_sum + fabs(estimate) * denominator_error) * scale;
    double margin = estimate_error + 8 * eps * fabs(estimate);
    if (ray->exponent == 0 && (estimate + margin < ray->t_min || estimate - margin > ray->t_max))
        return false;

    // P: a − o and t₀ d as sums of two numbers each (dd.h).
    sagi_d4 way = sagi_d4_fill(estimate) * d,
            way_error = sagi_d4_product_error(sagi_d4_fill(estimate), d, way);
    sagi_d4 back = ao - at_a, ao_error = (at_a - (ao - back)) + (-o - back);
    sagi_d4 p = (ao - way) + (ao_error - way_error);
    double step = sagi_d4_sum(n * p) * inverse, p_sum = sagi_d4_sum(sagi_d4_abs(p) * s);
    double cancelled = 2.1 * eps * eps * (ao_sum + fabs(estimate) * d_sum);
    double step_error = (9.1 * eps * p_sum + cancelled) * scale,
           division = denominator_error * scale + 5 * eps;
    if (!(step_error + fabs(step) * division <= 1.9 * eps * fabs(estimate + step))) {
        step = sagi_triangle_residual(ray, a, b, c, estimate) * inverse;
        step_error = 0x1p-100 * p_sum * scale;
    }
    step_error += fabs(step) * division;
    double result = estimate + step;

    sagi_d4 q = d * sagi_d4_fill(step) - p;
    double q_error = 6 * eps * sagi_d4_sum(sagi_d4_abs(p)) +
                     2 * eps * eps * (far + fabs(estimate) * ray->d1) +
                     (step_error + 6 * eps * fabs(step)) * ray->d1;
    // Of u and v: 28u |Q| E + 14u E² for the roundings, 3.5 E times Q's error, over |n|; |Q| ≤ E.
    double weight_error = 42 * eps * square + 3.5 * q_error * size, n_square = sagi_d4_sum(n * n);
    if (!(step_error <= 1.9 * eps * fabs(result) && weight_error * weight_error <= 0x1p-84 * n_square))
        return sagi_triangle_solve_dd(ray, a, b, c, far, size, t, u, v);
    double inverse_square = 1 / n_square;
    return sagi_triangle_accept(ray, result, sagi_d4_sum(sagi_d4_cross(q, ac) * n) * inverse_square,
                                sagi_d4_sum(sagi_d4_cross(ab, q) * n) * inverse_square, t, u, v);
}

#endif
