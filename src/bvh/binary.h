// SPDX-License-Identifier: MIT
// The binary tree between the builder's steps.
#ifndef SAGI_BVH_BINARY_H
#define SAGI_BVH_BINARY_H

#include "bvh/bvh.h"

// Node s over the primitives [first, first + n). Its left child is node s + 1, its right child node `link`.
// A subtree over n primitives owns 2n − 1 consecutive numbers beginning with its root's, so that threads
// number their subtrees without asking each other: with m primitives on the left, the right child is
// s + 2m. (Leaves of several primitives leave numbers unused.)
typedef struct sagi_binary_node {
    sagi_float_box box;
    uint32_t link;  // leaf: the first primitive; inner: the right child
    uint32_t count; // leaf: how many primitives; inner: 0
} sagi_binary_node;

// A range of primitives that is to become the subtree at `node`.
typedef struct sagi_range {
    uint32_t node, first, count, depth;
    sagi_float_box box;       // of the primitives
    sagi_float_box centroids; // of their centroids, times two (lo + hi)
} sagi_range;

// Where a range is cut: primitives whose bin on the axis is < bin go left.
typedef enum sagi_verdict { SAGI_MAKE_LEAF, SAGI_SPLIT, SAGI_HALVE } sagi_verdict;
typedef struct sagi_split {
    sagi_verdict verdict; // the rest is for SAGI_SPLIT
    int axis;
    int bin;
    float origin, scale; // bin = (centroid − origin) · scale
    uint32_t left_count;
    sagi_float_box left, right;
} sagi_split;

#define SAGI_MAX_BINS 16

typedef struct sagi_bin {
    float lo[4], hi[4]; // the fourth is not used: four floats are one register
    uint32_t count;
} sagi_bin;

typedef struct sagi_bins {
    int count;
    float origin[3], scale[3];
    sagi_bin at[3][SAGI_MAX_BINS];
} sagi_bins;

// Empty bins that fit the range's centroids.
void sagi_bins_init(sagi_bins *bins, const sagi_range *range);
void sagi_bins_add(sagi_bins *bins, const sagi_bvh_primitive *primitives, uint32_t count);
// Adds the contents of bins made alike.
void sagi_bins_merge(sagi_bins *bins, const sagi_bins *other);
// The cheapest split by the surface area heuristic, or the verdict that a leaf is cheaper, or that the depth
// cap asks for halving.
sagi_split sagi_bins_choose(const sagi_bins *bins, const sagi_range *range);

static inline float sagi_centroid(const sagi_bvh_primitive *p, int axis) { return p->lo[axis] + p->hi[axis]; }

static inline int sagi_bin_of(float centroid, float origin, float scale) {
    return (int)((centroid - origin) * scale);
}

static inline bool sagi_split_goes_left(const sagi_split *split, const sagi_bvh_primitive *p) {
    return sagi_bin_of(sagi_centroid(p, split->axis), split->origin, split->scale) < split->bin;
}

// Reorders primitives so that the half with the smaller centroids on the widest axis comes first.
void sagi_range_halve(sagi_bvh_primitive *primitives, const sagi_range *range);

// Nodes for the whole range below `range`, on the calling thread.
void sagi_binary_build_range(sagi_bvh_primitive *primitives, sagi_binary_node *nodes, sagi_range range);

// The eight-wide tree of a binary one whose root is nodes[0]; the leaves' references are sorted.
sag_status sagi_bvh_collapse(const sag_context *context, const sagi_binary_node *nodes,
                             const sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree);

#endif
