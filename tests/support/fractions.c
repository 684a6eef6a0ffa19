// SPDX-License-Identifier: MIT
#include "support/fractions.h"

void fraction3_init(fraction3 v) { mpq_inits(v[0], v[1], v[2], NULL); }
void fraction3_clear(fraction3 v) { mpq_clears(v[0], v[1], v[2], NULL); }

void fraction3_set(fraction3 out, sag_vec3 v) {
    for (int i = 0; i < 3; i++) mpq_set_d(out[i], sag_component(v, i));
}

void fraction3_set_diff(fraction3 out, sag_vec3 a, sag_vec3 b) {
    fraction3 w;
    fraction3_init(w);
    fraction3_set(out, a), fraction3_set(w, b);
    for (int i = 0; i < 3; i++) mpq_sub(out[i], out[i], w[i]);
    fraction3_clear(w);
}

void fraction3_dot(mpq_t out, fraction3 a, fraction3 b) {
    mpq_t x, sum;
    mpq_inits(x, sum, NULL);
    for (int i = 0; i < 3; i++) mpq_mul(x, a[i], b[i]), mpq_add(sum, sum, x);
    mpq_set(out, sum);
    mpq_clears(x, sum, NULL);
}

void fraction3_cross(fraction3 out, fraction3 a, fraction3 b) {
    mpq_t x;
    mpq_init(x);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpq_mul(out[i], a[j], b[k]), mpq_mul(x, a[k], b[j]);
        mpq_sub(out[i], out[i], x);
    }
    mpq_clear(x);
}

void fraction_clip_init(fraction_clip *c) {
    mpq_inits(c->enter, c->leave, c->t, NULL);
    fraction_clip_reset(c);
}

void fraction_clip_clear(fraction_clip *c) { mpq_clears(c->enter, c->leave, c->t, NULL); }

void fraction_clip_reset(fraction_clip *c) { c->has_enter = c->has_leave = c->empty = false; }

void fraction_clip_by(fraction_clip *c, mpq_t num, mpq_t den) {
    if (mpq_sgn(den) == 0) {
        c->empty |= mpq_sgn(num) < 0;
        return;
    }
    mpq_div(c->t, num, den);
    if (mpq_sgn(den) > 0) {
        if (!c->has_leave || mpq_cmp(c->t, c->leave) < 0) mpq_set(c->leave, c->t);
        c->has_leave = true;
    } else {
        if (!c->has_enter || mpq_cmp(c->t, c->enter) > 0) mpq_set(c->enter, c->t);
        c->has_enter = true;
    }
}

void fraction_clip_add(fraction_clip *c, const sag_ray *ray, crossing_truth *truth) {
    if (c->empty || (c->has_enter && c->has_leave && mpq_cmp(c->enter, c->leave) > 0)) return;
    if (c->has_enter) crossing_truth_add_fraction(truth, ray, c->enter);
    if (c->has_leave) crossing_truth_add_fraction(truth, ray, c->leave);
}
