// SPDX-License-Identifier: MIT
// A point of a triangle of a mesh: what sagi_triangle_point (triangle.c, where the error is derived) and
// sagi_surface_finish say, with the normals and texture coordinates of the vertices. Renderers ask it of
// every hit, so it is written for vectors of three numbers in a register, and the kernels have it for their
// instruction sets; the operations and their order are the same, and so are the bits.
//
// Texture coordinates and derivatives. With the texture coordinates of the three vertices interpolated, p is
// an affine function of (u, v); from the two edges to c,
//
//     a − c = (u_a − u_c) dp/du + (v_a − v_c) dp/dv,    b − c = (u_b − u_c) dp/du + (v_b − v_c) dp/dv,
//
// two equations for dp/du and dp/dv (PBR 4th ed. §6.5.1). Where they have no solution any frame of the normal
// serves.
#ifndef SAGI_SHAPES_MESH_SURFACE_H
#define SAGI_SHAPES_MESH_SURFACE_H

#include "math/map.h"
#include "shapes/common.h"
#include "shapes/mesh.h"
#include <float.h>
#include <stddef.h>

// Writes a fourth number, of no meaning, into what comes after: so in the order of the fields.
SAGI_INLINE void sagi_d4_store3(sag_vec3 *to, sagi_d4 a) { memcpy((void *)to, &a, sizeof a); }
_Static_assert(offsetof(sag_surface, dpdv) + 32 <= sizeof(sag_surface), "a fourth number has room");

SAGI_INLINE double sagi_d4_dot3(sagi_d4 a, sagi_d4 b) {
    const sagi_d4 p = a * b;
    return p[0] + p[1] + p[2];
}
SAGI_INLINE sagi_d4 sagi_d4_cross(sagi_d4 a, sagi_d4 b) {
    const sagi_d4 a_yzx = SAGI_D4_SHUFFLE2(a, a, 1, 2, 0, 3), a_zxy = SAGI_D4_SHUFFLE2(a, a, 2, 0, 1, 3);
    const sagi_d4 b_yzx = SAGI_D4_SHUFFLE2(b, b, 1, 2, 0, 3), b_zxy = SAGI_D4_SHUFFLE2(b, b, 2, 0, 1, 3);
    return a_yzx * b_zxy - a_zxy * b_yzx;
}
SAGI_INLINE double sagi_d4_most3(sagi_d4 a) {
    const double m = a[0] > a[1] ? a[0] : a[1];
    return m > a[2] ? m : a[2];
}
// As sagi_normalize.
SAGI_INLINE sagi_d4 sagi_d4_normalize3(sagi_d4 a) {
    const double squared = sagi_d4_dot3(a, a);
    if (__builtin_expect(sagi_square_is_safe(squared), 1)) return a / sagi_d4_fill(sqrt(squared));
    const sag_vec3 unit = sag_normalize(sagi_d4_vec3(a));
    return sagi_d4_of(unit.x, unit.y, unit.z, 0);
}

// The vertices' normals, interpolated; `normal` where that cannot be.
SAGI_INLINE sagi_d4 sagi_mesh_normal(const sag_mesh *s, const uint32_t corner[3], double u, double v,
                                     sagi_d4 normal) {
    const double weight[3] = {1 - u - v, u, v};
    sagi_d4 sum = {0, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        sagi_d4 unit = sagi_d4_load3_float(&s->normals_f32[3 * (size_t)corner[k]]);
        // Most are unit already as far as floats can be.
        if (__builtin_expect(!(fabs(sagi_d4_dot3(unit, unit) - 1) <= 0x1p-20), 0)) {
            const sag_vec3 again = sag_normalize(sagi_d4_vec3(unit));
            unit = sagi_d4_of(again.x, again.y, again.z, 0);
        }
        sum = sum + sagi_d4_fill(weight[k]) * unit;
    }
    const double squared = sagi_d4_dot3(sum, sum);
    if (__builtin_expect(sagi_square_is_safe(squared), 1)) return sum / sagi_d4_fill(sqrt(squared));
    return squared > 0 && sag_is_finite(sagi_d4_vec3(sum)) ? sagi_d4_normalize3(sum) : normal;
}

// The point of triangle i, of a mesh that sag_mesh_validate accepts, at the weights u, v of its second and
// third vertex: all of *surface but its side, geometry SAG_INVALID_ID.
SAGI_INLINE void sagi_mesh_point(const sag_mesh *s, uint32_t i, double u, double v, sag_surface *surface) {
    const uint32_t *corner = &s->triangles[3 * (size_t)i];
    // Three numbers each and no more: the mesh may be a user's, whose memory ends with the last vertex.
    sagi_d4 p[3];
    for (int k = 0; k < 3; k++) {
        const size_t at = 3 * (size_t)corner[k];
        p[k] = s->positions_f64 ? sagi_d4_load3(s->positions_f64 + at)
                                : sagi_d4_load3_float(s->positions_f32 + at);
    }
    const sagi_d4 ab = p[1] - p[0], ac = p[2] - p[0], size_ab = sagi_d4_abs(ab), size_ac = sagi_d4_abs(ac);
    const sagi_d4 us = sagi_d4_fill(u), vs = sagi_d4_fill(v);
    const double edge = sagi_d4_most3(sagi_d4_max(size_ab, size_ac));
    const sagi_d4 error =
        sagi_d4_fill(2 * SAGI_EPSILON) * (sagi_d4_abs(p[0]) + 2 * (us * size_ab + vs * size_ac));
    const sagi_d4 n = sagi_d4_cross(ab, ac);
    const double largest = sagi_d4_most3(sagi_d4_abs(n));
    sagi_d4 geometric;
    if (__builtin_expect(sagi_cross_is_good(largest, edge), 1)) {
        geometric = sagi_d4_normalize3(n);
    } else {
        sag_vec3 unit = {0, 0, 1}, at[3];
        sagi_mesh_triangle(s, i, at);
        sagi_triangle_normal(&at[0], &at[1], &at[2], &unit);
        geometric = sagi_d4_of(unit.x, unit.y, unit.z, 0);
    }
    sagi_d4 dpdu = ab, dpdv = ac, across = n;
    double at_u = u, at_v = v;
    if (s->texcoords_f32) {
        const float *a = &s->texcoords_f32[2 * (size_t)corner[0]],
                    *b = &s->texcoords_f32[2 * (size_t)corner[1]],
                    *c = &s->texcoords_f32[2 * (size_t)corner[2]];
        const double au = (double)a[0], av = (double)a[1], bu = (double)b[0], bv = (double)b[1],
                     cu = (double)c[0], cv = (double)c[1], alpha = 1 - u - v;
        at_u = alpha * au + u * bu + v * cu;
        at_v = alpha * av + u * bv + v * cv;
        const double ua = au - cu, va = av - cv, ub = bu - cu, vb = bv - cv;
        const sagi_d4 scale = sagi_d4_fill(1 / (ua * vb - va * ub)), to_a = p[0] - p[2], to_b = p[1] - p[2];
        dpdu = (to_a * vb + -va * to_b) * scale;
        dpdv = (to_b * ua + -ub * to_a) * scale;
        across = sagi_d4_cross(dpdu, dpdv);
    }
    sagi_d4_store3(&surface->position, p[0] + us * ab + vs * ac);
    sagi_d4_store3(&surface->position_error, error + sagi_d4_fill(64 * SAGI_EPSILON * edge));
    sagi_d4_store3(&surface->geometric_normal, geometric);
    sagi_d4_store3(&surface->shading_normal,
                   s->normals_f32 ? sagi_mesh_normal(s, corner, u, v, geometric) : geometric);
    sagi_d4_store3(&surface->dpdu, dpdu);
    sagi_d4_store3(&surface->dpdv, dpdv);
    surface->u = at_u, surface->v = at_v;
    surface->primitive = i;
    surface->geometry = SAG_INVALID_ID;
    surface->user_data = 0;
    const double squared = sagi_d4_dot3(across, across);
    if (__builtin_expect(!(squared > 0 && squared <= DBL_MAX), 0)) sagi_surface_finish_derivatives(surface);
}

// All of the surface where a ray has hit.
SAGI_INLINE void sagi_mesh_surface(const sag_mesh *s, const sag_ray *ray, const sag_hit *hit,
                                   sag_surface *surface) {
    sagi_mesh_point(s, hit->primitive, hit->u, hit->v, surface);
    surface->side = sag_dot(ray->direction, surface->geometric_normal) > 0 ? SAG_SIDE_BACK : SAG_SIDE_FRONT;
}

#endif
