// SPDX-License-Identifier: MIT
// The groups' trees put together as one: copied behind each other, with the numbers of children moved, below
// a few nodes over their roots. Copying is as fast as memory is, and the traversal knows nothing of groups.
//
// The nodes on top are those of a small tree over the groups' boxes, made by the same builder. A leaf of it
// names one or more groups: where it is one, the group's root takes its place; where there are more, a node
// does that has their roots for children.
#include "scene/structure.h"
#include <string.h>

#define NODES_AT_A_TIME 1024u

// What a leaf of the top holds, in one unit.
typedef struct top_leaf {
    uint32_t count, group[SAGI_BVH_MAX_LEAF];
} top_leaf;
_Static_assert(sizeof(top_leaf) <= SAGI_BVH_UNIT, "one unit");

static sagi_leaf_cost top_price(const void *user, uint32_t group) {
    (void)user, (void)group;
    return (sagi_leaf_cost){.each = 1};
}
static uint32_t top_units(const void *user, uint32_t group, uint32_t count) {
    (void)user, (void)group, (void)count;
    return 1;
}
static void top_write(const void *user, const sagi_bvh_primitive *primitives, uint32_t count, void *at) {
    (void)user;
    top_leaf leaf = {.count = count};
    for (uint32_t i = 0; i < count; i++) leaf.group[i] = primitives[i].geometry;
    memset(at, 0, SAGI_BVH_UNIT);
    memcpy(at, &leaf, sizeof leaf);
}

static top_leaf read_leaf(const sagi_bvh *top, uint32_t child) {
    top_leaf leaf;
    memcpy(&leaf, sagi_bvh_leaf_at(top, child), sizeof leaf);
    return leaf;
}

static bool is_there(const sagi_bvh_node *node, int i) { return node->plane[0][i] <= node->plane[3][i]; }

// The tree over the groups that have one. Fewer than two need none.
static sag_status build_top(const sagi_snapshot *s, sagi_bvh *top) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->group_count; i++) count += s->groups[i].tree.node_count > 0;
    *top = (sagi_bvh){.box = sagi_float_box_empty()};
    if (count < 2) return SAG_OK;
    size_t bytes = count * sizeof(sagi_bvh_primitive);
    sagi_bvh_primitive *roots = sag_allocate(s->context, bytes), *next = roots;
    if (roots == NULL) return SAG_ERROR_MEMORY;
    for (uint32_t i = 0; i < s->group_count; i++) {
        const sagi_float_box *b = &s->groups[i].tree.box;
        if (s->groups[i].tree.node_count > 0)
            *next++ = (sagi_bvh_primitive){
                .lo = {b->lo[0], b->lo[1], b->lo[2]}, .geometry = i, .hi = {b->hi[0], b->hi[1], b->hi[2]}};
    }
    sagi_bvh_options options = {.leaves = {NULL, top_price, top_units, top_write}};
    sag_status status = sagi_bvh_build(s->context, &options, roots, count, top);
    sag_release(s->context, roots, bytes);
    return status;
}

// How many nodes there will be over the groups' roots.
static uint32_t count_top(const sagi_bvh *top) {
    uint32_t count = top->node_count;
    for (uint32_t n = 0; n < top->node_count; n++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++)
            if (is_there(&top->nodes[n], i) && sagi_bvh_is_leaf(top->nodes[n].child[i]))
                count += read_leaf(top, top->nodes[n].child[i]).count > 1;
    return count;
}

static sagi_bvh_node node_over(const sagi_snapshot *s, const top_leaf *leaf) {
    sagi_bvh_node node = {.child = {0}};
    for (uint32_t i = 0; i < SAGI_BVH_WIDTH; i++) {
        const sagi_group *g = i < leaf->count ? &s->groups[leaf->group[i]] : NULL;
        for (int k = 0; k < 3; k++) {
            node.plane[k][i] = g != NULL ? g->tree.box.lo[k] : INFINITY;
            node.plane[3 + k][i] = g != NULL ? g->tree.box.hi[k] : -INFINITY;
        }
        if (g != NULL) node.child[i] = sagi_bvh_child_node(g->node_first);
    }
    return node;
}

static void write_top(sagi_snapshot *s, const sagi_bvh *top) {
    sagi_bvh_node *nodes = s->world.tree.nodes;
    uint32_t extra = top->node_count;
    for (uint32_t n = 0; n < top->node_count; n++) {
        nodes[n] = top->nodes[n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(&nodes[n], i) || !sagi_bvh_is_leaf(nodes[n].child[i])) continue;
            top_leaf leaf = read_leaf(top, nodes[n].child[i]);
            nodes[n].child[i] =
                sagi_bvh_child_node(leaf.count > 1 ? extra : s->groups[leaf.group[0]].node_first);
            if (leaf.count > 1) nodes[extra++] = node_over(s, &leaf);
        }
    }
}

// A group's tree on its way to its place.
typedef struct copier {
    const sagi_bvh_node *from;
    sagi_bvh_node *to;
    uint32_t count, nodes_by, leaves_by; // what is added to children that are nodes and leaves
} copier;

static void copy_nodes(void *argument, size_t index) {
    const copier *c = argument;
    uint64_t first = (uint64_t)index * NODES_AT_A_TIME, end = first + NODES_AT_A_TIME;
    for (uint64_t n = first; n < end && n < c->count; n++) {
        sagi_bvh_node *node = &c->to[n];
        *node = c->from[n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!is_there(node, i)) continue;
            node->child[i] += sagi_bvh_is_leaf(node->child[i]) ? c->leaves_by : c->nodes_by;
        }
    }
}

static void copy_group(sagi_snapshot *s, sagi_group *g, const sagi_bvh *from, uint32_t node_first,
                       uint32_t unit_first) {
    if (g->tree.node_count == 0) return;
    copier c = {.from = from->nodes + node_first,
                .to = s->world.tree.nodes + g->node_first,
                .count = g->tree.node_count,
                .nodes_by = (g->node_first - node_first) * SAGI_BVH_NODE_STEPS,
                .leaves_by = g->unit_first - unit_first};
    sag_parallel_for(s->context, (c.count + NODES_AT_A_TIME - 1) / NODES_AT_A_TIME, copy_nodes, &c);
    memcpy(s->world.tree.leaves + g->unit_first * SAGI_BVH_UNIT, from->leaves + unit_first * SAGI_BVH_UNIT,
           g->tree.unit_count * SAGI_BVH_UNIT);
}

// What each group's tree is. The box of one that is refitted is what it will be.
static void take_descriptions(sagi_snapshot *s, const sagi_job *jobs) {
    for (uint32_t i = 0; i < s->group_count; i++) {
        sagi_group *g = &s->groups[i];
        g->tree = jobs[i].plan == SAGI_BUILD ? jobs[i].tree : jobs[i].before->tree;
        g->tree.nodes = NULL, g->tree.leaves = NULL;
        g->is_refitted =
            jobs[i].plan == SAGI_REFIT || (jobs[i].plan == SAGI_KEEP && jobs[i].before->is_refitted);
        if (jobs[i].plan != SAGI_REFIT) continue;
        sagi_bvh_primitive box = sagi_world_primitive(&s->world, &g->found.bounds, 0, 0);
        g->tree.box = sagi_float_box_empty();
        sagi_float_box_extend(&g->tree.box, box.lo, box.hi);
    }
}

// Their places; false when there are more nodes or units than can be numbered.
static bool place_groups(sagi_snapshot *s, uint64_t *nodes, uint64_t *units) {
    for (uint32_t i = 0; i < s->group_count; i++) {
        sagi_group *g = &s->groups[i];
        g->node_first = (uint32_t)*nodes, g->unit_first = (uint32_t)*units;
        *nodes += g->tree.node_count, *units += g->tree.unit_count;
        if (*nodes >= SAGI_BVH_END_OF_NODES || *units >= SAGI_BVH_END_OF_UNITS) return false;
    }
    return true;
}

// Counts and costs of the whole.
static void describe(sagi_snapshot *s, const sagi_bvh *top, uint32_t top_levels) {
    sagi_bvh *t = &s->world.tree;
    for (uint32_t i = 0; i < s->group_count; i++) {
        const sagi_bvh *g = &s->groups[i].tree;
        t->leaf_count += g->leaf_count;
        t->repeats |= g->repeats;
        if (g->depth + top_levels > t->depth) t->depth = g->depth + top_levels;
        if (g->node_count > 0) sagi_float_box_extend(&t->box, g->box.lo, g->box.hi);
    }
    double whole = (double)sagi_float_box_half_area(&t->box), cost = (double)top->sah;
    for (uint32_t i = 0; i < s->group_count; i++) {
        const sagi_bvh *g = &s->groups[i].tree;
        // The top has counted a visit of each root as its leaf's cost, 1.
        double share = whole > 0 ? (double)sagi_float_box_half_area(&g->box) / whole : 1;
        if (g->node_count > 0) cost += share * ((double)g->sah - (top_levels > 0 ? 1 : 0));
    }
    t->sah = (float)cost;
}

static sag_status put_together(sagi_snapshot *s, const sagi_snapshot *old, sagi_job *jobs,
                               const sagi_bvh *top, bool *too_deep) {
    uint32_t over = count_top(top), levels = top->depth + (over > top->node_count), deepest = 0;
    uint64_t nodes = over, units = 0;
    if (!place_groups(s, &nodes, &units)) return SAG_ERROR_ARGUMENT;
    for (uint32_t i = 0; i < s->group_count; i++)
        if (s->groups[i].tree.depth > deepest) deepest = s->groups[i].tree.depth;
    *too_deep = levels + deepest > SAGI_BVH_MAX_DEPTH;
    if (*too_deep || nodes == 0) return SAG_OK;
    sagi_bvh *t = &s->world.tree;
    t->nodes = sag_allocate(s->context, nodes * sizeof *t->nodes);
    t->node_count = t->node_capacity = t->nodes != NULL ? (uint32_t)nodes : 0;
    t->leaves = sag_allocate(s->context, units * SAGI_BVH_UNIT);
    t->unit_count = t->leaves != NULL ? (uint32_t)units : 0;
    if (t->nodes == NULL || t->leaves == NULL) return SAG_ERROR_MEMORY;
    write_top(s, top);
    for (uint32_t i = 0; i < s->group_count; i++) {
        const sagi_group *b = jobs[i].before;
        if (jobs[i].plan == SAGI_BUILD) {
            copy_group(s, &s->groups[i], &jobs[i].tree, 0, 0);
            sagi_bvh_release(s->context, &jobs[i].tree);
        } else {
            copy_group(s, &s->groups[i], &old->world.tree, b->node_first, b->unit_first);
        }
    }
    describe(s, top, levels);
    return SAG_OK;
}

sag_status sagi_assemble(sagi_snapshot *s, const sagi_snapshot *old, sagi_job *jobs, bool *too_deep) {
    sagi_bvh top;
    take_descriptions(s, jobs);
    if (s->group_count == 1 && jobs[0].plan == SAGI_BUILD) { // nothing to put together
        s->world.tree = jobs[0].tree;
        jobs[0].tree = (sagi_bvh){.nodes = NULL};
        return SAG_OK;
    }
    sag_status status = build_top(s, &top);
    if (status != SAG_OK) return status;
    status = put_together(s, old, jobs, &top, too_deep);
    sagi_bvh_release(s->context, &top);
    return status;
}
