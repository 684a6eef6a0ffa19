// SPDX-License-Identifier: MIT
#include "shapes/common.h"

static bool comes_after(const sagi_crossing *c, double t, uint32_t primitive) {
    return c->t > t || (c->t == t && c->primitive > primitive);
}

void sagi_crossings_add(sagi_crossings *list, double t, double u, double v, uint32_t primitive) {
    if (isnan(t) || list->count == SAGI_MAX_CROSSINGS) return;
    int i = list->count++;
    for (; i > 0 && comes_after(&list->at[i - 1], t, primitive); i--) list->at[i] = list->at[i - 1];
    list->at[i] = (sagi_crossing){t, u, v, primitive};
}

sag_hit sagi_hit_make(double t, double u, double v, uint32_t primitive) {
    return (sag_hit){.t = t, .u = u, .v = v, .primitive = primitive, .geometry = SAG_INVALID_ID};
}

bool sagi_crossings_first(const sagi_crossings *list, sag_hit *hit) {
    if (list->count == 0) return false;
    const sagi_crossing *c = &list->at[0];
    *hit = sagi_hit_make(c->t, c->u, c->v, c->primitive);
    return true;
}

size_t sagi_crossings_write(const sagi_crossings *list, sag_hit *hits, size_t capacity) {
    for (int i = 0; i < list->count && (size_t)i < capacity; i++) {
        const sagi_crossing *c = &list->at[i];
        hits[i] = sagi_hit_make(c->t, c->u, c->v, c->primitive);
    }
    return (size_t)list->count;
}

void sagi_surface_finish_derivatives(sag_surface *surface) {
    sag_vec3 across = sag_cross(surface->dpdu, surface->dpdv);
    if (!(sag_dot(across, across) > 0) || !sag_is_finite(across))
        sag_frame(surface->geometric_normal, &surface->dpdu, &surface->dpdv);
}

static void finish(sag_surface *surface, uint32_t primitive) {
    surface->shading_normal = surface->geometric_normal;
    surface->primitive = primitive;
    surface->geometry = SAG_INVALID_ID;
    surface->user_data = 0;
    sagi_surface_finish_derivatives(surface);
}

void sagi_surface_finish(sag_surface *surface, const sag_ray *ray, const sag_hit *hit) {
    finish(surface, hit->primitive);
    surface->side = sag_dot(ray->direction, surface->geometric_normal) > 0 ? SAG_SIDE_BACK : SAG_SIDE_FRONT;
}

void sagi_surface_finish_sample(sag_surface *surface, uint32_t primitive) {
    finish(surface, primitive);
    surface->side = SAG_SIDE_FRONT;
}

sag_box3 sagi_box3_round_out(sag_box3 box, double ulps) {
    double e = ulps * 2 * SAGI_EPSILON;
    sag_vec3 lo = sag_abs(box.min), hi = sag_abs(box.max);
    return (sag_box3){
        .min = {sagi_next_down(box.min.x - e * lo.x), sagi_next_down(box.min.y - e * lo.y),
                sagi_next_down(box.min.z - e * lo.z)},
        .max = {sagi_next_up(box.max.x + e * hi.x), sagi_next_up(box.max.y + e * hi.y),
                sagi_next_up(box.max.z + e * hi.z)},
    };
}
