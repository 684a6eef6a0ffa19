// SPDX-License-Identifier: MIT
// The elementary functions beside MPFR: random arguments of all sizes, ones that are hard for the way they
// are computed, and the special values.
#include "math/elementary.h"
#include "support/random.h"
#include <float.h>
#include <math.h>
#include <mpfr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

typedef int mpfr_one(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
typedef int mpfr_two(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

// |got − truth| in units of the last place of the truth's double.
static double ulps(double got, mpfr_srcptr truth) {
    const double nearest = mpfr_get_d(truth, MPFR_RNDN);
    if (got == nearest || (isnan(got) && isnan(nearest))) {
        if (!isfinite(got) || got == 0) return 0;
    } else if (!isfinite(got) || !isfinite(nearest)) {
        return INFINITY;
    }
    int exponent;
    (void)frexp(nearest, &exponent);
    const double last = ldexp(1, exponent - 53 < -1074 ? -1074 : exponent - 53);
    mpfr_t difference;
    mpfr_init2(difference, 200);
    mpfr_sub_d(difference, truth, got, MPFR_RNDN);
    const double result = fabs(mpfr_get_d(difference, MPFR_RNDN)) / last;
    mpfr_clear(difference);
    return result;
}

static double any_size(rng *r, int low, int high) { // of either sign, exponents low … high − 1
    const double x = ldexp(1 + rng_unit(r), low + (int)rng_below(r, (uint32_t)(high - low)));
    return rng_one_in(r, 2) ? -x : x;
}

// A double next to a multiple of π/2.
static double near_quarter_turn(rng *r) {
    const double k = floor(ldexp(rng_unit(r), (int)rng_below(r, 40)));
    double x = k * 1.5707963267948966;
    for (uint32_t i = rng_below(r, 4); i > 0; i--) x = nextafter(x, rng_one_in(r, 2) ? 1e300 : 0);
    return x;
}

static void check_one(double (*f)(double), mpfr_one *truth_of, double x, double bound, double *worst) {
    mpfr_t a, truth;
    mpfr_inits2(200, a, truth, (mpfr_ptr)0);
    mpfr_set_d(a, x, MPFR_RNDN);
    truth_of(truth, a, MPFR_RNDN);
    const double error = ulps(f(x), truth);
    if (!(error <= bound)) fail_msg("f(%a) = %a, off by %g ulp", x, f(x), error);
    if (error > *worst) *worst = error;
    mpfr_clears(a, truth, (mpfr_ptr)0);
}

static void check_two(double (*f)(double, double), mpfr_two *truth_of, double x, double y, double bound,
                      double *worst) {
    mpfr_t a, b, truth;
    mpfr_inits2(200, a, b, truth, (mpfr_ptr)0);
    mpfr_set_d(a, x, MPFR_RNDN), mpfr_set_d(b, y, MPFR_RNDN);
    truth_of(truth, a, b, MPFR_RNDN);
    const double error = ulps(f(x, y), truth);
    if (!(error <= bound)) fail_msg("f(%a, %a) = %a, off by %g ulp", x, y, f(x, y), error);
    if (error > *worst) *worst = error;
    mpfr_clears(a, b, truth, (mpfr_ptr)0);
}

static void of_one_argument(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double (*f)(double);
        mpfr_one *truth;
        double bound;
        int low, high; // exponents of random arguments
        bool turns;    // arguments next to quarter turns too
    } functions[] = {
        {"sin", sagi_sin, mpfr_sin, 1, -60, 1023, true},
        {"cos", sagi_cos, mpfr_cos, 1, -60, 1023, true},
        {"sin", sagi_sin, mpfr_sin, 1, -4, 8, true},
        {"cos", sagi_cos, mpfr_cos, 1, -4, 8, true},
        {"tan", sagi_tan, mpfr_tan, 3, -60, 1023, true},
        {"asin", sagi_asin, mpfr_asin, 3, -60, 0, false},
        {"acos", sagi_acos, mpfr_acos, 3, -60, 0, false},
        {"exp", sagi_exp, mpfr_exp, 1, -60, 9, false},
        {"expm1", sagi_expm1, mpfr_expm1, 3, -60, 5, false},
        {"cbrt", sagi_cbrt, mpfr_cbrt, 1, -1022, 1023, false},
    };
    rng r = rng_make(1);
    const long count = (long)soak(40000);
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        double worst = 0;
        for (long k = 0; k < count; k++) {
            const double x = functions[i].turns && rng_one_in(&r, 2)
                                 ? near_quarter_turn(&r)
                                 : any_size(&r, functions[i].low, functions[i].high);
            check_one(functions[i].f, functions[i].truth, x, functions[i].bound, &worst);
        }
        printf("%s: %ld arguments, at most %.3f ulp\n", functions[i].name, count, worst);
    }
    double worst = 0;
    for (long k = 0; k < count; k++) {
        check_one(sagi_log, mpfr_log, fabs(any_size(&r, -1022, 1023)), 1, &worst);
        check_one(sagi_log, mpfr_log, 1 + any_size(&r, -52, -1), 1, &worst);
    }
    printf("log: %ld arguments, at most %.3f ulp\n", 2 * count, worst);
}

static void of_two_arguments(void **state) {
    (void)state;
    rng r = rng_make(2);
    const long count = (long)soak(100000);
    double arc = 0, power = 0, root = 0;
    for (long k = 0; k < count; k++) {
        const int spread = 1 << rng_below(&r, 10);
        check_two(sagi_atan2, mpfr_atan2, any_size(&r, -spread, spread), any_size(&r, -spread, spread), 1,
                  &arc);
        check_two(sagi_hypot, mpfr_hypot, any_size(&r, -spread, spread), any_size(&r, -spread, spread), 1,
                  &root);
        const double x = fabs(any_size(&r, -spread, spread)), size = 700 / (fabs(log(x)) + 0.1);
        check_two(sagi_pow, mpfr_pow, x, size * (2 * rng_unit(&r) - 1), 1, &power);
        check_two(sagi_pow, mpfr_pow, 1 + any_size(&r, -40, -2), any_size(&r, -4, 8), 1, &power);
    }
    printf("atan2 %.3f, pow %.3f, hypot %.3f ulp at most\n", arc, power, root);
}

static bool same(double a, double b) {
    return (isnan(a) && isnan(b)) || (a == b && !signbit(a) == !signbit(b));
}

// Where C's Annex F fixes the result, the C library has it too.
static void special_values(void **state) {
    (void)state;
    static const double values[] = {0.0,
                                    -0.0,
                                    1,
                                    -1,
                                    2,
                                    -2,
                                    3,
                                    -3,
                                    0.5,
                                    -0.5,
                                    1e300,
                                    -1e300,
                                    INFINITY,
                                    -INFINITY,
                                    NAN,
                                    DBL_MIN,
                                    4.9406564584124654e-324,
                                    -4.9406564584124654e-324,
                                    1e-310};
    static const struct {
        double (*ours)(double), (*theirs)(double);
    } one[] = {{sagi_sin, sin}, {sagi_cos, cos}, {sagi_asin, asin}, {sagi_acos, acos},
               {sagi_exp, exp}, {sagi_log, log}, {sagi_cbrt, cbrt}, {sagi_expm1, expm1}};
    static const struct {
        double (*ours)(double, double), (*theirs)(double, double);
    } two[] = {{sagi_atan2, atan2}, {sagi_pow, pow}, {sagi_hypot, hypot}};
    const size_t count = sizeof values / sizeof *values;
    for (size_t i = 0; i < count; i++) {
        for (size_t f = 0; f < sizeof one / sizeof *one; f++) {
            const double a = one[f].ours(values[i]), b = one[f].theirs(values[i]);
            if (!same(a, b) && !(fabs(a - b) <= 4 * DBL_EPSILON * fabs(b)))
                fail_msg("function %zu of %a: %a, not %a", f, values[i], a, b);
        }
        for (size_t j = 0; j < count; j++)
            for (size_t f = 0; f < sizeof two / sizeof *two; f++) {
                const double a = two[f].ours(values[i], values[j]), b = two[f].theirs(values[i], values[j]);
                if (!same(a, b) && !(fabs(a - b) <= 4 * DBL_EPSILON * fabs(b)))
                    fail_msg("function %zu of %a, %a: %a, not %a", f, values[i], values[j], a, b);
            }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_one_argument), cmocka_unit_test(of_two_arguments),
                                       cmocka_unit_test(special_values)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
