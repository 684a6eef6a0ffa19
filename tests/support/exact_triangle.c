// SPDX-License-Identifier: MIT
#include "support/exact_triangle.h"
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

// Few bits first, because they do for most; many when MPFR says that something was rounded; and so many on a
// tie that ε³ = 2⁻⁴⁵⁰⁰ fits beside the rest.
enum { FEW, MANY, TIE, WORKSPACE_COUNT };
static const mpfr_prec_t precision_bits[WORKSPACE_COUNT] = {640, 5000, 16000};
#define EPSILON_EXPONENT (-1500)

typedef struct exact3 {
    mpfr_t x[3];
} exact3;

typedef struct workspace {
    bool ready;
    exact3 o, d, a, b, c, moment, n;
    mpfr_t e[3], product, t, denominator, ulp;
} workspace;

static void init3(exact3 *v, mpfr_prec_t bits) {
    for (int i = 0; i < 3; i++) mpfr_init2(v->x[i], bits);
}

static void clear3(exact3 *v) {
    for (int i = 0; i < 3; i++) mpfr_clear(v->x[i]);
}

static void workspace_init(workspace *w, mpfr_prec_t bits) {
    exact3 *vectors[] = {&w->o, &w->d, &w->a, &w->b, &w->c, &w->moment, &w->n};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) init3(vectors[i], bits);
    for (int i = 0; i < 3; i++) mpfr_init2(w->e[i], bits);
    mpfr_inits2(bits, w->product, w->t, w->denominator, w->ulp, (mpfr_ptr)0);
    w->ready = true;
}

static void workspace_clear(workspace *w) {
    if (!w->ready) return;
    exact3 *vectors[] = {&w->o, &w->d, &w->a, &w->b, &w->c, &w->moment, &w->n};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) clear3(vectors[i]);
    for (int i = 0; i < 3; i++) mpfr_clear(w->e[i]);
    mpfr_clears(w->product, w->t, w->denominator, w->ulp, (mpfr_ptr)0);
    w->ready = false;
}

static workspace spaces[WORKSPACE_COUNT];

void exact_triangle_end(void) {
    for (int i = 0; i < WORKSPACE_COUNT; i++) workspace_clear(&spaces[i]);
    mpfr_free_cache();
}

static void set3(exact3 *v, sag_vec3 a) {
    mpfr_set_d(v->x[0], a.x, MPFR_RNDN);
    mpfr_set_d(v->x[1], a.y, MPFR_RNDN);
    mpfr_set_d(v->x[2], a.z, MPFR_RNDN);
}

static void subtract3(exact3 *a, const exact3 *b) {
    for (int i = 0; i < 3; i++) mpfr_sub(a->x[i], a->x[i], b->x[i], MPFR_RNDN);
}

static void cross3(workspace *w, exact3 *r, const exact3 *a, const exact3 *b) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpfr_mul(r->x[i], a->x[j], b->x[k], MPFR_RNDN);
        mpfr_mul(w->product, a->x[k], b->x[j], MPFR_RNDN);
        mpfr_sub(r->x[i], r->x[i], w->product, MPFR_RNDN);
    }
}

static void dot3(workspace *w, mpfr_t r, const exact3 *a, const exact3 *b) {
    mpfr_mul(r, a->x[0], b->x[0], MPFR_RNDN);
    for (int i = 1; i < 3; i++) {
        mpfr_mul(w->product, a->x[i], b->x[i], MPFR_RNDN);
        mpfr_add(r, r, w->product, MPFR_RNDN);
    }
}

// The edge functions of the line, with the origin moved when `epsilon` is not 0: det(d, a − o, b − o) as it
// is defined.
static void edge_functions(workspace *w, const sag_ray *ray, sag_vec3 a, sag_vec3 b, sag_vec3 c,
                           int epsilon) {
    set3(&w->o, ray->origin);
    set3(&w->d, ray->direction);
    for (int i = 0; i < 3 && epsilon != 0; i++) {
        mpfr_set_ui_2exp(w->product, 1, (mpfr_exp_t)epsilon * (i + 1), MPFR_RNDN);
        mpfr_add(w->o.x[i], w->o.x[i], w->product, MPFR_RNDN);
    }
    exact3 *vertex[3] = {&w->a, &w->b, &w->c};
    set3(&w->a, a);
    set3(&w->b, b);
    set3(&w->c, c);
    for (int i = 0; i < 3; i++) subtract3(vertex[i], &w->o);
    for (int i = 0; i < 3; i++) { // e[i]: the edge across from vertex i
        cross3(w, &w->moment, vertex[(i + 1) % 3], vertex[(i + 2) % 3]);
        dot3(w, w->e[i], &w->d, &w->moment);
    }
}

static int common_sign(workspace *w) {
    int s = mpfr_sgn(w->e[0]);
    return s == mpfr_sgn(w->e[1]) && s == mpfr_sgn(w->e[2]) ? s : 0;
}

static bool was_exact(void) { return !mpfr_inexflag_p() && !mpfr_underflow_p() && !mpfr_overflow_p(); }

static workspace *workspace_at(int i) {
    if (!spaces[i].ready) workspace_init(&spaces[i], precision_bits[i]);
    return &spaces[i];
}

// How far t is from the true value, in units of its last place.
static double error_ulp(workspace *w, double t) {
    mpfr_sub_d(w->product, w->t, t, MPFR_RNDN);
    if (mpfr_zero_p(w->product)) return 0;
    if (mpfr_zero_p(w->t)) return INFINITY;
    mpfr_set_ui_2exp(w->ulp, 1, mpfr_get_exp(w->t) - 53, MPFR_RNDN);
    mpfr_div(w->product, w->product, w->ulp, MPFR_RNDN);
    return fabs(mpfr_get_d(w->product, MPFR_RNDN));
}

// False when the bits of workspace `i` do not suffice.
static bool examine(int i, const sag_ray *ray, sag_vec3 a, sag_vec3 b, sag_vec3 c, double t,
                    exact_triangle *r) {
    workspace *w = workspace_at(i);
    mpfr_clear_flags();
    edge_functions(w, ray, a, b, c, 0);
    if (!was_exact()) return false;
    r->side = common_sign(w);
    r->tie = mpfr_zero_p(w->e[0]) || mpfr_zero_p(w->e[1]) || mpfr_zero_p(w->e[2]);
    if (r->tie) {
        edge_functions(workspace_at(TIE), ray, a, b, c, EPSILON_EXPONENT);
        r->side = common_sign(workspace_at(TIE));
    }
    if (r->side == 0) return was_exact();

    // t = det(a − o, b − o, c − o)/D with D the sum of the edge functions, u and v theirs over D.
    mpfr_add(w->denominator, w->e[0], w->e[1], MPFR_RNDN);
    mpfr_add(w->denominator, w->denominator, w->e[2], MPFR_RNDN);
    cross3(w, &w->n, &w->b, &w->c);
    dot3(w, w->t, &w->a, &w->n);
    if (!was_exact()) return false;
    mpfr_div(w->t, w->t, w->denominator, MPFR_RNDN);
    mpfr_div(w->e[1], w->e[1], w->denominator, MPFR_RNDN);
    mpfr_div(w->e[2], w->e[2], w->denominator, MPFR_RNDN);
    r->t = mpfr_get_d(w->t, MPFR_RNDN);
    r->u = mpfr_get_d(w->e[1], MPFR_RNDN);
    r->v = mpfr_get_d(w->e[2], MPFR_RNDN);
    r->t_error_ulp = error_ulp(w, t);
    return true;
}

exact_triangle exact_triangle_examine(const sag_ray *ray, sag_vec3 a, sag_vec3 b, sag_vec3 c, double t) {
    exact_triangle r = {0};
    if (examine(FEW, ray, a, b, c, t, &r)) return r;
    r = (exact_triangle){0};
    if (examine(MANY, ray, a, b, c, t, &r)) return r;
    fprintf(stderr, "exact_triangle: not enough bits\n");
    abort();
}
