// SPDX-License-Identifier: MIT
// A binary tree whose nodes stand in any order, for builders that work from the leaves up and for optimisers
// that move subtrees about. Written out at the end in the order that the collapse reads (binary.h).
#ifndef SAGI_BVH_LOOSE_H
#define SAGI_BVH_LOOSE_H

#include "bvh/binary.h"

// An inner node. A child is another inner node or, with SAGI_LOOSE_LEAF, a leaf: the number of its first
// primitive.
typedef struct sagi_loose_node {
    sagi_float_box box;
    uint32_t child[2];
    uint32_t parent; // SAGI_LOOSE_NONE: the root
    uint32_t count;  // of leaves below
    uint32_t size;   // of primitives below; only where leaves may have several
} sagi_loose_node;

#define SAGI_LOOSE_LEAF 0x80000000u
#define SAGI_LOOSE_NONE 0xFFFFFFFFu

typedef struct sagi_loose_tree {
    sagi_loose_node *nodes;
    sagi_bvh_primitive *primitives;
    const uint8_t *leaf_size; // of a leaf by its first primitive; NULL: they have one each
    uint32_t count;           // of leaves, at least 1; one less inner nodes are in use
    uint32_t root;            // a child like any other
} sagi_loose_tree;

static inline uint32_t sagi_loose_leaf_size(const sagi_loose_tree *tree, uint32_t first) {
    return tree->leaf_size != NULL ? tree->leaf_size[first] : 1;
}

static inline sagi_float_box sagi_loose_box(const sagi_loose_tree *tree, uint32_t child) {
    if (!(child & SAGI_LOOSE_LEAF)) return tree->nodes[child].box;
    uint32_t first = child & ~SAGI_LOOSE_LEAF, end = first + sagi_loose_leaf_size(tree, first);
    sagi_float_box box = sagi_float_box_empty();
    for (uint32_t i = first; i < end; i++)
        sagi_float_box_extend(&box, tree->primitives[i].lo, tree->primitives[i].hi);
    return box;
}

static inline uint32_t sagi_loose_count(const sagi_loose_tree *tree, uint32_t child) {
    return child & SAGI_LOOSE_LEAF ? 1 : tree->nodes[child].count;
}

static inline uint32_t sagi_loose_size(const sagi_loose_tree *tree, uint32_t child) {
    if (child & SAGI_LOOSE_LEAF) return sagi_loose_leaf_size(tree, child & ~SAGI_LOOSE_LEAF);
    return tree->leaf_size != NULL ? tree->nodes[child].size : tree->nodes[child].count;
}

static inline sagi_float_box sagi_float_box_union(const sagi_float_box *a, const sagi_float_box *b) {
    sagi_float_box box = *a;
    sagi_float_box_extend(&box, b->lo, b->hi);
    return box;
}

// Writes the tree as nodes[0 … 2 count − 1), count being of leaves, and its primitives in the leaves' order,
// on the context's threads. With a maker, small subtrees become leaves where they may and splitting gains
// little (SAGI_LEAF_SHARE). Where a subtree is too deep for the caps of bvh.h it is halved instead, so that
// what is written keeps to them however deep the loose tree is.
void sagi_loose_write(const sag_context *context, const sagi_leaf_maker *maker, const sagi_loose_tree *tree,
                      sagi_bvh_primitive *primitives, sagi_binary_node *nodes);

#endif
