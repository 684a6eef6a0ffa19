// SPDX-License-Identifier: MIT
// Rays that leave a surface without meeting it again.
//
// A computed position p is off the surface: all that is known is that the true point lies in the box p ± e, e
// being surface.position_error. A ray from p may start on the wrong side and meet the surface at once. Two
// cures are usual, a t_min > 0 or a fixed step along the normal; both need a length, and no length fits every
// scale. The bound needs none:
//
// The surface near p is the plane through the true point with unit normal n. Over the box p ± e the distance
// along n of a point from p is at most
//     δ = |n.x| e.x + |n.y| e.y + |n.z| e.z,
// so p + δn is on or above every plane with that normal that meets the box, and so above the surface; p − δn
// below it. The ray goes to the side its direction points to (Pharr, Jakob & Humphreys, "Physically Based
// Rendering", 4th ed., §6.8.6).
//
// Rounding: n's length and the sum that makes δ are good to a few 2⁻⁵³, which the factor 1 + 2⁻⁵⁰ covers.
// Adding δn to p rounds each coordinate to nearest, by at most half an ulp, and perhaps towards the surface;
// stepping it to the next double away from the surface makes up for that. The step is taken also where δn is
// too small to change p, so a ray never starts exactly on a surface whose position happens to be exact.
//
// A coordinate that is exactly 0 with error 0 (the floor y = 0 hit from within the floor) is the one place
// where a step can be too small to be seen: from the next double after 0, 5e-324, t underflows to 0, and a
// transform takes it back to 0. δ is therefore at least 2⁻⁵⁰⁰: 150 orders of magnitude above underflow and
// as many below a rounding of anything else.
//
// Here in line, and written number by number to where the ray is to stand: one that is copied as a whole at
// once would have to wait for its parts.
#ifndef SAGI_SHAPES_SPAWN_H
#define SAGI_SHAPES_SPAWN_H

#include "shapes/common.h"

// The next double from `moved` to the side of `normal`: the nearest to moved (1 ± φ) with φ slightly above
// half the spacing's share is just that one where nothing underflows (Rump, Zimmermann, Boldo & Melquiond,
// "Computing predecessor and successor in rounding to nearest", BIT 49, 2009). Which side it is, no processor
// guesses well: so it is arithmetic.
static inline double sagi_step_away(double position, double normal, double distance) {
    const double moved = position + distance * normal, size = fabs(moved);
    if (__builtin_expect(!(size > 0x1p-960 && size < 0x1p1000), 0))
        return normal > 0 ? sagi_next_up(moved) : normal < 0 ? sagi_next_down(moved) : moved;
    const double step = size * (0x1p-53 * (1 + 0x1p-52));
    return moved + (normal != 0 ? copysign(step, normal) : 0);
}

// The point off the surface on the side that `direction` points to.
static inline sag_vec3 sagi_spawn_point(const sag_surface *surface, sag_vec3 direction) {
    const sag_vec3 normal = surface->geometric_normal;
    double distance = sag_dot(sag_abs(normal), surface->position_error) * (1 + 0x1p-50);
    if (!(distance > 0x1p-500)) distance = 0x1p-500;
    const sag_vec3 n = sag_scale(normal, copysign(1, sag_dot(direction, normal) + 0.0));
    return sag_vec3_make(sagi_step_away(surface->position.x, n.x, distance),
                         sagi_step_away(surface->position.y, n.y, distance),
                         sagi_step_away(surface->position.z, n.z, distance));
}

static inline void sagi_ray_set(sag_ray *ray, sag_vec3 origin, sag_vec3 direction, double t_max) {
    ray->origin.x = origin.x, ray->origin.y = origin.y, ray->origin.z = origin.z;
    ray->direction.x = direction.x, ray->direction.y = direction.y, ray->direction.z = direction.z;
    ray->t_min = 0, ray->t_max = t_max;
    ray->mask = 0;
}

static inline void sagi_ray_copy(sag_ray *ray, const sag_ray *from) {
    sagi_ray_set(ray, from->origin, from->direction, from->t_max);
    ray->t_min = from->t_min;
    ray->mask = from->mask;
}

// As sag_spawn_ray, sag_spawn_ray_to_point and sag_spawn_ray_to_surface.
static inline void sagi_spawn(const sag_surface *surface, sag_vec3 direction, sag_ray *ray) {
    sagi_ray_set(ray, sagi_spawn_point(surface, direction), direction, INFINITY);
}
static inline void sagi_spawn_to_point(const sag_surface *surface, sag_vec3 point, sag_ray *ray) {
    const sag_vec3 origin = sagi_spawn_point(surface, sag_sub(point, surface->position));
    sagi_ray_set(ray, origin, sag_sub(point, origin), 1);
}
static inline void sagi_spawn_to_surface(const sag_surface *from, const sag_surface *to, sag_ray *ray) {
    const sag_vec3 between = sag_sub(to->position, from->position);
    const sag_vec3 origin = sagi_spawn_point(from, between), end = sagi_spawn_point(to, sag_neg(between));
    sagi_ray_set(ray, origin, sag_sub(end, origin), 1 - 0x1p-53); // the largest double below 1
}

#endif
