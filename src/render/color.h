// SPDX-License-Identifier: MIT
// Arithmetic of colours, and the constants of the renderer.
#ifndef SAGI_RENDER_COLOR_H
#define SAGI_RENDER_COLOR_H

#include "math/elementary.h"
#include <sagitta/render.h>

#define SAGI_RENDER_PI 3.14159265358979323846
#define SAGI_INV_PI    0.31830988618379067154
// The largest double below 1: random numbers are kept under it.
#define SAGI_ONE_MINUS 0x1.fffffffffffffp-1

static inline sag_rgb sagi_rgb(double r, double g, double b) {
    sag_rgb c;
    c.r = r, c.g = g, c.b = b;
    return c;
}
static inline sag_rgb sagi_rgb_grey(double x) { return sagi_rgb(x, x, x); }
static inline sag_rgb sagi_rgb_add(sag_rgb a, sag_rgb b) { return sagi_rgb(a.r + b.r, a.g + b.g, a.b + b.b); }
static inline sag_rgb sagi_rgb_sub(sag_rgb a, sag_rgb b) { return sagi_rgb(a.r - b.r, a.g - b.g, a.b - b.b); }
static inline sag_rgb sagi_rgb_mul(sag_rgb a, sag_rgb b) { return sagi_rgb(a.r * b.r, a.g * b.g, a.b * b.b); }
static inline sag_rgb sagi_rgb_scale(sag_rgb a, double s) { return sagi_rgb(a.r * s, a.g * s, a.b * s); }
static inline double sagi_rgb_max(sag_rgb a) { return fmax(a.r, fmax(a.g, a.b)); }
static inline double sagi_rgb_mean(sag_rgb a) { return (a.r + a.g + a.b) / 3; }
// True for a colour of zeros, negative numbers and NaN.
static inline bool sagi_rgb_is_black(sag_rgb a) { return !(a.r > 0 || a.g > 0 || a.b > 0); }
static inline bool sagi_rgb_is_finite(sag_rgb a) { return isfinite(a.r) && isfinite(a.g) && isfinite(a.b); }
static inline double sagi_clamp(double x, double low, double high) {
    return x > low ? (x < high ? x : high) : low;
}
static inline sag_rgb sagi_rgb_clamp(sag_rgb a) {
    return sagi_rgb(sagi_clamp(a.r, 0, 1), sagi_clamp(a.g, 0, 1), sagi_clamp(a.b, 0, 1));
}
static inline double sagi_square(double x) { return x * x; }
// The same on every machine, exact for powers of 2.
static inline double sagi_log2(double x) {
    int exponent;
    const double significand = frexp(x, &exponent);
    return exponent + sagi_log(significand) / 0.69314718055994530942;
}

#endif
