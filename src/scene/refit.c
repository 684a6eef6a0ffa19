// SPDX-License-Identifier: MIT
// Refitting: the same tree over primitives that have moved. First all leaves, on all threads: each is written
// anew in its place and the box of what is in it goes to its node. Then the inner nodes from below: the box
// of a child is the union of its eight.
//
// Answers are those of a new tree; the time to trace is not, when things move far from their neighbours. What
// the tree now costs is reckoned on the way, as the builder does it (bvh/forest.c).
#include "kernel/block.h"
#include "scene/structure.h"

#define NODES_AT_A_TIME 64u

typedef struct refitter {
    sagi_snapshot *snapshot;
    const sagi_group *group;
} refitter;

static bool is_there(const sagi_bvh_node *node, int i) { return node->plane[0][i] <= node->plane[3][i]; }

static sagi_float_box child_box(const sagi_bvh_node *node, int i) {
    sagi_float_box box;
    for (int k = 0; k < 3; k++) box.lo[k] = node->plane[k][i], box.hi[k] = node->plane[3 + k][i];
    return box;
}

static sagi_float_box refit_leaf(const sagi_snapshot *s, uint32_t child) {
    sagi_bvh_primitive primitives[SAGI_BVH_MAX_LEAF];
    sagi_float_box all = sagi_float_box_empty();
    const sagi_block *block = sagi_leaf(&s->world.tree, child);
    uint32_t count = block->count;
    for (uint32_t i = 0; i < count; i++) {
        sagi_bvh_reference r = sagi_block_reference(block, i);
        sag_box3 box = sag_box3_empty();
        sagi_primitive_box(s, r.geometry, r.primitive, &box);
        primitives[i] = sagi_world_primitive(&s->world, &box, r.geometry, r.primitive);
        sagi_float_box_extend(&all, primitives[i].lo, primitives[i].hi);
    }
    sagi_leaf_write(s, primitives, count,
                    s->world.tree.leaves + (size_t)(child & ~SAGI_BVH_LEAF) * SAGI_BVH_UNIT);
    return all;
}

static void refit_leaves(void *argument, size_t index) {
    const refitter *r = argument;
    uint64_t first = (uint64_t)index * NODES_AT_A_TIME, end = first + NODES_AT_A_TIME;
    for (uint64_t n = first; n < end && n < r->group->tree.node_count; n++) {
        sagi_bvh_node *node = &r->snapshot->world.tree.nodes[r->group->node_first + n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(node, i) || (node->child[i] & SAGI_BVH_LEAF) == 0) continue;
            sagi_float_box box = refit_leaf(r->snapshot, node->child[i]);
            for (int k = 0; k < 3; k++) node->plane[k][i] = box.lo[k], node->plane[3 + k][i] = box.hi[k];
        }
    }
}

// The box of a node whose leaves are renewed, at most SAGI_BVH_MAX_DEPTH levels deep. Adds the areas that
// rays meet, each times its cost.
static sagi_float_box refit_node(sagi_snapshot *s, uint32_t number, sagi_leaf_cost price, double *cost) {
    sagi_bvh_node *node = &s->world.tree.nodes[number];
    sagi_float_box all = sagi_float_box_empty();
    for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
        if (!is_there(node, i)) continue;
        sagi_float_box box = child_box(node, i);
        if ((node->child[i] & SAGI_BVH_LEAF) != 0) {
            double count = sagi_leaf(&s->world.tree, node->child[i])->count;
            *cost +=
                (double)sagi_float_box_half_area(&box) * ((double)price.all + count * (double)price.each);
        } else {
            box = refit_node(s, node->child[i], price, cost);
            for (int k = 0; k < 3; k++) node->plane[k][i] = box.lo[k], node->plane[3 + k][i] = box.hi[k];
        }
        sagi_float_box_extend(&all, box.lo, box.hi);
    }
    *cost += (double)sagi_float_box_half_area(&all);
    return all;
}

void sagi_refit(sagi_snapshot *s, sagi_group *g) {
    refitter r = {s, g};
    double cost = 0;
    sag_parallel_for(s->context, (g->tree.node_count + NODES_AT_A_TIME - 1) / NODES_AT_A_TIME, refit_leaves,
                     &r);
    sagi_leaf_cost price = sagi_leaf_price(s, s->members[g->member_first]);
    sagi_float_box all = refit_node(s, g->node_first, price, &cost);
    double area = (double)sagi_float_box_half_area(&all);
    if (area > 0) g->tree.sah = (float)(cost / area);
}

bool sagi_refit_is_possible(const sagi_snapshot *s, const sagi_snapshot *old, const sagi_group *before) {
    for (uint32_t n = 0; n < before->tree.node_count; n++) {
        const sagi_bvh_node *node = &old->world.tree.nodes[before->node_first + n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(node, i) || (node->child[i] & SAGI_BVH_LEAF) == 0) continue;
            const sagi_block *block = sagi_leaf(&old->world.tree, node->child[i]);
            for (uint32_t k = 0; k < block->count; k++) {
                sagi_bvh_reference r = sagi_block_reference(block, k);
                sag_box3 box;
                if (r.primitive >= sagi_primitive_count(s, r.geometry) ||
                    sagi_primitive_box(s, r.geometry, r.primitive, &box) != SAGI_PRIMITIVE_GOOD)
                    return false;
            }
        }
    }
    return true;
}
