// SPDX-License-Identifier: MIT
// Four rays from one point and one closed quadric: the steps of outline.h, every number of a ray being a
// vector of which each lane is a ray of its own; what depends on the origin alone is worked out once. The
// operations are the same in the same order, and so are the bits of the answers. Where outline.h takes a
// second polishing step, and for rays along the planes of the caps, the answer is "unknown" here.
#ifndef SAGI_SHAPES_OUTLINE_FOUR_H
#define SAGI_SHAPES_OUTLINE_FOUR_H

#include "math/dd_four.h"
#include "shapes/outline.h"

// What depends on the shape and the origin.
typedef struct sagi_outline_origin {
    const sagi_outline *outline;
    sag_vec3 at;
    double t_min;
    sagi_dd origin[3];           // from the form's centre
    double g[3], g_magnitude[3]; // of b = g·d
    double c, c_error;
    bool usual;
} sagi_outline_origin;

static inline sagi_outline_origin sagi_outline_origin_make(const sagi_outline *outline, sag_vec3 at,
                                                           double t_min) {
    const sagi_quadric_form *form = &outline->form;
    const sag_vec3 center = form->center;
    sagi_outline_origin o = {.outline = outline, .at = at, .t_min = t_min};
    o.origin[0] = sagi_two_sum(at.x, -center.x), o.origin[1] = sagi_two_sum(at.y, -center.y);
    o.origin[2] = sagi_two_sum(at.z, -center.z);
    const double y[3] = {o.origin[0].hi, o.origin[1].hi, o.origin[2].hi};
    o.usual = fabs(y[0]) + fabs(y[1]) + fabs(y[2]) < SAGI_QUADRIC_FARTHEST;
    sagi_quadric_apply(form, y, o.g, o.g_magnitude);
    // As sagi_quadric_expand has it: only along z there is a linear term.
    const double l = form->linear[2].hi;
    double c = form->constant.hi, c_sum = fabs(c);
    o.g[2] += l, o.g_magnitude[2] += fabs(l);
    c += l * y[2], c_sum += fabs(l * y[2]);
    for (int i = 0; i < 3; i++) c += o.g[i] * y[i], c_sum += o.g_magnitude[i] * fabs(y[i]);
    o.c = c, o.c_error = SAGI_QUADRIC_EPSILON * c_sum;
    return o;
}

typedef struct sagi_outline_four {
    sagi_d4 d[3], t_max;  // of the rays
    sagi_d4 t, primitive; // of what is found
    sagi_d4 a, a_error, coarse, slack, cut_enter, cut_leave, cut_cap;
    sagi_l4 hit, unknown;
} sagi_outline_four;

SAGI_INLINE sagi_d4 sagi_d4_copysign(sagi_d4 size, sagi_d4 sign) {
    const sagi_l4 bit = sagi_l4_fill(INT64_MIN);
    return (sagi_d4)(((sagi_l4)size & ~bit) | ((sagi_l4)sign & bit));
}

// sagi_quadric_polish, one step: where the root is certain then.
SAGI_INLINE sagi_l4 sagi_outline_polish4(const sagi_outline_origin *o, const sagi_outline_four *r,
                                         sagi_d4 sign, sagi_d4 *root) {
    const sagi_quadric_form *f = &o->outline->form;
    sagi_dd4 value = sagi_dd4_fill(f->constant);
    sagi_d4 b = sagi_d4_fill(0), b_sum = b, sum = sagi_d4_fill(fabs(f->constant.hi));
    for (int i = 0; i < 3; i++) {
        sagi_dd4 y = sagi_dd4_add(sagi_dd4_fill(o->origin[i]), sagi_two_prod4(*root, r->d[i]));
        sagi_dd4 g = sagi_dd4_mul(sagi_dd4_fill(f->square[i]), y);
        sagi_d4 magnitude = sagi_d4_abs(g.hi), half = g.hi;
        if (i == 2) {
            const sagi_dd l = f->linear[i];
            half += sagi_d4_fill(l.hi);
            b_sum += sagi_d4_abs(sagi_d4_fill(l.hi) * r->d[i]);
            magnitude += sagi_d4_fill(2 * fabs(l.hi));
            g = sagi_dd4_add(g, sagi_dd4_fill((sagi_dd){2 * l.hi, 2 * l.lo}));
        }
        value = sagi_dd4_add(value, sagi_dd4_mul(g, y));
        sum += magnitude * sagi_d4_abs(y.hi);
        b += half * r->d[i];
        b_sum += magnitude * sagi_d4_abs(r->d[i]);
    }
    const sagi_d4 b_error = SAGI_QUADRIC_EPSILON * b_sum, value_error = SAGI_QUADRIC_EPSILON_DD * sum,
                  size = sagi_d4_abs(b), v = value.hi;
    const sagi_l4 good =
        sagi_d4_above(b * sign, 0) & sagi_d4_at_most(b_error, size * 0x1p-6) &
        sagi_d4_at_most((sagi_d4_abs(r->a) + r->a_error) * (sagi_d4_abs(v) + value_error), b * b * 0.25);
    sagi_d4 step = -v / (b + sagi_d4_copysign(sagi_d4_sqrt(b * b - r->a * v), b)), wide = sagi_d4_abs(step);
    sagi_d4 error = 0.75 * value_error / size + wide * (1.4 * b_error / size + SAGI_QUADRIC_EPSILON) +
                    0.75 * wide * wide * r->a_error / size;
    *root += step;
    return good & sagi_d4_at_most(error, SAGI_EPSILON * sagi_d4_abs(*root));
}

// sagi_first_of_interval, of the lanes in `left`.
SAGI_INLINE void sagi_outline_interval4(const sagi_outline_origin *o, sagi_outline_four *r, sagi_l4 left,
                                        sagi_d4 enter, sagi_d4 leave, sagi_d4 sign) {
    const sagi_d4 slack = r->slack, first = r->cut_enter, last = r->cut_leave, t_max = r->t_max;
    const sagi_d4 t_min = sagi_d4_fill(o->t_min);
    left &=
        ~(sagi_d4_less(last, first) | sagi_d4_less(leave + slack, first) | sagi_d4_less(last, enter - slack));
    left &= ~(sagi_d4_less(leave + slack, t_min) | sagi_d4_less(last, t_min));
    sagi_l4 cap = left & sagi_d4_less(enter + slack, first), curved = left & ~cap;
    sagi_l4 sure = sagi_d4_less(first, leave - slack) & sagi_d4_at_most(t_min, first);
    r->unknown |= cap & ~sure;
    cap &= sure & sagi_d4_at_most(first, t_max) & sagi_d4_below(sagi_d4_abs(first), INFINITY);
    r->hit |= cap;
    r->t = sagi_d4_select(cap, first, r->t), r->primitive = sagi_d4_select(cap, r->cut_cap, r->primitive);
    sure = sagi_d4_less(first, enter - slack) & sagi_d4_less(enter + slack, last);
    r->unknown |= curved & ~sure;
    curved &= sure & ~sagi_d4_less(t_max, enter - slack);
    if (sagi_d4_signs((sagi_d4)curved) == 0) return;
    sagi_d4 root = enter;
    sure = sagi_outline_polish4(o, r, sign, &root) & sagi_d4_at_most(t_min, root);
    r->unknown |= curved & ~sure;
    curved &= sure & sagi_d4_at_most(root, t_max);
    r->hit |= curved;
    r->t = sagi_d4_select(curved, root, r->t);
    r->primitive = sagi_d4_select(curved, sagi_d4_fill(SAGI_CURVED), r->primitive);
}

// sagi_first_nappe: where the interval is of the nappe below the apex; *known: where that is certain.
SAGI_INLINE sagi_l4 sagi_outline_below4(const sagi_outline_origin *o, const sagi_outline_four *r,
                                        sagi_d4 enter, sagi_d4 leave, sagi_l4 *known) {
    const sagi_d4 up = r->d[2], step = (enter * 0.5 + leave * 0.5) * up;
    const double apex = o->outline->form.center.z;
    const sagi_d4 middle = sagi_d4_fill(o->at.z - apex) + step;
    const sagi_d4 doubt = r->slack * sagi_d4_abs(up) +
                          8 * SAGI_EPSILON * (sagi_d4_fill(fabs(o->at.z) + fabs(apex)) + sagi_d4_abs(step));
    const sagi_l4 last = sagi_d4_at_most(sagi_d4_fill(INFINITY), leave),
                  first = sagi_d4_at_most(enter, sagi_d4_fill(-INFINITY)),
                  under = sagi_d4_less(middle, -doubt);
    *known = last | first | under | sagi_d4_less(doubt, middle);
    return (last & sagi_d4_below(up, 0)) | (~last & first & sagi_d4_above(up, 0)) | (~last & ~first & under);
}

// sagi_outline_first for those lanes: `hit` is where t and primitive are, `unknown` where to ask again.
SAGI_INLINE void sagi_outline_first4(const sagi_outline_origin *o, sagi_outline_four *r, sagi_l4 lanes) {
    const sagi_outline *outline = o->outline;
    const sagi_quadric_form *form = &outline->form;
    const sagi_l4 nothing = {0, 0, 0, 0};
    const sagi_d4 zero = sagi_d4_fill(0);
    sagi_d4 size[3], magnitude[3], qd[3];
    for (int i = 0; i < 3; i++) {
        size[i] = sagi_d4_abs(r->d[i]);
        qd[i] = sagi_d4_fill(form->square[i].hi) * r->d[i], magnitude[i] = sagi_d4_abs(qd[i]);
    }
    const sagi_d4 largest = sagi_d4_max(sagi_d4_max(size[0], size[1]), size[2]);
    const sagi_d4 a = r->a = qd[0] * r->d[0] + qd[1] * r->d[1] + qd[2] * r->d[2];
    const sagi_d4 a_error = r->a_error =
        SAGI_QUADRIC_EPSILON * (magnitude[0] * size[0] + magnitude[1] * size[1] + magnitude[2] * size[2]);
    sagi_d4 b = zero, b_sum = zero;
    for (int i = 0; i < 3; i++)
        b += sagi_d4_fill(o->g[i]) * r->d[i], b_sum += sagi_d4_fill(o->g_magnitude[i]) * size[i];
    const sagi_d4 b_error = SAGI_QUADRIC_EPSILON * b_sum;
    const sagi_d4 c = sagi_d4_fill(o->c), c_error = sagi_d4_fill(o->c_error);
    sagi_d4 bb = b * b, ac = a * c, d = bb - ac;
    sagi_d4 d_error = (2 * sagi_d4_abs(b) + b_error) * b_error + sagi_d4_abs(c) * a_error +
                      (sagi_d4_abs(a) + a_error) * c_error + 4 * SAGI_EPSILON * (bb + sagi_d4_abs(ac));
    r->hit = nothing;
    sagi_l4 left = lanes, usual = sagi_d4_above(largest, 0x1p-60) & sagi_d4_below(largest, 0x1p60) &
                                  sagi_d4_less(a_error, sagi_d4_abs(a));
    if (!o->usual) usual = nothing;
    const sagi_l4 positive = sagi_d4_above(a, 0);
    const sagi_d4 sign = sagi_d4_select(positive, sagi_d4_fill(1), sagi_d4_fill(-1));
    sagi_l4 missed = sagi_d4_less(d, -d_error);
    if (o->t_min >= 0) missed |= sagi_d4_less(c_error, sign * c) & sagi_d4_less(b_error, sign * b);
    // Certainly missed, or not known, or it goes on.
    r->unknown =
        left & (~usual | (missed & ~positive) | (~missed & ~sagi_d4_less(SAGI_QUADRIC_GUARD * d_error, d)));
    left &= ~r->unknown & ~missed;
    if (sagi_d4_signs((sagi_d4)left) == 0) return;

    const sagi_d4 root = sagi_d4_sqrt(d), q = -(b + sagi_d4_copysign(root, b));
    const sagi_d4 ta = 0 + q / a, tb = 0 + c / q;
    const sagi_l4 sooner = sagi_d4_less(ta, tb);
    const sagi_d4 t0 = sagi_d4_select(sooner, ta, tb), t1 = sagi_d4_select(sooner, tb, ta);
    r->coarse = (root * 0x1p-5 + b_error) / sagi_d4_abs(a);
    const sagi_d4 far = sagi_d4_max(sagi_d4_abs(t0), sagi_d4_abs(t1));
    const sagi_d4 fine = ((a_error * far + 2 * b_error) * far + c_error) / root + 0x1p-50 * far;
    r->slack =
        sagi_d4_select(sagi_d4_less(64 * a_error, sagi_d4_abs(a)), sagi_d4_min(fine, r->coarse), r->coarse);
    const sagi_d4 low = sagi_d4_fill(outline->z_min - o->at.z) / r->d[2],
                  high = sagi_d4_fill(outline->z_max - o->at.z) / r->d[2];
    const sagi_l4 up = sagi_d4_above(r->d[2], 0);
    r->cut_enter = sagi_d4_select(up, low, high), r->cut_leave = sagi_d4_select(up, high, low);
    r->cut_cap = sagi_d4_select(up, sagi_d4_fill(SAGI_CAP_LOW), sagi_d4_fill(SAGI_CAP_HIGH));
    const sagi_l4 finite = sagi_d4_below(sagi_d4_abs(t0), INFINITY) &
                           sagi_d4_below(sagi_d4_abs(t1), INFINITY) & sagi_d4_below(r->slack, INFINITY) &
                           sagi_d4_above(sagi_d4_abs(r->d[2]), 0);
    r->unknown |= left & ~finite;
    left &= finite;
    for (int i = 0; i < 2; i++) {
        const sagi_d4 never = sagi_d4_fill(INFINITY);
        const sagi_d4 enter = i == 0 ? sagi_d4_select(positive, t0, -never) : t1;
        const sagi_d4 leave = i == 0 ? sagi_d4_select(positive, t1, t0) : never;
        sagi_l4 here = left;
        if (outline->below) {
            sagi_l4 known, below = sagi_outline_below4(o, r, enter, leave, &known);
            r->unknown |= here & ~known;
            here &= known & below;
        }
        sagi_outline_interval4(o, r, here, enter, leave, i == 0 ? -sign : sign);
        left &= ~positive & ~r->hit & ~r->unknown;
        if (sagi_d4_signs((sagi_d4)left) == 0) return;
    }
}

#endif
