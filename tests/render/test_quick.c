// SPDX-License-Identifier: MIT
// The quick sine, cosine and arc tangent beside the exact ones.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "math/elementary.h"
#include "render/quick.h"
#include "support/random.h"

#define HALF_PI 1.57079632679489661923

static void sine_and_cosine_are_near(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 200000; i++) {
        const double x = i < 2 ? (2 * i - 1) * HALF_PI : rng_uniform(&r, -HALF_PI, HALF_PI);
        double s, c, sine, cosine;
        sagi_quick_sincos(x, &s, &c);
        sagi_sincos(x, &sine, &cosine);
        assert_true(fabs(s - sine) <= 6 * 0x1p-53 && fabs(c - cosine) <= 6 * 0x1p-53);
    }
}

static void turns_are_near(void **state) {
    (void)state;
    rng r = rng_make(3);
    for (int i = 0; i < 200000; i++) {
        const double u = i == 0 ? 1 : i == 1 ? 0 : rng_unit(&r);
        double s, c, sine, cosine;
        sagi_quick_turn(u, &s, &c);
        sagi_sincos(4 * HALF_PI * u, &sine, &cosine);
        // (The exact one's angle, up to 2π, is off by up to 6·2⁻⁵³ itself.)
        assert_true(fabs(s - sine) <= 0x1p-49 && fabs(c - cosine) <= 0x1p-49);
    }
}

static void angles_are_near(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (int i = 0; i < 200000; i++) {
        const double y = i % 9 == 0 ? 0 : ldexp(rng_unit(&r), -(int)rng_below(&r, 60)),
                     x = i % 7 == 0 && y > 0 ? 0 : ldexp(rng_uniform(&r, -1, 1), -(int)rng_below(&r, 60));
        if (x == 0 && y == 0) continue;
        const double angle = sagi_atan2(y, x == 0 ? 0 : x);
        assert_true(fabs(sagi_quick_atan2(y, x) - angle) <= 0x1p-50 * angle);
    }
    assert_true(sagi_quick_atan2(1, 1) == HALF_PI / 2 && sagi_quick_atan2(0, -1) == 2 * HALF_PI);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sine_and_cosine_are_near),
        cmocka_unit_test(turns_are_near),
        cmocka_unit_test(angles_are_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
