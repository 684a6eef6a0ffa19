// SPDX-License-Identifier: MIT
// Refitting: the same tree over primitives that have moved. First all leaves, on all threads: each is written
// anew in its place and the box of what is in it goes to its node. Then the inner nodes from below: the box
// of a child is the union of its eight.
//
// Answers are those of a new tree; the time to trace is not, when things move far from their neighbours. What
// the tree now costs is reckoned on the way, as the builder does it (bvh/forest.c).
#include "kernel/block.h"
#include "scene/structure.h"
#include <string.h>

#define NODES_AT_A_TIME 64u

typedef struct refitter {
    sagi_snapshot *snapshot;
    const sagi_group *group;
    uint32_t primitive_count;
    bool all_good;      // every primitive there is
    atomic_bool unlike; // one in the tree is not good
} refitter;

static bool is_there(const sagi_bvh_node *node, int i) { return node->plane[0][i] <= node->plane[3][i]; }

static sagi_float_box child_box(const sagi_bvh_node *node, int i) {
    sagi_float_box box;
    for (int k = 0; k < 3; k++) box.lo[k] = node->plane[k][i], box.hi[k] = node->plane[3 + k][i];
    return box;
}

// A primitive's box in the scene's units; false when it is not good.
static bool measure(const refitter *r, sagi_bvh_reference at, sagi_bvh_primitive *out) {
    const sagi_snapshot *s = r->snapshot;
    if (s->items[at.geometry].kind == SAG_SHAPE_MESH)
        return sagi_mesh_boxes(&s->world, at.geometry, at.primitive, 1, r->all_good, out) != out;
    sag_box3 box;
    if (sagi_primitive_box(s, at.geometry, at.primitive, &box) != SAGI_PRIMITIVE_GOOD) return false;
    *out = sagi_world_primitive(&s->world, &box, at.geometry, at.primitive);
    return true;
}

static bool refit_leaf(const refitter *r, uint32_t child, sagi_float_box *all) {
    const sagi_snapshot *s = r->snapshot;
    sagi_bvh_primitive primitives[SAGI_BVH_MAX_LEAF];
    const sagi_block *block = sagi_leaf(&s->world.tree, child);
    uint32_t count = block->count, geometry = sagi_block_reference(block, 0).geometry;
    *all = sagi_float_box_empty();
    for (uint32_t i = 0; i < count; i++) {
        sagi_bvh_reference reference = sagi_block_reference(block, i);
        if (reference.primitive >= r->primitive_count || !measure(r, reference, &primitives[i])) return false;
        sagi_float_box_extend(all, primitives[i].lo, primitives[i].hi);
    }
    size_t bytes = sagi_leaf_units(s, geometry, count) * SAGI_BVH_UNIT;
    size_t there = sagi_block_bytes((sagi_block_kind)block->kind, count);
    if (bytes != (there + SAGI_BVH_UNIT - 1) / SAGI_BVH_UNIT * SAGI_BVH_UNIT) return false;
    unsigned char *at = sagi_bvh_leaf_at(&s->world.tree, child);
    memset(at, 0, bytes);
    sagi_leaf_write(s, primitives, count, at);
    return true;
}

static void refit_leaves(void *argument, size_t index) {
    refitter *r = argument;
    uint64_t first = (uint64_t)index * NODES_AT_A_TIME, end = first + NODES_AT_A_TIME;
    for (uint64_t n = first; n < end && n < r->group->tree.node_count; n++) {
        sagi_bvh_node *node = &r->snapshot->world.tree.nodes[r->group->node_first + n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(node, i) || !sagi_bvh_is_leaf(node->child[i])) continue;
            sagi_float_box box;
            if (!refit_leaf(r, node->child[i], &box)) {
                atomic_store(&r->unlike, true);
                return;
            }
            for (int k = 0; k < 3; k++) node->plane[k][i] = box.lo[k], node->plane[3 + k][i] = box.hi[k];
        }
    }
}

// The box of a node whose leaves are renewed, at most SAGI_BVH_MAX_DEPTH levels deep. Adds the areas that
// rays meet, each times its cost.
static sagi_float_box refit_node(sagi_snapshot *s, uint32_t at, sagi_leaf_cost price, double *cost) {
    sagi_bvh_node *node = sagi_bvh_node_at(&s->world.tree, at);
    sagi_float_box all = sagi_float_box_empty();
    for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
        if (!is_there(node, i)) continue;
        sagi_float_box box = child_box(node, i);
        if (sagi_bvh_is_leaf(node->child[i])) {
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

bool sagi_refit(sagi_snapshot *s, sagi_group *g) {
    uint32_t id = s->members[g->member_first];
    refitter r = {.snapshot = s, .group = g, .primitive_count = sagi_primitive_count(s, id)};
    r.all_good = g->found.good == r.primitive_count;
    double cost = 0;
    sag_parallel_for(s->context, (g->tree.node_count + NODES_AT_A_TIME - 1) / NODES_AT_A_TIME, refit_leaves,
                     &r);
    if (atomic_load(&r.unlike)) return false;
    sagi_float_box all = refit_node(s, sagi_bvh_child_node(g->node_first), sagi_leaf_price(s, id), &cost);
    double area = (double)sagi_float_box_half_area(&all);
    if (area > 0) g->tree.sah = (float)(cost / area);
    return true;
}
