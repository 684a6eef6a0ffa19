// SPDX-License-Identifier: MIT
// Polygons and bilinear patches against 1,200-bit arithmetic (MPFR), at scales 1e-9 … 1e9: no wrong decision,
// no t farther than 4 ulp from the root of the shape's equation.
#include "support/random.h"
#include <sagitta/shapes.h>

#include <mpfr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define BITS 1200

typedef struct big3 {
    mpfr_t x[3];
} big3;

static void init3(big3 *a) {
    for (int i = 0; i < 3; i++) mpfr_init2(a->x[i], BITS);
}
static void clear3(big3 *a) {
    for (int i = 0; i < 3; i++) mpfr_clear(a->x[i]);
}
static void set3(big3 *r, sag_vec3 a) {
    mpfr_set_d(r->x[0], a.x, MPFR_RNDN);
    mpfr_set_d(r->x[1], a.y, MPFR_RNDN);
    mpfr_set_d(r->x[2], a.z, MPFR_RNDN);
}
static void sub3(big3 *r, const big3 *a, const big3 *b) {
    for (int i = 0; i < 3; i++) mpfr_sub(r->x[i], a->x[i], b->x[i], MPFR_RNDN);
}
static void madd3(big3 *r, const big3 *a, mpfr_t s, const big3 *b) { // r = a + s b
    for (int i = 0; i < 3; i++) mpfr_fma(r->x[i], s, b->x[i], a->x[i], MPFR_RNDN);
}
static void cross3(big3 *r, const big3 *a, const big3 *b) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpfr_fmms(r->x[i], a->x[j], b->x[k], a->x[k], b->x[j], MPFR_RNDN);
    }
}
static void dot3(mpfr_t r, const big3 *a, const big3 *b) {
    mpfr_fmma(r, a->x[0], b->x[0], a->x[1], b->x[1], MPFR_RNDN);
    mpfr_fma(r, a->x[2], b->x[2], r, MPFR_RNDN);
}

static double error_ulp(mpfr_t truth, double t) {
    mpfr_t difference, ulp;
    mpfr_inits2(BITS, difference, ulp, (mpfr_ptr)0);
    double result = 0;
    mpfr_sub_d(difference, truth, t, MPFR_RNDN);
    if (!mpfr_zero_p(difference)) {
        mpfr_set_ui_2exp(ulp, 1, mpfr_zero_p(truth) ? -2000 : mpfr_get_exp(truth) - 53, MPFR_RNDN);
        mpfr_div(difference, difference, ulp, MPFR_RNDN);
        result = fabs(mpfr_get_d(difference, MPFR_RNDN));
    }
    mpfr_clears(difference, ulp, (mpfr_ptr)0);
    return result;
}

// Whether x/whole is 0 or 1 but for the rounding of thirds and roots: then either answer will do.
static bool is_at_rim(mpfr_t x, mpfr_t whole) {
    if (mpfr_zero_p(x)) return true;
    mpfr_t rest;
    mpfr_init2(rest, BITS);
    mpfr_sub(rest, whole, x, MPFR_RNDN);
    mpfr_exp_t small = mpfr_get_exp(whole) - 300;
    bool result = mpfr_get_exp(x) < small || mpfr_zero_p(rest) || mpfr_get_exp(rest) < small;
    mpfr_clear(rest);
    return result;
}

// The patch's crossings by the formulas of bilinear_solve.c in MPFR. Returns how many; t[] in no order; −1
// where one lies on the rim.
static int patch_truth(const sag_bilinear_patch *s, const sag_ray *ray, mpfr_t t[2]) {
    big3 o, d, q[4], w, e0, e1, twist, m, n, a, wu;
    big3 *all[] = {&o, &d, &q[0], &q[1], &q[2], &q[3], &w, &e0, &e1, &twist, &m, &n, &a, &wu};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) init3(all[i]);
    mpfr_t c[3], x, u[2], square, v;
    for (int i = 0; i < 3; i++) mpfr_init2(c[i], BITS);
    mpfr_inits2(BITS, x, u[0], u[1], square, v, (mpfr_ptr)0);
    const sag_vec3 corner[4] = {s->p00, s->p10, s->p01, s->p11};
    set3(&o, ray->origin);
    set3(&d, ray->direction);
    for (int i = 0; i < 4; i++) {
        set3(&q[i], corner[i]);
        sub3(&q[i], &q[i], &o);
    }
    sub3(&w, &q[2], &q[0]);
    sub3(&e0, &q[1], &q[0]);
    sub3(&e1, &q[3], &q[2]);
    sub3(&twist, &e1, &e0);
    cross3(&m, &d, &q[0]); // det(d, q00, ·)
    dot3(c[0], &m, &q[2]);
    dot3(c[1], &m, &e1);
    cross3(&n, &d, &e0); // det(d, e0, ·)
    dot3(c[2], &n, &e1);
    dot3(x, &n, &q[2]);
    mpfr_add(c[1], c[1], x, MPFR_RNDN);
    int roots = 0, count = 0;
    if (mpfr_zero_p(c[2])) {
        if (!mpfr_zero_p(c[1])) {
            mpfr_div(u[roots], c[0], c[1], MPFR_RNDN);
            mpfr_neg(u[roots], u[roots], MPFR_RNDN);
            roots++;
        }
    } else {
        mpfr_mul(x, c[0], c[2], MPFR_RNDN);
        mpfr_mul_ui(x, x, 4, MPFR_RNDN);
        mpfr_fms(x, c[1], c[1], x, MPFR_RNDN);
        if (mpfr_sgn(x) > 0) {
            mpfr_sqrt(x, x, MPFR_RNDN);
            for (; roots < 2; roots++) {
                mpfr_neg(x, x, MPFR_RNDN);
                mpfr_sub(u[roots], x, c[1], MPFR_RNDN);
                mpfr_div(u[roots], u[roots], c[2], MPFR_RNDN);
                mpfr_div_ui(u[roots], u[roots], 2, MPFR_RNDN);
            }
        }
    }
    bool at_rim = false;
    for (int i = 0; i < roots; i++) {
        mpfr_set_ui(x, 1, MPFR_RNDN);
        bool u_at_rim = is_at_rim(u[i], x);
        if (!u_at_rim && mpfr_sgn(u[i]) < 0) continue;
        if (!u_at_rim && mpfr_cmp(u[i], x) > 0) continue;
        madd3(&a, &q[0], u[i], &e0);
        madd3(&wu, &w, u[i], &twist);
        cross3(&m, &d, &wu);
        dot3(square, &m, &m);
        // A segment along the ray, or shrunk to a point: m is 0 but for the rounding of u.
        dot3(x, &w, &w), dot3(v, &twist, &twist), mpfr_add(x, x, v, MPFR_RNDN);
        dot3(v, &d, &d), mpfr_mul(x, x, v, MPFR_RNDN);
        if (mpfr_zero_p(square) || mpfr_get_exp(square) < mpfr_get_exp(x) - BITS) continue;
        cross3(&n, &a, &d);
        dot3(v, &n, &m);
        bool v_at_rim = is_at_rim(v, square);
        if (!v_at_rim && (mpfr_sgn(v) < 0 || mpfr_cmp(v, square) > 0)) continue;
        at_rim = at_rim || u_at_rim || v_at_rim;
        cross3(&n, &a, &wu);
        dot3(t[count], &n, &m);
        mpfr_div(t[count], t[count], square, MPFR_RNDN);
        // What is left of an exact 0 by the rounding of roots that are no binary fractions.
        if (!mpfr_zero_p(t[count]) && mpfr_get_exp(t[count]) < -900) mpfr_set_zero(t[count], 1);
        count++;
    }
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) clear3(all[i]);
    for (int i = 0; i < 3; i++) mpfr_clear(c[i]);
    mpfr_clears(x, u[0], u[1], square, v, (mpfr_ptr)0);
    return at_rim ? -1 : count;
}

static sag_vec3 grid(rng *r, double step) {
    double x = (int)rng_below(r, 5) - 2, y = (int)rng_below(r, 5) - 2, z = (int)rng_below(r, 5) - 2;
    return sag_scale(sag_vec3_make(x, y, z), step);
}

static sag_vec3 on_patch(const sag_bilinear_patch *s, double u, double v) {
    sag_vec3 a = sag_madd(s->p00, u, sag_sub(s->p10, s->p00));
    return sag_madd(a, v, sag_sub(sag_madd(s->p01, u, sag_sub(s->p11, s->p01)), a));
}

// Random patches, patches on a coarse grid (flat ones, folded ones, corners that fall together), rays from
// near, far and on the patch, rays through the rim, rays that graze.
static void make_patch(rng *r, sag_bilinear_patch *s, sag_ray *ray) {
    double scale = rng_log_uniform(r, 1e-9, 1e9), step = exp2(round(log2(scale)));
    bool is_grid = rng_one_in(r, 3);
    sag_vec3 middle = rng_vec3(r, rng_one_in(r, 2) ? scale : scale * rng_log_uniform(r, 1, 1e4));
    sag_vec3 *corner[4] = {&s->p00, &s->p10, &s->p01, &s->p11};
    for (int i = 0; i < 4; i++) *corner[i] = is_grid ? grid(r, step) : sag_add(middle, rng_vec3(r, scale));
    double u = rng_one_in(r, 5) ? rng_below(r, 2) : rng_unit(r), v = rng_uniform(r, -0.1, 1.1);
    sag_vec3 target = on_patch(s, u, v), du = sag_sub(on_patch(s, 1, v), on_patch(s, 0, v));
    double far = scale * rng_log_uniform(r, 1e-3, 1e5);
    sag_vec3 away =
        rng_one_in(r, 5) ? sag_madd(du, rng_double(r, -30, -5), rng_vec3(r, scale)) : rng_vec3(r, far);
    ray->origin = is_grid && rng_one_in(r, 2) ? grid(r, step) : sag_add(target, away);
    if (rng_one_in(r, 20)) ray->origin = target;
    ray->direction = is_grid             ? grid(r, 1)
                     : rng_one_in(r, 20) ? rng_direction(r)
                                         : sag_sub(target, ray->origin);
}

// All there is to know of a failure.
static void print_case(const char *what, const sag_bilinear_patch *s, const sag_ray *ray, const sag_hit *hits,
                       int count, mpfr_t *truth, int known) {
    const sag_vec3 v[6] = {s->p00, s->p10, s->p01, s->p11, ray->origin, ray->direction};
    printf("%s\n", what);
    for (int i = 0; i < 6; i++) printf("  {%a, %a, %a}\n", v[i].x, v[i].y, v[i].z);
    for (int i = 0; i < count; i++) printf("  found %.17g at %.17g %.17g\n", hits[i].t, hits[i].u, hits[i].v);
    for (int i = 0; i < known; i++) mpfr_printf("  truth %.25Rg\n", truth[i]);
}

static void test_patches(void **state) {
    (void)state;
    rng r = rng_make(7);
    mpfr_t truth[2];
    mpfr_inits2(BITS, truth[0], truth[1], (mpfr_ptr)0);
    size_t rays = 0, crossings = 0, wrong = 0;
    double worst = 0;
    for (size_t i = 0, n = soak(40000); i < n; i++) {
        sag_bilinear_patch s;
        sag_ray ray = {.t_min = -INFINITY, .t_max = INFINITY};
        make_patch(&r, &s, &ray);
        if (!sag_ray_is_valid(&ray)) continue;
        sag_hit hits[2];
        int count = (int)sag_bilinear_patch_crossings(&s, &ray, hits, 2),
            known = patch_truth(&s, &ray, truth);
        if (known < 0) continue;
        rays++;
        if (count != known) {
            wrong++;
            print_case("wrong number", &s, &ray, hits, count, truth, known);
            continue;
        }
        if (known == 2 && mpfr_cmp(truth[0], truth[1]) > 0) mpfr_swap(truth[0], truth[1]);
        for (int k = 0; k < count; k++) {
            double error = error_ulp(truth[k], hits[k].t);
            if (error > 4) print_case("far off", &s, &ray, hits, count, truth, known);
            crossings++;
            worst = fmax(worst, error);
        }
    }
    printf("bilinear patch: %zu rays, %zu crossings, %zu wrong, t within %.2f ulp\n", rays, crossings, wrong,
           worst);
    assert_int_equal(wrong, 0);
    assert_true(worst <= 4);
    mpfr_clears(truth[0], truth[1], (mpfr_ptr)0);
}

// A star-shaped loop of n points around (x, y) in the plane of two axes; flat z = 0.
static void make_loop(rng *r, sag_vec3 *p, uint32_t n, double x, double y, double size) {
    for (uint32_t i = 0; i < n; i++) {
        double angle = 6.283185307179586 * (i + 0.8 * rng_unit(r)) / n,
               radius = size * rng_uniform(r, 0.4, 1);
        // Multiples of 2⁻²⁰: sheared into any plane with small integers they stay exactly flat.
        p[i].x = ldexp(rint(ldexp(x + radius * cos(angle), 20)), -20);
        p[i].y = ldexp(rint(ldexp(y + radius * sin(angle), 20)), -20);
        p[i].z = 0;
    }
}

// Crossing numbers in the plane across the ray, in MPFR; *on_edge when the line meets the boundary. t of the
// plane by Newell through the centroid.
static bool polygon_truth(const sag_polygon *s, const sag_ray *ray, mpfr_t t, bool *on_edge) {
    big3 o, d, a, b, n, sum, x;
    big3 *all[] = {&o, &d, &a, &b, &n, &sum, &x};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) init3(all[i]);
    mpfr_t ya, yb, side, denominator;
    mpfr_inits2(BITS, ya, yb, side, denominator, (mpfr_ptr)0);
    set3(&o, ray->origin);
    set3(&d, ray->direction);
    set3(&n, (sag_vec3){0, 0, 0});
    set3(&sum, (sag_vec3){0, 0, 0});
    sag_vec3 w = sag_abs(ray->direction);
    int k = w.x > w.y ? (w.x > w.z ? 0 : 2) : (w.y > w.z ? 1 : 2), j = (k + 2) % 3;
    bool inside = false;
    *on_edge = false;
    for (uint32_t l = 0, first = 0; l < s->loop_count; first += s->loop_sizes[l++])
        for (uint32_t i = 0; i < s->loop_sizes[l]; i++) {
            set3(&a, s->positions[first + i]);
            set3(&b, s->positions[first + (i + 1) % s->loop_sizes[l]]);
            sub3(&a, &a, &o);
            sub3(&b, &b, &o);
            cross3(&x, &a, &b);
            if (l == 0) {
                for (int c = 0; c < 3; c++) {
                    mpfr_add(n.x[c], n.x[c], x.x[c], MPFR_RNDN);
                    mpfr_add(sum.x[c], sum.x[c], a.x[c], MPFR_RNDN);
                }
            }
            dot3(side, &x, &d);
            mpfr_fmms(ya, a.x[j], d.x[k], a.x[k], d.x[j], MPFR_RNDN);
            mpfr_fmms(yb, b.x[j], d.x[k], b.x[k], d.x[j], MPFR_RNDN);
            bool above_a = mpfr_sgn(ya) > 0, above_b = mpfr_sgn(yb) > 0;
            if (mpfr_zero_p(side)) *on_edge = true; // or an edge in line with it: not compared
            if (above_a == above_b) continue;
            int turn = mpfr_sgn(side) * mpfr_sgn(d.x[k]);
            if ((turn > 0) == above_b) inside = !inside;
        }
    dot3(denominator, &n, &d);
    mpfr_mul_ui(denominator, denominator, s->loop_sizes[0], MPFR_RNDN);
    dot3(t, &sum, &n);
    if (mpfr_zero_p(denominator)) inside = false;
    mpfr_div(t, t, denominator, MPFR_RNDN);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) clear3(all[i]);
    mpfr_clears(ya, yb, side, denominator, (mpfr_ptr)0);
    return inside;
}

static void test_polygons(void **state) {
    (void)state;
    rng r = rng_make(8);
    mpfr_t truth;
    mpfr_init2(truth, BITS);
    size_t rays = 0, hits = 0, wrong = 0;
    double worst = 0;
    for (size_t i = 0, n = soak(2000); i < n; i++) {
        uint32_t sizes[2] = {3 + rng_below(&r, 20), 3 + rng_below(&r, 5)};
        sag_vec3 p[32];
        make_loop(&r, p, sizes[0], 0, 0, 1);
        make_loop(&r, p + sizes[0], sizes[1], 0.05, 0.02, 0.2);
        double shear_x = (int)rng_below(&r, 9) - 4, shear_y = (int)rng_below(&r, 9) - 4;
        int scale = (int)rng_below(&r, 60) - 30;
        for (uint32_t k = 0; k < sizes[0] + sizes[1]; k++) {
            sag_vec3 q = {p[k].x, p[k].y, 0.125 + shear_x * p[k].x + shear_y * p[k].y};
            p[k] = sag_vec3_make(ldexp(q.x, scale), ldexp(q.y, scale), ldexp(q.z, scale));
        }
        sag_polygon s = {p, sizes[0] + sizes[1], sizes, 2};
        sag_error error;
        if (sag_polygon_validate(&s, &error) != SAG_OK) continue; // the hole may stick out
        double size = ldexp(1, scale);
        for (int k = 0; k < 40; k++) {
            double x = rng_uniform(&r, -1, 1), y = rng_uniform(&r, -1, 1);
            sag_vec3 target = sag_scale(sag_vec3_make(x, y, 0.125 + shear_x * x + shear_y * y), size);
            double away = size * rng_log_uniform(&r, rng_one_in(&r, 4) ? 1e-15 : 0.1, 1e5);
            sag_vec3 origin = sag_madd(target, away, rng_direction(&r));
            if (rng_one_in(&r, 10)) origin = target;
            sag_ray ray = {origin, sag_sub(target, origin), -INFINITY, INFINITY, 0};
            if (rng_one_in(&r, 10)) ray.direction = rng_direction(&r);
            if (!sag_ray_is_valid(&ray)) continue;
            bool on_edge;
            bool known = polygon_truth(&s, &ray, truth, &on_edge);
            if (on_edge) continue;
            sag_hit hit;
            bool found = sag_polygon_hit(&s, &ray, &hit);
            rays++;
            hits += found;
            if (found != known)
                wrong++;
            else if (found)
                worst = fmax(worst, error_ulp(truth, hit.t));
        }
    }
    printf("polygon: %zu rays, %zu hits, %zu wrong, t within %.2f ulp\n", rays, hits, wrong, worst);
    assert_true(hits > 1000);
    assert_int_equal(wrong, 0);
    assert_true(worst <= 4);
    mpfr_clear(truth);
    mpfr_free_cache();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_patches), cmocka_unit_test(test_polygons)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
