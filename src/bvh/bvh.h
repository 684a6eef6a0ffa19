// SPDX-License-Identifier: MIT
// The acceleration structure: a tree of boxes, eight to a node. It knows boxes and numbers, not shapes.
//
// Building goes in two steps: a binary tree, by the binned surface area heuristic (binary.c, split.c) or, for
// the fast quality, by clustering along a curve (fast.c, morton.c, ploc.c, loose.c) or, for the high one, by
// splits of space and reinsertion (high.c, spatial.c, clip.c, reinsert.c), which is then collapsed
// to nodes of eight children as cheaply as can be (forest.c, collapse.c). The tree depends on the primitives
// and their order alone, not on the number of threads.
#ifndef SAGI_BVH_BVH_H
#define SAGI_BVH_BVH_H

#include "bvh/box.h"
#include <sagitta/scene.h>

// What the tree is built over: a box and the two numbers that say whose it is. Coordinates should be of the
// order of 1 (the scene scales them), and must be finite with lo ≤ hi.
typedef struct sagi_bvh_primitive {
    float lo[3];
    uint32_t geometry;
    float hi[3];
    uint32_t primitive;
} sagi_bvh_primitive;
_Static_assert(sizeof(sagi_bvh_primitive) == 32, "each corner is followed by a number of a float's size");

typedef struct sagi_bvh_reference {
    uint32_t geometry, primitive;
} sagi_bvh_reference;

// A node: the boxes of its eight children, coordinate by coordinate, so that one instruction handles all
// eight. plane[0…2] are the lower x, y, z of each child, plane[3…5] the upper. A child without the bit
// SAGI_BVH_LEAF is the node that begins so many times eight bytes after the first one, which an instruction's
// address can say (a number would have to be multiplied by 224, and a ray alone waits for that at each node);
// with it, the rest is where its leaf begins, in units. Children that are not there have the box lo = ∞, hi =
// −∞, which no ray meets. 224 bytes: four cache lines, wherever it begins, and no power of two, so that nodes
// spread over the sets of a cache.
typedef struct sagi_bvh_node {
    float plane[6][8];
    uint32_t child[8];
} sagi_bvh_node;
_Static_assert(sizeof(sagi_bvh_node) == 224, "seven times 32 bytes");

#define SAGI_BVH_LEAF      0x80000000u
#define SAGI_BVH_STEP      ((size_t)8)  // bytes
#define SAGI_BVH_UNIT      ((size_t)64) // bytes, of leaves
#define SAGI_BVH_MAX_UNITS 63
#define SAGI_BVH_MIXED     0xFFFFFFFFu

// Caps that hold together. A leaf has at most SAGI_BVH_MAX_LEAF references and the binary tree at most
// SAGI_BVH_MAX_DEPTH levels of inner nodes: a node at depth d may hold at most
// SAGI_BVH_MAX_LEAF · 2^(SAGI_BVH_MAX_DEPTH − d) primitives, and where a split would break that for a child
// the node is halved instead, which keeps it for both. At the root it holds for any 32-bit count, at the
// bottom it says that the node fits in a leaf. Collapsing only makes paths shorter. A traversal that pushes
// all but one of a node's children a level needs a stack of SAGI_BVH_STACK_SIZE.
#define SAGI_BVH_MAX_LEAF   8
#define SAGI_BVH_MAX_DEPTH  64
#define SAGI_BVH_WIDTH      8
#define SAGI_BVH_STACK_SIZE ((SAGI_BVH_WIDTH - 1) * SAGI_BVH_MAX_DEPTH + 1)
_Static_assert(SAGI_BVH_MAX_DEPTH >= 32, "halving a 32-bit count must reach a leaf");

typedef struct sagi_bvh {
    sagi_bvh_node *nodes;               // nodes[0] is the root; NULL for an empty tree
    unsigned char *leaves;              // the leaves' data, which the maker of leaves wrote
    uint32_t node_count, node_capacity; // equal once built
    uint32_t unit_count;                // of leaves
    uint32_t leaf_count;
    uint32_t depth; // levels of nodes
    bool repeats;   // some primitives are in several leaves
    float sah;      // what a ray that meets the box costs on average, a visit of a node being 1 (forest.c)
    sagi_float_box box; // of everything; empty for an empty tree
} sagi_bvh;

#define SAGI_BVH_NODE_STEPS ((uint32_t)(sizeof(sagi_bvh_node) / SAGI_BVH_STEP))
_Static_assert(SAGI_BVH_UNIT / SAGI_BVH_STEP == 1 << 3, "batch.inl shifts by this");
#define SAGI_BVH_END_OF_NODES (SAGI_BVH_LEAF / SAGI_BVH_NODE_STEPS) // no tree has as many, nor as
#define SAGI_BVH_END_OF_UNITS SAGI_BVH_LEAF                         // many units

// A child that is the node of this number, or the leaf that begins at this unit; and back.
static inline uint32_t sagi_bvh_child_node(uint32_t number) { return number * SAGI_BVH_NODE_STEPS; }
static inline uint32_t sagi_bvh_child_leaf(uint32_t unit) { return SAGI_BVH_LEAF | unit; }
static inline bool sagi_bvh_is_leaf(uint32_t child) { return (child & SAGI_BVH_LEAF) != 0; }
static inline uint32_t sagi_bvh_number(uint32_t child) { return child / SAGI_BVH_NODE_STEPS; }
static inline uint32_t sagi_bvh_unit(uint32_t child) { return child & ~SAGI_BVH_LEAF; }
static inline sagi_bvh_node *sagi_bvh_node_at(const sagi_bvh *tree, uint32_t child) {
    return (sagi_bvh_node *)(void *)((char *)tree->nodes + child * SAGI_BVH_STEP);
}
// What begins at the leaf.
static inline unsigned char *sagi_bvh_leaf_at(const sagi_bvh *tree, uint32_t child) {
    return tree->leaves + sagi_bvh_unit(child) * SAGI_BVH_UNIT;
}

// What testing a leaf of n primitives costs, a visit of a node being 1: all + n · each.
typedef struct sagi_leaf_cost {
    float all, each;
} sagi_leaf_cost;

// Who knows what primitives are. All are called from several threads.
typedef struct sagi_leaf_maker {
    const void *user;
    // The cost of a leaf of this geometry.
    sagi_leaf_cost (*cost)(const void *user, uint32_t geometry);
    // How many units, 1 to SAGI_BVH_MAX_UNITS, a leaf of 1 to SAGI_BVH_MAX_LEAF primitives takes; no fewer
    // for more primitives. The geometry is SAGI_BVH_MIXED when they are of several.
    uint32_t (*units)(const void *user, uint32_t geometry, uint32_t count);
    // Writes the leaf into these units, which are all 0.
    void (*write)(const void *user, const sagi_bvh_primitive *primitives, uint32_t count, void *at);
} sagi_leaf_maker;

// Who knows which primitives splits of space may cut: those that are triangles and that a ray crosses once at
// most (kernel/collect.c). Called from several threads.
typedef struct sagi_clipper {
    const void *user;
    // Writes the triangle's corners in the units of boxes, each coordinate within 2⁻⁵² of the true one; false
    // for what is not to be cut.
    bool (*corners)(const void *user, const sagi_bvh_primitive *primitive, double corner[3][3]);
} sagi_clipper;

// What is asked of the builder.
typedef struct sagi_bvh_options {
    sag_quality quality;
    sagi_leaf_maker leaves;
    sagi_clipper clipper; // nothing is cut when corners is NULL
} sagi_bvh_options;

// Builds the tree over primitives[0 … count) on the context's threads; reorders them. SAG_ERROR_MEMORY leaves
// *tree alone. A count of 0 gives an empty tree.
sag_status sagi_bvh_build(const sag_context *context, const sagi_bvh_options *options,
                          sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree);
// Frees what sagi_bvh_build allocated and zeroes *tree.
void sagi_bvh_release(const sag_context *context, sagi_bvh *tree);
// Bytes of nodes and leaves.
size_t sagi_bvh_bytes(const sagi_bvh *tree);

#endif
