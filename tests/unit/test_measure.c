// SPDX-License-Identifier: MIT
// Closest approach of rays, barycentric coordinates and signed areas.
#include "support/random.h"
#include <sagitta/shapes.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static sag_ray ray_of(double ox, double oy, double oz, double dx, double dy, double dz) {
    return sag_ray_make(sag_vec3_make(ox, oy, oz), sag_vec3_make(dx, dy, dz));
}

static void test_known_approaches(void **state) {
    (void)state;
    sag_closest_approach c;
    sag_ray x = ray_of(-2, 0, 0, 2, 0, 0), y = ray_of(0, 3, 5, 0, -1, 0);
    assert_true(sag_ray_ray_closest(&x, &y, &c));
    assert_true(c.t_a == 1 && c.t_b == 3 && c.distance == 5 && !c.parallel && c.b.z == 5);
    x.t_max = 0.5; // the nearest point is out of range: the end is nearest
    assert_true(sag_ray_ray_closest(&x, &y, &c) && c.t_a == 0.5 && c.t_b == 3);
    sag_ray beside = ray_of(5, 1, 0, -1, 0, 0);
    x.t_max = INFINITY;
    assert_true(sag_ray_ray_closest(&x, &beside, &c));
    assert_true(c.parallel && c.t_a == 0 && c.t_b == 7 && c.distance == 1);
    sag_ray ahead = ray_of(4, 1, 0, 3, 0, 0);
    assert_true(sag_ray_ray_closest(&x, &ahead, &c) && c.parallel && c.t_a == 3 && c.t_b == 0);
    x.t_max = 1; // no longer side by side
    assert_true(sag_ray_ray_closest(&x, &ahead, &c) && c.t_a == 1 && c.t_b == 0 && c.distance == sqrt(17));
    sag_ray line = {{0, 0, 0}, {1, 0, 0}, -INFINITY, INFINITY, 0},
            other = {{9, 0, 2}, {-4, 0, 0}, -INFINITY, INFINITY, 0};
    assert_true(sag_ray_ray_closest(&line, &other, &c) && c.t_a == 0 && c.distance == 2);
    x.direction.x = NAN;
    c.t_a = 42;
    assert_false(sag_ray_ray_closest(&x, &ahead, &c));
    assert_true(c.t_a == 42);
}

// No pair of points within the ranges is nearer, at any scale and length of direction.
static void test_approach_is_closest(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 20000; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9), length = rng_log_uniform(&r, 1e-100, 1e100);
        sag_ray a = {rng_vec3(&r, scale), sag_scale(rng_direction(&r), length), 0, scale / length, 0};
        sag_ray b = {rng_vec3(&r, scale), rng_direction(&r), -scale, rng_one_in(&r, 2) ? scale : INFINITY, 0};
        if (rng_one_in(&r, 10)) b.direction = sag_scale(a.direction, rng_one_in(&r, 2) ? -0.5 : 2);
        sag_closest_approach c;
        if (b.t_max < b.t_min || !sag_ray_ray_closest(&a, &b, &c)) continue;
        assert_true(c.t_a >= a.t_min && c.t_a <= a.t_max && c.t_b >= b.t_min && c.t_b <= b.t_max);
        assert_true(fabs(sag_length(sag_sub(c.a, c.b)) - c.distance) <= 1e-9 * scale);
        for (int k = 0; k < 10; k++) {
            double t_a = rng_uniform(&r, a.t_min, a.t_max), near = rng_one_in(&r, 2) ? 1 : 1e-3;
            double t_b = c.t_b + near * scale * rng_uniform(&r, -1, 1) / sag_length(b.direction);
            if (rng_one_in(&r, 2)) t_a = c.t_a + 1e-3 * (t_a - c.t_a);
            t_b = fmin(fmax(t_b, b.t_min), b.t_max);
            double distance = sag_length(sag_sub(sag_ray_at(&a, t_a), sag_ray_at(&b, t_b)));
            assert_true(distance >= c.distance - 1e-9 * scale);
        }
    }
}

static void test_barycentric(void **state) {
    (void)state;
    double w[3] = {7, 7, 7};
    assert_true(sag_barycentric_1d(1, 0, 4, w) && w[0] == 0.75 && w[1] == 0.25);
    assert_false(sag_barycentric_1d(1, 4, 4, w));
    assert_false(sag_barycentric_1d(NAN, 0, 4, w) || sag_barycentric_1d(1, -INFINITY, 4, w));
    assert_false(
        sag_barycentric_2d((sag_vec2){NAN, 1}, (sag_vec2){0, 0}, (sag_vec2){4, 0}, (sag_vec2){0, 2}, w));
    assert_true(
        sag_barycentric_2d((sag_vec2){1, 1}, (sag_vec2){0, 0}, (sag_vec2){4, 0}, (sag_vec2){0, 2}, w));
    assert_true(w[0] == 0.25 && w[1] == 0.25 && w[2] == 0.5);
    w[0] = 7;
    assert_false(
        sag_barycentric_2d((sag_vec2){1, 1}, (sag_vec2){0, 0}, (sag_vec2){1, 2}, (sag_vec2){2, 4}, w));
    assert_false(sag_barycentric_3d((sag_vec3){1, 1, 1}, (sag_vec3){0, 0, 0}, (sag_vec3){1, 2, 3},
                                    (sag_vec3){2, 4, 6}, w));
    assert_true(w[0] == 7);
    rng r = rng_make(2);
    for (int i = 0; i < 20000; i++) {
        double scale = rng_log_uniform(&r, 1e-100, 1e25);
        sag_vec3 a = rng_vec3(&r, scale), b = rng_vec3(&r, scale), c = rng_vec3(&r, scale);
        if (rng_one_in(&r, 2)) // a needle
            c = sag_madd(sag_madd(a, rng_unit(&r), sag_sub(b, a)), rng_double(&r, -45, -10),
                         rng_vec3(&r, scale));
        double u = rng_uniform(&r, -2, 2), v = rng_uniform(&r, -2, 2);
        sag_vec3 p = sag_madd(sag_madd(a, u, sag_sub(b, a)), v, sag_sub(c, a));
        if (!sag_barycentric_3d(p, a, b, c, w)) continue;
        sag_vec3 back = sag_add(sag_add(sag_scale(a, w[0]), sag_scale(b, w[1])), sag_scale(c, w[2]));
        double size = fabs(w[0]) + fabs(w[1]) + fabs(w[2]);
        assert_true(sag_length(sag_sub(back, p)) <= 1e-12 * scale * size);
        assert_true(fabs(w[0] + w[1] + w[2] - 1) <= 1e-15 * size);
    }
}

// The sign of an area is exact: at points that differ in the last bit, and where the area underflows.
static void test_areas(void **state) {
    (void)state;
    const sag_vec2 a = {0, 0}, b = {4, 0}, c = {0, 2};
    assert_true(sag_triangle_signed_area_2d(a, b, c) == 4 && sag_triangle_signed_area_2d(a, c, b) == -4);
    assert_true(sag_triangle_area_2d(a, c, b) == 4);
    const sag_vec2 p = {0.5, 0.5}, q = {12, 12}, s = {24, 24};
    for (int i = -50; i <= 50; i++) {
        sag_vec2 moved = {p.x,
                          p.y + i * 0x1p-53}; // Kettner et al., "Classroom Examples of Robustness Problems"
        double area = sag_triangle_signed_area_2d(moved, q, s);
        assert_true((area > 0) == (moved.y > moved.x) && (area < 0) == (moved.y < moved.x));
    }
    const sag_vec2 tiny[3] = {{0, 0}, {1e-200, 0}, {0, 1e-200}};
    assert_true(sag_triangle_signed_area_2d(tiny[0], tiny[1], tiny[2]) > 0);
    assert_true(sag_triangle_signed_area_2d(tiny[0], tiny[2], tiny[1]) < 0);
    double w[3];
    assert_true(sag_barycentric_2d((sag_vec2){0.25e-200, 0.5e-200}, tiny[0], tiny[1], tiny[2], w));
    assert_true(fabs(w[1] - 0.25) < 1e-15 && fabs(w[2] - 0.5) < 1e-15);

    const sag_vec3 o = {0, 0, 0}, x = {3, 0, 0}, y = {0, 0, 4};
    assert_true(sag_triangle_area_3d(o, x, y) == 6);
    assert_true(sag_triangle_signed_area_3d(o, x, y, (sag_vec3){0, -2, 5}) == 6);
    assert_true(sag_triangle_signed_area_3d(o, x, y, (sag_vec3){0, 1e-270, 5}) == -6);
    assert_true(sag_triangle_signed_area_3d(o, x, y, (sag_vec3){1, 0, 5}) == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_known_approaches),
                                       cmocka_unit_test(test_approach_is_closest),
                                       cmocka_unit_test(test_barycentric), cmocka_unit_test(test_areas)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
