// SPDX-License-Identifier: MIT
// The disk or ring: where the ray cuts its plane (cut.c), and whether the distance ρ from the center is in
// [inner_radius, radius].
//
// With N = (c − o)·n, D = d·n the point is p = o + (N/D) d, so ρ² ≤ r² ⇔ |D (o − c) + N d|² ≤ r² D²: decided
// to 400 bits where the double p, which is within `werr` of the truth coordinate by coordinate, cannot tell.
// The sector is decided on the rounded point.
#include "math/elementary.h"
#include "shapes/cut.h"
#include "shapes/validate.h"

// In-plane frame: x where φ = 0, y counter-clockwise of it, z the normal; units.
typedef struct frame {
    sag_vec3 x, y, z;
} frame;

static double phi_max(const sag_disk *disk) {
    return disk->phi_max_rad == 0 ? 2 * SAGI_PI : disk->phi_max_rad;
}

static bool has_axis(const sag_disk *disk) { return !sagi_is_zero3(disk->x_axis); }

static bool is_axis_parallel(const sag_disk *disk) {
    return sagi_is_zero3(sag_cross(sag_normalize(disk->x_axis), sag_normalize(disk->normal)));
}

static bool is_valid(const sag_disk *disk) {
    return disk->radius > 0 && disk->inner_radius >= 0 && disk->inner_radius < disk->radius &&
           disk->phi_max_rad >= 0 && disk->phi_max_rad <= 2 * SAGI_PI && sagi_is_coordinate(disk->radius) &&
           sagi_is_coordinate3(disk->center) && sagi_is_coordinate3(disk->normal) &&
           sagi_is_coordinate3(disk->x_axis) && !(has_axis(disk) && is_axis_parallel(disk));
}

static frame frame_of(const sag_disk *disk) {
    frame f = {.z = sag_normalize(disk->normal)};
    sag_frame(f.z, &f.x, &f.y);
    sag_vec3 y = sag_cross(f.z, sag_normalize(disk->x_axis));
    if (!(sag_dot(y, y) > 0)) return f;
    f.y = sag_normalize(y);
    f.x = sag_cross(f.y, f.z);
    return f;
}

// The angle in [0, 2π) of an in-plane vector.
static double angle_of(const frame *f, sag_vec3 w) {
    double phi = sagi_atan2(sag_dot(w, f->y), sag_dot(w, f->x));
    return phi < 0 ? phi + 2 * SAGI_PI : phi;
}

// The sign of ρ − r at the ray's cut with the plane, to 400 bits.
static int compare_radius_real(const sag_disk *disk, const sag_ray *ray, double r) {
    sag_vec3 n = sag_scale(disk->normal, sagi_power_scale(disk->normal));
    sag_vec3 d = sag_scale(ray->direction, sagi_power_scale(ray->direction));
    sagi_dd3 w = sagi_dd3_from_diff(disk->center, ray->origin);
    sagi_real num = sagi_dot_real(w, sagi_dd3_from(n));
    sagi_real den = sagi_dot_real(sagi_dd3_from(d), sagi_dd3_from(n)), sum = {0};
    for (int axis = 0; axis < 3; axis++) {
        sagi_real wi =
            sagi_real_from_diff(sag_component(disk->center, axis), sag_component(ray->origin, axis));
        sagi_real q = sagi_real_sub(sagi_real_scale(num, sag_component(d, axis)), sagi_real_mul(wi, den));
        sum = sagi_real_add(sum, sagi_real_mul(q, q));
    }
    sagi_real rd = sagi_real_scale(den, r);
    return sagi_real_compare(sum, sagi_real_mul(rd, rd));
}

static int compare_radius(const sag_disk *disk, const sag_ray *ray, sag_vec3 w, double w_error, double r) {
    double rho2 = sag_dot(w, w), r2 = r * r;
    // ρ² and r² are off by at most 3u and u, w's error counts 2|w| + itself.
    double error = 8 * SAGI_EPSILON * (rho2 + r2) + w_error * (4 * sag_max_component(sag_abs(w)) + w_error);
    if (rho2 - r2 > error) return 1;
    if (r2 - rho2 > error) return -1;
    return compare_radius_real(disk, ray, r);
}

static double w_coordinate(double o, double c, double d, sagi_cut cut, double *error) {
    sagi_dd from = sagi_two_sum(o, -c), step = sagi_dd_mul_double(cut.t, d);
    sagi_dd w = sagi_dd_add(from, step);
    *error += SAGI_EPSILON * fabs(w.hi) + 0x1p-101 * (fabs(from.hi) + fabs(step.hi)) + fabs(d) * cut.error;
    return w.hi;
}

static bool find(const sag_disk *disk, const sag_ray *ray, sagi_cut *cut) {
    if (!sag_ray_is_valid(ray) || !is_valid(disk)) return false;
    if (!sagi_cut_plane(disk->normal, disk->center, ray, cut)) return false;
    double error = 0;
    const sag_vec3 *o = &ray->origin, *c = &disk->center, *d = &ray->direction;
    sag_vec3 w = {w_coordinate(o->x, c->x, d->x, *cut, &error), w_coordinate(o->y, c->y, d->y, *cut, &error),
                  w_coordinate(o->z, c->z, d->z, *cut, &error)};
    if (compare_radius(disk, ray, w, error, disk->radius) > 0) return false;
    if (disk->inner_radius > 0 && compare_radius(disk, ray, w, error, disk->inner_radius) < 0) return false;
    if (phi_max(disk) >= 2 * SAGI_PI) return true;
    frame f = frame_of(disk);
    return angle_of(&f, w) <= disk->phi_max_rad;
}

sag_status sag_disk_validate(const sag_disk *disk, sag_error *error) {
    sag_status status = sagi_check_point(error, "disk", "center", disk->center);
    if (status == SAG_OK) status = sagi_check_direction(error, "disk", "normal", disk->normal);
    if (status == SAG_OK) status = sagi_check_positive(error, "disk", "radius", disk->radius);
    if (status == SAG_OK) status = sagi_check_point(error, "disk", "x_axis", disk->x_axis);
    if (status != SAG_OK) return status;
    if (!(disk->inner_radius >= 0 && disk->inner_radius < disk->radius))
        return sagi_invalid(error, "disk", "inner_radius", disk->inner_radius, "must be in [0, radius)");
    if (!(disk->phi_max_rad >= 0 && disk->phi_max_rad <= 2 * SAGI_PI))
        return sagi_invalid(error, "disk", "phi_max_rad", disk->phi_max_rad, "must be in [0, 2 pi]");
    if (has_axis(disk) && is_axis_parallel(disk))
        return sagi_invalid3(error, "disk", "x_axis", disk->x_axis, "must not be parallel to the normal");
    return SAG_OK;
}

sag_box3 sag_disk_bounds(const sag_disk *disk) {
    if (sag_disk_validate(disk, NULL) != SAG_OK) return sag_box3_empty();
    // Along axis i the circle reaches r √(1 − nᵢ²) from the center.
    sag_vec3 n = sag_normalize(disk->normal);
    double r = disk->radius * (1 + 16 * SAGI_EPSILON);
    sag_vec3 e = {r * sagi_hypot(n.y, n.z), r * sagi_hypot(n.z, n.x), r * sagi_hypot(n.x, n.y)};
    return sagi_box3_round_out((sag_box3){sag_sub(disk->center, e), sag_add(disk->center, e)}, 2);
}

bool sag_disk_hit(const sag_disk *disk, const sag_ray *ray, sag_hit *hit) {
    sagi_cut cut;
    if (!find(disk, ray, &cut)) return false;
    *hit = sagi_hit_make(cut.t.hi, 0, 0, 0);
    return true;
}

bool sag_disk_occluded(const sag_disk *disk, const sag_ray *ray) {
    sagi_cut cut;
    return find(disk, ray, &cut);
}

size_t sag_disk_crossings(const sag_disk *disk, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sag_hit hit;
    if (!sag_disk_hit(disk, ray, &hit)) return 0;
    if (capacity > 0) hits[0] = hit;
    return 1;
}

// Texture coordinates and derivatives at `surface->position`.
static void finish(const sag_disk *disk, sag_surface *surface) {
    frame f = frame_of(disk);
    double width = disk->radius - disk->inner_radius, sweep = phi_max(disk);
    sag_vec3 w = sag_sub(surface->position, disk->center);
    double rho = sag_length(w);
    sagi_clear_plane(disk->center, surface);
    surface->geometric_normal = f.z;
    surface->u = fmin(angle_of(&f, w) / sweep, 1);
    surface->v = fmax(0, fmin((disk->radius - rho) / width, 1));
    surface->dpdu = sag_scale(sag_cross(f.z, w), sweep);
    surface->dpdv = rho > 0 ? sag_scale(w, -width / rho) : (sag_vec3){0, 0, 0};
}

void sag_disk_surface(const sag_disk *disk, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    sagi_cut cut;
    if (!sagi_cut_plane(disk->normal, disk->center, ray, &cut))
        cut = (sagi_cut){{hit->t, 0}, 2 * SAGI_EPSILON * fabs(hit->t)};
    sagi_point_at(ray, cut, &surface->position, &surface->position_error);
    finish(disk, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_disk_area(const sag_disk *disk) {
    if (!is_valid(disk)) return 0;
    return phi_max(disk) / 2 * (disk->radius - disk->inner_radius) * (disk->radius + disk->inner_radius);
}

bool sag_disk_sample(const sag_disk *disk, sag_vec2 random, sag_surface *surface) {
    if (sag_disk_validate(disk, NULL) != SAG_OK) return false;
    // Equal areas lie between equal steps of ρ².
    frame f = frame_of(disk);
    double r2 = disk->inner_radius * disk->inner_radius;
    double rho = sqrt(r2 + random.x * (disk->radius * disk->radius - r2)), phi = random.y * phi_max(disk);
    sag_vec3 w = sag_add(sag_scale(f.x, rho * sagi_cos(phi)), sag_scale(f.y, rho * sagi_sin(phi)));
    surface->position = sag_add(disk->center, w);
    sag_vec3 size = sag_abs(disk->center);
    surface->position_error =
        sag_scale((sag_vec3){size.x + rho, size.y + rho, size.z + rho}, 8 * SAGI_EPSILON);
    finish(disk, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

// The point of the radial segment at angle φ nearest to the in-plane vector (x, y).
static sag_vec2 nearest_on_radius(const sag_disk *disk, double phi, double x, double y) {
    double c = sagi_cos(phi), s = sagi_sin(phi);
    double along = fmax(disk->inner_radius, fmin(x * c + y * s, disk->radius));
    return (sag_vec2){along * c, along * s};
}

sag_vec3 sag_disk_closest_point(const sag_disk *disk, sag_vec3 point) {
    frame f = frame_of(disk);
    sag_vec3 w = sag_sub(point, disk->center);
    double x = sag_dot(w, f.x), y = sag_dot(w, f.y), rho = sagi_hypot(x, y);
    double sweep = phi_max(disk), phi = rho > 0 ? angle_of(&f, w) : 0;
    sag_vec2 q;
    if (phi <= sweep) { // radially to the ring
        double r = fmax(disk->inner_radius, fmin(rho, disk->radius));
        q = rho > 0 ? (sag_vec2){x * (r / rho), y * (r / rho)} : (sag_vec2){r, 0};
    } else { // to the nearer of the sector's straight edges
        sag_vec2 a = nearest_on_radius(disk, 0, x, y), b = nearest_on_radius(disk, sweep, x, y);
        q = sagi_hypot(x - a.x, y - a.y) <= sagi_hypot(x - b.x, y - b.y) ? a : b;
    }
    return sag_add(disk->center, sag_add(sag_scale(f.x, q.x), sag_scale(f.y, q.y)));
}
