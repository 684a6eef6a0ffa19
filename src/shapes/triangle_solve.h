// SPDX-License-Identifier: MIT
// Where a line that pierces a triangle does so: t and the barycentric weights u (of b) and v (of c).
//
// With n = (b − a) × (c − a), D = d · n and e the edge functions of triangle_test.c,
//
//     t = (a − o) · n / D,    u = e(c, a) / D,    v = e(a, b) / D.
//
// With S(x) the sum of the absolute values of all products in x · n, the numerator of t has in doubles an
// error of 8u S(a − o) and D one of 7u S(d) (so many roundings lie on a path): not enough for 4 ulp. So:
//
// 1. From near the triangle. For any t₀, with P = a − o − t₀ d,
//        t = t₀ + n · P / D,    u = −(d × P) · (c − a) / D,    v = (d × P) · (b − a) / D
//    exactly. t₀ = (a − o) · d / d · d, where the ray comes nearest to a, is soon there, and then P is at
//    most as long as the triangle. With error-free transforms its components come out within
//        2u |P| + 2u² (|a − o| + |t₀ d|),
//    so that n · P has an error of 9u S(P) + 2u² (S(a − o) + |t₀| S(d)): a small part of u |t D| unless the
//    triangle is large beside the distance. There is nothing in a row but this, and D is worked out beside
//    it.
// 2. Where that is not good enough, the same again from the t that it gave. Now the step n · P / D is so
//    small that D's error does not matter. Where the weights are not good either, as of rays that graze the
//    triangle, they follow from P once it is corrected: Q = n · P/D · d − P = u (b − a) + v (c − a), so
//    u = (Q × (c − a)) · n / n², v = ((b − a) × Q) · n / n² (sagi_triangle_refine).
// 3. The same step with n · P in double-doubles from exact differences. Products and sums there are good to
//    7 · 2⁻¹⁰⁶ and 3 · 2⁻¹⁰⁶, so n · P to 2⁻¹⁰⁰ S(P), and only D is still a double. Where that is not enough
//    either, all of it in double-doubles, good to 46 · 2⁻¹⁰⁶ (2⁻¹⁰⁰ is used) of E² |a − o|₁ and so on, E
//    being the longer edge in the maximum norm.
// 4. Expansions: exact numerators and denominators, two roundings. For an origin almost in the plane, rays
//    almost parallel to it, needles, and magnitudes beyond the others' limits.
//
// Each step checks its own bound (good in triangle_step.inl, sagi_triangle_refine) and hands over to the next
// when t could be off by more than 4 ulp or u and v by more than 2⁻⁴². What is asked is a function of the
// ray's line and the triangle only, and so are the bits of the result.
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

#define REAL          double
#define MASK          bool
#define BOTH(a, b)    ((a) && (b))
#define EITHER(a, b)  ((a) || (b))
#define ALL(x)        (x)
#define LESS(a, b)    ((a) < (b))
#define AT_MOST(a, b) ((a) <= (b))
#define STEP(name)    sagi_solve1_##name
#define ABS           fabs
typedef sagi_d4 sagi_solve1_vec3; // the fourth place holds anything
SAGI_INLINE sagi_d4 sagi_solve1_add(sagi_d4 a, sagi_d4 b) { return a + b; }
SAGI_INLINE sagi_d4 sagi_solve1_sub(sagi_d4 a, sagi_d4 b) { return a - b; }
SAGI_INLINE sagi_d4 sagi_solve1_mul(sagi_d4 a, sagi_d4 b) { return a * b; }
SAGI_INLINE sagi_d4 sagi_solve1_max(sagi_d4 a, sagi_d4 b) { return sagi_d4_max(a, b); }
SAGI_INLINE sagi_d4 sagi_solve1_abs(sagi_d4 a) { return sagi_d4_abs(a); }
SAGI_INLINE sagi_d4 sagi_solve1_turn(sagi_d4 a) { return SAGI_D4_SHUFFLE2(a, a, 1, 2, 0, 3); }
SAGI_INLINE sagi_d4 sagi_solve1_turn_back(sagi_d4 a) { return SAGI_D4_SHUFFLE2(a, a, 2, 0, 1, 3); }
SAGI_INLINE sagi_d4 sagi_solve1_scale(double s, sagi_d4 a) { return sagi_d4_fill(s) * a; }
SAGI_INLINE sagi_d4 sagi_solve1_product_error(double s, sagi_d4 a, sagi_d4 product) {
    return sagi_d4_product_error(sagi_d4_fill(s), a, product);
}
SAGI_INLINE double sagi_solve1_largest(sagi_d4 a) { return sagi_larger(a[0], sagi_larger(a[1], a[2])); }
SAGI_INLINE double sagi_solve1_sum(sagi_d4 a) { return sagi_d4_sum3(a); }
SAGI_INLINE void sagi_solve1_sum4(sagi_d4 a, sagi_d4 b, sagi_d4 c, sagi_d4 d, double sum[4]) {
    sagi_d4 xz1 = SAGI_D4_SHUFFLE2(a, b, 0, 4, 2, 6), xy1 = xz1 + SAGI_D4_SHUFFLE2(a, b, 1, 5, 3, 7);
    sagi_d4 xz2 = SAGI_D4_SHUFFLE2(c, d, 0, 4, 2, 6), xy2 = xz2 + SAGI_D4_SHUFFLE2(c, d, 1, 5, 3, 7);
    sagi_d4 all = SAGI_D4_SHUFFLE2(xy1, xy2, 0, 1, 4, 5) + SAGI_D4_SHUFFLE2(xz1, xz2, 2, 3, 6, 7);
    sum[0] = all[0], sum[1] = all[1], sum[2] = all[2], sum[3] = all[3];
}
#include "shapes/triangle_step.inl"

#define REAL          sagi_d4
#define MASK          sagi_l4
#define BOTH(a, b)    ((a) & (b))
#define EITHER(a, b)  ((a) | (b))
#define ALL(x)        sagi_d4_fill(x)
#define LESS(a, b)    sagi_d4_less(a, b)
#define AT_MOST(a, b) sagi_d4_at_most(a, b)
#define STEP(name)    sagi_solve4_##name
#define ABS           sagi_d4_abs
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
SAGI_INLINE sagi_d4x3 sagi_solve4_turn_back(sagi_d4x3 a) { return (sagi_d4x3){a.z, a.x, a.y}; }
SAGI_INLINE sagi_d4x3 sagi_solve4_scale(sagi_d4 s, sagi_d4x3 a) {
    return (sagi_d4x3){s * a.x, s * a.y, s * a.z};
}
SAGI_INLINE sagi_d4x3 sagi_solve4_product_error(sagi_d4 s, sagi_d4x3 a, sagi_d4x3 product) {
    return (sagi_d4x3){sagi_d4_product_error(s, a.x, product.x), sagi_d4_product_error(s, a.y, product.y),
                       sagi_d4_product_error(s, a.z, product.z)};
}
SAGI_INLINE sagi_d4 sagi_solve4_largest(sagi_d4x3 a) { return sagi_d4_max(a.x, sagi_d4_max(a.y, a.z)); }
SAGI_INLINE sagi_d4 sagi_solve4_sum(sagi_d4x3 a) { return (a.x + a.y) + a.z; }
SAGI_INLINE void sagi_solve4_sum4(sagi_d4x3 a, sagi_d4x3 b, sagi_d4x3 c, sagi_d4x3 d, sagi_d4 sum[4]) {
    sum[0] = sagi_solve4_sum(a), sum[1] = sagi_solve4_sum(b);
    sum[2] = sagi_solve4_sum(c), sum[3] = sagi_solve4_sum(d);
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

typedef enum sagi_triangle_outcome {
    SAGI_TRIANGLE_OPEN,   // not known: the next step has to say
    SAGI_TRIANGLE_SOLVED, // t, u (not yet confined) and v are good
    SAGI_TRIANGLE_OUTSIDE // t is certainly out of range
} sagi_triangle_outcome;

// Steps 2 and 3, from t = s->t on.
static __attribute__((noinline)) sagi_triangle_outcome
sagi_triangle_refine(const sagi_solve1_pair *of, double t_min, double t_max, sagi_solve1_step *s) {
    const double eps = SAGI_EPSILON, t0 = s->t, size = s->size, square = size * size;
    sagi_d4 ao = of->a - of->o, ab = of->b - of->a, ac = of->c - of->a, turned_d = sagi_solve1_turn(of->d);
    sagi_d4 turned_ab = sagi_solve1_turn_back(ab), turned_ac = sagi_solve1_turn_back(ac);
    sagi_d4 plus = turned_ab * ac, minus = ab * turned_ac, n = plus - minus; // (y z x)
    // Σ|xᵢ| sᵢ is S(x); 2⁻¹⁰⁰ is for underflow.
    sagi_d4 products = (sagi_d4_abs(plus) + sagi_d4_abs(minus)) + sagi_d4_fill(0x1p-100 * square);
    double denominator = sagi_solve1_sum(n * turned_d);
    double ao_sum = sagi_solve1_sum(sagi_d4_abs(sagi_solve1_turn(ao)) * products) + 0x1p-300 * square;
    double d_sum = sagi_solve1_sum(sagi_d4_abs(turned_d) * products);
    double far = sagi_solve1_sum(sagi_d4_abs(ao)) + 0x1p-300; // with these limits, it covers all underflow
    double denominator_error = (7.1 * eps) * d_sum, scale = 1.01 * fabs(s->inverse);
    if (!(far <= 0x1p400 && size >= 0x1p-200 && size <= 0x1p200 &&
          denominator_error <= 0x1p-10 * fabs(denominator)))
        return SAGI_TRIANGLE_OPEN;
    sagi_d4 p = sagi_solve1_way_back(of, ao, t0), turned_p = sagi_solve1_turn(p);
    double p_sum = sagi_solve1_sum(sagi_d4_abs(turned_p) * products), p1 = sagi_solve1_sum(sagi_d4_abs(p));
    double step = sagi_solve1_sum(n * turned_p) * s->inverse, t = t0 + step;
    double cancelled = (2.1 * eps * eps) * (ao_sum + fabs(t0) * d_sum);
    double division = denominator_error * scale + 5 * eps;
    // Of t, less the last rounding.
    double error = ((9.1 * eps) * p_sum + cancelled) * scale + fabs(step) * division;
    if (!(error <= (1.9 * eps) * fabs(t))) {
        double margin = 1.01 * error + (16 * eps) * fabs(t);
        if (t + margin < t_min || t - margin > t_max) return SAGI_TRIANGLE_OUTSIDE;
        step = sagi_triangle_residual(of, t0) * s->inverse;
        t = t0 + step;
        error = 0x1p-100 * p_sum * scale + fabs(step) * division;
        if (!(error <= (1.9 * eps) * fabs(t))) return SAGI_TRIANGLE_OPEN;
    }
    sagi_d4 q = sagi_d4_fill(step) * of->d - p, turned_q = sagi_solve1_turn_back(q);
    double n_square = sagi_solve1_sum(n * n), inverse = 1 / n_square;
    s->t = t;
    s->u = sagi_solve1_sum((turned_q * ac - q * turned_ac) * n) * inverse;
    s->v = sagi_solve1_sum((turned_ab * q - ab * turned_q) * n) * inverse;
    double q_error = (6 * eps) * p1 + (2 * eps * eps) * (far + fabs(t0) * s->d1) +
                     (error + (6 * eps) * fabs(step)) * s->d1;
    // Of u and v: 28u |Q| E + 14u E² for the roundings, 3.5 E times Q's error, over |n|; |Q| ≤ E.
    double weight_error = (42 * eps) * square + 3.5 * q_error * size;
    return weight_error * weight_error <= 0x1p-84 * n_square ? SAGI_TRIANGLE_SOLVED : SAGI_TRIANGLE_OPEN;
}

// What the first step, which ended with *s, left open.
static __attribute__((noinline)) bool sagi_triangle_solve_on(const sag_ray *ray, double t_max,
                                                             const sagi_solve1_pair *of, sagi_solve1_step *s,
                                                             double *t, double *u, double *v) {
    if (s->d1 >= 0x1p-62 && s->d1 <= 0x1p64) { // directions that sagi_triangle_prepare takes as they are
        const sagi_triangle_outcome outcome = sagi_triangle_refine(of, ray->t_min, t_max, s);
        if (outcome == SAGI_TRIANGLE_OUTSIDE) return false;
        if (outcome == SAGI_TRIANGLE_SOLVED) {
            if (!(s->t >= ray->t_min && s->t <= t_max)) return false;
            *t = s->t;
            sagi_triangle_confine(s->u, s->v, u, v);
            return true;
        }
    }
    const sagi_d4 corner[3] = {of->a, of->b, of->c};
    return sagi_triangle_solve_ray(ray, t_max, corner, t, u, v);
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
    sagi_solve1_solve(&of, &s);
    bool good = sagi_solve1_good(&s);
    if (!good) { // of rays that are not much longer than the triangle
        if (sagi_solve1_beyond(&s, ray->t_min, t_max)) return false;
        sagi_solve1_again(&of, &s);
        good = sagi_solve1_good(&s);
    }
    if (__builtin_expect(!good, 0)) {
        const sagi_solve1_pair pair = of; // so that the other one need not be in memory
        sagi_solve1_step step = s;
        return sagi_triangle_solve_on(ray, t_max, &pair, &step, t, u, v);
    }
    if (!(s.t >= ray->t_min && s.t <= t_max)) return false;
    *t = s.t;
    sagi_triangle_confine(s.u, s.v, u, v);
    return true;
}

// The same, of vertices that are floats, where it is soonest done, as it is mostly: with the first step only,
// and t in range; *tuv is t, u, v and anything. False: that is for sagi_triangle_solve_here to say.
//
// What it asks of the step is a little more than triangle_step.inl does, so that the bits are the same. With
// h = E²/|D| and q = h (1 + d²), |d|₁ ≤ √3 |d|₂ ≤ ½√3 (1 + d²) makes g ≤ 0.8661q: g ≤ 40 where q ≤ 46,
// and 14.6g ≤ 12.65q. As g ≥ 0.49, |t d|₁ ≥ 2⁻²⁰ E where t ≥ 2⁻¹⁸ hE. And |d|₂ ≤ 46 √3/0.49 < 163, |d|₁ < 2⁹,
// so that |t d|₁ ≤ 2³⁶ E where t ≤ 2²⁷ E; and |d|₁ ≥ 0.49/46. Edges of floats are neither less than 2⁻¹⁴⁹ nor
// more than 2¹²⁹. (An edge that is 0 makes h a NaN.)
SAGI_INLINE bool sagi_triangle_solve_quick(const sag_ray *ray, double t_max, sagi_d4 a, sagi_d4 b, sagi_d4 c,
                                           sagi_d4 *tuv) {
    const sagi_solve1_pair of = {.o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin)),
                                 .d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction)),
                                 .a = a,
                                 .b = b,
                                 .c = c};
    sagi_d4 ao = of.a - of.o, ab = of.b - of.a, ac = of.c - of.a;
    sagi_d4 turned_ab = sagi_solve1_turn_back(ab), turned_ac = sagi_solve1_turn_back(ac),
            turned_d = sagi_solve1_turn(of.d);
    sagi_d4 plus = turned_ab * ac, minus = ab * turned_ac, n = plus - minus;
    double inverse = 1.0 / sagi_solve1_sum(n * turned_d), d_square = sagi_solve1_sum(of.d * of.d);
    double t0 = sagi_solve1_sum(ao * (sagi_d4_fill(1.0 / d_square) * of.d));
    sagi_d4 p = sagi_solve1_way_back(&of, ao, t0), turned_p = sagi_solve1_turn(p);
    sagi_d4 m = turned_d * p - of.d * turned_p;
    // Four sums, each as sagi_solve1_sum4 has it, times 1/D. The third is of the other sign.
    sagi_d4 x = n * turned_p, y = m * turned_ac, z = m * turned_ab;
    sagi_d4 w = (sagi_d4_abs(plus) + sagi_d4_abs(minus)) * sagi_d4_abs(turned_p);
    sagi_d4 xy = SAGI_D4_SHUFFLE2(x, y, 0, 4, 2, 6), zw = SAGI_D4_SHUFFLE2(z, w, 0, 4, 2, 6);
    sagi_d4 first = xy + SAGI_D4_SHUFFLE2(x, y, 1, 5, 3, 7), second = zw + SAGI_D4_SHUFFLE2(z, w, 1, 5, 3, 7);
    sagi_d4 sum = SAGI_D4_SHUFFLE2(first, second, 0, 1, 4, 5) + SAGI_D4_SHUFFLE2(xy, zw, 2, 3, 6, 7);
    const sagi_d4 sign = {0, 0, -0.0, 0};
    sagi_d4 found = sum * (sagi_d4)((sagi_l4)sagi_d4_fill(inverse) ^ (sagi_l4)sign);
    const sagi_l4 only_first = {-1, 0, 0, 0}, only_third = {0, 0, -1, 0};
    const double step = found[0];
    found += (sagi_d4)((sagi_l4)sagi_d4_fill(t0) & only_first);

    double size = sagi_solve1_largest(sagi_d4_max(sagi_d4_abs(ab), sagi_d4_abs(ac)));
    double h = size * size * fabs(inverse), least = 0x1p-18 * (h * size), most = 0x1p27 * size, t = found[0];
    most = most < t_max ? most : t_max;
    const double q = h * (1 + d_square);
    const double error = 9.4 * fabs(found[3]) + (12.65 * q + 4) * fabs(step);
    if (!(q <= 46) || !(error <= 2.79 * t) || !(t >= least) || !(t <= most)) return false;
    if (!(t >= ray->t_min)) return false;
    // sagi_triangle_confine.
    const sagi_d4 low = {-INFINITY, 0, 0, 0}, high = {INFINITY, 1, 1, 1};
    found = sagi_d4_min(sagi_d4_max(found, low), high);
    sagi_d4 u = (sagi_d4)((sagi_l4)SAGI_D4_SHUFFLE2(found, found, 0, 0, 1, 3) & only_third);
    *tuv = sagi_d4_min(found, high - u);
    return true;
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
    sagi_solve4_solve(&of, &s);
    sagi_l4 good = sagi_solve4_good(&s), beyond = {0, 0, 0, 0};
    if (sagi_d4_signs((sagi_d4)good) != 15) {
        beyond = ~good & sagi_solve4_beyond(&s, rest.z, four->t_max);
        sagi_solve4_step second = s;
        sagi_solve4_again(&of, &second);
        s.t = sagi_d4_select(good, s.t, second.t);
        good |= sagi_solve4_good(&second);
    }
    const sagi_d4 zero = sagi_d4_fill(0), one = sagi_d4_fill(1);
    four->t = s.t;
    four->u = sagi_d4_min(sagi_d4_max(s.u, zero), one);
    four->v = sagi_d4_min(sagi_d4_max(s.v, zero), one - four->u);
    uint32_t hit =
        lanes &
        sagi_d4_signs((sagi_d4)(good & sagi_d4_at_most(rest.z, s.t) & sagi_d4_at_most(s.t, four->t_max)));
    uint32_t left = lanes & ~sagi_d4_signs((sagi_d4)(good | beyond));
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
