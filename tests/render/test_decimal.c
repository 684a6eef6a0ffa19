// SPDX-License-Identifier: MIT
// Decimal numbers against GMP and MPFR: the table of powers of five, and readings of numbers that stand on,
// or a hair beside, the middle between two doubles.
#include "formats/decimal.h"
#include "formats/number.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gmp.h>
#include <mpfr.h>

static uint64_t next_random(uint64_t *state) { // splitmix64
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static int count_of(int usual) {
    const char *soak = getenv("SAGITTA_SOAK");
    return soak ? usual * (atoi(soak) > 0 ? atoi(soak) : 1) : usual;
}

static void table_of_powers(void **state) {
    (void)state;
    mpz_t five, power, part;
    mpz_inits(five, power, part, NULL);
    for (int q = -SAGI_MAX_DECIMAL_POWER; q <= SAGI_MAX_DECIMAL_POWER; q++) {
        mpz_ui_pow_ui(five, 5, (unsigned)abs(q));
        const size_t length = mpz_sizeinbase(five, 2);
        if (q >= 0) { // the upper 128 bits
            if (length <= 128)
                mpz_mul_2exp(power, five, 128 - length);
            else
                mpz_fdiv_q_2exp(power, five, length - 128);
        } else { // 2^(127 + length)/5^-q, rounded up, has 128
            mpz_set_ui(part, 1);
            mpz_mul_2exp(part, part, 127 + length);
            mpz_cdiv_q(power, part, five);
        }
        assert_int_equal(mpz_sizeinbase(power, 2), 128);
        mpz_fdiv_q_2exp(part, power, 64);
        const uint64_t *entry = &sagi_decimal_powers[2 * (q + SAGI_MAX_DECIMAL_POWER)];
        assert_true(mpz_get_ui(part) == entry[0]);
        mpz_fdiv_r_2exp(part, power, 64);
        assert_true(mpz_get_ui(part) == entry[1]);
    }
    mpz_clears(five, power, part, NULL);
}

static void check(const char *text, mpfr_t exact) {
    mpfr_set_str(exact, text, 10, MPFR_RNDN);
    const double expected = mpfr_get_d(exact, MPFR_RNDN);
    double value = -1;
    const char *const end = text + strlen(text), *after = sagi_parse_number(text, end, &value);
    if (after != end || memcmp(&value, &expected, sizeof value) != 0)
        fail_msg("'%s' read as %a, expected %a", text, value, expected);
}

// The exact decimal expansion of the middle between two doubles, and that with its last digits changed: by
// strings of 17 to 25 digits, which is where a shortcut would go wrong.
static void middles_between_doubles(void **state) {
    (void)state;
    mpfr_t exact, middle;
    mpfr_init2(exact, 2400), mpfr_init2(middle, 64);
    uint64_t seed = 3;
    for (int i = 0; i < count_of(20000); i++) {
        const uint64_t r = next_random(&seed);
        const int exponent = (int)(r % 240) - 120;
        double below = ldexp((double)((next_random(&seed) >> 11) | (uint64_t)1 << 52), exponent - 52);
        mpfr_set_d(middle, below, MPFR_RNDN);
        mpfr_set_d(exact, nextafter(below, INFINITY), MPFR_RNDN);
        mpfr_add(middle, middle, exact, MPFR_RNDN);
        mpfr_div_2ui(middle, middle, 1, MPFR_RNDN);
        for (int digits = 15; digits < 26; digits++) {
            char text[128];
            mpfr_snprintf(text, sizeof text, digits % 2 ? "%.*RDe" : "%.*RUe", digits, middle);
            check(text, exact);
        }
        char text[700];
        mpfr_snprintf(text, sizeof text, "%.300RNe", middle); // all of it, zeros behind
        check(text, exact);
        text[290] = '1'; // and a trace more
        check(text, exact);
    }
    mpfr_clears(exact, middle, NULL);
}

// As scenes have them: %g, %f and %.17g of numbers of all sizes.
static void numbers_of_scenes(void **state) {
    (void)state;
    static const char *const formats[] = {"%.6g", "%g",    "%.9g", "%.7g",  "%.17g", "%.6f",
                                          "%.8f", "%.12f", "%.3e", "%.16g", "%.20f", "%.15g"};
    mpfr_t exact;
    mpfr_init2(exact, 400);
    uint64_t seed = 4;
    for (int i = 0; i < count_of(150000); i++) {
        const uint64_t r = next_random(&seed);
        const double value = ldexp((double)(int64_t)next_random(&seed), -63 + (int)(r % 60) - 30);
        char text[128];
        snprintf(text, sizeof text, formats[(r >> 20) % 12], value);
        check(text, exact);
        if ((r >> 60) == 0 && (double)(float)value == (double)(float)value) {
            snprintf(text, sizeof text, "%.9g", (double)(float)ldexp(value, (int)(r >> 30) % 160 - 100));
            if (text[0] != '0' || text[1]) check(text, exact);
        }
    }
    mpfr_clear(exact);
}

// Digits by the million against the C library: any number of them, the point and the exponent anywhere.
static void random_texts(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < count_of(1500000); i++) {
        char text[96];
        uint64_t r = next_random(&seed), pool = next_random(&seed);
        const int digits = 1 + (int)(r % 23), point = (int)(r >> 8) % (digits + 2);
        int length = 0;
        if (r >> 40 & 1) text[length++] = r >> 41 & 1 ? '-' : '+';
        for (int k = 0; k < digits; k++) {
            if (k == point) text[length++] = '.';
            if (k == 16) pool = next_random(&seed);
            const uint64_t nibble = pool & 15;
            text[length++] = (char)('0' + (nibble > 9 ? (nibble & 1) * 9 : nibble)); // 0 and 9 more often
            pool >>= 4;
        }
        if (r >> 42 & 1) length += snprintf(text + length, 10, "e%d", (int)(r >> 48) % 121 - 60);
        const char *const end = text + length;
        text[length] = 0;
        double value = -1;
        const double expected = strtod(text, NULL);
        const char *const after = sagi_parse_number(text, end, &value);
        if (after != end || memcmp(&value, &expected, sizeof value) != 0)
            fail_msg("'%s' read as %a, expected %a", text, value, expected);
    }
}

// Whatever follows, and wherever the text ends: the number is the same, and nothing behind the end is looked
// at.
static void ends_anywhere(void **state) {
    (void)state;
    static const char *const tails[] = {"",  " ",    "\n",   "]", "#", "x", "/",
                                        ":", "\x80", "\xFF", ".", "e", "-"};
    uint64_t seed = 6;
    for (int i = 0; i < 20000; i++) {
        char text[48];
        const int length = snprintf(text, 32, "%.*f", (int)(next_random(&seed) % 12),
                                    (double)(int64_t)next_random(&seed) * 0x1p-55);
        const double expected = strtod(text, NULL);
        const char *const tail = tails[(size_t)next_random(&seed) % 13];
        const bool point = strchr(text, '.') != NULL;
        if (tail[0] == '.' && !point) continue;
        strcpy(text + length, tail);
        double value;
        char *exactly = malloc((size_t)length); // so that a sanitizer sees the end
        memcpy(exactly, text, (size_t)length);
        assert_ptr_equal(sagi_parse_number(exactly, exactly + length, &value), exactly + length);
        assert_true(value == expected);
        free(exactly);
        assert_ptr_equal(sagi_parse_number(text, text + strlen(text), &value), text + length);
        assert_true(value == expected);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_of_powers),   cmocka_unit_test(middles_between_doubles),
        cmocka_unit_test(numbers_of_scenes), cmocka_unit_test(random_texts),
        cmocka_unit_test(ends_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
