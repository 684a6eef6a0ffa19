// SPDX-License-Identifier: MIT
// Decimal to double. Nearly every number in a file has at most 15 digits and a small exponent: then its
// digits as an integer (below 2⁵³) and the power of ten (up to 10²²) are doubles without error, and one
// multiplication or division rounds once, so the result is the nearest double (Clinger, "How to Read Floating
// Point Numbers Accurately", 1990). Up to 19 digits, as "%.17g" writes them, are rounded by whole-number
// arithmetic (decimal.h). All others go to strtod, rewritten as an integer and an exponent,
// "123e-7": no decimal point, so no locale has a say. Digits beyond the 768th cannot decide a rounding except
// by being not all zero (the longest exact midpoint between doubles has 767), so the rewritten number has a
// bounded length.
#include "formats/number.h"

#include "formats/decimal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define MAX_DIGITS   800
#define MAX_EXPONENT 100000

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Whether the letters at `begin` are `word`, given in lower case.
static bool is_word(const char *begin, const char *end, const char *word) {
    for (; *word; word++, begin++)
        if (begin == end || (*begin | 0x20) != *word) return false;
    return true;
}

// The parts of a decimal number: value = digits × 10^exponent.
typedef struct decimal {
    const char *first,
        *last;         // first digit that is not 0, and the place behind the last digit (a point between)
    uint64_t mantissa; // the first 19 digits
    int digit_count;   // from the first that is not 0
    int exponent;      // of ten, for `mantissa` when it holds all digits
    const char *stop;
} decimal;

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
    d->stop = p;
    int exponent = 0;
    if (p != end && (*p == 'e' || *p == 'E')) {
        const char *q = p + 1;
        const bool negative = q != end && *q == '-';
        if (q != end && (*q == '-' || *q == '+')) q++;
        if (q != end && is_digit(*q)) {
            for (; q != end && is_digit(*q); q++)
                if (exponent < 4 * MAX_EXPONENT) exponent = 10 * exponent + (*q - '0');
            if (negative) exponent = -exponent;
            d->stop = q;
        }
    }
    d->exponent = exponent - point_shift;
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

const char *sagi_parse_number(const char *begin, const char *end, double *value) {
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *p = begin;
    const bool negative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) p++;
    if (p != end && !is_digit(*p) && *p != '.') {
        double special;
        if (is_word(p, end, "infinity")) {
            special = (double)INFINITY, p += 8;
        } else if (is_word(p, end, "inf")) {
            special = (double)INFINITY, p += 3;
        } else if (is_word(p, end, "nan")) {
            special = (double)NAN, p += 3;
        } else {
            return NULL;
        }
        *value = negative ? -special : special;
        return p;
    }
    decimal d;
    if (!scan(p, end, &d)) return NULL;
    double magnitude;
    if (d.digit_count == 0)
        magnitude = 0;
    else if (d.digit_count <= 19 && d.mantissa <= (uint64_t)1 << 53 && d.exponent >= -22 && d.exponent <= 22)
        magnitude = d.exponent < 0 ? (double)d.mantissa / powers[-d.exponent]
                                   : (double)d.mantissa * powers[d.exponent];
    else if (d.digit_count > 19 || !sagi_decimal_to_double(d.mantissa, d.exponent, &magnitude))
        magnitude = convert_slowly(&d);
    *value = negative ? -magnitude : magnitude;
    return d.stop;
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
