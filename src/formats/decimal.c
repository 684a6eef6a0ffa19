// SPDX-License-Identifier: MIT
// Decimal to binary and back by whole numbers alone.
//
// Reading: up to 19 digits are a whole number w < 2⁶⁴, and the text means w·10^q = w·5^q·2^q. A table has the
// leading 128 bits T of 5^q for |q| ≤ 64, and 64 × 128 bits make 192, of which the upper 128 are kept, P.
// What P lacks is known: T is off by less than one (too low for q ≥ 0, too high for q < 0), so w·T by less
// than 2⁶⁴, which is one unit of P, and the dropped bits are less than another. The exact product is thus in
// (P − 1, P + 2), and rounding P to 53 bits is right unless P stands within two units of the middle between
// two doubles. There, and beyond the table, nothing is claimed and strtod has the word; up to 5²⁷ < 2⁶³ both
// T and P are exact and ties go to the even number here. (Lemire, "Number Parsing at a Gigabyte per Second",
// Software: Practice and Experience 51(8), 2021, shows that the first product alone nearly always decides.)
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

#endif

bool sagi_decimal_to_double(uint64_t w, int q, double *value) {
#ifdef __SIZEOF_INT128__
    if (w == 0 || q < -SAGI_MAX_DECIMAL_POWER || q > SAGI_MAX_DECIMAL_POWER) return false;
    const uint64_t *t = &sagi_decimal_powers[2 * (q + SAGI_MAX_DECIMAL_POWER)];
    const int w_shift = __builtin_clzll(w);
    const uint64_t n = w << w_shift;
    const wide product = (wide)n * t[0] + ((wide)n * t[1] >> 64);
    // Two factors with their upper bits set: the product has its upper bit there or one below.
    uint64_t high = (uint64_t)(product >> 64), low = (uint64_t)product;
    const int below = (int)(high >> 63 ^ 1);
    if (below) high = high << 1 | low >> 63, low <<= 1;
    // Bits 10 … 0 of `high` and all of `low` are rounded away; the middle is bit 10 alone.
    const uint64_t rest = high & 0x7FF, half = 0x400;
    uint64_t top = high >> 11;
    const bool near_middle = (rest == half && low <= 8) || (rest == half - 1 && low >= UINT64_MAX - 8);
    if (near_middle && !(q >= 0 && q <= MAX_POWER)) return false;
    if (rest > half || (rest == half && (low != 0 || (top & 1)))) top++;
    // 2^b ≤ 5^q < 2^(b+1) for b = ⌊q log₂ 5⌋, and T = 5^q·2^(127 − b). So the value is top·2^e, which is far
    // from the ends of double's range; as bits the carry of top = 2⁵³ goes where it belongs.
    const int b = (q * 152170 - ((q * 152170) & 0xFFFF)) / 65536, e = b - 127 + 139 + q - w_shift - below;
    const uint64_t bits = ((uint64_t)(e + 52 + 1023) << 52) + (top - ((uint64_t)1 << 52));
    memcpy(value, &bits, sizeof bits);
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
