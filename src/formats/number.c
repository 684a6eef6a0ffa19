// SPDX-License-Identifier: MIT
// Decimal to double. Nearly every number in a file has at most 19 digits: they become a whole number, eight
// of them at a time, and the point and exponent a power of ten. When the whole number is at most 2⁵³ and the
// power of ten at most 10²², both are doubles without error, and one multiplication or division rounds once,
// so the result is the nearest double (Clinger, "How to Read Floating Point Numbers Accurately", 1990). What
// is longer, as "%.17g" writes it, is rounded by whole-number arithmetic (decimal.h). With more than 19
// digits the number lies between the first 19 and one more: where both round alike that is it. All others go
// to strtod, rewritten as an integer and an exponent, "123e-7": no decimal point, so no locale has a say.
// Digits beyond the 768th cannot decide a rounding except by being not all zero (the longest exact midpoint
// between doubles has 767), so the rewritten number has a bounded length.
//
// Eight digits at a time (Lemire, "Quickly parsing eight digits", 2018): the bytes are the digits of a number
// to base 256, and three steps of multiply, shift and add make it one to base 100, 10⁴ and 10⁸. Digits fewer
// than eight are shifted up, with zeros before them: so their number costs no branch.
#include "formats/number.h"

#include "formats/decimal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_DIGITS   800
#define MAX_EXPONENT 100000

static inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Whether the letters at `begin` are `word`, given in lower case.
static bool is_word(const char *begin, const char *end, const char *word) {
    for (; *word; word++, begin++)
        if (begin == end || (*begin | 0x20) != *word) return false;
    return true;
}

// ---- the general way

// The parts of a decimal number: value = digits × 10^exponent.
typedef struct decimal {
    const char *first, // first digit that is not 0
        *last;         // the place behind the last digit (a point between)
    uint64_t mantissa; // the first 19 digits
    int digit_count;   // from the first that is not 0
    int exponent;      // of ten, for all digits
    const char *stop;
} decimal;

// Reads "e-5" at p, if it is there; *exponent is changed by it.
static const char *scan_exponent(const char *p, const char *end, int *exponent) {
    if (p == end || (*p | 0x20) != 'e') return p;
    const char *q = p + 1;
    const bool negative = q != end && *q == '-';
    if (q != end && (*q == '-' || *q == '+')) q++;
    if (q == end || !is_digit(*q)) return p;
    int written = 0;
    for (; q != end && is_digit(*q); q++)
        if (written < 4 * MAX_EXPONENT) written = 10 * written + (*q - '0');
    *exponent += negative ? -written : written;
    return q;
}

static bool scan(const char *p, const char *end, decimal *d) {
    *d = (decimal){.first = NULL};
    bool any = false;
    int point_shift = 0;
    for (bool seen_point = false; p != end; p++) {
        if (*p == '.' && !seen_point) {
            seen_point = true;
            continue;
        }
        if (!is_digit(*p)) break;
        any = true;
        if (d->digit_count > 0 || *p != '0') {
            if (d->digit_count == 0) d->first = p;
            if (d->digit_count < 19) d->mantissa = 10 * d->mantissa + (uint64_t)(*p - '0');
            if (d->digit_count < 2 * MAX_EXPONENT) d->digit_count++;
        }
        if (seen_point && point_shift < 2 * MAX_EXPONENT) point_shift++;
    }
    if (!any) return false;
    d->last = p;
    d->exponent = -point_shift;
    d->stop = scan_exponent(p, end, &d->exponent);
    return true;
}

static double convert_slowly(const decimal *d) {
    char text[MAX_DIGITS + 32];
    int length = 0, dropped = 0;
    bool sticky = false;
    for (const char *p = d->first; p != d->last; p++) {
        if (*p == '.') continue;
        if (length < MAX_DIGITS) {
            text[length++] = *p;
        } else {
            if (dropped < 2 * MAX_EXPONENT) dropped++;
            sticky = sticky || *p != '0';
        }
    }
    int exponent = d->exponent + dropped;
    if (sticky) {
        text[length++] = '1';
        exponent--;
    }
    snprintf(text + length, sizeof text - (size_t)length, "e%d", exponent);
    return strtod(text, NULL);
}

// digits × 10^exponent, for at most 19 digits. False: neither way is sure of it.
static inline bool convert(uint64_t digits, int exponent, double *magnitude) {
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (digits <= (uint64_t)1 << 53 && exponent >= -22 && exponent <= 22) {
        *magnitude = exponent < 0 ? (double)digits / powers[-exponent] : (double)digits * powers[exponent];
        return true;
    }
    return sagi_decimal_to_double(digits, exponent, magnitude);
}

static double convert_decimal(const decimal *d) {
    if (d->digit_count == 0) return 0;
    double low, high;
    if (d->digit_count <= 19) return convert(d->mantissa, d->exponent, &low) ? low : convert_slowly(d);
    const int exponent = d->exponent + d->digit_count - 19;
    if (convert(d->mantissa, exponent, &low) && convert(d->mantissa + 1, exponent, &high) && low == high)
        return low;
    return convert_slowly(d);
}

// A number that is not plainly digits: by the general way, or nan, inf, infinity.
static const char *parse_any(const char *p, const char *end, double *magnitude) {
    decimal d;
    if (scan(p, end, &d)) {
        *magnitude = convert_decimal(&d);
        return d.stop;
    }
    if (is_word(p, end, "infinity")) return *magnitude = (double)INFINITY, p + 8;
    if (is_word(p, end, "inf")) return *magnitude = (double)INFINITY, p + 3;
    if (is_word(p, end, "nan")) return *magnitude = (double)NAN, p + 3;
    return NULL;
}

// ---- the quick way

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
// Goes on with *digits over the digits at p, and returns the place behind them.
static inline const char *read_digits(const char *p, const char *end, uint64_t *digits) {
    static const uint32_t powers[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};
    uint64_t n = *digits;
    while (end - p >= 8) {
        uint64_t bytes;
        memcpy(&bytes, p, 8);
        bytes ^= 0x3030303030303030u; // digits become 0 … 9, all else is more
        // The upper bit of every byte above 9 up to the first such; what lies behind it does not matter.
        const uint64_t others = ((bytes + 0x7676767676767676u) | bytes) & 0x8080808080808080u;
        const unsigned count = others ? (unsigned)__builtin_ctzll(others) / 8 : 8;
        if (count == 0) break;
        bytes <<= 8 * (8 - count);
        bytes = bytes * 10 + (bytes >> 8);
        bytes = ((bytes & 0x000000FF000000FFu) * 0x000F424000000064u +
                 ((bytes >> 16) & 0x000000FF000000FFu) * 0x0000271000000001u) >>
                32;
        n = n * powers[count] + bytes;
        p += count;
        if (count < 8) break;
    }
    if (end - p < 8)
        for (; p != end && is_digit(*p); p++) n = 10 * n + (uint64_t)(*p - '0');
    *digits = n;
    return p;
}
#else
static inline const char *read_digits(const char *p, const char *end, uint64_t *digits) {
    uint64_t n = *digits;
    for (; p != end && is_digit(*p); p++) n = 10 * n + (uint64_t)(*p - '0');
    *digits = n;
    return p;
}
#endif

const char *sagi_parse_number(const char *begin, const char *end, double *value) {
    const char *p = begin;
    const bool negative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) p++;
    const char *const first = p;
    uint64_t digits = 0;
    p = read_digits(p, end, &digits);
    ptrdiff_t digit_count = p - first, fraction = 0;
    if (p != end && *p == '.') {
        const char *const point = ++p;
        p = read_digits(p, end, &digits);
        fraction = p - point;
        digit_count += fraction;
    }
    double magnitude;
    if (digit_count > 0 && digit_count <= 19) {
        int exponent = -(int)fraction;
        const char *const stop = p = scan_exponent(p, end, &exponent);
        if (digits == 0)
            magnitude = 0;
        else if (!convert(digits, exponent, &magnitude))
            p = parse_any(first, stop, &magnitude);
    } else {
        p = parse_any(first, end, &magnitude);
        if (!p) return NULL;
    }
    *value = negative ? -magnitude : magnitude;
    return p;
}

const char *sagi_parse_integer(const char *begin, const char *end, int64_t *value) {
    const char *p = begin;
    const bool negative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) p++;
    if (p == end || !is_digit(*p)) return NULL;
    uint64_t magnitude = 0;
    for (; p != end && is_digit(*p); p++) {
        const uint64_t digit = (uint64_t)(*p - '0');
        if (magnitude > (INT64_MAX - digit) / 10) return NULL;
        magnitude = 10 * magnitude + digit;
    }
    *value = negative ? -(int64_t)magnitude : (int64_t)magnitude;
    return p;
}
