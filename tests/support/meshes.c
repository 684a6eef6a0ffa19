// SPDX-License-Identifier: MIT
#include "support/meshes.h"

#include <string.h>

static test_mesh make(uint32_t vertex_count, uint32_t triangle_count) {
    test_mesh m = {.positions = calloc(3 * (size_t)vertex_count, sizeof *m.positions),
                   .triangles = calloc(3 * (size_t)triangle_count, sizeof *m.triangles)};
    if (!m.positions || !m.triangles) abort();
    m.mesh = (sag_mesh){.positions_f64 = m.positions,
                        .triangles = m.triangles,
                        .vertex_count = vertex_count,
                        .triangle_count = triangle_count};
    return m;
}

sag_mesh test_mesh_soup(const test_mesh *m, float **positions, uint32_t **triangles) {
    const uint32_t n = m->mesh.triangle_count;
    float *soup = *positions = malloc(9 * (size_t)n * sizeof *soup);
    uint32_t *corners = *triangles = malloc(3 * (size_t)n * sizeof *corners);
    if (!soup || !corners) abort();
    for (uint32_t i = 0; i < 3 * n; i++) {
        corners[i] = i;
        for (uint32_t k = 0; k < 3; k++) {
            const float x = (float)m->positions[3 * m->triangles[i] + k];
            soup[3 * i + k] = x == 0 ? (i % 2 ? -0.0F : 0.0F) : x;
        }
    }
    return (sag_mesh){
        .positions_f32 = soup, .triangles = corners, .vertex_count = 3 * n, .triangle_count = n};
}

void test_mesh_free(test_mesh *m) {
    free(m->positions);
    free(m->triangles);
    *m = (test_mesh){0};
}

static void set_vertex(test_mesh *m, uint32_t i, double x, double y, double z) {
    m->positions[3 * i] = x;
    m->positions[3 * i + 1] = y;
    m->positions[3 * i + 2] = z;
}

test_mesh test_mesh_cube(void) {
    static const uint32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    test_mesh m = make(8, 12);
    memcpy(m.triangles, faces, sizeof faces);
    for (uint32_t i = 0; i < 8; i++) set_vertex(&m, i, i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    return m;
}

// The index of the middle of edge a b, made when it is asked for the first time.
static uint32_t middle(test_mesh *m, uint32_t *keys, uint32_t *used, uint32_t a, uint32_t b) {
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    for (uint32_t k = 0; k < 6; k++) { // a vertex has at most six edges upward
        uint32_t *slot = &keys[12 * low + 2 * k];
        if (slot[1] != 0 && slot[0] == high) return slot[1];
        if (slot[1] != 0) continue;
        uint32_t i = (*used)++;
        const double *p = &m->positions[3 * a], *q = &m->positions[3 * b];
        sag_vec3 n = sag_normalize(sag_vec3_make(p[0] + q[0], p[1] + q[1], p[2] + q[2]));
        set_vertex(m, i, n.x, n.y, n.z);
        slot[0] = high;
        slot[1] = i;
        return i;
    }
    abort();
}

static test_mesh icosahedron(void) {
    static const uint32_t faces[60] = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                       4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                       6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
    const double g = (1 + sqrt(5)) / 2;
    const double p[12][3] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                             {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    test_mesh m = make(12, 20);
    memcpy(m.triangles, faces, sizeof faces);
    for (uint32_t i = 0; i < 12; i++) {
        sag_vec3 n = sag_normalize(sag_vec3_make(p[i][0], p[i][1], p[i][2]));
        set_vertex(&m, i, n.x, n.y, n.z);
    }
    return m;
}

test_mesh test_mesh_sphere(int levels) {
    test_mesh coarse = icosahedron();
    for (int level = 0; level < levels; level++) {
        uint32_t old_vertices = coarse.mesh.vertex_count, old_triangles = coarse.mesh.triangle_count;
        test_mesh fine = make(old_vertices + old_triangles * 3 / 2, old_triangles * 4);
        memcpy(fine.positions, coarse.positions, 3 * (size_t)old_vertices * sizeof *fine.positions);
        uint32_t *keys = calloc(12 * (size_t)old_vertices, sizeof *keys), used = old_vertices;
        if (!keys) abort();
        for (uint32_t i = 0; i < old_triangles; i++) {
            const uint32_t *v = &coarse.triangles[3 * i];
            uint32_t ab = middle(&fine, keys, &used, v[0], v[1]), bc = middle(&fine, keys, &used, v[1], v[2]);
            uint32_t ca = middle(&fine, keys, &used, v[2], v[0]);
            const uint32_t four[12] = {v[0], ab, ca, v[1], bc, ab, v[2], ca, bc, ab, bc, ca};
            memcpy(&fine.triangles[12 * i], four, sizeof four);
        }
        free(keys);
        test_mesh_free(&coarse);
        coarse = fine;
    }
    return coarse;
}

test_mesh test_mesh_torus(uint32_t n, uint32_t m) {
    const double two_pi = 6.283185307179586;
    test_mesh torus = make(n * m, 2 * n * m);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            double around = two_pi * i / n, along = two_pi * j / m, r = 1 + 0.4 * cos(along);
            set_vertex(&torus, i * m + j, r * cos(around), r * sin(around), 0.4 * sin(along));
            uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m,
                     d = i * m + (j + 1) % m;
            const uint32_t two[6] = {a, b, c, a, c, d};
            memcpy(&torus.triangles[6 * (size_t)a], two, sizeof two);
        }
    return torus;
}

void test_mesh_move(test_mesh *m, double scale, sag_vec3 offset, double noise, rng *r) {
    for (uint32_t i = 0; i < m->mesh.vertex_count; i++) {
        double *p = &m->positions[3 * i];
        sag_vec3 moved = sag_add(sag_vec3_make(p[0], p[1], p[2]), rng_vec3(r, noise));
        moved = sag_madd(offset, scale, moved);
        set_vertex(m, i, moved.x, moved.y, moved.z);
    }
}
