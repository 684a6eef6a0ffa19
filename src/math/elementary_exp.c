// SPDX-License-Identifier: MIT
// Exponentials, logarithms, powers and roots.
//
// exp: x = k ln 2 + r, |r| ≤ ln 2/2, r as a double-double; Taylor's series to r¹³, the next term being below
// 2⁻⁵⁷; times 2ᵏ.
//
// log: x = 2ᵏ (1 + f), 1 + f in [√½, √2). With s = f/(2 + f), log(1 + f) = 2 atanh s = 2s + s R,
// R = 2 (s²/3 + s⁴/5 + …), s² < 0.0295. As 2s = f − f s this is f − (f²/2 − s (f²/2 + R)), whose first term
// carries nearly all and is exact.
//
// pow: exp(y log x), where y log x may be 745: log x must be good to 2⁻⁶⁵. So the same series with its first
// two terms in double-double, and exp of a double-double.
#include "math/dd.h"
#include "math/elementary.h"

#include <stdbool.h>

static const sagi_dd ln2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};

// exp of the sum, |x.hi| < 800.
static double exp_of(sagi_dd x) {
    const double k = (x.hi * 0x1.71547652b82fep+0 + 0x1.8p52) - 0x1.8p52;
    // The first 32 bits of ln 2, whose product with k is exact, and the rest.
    sagi_dd r = sagi_two_sum(x.hi - k * 0x1.62e42fee00000p-1, -k * 0x1.a39ef35793c76p-33);
    r = sagi_fast_two_sum(r.hi, r.lo + x.lo);
    double p = 1.0 / 6227020800;
    p = p * r.hi + 1.0 / 479001600;
    p = p * r.hi + 1.0 / 39916800;
    p = p * r.hi + 1.0 / 3628800;
    p = p * r.hi + 1.0 / 362880;
    p = p * r.hi + 1.0 / 40320;
    p = p * r.hi + 1.0 / 5040;
    p = p * r.hi + 1.0 / 720;
    p = p * r.hi + 1.0 / 120;
    p = p * r.hi + 1.0 / 24;
    p = p * r.hi + 1.0 / 6;
    p = p * r.hi + 0.5;
    const sagi_dd sum = sagi_two_sum(1, r.hi);
    const double e = sum.hi + (sum.lo + (r.lo * (1 + r.hi) + r.hi * r.hi * p));
    return scalbn(e, (int)k);
}

double sagi_exp(double x) {
    if (isnan(x)) return x;
    if (x > 709.8) return INFINITY;
    if (x < -745.2) return 0;
    return exp_of((sagi_dd){x, 0});
}

double sagi_expm1(double x) {
    if (!(fabs(x) < 0.35)) return sagi_exp(x) - 1;
    double p = 1.0 / 6227020800;
    for (int n = 12; n >= 2; n--) { // 1/n! + x p: n! = Γ(n + 1)
        static const double factorial[13] = {1,    1,     2,      6,       24,       120,      720,
                                             5040, 40320, 362880, 3628800, 39916800, 479001600};
        p = p * x + 1 / factorial[n];
    }
    return x + x * x * p;
}

// x = 2^*k (1 + f), for finite x > 0.
static double split(double x, int *k) {
    double m = frexp(x, k);
    if (m < 0x1.6a09e667f3bcdp-1) m *= 2, *k -= 1;
    return m - 1;
}

// 2 (z/(n0) + z²/(n0 + 2) + …) by Horner, for odd n0 and z < 0.0295.
static double tail(double z, int n0) {
    double r = 0;
    for (int n = 25; n >= n0; n -= 2) r = (r + 2.0 / n) * z;
    return r;
}

double sagi_log(double x) {
    if (!(x > 0)) return x == 0 ? -INFINITY : NAN;
    if (x == INFINITY) return x;
    int k;
    const double f = split(x, &k), s = f / (2 + f), half = 0.5 * f * f;
    const double high = k * 0x1.62e42fee00000p-1, low = k * 0x1.a39ef35793c76p-33;
    const sagi_dd sum = sagi_two_sum(high, f);
    return sum.hi + (sum.lo + (low - (half - s * (half + tail(s * s, 3)))));
}

// log x for finite x > 0, with a relative error below 2⁻⁶⁵.
static sagi_dd log_of(double x) {
    int k;
    const double f = split(x, &k);
    const sagi_dd s = sagi_dd_div(sagi_dd_from(f), sagi_two_sum(2, f)), z = sagi_dd_mul(s, s);
    static const sagi_dd two_thirds = {0x1.5555555555555p-1, 0x1.5555555555555p-55},
                         two_fifths = {0x1.999999999999ap-2, -0x1.999999999999ap-56};
    sagi_dd r = sagi_dd_add_double(two_fifths, tail(z.hi, 7));
    r = sagi_dd_add(two_thirds, sagi_dd_mul(z, r));
    r = sagi_dd_add_double(sagi_dd_mul(z, r), 2);
    return sagi_dd_add(sagi_dd_mul(s, r), sagi_dd_mul_double(ln2, k));
}

static bool is_odd(double y) { return fabs(y) < 0x1p53 && y == floor(y) && fmod(y, 2) != 0; }

double sagi_pow(double x, double y) {
    if (y == 0 || x == 1) return 1;
    if (isnan(x) || isnan(y)) return x + y;
    const double size = fabs(x);
    if (isinf(y)) return size == 1 ? 1 : (size > 1) == (y > 0) ? INFINITY : 0;
    if (x < 0 && y != floor(y) && !isinf(x)) return NAN;
    const double sign = signbit(x) && is_odd(y) ? -1 : 1;
    if (size == 0) return y > 0 ? sign * 0 : sign * INFINITY;
    if (isinf(size)) return y > 0 ? sign * INFINITY : sign * 0;
    const sagi_dd l = log_of(size);
    if (fabs(l.hi * y) > 800) return sign * ((l.hi > 0) == (y > 0) ? INFINITY : 0);
    return sign * exp_of(sagi_dd_mul_double(l, y));
}

double sagi_cbrt(double x) {
    if (x == 0 || !isfinite(x)) return x;
    int exponent;
    double m = frexp(fabs(x), &exponent);
    while (exponent % 3 != 0) m *= 0.5, exponent++;
    // m in [1/8, 1). Halley's step y (y³ + 2m)/(2y³ + m) triples the right digits, of which the line has
    // one and a half; the last step takes m − y³ in double-double.
    double y = 0.4 + 0.62 * m;
    for (int i = 0; i < 3; i++) {
        const double cube = y * y * y;
        y *= (cube + 2 * m) / (2 * cube + m);
    }
    const sagi_dd cube = sagi_dd_mul_double(sagi_two_prod(y, y), y);
    y += ((m - cube.hi) - cube.lo) / (3 * y * y);
    return copysign(ldexp(y, exponent / 3), x);
}

double sagi_hypot(double x, double y) {
    x = fabs(x), y = fabs(y);
    if (isinf(x) || isinf(y)) return INFINITY;
    const double large = x > y ? x : y, small = x > y ? y : x;
    if (!(large > 0)) return x + y; // 0 or NaN
    double scale = 1;
    if (large > 0x1p400) scale = 0x1p600;
    if (large < 0x1p-300) scale = 0x1p-700;
    const double a = large / scale, b = small / scale;
    if (isnan(b) || b < a * 0x1p-60) return x + y;
    const sagi_dd squares = sagi_dd_add(sagi_two_prod(a, a), sagi_two_prod(b, b));
    return sagi_dd_to_double(sagi_dd_sqrt(squares)) * scale;
}
