// SPDX-License-Identifier: MIT
// Loop's subdivision surfaces as triangle meshes.
#ifndef SAGI_FORMATS_LOOP_SUBDIVISION_H
#define SAGI_FORMATS_LOOP_SUBDIVISION_H

#include "formats/load.h"

// More triangles than that are not made.
#define SAGI_MAX_SUBDIVIDED_TRIANGLES ((uint64_t)1 << 24)

// Divides each triangle of the mesh into 4^levels, puts the vertices on the limit surface and gives them its
// normals: *out, whose context is set, gets positions_f64, normals and triangles, the corners of triangle t
// of the mesh in 4^levels·t and so on. Texture coordinates are not looked at. *borders: how many edges were
// taken for borders since more than two triangles meet there, or two that are turned differently. False when
// memory is short; *out then holds nothing. There must be no more triangles than said above.
bool sagi_loop_subdivide(const sagi_mesh_data *mesh, uint32_t levels, sagi_mesh_data *out, uint32_t *borders);

#endif
