// SPDX-License-Identifier: MIT
/// @file quadrics.h
/// Surfaces of second degree. Sphere and ellipsoid stand at a centre; the others stand on the z axis of their
/// own space and are placed by a transform (sag_geometry_set_transform, or sag_ray_transform when used
/// alone).
///
/// A sweep `phi_max_rad` in (0, 2π] keeps the part with φ = atan2(y, x) in [0, phi_max]; 0 counts as 2π.
/// `closed` adds the flat caps (and turns the shape into a solid: contains and volume speak of it); it needs
/// a full sweep. primitive: 0 the curved surface, 1 the cap at the smaller z, 2 the cap at the larger z. A
/// cap's u is φ/2π, its v 1 − ρ/r. An open shape contains nothing and has no volume.
///
/// Accuracy, for all of them: t within 1.5 ulp of the exact root of the equation for the numbers given, and
/// hit or miss decided exactly, tangents included (tests/oracle/test_quadrics.c, against MPFR). Where a clip
/// or a cap meets the surface, which side a crossing is on is decided by values of t within 2 ulp each; a
/// closed shape is entered as often as left all the same. (So a cone or paraboloid lower than 2^-48 of its
/// radius has a rim as blurred as it is wide.) A ray that starts more than 2²⁰⁰ times the shape's size away
/// misses. The position of a hit is projected onto the surface: position_error bounds its distance from the
/// surface, which is what spawned rays need (tests/unit/test_quadric_surfaces.c). Source: docs/sphere.md and
/// src/shapes/quadric_solve.c.
#ifndef SAGITTA_SHAPES_QUADRICS_H
#define SAGITTA_SHAPES_QUADRICS_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The sphere |p − center| = radius; as in pbrt, clipped to center.z + z_min ≤ z ≤ center.z + z_max and swept
/// by phi_max.
///
/// Texture coordinates. With phi_max_rad 0 (a whole sphere, y up, longitude 0 at −z): u = (atan2(n.x, n.z) +
/// π)/2π, v = (asin n.y + π/2)/π, for the outward unit normal n. With phi_max_rad > 0 pbrt's: θ =
/// acos(z/radius), u = φ/phi_max, v = (θ − θ(z_min))/(θ(z_max) − θ(z_min)). contains, volume and
/// closest_point speak of the whole ball, whatever the clipping.
typedef struct sag_sphere {
    sag_vec3 center;
    double radius;       ///< > 0
    double z_min, z_max; ///< relative to the centre; both 0: not clipped
    double phi_max_rad;
} sag_sphere;

/// The verbs of sphere: see shapes.h.
SAG_API sag_status sag_sphere_validate(const sag_sphere *sphere, sag_error *error);
SAG_API sag_box3 sag_sphere_bounds(const sag_sphere *sphere);
SAG_API bool sag_sphere_hit(const sag_sphere *sphere, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_sphere_occluded(const sag_sphere *sphere, const sag_ray *ray);
SAG_API size_t sag_sphere_crossings(const sag_sphere *sphere, const sag_ray *ray, sag_hit *hits,
                                    size_t capacity);
SAG_API void sag_sphere_surface(const sag_sphere *sphere, const sag_ray *ray, const sag_hit *hit,
                                sag_surface *surface);
SAG_API double sag_sphere_area(const sag_sphere *sphere);
SAG_API bool sag_sphere_sample(const sag_sphere *sphere, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_sphere_contains(const sag_sphere *sphere, sag_vec3 point);
SAG_API double sag_sphere_volume(const sag_sphere *sphere);
SAG_API sag_vec3 sag_sphere_closest_point(const sag_sphere *sphere, sag_vec3 point);

/// The ellipsoid Σ ((p − center)ᵢ / radiiᵢ)² = 1. Texture coordinates: a whole sphere's, of the point (p −
/// center)/radii.
typedef struct sag_ellipsoid {
    sag_vec3 center;
    sag_vec3 radii; ///< > 0 each
} sag_ellipsoid;

/// The verbs of ellipsoid: see shapes.h.
SAG_API sag_status sag_ellipsoid_validate(const sag_ellipsoid *ellipsoid, sag_error *error);
SAG_API sag_box3 sag_ellipsoid_bounds(const sag_ellipsoid *ellipsoid);
SAG_API bool sag_ellipsoid_hit(const sag_ellipsoid *ellipsoid, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_ellipsoid_occluded(const sag_ellipsoid *ellipsoid, const sag_ray *ray);
SAG_API size_t sag_ellipsoid_crossings(const sag_ellipsoid *ellipsoid, const sag_ray *ray, sag_hit *hits,
                                       size_t capacity);
SAG_API void sag_ellipsoid_surface(const sag_ellipsoid *ellipsoid, const sag_ray *ray, const sag_hit *hit,
                                   sag_surface *surface);
SAG_API double sag_ellipsoid_area(const sag_ellipsoid *ellipsoid);
SAG_API bool sag_ellipsoid_sample(const sag_ellipsoid *ellipsoid, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_ellipsoid_contains(const sag_ellipsoid *ellipsoid, sag_vec3 point);
SAG_API double sag_ellipsoid_volume(const sag_ellipsoid *ellipsoid);
SAG_API sag_vec3 sag_ellipsoid_closest_point(const sag_ellipsoid *ellipsoid, sag_vec3 point);

/// The cylinder x² + y² = radius², z_min ≤ z ≤ z_max. u = φ/phi_max, v = (z − z_min)/(z_max − z_min).
typedef struct sag_cylinder {
    double radius;       ///< > 0
    double z_min, z_max; ///< z_min < z_max
    double phi_max_rad;
    bool closed;
} sag_cylinder;

/// The verbs of cylinder: see shapes.h.
SAG_API sag_status sag_cylinder_validate(const sag_cylinder *cylinder, sag_error *error);
SAG_API sag_box3 sag_cylinder_bounds(const sag_cylinder *cylinder);
SAG_API bool sag_cylinder_hit(const sag_cylinder *cylinder, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_cylinder_occluded(const sag_cylinder *cylinder, const sag_ray *ray);
SAG_API size_t sag_cylinder_crossings(const sag_cylinder *cylinder, const sag_ray *ray, sag_hit *hits,
                                      size_t capacity);
SAG_API void sag_cylinder_surface(const sag_cylinder *cylinder, const sag_ray *ray, const sag_hit *hit,
                                  sag_surface *surface);
SAG_API double sag_cylinder_area(const sag_cylinder *cylinder);
SAG_API bool sag_cylinder_sample(const sag_cylinder *cylinder, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_cylinder_contains(const sag_cylinder *cylinder, sag_vec3 point);
SAG_API double sag_cylinder_volume(const sag_cylinder *cylinder);
SAG_API sag_vec3 sag_cylinder_closest_point(const sag_cylinder *cylinder, sag_vec3 point);

/// The cone x² + y² = (radius (1 − z/height))², 0 ≤ z ≤ height: base at z = 0, apex at z = height
/// (pbrt-v3's). u = φ/phi_max, v = z/height.
typedef struct sag_cone {
    double radius; ///< > 0
    double height; ///< > 0
    double phi_max_rad;
    bool closed; ///< adds the base
} sag_cone;

/// The verbs of cone: see shapes.h.
SAG_API sag_status sag_cone_validate(const sag_cone *cone, sag_error *error);
SAG_API sag_box3 sag_cone_bounds(const sag_cone *cone);
SAG_API bool sag_cone_hit(const sag_cone *cone, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_cone_occluded(const sag_cone *cone, const sag_ray *ray);
SAG_API size_t sag_cone_crossings(const sag_cone *cone, const sag_ray *ray, sag_hit *hits, size_t capacity);
SAG_API void sag_cone_surface(const sag_cone *cone, const sag_ray *ray, const sag_hit *hit,
                              sag_surface *surface);
SAG_API double sag_cone_area(const sag_cone *cone);
SAG_API bool sag_cone_sample(const sag_cone *cone, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_cone_contains(const sag_cone *cone, sag_vec3 point);
SAG_API double sag_cone_volume(const sag_cone *cone);
SAG_API sag_vec3 sag_cone_closest_point(const sag_cone *cone, sag_vec3 point);

/// The paraboloid z = z_max (x² + y²)/radius², z_min ≤ z ≤ z_max (pbrt-v3's): radius is that at z_max.
/// u = φ/phi_max, v = (z − z_min)/(z_max − z_min). The normal points away from the axis.
typedef struct sag_paraboloid {
    double radius;       ///< > 0
    double z_min, z_max; ///< 0 ≤ z_min < z_max
    double phi_max_rad;
    bool closed;
} sag_paraboloid;

/// The verbs of paraboloid: see shapes.h.
SAG_API sag_status sag_paraboloid_validate(const sag_paraboloid *paraboloid, sag_error *error);
SAG_API sag_box3 sag_paraboloid_bounds(const sag_paraboloid *paraboloid);
SAG_API bool sag_paraboloid_hit(const sag_paraboloid *paraboloid, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_paraboloid_occluded(const sag_paraboloid *paraboloid, const sag_ray *ray);
SAG_API size_t sag_paraboloid_crossings(const sag_paraboloid *paraboloid, const sag_ray *ray, sag_hit *hits,
                                        size_t capacity);
SAG_API void sag_paraboloid_surface(const sag_paraboloid *paraboloid, const sag_ray *ray, const sag_hit *hit,
                                    sag_surface *surface);
SAG_API double sag_paraboloid_area(const sag_paraboloid *paraboloid);
SAG_API bool sag_paraboloid_sample(const sag_paraboloid *paraboloid, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_paraboloid_contains(const sag_paraboloid *paraboloid, sag_vec3 point);
SAG_API double sag_paraboloid_volume(const sag_paraboloid *paraboloid);

/// The segment p1 p2 swept around the z axis (pbrt-v3's): a hyperboloid of one sheet; a cylinder, cone or
/// flat ring in special cases. u = φ/phi_max with φ counted from the segment's own angle, v the place along
/// the segment. One end may lie on the axis. A segment with p1.z = p2.z (a ring) is an error when closed; its
/// normal is +z.
typedef struct sag_hyperboloid {
    sag_vec3 p1, p2; ///< different; not both on the z axis
    double phi_max_rad;
    bool closed;
} sag_hyperboloid;

/// The verbs of hyperboloid: see shapes.h.
SAG_API sag_status sag_hyperboloid_validate(const sag_hyperboloid *hyperboloid, sag_error *error);
SAG_API sag_box3 sag_hyperboloid_bounds(const sag_hyperboloid *hyperboloid);
SAG_API bool sag_hyperboloid_hit(const sag_hyperboloid *hyperboloid, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_hyperboloid_occluded(const sag_hyperboloid *hyperboloid, const sag_ray *ray);
SAG_API size_t sag_hyperboloid_crossings(const sag_hyperboloid *hyperboloid, const sag_ray *ray,
                                         sag_hit *hits, size_t capacity);
SAG_API void sag_hyperboloid_surface(const sag_hyperboloid *hyperboloid, const sag_ray *ray,
                                     const sag_hit *hit, sag_surface *surface);
SAG_API double sag_hyperboloid_area(const sag_hyperboloid *hyperboloid);
SAG_API bool sag_hyperboloid_sample(const sag_hyperboloid *hyperboloid, sag_vec2 random,
                                    sag_surface *surface);
SAG_API bool sag_hyperboloid_contains(const sag_hyperboloid *hyperboloid, sag_vec3 point);
SAG_API double sag_hyperboloid_volume(const sag_hyperboloid *hyperboloid);

/// The hyperboloid of two sheets z²/c² − (x² + y²)/a² = 1, z_min ≤ z ≤ z_max: the upper sheet where z ≥ c,
/// the lower where z ≤ −c. u = φ/phi_max, v = (z − z_min)/(z_max − z_min). The normal points away from the
/// axis. `closed` caps each sheet at the end away from the origin; primitive 1 is then the cap at z_min, 2
/// the cap at z_max.
typedef struct sag_hyperboloid2 {
    double a, c;         ///< > 0
    double z_min, z_max; ///< z_min < z_max, and some of the surface between them
    double phi_max_rad;
    bool closed;
} sag_hyperboloid2;

/// The verbs of hyperboloid2: see shapes.h.
SAG_API sag_status sag_hyperboloid2_validate(const sag_hyperboloid2 *hyperboloid2, sag_error *error);
SAG_API sag_box3 sag_hyperboloid2_bounds(const sag_hyperboloid2 *hyperboloid2);
SAG_API bool sag_hyperboloid2_hit(const sag_hyperboloid2 *hyperboloid2, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_hyperboloid2_occluded(const sag_hyperboloid2 *hyperboloid2, const sag_ray *ray);
SAG_API size_t sag_hyperboloid2_crossings(const sag_hyperboloid2 *hyperboloid2, const sag_ray *ray,
                                          sag_hit *hits, size_t capacity);
SAG_API void sag_hyperboloid2_surface(const sag_hyperboloid2 *hyperboloid2, const sag_ray *ray,
                                      const sag_hit *hit, sag_surface *surface);
SAG_API double sag_hyperboloid2_area(const sag_hyperboloid2 *hyperboloid2);
SAG_API bool sag_hyperboloid2_sample(const sag_hyperboloid2 *hyperboloid2, sag_vec2 random,
                                     sag_surface *surface);
SAG_API bool sag_hyperboloid2_contains(const sag_hyperboloid2 *hyperboloid2, sag_vec3 point);
SAG_API double sag_hyperboloid2_volume(const sag_hyperboloid2 *hyperboloid2);

/// Any quadric by ten coefficients, ax² + by² + cz² + 2dxy + 2exz + 2fyz + 2gx + 2hy + 2iz + j = 0, clipped
/// by a box. The normal is the gradient's direction. The box clips; it adds no faces. u, v: φ/2π and (z −
/// min.z)/(max.z − min.z). contains: the value ≤ 0 inside the box. area is numerical, within 1e-6 of the area
/// of a smooth patch, and takes milliseconds: ask once. sample is exact to rounding; it tries lines through
/// the box, so it also returns false for a patch below some ten-thousandth of the box.
typedef struct sag_quadric {
    double coefficients[10]; ///< a b c d e f g h i j; not all of a … i zero
    sag_box3 clip;           ///< not empty, finite
} sag_quadric;

/// The verbs of quadric: see shapes.h.
SAG_API sag_status sag_quadric_validate(const sag_quadric *quadric, sag_error *error);
SAG_API sag_box3 sag_quadric_bounds(const sag_quadric *quadric);
SAG_API bool sag_quadric_hit(const sag_quadric *quadric, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_quadric_occluded(const sag_quadric *quadric, const sag_ray *ray);
SAG_API size_t sag_quadric_crossings(const sag_quadric *quadric, const sag_ray *ray, sag_hit *hits,
                                     size_t capacity);
SAG_API void sag_quadric_surface(const sag_quadric *quadric, const sag_ray *ray, const sag_hit *hit,
                                 sag_surface *surface);
SAG_API double sag_quadric_area(const sag_quadric *quadric);
SAG_API bool sag_quadric_sample(const sag_quadric *quadric, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_quadric_contains(const sag_quadric *quadric, sag_vec3 point);

#ifdef __cplusplus
}
#endif
#endif
