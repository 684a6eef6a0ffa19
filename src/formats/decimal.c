// SPDX-License-Identifier: MIT
// Decimal to binary and back by whole numbers alone.
//
// Reading: up to 19 digits are a whole number w < 2⁶⁴, and the text means w·10^q = w·5^q·2^q. For 0 ≤ q ≤ 27
// the product w·5^q fits in 127 bits, since 5²⁷ < 2⁶³: it is formed exactly and rounded once. For −27 ≤ q < 0
// the quotient (w·2^s)/5^|q| is taken with s chosen to give 63 or 64 bits; whether there is a remainder is
// one more bit below them, which is all that rounding to 53 bits needs to know. No table of approximate
// powers, no case that is only nearly right; what lies outside (more digits, larger exponents) is left to
// strtod.
//
// Writing 17 digits: with d = ⌊log₁₀ x⌋ and k = 16 − d, the digits are those of x·10^k = m·5^k·2^(e+k), where
// x = m·2^e. For 0 ≤ k ≤ 27, which holds for 10⁻¹⁰ ≤ x < 10¹⁷, m·5^k has at most 53 + 63 bits: again exact,
// and rounded once. The rest is left to snprintf.
#include "formats/decimal.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define MAX_POWER 27

#ifdef __SIZEOF_INT128__
__extension__ typedef unsigned __int128 wide;

static const uint64_t power_of_5[MAX_POWER + 1] = {1u,
                                                   5u,
                                                   25u,
                                                   125u,
                                                   625u,
                                                   3125u,
                                                   15625u,
                                                   78125u,
                                                   390625u,
                                                   1953125u,
                                                   9765625u,
                                                   48828125u,
                                                   244140625u,
                                                   1220703125u,
                                                   6103515625u,
                                                   30517578125u,
                                                   152587890625u,
                                                   762939453125u,
                                                   3814697265625u,
                                                   19073486328125u,
                                                   95367431640625u,
                                                   476837158203125u,
                                                   2384185791015625u,
                                                   11920928955078125u,
                                                   59604644775390625u,
                                                   298023223876953125u,
                                                   1490116119384765625u,
                                                   7450580596923828125u};

static int bit_length(wide n) {
    uint64_t high = (uint64_t)(n >> 64), low = (uint64_t)n;
    if (high) return 128 - __builtin_clzll(high);
    return low ? 64 - __builtin_clzll(low) : 0;
}

// n·2^exponent rounded to the nearest double, ties to even. The result must be a normal number.
static double round_to_double(wide n, int exponent) {
    int excess = bit_length(n) - 53;
    if (excess <= 0) return ldexp((double)(uint64_t)n, exponent);
    uint64_t top = (uint64_t)(n >> excess);
    wide rest = n & (((wide)1 << excess) - 1), half = (wide)1 << (excess - 1);
    if (rest > half || (rest == half && (top & 1))) top++;
    return ldexp((double)top, exponent + excess);
}

#endif

bool sagi_decimal_to_double(uint64_t w, int q, double *value) {
#ifdef __SIZEOF_INT128__
    if (w == 0 || q < -MAX_POWER || q > MAX_POWER) return false;
    if (q >= 0) {
        *value = round_to_double((wide)w * power_of_5[q], q);
        return true;
    }
    int w_shift = __builtin_clzll(w), d_shift = __builtin_clzll(power_of_5[-q]);
    uint64_t n = w << w_shift, d = power_of_5[-q] << d_shift;
    wide dividend = (wide)n << 63, quotient = dividend / d;
    bool remainder = quotient * d != dividend;
    *value = round_to_double(quotient << 1 | remainder, q + d_shift - w_shift - 64);
    return true;
#else
    (void)w, (void)q, (void)value;
    return false;
#endif
}

size_t sagi_format_integer(long long value, char *text) {
    char reversed[20];
    size_t count = 0, length = 0;
    unsigned long long rest = value < 0 ? 0ull - (unsigned long long)value : (unsigned long long)value;
    do {
        reversed[count++] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest);
    if (value < 0) text[length++] = '-';
    while (count) text[length++] = reversed[--count];
    return length;
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static size_t slow_format(double value, char *text) {
    char copy[64];
    int length = snprintf(copy, sizeof copy, "%.17g", value);
    size_t used = 0;
    bool point = false;
    for (int i = 0; i < length && used < SAGI_NUMBER_BYTES; i++) {
        bool plain = is_digit(copy[i]) || copy[i] == '-' || copy[i] == '+' || copy[i] == 'e';
        if (!plain && point) continue; // a locale's point may be several bytes
        point |= !plain;
        text[used++] = plain ? copy[i] : '.';
    }
    return used;
}

#ifdef __SIZEOF_INT128__
// m·5^k·2^shift rounded to the nearest whole number, ties to even; it must be below 2⁶³.
static uint64_t scaled(uint64_t m, int k, int shift) {
    wide product = (wide)m * power_of_5[k];
    if (shift >= 0) return (uint64_t)(product << shift);
    if (shift < -127) return 0;
    uint64_t whole = (uint64_t)(product >> -shift);
    wide rest = product & (((wide)1 << -shift) - 1), half = (wide)1 << (-shift - 1);
    return whole + (rest > half || (rest == half && (whole & 1)));
}

// The 17 digits of whole ∈ [10¹⁶, 10¹⁷) as d.ddd…·10^exponent, laid out as %.17g does.
static size_t lay_out(uint64_t whole, int exponent, char *text) {
    char digits[17];
    for (int i = 16; i >= 0; i--) {
        digits[i] = (char)('0' + whole % 10);
        whole /= 10;
    }
    int count = 17;
    while (count > 1 && digits[count - 1] == '0') count--;
    char *p = text;
    if (exponent >= 0) {
        int before_point = exponent + 1;
        memcpy(p, digits, (size_t)before_point);
        p += before_point;
        if (count > before_point) {
            *p++ = '.';
            memcpy(p, digits + before_point, (size_t)(count - before_point));
            p += count - before_point;
        }
    } else if (exponent >= -4) {
        *p++ = '0', *p++ = '.';
        for (int i = -1; i > exponent; i--) *p++ = '0';
        memcpy(p, digits, (size_t)count);
        p += count;
    } else {
        *p++ = digits[0];
        if (count > 1) {
            *p++ = '.';
            memcpy(p, digits + 1, (size_t)(count - 1));
            p += count - 1;
        }
        *p++ = 'e', *p++ = '-';
        *p++ = (char)('0' + -exponent / 10);
        *p++ = (char)('0' + -exponent % 10);
    }
    return (size_t)(p - text);
}
#endif

size_t sagi_format_number(double value, char text[SAGI_NUMBER_BYTES]) {
    if (isnan(value)) {
        text[0] = 'n', text[1] = 'a', text[2] = 'n';
        return 3;
    }
    size_t sign = signbit(value) ? 1 : 0;
    double x = fabs(value);
    if (sign) text[0] = '-';
    if (isinf(x)) {
        text[sign] = 'i', text[sign + 1] = 'n', text[sign + 2] = 'f';
        return sign + 3;
    }
    if (x == 0) {
        text[sign] = '0';
        return sign + 1;
    }
#ifdef __SIZEOF_INT128__
    if (x >= 1e-10 && x < 1e17) {
        const uint64_t limit = 100000000000000000u; // 10¹⁷
        int exponent2;
        uint64_t m = (uint64_t)ldexp(frexp(x, &exponent2), 53); // x = m·2^(exponent2 − 53)
        // ⌊log₁₀ 2^(exponent2 − 1)⌋ is ⌊log₁₀ x⌋ or one less, so at least −11.
        int exponent = (int)floor((exponent2 - 1) * 0.30102999566398120);
        uint64_t whole = scaled(m, 16 - exponent, exponent2 - 53 + 16 - exponent);
        if (whole >= limit) {
            exponent++;
            whole = scaled(m, 16 - exponent, exponent2 - 53 + 16 - exponent);
        }
        return sign + lay_out(whole, exponent, text + sign);
    }
#endif
    return slow_format(value, text);
}
