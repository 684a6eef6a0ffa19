// SPDX-License-Identifier: MIT
// Depths and ids need nothing but the hits of the camera's rays: no surface, no material, no path. Where
// every surface is there (see_through is false), they are taken straight from a batch of rays. The numbers
// and their order are those of a wave of paths that end at their first hit (wave.c, shown.c), and so are the
// sums.
//
// The usual rays (independent samples, a box filter, a pinhole) are made sixteen at a time: their random
// numbers one by one, everything else in loops that the compiler turns into vectors. The operations are those
// of sagi_camera_sample in the same order, so that the bits are the same.
#include "start.h"

enum { SIDE = 4, TOGETHER = SIDE * SIDE };

bool sagi_can_glance(const sag_render *render) {
    const sag_integrator_kind shown = render->settings.integrator;
    return !render->see_through && !render->layers &&
           (shown == SAG_INTEGRATOR_DEPTH || shown == SAG_INTEGRATOR_ID);
}

static bool is_usual(const sag_render *render) {
    return render->camera.pinhole && render->filter.kind == SAG_FILTER_BOX &&
           render->sampler.plan->kind == SAG_SAMPLER_INDEPENDENT;
}

static inline void add(sag_render *render, const sagi_glance *glance, sag_rgb value) {
    if (!sagi_pixel_add(glance->pixel, glance->pixel_weight, value, render->max_component))
        sagi_film_add(render, glance->pixel, glance->sample, glance->pixel_weight, value); // tells of it
}

// Traces what there is and adds it to the pixels.
static void finish(sag_render *render, sagi_wave *wave) {
    const sag_hit *hit = wave->hits;
    const sagi_glance *glance = wave->glances, *end = glance + wave->path_count;
    sagi_wave_intersect(wave, wave->rays, wave->path_count);
    wave->path_count = 0;
    if (render->settings.integrator == SAG_INTEGRATOR_DEPTH)
        for (; glance < end; glance++, hit++)
            add(render, glance, sagi_rgb_grey(hit->geometry != SAG_INVALID_ID ? hit->t : 0));
    else
        for (; glance < end; glance++, hit++)
            add(render, glance, hit->geometry != SAG_INVALID_ID ? sagi_id_color(hit) : sagi_rgb_grey(0));
}

// Sample `sample` of each of the pixels of a square. (Loops of constant length are what becomes vectors; the
// hashes are not, for want of products of 64 bits.)
static void start_square(const sag_render *render, sagi_wave *wave, uint32_t column, uint32_t row,
                         uint32_t sample) {
    const uint32_t x0 = render->first_x + column, y0 = render->first_y + row;
    const sagi_camera *camera = &render->camera;
    const double radius_x = render->filter.radius_x, radius_y = render->filter.radius_y;
    const double x_min = camera->x_min, x_step = camera->x_per_pixel, y_max = camera->y_max,
                 y_step = camera->y_per_pixel;
    const sag_affine to_world = camera->camera.to_world;
    const sag_vec3 eye = camera->eye;
    sagi_sampler sampler = render->sampler;
    sampler.sample = sample, sampler.dimension = 0;
    sagi_pixel *pixel = &render->pixels[(size_t)row * render->width + column];
    sagi_glance *glance = wave->glances + wave->path_count;
    double u[TOGETHER], v[TOGETHER]; // random, times 2³²
    for (uint32_t j = 0, i = 0; j < SIDE; j++, pixel += render->width)
        for (uint32_t k = 0; k < SIDE; k++, i++, glance++) {
            sampler.key = sagi_sampler_hash(sampler.plan, x0 + k, y0 + j);
            const uint64_t random = sagi_sampler_bits(&sampler);
            u[i] = (double)(int64_t)(random >> 32), v[i] = (double)(int64_t)(random & 0xFFFFFFFFu);
            glance->pixel = pixel + k, glance->pixel_weight = 1, glance->sample = sample;
        }
    double x[TOGETHER], y[TOGETHER], z[TOGETHER], squared[TOGETHER];
    for (int i = 0; i < TOGETHER; i++) {
        const double offset_x = (2 * (u[i] * 0x1p-32) - 1) * radius_x,
                     offset_y = (2 * (v[i] * 0x1p-32) - 1) * radius_y;
        const double film_x = (double)((int)x0 + i % SIDE) + 0.5 + offset_x,
                     film_y = (double)((int)y0 + i / SIDE) + 0.5 + offset_y;
        const sag_vec3 way =
            sagi_affine_vector(&to_world, sag_vec3_make(x_min + film_x * x_step, y_max - film_y * y_step, 1));
        x[i] = way.x, y[i] = way.y, z[i] = way.z;
        squared[i] = sag_dot(way, way);
    }
    bool safe = true;
    for (int i = 0; i < TOGETHER; i++) safe &= sagi_square_is_safe(squared[i]);
    for (int i = 0; i < TOGETHER && safe; i++) {
        const double length = sqrt(squared[i]);
        x[i] /= length, y[i] /= length, z[i] /= length;
    }
    sag_ray *ray = wave->rays + wave->path_count;
    for (uint32_t i = 0; i < TOGETHER; i++, ray++) {
        sag_vec3 d = sag_vec3_make(x[i], y[i], z[i]);
        if (!safe) d = sagi_normalize(d);
        ray->origin.x = eye.x, ray->origin.y = eye.y, ray->origin.z = eye.z;
        ray->direction.x = d.x, ray->direction.y = d.y, ray->direction.z = d.z;
        ray->t_min = 0, ray->t_max = INFINITY, ray->mask = SAG_RAY_CAMERA;
    }
    wave->path_count += TOGETHER;
}

// The same for any camera, sampler, filter and part of a square.
static void start_pixel(const sag_render *render, sagi_wave *wave, uint32_t column, uint32_t row,
                        uint32_t sample) {
    const uint32_t x = render->first_x + column, y = render->first_y + row;
    sagi_sampler sampler = render->sampler;
    sagi_sampler_start_pixel(&sampler, x, y);
    sagi_glance *glance = &wave->glances[wave->path_count];
    glance->pixel = &render->pixels[(size_t)row * render->width + column], glance->sample = sample;
    glance->pixel_weight =
        sagi_camera_sample(render, &sampler, x, y, sample, &wave->rays[wave->path_count++]);
}

void sagi_glance_tile(sag_render *render, sagi_wave *wave, const sagi_tile *tile) {
    const bool usual = is_usual(render) && render->wave_size >= TOGETHER;
    for (uint32_t square = 0; square < SAGI_TILE_SIZE * SAGI_TILE_SIZE; square += TOGETHER) {
        const uint32_t x0 = tile->x0 + sagi_along(square), y0 = tile->y0 + sagi_along(square >> 1);
        const bool whole = usual && x0 + SIDE <= tile->x1 && y0 + SIDE <= tile->y1;
        for (uint32_t sample = tile->first; sample < tile->end; sample++) {
            if (whole) {
                if (wave->path_count + TOGETHER > render->wave_size) finish(render, wave);
                start_square(render, wave, x0, y0, sample);
                continue;
            }
            for (uint32_t i = 0; i < TOGETHER; i++) {
                const uint32_t x = x0 + i % SIDE, y = y0 + i / SIDE;
                if (x >= tile->x1 || y >= tile->y1) continue;
                if (wave->path_count == render->wave_size) finish(render, wave);
                start_pixel(render, wave, x, y, sample);
            }
        }
    }
    finish(render, wave);
}
