// SPDX-License-Identifier: MIT
// The bilinear patch p(u, v) = (1−u)(1−v) p00 + u(1−v) p10 + (1−u)v p01 + uv p11: the verbs. The ray is in
// bilinear_solve.c, area and sampling in bilinear_area.c.
//
// Position and its error. Every u, v gives a point of the patch, so off the patch the position is by
// roundings only: p00 + u e + v (f + u k) with e, f, k edges and twist, at most 8ε (|p00| + |e| + |f| + 2|k|)
// per coordinate, ε = 2⁻⁵³; along the patch by what u and v are off, a few ε of the edges unless the ray
// grazes.
#include "shapes/bilinear.h"
#include "shapes/triangle.h"

static sag_status check_corner(const char *name, sag_vec3 p, sag_error *error) {
    if (sag_is_finite(p) && sag_max_component(sag_abs(p)) <= SAG_MAX_COORDINATE) return SAG_OK;
    return sag_error_set(error, SAG_ERROR_GEOMETRY,
                         "bilinear_patch.%s is (%g, %g, %g): not finite or beyond SAG_MAX_COORDINATE", name,
                         p.x, p.y, p.z);
}

static bool has_area(const sag_bilinear_patch *s) {
    return sagi_triangle_has_area(&s->p00, &s->p10, &s->p01) ||
           sagi_triangle_has_area(&s->p10, &s->p11, &s->p01) ||
           sagi_triangle_has_area(&s->p00, &s->p10, &s->p11) ||
           sagi_triangle_has_area(&s->p00, &s->p11, &s->p01);
}

sag_status sag_bilinear_patch_validate(const sag_bilinear_patch *s, sag_error *error) {
    sag_status status = check_corner("p00", s->p00, error);
    if (status == SAG_OK) status = check_corner("p10", s->p10, error);
    if (status == SAG_OK) status = check_corner("p01", s->p01, error);
    if (status == SAG_OK) status = check_corner("p11", s->p11, error);
    if (status == SAG_OK && !has_area(s))
        status = sag_error_set(error, SAG_ERROR_GEOMETRY, "bilinear_patch: the four corners lie on one line");
    return status;
}

// The weights are positive and add up to 1: the patch lies within the hull of its corners.
sag_box3 sag_bilinear_patch_bounds(const sag_bilinear_patch *s) {
    if (sag_bilinear_patch_validate(s, NULL) != SAG_OK) return sag_box3_empty();
    sag_box3 box = {s->p00, s->p00};
    return sag_box3_extend(sag_box3_extend(sag_box3_extend(box, s->p10), s->p01), s->p11);
}

bool sag_bilinear_patch_hit(const sag_bilinear_patch *s, const sag_ray *ray, sag_hit *hit) {
    if (!sag_ray_is_valid(ray)) return false;
    sagi_crossings list;
    sagi_bilinear_solve(s, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_bilinear_patch_occluded(const sag_bilinear_patch *s, const sag_ray *ray) {
    if (!sag_ray_is_valid(ray)) return false;
    sagi_crossings list;
    sagi_bilinear_solve(s, ray, &list);
    return list.count > 0;
}

size_t sag_bilinear_patch_crossings(const sag_bilinear_patch *s, const sag_ray *ray, sag_hit *hits,
                                    size_t capacity) {
    if (!sag_ray_is_valid(ray)) return 0;
    sagi_crossings list;
    sagi_bilinear_solve(s, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

static double size_of(const sagi_bilinear_frame *f, int axis) {
    return fabs(sag_component(f->u_edge, axis)) + fabs(sag_component(f->v_edge, axis)) +
           2 * fabs(sag_component(f->twist, axis));
}

static double error_of(double p00, double size) {
    return 8 * SAGI_EPSILON * (fabs(p00) + size) + 16 * SAGI_EPSILON * size;
}

// At a corner where two others fall together the cross product is 0; the middle's serves there.
static sag_vec3 normal_at(const sagi_bilinear_frame *f, double u, double v) {
    const sag_vec2 places[3] = {{u, v}, {0.5, 0.5}, {0.25, 0.375}};
    for (int i = 0; i < 3; i++) {
        sag_vec3 n = sag_normalize(sag_madd(sag_madd(f->n, places[i].x, f->n_u), places[i].y, f->n_v));
        if (sag_dot(n, n) > 0.5) return n;
    }
    return sag_vec3_make(0, 0, 1);
}

static void make_surface(const sag_bilinear_patch *s, double u, double v, sag_surface *surface) {
    sagi_bilinear_frame f = sagi_bilinear_make_frame(s);
    surface->dpdu = sag_madd(f.u_edge, v, f.twist);
    surface->dpdv = sag_madd(f.v_edge, u, f.twist);
    surface->position = sag_madd(sag_madd(s->p00, u, f.u_edge), v, surface->dpdv);
    // A flat patch in the plane z = 0 knows its z exactly, and a ray spawned there would start next to
    // nothing off it: less than the test can tell, also in 400 bits. So some of the largest extent is added
    // in every coordinate.
    const double size[3] = {size_of(&f, 0), size_of(&f, 1), size_of(&f, 2)};
    const double margin = 8 * SAGI_EPSILON * fmax(size[0], fmax(size[1], size[2]));
    surface->position_error =
        sag_vec3_make(error_of(s->p00.x, size[0]) + margin, error_of(s->p00.y, size[1]) + margin,
                      error_of(s->p00.z, size[2]) + margin);
    surface->geometric_normal = normal_at(&f, u, v);
    surface->u = u;
    surface->v = v;
}

void sag_bilinear_patch_surface(const sag_bilinear_patch *s, const sag_ray *ray, const sag_hit *hit,
                                sag_surface *surface) {
    make_surface(s, hit->u, hit->v, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_bilinear_patch_area(const sag_bilinear_patch *s) {
    if (sag_bilinear_patch_validate(s, NULL) != SAG_OK) return 0;
    sagi_bilinear_frame f = sagi_bilinear_make_frame(s);
    return sagi_bilinear_area(&f);
}

bool sag_bilinear_patch_sample(const sag_bilinear_patch *s, sag_vec2 random, sag_surface *surface) {
    double area = sag_bilinear_patch_area(s);
    sagi_bilinear_frame f = sagi_bilinear_make_frame(s);
    if (!(area > 0 && area < INFINITY)) return false;
    sag_vec2 uv = sagi_bilinear_sample(&f, area, random);
    make_surface(s, uv.x, uv.y, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}
