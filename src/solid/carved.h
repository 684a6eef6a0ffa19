// SPDX-License-Identifier: MIT
// Solids that are one closed mesh with other parts cut out of it, as the kernels' batches read them: where
// none of the cutters is, the solid is the mesh, and a ray that first meets the mesh at such a place has met
// the solid. So most rays can be traced as those of any mesh (kernel/solid_batch.inl).
//
// A cutter matters within its effective box only (tree.h). Here it is a ball: itself, if it is one, or the
// ball around its box. (Balls are asked for four at a time.)
#ifndef SAGI_SOLID_CARVED_H
#define SAGI_SOLID_CARVED_H

#include "math/simd.h"
#include "solid/tree.h"

#define SAGI_CARVED_MOST 64 // cutters

typedef struct sagi_carved_four {
    sagi_d4 x, y, z, squared; // centres, squares of the radii; what is not there is far away
} sagi_carved_four;

typedef struct sagi_carved {
    uint32_t geometry; // the mesh
    uint32_t four_count;
    sagi_carved_four fours[SAGI_CARVED_MOST / 4];
} sagi_carved;

// Whether a solid may be one: the part that the others are taken from, or SAG_INVALID_ID.
uint32_t sagi_carved_part(const sagi_solid *solid);
// Adds a cutter, by the box that it matters in and, if it is a ball itself, by that (else radius = ∞). False
// when it is too large for words.
bool sagi_carved_add(sagi_carved *carved, uint32_t number, const sag_box3 *box, sag_vec3 center,
                     double radius);

#endif
