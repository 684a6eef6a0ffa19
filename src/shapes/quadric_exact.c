// SPDX-License-Identifier: MIT
// The quadrics' last resort: the same polynomial as in quadric_solve.c, its coefficients, discriminant and
// roots with 400 bits. Signs are those of the exact values unless the inputs' exponents lie hundreds of bits
// apart, so a tangent is a tangent, and a start on the surface is t = 0. Costs some tens of microseconds.
#include "shapes/quadric_local.h"

#define TANGENT 0x1p-370

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

sagi_spans sagi_quadric_solve_exactly(const sagi_quadric_form *form, const sagi_local_ray *ray) {
    sagi_quadric_exact q;
    form->exact(form->shape, &q);
    sagi_real d[3], qo[3], qd[3], c = real_value(form, &q, ray->origin, qo);
    for (int i = 0; i < 3; i++) d[i] = sagi_real_from(ray->direction[i]);
    real_apply(form, &q, d, qd);
    sagi_real a = real_dot(qd, ray->direction), b = real_dot(qo, ray->direction);
    int sign_a = sagi_real_sign(&a), sign_b = sagi_real_sign(&b);
    if (sign_a == 0) {
        if (sign_b == 0) return sagi_spans_everywhere(sagi_real_sign(&c) <= 0);
        sagi_real t = sagi_real_div(sagi_real_neg(c), sagi_real_scale(b, 2));
        return sagi_spans_of_line(sagi_real_to_double(&t), sign_b > 0);
    }
    sagi_real bb = sagi_real_mul(b, b), d2 = sagi_real_sub(bb, sagi_real_mul(a, c));
    // What is below the last of 400 bits is 0: a line through a cone's apex must not miss it by 2⁻³⁹⁰.
    if (fabs(sagi_real_to_double(&d2)) <= TANGENT * sagi_real_to_double(&bb)) d2 = sagi_real_from(0);
    if (sagi_real_sign(&d2) < 0) return sagi_spans_everywhere(sign_a < 0);
    sagi_real root = sagi_real_sqrt(d2);
    sagi_real minus_q = sign_b < 0 ? sagi_real_sub(b, root) : sagi_real_add(b, root);
    sagi_real first = sagi_real_div(sagi_real_neg(minus_q), a);
    sagi_real second = sagi_real_sign(&d2) == 0 ? first : sagi_real_div(sagi_real_neg(c), minus_q);
    double t0 = sagi_real_to_double(&first), t1 = sagi_real_to_double(&second);
    return sagi_spans_of_roots(fmin(t0, t1), fmax(t0, t1), sign_a > 0);
}

int sagi_quadric_sign(const sagi_quadric_form *form, sag_vec3 point) {
    const sag_ray still = {.origin = point, .direction = {1, 1, 1}};
    sagi_local_ray local = sagi_quadric_localise(form, &still);
    sagi_polynomial p;
    double error, value = sagi_quadric_residual(form, local.origin, local.direction, &error, &p);
    if (fabs(value) > error) return value > 0 ? 1 : -1;
    sagi_quadric_exact q;
    form->exact(form->shape, &q);
    sagi_real gradient[3], exact = real_value(form, &q, local.origin, gradient);
    return sagi_real_sign(&exact);
}
