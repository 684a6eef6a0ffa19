// SPDX-License-Identifier: MIT
// Filter importance sampling (Ernst, Stamminger & Greiner 2006): instead of spreading a sample over the
// pixels whose filters reach it, each pixel draws its own samples, distributed as its filter. No two pixels
// share a sum, so the picture cannot depend on which thread came first.
//
// Box and tent are drawn by formula. The others are pbrt's curves over |x| ≤ r:
//
//     Gaussian  exp(−x²/2σ²) − exp(−r²/2σ²)
//     Mitchell  the cubic of Mitchell & Netravali (SIGGRAPH 1988) with B and C, stretched from 2 to r
//     sinc      sinc(x) sinc(x/τ), sinc(x) = sin(πx)/(πx)   (Lanczos' window)
//
// Their distribution functions are tabulated and inverted linearly: within a cell all points are alike, but
// each cell has the exact share of the curve's integral. Where a curve is negative, its absolute value is
// drawn from and the sample counts negatively: all weights are 1 or −1. A guide (Chen & Asau 1974) leads to
// the cell in a step or two.
#include "filter.h"

#include "math/elementary.h"
#include "warp.h"

static double sinc(double x) {
    const double a = SAGI_RENDER_PI * x;
    return fabs(a) < 1e-5 ? 1 - a * a / 6 : sagi_sin(a) / a;
}

static double mitchell(double b, double c, double x) {
    if (x <= 1) return ((12 - 9 * b - 6 * c) * x + (-18 + 12 * b + 6 * c)) * x * x + (6 - 2 * b);
    if (x <= 2)
        return (((-b - 6 * c) * x + (6 * b + 30 * c)) * x + (-12 * b - 48 * c)) * x + (8 * b + 24 * c);
    return 0;
}

double sagi_filter_curve_at(const sag_film *film, double radius, double x) {
    if (!(x <= radius)) return 0;
    switch (film->filter) {
    case SAG_FILTER_BOX: return 1;
    case SAG_FILTER_TRIANGLE: return radius - x;
    case SAG_FILTER_GAUSSIAN: {
        const double sigma = film->filter_sigma == 0 ? 0.5 : film->filter_sigma, scale = 2 * sigma * sigma;
        return sagi_exp(-x * x / scale) - sagi_exp(-radius * radius / scale);
    }
    case SAG_FILTER_MITCHELL: {
        const bool usual = film->filter_b == 0 && film->filter_c == 0;
        return mitchell(usual ? 1.0 / 3 : film->filter_b, usual ? 1.0 / 3 : film->filter_c, 2 * x / radius);
    }
    case SAG_FILTER_SINC: return sinc(x) * sinc(x / (film->filter_tau == 0 ? 3 : film->filter_tau));
    }
    return 0;
}

// Returns ∫f / ∫|f|; not positive or not a number: the curve is of no use.
static double tabulate(const sag_film *film, double radius, sagi_filter_curve *curve) {
    const int inner = 16; // points of the midpoint rule a cell
    double total = 0, absolute = 0;
    curve->cdf[0] = 0;
    for (int i = 0; i < SAGI_FILTER_CELLS; i++) {
        double sum = 0;
        for (int j = 0; j < inner; j++)
            sum += sagi_filter_curve_at(film, radius, radius * (i + (j + 0.5) / inner) / SAGI_FILTER_CELLS);
        total += sum;
        absolute += fabs(sum);
        curve->cdf[i + 1] = absolute;
        curve->negative[i] = sum < 0;
    }
    for (int i = 1; i <= SAGI_FILTER_CELLS; i++) curve->cdf[i] /= absolute;
    for (int i = 0, cell = 0; i < SAGI_FILTER_SLOTS; i++) {
        while (cell < SAGI_FILTER_CELLS - 1 && curve->cdf[cell + 1] <= (double)i / SAGI_FILTER_SLOTS) cell++;
        curve->guide[i] = (uint8_t)cell;
    }
    return total / absolute;
}

// From −radius to radius.
static double integral(const sag_film *film, double radius) {
    const int points = 16 * SAGI_FILTER_CELLS;
    double sum = 0;
    for (int i = 0; i < points; i++) sum += sagi_filter_curve_at(film, radius, radius * (i + 0.5) / points);
    return 2 * radius * sum / points;
}

sag_status sagi_filter_init(sagi_filter *filter, const sag_film *film, sag_error *error) {
    const double numbers[] = {film->filter_radius_x, film->filter_radius_y, film->filter_sigma,
                              film->filter_tau};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!(numbers[i] >= 0 && isfinite(numbers[i])))
            return sag_error_set(error, SAG_ERROR_ARGUMENT,
                                 "a filter of radius %g x %g, sigma %g, tau %g is not usable", numbers[0],
                                 numbers[1], numbers[2], numbers[3]);
    double radius = 0.5;
    switch (film->filter) {
    case SAG_FILTER_BOX: radius = 0.5; break;
    case SAG_FILTER_TRIANGLE: radius = 2; break;
    case SAG_FILTER_GAUSSIAN: radius = 1.5; break;
    case SAG_FILTER_MITCHELL: radius = 2; break;
    case SAG_FILTER_SINC: radius = 4; break;
    }
    filter->kind = film->filter;
    filter->radius_x = film->filter_radius_x > 0 ? film->filter_radius_x : radius;
    filter->radius_y = film->filter_radius_y > 0 ? film->filter_radius_y : radius;
    filter->mean_weight = 1;
    filter->integral = integral(film, filter->radius_x) * integral(film, filter->radius_y);
    if (film->filter == SAG_FILTER_BOX || film->filter == SAG_FILTER_TRIANGLE) return SAG_OK;
    filter->mean_weight =
        tabulate(film, filter->radius_x, &filter->x) * tabulate(film, filter->radius_y, &filter->y);
    if (!(filter->mean_weight > 0.01))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "the filter is as much negative as positive");
    return SAG_OK;
}

// A point of [−radius, radius]; *weight changes its sign where the curve is negative.
static double draw(const sagi_filter_curve *curve, double radius, double u, double *weight) {
    // Each half has half of the numbers.
    const double v = fabs(2 * u - 1);
    const int slot = (int)(v * SAGI_FILTER_SLOTS);
    uint32_t cell = curve->guide[slot < SAGI_FILTER_SLOTS ? slot : SAGI_FILTER_SLOTS - 1];
    while (cell < SAGI_FILTER_CELLS - 1 && curve->cdf[cell + 1] <= v) cell++;
    const double below = curve->cdf[cell], share = curve->cdf[cell + 1] - below;
    const double within = share > 0 ? (v - below) / share : 0.5;
    const double x = radius * (cell + (within < 1 ? within : 1)) * (1.0 / SAGI_FILTER_CELLS);
    if (curve->negative[cell]) *weight = -*weight;
    return copysign(x, u - 0.5);
}

sagi_filter_sample sagi_filter_draw(const sagi_filter *filter, sag_vec2 u) {
    sagi_filter_sample sample = {.weight = 1};
    switch (filter->kind) {
    case SAG_FILTER_BOX:
        sample.offset.x = (2 * u.x - 1) * filter->radius_x;
        sample.offset.y = (2 * u.y - 1) * filter->radius_y;
        break;
    case SAG_FILTER_TRIANGLE:
        sample.offset.x = sagi_warp_tent(u.x, filter->radius_x);
        sample.offset.y = sagi_warp_tent(u.y, filter->radius_y);
        break;
    case SAG_FILTER_GAUSSIAN:
    case SAG_FILTER_MITCHELL:
    case SAG_FILTER_SINC:
        sample.offset.x = draw(&filter->x, filter->radius_x, u.x, &sample.weight);
        sample.offset.y = draw(&filter->y, filter->radius_y, u.y, &sample.weight);
        break;
    }
    return sample;
}
