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

// ---- joining vertices: a hash table of the vertices kept, with open addressing

static uint32_t mix(uint32_t hash, const float *numbers, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        hash = (hash ^ bits) * 0x9E3779B1u;
        hash ^= hash >> 15;
    }
    return hash;
}

static uint32_t hash_of(const sagi_mesh_data *mesh, size_t v) {
    uint32_t hash = mix(0, mesh->positions_f32 + 3 * v, 3);
    if (mesh->normals) hash = mix(hash, mesh->normals + 3 * v, 3);
    return mesh->texcoords ? mix(hash, mesh->texcoords + 2 * v, 2) : hash;
}

static bool are_same(const sagi_mesh_data *mesh, size_t a, size_t b) {
    const size_t three = 3 * sizeof(float), two = 2 * sizeof(float);
    return memcmp(mesh->positions_f32 + 3 * a, mesh->positions_f32 + 3 * b, three) == 0 &&
           (!mesh->normals || memcmp(mesh->normals + 3 * a, mesh->normals + 3 * b, three) == 0) &&
           (!mesh->texcoords || memcmp(mesh->texcoords + 2 * a, mesh->texcoords + 2 * b, two) == 0);
}

// Fills in the new number of each vertex; returns how many there are.
static uint32_t number_vertices(const sagi_mesh_data *mesh, uint32_t *slots, size_t slot_count,
                                uint32_t *numbers) {
    uint32_t kept = 0;
    memset(slots, 0xFF, slot_count * sizeof *slots);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        size_t at = hash_of(mesh, v) & (slot_count - 1);
        while (slots[at] != UINT32_MAX && !are_same(mesh, slots[at], v)) at = (at + 1) & (slot_count - 1);
        if (slots[at] == UINT32_MAX) {
            slots[at] = v;
            numbers[v] = kept++;
        } else {
            numbers[v] = numbers[slots[at]];
        }
    }
    return kept;
}

// A copy of the array with the vertices that are kept; NULL when memory is short.
static float *compact(const sagi_mesh_data *mesh, const float *from, size_t width, const uint32_t *numbers,
                      uint32_t kept) {
    float *to = sag_allocate(mesh->context, width * kept * sizeof(float));
    // Twins overwrite one another with the same bits.
    for (size_t v = 0; to && v < mesh->vertex_count; v++)
        memcpy(to + width * numbers[v], from + width * v, width * sizeof(float));
    return to;
}

static bool renumber(sagi_mesh_data *mesh, const uint32_t *numbers, uint32_t kept) {
    const size_t n = mesh->vertex_count, size = kept * sizeof(float);
    float *positions = compact(mesh, mesh->positions_f32, 3, numbers, kept);
    float *normals = mesh->normals ? compact(mesh, mesh->normals, 3, numbers, kept) : NULL;
    float *texcoords = mesh->texcoords ? compact(mesh, mesh->texcoords, 2, numbers, kept) : NULL;
    if (!positions || (mesh->normals && !normals) || (mesh->texcoords && !texcoords)) {
        sag_release(mesh->context, positions, 3 * size);
        sag_release(mesh->context, normals, 3 * size);
        sag_release(mesh->context, texcoords, 2 * size);
        return false;
    }
    sag_release(mesh->context, mesh->positions_f32, 3 * n * sizeof(float));
    sag_release(mesh->context, mesh->normals, 3 * n * sizeof(float));
    sag_release(mesh->context, mesh->texcoords, 2 * n * sizeof(float));
    mesh->positions_f32 = positions, mesh->normals = normals, mesh->texcoords = texcoords;
    mesh->vertex_count = kept;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        mesh->triangles[i] = numbers[mesh->triangles[i]];
    return true;
}

bool sagi_mesh_data_join(sagi_mesh_data *mesh) {
    size_t slot_count = 16;
    while (slot_count < 2 * (size_t)mesh->vertex_count) slot_count *= 2;
    const size_t number_bytes = (mesh->vertex_count ? mesh->vertex_count : 1) * sizeof(uint32_t);
    uint32_t *slots = sag_allocate(mesh->context, slot_count * sizeof *slots);
    uint32_t *numbers = sag_allocate(mesh->context, number_bytes);
    bool good = slots && numbers;
    if (good) {
        const uint32_t kept = number_vertices(mesh, slots, slot_count, numbers);
        good = kept == mesh->vertex_count || renumber(mesh, numbers, kept);
    }
    sag_release(mesh->context, slots, slot_count * sizeof *slots);
    sag_release(mesh->context, numbers, number_bytes);
    return good;
}

// ---- what the scene leaves out

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

static sag_vec3 position(const sagi_mesh_data *mesh, uint32_t vertex) {
    const size_t at = 3 * (size_t)vertex;
    if (mesh->positions_f64)
        return sag_vec3_make(mesh->positions_f64[at], mesh->positions_f64[at + 1],
                             mesh->positions_f64[at + 2]);
    return sag_vec3_make((double)mesh->positions_f32[at], (double)mesh->positions_f32[at + 1],
                         (double)mesh->positions_f32[at + 2]);
}

static bool is_within(sag_vec3 p) {
    return fabs(p.x) <= SAG_MAX_COORDINATE && fabs(p.y) <= SAG_MAX_COORDINATE &&
           fabs(p.z) <= SAG_MAX_COORDINATE;
}

bool sagi_mesh_data_has_area(const sagi_mesh_data *mesh, const sag_affine *placed) {
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        sag_vec3 p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = sag_affine_point(placed, position(mesh, mesh->triangles[3 * i + k]));
        const sag_vec3 twice = sag_cross(sag_sub(p[1], p[0]), sag_sub(p[2], p[0]));
        const double area = sag_length(twice) / 2;
        if (area > 0 && isfinite(1 / area) && is_within(p[0]) && is_within(p[1]) && is_within(p[2]))
            return true; // as nearly always the first
    }
    return false;
}

bool sagi_mesh_data_reserve(sagi_mesh_data *mesh, size_t capacity) {
    if (capacity <= mesh->triangle_capacity) return true;
    uint32_t *triangles = sag_allocate(mesh->context, 3 * capacity * sizeof(uint32_t));
    if (!triangles) return false;
    if (mesh->triangle_count)
        memcpy(triangles, mesh->triangles, 3 * (size_t)mesh->triangle_count * sizeof(uint32_t));
    sag_release(mesh->context, mesh->triangles, 3 * mesh->triangle_capacity * sizeof(uint32_t));
    mesh->triangles = triangles;
    mesh->triangle_capacity = capacity;
    return true;
}

bool sagi_mesh_data_add(sagi_mesh_data *mesh, uint32_t a, uint32_t b, uint32_t c) {
    if (mesh->triangle_count == UINT32_MAX) return false;
    if (mesh->triangle_count == mesh->triangle_capacity &&
        !sagi_mesh_data_reserve(mesh, mesh->triangle_capacity ? 2 * mesh->triangle_capacity : 1024))
        return false;
    uint32_t *triangle = mesh->triangles + 3 * (size_t)mesh->triangle_count++;
    triangle[0] = a, triangle[1] = b, triangle[2] = c;
    return true;
}
