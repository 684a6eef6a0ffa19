// SPDX-License-Identifier: MIT
// Vertex normals: around a vertex, each triangle's unit normal counts by the angle it takes up there. Unlike
// a plain mean or one weighted by area, that does not change when a triangle is cut in two (Thürmer &
// Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1), 1998).
#include "math/elementary.h"
#include "shapes/mesh.h"

void sag_mesh_compute_normals(const sag_mesh *mesh, float *normals_f32) {
    for (size_t k = 0; k < 3 * (size_t)mesh->vertex_count; k++) normals_f32[k] = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        sag_vec3 p[3], n;
        if (sagi_mesh_triangle_state(mesh, i, p) != SAGI_TRIANGLE_GOOD) continue;
        if (!(sagi_triangle_normal(&p[0], &p[1], &p[2], &n) > 0)) continue;
        for (int k = 0; k < 3; k++) {
            sag_vec3 to = sag_normalize(sag_sub(p[(k + 1) % 3], p[k]));
            sag_vec3 from = sag_normalize(sag_sub(p[(k + 2) % 3], p[k]));
            double angle = sagi_atan2(sag_length(sag_cross(to, from)), sag_dot(to, from));
            float *sum = &normals_f32[3 * (size_t)mesh->triangles[3 * (size_t)i + (size_t)k]];
            sum[0] += (float)(angle * n.x);
            sum[1] += (float)(angle * n.y);
            sum[2] += (float)(angle * n.z);
        }
    }
    for (size_t vertex = 0; vertex < mesh->vertex_count; vertex++) {
        float *sum = &normals_f32[3 * vertex];
        sag_vec3 n = sag_normalize(sag_vec3_make(sum[0], sum[1], sum[2]));
        if (!(sag_dot(n, n) > 0)) n = sag_vec3_make(0, 0, 1);
        sum[0] = (float)n.x;
        sum[1] = (float)n.y;
        sum[2] = (float)n.z;
    }
}
