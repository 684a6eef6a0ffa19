// SPDX-License-Identifier: MIT
// One triangle of a mesh at a time, for the mesh's own verbs and for the scene. Surfaces of a hit on one
// triangle: sag_mesh_surface itself, which looks at hit->primitive only.
#ifndef SAGI_SHAPES_MESH_H
#define SAGI_SHAPES_MESH_H

#include "math/simd.h"
#include "shapes/triangle.h"
#include <sagitta/shapes.h>

static inline sag_vec3 sagi_mesh_vertex(const sag_mesh *mesh, uint32_t vertex) {
    size_t at = 3 * (size_t)vertex;
    if (mesh->positions_f64)
        return sag_vec3_make(mesh->positions_f64[at], mesh->positions_f64[at + 1],
                             mesh->positions_f64[at + 2]);
    return sag_vec3_make(mesh->positions_f32[at], mesh->positions_f32[at + 1], mesh->positions_f32[at + 2]);
}

// The vertices of triangle i < triangle_count. Of a mesh that sag_mesh_validate accepts.
static inline void sagi_mesh_triangle(const sag_mesh *mesh, uint32_t i, sag_vec3 out[3]) {
    const uint32_t *corner = &mesh->triangles[3 * (size_t)i];
    for (int k = 0; k < 3; k++) out[k] = sagi_mesh_vertex(mesh, corner[k]);
}

// The same with the second and third in the other order if `mirrored`, in vectors whose fourth places hold
// anything. Of a mesh in a store, where the vertices are not the last thing (scene/store.c): a vertex is
// fetched with what follows it.
SAGI_INLINE void sagi_mesh_corners(const sag_mesh *mesh, uint32_t i, bool mirrored, sagi_d4 out[3]) {
    const uint32_t *corner = &mesh->triangles[3 * (size_t)i];
    size_t swap = mirrored, a = 3 * (size_t)corner[0], b = 3 * (size_t)corner[1 + swap],
           c = 3 * (size_t)corner[2 - swap];
    const double *f64 = mesh->positions_f64;
    const float *f32 = mesh->positions_f32;
    if (__builtin_expect(f64 != NULL, 0))
        out[0] = sagi_d4_load(f64 + a), out[1] = sagi_d4_load(f64 + b), out[2] = sagi_d4_load(f64 + c);
    else
        out[0] = sagi_d4_load4_float(f32 + a), out[1] = sagi_d4_load4_float(f32 + b),
        out[2] = sagi_d4_load4_float(f32 + c);
}

// Why a triangle is not there, if it is not.
typedef enum sagi_triangle_state {
    SAGI_TRIANGLE_GOOD,
    SAGI_TRIANGLE_NOT_FINITE, // or beyond SAG_MAX_COORDINATE, or an index is out of range
    SAGI_TRIANGLE_NO_AREA,    // decided exactly
} sagi_triangle_state;

// The state of triangle i, and its vertices when it is finite. Looks at indices first, so it may be asked of
// any mesh.
sagi_triangle_state sagi_mesh_triangle_state(const sag_mesh *mesh, uint32_t i, sag_vec3 out[3]);
// The box of one triangle; empty unless it is good.
sag_box3 sagi_mesh_triangle_bounds(const sag_mesh *mesh, uint32_t i);
// 0 unless it is good.
double sagi_mesh_triangle_area(const sag_mesh *mesh, uint32_t i);
// A point of one triangle, uniformly by area; false, writing nothing, unless it is good.
bool sagi_mesh_triangle_sample(const sag_mesh *mesh, uint32_t i, sag_vec2 random, sag_surface *surface);
// The normals of the vertices, interpolated at the weights u, v of the second and third and normalised; what
// cannot be (no normals, or they cancel) leaves *normal alone.
void sagi_mesh_shading_normal(const sag_mesh *mesh, uint32_t i, double u, double v, sag_vec3 *normal);

#endif
