// SPDX-License-Identifier: MIT
/// @file math.h
/// Vectors, boxes, affine maps and rays, all in double precision. Right-handed; lengths in the caller's unit;
/// angles in radians, named `_rad`. The inline functions round once per operation and keep no state.
#ifndef SAGITTA_MATH_H
#define SAGITTA_MATH_H

#include <math.h>
#include <sagitta/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sag_vec2 {
    double x, y;
} sag_vec2;

typedef struct sag_vec3 {
    double x, y, z;
} sag_vec3;

/// The points with min ≤ p ≤ max in every coordinate; empty when min > max in any.
typedef struct sag_box3 {
    sag_vec3 min, max;
} sag_box3;

/// The affine map p ↦ M p + t, as the rows of the 3×4 matrix [M | t]. Zero-initialised it is singular, not
/// the identity.
typedef struct sag_affine {
    double m[3][4];
} sag_affine;

/// Kinds of ray, for masks: a geometry is seen by a ray when their masks share a bit; a mask of 0 counts as
/// all bits. The library only compares bits; the renderer uses these names.
enum {
    SAG_RAY_CAMERA = 1u << 0,
    SAG_RAY_SHADOW = 1u << 1,
    SAG_RAY_REFLECTION = 1u << 2,
    SAG_RAY_REFRACTION = 1u << 3,
    SAG_RAY_DIFFUSE = 1u << 4,
    SAG_RAY_USER = 1u << 16, ///< this and the higher bits are the caller's
};

/// The points origin + t·direction with t in the closed interval [t_min, t_max]. The direction has any length
/// but 0; t counts in directions, so it is a distance only when the direction is a unit. A ray with a NaN
/// anywhere, an infinite origin or direction, a zero direction, or t_min > t_max meets nothing. t_min may be
/// negative, t_max infinite. Mind that a zero-initialised t_max is 0: use sag_ray_make or set it.
typedef struct sag_ray {
    sag_vec3 origin;
    sag_vec3 direction;
    double t_min, t_max;
    uint32_t mask; ///< kinds of this ray; 0: sees everything
} sag_ray;

static inline sag_vec3 sag_vec3_make(double x, double y, double z) {
    sag_vec3 v;
    v.x = x, v.y = y, v.z = z;
    return v;
}
static inline sag_vec3 sag_add(sag_vec3 a, sag_vec3 b) {
    return sag_vec3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline sag_vec3 sag_sub(sag_vec3 a, sag_vec3 b) {
    return sag_vec3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline sag_vec3 sag_mul(sag_vec3 a, sag_vec3 b) {
    return sag_vec3_make(a.x * b.x, a.y * b.y, a.z * b.z);
}
static inline sag_vec3 sag_scale(sag_vec3 a, double s) { return sag_vec3_make(a.x * s, a.y * s, a.z * s); }
static inline sag_vec3 sag_neg(sag_vec3 a) { return sag_vec3_make(-a.x, -a.y, -a.z); }
/// a + s·b
static inline sag_vec3 sag_madd(sag_vec3 a, double s, sag_vec3 b) {
    return sag_vec3_make(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double sag_dot(sag_vec3 a, sag_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline sag_vec3 sag_cross(sag_vec3 a, sag_vec3 b) {
    return sag_vec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double sag_length(sag_vec3 a) { return sqrt(sag_dot(a, a)); }
static inline sag_vec3 sag_abs(sag_vec3 a) { return sag_vec3_make(fabs(a.x), fabs(a.y), fabs(a.z)); }
static inline double sag_max_component(sag_vec3 a) { return fmax(a.x, fmax(a.y, a.z)); }
/// The component by number: 0 is x, 1 is y, 2 is z.
static inline double sag_component(sag_vec3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }
static inline bool sag_is_finite(sag_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

/// a/|a|. Scaled inside, so no length overflows or underflows; a zero vector comes back as it is.
SAG_API sag_vec3 sag_normalize(sag_vec3 a);

/// Two unit vectors that make a right-handed orthonormal frame s, t, n with the unit vector n (s × t = n).
/// Continuous but at n.z = 0's sign change (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT
/// 6(1), 2017).
SAG_API void sag_frame(sag_vec3 n, sag_vec3 *s, sag_vec3 *t);

/// The empty box: min = +∞, max = −∞; extending it by a point gives that point.
SAG_API sag_box3 sag_box3_empty(void);
/// True when no point is inside; also for NaN.
SAG_API bool sag_box3_is_empty(const sag_box3 *box);
/// The smallest box that holds both. An empty box adds nothing.
SAG_API sag_box3 sag_box3_union(sag_box3 a, sag_box3 b);
/// The smallest box that holds the box and the point.
SAG_API sag_box3 sag_box3_extend(sag_box3 box, sag_vec3 point);

/// The identity, a test for it (exact, element by element), a move, and a scaling along the axes.
SAG_API sag_affine sag_affine_identity(void);
SAG_API bool sag_affine_is_identity(const sag_affine *a);
SAG_API sag_affine sag_affine_translate(sag_vec3 offset);
SAG_API sag_affine sag_affine_scale(sag_vec3 factors);
/// Rotation about an axis through 0, right-handed; the axis need not be a unit. The identity for a zero axis.
/// Right angles are exact: cos 90° is 0.
SAG_API sag_affine sag_affine_rotate(double angle_rad, sag_vec3 axis);
/// The map whose columns are x, y, z and whose translation is `origin`.
SAG_API sag_affine sag_affine_from_columns(sag_vec3 x, sag_vec3 y, sag_vec3 z, sag_vec3 origin);
/// A rigid map that takes the z axis to the direction from → to and 0 to `from`: places a shape that stands
/// on z.
SAG_API sag_affine sag_affine_along(sag_vec3 from, sag_vec3 to);
/// The map p ↦ a(b(p)).
SAG_API sag_affine sag_affine_multiply(const sag_affine *a, const sag_affine *b);
/// Writes the inverse and returns true; false, writing nothing, when the map is singular or not finite.
SAG_API bool sag_affine_inverse(const sag_affine *a, sag_affine *inverse);
/// The determinant of M; its sign is that of the handedness.
SAG_API double sag_affine_determinant(const sag_affine *a);
SAG_API sag_vec3 sag_affine_point(const sag_affine *a, sag_vec3 p);
SAG_API sag_vec3 sag_affine_vector(const sag_affine *a, sag_vec3 v);
/// Mᵀ n: maps normals *back*; apply it with the inverse map to send a normal forth. Not normalised.
SAG_API sag_vec3 sag_affine_transposed(const sag_affine *a, sag_vec3 n);
/// The box of the image of a box: conservative, rounded outward. Empty stays empty; infinite extents stay
/// infinite.
SAG_API sag_box3 sag_affine_box(const sag_affine *a, const sag_box3 *box);

/// A ray with t in [0, ∞) that sees everything.
SAG_API sag_ray sag_ray_make(sag_vec3 origin, sag_vec3 direction);
/// The image of a ray; the direction is not normalised, so t means the same on both.
SAG_API sag_ray sag_ray_transform(const sag_affine *a, const sag_ray *ray);
/// False for the rays that meet nothing by definition (see sag_ray).
SAG_API bool sag_ray_is_valid(const sag_ray *ray);
/// origin + t·direction
static inline sag_vec3 sag_ray_at(const sag_ray *ray, double t) {
    return sag_madd(ray->origin, t, ray->direction);
}

#ifdef __cplusplus
}
#endif
#endif
