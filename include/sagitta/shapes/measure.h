// SPDX-License-Identifier: MIT
/// @file measure.h
/// Ray against ray, barycentric coordinates and triangle areas, as plain functions.
#ifndef SAGITTA_SHAPES_MEASURE_H
#define SAGITTA_SHAPES_MEASURE_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Where two rays come closest.
typedef struct sag_closest_approach {
    double t_a, t_b; ///< the parameters, each within its ray's [t_min, t_max]
    sag_vec3 a, b;   ///< the points
    double distance; ///< |a − b|
    bool parallel;   ///< directions exactly parallel: of equally near pairs the one with the smallest t_a, or
                     ///< where that would be −∞ with the t_a nearest to 0
} sag_closest_approach;

/// The pair of points, one on each ray within its range, that lie nearest to each other (minimises |a(t_a) −
/// b(t_b)| over the rectangle of ranges; Ericson, Real-Time Collision Detection §5.1.9). False, writing
/// nothing, for an invalid ray. Relative error of t_a and t_b about 2^-48/sin² of the angle between the rays.
/// (tests/unit/test_measure.c)
SAG_API bool sag_ray_ray_closest(const sag_ray *a, const sag_ray *b, sag_closest_approach *result);

/// One dimension: the weights of a and b with w[0]·a + w[1]·b = p, w[0] + w[1] = 1. False, writing nothing,
/// when a = b; in this and the two below also for what is not finite (tests/unit/test_measure.c).
SAG_API bool sag_barycentric_1d(double p, double a, double b, double weights[2]);
/// Two dimensions: the weights of a, b, c for p. Computed from signed areas; the signs are exact. False for
/// no area.
SAG_API bool sag_barycentric_2d(sag_vec2 p, sag_vec2 a, sag_vec2 b, sag_vec2 c, double weights[3]);
/// Three dimensions: the weights of a, b, c for p's perpendicular projection on their plane. False for no
/// area.
SAG_API bool sag_barycentric_3d(sag_vec3 p, sag_vec3 a, sag_vec3 b, sag_vec3 c, double weights[3]);

/// Half of (b − a) × (c − a): positive when a, b, c turn counter-clockwise; the sign is exact.
SAG_API double sag_triangle_signed_area_2d(sag_vec2 a, sag_vec2 b, sag_vec2 c);
/// The absolute value of the above.
SAG_API double sag_triangle_area_2d(sag_vec2 a, sag_vec2 b, sag_vec2 c);
/// Half of |(b − a) × (c − a)|.
SAG_API double sag_triangle_area_3d(sag_vec3 a, sag_vec3 b, sag_vec3 c);
/// The area signed by the side a, b, c are seen from: positive where they turn counter-clockwise as `normal`
/// points at one. The sign is exact; 0 when `normal` lies in their plane.
SAG_API double sag_triangle_signed_area_3d(sag_vec3 a, sag_vec3 b, sag_vec3 c, sag_vec3 normal);

#ifdef __cplusplus
}
#endif
#endif
