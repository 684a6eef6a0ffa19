// SPDX-License-Identifier: MIT
// A ray against a bilinear patch (Reshetov, "Cool Patches: A Geometric Approach to Ray/Bilinear Patch
// Intersections", Ray Tracing Gems, ch. 8).
//
// With the corners taken from the ray's origin (q_ij = p_ij − o), the patch at a fixed u is the segment from
// a(u) = q00 + u (q10 − q00) to b(u) = q01 + u (q11 − q01). The line of the ray meets the segment's line
// where
//
//     f(u) = det(d, a(u), b(u)) = 0,
//
// a quadratic in u: c0 + c1 u + c2 u². There, with w = b − a and m = d × w, t d = a + v w gives
//
//     t = (a × w) · m / m²,    v = (a × d) · m / m².
//
// 1. A certain miss. On [0, 1] f lies between the least and the largest of its Bernstein coefficients c0,
//    c0 + c1/2, c0 + c1 + c2; the same goes for the quadratic in v. If those have one sign, by more than
//    their error, there is nothing to hit: rays that pass the patch's outline end here. All c are sums of
//    determinants of d, a vector |q| ≤ M and one of the size E, with an error below 32ε |d|₁ M E, ε = 2⁻⁵³.
// 2. Roots in doubles (the stable way), polished by Newton's method on p(u, v) − o − t d = 0 in three
// unknowns:
//    the residual in double-doubles, the derivative and its inverse in doubles. The method converges
//    quadratically, so the size of its last step bounds the error of the one before; it is done when that
//    step moves t by less than ε |t| / 4 and u, v by less than 2⁻⁶⁰.
// 3. What does not converge, or ends too near to the rim to be told apart from it, or has almost a double
//    root: the same formulas in 400-bit reals, from exact differences. A double root is no crossing.
#include "math/dd.h"
#include "math/real3.h"
#include "shapes/bilinear.h"

// The problem brought to the order of 1: corners minus origin over 2^q_exponent, direction over 2^d_exponent.
typedef struct problem {
    const sag_bilinear_patch *patch;
    const sag_ray *ray;
    int q_exponent, d_exponent;
    sag_vec3 d, q[4];       // 00, 10, 01, 11
    sag_vec3 low[4];        // q + low are the exact differences
    sag_vec3 u_edge[2];     // q10 − q00, q11 − q01
    sag_vec3 v_edge[2];     // q01 − q00, q11 − q10
    double far, size, unit; // |q| and edges in the maximum norm; the error of a coefficient
} problem;

static double norm_max(sag_vec3 a) { return sag_max_component(sag_abs(a)); }
static double det(sag_vec3 a, sag_vec3 b, sag_vec3 c) { return sag_dot(sag_cross(a, b), c); }
static sag_vec3 scaled_down(sag_vec3 a, int exponent) {
    return sag_vec3_make(ldexp(a.x, -exponent), ldexp(a.y, -exponent), ldexp(a.z, -exponent));
}

static sag_vec3 corner(const sag_bilinear_patch *s, int i) {
    return i == 0 ? s->p00 : i == 1 ? s->p10 : i == 2 ? s->p01 : s->p11;
}

static bool set_up(const sag_bilinear_patch *s, const sag_ray *ray, problem *p) {
    *p = (problem){.patch = s, .ray = ray, .d_exponent = ilogb(norm_max(ray->direction))};
    p->d = scaled_down(ray->direction, p->d_exponent);
    double largest = 0;
    for (int i = 0; i < 4; i++) {
        if (!sag_is_finite(corner(s, i)) || !(norm_max(corner(s, i)) <= SAG_MAX_COORDINATE)) return false;
        largest = fmax(largest, norm_max(sag_sub(corner(s, i), ray->origin)));
    }
    if (!(largest > 0)) return false;
    p->q_exponent = ilogb(largest);
    for (int i = 0; i < 4; i++) {
        sag_vec3 c = corner(s, i);
        sagi_dd x = sagi_two_sum(c.x, -ray->origin.x), y = sagi_two_sum(c.y, -ray->origin.y);
        sagi_dd z = sagi_two_sum(c.z, -ray->origin.z);
        p->q[i] = scaled_down(sag_vec3_make(x.hi, y.hi, z.hi), p->q_exponent);
        p->low[i] = scaled_down(sag_vec3_make(x.lo, y.lo, z.lo), p->q_exponent);
        p->far = fmax(p->far, norm_max(p->q[i]));
    }
    p->u_edge[0] = scaled_down(sag_sub(s->p10, s->p00), p->q_exponent);
    p->u_edge[1] = scaled_down(sag_sub(s->p11, s->p01), p->q_exponent);
    p->v_edge[0] = scaled_down(sag_sub(s->p01, s->p00), p->q_exponent);
    p->v_edge[1] = scaled_down(sag_sub(s->p11, s->p10), p->q_exponent);
    for (int i = 0; i < 2; i++) p->size = fmax(p->size, fmax(norm_max(p->u_edge[i]), norm_max(p->v_edge[i])));
    double d1 = fabs(p->d.x) + fabs(p->d.y) + fabs(p->d.z);
    p->unit = 96 * SAGI_EPSILON * d1 * p->far * p->size + 0x1p-900; // |q|₁ ≤ 3 |q|∞
    return true;
}

// f(u) = det(d, a + u e0, b + u e1) with w = b − a, in a form whose error goes with the segment's length.
static void quadratic(sag_vec3 d, sag_vec3 a, sag_vec3 w, const sag_vec3 e[2], double c[3]) {
    c[0] = det(d, a, w);
    c[1] = det(d, a, sag_sub(e[1], e[0])) + det(d, e[0], w);
    c[2] = det(d, e[0], e[1]);
}

static bool certainly_no_root(const double c[3], double unit) {
    double b0 = c[0], b1 = c[0] + 0.5 * c[1], b2 = c[0] + c[1] + c[2], e = 4 * unit;
    return (b0 > e && b1 > e && b2 > e) || (b0 < -e && b1 < -e && b2 < -e);
}

static void add(const problem *p, double u, double v, double t_scaled, sagi_crossings *list) {
    double t = ldexp(t_scaled, p->q_exponent - p->d_exponent);
    if (sagi_in_range(p->ray, t)) sagi_crossings_add(list, t, u, v, 0);
}

// p(u, v) − o − t d
static sag_vec3 residual(const problem *p, double u, double v, sagi_dd t) {
    sagi_dd rest_u = sagi_two_sum(1, -u), rest_v = sagi_two_sum(1, -v);
    const sagi_dd weight[4] = {sagi_dd_mul(rest_u, rest_v), sagi_dd_mul_double(rest_v, u),
                               sagi_dd_mul_double(rest_u, v), sagi_two_prod(u, v)};
    double r[3];
    for (int k = 0; k < 3; k++) {
        sagi_dd sum = sagi_dd_neg(sagi_dd_mul_double(t, sag_component(p->d, k)));
        for (int i = 0; i < 4; i++) {
            sagi_dd q = {sag_component(p->q[i], k), sag_component(p->low[i], k)};
            sum = sagi_dd_add(sum, sagi_dd_mul(weight[i], q));
        }
        r[k] = sagi_dd_to_double(sum);
    }
    return sag_vec3_make(r[0], r[1], r[2]);
}

typedef enum outcome { MISS, HIT, UNSURE } outcome;

static outcome inside(double u, double v) {
    const double rim = 0x1p-40;
    if (u < -rim || u > 1 + rim || v < -rim || v > 1 + rim) return MISS;
    return u > rim && u < 1 - rim && v > rim && v < 1 - rim ? HIT : UNSURE;
}

// Whether a t within `error` of this one is before t_min or beyond t_max. So a ray that starts at the patch
// and leaves it is done with without exact arithmetic: its t, a rounding from 0, can hardly be known to 4 ulp
// in doubles.
static bool certainly_out_of_range(const problem *p, double t_scaled, double error) {
    int exponent = p->q_exponent - p->d_exponent;
    return ldexp(t_scaled + 2 * error, exponent) < p->ray->t_min ||
           ldexp(t_scaled - 2 * error, exponent) > p->ray->t_max;
}

// From an estimate of u: Newton's method on F = p(u, v) − o − t d. With n = pu × pv and D = d · n, its steps
// are δt = F·n/D, δu = −F·(pv × d)/D, δv = −F·(d × pu)/D. What a step leaves is δu δv twist, plus the
// step's own rounding: D and n are off by 16ε E², the residual by 2⁻⁹⁸ (M + |t|).
static outcome polish(const problem *p, double u, sagi_crossings *list) {
    sag_vec3 twist = sag_sub(p->u_edge[1], p->u_edge[0]);
    sag_vec3 a = sag_madd(p->q[0], u, p->u_edge[0]), w = sag_madd(p->v_edge[0], u, twist);
    sag_vec3 m = sag_cross(p->d, w);
    double v = sag_dot(sag_cross(a, p->d), m) / sag_dot(m, m);
    sagi_dd t = {sag_dot(sag_cross(a, w), m) / sag_dot(m, m), 0};
    for (int i = 0; i < 5; i++) {
        if (!(fabs(v) < 1e3 && fabs(t.hi) < 0x1p200)) return UNSURE;
        sag_vec3 f = residual(p, u, v, t);
        sag_vec3 pu = sag_madd(p->u_edge[0], v, twist), pv = sag_madd(p->v_edge[0], u, twist);
        sag_vec3 n = sag_cross(pu, pv);
        double denominator = sag_dot(p->d, n), rounding = 64 * SAGI_EPSILON * norm_max(pu) * norm_max(pv);
        double t_step = sag_dot(f, n) / denominator;
        double u_step = -sag_dot(f, sag_cross(pv, p->d)) / denominator;
        double v_step = -sag_dot(f, sag_cross(p->d, pu)) / denominator;
        if (!(rounding <= 0x1p-12 * fabs(denominator) && fabs(u_step) < 0.01 && fabs(v_step) < 0.01))
            return UNSURE;
        t = sagi_dd_add_double(t, t_step);
        double left = fabs(u_step * v_step) * norm_max(twist) + 0x1p-98 * (p->far + fabs(t.hi));
        double error = (3 * norm_max(f) * rounding + 3 * left * norm_max(n)) / fabs(denominator) +
                       fabs(t_step) * rounding / fabs(denominator);
        bool is_done = fabs(u_step) < 0x1p-48 && fabs(v_step) < 0x1p-48;
        u += u_step;
        v += v_step;
        if (is_done && certainly_out_of_range(p, t.hi, error)) return MISS;
        if (!is_done || !(error <= 0.25 * SAGI_EPSILON * fabs(t.hi))) continue;
        outcome where = inside(u, v);
        if (where == HIT) add(p, u, v, sagi_dd_to_double(t), list);
        return where;
    }
    return UNSURE;
}

typedef struct real_problem {
    sagi_real3 d, a, w, e0, e1, twist; // the segment's ends move along e0 and e1
} real_problem;

// Numbers here are of the order of 1 and good to 2⁻³⁴⁰ at least: less than that is an exact 0 that a root
// which is no binary fraction has blurred.
static int sign_of(const sagi_real *a) {
    return fabs(sagi_real_to_double(a)) < 0x1p-340 ? 0 : sagi_real_sign(a);
}

// The crossing at a root u; the rim belongs to the patch.
static void add_real(const problem *p, const real_problem *r, sagi_real u, sagi_crossings *list) {
    sagi_real beyond = sagi_real_sub(u, sagi_real_from(1));
    if (sign_of(&u) < 0 || sign_of(&beyond) > 0) return;
    sagi_real3 a = sagi_real3_madd(&r->a, u, &r->e0), w = sagi_real3_madd(&r->w, u, &r->twist);
    sagi_real3 m = sagi_real3_cross(&r->d, &w), a_d = sagi_real3_cross(&a, &r->d);
    sagi_real3 a_w = sagi_real3_cross(&a, &w);
    sagi_real square = sagi_real3_dot(&m, &m), v = sagi_real3_dot(&a_d, &m);
    // Along the ray, or no segment at all: m is 0, or what a root that is no binary fraction has left of it.
    if (sagi_real_to_double(&square) < 0x1p-600) return;
    v = sagi_real_div(v, square);
    beyond = sagi_real_sub(v, sagi_real_from(1));
    if (sign_of(&v) < 0 || sign_of(&beyond) > 0) return;
    sagi_real t = sagi_real_div(sagi_real3_dot(&a_w, &m), square);
    add(p, fmin(fmax(sagi_real_to_double(&u), 0), 1), fmin(fmax(sagi_real_to_double(&v), 0), 1),
        sign_of(&t) == 0 ? 0 : sagi_real_to_double(&t), list);
}

static sagi_real det_real(const sagi_real3 *a, const sagi_real3 *b, const sagi_real3 *c) {
    sagi_real3 across = sagi_real3_cross(a, b);
    return sagi_real3_dot(&across, c);
}

static void solve_real(const problem *p, sagi_crossings *list) {
    const sag_bilinear_patch *s = p->patch;
    int k = p->q_exponent;
    real_problem r = {.d = sagi_real3_from(p->d),
                      .a = sagi_real3_from_diff(s->p00, p->ray->origin, k),
                      .w = sagi_real3_from_diff(s->p01, s->p00, k),
                      .e0 = sagi_real3_from_diff(s->p10, s->p00, k),
                      .e1 = sagi_real3_from_diff(s->p11, s->p01, k)};
    r.twist = sagi_real3_sub(&r.e1, &r.e0);
    sagi_real c0 = det_real(&r.d, &r.a, &r.w), c2 = det_real(&r.d, &r.e0, &r.e1);
    sagi_real c1 = sagi_real_add(det_real(&r.d, &r.a, &r.twist), det_real(&r.d, &r.e0, &r.w));
    if (sagi_real_sign(&c2) == 0) {
        if (sagi_real_sign(&c1) != 0) add_real(p, &r, sagi_real_div(sagi_real_neg(c0), c1), list);
        return;
    }
    sagi_real discriminant = sagi_real_sub(sagi_real_mul(c1, c1), sagi_real_scale(sagi_real_mul(c0, c2), 4));
    if (sagi_real_sign(&discriminant) <= 0) return;
    sagi_real root = sagi_real_sqrt(discriminant);
    if (sagi_real_sign(&c1) < 0) root = sagi_real_neg(root);
    sagi_real q = sagi_real_scale(sagi_real_add(c1, root), -0.5); // not 0: the discriminant is not
    add_real(p, &r, sagi_real_div(q, c2), list);
    add_real(p, &r, sagi_real_div(c0, q), list);
}

void sagi_bilinear_solve(const sag_bilinear_patch *patch, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    problem p;
    if (!set_up(patch, ray, &p)) return;
    double c[3], cv[3];
    quadratic(p.d, p.q[0], p.v_edge[0], p.u_edge, c);
    quadratic(p.d, p.q[0], p.u_edge[0], p.v_edge, cv);
    if (certainly_no_root(c, p.unit) || certainly_no_root(cv, p.unit)) return;

    // f is off by less than 4 units on [0, 1], so a root there that is 0.25 from both computed ones cannot be
    // while the difference of the roots' slopes, √D, is 2²⁰ units.
    double square = c[1] * c[1], product = 4 * c[0] * c[2], discriminant = square - product;
    double error =
        8 * p.unit * (fabs(c[0]) + fabs(c[1]) + fabs(c[2])) + 4 * SAGI_EPSILON * (square + fabs(product));
    if (discriminant < -error) return;
    double root = sqrt(discriminant);
    if (!(discriminant > 0x1p10 * error && root > 0x1p20 * p.unit)) {
        solve_real(&p, list);
        return;
    }
    double q = -0.5 * (c[1] + copysign(root, c[1]));
    const double u[2] = {q / c[2], c[0] / q};
    for (int i = 0; i < 2; i++) {
        if (!(u[i] > -0.25 && u[i] < 1.25)) continue;
        if (polish(&p, u[i], list) != UNSURE) continue;
        list->count = 0;
        solve_real(&p, list);
        return;
    }
}
