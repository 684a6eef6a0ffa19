// SPDX-License-Identifier: MIT
// How a pixel's samples are summed.
#ifndef SAGI_RENDER_FILM_H
#define SAGI_RENDER_FILM_H

#include "color.h"

#include <stdatomic.h>

// The running sum of one pixel. One thread owns a pixel and adds its samples in order.
typedef struct sagi_pixel {
    double r, g, b; // weighted
    double weight;
    uint32_t count; // samples summed: bad ones are not
} sagi_pixel;

// Sums that anybody adds to, in any order (splat.c).
typedef struct sagi_fixed {
    atomic_uint_fast64_t low, high;
} sagi_fixed;
typedef struct sagi_splat {
    sagi_fixed channel[3];
} sagi_splat;

// Adds a sample, dimmed until no component exceeds `most`; false, adding nothing, for one that is not finite.
static inline bool sagi_pixel_add(sagi_pixel *pixel, double weight, sag_rgb value, double most) {
    if (!sagi_rgb_is_finite(value)) return false;
    if (value.r > most || value.g > most || value.b > most)
        value = sagi_rgb_scale(value, most / sagi_rgb_max(value));
    pixel->r += weight * value.r, pixel->g += weight * value.g, pixel->b += weight * value.b;
    pixel->weight += weight;
    pixel->count++;
    return true;
}

// What the sums are to be divided by. The sum of the weights: so what is the same everywhere stays the same,
// whatever the weights. But a few samples of a filter that is negative in part may weigh next to nothing
// together: then what they weigh on the average.
static inline double sagi_pixel_weight(const sagi_pixel *pixel, double mean_weight) {
    const double expected = pixel->count * mean_weight;
    return fabs(pixel->weight) > expected / 4 ? pixel->weight : expected;
}

#endif
