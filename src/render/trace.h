// SPDX-License-Identifier: MIT
// What a ray has met, in line for the loop over all paths.
#ifndef SAGI_RENDER_TRACE_H
#define SAGI_RENDER_TRACE_H

#include "job.h"

// The surface that a ray has hit, and its look.
static inline const sagi_appearance *sagi_see(const sag_render *render, const sag_ray *ray,
                                              const sag_hit *hit, sag_surface *surface) {
    sag_surface_at(render->scene, ray, hit, surface);
    const sagi_appearance *appearance = sagi_appearance_of(render->world, surface);
    sagi_replace_texcoords(appearance, surface);
    return appearance;
}

// What a path's ray comes to at its hit (geometry SAG_INVALID_ID: none); fills *meeting or moves *ray on.
static inline sagi_course sagi_trace(const sag_render *render, sagi_path *path, sag_ray *ray,
                                     const sag_hit *hit, sagi_meeting *meeting) {
    if (hit->geometry == SAG_INVALID_ID) return SAGI_COURSE_AWAY;
    meeting->appearance = sagi_see(render, ray, hit, &meeting->surface);
    meeting->hit = hit;
    path->distance += hit->t;
    if (render->see_through) {
        const sagi_course course = sagi_trace_through(render, path, ray, meeting);
        if (course != SAGI_COURSE_MEETING) return course;
    }
    sagi_orient(meeting->appearance, &meeting->surface);
    const sagi_origin origin = {render->scene, ray, hit,
                                meeting->appearance && meeting->appearance->smooth_mesh};
    sagi_material_evaluate(render->world, meeting->appearance, &meeting->surface, &origin, &render->footprint,
                           sag_neg(ray->direction), path->wavelengths.lambda, &meeting->bsdf);
    return SAGI_COURSE_MEETING;
}

#endif
