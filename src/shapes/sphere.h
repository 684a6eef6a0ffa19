// SPDX-License-Identifier: MIT
// One whole sphere by centre and radius: what sag_sphere, sag_spheres and the scene's kernel share. Rays must
// be valid (sag_ray_is_valid); centre and radius finite, radius > 0.
#ifndef SAGI_SHAPES_SPHERE_H
#define SAGI_SHAPES_SPHERE_H

#include "shapes/common.h"

// Whether nothing is cut off.
bool sagi_sphere_is_whole(const sag_sphere *sphere);
// The nearest crossing in [t_min, t_max]; *t is written only when there is one.
bool sagi_sphere_hit(sag_vec3 center, double radius, const sag_ray *ray, double *t);
// Both crossings in range, in order; returns how many. A tangent counts twice.
int sagi_sphere_crossings(sag_vec3 center, double radius, const sag_ray *ray, double t[2]);
// Whether the point is inside or on the sphere: exact.
bool sagi_sphere_contains(sag_vec3 center, double radius, sag_vec3 point);
// The point of the sphere nearest to `point`; center + (radius, 0, 0) for the centre itself.
sag_vec3 sagi_sphere_closest_point(sag_vec3 center, double radius, sag_vec3 point);
sag_box3 sagi_sphere_bounds(sag_vec3 center, double radius);
// position, position_error and geometric_normal of the point of the ray at t.
void sagi_sphere_place(sag_vec3 center, double radius, const sag_ray *ray, double t, sag_surface *surface);
// u, v, dpdu, dpdv of a whole sphere with y up, at the point center + offset.
void sagi_sphere_texture(sag_vec3 offset, sag_surface *surface);
// A point uniform by area on the part z_min ≤ z ≤ z_max (relative to the centre), 0 ≤ φ ≤ phi_max: position,
// position_error and geometric_normal. Returns the offset from the centre.
sag_vec3 sagi_sphere_sample(sag_vec3 center, double radius, double z_min, double z_max, double phi_max,
                            sag_vec2 random, sag_surface *surface);

#endif
