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
// 3. What that cannot certify (tangents, starts on the surface) is solved with 400 bits (math/real.h).
#include "shapes/quadric_solve.h"

#define EPSILON     (16 * SAGI_EPSILON)
#define EPSILON_DD  0x1p-99
#define FARTHEST    0x1p200 // beyond that many sizes of the shape b² may overflow; a ray from there is a miss
#define SHIFT_GUARD 64      // D must be this many times its error for stage 1's roots to be good guesses

// The ray in the form's coordinates: y = origin + τ·direction, τ = t·2^exponent.
typedef struct local_ray {
    sagi_dd origin[3];
    double direction[3];
    double t_min, t_max; // widened a little
    int exponent;
} local_ray;

// a t² + 2 b t + c with error bounds.
typedef struct polynomial {
    double a, b, c;
    double a_error, b_error, c_error;
} polynomial;

int sagi_size_exponent(double size) {
    if (size > 0x1p-40 && size < 0x1p40) return 0;
    return size > 0 && isfinite(size) ? ilogb(size) : 0;
}

static local_ray localise(const sagi_quadric_form *form, const sag_ray *ray) {
    const sag_vec3 o = ray->origin, c = form->center, d = ray->direction;
    local_ray local = {
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

// Q v and |Q||v|.
static void apply(const sagi_quadric_form *f, const double v[3], double out[3], double magnitude[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = f->square[i].hi * v[i];
        magnitude[i] = fabs(out[i]);
    }
    if (!f->mixed) return;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double xj = f->cross[k].hi * v[j], xk = f->cross[j].hi * v[k];
        out[i] += xj + xk;
        magnitude[i] += fabs(xj) + fabs(xk);
    }
}

static void quadratic_term(const sagi_quadric_form *f, const double d[3], polynomial *p) {
    double qd[3], magnitude[3];
    apply(f, d, qd, magnitude);
    p->a = qd[0] * d[0] + qd[1] * d[1] + qd[2] * d[2];
    p->a_error =
        EPSILON * (magnitude[0] * fabs(d[0]) + magnitude[1] * fabs(d[1]) + magnitude[2] * fabs(d[2]));
}

// b and c at the point y, itself good to one rounding in each coordinate.
static void expand_at(const sagi_quadric_form *f, const double y[3], const double d[3], polynomial *p) {
    double g[3], magnitude[3];
    apply(f, y, g, magnitude);
    double b = 0, b_sum = 0, c = f->constant.hi, c_sum = fabs(c);
    for (int i = f->mixed ? 0 : 2; i < 3; i++) {
        double l = f->linear[i].hi;
        g[i] += l;
        magnitude[i] += fabs(l);
        c += l * y[i];
        c_sum += fabs(l * y[i]);
    }
    for (int i = 0; i < 3; i++) {
        b += g[i] * d[i];
        b_sum += magnitude[i] * fabs(d[i]);
        c += g[i] * y[i];
        c_sum += magnitude[i] * fabs(y[i]);
    }
    p->b = b, p->c = c;
    p->b_error = EPSILON * b_sum, p->c_error = EPSILON * c_sum;
}

static double discriminant(const polynomial *p, double *error) {
    double bb = p->b * p->b, ac = p->a * p->c;
    *error = (2 * fabs(p->b) + p->b_error) * p->b_error + fabs(p->c) * p->a_error +
             (fabs(p->a) + p->a_error) * p->c_error + 4 * SAGI_EPSILON * (bb + fabs(ac));
    return bb - ac;
}

// Stage 3. -------------------------------------------------------------------------------------------------

static sagi_real real_dot(const sagi_real a[3], const double b[3]) {
    sagi_real sum = sagi_real_scale(a[0], b[0]);
    for (int i = 1; i < 3; i++) sum = sagi_real_add(sum, sagi_real_scale(a[i], b[i]));
    return sum;
}

static void real_apply(const sagi_quadric_form *f, const sagi_quadric_exact *q, const sagi_real v[3],
                       sagi_real out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = sagi_real_mul(q->square[i], v[i]);
        if (!f->mixed) continue;
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = sagi_real_add(
            out[i], sagi_real_add(sagi_real_mul(q->cross[k], v[j]), sagi_real_mul(q->cross[j], v[k])));
    }
}

static sagi_spans spans_between(double t0, double t1) {
    return (sagi_spans){1, {t0, INFINITY}, {t1, INFINITY}};
}

static sagi_spans spans_everywhere(bool inside) {
    return (sagi_spans){inside, {-INFINITY, INFINITY}, {INFINITY, INFINITY}};
}

// The intervals between two roots (a > 0) or beyond them (a < 0).
static sagi_spans spans_of_roots(double t0, double t1, bool between) {
    if (between) return spans_between(t0, t1);
    return (sagi_spans){2, {-INFINITY, t1}, {t0, INFINITY}};
}

static sagi_spans spans_of_line(double t, bool rising) {
    return rising ? spans_between(-INFINITY, t) : spans_between(t, INFINITY);
}

// Q o + l and F(o).
static sagi_real real_value(const sagi_quadric_form *form, const sagi_quadric_exact *q,
                            const sagi_dd origin[3], sagi_real gradient[3]) {
    sagi_real o[3], value = q->constant;
    for (int i = 0; i < 3; i++)
        o[i] = sagi_real_add(sagi_real_from(origin[i].hi), sagi_real_from(origin[i].lo));
    real_apply(form, q, o, gradient);
    for (int i = 0; i < 3; i++) {
        sagi_real l = i == 2 || form->mixed ? q->linear[i] : sagi_real_from(0);
        gradient[i] = sagi_real_add(gradient[i], l);
        value = sagi_real_add(value, sagi_real_mul(sagi_real_add(gradient[i], l), o[i]));
    }
    return value;
}

static sagi_spans solve_exactly(const sagi_quadric_form *form, const local_ray *ray) {
    sagi_quadric_exact q;
    form->exact(form->shape, &q);
    sagi_real d[3], qo[3], qd[3], c = real_value(form, &q, ray->origin, qo);
    for (int i = 0; i < 3; i++) d[i] = sagi_real_from(ray->direction[i]);
    real_apply(form, &q, d, qd);
    sagi_real a = real_dot(qd, ray->direction), b = real_dot(qo, ray->direction);
    int sign_a = sagi_real_sign(&a), sign_b = sagi_real_sign(&b);
    if (sign_a == 0) {
        if (sign_b == 0) return spans_everywhere(sagi_real_sign(&c) <= 0);
        sagi_real t = sagi_real_div(sagi_real_neg(c), sagi_real_scale(b, 2));
        return spans_of_line(sagi_real_to_double(&t), sign_b > 0);
    }
    sagi_real d2 = sagi_real_sub(sagi_real_mul(b, b), sagi_real_mul(a, c));
    if (sagi_real_sign(&d2) < 0) return spans_everywhere(sign_a < 0);
    sagi_real root = sagi_real_sqrt(d2);
    sagi_real minus_q = sign_b < 0 ? sagi_real_sub(b, root) : sagi_real_add(b, root);
    sagi_real first = sagi_real_div(sagi_real_neg(minus_q), a);
    sagi_real second = sagi_real_sign(&d2) == 0 ? first : sagi_real_div(sagi_real_neg(c), minus_q);
    double t0 = sagi_real_to_double(&first), t1 = sagi_real_to_double(&second);
    return spans_of_roots(fmin(t0, t1), fmax(t0, t1), sign_a > 0);
}

// Stage 2. -------------------------------------------------------------------------------------------------

// F at y in double-double, with its error bound, and b there in double.
static double residual(const sagi_quadric_form *f, const sagi_dd y[3], const double d[3], double *error,
                       polynomial *p) {
    double b = 0, b_sum = 0, sum = fabs(f->constant.hi);
    sagi_dd value = f->constant;
    for (int i = 0; i < 3; i++) {
        sagi_dd g = sagi_dd_mul(f->square[i], y[i]);
        double magnitude = fabs(g.hi);
        if (f->mixed) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            sagi_dd gj = sagi_dd_mul(f->cross[k], y[j]), gk = sagi_dd_mul(f->cross[j], y[k]);
            g = sagi_dd_add(g, sagi_dd_add(gj, gk));
            magnitude += fabs(gj.hi) + fabs(gk.hi);
        }
        double half = g.hi;
        if (f->mixed || i == 2) {
            half += f->linear[i].hi;
            b_sum += fabs(f->linear[i].hi * d[i]);
            magnitude += 2 * fabs(f->linear[i].hi);
            g = sagi_dd_add(g, (sagi_dd){2 * f->linear[i].hi, 2 * f->linear[i].lo});
        }
        value = sagi_dd_add(value, sagi_dd_mul(g, y[i]));
        sum += magnitude * fabs(y[i].hi);
        b += half * d[i];
        b_sum += magnitude * fabs(d[i]);
    }
    p->b = b, p->b_error = EPSILON * b_sum;
    *error = EPSILON_DD * sum;
    return value.hi;
}

// Improves the root *t, at which b must have the given sign, until it is certain to half an ulp before the
// last rounding, or certainly out of range. False when it cannot be.
static bool polish(const sagi_quadric_form *form, const local_ray *ray, const polynomial *whole, double sign,
                   double *root) {
    double t = *root;
    for (int i = 0; i < 4; i++) {
        sagi_dd y[3];
        for (int k = 0; k < 3; k++) y[k] = sagi_dd_add(ray->origin[k], sagi_two_prod(t, ray->direction[k]));
        polynomial p;
        double value_error, value = residual(form, y, ray->direction, &value_error, &p);
        double size = fabs(p.b);
        if (!(p.b * sign > 0) || !(p.b_error <= size * 0x1p-6)) return false;
        if (!((fabs(whole->a) + whole->a_error) * (fabs(value) + value_error) <= p.b * p.b * 0.25))
            return false;
        double step = -value / (p.b + copysign(sqrt(p.b * p.b - whole->a * value), p.b));
        double wide = fabs(step);
        double error = 0.75 * value_error / size + wide * (1.4 * p.b_error / size + EPSILON) +
                       0.75 * wide * wide * whole->a_error / size;
        t += step;
        bool certain = error <= SAGI_EPSILON * fabs(t) || t + error < ray->t_min || t - error > ray->t_max;
        if (!certain) continue;
        *root = t;
        return true;
    }
    return false;
}

// Stage 1. -------------------------------------------------------------------------------------------------

static bool solve_linear(const sagi_quadric_form *form, const local_ray *ray, const polynomial *p,
                         sagi_spans *spans) {
    if (p->b_error == 0) {
        *spans = spans_everywhere(p->c < 0);
        return fabs(p->c) > p->c_error;
    }
    if (!(fabs(p->b) > p->b_error)) return false;
    double t = -p->c / (2 * p->b);
    if (!polish(form, ray, p, p->b, &t)) return false;
    *spans = spans_of_line(t, p->b > 0);
    return true;
}

// Writes the spans and returns true when doubles and double-doubles can say what they are.
static bool solve(const sagi_quadric_form *form, const local_ray *ray, sagi_spans *spans) {
    double o[3] = {ray->origin[0].hi, ray->origin[1].hi, ray->origin[2].hi};
    polynomial p;
    quadratic_term(form, ray->direction, &p);
    expand_at(form, o, ray->direction, &p);
    if (p.a_error == 0 && p.a == 0) return solve_linear(form, ray, &p, spans);
    if (!(fabs(p.a) > p.a_error)) return false;
    double sign = p.a > 0 ? 1 : -1; // of F; sign·F opens upward
    *spans = spans_everywhere(p.a < 0);

    bool forward = ray->t_min >= 0;
    if (forward && sign * p.c > p.c_error && sign * p.b > p.b_error) return true; // both roots behind
    bool around = sign * p.c < -p.c_error;                                        // one behind, one ahead
    double d_error, d = discriminant(&p, &d_error);
    if (d < -d_error) return true;
    double shift = 0;
    if (!(d > SHIFT_GUARD * d_error)) {
        shift = -p.b / p.a;
        if (!isfinite(shift)) return false;
        for (int i = 0; i < 3; i++)
            o[i] = sagi_dd_add(ray->origin[i], sagi_two_prod(shift, ray->direction[i])).hi;
        expand_at(form, o, ray->direction, &p);
        d = discriminant(&p, &d_error);
        if (d < -d_error) return true;
        if (!(d > SHIFT_GUARD * d_error)) return false;
    }
    double root = sqrt(d), q = -(p.b + copysign(root, p.b));
    double ta = shift + q / p.a, tb = shift + p.c / q;
    double t0 = fmin(ta, tb), t1 = fmax(ta, tb);
    // D is known to 1/64, so √D to 1/100; the slack also covers the error of b and of the sums.
    double slack = (root * 0x1p-5 + p.b_error) / fabs(p.a) + EPSILON * fabs(shift);
    bool near = !(t0 + slack < ray->t_min || t0 - slack > ray->t_max || (forward && around));
    bool far = !(t1 + slack < ray->t_min || t1 - slack > ray->t_max);
    if (near && !polish(form, ray, &p, -sign, &t0)) return false;
    if (far && !polish(form, ray, &p, sign, &t1)) return false;
    *spans = spans_of_roots(t0, t1, p.a > 0);
    return true;
}

sagi_spans sagi_quadric_spans(const sagi_quadric_form *form, const sag_ray *ray) {
    local_ray local = localise(form, ray);
    sagi_spans spans = {0};
    double far = fmax(fabs(local.origin[0].hi), fmax(fabs(local.origin[1].hi), fabs(local.origin[2].hi)));
    if (!(far < FARTHEST)) return spans;
    if (!solve(form, &local, &spans)) spans = solve_exactly(form, &local);
    for (int i = 0; i < spans.count && local.exponent != 0; i++) {
        spans.enter[i] = ldexp(spans.enter[i], -local.exponent);
        spans.leave[i] = ldexp(spans.leave[i], -local.exponent);
    }
    return spans;
}

int sagi_quadric_sign(const sagi_quadric_form *form, sag_vec3 point) {
    const sag_ray still = {.origin = point, .direction = {1, 1, 1}};
    local_ray local = localise(form, &still);
    polynomial p;
    double error, value = residual(form, local.origin, local.direction, &error, &p);
    if (fabs(value) > error) return value > 0 ? 1 : -1;
    sagi_quadric_exact q;
    form->exact(form->shape, &q);
    sagi_real gradient[3], exact = real_value(form, &q, local.origin, gradient);
    return sagi_real_sign(&exact);
}

// Positions. -----------------------------------------------------------------------------------------------

// Newton's method along the half gradient g: F(y + δ) ≈ F + 2 g·δ, so δ = −F g/2g². What a step leaves is of
// second order. Mostly the first does; a ray from 1e9 sizes away, whose t is known to half an ulp, is 1e-7
// sizes off, and a few more steps are needed where that is not small beside the radius of curvature.
//
// The bound of the error is generous on purpose. Along the normal it must exceed the distance within which
// the filter above cannot tell inside from outside, so that a spawned ray is rejected at once: the filter's
// bound of F is 16u ΣF, the sum of magnitudes, and F grows by 2|g| along the normal, so that is 8u ΣF/|g|.
// Taken is four times as much, along each coordinate in proportion to the normal, and the roundings of the
// coordinates. To that comes what the last step was: near the apex of a cone the root of F is nearly double,
// the steps only halve the distance, and twice the last one is left. Where the gradient nearly vanishes
// elsewhere (a crease) the filter is no measure; then 2⁻⁴⁴ of the coordinates is enough. FLOOR, 2⁻¹⁶⁰ of the
// smallest size or less, is for a point that is exactly 0, all of it (the vertex of a paraboloid): the next
// double after 0 is so small that F underflows.
// Where the gradient vanishes the normal is a column of Q: right for a double plane (Q = v vᵀ), any will do
// in an apex.
#define FLOOR 0x1p-200

static void place(const sagi_quadric_form *f, sagi_dd y[3], sag_surface *surface) {
    const double center[3] = {f->center.x, f->center.y, f->center.z}, ones[3] = {1, 1, 1};
    double g[3] = {0}, magnitude[3], gg = 1, blur = 0, k = 0, position[3], error[3];
    for (int step = 0; step < 8; step++) {
        const double at[3] = {y[0].hi, y[1].hi, y[2].hi};
        polynomial unused;
        double value_error, value = residual(f, y, ones, &value_error, &unused);
        apply(f, at, g, magnitude);
        for (int i = f->mixed ? 0 : 2; i < 3; i++) g[i] += f->linear[i].hi;
        gg = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        if (!(gg > 0)) break; // the apex of a cone
        blur = 32 * SAGI_EPSILON * (value_error / EPSILON_DD) / gg;
        k = value / (2 * gg);
        for (int i = 0; i < 3; i++) y[i] = sagi_dd_add_double(y[i], -k * g[i]);
        if (fabs(k) <= blur / 64) break; // the step was below the bound's unit
    }
    double most = fmax(fabs(y[0].hi), fmax(fabs(y[1].hi), fabs(y[2].hi)));
    blur = fmin(blur, 0x1p-44 * most / sqrt(gg));
    for (int i = 0; i < 3; i++) {
        double local = ldexp(y[i].hi, f->exponent);
        position[i] = center[i] + local;
        error[i] = ldexp((blur + 4 * fabs(k)) * fabs(g[i]) + FLOOR, f->exponent) +
                   4 * SAGI_EPSILON * (fabs(local) + fabs(position[i]));
    }
    surface->position = sag_vec3_make(position[0], position[1], position[2]);
    surface->position_error = sag_vec3_make(error[0], error[1], error[2]);
    if (!(gg > 0)) {
        double size[3] = {fabs(f->square[0].hi), fabs(f->square[1].hi), fabs(f->square[2].hi)};
        int main_axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
        const double unit[3] = {main_axis == 0, main_axis == 1, main_axis == 2};
        apply(f, unit, g, magnitude);
    }
    surface->geometric_normal = sag_normalize(sag_vec3_make(g[0], g[1], g[2]));
}

void sagi_quadric_place_hit(const sagi_quadric_form *form, const sag_ray *ray, double t,
                            sag_surface *surface) {
    const sag_vec3 o = ray->origin, c = form->center, d = ray->direction;
    sagi_dd y[3] = {sagi_ray_coordinate(o.x, c.x, t, d.x), sagi_ray_coordinate(o.y, c.y, t, d.y),
                    sagi_ray_coordinate(o.z, c.z, t, d.z)};
    for (int i = 0; i < 3 && form->exponent != 0; i++)
        y[i] = (sagi_dd){ldexp(y[i].hi, -form->exponent), ldexp(y[i].lo, -form->exponent)};
    place(form, y, surface);
}

void sagi_quadric_place_point(const sagi_quadric_form *form, sag_vec3 point, sag_surface *surface) {
    const sag_ray still = {.origin = point, .direction = {1, 1, 1}};
    local_ray local = localise(form, &still);
    place(form, local.origin, surface);
}
