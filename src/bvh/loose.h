// SPDX-License-Identifier: MIT
// A binary tree whose nodes stand in any order, for builders that work from the leaves up and for optimisers
// that move subtrees about. Written out at the end in the order that the collapse reads (binary.h).
#ifndef SAGI_BVH_LOOSE_H
#define SAGI_BVH_LOOSE_H

#include "bvh/binary.h"

// An inner node. A child is another inner node or, with SAGI_LOOSE_LEAF, a primitive.
typedef struct sagi_loose_node {
    sagi_float_box box;
    uint32_t child[2];
    uint32_t parent; // SAGI_LOOSE_NONE: the root
    uint32_t count;  // of primitives below
} sagi_loose_node;

#define SAGI_LOOSE_LEAF 0x80000000u
#define SAGI_LOOSE_NONE 0xFFFFFFFFu

typedef struct sagi_loose_tree {
    sagi_loose_node *nodes;
    sagi_bvh_primitive *primitives;
    uint32_t count; // of primitives, at least 1; one less inner nodes are in use
    uint32_t root;  // a child like any other
} sagi_loose_tree;

static inline sagi_float_box sagi_loose_box(const sagi_loose_tree *tree, uint32_t child) {
    if (!(child & SAGI_LOOSE_LEAF)) return tree->nodes[child].box;
    const sagi_bvh_primitive *p = &tree->primitives[child & ~SAGI_LOOSE_LEAF];
    return (sagi_float_box){{p->lo[0], p->lo[1], p->lo[2]}, {p->hi[0], p->hi[1], p->hi[2]}};
}

static inline uint32_t sagi_loose_count(const sagi_loose_tree *tree, uint32_t child) {
    return child & SAGI_LOOSE_LEAF ? 1 : tree->nodes[child].count;
}

static inline sagi_float_box sagi_float_box_union(const sagi_float_box *a, const sagi_float_box *b) {
    sagi_float_box box = *a;
    sagi_float_box_extend(&box, b->lo, b->hi);
    return box;
}

// Writes the tree as nodes[0 … 2 count − 1) and its primitives in the leaves' order, with leaves of one
// primitive, on the context's threads. Where a subtree is too deep for the caps of bvh.h it is halved
// instead, so that what is written keeps to them however deep the loose tree is.
void sagi_loose_write(const sag_context *context, const sagi_loose_tree *tree, sagi_bvh_primitive *primitives,
                      sagi_binary_node *nodes);

#endif
