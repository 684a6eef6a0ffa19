// SPDX-License-Identifier: MIT
// How a pixel's samples are summed.
#ifndef SAGI_RENDER_FILM_H
#define SAGI_RENDER_FILM_H

#include "color.h"

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
