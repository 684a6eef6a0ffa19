// SPDX-License-Identifier: MIT
/// @file boxes.h
/// Convex solids with faces: axis-aligned box, oriented box, polyhedron; and the capsule. All closed, normals
/// outward. A ray through an edge or vertex crosses the solid once in and once out, never more. Rays that run
/// within a face's plane belong to the solid by this rule: the face's half-space is closed, so they enter and
/// leave through the other faces.
#ifndef SAGITTA_SHAPES_BOXES_H
#define SAGITTA_SHAPES_BOXES_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The axis-aligned box min ≤ p ≤ max, decided exactly for the numbers given. primitive: 2·axis + (0 at min,
/// 1 at max). Texture coordinates: the face's two coordinates, 0 to 1 — for axis x: (y, z), for y: (z, x),
/// for z: (x, y).
typedef struct sag_box {
    sag_vec3 min, max; ///< min < max in each coordinate
} sag_box;

/// The verbs of box: see shapes.h.
SAG_API sag_status sag_box_validate(const sag_box *box, sag_error *error);
SAG_API sag_box3 sag_box_bounds(const sag_box *box);
SAG_API bool sag_box_hit(const sag_box *box, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_box_occluded(const sag_box *box, const sag_ray *ray);
SAG_API size_t sag_box_crossings(const sag_box *box, const sag_ray *ray, sag_hit *hits, size_t capacity);
SAG_API void sag_box_surface(const sag_box *box, const sag_ray *ray, const sag_hit *hit,
                             sag_surface *surface);
SAG_API double sag_box_area(const sag_box *box);
SAG_API bool sag_box_sample(const sag_box *box, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_box_contains(const sag_box *box, sag_vec3 point);
SAG_API double sag_box_volume(const sag_box *box);
SAG_API sag_vec3 sag_box_closest_point(const sag_box *box, sag_vec3 point);

/// The box center + Σ sᵢ half_axes[i], |sᵢ| ≤ 1. The half axes carry the sizes; perpendicular makes a rotated
/// box, any independent ones a parallelepiped (also right-handed or left-handed). primitive and texture
/// coordinates as for sag_box, in the coordinates (s + 1)/2.
typedef struct sag_oriented_box {
    sag_vec3 center;
    sag_vec3 half_axes[3];
} sag_oriented_box;

/// The verbs of oriented_box: see shapes.h.
SAG_API sag_status sag_oriented_box_validate(const sag_oriented_box *oriented_box, sag_error *error);
SAG_API sag_box3 sag_oriented_box_bounds(const sag_oriented_box *oriented_box);
SAG_API bool sag_oriented_box_hit(const sag_oriented_box *oriented_box, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_oriented_box_occluded(const sag_oriented_box *oriented_box, const sag_ray *ray);
SAG_API size_t sag_oriented_box_crossings(const sag_oriented_box *oriented_box, const sag_ray *ray,
                                          sag_hit *hits, size_t capacity);
SAG_API void sag_oriented_box_surface(const sag_oriented_box *oriented_box, const sag_ray *ray,
                                      const sag_hit *hit, sag_surface *surface);
SAG_API double sag_oriented_box_area(const sag_oriented_box *oriented_box);
SAG_API bool sag_oriented_box_sample(const sag_oriented_box *oriented_box, sag_vec2 random,
                                     sag_surface *surface);
SAG_API bool sag_oriented_box_contains(const sag_oriented_box *oriented_box, sag_vec3 point);
SAG_API double sag_oriented_box_volume(const sag_oriented_box *oriented_box);
SAG_API sag_vec3 sag_oriented_box_closest_point(const sag_oriented_box *oriented_box, sag_vec3 point);

/// One half-space normal·p ≤ offset; the normal has any length but 0 and points out.
typedef struct sag_half_space {
    sag_vec3 normal;
    double offset;
} sag_half_space;

/// The convex polyhedron where all half-spaces meet: slab, wedge, frustum, crystal. It may be unbounded (a
/// slab between two planes); then bounds are infinite in those directions, area and volume INFINITY. An empty
/// intersection is an error. primitive: the plane's index. u, v: along sag_frame of the face's normal, from
/// the point of the plane nearest 0.
typedef struct sag_polyhedron {
    const sag_half_space *planes; ///< plane_count of them
    uint32_t plane_count;         ///< 1 … SAG_MAX_POLYHEDRON_PLANES
} sag_polyhedron;
#define SAG_MAX_POLYHEDRON_PLANES 256

/// The verbs of polyhedron: see shapes.h.
SAG_API sag_status sag_polyhedron_validate(const sag_polyhedron *polyhedron, sag_error *error);
SAG_API sag_box3 sag_polyhedron_bounds(const sag_polyhedron *polyhedron);
SAG_API bool sag_polyhedron_hit(const sag_polyhedron *polyhedron, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_polyhedron_occluded(const sag_polyhedron *polyhedron, const sag_ray *ray);
SAG_API size_t sag_polyhedron_crossings(const sag_polyhedron *polyhedron, const sag_ray *ray, sag_hit *hits,
                                        size_t capacity);
SAG_API void sag_polyhedron_surface(const sag_polyhedron *polyhedron, const sag_ray *ray, const sag_hit *hit,
                                    sag_surface *surface);
SAG_API double sag_polyhedron_area(const sag_polyhedron *polyhedron);
SAG_API bool sag_polyhedron_sample(const sag_polyhedron *polyhedron, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_polyhedron_contains(const sag_polyhedron *polyhedron, sag_vec3 point);
SAG_API double sag_polyhedron_volume(const sag_polyhedron *polyhedron);
SAG_API sag_vec3 sag_polyhedron_closest_point(const sag_polyhedron *polyhedron, sag_vec3 point);

/// The frustum of a view as six half-spaces: apex `eye`, looking along `forward`, between the distances near
/// and far, with the half angles given. Writes planes[6] (left, right, bottom, top, near, far). Needs 0 ≤
/// near < far.
SAG_API sag_status sag_frustum_planes(sag_vec3 eye, sag_vec3 forward, sag_vec3 up, double half_width_rad,
                                      double half_height_rad, double near_distance, double far_distance,
                                      sag_half_space planes[6], sag_error *error);

/// All points within `radius` of the segment p0 p1. p0 = p1 is a ball. primitive: 0 the side, 1 the ball's
/// half at p0, 2 at p1. u = φ/2π around the axis (from sag_frame of its direction), v along the whole length
/// from end to end, 0 to 1.
typedef struct sag_capsule {
    sag_vec3 p0, p1;
    double radius; ///< > 0
} sag_capsule;

/// The verbs of capsule: see shapes.h.
SAG_API sag_status sag_capsule_validate(const sag_capsule *capsule, sag_error *error);
SAG_API sag_box3 sag_capsule_bounds(const sag_capsule *capsule);
SAG_API bool sag_capsule_hit(const sag_capsule *capsule, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_capsule_occluded(const sag_capsule *capsule, const sag_ray *ray);
SAG_API size_t sag_capsule_crossings(const sag_capsule *capsule, const sag_ray *ray, sag_hit *hits,
                                     size_t capacity);
SAG_API void sag_capsule_surface(const sag_capsule *capsule, const sag_ray *ray, const sag_hit *hit,
                                 sag_surface *surface);
SAG_API double sag_capsule_area(const sag_capsule *capsule);
SAG_API bool sag_capsule_sample(const sag_capsule *capsule, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_capsule_contains(const sag_capsule *capsule, sag_vec3 point);
SAG_API double sag_capsule_volume(const sag_capsule *capsule);
SAG_API sag_vec3 sag_capsule_closest_point(const sag_capsule *capsule, sag_vec3 point);

#ifdef __cplusplus
}
#endif
#endif
