// SPDX-License-Identifier: MIT
// Warps of the unit square. All keep areas in proportion, so that well spread numbers make well spread
// points.
#include "warp.h"
#include "math/elementary.h"
#include "quick.h"

typedef double pair __attribute__((vector_size(16)));
typedef int64_t pair_mask __attribute__((vector_size(16)));

// { sine, cosine } of |x| ≤ π/4, to 2⁻⁴⁵: Taylor's series.
static inline pair small_sincos(double x) {
    const double z = x * x;
    const double z2 = z * z;
    const pair c6 = {1.0 / 6227020800, 1.0 / 479001600};
    const pair c45 = (pair){1.0 / 362880, 1.0 / 40320} + z * (pair){-1.0 / 39916800, -1.0 / 3628800};
    const pair c23 = (pair){1.0 / 120, 1.0 / 24} + z * (pair){-1.0 / 5040, -1.0 / 720};
    const pair c01 = 1 + z * (pair){-1.0 / 6, -1.0 / 2};
    return (c01 + z2 * (c23 + z2 * (c45 + z2 * c6))) * (pair){x, 1}; // few steps one after the other
}

// The angle is π/4 b/a, or π/2 − π/4 a/b where |b| is the larger: then sine and cosine change places. Which
// of the two is a coin's toss, which no processor guesses: so numbers change places by masks.
sag_vec2 sagi_warp_disk(sag_vec2 u) {
    const pair ab = {2 * u.x - 1, 2 * u.y - 1}, ba = {ab[1], ab[0]};
    const pair_mask flat = (pair)((pair_mask)ab & INT64_MAX) > (pair)((pair_mask)ba & INT64_MAX),
                    whole = {flat[0], flat[0]};
    const pair sorted = (pair)((whole & (pair_mask)ab) | (~whole & (pair_mask)ba)); // the larger, the smaller
    if (sorted[0] == 0) return (sag_vec2){0, 0};
    const pair sc = small_sincos(SAGI_RENDER_PI / 4 * (sorted[1] / sorted[0])), cs = {sc[1], sc[0]};
    const pair d = (pair)((whole & (pair_mask)cs) | (~whole & (pair_mask)sc)) * sorted[0];
    return (sag_vec2){d[0], d[1]};
}

sag_vec3 sagi_warp_cosine(sag_vec2 u) {
    const sag_vec2 d = sagi_warp_disk(u);
    const double z2 = 1 - d.x * d.x - d.y * d.y;
    return sag_vec3_make(d.x, d.y, sqrt(z2 > 0 ? z2 : 0));
}

sag_vec3 sagi_warp_sphere(sag_vec2 u) {
    double z = 1 - 2 * u.x, r = sqrt(fmax(0, 1 - z * z));
    double sine, cosine;
    sagi_quick_turn(u.y, &sine, &cosine);
    return sag_vec3_make(r * cosine, r * sine, z);
}

// Density a at 0 and b at 1, linear between: where the distribution function is u (a + b)/2.
static double sample_linear(double u, double a, double b) {
    if (a == b) return u;
    const double x = u * (a + b) / (a + sqrt(a * a + u * (b * b - a * a)));
    return x < SAGI_ONE_MINUS ? x : SAGI_ONE_MINUS;
}

sag_vec2 sagi_warp_bilinear(const double w[4], sag_vec2 u) {
    u.y = sample_linear(u.y, w[0] + w[1], w[2] + w[3]);
    u.x = sample_linear(u.x, (1 - u.y) * w[0] + u.y * w[2], (1 - u.y) * w[1] + u.y * w[3]);
    return u;
}

double sagi_warp_bilinear_pdf(const double w[4], sag_vec2 p) {
    const double here = (1 - p.y) * ((1 - p.x) * w[0] + p.x * w[1]) + p.y * ((1 - p.x) * w[2] + p.x * w[3]);
    return 4 * here / (w[0] + w[1] + w[2] + w[3]);
}

double sagi_warp_tent(double u, double radius) {
    // Each half's distribution function is a parabola: 1 − (1 − |x|)².
    return u < 0.5 ? radius * (sqrt(2 * u) - 1) : radius * (1 - sqrt(2 * (1 - u)));
}

// The square's inner diamond |a| + |b| ≤ 1 (a, b in [−1, 1]) is the upper half sphere, the four corners
// folded out the lower one. r = 1 − |1 − |a| − |b|| is the distance from the centre or from the corners;
// within a quadrant the angle runs with (b − a)/r, and z = 1 − r² keeps areas in proportion.
sag_vec3 sagi_equal_area_to_sphere(sag_vec2 p) {
    double a = 2 * p.x - 1, b = 2 * p.y - 1;
    double from_fold = 1 - (fabs(a) + fabs(b));
    double r = 1 - fabs(from_fold);
    double phi = (r == 0 ? 1 : (fabs(b) - fabs(a)) / r + 1) * SAGI_RENDER_PI / 4;
    double z = copysign(1 - r * r, from_fold);
    double s = r * sqrt(2 - r * r);
    double sine, cosine;
    sagi_quick_sincos(phi, &sine, &cosine);
    return sag_vec3_make(copysign(cosine, a) * s, copysign(sine, b) * s, z);
}

sag_vec2 sagi_equal_area_from_sphere(sag_vec3 d) {
    double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    double r = sqrt(z < 1 ? 1 - z : 0);
    double phi = x == 0 && y == 0 ? 0 : sagi_quick_atan2(y, x) * (2 / SAGI_RENDER_PI); // in [0, 1]
    double b = phi * r, a = r - b;
    if (d.z < 0) {
        double swap = a;
        a = 1 - b;
        b = 1 - swap;
    }
    a = copysign(a, d.x), b = copysign(b, d.y);
    return (sag_vec2){(a + 1) / 2, (b + 1) / 2};
}
