// SPDX-License-Identifier: MIT
// Blocks of triangles and rays that are made to break the kernel's float filters (kernel/triangles.inl,
// kernel/ray.h): everything that is decided within fractions of a step of the blocks' grids or within
// roundings of floats, and everything at the edge of boxes.
#ifndef TESTS_SUPPORT_FILTER_ADVERSARY_H
#define TESTS_SUPPORT_FILTER_ADVERSARY_H

#include "support/exact_block.h"
#include "support/random.h"

enum { ADVERSARY_KINDS = 8 };
extern const char *const adversary_names[ADVERSARY_KINDS];

// A block of whole numbers, times a power of two between 1e-12 and 1e12.
void adversary_block(rng *r, int kind, exact_block *block);
// Moves it to where it is no whole numbers any more: turned by roundings, far off the origin. `size` is what
// it was made with.
void adversary_disturb(rng *r, exact_block *block);
// A ray at a block, by whole numbers where the block has them and the dice say so.
void adversary_line(rng *r, const exact_block *block, exact_line *line);
// `count` rays from one point in directions that are nearly the same, as a camera has them, aimed like the
// above: what a kernel may answer together.
void adversary_bundle(rng *r, const exact_block *block, exact_line *lines, int count);

#endif
