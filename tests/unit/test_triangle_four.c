// SPDX-License-Identifier: MIT
// t, u and v of four triangles at a time have the bits of one at a time, whatever stands in the other lanes,
// for every instruction set this machine has; and so does the one that stands in the kernels.
#include "base/cpu.h"
#include "support/triangle_four.h"
#include "support/triangle_rays.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

typedef struct answer {
    bool hit;
    double t, u, v;
} answer;

static bool same_double(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }
static bool same(const answer *a, const answer *b) {
    return a->hit == b->hit &&
           (!a->hit || (same_double(a->t, b->t) && same_double(a->u, b->u) && same_double(a->v, b->v)));
}

// As sagi_triangle_solve, compiled for any machine, has it.
static answer solve(const triangle_ray *s, double t_max) {
    sagi_triangle_ray ray = sagi_triangle_prepare(&s->ray);
    ray.t_max = t_max;
    answer a = {0};
    a.hit = sagi_triangle_solve(&ray, &s->a, &s->b, &s->c, &a.t, &a.u, &a.v);
    return a;
}

// One that is pierced, of any kind; its range, if it has one, often ends or begins at t itself.
static triangle_ray draw(rng *r) {
    for (;;) {
        triangle_ray s = {.ray = {.t_min = -INFINITY, .t_max = INFINITY}};
        // Half of them are such as scenes have.
        size_t kind = rng_one_in(r, 2) ? 0 : rng_below(r, TRIANGLE_RAY_KINDS);
        triangle_ray_kinds[kind].make(r, rng_log_uniform(r, 1e-9, 1e9), &s);
        if (!sag_ray_is_valid(&s.ray)) continue;
        sagi_triangle_ray ray = sagi_triangle_prepare(&s.ray);
        if (sagi_triangle_side(&ray, &s.a, &s.b, &s.c) == 0) continue;
        answer a = solve(&s, INFINITY);
        if (!a.hit) return s;
        switch (rng_below(r, 6)) {
        case 0: s.ray.t_min = 0; break;
        case 1: s.ray.t_min = a.t; break;
        case 2: s.ray.t_min = nextafter(a.t, INFINITY); break;
        case 3: s.ray.t_min = a.t - fabs(a.t) * rng_double(r, -60, 3); break;
        default: break;
        }
        return s;
    }
}

static double draw_t_max(rng *r, const triangle_ray *s) {
    double t = solve(s, INFINITY).t;
    switch (rng_below(r, 6)) {
    case 0: return t;
    case 1: return nextafter(t, -INFINITY);
    case 2: return t + fabs(t) * rng_double(r, -60, 3);
    default: return INFINITY;
    }
}

static void place(sagi_triangle_four *four, int lane, const triangle_ray *s, double t_max) {
    four->ray[lane] = &s->ray, four->t_max[lane] = t_max;
    const sag_vec3 *corner[3] = {&s->a, &s->b, &s->c};
    for (int k = 0; k < 3; k++)
        four->corner[k][lane] = (sagi_d4){corner[k]->x, corner[k]->y, corner[k]->z, NAN};
}

static void test_four(const triangle_solvers *solvers) {
    rng r = rng_make(20);
    size_t hits = 0, misses = 0;
    for (int i = 0; i < 40000; i++) {
        triangle_ray s[4];
        answer expected[4];
        sagi_triangle_four four;
        memset(&four, 0xff, sizeof four);
        uint32_t lanes = rng_below(&r, 16);
        for (int k = 0; k < 4; k++) {
            if (!(lanes >> k & 1)) continue;
            s[k] = draw(&r);
            double t_max = draw_t_max(&r, &s[k]);
            expected[k] = solve(&s[k], t_max);
            answer one = {0};
            one.hit = solvers->one(&s[k].ray, t_max, &s[k].a, &s[k].b, &s[k].c, &one.t, &one.u, &one.v);
            assert_true(same(&expected[k], &one));
            place(&four, k, &s[k], t_max);
        }
        uint32_t found = solvers->four(&four, lanes);
        assert_int_equal(found & ~lanes, 0);
        for (int k = 0; k < 4; k++) {
            if (!(lanes >> k & 1)) continue;
            answer a = {found >> k & 1, four.t[k], four.u[k], four.v[k]};
            if (!same(&expected[k], &a))
                printf("%d/%d: %d %a %a %a, not %d %a %a %a\n", i, k, a.hit, a.t, a.u, a.v, expected[k].hit,
                       expected[k].t, expected[k].u, expected[k].v);
            assert_true(same(&expected[k], &a));
            hits += a.hit, misses += !a.hit;
        }
    }
    assert_true(hits > 30000 && misses > 10000);
}

static void test_portable(void **state) {
    (void)state;
    test_four(&triangle_solvers_portable);
}
static void test_avx2(void **state) {
    (void)state;
    if (triangle_solvers_avx2.four == NULL || !sagi_cpu_has(SAGI_ISA_AVX2)) skip();
    test_four(&triangle_solvers_avx2);
}
static void test_avx512(void **state) {
    (void)state;
    if (triangle_solvers_avx512.four == NULL || !sagi_cpu_has(SAGI_ISA_AVX512)) skip();
    test_four(&triangle_solvers_avx512);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_portable), cmocka_unit_test(test_avx2),
                                       cmocka_unit_test(test_avx512)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
