// SPDX-License-Identifier: MIT
// The camera's ray for a sample: sampler, filter and camera in one. The usual ones (independent samples, a
// box filter, a pinhole) are in line and otherwise the same calculations as the functions'.
#ifndef SAGI_RENDER_START_H
#define SAGI_RENDER_START_H

#include "job.h"
#include "math/map.h"

static inline sag_vec2 sagi_independent_2d(sagi_sampler *sampler) {
    const uint64_t random = sagi_sampler_bits(sampler);
    sampler->dimension++;
    return (sag_vec2){(double)(random >> 32) * 0x1p-32, (double)(random & 0xFFFFFFFFu) * 0x1p-32};
}

static inline sagi_filter_sample sagi_filter_point(const sagi_filter *filter, sag_vec2 u) {
    if (filter->kind != SAG_FILTER_BOX) return sagi_filter_draw(filter, u);
    return (sagi_filter_sample){{(2 * u.x - 1) * filter->radius_x, (2 * u.y - 1) * filter->radius_y}, 1};
}

// The sampler is of this pixel already. Returns the sample's weight in the pixel. (Number by number into
// *ray: a whole that is copied at once would have to wait for its parts.)
static inline double sagi_camera_sample(const sag_render *render, sagi_sampler *sampler, uint32_t x,
                                        uint32_t y, uint32_t sample, sag_ray *ray) {
    const sagi_camera *camera = &render->camera;
    sag_vec2 u;
    if (sampler->plan->kind == SAG_SAMPLER_INDEPENDENT) {
        sampler->sample = sample;
        sampler->dimension = 0;
        sampler->ready_block = UINT32_MAX;
        u = sagi_independent_2d(sampler);
    } else {
        sagi_sampler_start_sample(sampler, sample);
        u = sagi_sampler_pixel(sampler);
    }
    const sagi_filter_sample point = sagi_filter_point(&render->filter, u);
    const double film_x = x + 0.5 + point.offset.x, film_y = y + 0.5 + point.offset.y;
    if (camera->pinhole) {
        const double on_film[2] = {camera->x_min + film_x * camera->x_per_pixel,
                                   camera->y_max - film_y * camera->y_per_pixel};
        const sag_vec3 d = sagi_normalize(
            sagi_affine_vector(&camera->camera.to_world, sag_vec3_make(on_film[0], on_film[1], 1)));
        ray->origin.x = camera->eye.x, ray->origin.y = camera->eye.y, ray->origin.z = camera->eye.z;
        ray->direction.x = d.x, ray->direction.y = d.y, ray->direction.z = d.z;
        ray->t_min = 0, ray->t_max = INFINITY;
    } else {
        sag_vec2 lens = {0, 0};
        if (sagi_camera_has_lens(camera)) lens = sagi_sampler_2d(sampler);
        *ray = sagi_camera_ray(camera, film_x, film_y, lens);
    }
    ray->mask = SAG_RAY_CAMERA;
    return point.weight;
}

#endif
