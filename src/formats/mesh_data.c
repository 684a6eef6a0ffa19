// SPDX-License-Identifier: MIT
// Meshes on their way from a file into a scene.
#include "formats/load.h"

#include <math.h>
#include <string.h>

void sagi_mesh_data_clear(sagi_mesh_data *mesh) {
    const size_t n = mesh->vertex_count;
    sag_release(mesh->context, mesh->positions_f32, 3 * n * sizeof(float));
    sag_release(mesh->context, mesh->positions_f64, 3 * n * sizeof(double));
    sag_release(mesh->context, mesh->normals, 3 * n * sizeof(float));
    sag_release(mesh->context, mesh->texcoords, 2 * n * sizeof(float));
    sag_release(mesh->context, mesh->triangles, 3 * mesh->triangle_capacity * sizeof(uint32_t));
    *mesh = (sagi_mesh_data){.context = mesh->context};
}

sag_mesh sagi_mesh_data_view(const sagi_mesh_data *mesh) {
    return (sag_mesh){.positions_f32 = mesh->positions_f32,
                      .positions_f64 = mesh->positions_f64,
                      .normals_f32 = mesh->normals,
                      .texcoords_f32 = mesh->texcoords,
                      .triangles = mesh->triangles,
                      .vertex_count = mesh->vertex_count,
                      .triangle_count = mesh->triangle_count};
}

static bool is_good(const sagi_mesh_data *mesh, size_t vertex) {
    bool good = true;
    for (size_t k = 3 * vertex; k < 3 * vertex + 3; k++) {
        const double x = mesh->positions_f64 ? mesh->positions_f64[k] : (double)mesh->positions_f32[k];
        good = good && fabs(x) <= SAG_MAX_COORDINATE; // a NaN is not
    }
    return good;
}

uint32_t sagi_mesh_data_not_finite(const sagi_mesh_data *mesh) {
    size_t first = 0;
    while (first < mesh->vertex_count && is_good(mesh, first)) first++;
    if (first == mesh->vertex_count) return 0; // as nearly always, found in order of memory
    uint32_t count = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *v = &mesh->triangles[3 * i];
        if (!is_good(mesh, v[0]) || !is_good(mesh, v[1]) || !is_good(mesh, v[2])) count++;
    }
    return count;
}

bool sagi_mesh_data_add(sagi_mesh_data *mesh, uint32_t a, uint32_t b, uint32_t c) {
    if (mesh->triangle_count == mesh->triangle_capacity) {
        const size_t larger = mesh->triangle_capacity ? 2 * mesh->triangle_capacity : 1024;
        uint32_t *triangles = sag_allocate(mesh->context, 3 * larger * sizeof(uint32_t));
        if (!triangles) return false;
        if (mesh->triangle_count)
            memcpy(triangles, mesh->triangles, 3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
        sag_release(mesh->context, mesh->triangles, 3 * mesh->triangle_capacity * sizeof(uint32_t));
        mesh->triangles = triangles;
        mesh->triangle_capacity = larger;
    }
    if (mesh->triangle_count == UINT32_MAX) return false;
    uint32_t *triangle = mesh->triangles + 3 * (size_t)mesh->triangle_count++;
    triangle[0] = a, triangle[1] = b, triangle[2] = c;
    return true;
}
