// SPDX-License-Identifier: MIT
// The shape of docs/adding-a-shape.md: what every shape is tested for, and what this one is for. Start the
// test of a new shape from this file.
#include "../../docs/skeleton/trough.h"
#include "support/shape_kind.h"
#include "support/shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

SHAPE_KIND(trough)

static const sag_trough mirror = {.focal_length = 1.5, .half_width = 2, .half_length = 3};

static void properties_of(const sag_trough *s, uint64_t seed) {
    sag_box3 box = sag_trough_bounds(s);
    shape_case c = {.kind = &trough_kind, .shape = s, .leaving = LEAVING_ANY};
    c.center = sag_scale(sag_add(box.min, box.max), 0.5);
    c.radius = 1.01 * sag_length(sag_sub(box.max, c.center));
    rng r = rng_make(seed);
    check_verbs(&c, &r, 5000);
    check_surfaces(&c, &r, 2000);
    check_spawned(&c, &r, 2000);
    check_area_and_samples(&c, &r, 20000);
    check_bad_rays(&c);
}

static void it_is_a_shape_at_every_scale(void **state) {
    (void)state;
    properties_of(&mirror, 1);
    properties_of(&(sag_trough){.focal_length = 1.5e9, .half_width = 2e9, .half_length = 1e9}, 2);
    properties_of(&(sag_trough){.focal_length = 1.5e-9, .half_width = 2e-9, .half_length = 4e-9}, 3);
    properties_of(&(sag_trough){.focal_length = 100, .half_width = 1, .half_length = 1}, 4); // nearly flat
}

// Analytic: down on x = 1 the mirror is at z = 1/(4f).
static void known_values(void **state) {
    (void)state;
    sag_hit hit;
    sag_ray ray = sag_ray_make(sag_vec3_make(1, 0, 10), sag_vec3_make(0, 0, -2));
    assert_true(sag_trough_hit(&mirror, &ray, &hit));
    assert_true(fabs(hit.t - (10 - 1 / 6.0) / 2) <= 4 * 0x1p-51);
    ray = sag_ray_make(sag_vec3_make(-5, 0, 0.5),
                       sag_vec3_make(1, 0, 0)); // across, through both walls: x = ∓√3
    sag_hit hits[4];
    assert_int_equal(sag_trough_crossings(&mirror, &ray, hits, 4), 2);
    assert_true(fabs(hits[0].t - (5 - sqrt(3.0))) < 1e-15 && fabs(hits[1].t - (5 + sqrt(3.0))) < 2e-15);
    ray.origin.z = 0.7; // above the rim
    assert_int_equal(sag_trough_crossings(&mirror, &ray, hits, 4), 0);
    ray = sag_ray_make(sag_vec3_make(0, -9, 0),
                       sag_vec3_make(0, 1, 0)); // along the vertex line, in the surface
    assert_true(sag_trough_crossings(&mirror, &ray, hits, 4) % 2 == 0);
}

// What it is built for: light that comes along −z goes through the focal line.
static void it_focuses(void **state) {
    (void)state;
    rng r = rng_make(5);
    for (int i = 0; i < 2000; i++) {
        sag_vec3 down = sag_vec3_make(0, 0, -1);
        sag_ray ray = sag_ray_make(sag_vec3_make(rng_uniform(&r, -2, 2), rng_uniform(&r, -3, 3), 50), down);
        sag_hit hit;
        sag_surface s;
        assert_true(sag_trough_hit(&mirror, &ray, &hit));
        sag_trough_surface(&mirror, &ray, &hit, &s);
        assert_int_equal(s.side, SAG_SIDE_FRONT);
        sag_vec3 n = s.geometric_normal, mirrored = sag_madd(down, -2 * sag_dot(down, n), n);
        sag_ray away = sag_spawn_ray(&s, mirrored);
        assert_false(sag_trough_occluded(&mirror, &away));
        if (fabs(s.position.x) < 1e-6) continue; // comes back up the way it went
        double t = -away.origin.x / mirrored.x;
        assert_true(fabs(away.origin.z + t * mirrored.z - mirror.focal_length) < 1e-12);
    }
}

static void bad_shapes_are_refused(void **state) {
    (void)state;
    const double bad[] = {0, -1, NAN, INFINITY, 0x1p101};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 3; k++) {
            sag_trough s = mirror;
            double *field[] = {&s.focal_length, &s.half_width, &s.half_length};
            *field[k] = bad[i];
            sag_error error;
            assert_int_equal(sag_trough_validate(&s, &error), SAG_ERROR_GEOMETRY);
            sag_ray ray = sag_ray_make(sag_vec3_make(0.5, 0, 10), sag_vec3_make(0, 0, -1));
            sag_box3 box = sag_trough_bounds(&s);
            assert_false(sag_trough_occluded(&s, &ray));
            assert_true(sag_box3_is_empty(&box) && sag_trough_area(&s) == 0);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_a_shape_at_every_scale),
        cmocka_unit_test(known_values),
        cmocka_unit_test(it_focuses),
        cmocka_unit_test(bad_shapes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
