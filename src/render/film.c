// SPDX-License-Identifier: MIT
// The film: which of its pixels are made, and what becomes of samples.
//
// A sample that is not finite would spoil its pixel for good. It is dropped: the pixel is the mean of its
// others. So that it can be looked into, the first few (by row, column and number, whichever thread finds
// them when) are told: each is a number of 64 bits, and a sorted list of those is kept without locks. A
// number is carried along the list; where it is less than what it finds, it takes the place and the other is
// carried on. Places only ever get smaller, so what was carried past a place stays greater than it.
#include "job.h"

static uint32_t edge(double share, uint32_t size) {
    const double pixels = ceil(fmin(fmax(share, 0), 1) * size);
    return pixels < size ? (uint32_t)pixels : size;
}

sag_status sagi_film_bounds(const sag_film *film, sagi_bounds *bounds, sag_error *error) {
    const double *window = film->crop_window;
    const uint32_t *pixels = film->pixel_bounds;
    uint32_t x[2] = {0, film->width}, y[2] = {0, film->height};
    if (!isfinite(window[0] + window[1] + window[2] + window[3]))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "the crop window is not finite");
    if (window[0] != 0 || window[1] != 0 || window[2] != 0 || window[3] != 0) {
        for (int i = 0; i < 2; i++)
            x[i] = edge(window[i], film->width), y[i] = edge(window[2 + i], film->height);
    } else if (pixels[0] | pixels[1] | pixels[2] | pixels[3]) {
        for (int i = 0; i < 2; i++) {
            x[i] = pixels[i] < film->width ? pixels[i] : film->width;
            y[i] = pixels[2 + i] < film->height ? pixels[2 + i] : film->height;
        }
    }
    if (x[0] >= x[1] || y[0] >= y[1])
        return sag_error_set(error, SAG_ERROR_ARGUMENT,
                             "nothing is left of a film of %ux%u cropped to columns %u to %u, rows %u to %u",
                             film->width, film->height, x[0], x[1], y[0], y[1]);
    *bounds = (sagi_bounds){x[0], y[0], x[1] - x[0], y[1] - y[0]};
    return SAG_OK;
}

void sagi_film_note_bad(sag_render *render, const sagi_pixel *pixel, uint32_t sample) {
    const size_t index = (size_t)(pixel - render->pixels);
    const uint64_t x = index % render->width + render->first_x, y = index / render->width + render->first_y;
    uint_fast64_t carried = y << 48 | x << 32 | sample;
    for (int i = 0; i < SAG_BAD_SAMPLES; i++) {
        uint_fast64_t found = atomic_load(&render->first_bad[i]);
        while (carried < found)
            if (atomic_compare_exchange_weak(&render->first_bad[i], &found, carried)) {
                carried = found;
                break;
            }
    }
    atomic_fetch_add(&render->bad_samples, 1);
}

void sagi_film_add(sag_render *render, sagi_pixel *pixel, uint32_t sample, double weight, sag_rgb value) {
    if (!sagi_pixel_add(pixel, weight, value, render->max_component))
        sagi_film_note_bad(render, pixel, sample);
}

sag_rgb sagi_film_value(const sag_render *render, const sagi_pixel *pixel) {
    if (render->splats) return sagi_splat_value(render, (size_t)(pixel - render->pixels));
    if (pixel->count == 0) return sagi_rgb_grey(0);
    const double sum[3] = {pixel->r, pixel->g, pixel->b};
    double value[3] = {pixel->r, pixel->g, pixel->b};
    if (sagi_is_spectral(render)) sagi_matrix_apply(render->sensor.output, sum, value);
    return sagi_rgb_scale(sagi_rgb(value[0], value[1], value[2]),
                          1 / sagi_pixel_weight(pixel, render->filter.mean_weight));
}

uint32_t sagi_film_first_bad(const sag_render *render, sag_bad_sample bad[SAG_BAD_SAMPLES]) {
    uint32_t count = 0;
    for (; count < SAG_BAD_SAMPLES; count++) {
        const uint64_t key = atomic_load(&render->first_bad[count]);
        if (key == UINT64_MAX) break;
        bad[count] = (sag_bad_sample){
            .x = (uint32_t)(key >> 32 & 0xFFFF), .y = (uint32_t)(key >> 48), .sample = (uint32_t)key};
    }
    return count;
}
