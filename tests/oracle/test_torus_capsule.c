// SPDX-License-Identifier: MIT
// Torus and capsule against MPFR (600 bits), at sizes from 1e-9 to 1e9. The torus' roots are counted by
// Sturm's theorem and then bisected, an algorithm the library does not use; the capsule's two crossings are
// the ends of the union of three exact intervals.
#include "support/adversarial.h"
#include "support/crossing_truth.h"
#include <mpfr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define BITS 600
#define RN   MPFR_RNDN

typedef struct poly {
    int degree;
    mpfr_t c[5];
} poly;

// The Sturm chain of a quartic, and room to work.
typedef struct chain {
    poly p[5];
    int count;
    bool multiple;  // a multiple root, or one to 300 bits
    bool starts_on; // the ray's origin is exactly on the torus
    mpfr_t x, y, z, low, high, o[3], d[3], k, q, r4;
    double t0; // t = t0 + s 2^-length
    int length;
} chain;

static void chain_init(chain *w) {
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 5; k++) mpfr_init2(w->p[i].c[k], BITS);
    for (int i = 0; i < 3; i++) mpfr_init2(w->o[i], BITS), mpfr_init2(w->d[i], BITS);
    mpfr_inits2(BITS, w->x, w->y, w->z, w->low, w->high, w->k, w->q, w->r4, NULL);
}

static void chain_clear(chain *w) {
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 5; k++) mpfr_clear(w->p[i].c[k]);
    for (int i = 0; i < 3; i++) mpfr_clear(w->o[i]), mpfr_clear(w->d[i]);
    mpfr_clears(w->x, w->y, w->z, w->low, w->high, w->k, w->q, w->r4, NULL);
    mpfr_free_cache();
}

// out += u · v · m
static void add_product(chain *w, mpfr_t out, mpfr_t u, mpfr_t v, long m) {
    mpfr_mul(w->x, u, v, RN), mpfr_mul_si(w->x, w->x, m, RN), mpfr_add(out, out, w->x, RN);
}

// The quartic in s of (|p|² + K)² − 4R²(x² + y²), p = o + (t0 + s 2^-length) d, expanded term by term, all
// lengths by 2^-size.
static void set_quartic(chain *w, const sag_torus *torus, const sag_ray *ray, double t0, int length,
                        int size) {
    poly *f = &w->p[0];
    poly *g = &w->p[1]; // |p|² + K for now, and w->p[2]: x² + y²
    for (int k = 0; k < 5; k++)
        mpfr_set_zero(f->c[k], 1), mpfr_set_zero(g->c[k], 1), mpfr_set_zero(w->p[2].c[k], 1);
    for (int i = 0; i < 3; i++) {
        mpfr_set_d(w->d[i], sag_component(ray->direction, i), RN);
        mpfr_mul_d(w->o[i], w->d[i], t0, RN), mpfr_add_d(w->o[i], w->o[i], sag_component(ray->origin, i), RN);
        mpfr_mul_2si(w->o[i], w->o[i], -size, RN), mpfr_mul_2si(w->d[i], w->d[i], -size - length, RN);
        for (int which = 1; which <= (i < 2 ? 2 : 1); which++) {
            add_product(w, w->p[which].c[0], w->o[i], w->o[i], 1);
            add_product(w, w->p[which].c[1], w->o[i], w->d[i], 2);
            add_product(w, w->p[which].c[2], w->d[i], w->d[i], 1);
        }
    }
    mpfr_set_d(w->k, torus->major_radius, RN), mpfr_mul_2si(w->k, w->k, -size, RN);
    mpfr_set_d(w->q, torus->minor_radius, RN), mpfr_mul_2si(w->q, w->q, -size, RN);
    add_product(w, g->c[0], w->k, w->k, 1), add_product(w, g->c[0], w->q, w->q, -1);
    mpfr_sqr(w->r4, w->k, RN), mpfr_mul_si(w->r4, w->r4, 4, RN);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) add_product(w, f->c[i + j], g->c[i], g->c[j], 1);
        add_product(w, f->c[i], w->r4, w->p[2].c[i], -1);
    }
    f->degree = 4;
}

static void set_chain(chain *w) {
    poly *f = &w->p[0], *g = &w->p[1];
    g->degree = 3;
    for (int k = 1; k <= 4; k++) mpfr_mul_si(g->c[k - 1], f->c[k], k, RN);
    for (w->count = 2; w->count < 5; w->count++) {
        // The next is minus the remainder of the last two.
        poly *a = &w->p[w->count - 2], *b = &w->p[w->count - 1], *r = &w->p[w->count];
        long exponent = -1000000;
        for (int k = 0; k <= a->degree; k++) {
            mpfr_set(r->c[k], a->c[k], RN);
            if (!mpfr_zero_p(a->c[k]) && mpfr_get_exp(a->c[k]) > exponent) exponent = mpfr_get_exp(a->c[k]);
        }
        for (int k = a->degree; k >= b->degree; k--) {
            mpfr_div(w->y, r->c[k], b->c[b->degree], RN);
            for (int j = 0; j <= b->degree; j++)
                mpfr_mul(w->x, w->y, b->c[j], RN),
                    mpfr_sub(r->c[k - b->degree + j], r->c[k - b->degree + j], w->x, RN);
        }
        r->degree = b->degree - 1;
        for (int k = 0; k <= r->degree; k++) mpfr_neg(r->c[k], r->c[k], RN);
        mpfr_ptr lead = r->c[r->degree];
        w->multiple = mpfr_zero_p(lead) || mpfr_get_exp(lead) < exponent - 300;
        if (w->multiple) return;
        if (r->degree == 0) {
            w->count++;
            break;
        }
    }
}

static int sign_at(chain *w, const poly *p, mpfr_t t) {
    mpfr_set(w->z, p->c[p->degree], RN);
    for (int k = p->degree - 1; k >= 0; k--) mpfr_mul(w->z, w->z, t, RN), mpfr_add(w->z, w->z, p->c[k], RN);
    return mpfr_sgn(w->z);
}

static int changes_at(chain *w, mpfr_t t) {
    int changes = 0, before = 0;
    for (int i = 0; i < w->count; i++) {
        int sign = sign_at(w, &w->p[i], t);
        if (sign != 0 && before != 0 && sign != before) changes++;
        if (sign != 0) before = sign;
    }
    return changes;
}

// Every root between low and high, by halving; changes_low − changes_high of them.
static void isolate(chain *w, mpfr_t low, mpfr_t high, int changes_low, int changes_high, int depth,
                    const sag_ray *ray, crossing_truth *truth) {
    if (changes_low == changes_high || depth > 500) return;
    mpfr_t middle;
    mpfr_init2(middle, BITS);
    if (changes_low - changes_high == 1) {
        // A start exactly on the torus: t = 0 is a root, and halving would only come near it.
        mpfr_set_d(w->x, -w->t0, RN), mpfr_mul_2si(w->x, w->x, w->length, RN);
        if (w->starts_on && mpfr_cmp(w->x, low) > 0 && mpfr_cmp(w->x, high) <= 0) {
            crossing_truth_add(truth, ray, 0);
            mpfr_clear(middle);
            return;
        }
        // Just above low, which may be a root that belongs to the interval before.
        int sign_low = sign_at(w, &w->p[0], low);
        if (sign_low == 0) sign_low = sign_at(w, &w->p[1], low);
        for (int i = 0; i < 500; i++) {
            mpfr_add(middle, low, high, RN), mpfr_div_2ui(middle, middle, 1, RN);
            int sign = sign_at(w, &w->p[0], middle);
            if (sign == 0) break;
            if (sign == sign_low)
                mpfr_set(low, middle, RN);
            else
                mpfr_set(high, middle, RN);
            // Narrow enough beside t itself, which may be much smaller than s.
            mpfr_sub(w->y, high, low, RN), mpfr_mul_2si(w->y, w->y, -w->length, RN);
            mpfr_mul_2si(w->x, middle, -w->length, RN), mpfr_add_d(w->x, w->x, w->t0, RN);
            if (!mpfr_zero_p(w->x) && mpfr_get_exp(w->y) < mpfr_get_exp(w->x) - 70) break;
        }
        mpfr_mul_2si(middle, middle, -w->length, RN), mpfr_add_d(middle, middle, w->t0, RN);
        crossing_truth_add(truth, ray, mpfr_get_ld(middle, RN));
    } else {
        mpfr_t end;
        mpfr_init2(end, BITS);
        mpfr_set(end, high, RN);
        mpfr_add(middle, low, high, RN), mpfr_div_2ui(middle, middle, 1, RN);
        int changes = changes_at(w, middle);
        mpfr_set(high, middle, RN);
        isolate(w, low, high, changes_low, changes, depth + 1, ray, truth);
        isolate(w, middle, end, changes, changes_high, depth + 1, ray, truth);
        mpfr_clear(end);
    }
    mpfr_clear(middle);
}

// Whether the point is exactly on the torus: (ρ² + R² − r²)² = 4R²(x² + y²), without a rounding.
static bool is_on(chain *w, const sag_torus *torus, sag_vec3 p) {
    const double squares[5] = {p.x, p.y, p.z, torus->major_radius, torus->minor_radius};
    mpfr_set_zero(w->x, 1), mpfr_set_zero(w->y, 1);
    for (int i = 0; i < 5; i++) {
        mpfr_set_d(w->z, squares[i], RN), mpfr_sqr(w->z, w->z, RN);
        if (i < 2) mpfr_add(w->y, w->y, w->z, RN);
        (i < 4 ? mpfr_add : mpfr_sub)(w->x, w->x, w->z, RN);
    }
    mpfr_sqr(w->x, w->x, RN);
    mpfr_mul_d(w->y, w->y, 2 * torus->major_radius, RN), mpfr_mul_d(w->y, w->y, 2 * torus->major_radius, RN);
    return mpfr_equal_p(w->x, w->y);
}

// False for a multiple root, which Sturm's theorem counts once (unit/test_torus.c has those).
static bool solve_torus(chain *w, const sag_torus *torus, const sag_ray *ray, crossing_truth *truth) {
    // Only rays that come near the ball around it; and the interval of t in twice that ball.
    double reach = 2 * (torus->major_radius + torus->minor_radius);
    sag_vec3 o = ray->origin, d = ray->direction;
    long double dd = 0, od = 0, off = 0;
    for (int i = 0; i < 3; i++) {
        long double oi = sag_component(o, i), di = sag_component(d, i);
        dd += di * di, od += oi * di;
    }
    w->t0 = (double)(-od / dd), w->length = ilogb((double)sqrtl(dd)) - ilogb(reach);
    for (int i = 0; i < 3; i++) {
        long double p = sag_component(o, i) + w->t0 * (long double)sag_component(d, i);
        off += p * p;
    }
    if (off > (long double)reach * reach) return true;
    set_quartic(w, torus, ray, w->t0, w->length, ilogb(reach));
    set_chain(w);
    if (w->multiple) return false;
    w->starts_on = is_on(w, torus, o);
    mpfr_set_d(w->low, -4, RN), mpfr_set_d(w->high, 4, RN);
    int a = changes_at(w, w->low), b = changes_at(w, w->high);
    isolate(w, w->low, w->high, a, b, 0, ray, truth);
    return true;
}

typedef struct tally {
    size_t rays, crossings, wrong;
    double worst;
} tally;

static void take(tally *t, const char *name, const crossing_truth *truth, const sag_hit *hits, size_t count,
                 const sag_ray *ray, const double shape[7]) {
    double ulps = crossing_truth_compare(truth, hits, count);
    t->rays++, t->crossings += count;
    if (!(ulps <= 4) && t->wrong++ < 5) {
        print_message(
            "%s %a %a %a %a %a %a %a: ray %a %a %a  %a %a %a  [%a, %a]: %zu found, %d expected, %g ulp\n",
            name, shape[0], shape[1], shape[2], shape[3], shape[4], shape[5], shape[6], ray->origin.x,
            ray->origin.y, ray->origin.z, ray->direction.x, ray->direction.y, ray->direction.z, ray->t_min,
            ray->t_max, count, truth->count, ulps);
        for (size_t i = 0; i < count; i++) print_message("  found %.17g\n", hits[i].t);
        for (int i = 0; i < truth->count; i++)
            print_message("  truth %.17Lg%s\n", truth->t[i], truth->optional[i] ? "?" : "");
    }
    if (ulps > t->worst && isfinite(ulps)) t->worst = ulps;
}

static void report(const char *name, const tally *t) {
    print_message("%s: %zu rays, %zu crossings, wrong decisions %zu, largest error of t %.2f ulp\n", name,
                  t->rays, t->crossings, t->wrong, t->worst);
    assert_int_equal(t->wrong, 0);
    assert_true(t->worst <= 4);
}

static void tori(void **state) {
    (void)state;
    rng r = rng_make(401);
    chain w;
    chain_init(&w);
    tally t = {0};
    size_t rays = soak(20000);
    for (size_t i = 0; i < rays; i += 20) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        sag_torus torus = {size, size * rng_log_uniform(&r, 1e-4, 1e3)};
        if (rng_one_in(&r, 4)) torus.minor_radius = size * rng_uniform(&r, 0.5, 1.5);
        if (rng_one_in(&r, 8)) torus.minor_radius = size;
        if (torus.minor_radius > size)
            torus.major_radius *= size / torus.minor_radius, torus.minor_radius = size;
        // Points on it: rays between them, at them and from them.
        sag_vec3 points[16];
        for (int k = 0; k < 16; k++) {
            double phi = k < 8 ? (k & 3) * 1.57079632679489661923 : rng_uniform(&r, 0, 6.28);
            double psi = k < 8 ? (k >> 1) * 1.57079632679489661923 : rng_uniform(&r, 0, 6.28);
            double rho = torus.major_radius + torus.minor_radius * cos(psi);
            points[k] = (sag_vec3){rho * cos(phi), rho * sin(phi), torus.minor_radius * sin(psi)};
        }
        adversary hard = {{0, 0, 0}, torus.major_radius + torus.minor_radius, points, 16};
        for (int k = 0; k < 20; k++) {
            sag_ray ray = adversarial_ray(&r, &hard);
            if (rng_one_in(&r, 10)) { // grazing: through a point, across its normal, nearly
                sag_vec3 p = points[8 + rng_below(&r, 8)];
                double rho = hypot(p.x, p.y), ring = 1 - torus.major_radius / rho;
                sag_vec3 n = {p.x * ring, p.y * ring, p.z}, across = sag_cross(n, rng_direction(&r));
                if (!(sag_dot(across, across) > 0)) continue;
                ray = sag_ray_make(
                    sag_madd(p, -rng_uniform(&r, 0, 5) * hard.size / sag_length(across), across), across);
            }
            crossing_truth truth = {0};
            if (!solve_torus(&w, &torus, &ray, &truth)) continue;
            sag_hit hits[4];
            const double shape[7] = {torus.major_radius, torus.minor_radius};
            take(&t, "torus", &truth, hits, sag_torus_crossings(&torus, &ray, hits, 4), &ray, shape);
        }
    }
    chain_clear(&w);
    report("torus", &t);
}

// For the capsule: the roots of a t² + 2 b t + c = 0, from coefficients in w->x (a), w->y (b), w->z (c).
static bool quadratic(chain *w, mpfr_t low, mpfr_t high) {
    mpfr_sqr(w->k, w->y, RN), mpfr_mul(w->q, w->x, w->z, RN), mpfr_sub(w->k, w->k, w->q, RN);
    if (mpfr_sgn(w->k) < 0 || mpfr_zero_p(w->x)) return false;
    mpfr_sqrt(w->k, w->k, RN);
    mpfr_add(low, w->y, w->k, RN), mpfr_neg(low, low, RN), mpfr_div(low, low, w->x, RN);
    mpfr_sub(high, w->k, w->y, RN), mpfr_div(high, high, w->x, RN);
    return true;
}

static void dot(chain *w, mpfr_t out, mpfr_t a[3], mpfr_t b[3]) {
    mpfr_set_zero(out, 1);
    for (int i = 0; i < 3; i++) mpfr_mul(w->r4, a[i], b[i], RN), mpfr_add(out, out, w->r4, RN);
}

static void widen(mpfr_t enter, mpfr_t leave, mpfr_t low, mpfr_t high, bool *any) {
    if (!*any || mpfr_less_p(low, enter)) mpfr_set(enter, low, RN);
    if (!*any || mpfr_greater_p(high, leave)) mpfr_set(leave, high, RN);
    *any = true;
}

static void solve_capsule(chain *w, const sag_capsule *c, const sag_ray *ray, crossing_truth *truth) {
    mpfr_t l[3], axis[3], enter, leave, dd, dw, lw, ww, ld;
    mpfr_inits2(BITS, l[0], l[1], l[2], axis[0], axis[1], axis[2], enter, leave, dd, dw, lw, ww, ld, NULL);
    bool any = false;
    for (int ball = 0; ball < 2; ball++) {
        for (int i = 0; i < 3; i++) {
            mpfr_set_d(w->d[i], sag_component(ray->direction, i), RN),
                mpfr_set_d(l[i], sag_component(ray->origin, i), RN);
            mpfr_sub_d(l[i], l[i], sag_component(ball == 0 ? c->p1 : c->p0, i), RN);
            mpfr_set_d(axis[i], sag_component(c->p1, i), RN),
                mpfr_sub_d(axis[i], axis[i], sag_component(c->p0, i), RN);
        }
        dot(w, w->x, w->d, w->d), dot(w, w->y, l, w->d), dot(w, w->z, l, l);
        mpfr_set_d(w->k, c->radius, RN), mpfr_sqr(w->k, w->k, RN), mpfr_sub(w->z, w->z, w->k, RN);
        if (quadratic(w, w->low, w->high)) widen(enter, leave, w->low, w->high, &any);
    }
    // The side, l being from p0: (y·y)(w·w) − (y·w)² = r² w·w within 0 ≤ y·w ≤ w·w.
    dot(w, ww, axis, axis), dot(w, dw, w->d, axis), dot(w, lw, l, axis), dot(w, dd, w->d, w->d),
        dot(w, ld, l, w->d);
    mpfr_mul(w->x, dd, ww, RN), mpfr_sqr(w->k, dw, RN), mpfr_sub(w->x, w->x, w->k, RN);
    mpfr_mul(w->y, ld, ww, RN), mpfr_mul(w->k, dw, lw, RN), mpfr_sub(w->y, w->y, w->k, RN);
    dot(w, w->z, l, l), mpfr_set_d(w->k, c->radius, RN), mpfr_sqr(w->k, w->k, RN),
        mpfr_sub(w->z, w->z, w->k, RN);
    mpfr_mul(w->z, w->z, ww, RN), mpfr_sqr(w->k, lw, RN), mpfr_sub(w->z, w->z, w->k, RN);
    if (!mpfr_zero_p(ww) && quadratic(w, w->low, w->high)) {
        bool inside = !mpfr_zero_p(dw) || (mpfr_sgn(lw) >= 0 && mpfr_lessequal_p(lw, ww));
        if (!mpfr_zero_p(dw)) { // between the two end planes
            mpfr_div(lw, lw, dw, RN), mpfr_neg(lw, lw, RN);
            mpfr_div(ww, ww, dw, RN), mpfr_add(ww, ww, lw, RN);
            if (mpfr_greater_p(lw, ww)) mpfr_swap(lw, ww);
            if (mpfr_greater_p(lw, w->low)) mpfr_set(w->low, lw, RN);
            if (mpfr_less_p(ww, w->high)) mpfr_set(w->high, ww, RN);
        }
        if (inside && mpfr_lessequal_p(w->low, w->high)) widen(enter, leave, w->low, w->high, &any);
    }
    if (any)
        crossing_truth_add(truth, ray, mpfr_get_ld(enter, RN)),
            crossing_truth_add(truth, ray, mpfr_get_ld(leave, RN));
    mpfr_clears(l[0], l[1], l[2], axis[0], axis[1], axis[2], enter, leave, dd, dw, lw, ww, ld, NULL);
}

static void capsules(void **state) {
    (void)state;
    rng r = rng_make(402);
    chain w;
    chain_init(&w);
    tally t = {0};
    size_t rays = soak(100000);
    for (size_t i = 0; i < rays; i += 20) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 center = rng_one_in(&r, 3) ? (sag_vec3){0, 0, 0} : rng_vec3(&r, size * 10);
        sag_vec3 half = rng_one_in(&r, 3) ? (sag_vec3){0, 0, size} : rng_vec3(&r, size);
        sag_capsule c = {sag_sub(center, half), sag_add(center, half), size * rng_log_uniform(&r, 1e-4, 10)};
        if (rng_one_in(&r, 16)) c.p1 = c.p0;
        // Both ends of the axis, and points of the two seams.
        sag_vec3 points[16], n = rng_direction(&r), w0 = sag_sub(c.p1, c.p0);
        for (int k = 0; k < 16; k++) {
            sag_vec3 across = sag_cross(w0, k < 4 ? (sag_vec3){1, k & 1, 0} : rng_direction(&r));
            n = sag_normalize(sag_dot(across, across) > 0 ? across : n);
            points[k] = sag_madd(k & 1 ? c.p0 : c.p1, k < 2 ? 0 : c.radius, n);
        }
        adversary hard = {center, sag_length(half) + c.radius, points, 16};
        for (int k = 0; k < 20; k++) {
            sag_ray ray = adversarial_ray(&r, &hard);
            if (rng_one_in(&r, 10)) ray.direction = sag_scale(w0, rng_one_in(&r, 2) ? 1 : -1);
            if (sag_dot(ray.direction, ray.direction) == 0) continue;
            crossing_truth truth = {0};
            solve_capsule(&w, &c, &ray, &truth);
            sag_hit hits[4];
            const double shape[7] = {c.p0.x, c.p0.y, c.p0.z, c.p1.x, c.p1.y, c.p1.z, c.radius};
            take(&t, "capsule", &truth, hits, sag_capsule_crossings(&c, &ray, hits, 4), &ray, shape);
        }
    }
    chain_clear(&w);
    report("capsule", &t);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(tori), cmocka_unit_test(capsules)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
