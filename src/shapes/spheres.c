// SPDX-License-Identifier: MIT
// Many spheres in one geometry. The verbs here visit each; a scene asks them one by one (spheres.h). Hits of
// equal t are in order of the sphere's number.
#include "shapes/spheres.h"
#include "shapes/sweep.h"

static bool is_usable(const sag_spheres *s) { return s->count > 0 && !s->centers_f32 != !s->centers_f64; }

sag_status sag_spheres_validate(const sag_spheres *s, sag_error *error) {
    if (s->count == 0) return sag_error_set(error, SAG_ERROR_GEOMETRY, "spheres: count 0 must be positive");
    if (!is_usable(s))
        return sag_error_set(error, SAG_ERROR_GEOMETRY,
                             "spheres: exactly one of centers_f32 and centers_f64 must "
                             "be given, not %s",
                             s->centers_f32 ? "both" : "neither");
    return s->radii_f32 ? SAG_OK : sagi_check_positive(error, "spheres", "radius", s->radius);
}

sag_box3 sag_spheres_bounds(const sag_spheres *s) {
    sag_box3 box = sag_box3_empty();
    sag_vec3 center;
    double radius;
    for (uint32_t i = 0; is_usable(s) && i < s->count; i++)
        if (sagi_spheres_get(s, i, &center, &radius))
            box = sag_box3_union(box, sagi_sphere_bounds(center, radius));
    return box;
}

bool sag_spheres_hit(const sag_spheres *s, const sag_ray *ray, sag_hit *hit) {
    if (!is_usable(s) || !sag_ray_is_valid(ray)) return false;
    sag_ray rest = *ray;
    sag_vec3 center;
    double radius, t;
    bool found = false;
    for (uint32_t i = 0; i < s->count; i++) {
        if (!sagi_spheres_get(s, i, &center, &radius)) continue;
        if (!sagi_sphere_hit(center, radius, &rest, &t) || (found && !(t < rest.t_max))) continue;
        *hit = sagi_hit_make(t, 0, 0, i);
        rest.t_max = t;
        found = true;
    }
    return found;
}

bool sag_spheres_occluded(const sag_spheres *s, const sag_ray *ray) {
    if (!is_usable(s) || !sag_ray_is_valid(ray)) return false;
    sag_vec3 center;
    double radius, t;
    for (uint32_t i = 0; i < s->count; i++)
        if (sagi_spheres_get(s, i, &center, &radius) && sagi_sphere_hit(center, radius, ray, &t)) return true;
    return false;
}

// Insertion into the sorted front of the list, as long as it has room.
size_t sag_spheres_crossings(const sag_spheres *s, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    if (!is_usable(s) || !sag_ray_is_valid(ray)) return 0;
    size_t count = 0, kept = 0;
    sag_vec3 center;
    double radius, t[2];
    for (uint32_t i = 0; i < s->count; i++) {
        if (!sagi_spheres_get(s, i, &center, &radius)) continue;
        int found = sagi_sphere_crossings(center, radius, ray, t);
        for (int k = 0; k < found; k++) {
            count++;
            if (kept == capacity && (kept == 0 || !(t[k] < hits[kept - 1].t))) continue;
            size_t at = kept < capacity ? kept++ : kept - 1;
            for (; at > 0 && hits[at - 1].t > t[k]; at--) hits[at] = hits[at - 1];
            hits[at] = sagi_hit_make(t[k], 0, 0, i);
        }
    }
    return count;
}

void sag_spheres_surface(const sag_spheres *s, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    sag_vec3 center = {0, 0, 0};
    double radius = 0;
    if (is_usable(s) && hit->primitive < s->count) sagi_spheres_get(s, hit->primitive, &center, &radius);
    sagi_sphere_place(center, radius, ray, hit->t, surface);
    sagi_sphere_texture(sag_scale(surface->geometric_normal, radius), surface);
    sagi_surface_finish(surface, ray, hit);
}

static double area_of(double radius) { return 4 * SAGI_PI * radius * radius; }

double sag_spheres_area(const sag_spheres *s) {
    double area = 0, radius;
    sag_vec3 center;
    for (uint32_t i = 0; is_usable(s) && i < s->count; i++)
        if (sagi_spheres_get(s, i, &center, &radius)) area += area_of(radius);
    return area;
}

bool sag_spheres_sample(const sag_spheres *s, sag_vec2 random, sag_surface *surface) {
    double left = random.x * sag_spheres_area(s), radius = 0, last_radius = 0;
    sag_vec3 center, last_center = {0, 0, 0};
    uint32_t last = 0;
    bool found = false;
    for (uint32_t i = 0; is_usable(s) && i < s->count && !found; i++) {
        if (!sagi_spheres_get(s, i, &center, &radius)) continue;
        last = i, last_radius = radius, last_center = center;
        found = left < area_of(radius);
        if (!found) left -= area_of(radius);
    }
    if (!(last_radius > 0)) return false;
    // What is left of the number within this sphere's share is uniform again.
    random.x = fmin(left / area_of(last_radius), 1 - SAGI_EPSILON);
    sag_vec3 offset =
        sagi_sphere_sample(last_center, last_radius, -last_radius, last_radius, SAGI_TWO_PI, random, surface);
    sagi_sphere_texture(offset, surface);
    sagi_surface_finish_sample(surface, last);
    return true;
}

bool sag_spheres_contains(const sag_spheres *s, sag_vec3 point) {
    sag_vec3 center;
    double radius;
    for (uint32_t i = 0; is_usable(s) && i < s->count; i++)
        if (sagi_spheres_get(s, i, &center, &radius) && sagi_sphere_contains(center, radius, point))
            return true;
    return false;
}

sag_vec3 sag_spheres_closest_point(const sag_spheres *s, sag_vec3 point) {
    sag_vec3 center, best = {NAN, NAN, NAN};
    double radius, least = INFINITY;
    for (uint32_t i = 0; is_usable(s) && i < s->count; i++) {
        if (!sagi_spheres_get(s, i, &center, &radius)) continue;
        double distance = fabs(sag_length(sag_sub(point, center)) - radius);
        if (!(distance < least)) continue;
        least = distance;
        best = sagi_sphere_closest_point(center, radius, point);
    }
    return best;
}
