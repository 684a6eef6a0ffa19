// SPDX-License-Identifier: MIT
// What the code takes for granted of the compiler and of the flags it is built with.
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static void round_pairs(double a[2][4]) {
    for (int j = 0; j < 3; j++) {
        a[0][j] = (double)(float)a[0][j];
        a[1][j] = (double)(float)a[1][j];
    }
}

// GCC 12.2 at -O2 and -O3 takes the two conversions of neighbours for a copy, unless told
// -fno-tree-slp-vectorize.
static void rounding_to_float_is_not_dropped(void **state) {
    (void)state;
    volatile double tenth = 0.1;
    double a[2][4] = {{tenth, tenth, tenth, 0}, {tenth, tenth, tenth, 0}};
    void (*volatile call)(double(*)[4]) = round_pairs;
    call(a);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 3; j++) assert_true(a[i][j] == 0x1.99999ap-4);
}

// With contraction x·x − p would be one rounding, and the rounding error of the product instead of 0.
static void products_are_rounded_before_they_are_added(void **state) {
    (void)state;
    volatile double x = 0.1, y = 0.3;
    double p = x * y, difference = x * y - p;
    assert_true(difference == 0);
    volatile double residual = fma(x, y, -p);
    assert_true(residual != 0);
}

// No flush-to-zero, no finite-math: what -ffast-math would break.
static void arithmetic_is_ieee(void **state) {
    (void)state;
    volatile double tiny = DBL_MIN, zero = 0, huge = DBL_MAX;
    assert_true(tiny / 2 > 0 && tiny / 2 * 2 == DBL_MIN);
    assert_true(huge * 2 == INFINITY && 1 / zero == INFINITY && 1 / -zero == -INFINITY);
    volatile double nan = zero / zero;
    assert_true(isnan(nan) && !(nan < 1));
    assert_true(!(nan >= 1) && !(nan == 0));
    assert_int_equal(FLT_EVAL_METHOD, 0);
    volatile double one = 1, half_ulp = 0x1p-53;
    assert_true(one + half_ulp == 1 && one + half_ulp * 1.0000001 > 1); // to nearest, ties to even
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounding_to_float_is_not_dropped),
        cmocka_unit_test(products_are_rounded_before_they_are_added),
        cmocka_unit_test(arithmetic_is_ieee),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
