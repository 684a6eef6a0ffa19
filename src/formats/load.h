// SPDX-License-Identifier: MIT
// What the readers of scenes share: how a file is to be read, and meshes on their way into a scene.
#ifndef SAGI_FORMATS_LOAD_H
#define SAGI_FORMATS_LOAD_H

#include <sagitta/render.h>

// How to read. Zero-initialised: everything.
typedef struct sagi_load_options {
    bool geometry_only;
    sag_mesh_callback on_mesh; // NULL: nobody wants to know
    void *user;
} sagi_load_options;

sag_status sagi_pbrt_load(sag_world *world, const char *path, const sagi_load_options *options,
                          sag_error *error);
sag_status sagi_import_load(sag_world *world, const char *path, const sagi_load_options *options,
                            sag_error *error);

// A mesh whose arrays belong to the context. Zero-initialised but for the context: nothing.
typedef struct sagi_mesh_data {
    const sag_context *context;
    float *positions_f32; // one of these two
    double *positions_f64;
    float *normals, *texcoords; // or NULL
    uint32_t *triangles;
    uint32_t vertex_count, triangle_count;
    size_t triangle_capacity; // allocated, in triangles
} sagi_mesh_data;

void sagi_mesh_data_clear(sagi_mesh_data *mesh);
// As the scene takes it.
sag_mesh sagi_mesh_data_view(const sagi_mesh_data *mesh);
// Makes one of vertices that are the same bit for bit, in position, normal and texture coordinates, in order
// of first appearance; only for positions_f32. False when memory is short: nothing has changed.
bool sagi_mesh_data_join(sagi_mesh_data *mesh);
// How many triangles have a vertex that is NaN, infinite or beyond SAG_MAX_COORDINATE: the scene leaves them
// out.
uint32_t sagi_mesh_data_not_finite(const sagi_mesh_data *mesh);
// Whether a triangle of it has an area where it is placed, as far as double precision tells, and is not left
// out.
bool sagi_mesh_data_has_area(const sagi_mesh_data *mesh, const sag_affine *placed);
// Makes room for so many triangles; false when memory is short.
bool sagi_mesh_data_reserve(sagi_mesh_data *mesh, size_t capacity);
// Adds a triangle; false when memory is short (or there are 2³² of them).
bool sagi_mesh_data_add(sagi_mesh_data *mesh, uint32_t a, uint32_t b, uint32_t c);

// Reads a PLY file (ply.c): ascii or binary in either byte order, also gzipped. Faces of more than three
// corners become fans of triangles. The error has the file and, for ascii, line and column; for binary data
// the message has the place.
sag_status sagi_ply_read(const sag_context *context, const char *path, sagi_mesh_data *mesh,
                         sag_error *error);

#endif
