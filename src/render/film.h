// SPDX-License-Identifier: MIT
// Where within and around a pixel its samples lie, and how they are summed.
#ifndef SAGI_RENDER_FILM_H
#define SAGI_RENDER_FILM_H

#include "color.h"

#define SAGI_FILTER_STEPS 64

// A pixel filter to draw offsets from: the product of the same kind of curve in x and in y.
typedef struct sagi_filter {
    sag_filter_kind kind;
    double radius_x, radius_y;
    // Gaussian: the distribution function of each axis at equal steps over [0, radius], from 0 to 1.
    double cdf_x[SAGI_FILTER_STEPS + 1], cdf_y[SAGI_FILTER_STEPS + 1];
} sagi_filter;

// SAG_ERROR_ARGUMENT for a radius or sigma that is negative or not finite.
sag_status sagi_filter_init(sagi_filter *filter, const sag_film *film, sag_error *error);
// An offset from the pixel's centre in pixels, distributed as the filter.
sag_vec2 sagi_filter_sample(const sagi_filter *filter, sag_vec2 u);

// The running sum of one pixel. One thread owns a pixel and adds its samples in order.
typedef struct sagi_pixel {
    double r, g, b;
    uint32_t count; // samples summed: bad ones are not
} sagi_pixel;

// Adds a sample; false, adding nothing, for one that is not finite.
static inline bool sagi_pixel_add(sagi_pixel *pixel, sag_rgb value) {
    if (!sagi_rgb_is_finite(value)) return false;
    pixel->r += value.r, pixel->g += value.g, pixel->b += value.b;
    pixel->count++;
    return true;
}

#endif
