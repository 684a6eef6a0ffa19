// SPDX-License-Identifier: MIT
// The area of a shape under an affine map.
//
// A similarity multiplies it by the square of its scale. Any other map p ↦ M p + s enlarges a small piece
// with the unit normal n by J(n) = |det M| |M⁻ᵀ n|:
//   * flat faces (disk, rectangle, polygon, triangle, box, polyhedron) each by one J: exact;
//   * an ellipsoid becomes another, whose radii are known from its second moments: with C = V/5 B Bᵀ the
//     squares of the radii are the eigenvalues of 5 C/V, and the area is 4π R_G(r₁²r₂², r₂²r₃², r₃²r₁²)
//     (Carlson; NIST DLMF 19.33.1). Sphere and closed quadric are ellipsoids;
//   * all others: the mean of J over points that the shape itself spreads evenly, times its area. J is
//     smooth, so scrambled Sobol' points are soon good for five digits; 32 randomisations say how good.
//
// A spindle torus: hits and its own area know the inner sheet, the boundary of the body is the outer one.
// With cos β = −R/r that is 2π r ∫ over |ψ| ≤ β of R + r cos ψ, = 4π r (R β + r sin β); and of points on
// both, those with |ψ| > β do not count.
#include "math/elementary.h"
#include "measure/measure.h"
#include "shapes/carlson.h"
#include "shapes/polyhedron_face.h"
#include "shapes/shape.h"

#define FIRST_POINTS 64
#define MOST_POINTS  16384

// Where the outer sheet ends, as v = ψ/2π; 0.5 for a ring.
static double torus_end(const sag_torus *t) {
    return t->major_radius < t->minor_radius ? sagi_acos(-t->major_radius / t->minor_radius) / (2 * SAGI_PI)
                                             : 0.5;
}

// The area in the shape's own space.
static double own_area(sag_shape_kind kind, const void *shape) {
    if (kind == SAG_SHAPE_USER) return NAN; // the library cannot know
    if (kind == SAG_SHAPE_TORUS) {
        const sag_torus *t = shape;
        const double beta = 2 * SAGI_PI * torus_end(t), major = t->major_radius, minor = t->minor_radius;
        if (major < minor) return 4 * SAGI_PI * minor * (major * beta + minor * sagi_sin(beta));
    }
    return sagi_shape_classes[kind].area(shape);
}

static double enlargement(const sagi_place *place, double determinant, sag_vec3 normal) {
    return determinant * sag_length(sag_affine_transposed(&place->to_object, normal));
}

static double polyhedron_area(const sag_polyhedron *p, const sagi_place *place, double determinant) {
    double sum = 0;
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < p->plane_count; i++) {
        sagi_polyhedron_face_find(p, i, &face);
        if (face.count < 3) continue;
        if (face.unbounded) return INFINITY;
        sum += sagi_polyhedron_face_area(&face) *
               enlargement(place, determinant, sag_normalize(p->planes[i].normal));
    }
    return sum;
}

static double parallelepiped_area(const sag_vec3 half_axes[3], const sag_affine *map) {
    sag_vec3 a[3];
    for (int i = 0; i < 3; i++) a[i] = sag_affine_vector(map, half_axes[i]);
    return 8 * (sag_length(sag_cross(a[0], a[1])) + sag_length(sag_cross(a[1], a[2])) +
                sag_length(sag_cross(a[2], a[0])));
}

static double box_area(const sag_box *box, const sag_affine *map) {
    const sag_vec3 half = sag_sub(sag_scale(box->max, 0.5), sag_scale(box->min, 0.5));
    const sag_vec3 axes[3] = {{half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z}};
    return parallelepiped_area(axes, map);
}

static double ellipsoid_area(sag_shape_kind kind, const void *shape, const sag_affine *map) {
    sagi_moments m;
    if (!sagi_shape_moments(kind, shape, &m)) return NAN;
    m = sagi_moments_map(&m, map);
    const double f = 5 / m.volume, *c = m.central;
    const double square[3][3] = {
        {f * c[0], f * c[3], f * c[4]}, {f * c[3], f * c[1], f * c[5]}, {f * c[4], f * c[5], f * c[2]}};
    double r[3];
    sag_vec3 axes[3];
    sagi_symmetric_eigen(square, r, axes);
    for (int i = 0; i < 3; i++) r[i] = fmax(r[i], 0);
    return 4 * SAGI_PI * sagi_carlson_rg(r[0] * r[1], r[1] * r[2], r[2] * r[0]);
}

// ∫ J over the points first … count − 1 of one randomisation, times their density.
static bool sum_points(sag_shape_kind kind, const void *shape, const sagi_place *place, uint64_t key,
                       uint32_t first, uint32_t count, double *sum) {
    const double determinant = fabs(sag_affine_determinant(&place->to_scene));
    const double end = kind == SAG_SHAPE_TORUS ? torus_end(shape) : 1;
    for (uint32_t i = first; i < count; i++) {
        sag_surface s;
        if (!sagi_shape_classes[kind].sample(shape, sagi_measure_point(key, i), &s)) return false;
        const bool inner = kind == SAG_SHAPE_TORUS && s.v > end && s.v < 1 - end;
        if (!inner) *sum += enlargement(place, determinant, s.geometric_normal);
    }
    return true;
}

static sag_estimate sampled_area(sag_shape_kind kind, const void *shape, const sagi_place *place,
                                 const sag_measure_options *options, uint64_t seed) {
    // The shape's own area, of both sheets of a torus, is what its points are spread over.
    const double area = sagi_shape_classes[kind].area(shape);
    double sums[SAGI_REPLICATES] = {0}, means[SAGI_REPLICATES];
    const sag_estimate unknown = {NAN, NAN};
    if (!(area > 0) || !isfinite(area)) return unknown;
    for (uint32_t from = 0, to = FIRST_POINTS;; from = to, to *= 2) {
        for (uint32_t r = 0; r < SAGI_REPLICATES; r++) {
            if (!sum_points(kind, shape, place, sagi_line_key(seed, r, 0), from, to, &sums[r]))
                return unknown;
            means[r] = area * sums[r] / to;
        }
        const sag_estimate e = sagi_mean_estimate(means, SAGI_REPLICATES, options->confidence);
        if (e.error <= 0.1 * options->error * e.value || to >= MOST_POINTS) return e;
    }
}

sag_estimate sagi_shape_area(sag_shape_kind kind, const void *shape, const sagi_place *place,
                             const sag_measure_options *options, uint64_t seed) {
    if (place == NULL) return (sag_estimate){own_area(kind, shape), 0};
    const double determinant = fabs(sag_affine_determinant(&place->to_scene));
    if (place->similarity) {
        const double scale = sagi_cbrt(determinant);
        return (sag_estimate){own_area(kind, shape) * scale * scale, 0};
    }
    switch (kind) {
    case SAG_SHAPE_SPHERE:
    case SAG_SHAPE_ELLIPSOID:
    case SAG_SHAPE_QUADRIC:
        if (sagi_shape_state(kind, shape) != SAG_BODY_CLOSED) break;
        return (sag_estimate){ellipsoid_area(kind, shape, &place->to_scene), 0};
    case SAG_SHAPE_BOX: return (sag_estimate){box_area(shape, &place->to_scene), 0};
    case SAG_SHAPE_ORIENTED_BOX:
        return (sag_estimate){
            parallelepiped_area(((const sag_oriented_box *)shape)->half_axes, &place->to_scene), 0};
    case SAG_SHAPE_POLYHEDRON: return (sag_estimate){polyhedron_area(shape, place, determinant), 0};
    case SAG_SHAPE_DISK:
    case SAG_SHAPE_RECTANGLE:
    case SAG_SHAPE_POLYGON:
    case SAG_SHAPE_TRIANGLE: {
        sag_surface s;
        if (!sagi_shape_classes[kind].sample(shape, (sag_vec2){0.5, 0.5}, &s)) break;
        return (sag_estimate){own_area(kind, shape) * enlargement(place, determinant, s.geometric_normal), 0};
    }
    case SAG_SHAPE_PLANE: return (sag_estimate){INFINITY, 0};
    case SAG_SHAPE_USER:
    case SAG_SHAPE_MESH:
    case SAG_SHAPE_INSTANCE: return (sag_estimate){NAN, 0};
    case SAG_SHAPE_CYLINDER:
    case SAG_SHAPE_CONE:
    case SAG_SHAPE_PARABOLOID:
    case SAG_SHAPE_HYPERBOLOID:
    case SAG_SHAPE_HYPERBOLOID2:
    case SAG_SHAPE_CAPSULE:
    case SAG_SHAPE_BILINEAR_PATCH:
    case SAG_SHAPE_TORUS:
    case SAG_SHAPE_SPHERES: break;
    }
    return sampled_area(kind, shape, place, options, seed);
}
