// SPDX-License-Identifier: MIT
// Choosing a light and sampling it.
//
// Which light is chosen depends on the point that is shone on (light_tree.c), but for lights at infinity,
// which nothing tells apart: each of these gets a share, and all the others together get one (as in pbrt-v4).
// Or it does not: one alias table for all, by power or alike.
//
// Multiple importance sampling (Veach 1997, §9.2.4): light found by both ways is weighted p²/(p_light² +
// p_surface²), where p_light is the density per solid angle including the choice of the light. Lights that no
// ray can find (points, spots, distant ones) and lights that cannot be sampled (unbounded or user-defined
// geometry, p_light = 0) come out right by themselves.
#include "light.h"

#include <string.h>

double sagi_surface_weight(const sagi_lights *lights, double surface_pdf, double light_pdf) {
    if (!(light_pdf > 0)) return 1;
    switch (lights->strategy) {
    case SAG_STRATEGY_MIS: break;
    case SAG_STRATEGY_LIGHTS: return 0;
    case SAG_STRATEGY_SURFACES: return 1;
    }
    // Written as a ratio, so that the squares of sharp densities do not overflow.
    return 1 / (1 + sagi_square(light_pdf / surface_pdf));
}

double sagi_light_weight(const sagi_lights *lights, double surface_pdf, const sagi_light_sample *sample) {
    if (sample->delta) return 1;
    switch (lights->strategy) {
    case SAG_STRATEGY_MIS: break;
    case SAG_STRATEGY_LIGHTS: return 1;
    case SAG_STRATEGY_SURFACES: return 0;
    }
    return 1 / (1 + sagi_square(surface_pdf / sample->pdf));
}

static bool sample_point(const sagi_light *light, const sagi_shading_point *from, sagi_spectrum lambda,
                         sagi_light_sample *sample) {
    sag_vec3 d = sag_sub(light->light.from, from->position);
    double distance = sag_length(d);
    if (!(distance > 0)) return false;
    sample->wi = sag_scale(d, 1 / distance);
    double scale = 1 / distance / distance;
    if (light->light.kind == SAG_LIGHT_SPOT) scale *= sagi_spot_falloff(light, sag_neg(sample->wi));
    const bool picture =
        light->light.kind == SAG_LIGHT_GONIOMETRIC || light->light.kind == SAG_LIGHT_PROJECTION;
    sample->radiance = (picture ? sagi_beam_intensity(light, sag_neg(sample->wi), lambda)
                                : sagi_color_at(&light->color, lambda)) *
                       (float)scale;
    sample->delta = true;
    sample->target = SAGI_TARGET_POINT;
    sample->point = light->light.from;
    return scale > 0 && !sagi_spectrum_is_black(sample->radiance);
}

static bool sample_light(const sagi_light *light, const sagi_shading_point *from, sagi_spectrum lambda,
                         sag_vec2 u, sagi_light_sample *sample) {
    switch (light->light.kind) {
    case SAG_LIGHT_POINT:
    case SAG_LIGHT_SPOT:
    case SAG_LIGHT_GONIOMETRIC:
    case SAG_LIGHT_PROJECTION: return sample_point(light, from, lambda, sample);
    case SAG_LIGHT_DISTANT:
        sample->wi = light->axis;
        sample->radiance = sagi_color_at(&light->color, lambda);
        sample->delta = true;
        sample->target = SAGI_TARGET_FAR;
        return true;
    case SAG_LIGHT_INFINITE:
    case SAG_LIGHT_SKY: break;
    }
    double pdf;
    if (!sagi_sky_sample(light, from, u, lambda, &sample->wi, &pdf, &sample->radiance)) return false;
    sample->pdf *= pdf;
    sample->target = SAGI_TARGET_FAR;
    return sample->pdf > 0;
}

static bool sample_area(const sagi_lights *lights, uint32_t area, const sagi_shading_point *from,
                        sagi_spectrum lambda, sag_vec2 u, sagi_light_sample *sample) {
    double pdf;
    if (!sagi_area_sample(&lights->areas, area, from, u, &sample->surface, &sample->wi, &pdf)) return false;
    const sagi_appearance *appearance = sagi_area_appearance(&lights->areas, area);
    if (appearance->look.alpha.texture) {
        sample->delta = sagi_alpha_is_nowhere(appearance);
        const sag_ray last = {.origin = sample->surface.position, .direction = from->position};
        if (!sample->delta && !sagi_alpha_is_there(appearance, &sample->surface, &last)) return false;
    }
    sample->pdf *= pdf;
    sample->radiance = sagi_emission(appearance, &sample->surface, sag_neg(sample->wi), lambda);
    sample->target = SAGI_TARGET_SURFACE;
    return isfinite(sample->pdf) && !sagi_spectrum_is_black(sample->radiance);
}

static sagi_light_view view_of(const sagi_shading_point *from) {
    return (sagi_light_view){from->position, from->normal, from->reflects_only};
}

// Whether a light at infinity may send anything to the point: not from behind, not from within its window's
// side.
static bool reaches(const sagi_light *light, const sagi_shading_point *from) {
    if (light->light.kind == SAG_LIGHT_DISTANT)
        return !from->reflects_only || sag_dot(from->normal, light->axis) > 0;
    if (light->light.has_portal)
        return sag_dot(light->portal.z, sag_sub(light->portal.low, from->position)) > 0;
    return true;
}

// How many of them do. Each has one share, and so have all the others together.
static uint32_t count_far(const sagi_lights *lights, const sagi_shading_point *from) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < lights->far_count; i++) count += reaches(&lights->lights[lights->far[i]], from);
    return count;
}

bool sagi_lights_choose(const sagi_lights *lights, const sagi_shading_point *from, double *u, uint32_t *index,
                        double *probability) {
    if (lights->choice.count > 0) {
        *index = sagi_alias_sample(&lights->choice, *u, u);
        *probability = lights->choice.entries[*index].probability;
        return true;
    }
    const uint32_t far_count = lights->far_count > 0 ? count_far(lights, from) : 0;
    const uint32_t shares = far_count + (lights->tree.node_count > 0);
    if (far_count > 0) {
        const double place = *u * shares;
        uint32_t chosen = (uint32_t)place < shares ? (uint32_t)place : shares - 1;
        *u = fmin(place - chosen, SAGI_ONE_MINUS);
        *probability = 1.0 / shares;
        for (uint32_t i = 0; chosen < far_count; i++)
            if (reaches(&lights->lights[lights->far[i]], from) && chosen-- == 0) {
                *index = lights->far[i];
                return true;
            }
    }
    const sagi_light_view view = view_of(from);
    if (!sagi_light_tree_sample(&lights->tree, &view, u, index, probability)) return false;
    *probability /= shares;
    return true;
}

double sagi_lights_choice(const sagi_lights *lights, const sagi_shading_point *from, uint32_t index) {
    if (lights->choice.count > 0) return lights->choice.entries[index].probability;
    const double shares =
        (lights->far_count > 0 ? count_far(lights, from) : 0) + (lights->tree.node_count > 0);
    if (index < lights->light_count && sagi_light_is_far(&lights->lights[index]))
        return lights->lights[index].chosen && reaches(&lights->lights[index], from) ? 1 / shares : 0;
    const sagi_light_view view = view_of(from);
    return sagi_light_tree_probability(&lights->tree, &view, index) / shares;
}

bool sagi_lights_sample_one(const sagi_lights *lights, uint32_t index, const sagi_shading_point *from,
                            sagi_spectrum lambda, sag_vec2 u, sagi_light_sample *sample) {
    sample->delta = false;
    if (index < lights->light_count) return sample_light(&lights->lights[index], from, lambda, u, sample);
    return sample_area(lights, index - lights->light_count, from, lambda, u, sample);
}

bool sagi_lights_sample(const sagi_lights *lights, const sagi_shading_point *from, sagi_spectrum lambda,
                        double choose, sag_vec2 u, sagi_light_sample *sample) {
    uint32_t index;
    return sagi_lights_choose(lights, from, &choose, &index, &sample->pdf) &&
           sagi_lights_sample_one(lights, index, from, lambda, u, sample);
}

sagi_spectrum sagi_lights_far(const sagi_lights *lights, const sagi_shading_point *from, sag_vec3 origin,
                              sag_vec3 wi, sagi_spectrum lambda, double surface_pdf) {
    sagi_spectrum sum = {0, 0, 0, 0};
    for (uint32_t i = 0; i < lights->light_count; i++) {
        const sagi_light *light = &lights->lights[i];
        if (light->light.kind != SAG_LIGHT_INFINITE && light->light.kind != SAG_LIGHT_SKY) continue;
        double pdf, weight = 1;
        const sagi_spectrum radiance = sagi_sky_look(light, from, origin, wi, lambda, &pdf);
        if (from)
            weight = sagi_surface_weight(lights, surface_pdf, sagi_lights_choice(lights, from, i) * pdf);
        sum += radiance * (float)weight;
    }
    return sum;
}

double sagi_lights_area_pdf(const sagi_lights *lights, const sagi_shading_point *from, sag_vec3 wi,
                            const sag_hit *hit, const sag_surface *surface) {
    const uint32_t area = sagi_area_find(&lights->areas, hit, surface);
    if (area == SAG_INVALID_ID || !(lights->areas.areas[area].density > 0)) return 0;
    const double choice = sagi_lights_choice(lights, from, lights->light_count + area);
    return choice > 0 ? choice * sagi_area_pdf(&lights->areas, area, from, wi, hit, surface) : 0;
}
