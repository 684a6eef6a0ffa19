// SPDX-License-Identifier: MIT
// Paths through participating media: what happens to a path between two surfaces. A particle is a vertex like
// a point of a surface, with a phase function in place of a BSDF: one light is sampled there, and one
// direction drawn, each weighted for the other. Shadow rays lose exactly what the media on their way take.
#include "job.h"
#include "medium.h"

// One sampled light, as the particle at `at` scatters it.
static void add_light(sagi_wave *wave, sagi_path *p, const sagi_medium *medium, const sag_surface *at,
                      sag_vec3 wo) {
    const sagi_lights *lights = &wave->render->lights;
    const double choose = sagi_sampler_1d(&p->sampler);
    const sag_vec2 u = sagi_sampler_2d(&p->sampler);
    sagi_light_sample sample;
    if (!sagi_lights_sample(lights, &p->from, p->wavelengths.lambda, choose, u, &sample)) return;
    const double phase = sagi_phase(medium->medium.g, sag_dot(wo, sample.wi));
    const double weight = sagi_light_weight(lights, phase, &sample);
    const sagi_spectrum light = sample.radiance * (float)(phase * weight / sample.pdf);
    if (sagi_spectrum_is_black(light) && sagi_spectrum_is_finite(light)) return;
    sagi_wave_add_light(wave, p, at, p->medium, &sample, light);
}

// The path meets a particle at distance `distance`. True when it goes on with what is then in *ray.
static bool scatter(sagi_wave *wave, sagi_path *p, const sagi_medium *medium, double distance, sag_ray *ray) {
    if (p->depth >= wave->render->settings.max_depth) return false;
    const sag_vec3 wo = sag_neg(ray->direction);
    // No surface: a normal of 0 moves no ray away.
    const sag_surface at = {.position = sag_madd(ray->origin, distance, ray->direction)};
    p->from = (sagi_shading_point){.position = at.position};
    p->exact = false;
    p->scattered = true;
    p->depth++;
    add_light(wave, p, medium, &at, wo);
    p->surface_pdf = sagi_phase_sample(medium->medium.g, wo, sagi_sampler_2d(&p->sampler), &ray->direction);
    ray->origin = at.position;
    ray->mask = SAG_RAY_DIFFUSE;
    p->distance = 0;
    p->passed = 0;
    return sagi_path_survives(p);
}

sagi_passage sagi_volume_step(sagi_wave *wave, sagi_path *p, sag_ray *ray, const sag_hit *hit) {
    const sagi_medium *medium = sagi_medium_of(wave->render->world, p->medium);
    if (!medium) return SAGI_PASSAGE_THROUGH;
    const double length = hit->geometry == SAG_INVALID_ID ? INFINITY : hit->t;
    const double u = medium->scatters ? sagi_sampler_1d(&p->sampler) : 0;
    const sagi_flight flight = sagi_medium_fly(medium, p->wavelengths.lambda, p->dispersed, length, u);
    if (medium->emits) p->radiance += p->weight * flight.emitted;
    p->weight *= flight.weight;
    if (sagi_spectrum_is_black(p->weight)) return SAGI_PASSAGE_END;
    if (!flight.scattered) return SAGI_PASSAGE_THROUGH;
    return scatter(wave, p, medium, flight.distance, ray) ? SAGI_PASSAGE_SCATTERED : SAGI_PASSAGE_END;
}

void sagi_volume_dim(const sag_render *render, sagi_shadow *shadow, const sag_ray *ray, const sag_hit *hit) {
    const sagi_medium *medium = sagi_medium_of(render->world, shadow->medium);
    if (!medium) return;
    const double length = !hit || hit->geometry == SAG_INVALID_ID ? ray->t_max : hit->t;
    shadow->light *= sagi_medium_transmittance(medium, shadow->path->wavelengths.lambda,
                                               length * sag_length(ray->direction));
}
