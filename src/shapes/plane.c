// SPDX-License-Identifier: MIT
// The plane: t = (point − o)·n / d·n (cut.c, which decides it exactly). Texture coordinates are the
// coordinates of p − point in the basis s, t through its dual basis s' = t×z/|z|², t' = z×s/|z|² with z =
// s×t: s'·s = 1, s'·t = 0, because (t×z)·s = z·(s×t) = |z|² and (t×z)·t = 0.
#include "shapes/cut.h"
#include "shapes/validate.h"

// The texture basis is none: parallel vectors, or only one of the two.
static bool is_flat(const sag_plane *plane) {
    if (sagi_is_zero3(plane->s) && sagi_is_zero3(plane->t)) return false;
    return sagi_is_zero3(sag_cross(plane->s, plane->t)) &&
           sagi_is_zero3(sag_cross(sag_normalize(plane->s), sag_normalize(plane->t)));
}

static bool is_usable(const sag_plane *plane) {
    return sagi_is_coordinate3(plane->point) && sagi_is_coordinate3(plane->normal) &&
           sagi_is_coordinate3(plane->s) && sagi_is_coordinate3(plane->t) && !is_flat(plane);
}

static bool find(const sag_plane *plane, const sag_ray *ray, sagi_cut *cut) {
    return sag_ray_is_valid(ray) && is_usable(plane) && sagi_cut_plane(plane->normal, plane->point, ray, cut);
}

sag_status sag_plane_validate(const sag_plane *plane, sag_error *error) {
    sag_status status = sagi_check_point(error, "plane", "point", plane->point);
    if (status == SAG_OK) status = sagi_check_direction(error, "plane", "normal", plane->normal);
    if (status == SAG_OK) status = sagi_check_point(error, "plane", "s", plane->s);
    if (status == SAG_OK) status = sagi_check_point(error, "plane", "t", plane->t);
    if (status == SAG_OK && is_flat(plane))
        return sagi_invalid3(error, "plane", "s", plane->s, "must not be parallel to t");
    return status;
}

sag_box3 sag_plane_bounds(const sag_plane *plane) {
    if (sag_plane_validate(plane, NULL) != SAG_OK) return sag_box3_empty();
    return (sag_box3){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
}

bool sag_plane_hit(const sag_plane *plane, const sag_ray *ray, sag_hit *hit) {
    sagi_cut cut;
    if (!find(plane, ray, &cut)) return false;
    *hit = sagi_hit_make(cut.t.hi, 0, 0, 0);
    return true;
}

bool sag_plane_occluded(const sag_plane *plane, const sag_ray *ray) {
    sagi_cut cut;
    return find(plane, ray, &cut);
}

size_t sag_plane_crossings(const sag_plane *plane, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sag_hit hit;
    if (!sag_plane_hit(plane, ray, &hit)) return 0;
    if (capacity > 0) hits[0] = hit;
    return 1;
}

void sag_plane_surface(const sag_plane *plane, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    sagi_cut cut;
    if (!sagi_cut_plane(plane->normal, plane->point, ray, &cut))
        cut = (sagi_cut){{hit->t, 0}, 2 * SAGI_EPSILON * fabs(hit->t)};
    sagi_point_at(ray, cut, &surface->position, &surface->position_error);
    sagi_clear_plane(plane->point, surface);
    surface->geometric_normal = sag_normalize(plane->normal);
    surface->dpdu = plane->s, surface->dpdv = plane->t;
    sag_vec3 z = sag_cross(plane->s, plane->t);
    if (!(sag_dot(z, z) > 0)) { // none given
        sag_frame(surface->geometric_normal, &surface->dpdu, &surface->dpdv);
        z = sag_cross(surface->dpdu, surface->dpdv);
    }
    sag_vec3 q = sag_sub(surface->position, plane->point);
    surface->u = sag_dot(q, sag_cross(surface->dpdv, z)) / sag_dot(z, z);
    surface->v = sag_dot(q, sag_cross(z, surface->dpdu)) / sag_dot(z, z);
    sagi_surface_finish(surface, ray, hit);
}

double sag_plane_area(const sag_plane *plane) {
    return sag_plane_validate(plane, NULL) == SAG_OK ? INFINITY : 0;
}

bool sag_plane_sample(const sag_plane *plane, sag_vec2 random, sag_surface *surface) {
    (void)plane, (void)random, (void)surface; // nothing is uniform on an infinite area
    return false;
}

bool sag_plane_contains(const sag_plane *plane, sag_vec3 point) {
    return sag_is_finite(point) && sag_plane_validate(plane, NULL) == SAG_OK &&
           sagi_plane_side(plane->normal, plane->point, point) <= 0;
}

double sag_plane_volume(const sag_plane *plane) { return sag_plane_area(plane); }

sag_vec3 sag_plane_closest_point(const sag_plane *plane, sag_vec3 point) {
    sag_vec3 n = sag_scale(plane->normal, sagi_power_scale(plane->normal));
    return sag_madd(point, -sagi_plane_offset(n, plane->point, point) / sag_dot(n, n), n);
}
