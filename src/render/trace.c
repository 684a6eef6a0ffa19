// SPDX-License-Identifier: MIT
// Rays that pass what is not there: surfaces whose alpha is 0, and interfaces. A ray goes on from such a
// surface as any spawned ray does, so nothing is skipped and nothing is met twice. Scenes without them take
// the short way.
#include "job.h"

static bool is_there(const sag_world *world, const sagi_appearance *appearance, const sag_surface *surface) {
    if (!appearance) return true;
    const sag_input *alpha = &appearance->look.alpha;
    if (alpha->texture != 0 && !(sagi_input_evaluate(world, alpha, surface).r > 0)) return false;
    uint32_t id = appearance->look.material;
    if (id == 0) return true;
    const sagi_material *material = (const sagi_material *)world->materials.items + (id - 1);
    return material->material.kind != SAG_MATERIAL_INTERFACE;
}

sagi_course sagi_trace(const sag_render *render, sagi_path *path, sag_ray *ray, const sag_hit *hit,
                       sagi_meeting *meeting) {
    if (hit->geometry == SAG_INVALID_ID) return SAGI_COURSE_AWAY;
    sag_surface *surface = &meeting->surface;
    sag_surface_at(render->scene, ray, hit, surface);
    path->distance += hit->t;
    meeting->hit = hit;
    meeting->appearance = sagi_appearance_of(render->world, surface);
    if (!render->see_through || is_there(render->world, meeting->appearance, surface)) {
        sagi_orient(meeting->appearance, surface);
        sagi_material_evaluate(render->world, meeting->appearance, surface, sag_neg(ray->direction),
                               path->wavelengths.lambda, &meeting->bsdf);
        return SAGI_COURSE_MEETING;
    }
    if (++path->passed == SAGI_MAX_PASSED) return SAGI_COURSE_AWAY;
    uint32_t mask = ray->mask;
    *ray = sag_spawn_ray(surface, ray->direction);
    ray->mask = mask;
    return SAGI_COURSE_ON;
}

sag_ray sagi_shadow_ray(const sag_surface *from, const sagi_light_sample *sample) {
    sag_ray ray = {0};
    switch (sample->target) {
    case SAGI_TARGET_FAR: ray = sag_spawn_ray(from, sample->wi); break;
    case SAGI_TARGET_POINT: ray = sag_spawn_ray_to_point(from, sample->point); break;
    case SAGI_TARGET_SURFACE: ray = sag_spawn_ray_to_surface(from, &sample->surface); break;
    }
    ray.mask = SAG_RAY_SHADOW;
    return ray;
}

sagi_course sagi_trace_shadow(const sag_render *render, const sagi_light_sample *sample, sag_ray *ray,
                              const sag_hit *hit) {
    if (hit->geometry == SAG_INVALID_ID) return SAGI_COURSE_AWAY;
    sag_surface surface;
    sag_surface_at(render->scene, ray, hit, &surface);
    if (is_there(render->world, sagi_appearance_of(render->world, &surface), &surface))
        return SAGI_COURSE_MEETING;
    *ray = sagi_shadow_ray(&surface, sample);
    return SAGI_COURSE_ON;
}
