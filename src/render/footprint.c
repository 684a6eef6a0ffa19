// SPDX-License-Identifier: MIT
// The footprint of a pixel on any surface, of any bounce, without following what happens to rays (pbrt-v4's
// Camera::Approximate_dp_dxy; PBR 4th ed., §10.1.3): every point is taken for one that the camera sees
// directly, in a pixel where rays are as close together as they are anywhere in the picture. That is exact
// for what a camera with equal pixels sees, and for what lies behind bounces it is a guess on the sharp side,
// which costs some noise and never blurs. It needs a handful of products, no state in the path, and is taken
// only where a texture asks for it.
//
// With the ray to the point p as the z axis and n the normal there, the next pixel's ray o + t d,
// d = z + δd, meets the tangent plane n·(x − p) = 0 at t = n·(p − o)/n·d. An orthographic camera's rays all
// go along its own z axis (pbrt turns the frame towards the point there too, and blurs what is off the
// middle).
#include "footprint.h"

#include "math/map.h"

// How many points of the picture's diagonal the smallest changes are sought at.
#define PROBES 512

static sag_vec3 shorter(sag_vec3 a, sag_vec3 b) { return sag_dot(b, b) < sag_dot(a, a) ? b : a; }

// The direction b in the frame of the unit direction a, less a itself (0, 0, 1).
static sag_vec3 turned(sag_vec3 a, sag_vec3 b) {
    sag_vec3 s, t;
    sagi_frame(a, &s, &t);
    return sag_vec3_make(sag_dot(b, s), sag_dot(b, t), sag_dot(b, a) - 1);
}

static sag_vec3 direction_of(const sagi_footprint *f, const sag_ray *ray) {
    return sagi_normalize(sagi_affine_vector(&f->from_world, ray->direction));
}

static sag_vec3 origin_change(const sagi_footprint *f, const sag_ray *ray, const sag_ray *next) {
    return sagi_affine_vector(&f->from_world, sag_sub(next->origin, ray->origin));
}

void sagi_footprint_init(sagi_footprint *footprint, const sagi_camera *camera, uint32_t samples_per_pixel) {
    const sag_vec3 far_away = {INFINITY, INFINITY, INFINITY};
    *footprint = (sagi_footprint){.to_world = camera->camera.to_world,
                                  .origin_x = far_away,
                                  .origin_y = far_away,
                                  .direction_x = far_away,
                                  .direction_y = far_away};
    sagi_footprint *f = footprint;
    f->known = sag_affine_inverse(&f->to_world, &f->from_world);
    if (!f->known) return;
    const sag_vec2 middle = {0.5, 0.5};
    for (int i = 0; i < PROBES; i++) {
        const double x = i * camera->width / (PROBES - 1), y = i * camera->height / (PROBES - 1);
        const sag_ray ray = sagi_camera_ray(camera, x, y, middle);
        const sag_ray right = sagi_camera_ray(camera, x + 1, y, middle);
        const sag_ray below = sagi_camera_ray(camera, x, y + 1, middle);
        const sag_vec3 d = direction_of(f, &ray);
        f->origin_x = shorter(f->origin_x, origin_change(f, &ray, &right));
        f->origin_y = shorter(f->origin_y, origin_change(f, &ray, &below));
        f->direction_x = shorter(f->direction_x, turned(d, direction_of(f, &right)));
        f->direction_y = shorter(f->direction_y, turned(d, direction_of(f, &below)));
    }
    f->parallel = camera->camera.kind == SAG_CAMERA_ORTHOGRAPHIC;
    f->scale = samples_per_pixel > 0 ? 1 / sqrt((double)samples_per_pixel) : 1;
    if (f->scale < 0.125) f->scale = 0.125; // pbrt's bound
}

// From the point at `distance` along z to where the next pixel's ray meets the tangent plane of normal n.
static sag_vec3 change(sag_vec3 n, double distance, sag_vec3 origin, sag_vec3 direction) {
    direction.z += 1;
    const double t = (n.z * distance - sag_dot(n, origin)) / sag_dot(n, direction);
    const sag_vec3 met = sag_madd(origin, t, direction);
    return sag_vec3_make(met.x, met.y, met.z - distance);
}

// Out of the frame s, t, z in camera space.
static sag_vec3 to_world(const sagi_footprint *f, sag_vec3 s, sag_vec3 t, sag_vec3 z, sag_vec3 v) {
    const sag_vec3 in_camera = sag_madd(sag_madd(sag_scale(s, v.x), v.y, t), v.z, z);
    const sag_vec3 in_world = sag_scale(sagi_affine_vector(&f->to_world, in_camera), f->scale);
    return sag_is_finite(in_world) ? in_world : sag_vec3_make(0, 0, 0); // the ray grazes
}

void sagi_footprint_at(const sagi_footprint *footprint, sag_vec3 dpdu, sag_vec3 dpdv, sagi_spot *spot) {
    const sagi_footprint *f = footprint;
    spot->dpdx = spot->dpdy = sag_vec3_make(0, 0, 0);
    spot->dudx = spot->dudy = spot->dvdx = spot->dvdy = 0;
    if (!f->known) return;
    const sag_vec3 p = sagi_affine_point(&f->from_world, spot->position);
    const double distance = f->parallel ? p.z : sag_length(p);
    if (!f->parallel && !(distance > 0)) return;
    sag_vec3 s = {1, 0, 0}, t = {0, 1, 0}, z = {0, 0, 1};
    if (!f->parallel) {
        z = sag_scale(p, 1 / distance);
        sagi_frame(z, &s, &t);
    }
    // A normal goes the other way by the transposed map.
    const double(*m)[4] = f->to_world.m;
    const sag_vec3 n = spot->normal;
    const sag_vec3 inward = {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
                             m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
                             m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
    const sag_vec3 turned_n = {sag_dot(inward, s), sag_dot(inward, t), sag_dot(inward, z)};
    spot->dpdx = to_world(f, s, t, z, change(turned_n, distance, f->origin_x, f->direction_x));
    spot->dpdy = to_world(f, s, t, z, change(turned_n, distance, f->origin_y, f->direction_y));
    sagi_spot_set_uv(spot, dpdu, dpdv);
}
