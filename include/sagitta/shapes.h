// SPDX-License-Identifier: MIT
/// @file shapes.h
/// The shapes. Each is plain data plus pure functions, usable alone, without a context or scene; each may
/// also be added to a scene (scene.h). This file says once what the functions of every shape do; the headers
/// it includes say, shape by shape, the equation, the parameters and the texture coordinates.
///
/// Every shape X has these eight verbs. None allocates, none keeps state, all may be called from any threads
/// at once.
///
///     sag_status sag_X_validate(const sag_X *, sag_error *);
///         SAG_OK, or SAG_ERROR_GEOMETRY and a message that names the field and its value. The other verbs
///         expect a shape that passes; given one that does not they never crash, never loop, never read
///         outside the arrays the shape names. One whose own numbers do not pass gets false, 0 or an empty
///         box (tests/unit/test_invalid_shapes.c); what only a search finds (a polygon that crosses itself, a
///         polyhedron without an inside, a bad index in a mesh) is validate's alone to tell.
///     sag_box3 sag_X_bounds(const sag_X *);
///         A box that holds the whole shape, rounded outward. Infinite for an unbounded shape.
///     bool sag_X_hit(const sag_X *, const sag_ray *, sag_hit *);
///         The crossing with the smallest t in the closed [t_min, t_max], whatever the origin's side. A
///         crossing out of range does not hide one in range. *hit is written only when true is returned: t,
///         u, v, primitive; geometry and the instance path become "none". t lies within 4 ulp of the root of
///         the shape's equation for the numbers given (tests/oracle).
///     bool sag_X_occluded(const sag_X *, const sag_ray *);
///         Whether there is a crossing in [t_min, t_max]; always the same answer as hit, sooner.
///     size_t sag_X_crossings(const sag_X *, const sag_ray *, sag_hit *hits, size_t capacity);
///         Every crossing in [t_min, t_max] in order of t, at equal t of primitive. Writes the first
///         `capacity` of them to hits[] (which may be NULL when capacity is 0) and returns how many there are
///         in all. A closed shape is entered and left equally often by a ray from −∞ to ∞; where a ray
///         touches without entering the count is 0 or 2.
///     void sag_X_surface(const sag_X *, const sag_ray *, const sag_hit *, sag_surface *);
///         Everything about a hit that hit or crossings reported for this very ray.
///     double sag_X_area(const sag_X *);
///         The area of the surface in the unit of length squared; INFINITY for an unbounded one.
///     bool sag_X_sample(const sag_X *, sag_vec2 random, sag_surface *);
///         A point distributed uniformly by area, from two numbers in [0, 1); its density is 1/area. False,
///         writing nothing, when the area is 0 or infinite. The surface is as seen from its front.
///
/// Closed or simple shapes have some of these too:
///
///     bool sag_X_contains(const sag_X *, sag_vec3 point);
///         Whether the point is inside or on the closed shape (for a plane: on it or on the side away from
///         the normal).
///     double sag_X_volume(const sag_X *);
///         The volume; for a mesh signed, positive when the triangles turn counter-clockwise seen from
///         outside.
///     sag_vec3 sag_X_closest_point(const sag_X *, sag_vec3 point);
///         The point of the surface nearest to the given one (for a point inside too); when several are, one
///         of them.
#ifndef SAGITTA_SHAPES_H
#define SAGITTA_SHAPES_H

#include <sagitta/math.h>

#ifdef __cplusplus
extern "C" {
#endif

/// "No such thing" where an id is expected.
#define SAG_INVALID_ID 0xFFFFFFFFu
/// How deep instances may nest.
#define SAG_MAX_INSTANCE_DEPTH 8
/// Coordinates and sizes of geometry must not exceed this in absolute value (2¹⁰⁰ ≈ 1.3e30), so that no
/// product of the predicates overflows. validate says so; mesh vertices beyond it are dropped and reported
/// like NaN.
#define SAG_MAX_COORDINATE 0x1p100

/// Where a ray meets something: the least that says it. sag_surface_at (or a shape's own `surface`) works out
/// the rest.
typedef struct sag_hit {
    double t;           ///< in directions of the ray
    double u, v;        ///< barycentric weights of the 2nd and 3rd vertex for triangles; (u,v) of patch and
                        ///< rectangle; else 0
    uint32_t primitive; ///< which part: triangle of a mesh, sphere of a set, face of a box, 1 and 2 for caps;
                        ///< else 0
    uint32_t geometry;  ///< the id in the scene it was added to; SAG_INVALID_ID for a shape used alone
    uint32_t instance_depth;                        ///< how many of instance_path are used
    uint32_t instance_path[SAG_MAX_INSTANCE_DEPTH]; ///< ids of the instances passed through, outermost first
    uint32_t flipped; ///< 1: the boundary of a solid that lies on the outer side of the part's surface
                      ///< (solid.h); else 0
} sag_hit;

/// Which side of the surface the ray arrives at: the front is the one the geometric normal points to.
typedef enum sag_side { SAG_SIDE_FRONT, SAG_SIDE_BACK } sag_side;

/// Everything about one point of a surface.
typedef struct sag_surface {
    sag_vec3 position;         ///< on the surface as nearly as doubles allow
    sag_vec3 position_error;   ///< absolute bound of position's error in each coordinate; see sag_spawn_ray
    sag_vec3 geometric_normal; ///< unit; outward for closed shapes; perpendicular to the surface itself
    sag_vec3
        shading_normal;  ///< unit; interpolated where the shape has vertex normals, else the geometric one
    sag_vec3 dpdu, dpdv; ///< how the position changes with u and v; never 0, never parallel to each other
    double u, v;         ///< texture coordinates
    sag_side side;
    uint32_t primitive;
    uint32_t geometry;
    uint64_t user_data; ///< the geometry's (scene.h); 0 for a shape used alone
} sag_surface;

/// Every kind of geometry a scene holds.
typedef enum sag_shape_kind {
    SAG_SHAPE_PLANE,
    SAG_SHAPE_DISK,
    SAG_SHAPE_RECTANGLE,
    SAG_SHAPE_POLYGON,
    SAG_SHAPE_SPHERE,
    SAG_SHAPE_ELLIPSOID,
    SAG_SHAPE_CYLINDER,
    SAG_SHAPE_CONE,
    SAG_SHAPE_PARABOLOID,
    SAG_SHAPE_HYPERBOLOID,
    SAG_SHAPE_HYPERBOLOID2,
    SAG_SHAPE_QUADRIC,
    SAG_SHAPE_BOX,
    SAG_SHAPE_ORIENTED_BOX,
    SAG_SHAPE_POLYHEDRON,
    SAG_SHAPE_CAPSULE,
    SAG_SHAPE_TRIANGLE,
    SAG_SHAPE_BILINEAR_PATCH,
    SAG_SHAPE_TORUS,
    SAG_SHAPE_SPHERES,
    SAG_SHAPE_MESH,
    SAG_SHAPE_USER,
    SAG_SHAPE_INSTANCE,
} sag_shape_kind;

/// "plane", "sphere" …: as the scene language says it; never NULL. Thread-safe.
SAG_API const char *sag_shape_kind_name(sag_shape_kind kind);

/// A ray that starts outside the surface's position error, on the side the direction points to, so that it
/// does not meet the surface it leaves again: t ∈ [0, ∞), mask 0. The origin is moved along the geometric
/// normal by no more than the error bound asks for and then rounded outward; there is no constant in it but
/// 2^-500, the least step from a coordinate that is exactly 0. (tests/unit/test_spawn.c; PBR
/// 4th ed. §6.8.6; docs/numerics.md.)
SAG_API sag_ray sag_spawn_ray(const sag_surface *surface, sag_vec3 direction);

/// The ray from a surface to a point, t ∈ [0, 1], t = 1 being the point. For a shadow ray to a light at a
/// point.
SAG_API sag_ray sag_spawn_ray_to_point(const sag_surface *surface, sag_vec3 point);

/// The ray from one surface to another with both ends moved off their surfaces, t ∈ [0, 1): it meets neither
/// end.
SAG_API sag_ray sag_spawn_ray_to_surface(const sag_surface *from, const sag_surface *to);

#ifdef __cplusplus
}
#endif

#include <sagitta/shapes/boxes.h>
#include <sagitta/shapes/measure.h>
#include <sagitta/shapes/planar.h>
#include <sagitta/shapes/quadrics.h>
#include <sagitta/shapes/sets.h>
#include <sagitta/shapes/torus.h>
#include <sagitta/shapes/triangles.h>

#endif
