// SPDX-License-Identifier: MIT
// Where a ray cuts a plane: t = numerator/denominator, both sums of products of the numbers given. What the
// flat shapes and the faces of the convex ones share.
#ifndef SAGI_SHAPES_CUT_H
#define SAGI_SHAPES_CUT_H

#include "math/determinant.h"
#include "shapes/common.h"

// t to more than a double: |t − exact| ≤ error. error ≤ 2⁻⁵⁴ |t|, mostly about 2⁻¹⁰⁰.
typedef struct sagi_cut {
    sagi_dd t;
    double error;
} sagi_cut;

// A power of two that brings the largest coordinate of v near 1, so that products of it neither overflow nor
// underflow; 1 for ordinary vectors (2⁻¹⁰⁰ to 2²⁵⁰), so that it usually costs one comparison and
// small coordinates beside large ones are kept.
double sagi_power_scale(sag_vec3 v);

// numerator/denominator when both are known well enough for a relative error of 2⁻⁵⁴, else false: then ask
// sagi_cut_real.
bool sagi_cut_ratio(sagi_dd numerator, double numerator_error, sagi_dd denominator, double denominator_error,
                    sagi_cut *cut);
// The same from 400 bits; the denominator must not be 0.
sagi_cut sagi_cut_real(sagi_real numerator, sagi_real denominator);

// Whether numerator/denominator is certainly outside [t_min, t_max], the two being known to the errors given.
bool sagi_cut_outside(double numerator, double numerator_error, double denominator, double denominator_error,
                      const sag_ray *ray);

// t of the ray and the plane (p − point)·normal = 0, decided exactly. False when the ray runs along the plane
// or t, rounded to a double, is outside [t_min, t_max]. Filtered: a ray that certainly misses costs some
// thirty operations.
bool sagi_cut_plane(sag_vec3 normal, sag_vec3 point, const sag_ray *ray, sagi_cut *cut);

// The sign of (p − point)·normal: exact.
int sagi_plane_side(sag_vec3 normal, sag_vec3 point, sag_vec3 p);
// (p − point)·normal to within a few 2⁻⁵³ of itself, or exactly 0.
double sagi_plane_offset(sag_vec3 normal, sag_vec3 point, sag_vec3 p);

// The point at t, correctly rounded or nearly so however far the origin is, and twice the bound of its error
// in each coordinate. The second half is what spawned rays need to be clear of the surface for certain.
void sagi_point_at(const sag_ray *ray, sagi_cut cut, sag_vec3 *position, sag_vec3 *position_error);

// Widens the position error of a point of the plane through `point`, so that the quick test of sagi_cut_plane
// sees for certain on which side a spawned ray starts, and turns it away at the cost of a few products.
void sagi_clear_plane(sag_vec3 point, sag_surface *surface);
// The same by a distance: an upper bound of the quick test's error, as a distance from the surface.
void sagi_clear_distance(double distance, sag_surface *surface);

#endif
