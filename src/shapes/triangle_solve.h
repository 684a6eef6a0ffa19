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
// The first step is written once, in triangle_step.inl, and stands in this header for the kernels: with an
// instruction for fused multiply-add an error-free product takes two operations in place of 17, and its bits
// are the same. It comes for one ray and triangle, and for four at once. The others are in triangle_solve.c.
#ifndef SAGI_SHAPES_TRIANGLE_SOLVE_H
#define SAGI_SHAPES_TRIANGLE_SOLVE_H

#include "math/dd.h"
#include "math/simd.h"
#include "shapes/common.h"
#include "shapes/triangle.h"
#include <stddef.h>

static inline double sagi_larger(double a, double b) { return a > b ? a : b; }

#define REAL                   double
#define MASK                   int
#define STEP(name)             sagi_solve1_##name
#define ABS                    fabs
#define MAX                    sagi_larger
#define PRODUCT_ERROR(a, b, p) sagi_two_prod(a, b).lo
#include "shapes/triangle_step.inl"

#define REAL                   sagi_d4
#define MASK                   sagi_l4
#define STEP(name)             sagi_solve4_##name
#define ABS                    sagi_d4_abs
#define MAX                    sagi_d4_max
#define PRODUCT_ERROR(a, b, p) sagi_d4_product_error(a, b, p)
#include "shapes/triangle_step.inl"

// Step 2: n · P in double-doubles.
double sagi_triangle_residual(const sag_vec3 *o, const sag_vec3 *d, const sag_vec3 *a, const sag_vec3 *b,
                              const sag_vec3 *c, double t);
// sagi_triangle_solve for a ray that is not prepared, and with another t_max.
bool sagi_triangle_solve_ray(const sag_ray *ray, double t_max, const sag_vec3 *a, const sag_vec3 *b,
                             const sag_vec3 *c, double *t, double *u, double *v);

// The weights as they are handed out: u, v ≥ 0, u + v ≤ 1.
static inline void sagi_triangle_confine(double beta, double gamma, double *u, double *v) {
    *u = beta > 0 ? (beta < 1 ? beta : 1) : 0;
    double room = 1 - *u;
    *v = gamma > 0 ? (gamma < room ? gamma : room) : 0;
}

typedef enum sagi_solved { SAGI_SOLVED_MISS, SAGI_SOLVED_HIT, SAGI_SOLVED_NOT } sagi_solved;

// Steps 1 and 2: *t, *beta and *gamma for SAGI_SOLVED_HIT, which does not say that t is in range.
SAGI_INLINE sagi_solved sagi_triangle_step(const sag_vec3 *o, const sag_vec3 *d, double d1, double t_min,
                                           double t_max, const sag_vec3 *a, const sag_vec3 *b,
                                           const sag_vec3 *c, double *t, double *beta, double *gamma) {
    sagi_solve1_pair of = {.o = {o->x, o->y, o->z},
                           .d = {d->x, d->y, d->z},
                           .a = {a->x, a->y, a->z},
                           .b = {b->x, b->y, b->z},
                           .c = {c->x, c->y, c->z},
                           .d1 = d1,
                           .t_min = t_min,
                           .t_max = t_max};
    sagi_solve1_step s;
    sagi_solve1_estimate(&of, &s);
    if (!s.usual) return SAGI_SOLVED_NOT;
    if (s.outside) return SAGI_SOLVED_MISS;
    sagi_solve1_improve(&of, &s);
    if (!s.near) {
        s.step = sagi_triangle_residual(o, d, a, b, c, s.estimate) * s.inverse;
        s.step_error = 0x1p-100 * s.p_sum * s.scale;
    }
    sagi_solve1_conclude(&of, &s);
    if (!s.good) return SAGI_SOLVED_NOT;
    *t = s.t, *beta = s.u, *gamma = s.v;
    return SAGI_SOLVED_HIT;
}

// sagi_triangle_solve_ray, for kernels.
SAGI_INLINE bool sagi_triangle_solve_here(const sag_ray *ray, double t_max, const sag_vec3 *a,
                                          const sag_vec3 *b, const sag_vec3 *c, double *t, double *u,
                                          double *v) {
    double x = fabs(ray->direction.x), y = fabs(ray->direction.y), z = fabs(ray->direction.z);
    double largest = sagi_larger(sagi_larger(x, y), z), value, beta, gamma;
    if (!(largest >= SAGI_TRIANGLE_SHORT && largest <= SAGI_TRIANGLE_LONG))
        return sagi_triangle_solve_ray(ray, t_max, a, b, c, t, u, v);
    switch (sagi_triangle_step(&ray->origin, &ray->direction, x + y + z, ray->t_min, t_max, a, b, c, &value,
                               &beta, &gamma)) {
    case SAGI_SOLVED_MISS: return false;
    case SAGI_SOLVED_NOT: return sagi_triangle_solve_ray(ray, t_max, a, b, c, t, u, v);
    case SAGI_SOLVED_HIT: break;
    }
    if (!(value >= ray->t_min && value <= t_max)) return false;
    *t = value;
    sagi_triangle_confine(beta, gamma, u, v);
    return true;
}

// Four rays, each with a triangle that its line pierces.
typedef struct sagi_triangle_four {
    const sag_ray *ray[4];
    sagi_d4 t_max;        // in place of the rays' own
    sagi_d4 corner[3][4]; // a, b, c of each: x, y, z and anything
    sagi_d4 t, u, v;      // what is found
} sagi_triangle_four;

SAGI_INLINE sag_vec3 sagi_vec3_of(sagi_d4 a) { return sag_vec3_make(a[0], a[1], a[2]); }

// Rows to columns; the fourth of these to *rest.
SAGI_INLINE sagi_solve4_vec3 sagi_d4_columns(const sagi_d4 row[4], sagi_d4 *rest) {
    sagi_d4 xz01 = SAGI_D4_SHUFFLE2(row[0], row[1], 0, 4, 2, 6),
            yw01 = SAGI_D4_SHUFFLE2(row[0], row[1], 1, 5, 3, 7);
    sagi_d4 xz23 = SAGI_D4_SHUFFLE2(row[2], row[3], 0, 4, 2, 6),
            yw23 = SAGI_D4_SHUFFLE2(row[2], row[3], 1, 5, 3, 7);
    *rest = SAGI_D4_SHUFFLE2(yw01, yw23, 2, 3, 6, 7);
    return (sagi_solve4_vec3){SAGI_D4_SHUFFLE2(xz01, xz23, 0, 1, 4, 5),
                              SAGI_D4_SHUFFLE2(yw01, yw23, 0, 1, 4, 5),
                              SAGI_D4_SHUFFLE2(xz01, xz23, 2, 3, 6, 7)};
}

// sagi_triangle_solve_ray for those in `lanes`, bit 0 being the first; returns those whose t is in range. t,
// u and v of others are left with anything.
static inline uint32_t sagi_triangle_solve4(sagi_triangle_four *four, uint32_t lanes) {
    if (lanes == 0) return 0;
    const int any = __builtin_ctz(lanes);
    sagi_d4 row[2][4], unused;
    for (int i = 0; i < 4; i++) { // a ray begins with origin, direction, t_min, t_max
        const char *ray = (const char *)four->ray[lanes >> i & 1 ? i : any];
        row[0][i] = sagi_d4_load(ray), row[1][i] = sagi_d4_load(ray + sizeof(sagi_d4));
    }
    sagi_solve4_pair of = {.t_max = four->t_max};
    of.o = sagi_d4_columns(row[0], &of.d.x);
    sagi_solve4_vec3 rest = sagi_d4_columns(row[1], &unused);
    of.d.y = rest.x, of.d.z = rest.y, of.t_min = rest.z;
    of.a = sagi_d4_columns(four->corner[0], &unused);
    of.b = sagi_d4_columns(four->corner[1], &unused);
    of.c = sagi_d4_columns(four->corner[2], &unused);
    sagi_solve4_vec3 size = sagi_solve4_abs(of.d);
    sagi_d4 largest = sagi_d4_max(sagi_d4_max(size.x, size.y), size.z);
    of.d1 = sagi_solve4_sum(size);

    sagi_solve4_step s;
    sagi_solve4_estimate(&of, &s);
    s.usual &= (largest >= SAGI_TRIANGLE_SHORT) & (largest <= SAGI_TRIANGLE_LONG);
    uint32_t usual = lanes & sagi_d4_signs((sagi_d4)s.usual),
             outside = usual & sagi_d4_signs((sagi_d4)s.outside);
    sagi_solve4_improve(&of, &s);
    for (uint32_t far = usual & ~(outside | sagi_d4_signs((sagi_d4)s.near)); far != 0; far &= far - 1) {
        const int i = __builtin_ctz(far);
        sag_vec3 a = sagi_vec3_of(four->corner[0][i]), b = sagi_vec3_of(four->corner[1][i]),
                 c = sagi_vec3_of(four->corner[2][i]);
        const sag_ray *ray = four->ray[i];
        s.step[i] =
            sagi_triangle_residual(&ray->origin, &ray->direction, &a, &b, &c, s.estimate[i]) * s.inverse[i];
        s.step_error[i] = 0x1p-100 * s.p_sum[i] * s.scale[i];
    }
    sagi_solve4_conclude(&of, &s);
    const sagi_d4 zero = sagi_d4_fill(0), one = sagi_d4_fill(1);
    four->t = s.t;
    four->u = sagi_d4_min(sagi_d4_max(s.u, zero), one);
    four->v = sagi_d4_min(sagi_d4_max(s.v, zero), one - four->u);
    uint32_t good = usual & sagi_d4_signs((sagi_d4)s.good);
    uint32_t hit = good & ~outside & sagi_d4_signs((sagi_d4)((s.t >= of.t_min) & (s.t <= of.t_max)));
    for (uint32_t left = lanes & ~(good | outside); left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        sag_vec3 a = sagi_vec3_of(four->corner[0][i]), b = sagi_vec3_of(four->corner[1][i]),
                 c = sagi_vec3_of(four->corner[2][i]);
        double t, u, v;
        if (!sagi_triangle_solve_ray(four->ray[i], four->t_max[i], &a, &b, &c, &t, &u, &v)) continue;
        four->t[i] = t, four->u[i] = u, four->v[i] = v;
        hit |= 1U << i;
    }
    return hit;
}

#endif
