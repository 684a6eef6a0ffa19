// SPDX-License-Identifier: MIT
// Pixel filters: points come as often as the curve is high, with its sign.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/filter.h"
#include "support/picture.h"
#include "support/random.h"

static const sag_film films[] = {
    {.filter = SAG_FILTER_BOX, .filter_radius_x = 1.5, .filter_radius_y = 0.75},
    {.filter = SAG_FILTER_TRIANGLE, .filter_radius_x = 1.5, .filter_radius_y = 0.75},
    {.filter = SAG_FILTER_GAUSSIAN, .filter_radius_x = 1.5, .filter_radius_y = 0.75},
    {.filter = SAG_FILTER_GAUSSIAN, .filter_radius_x = 3, .filter_radius_y = 2, .filter_sigma = 1.25},
    {.filter = SAG_FILTER_MITCHELL},
    {.filter = SAG_FILTER_MITCHELL, .filter_c = 0.5, .filter_radius_x = 3},
    {.filter = SAG_FILTER_SINC},
    {.filter = SAG_FILTER_SINC, .filter_tau = 2, .filter_radius_x = 2, .filter_radius_y = 6},
};
#define FILMS (sizeof films / sizeof *films)
#define BINS  64

// The weighted share of the numbers that falls into each bin of an axis is the curve's integral there.
static void samples_have_the_curves_weights(void **state) {
    (void)state;
    for (size_t f = 0; f < FILMS; f++) {
        sagi_filter filter;
        assert_int_equal(sagi_filter_init(&filter, &films[f], NULL), SAG_OK);
        const double radii[2] = {filter.radius_x, filter.radius_y};
        double expected[2][BINS] = {{0}}, sums[2] = {0}, found[2][BINS] = {{0}}, total[2] = {0};
        for (int axis = 0; axis < 2; axis++) {
            for (int i = 0; i < BINS * 100; i++) {
                const double x = radii[axis] * ((i + 0.5) / (BINS * 50) - 1);
                const double value = sagi_filter_curve_at(&films[f], radii[axis], fabs(x));
                expected[axis][i / 100] += value;
                sums[axis] += value;
            }
            const int n = 1 << 17;
            for (int i = 0; i < n; i++) { // the other axis in its middle, where no curve is negative
                const double u = (i + 0.5) / n;
                const sagi_filter_sample s =
                    sagi_filter_draw(&filter, axis ? (sag_vec2){0.5, u} : (sag_vec2){u, 0.5});
                const double x = axis ? s.offset.y : s.offset.x, rest = axis ? s.offset.x : s.offset.y;
                assert_true(fabs(x) <= radii[axis] && fabs(rest) < 1e-9 && fabs(s.weight) == 1);
                const int bin = (int)((x / radii[axis] + 1) / 2 * BINS);
                found[axis][bin < BINS ? bin : BINS - 1] += s.weight;
                total[axis] += s.weight;
            }
            for (int i = 0; i < BINS; i++)
                assert_true(fabs(found[axis][i] / total[axis] - expected[axis][i] / sums[axis]) < 2e-4);
        }
        const double mean = total[0] * total[1] / ((double)(1 << 17) * (1 << 17));
        assert_true(fabs(mean - filter.mean_weight) < 1e-3);
    }
}

// Greater numbers, greater offsets: strata stay strata.
static void offsets_grow_with_their_numbers(void **state) {
    (void)state;
    for (size_t f = 0; f < FILMS; f++) {
        sagi_filter filter;
        assert_int_equal(sagi_filter_init(&filter, &films[f], NULL), SAG_OK);
        double last = -INFINITY;
        for (double u = 0; u < 1; u += 0x1p-12) {
            const sagi_filter_sample s = sagi_filter_draw(&filter, (sag_vec2){u, 1 - 0x1p-32});
            assert_true(s.offset.x >= last && s.offset.y <= filter.radius_y);
            last = s.offset.x;
        }
    }
}

// The closed forms: Mitchell's cubic has 8/9 at 0 and 1/18 at half its radius for B = C = 1/3; sinc's lobes
// end at the whole numbers.
static void curves_have_their_values(void **state) {
    (void)state;
    const sag_film mitchell = {.filter = SAG_FILTER_MITCHELL}, sinc = {.filter = SAG_FILTER_SINC};
    const double at_0 = sagi_filter_curve_at(&mitchell, 2, 0);
    assert_true(fabs(sagi_filter_curve_at(&mitchell, 2, 1) / at_0 - (1.0 / 18) / (8.0 / 9)) < 1e-14);
    assert_true(fabs(sagi_filter_curve_at(&mitchell, 2, 2)) < 1e-14);
    assert_true(sagi_filter_curve_at(&sinc, 4, 0) == 1 && sagi_filter_curve_at(&sinc, 4, 4.5) == 0);
    for (int i = 1; i <= 4; i++) assert_true(fabs(sagi_filter_curve_at(&sinc, 4, i)) < 1e-15);
    assert_true(sagi_filter_curve_at(&sinc, 4, 1.5) < 0 && sagi_filter_curve_at(&sinc, 4, 2.5) > 0);
}

static void impossible_filters_are_errors(void **state) {
    (void)state;
    const sag_film bad[] = {
        {.filter_radius_x = (double)NAN},
        {.filter_radius_y = -1},
        {.filter = SAG_FILTER_GAUSSIAN, .filter_sigma = (double)INFINITY},
        {.filter = SAG_FILTER_SINC, .filter_tau = -2},
        {.filter = SAG_FILTER_MITCHELL, .filter_b = (double)NAN},
        {.filter = SAG_FILTER_MITCHELL, .filter_b = 1e300, .filter_c = -1e300},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sagi_filter filter;
        assert_int_equal(sagi_filter_init(&filter, &bad[i], NULL), SAG_ERROR_ARGUMENT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_have_the_curves_weights),
        cmocka_unit_test(offsets_grow_with_their_numbers),
        cmocka_unit_test(curves_have_their_values),
        cmocka_unit_test(impossible_filters_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
