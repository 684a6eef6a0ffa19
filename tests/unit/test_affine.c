// SPDX-License-Identifier: MIT
// Affine maps: rotation by right angles, inverse, determinant, conservative boxes.
#include "math/affine_inverse.h"
#include "support/random.h"
#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

static void assert_same(const sag_affine *a, const sag_affine *b, double tolerance) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) assert_true(fabs(a->m[i][j] - b->m[i][j]) <= tolerance);
}

static void right_angles_are_exact(void **state) {
    (void)state;
    for (int degrees = -3600; degrees <= 3600; degrees += 90) {
        double ways[] = {degrees * pi / 180, degrees / 180.0 * pi, degrees * (pi / 180),
                         degrees * 0.017453292519943295};
        const double sines[] = {0, 1, 0, -1};
        int quarter = ((degrees / 90) % 4 + 4) % 4;
        double s = sines[quarter], c = sines[(quarter + 1) % 4];
        for (int w = 0; w < 4; w++) {
            sag_affine z = sag_affine_rotate(ways[w], sag_vec3_make(0, 0, 7));
            sag_affine expected = {{{c, -s, 0, 0}, {s, c, 0, 0}, {0, 0, 1, 0}}};
            assert_same(&z, &expected, 0);
            sag_affine x = sag_affine_rotate(ways[w], sag_vec3_make(1e-200, 0, 0));
            expected = (sag_affine){{{1, 0, 0, 0}, {0, c, -s, 0}, {0, s, c, 0}}};
            assert_same(&x, &expected, 0);
        }
    }
    // Angles that are merely near one keep their difference.
    sag_affine near = sag_affine_rotate(pi / 2 + 1e-14, sag_vec3_make(0, 0, 1));
    assert_true(near.m[0][0] < -0.9e-14 && near.m[0][0] > -1.1e-14);
    near = sag_affine_rotate(1e-300, sag_vec3_make(0, 0, 1));
    assert_true(near.m[1][0] == 1e-300);
}

static void rotations_are_rigid(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 5000; i++) {
        sag_vec3 axis = sag_scale(rng_direction(&r), rng_log_uniform(&r, 1e-9, 1e9));
        double angle = rng_uniform(&r, -10, 10);
        sag_affine a = sag_affine_rotate(angle, axis), back = sag_affine_rotate(-angle, axis);
        sag_affine product = sag_affine_multiply(&a, &back), one = sag_affine_identity();
        assert_same(&product, &one, 1e-14);
        assert_true(fabs(sag_affine_determinant(&a) - 1) < 1e-14);
        sag_vec3 kept = sag_affine_vector(&a, axis);
        assert_true(sag_length(sag_sub(kept, axis)) <= 1e-14 * sag_length(axis));
    }
    sag_affine none = sag_affine_rotate(1, sag_vec3_make(0, 0, 0));
    assert_true(sag_affine_is_identity(&none));
    assert_true(!sag_affine_is_identity(&(sag_affine){0}));
}

static void along_points_the_z_axis(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (int i = 0; i < 2000; i++) {
        sag_vec3 from = rng_vec3(&r, 10), to = rng_vec3(&r, 10);
        sag_affine a = sag_affine_along(from, to);
        double length = sag_length(sag_sub(to, from));
        sag_vec3 tip = sag_affine_point(&a, sag_vec3_make(0, 0, length));
        assert_true(sag_length(sag_sub(tip, to)) < 1e-13);
        assert_true(fabs(sag_affine_determinant(&a) - 1) < 1e-14);
    }
    sag_affine up = sag_affine_along(sag_vec3_make(0, 0, 0), sag_vec3_make(0, 0, 3));
    assert_true(sag_affine_is_identity(&up));
    sag_affine still = sag_affine_along(sag_vec3_make(1, 2, 3), sag_vec3_make(1, 2, 3));
    assert_true(still.m[0][3] == 1 && still.m[0][0] == 1 && still.m[2][2] == 1);
    sag_affine far = sag_affine_along(sag_vec3_make(-1.5e308, 0, 0), sag_vec3_make(1.5e308, 0, 0));
    assert_true(far.m[0][2] == 1);
}

static sag_affine random_map(rng *r, int exponent) {
    sag_affine a;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) a.m[i][j] = rng_double(r, -exponent, exponent);
    return a;
}

static void inverse_undoes(void **state) {
    (void)state;
    rng r = rng_make(3);
    for (int i = 0; i < 5000; i++) {
        sag_affine a = random_map(&r, 2), inverse, twice;
        assert_true(sag_affine_inverse(&a, &inverse));
        assert_true(sag_affine_inverse(&inverse, &twice));
        double largest = 0;
        for (int k = 0; k < 12; k++) largest = fmax(largest, fabs(inverse.m[k / 4][k % 4]));
        sag_affine product = sag_affine_multiply(&a, &inverse), one = sag_affine_identity();
        assert_same(&product, &one, 64 * DBL_EPSILON * (1 + largest));
        assert_true(fabs(sag_affine_determinant(&a) * sag_affine_determinant(&inverse) - 1) <
                    1e-12 * (1 + largest * largest));
    }
    // Scales far apart, with no product in range: exact all the same.
    sag_affine wide = sag_affine_scale(sag_vec3_make(0x1p900, 0x1p-900, -0x1p400)), inverse;
    wide.m[0][3] = 0x1p901, wide.m[1][3] = 0x1p-899, wide.m[2][3] = 3;
    assert_true(sag_affine_inverse(&wide, &inverse));
    sag_affine expected = sag_affine_scale(sag_vec3_make(0x1p-900, 0x1p900, -0x1p-400));
    expected.m[0][3] = -2, expected.m[1][3] = -2, expected.m[2][3] = 3 * 0x1p-400;
    assert_same(&inverse, &expected, 0);
    assert_true(sag_affine_determinant(&wide) == -0x1p400);
}

// What is seen at once is what the inverse says.
static void to_have_an_inverse_is_to_find_one(void **state) {
    (void)state;
    rng r = rng_make(11);
    int with = 0, without = 0;
    for (int i = 0; i < 20000; i++) {
        sag_affine a = random_map(&r, 2), inverse;
        if (i % 4 == 1) // singular, or by one ulp not
            for (int j = 0; j < 3; j++) {
                a.m[0][j] = (double)(float)a.m[0][j], a.m[1][j] = (double)(float)a.m[1][j];
                a.m[2][j] = a.m[0][j] + a.m[1][j];
            }
        if (i % 8 == 5) a.m[2][1] = nextafter(a.m[2][1], INFINITY);
        if (i % 4 == 2) // of any scale
            for (int k = 0; k < 12; k++)
                a.m[k / 4][k % 4] = ldexp(a.m[k / 4][k % 4], (int)rng_below(&r, 2100) - 1050);
        if (i % 4 == 3) // with zeros
            for (int k = 0; k < 9; k++)
                if (rng_one_in(&r, 3)) a.m[k / 3][k % 3] = 0;
        const bool has = sag_affine_inverse(&a, &inverse);
        assert_true(sagi_affine_has_inverse(&a) == has);
        assert_true(sagi_affine_is_mirror(&a) == (sag_affine_determinant(&a) < 0));
        with += has, without += !has;
    }
    assert_true(with > 5000 && without > 3000);
}

static void singular_is_decided_exactly(void **state) {
    (void)state;
    rng r = rng_make(4);
    sag_affine untouched = sag_affine_identity();
    for (int i = 0; i < 5000; i++) {
        // Third row = first + second with few enough bits that it is exact: singular. One ulp more: not.
        sag_affine a = random_map(&r, 2);
        for (int j = 0; j < 3; j++) {
            a.m[0][j] = (double)(float)a.m[0][j], a.m[1][j] = (double)(float)a.m[1][j];
            a.m[2][j] = a.m[0][j] + a.m[1][j];
        }
        assert_false(sag_affine_inverse(&a, &untouched));
        assert_true(sag_affine_determinant(&a) == 0);
        a.m[2][1] = nextafter(a.m[2][1], INFINITY);
        double minor = a.m[0][2] * a.m[1][0] - a.m[0][0] * a.m[1][2];
        if (minor == 0) continue;
        double d = sag_affine_determinant(&a);
        assert_true(d != 0 && (d > 0) == (minor > 0));
        sag_affine inverse;
        assert_true(sag_affine_inverse(&a, &inverse));
    }
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 12; k++) {
            sag_affine a = sag_affine_identity();
            a.m[k / 4][k % 4] = bad[i];
            assert_false(sag_affine_inverse(&a, &untouched));
        }
    sag_affine zero = {0}, flat = sag_affine_scale(sag_vec3_make(1, 1, 0)),
               thin = sag_affine_scale(sag_vec3_make(1e-310, 1, 1));
    assert_false(sag_affine_inverse(&zero, &untouched));
    assert_false(sag_affine_inverse(&flat, &untouched));
    assert_false(sag_affine_inverse(&thin, &untouched)); // the inverse is not finite
    assert_true(sag_affine_is_identity(&untouched));
}

static void normals_go_with_the_inverse_transposed(void **state) {
    (void)state;
    rng r = rng_make(5);
    for (int i = 0; i < 2000; i++) {
        sag_affine a = random_map(&r, 1), inverse;
        if (!sag_affine_inverse(&a, &inverse)) continue;
        sag_vec3 s = rng_direction(&r), t = rng_direction(&r), n = sag_cross(s, t);
        sag_vec3 m = sag_affine_transposed(&inverse, n), u = sag_affine_vector(&a, s),
                 v = sag_affine_vector(&a, t);
        assert_true(fabs(sag_dot(m, u)) <= 1e-12 * sag_length(m) * sag_length(u));
        assert_true(fabs(sag_dot(m, v)) <= 1e-12 * sag_length(m) * sag_length(v));
    }
}

static void boxes_hold_their_image(void **state) {
    (void)state;
    rng r = rng_make(6);
    for (int i = 0; i < 5000; i++) {
        int range = i % 3 == 0 ? 1 : i % 3 == 1 ? 40 : 400;
        sag_affine a = random_map(&r, range);
        sag_vec3 p = {rng_double(&r, -range, range), rng_double(&r, -range, range),
                      rng_double(&r, -range, range)};
        sag_vec3 q = {rng_double(&r, -range, range), rng_double(&r, -range, range),
                      rng_double(&r, -range, range)};
        sag_box3 box = sag_box3_extend(sag_box3_extend(sag_box3_empty(), p), q),
                 image = sag_affine_box(&a, &box);
        for (int corner = 0; corner < 8; corner++) {
            long double c[3] = {corner & 1 ? p.x : q.x, corner & 2 ? p.y : q.y, corner & 4 ? p.z : q.z};
            for (int k = 0; k < 3; k++) {
                long double v = a.m[k][0] * c[0] + a.m[k][1] * c[1] + a.m[k][2] * c[2] + a.m[k][3];
                assert_true(v >= sag_component(image.min, k) && v <= sag_component(image.max, k));
            }
        }
    }
}

static void exact_images_keep_their_bits(void **state) {
    (void)state;
    sag_box3 box = {{-1, 0.1, 3}, {1, 0.7, 1e9}};
    sag_affine one = sag_affine_identity(), turn = sag_affine_rotate(pi / 2, sag_vec3_make(0, 0, 1));
    sag_box3 same = sag_affine_box(&one, &box), turned = sag_affine_box(&turn, &box);
    assert_true(same.min.x == -1 && same.min.y == 0.1 && same.min.z == 3 && same.max.x == 1 &&
                same.max.z == 1e9);
    assert_true(turned.min.x == -0.7 && turned.max.x == -0.1 && turned.min.y == -1 && turned.max.y == 1);
}

static void infinite_boxes_stay_infinite(void **state) {
    (void)state;
    double inf = INFINITY;
    sag_box3 slab = {{-inf, -1, -inf}, {inf, 1, inf}}, half = {{0, 0, 0}, {inf, 1, 1}};
    sag_affine turn = sag_affine_rotate(pi / 2, sag_vec3_make(0, 0, 1)),
               tilt = sag_affine_rotate(0.3, sag_vec3_make(0, 0, 1));
    sag_box3 b = sag_affine_box(&turn, &slab);
    assert_true(b.min.x == -1 && b.max.x == 1 && b.min.y == -inf && b.max.y == inf && b.max.z == inf);
    b = sag_affine_box(&tilt, &slab);
    assert_true(b.min.x == -inf && b.max.x == inf && b.min.y == -inf);
    sag_affine mirror = sag_affine_scale(sag_vec3_make(-2, 1, 1));
    b = sag_affine_box(&mirror, &half);
    assert_true(b.min.x == -inf && b.max.x == 0 && b.max.y == 1);
    sag_affine huge = sag_affine_scale(sag_vec3_make(1e300, 1, 1));
    sag_box3 far = {{1e200, 0, 0}, {2e200, 1, 1}};
    b = sag_affine_box(&huge, &far); // the image overflows: still inside
    assert_true(b.max.x == inf && b.min.x <= DBL_MAX && !sag_box3_is_empty(&b));
    sag_box3 empty = {{1, 0, 0}, {0, 1, 1}};
    b = sag_affine_box(&tilt, &empty);
    assert_true(sag_box3_is_empty(&b));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_angles_are_exact),
        cmocka_unit_test(rotations_are_rigid),
        cmocka_unit_test(along_points_the_z_axis),
        cmocka_unit_test(inverse_undoes),
        cmocka_unit_test(to_have_an_inverse_is_to_find_one),
        cmocka_unit_test(singular_is_decided_exactly),
        cmocka_unit_test(normals_go_with_the_inverse_transposed),
        cmocka_unit_test(boxes_hold_their_image),
        cmocka_unit_test(exact_images_keep_their_bits),
        cmocka_unit_test(infinite_boxes_stay_infinite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
