// SPDX-License-Identifier: MIT
// Primitives along a curve that fills space.
#ifndef SAGI_BVH_MORTON_H
#define SAGI_BVH_MORTON_H

#include "bvh/binary.h"

// Keys: a Morton code in the upper 33 bits, a primitive's number in the lower 31.
#define SAGI_MORTON_INDEX 31
#define SAGI_MORTON_BITS  11 // an axis

// Sorts the `count` < 2³¹ primitives in the order of the Morton codes of their centroids: writes keys[0 …
// count); primitives of one code come by their number. scratch has room for as many. On the context's
// threads. SAG_ERROR_MEMORY.
sag_status sagi_morton_sort(const sag_context *context, const sagi_bvh_primitive *primitives, uint32_t count,
                            uint64_t *keys, uint64_t *scratch);

#endif
