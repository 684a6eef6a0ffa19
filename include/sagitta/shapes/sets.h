// SPDX-License-Identifier: MIT
/// @file sets.h
/// Many primitives in one geometry: spheres, and what the caller makes.
#ifndef SAGITTA_SHAPES_SETS_H
#define SAGITTA_SHAPES_SETS_H

#include <sagitta/shapes.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Many spheres: molecules, particles. Exactly one of centers_f32 and centers_f64 is given; radii_f32 is NULL
/// when all have the radius `radius`. Spheres that are not finite or have no positive radius are dropped and
/// reported at commit. primitive is the sphere's index. Texture coordinates: a whole sphere's.
typedef struct sag_spheres {
    const float *centers_f32;  ///< x y z of each sphere, or NULL
    const double *centers_f64; ///< x y z of each sphere, or NULL
    const float *radii_f32;    ///< of each sphere, or NULL
    double radius;             ///< when radii_f32 is NULL
    uint32_t count;            ///< > 0
} sag_spheres;

/// The verbs of spheres: see shapes.h. They visit every sphere: use a scene for more than a few. area is the
/// sum.
SAG_API sag_status sag_spheres_validate(const sag_spheres *spheres, sag_error *error);
SAG_API sag_box3 sag_spheres_bounds(const sag_spheres *spheres);
SAG_API bool sag_spheres_hit(const sag_spheres *spheres, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_spheres_occluded(const sag_spheres *spheres, const sag_ray *ray);
SAG_API size_t sag_spheres_crossings(const sag_spheres *spheres, const sag_ray *ray, sag_hit *hits,
                                     size_t capacity);
SAG_API void sag_spheres_surface(const sag_spheres *spheres, const sag_ray *ray, const sag_hit *hit,
                                 sag_surface *surface);
SAG_API double sag_spheres_area(const sag_spheres *spheres);
SAG_API bool sag_spheres_sample(const sag_spheres *spheres, sag_vec2 random, sag_surface *surface);
SAG_API bool sag_spheres_contains(const sag_spheres *spheres, sag_vec3 point);
SAG_API sag_vec3 sag_spheres_closest_point(const sag_spheres *spheres, sag_vec3 point);

/// Collects what a user-defined shape's callback finds; see sag_user.
typedef struct sag_user_report sag_user_report;

/// Tells of a crossing of `primitive` at t with the caller's u, v. Any order; t outside the ray's range or
/// NaN is ignored. Returns the t beyond which crossings are of no interest any more (the ray's t_max, or less
/// once something was found).
SAG_API double sag_user_report_hit(sag_user_report *report, uint32_t primitive, double t, double u, double v);

/// A shape of the caller's own, as a set of primitives in boxes. The callbacks are called from many threads
/// at once and must not call back into the scene under construction.
typedef struct sag_user {
    uint32_t primitive_count; ///< > 0
    void *user;               ///< handed to the callbacks; must outlive the scene
    /// The box of a primitive; conservative. An empty or non-finite box drops the primitive.
    sag_box3 (*bounds)(void *user, uint32_t primitive);
    /// Reports the crossings of the ray with the `count` primitives listed, all of them
    /// (sag_user_report_hit).
    void (*crossings)(void *user, const uint32_t *primitives, size_t count, const sag_ray *ray,
                      sag_user_report *report);
    /// Fills position, position_error, geometric_normal, shading_normal, dpdu, dpdv, u and v; the library
    /// does the rest. A zero position_error is replaced by 16 ulp of the position.
    void (*surface)(void *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface);
} sag_user;

/// The verbs of user: see shapes.h. area is 0 and sample false: the library cannot know.
SAG_API sag_status sag_user_validate(const sag_user *user, sag_error *error);
SAG_API sag_box3 sag_user_bounds(const sag_user *user);
SAG_API bool sag_user_hit(const sag_user *user, const sag_ray *ray, sag_hit *hit);
SAG_API bool sag_user_occluded(const sag_user *user, const sag_ray *ray);
SAG_API size_t sag_user_crossings(const sag_user *user, const sag_ray *ray, sag_hit *hits, size_t capacity);
SAG_API void sag_user_surface(const sag_user *user, const sag_ray *ray, const sag_hit *hit,
                              sag_surface *surface);
SAG_API double sag_user_area(const sag_user *user);
SAG_API bool sag_user_sample(const sag_user *user, sag_vec2 random, sag_surface *surface);

#ifdef __cplusplus
}
#endif
#endif
