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
// Each step checks its own bound (sagi_triangle_refine) and hands over to the next when t could be off by
// more than 3u |t| with its last rounding (4 ulp are at least 4u |t|), or u and v by more than 2⁻⁴². So the
// result is within 4 ulp always, and its bits depend on the ray's line and the triangle only.
//
// The first step is written once, in triangle_step.inl, and stands in this header for the kernels: with an
// instruction for fused multiply-add an error-free product takes two operations in place of 17, and its bits
// are the same. It comes for one ray and triangle, and for four at once. The second is beside it, for rays
// that end near where they begin; the others are in triangle_solve.c.
#ifndef SAGI_SHAPES_TRIANGLE_SOLVE_H
#define SAGI_SHAPES_TRIANGLE_SOLVE_H

#include "math/dd.h"
#include "math/simd.h"
#include "shapes/common.h"
#include "shapes/triangle.h"
#include <stddef.h>

static inline double sagi_larger(double a, double b) { return a > b ? a : b; }

#define REAL       double
#define MASK       bool
#define STEP(name) sagi_solve1_##name
#define ABS        fabs
typedef sagi_d4 sagi_solve1_vec3; // the fourth place holds anything
SAGI_INLINE sagi_d4 sagi_solve1_add(sagi_d4 a, sagi_d4 b) { return a + b; }
SAGI_INLINE sagi_d4 sagi_solve1_sub(sagi_d4 a, sagi_d4 b) { return a - b; }
SAGI_INLINE sagi_d4 sagi_solve1_mul(sagi_d4 a, sagi_d4 b) { return a * b; }
SAGI_INLINE sagi_d4 sagi_solve1_max(sagi_d4 a, sagi_d4 b) { return sagi_d4_max(a, b); }
SAGI_INLINE sagi_d4 sagi_solve1_abs(sagi_d4 a) { return sagi_d4_abs(a); }
SAGI_INLINE sagi_d4 sagi_solve1_turn(sagi_d4 a) { return SAGI_D4_SHUFFLE2(a, a, 1, 2, 0, 3); }
SAGI_INLINE sagi_d4 sagi_solve1_raise(sagi_d4 a, double by) { return a + sagi_d4_fill(by); }
SAGI_INLINE sagi_d4 sagi_solve1_scale(double s, sagi_d4 a) { return sagi_d4_fill(s) * a; }
SAGI_INLINE sagi_d4 sagi_solve1_product_error(double s, sagi_d4 a, sagi_d4 product) {
    return sagi_d4_product_error(sagi_d4_fill(s), a, product);
}
SAGI_INLINE double sagi_solve1_largest(sagi_d4 a) { return sagi_larger(a[0], sagi_larger(a[1], a[2])); }
SAGI_INLINE void sagi_solve1_sum2_turned(sagi_d4 a, sagi_d4 b, double sum[2]) {
    sagi_d4 yx = SAGI_D4_SHUFFLE2(a, b, 1, 5, 0, 4), z = SAGI_D4_SHUFFLE2(a, b, 2, 6, 3, 7), yz = yx + z;
    sagi_d4 all = yz + SAGI_D4_SHUFFLE2(yx, yx, 2, 3, 2, 3);
    sum[0] = all[0], sum[1] = all[1];
}
SAGI_INLINE void sagi_solve1_sum4(sagi_d4 a, sagi_d4 b, sagi_d4 c, sagi_d4 d, double sum[4]) {
    sagi_d4 xz1 = SAGI_D4_SHUFFLE2(a, b, 0, 4, 2, 6), xy1 = xz1 + SAGI_D4_SHUFFLE2(a, b, 1, 5, 3, 7);
    sagi_d4 xz2 = SAGI_D4_SHUFFLE2(c, d, 0, 4, 2, 6), xy2 = xz2 + SAGI_D4_SHUFFLE2(c, d, 1, 5, 3, 7);
    sagi_d4 all = SAGI_D4_SHUFFLE2(xy1, xy2, 0, 1, 4, 5) + SAGI_D4_SHUFFLE2(xz1, xz2, 2, 3, 6, 7);
    sum[0] = all[0], sum[1] = all[1], sum[2] = all[2], sum[3] = all[3];
}
#include "shapes/triangle_step.inl"

#define REAL       sagi_d4
#define MASK       sagi_l4
#define STEP(name) sagi_solve4_##name
#define ABS        sagi_d4_abs
typedef struct sagi_solve4_vec3 {
    sagi_d4 x, y, z;
} sagi_solve4_vec3;
typedef sagi_solve4_vec3 sagi_d4x3;
SAGI_INLINE sagi_d4x3 sagi_solve4_add(sagi_d4x3 a, sagi_d4x3 b) {
    return (sagi_d4x3){a.x + b.x, a.y + b.y, a.z + b.z};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_sub(sagi_d4x3 a, sagi_d4x3 b) {
    return (sagi_d4x3){a.x - b.x, a.y - b.y, a.z - b.z};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_mul(sagi_d4x3 a, sagi_d4x3 b) {
    return (sagi_d4x3){a.x * b.x, a.y * b.y, a.z * b.z};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_max(sagi_d4x3 a, sagi_d4x3 b) {
    return (sagi_d4x3){sagi_d4_max(a.x, b.x), sagi_d4_max(a.y, b.y), sagi_d4_max(a.z, b.z)};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_abs(sagi_d4x3 a) {
    return (sagi_d4x3){sagi_d4_abs(a.x), sagi_d4_abs(a.y), sagi_d4_abs(a.z)};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_turn(sagi_d4x3 a) { return (sagi_d4x3){a.y, a.z, a.x}; }
SAGI_INLINE sagi_d4x3 sagi_solve4_raise(sagi_d4x3 a, sagi_d4 by) {
    return (sagi_d4x3){a.x + by, a.y + by, a.z + by};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_scale(sagi_d4 s, sagi_d4x3 a) {
    return (sagi_d4x3){s * a.x, s * a.y, s * a.z};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_product_error(sagi_d4 s, sagi_d4x3 a, sagi_d4x3 product) {
    return (sagi_d4x3){sagi_d4_product_error(s, a.x, product.x), sagi_d4_product_error(s, a.y, product.y),
                       sagi_d4_product_error(s, a.z, product.z)};
}
SAGI_INLINE sagi_d4 sagi_solve4_largest(sagi_d4x3 a) { return sagi_d4_max(a.x, sagi_d4_max(a.y, a.z)); }
SAGI_INLINE void sagi_solve4_sum2(sagi_d4x3 a, sagi_d4x3 b, sagi_d4 sum[2]) {
    sum[0] = (a.x + a.y) + a.z, sum[1] = (b.x + b.y) + b.z;
}
SAGI_INLINE void sagi_solve4_sum4(sagi_d4x3 a, sagi_d4x3 b, sagi_d4x3 c, sagi_d4x3 d, sagi_d4 sum[4]) {
    sagi_solve4_sum2(a, b, sum), sagi_solve4_sum2(c, d, sum + 2);
}
SAGI_INLINE void sagi_solve4_sum2_turned(sagi_d4x3 a, sagi_d4x3 b, sagi_d4 sum[2]) {
    sum[0] = (a.y + a.z) + a.x, sum[1] = (b.y + b.z) + b.x;
}
#include "shapes/triangle_step.inl"

// sagi_triangle_solve for a ray that is not prepared, and with another t_max; the corners' fourth places hold
// anything. (Vectors do not go from file to file by value: how depends on the instruction set.)
bool sagi_triangle_solve_ray(const sag_ray *ray, double t_max, const sagi_d4 corner[3], double *t, double *u,
                             double *v);

// The weights as they are handed out: u, v ≥ 0, u + v ≤ 1.
static inline void sagi_triangle_confine(double beta, double gamma, double *u, double *v) {
    *u = beta > 0 ? (beta < 1 ? beta : 1) : 0;
    double room = 1 - *u;
    *v = gamma > 0 ? (gamma < room ? gamma : room) : 0;
}

typedef struct sagi_dd3 {
    sagi_dd x, y, z;
} sagi_dd3;

static inline sagi_dd3 sagi_dd3_from(sag_vec3 a) { return (sagi_dd3){{a.x, 0}, {a.y, 0}, {a.z, 0}}; }
static inline sagi_dd3 sagi_dd3_diff(sag_vec3 a, sag_vec3 b) {
    return (sagi_dd3){sagi_two_sum(a.x, -b.x), sagi_two_sum(a.y, -b.y), sagi_two_sum(a.z, -b.z)};
}
static inline sagi_dd sagi_dd_det(sagi_dd a, sagi_dd b, sagi_dd c, sagi_dd d) {
    return sagi_dd_sub(sagi_dd_mul(a, d), sagi_dd_mul(b, c));
}
static inline sagi_dd3 sagi_dd3_cross(const sagi_dd3 *a, const sagi_dd3 *b) {
    return (sagi_dd3){sagi_dd_det(a->y, a->z, b->y, b->z), sagi_dd_det(a->z, a->x, b->z, b->x),
                      sagi_dd_det(a->x, a->y, b->x, b->y)};
}
static inline sagi_dd sagi_dd3_dot(const sagi_dd3 *a, const sagi_dd3 *b) {
    return sagi_dd_add(sagi_dd_add(sagi_dd_mul(a->x, b->x), sagi_dd_mul(a->y, b->y)),
                       sagi_dd_mul(a->z, b->z));
}

// n · P in double-doubles.
static inline double sagi_triangle_residual(const sagi_solve1_pair *of, double t) {
    sag_vec3 a = sagi_d4_vec3(of->a), d = sagi_d4_vec3(of->d);
    sagi_dd3 ab = sagi_dd3_diff(sagi_d4_vec3(of->b), a), ac = sagi_dd3_diff(sagi_d4_vec3(of->c), a);
    sagi_dd3 n = sagi_dd3_cross(&ab, &ac), p = sagi_dd3_diff(a, sagi_d4_vec3(of->o));
    p.x = sagi_dd_sub(p.x, sagi_two_prod(t, d.x));
    p.y = sagi_dd_sub(p.y, sagi_two_prod(t, d.y));
    p.z = sagi_dd_sub(p.z, sagi_two_prod(t, d.z));
    return sagi_dd_to_double(sagi_dd3_dot(&n, &p));
}

static inline double sagi_d4_sum3(sagi_d4 a) { return (a[0] + a[1]) + a[2]; }

// Step 1 from sagi_solve1_improve on, with the bounds of its errors in full, and step 2. False when these
// will not do.
static __attribute__((noinline)) bool sagi_triangle_refine(const sagi_solve1_pair *of, sagi_solve1_step *s) {
    const double eps = SAGI_EPSILON;
    double ao_sum = sagi_d4_sum3(sagi_d4_abs(s->ao) * s->s) + 0x1p-300 * s->square;
    double d_sum = sagi_d4_sum3(sagi_d4_abs(of->d) * s->s);
    double far = s->far + 0x1p-300; // with the limits below, the bounds cover all underflow
    double denominator_error = (7.1 * eps) * d_sum, scale = 1.01 * fabs(s->inverse);
    if (!(far <= 0x1p400 && s->size >= 0x1p-200 && s->size <= 0x1p200 &&
          denominator_error <= 0x1p-10 * fabs(s->denominator)))
        return false;
    double cancelled = (2.1 * eps * eps) * (ao_sum + fabs(s->estimate) * d_sum);
    double division = denominator_error * scale + 5 * eps;
    // Of t, less the last rounding.
    double error = ((9.1 * eps) * s->p_sum + cancelled) * scale + fabs(s->step) * division;
    if (!(error <= (1.9 * eps) * fabs(s->t))) {
        s->step = sagi_triangle_residual(of, s->estimate) * s->inverse;
        s->t = s->estimate + s->step;
        error = 0x1p-100 * s->p_sum * scale + fabs(s->step) * division;
        if (!(error <= (1.9 * eps) * fabs(s->t))) return false;
    }
    sagi_solve1_weigh(of, s);
    double q_error = (6 * eps) * s->p1 + (2 * eps * eps) * (far + fabs(s->estimate) * s->d1) +
                     (error + (6 * eps) * fabs(s->step)) * s->d1;
    // Of u and v: 28u |Q| E + 14u E² for the roundings, 3.5 E times Q's error, over |n|; |Q| ≤ E.
    double weight_error = (42 * eps) * s->square + 3.5 * q_error * s->size;
    return weight_error * weight_error <= 0x1p-84 * s->n_square;
}

// sagi_triangle_solve_ray, for kernels.
SAGI_INLINE bool sagi_triangle_solve_here(const sag_ray *ray, double t_max, sagi_d4 a, sagi_d4 b, sagi_d4 c,
                                          double *t, double *u, double *v) {
    // The fourth places are parts of the ray, too.
    const sagi_solve1_pair of = {.o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin)),
                                 .d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction)),
                                 .a = a,
                                 .b = b,
                                 .c = c};
    sagi_solve1_step s;
    sagi_solve1_estimate(&of, &s);
    if (__builtin_expect(sagi_solve1_usual(&s), 1)) {
        if (!(s.estimate >= ray->t_min && s.estimate <= t_max) && sagi_solve1_outside(&s, ray->t_min, t_max))
            return false;
        sagi_solve1_improve(&of, &s);
        sagi_solve1_weigh(&of, &s);
        bool good = sagi_solve1_good(&s);
        if (!good) { // of rays that are not much longer than the triangle as often as not
            const sagi_solve1_pair pair = of; // so that the other one need not be in memory
            sagi_solve1_step full = s;
            good = sagi_triangle_refine(&pair, &full);
            s.t = full.t, s.u = full.u, s.v = full.v;
        }
        if (__builtin_expect(good, 1)) {
            if (!(s.t >= ray->t_min && s.t <= t_max)) return false;
            *t = s.t;
            sagi_triangle_confine(s.u, s.v, u, v);
            return true;
        }
    }
    const sagi_d4 corner[3] = {a, b, c};
    return sagi_triangle_solve_ray(ray, t_max, corner, t, u, v);
}

// Four rays, each with a triangle that its line pierces.
typedef struct sagi_triangle_four {
    const sag_ray *ray[4];
    sagi_d4 t_max;        // in place of the rays' own
    sagi_d4 corner[3][4]; // a, b, c of each: x, y, z and anything
    sagi_d4 t, u, v;      // what is found
} sagi_triangle_four;

// Rows to columns; the fourth of these to *rest.
SAGI_INLINE sagi_d4x3 sagi_d4_columns(const sagi_d4 row[4], sagi_d4 *rest) {
    sagi_d4 xz1 = SAGI_D4_SHUFFLE2(row[0], row[1], 0, 4, 2, 6);
    sagi_d4 xz2 = SAGI_D4_SHUFFLE2(row[2], row[3], 0, 4, 2, 6);
    sagi_d4 yw1 = SAGI_D4_SHUFFLE2(row[0], row[1], 1, 5, 3, 7);
    sagi_d4 yw2 = SAGI_D4_SHUFFLE2(row[2], row[3], 1, 5, 3, 7);
    *rest = SAGI_D4_SHUFFLE2(yw1, yw2, 2, 3, 6, 7);
    return (sagi_d4x3){SAGI_D4_SHUFFLE2(xz1, xz2, 0, 1, 4, 5), SAGI_D4_SHUFFLE2(yw1, yw2, 0, 1, 4, 5),
                       SAGI_D4_SHUFFLE2(xz1, xz2, 2, 3, 6, 7)};
}

// sagi_triangle_solve_ray for those in `lanes`, bit 0 being the first; returns those whose t is in range.
// Of others t, u and v are left with anything, and so is the ray of those that are not asked for.
static inline uint32_t sagi_triangle_solve4(sagi_triangle_four *four, uint32_t lanes) {
    if (__builtin_expect(lanes != 15, 0)) {
        if (lanes == 0) return 0;
        for (int i = 0; i < 4; i++)
            if (!(lanes >> i & 1)) four->ray[i] = four->ray[__builtin_ctz(lanes)];
    }
    sagi_d4 row[2][4], unused;
    for (int i = 0; i < 4; i++) { // a ray begins with origin, direction, t_min, t_max
        const char *ray = (const char *)four->ray[i];
        row[0][i] = sagi_d4_load(ray), row[1][i] = sagi_d4_load(ray + sizeof(sagi_d4));
    }
    sagi_solve4_pair of;
    of.o = sagi_d4_columns(row[0], &of.d.x);
    sagi_d4x3 rest = sagi_d4_columns(row[1], &unused);
    of.d.y = rest.x, of.d.z = rest.y;
    of.a = sagi_d4_columns(four->corner[0], &unused);
    of.b = sagi_d4_columns(four->corner[1], &unused);
    of.c = sagi_d4_columns(four->corner[2], &unused);
    sagi_solve4_step s;
    sagi_solve4_estimate(&of, &s);
    sagi_solve4_improve(&of, &s);
    sagi_solve4_weigh(&of, &s);
    const sagi_l4 good = sagi_solve4_usual(&s) & sagi_solve4_good(&s);
    const sagi_d4 zero = sagi_d4_fill(0), one = sagi_d4_fill(1);
    four->t = s.t;
    four->u = sagi_d4_min(sagi_d4_max(s.u, zero), one);
    four->v = sagi_d4_min(sagi_d4_max(s.v, zero), one - four->u);
    uint32_t hit = lanes & sagi_d4_signs((sagi_d4)(good & (s.t >= rest.z) & (s.t <= four->t_max)));
    uint32_t left = lanes & ~sagi_d4_signs((sagi_d4)good);
    for (; __builtin_expect(left != 0, 0); left &= left - 1) {
        const int i = __builtin_ctz(left);
        const sagi_d4 corner[3] = {four->corner[0][i], four->corner[1][i], four->corner[2][i]};
        double t, u, v;
        if (!sagi_triangle_solve_here(four->ray[i], four->t_max[i], corner[0], corner[1], corner[2], &t, &u,
                                      &v))
            continue;
        four->t[i] = t, four->u[i] = u, four->v[i] = v;
        hit |= 1U << i;
    }
    return hit;
}

#endif
