// SPDX-License-Identifier: MIT
// Where a ray o + t d runs inside a quadric {F ≤ 0}. Along the ray F is the polynomial
//
//     a t² + 2 b t + c,   a = d·Qd,   b = g(o)·d,   c = F(o),   g(p) = Qp + l  (half the gradient),
//
// whose roots are t = (−b ± √D)/a, D = b² − a c. Written so, two things go wrong in floating point: b and √D
// nearly cancel for the root near the origin, and b² and a c nearly cancel for a ray that starts far away or
// grazes. The first is cured by q = −(b + sign(b) √D), t = q/a and c/q. For the second the origin is moved
// along the ray to the point of closest approach, t = −b/a, where b is nearly 0 (E. Haines et al., "Precision
// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, ch. 7, 2019).
//
// That gives good roots, not certain ones. So there are three stages, each only for what the one before left
// open:
//
// 1. Doubles with a forward error bound. Every coefficient is a sum of at most ten products; with inputs good
//    to u = 2⁻⁵³ each term has at most six roundings and the sum nine more, so its error is below 16u times
//    the sum of the terms' magnitudes. What is certain (no root, or none in the ray's range) ends here.
// 2. A root that may be in range is polished: at the approximate t, F is evaluated in double-double (error
//    below 64·2⁻¹⁰⁶ < 2⁻⁹⁹ of the sum of magnitudes), and the little quadratic a s² + 2 b s + F = 0 gives the
//    step s to the root. Its sensitivity is known: |∂s/∂F| = 1/(2√D), |∂s/∂b| = |s|/√D, |∂s/∂a| = s²/(2√D),
//    so the step carries its own certificate.
// 3. What that cannot certify (tangents, starts on the surface) is solved with 400 bits (quadric_exact.c).
#include "shapes/quadric_steps.h"

int sagi_size_exponent(double size) {
    if (size > 0x1p-40 && size < 0x1p40) return 0;
    return size > 0 && isfinite(size) ? ilogb(size) : 0;
}

sagi_local_ray sagi_quadric_localise(const sagi_quadric_form *form, const sag_ray *ray) {
    const sag_vec3 o = ray->origin, c = form->center, d = ray->direction;
    sagi_local_ray local = {
        .origin = {sagi_two_sum(o.x, -c.x), sagi_two_sum(o.y, -c.y), sagi_two_sum(o.z, -c.z)},
        .direction = {d.x, d.y, d.z},
        .t_min = ray->t_min,
        .t_max = ray->t_max,
    };
    double longest = sag_max_component(sag_abs(d));
    int shrink = longest > 0x1p-60 && longest < 0x1p60 ? 0 : ilogb(longest);
    if (form->exponent == 0 && shrink == 0) return local;
    for (int i = 0; i < 3; i++) {
        local.origin[i].hi = ldexp(local.origin[i].hi, -form->exponent);
        local.origin[i].lo = ldexp(local.origin[i].lo, -form->exponent);
        local.direction[i] = ldexp(local.direction[i], -shrink);
    }
    local.exponent = shrink - form->exponent;
    local.t_min = ldexp(ray->t_min, local.exponent);
    local.t_max = ldexp(ray->t_max, local.exponent);
    local.t_min -= fabs(local.t_min) * 0x1p-50 + 0x1p-1000;
    local.t_max += fabs(local.t_max) * 0x1p-50 + 0x1p-1000;
    return local;
}

// Stage 2.

double sagi_quadric_residual(const sagi_quadric_form *f, const sagi_dd y[3], const double d[3], double *error,
                             sagi_polynomial *slope) {
    return sagi_quadric_value(f, y, d, error, slope);
}

static bool polish(const sagi_quadric_form *form, const sagi_local_ray *ray, const sagi_polynomial *whole,
                   double sign, double *root) {
    return sagi_quadric_polish(form, ray, whole, sign, root);
}

// Stage 1.

static bool solve_linear(const sagi_quadric_form *form, const sagi_local_ray *ray, const sagi_polynomial *p,
                         sagi_spans *spans) {
    if (p->b_error == 0) {
        *spans = sagi_spans_everywhere(p->c < 0);
        return fabs(p->c) > p->c_error;
    }
    if (!(fabs(p->b) > p->b_error)) return false;
    double t = -p->c / (2 * p->b);
    if (!polish(form, ray, p, p->b, &t)) return false;
    *spans = sagi_spans_of_line(t, p->b > 0);
    return true;
}

// Writes the spans and returns true when doubles and double-doubles can say what they are.
static bool solve(const sagi_quadric_form *form, const sagi_local_ray *ray, sagi_spans *spans) {
    double o[3] = {ray->origin[0].hi, ray->origin[1].hi, ray->origin[2].hi};
    sagi_polynomial p;
    sagi_quadric_square_term(form, ray->direction, &p);
    sagi_quadric_expand(form, o, ray->direction, &p);
    if (p.a_error == 0 && p.a == 0) return solve_linear(form, ray, &p, spans);
    if (!(fabs(p.a) > p.a_error)) return false;
    double sign = p.a > 0 ? 1 : -1; // of F; sign·F opens upward
    *spans = sagi_spans_everywhere(p.a < 0);

    bool forward = ray->t_min >= 0;
    if (forward && sign * p.c > p.c_error && sign * p.b > p.b_error) return true; // both roots behind
    bool around = sign * p.c < -p.c_error;                                        // one behind, one ahead
    double d_error, d = sagi_quadric_discriminant(&p, &d_error);
    if (d < -d_error) return true;
    double shift = 0;
    if (!(d > SAGI_QUADRIC_GUARD * d_error)) {
        shift = -p.b / p.a;
        if (!isfinite(shift)) return false;
        for (int i = 0; i < 3; i++)
            o[i] = sagi_dd_add(ray->origin[i], sagi_two_prod(shift, ray->direction[i])).hi;
        sagi_quadric_expand(form, o, ray->direction, &p);
        d = sagi_quadric_discriminant(&p, &d_error);
        if (d < -d_error) return true;
        if (!(d > SAGI_QUADRIC_GUARD * d_error)) return false;
    }
    double root = sqrt(d), q = -(p.b + copysign(root, p.b));
    double ta = shift + q / p.a, tb = shift + p.c / q;
    double t0 = fmin(ta, tb), t1 = fmax(ta, tb);
    // D is known to 1/64, so √D to 1/100; the slack also covers the error of b and of the sums.
    double slack = (root * 0x1p-5 + p.b_error) / fabs(p.a) + SAGI_QUADRIC_EPSILON * fabs(shift);
    bool near = !(t0 + slack < ray->t_min || t0 - slack > ray->t_max || (forward && around));
    bool far = !(t1 + slack < ray->t_min || t1 - slack > ray->t_max);
    if (near && !polish(form, ray, &p, -sign, &t0)) return false;
    if (far && !polish(form, ray, &p, sign, &t1)) return false;
    *spans = sagi_spans_of_roots(t0, t1, p.a > 0);
    return true;
}

sagi_spans sagi_quadric_spans(const sagi_quadric_form *form, const sag_ray *ray) {
    sagi_local_ray local = sagi_quadric_localise(form, ray);
    sagi_spans spans = {0};
    double far = fmax(fabs(local.origin[0].hi), fmax(fabs(local.origin[1].hi), fabs(local.origin[2].hi)));
    if (!(far < SAGI_QUADRIC_FARTHEST)) return spans;
    if (!solve(form, &local, &spans)) spans = sagi_quadric_solve_exactly(form, &local);
    for (int i = 0; i < spans.count && local.exponent != 0; i++) {
        spans.enter[i] = ldexp(spans.enter[i], -local.exponent);
        spans.leave[i] = ldexp(spans.leave[i], -local.exponent);
    }
    return spans;
}
