// SPDX-License-Identifier: MIT
// Triangles cut at planes: the box of the part holds every point of it, exactly, and is not much larger.
#include "bvh/clip.h"
#include "support/random.h"
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static double grid(rng *r, double step) { return (double)(int32_t)rng_below(r, 1u << 21) * step - 1; }

// Corners are multiples of 2⁻²⁰ and so are weights: points are multiples of 2⁻⁴⁰, and exact.
static void points_of_the_part_are_in_the_box(void **state) {
    (void)state;
    rng r = rng_make(1);
    size_t inside = 0, count = soak(20000);
    for (size_t i = 0; i < count; i++) {
        double corner[3][3], given[3][3];
        bool needle = rng_one_in(&r, 2), upright = rng_one_in(&r, 3);
        int axis = (int)rng_below(&r, 3);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                corner[c][k] = grid(&r, 0x1p-20);
                if (needle && c == 2) corner[c][k] = fmin(corner[1][k] + 0x1p-20, 1);
                if (upright && k == axis) corner[c][k] = corner[0][k]; // nearly parallel to the planes
                given[c][k] = corner[c][k] + (rng_one_in(&r, 2) ? 0 : rng_one_in(&r, 2) ? 0x1p-52 : -0x1p-52);
            }
        float lo = (float)rng_uniform(&r, -1, 1), hi = (float)rng_uniform(&r, -1, 1);
        if (rng_one_in(&r, 3)) lo = (float)corner[rng_below(&r, 3)][axis];
        if (rng_one_in(&r, 3)) hi = nextafterf((float)corner[rng_below(&r, 3)][axis], lo);
        if (lo > hi) lo = hi;
        sagi_float_box box = {{-1, -1, -1}, {1, 1, 1}};
        sagi_clip_triangle(given, axis, lo, hi, &box);
        for (int s = 0; s < 20; s++) {
            int32_t u = (int32_t)rng_below(&r, (1 << 20) + 1),
                    v = (int32_t)rng_below(&r, (1 << 20) + 1 - (uint32_t)u);
            if (rng_one_in(&r, 4)) u = 0;
            double w[3] = {u * 0x1p-20, v * 0x1p-20, ((1 << 20) - u - v) * 0x1p-20}, p[3] = {0, 0, 0};
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++) p[k] += w[c] * corner[c][k];
            if (!(p[axis] >= (double)lo && p[axis] <= (double)hi)) continue;
            inside++;
            for (int k = 0; k < 3; k++) assert_true(p[k] >= (double)box.lo[k] && p[k] <= (double)box.hi[k]);
        }
    }
    assert_true(inside > count);
}

static void part_is_tight(void **state) {
    (void)state;
    const double diagonal[3][3] = {{-1, -1, 0}, {1, 1, 0}, {1, 1, 0.5}};
    sagi_float_box box = {{-1, -1, 0}, {1, 1, 0.5f}};
    sagi_clip_triangle(diagonal, 0, 0, 0.5f, &box);
    const sagi_float_box expected = {{0, 0, 0}, {0.5f, 0.5f, 0.375f}};
    for (int k = 0; k < 3; k++) {
        assert_true(box.lo[k] <= expected.lo[k] && box.lo[k] >= expected.lo[k] - 1e-6f);
        assert_true(box.hi[k] >= expected.hi[k] && box.hi[k] <= expected.hi[k] + 1e-6f);
    }
}

static void nothing_between_the_planes(void **state) {
    (void)state;
    const double corner[3][3] = {{0.1, 0, 0}, {0.2, 1, 0}, {0.3, 0, 1}};
    sagi_float_box box = {{-1, -1, -1}, {1, 1, 1}};
    sagi_clip_triangle(corner, 0, 0.5f, 0.75f, &box);
    assert_true(sagi_float_box_is_empty(&box));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_of_the_part_are_in_the_box),
        cmocka_unit_test(part_is_tight),
        cmocka_unit_test(nothing_between_the_planes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
