// SPDX-License-Identifier: MIT
// Solids that are dented: boxes and balls in common, without other boxes and balls (a die, a bead, a lens).
// What they have in common is convex, a ray enters it once; and only if that place is in a dent, it goes on
// to where it leaves the dent. This is how packets read them, in floats (kernel/packet_solids.inl).
#ifndef SAGI_SOLID_DENTED_H
#define SAGI_SOLID_DENTED_H

#include "solid/tree.h"

#define SAGI_DENTED_MOST 64 // parts

// In the units of sagi_dented: |coordinates| ≤ 8, off by 2⁻²¹ at most.
typedef struct sagi_dented_part {
    float lo[3], hi[3]; // of a box; of a ball lo is the centre, hi[0] the radius
    uint32_t part;
    bool is_ball;
} sagi_dented_part;

typedef struct sagi_dented {
    sag_vec3 origin; // p is at (p − origin) · scale; what the convex ones have in common is within [−1, 1]³
    double scale;                 // a power of two
    uint32_t convex_count, count; // the convex ones come first
    sagi_dented_part parts[SAGI_DENTED_MOST];
} sagi_dented;

// Whether the tree is such a one, for any parts; then *first is the node of the convex ones (or
// SAG_INVALID_ID: part 0 alone is convex).
bool sagi_dented_tree(const sagi_solid *solid, uint32_t *first);
// Begins with the box around the convex ones' common place; false when there are no numbers for it.
bool sagi_dented_begin(sagi_dented *dented, const sag_box3 *box);
// Adds a part, the convex ones first; false when it is too large.
bool sagi_dented_add(sagi_dented *dented, uint32_t part, const sag_box3 *box, const sag_sphere *ball);

#endif
