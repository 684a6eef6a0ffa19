// SPDX-License-Identifier: MIT
// Parallel locally-ordered clustering (Meister & Bittner, "Parallel Locally-Ordered Clustering for Bounding
// Volume Hierarchy Construction", TVCG 24(3), 2018). Clusters stand along a curve. Each looks at a few
// neighbours on either side for the one with which it shares the smallest box; two that choose each other
// merge; and so on with those that are left.
//
// There is always a pair to merge: of the pairs with the least cost take the one with the smallest left
// member, then the smallest right one; both choose each other, as of equal costs the left neighbour, then the
// smallest number wins. How many pairs there are depends on the scene, and there are scenes (boxes that grow
// along the curve) with one a round; then neighbours are paired as they stand, so that a round always leaves
// at most 15/16 of the clusters and the work is bounded by the count times a constant.
#include "bvh/ploc.h"

#define FAR_AWAY 0x1p60f // a box from −this to this costs more than any two clusters, and is finite

void sagi_clusters_init(sagi_clusters *c, float *memory, size_t capacity) {
    size_t stride = capacity + SAGI_PLOC_RADIUS;
    for (int k = 0; k < 3; k++) c->lo[k] = memory + (size_t)k * stride, c->hi[k] = c->lo[k] + 3 * stride;
    c->cost = memory + 6 * stride;
    c->nearest = (uint32_t *)(void *)(memory + 7 * stride);
    c->child = (uint32_t *)(void *)(memory + 8 * stride);
    c->count = 0;
}

void sagi_clusters_add(sagi_clusters *c, const sagi_loose_tree *tree, uint32_t child) {
    sagi_float_box box = sagi_loose_box(tree, child);
    for (int k = 0; k < 3; k++) c->lo[k][c->count] = box.lo[k], c->hi[k][c->count] = box.hi[k];
    c->child[c->count++] = child;
}

// Half the area of the box around cluster i and each of the next few. (Loops without branches, of a fixed
// length: they become vector instructions.)
static inline void costs_with_next(const sagi_clusters *c, uint32_t i, float cost[SAGI_PLOC_RADIUS]) {
    float size[3][SAGI_PLOC_RADIUS];
    for (int k = 0; k < 3; k++) {
        const float *lo = c->lo[k] + i, *hi = c->hi[k] + i;
        for (int d = 0; d < SAGI_PLOC_RADIUS; d++)
            size[k][d] = sagi_float_max(hi[0], hi[1 + d]) - sagi_float_min(lo[0], lo[1 + d]);
    }
    for (int d = 0; d < SAGI_PLOC_RADIUS; d++)
        cost[d] = size[0][d] * size[1][d] + size[1][d] * size[2][d] + size[2][d] * size[0][d];
}

static void find_nearest(sagi_clusters *c) {
    uint32_t n = c->count;
    for (uint32_t i = n; i < n + SAGI_PLOC_RADIUS; i++)
        for (int k = 0; k < 3; k++) c->lo[k][i] = -FAR_AWAY, c->hi[k][i] = FAR_AWAY;
    for (uint32_t i = 0; i < n + SAGI_PLOC_RADIUS; i++) c->cost[i] = INFINITY, c->nearest[i] = 0;
    for (uint32_t i = 0; i < n; i++) {
        float cost[SAGI_PLOC_RADIUS], *theirs = c->cost + i + 1;
        uint32_t *nearest = c->nearest + i + 1;
        costs_with_next(c, i, cost);
        for (int d = 0; d < SAGI_PLOC_RADIUS; d++) {
            bool nearer = cost[d] < theirs[d];
            theirs[d] = nearer ? cost[d] : theirs[d];
            nearest[d] = nearer ? i : nearest[d];
        }
        float least = c->cost[i];
        uint32_t which = c->nearest[i];
        for (uint32_t d = 0; d < SAGI_PLOC_RADIUS; d++)
            if (cost[d] < least) least = cost[d], which = i + 1 + d;
        c->nearest[i] = which;
    }
}

// Makes a node of clusters i and j and puts it at `place`, which is no later than either.
static void merge(sagi_clusters *c, sagi_loose_tree *tree, uint32_t i, uint32_t j, uint32_t place,
                  uint32_t slot) {
    sagi_loose_node *node = &tree->nodes[slot];
    for (int k = 0; k < 3; k++) {
        node->box.lo[k] = c->lo[k][place] = sagi_float_min(c->lo[k][i], c->lo[k][j]);
        node->box.hi[k] = c->hi[k][place] = sagi_float_max(c->hi[k][i], c->hi[k][j]);
    }
    node->child[0] = c->child[i], node->child[1] = c->child[j];
    node->parent = SAGI_LOOSE_NONE;
    node->count = node->size = 0;
    for (int side = 0; side < 2; side++) {
        uint32_t child = node->child[side];
        node->count += sagi_loose_count(tree, child), node->size += sagi_loose_size(tree, child);
        if (!(child & SAGI_LOOSE_LEAF)) tree->nodes[child].parent = slot;
    }
    c->child[place] = slot;
}

static void keep(sagi_clusters *c, uint32_t i, uint32_t place) {
    for (int k = 0; k < 3; k++) c->lo[k][place] = c->lo[k][i], c->hi[k][place] = c->hi[k][i];
    c->child[place] = c->child[i];
}

static uint32_t count_pairs(const sagi_clusters *c) {
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < c->count; i++) pairs += c->nearest[i] > i && c->nearest[c->nearest[i]] == i;
    return pairs;
}

uint32_t sagi_clusters_merge(sagi_clusters *c, sagi_loose_tree *tree, const uint32_t *slots, uint32_t slot) {
    uint32_t made = 0;
    while (c->count > 1) {
        find_nearest(c);
        if (count_pairs(c) < c->count / 16)
            for (uint32_t i = 0; i < c->count; i++) c->nearest[i] = (i ^ 1) < c->count ? i ^ 1 : i;
        uint32_t left = 0;
        for (uint32_t i = 0; i < c->count; i++) {
            uint32_t j = c->nearest[i];
            if (j == i || c->nearest[j] != i)
                keep(c, i, left++);
            else if (i < j) {
                merge(c, tree, i, j, left++, slots != NULL ? slots[made] : slot + made);
                made++;
            }
        }
        c->count = left;
    }
    return c->child[0];
}
