// SPDX-License-Identifier: MIT
// Sine, cosine and the arc tangent where sampling needs them: in plain doubles, a few roundings off instead
// of below one, and a third of the time of those in math/elementary.h. The same bits on every machine, as
// those. Test: tests/render/test_quick.c.
#ifndef SAGI_RENDER_QUICK_H
#define SAGI_RENDER_QUICK_H

#include <math.h>

// |x| ≤ π/2; errors below 6·2⁻⁵³ (4 in three million). Taylor's series, cut off where a term is below 2⁻⁵⁴,
// both at once.
static inline void sagi_quick_sincos(double x, double *sine, double *cosine) {
    typedef double pair __attribute__((vector_size(16)));
    const double z = x * x;
    pair p = {-1.0 / 121645100408832000, 1.0 / 2432902008176640000};
    p = p * z + (pair){1.0 / 355687428096000, -1.0 / 6402373705728000};
    p = p * z + (pair){-1.0 / 1307674368000, 1.0 / 20922789888000};
    p = p * z + (pair){1.0 / 6227020800, -1.0 / 87178291200};
    p = p * z + (pair){-1.0 / 39916800, 1.0 / 479001600};
    p = p * z + (pair){1.0 / 362880, -1.0 / 3628800};
    p = p * z + (pair){-1.0 / 5040, 1.0 / 40320};
    p = p * z + (pair){1.0 / 120, -1.0 / 720};
    p = p * z + (pair){-1.0 / 6, 1.0 / 24};
    *sine = x + x * z * p[0];
    *cosine = 1 + z * (z * p[1] - 0.5);
}

// Of the angle 2π u, u in [0, 1]: of twice π u − π/2, and turned by half a circle. Errors below 2⁻⁴⁹: those
// of the sine and cosine count 2(|s| + |c|) ≤ 2√2 times, the angle's and the product's are a few roundings.
static inline void sagi_quick_turn(double u, double *sine, double *cosine) {
    double s, c;
    sagi_quick_sincos((u - 0.5) * 0x1.921fb54442d18p+1, &s, &c);
    *sine = -2 * s * c;
    *cosine = (s - c) * (s + c);
}

// The angle of (x, y), y ≥ 0, in [0, π]; x and y finite, not both 0, their products neither over- nor
// underflowing. Relative error below 2⁻⁵⁰. With t = low/high in [0, 1] and c the nearest of i/8,
// atan t = atan c + atan((t − c)/(1 + t c)), the latter of at most 1/16.
static inline double sagi_quick_atan2(double y, double x) {
    static const double angles[9] = {0,
                                     0x1.fd5ba9aac2f6ep-4,
                                     0x1.f5b75f92c80ddp-3,
                                     0x1.6f61941e4def1p-2,
                                     0x1.dac670561bb4fp-2,
                                     0x1.1e00babdefeb4p-1,
                                     0x1.4978fa3269ee1p-1,
                                     0x1.700a7c5784634p-1,
                                     0x1.921fb54442d18p-1};
    const double size = fabs(x);
    const double low = y < size ? y : size, high = y < size ? size : y;
    const double ratio = low / high;
    const int i = ratio > 0 ? (int)(8 * ratio + 0.5) : 0; // (also for what is no number)
    const double c = i * 0.125, t = (low - c * high) / (high + c * low), z = t * t;
    double s = 1.0 / 13;
    s = s * z - 1.0 / 11;
    s = s * z + 1.0 / 9;
    s = s * z - 1.0 / 7;
    s = s * z + 1.0 / 5;
    s = s * z - 1.0 / 3;
    double angle = angles[i] + (t + t * z * s);
    if (y >= size) angle = 0x1.921fb54442d18p+0 - angle;
    return x < 0 ? 0x1.921fb54442d18p+1 - angle : angle;
}

#endif
