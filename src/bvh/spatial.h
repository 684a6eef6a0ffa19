// SPDX-License-Identifier: MIT
// A binary tree by splits of space as well as of primitives.
#ifndef SAGI_BVH_SPATIAL_H
#define SAGI_BVH_SPATIAL_H

#include "bvh/loose.h"

#define SAGI_SPATIAL_BINS 16

// What a plane of space divides a range into, as bins between equal planes tell: the boxes of the parts of
// primitives in each, and how many begin and end there.
typedef struct sagi_spatial_bins {
    float origin[3], step[3]; // plane b of an axis is origin + b · step; step 0: not to be split
    sagi_float_box box[3][SAGI_SPATIAL_BINS];
    uint32_t begin[3][SAGI_SPATIAL_BINS], end[3][SAGI_SPATIAL_BINS];
} sagi_spatial_bins;

// The cheapest plane that leaves no more than `most` parts: cost ∞ when there is none. Counts and boxes are
// of the parts on either side.
typedef struct sagi_plane_split {
    float cost; // n · area of the left side plus that of the right
    int axis;
    float plane;
    uint32_t left_count, right_count;
    sagi_float_box left, right;
} sagi_plane_split;

void sagi_spatial_bins_init(sagi_spatial_bins *bins, const sagi_float_box *box);
void sagi_spatial_bins_add(sagi_spatial_bins *bins, const sagi_clipper *clipper,
                           const sagi_bvh_primitive *primitives, uint32_t count);
void sagi_spatial_bins_merge(sagi_spatial_bins *bins, const sagi_spatial_bins *other);
sagi_plane_split sagi_spatial_bins_choose(const sagi_spatial_bins *bins, uint32_t most);

// Builds over primitives[0 … count), which stand in tree->primitives with room for `capacity`, each in one
// leaf or more; counts them in tree->count and moves them there to gaps among the rest. Numbers of inner
// nodes are below `capacity`; unused ones have a count of 0. scratch has room for `capacity` too.
sag_status sagi_spatial_build(const sag_context *context, const sagi_clipper *clipper, sagi_loose_tree *tree,
                              uint32_t capacity, sagi_bvh_primitive *scratch);

#endif
