// SPDX-License-Identifier: MIT
// Triangles against exact arithmetic: a million seeded rays of every awkward kind at scales 1e-9 … 1e9. No
// wrong decision is allowed, ties included, and no t farther than 4 ulp from the true one.
#include "support/exact_triangle.h"
#include "support/random.h"
#include "support/triangle_rays.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

typedef struct statistics {
    size_t rays, hits, ties, wrong;
    double t_error_ulp, weight_error;
} statistics;

static void print_vector(const char *name, sag_vec3 a) { printf("%s %a %a %a ", name, a.x, a.y, a.z); }

static void report(const triangle_ray *s, const exact_triangle *truth, bool is_hit, const sag_hit *hit) {
    print_vector("a", s->a);
    print_vector("b", s->b);
    print_vector("c", s->c);
    print_vector("o", s->ray.origin);
    print_vector("d", s->ray.direction);
    printf("hit %d, truly %d; t %.17g, truly %.17g, %g ulp; u %.17g %.17g v %.17g %.17g\n", is_hit,
           truth->side, hit->t, truth->t, truth->t_error_ulp, hit->u, truth->u, hit->v, truth->v);
}

static void examine(const triangle_ray *s, statistics *out) {
    if (!sag_ray_is_valid(&s->ray)) return;
    sag_triangle triangle = {s->a, s->b, s->c, false};
    sag_hit hit = {.t = NAN};
    bool is_hit = sag_triangle_hit(&triangle, &s->ray, &hit);
    exact_triangle truth = exact_triangle_examine(&s->ray, s->a, s->b, s->c, hit.t);
    out->rays++;
    out->ties += truth.tie;
    bool wrong = is_hit != (truth.side != 0 && isfinite(truth.t));
    if (is_hit && !wrong) {
        out->hits++;
        if (fabs(truth.t) >= 0x1p-1000) {
            out->t_error_ulp = fmax(out->t_error_ulp, truth.t_error_ulp);
            if (!(truth.t_error_ulp <= 4)) wrong = true;
        } else if (hit.t != truth.t && !(fabs(hit.t - truth.t) <= 0x1p-1074)) { // among subnormals
            wrong = true;
        }
        double error = fmax(fabs(hit.u - truth.u), fabs(hit.v - truth.v));
        if (!(error <= 0x1p-42) || !(hit.u >= 0 && hit.v >= 0 && hit.u + hit.v <= 1)) wrong = true;
        out->weight_error = fmax(out->weight_error, error);
        sag_triangle one_sided = {s->a, s->b, s->c, true};
        sag_hit front;
        if (sag_triangle_hit(&one_sided, &s->ray, &front) != (truth.side < 0)) wrong = true;
    }
    if (wrong && out->wrong++ < 5) report(s, &truth, is_hit, &hit);
}

static void test_against_exact(void **state) {
    (void)state;
    size_t rays = 0, wrong = 0;
    double t_error = 0;
    for (size_t k = 0; k < TRIANGLE_RAY_KINDS; k++) {
        rng r = rng_make(17 + k);
        statistics out = {0};
        for (size_t i = 0, n = soak(triangle_ray_kinds[k].count); i < n; i++) {
            triangle_ray s = {.ray = {.t_min = -INFINITY, .t_max = INFINITY}};
            triangle_ray_kinds[k].make(&r, rng_log_uniform(&r, 1e-9, 1e9), &s);
            examine(&s, &out);
        }
        printf("%-8s %8zu rays, %7zu hits, %7zu ties, %zu wrong; t within %.2f ulp, u and v within %.2g\n",
               triangle_ray_kinds[k].name, out.rays, out.hits, out.ties, out.wrong, out.t_error_ulp,
               out.weight_error);
        rays += out.rays;
        wrong += out.wrong;
        t_error = fmax(t_error, out.t_error_ulp);
    }
    printf("%zu rays: %zu wrong, largest error of t %.2f ulp\n", rays, wrong, t_error);
    assert_int_equal(wrong, 0);
    assert_true(t_error <= 4);
    exact_triangle_end();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_against_exact)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
