// SPDX-License-Identifier: MIT
// Vectors, frames, boxes and rays.
#include "support/random.h"
#include <float.h>
#include <sagitta/math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static void assert_vec3(sag_vec3 a, double x, double y, double z) {
    assert_true(a.x == x && a.y == y && a.z == z);
}

static void normalize_takes_any_length(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 20000; i++) {
        sag_vec3 d = rng_direction(&r);
        sag_vec3 v = sag_scale(d, ldexp(1 + rng_unit(&r), (int)rng_below(&r, 2040) - 1020));
        sag_vec3 n = sag_normalize(v);
        assert_true(fabs(sag_dot(n, n) - 1) <= 8 * DBL_EPSILON);
        assert_true(sag_length(sag_sub(n, d)) <=
                    (sag_max_component(sag_abs(v)) < 0x1p-960 ? 1e-9 : 4 * DBL_EPSILON));
    }
    assert_vec3(sag_normalize(sag_vec3_make(0, 0, 0)), 0, 0, 0);
    assert_vec3(sag_normalize(sag_vec3_make(0, 0, -4.9406564584124654e-324)), 0, 0, -1);
    assert_vec3(sag_normalize(sag_vec3_make(0, 3, 4)), 0, 3.0 / 5, 4.0 / 5);
    sag_vec3 huge = sag_normalize(sag_vec3_make(DBL_MAX, DBL_MAX, 0));
    assert_true(fabs(huge.x - sqrt(0.5)) < DBL_EPSILON && huge.x == huge.y);
    assert_true(isnan(sag_normalize(sag_vec3_make(NAN, 1, 0)).x));
}

static void frames_are_orthonormal_and_right_handed(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (int i = 0; i < 20000; i++) {
        sag_vec3 n = rng_direction(&r), s, t;
        if (i % 10 == 0) n.z = -1 + (double)(i % 7) * 1e-9, n = sag_normalize(n);
        if (i < 6)
            n = sag_vec3_make(i == 0   ? 1
                              : i == 1 ? -1
                                       : 0,
                              i == 2   ? 1
                              : i == 3 ? -1
                                       : 0,
                              i == 4   ? 1
                              : i == 5 ? -1
                                       : 0);
        if (i == 6) n = sag_vec3_make(0, 0, -1);
        sag_frame(n, &s, &t);
        assert_true(fabs(sag_dot(s, s) - 1) < 1e-14 && fabs(sag_dot(t, t) - 1) < 1e-14);
        assert_true(fabs(sag_dot(s, n)) < 1e-14 && fabs(sag_dot(t, n)) < 1e-14 &&
                    fabs(sag_dot(s, t)) < 1e-14);
        assert_true(sag_length(sag_sub(sag_cross(s, t), n)) < 1e-14);
    }
}

static void boxes_join_and_grow(void **state) {
    (void)state;
    sag_box3 e = sag_box3_empty(), unit = {{0, 0, 0}, {1, 1, 1}}, odd = {{5, 0, 0}, {4, 9, 9}},
             nan = {{NAN, 0, 0}, {1, 1, 1}};
    assert_true(sag_box3_is_empty(&e) && sag_box3_is_empty(&odd) && sag_box3_is_empty(&nan));
    assert_false(sag_box3_is_empty(&unit));
    sag_box3 with[] = {sag_box3_union(e, unit), sag_box3_union(unit, odd), sag_box3_union(nan, unit)};
    for (int i = 0; i < 3; i++) { // an empty box of any form adds nothing
        assert_vec3(with[i].min, 0, 0, 0);
        assert_vec3(with[i].max, 1, 1, 1);
    }
    sag_box3 point = sag_box3_extend(e, sag_vec3_make(1, 2, 3));
    assert_vec3(point.min, 1, 2, 3);
    assert_vec3(point.max, 1, 2, 3);
    assert_false(sag_box3_is_empty(&point));
    sag_box3 both = sag_box3_extend(unit, sag_vec3_make(-1, 0.5, 7));
    assert_vec3(both.min, -1, 0, 0);
    assert_vec3(both.max, 1, 1, 7);
    both = sag_box3_extend(unit, sag_vec3_make(NAN, 9, 9)); // not a point at all
    assert_vec3(both.max, 1, 1, 1);
    both = sag_box3_union(e, e);
    assert_true(sag_box3_is_empty(&both));
}

static void only_sound_rays_are_valid(void **state) {
    (void)state;
    sag_ray ok = sag_ray_make(sag_vec3_make(1, 2, 3), sag_vec3_make(0, 0, -1e-300));
    assert_true(ok.t_min == 0 && ok.t_max == INFINITY && ok.mask == 0);
    assert_true(sag_ray_is_valid(&ok));
    ok.t_min = -INFINITY;
    assert_true(sag_ray_is_valid(&ok));
    ok.t_min = ok.t_max = 5;
    assert_true(sag_ray_is_valid(&ok));
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 6; k++) {
            sag_ray r = ok;
            double *place[] = {&r.origin.x,    &r.origin.y,    &r.origin.z,
                               &r.direction.x, &r.direction.y, &r.direction.z};
            *place[k] = bad[i];
            assert_false(sag_ray_is_valid(&r));
        }
    sag_ray r = ok;
    r.t_min = NAN;
    assert_false(sag_ray_is_valid(&r));
    r = ok, r.t_max = NAN;
    assert_false(sag_ray_is_valid(&r));
    r = ok, r.t_max = 4;
    assert_false(sag_ray_is_valid(&r));
    r = ok, r.direction = sag_vec3_make(0, -0.0, 0);
    assert_false(sag_ray_is_valid(&r));
}

static void rays_are_mapped_with_their_parameter(void **state) {
    (void)state;
    sag_affine a = sag_affine_scale(sag_vec3_make(2, 3, 4));
    a.m[0][3] = 10;
    sag_ray r = {.origin = {1, 1, 1}, .direction = {1, 0, 2}, .t_min = -1, .t_max = 7, .mask = 5};
    sag_ray s = sag_ray_transform(&a, &r);
    assert_vec3(s.origin, 12, 3, 4);
    assert_vec3(s.direction, 2, 0, 8);
    assert_true(s.t_min == -1 && s.t_max == 7 && s.mask == 5);
    sag_vec3 at = sag_ray_at(&s, 3), image = sag_affine_point(&a, sag_ray_at(&r, 3));
    assert_vec3(at, image.x, image.y, image.z);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normalize_takes_any_length),
        cmocka_unit_test(frames_are_orthonormal_and_right_handed),
        cmocka_unit_test(boxes_join_and_grow),
        cmocka_unit_test(only_sound_rays_are_valid),
        cmocka_unit_test(rays_are_mapped_with_their_parameter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
