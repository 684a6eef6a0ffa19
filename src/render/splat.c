// SPDX-License-Identifier: MIT
// Sums of a picture whose samples fall on pixels of anybody's.
//
// Floating-point sums depend on the order in which threads come. Here each is a whole number of 128 bits in
// units of 2⁻⁷⁰, in two halves: whoever adds to the lower one sees by its old value whether it overflowed,
// and adds that to the upper one. Sums of whole numbers are the same in any order, so the picture is the same
// to the bit with any number of threads. A sample counts up to 2⁴⁰; the smallest that counts is 8·10⁻²².
//
// A splat is spread over the pixels whose filters reach it, by the filter's value, the integral being 1.
#include "job.h"

#define MOST 0x1p40

static void add_fixed(sagi_fixed *sum, double value) {
    const double size = fmin(fabs(value), MOST) * 0x1p6; // in units of 2⁶⁴ of the lower half's
    uint64_t high = (uint64_t)size, low = (uint64_t)((size - (double)high) * 0x1p64);
    if (value < 0) {
        low = ~low + 1;
        high = ~high + (low == 0);
    }
    const uint64_t old = atomic_fetch_add_explicit(&sum->low, low, memory_order_relaxed);
    high += old + low < old;
    if (high) atomic_fetch_add_explicit(&sum->high, high, memory_order_relaxed);
}

static double fixed_value(const sagi_fixed *sum) {
    const uint64_t low = atomic_load_explicit(&sum->low, memory_order_relaxed),
                   high = atomic_load_explicit(&sum->high, memory_order_relaxed);
    if ((int64_t)high >= 0) return (double)high * 0x1p-6 + (double)low * 0x1p-70;
    const uint64_t positive = ~low + 1;
    return -((double)(~high + (positive == 0)) * 0x1p-6 + (double)positive * 0x1p-70);
}

// The pixels [*first, *end) along one axis whose filters reach `at`.
static bool reach(double at, double radius, uint32_t first, uint32_t size, uint32_t *from, uint32_t *end) {
    const double a = fmax(ceil(at - radius - 0.5), first), b = fmin(ceil(at + radius - 0.5), first + size);
    if (!(a < b)) return false;
    *from = (uint32_t)a, *end = (uint32_t)b;
    return true;
}

static void spread(sag_render *render, sag_vec2 place, sag_rgb value) {
    const sagi_filter *filter = &render->filter;
    const sag_film *film = &render->settings.film;
    uint32_t x0, x1, y0, y1;
    if (!reach(place.x, filter->radius_x, render->first_x, render->width, &x0, &x1) ||
        !reach(place.y, filter->radius_y, render->first_y, render->height, &y0, &y1))
        return;
    for (uint32_t y = y0; y < y1; y++) {
        const double by_y =
            sagi_filter_curve_at(film, filter->radius_y, fabs(y + 0.5 - place.y)) / filter->integral;
        sagi_splat *row = render->splats + (size_t)(y - render->first_y) * render->width;
        for (uint32_t x = x0; x < x1; x++) {
            const double weight =
                by_y * sagi_filter_curve_at(film, filter->radius_x, fabs(x + 0.5 - place.x));
            sagi_splat *splat = row + (x - render->first_x);
            add_fixed(&splat->channel[0], weight * value.r);
            add_fixed(&splat->channel[1], weight * value.g);
            add_fixed(&splat->channel[2], weight * value.b);
        }
    }
}

// A picture of all around has no rim: the filters of its outermost pixels reach into directions that are
// elsewhere on the film. So a place near the rim is also these beside the film, as sagi_camera_ray has them.
static void spread_around(sag_render *render, sag_vec2 p, sag_rgb value) {
    const double w = render->camera.width, h = render->camera.height;
    const double rx = render->filter.radius_x, ry = render->filter.radius_y;
    const bool all_longitudes = render->settings.camera.kind == SAG_CAMERA_ENVIRONMENT;
    const bool side = p.x < rx || p.x > w - rx, end = p.y < ry || p.y > h - ry;
    const double beside = p.x < w / 2 ? p.x + w : p.x - w, over = p.y < h / 2 ? -p.y : 2 * h - p.y;
    if (all_longitudes) {
        // One longitude after the other, and over the poles to the opposite one.
        if (side) spread(render, (sag_vec2){beside, p.y}, value);
        for (int turn = -2; turn < 2 && end; turn++)
            spread(render, (sag_vec2){p.x + w / 2 + turn * w, over}, value);
        return;
    }
    // Each edge is folded in its middle; over both edges of a corner one comes in at the opposite one.
    if (side) spread(render, (sag_vec2){p.x < w / 2 ? -p.x : 2 * w - p.x, h - p.y}, value);
    if (end) spread(render, (sag_vec2){w - p.x, over}, value);
    if (side && end) spread(render, (sag_vec2){beside, p.y < h / 2 ? p.y + h : p.y - h}, value);
}

void sagi_splat_add(sag_render *render, const sagi_path *path, sag_vec2 place, sagi_spectrum light) {
    sag_rgb value = sagi_sensor_measure(&render->sensor, light, &path->wavelengths);
    if (!sagi_rgb_is_finite(value)) {
        sagi_film_note_bad(render, path->pixel, path->sampler.sample);
        return;
    }
    // A path is one of as many as the picture has pixels, and reaches one of them.
    const double pixels = (double)render->width * render->height;
    const double most = render->max_component * pixels, largest = sagi_rgb_max(value);
    if (largest > most) value = sagi_rgb_scale(value, most / largest);
    spread(render, place, value);
    const sag_camera_kind kind = render->settings.camera.kind;
    if (kind == SAG_CAMERA_ENVIRONMENT || kind == SAG_CAMERA_EQUAL_AREA) spread_around(render, place, value);
}

sag_rgb sagi_splat_value(const sag_render *render, size_t pixel) {
    const sagi_splat *splat = &render->splats[pixel];
    const double count = (double)atomic_load(&render->camera_samples);
    if (!(count > 0)) return sagi_rgb_grey(0);
    double sum[3], value[3];
    for (int i = 0; i < 3; i++) sum[i] = fixed_value(&splat->channel[i]);
    sagi_matrix_apply(render->sensor.output, sum, value);
    return sagi_rgb_scale(sagi_rgb(value[0], value[1], value[2]), 1 / count);
}
