// SPDX-License-Identifier: MIT
// Choosing a light and sampling it.
//
// Every light has a probability in one alias table. Lights in the scene share one part in proportion to their
// power; each light at infinity, whose power depends on how big the scene is taken to be, gets a part of its
// own (as pbrt's samplers do).
//
// Multiple importance sampling (Veach 1997, §9.2.4): light found by both ways is weighted p²/(p_light² +
// p_surface²), where p_light is the density per solid angle including the choice of the light. Lights that no
// ray can find (points, spots, distant ones) and lights that cannot be sampled (unbounded or user-defined
// geometry, p_light = 0) come out right by themselves.
#include "light.h"

#include <string.h>

sagi_spectrum sagi_emission(const sagi_appearance *appearance, const sag_surface *surface, sag_vec3 wo,
                            sagi_spectrum lambda) {
    const sagi_spectrum black = {0, 0, 0, 0};
    if (!appearance || !(appearance->brightness > 0)) return black;
    if (!appearance->look.two_sided && !(sag_dot(surface->geometric_normal, wo) > 0)) return black;
    return sagi_color_at(&appearance->emission, lambda);
}

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

static double spot_falloff(const sagi_light *light, sag_vec3 away) {
    double x = sag_dot(away, light->axis);
    if (!(x > light->cos_cone)) return 0;
    if (x >= light->cos_full) return 1;
    x = (x - light->cos_cone) / (light->cos_full - light->cos_cone);
    return x * x * (3 - 2 * x);
}

static bool sample_point(const sagi_light *light, const sagi_shading_point *from, sagi_spectrum lambda,
                         sagi_light_sample *sample) {
    sag_vec3 d = sag_sub(light->light.from, from->position);
    double distance = sag_length(d);
    if (!(distance > 0)) return false;
    sample->wi = sag_scale(d, 1 / distance);
    double scale = 1 / distance / distance;
    if (light->light.kind == SAG_LIGHT_SPOT) scale *= spot_falloff(light, sag_neg(sample->wi));
    sample->radiance = sagi_color_at(&light->color, lambda) * (float)scale;
    sample->delta = true;
    sample->target = SAGI_TARGET_POINT;
    sample->point = light->light.from;
    return scale > 0;
}

static bool sample_light(const sagi_light *light, const sagi_shading_point *from, sagi_spectrum lambda,
                         sag_vec2 u, sagi_light_sample *sample) {
    switch (light->light.kind) {
    case SAG_LIGHT_POINT:
    case SAG_LIGHT_SPOT: return sample_point(light, from, lambda, sample);
    case SAG_LIGHT_DISTANT:
        sample->wi = light->axis;
        sample->radiance = sagi_color_at(&light->color, lambda);
        sample->delta = true;
        sample->target = SAGI_TARGET_FAR;
        return true;
    case SAG_LIGHT_INFINITE:
    case SAG_LIGHT_SKY: break;
    }
    if (!sagi_sky_sample(light, from, u, &sample->wi)) return false;
    sample->pdf *= sagi_sky_pdf(light, from, sample->wi);
    sample->radiance = sagi_sky_radiance(light, sample->wi, lambda);
    sample->target = SAGI_TARGET_FAR;
    return sample->pdf > 0;
}

static const sagi_appearance *appearance_at(const sagi_lights *lights, uint32_t index) {
    return (const sagi_appearance *)lights->world->appearances.items + index;
}

static bool sample_area(const sagi_lights *lights, const sagi_area_light *area,
                        const sagi_shading_point *from, sagi_spectrum lambda, sag_vec2 u,
                        sagi_light_sample *sample) {
    const sagi_area_group *group = &lights->groups[area->group];
    const sagi_appearance *appearance = appearance_at(lights, group->appearance);
    double density = 0, cone = area->radius > 0 ? sagi_ball_cone(area, from->position) : 0;
    if (cone > 0)
        sagi_ball_sample(area, from->position, cone, u, &sample->surface);
    else if (!sag_geometry_sample(group->scene, group->geometry, area->primitive, u, &sample->surface,
                                  &density))
        return false;
    sagi_orient(appearance, &sample->surface);
    sag_vec3 d = sag_sub(sample->surface.position, from->position);
    double distance2 = sag_dot(d, d);
    if (!(distance2 > 0)) return false;
    sample->wi = sag_scale(d, 1 / sqrt(distance2));
    double cosine = fabs(sag_dot(sample->wi, sample->surface.geometric_normal));
    if (!(cosine > 0)) return false;
    sample->pdf *= cone > 0 ? 1 / (2 * SAGI_RENDER_PI * cone) : density * distance2 / cosine;
    sample->radiance = sagi_emission(appearance, &sample->surface, sag_neg(sample->wi), lambda);
    sample->target = SAGI_TARGET_SURFACE;
    return isfinite(sample->pdf) && !sagi_spectrum_is_black(sample->radiance);
}

bool sagi_lights_sample(const sagi_lights *lights, const sagi_shading_point *from, sagi_spectrum lambda,
                        double choose, sag_vec2 u, sagi_light_sample *sample) {
    if (lights->choice.count == 0) return false;
    double rest;
    uint32_t index = sagi_alias_sample(&lights->choice, choose, &rest);
    sample->pdf = lights->choice.entries[index].probability;
    sample->delta = false;
    if (index < lights->light_count) return sample_light(&lights->lights[index], from, lambda, u, sample);
    return sample_area(lights, &lights->areas[index - lights->light_count], from, lambda, u, sample);
}

sagi_spectrum sagi_lights_far(const sagi_lights *lights, const sagi_shading_point *from, sag_vec3 wi,
                              sagi_spectrum lambda, double surface_pdf) {
    sagi_spectrum sum = {0, 0, 0, 0};
    for (uint32_t i = 0; i < lights->light_count; i++) {
        const sagi_light *light = &lights->lights[i];
        if (light->light.kind != SAG_LIGHT_INFINITE && light->light.kind != SAG_LIGHT_SKY) continue;
        double weight = 1;
        if (from && lights->choice.count) {
            double choice = lights->choice.entries[i].probability;
            weight = sagi_surface_weight(lights, surface_pdf, choice * sagi_sky_pdf(light, from, wi));
        }
        sum += sagi_sky_radiance(light, wi, lambda) * (float)weight;
    }
    return sum;
}

double sagi_lights_area_pdf(const sagi_lights *lights, sag_vec3 from, sag_vec3 wi, const sag_hit *hit,
                            const sag_surface *surface) {
    if (hit->instance_depth > 0 || lights->choice.count == 0) return 0;
    uint64_t id = surface->user_data;
    if (id == 0 || id > lights->appearance_count) return 0;
    uint32_t group_index = lights->group_of[id - 1];
    if (group_index == SAG_INVALID_ID) return 0;
    const sagi_area_group *group = &lights->groups[group_index];
    uint32_t primitive = group->count > 1 ? hit->primitive : 0;
    if (primitive >= group->count) return 0;
    const sagi_area_light *area = &lights->areas[group->first + primitive];
    double choice = lights->choice.entries[lights->light_count + group->first + primitive].probability;
    double density = area->density, cone = area->radius > 0 ? sagi_ball_cone(area, from) : 0;
    if (cone > 0) return choice / (2 * SAGI_RENDER_PI * cone);
    if (!group->flat && choice > 0)
        density = sag_geometry_density(group->scene, group->geometry, hit->primitive, surface);
    sag_vec3 d = sag_sub(surface->position, from);
    double cosine = fabs(sag_dot(wi, surface->geometric_normal));
    double pdf = choice * density * sag_dot(d, d) / cosine;
    return isfinite(pdf) ? pdf : 0;
}
