// SPDX-License-Identifier: MIT
/// @file planar.h
/// Flat shapes: plane, disk, rectangle, polygon. A ray that lies in the plane of one misses it.
#ifndef SAGITTA_SHAPES_PLANAR_H
#define SAGITTA_SHAPES_PLANAR_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The plane (p − point)·normal = 0. Decided exactly for the numbers given. contains: the half-space (p −
/// point)·normal ≤ 0.
///
/// Texture coordinates with the basis s, t (neither unit nor perpendicular): z = s×t, s' = t×z/|z|², t' =
/// z×s/|z|², u = (p − point)·s', v = (p − point)·t', so that point + s is at u = 1. dp/du = s, dp/dv = t.
typedef struct sag_plane {
    sag_vec3 point;
    sag_vec3 normal; ///< any length but 0
    sag_vec3 s,
        t; ///< texture basis, in the plane and not parallel; both 0: a unit basis is made from the normal
} sag_plane;

/// The verbs of plane: see shapes.h.
SAG_API sag_status sag_plane_validate(const sag_plane *plane, sag_error *error);
SAG_API sag_box3 sag_plane_bounds(const sag_plane *plane);
SAG_API bool sag_plane_hit(const sag_plane *plane, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_plane_occluded(const sag_plane *plane, const sag_ray *ray);
SAG_API size_t sag_plane_crossings(const sag_plane *plane, const sag_ray *ray, sag_hit *hits,
                                   size_t capacity);
SAG_API void sag_plane_surface(const sag_plane *plane, const sag_ray *ray, const sag_hit *hit,
                               sag_surface *surface);
SAG_API double sag_plane_area(const sag_plane *plane);
SAG_API bool sag_plane_sample(const sag_plane *plane, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_plane_contains(const sag_plane *plane, sag_vec3 point);
SAG_API double sag_plane_volume(const sag_plane *plane);
SAG_API sag_vec3 sag_plane_closest_point(const sag_plane *plane, sag_vec3 point);

/// The disk or ring |p − center| ≤ radius, ≥ inner_radius in the plane (p − center)·normal = 0; in a sector φ
/// ≤ phi_max. φ runs from the x axis counter-clockwise around the normal. u = φ/phi_max, v = (radius −
/// ρ)/(radius − inner_radius).
typedef struct sag_disk {
    sag_vec3 center;
    sag_vec3 normal;     ///< any length but 0
    double radius;       ///< > 0
    double inner_radius; ///< in [0, radius)
    double phi_max_rad;  ///< in (0, 2π]; 0 counts as 2π
    sag_vec3 x_axis;     ///< where φ = 0, made perpendicular to the normal; 0: sag_frame's first vector
} sag_disk;

/// The verbs of disk: see shapes.h.
SAG_API sag_status sag_disk_validate(const sag_disk *disk, sag_error *error);
SAG_API sag_box3 sag_disk_bounds(const sag_disk *disk);
SAG_API bool sag_disk_hit(const sag_disk *disk, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_disk_occluded(const sag_disk *disk, const sag_ray *ray);
SAG_API size_t sag_disk_crossings(const sag_disk *disk, const sag_ray *ray, sag_hit *hits, size_t capacity);
SAG_API void sag_disk_surface(const sag_disk *disk, const sag_ray *ray, const sag_hit *hit,
                              sag_surface *surface);
SAG_API double sag_disk_area(const sag_disk *disk);
SAG_API bool sag_disk_sample(const sag_disk *disk, sag_vec2 random, sag_surface *surface);
SAG_API sag_vec3 sag_disk_closest_point(const sag_disk *disk, sag_vec3 point);

/// The parallelogram corner + u·edge_u + v·edge_v, u and v in [0, 1]; a rectangle when the edges are
/// perpendicular. The normal is edge_u × edge_v; u, v are the texture coordinates.
typedef struct sag_rectangle {
    sag_vec3 corner;
    sag_vec3 edge_u, edge_v; ///< not 0, not parallel
} sag_rectangle;

/// The verbs of rectangle: see shapes.h.
SAG_API sag_status sag_rectangle_validate(const sag_rectangle *rectangle, sag_error *error);
SAG_API sag_box3 sag_rectangle_bounds(const sag_rectangle *rectangle);
SAG_API bool sag_rectangle_hit(const sag_rectangle *rectangle, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_rectangle_occluded(const sag_rectangle *rectangle, const sag_ray *ray);
SAG_API size_t sag_rectangle_crossings(const sag_rectangle *rectangle, const sag_ray *ray, sag_hit *hits,
                                       size_t capacity);
SAG_API void sag_rectangle_surface(const sag_rectangle *rectangle, const sag_ray *ray, const sag_hit *hit,
                                   sag_surface *surface);
SAG_API double sag_rectangle_area(const sag_rectangle *rectangle);
SAG_API bool sag_rectangle_sample(const sag_rectangle *rectangle, sag_vec2 random, sag_surface *surface);
SAG_API sag_vec3 sag_rectangle_closest_point(const sag_rectangle *rectangle, sag_vec3 point);

/// A flat polygon with holes: the first loop is the outer boundary, the others are holes; concave is fine, a
/// loop closes by itself. Inside means an odd number of loops around (even-odd rule), so the turning of the
/// loops does not matter; the normal is the first loop's by Newell's rule (counter-clockwise seen from the
/// front). Not planar to within 1e-9 of its extent, fewer than three points in a loop, or a boundary that
/// crosses itself is an error. The plane is the outer loop's by Newell, through its centroid. u, v: (p −
/// positions[0]) along the unit first edge and along the normal × that edge.
typedef struct sag_polygon {
    const sag_vec3 *positions; ///< loop after loop, position_count of them
    uint32_t position_count;
    const uint32_t *loop_sizes; ///< points in each loop, loop_count of them, adding up to position_count
    uint32_t loop_count;
} sag_polygon;

/// The verbs of polygon: see shapes.h.
SAG_API sag_status sag_polygon_validate(const sag_polygon *polygon, sag_error *error);
SAG_API sag_box3 sag_polygon_bounds(const sag_polygon *polygon);
SAG_API bool sag_polygon_hit(const sag_polygon *polygon, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_polygon_occluded(const sag_polygon *polygon, const sag_ray *ray);
SAG_API size_t sag_polygon_crossings(const sag_polygon *polygon, const sag_ray *ray, sag_hit *hits,
                                     size_t capacity);
SAG_API void sag_polygon_surface(const sag_polygon *polygon, const sag_ray *ray, const sag_hit *hit,
                                 sag_surface *surface);
SAG_API double sag_polygon_area(const sag_polygon *polygon);
SAG_API bool sag_polygon_sample(const sag_polygon *polygon, sag_vec2 random, sag_surface *surface);
SAG_API sag_vec3 sag_polygon_closest_point(const sag_polygon *polygon, sag_vec3 point);

#ifdef __cplusplus
}
#endif
#endif
