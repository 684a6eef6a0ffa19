// SPDX-License-Identifier: MIT
// The sphere |o + t d − c| = r, the hot one: the stages of quadric_solve.c written out for it. With l = o −
// c,
//
//     a t² + 2 b t + c = 0,   a = d·d,   b = l·d,   c = l·l − r²,   D = b² − a c.
//
// Error bounds, with u = 2⁻⁵³: l has one rounding in each coordinate; so |b| is off by at most 5u|l||d| (by
// Cauchy and Schwarz the terms' magnitudes sum to at most |l||d|), l·l by 5u l², c by 6u(l² + r²), a by 3u a;
// in D, b² is off by 12u a l² and a c by 11u a (l² + r²): 24u a (l² + r²) in all. The code takes 8u and 32u.
//
// D ≥ 64 · 32u a (l² + r²) holds up to about 10⁶ radii away; farther out, and for grazing rays, the general
// solver moves the origin to the point of closest approach.
#include "math/dd.h"
#include "shapes/quadric_solve.h"
#include "shapes/sphere.h"

typedef struct sphere {
    sag_vec3 center;
    double radius; // scaled by 2^-exponent
} sphere;

static void exact(const void *shape, sagi_quadric_exact *q) {
    const sphere *s = shape;
    for (int i = 0; i < 3; i++) {
        q->square[i] = sagi_real_from(1);
        q->cross[i] = q->linear[i] = sagi_real_from(0);
    }
    q->constant = sagi_real_scale(sagi_real_from(s->radius), -s->radius);
}

static sagi_quadric_form form_of(sphere *s) {
    int exponent = sagi_size_exponent(s->radius);
    if (exponent != 0) s->radius = ldexp(s->radius, -exponent);
    return (sagi_quadric_form){
        .square = {{1, 0}, {1, 0}, {1, 0}},
        .constant = sagi_dd_neg(sagi_two_prod(s->radius, s->radius)),
        .center = s->center,
        .exponent = exponent,
        .exact = exact,
        .shape = s,
    };
}

// The crossings in range, by the general solver.
static int solve_generally(sag_vec3 center, double radius, const sag_ray *ray, double t[2]) {
    sphere s = {center, radius};
    sagi_quadric_form form = form_of(&s);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    int count = 0;
    if (spans.count == 0) return 0;
    if (sagi_in_range(ray, spans.enter[0])) t[count++] = spans.enter[0];
    if (sagi_in_range(ray, spans.leave[0])) t[count++] = spans.leave[0];
    return count;
}

// F at t in about twice the working precision (the compensated dot product of T. Ogita, S. Rump & S. Oishi,
// "Accurate Sum and Dot Product", SISC 26(6), 2005), with an error bound; *b becomes ½ dF/dt there. The point
// is kept as high + low in each coordinate; low is below 2u of |l| + |t d| and known to 2u of itself, the
// squares of the high parts are summed exactly but for their low parts' roundings.
static double residual(const sag_ray *ray, sag_vec3 c, double r, double t, double *b, double *error) {
    const double o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double center[3] = {c.x, c.y, c.z};
    sagi_dd sum = sagi_two_prod(r, -r);
    double reach = 0, size = 0, half_slope = 0, low_sum = sum.lo, high_sum = sum.hi;
    for (int i = 0; i < 3; i++) {
        sagi_dd l = sagi_two_sum(o[i], -center[i]), td = sagi_two_prod(t, d[i]);
        sagi_dd p = sagi_two_sum(l.hi, td.hi);
        double low = p.lo + (l.lo + td.lo);
        sagi_dd square = sagi_two_prod(p.hi, p.hi), next = sagi_two_sum(high_sum, square.hi);
        high_sum = next.hi;
        low_sum += next.lo + (square.lo + low * (2 * p.hi + low));
        reach += fabs(l.hi) + fabs(td.hi);
        size += fabs(p.hi);
        half_slope += p.hi * d[i];
    }
    *b = half_slope;
    *error = 0x1p-98 * (size * reach + r * r);
    return high_sum + low_sum;
}

// As `polish` in quadric_solve.c: makes the root certain to an ulp, or certainly out of range.
static bool polish(const sag_ray *ray, sag_vec3 c, double r, double a, double sign, double *root) {
    double t = *root;
    for (int i = 0; i < 3; i++) {
        double b, value_error, value = residual(ray, c, r, t, &b, &value_error);
        double size = fabs(b);
        // b's own error, 5u|p||d|, is small beside it where b² ≥ 2⁻⁴⁰ a p², and p² is r² + F.
        if (!(b * sign > 0) || !(b * b >= 0x1p-40 * a * (r * r + fabs(value)))) return false;
        if (!(a * (fabs(value) + value_error) <= b * b * 0.25)) return false;
        double step = -value / (b + copysign(sqrt(b * b - a * value), b));
        double error = 0.75 * value_error / size + fabs(step) * 0x1p-29;
        t += step;
        if (error <= SAGI_EPSILON * fabs(t) || t + error < ray->t_min || t - error > ray->t_max) {
            *root = t;
            return true;
        }
    }
    return false;
}

// The crossings in range in order, or only the first one: returns how many were written.
static inline int solve(sag_vec3 center, double radius, const sag_ray *ray, bool nearest, double t[2]) {
    sag_vec3 l = sag_sub(ray->origin, center), d = ray->direction;
    double a = sag_dot(d, d), b = sag_dot(l, d), ll = sag_dot(l, l), rr = radius * radius;
    double c = ll - rr, size = ll + rr, d2 = b * b - a * c;
    // Out of these ranges products might over- or underflow.
    if (!(a > 0x1p-120 && a < 0x1p120 && rr > 0x1p-200 && size < 0x1p250))
        return solve_generally(center, radius, ray, t);
    double c_error = 8 * SAGI_EPSILON * size, d2_error = 32 * SAGI_EPSILON * a * size;
    if (d2 < -d2_error) return 0;
    bool forward = ray->t_min >= 0;
    // Outside and going away: b > 0 is certain where b² > (5u)² a l².
    if (forward && c > c_error && b > 0 && b * b > 0x1p-100 * a * ll) return 0;
    if (!(d2 > 64 * d2_error)) return solve_generally(center, radius, ray, t);

    double root = sqrt(d2), q = -(b + copysign(root, b));
    double ta = q / a, tb = c / q, t0 = fmin(ta, tb), t1 = fmax(ta, tb), slack = root * 0x1p-5 / a;
    if (t0 - slack > ray->t_max || t1 + slack < ray->t_min) return 0;
    int count = 0;
    bool near = !(t0 + slack < ray->t_min) && !(forward && c < -c_error);
    if (near) {
        if (!polish(ray, center, radius, a, -1, &t0)) return solve_generally(center, radius, ray, t);
        if (sagi_in_range(ray, t0)) t[count++] = t0;
        if (nearest && count == 1) return 1;
    }
    if (t1 - slack > ray->t_max) return count;
    if (!polish(ray, center, radius, a, 1, &t1)) return solve_generally(center, radius, ray, t);
    if (sagi_in_range(ray, t1)) t[count++] = t1;
    return count;
}

bool sagi_sphere_hit(sag_vec3 center, double radius, const sag_ray *ray, double *t) {
    double roots[2];
    if (solve(center, radius, ray, true, roots) == 0) return false;
    *t = roots[0];
    return true;
}

int sagi_sphere_crossings(sag_vec3 center, double radius, const sag_ray *ray, double t[2]) {
    return solve(center, radius, ray, false, t);
}

bool sagi_sphere_contains(sag_vec3 center, double radius, sag_vec3 point) {
    sphere s = {center, radius};
    sagi_quadric_form form = form_of(&s);
    return sag_is_finite(point) && sagi_quadric_sign(&form, point) <= 0;
}
