// SPDX-License-Identifier: MIT
// Depths and ids need nothing but the hits of the camera's rays: no surface, no material, no path. Where
// every surface is there (see_through is false), they are taken straight from a batch of rays. The numbers
// and their order are those of a wave of paths that end at their first hit (wave.c, shown.c), and so are the
// sums.
#include "start.h"

bool sagi_can_glance(const sag_render *render) {
    const sag_integrator_kind shown = render->settings.integrator;
    return !render->see_through && (shown == SAG_INTEGRATOR_DEPTH || shown == SAG_INTEGRATOR_ID);
}

void sagi_glance_start(sagi_wave *wave, sagi_pixel *pixel, uint32_t x, uint32_t y, uint32_t first,
                       uint32_t end) {
    sagi_sampler sampler = wave->render->sampler;
    sagi_sampler_start_pixel(&sampler, x, y);
    for (uint32_t sample = first; sample < end; sample++) {
        const double weight =
            sagi_camera_sample(wave->render, &sampler, x, y, sample, &wave->rays[wave->path_count]);
        wave->glances[wave->path_count++] = (sagi_glance){pixel, weight, sample};
    }
}

void sagi_glance_finish(sag_render *render, sagi_wave *wave) {
    const bool depth = render->settings.integrator == SAG_INTEGRATOR_DEPTH;
    sagi_wave_intersect(wave, wave->rays, wave->path_count);
    for (uint32_t i = 0; i < wave->path_count; i++) {
        const sag_hit *hit = &wave->hits[i];
        sag_rgb value = {0, 0, 0};
        if (hit->geometry != SAG_INVALID_ID) value = depth ? sagi_rgb_grey(hit->t) : sagi_id_color(hit);
        const sagi_glance *glance = &wave->glances[i];
        sagi_film_add(render, glance->pixel, glance->sample, glance->pixel_weight, value);
    }
    wave->path_count = 0;
}
