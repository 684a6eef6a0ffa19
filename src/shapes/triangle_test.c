// SPDX-License-Identifier: MIT
// Whether a ray's line pierces a triangle, exactly.
//
// The line is o + t d. Seen along d the triangle a b c is a triangle in the plane and the line a point; the
// point is inside when it lies on the same side of all three edges. The side of the edge from a to b is the
// sign of the edge function
//
//     e(a, b) = det(d, a − o, b − o) = (d × (a − o)) · (b − a),
//
// which changes sign when a and b change places: two triangles that share an edge and run through it in
// opposite directions, as neighbours of one surface do, see opposite signs, whatever the rest of them is.
// The three functions add up to D = d · n with n = (b − a) × (c − a), so three equal signs are the sign of D.
//
// Filter. Each operation in double gives (1 + δ), |δ| ≤ u = 2⁻⁵³. From the inputs to the result of e there
// are at most seven on one path (a − o, times d, minus; b − a, times, two additions), so the error is below
// 7.01u times the sum of the products' absolute values, and that sum is at most |d|₁ |a − o|₁ |b − a|∞: the
// cross product pairs each |d_j| with each |(a − o)_k|, j ≠ k, once. With 8u in place of 7.01u the roundings
// in the bound itself are covered. It is the length of the edge that counts, not the distance of the second
// vertex: a far origin costs little. The filter speaks only when magnitudes are such that no product that
// matters under- or overflows (see the limits below); NaN and infinities fail those comparisons.
//
// Exact. What the filter leaves is computed in expansions (vector_expansion.h), from the edge's two ends in
// lexicographic order, so that both neighbours do the very same calculation. It is exact as long as within
// each of the vectors d, a − o, b − a and d × (a − o) no part is smaller than 2⁻⁹³⁵ (1e-281) of the largest:
// for all coordinates and origins between 2⁻⁴⁰⁰ and 2¹⁰⁰ and directions of any length, for instance. Smaller
// parts count as 0; the two sides of an edge still agree then, and agree with the filter.
//
// Ties. When e(a, b) = 0 the line meets the edge's line. It is decided as if the origin were
// o + w, w = (ε, ε², ε³), with ε > 0 so small that nothing else changes:
//
//     e_w(a, b) = (d × (a − o − w)) · (b − a) = e(a, b) + w · (d × (b − a)),
//
// so the sign of a zero e is that of the first component of d × (b − a) that is not 0. Why this is right: of
// any finite set of triangles, none has an edge function that vanishes for the moved line, but for edges
// parallel to d. So there is an ε > 0 for which the moved ray is an ordinary ray that meets no edge and no
// vertex, and every sign taken is the one of that ray. It crosses a closed surface as any line does: through
// an edge or a vertex that lies in its way into the inside, one triangle takes it; past a silhouette, none or
// two; parity is always right. An edge parallel to d has e_w = 0 always, and its triangles have D = 0: they
// are missed, as are all triangles in whose plane the ray lies; moving the origin does not change D, so the
// moved ray, parallel to such a plane and not in it, misses them as well. The rule depends on the ray and the
// two ends of the edge alone. (Edelsbrunner & Mücke, "Simulation of Simplicity", TOG 9(1), 1990; Shewchuk,
// "Adaptive Precision Floating-Point Arithmetic", 1997.) A triangle without area has D = 0, and signs that
// add up to 0 are never all equal: it is missed without being asked.
#include "shapes/common.h"
#include "shapes/triangle.h"
#include "shapes/vector_expansion.h"

#if defined(__GNUC__)
#define SAGI_COLD __attribute__((noinline, cold))
#else
#define SAGI_COLD
#endif

static double norm1(sag_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }
static double larger(double a, double b) { return a > b ? a : b; }
static double norm_max(sag_vec3 a) { return larger(larger(fabs(a.x), fabs(a.y)), fabs(a.z)); }

static bool before(const sag_vec3 *a, const sag_vec3 *b) {
    if (a->x != b->x) return a->x < b->x;
    if (a->y != b->y) return a->y < b->y;
    return a->z < b->z;
}

// The sign of e_w(a, b), by expansions; 0 only for an edge parallel to the ray or without length.
static int edge_sign(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b) {
    if (before(b, a)) return -edge_sign(ray, b, a);
    sagi_expansion3 d = sagi_expansion3_from(ray->d);
    sagi_expansion3 from_o = sagi_expansion3_from_diff(*a, ray->o);
    sagi_expansion3 edge = sagi_expansion3_from_diff(*b, *a);
    sagi_expansion3_normalize(&d);
    sagi_expansion3_normalize(&from_o);
    sagi_expansion3_normalize(&edge);
    sagi_expansion3 moment = sagi_expansion3_cross(&d, &from_o);
    sagi_expansion3_normalize(&moment);
    double sum[192];
    int n = sagi_expansion3_dot(&moment, &edge, sum);
    for (int i = 0; n == 0 && i < 3; i++) n = sagi_expansion3_cross_component(&d, &edge, i, sum);
    return sagi_expansion_sign(n, sum);
}

// The signs the filter could not tell: `known` holds −1 or 1 for an edge it could, else 0.
static SAGI_COLD int side_exact(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                                const sag_vec3 *c, const int known[3]) {
    if (!sagi_triangle_is_finite(a, b, c)) return 0;
    int first = known[0] ? known[0] : edge_sign(ray, a, b);
    if (first == 0 || first == -known[1] || first == -known[2]) return 0;
    int second = known[1] ? known[1] : edge_sign(ray, b, c);
    if (second != first) return 0;
    int third = known[2] ? known[2] : edge_sign(ray, c, a);
    return third == first ? first : 0;
}

int sagi_triangle_side(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                       const sag_vec3 *c) {
    sag_vec3 ao = sag_sub(*a, ray->o), bo = sag_sub(*b, ray->o);
    sag_vec3 ab = sag_sub(*b, *a), bc = sag_sub(*c, *b), ca = sag_sub(*a, *c);
    sag_vec3 a_moment = sag_cross(ray->d, ao), b_moment = sag_cross(ray->d, bo);
    double e_ab = sag_dot(a_moment, ab), e_bc = sag_dot(b_moment, bc), e_ca = sag_dot(a_moment, ca);

    // e(c, a) = −e(a, c) = (d × (a − o)) · (a − c): the two edges at a share their moment.
    double far = larger(norm1(ao), norm1(bo));
    double size = larger(norm_max(ab), larger(norm_max(bc), norm_max(ca)));
    double bound = 8 * SAGI_EPSILON * ray->d1 * far * size;

    // Within these limits (|d|₁ is in [2⁻⁶⁴, 2⁶⁶]) the bound is at least 2⁻⁷¹⁴, far above what underflow can
    // do, and nothing overflows.
    if (far >= 0x1p-300 && far <= 0x1p500 && size >= 0x1p-300 && size <= 0x1p200) {
        if (e_ab > bound && e_bc > bound && e_ca > bound) return 1;
        if (e_ab < -bound && e_bc < -bound && e_ca < -bound) return -1;
        const int known[3] = {(e_ab > bound) - (e_ab < -bound), (e_bc > bound) - (e_bc < -bound),
                              (e_ca > bound) - (e_ca < -bound)};
        if (known[0] * known[1] < 0 || known[1] * known[2] < 0 || known[2] * known[0] < 0) return 0;
        return side_exact(ray, a, b, c, known);
    }
    return side_exact(ray, a, b, c, (const int[3]){0, 0, 0});
}

bool sagi_triangle_is_finite(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c) {
    return norm_max(*a) <= SAG_MAX_COORDINATE && norm_max(*b) <= SAG_MAX_COORDINATE &&
           norm_max(*c) <= SAG_MAX_COORDINATE && sag_is_finite(*a) && sag_is_finite(*b) && sag_is_finite(*c);
}

static SAGI_COLD bool has_area_exact(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c) {
    sagi_expansion3 ab = sagi_expansion3_from_diff(*b, *a), ac = sagi_expansion3_from_diff(*c, *a);
    sagi_expansion3_normalize(&ab);
    sagi_expansion3_normalize(&ac);
    sagi_expansion3 n = sagi_expansion3_cross(&ab, &ac);
    return n.count[0] + n.count[1] + n.count[2] > 0;
}

// Each component of n has an error below 4.01u times the sum of its two products' absolute values (b − a, c −
// a, times, minus).
bool sagi_triangle_has_area(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c) {
    sag_vec3 ab = sag_sub(*b, *a), ac = sag_sub(*c, *a);
    double bound = 10 * SAGI_EPSILON * norm_max(ab) * norm_max(ac);
    if (bound >= 0x1p-900 && norm_max(sag_cross(ab, ac)) > bound) return true;
    return has_area_exact(a, b, c);
}
