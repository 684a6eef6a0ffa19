// SPDX-License-Identifier: MIT
// How light leaves a lamp: a point and a direction drawn for a particle, which carries the radiance there by
// what the two were likely to be drawn:
//
//     points        a direction ω: I/p(ω). Spots shine into their cone only, projectors into their screen.
//     surfaces      a point uniformly by area, a direction by the cosine: L cos θ/(p(x) cos θ/π) = π L/p(x)
//     far lights    a direction ω, and a point of the disk across it that the scene's sphere fills: L π
//     R²/p(ω) portals       a point of the window, a direction by its cosine: π A L; the particle starts
//     outside
//
// (PBR 4th ed. §12.1 to 12.5, 13.) For whole boxes and balls all sides of the surface count.
#include "math/elementary.h"
#include "particle.h"
#include "warp.h"

static sag_vec3 around(sag_vec3 axis, sag_vec3 local) {
    sag_vec3 s, t;
    sag_frame(axis, &s, &t);
    return sag_madd(sag_madd(sag_scale(s, local.x), local.y, t), local.z, axis);
}

// Takes directions to the world: dω there of what is a piece of area 1 across a unit one, or of the plane z
// = 1.
static double spread(const sag_affine *to_world, sag_vec3 *direction) {
    const sag_vec3 way = sag_affine_vector(to_world, *direction);
    const double length = sag_length(way);
    *direction = sag_scale(way, 1 / length);
    return fabs(sag_affine_determinant(to_world)) / (length * length * length);
}

static bool leave_point(const sagi_light *light, sagi_spectrum lambda, sag_vec2 u, sagi_leaving *leaving) {
    const sag_light *description = &light->light;
    sag_vec3 d = sagi_warp_sphere(u);
    double by_density = 4 * SAGI_RENDER_PI;
    if (description->kind == SAG_LIGHT_SPOT) {
        const double cosine = 1 - u.x * (1 - light->cos_cone), sine = sqrt(fmax(0, 1 - cosine * cosine));
        double sin_phi, cos_phi;
        sagi_sincos(2 * SAGI_RENDER_PI * u.y, &sin_phi, &cos_phi);
        const sag_vec3 local = {sine * cos_phi, sine * sin_phi, cosine};
        d = around(light->stretched ? light->own_axis : light->axis, local);
        by_density = 2 * SAGI_RENDER_PI * (1 - light->cos_cone);
        if (light->stretched) by_density *= spread(&description->to_world, &d);
        by_density *= sagi_spot_falloff(light, d);
    } else if (description->kind == SAG_LIGHT_PROJECTION) {
        const sag_vec3 at = {(2 * u.x - 1) * light->screen.x, (2 * u.y - 1) * light->screen.y, 1};
        d = at;
        by_density = 4 * light->screen.x * light->screen.y * spread(&description->to_world, &d);
    }
    const bool picture =
        description->kind == SAG_LIGHT_GONIOMETRIC || description->kind == SAG_LIGHT_PROJECTION;
    leaving->power =
        (picture ? sagi_beam_intensity(light, d, lambda) : sagi_color_at(&light->color, lambda)) *
        (float)by_density;
    leaving->ray = sag_ray_make(description->from, d);
    return true;
}

// A ray in direction d through a point of the scene's disk across it.
static double through_scene(const sagi_lights *lights, sag_vec3 d, sag_vec2 u, sag_ray *ray) {
    const double radius = lights->radius;
    const sag_vec2 disk = sagi_warp_disk(u);
    const sag_vec3 offset = around(d, (sag_vec3){disk.x, disk.y, -1});
    *ray = sag_ray_make(sag_madd(lights->center, radius, offset), d);
    return SAGI_RENDER_PI * radius * radius;
}

static bool leave_window(const sagi_lights *lights, const sagi_light *light, sagi_spectrum lambda, sag_vec2 u,
                         sag_vec2 v, sagi_leaving *leaving) {
    const sag_vec3 *corner = light->light.portal;
    const sag_vec3 e = sag_sub(corner[1], corner[0]), f = sag_sub(corner[3], corner[0]);
    const sag_vec3 at = sag_madd(sag_madd(corner[0], u.x, e), u.y, f);
    const sag_vec3 d = around(sag_neg(light->portal.z), sagi_warp_cosine(v));
    const double far = lights->radius + sag_length(sag_sub(at, lights->center));
    leaving->power = sagi_sky_radiance(light, sag_madd(at, lights->radius, d), sag_neg(d), lambda) *
                     (float)(SAGI_RENDER_PI * sag_length(sag_cross(e, f)));
    leaving->ray = sag_ray_make(sag_madd(at, -far, d), d);
    leaving->window = far;
    return true;
}

static bool leave_light(const sagi_lights *lights, const sagi_light *light, sagi_spectrum lambda, sag_vec2 u,
                        sag_vec2 v, sagi_leaving *leaving) {
    const sag_light_kind kind = light->light.kind;
    if (!sagi_light_is_far(light)) return leave_point(light, lambda, u, leaving);
    if (kind == SAG_LIGHT_DISTANT) {
        const double disk = through_scene(lights, sag_neg(light->axis), u, &leaving->ray);
        leaving->power = sagi_color_at(&light->color, lambda) * (float)disk;
        return true;
    }
    if (light->light.has_portal) return leave_window(lights, light, lambda, u, v, leaving);
    const sagi_shading_point nowhere = {.position = lights->center};
    sag_vec3 wi;
    double density;
    sagi_spectrum radiance;
    if (!sagi_sky_sample(light, &nowhere, v, lambda, &wi, &density, &radiance)) return false;
    const double disk = through_scene(lights, sag_neg(wi), u, &leaving->ray);
    leaving->power = radiance * (float)(disk / density);
    return true;
}

static bool leave_area(const sagi_lights *lights, uint32_t area, sagi_spectrum lambda, sag_vec2 u, sag_vec2 v,
                       sagi_leaving *leaving) {
    const sagi_appearance *appearance = sagi_area_appearance(&lights->areas, area);
    sag_surface *surface = &leaving->surface;
    if (!sagi_area_point(&lights->areas, area, u, surface, &leaving->density)) return false;
    sagi_replace_texcoords(appearance, surface);
    sagi_orient(appearance, surface);
    const sag_ray last = {.origin = surface->position, .direction = {u.x, v.x, v.y}}; // as good as random
    if (!sagi_alpha_is_nowhere(appearance) && !sagi_alpha_is_there(appearance, surface, &last)) return false;
    const double sides = appearance->look.two_sided ? 2 : 1;
    sag_vec3 n = surface->geometric_normal;
    if (appearance->look.two_sided) {
        if (v.x < 0.5) n = sag_neg(n);
        v.x = fmin(v.x < 0.5 ? 2 * v.x : 2 * v.x - 1, SAGI_ONE_MINUS);
    }
    const sag_vec3 d = around(n, sagi_warp_cosine(v));
    leaving->power =
        sagi_emission(appearance, surface, d, lambda) * (float)(sides * SAGI_RENDER_PI / leaving->density);
    leaving->ray = sag_spawn_ray(surface, d);
    leaving->on_surface = true;
    leaving->of = appearance;
    return true;
}

bool sagi_lights_leave(const sagi_lights *lights, sagi_spectrum lambda, double choose, sag_vec2 u, sag_vec2 v,
                       sagi_leaving *leaving) {
    if (lights->choice.count == 0) return false;
    const uint32_t index = sagi_alias_sample(&lights->choice, choose, &choose);
    const double probability = lights->choice.entries[index].probability;
    leaving->on_surface = false;
    leaving->window = 0;
    const bool left = index < lights->light_count
                          ? leave_light(lights, &lights->lights[index], lambda, u, v, leaving)
                          : leave_area(lights, index - lights->light_count, lambda, u, v, leaving);
    if (!left) return false;
    leaving->power *= (float)(1 / probability);
    leaving->density *= probability;
    return true;
}
