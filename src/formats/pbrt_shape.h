// SPDX-License-Identifier: MIT
// What the readers of shapes share.
#ifndef SAGI_FORMATS_PBRT_SHAPE_H
#define SAGI_FORMATS_PBRT_SHAPE_H

#include "formats/pbrt.h"

// Puts a shape, known to be good, into the scene: transform, material, light. `area` is that of the placed
// shape, for lights, which do not shine without one; a mesh's need only be 0 or not.
sag_status sagi_pbrt_add(sagi_pbrt *p, sag_shape_kind kind, const void *shape, double area,
                         const sag_affine *placed);
// The same, and which geometry it became (of a scene that is no solid).
sag_status sagi_pbrt_add_numbered(sagi_pbrt *p, sag_shape_kind kind, const void *shape, double area,
                                  const sag_affine *placed, uint32_t *geometry);
// How much larger the current transform makes areas: lengths grow by the cube root of the volume's factor,
// which is right for similarities and near for others.
double sagi_pbrt_area_factor(const sagi_pbrt *p);

// Shapes with arrays (pbrt_mesh.c).
sag_status sagi_pbrt_plymesh(sagi_pbrt *p);
sag_status sagi_pbrt_trianglemesh(sagi_pbrt *p);
// The mesh of the parameters that have been read; on failure *data holds what there is so far.
sag_status sagi_pbrt_read_triangles(sagi_pbrt *p, sagi_mesh_data *data);
// P, N, uv and the indices, `corners` of which make a face; without indices (0 of them) the points are one
// face.
sag_status sagi_pbrt_read_arrays(sagi_pbrt *p, size_t corners, sagi_mesh_data *data, const double **indices,
                                 size_t *index_count);
// Adds a mesh that has no file of its own, whose name is the place, and clears it.
sag_status sagi_pbrt_finish_text_mesh(sagi_pbrt *p, sagi_mesh_data *data);
sag_status sagi_pbrt_loopsubdiv(sagi_pbrt *p);
sag_status sagi_pbrt_bilinearmesh(sagi_pbrt *p); // (pbrt_patch.c)
sag_status sagi_pbrt_polygon(sagi_pbrt *p);
sag_status sagi_pbrt_spheres(sagi_pbrt *p);

#endif
