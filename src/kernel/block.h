// SPDX-License-Identifier: MIT
// Leaves: what the tree's lowest children are. A leaf is one block of at most eight primitives; it lies in
// the world's leaves at a multiple of SAGI_BVH_UNIT bytes and begins with a header that says what it is.
//
// Triangles of a mesh stand as 16-bit numbers on a grid of the block's own, in 192 bytes, three cache lines.
// The grid's lines are 2^-exponent world units apart in all three directions (bvh.h has the units), and its
// zero is at −1 + base·2⁻²⁰. A corner is at most half a grid step off the true vertex (SAGI_GRID_ERROR
// covers the roundings of its calculation as well). So a block answers "certainly missed" and "certainly hit"
// by itself, and where it cannot, the vertices decide: the mesh's own, or what a fourth cache line, which
// the test does not need, makes of the block's corners (corners.h).
//
// Spheres of a set without a transform stand the same way, in 64 bytes up to four of them and in 128 bytes up
// to eight: centres and radii on a grid on which all of the block's spheres lie between 0 and 65535, each
// number at most SAGI_GRID_ERROR off. And so do whole spheres that are geometries of their own, without a
// transform: to the tree all of them are one geometry, SAGI_LONE_SPHERES, in which a primitive's number is
// the true geometry's.
//
// Everything else is a list of references.
#ifndef SAGI_KERNEL_BLOCK_H
#define SAGI_KERNEL_BLOCK_H

#include "bvh/bvh.h"
#include <stddef.h>

#define SAGI_LONE_SPHERES (SAGI_BVH_MIXED - 1)

typedef enum sagi_block_kind {
    SAGI_BLOCK_TRIANGLES,
    SAGI_BLOCK_REFERENCES,
    SAGI_BLOCK_SPHERES
} sagi_block_kind;

typedef struct sagi_block {
    uint8_t kind; // sagi_block_kind
    uint8_t count;
    uint8_t exponent;  // of the grid
    uint8_t edge;      // of triangles: no coordinate of an edge is longer than (edge + 1) · 256 grid steps
    uint32_t geometry; // of triangles and spheres
    uint64_t base;     // of the grid: x, y, z in 21 bits each
} sagi_block;
_Static_assert(sizeof(sagi_block) == 16, "the primitives' numbers follow");

// A triangle's corners are a, b and c; of a mirrored mesh b and c have changed places (leaf.inl). Rows of
// eight numbers, one a triangle, stand two by two, four numbers of the one and four of the other in turns: an
// instruction that puts 16-bit numbers of two registers side by side then makes floats of a row at once
// (sagi_f8_rows, simd.h). pair[k] are coordinate k of a and of b, pair[3] x and y of c; its z is alone.
// rest[j] is what triangle j's corners lack (corners.h). What is beyond count is 0.
typedef struct sagi_triangle_block {
    sagi_block head;
    uint16_t last[SAGI_BVH_WIDTH];
    uint32_t primitive[SAGI_BVH_WIDTH];
    uint16_t pair[4][2 * SAGI_BVH_WIDTH];
    uint64_t rest[SAGI_BVH_WIDTH];
} sagi_triangle_block;
_Static_assert(sizeof(sagi_triangle_block) == 4 * SAGI_BVH_UNIT, "four cache lines");
_Static_assert(offsetof(sagi_triangle_block, pair) == SAGI_BVH_UNIT, "no pair lies in two");

// Where coordinate k of corner i of triangle j stands.
static inline uint16_t *sagi_block_corner(sagi_triangle_block *block, int i, int k, int j) {
    if (i == 2 && k == 2) return &block->last[j];
    const int row = i == 2 ? 3 : k, second = i == 2 ? k : i;
    return &block->pair[row][(j & 3) + 4 * second + 8 * (j >> 2)];
}

#define SAGI_GRID_BITS         16
#define SAGI_GRID_MAX_EXPONENT 40
#define SAGI_GRID_ERROR        (0.5 + 0x1p-10) // in grid steps
#define SAGI_GRID_BASE_BITS    21

// A block of spheres is the header, then four rows of numbers (x, y, z, radius) and one row of the
// primitives' numbers, each four or eight long. What is beyond count is 0. Eight numbers of a row may be read
// in any case and are within the block: with rows of four the last ones belong to the next row.
static inline uint32_t sagi_sphere_row_length(uint32_t count) { return count <= 4 ? 4 : SAGI_BVH_WIDTH; }
static inline const uint16_t *sagi_sphere_row(const sagi_block *head, uint32_t row) {
    return (const uint16_t *)(const void *)(head + 1) + row * sagi_sphere_row_length(head->count);
}
static inline const uint32_t *sagi_sphere_primitives(const sagi_block *head) {
    return (const uint32_t *)(const void *)sagi_sphere_row(head, 4);
}

// References by geometry, so that shapes of one kind stand together.
typedef struct sagi_reference_block {
    sagi_block head;
    sagi_bvh_reference reference[SAGI_BVH_MAX_LEAF];
} sagi_reference_block;

// How long a block of this kind is.
static inline size_t sagi_block_bytes(sagi_block_kind kind, uint32_t count) {
    switch (kind) {
    case SAGI_BLOCK_TRIANGLES: return sizeof(sagi_triangle_block);
    case SAGI_BLOCK_REFERENCES: return sizeof(sagi_block) + count * sizeof(sagi_bvh_reference);
    case SAGI_BLOCK_SPHERES:
        return sizeof(sagi_block) + sagi_sphere_row_length(count) * (4 * sizeof(uint16_t) + sizeof(uint32_t));
    }
    return 0;
}

static inline const sagi_block *sagi_leaf(const sagi_bvh *tree, uint32_t child) {
    return (const sagi_block *)(const void *)sagi_bvh_leaf_at(tree, child);
}

// What primitive i of a block is, of any kind.
static inline sagi_bvh_reference sagi_block_reference(const sagi_block *block, uint32_t i) {
    if (block->kind == SAGI_BLOCK_REFERENCES)
        return ((const sagi_reference_block *)(const void *)block)->reference[i];
    if (block->kind == SAGI_BLOCK_SPHERES && block->geometry == SAGI_LONE_SPHERES)
        return (sagi_bvh_reference){sagi_sphere_primitives(block)[i], 0};
    if (block->kind == SAGI_BLOCK_SPHERES)
        return (sagi_bvh_reference){block->geometry, sagi_sphere_primitives(block)[i]};
    return (sagi_bvh_reference){block->geometry,
                                ((const sagi_triangle_block *)(const void *)block)->primitive[i]};
}

#endif
