// SPDX-License-Identifier: MIT
// The binary tree between the builder's steps.
#ifndef SAGI_BVH_BINARY_H
#define SAGI_BVH_BINARY_H

#include "bvh/bvh.h"
#include "bvh/lanes.h"
#include <stddef.h>

// Node s over the primitives [first, first + n). Its left child is node s + 1, its right child node `link`.
// Numbers may be left unused. No node is deeper than SAGI_BVH_MAX_DEPTH levels below the root. Leaves may
// hold the same primitive with several boxes.
typedef struct sagi_binary_node {
    sagi_float_box box;
    uint32_t link;  // leaf: the first primitive; inner: the right child
    uint32_t count; // leaf: how many primitives; inner: 0, and later above the lowest bits choices (forest.h)
} sagi_binary_node;

// How many primitives a leaf has; 0 for an inner node.
static inline uint32_t sagi_binary_leaf_count(const sagi_binary_node *n) { return n->count & 15; }

// A range of primitives that is to become the subtree at `node`.
typedef struct sagi_range {
    uint32_t node, first, count, depth;
    sagi_float_box box;       // of the primitives
    sagi_float_box centroids; // of their centroids, times two (lo + hi)
    bool fits;                // they may be one leaf
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

// A bin's box; the fourth lanes mean nothing. Aligned, so that no access crosses a cache line.
typedef struct sagi_bin {
    _Alignas(32) float lo[4];
    float hi[4];
} sagi_bin;

// Boxes and counts of the primitives in each bin of each axis.
typedef struct sagi_bins {
    sagi_bin at[3][SAGI_MAX_BINS];
    uint32_t held[3][SAGI_MAX_BINS];
    float origin[4], scale[4];
    int count;
} sagi_bins;

// Empty bins that fit the range's centroids.
void sagi_bins_init(sagi_bins *bins, const sagi_range *range);
void sagi_bins_add(sagi_bins *bins, const sagi_bvh_primitive *primitives, uint32_t count);
// Adds the contents of bins made alike.
void sagi_bins_merge(sagi_bins *bins, const sagi_bins *other);
// How many of the primitives in the bins go left.
uint32_t sagi_bins_left(const sagi_bins *bins, const sagi_split *split);
// The cheapest split by the surface area heuristic, or the verdict that a leaf is cheaper, or that the depth
// cap asks for halving.
sagi_split sagi_bins_choose(const sagi_bins *bins, const sagi_range *range);

static inline float sagi_centroid(const sagi_bvh_primitive *p, int axis) { return p->lo[axis] + p->hi[axis]; }

// A primitive's corners; the fourth lanes hold its numbers, taken for floats, and go nowhere. (Such floats
// are mostly denormal, which makes sums and products slow: sagi_lanes_clear before calculating with them.)
static inline sagi_lanes sagi_lower(const sagi_bvh_primitive *p) { return sagi_lanes_load(p); }
static inline sagi_lanes sagi_upper(const sagi_bvh_primitive *p) {
    return sagi_lanes_load((const char *)p + offsetof(sagi_bvh_primitive, hi));
}

// The extent of centroids (lo + hi) while primitives pass by.
typedef struct sagi_extent {
    sagi_lanes lo, hi;
} sagi_extent;

static inline sagi_extent sagi_extent_empty(void) {
    return (sagi_extent){sagi_lanes_fill(INFINITY), sagi_lanes_fill(-INFINITY)};
}
static inline void sagi_extent_add(sagi_extent *e, const sagi_bvh_primitive *p) {
    sagi_lanes c = sagi_lanes_add(sagi_lower(p), sagi_upper(p));
    e->lo = sagi_lanes_min(c, e->lo), e->hi = sagi_lanes_max(c, e->hi);
}
static inline sagi_float_box sagi_extent_box(const sagi_extent *e) {
    float lo[4], hi[4];
    sagi_lanes_store(lo, e->lo), sagi_lanes_store(hi, e->hi);
    return (sagi_float_box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

// By the very arithmetic that put primitives into bins.
static inline bool sagi_split_goes_left(const sagi_split *split, const sagi_bvh_primitive *p) {
    return (int)((sagi_centroid(p, split->axis) - split->origin) * split->scale) < split->bin;
}

// The most primitives a node at this depth may hold (bvh.h); below the deepest level none.
static inline uint64_t sagi_depth_allows(uint32_t depth) {
    if (depth > SAGI_BVH_MAX_DEPTH) return 0;
    uint32_t levels = SAGI_BVH_MAX_DEPTH - depth;
    return levels >= 32 ? UINT64_MAX : (uint64_t)SAGI_BVH_MAX_LEAF << levels;
}

// Reorders primitives so that the half with the smaller centroids on the widest axis comes first.
void sagi_range_halve(sagi_bvh_primitive *primitives, const sagi_range *range);

// What may be one leaf, at one price for any number of primitives, is cut only when the halves' areas add up
// to less than this share of the whole: when it is a longish thing, not a patch of a surface. (Cutting
// whenever it fits down to two makes trees 0.2 % cheaper, with 8 % more memory and more work for builders.)
#define SAGI_LEAF_SHARE 0.85f

// Whether the primitives may be one leaf: of one geometry, whose leaves cost the same however many they hold.
// Others are split down to single ones.
bool sagi_binary_fits(const sagi_leaf_maker *maker, const sagi_bvh_primitive *primitives, uint32_t count);

// Nodes for the whole range below `range`, on the calling thread, with numbers below `end`; false when these
// do not suffice.
bool sagi_binary_build_range(const sagi_leaf_maker *maker, sagi_bvh_primitive *primitives,
                             sagi_binary_node *nodes, sagi_range range, uint32_t end);

// Passes over a finished binary tree cut it into subtrees of so many node numbers at most, each of which one
// thread does: `most`, but in a small tree less, so that there is something to do for all.
static inline uint32_t sagi_task_size(uint32_t end, uint32_t most) {
    const uint32_t least = 512, part = end / 16;
    return part > most ? most : part < least ? least : part;
}

// The eight-wide tree of a binary one whose root is nodes[0] and whose numbers are below `end`. Changes the
// inner nodes' counts. SAG_ERROR_MEMORY leaves *tree alone.
sag_status sagi_bvh_collapse(const sag_context *context, const sagi_leaf_maker *maker,
                             sagi_binary_node *nodes, uint32_t end, const sagi_bvh_primitive *primitives,
                             sagi_bvh *tree);

// sagi_bvh_build of the other qualities (fast.c, high.c).
sag_status sagi_bvh_build_high(const sag_context *context, const sagi_bvh_options *options,
                               const sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree);
sag_status sagi_bvh_build_fast(const sag_context *context, const sagi_bvh_options *options,
                               sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree);

#endif
