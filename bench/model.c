// SPDX-License-Identifier: MIT
#include "model.h"
#include <stdlib.h>
#include <time.h>

double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool grow(model *m, uint32_t vertices, uint32_t triangles) {
    float *p = realloc(m->positions, (size_t)(m->vertex_count + vertices) * 3 * sizeof *p);
    if (p == NULL) return false;
    m->positions = p;
    uint32_t *t = realloc(m->triangles, (size_t)(m->triangle_count + triangles) * 3 * sizeof *t);
    if (t == NULL) return false;
    m->triangles = t;
    return true;
}

bool model_generate(model *m, uint32_t n) {
    if (!grow(m, (n + 1) * (n + 1), 2 * n * n)) return false;
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t j = 0; j <= n; j++) {
            double theta = 3.14159265358979323846 * i / n, phi = 6.28318530717958647692 * (j % n) / n;
            double r = 1 + 0.1 * sin(9 * theta) * cos(8 * phi) + 0.01 * sin(90 * theta) * sin(80 * phi);
            m->positions[3 * m->vertex_count] = (float)(r * sin(theta) * cos(phi));
            m->positions[3 * m->vertex_count + 1] = (float)(r * cos(theta));
            m->positions[3 * m->vertex_count++ + 2] = (float)(r * sin(theta) * sin(phi));
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            uint32_t a = i * (n + 1) + j, c[6] = {a, a + 1, a + n + 1, a + 1, a + n + 2, a + n + 1};
            for (int k = 0; k < 6; k++) m->triangles[3 * m->triangle_count + (uint32_t)k] = c[k];
            m->triangle_count += 2;
        }
    return true;
}

bool model_append(model *m, const sag_mesh *mesh) {
    if (!grow(m, mesh->vertex_count, mesh->triangle_count)) return false;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        m->positions[3 * (size_t)m->vertex_count + i] =
            mesh->positions_f32 != NULL ? mesh->positions_f32[i] : (float)mesh->positions_f64[i];
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        m->triangles[3 * (size_t)m->triangle_count + i] = mesh->triangles[i] + m->vertex_count;
    m->vertex_count += mesh->vertex_count;
    m->triangle_count += mesh->triangle_count;
    return true;
}

void model_free(model *m) {
    free(m->positions);
    free(m->triangles);
    *m = (model){0};
}
