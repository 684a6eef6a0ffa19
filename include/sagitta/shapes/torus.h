// SPDX-License-Identifier: MIT
/// @file torus.h
/// The torus.
#ifndef SAGITTA_SHAPES_TORUS_H
#define SAGITTA_SHAPES_TORUS_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The torus (√(x² + y²) − major_radius)² + z² = minor_radius² around the z axis: a ring for major > minor, a
/// spindle (which meets itself on the axis) for major < minor; major_radius 0 is a sphere. Up to four
/// crossings. Closed: contains speaks of distance from the circle ≤ minor_radius. For a spindle the inner
/// sheet is part of the surface for hits and area, and a point in the lens between is inside. u = φ/2π around
/// the axis, v = ψ/2π around the tube, from the outer equator upward.
typedef struct sag_torus {
    double major_radius; ///< ≥ 0
    double minor_radius; ///< > 0
} sag_torus;

/// The verbs of torus: see shapes.h.
SAG_API sag_status sag_torus_validate(const sag_torus *torus, sag_error *error);
SAG_API sag_box3 sag_torus_bounds(const sag_torus *torus);
SAG_API bool sag_torus_hit(const sag_torus *torus, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_torus_occluded(const sag_torus *torus, const sag_ray *ray);
SAG_API size_t sag_torus_crossings(const sag_torus *torus, const sag_ray *ray, sag_hit *hits,
                                   size_t capacity);
SAG_API void sag_torus_surface(const sag_torus *torus, const sag_ray *ray, const sag_hit *hit,
                               sag_surface *surface);
SAG_API double sag_torus_area(const sag_torus *torus);
SAG_API bool sag_torus_sample(const sag_torus *torus, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_torus_contains(const sag_torus *torus, sag_vec3 point);
SAG_API double sag_torus_volume(const sag_torus *torus);
SAG_API sag_vec3 sag_torus_closest_point(const sag_torus *torus, sag_vec3 point);

#ifdef __cplusplus
}
#endif
#endif
