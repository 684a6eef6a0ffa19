// SPDX-License-Identifier: MIT
// Closed meshes made on the spot, in double precision, counter-clockwise seen from outside.
#ifndef TESTS_SUPPORT_MESHES_H
#define TESTS_SUPPORT_MESHES_H

#include "support/random.h"
#include <sagitta/shapes.h>

typedef struct test_mesh {
    double *positions;
    uint32_t *triangles;
    sag_mesh mesh; // over these two
} test_mesh;

// A cube [−1, 1]³ of 12 triangles.
test_mesh test_mesh_cube(void);
// A unit sphere: an icosahedron, each triangle cut in four `levels` times (20 · 4^levels triangles).
test_mesh test_mesh_sphere(int levels);
// A torus around z of radii 1 and 0.4, of n × m quads cut in two.
test_mesh test_mesh_torus(uint32_t n, uint32_t m);
// p ↦ scale · p + offset, rounded; vertices then moved at random by up to `noise` · scale.
void test_mesh_move(test_mesh *mesh, double scale, sag_vec3 offset, double noise, rng *r);
// The same triangles as STL files have them: a vertex in floats for each corner, every other 0 a −0. The
// caller frees both arrays.
sag_mesh test_mesh_soup(const test_mesh *mesh, float **positions, uint32_t **triangles);
void test_mesh_free(test_mesh *mesh);

#endif
