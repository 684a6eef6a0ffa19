// SPDX-License-Identifier: MIT
// The sphere: everything but the solver (sphere_solve.c). Clipping in z and the sweep are decided on the
// polished crossing, so a clipped sphere costs a whole one nothing.
//
// The position of a hit is computed from the ray in double-double, then scaled to the radius: l' = l r/|l|
// has a relative error below 8u in each coordinate, the sum with the centre one rounding more. position_error
// is taken as 32u |l'| + 2u |p|: along the normal that is at least 32u r (Σ nᵢ² = 1), more than the 8u r
// within which the filter of the solver cannot tell on which side of the sphere a point is; so a spawned ray
// is rejected at once.
#include "shapes/sphere.h"
#include "math/elementary.h"
#include "shapes/quadric_solve.h"
#include "shapes/sweep.h"

static bool is_clipped(const sag_sphere *s) { return s->z_min != 0 || s->z_max != 0; }
static double bottom(const sag_sphere *s) {
    return is_clipped(s) && s->z_min > -s->radius ? s->z_min : -s->radius;
}
static double top(const sag_sphere *s) {
    return is_clipped(s) && s->z_max < s->radius ? s->z_max : s->radius;
}

bool sagi_sphere_is_whole(const sag_sphere *s) {
    return !is_clipped(s) && sagi_sweep_is_full(s->phi_max_rad);
}

static bool is_usable(const sag_sphere *s) { return sag_sphere_validate(s, NULL) == SAG_OK; }

sag_status sag_sphere_validate(const sag_sphere *s, sag_error *error) {
    sag_status status = sagi_check_point(error, "sphere", "center", s->center);
    if (status == SAG_OK) status = sagi_check_positive(error, "sphere", "radius", s->radius);
    if (status == SAG_OK) status = sagi_sweep_validate(error, "sphere", s->phi_max_rad);
    if (status != SAG_OK || !is_clipped(s)) return status;
    status = sagi_check_interval(error, "sphere", s->z_min, s->z_max);
    if (status != SAG_OK) return status;
    if (!(s->z_min < s->radius))
        return sagi_invalid(error, "sphere", "z_min", s->z_min, "leaves nothing: it must be below radius");
    if (!(s->z_max > -s->radius))
        return sagi_invalid(error, "sphere", "z_max", s->z_max, "leaves nothing: it must be above -radius");
    return SAG_OK;
}

sag_box3 sagi_sphere_bounds(sag_vec3 c, double r) {
    sag_box3 box = {{c.x - r, c.y - r, c.z - r}, {c.x + r, c.y + r, c.z + r}};
    return sagi_box3_round_out(box, 1);
}

sag_box3 sag_sphere_bounds(const sag_sphere *sphere) {
    if (!is_usable(sphere)) return sag_box3_empty();
    sag_box3 box = sagi_sweep_bounds(sphere->phi_max_rad, sphere->radius, bottom(sphere), top(sphere));
    box = sagi_box3_round_out(box, 4);
    box.min = sag_add(box.min, sphere->center), box.max = sag_add(box.max, sphere->center);
    return sagi_box3_round_out(box, 1);
}

static bool holds(const sag_sphere *sphere, const sag_ray *ray, double t) {
    if (is_clipped(sphere)) { // a bound beyond the radius cuts nothing, not even a pole rounded outward
        double z = sagi_ray_coordinate(ray->origin.z, sphere->center.z, t, ray->direction.z).hi;
        if (sphere->z_min > -sphere->radius && !(z >= sphere->z_min)) return false;
        if (sphere->z_max < sphere->radius && !(z <= sphere->z_max)) return false;
    }
    return sagi_sweep_holds(sphere->phi_max_rad, sphere->center, ray, t);
}

static void collect(const sag_sphere *sphere, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(sphere)) return;
    double t[2];
    int count = sagi_sphere_crossings(sphere->center, sphere->radius, ray, t);
    for (int i = 0; i < count; i++)
        if (holds(sphere, ray, t[i])) sagi_crossings_add(list, t[i], 0, 0, 0);
}

bool sag_sphere_hit(const sag_sphere *sphere, const sag_ray *ray, sag_hit *hit) {
    if (!sagi_sphere_is_whole(sphere)) {
        sagi_crossings list;
        collect(sphere, ray, &list);
        return sagi_crossings_first(&list, hit);
    }
    double t;
    if (!sag_ray_is_valid(ray) || !is_usable(sphere)) return false;
    if (!sagi_sphere_hit(sphere->center, sphere->radius, ray, &t)) return false;
    *hit = sagi_hit_make(t, 0, 0, 0);
    return true;
}

bool sag_sphere_occluded(const sag_sphere *sphere, const sag_ray *ray) {
    sag_hit hit;
    return sag_sphere_hit(sphere, ray, &hit);
}

size_t sag_sphere_crossings(const sag_sphere *sphere, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list;
    collect(sphere, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

// Position, its error and the normal of center + offset, the offset being on the sphere to 8u.
static void place(sag_vec3 center, double radius, sag_vec3 offset, sag_surface *surface) {
    surface->position = sag_add(center, offset);
    surface->position_error = sag_add(sag_scale(sag_abs(offset), 32 * SAGI_EPSILON),
                                      sag_scale(sag_abs(surface->position), 2 * SAGI_EPSILON));
    surface->geometric_normal = sag_normalize(sag_scale(offset, 1 / radius));
}

static sag_vec3 on_sphere(double radius, sag_vec3 direction) {
    return sag_scale(sag_normalize(direction), radius);
}

static sag_vec3 offset_at(sag_vec3 c, double radius, const sag_ray *ray, double t) {
    sag_vec3 o = ray->origin, d = ray->direction;
    return on_sphere(radius, sag_vec3_make(sagi_ray_coordinate(o.x, c.x, t, d.x).hi,
                                           sagi_ray_coordinate(o.y, c.y, t, d.y).hi,
                                           sagi_ray_coordinate(o.z, c.z, t, d.z).hi));
}

void sagi_sphere_place(sag_vec3 center, double radius, const sag_ray *ray, double t, sag_surface *surface) {
    place(center, radius, offset_at(center, radius, ray, t), surface);
}

// u is the longitude about y from −z, v the latitude: l = r (cos β sin α, sin β, cos β cos α).
void sagi_sphere_texture(sag_vec3 l, sag_surface *surface) {
    double h = sagi_hypot(l.x, l.z);
    surface->u = (sagi_atan2(l.x, l.z) + SAGI_PI) / SAGI_TWO_PI;
    surface->v = (sagi_atan2(l.y, h) + SAGI_PI / 2) / SAGI_PI;
    surface->dpdu = sag_vec3_make(SAGI_TWO_PI * l.z, 0, -SAGI_TWO_PI * l.x);
    surface->dpdv = sag_scale(sag_vec3_make(-l.y * (l.x / h), h, -l.y * (l.z / h)), SAGI_PI);
}

// pbrt's: l = r (sin θ cos φ, sin θ sin φ, cos θ), θ from θ(z_min) to θ(z_max), so growing with z.
static void texture_of_sweep(const sag_sphere *s, sag_vec3 l, sag_surface *surface) {
    double r = s->radius, sweep = sagi_sweep_end(s->phi_max_rad);
    double theta0 = sagi_acos(bottom(s) / r), theta1 = sagi_acos(top(s) / r), rho = sagi_hypot(l.x, l.y);
    surface->u = sagi_sweep_angle(l.x, l.y) / sweep;
    surface->v = (sagi_atan2(rho, l.z) - theta0) / (theta1 - theta0);
    surface->dpdu = sag_vec3_make(-sweep * l.y, sweep * l.x, 0);
    surface->dpdv = sag_scale(sag_vec3_make(l.z * (l.x / rho), l.z * (l.y / rho), -rho), theta1 - theta0);
}

static void texture(const sag_sphere *s, sag_vec3 offset, sag_surface *surface) {
    if (s->phi_max_rad > 0)
        texture_of_sweep(s, offset, surface);
    else
        sagi_sphere_texture(offset, surface);
}

void sag_sphere_surface(const sag_sphere *sphere, const sag_ray *ray, const sag_hit *hit,
                        sag_surface *surface) {
    sag_vec3 offset = offset_at(sphere->center, sphere->radius, ray, hit->t);
    place(sphere->center, sphere->radius, offset, surface);
    texture(sphere, offset, surface);
    sagi_surface_finish(surface, ray, hit);
}

// Archimedes: a zone's area is that of the cylinder around it.
double sag_sphere_area(const sag_sphere *sphere) {
    if (!is_usable(sphere)) return 0;
    return sagi_sweep_end(sphere->phi_max_rad) * sphere->radius * (top(sphere) - bottom(sphere));
}

sag_vec3 sagi_sphere_sample(sag_vec3 center, double radius, double z_min, double z_max, double phi_max,
                            sag_vec2 random, sag_surface *surface) {
    double z = z_min + random.x * (z_max - z_min), phi = random.y * phi_max;
    double rho = sqrt(fmax(0, (radius - z) * (radius + z)));
    sag_vec3 offset = {rho * sagi_cos(phi), rho * sagi_sin(phi), z};
    place(center, radius, offset, surface);
    return offset;
}

bool sag_sphere_sample(const sag_sphere *sphere, sag_vec2 random, sag_surface *surface) {
    double area = sag_sphere_area(sphere);
    if (!(area > 0 && isfinite(area))) return false;
    sag_vec3 offset = sagi_sphere_sample(sphere->center, sphere->radius, bottom(sphere), top(sphere),
                                         sagi_sweep_end(sphere->phi_max_rad), random, surface);
    texture(sphere, offset, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

bool sag_sphere_contains(const sag_sphere *sphere, sag_vec3 point) {
    return is_usable(sphere) && sagi_sphere_contains(sphere->center, sphere->radius, point);
}

double sag_sphere_volume(const sag_sphere *sphere) {
    if (!is_usable(sphere)) return 0;
    return SAGI_PI * 4 / 3 * sphere->radius * sphere->radius * sphere->radius;
}

sag_vec3 sagi_sphere_closest_point(sag_vec3 center, double radius, sag_vec3 point) {
    sag_vec3 away = sag_sub(point, center);
    if (away.x == 0 && away.y == 0 && away.z == 0) away.x = 1;
    return sag_add(center, on_sphere(radius, away));
}

sag_vec3 sag_sphere_closest_point(const sag_sphere *sphere, sag_vec3 point) {
    return sagi_sphere_closest_point(sphere->center, sphere->radius, point);
}
