// SPDX-License-Identifier: MIT
// Filter importance sampling (Ernst, Stamminger & Greiner 2006): instead of spreading a sample over the
// pixels whose filters reach it, each pixel draws its own samples, distributed as its filter. All weights are
// 1 and no two pixels share a sum, so the picture cannot depend on which thread came first.
//
// Box and tent are drawn by formula. The Gaussian is pbrt's, lowered so that it ends at 0:
// g(x) = max(0, exp(−x²/2σ²) − exp(−r²/2σ²)); its distribution function is tabulated and inverted linearly.
#include "film.h"

#include "warp.h"

static void tabulate_gaussian(double radius, double sigma, double cdf[SAGI_FILTER_STEPS + 1]) {
    const int inner = 16; // points of the midpoint rule a step
    double floor_value = exp(-radius * radius / (2 * sigma * sigma)), sum = 0;
    cdf[0] = 0;
    for (int i = 0; i < SAGI_FILTER_STEPS; i++) {
        for (int j = 0; j < inner; j++) {
            double x = radius * (i + (j + 0.5) / inner) / SAGI_FILTER_STEPS;
            sum += fmax(0, exp(-x * x / (2 * sigma * sigma)) - floor_value);
        }
        cdf[i + 1] = sum;
    }
    for (int i = 1; i <= SAGI_FILTER_STEPS; i++)
        cdf[i] = sum > 0 ? cdf[i] / sum : (double)i / SAGI_FILTER_STEPS;
}

static double sample_gaussian(const double cdf[SAGI_FILTER_STEPS + 1], double radius, double u) {
    // Each half has half of the numbers.
    double sign = u < 0.5 ? -1 : 1, v = u < 0.5 ? 1 - 2 * u : 2 * u - 1;
    int low = 0, high = SAGI_FILTER_STEPS;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (cdf[middle] <= v)
            low = middle;
        else
            high = middle;
    }
    double step = cdf[high] - cdf[low];
    double fraction = step > 0 ? (v - cdf[low]) / step : 0.5;
    return sign * radius * (low + fraction) / SAGI_FILTER_STEPS;
}

sag_status sagi_filter_init(sagi_filter *filter, const sag_film *film, sag_error *error) {
    double sigma = film->filter_sigma == 0 ? 0.5 : film->filter_sigma;
    if (!(film->filter_radius_x >= 0) || !(film->filter_radius_y >= 0) || !(sigma > 0) ||
        !isfinite(film->filter_radius_x) || !isfinite(film->filter_radius_y) || !isfinite(sigma))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "filter radius %g x %g with sigma %g is not usable",
                             film->filter_radius_x, film->filter_radius_y, sigma);
    double radius = 0.5;
    switch (film->filter) {
    case SAG_FILTER_BOX: radius = 0.5; break;
    case SAG_FILTER_TRIANGLE: radius = 2; break;
    case SAG_FILTER_GAUSSIAN: radius = 1.5; break;
    }
    filter->kind = film->filter;
    filter->radius_x = film->filter_radius_x > 0 ? film->filter_radius_x : radius;
    filter->radius_y = film->filter_radius_y > 0 ? film->filter_radius_y : radius;
    tabulate_gaussian(filter->radius_x, sigma, filter->cdf_x);
    tabulate_gaussian(filter->radius_y, sigma, filter->cdf_y);
    return SAG_OK;
}

sag_vec2 sagi_filter_sample(const sagi_filter *filter, sag_vec2 u) {
    sag_vec2 offset = {0, 0};
    switch (filter->kind) {
    case SAG_FILTER_BOX:
        offset.x = (2 * u.x - 1) * filter->radius_x;
        offset.y = (2 * u.y - 1) * filter->radius_y;
        break;
    case SAG_FILTER_TRIANGLE:
        offset.x = sagi_warp_tent(u.x, filter->radius_x);
        offset.y = sagi_warp_tent(u.y, filter->radius_y);
        break;
    case SAG_FILTER_GAUSSIAN:
        offset.x = sample_gaussian(filter->cdf_x, filter->radius_x, u.x);
        offset.y = sample_gaussian(filter->cdf_y, filter->radius_y, u.y);
        break;
    }
    return offset;
}
