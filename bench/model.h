// SPDX-License-Identifier: MIT
// What is measured: triangles, and three sets of rays through them.
#ifndef BENCH_MODEL_H
#define BENCH_MODEL_H

#include <sagitta/sagitta.h>

typedef struct model {
    float *positions;    // x y z of each vertex
    uint32_t *triangles; // three corners each
    uint32_t vertex_count, triangle_count;
} model;

// A sphere with bumps, of about 2·n² triangles; false when memory is short.
bool model_generate(model *m, uint32_t n);
// Appends a mesh's triangles.
bool model_append(model *m, const sag_mesh *mesh);
void model_free(model *m);

// The other library, when it was found (bench/embree.c): milliseconds to build, and nanoseconds a ray of one
// thread.
typedef struct peer peer;
const char *peer_name(void); // NULL: not there
peer *peer_create(const model *m, double *build_seconds);
void peer_destroy(peer *p);
// Writes t of each hit (INFINITY: none), or 0 where occluded. Returns the seconds it took.
double peer_trace(peer *p, const sag_ray *rays, float *t, size_t count, bool occluded);

double seconds_now(void);

#endif
