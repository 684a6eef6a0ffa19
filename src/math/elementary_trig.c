// SPDX-License-Identifier: MIT
// Sine, cosine and the arc functions.
//
// Sine and cosine. x = k π/2 + r with |r| ≤ π/4, r as a double-double. Taylor's series in r² end where the
// next term is below 2⁻⁵⁸; k mod 4 says which of the two, with which sign. k π/2 is taken off in three
// parts of π/2 whose products with k < 2²⁰ are exact (Cody & Waite 1980). Larger x: only the bits of 2/π that
// matter are multiplied by the 53 bits of x, as whole numbers (Payne & Hanek, "Radian reduction for
// trigonometric functions", SIGNUM 18, 1983): what lies above gives whole turns, what lies below is under
// 2⁻¹³⁷, and no double's r is under 2⁻⁶².
//
// Arc tangent. t = the smaller over the larger of |x| and |y|, in [0, 1]; the nearest of the angles
// atan(i/8) is taken off by atan t − atan c = atan((t − c)/(1 + t c)), and a series of seven terms does the
// rest, at most 1/16. The octant is put back in double-double.
#include "math/dd.h"
#include "math/elementary.h"

#include <stdbool.h>
#include <stdint.h>

static const sagi_dd pi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53},
                     half_pi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};

// 2/π after the point.
static const uint64_t two_over_pi[20] = {
    0xA2F9836E4E441529, 0xFC2757D1F534DDC0, 0xDB6295993C439041, 0xFE5163ABDEBBC561, 0xB7246E3A424DD2E0,
    0x06492EEA09D1921C, 0xFE1DEB1CB129A73E, 0xE88235F52EBB4484, 0xE99C7026B45F7E41, 0x3991D639835339F4,
    0x9C845F8BBDF9283B, 0x1FF897FFDE05980F, 0xEF2F118B5A0A6D1F, 0x6D367ECF27CB09B7, 0x4F463F669E5FEA2D,
    0x7527BAC7EBE5F17B, 0x3D0739F78A5292EA, 0x6BFB5FB11F8D5D08, 0x56033046FC7B6BAB, 0xF0CFBC209AF4361D,
};

// 64 bits of 2/π from the given one on.
static uint64_t bits_from(uint32_t bit) {
    const uint32_t word = bit / 64, shift = bit % 64;
    return shift ? two_over_pi[word] << shift | two_over_pi[word + 1] >> (64 - shift) : two_over_pi[word];
}

// The 256 bits, from the highest word down, moved up by shift < 128.
static void shift_up(uint64_t w[4], uint32_t shift) {
    for (; shift >= 64; shift -= 64) w[0] = w[1], w[1] = w[2], w[2] = w[3], w[3] = 0;
    if (shift == 0) return;
    for (int i = 0; i < 4; i++) w[i] = w[i] << shift | (i < 3 ? w[i + 1] >> (64 - shift) : 0);
}

// r for x ≥ 2²⁰; returns k mod 4.
static unsigned reduce_large(double x, sagi_dd *r) {
    int exponent;
    const uint64_t m = (uint64_t)ldexp(frexp(x, &exponent), 53);
    exponent -= 53; // x = m 2^exponent
    const uint32_t first = exponent > 2 ? (uint32_t)exponent - 2 : 0;
    // m × 192 bits of 2/π, with 192 − (exponent − first) bits after the point.
    uint64_t w[4] = {0};
    unsigned __int128 carry = 0;
    for (uint32_t i = 3; i > 0; i--) {
        carry += (unsigned __int128)m * bits_from(first + 64 * (i - 1));
        w[i] = (uint64_t)carry;
        carry >>= 64;
    }
    w[0] = (uint64_t)carry;
    const int above = 64 + exponent - (int)first; // bits before the point, of which the last two count
    shift_up(w, (uint32_t)above - 2);
    unsigned k = (unsigned)(w[0] >> 62);
    shift_up(w, 2);
    const bool negative = w[0] >> 63; // nearer to the next
    if (negative) {
        k++;
        bool borrow = true;
        for (int i = 4; i-- > 0;) w[i] = ~w[i] + borrow, borrow = borrow && w[i] == 0;
    }
    int scale = 0;
    while (scale < 128 && !(w[0] >> 63)) {
        const uint32_t zeros = w[0] ? (uint32_t)__builtin_clzll(w[0]) : 64;
        shift_up(w, zeros);
        scale -= (int)zeros;
    }
    const sagi_dd turn = sagi_fast_two_sum((double)(w[0] >> 11) * 0x1p-53,
                                           (double)((w[0] & 0x7FF) << 42 | w[1] >> 22) * 0x1p-106);
    *r = sagi_dd_mul(turn, half_pi);
    const double factor = ldexp(negative ? -1 : 1, scale);
    r->hi *= factor, r->lo *= factor;
    return k & 3;
}

// r for |x| < 2²⁰; returns k mod 4.
static unsigned reduce_small(double x, sagi_dd *r) {
    const double part1 = 0x1.921fb54400000p+0, part2 = 0x1.0b4611a600000p-34, part3 = 0x1.3198a2e037073p-69;
    const double k = (x * 0x1.45f306dc9c883p-1 + 0x1.8p52) - 0x1.8p52; // rounded to the nearest
    *r = sagi_two_sum(x - k * part1, -k * part2);
    *r = sagi_dd_sub(*r, sagi_two_prod(k, part3));
    return (unsigned)(int)k & 3;
}

static double sine_of(sagi_dd r) {
    const double z = r.hi * r.hi;
    double s = 1.0 / 355687428096000;
    s = s * z - 1.0 / 1307674368000;
    s = s * z + 1.0 / 6227020800;
    s = s * z - 1.0 / 39916800;
    s = s * z + 1.0 / 362880;
    s = s * z - 1.0 / 5040;
    s = s * z + 1.0 / 120;
    s = s * z - 1.0 / 6;
    return r.hi + (r.lo * (1 - 0.5 * z) + r.hi * z * s);
}

static double cosine_of(sagi_dd r) {
    const double z = r.hi * r.hi;
    double c = 1.0 / 20922789888000;
    c = c * z - 1.0 / 87178291200;
    c = c * z + 1.0 / 479001600;
    c = c * z - 1.0 / 3628800;
    c = c * z + 1.0 / 40320;
    c = c * z - 1.0 / 720;
    c = c * z + 1.0 / 24;
    const double half = 0.5 * z, most = 1 - half;
    return most + (((1 - most) - half) + (z * z * c - r.hi * r.lo));
}

void sagi_sincos(double x, double *sine, double *cosine) {
    const double size = fabs(x);
    if (!(size < INFINITY)) {
        *sine = *cosine = x - x;
        return;
    }
    sagi_dd r = {size, 0};
    unsigned k = 0;
    if (size > 0x1.921fb54442d18p-1) k = size < 0x1p20 ? reduce_small(size, &r) : reduce_large(size, &r);
    double s = sine_of(r), c = cosine_of(r);
    if (size < 0x1p-30) s = size;
    if (k & 1) {
        const double swap = s;
        s = c, c = -swap;
    }
    if (k & 2) s = -s, c = -c;
    *sine = signbit(x) ? -s : s;
    *cosine = c;
}

double sagi_sin(double x) {
    double s, c;
    sagi_sincos(x, &s, &c);
    return s;
}

double sagi_cos(double x) {
    double s, c;
    sagi_sincos(x, &s, &c);
    return c;
}

double sagi_tan(double x) {
    double s, c;
    sagi_sincos(x, &s, &c);
    return s / c;
}

// atan(low/high), 0 ≤ low ≤ high, high > 0.
static sagi_dd arc(double low, double high) {
    static const sagi_dd angles[9] = {
        {0, 0},
        {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
        {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
        {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
        {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
        {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
        {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
        {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
        {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
    };
    if (low < 0x1p-30 * high) return (sagi_dd){low / high, 0};
    if (high > 0x1p500) low *= 0x1p-600, high *= 0x1p-600;
    if (high < 0x1p-400) low *= 0x1p600, high *= 0x1p600;
    const int i = (int)(8 * (low / high) + 0.5);
    // (t − c)/(1 + t c) = (low − c high)/(high + c low)
    const double c = i * 0.125;
    const sagi_dd above = sagi_dd_add_double(sagi_two_prod(-c, high), low),
                  below = sagi_dd_add_double(sagi_two_prod(c, low), high);
    sagi_dd u = {above.hi / below.hi, 0};
    const sagi_dd back = sagi_two_prod(u.hi, below.hi);
    u.lo = ((above.hi - back.hi) - back.lo + above.lo - u.hi * below.lo) / below.hi;
    const double z = u.hi * u.hi;
    double s = 1.0 / 13;
    s = s * z - 1.0 / 11;
    s = s * z + 1.0 / 9;
    s = s * z - 1.0 / 7;
    s = s * z + 1.0 / 5;
    s = s * z - 1.0 / 3;
    s = -s;
    return sagi_dd_add(angles[i], sagi_fast_two_sum(u.hi, u.lo - u.hi * z * s));
}

double sagi_atan2(double y, double x) {
    if (isnan(x) || isnan(y)) return x + y;
    double ax = fabs(x), ay = fabs(y);
    if (isinf(ax) || isinf(ay)) ax = isinf(ax), ay = isinf(ay);
    sagi_dd angle = {0, 0};
    if (ax > 0 || ay > 0) {
        angle = ay <= ax ? arc(ay, ax) : sagi_dd_sub(half_pi, arc(ax, ay));
    }
    if (signbit(x)) angle = sagi_dd_sub(pi, angle);
    return copysign(sagi_dd_to_double(angle), y);
}

double sagi_asin(double x) { return fabs(x) <= 1 ? sagi_atan2(x, sqrt((1 - x) * (1 + x))) : NAN; }

double sagi_acos(double x) { return fabs(x) <= 1 ? 2 * sagi_atan2(sqrt(1 - x), sqrt(1 + x)) : NAN; }
