// SPDX-License-Identifier: MIT
// A subtree of the binary tree on one thread: bin, choose, partition in place, and again with both halves.
#include "bvh/binary.h"

// Box and centroids of primitives, for halves whose boxes no bins have told.
static void measure(const sagi_bvh_primitive *primitives, sagi_range *range) {
    sagi_extent centroids = sagi_extent_empty();
    range->box = sagi_float_box_empty();
    for (uint32_t i = 0; i < range->count; i++) {
        const sagi_bvh_primitive *p = &primitives[range->first + i];
        sagi_float_box_extend(&range->box, p->lo, p->hi);
        sagi_extent_add(&centroids, p);
    }
    range->centroids = sagi_extent_box(&centroids);
}

// Those that go left come first; both sides' centroids are measured while they pass through our hands anyway.
static void partition(sagi_bvh_primitive *primitives, const sagi_split *split, uint32_t first, uint32_t count,
                      sagi_float_box *left, sagi_float_box *right) {
    sagi_bvh_primitive *i = primitives + first, *j = i + count;
    sagi_extent l = sagi_extent_empty(), r = sagi_extent_empty();
    for (;;) {
        while (i < j && sagi_split_goes_left(split, i)) sagi_extent_add(&l, i++);
        while (i < j && !sagi_split_goes_left(split, j - 1)) sagi_extent_add(&r, --j);
        if (i == j) break;
        sagi_bvh_primitive t = *i;
        *i = *--j, *j = t;
        sagi_extent_add(&l, i++), sagi_extent_add(&r, j);
    }
    *left = sagi_extent_box(&l), *right = sagi_extent_box(&r);
}

bool sagi_binary_fits(const sagi_leaf_maker *maker, const sagi_bvh_primitive *p, uint32_t count) {
    if (count > SAGI_BVH_MAX_LEAF) return false;
    for (uint32_t i = 1; i < count; i++)
        if (p[i].geometry != p[0].geometry) return false;
    return !(maker->cost(maker->user, p[0].geometry).each > 0);
}

bool sagi_binary_build_range(const sagi_leaf_maker *maker, sagi_bvh_primitive *primitives,
                             sagi_binary_node *nodes, sagi_range range, uint32_t end) {
    sagi_range stack[SAGI_BVH_MAX_DEPTH + 1]; // right halves not yet done: one a level at most
    int waiting = 0;
    uint32_t next = range.node + 1; // nodes stand closely, so that they fill few cache lines
    sagi_bins bins;
    for (;;) {
        sagi_binary_node *node = &nodes[range.node];
        sagi_split split = {.verdict = SAGI_MAKE_LEAF};
        range.fits = sagi_binary_fits(maker, primitives + range.first, range.count);
        if (range.count > 2 || (range.count == 2 && !range.fits)) {
            sagi_bins_init(&bins, &range);
            sagi_bins_add(&bins, primitives + range.first, range.count);
            split = sagi_bins_choose(&bins, &range);
        }
        if (split.verdict == SAGI_MAKE_LEAF) {
            *node = (sagi_binary_node){range.box, range.first, range.count};
            if (waiting == 0) return true;
            range = stack[--waiting];
            nodes[range.node].link = next; // so far that was its parent's number
            range.node = next++;
            continue;
        }
        if (end - next < 1 + (uint32_t)waiting + 1) return false; // for the halves and those that wait
        uint32_t m = split.verdict == SAGI_HALVE ? range.count / 2 : split.left_count;
        sagi_range left = {.node = next++, .first = range.first, .count = m, .depth = range.depth + 1};
        sagi_range right = {
            .node = range.node, .first = range.first + m, .count = range.count - m, .depth = range.depth + 1};
        if (split.verdict == SAGI_HALVE) {
            sagi_range_halve(primitives, &range);
            measure(primitives, &left), measure(primitives, &right);
        } else {
            left.box = split.left, right.box = split.right;
            partition(primitives, &split, range.first, range.count, &left.centroids, &right.centroids);
        }
        *node = (sagi_binary_node){range.box, 0, 0};
        stack[waiting++] = right;
        range = left;
    }
}
