// SPDX-License-Identifier: MIT
// The triangle a b c: p = (1 − u − v) a + u b + v c, u, v ≥ 0, u + v ≤ 1. The ray test is in triangle_test.c
// and triangle_solve.h; here is everything else about one triangle, for mesh as well.
//
// Position and its error. p = (a + u (b − a)) + v (c − a): for any weights, however inexact, the result is
// off the triangle's plane by roundings only, per coordinate at most 2ε (|a| + 2u |b − a| + 2v |c − a|), ε =
// 2⁻⁵³ (the differences, products and sums, one ε each). That is its distance from the point of the triangle
// at the u, v reported. 64ε of the longest edge is added in every coordinate: a spawned ray then starts so
// far off the plane (8ε S(a − o)/|n| and more, see triangle_solve.h) that the test in doubles turns its own
// triangle away, unless that is a needle.
#include "shapes/triangle.h"
#include "math/map.h"
#include "shapes/common.h"
#include "shapes/vector_expansion.h"

static inline double larger(double a, double b) { return a > b ? a : b; }
static inline double norm_max(sag_vec3 a) { return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z))); }

static double length_scaled(sag_vec3 a) {
    double largest = norm_max(a);
    return largest > 0 ? largest * sag_length(sag_scale(a, 1 / largest)) : 0;
}

double sagi_triangle_normal(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c, sag_vec3 *unit) {
    sag_vec3 ab = sag_sub(*b, *a), ac = sag_sub(*c, *a), n = sag_cross(ab, ac);
    if (sagi_cross_is_good(norm_max(n), larger(norm_max(ab), norm_max(ac)))) {
        *unit = sagi_normalize(n);
        return length_scaled(n);
    }
    if (!sag_is_finite(ab) || !sag_is_finite(ac)) return 0;
    sagi_expansion3 x = sagi_expansion3_from_diff(*b, *a), y = sagi_expansion3_from_diff(*c, *a);
    int exponent = -sagi_expansion3_normalize(&x) - sagi_expansion3_normalize(&y);
    sagi_expansion3 cross = sagi_expansion3_cross(&x, &y);
    exponent -= sagi_expansion3_normalize(&cross);
    n = sag_vec3_make(sagi_expansion_estimate(cross.count[0], cross.terms[0]),
                      sagi_expansion_estimate(cross.count[1], cross.terms[1]),
                      sagi_expansion_estimate(cross.count[2], cross.terms[2]));
    double length = length_scaled(n);
    if (length > 0) *unit = sag_normalize(n);
    return ldexp(length, exponent);
}

static double position(double a, double ab, double ac, double u, double v, double *error) {
    *error = 2 * SAGI_EPSILON * (fabs(a) + 2 * (u * fabs(ab) + v * fabs(ac)));
    return a + u * ab + v * ac;
}

void sagi_triangle_point(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c, double u, double v,
                         sag_surface *surface) {
    sag_vec3 ab = sag_sub(*b, *a), ac = sag_sub(*c, *a), error;
    surface->position.x = position(a->x, ab.x, ac.x, u, v, &error.x);
    surface->position.y = position(a->y, ab.y, ac.y, u, v, &error.y);
    surface->position.z = position(a->z, ab.z, ac.z, u, v, &error.z);
    double edge = larger(norm_max(ab), norm_max(ac)), margin = 64 * SAGI_EPSILON * edge;
    surface->position_error = sag_add(error, sag_vec3_make(margin, margin, margin));
    sag_vec3 n = sag_cross(ab, ac);
    if (sagi_cross_is_good(norm_max(n), edge)) {
        surface->geometric_normal = sagi_normalize(n);
    } else {
        surface->geometric_normal = sag_vec3_make(0, 0, 1);
        sagi_triangle_normal(a, b, c, &surface->geometric_normal);
    }
    surface->dpdu = ab;
    surface->dpdv = ac;
    surface->u = u;
    surface->v = v;
}

// The square root spreads the points evenly: the part of the area farther from a than the fraction s is
// 1 − s².
void sagi_triangle_sample_weights(sag_vec2 random, double *u, double *v) {
    double s = sqrt(random.x);
    *u = s * (1 - random.y);
    *v = s * random.y;
}

// Which of the seven regions of the plane (three at vertices, three at edges, the inside) the point projects
// to, after Ericson, Real-Time Collision Detection, §5.1.5.
sag_vec3 sagi_triangle_closest_point(const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c,
                                     sag_vec3 point) {
    sag_vec3 ab = sag_sub(*b, *a), ac = sag_sub(*c, *a), ap = sag_sub(point, *a);
    double d1 = sag_dot(ab, ap), d2 = sag_dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return *a;
    sag_vec3 bp = sag_sub(point, *b);
    double d3 = sag_dot(ab, bp), d4 = sag_dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return *b;
    double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) return sag_madd(*a, d1 / (d1 - d3), ab);
    sag_vec3 cp = sag_sub(point, *c);
    double d5 = sag_dot(ab, cp), d6 = sag_dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return *c;
    double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) return sag_madd(*a, d2 / (d2 - d6), ac);
    double va = d3 * d6 - d5 * d4, along = d4 - d3, back = d5 - d6;
    if (va <= 0 && along >= 0 && back >= 0 && along + back > 0)
        return sag_madd(*b, along / (along + back), sag_sub(*c, *b));
    double sum = va + vb + vc;
    if (!(sum > 0)) return *a;
    return sag_madd(sag_madd(*a, vb / sum, ab), vc / sum, ac);
}

static sag_status check_vertex(const char *name, sag_vec3 p, sag_error *error) {
    if (sag_is_finite(p) && norm_max(p) <= SAG_MAX_COORDINATE) return SAG_OK;
    return sag_error_set(error, SAG_ERROR_GEOMETRY,
                         "triangle.%s is (%g, %g, %g): not finite or beyond SAG_MAX_COORDINATE", name, p.x,
                         p.y, p.z);
}

sag_status sag_triangle_validate(const sag_triangle *s, sag_error *error) {
    sag_status status = check_vertex("a", s->a, error);
    if (status == SAG_OK) status = check_vertex("b", s->b, error);
    if (status == SAG_OK) status = check_vertex("c", s->c, error);
    if (status == SAG_OK && !sagi_triangle_has_area(&s->a, &s->b, &s->c))
        status = sag_error_set(error, SAG_ERROR_GEOMETRY,
                               "triangle.a, b, c lie on one line: (%g, %g, %g), (%g, %g, %g), (%g, %g, %g)",
                               s->a.x, s->a.y, s->a.z, s->b.x, s->b.y, s->b.z, s->c.x, s->c.y, s->c.z);
    return status;
}

sag_box3 sag_triangle_bounds(const sag_triangle *s) {
    if (sag_triangle_validate(s, NULL) != SAG_OK) return sag_box3_empty();
    sag_box3 box = {s->a, s->a};
    return sag_box3_extend(sag_box3_extend(box, s->b), s->c);
}

bool sag_triangle_hit(const sag_triangle *s, const sag_ray *ray, sag_hit *hit) {
    if (!sag_ray_is_valid(ray)) return false;
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    double t, u, v;
    if (!sagi_triangle_hit(&prepared, &s->a, &s->b, &s->c, s->one_sided, &t, &u, &v)) return false;
    *hit = sagi_hit_make(t, u, v, 0);
    return true;
}

bool sag_triangle_occluded(const sag_triangle *s, const sag_ray *ray) {
    sag_hit hit;
    return sag_triangle_hit(s, ray, &hit);
}

size_t sag_triangle_crossings(const sag_triangle *s, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sag_hit hit;
    if (!sag_triangle_hit(s, ray, &hit)) return 0;
    if (capacity > 0) hits[0] = hit;
    return 1;
}

void sag_triangle_surface(const sag_triangle *s, const sag_ray *ray, const sag_hit *hit,
                          sag_surface *surface) {
    sagi_triangle_point(&s->a, &s->b, &s->c, hit->u, hit->v, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_triangle_area(const sag_triangle *s) {
    sag_vec3 unit;
    if (sag_triangle_validate(s, NULL) != SAG_OK) return 0;
    return 0.5 * sagi_triangle_normal(&s->a, &s->b, &s->c, &unit);
}

bool sag_triangle_sample(const sag_triangle *s, sag_vec2 random, sag_surface *surface) {
    if (!sagi_triangle_is_finite(&s->a, &s->b, &s->c) || !sagi_triangle_has_area(&s->a, &s->b, &s->c))
        return false;
    double u, v;
    sagi_triangle_sample_weights(random, &u, &v);
    sagi_triangle_point(&s->a, &s->b, &s->c, u, v, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

sag_vec3 sag_triangle_closest_point(const sag_triangle *s, sag_vec3 point) {
    return sagi_triangle_closest_point(&s->a, &s->b, &s->c, point);
}
