// SPDX-License-Identifier: MIT
// The meshes beside the project, for tests of the core alone (which has no importer): OBJ with faces of any
// size, binary PLY of three floats a vertex and triangles.
#ifndef TESTS_SUPPORT_MESH_FILE_H
#define TESTS_SUPPORT_MESH_FILE_H

#include <sagitta/shapes.h>

typedef struct mesh_file {
    float *positions;
    uint32_t *triangles;
    sag_mesh mesh; // over these two
} mesh_file;

// Reads $SAGITTA_DATA/meshes/<name>; false, with a notice, when it is not there.
bool mesh_file_load(const char *name, mesh_file *file);
void mesh_file_free(mesh_file *file);

#endif
