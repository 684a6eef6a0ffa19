// SPDX-License-Identifier: MIT
// Which binary nodes become nodes of eight children, which become leaves, and which vanish.
//
// The surface area heuristic says what a random ray that meets the root costs on average: NODE_COST for every
// wide node and the leaf's cost for every leaf, each times its share of the root's area. The cheapest tree is
// found exactly by dynamic programming (Wald, Benthin & Boulos, "Getting Rid of Packets", 2008; Ylitie,
// Karras & Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017, section
// 3). Let c(n, i) be the least cost of everything below the binary node n as a forest of at most i trees.
// Then
//     d(n, i) = min over 0 < k < i of c(left, k) + c(right, i − k)      two forests side by side
//     c(n, 1) = min of  the leaf's cost · A(n)                          if it may be one
//                       NODE_COST · A(n) + d(n, 8)                      one wide node over at most eight
//     c(n, i) = min of c(n, 1) and d(n, i).
// The choices (the k of each d, 0 for the first case) stay with the node. The costs live on a stack only as
// long as the parent wants them, so the memory is that of the tree. A leaf is of one geometry: leaves of
// several exist only where the builder of the binary tree made one.
//
// Costs are positive floats. Their last three bits are given up to hold the k they belong to: one minimum
// finds the cost together with the choice, and eight of them are compared at once.
#include "bvh/forest.h"
#include <string.h>

#define NODE_COST 1.0f
// What is so small that rays hardly ever meet it should at least take little memory: no box counts for less
// than the root's area over this times the nodes' numbers, so all small ones together for little.
#define LEAST_AREA   4.0f
#define MOST_OF_TASK 8192u // binary nodes (by their numbers) that one thread does at a time

// No cost comes near; sums of two stay finite.
#define NO_COST 0x1p120f

// c(n, i) at cost[8 + i] for 1 ≤ i ≤ 7; below stands NO_COST, so that cost[8 + i − k] can be read for any
// 1 ≤ i ≤ 8, 1 ≤ k ≤ 7. count is of primitives if these may be one leaf, else 0.
typedef struct table {
    float cost[16];
    uint32_t count, geometry;
} table;

typedef struct decider {
    const sag_context *context;
    const sagi_leaf_maker *maker;
    const sagi_bvh_primitive *primitives;
    sagi_binary_node *nodes;
    float least_area;
    sagi_subtree *tasks;
    table *task_tables;
    uint32_t task_count;
} decider;

static float area_of(const decider *d, const sagi_binary_node *n) {
    return sagi_float_max(sagi_float_box_half_area(&n->box), d->least_area);
}

static uint32_t bits_of(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

// One cost for a forest of however many trees.
static table table_of(float cost, uint32_t count, uint32_t geometry) {
    table t = {.count = count, .geometry = geometry};
    for (int i = 0; i < 9; i++) t.cost[i] = NO_COST;
    for (int i = 9; i < 16; i++) t.cost[i] = cost;
    return t;
}

static float leaf_cost(const decider *d, uint32_t geometry, uint32_t count) {
    sagi_leaf_cost c = d->maker->cost(d->maker->user, geometry);
    return c.each * (float)count + c.all;
}

// A leaf of the binary tree stays one, of several geometries if need be.
static table binary_leaf(const decider *d, sagi_binary_node *n) {
    const sagi_bvh_primitive *p = d->primitives + n->link;
    uint32_t one = n->count;
    float cost = leaf_cost(d, p[0].geometry, n->count);
    for (uint32_t i = 1; i < n->count; i++)
        if (p[i].geometry != p[0].geometry) one = 0;
    uint32_t units = d->maker->units(d->maker->user, one > 0 ? p[0].geometry : SAGI_BVH_MIXED, n->count);
    n->count |= units << SAGI_FOREST_BINARY_UNITS;
    return table_of(cost * area_of(d, n), one, p[0].geometry);
}

// The two vectors of d(n, 1 … 4) and d(n, 5 … 8), each with its k.
static void side_by_side(const table *left, const table *right, float d[8]) {
    sagi_lanes low = sagi_lanes_fill(NO_COST), high = low;
    for (int k = 1; k < 8; k++) {
        sagi_lanes l = sagi_lanes_fill(left->cost[8 + k]);
        sagi_lanes a = sagi_lanes_add(l, sagi_lanes_load(&right->cost[9 - k]));
        sagi_lanes b = sagi_lanes_add(l, sagi_lanes_load(&right->cost[13 - k]));
        low = sagi_lanes_min(sagi_lanes_tag(a, k), low), high = sagi_lanes_min(sagi_lanes_tag(b, k), high);
    }
    sagi_lanes_store(d, low), sagi_lanes_store(d + 4, high);
}

// The table of an inner node from its children's; leaves the choices with the node.
static table join(const decider *decide, sagi_binary_node *n, const table *left, const table *right) {
    float d[8];
    side_by_side(left, right, d);
    const float area = area_of(decide, n);
    float one = NODE_COST * area + d[7];
    uint32_t count = left->count + right->count, choices = 0;
    if (left->count == 0 || right->count == 0 || left->geometry != right->geometry ||
        count > SAGI_BVH_MAX_LEAF)
        count = 0;
    if (count > 0) {
        float leaf = leaf_cost(decide, left->geometry, count) * area;
        if (leaf <= one) {
            one = leaf;
            choices = decide->maker->units(decide->maker->user, left->geometry, count) << SAGI_FOREST_UNITS;
        }
    }
    uint32_t single = bits_of(one) & ~7u;
    memcpy(&one, &single, sizeof one);
    table t = table_of(one, count, left->geometry);
    for (int i = 2; i < 8; i++)
        if (d[i - 1] < one) {
            t.cost[8 + i] = d[i - 1];
            choices |= (bits_of(d[i - 1]) & 7) << sagi_forest_shift(i);
        }
    n->count = choices | (bits_of(d[7]) & 7) << sagi_forest_shift(8);
    return t;
}

// All below `root`, children before parents. Without tasks down to the binary leaves, with tasks down to
// these, which come up in their order.
static table decide_below(const decider *decide, uint32_t root, bool to_tasks) {
    uint32_t path[SAGI_BVH_MAX_DEPTH + 1]; // the inner nodes from the root down
    table left[SAGI_BVH_MAX_DEPTH + 1];    // of those whose left side is done
    bool left_done[SAGI_BVH_MAX_DEPTH + 1];
    uint32_t next_task = 0;
    int depth = 0;
    for (uint32_t at = root;;) {
        sagi_binary_node *n = &decide->nodes[at];
        bool task = to_tasks && decide->tasks[next_task].root == at;
        if (!task && sagi_binary_leaf_count(n) == 0) {
            path[depth] = at++, left_done[depth++] = false;
            continue;
        }
        table t = task ? decide->task_tables[next_task] : binary_leaf(decide, n);
        next_task += task;
        while (depth > 0 && left_done[depth - 1]) {
            depth--;
            t = join(decide, &decide->nodes[path[depth]], &left[depth], &t);
        }
        if (depth == 0) return t;
        left[depth - 1] = t, left_done[depth - 1] = true;
        at = decide->nodes[path[depth - 1]].link;
    }
}

static void decide_task(void *argument, size_t index) {
    decider *d = argument;
    d->task_tables[index] = decide_below(d, d->tasks[index].root, false);
}

// Cuts the tree into tasks from left to right; only counts them while there is no memory for them.
static uint32_t find_tasks(const sagi_binary_node *nodes, uint32_t end, sagi_subtree *tasks) {
    sagi_subtree stack[SAGI_BVH_MAX_DEPTH + 1];
    int waiting = 0;
    uint32_t count = 0;
    const uint32_t size = sagi_task_size(end, MOST_OF_TASK);
    for (sagi_subtree at = {0, end};;) {
        const sagi_binary_node *n = &nodes[at.root];
        if (at.end - at.root > size && sagi_binary_leaf_count(n) == 0) {
            stack[waiting++] = (sagi_subtree){n->link, at.end};
            at = (sagi_subtree){at.root + 1, n->link};
            continue;
        }
        if (tasks != NULL) tasks[count] = at;
        count++;
        if (waiting == 0) return count;
        at = stack[--waiting];
    }
}

sag_status sagi_forest_decide(const sag_context *context, const sagi_leaf_maker *maker,
                              const sagi_bvh_primitive *primitives, sagi_binary_node *nodes, uint32_t end,
                              float *sah) {
    decider d = {
        .context = context, .maker = maker, .primitives = primitives, .nodes = nodes, .least_area = 0x1p-60f};
    d.least_area = area_of(&d, &nodes[0]) / (LEAST_AREA * (float)end);
    d.task_count = find_tasks(nodes, end, NULL);
    d.tasks = sag_allocate(context, d.task_count * sizeof *d.tasks);
    d.task_tables = sag_allocate(context, d.task_count * sizeof *d.task_tables);
    bool room = d.tasks != NULL && d.task_tables != NULL;
    if (room) {
        find_tasks(nodes, end, d.tasks);
        sag_parallel_for(context, d.task_count, decide_task, &d);
        *sah = decide_below(&d, 0, true).cost[9] / area_of(&d, &nodes[0]);
    }
    sag_release(context, d.tasks, d.task_count * sizeof *d.tasks);
    sag_release(context, d.task_tables, d.task_count * sizeof *d.task_tables);
    return room ? SAG_OK : SAG_ERROR_MEMORY;
}
