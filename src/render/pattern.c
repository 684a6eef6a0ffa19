// SPDX-License-Identifier: MIT
// Checkerboard, dots, marble and wind, after pbrt-v4 (PBR 4th ed., §10.4–10.5 and, for the last two, 3rd ed.
// §10.6), so that scenes made for it look the same.
//
// The checkerboard is a product of square waves ±1, one for each coordinate, so its mean over a footprint
// whose sides are along the coordinates is the product of the waves' means. Each is weighted with a triangle
// of half width r about x: with D the second integral of the wave,
//   ∫ wave(x + y) (r − |y|) dy/r² = (D(x + r) − 2 D(x) + D(x − r))/r².
// The wave is +1 on [0, 1), −1 on [1, 2) and so on; D(x) = x/2 + y (1 − 2|y|), y = x/2 − ⌊x/2⌋ − 1/2, up to a
// linear part that the second difference does not see.
#include "pattern.h"

#include "noise.h"

static double second_integral(double x) {
    const double y = x / 2 - floor(x / 2) - 0.5;
    return x / 2 + y * (1 - 2 * fabs(y));
}

static double wave(double x, double r) {
    if (floor(x - r) == floor(x + r)) return 1 - 2 * (floor(x) - 2 * floor(floor(x) / 2));
    if (!(r < 1e6)) return 0; // also where nothing is finite
    return (second_integral(x + r) - 2 * second_integral(x) + second_integral(x - r)) / (r * r);
}

// Half the width of the triangle over a pixel and half of each neighbour.
static double half_width(double dx, double dy) { return 1.5 * fmax(fabs(dx), fabs(dy)); }

double sagi_checkerboard_2d(const sagi_spot_2d *at) {
    return 0.5 -
           0.5 * wave(at->s, half_width(at->dsdx, at->dsdy)) * wave(at->t, half_width(at->dtdx, at->dtdy));
}

double sagi_checkerboard_3d(const sagi_spot_3d *at) {
    return 0.5 - 0.5 * wave(at->p.x, half_width(at->dpdx.x, at->dpdy.x)) *
                     wave(at->p.y, half_width(at->dpdx.y, at->dpdy.y)) *
                     wave(at->p.z, half_width(at->dpdx.z, at->dpdy.z));
}

// In about two of five unit cells a dot, moved by noise as far as it stays within its cell.
bool sagi_in_dot(double s, double t) {
    const double cell_s = floor(s + 0.5), cell_t = floor(t + 0.5), radius = 0.35, room = 0.5 - radius;
    if (!(sagi_noise_2d(cell_s + 0.5, cell_t + 0.5) > 0)) return false;
    const double ds = s - (cell_s + room * sagi_noise_2d(cell_s + 1.5, cell_t + 2.8));
    const double dt = t - (cell_t + room * sagi_noise_2d(cell_s + 4.5, cell_t + 9.8));
    return ds * ds + dt * dt < radius * radius;
}

double sagi_windy(const sagi_spot_3d *at) {
    const double strength =
        sagi_noise_fbm(sag_scale(at->p, 0.1), sag_scale(at->dpdx, 0.1), sag_scale(at->dpdy, 0.1), 0.5, 3);
    return fabs(strength) * sagi_noise_fbm(at->p, at->dpdx, at->dpdy, 0.5, 6);
}

// Cubic Bézier curves through these, one after another, four at a time.
static const sag_rgb veins[] = {
    {0.58, 0.58, 0.6}, {0.58, 0.58, 0.6}, {0.58, 0.58, 0.6}, {0.5, 0.5, 0.5},   {0.6, 0.59, 0.58},
    {0.58, 0.58, 0.6}, {0.58, 0.58, 0.6}, {0.2, 0.2, 0.33},  {0.58, 0.58, 0.6},
};
#define CURVES ((int)(sizeof veins / sizeof *veins) - 3)

static sag_rgb between(sag_rgb a, sag_rgb b, double t) {
    return sagi_rgb_add(sagi_rgb_scale(a, 1 - t), sagi_rgb_scale(b, t));
}

// De Casteljau.
static sag_rgb bezier(const sag_rgb *c, double t) {
    const sag_rgb a = between(c[0], c[1], t), b = between(c[1], c[2], t), d = between(c[2], c[3], t);
    return between(between(a, b, t), between(b, d, t), t);
}

sag_rgb sagi_marble(const sagi_spot_3d *at, double scale, double variation, double omega, int octaves) {
    const sag_vec3 p = sag_scale(at->p, scale);
    const double noise =
        sagi_noise_fbm(p, sag_scale(at->dpdx, scale), sag_scale(at->dpdy, scale), omega, octaves);
    const double t = sagi_clamp(0.5 + 0.5 * sagi_sin(p.y + variation * noise), 0, 1) * CURVES;
    const int first = t < CURVES ? (int)t : CURVES - 1;
    return sagi_rgb_scale(bezier(veins + first, t - first), 1.5);
}
