// SPDX-License-Identifier: MIT
#include "support/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *grow(void *memory, size_t count, size_t size) {
    if (count != 0 && (count & (count - 1)) != 0) return memory; // room was made at the last power of two
    void *grown = realloc(memory, (count ? 2 * count : 1) * size);
    if (grown == NULL) abort();
    return grown;
}

static void add_vertex(mesh_file *m, const float p[3]) {
    m->positions = grow(m->positions, m->mesh.vertex_count, 3 * sizeof(float));
    memcpy(m->positions + 3 * (size_t)m->mesh.vertex_count++, p, 3 * sizeof(float));
}

static void add_triangle(mesh_file *m, uint32_t a, uint32_t b, uint32_t c) {
    m->triangles = grow(m->triangles, m->mesh.triangle_count, 3 * sizeof(uint32_t));
    uint32_t *t = m->triangles + 3 * (size_t)m->mesh.triangle_count++;
    t[0] = a, t[1] = b, t[2] = c;
}

static void read_obj(FILE *in, mesh_file *m) {
    char line[1024];
    while (fgets(line, sizeof line, in)) {
        float p[3];
        if (sscanf(line, "v %f %f %f", &p[0], &p[1], &p[2]) == 3) add_vertex(m, p);
        if (strncmp(line, "f ", 2) != 0) continue;
        uint32_t corner[3] = {0};
        int corners = 0;
        for (char *word = strtok(line + 2, " \r\n"); word != NULL; word = strtok(NULL, " \r\n")) {
            corner[corners < 2 ? corners : 2] = (uint32_t)strtoul(word, NULL, 10) - 1;
            if (++corners < 3) continue;
            add_triangle(m, corner[0], corner[1], corner[2]);
            corner[1] = corner[2];
        }
    }
}

static void read_ply(FILE *in, mesh_file *m) {
    char line[1024];
    unsigned vertices = 0, faces = 0;
    while (fgets(line, sizeof line, in) && strncmp(line, "end_header", 10) != 0) {
        sscanf(line, "element vertex %u", &vertices);
        sscanf(line, "element face %u", &faces);
    }
    for (unsigned i = 0; i < vertices; i++) {
        float p[3];
        if (fread(p, sizeof p, 1, in) != 1) abort();
        add_vertex(m, p);
    }
    for (unsigned i = 0; i < faces; i++) {
        uint32_t t[3];
        if (fgetc(in) != 3 || fread(t, sizeof t, 1, in) != 1) abort();
        add_triangle(m, t[0], t[1], t[2]);
    }
}

bool mesh_file_load(const char *name, mesh_file *file) {
    const char *data = getenv("SAGITTA_DATA");
    char path[4096];
    snprintf(path, sizeof path, "%s/meshes/%s", data ? data : "../shared", name);
    FILE *in = fopen(path, "rb");
    if (in == NULL) {
        printf("%s is not there: skipped\n", path);
        return false;
    }
    *file = (mesh_file){.positions = NULL};
    const char *dot = strrchr(name, '.');
    if (dot != NULL && strcmp(dot, ".ply") == 0)
        read_ply(in, file);
    else
        read_obj(in, file);
    fclose(in);
    file->mesh.positions_f32 = file->positions;
    file->mesh.triangles = file->triangles;
    return true;
}

void mesh_file_free(mesh_file *file) {
    free(file->positions);
    free(file->triangles);
    *file = (mesh_file){.positions = NULL};
}
