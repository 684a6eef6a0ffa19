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
#include "shapes/common.h"

static double step_away(double position, double normal, double distance) {
    double moved = position + distance * normal;
    if (normal > 0) return sagi_next_up(moved);
    if (normal < 0) return sagi_next_down(moved);
    return moved;
}

// The point off the surface on the side that `direction` points to.
static sag_vec3 offset(const sag_surface *surface, sag_vec3 direction) {
    sag_vec3 n = surface->geometric_normal;
    double distance = sag_dot(sag_abs(n), surface->position_error) * (1 + 0x1p-50);
    if (!(distance > 0x1p-500)) distance = 0x1p-500;
    if (sag_dot(direction, n) < 0) n = sag_neg(n);
    return sag_vec3_make(step_away(surface->position.x, n.x, distance),
                         step_away(surface->position.y, n.y, distance),
                         step_away(surface->position.z, n.z, distance));
}

sag_ray sag_spawn_ray(const sag_surface *surface, sag_vec3 direction) {
    return sag_ray_make(offset(surface, direction), direction);
}

sag_ray sag_spawn_ray_to_point(const sag_surface *surface, sag_vec3 point) {
    sag_vec3 origin = offset(surface, sag_sub(point, surface->position));
    sag_ray ray = sag_ray_make(origin, sag_sub(point, origin));
    ray.t_max = 1;
    return ray;
}

sag_ray sag_spawn_ray_to_surface(const sag_surface *from, const sag_surface *to) {
    sag_vec3 between = sag_sub(to->position, from->position);
    sag_vec3 origin = offset(from, between);
    sag_ray ray = sag_ray_make(origin, sag_sub(offset(to, sag_neg(between)), origin));
    ray.t_max = 1 - 0x1p-53; // the largest double below 1
    return ray;
}
