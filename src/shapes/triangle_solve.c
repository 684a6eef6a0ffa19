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
#include "math/dd.h"
#include "shapes/common.h"
#include "shapes/triangle.h"
#include "shapes/vector_expansion.h"

#if defined(__GNUC__)
#define SAGI_COLD     __attribute__((noinline, cold))
#define SAGI_NOINLINE __attribute__((noinline))
#else
#define SAGI_COLD
#define SAGI_NOINLINE
#endif

static double norm1(sag_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }
static double larger(double a, double b) { return a > b ? a : b; }
static double norm_max(sag_vec3 a) { return larger(larger(fabs(a.x), fabs(a.y)), fabs(a.z)); }

// Writes the answer when t, back in the caller's directions, is in range and a number: very short directions
// may put it beyond the doubles.
static bool accept(const sagi_triangle_ray *ray, double t_scaled, double beta, double gamma, double *t,
                   double *u, double *v) {
    double value = ray->exponent ? ldexp(t_scaled, -ray->exponent) : t_scaled;
    if (!(value >= ray->t_min && value <= ray->t_max) || isinf(value)) return false;
    *t = value;
    *u = beta > 0 ? (beta < 1 ? beta : 1) : 0;
    double room = 1 - *u;
    *v = gamma > 0 ? (gamma < room ? gamma : room) : 0;
    return true;
}

static SAGI_COLD bool solve_exact(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                                  const sag_vec3 *c, double *t, double *u, double *v) {
    sagi_expansion3 d = sagi_expansion3_from(ray->d), ao = sagi_expansion3_from_diff(*a, ray->o);
    sagi_expansion3 ab = sagi_expansion3_from_diff(*b, *a), ac = sagi_expansion3_from_diff(*c, *a);
    // Each vector is its true value times 2 to the exponent here; quotients take the difference out again.
    int d_scale = sagi_expansion3_normalize(&d), ao_scale = sagi_expansion3_normalize(&ao);
    int ab_scale = sagi_expansion3_normalize(&ab), ac_scale = sagi_expansion3_normalize(&ac);
    sagi_expansion3 n = sagi_expansion3_cross(&ab, &ac), moment = sagi_expansion3_cross(&d, &ao);
    int n_scale = sagi_expansion3_normalize(&n), moment_scale = sagi_expansion3_normalize(&moment);

    double denominator[192], numerator[192];
    int m = sagi_expansion3_dot(&d, &n, denominator);
    if (m == 0) return false;
    int count = sagi_expansion3_dot(&ao, &n, numerator);
    double t_scaled = sagi_expansion_quotient(count, numerator, m, denominator, d_scale - ao_scale);
    int weight_scale = n_scale - ao_scale - moment_scale;
    count = sagi_expansion3_dot(&moment, &ac, numerator); // −e(c, a)
    double beta = -sagi_expansion_quotient(count, numerator, m, denominator, weight_scale + ab_scale);
    count = sagi_expansion3_dot(&moment, &ab, numerator); // e(a, b)
    double gamma = sagi_expansion_quotient(count, numerator, m, denominator, weight_scale + ac_scale);
    return accept(ray, t_scaled, beta, gamma, t, u, v);
}

typedef struct dd3 {
    sagi_dd x, y, z;
} dd3;

static dd3 dd3_from(sag_vec3 a) { return (dd3){{a.x, 0}, {a.y, 0}, {a.z, 0}}; }
static dd3 dd3_diff(sag_vec3 a, sag_vec3 b) {
    return (dd3){sagi_two_sum(a.x, -b.x), sagi_two_sum(a.y, -b.y), sagi_two_sum(a.z, -b.z)};
}
static sagi_dd dd_det(sagi_dd a, sagi_dd b, sagi_dd c, sagi_dd d) {
    return sagi_dd_sub(sagi_dd_mul(a, d), sagi_dd_mul(b, c));
}
static dd3 dd3_cross(const dd3 *a, const dd3 *b) {
    return (dd3){dd_det(a->y, a->z, b->y, b->z), dd_det(a->z, a->x, b->z, b->x),
                 dd_det(a->x, a->y, b->x, b->y)};
}
static sagi_dd dd3_dot(const dd3 *a, const dd3 *b) {
    return sagi_dd_add(sagi_dd_add(sagi_dd_mul(a->x, b->x), sagi_dd_mul(a->y, b->y)),
                       sagi_dd_mul(a->z, b->z));
}

static SAGI_COLD bool solve_dd(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                               const sag_vec3 *c, double far, double size, double *t, double *u, double *v) {
    dd3 d = dd3_from(ray->d), ao = dd3_diff(*a, ray->o), ab = dd3_diff(*b, *a), ac = dd3_diff(*c, *a);
    dd3 n = dd3_cross(&ab, &ac), moment = dd3_cross(&d, &ao);
    sagi_dd denominator = dd3_dot(&d, &n), numerator = dd3_dot(&ao, &n);
    double square = size * size, unit = 0x1p-100;
    double denominator_error = unit * ray->d1 * square;
    if (!(denominator_error <= 0.5 * SAGI_EPSILON * fabs(denominator.hi) &&
          unit * far * square <= 0.5 * SAGI_EPSILON * fabs(numerator.hi) &&
          unit * ray->d1 * far * size + denominator_error <= 0x1p-50 * fabs(denominator.hi)))
        return solve_exact(ray, a, b, c, t, u, v);
    double beta = -sagi_dd_to_double(sagi_dd_div(dd3_dot(&moment, &ac), denominator));
    double gamma = sagi_dd_to_double(sagi_dd_div(dd3_dot(&moment, &ab), denominator));
    return accept(ray, sagi_dd_to_double(sagi_dd_div(numerator, denominator)), beta, gamma, t, u, v);
}

// n · P in double-doubles, see 2. above.
static SAGI_NOINLINE double residual_dd(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                                        const sag_vec3 *c, double t) {
    dd3 ab = dd3_diff(*b, *a), ac = dd3_diff(*c, *a), n = dd3_cross(&ab, &ac), p = dd3_diff(*a, ray->o);
    p.x = sagi_dd_sub(p.x, sagi_two_prod(t, ray->d.x));
    p.y = sagi_dd_sub(p.y, sagi_two_prod(t, ray->d.y));
    p.z = sagi_dd_sub(p.z, sagi_two_prod(t, ray->d.z));
    return sagi_dd_to_double(dd3_dot(&n, &p));
}

// a − o − t d for one coordinate, see 1. above.
static double back_to_a(double a, double o, double t, double d) {
    sagi_dd difference = sagi_two_sum(a, -o), way = sagi_two_prod(t, d);
    return (difference.hi - way.hi) + (difference.lo - way.lo);
}

bool sagi_triangle_solve(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                         const sag_vec3 *c, double *t, double *u, double *v) {
    const double eps = SAGI_EPSILON;
    sag_vec3 o = ray->o, d = ray->d;
    sag_vec3 ao = sag_sub(*a, o), ab = sag_sub(*b, *a), ac = sag_sub(*c, *a);
    sag_vec3 n = sag_cross(ab, ac);
    double far = norm1(ao) + 0x1p-300; // with the limits below, the bounds cover all underflow
    double size = larger(norm_max(ab), norm_max(ac));
    if (!(far <= 0x1p400 && size >= 0x1p-200 && size <= 0x1p200)) return solve_exact(ray, a, b, c, t, u, v);

    // Σ|x_i| s_i is the sum of the absolute values of all products in x · n; the last term is for underflow.
    double square = size * size;
    sag_vec3 s = sag_vec3_make(fabs(ab.y * ac.z) + fabs(ab.z * ac.y) + 0x1p-100 * square,
                               fabs(ab.z * ac.x) + fabs(ab.x * ac.z) + 0x1p-100 * square,
                               fabs(ab.x * ac.y) + fabs(ab.y * ac.x) + 0x1p-100 * square);
    double numerator = sag_dot(ao, n), denominator = sag_dot(d, n);
    double ao_sum = sag_dot(sag_abs(ao), s) + 0x1p-300 * square, d_sum = sag_dot(sag_abs(d), s);
    double denominator_error = 7.1 * eps * d_sum;
    if (!(denominator_error <= 0x1p-10 * fabs(denominator)))
        return solve_dd(ray, a, b, c, far, size, t, u, v);

    // The margin of 8u |t| makes sure that what is turned away here would be when rounded, too.
    double inverse = 1 / denominator, estimate = numerator * inverse;
    double scale = 1.01 * fabs(inverse);
    double estimate_error = (8.1 * eps * ao_sum + fabs(estimate) * denominator_error) * scale;
    double margin = estimate_error + 8 * eps * fabs(estimate);
    if (ray->exponent == 0 && (estimate + margin < ray->t_min || estimate - margin > ray->t_max))
        return false;

    sag_vec3 p = sag_vec3_make(back_to_a(a->x, o.x, estimate, d.x), back_to_a(a->y, o.y, estimate, d.y),
                               back_to_a(a->z, o.z, estimate, d.z));
    double step = sag_dot(n, p) * inverse, p_sum = sag_dot(sag_abs(p), s);
    double cancelled = 2.1 * eps * eps * (ao_sum + fabs(estimate) * d_sum);
    double step_error = (9.1 * eps * p_sum + cancelled) * scale,
           division = denominator_error * scale + 5 * eps;
    if (!(step_error + fabs(step) * division <= 1.9 * eps * fabs(estimate + step))) {
        step = residual_dd(ray, a, b, c, estimate) * inverse;
        step_error = 0x1p-100 * p_sum * scale;
    }
    step_error += fabs(step) * division;
    double result = estimate + step;

    sag_vec3 q = sag_sub(sag_scale(d, step), p);
    double q_error = 6 * eps * norm1(p) + 2 * eps * eps * (far + fabs(estimate) * ray->d1) +
                     (step_error + 6 * eps * fabs(step)) * ray->d1;
    // Of u and v: 28u |Q| E + 14u E² for the roundings, 3.5 E times Q's error, over |n|; |Q| ≤ E.
    double weight_error = 42 * eps * square + 3.5 * q_error * size, n_square = sag_dot(n, n);
    if (!(step_error <= 1.9 * eps * fabs(result) && weight_error * weight_error <= 0x1p-84 * n_square))
        return solve_dd(ray, a, b, c, far, size, t, u, v);
    double inverse_square = 1 / n_square;
    return accept(ray, result, sag_dot(sag_cross(q, ac), n) * inverse_square,
                  sag_dot(sag_cross(ab, q), n) * inverse_square, t, u, v);
}
