// SPDX-License-Identifier: MIT
// The shape of the caller's own. Used alone it asks the callback for all primitives, in batches on the stack;
// a scene asks for those of one leaf at a time. Either way what comes back passes through
// sag_user_report_hit, which drops what is out of range or NaN and orders equal t by primitive, so that the
// answer does not depend on the order of the reports.
#include "shapes/user.h"
#include "shapes/common.h"

#define BATCH 64

static bool is_usable(const sag_box3 *box) {
    return sag_is_finite(box->min) && sag_is_finite(box->max) && !sag_box3_is_empty(box);
}

double sag_user_report_hit(sag_user_report *report, uint32_t primitive, double t, double u, double v) {
    if (t >= report->t_min && t <= report->t_max && isfinite(t))
        report->t_max = report->take(report->sink, primitive, t, u, v);
    return report->t_max;
}

sag_status sag_user_validate(const sag_user *user, sag_error *error) {
    const char *missing = user->primitive_count == 0 ? "primitive_count 0 must be positive"
                          : user->bounds == NULL     ? "bounds is NULL"
                          : user->crossings == NULL  ? "crossings is NULL"
                          : user->surface == NULL    ? "surface is NULL"
                                                     : NULL;
    return missing == NULL ? SAG_OK : sag_error_set(error, SAG_ERROR_GEOMETRY, "user: %s", missing);
}

sag_box3 sag_user_bounds(const sag_user *user) {
    sag_box3 all = sag_box3_empty();
    if (sag_user_validate(user, NULL) != SAG_OK) return all;
    for (uint32_t i = 0; i < user->primitive_count; i++) {
        sag_box3 box = user->bounds(user->user, i);
        if (is_usable(&box)) all = sag_box3_union(all, box);
    }
    return all;
}

// Asks for every primitive that has a box.
static void ask(const sag_user *user, const sag_ray *ray, sag_user_report *report) {
    if (!sag_ray_is_valid(ray) || sag_user_validate(user, NULL) != SAG_OK) return;
    uint32_t batch[BATCH];
    size_t count = 0;
    for (uint32_t i = 0; i < user->primitive_count && report->t_max >= report->t_min; i++) {
        sag_box3 box = user->bounds(user->user, i);
        if (is_usable(&box)) batch[count++] = i;
        if (count < BATCH && i + 1 < user->primitive_count) continue;
        if (count > 0) user->crossings(user->user, batch, count, ray, report);
        count = 0;
    }
}

// The first `capacity` hits in order of (t, primitive), and how many there were.
typedef struct hit_list {
    sag_hit *hits;
    size_t capacity, count;
    double t_max; // handed back as it is
} hit_list;

static double take(void *sink, uint32_t primitive, double t, double u, double v) {
    hit_list *list = sink;
    size_t i = list->count < list->capacity ? list->count : list->capacity;
    list->count++;
    for (; i > 0; i--) {
        const sag_hit *before = &list->hits[i - 1];
        if (before->t < t || (before->t == t && before->primitive <= primitive)) break;
        if (i < list->capacity) list->hits[i] = *before;
    }
    if (i < list->capacity) list->hits[i] = sagi_hit_make(t, u, v, primitive);
    return list->t_max;
}

// A closer one shortens what is of interest; one at the same t may still win by its number.
static double take_closest(void *sink, uint32_t primitive, double t, double u, double v) {
    take(sink, primitive, t, u, v);
    return ((hit_list *)sink)->hits[0].t;
}

static double take_any(void *sink, uint32_t primitive, double t, double u, double v) {
    take(sink, primitive, t, u, v);
    return -INFINITY;
}

bool sag_user_hit(const sag_user *user, const sag_ray *ray, sag_hit *hit) {
    sag_hit best;
    hit_list list = {&best, 1, 0, ray->t_max};
    sag_user_report report = {ray->t_min, ray->t_max, take_closest, &list};
    ask(user, ray, &report);
    if (list.count > 0) *hit = best;
    return list.count > 0;
}

bool sag_user_occluded(const sag_user *user, const sag_ray *ray) {
    hit_list list = {NULL, 0, 0, ray->t_max};
    sag_user_report report = {ray->t_min, ray->t_max, take_any, &list};
    ask(user, ray, &report);
    return list.count > 0;
}

size_t sag_user_crossings(const sag_user *user, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    hit_list list = {hits, capacity, 0, ray->t_max};
    sag_user_report report = {ray->t_min, ray->t_max, take, &list};
    ask(user, ray, &report);
    return list.count;
}

void sag_user_surface(const sag_user *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    *surface = (sag_surface){0};
    user->surface(user->user, ray, hit, surface);
    sag_vec3 e = surface->position_error, shading = surface->shading_normal;
    if (!(e.x > 0 || e.y > 0 || e.z > 0)) {
        double error = 0x1p-48 * sag_max_component(sag_abs(surface->position));
        surface->position_error = (sag_vec3){error, error, error};
    }
    surface->geometric_normal = sag_normalize(surface->geometric_normal);
    sagi_surface_finish(surface, ray, hit);
    if (sag_dot(shading, shading) > 0) surface->shading_normal = sag_normalize(shading);
}

double sag_user_area(const sag_user *user) {
    (void)user; // the callbacks do not tell
    return 0;
}

bool sag_user_sample(const sag_user *user, sag_vec2 random, sag_surface *surface) {
    (void)user, (void)random, (void)surface;
    return false;
}
