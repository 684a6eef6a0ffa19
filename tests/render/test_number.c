// SPDX-License-Identifier: MIT
// Numbers as text against the C library's own: every reading and every writing must be the same, bit for bit.
#include "formats/decimal.h"
#include "formats/number.h"

#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t next_random(uint64_t *state) { // splitmix64
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static uint64_t bits(double value) {
    uint64_t b;
    memcpy(&b, &value, sizeof b);
    return b;
}

static void check_parse(const char *text) {
    double expected = strtod(text, NULL), value = -1;
    const char *end = text + strlen(text), *after = sagi_parse_number(text, end, &value);
    if (after != end || bits(value) != bits(expected)) {
        fail_msg("'%s' read as %a, expected %a", text, value, expected);
    }
}

static void check_format(double value) {
    char expected[64], text[SAGI_NUMBER_BYTES + 1];
    snprintf(expected, sizeof expected, "%.17g", value);
    text[sagi_format_number(value, text)] = 0;
    if (strcmp(text, expected) != 0) fail_msg("%a written as '%s', expected '%s'", value, text, expected);
    double again = 0;
    const char *after = sagi_parse_number(text, text + strlen(text), &again);
    if (!after || *after || bits(again) != bits(value)) fail_msg("%s read again as %a", text, again);
}

static void reads_the_usual(void **state) {
    (void)state;
    static const char *const texts[] = {"0",
                                        "-0",
                                        "+1",
                                        "1.",
                                        ".5",
                                        "-.5e1",
                                        "1e22",
                                        "1e23",
                                        "1e-22",
                                        "1e-27",
                                        "1e-28",
                                        "1e28",
                                        "123456789012345678",
                                        "9007199254740993",
                                        "9007199254740992.5",
                                        "9007199254740993.00000000000000000001",
                                        "0.1",
                                        "0.30000000000000004",
                                        "1e308",
                                        "1e309",
                                        "-1e400",
                                        "4.9e-324",
                                        "2.4703282292062327e-324",
                                        "2.4703282292062328e-324",
                                        "1e-400",
                                        "2.2250738585072011e-308",
                                        "000000000000000000000000001.5",
                                        "0.000000000000000000000000000000015",
                                        "18446744073709551615",
                                        "18446744073709551616",
                                        "99999999999999999999",
                                        "1e99999999999999999999",
                                        "0e99999999999999999999",
                                        "inf",
                                        "-Infinity",
                                        "INF"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) check_parse(texts[i]);
    double value = 1;
    const char *nan_text = "nan";
    assert_ptr_equal(sagi_parse_number(nan_text, nan_text + 3, &value), nan_text + 3);
    assert_true(isnan(value));
}

static void reads_only_numbers(void **state) {
    (void)state;
    static const char *const texts[] = {"", "-", "+", ".", "e5", "-.e1", "x", "in", "na", "--1", "0x"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts - 1; i++) {
        double value = 7;
        assert_null(sagi_parse_number(texts[i], texts[i] + strlen(texts[i]), &value));
        assert_true(value == 7);
    }
    double value;
    const char *text = "1e+x";
    assert_ptr_equal(sagi_parse_number(text, text + 4, &value), text + 1);
    text = "0x10";
    assert_ptr_equal(sagi_parse_number(text, text + 4, &value), text + 1);
    text = "12345"; // the end is the caller's, not a zero byte's
    assert_ptr_equal(sagi_parse_number(text, text + 2, &value), text + 2);
    assert_true(value == 12);
}

static void random_doubles(void **state) {
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < 200000; i++) {
        uint64_t r = next_random(&seed);
        double any;
        memcpy(&any, &r, sizeof any);
        if (isfinite(any)) check_format(any);
        double near_one = ldexp((double)(int64_t)next_random(&seed), -63 + (int)(r % 110) - 45);
        check_format(near_one);
    }
}

static void random_texts(void **state) {
    (void)state;
    uint64_t seed = 2;
    for (int i = 0; i < 200000; i++) {
        char text[80];
        uint64_t r = next_random(&seed);
        int digits = 1 + (int)(r % 22), point = (int)(r >> 8) % (digits + 1), length = 0;
        if (r >> 40 & 1) text[length++] = '-';
        for (int k = 0; k < digits; k++) {
            if (k == point) text[length++] = '.';
            text[length++] = (char)('0' + next_random(&seed) % 10);
        }
        if (r >> 41 & 1) length += snprintf(text + length, 10, "e%d", (int)(r >> 48) % 31 - 15);
        text[length] = 0;
        check_parse(text);
    }
}

// Halfway between two doubles: 2⁵³·k + 1 and the like must go to the even one.
static void ties_go_to_even(void **state) {
    (void)state;
    for (int exponent = 54; exponent < 64; exponent++) {
        for (uint64_t k = 1; k < 200; k++) {
            char text[64];
            uint64_t step = (uint64_t)1 << (exponent - 53);
            snprintf(text, sizeof text, "%llu",
                     (unsigned long long)(((uint64_t)1 << (exponent - 1)) + k * step / 2));
            check_parse(text);
        }
    }
    static const double edges[] = {0.1,      0.5,
                                   1,        10,
                                   1e15,     1e16,
                                   1e17,     9.9999999999999995e16,
                                   1e-4,     9.9999999999999991e-5,
                                   1e-5,     1e-10,
                                   1e-11,    9.9999999999999994e-11,
                                   123456,   0x1p-1074,
                                   0x1p1023, 1e22,
                                   5e-324};
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        check_format(edges[i]);
        check_format(-edges[i]);
        check_format(nextafter(edges[i], 0));
        check_format(nextafter(edges[i], INFINITY));
    }
    check_format(0.0);
    check_format(-0.0);
    check_format(INFINITY);
    check_format(-INFINITY);
}

static void locale_does_not_matter(void **state) {
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "ps_AF.UTF-8"};
    const char *found = NULL;
    for (size_t i = 0; i < 3 && !found; i++) found = setlocale(LC_ALL, names[i]);
    char text[SAGI_NUMBER_BYTES];
    double value = 0;
    size_t length = sagi_format_number(2.5e17, text);
    assert_int_equal(length, 7);
    assert_memory_equal(text, "2.5e+17", 7);
    assert_non_null(sagi_parse_number(text, text + length, &value));
    assert_true(value == 2.5e17);
    setlocale(LC_ALL, "C");
    if (!found) print_message("no locale with a decimal comma here: only the C locale was tried\n");
}

static void integers(void **state) {
    (void)state;
    static const long long values[] = {0, 1, -1, 9, 10, 12345678901234567, INT64_MAX, INT64_MIN};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        char expected[32], text[21];
        snprintf(expected, sizeof expected, "%lld", values[i]);
        text[sagi_format_integer(values[i], text)] = 0;
        assert_string_equal(text, expected);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_usual), cmocka_unit_test(reads_only_numbers),
        cmocka_unit_test(random_doubles),  cmocka_unit_test(random_texts),
        cmocka_unit_test(ties_go_to_even), cmocka_unit_test(locale_does_not_matter),
        cmocka_unit_test(integers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
