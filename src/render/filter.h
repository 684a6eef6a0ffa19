// SPDX-License-Identifier: MIT
// Pixel filters to draw points from.
#ifndef SAGI_RENDER_FILTER_H
#define SAGI_RENDER_FILTER_H

#include "color.h"

#define SAGI_FILTER_CELLS 256
// Equal parts of the distribution function, so many that most lie within a cell: then it is found at once.
#define SAGI_FILTER_SLOTS 1024

// One half of a curve f over [0, radius] in cells of equal width, drawn from by |∫f| over each.
typedef struct sagi_filter_curve {
    double cdf[SAGI_FILTER_CELLS + 1]; // from 0 to 1
    uint8_t guide[SAGI_FILTER_SLOTS];  // the cell that the number i/SAGI_FILTER_SLOTS falls into
    bool negative[SAGI_FILTER_CELLS];  // the cell's integral
} sagi_filter_curve;

// The product of the same kind of curve in x and in y.
typedef struct sagi_filter {
    sag_filter_kind kind;
    double radius_x, radius_y;
    double integral;        // of the curves of sagi_filter_curve_at
    double mean_weight;     // of many samples: ∫f / ∫|f|
    sagi_filter_curve x, y; // Gaussian, Mitchell, sinc
} sagi_filter;

typedef struct sagi_filter_sample {
    sag_vec2 offset; // from the pixel's centre, in pixels
    double weight;   // 1, or −1 where the filter is negative
} sagi_filter_sample;

// SAG_ERROR_ARGUMENT for a radius, sigma or tau that is negative or not finite, or parameters whose curve has
// no positive integral.
sag_status sagi_filter_init(sagi_filter *filter, const sag_film *film, sag_error *error);
// An offset distributed as the filter's absolute value, and its sign: weighted so, the mean of samples is
// that of the filter.
sagi_filter_sample sagi_filter_draw(const sagi_filter *filter, sag_vec2 u);
// One axis' curve, of any scale, at a distance x from the centre.
double sagi_filter_curve_at(const sag_film *film, double radius, double x);

#endif
