// SPDX-License-Identifier: MIT
// Preparing the lights of a world: which geometries shine, primitive by primitive, and how likely each is
// chosen.
#include "light.h"

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
        light->cos_cone = cos(cone);
        light->cos_full = cos(cone - delta);
    }
    light->axis = sag_normalize(description->kind == SAG_LIGHT_DISTANT ? sag_neg(along) : along);
    return description->kind == SAG_LIGHT_INFINITE ? sagi_sky_init(light, world->context, error) : SAG_OK;
}

// How many primitives of a geometry are sampled one by one; the rest are sampled as a whole.
static uint32_t primitive_count(const sag_scene *scene, uint32_t geometry, bool *flat) {
    sag_shape_kind kind;
    const void *shape;
    *flat = false;
    if (sag_geometry_get(scene, geometry, &kind, &shape) != SAG_OK) return 0;
    if (kind == SAG_SHAPE_MESH) {
        *flat = true;
        return ((const sag_mesh *)shape)->triangle_count;
    }
    if (kind == SAG_SHAPE_SPHERES) return ((const sag_spheres *)shape)->count;
    *flat = kind == SAG_SHAPE_TRIANGLE || kind == SAG_SHAPE_RECTANGLE || kind == SAG_SHAPE_POLYGON ||
            kind == SAG_SHAPE_DISK;
    return kind == SAG_SHAPE_INSTANCE ? 0 : 1;
}

static bool shines(const sagi_appearance *appearance, const sag_world *world) {
    return appearance->scene == world->scene && appearance->brightness > 0;
}

// Fills the groups and counts the area lights.
static sag_status count_areas(sagi_lights *lights, sag_error *error) {
    const sag_world *world = lights->world;
    const sagi_appearance *all = world->appearances.items;
    uint64_t total = 0;
    for (uint32_t i = 0; i < lights->appearance_count; i++) {
        lights->group_of[i] = SAG_INVALID_ID;
        if (!color_is_valid(all[i].look.emission))
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "geometry %u has a negative or infinite emission",
                                 all[i].geometry);
        if (!shines(&all[i], world)) continue;
        bool flat;
        uint32_t count = primitive_count(world->scene, all[i].geometry, &flat);
        if (count == 0) continue;
        lights->group_of[i] = lights->group_count;
        lights->groups[lights->group_count++] = (sagi_area_group){.scene = world->scene,
                                                                  .appearance = i,
                                                                  .geometry = all[i].geometry,
                                                                  .first = (uint32_t)total,
                                                                  .count = count,
                                                                  .flat = flat};
        total += count;
    }
    if (total + lights->light_count >= SAG_INVALID_ID)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "too many shining primitives");
    lights->area_count = (uint32_t)total;
    return SAG_OK;
}

// Writes each area light and its power into weights[].
static void fill_areas(sagi_lights *lights, double *weights) {
    const sagi_appearance *all = lights->world->appearances.items;
    for (uint32_t g = 0; g < lights->group_count; g++) {
        const sagi_area_group *group = &lights->groups[g];
        const sag_appearance *look = &all[group->appearance].look;
        double sides = look->two_sided ? 2 : 1;
        for (uint32_t i = 0; i < group->count; i++) {
            double area = sag_geometry_area(group->scene, group->geometry, i);
            bool usable = area > 0 && isfinite(area) && isfinite(1 / area);
            sagi_area_light *light = &lights->areas[group->first + i];
            *light = (sagi_area_light){.group = g, .primitive = i, .density = usable ? 1 / area : 0};
            if (!sagi_ball_find(group->scene, group->geometry, i, &light->center, &light->radius))
                light->radius = 0;
            weights[group->first + i] =
                usable ? SAGI_RENDER_PI * sides * area * all[group->appearance].brightness : 0;
        }
    }
}

// The power of a light in the scene, or 0 for one at infinity.
static double light_power(const sagi_light *light) {
    const double brightness = light->brightness;
    if (light->light.kind == SAG_LIGHT_POINT) return 4 * SAGI_RENDER_PI * brightness;
    if (light->light.kind == SAG_LIGHT_SPOT)
        return 2 * SAGI_RENDER_PI * brightness * (1 - (light->cos_full + light->cos_cone) / 2);
    return 0;
}

static bool at_infinity(const sagi_light *light) {
    if (!(light->brightness > 0) && sagi_rgb_is_black(light->light.horizon)) return false;
    return light->light.kind != SAG_LIGHT_POINT && light->light.kind != SAG_LIGHT_SPOT;
}

static sag_status choose_weights(sagi_lights *lights, sag_error *error) {
    const sag_context *context = lights->world->context;
    uint32_t count = lights->light_count + lights->area_count;
    if (count == 0) return SAG_OK;
    double *weights = sag_allocate(context, count * sizeof *weights);
    if (!weights) return no_memory(error);
    fill_areas(lights, weights + lights->light_count);
    for (uint32_t i = 0; i < lights->light_count; i++) weights[i] = light_power(&lights->lights[i]);
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += weights[i];
    if (!(sum > 0)) sum = 1;
    for (uint32_t i = 0; i < lights->light_count; i++)
        if (at_infinity(&lights->lights[i])) weights[i] = sum;
    bool made = sagi_alias_init(&lights->choice, context, weights, count);
    sag_release(context, weights, count * sizeof *weights);
    return made ? SAG_OK : no_memory(error);
}

sag_status sagi_lights_init(sagi_lights *lights, const sag_world *world, sag_error *error) {
    const sag_context *context = world->context;
    *lights = (sagi_lights){.world = world,
                            .strategy = world->settings.strategy,
                            .appearance_count = (uint32_t)world->appearances.count};
    size_t light_count = world->lights.count, appearance_count = world->appearances.count;
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
    }
    if (appearance_count) {
        lights->groups = sag_allocate(context, appearance_count * sizeof *lights->groups);
        lights->group_of = sag_allocate(context, appearance_count * sizeof *lights->group_of);
        if (!lights->groups || !lights->group_of) return no_memory(error);
        sag_status status = count_areas(lights, error);
        if (status != SAG_OK) return status;
    }
    if (lights->area_count) {
        lights->areas = sag_allocate(context, lights->area_count * sizeof *lights->areas);
        if (!lights->areas) return no_memory(error);
    }
    return choose_weights(lights, error);
}

void sagi_lights_clear(sagi_lights *lights) {
    if (!lights->world) return;
    const sag_context *context = lights->world->context;
    for (uint32_t i = 0; i < lights->light_count; i++) sagi_alias_clear(&lights->lights[i].texels, context);
    sag_release(context, lights->lights, lights->light_count * sizeof *lights->lights);
    sag_release(context, lights->groups, lights->appearance_count * sizeof *lights->groups);
    sag_release(context, lights->group_of, lights->appearance_count * sizeof *lights->group_of);
    if (lights->areas) sag_release(context, lights->areas, lights->area_count * sizeof *lights->areas);
    sagi_alias_clear(&lights->choice, context);
    *lights = (sagi_lights){0};
}
