// SPDX-License-Identifier: MIT
// Rays that pass what is not there: surfaces by as much as their alpha is below 1, and interfaces. A ray goes
// on from such a surface as any spawned ray does, so nothing is skipped and nothing is met twice. Scenes
// without them take the short way.
#include "trace.h"
#include "medium.h"
#include "shapes/spawn.h"

// What a ray finds at a hit.
typedef enum presence { NOTHING, INTERFACE, SURFACE } presence;

static presence presence_at(const sag_world *world, const sagi_appearance *appearance,
                            const sag_surface *surface, const sag_ray *ray) {
    if (!appearance) return SURFACE;
    if (!sagi_alpha_is_there(appearance, surface, ray)) return NOTHING;
    uint32_t id = appearance->look.material;
    if (id == 0) return SURFACE;
    const sagi_material *material = (const sagi_material *)world->materials.items + (id - 1);
    return material->material.kind == SAG_MATERIAL_INTERFACE ? INTERFACE : SURFACE;
}

// Where a ray goes on through what is no surface: into the medium behind, if it is an interface.
static void pass(const sag_render *render, presence found, const sagi_appearance *appearance,
                 const sag_surface *surface, sag_vec3 direction, uint32_t *medium) {
    if (!render->has_media || found != INTERFACE) return;
    sag_surface oriented = *surface;
    sagi_orient(appearance, &oriented);
    *medium = sagi_medium_beyond(appearance, &oriented, direction, *medium);
}

sagi_course sagi_trace_through(const sag_render *render, sagi_path *path, sag_ray *ray,
                               const sagi_meeting *meeting) {
    const sag_surface *surface = &meeting->surface;
    const presence found = presence_at(render->world, meeting->appearance, surface, ray);
    if (found == SURFACE) return SAGI_COURSE_MEETING;
    if (++path->passed == SAGI_MAX_PASSED) return SAGI_COURSE_AWAY;
    pass(render, found, meeting->appearance, surface, ray->direction, &path->medium);
    uint32_t mask = ray->mask;
    sagi_spawn(surface, ray->direction, ray);
    ray->mask = mask;
    return SAGI_COURSE_ON;
}

void sagi_shadow_ray(const sag_surface *from, const sagi_light_sample *sample, sag_ray *ray) {
    switch (sample->target) {
    case SAGI_TARGET_FAR: sagi_spawn(from, sample->wi, ray); break;
    case SAGI_TARGET_POINT: sagi_spawn_to_point(from, sample->point, ray); break;
    case SAGI_TARGET_SURFACE: sagi_spawn_to_surface(from, &sample->surface, ray); break;
    }
    ray->mask = SAG_RAY_SHADOW;
}

sagi_course sagi_trace_shadow(const sag_render *render, const sagi_light_sample *sample, sag_ray *ray,
                              const sag_hit *hit, uint32_t *medium) {
    if (hit->geometry == SAG_INVALID_ID) return SAGI_COURSE_AWAY;
    sag_surface surface;
    const sagi_appearance *appearance = sagi_see(render, ray, hit, &surface);
    const presence found = presence_at(render->world, appearance, &surface, ray);
    if (found == SURFACE) return SAGI_COURSE_MEETING;
    pass(render, found, appearance, &surface, ray->direction, medium);
    sagi_shadow_ray(&surface, sample, ray);
    return SAGI_COURSE_ON;
}
