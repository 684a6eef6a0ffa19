// SPDX-License-Identifier: MIT
// Solids of a pbrt scene: what the readers of blocks, objects and shapes say to each other about them.
#ifndef SAGI_FORMATS_PBRT_SOLID_H
#define SAGI_FORMATS_PBRT_SOLID_H

#include "formats/pbrt.h"

sag_status sagi_pbrt_solid_begin(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_solid_end(sagi_pbrt *p, sagi_place place);
void sagi_pbrt_solid_clear(sagi_pbrt *p);

// Why a shape is no body, and so nothing for a solid: "has no inside …". NULL: it may be one; whether a mesh
// or quadric is closed shows when the solid is committed.
const char *sagi_pbrt_not_closed(sag_shape_kind kind, const void *shape);
// What comes next is one more operand of the operation that is open.
void sagi_pbrt_solid_operand(sagi_pbrt *p);
// Adds a shape that passed sagi_pbrt_not_closed, as a step. A set of spheres is their union.
sag_status sagi_pbrt_solid_shape(sagi_pbrt *p, sagi_place place, sag_shape_kind kind, const void *shape,
                                 const sag_affine *placed, const sag_appearance *look);
// Adds an instance of a finished solid (index in p->solids), as a step.
sag_status sagi_pbrt_solid_instance(sagi_pbrt *p, sagi_place place, uint32_t solid, const sag_affine *placed);
// Adds an operation, after all of its operands.
sag_status sagi_pbrt_solid_step(sagi_pbrt *p, sag_solid_operation operation, uint32_t number);
// Ends the open solid: makes its scene a solid by the steps read and commits it. An error about a geometry
// has the place of that in the file, any other the solid's. With `index` it is kept in p->solids for others.
sag_status sagi_pbrt_solid_commit(sagi_pbrt *p, sagi_place place, uint32_t *index);

// A geometry of the open object (pbrt_object.c).
sag_status sagi_pbrt_object_part(sagi_pbrt *p, const sagi_part *part, size_t weight);
// How many primitives a shape has.
size_t sagi_pbrt_weight(sag_shape_kind kind, const void *shape);
sag_status sagi_pbrt_object_begin(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_object_end(sagi_pbrt *p, sagi_place place);
sag_status sagi_pbrt_object_instance(sagi_pbrt *p, sagi_place place);
// Places an object, which must be there.
sag_status sagi_pbrt_place_object(sagi_pbrt *p, sagi_place place, const char *name, const sag_affine *map);

#endif
