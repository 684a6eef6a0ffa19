// SPDX-License-Identifier: MIT
// Preparing the lights of a world, and how one of them is chosen.
#include "light.h"
#include "math/elementary.h"

#include <string.h>

static sag_status no_memory(sag_error *error) {
    return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
}

static bool color_is_valid(sag_rgb color) {
    return color.r >= 0 && color.g >= 0 && color.b >= 0 && sagi_rgb_is_finite(color);
}

// The light's colours, made ready.
static void init_color(sagi_light *light, const sag_world *world) {
    const sag_light *description = &light->light;
    const sagi_spectrum_entry *spectrum = sagi_spectrum_of(world, description->spectrum);
    light->brightness = sagi_rgb_mean(description->color);
    if (spectrum) {
        light->color = spectrum->color;
        light->color.scale = (float)((double)light->color.scale * light->brightness);
        light->brightness *= spectrum->brightness;
    } else {
        light->color = sagi_color_of_rgb(SAG_COLOR_SRGB, description->color, SAGI_RGB_ILLUMINANT);
    }
    light->horizon = sagi_color_of_rgb(SAG_COLOR_SRGB, description->horizon, SAGI_RGB_ILLUMINANT);
}

// Whether a map makes ellipses of circles. (What is round to 2⁻⁴⁰ is round; zeros are the identity.)
static bool is_stretched(const sag_affine *map) {
    double dots[3][3], most = 0, off = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            dots[i][j] = 0;
            for (int k = 0; k < 3; k++) dots[i][j] += map->m[k][i] * map->m[k][j];
            most = fmax(most, fabs(dots[i][j]));
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) off = fmax(off, fabs(dots[i][j] - (i == j ? dots[0][0] : 0)));
    return off > 0x1p-40 * most;
}

static sag_status init_light(sagi_light *light, const sag_light *description, const sag_world *world,
                             uint32_t id, sag_error *error) {
    light->light = *description;
    if (!color_is_valid(description->color) || !color_is_valid(description->horizon))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "light %u has a negative or infinite colour", id);
    init_color(light, world);
    if (!sag_is_finite(description->from) || !sag_is_finite(description->to))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "light %u has a place that is not finite", id);
    sag_vec3 along = sag_sub(description->to, description->from);
    bool aimed = description->kind == SAG_LIGHT_SPOT || description->kind == SAG_LIGHT_DISTANT;
    if (aimed && !(sag_dot(along, along) > 0))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "light %u has no direction: from and to are equal",
                             id);
    if (description->kind == SAG_LIGHT_SPOT) {
        double cone = description->cone_rad, delta = description->cone_delta_rad;
        if (!(cone > 0 && cone <= SAGI_RENDER_PI) || !(delta >= 0 && delta <= cone))
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "spot light %u has a cone of %g rad, delta %g",
                                 id, cone, delta);
        light->cos_cone = sagi_cos(cone);
        light->cos_full = sagi_cos(cone - delta);
        light->stretched = is_stretched(&description->to_world);
        const sag_status placed = light->stretched ? sagi_light_place(light, error) : SAG_OK;
        if (placed != SAG_OK) return placed;
        if (light->stretched) light->own_axis = sag_normalize(sag_affine_vector(&light->from_world, along));
    }
    light->axis = sag_normalize(description->kind == SAG_LIGHT_DISTANT ? sag_neg(along) : along);
    if (description->kind == SAG_LIGHT_INFINITE)
        return sagi_sky_init(light, world->context,
                             world->settings.strategy == SAG_STRATEGY_MIS &&
                                 world->settings.integrator != SAG_INTEGRATOR_LIGHTPATH,
                             error);
    const bool beam = description->kind == SAG_LIGHT_GONIOMETRIC || description->kind == SAG_LIGHT_PROJECTION;
    return beam ? sagi_beam_init(light, error) : SAG_OK;
}

// The least cosine between a projector's axis and a corner, as it is placed.
static double projection_cosine(const sagi_light *light) {
    const sag_affine *place = &light->light.to_world;
    const sag_vec3 axis = sag_normalize(sag_affine_vector(place, sag_vec3_make(0, 0, 1)));
    double least = 1;
    for (int i = 0; i < 4; i++) {
        const sag_vec3 corner = {i & 1 ? light->screen.x : -light->screen.x,
                                 i & 2 ? light->screen.y : -light->screen.y, 1};
        least = fmin(least, sag_dot(axis, sag_normalize(sag_affine_vector(place, corner))));
    }
    return least;
}

// What the tree is told of a light; intensity 0 for one at infinity.
static sagi_light_bounds light_bounds(const sagi_light *light) {
    const sag_vec3 at = light->light.from;
    sagi_light_bounds bounds = {.box = {at, at}, .axis = {0, 0, 1}, .cos_normals = -1};
    if (sagi_light_is_far(light)) return bounds;
    bounds.intensity = light->brightness;
    if (light->light.kind == SAG_LIGHT_SPOT) {
        if (light->stretched) return bounds; // all around: how far the cone reaches depends on the side
        bounds.axis = light->axis;
        bounds.cos_normals = light->cos_cone;
        bounds.cos_spread = 0.999; // nothing beyond; some room for rounding
    } else if (light->light.kind == SAG_LIGHT_GONIOMETRIC) {
        bounds.intensity *= light->mean;
    } else if (light->light.kind == SAG_LIGHT_PROJECTION) {
        bounds.intensity *= light->mean;
        bounds.axis = sag_normalize(sag_affine_vector(&light->light.to_world, sag_vec3_make(0, 0, 1)));
        bounds.cos_normals = projection_cosine(light);
        bounds.cos_spread = 0.999;
    }
    return bounds;
}

// The power of a light; of those at infinity what arrives in a ball of this radius (pbrt-v4's measure).
static double light_power(const sagi_light *light, double radius) {
    const double brightness = light->brightness;
    switch (light->light.kind) {
    case SAG_LIGHT_POINT: return 4 * SAGI_RENDER_PI * brightness;
    case SAG_LIGHT_SPOT:
        return 2 * SAGI_RENDER_PI * brightness * (1 - (light->cos_full + light->cos_cone) / 2);
    case SAG_LIGHT_GONIOMETRIC:
    case SAG_LIGHT_PROJECTION: return light->solid_angle * light->mean * brightness;
    case SAG_LIGHT_DISTANT: return SAGI_RENDER_PI * radius * radius * brightness;
    case SAG_LIGHT_INFINITE:
    case SAG_LIGHT_SKY: break;
    }
    return sagi_square(2 * SAGI_RENDER_PI * radius) * fmax(brightness, sagi_rgb_mean(light->light.horizon));
}

// The ball around the scene's box; of a scene without bounds, or without anything, one of radius 1.
static bool find_ball(sagi_lights *lights) {
    const sag_box3 box = sag_scene_bounds(lights->world->scene);
    lights->radius = sag_length(sag_sub(box.max, box.min)) / 2 * 1.001;
    lights->center = sag_scale(sag_add(box.min, box.max), 0.5);
    if (lights->radius > 0 && isfinite(lights->radius) && sag_is_finite(lights->center)) return true;
    lights->radius = 1;
    lights->center = (sag_vec3){0, 0, 0};
    return false;
}

static double area_power(const sagi_areas *areas, uint32_t index) {
    const double density = areas->areas[index].density;
    if (!(density > 0)) return 0;
    const sagi_appearance *appearance = sagi_area_appearance(areas, index);
    const double area = appearance->look.emission_over_area ? 1 : 1 / density;
    return SAGI_RENDER_PI * (appearance->look.two_sided ? 2 : 1) * appearance->brightness * area;
}

// One table for all lights, by power or alike.
static bool make_table(sagi_lights *lights) {
    const sag_context *context = lights->world->context;
    const uint32_t count = lights->light_count + lights->areas.count;
    double *weights = sag_allocate(context, count * sizeof *weights), sum = 0;
    if (!weights) return false;
    const double radius = lights->radius;
    for (uint32_t i = 0; i < count; i++) {
        weights[i] = i < lights->light_count ? light_power(&lights->lights[i], radius)
                                             : area_power(&lights->areas, i - lights->light_count);
        if (!isfinite(weights[i])) weights[i] = 0;
        if (lights->sampler == SAG_LIGHT_SAMPLER_UNIFORM) weights[i] = weights[i] > 0;
        sum += weights[i];
    }
    const bool made = !(sum > 0) || sagi_alias_init(&lights->choice, context, weights, count);
    sag_release(context, weights, count * sizeof *weights);
    return made;
}

static bool make_tree(sagi_lights *lights) {
    const sag_context *context = lights->world->context;
    const uint32_t count = lights->light_count + lights->areas.count;
    if (lights->light_count > 0)
        lights->far = sag_allocate(context, lights->light_count * sizeof *lights->far);
    sagi_light_bounds *bounds = sag_allocate(context, count * sizeof *bounds);
    if (!bounds || (lights->light_count > 0 && !lights->far)) {
        sag_release(context, bounds, count * sizeof *bounds);
        return false;
    }
    for (uint32_t i = 0; i < count; i++)
        bounds[i] = i < lights->light_count ? light_bounds(&lights->lights[i])
                                            : sagi_area_bounds(&lights->areas, i - lights->light_count);
    for (uint32_t i = 0; i < lights->light_count; i++) {
        sagi_light *light = &lights->lights[i];
        light->chosen = sagi_light_is_far(light) && light_power(light, 1) > 0;
        if (light->chosen) lights->far[lights->far_count++] = i;
    }
    const bool made = sagi_light_tree_init(&lights->tree, context, bounds, count);
    sag_release(context, bounds, count * sizeof *bounds);
    return made;
}

sag_status sagi_lights_init(sagi_lights *lights, const sag_world *world, sag_error *error) {
    const sag_context *context = world->context;
    *lights = (sagi_lights){
        .world = world, .strategy = world->settings.strategy, .sampler = world->settings.light_sampler};
    const bool from_lamps = world->settings.integrator == SAG_INTEGRATOR_LIGHTPATH;
    if (from_lamps) lights->sampler = SAG_LIGHT_SAMPLER_POWER; // nothing is lit yet
    const bool bounded = find_ball(lights);
    size_t light_count = world->lights.count;
    if (light_count) {
        lights->lights = sag_allocate(context, light_count * sizeof *lights->lights);
        if (!lights->lights) return no_memory(error);
        memset(lights->lights, 0, light_count * sizeof *lights->lights);
        lights->light_count = (uint32_t)light_count;
    }
    for (uint32_t i = 0; i < light_count; i++) {
        const sag_light *description = (const sag_light *)world->lights.items + i;
        sag_status status = init_light(&lights->lights[i], description, world, i + 1, error);
        if (status != SAG_OK) return status;
        if (from_lamps && !bounded && sagi_light_is_far(&lights->lights[i]))
            sag_context_log(
                context, SAG_LOG_WARNING,
                "light from infinity is followed into a ball of radius 1 only: the scene has no bounds");
    }
    const sag_status status = sagi_areas_init(&lights->areas, world, error);
    if (status != SAG_OK) return status;
    if (light_count + lights->areas.count == 0) return SAG_OK;
    if (light_count + lights->areas.count >= SAGI_LIGHT_LEAF)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "too many lights");
    const bool tree = lights->sampler == SAG_LIGHT_SAMPLER_BVH;
    return (tree ? make_tree(lights) : make_table(lights)) ? SAG_OK : no_memory(error);
}

void sagi_lights_clear(sagi_lights *lights) {
    if (!lights->world) return;
    const sag_context *context = lights->world->context;
    for (uint32_t i = 0; i < lights->light_count; i++) sagi_sky_clear(&lights->lights[i], context);
    sag_release(context, lights->far, lights->light_count * sizeof *lights->far);
    sag_release(context, lights->lights, lights->light_count * sizeof *lights->lights);
    sagi_areas_clear(&lights->areas);
    sagi_light_tree_clear(&lights->tree, context);
    sagi_alias_clear(&lights->choice, context);
    *lights = (sagi_lights){0};
}
