// SPDX-License-Identifier: MIT
// The models: meshes from files, all parts of a file as one mesh in the file's own order, so that a
// triangle has the same number on both sides.
#include "bench.h"
#include <sagitta/render.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *grown(void *old, size_t bytes) {
    void *memory = realloc(old, bytes);
    if (memory == NULL && bytes > 0) {
        fprintf(stderr, "bench-rays: %zu bytes of memory are not to be had\n", bytes);
        exit(1);
    }
    return memory;
}

static void append(void *user, const char *name, const sag_mesh *mesh) {
    (void)name;
    model *m = user;
    size_t vertices = (size_t)m->vertex_count + mesh->vertex_count,
           triangles = (size_t)m->triangle_count + mesh->triangle_count;
    m->positions = grown(m->positions, vertices * 3 * sizeof *m->positions);
    m->triangles = grown(m->triangles, triangles * 3 * sizeof *m->triangles);
    float *p = m->positions + 3 * (size_t)m->vertex_count;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        p[i] = mesh->positions_f32 != NULL ? mesh->positions_f32[i] : (float)mesh->positions_f64[i];
    uint32_t *t = m->triangles + 3 * (size_t)m->triangle_count;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) t[i] = mesh->triangles[i] + m->vertex_count;
    m->vertex_count = (uint32_t)vertices;
    m->triangle_count = (uint32_t)triangles;
}

bool model_load(model *m, const char *path) {
    *m = (model){0};
    const char *file = strrchr(path, '/');
    file = file != NULL ? file + 1 : path;
    if (strncmp(file, "stanford-", 9) == 0) file += 9;
    snprintf(m->name, sizeof m->name, "%.*s", (int)strcspn(file, "."), file);
    sag_context *context = sag_context_create(NULL);
    sag_world *world = context != NULL ? sag_world_create(context) : NULL;
    sag_error error = {.message = "out of memory"};
    bool loaded = world != NULL && sag_world_load_geometry(world, path, append, m, &error) == SAG_OK;
    if (!loaded) fprintf(stderr, "bench-rays: %s: %s\n", path, error.message);
    sag_world_destroy(world);
    sag_context_destroy(context);
    if (loaded && m->triangle_count == 0) {
        fprintf(stderr, "bench-rays: %s: no triangles\n", path);
        loaded = false;
    }
    if (loaded)
        model_measure(m);
    else
        model_free(m);
    return loaded;
}

void model_measure(model *m) {
    sag_box3 box = sag_box3_empty();
    for (size_t i = 0; i < m->vertex_count; i++) {
        const float *p = m->positions + 3 * i;
        box = sag_box3_extend(box, sag_vec3_make(p[0], p[1], p[2]));
    }
    for (size_t i = 0; i < m->sphere_count; i++) {
        const float *s = m->spheres + 4 * i;
        sag_vec3 c = sag_vec3_make(s[0], s[1], s[2]), r = sag_vec3_make(s[3], s[3], s[3]);
        box = sag_box3_extend(sag_box3_extend(box, sag_sub(c, r)), sag_add(c, r));
    }
    m->center = sag_scale(sag_add(box.min, box.max), 0.5);
    m->radius = 0.5 * sag_length(sag_sub(box.max, box.min));
}

void model_free(model *m) {
    free(m->positions);
    free(m->triangles);
    free(m->spheres);
    *m = (model){0};
}
