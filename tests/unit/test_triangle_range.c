// SPDX-License-Identifier: MIT
// A triangle that is said to be met outside a ray's range is not met within it by the solution either: for
// ranges that end a few roundings before and after the hit, at it, and anywhere. And most are told.
#include "shapes/triangle_range.h"
#include "support/random.h"
#include "support/triangle_rays.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static bool is_beyond(const sag_ray *ray, double t_max, const triangle_ray *s) {
    const sagi_d4 corner[3] = {
        {s->a.x, s->a.y, s->a.z, NAN}, {s->b.x, s->b.y, s->b.z, 1}, {s->c.x, s->c.y, s->c.z, INFINITY}};
    return sagi_triangle_is_beyond(ray, t_max, corner);
}

static bool is_hit(const sag_ray *ray, double t_max, const triangle_ray *s, double *t) {
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    prepared.t_max = t_max;
    double u, v;
    return sagi_triangle_hit(&prepared, &s->a, &s->b, &s->c, false, t, &u, &v);
}

// An end of a range near t: relative steps of every size from a fraction of a rounding up, or single doubles.
static double end_near(rng *r, double t) {
    if (rng_one_in(r, 4)) {
        for (int i = (int)rng_below(r, 40); i > 0; i--)
            t = nextafter(t, rng_one_in(r, 2) ? INFINITY : -INFINITY);
        return t;
    }
    const double step = fabs(t) * rng_double(r, -56, 2);
    return rng_one_in(r, 2) ? t + step : t - step;
}

static void test_never_wrong(void **state) {
    (void)state;
    for (size_t kind = 0; kind < TRIANGLE_RAY_KINDS; kind++) {
        rng r = rng_make(40 + kind);
        size_t hits = 0, outside = 0, told = 0;
        for (size_t i = 0; i < 20000; i++) {
            triangle_ray s = {.ray = {.t_min = -INFINITY, .t_max = INFINITY}};
            triangle_ray_kinds[kind].make(&r, rng_log_uniform(&r, 1e-9, 1e9), &s);
            double t, again;
            if (!sag_ray_is_valid(&s.ray) || !is_hit(&s.ray, INFINITY, &s, &t)) continue;
            hits++;
            assert_false(is_beyond(&s.ray, INFINITY, &s));
            for (int turn = 0; turn < 6; turn++) {
                sag_ray ray = s.ray;
                double t_max = INFINITY;
                if (turn < 2) ray.t_min = end_near(&r, t);
                if (turn == 2) ray.t_min = 0;
                if (turn > 2) t_max = end_near(&r, t);
                if (turn == 5) ray.t_min = end_near(&r, t);
                if (is_hit(&ray, t_max, &s, &again)) {
                    assert_false(is_beyond(&ray, t_max, &s));
                } else {
                    outside++;
                    told += is_beyond(&ray, t_max, &s);
                }
            }
        }
        printf("%-8s %6zu hits; of %6zu out of range %.3f are told\n", triangle_ray_kinds[kind].name, hits,
               outside, (double)told / (double)(outside + !outside));
        if (kind == 0) assert_true((double)told > 0.5 * (double)outside);
    }
}

// A ray that leaves a surface as sag_spawn_ray has it, and one that ends on it.
static void test_spawned(void **state) {
    (void)state;
    rng r = rng_make(7);
    size_t left = 0, told[2] = {0};
    for (int i = 0; i < 20000; i++) {
        triangle_ray s = {.ray = {.t_min = -INFINITY, .t_max = INFINITY}};
        triangle_ray_kinds[0].make(&r, rng_log_uniform(&r, 1e-9, 1e9), &s);
        const sag_triangle triangle = {s.a, s.b, s.c, false};
        sag_hit hit;
        if (!sag_ray_is_valid(&s.ray) || !sag_triangle_hit(&triangle, &s.ray, &hit)) continue;
        sag_surface surface;
        sag_triangle_surface(&triangle, &s.ray, &hit, &surface);
        const sag_ray away = sag_spawn_ray(&surface, sag_neg(s.ray.direction));
        sag_ray on = s.ray;
        const sag_vec3 end = away.origin;
        on.direction = sag_sub(end, on.origin), on.t_min = 0;
        left++;
        told[0] += is_beyond(&away, INFINITY, &s);
        told[1] += is_beyond(&on, 1 - 0x1p-53, &s);
    }
    printf("%zu rays: told of those that leave %.3f, of those that end there %.3f\n", left,
           (double)told[0] / (double)left, (double)told[1] / (double)left);
    assert_true((double)told[0] > 0.95 * (double)left);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_never_wrong), cmocka_unit_test(test_spawned)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
