// SPDX-License-Identifier: MIT
// Clustering from the leaves up.
#ifndef SAGI_BVH_PLOC_H
#define SAGI_BVH_PLOC_H

#include "bvh/loose.h"

#define SAGI_PLOC_RADIUS 8 // neighbours looked at on each side

// Clusters in the order of a curve: their boxes, coordinate by coordinate, and what they are in the tree.
// Arrays hold SAGI_PLOC_RADIUS more than there are clusters.
typedef struct sagi_clusters {
    float *lo[3], *hi[3];
    float *cost;       // of the merger with the nearest neighbour
    uint32_t *nearest; // which that is
    uint32_t *child;   // as in sagi_loose_node
    uint32_t count;
} sagi_clusters;

// Spreads the arrays over memory of at least SAGI_CLUSTERS_FLOATS(capacity) floats and empties them.
#define SAGI_CLUSTERS_FLOATS(capacity) (9 * ((size_t)(capacity) + SAGI_PLOC_RADIUS))
void sagi_clusters_init(sagi_clusters *clusters, float *memory, size_t capacity);
void sagi_clusters_add(sagi_clusters *clusters, const sagi_loose_tree *tree, uint32_t child);

// Merges clusters until one is left, which is returned. New nodes get the numbers slots[0], slots[1] … or,
// when slots is NULL, slot, slot + 1 …: as many as clusters but one.
uint32_t sagi_clusters_merge(sagi_clusters *clusters, sagi_loose_tree *tree, const uint32_t *slots,
                             uint32_t slot);

#endif
