// SPDX-License-Identifier: MIT
// The arithmetic everything exact stands on, against GMP's rationals: expansions must be exact and well
// formed, double-doubles and reals within the bounds their headers give. Operands are chosen to be mean:
// exponents far apart or equal, cancellation, long runs of zeros and ones.
#include "math/dd.h"
#include "math/expansion.h"
#include "math/real.h"
#include "support/random.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>
#include <gmp.h>

// A double with few, many or ordinary significant bits.
static double mean_double(rng *r, int low, int high) {
    double x = rng_double(r, low, high);
    switch (rng_below(r, 6)) {
    case 0: return 0;
    case 1: return ldexp(copysign(1, x), ilogb(x));                   // one bit
    case 2: return copysign(nextafter(ldexp(1, ilogb(x) + 1), 0), x); // all ones
    case 3: return ldexp(rint(ldexp(x, 6 - ilogb(x))), ilogb(x) - 6); // seven bits
    default: return x;
    }
}

// A random expansion of at most `limit` components, as the library makes them: a sum of random doubles.
static int random_expansion(rng *r, int limit, int low, int high, double *e) {
    int count = 0, wanted = 1 + (int)rng_below(r, (uint32_t)limit);
    double sum[64];
    for (int i = 0; i < wanted; i++) {
        double x = mean_double(r, low, high);
        count = sagi_expansion_sum(count, e, x != 0, &x, sum);
        for (int k = 0; k < count; k++) e[k] = sum[k];
    }
    return count;
}

static void set_expansion(mpq_t q, int n, const double *e) {
    mpq_t x;
    mpq_init(x);
    mpq_set_ui(q, 0, 1);
    for (int i = 0; i < n; i++) {
        mpq_set_d(x, e[i]);
        mpq_add(q, q, x);
    }
    mpq_clear(x);
}

// Increasing, none zero, none overlapping: each is below the lowest set bit of the next.
static void assert_well_formed(int n, const double *e) {
    for (int i = 0; i < n; i++) {
        assert_true(isfinite(e[i]) && e[i] != 0);
        if (i == 0) continue;
        double unit = ldexp(1, ilogb(e[i]) - 52);
        while (fmod(e[i], 2 * unit) == 0) unit *= 2;
        assert_true(fabs(e[i - 1]) < unit);
    }
}

static void assert_equals(int n, const double *h, const mpq_t expected) {
    mpq_t value;
    mpq_init(value);
    set_expansion(value, n, h);
    assert_true(mpq_equal(value, expected));
    assert_well_formed(n, h);
    assert_int_equal(sagi_expansion_sign(n, h), mpq_sgn(expected));
    mpq_clear(value);
}

// |value − expected| ≤ 2^exponent · factor · |expected|
static void assert_close(const mpq_t value, const mpq_t expected, double factor, int exponent) {
    mpq_t error, bound, f;
    mpq_inits(error, bound, f, NULL);
    mpq_sub(error, value, expected);
    mpq_abs(error, error);
    mpq_set_d(f, factor);
    mpq_abs(bound, expected);
    mpq_mul(bound, bound, f);
    mpq_div_2exp(bound, bound, (mp_bitcnt_t)-exponent);
    assert_true(mpq_cmp(error, bound) <= 0);
    mpq_clears(error, bound, f, NULL);
}

static void expansions_are_exact(void **state) {
    (void)state;
    rng r = rng_make(1);
    mpq_t a, b, c, d;
    mpq_inits(a, b, c, d, NULL);
    double e[32], f[32], h[1024];
    for (size_t i = 0, n = soak(40000); i < n; i++) {
        int range = i % 3 == 0 ? 2 : i % 3 == 1 ? 60 : 300;
        int ne = random_expansion(&r, 8, -range, range, e), nf = random_expansion(&r, 8, -range, range, f);
        if (rng_one_in(&r, 4) && ne > 0) { // nearly the same number: cancellation
            for (nf = 0; nf < ne; nf++) f[nf] = e[nf];
            f[0] = nextafter(f[0], 0);
            if (f[0] == 0) nf = 0;
        }
        set_expansion(a, ne, e);
        set_expansion(b, nf, f);
        mpq_add(c, a, b);
        assert_equals(sagi_expansion_sum(ne, e, nf, f, h), h, c);
        mpq_sub(c, a, b);
        assert_equals(sagi_expansion_diff(ne, e, nf, f, h), h, c);
        double x = mean_double(&r, -range, range);
        mpq_set_d(d, x);
        mpq_mul(c, a, d);
        assert_equals(sagi_expansion_scale(ne, e, x, h), h, c);
        mpq_mul(c, a, b);
        int np = sagi_expansion_product(ne, e, nf, f, h);
        assert_equals(np, h, c);
        double small[1024];
        int ns = sagi_expansion_compress(np, h, small);
        assert_equals(ns, small, c);
        assert_true(ns <= np);
        if (np > 0)
            assert_true(fabs(sagi_expansion_estimate(np, h) - small[ns - 1]) <=
                        0x1p-51 * fabs(small[ns - 1]));
        if (ns > 1)
            assert_true(fabs(small[ns - 2]) <= ldexp(1, ilogb(small[ns - 1]) - 53)); // each a full double
        double y = mean_double(&r, -range, range);
        mpq_set_d(c, y);
        mpq_sub(b, d, c);
        assert_equals(sagi_expansion_from_diff(x, y, h), h, b);
        mpq_mul(b, d, c);
        assert_equals(sagi_expansion_from_product(x, y, h), h, b);
    }
    mpq_clears(a, b, c, d, NULL);
}

static sagi_dd random_dd(rng *r, int low, int high, mpq_t value) {
    double hi = mean_double(r, low, high), lo = mean_double(r, -60, 0);
    sagi_dd a = sagi_two_sum(hi, hi * 0x1p-53 * (lo > 1 ? 1 / lo : lo));
    double parts[2] = {a.lo, a.hi};
    set_expansion(value, 2, parts);
    return a;
}

static void assert_dd(sagi_dd value, const mpq_t expected, double factor) {
    mpq_t v;
    mpq_init(v);
    double parts[2] = {value.lo, value.hi};
    set_expansion(v, 2, parts);
    assert_close(v, expected, factor, -106);
    assert_true(value.hi + value.lo == value.hi);
    mpq_clear(v);
}

static void double_doubles_are_within_their_bounds(void **state) {
    (void)state;
    rng r = rng_make(2);
    mpq_t a, b, c, d;
    mpq_inits(a, b, c, d, NULL);
    for (size_t i = 0, n = soak(200000); i < n; i++) {
        int range = i % 2 ? 3 : 200;
        sagi_dd x = random_dd(&r, -range, range, a), y = random_dd(&r, -range, range, b);
        if (rng_one_in(&r, 4)) { // cancellation
            y = (sagi_dd){-x.hi, x.lo};
            double parts[2] = {y.lo, y.hi};
            set_expansion(b, 2, parts);
        }
        mpq_add(c, a, b);
        assert_dd(sagi_dd_add(x, y), c, 3.1);
        mpq_sub(c, a, b);
        assert_dd(sagi_dd_sub(x, y), c, 3.1);
        mpq_mul(c, a, b);
        assert_dd(sagi_dd_mul(x, y), c, 5);
        double s = mean_double(&r, -range, range);
        mpq_set_d(d, s);
        mpq_add(c, a, d);
        assert_dd(sagi_dd_add_double(x, s), c, 2.1);
        mpq_mul(c, a, d);
        assert_dd(sagi_dd_mul_double(x, s), c, 3);
        if (y.hi != 0) {
            mpq_div(c, a, b);
            assert_dd(sagi_dd_div(x, y), c, 10);
        }
        if (x.hi > 0) { // (√a)² within twice the bound of √a
            sagi_dd root = sagi_dd_sqrt(x);
            double parts[2] = {root.lo, root.hi};
            set_expansion(c, 2, parts);
            mpq_mul(c, c, c);
            assert_close(c, a, 2 * 4, -106);
        }
    }
    assert_true(sagi_dd_sqrt((sagi_dd){-1, 0}).hi == 0 && sagi_dd_sqrt((sagi_dd){0, 0}).hi == 0);
    mpq_clears(a, b, c, d, NULL);
}

// As the library makes them: by adding.
static sagi_real random_real(rng *r, int low, int high, mpq_t value) {
    sagi_real a = {0};
    int wanted = 1 + (int)rng_below(r, SAGI_REAL_TERMS);
    for (int i = 0; i < wanted; i++) a = sagi_real_add(a, sagi_real_from(mean_double(r, low, high)));
    set_expansion(value, a.count, a.terms);
    return a;
}

static void assert_real(const sagi_real *value, const mpq_t expected, int exponent) {
    mpq_t v;
    mpq_init(v);
    assert_true(value->count >= 0 && value->count <= SAGI_REAL_TERMS);
    assert_well_formed(value->count, value->terms);
    set_expansion(v, value->count, value->terms);
    assert_close(v, expected, 1, exponent);
    assert_int_equal(sagi_real_sign(value), mpq_sgn(expected));
    mpq_clear(v);
}

static void reals_have_390_bits(void **state) {
    (void)state;
    rng r = rng_make(3);
    mpq_t a, b, c, d;
    mpq_inits(a, b, c, d, NULL);
    for (size_t i = 0, n = soak(8000); i < n; i++) {
        int range = i % 2 ? 30 : 120;
        sagi_real x = random_real(&r, -range, range, a), y = random_real(&r, -range, range, b), z;
        double s = mean_double(&r, -range, range);
        mpq_set_d(d, s);
        z = sagi_real_add(x, y), mpq_add(c, a, b), assert_real(&z, c, -390);
        z = sagi_real_sub(x, y), mpq_sub(c, a, b), assert_real(&z, c, -390);
        assert_int_equal(sagi_real_compare(x, y), mpq_cmp(a, b) > 0 ? 1 : mpq_cmp(a, b) < 0 ? -1 : 0);
        z = sagi_real_mul(x, y), mpq_mul(c, a, b), assert_real(&z, c, -390);
        z = sagi_real_scale(x, s), mpq_mul(c, a, d), assert_real(&z, c, -390);
        z = sagi_real_neg(x), mpq_neg(c, a), assert_real(&z, c, -390);
        z = sagi_real_from_diff(s, 0.1), mpq_set_d(c, 0.1), mpq_sub(c, d, c), assert_real(&z, c, -2000);
        if (y.count > 0) z = sagi_real_div(x, y), mpq_div(c, a, b), assert_real(&z, c, -390);
        if (sagi_real_sign(&x) > 0) {
            z = sagi_real_sqrt(x);
            mpq_t root;
            mpq_init(root);
            set_expansion(root, z.count, z.terms);
            mpq_mul(c, root, root);
            assert_close(c, a, 2, -390);
            assert_int_equal(sagi_real_sign(&z), 1);
            mpq_clear(root);
        }
        double rounded = sagi_real_to_double(&x);
        mpq_set_d(c, rounded);
        assert_close(c, a, 1, -52);
    }
    sagi_real zero = sagi_real_from(0), one = sagi_real_from(1), q = sagi_real_div(one, zero);
    assert_int_equal(q.count, 0);
    q = sagi_real_sqrt(sagi_real_from(-4));
    assert_int_equal(q.count, 0);
    q = sagi_real_div(zero, one);
    assert_int_equal(q.count, 0);
    mpq_clears(a, b, c, d, NULL);
}

// A product divided by a factor gives the other one exactly.
static void quotients_are_exact(void **state) {
    (void)state;
    rng r = rng_make(4);
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    for (size_t i = 0, n = soak(4000); i < n; i++) {
        double x = rng_double(&r, -40, 40), y = rng_double(&r, -40, 40);
        sagi_real sum = sagi_real_add(sagi_real_from(x), sagi_real_from(y * 0x1p-80));
        set_expansion(a, sum.count, sum.terms);
        sagi_real quotient = sagi_real_div(sagi_real_scale(sum, y), sagi_real_from(y));
        set_expansion(b, quotient.count, quotient.terms);
        assert_true(mpq_equal(a, b));
    }
    mpq_clears(a, b, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expansions_are_exact),
        cmocka_unit_test(double_doubles_are_within_their_bounds),
        cmocka_unit_test(reals_have_390_bits),
        cmocka_unit_test(quotients_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
