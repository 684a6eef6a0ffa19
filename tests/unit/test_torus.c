// SPDX-License-Identifier: MIT
// The torus: analytic values, the properties of every shape, and what users of other programs met: starts on
// the surface, spindles, double roots, phantom hits.
#include "support/shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static void values(void **state) {
    (void)state;
    sag_torus torus = {3, 1};
    assert_int_equal(sag_torus_validate(&torus, NULL), SAG_OK);
    sag_ray ray = sag_ray_make((sag_vec3){-8, 0, 0}, (sag_vec3){2, 0, 0});
    sag_hit hits[4];
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 4);
    assert_true(hits[0].t == 2 && hits[1].t == 3 && hits[2].t == 5 && hits[3].t == 6);
    sag_surface s;
    sag_torus_surface(&torus, &ray, &hits[0], &s);
    assert_true(s.position.x == -4 && s.geometric_normal.x == -1 && s.side == SAG_SIDE_FRONT);
    assert_true(s.u == 0.5 && s.v == 0 && s.dpdv.z == 2 * PI && s.dpdu.y == -8 * PI);
    sag_torus_surface(&torus, &ray, &hits[1], &s);
    assert_true(s.geometric_normal.x == 1 && s.v == 0.5 && s.side == SAG_SIDE_BACK);
    // Through the hole, from inside the tube, and downward through it.
    ray = sag_ray_make((sag_vec3){0, 0, 5}, (sag_vec3){0.1, 0.1, -1});
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 0);
    ray = sag_ray_make((sag_vec3){0, 3, 0}, (sag_vec3){0, 0, 4});
    assert_true(sag_torus_hit(&torus, &ray, hits) && hits[0].t == 0.25);
    assert_true(fabs(sag_torus_area(&torus) - 4 * PI * PI * 3) < 1e-13);
    assert_true(fabs(sag_torus_volume(&torus) - 2 * PI * PI * 3) < 1e-13);
    assert_true(sag_torus_contains(&torus, (sag_vec3){0, 4, 0}));
    assert_false(sag_torus_contains(&torus, (sag_vec3){0, nextafter(4, 5), 0}));
    assert_false(sag_torus_contains(&torus, (sag_vec3){0, 0, 0}));
    // A lens' worth: R = 0 is a sphere, for area and volume too.
    sag_torus ball = {0, 2};
    assert_true(fabs(sag_torus_area(&ball) - 16 * PI) < 1e-13);
    assert_true(fabs(sag_torus_volume(&ball) - 32 * PI / 3) < 1e-13);
    ray = sag_ray_make((sag_vec3){0, 0, -5}, (sag_vec3){0, 0, 1});
    assert_int_equal(sag_torus_crossings(&ball, &ray, hits, 4), 2);
    assert_true(hits[0].t == 3 && hits[1].t == 7);
}

// Tangents: 0 or 2, and the t of a double root as good as any other.
static void tangents(void **state) {
    (void)state;
    sag_torus torus = {3, 1};
    sag_hit hits[4];
    // The outer equator and the top circle along and across it, the hole's equator, the plane z = 1 slanted.
    const sag_ray rays[5] = {
        sag_ray_make((sag_vec3){4, -7, 0}, (sag_vec3){0, 1, 0}),
        sag_ray_make((sag_vec3){3, -7, 1}, (sag_vec3){0, 1, 0}),
        sag_ray_make((sag_vec3){-7, 0, 1}, (sag_vec3){1, 0, 0}),
        sag_ray_make((sag_vec3){2, -7, 0}, (sag_vec3){0, 1, 0}),
        sag_ray_make((sag_vec3){-5, -5, 1}, (sag_vec3){1, 1, 0}),
    };
    const size_t counts[5] = {2, 2, 4, 4, 4};
    for (int i = 0; i < 5; i++) assert_int_equal(sag_torus_crossings(&torus, &rays[i], hits, 4), counts[i]);
    assert_int_equal(sag_torus_crossings(&torus, &rays[0], hits, 4), 2);
    assert_true(hits[0].t == 7 && hits[1].t == 7);
    assert_int_equal(sag_torus_crossings(&torus, &rays[1], hits, 4), 2); // a root of order four
    assert_true(hits[0].t == 7 && hits[1].t == 7);
    assert_int_equal(sag_torus_crossings(&torus, &rays[2], hits, 4), 4); // two double roots
    assert_true(hits[0].t == 4 && hits[1].t == 4 && hits[2].t == 10 && hits[3].t == 10);
    assert_int_equal(sag_torus_crossings(&torus, &rays[3], hits, 4), 4);
    assert_true(hits[1].t == 7 && hits[2].t == 7);
    // One double off either way is decided.
    sag_ray ray = rays[0];
    ray.origin.x = nextafter(4, 5);
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 0);
    ray.origin.x = nextafter(4, 3);
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 2);
    assert_true(hits[0].t < 7 && hits[1].t > 7);
    ray = rays[2];
    ray.origin.z = nextafter(1, 0);
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 4);
    ray.origin.z = nextafter(1, 2);
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 0);
}

// openmc-1933, openmc-2053: a particle that starts on a torus of R = 139 or R = 1000 met it again at once (or
// never), because the constant term of the quartic was compared with 1e-10 or 1e-9.
static void openmc_1933_2053_start_on_torus(void **state) {
    (void)state;
    const double majors[4] = {139, 1000, 1e-6, 1e8}, ratios[3] = {0.5, 0.01, 0.9};
    rng r = rng_make(41);
    for (int i = 0; i < 12; i++) {
        sag_torus torus = {majors[i % 4], majors[i % 4] * ratios[i % 3]};
        double reach = torus.major_radius + torus.minor_radius;
        sag_hit hits[4];
        // Exactly on it: t = 0 is a crossing, the first.
        sag_ray ray = sag_ray_make((sag_vec3){reach, 0, 0}, (sag_vec3){-1, 0, 0});
        if (reach - torus.major_radius == torus.minor_radius) {
            assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 4);
            assert_true(hits[0].t == 0 && fabs(hits[1].t / torus.minor_radius - 2) < 1e-12);
            ray.direction.x = 1;
            assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 1);
        }
        // From a hit on, the spawned ray leaves, whichever way it goes.
        for (int k = 0; k < 300; k++) {
            sag_surface s;
            assert_true(sag_torus_sample(&torus, rng_vec2(&r), &s));
            sag_vec3 d = rng_direction(&r);
            if (sag_dot(d, s.geometric_normal) > 0) d = sag_neg(d);
            ray = sag_spawn_ray(&s, d);
            size_t n = sag_torus_crossings(&torus, &ray, hits, 4);
            assert_true(n == 1 || n == 3);
            ray = sag_spawn_ray(&s, sag_neg(d));
            n = sag_torus_crossings(&torus, &ray, hits, 4);
            assert_true(n == 0 || n == 2);
        }
    }
}

// openmc-2589: the spindle torus. Its axis points, the lens, and the sheet within.
static void openmc_2589_spindle(void **state) {
    (void)state;
    sag_torus torus = {3, 5}; // meets itself at z = ±4
    sag_hit hits[4];
    sag_ray ray = sag_ray_make((sag_vec3){-10, 0, 0}, (sag_vec3){1, 0, 0});
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 4);
    assert_true(hits[0].t == 2 && hits[1].t == 8 && hits[2].t == 12 && hits[3].t == 18);
    sag_surface s;
    sag_torus_surface(&torus, &ray, &hits[1], &s); // the lens' left end, seen from the tube: R + r cos π = −2
    assert_true(s.position.x == -2 && fabs(s.geometric_normal.x) == 1 && s.v == 0.5 && s.u == 0);
    // Down the axis: through both points where it meets itself, each a double root.
    ray = sag_ray_make((sag_vec3){0, 0, 10}, (sag_vec3){0, 0, -1});
    assert_int_equal(sag_torus_crossings(&torus, &ray, hits, 4), 4);
    assert_true(hits[0].t == 6 && hits[1].t == 6 && hits[2].t == 14 && hits[3].t == 14);
    // The same with a double root that is no double: z = ±√3.
    sag_torus other = {1, 2};
    assert_int_equal(sag_torus_crossings(&other, &ray, hits, 4), 4);
    assert_true(fabs(hits[0].t - (10 - sqrt(3))) < 4e-15 && hits[1].t == hits[0].t);
    // The horn torus touches itself in the center.
    sag_torus horn = {2, 2};
    assert_int_equal(sag_torus_crossings(&horn, &ray, hits, 4), 2);
    assert_true(hits[0].t == 10 && hits[1].t == 10);
    assert_true(sag_torus_contains(&torus, (sag_vec3){0, 0, 0}) &&
                sag_torus_contains(&torus, (sag_vec3){0, 0, 4}));
    assert_false(sag_torus_contains(&torus, (sag_vec3){0, 0, 4.0001}));
}

// pov-358: roots of the quartic were off by up to 0.1. rayx-467: Newton found four times as many hits as
// there are. Here: every crossing is on the torus, and their number is that of the changes of sign along the
// ray.
static void pov_358_rayx_467_roots_are_roots(void **state) {
    (void)state;
    rng r = rng_make(42);
    for (int i = 0; i < 20000; i++) {
        sag_torus torus = {rng_log_uniform(&r, 0.1, 10), rng_log_uniform(&r, 0.01, 10)};
        double reach = torus.major_radius + torus.minor_radius;
        sag_vec3 o = rng_vec3(&r, 2 * reach), target = rng_vec3(&r, reach);
        target.z = rng_uniform(&r, -1, 1) * torus.minor_radius;
        sag_ray ray = sag_ray_make(o, sag_sub(target, o));
        ray.t_min = -INFINITY;
        sag_hit hits[4];
        size_t n = sag_torus_crossings(&torus, &ray, hits, 4);
        for (size_t k = 0; k < n; k++) {
            sag_vec3 p = sag_ray_at(&ray, hits[k].t);
            double rho = hypot(p.x, p.y), outer = hypot(rho - torus.major_radius, p.z),
                   inner = hypot(rho + torus.major_radius, p.z);
            double off = fmin(fabs(outer - torus.minor_radius), fabs(inner - torus.minor_radius));
            assert_true(off <= 1e-14 * (reach + sag_length(o)));
        }
        assert_true(n % 2 == 0);
        // Between crossings F has alternating signs.
        for (size_t k = 0; k + 1 < n; k++) {
            if (!(hits[k + 1].t - hits[k].t > 1e-6)) continue;
            sag_vec3 p = sag_ray_at(&ray, 0.5 * (hits[k].t + hits[k + 1].t));
            double rho = hypot(p.x, p.y);
            double f = (hypot(rho - torus.major_radius, p.z) - torus.minor_radius) *
                       (hypot(rho + torus.major_radius, p.z) - torus.minor_radius);
            assert_true((f < 0) == (k % 2 == 0));
        }
    }
}

static void properties(void **state) {
    (void)state;
    rng r = rng_make(43);
    const double ratios[8] = {0.3, 0.9, 1, 1.5, 20, 0.01, 0.6, 3};
    for (int i = 0; i < 24; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_torus torus = {scale, scale * ratios[i % 8]};
        if (i == 23) torus.major_radius = 0;
        shape_case c = {&sagi_shape_classes[SAG_SHAPE_TORUS],
                        &torus,
                        {0, 0, 0},
                        torus.major_radius + torus.minor_radius,
                        LEAVING_ANY};
        assert_int_equal(sag_torus_validate(&torus, NULL), SAG_OK);
        check_verbs(&c, &r, 1000);
        check_surfaces(&c, &r, 1000);
        check_spawned(&c, &r, 1000);
        check_closest_point(&c, &r, 100);
        check_bad_rays(&c);
        if (i < 8 || i == 23) check_area_and_samples(&c, &r, 8000), check_volume(&c, &r, 8000);
    }
}

static void messages(void **state) {
    (void)state;
    sag_error error;
    sag_torus torus = {-1, 2};
    assert_int_equal(sag_torus_validate(&torus, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "torus: major_radius -1"));
    torus = (sag_torus){1, 0};
    assert_int_equal(sag_torus_validate(&torus, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "torus: minor_radius 0"));
    torus.minor_radius = NAN;
    sag_ray ray = sag_ray_make((sag_vec3){0, 0, -5}, (sag_vec3){0, 0, 1});
    assert_false(sag_torus_occluded(&torus, &ray));
    sag_box3 box = sag_torus_bounds(&torus);
    assert_true(sag_box3_is_empty(&box));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values),
        cmocka_unit_test(tangents),
        cmocka_unit_test(openmc_1933_2053_start_on_torus),
        cmocka_unit_test(openmc_2589_spindle),
        cmocka_unit_test(pov_358_rayx_467_roots_are_roots),
        cmocka_unit_test(properties),
        cmocka_unit_test(messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
