// SPDX-License-Identifier: MIT
// The choices that turn a binary tree into an eight-wide one (forest.c), as they stand in sagi_binary_node.
#ifndef SAGI_BVH_FOREST_H
#define SAGI_BVH_FOREST_H

#include "bvh/binary.h"

// A binary subtree: its root's number, and the number behind its last node's.
typedef struct sagi_subtree {
    uint32_t root, end;
} sagi_subtree;

// The count of an inner node once decided: the lowest four bits stay 0. Above, in three bits for each i from
// 2 to 8: of a forest of at most i trees below the node, how many the left child gets; 0 says that one tree
// is better (never for i = 8, which is asked when the node itself is wide). Above that: if that one tree is a
// leaf, how many units it takes, else 0. A binary leaf's count has its units above the lowest four bits.
#define SAGI_FOREST_UNITS        25
#define SAGI_FOREST_BINARY_UNITS 4

static inline int sagi_forest_shift(int trees) { return 4 + 3 * (trees - 2); }
static inline uint32_t sagi_forest_left(const sagi_binary_node *n, uint32_t trees) {
    return trees < 2 ? 0 : n->count >> sagi_forest_shift((int)trees) & 7;
}

// The units of the node, standing for itself, when it is a leaf of the wide tree; else 0.
static inline uint32_t sagi_forest_units(const sagi_binary_node *n) {
    return n->count >> (sagi_binary_leaf_count(n) > 0 ? SAGI_FOREST_BINARY_UNITS : SAGI_FOREST_UNITS);
}

// Decides for all nodes; their numbers are below `end`. Writes the cost of it all, in parts of the root's
// area. SAG_ERROR_MEMORY decides nothing.
sag_status sagi_forest_decide(const sag_context *context, const sagi_leaf_maker *maker,
                              const sagi_bvh_primitive *primitives, sagi_binary_node *nodes, uint32_t end,
                              float *sah);

#endif
