// SPDX-License-Identifier: MIT
// Writing a loose tree in the order of binary.h: parents before children, a subtree's nodes and primitives
// side by side. How many primitives a subtree holds says where it goes, so subtrees are written by all
// threads at once. The walk down has a stack, which the depth cap bounds; the walk through a subtree that is
// too deep has none and finds its way back by the parents.
#include "bvh/loose.h"

#define TASK  4096u // primitives that one thread writes at a time
#define TASKS 512u

// A loose subtree and its place in the written tree.
typedef struct job {
    uint32_t child, node, first, depth;
} job;

typedef struct writer {
    const sagi_loose_tree *tree;
    sagi_bvh_primitive *primitives;
    sagi_binary_node *nodes;
    job tasks[TASKS];
    uint32_t task_count;
} writer;

// Copies the primitives below an inner node, from left to right.
static void copy_leaves(const writer *w, uint32_t root, sagi_bvh_primitive *out) {
    const sagi_loose_node *nodes = w->tree->nodes;
    uint32_t node = root;
    for (int side = 0;;) {
        uint32_t child = nodes[node].child[side];
        if (!(child & SAGI_LOOSE_LEAF)) {
            node = child, side = 0;
            continue;
        }
        *out++ = w->tree->primitives[child & ~SAGI_LOOSE_LEAF];
        for (; side == 1; node = nodes[node].parent) {
            if (node == root) return;
            side = nodes[nodes[node].parent].child[1] == node;
        }
        side = 1;
    }
}

static sagi_float_box box_of(const sagi_bvh_primitive *primitives, uint32_t count) {
    sagi_float_box box = sagi_float_box_empty();
    for (uint32_t i = 0; i < count; i++) sagi_float_box_extend(&box, primitives[i].lo, primitives[i].hi);
    return box;
}

// A subtree as deep as its count needs: halves of halves of the primitives in their order, which neighbours
// in the loose tree give some sense.
static void write_halves(const writer *w, job root) {
    struct {
        job at;
        uint32_t count;
    } stack[SAGI_BVH_MAX_DEPTH + 1];
    int waiting = 0;
    copy_leaves(w, root.child, w->primitives + root.first);
    stack[waiting].at = root, stack[waiting++].count = w->tree->nodes[root.child].count;
    while (waiting > 0) {
        uint32_t n = stack[--waiting].count;
        job j = stack[waiting].at;
        sagi_float_box box = box_of(w->primitives + j.first, n);
        if (n == 1 || j.depth == SAGI_BVH_MAX_DEPTH) {
            w->nodes[j.node] = (sagi_binary_node){box, j.first, n};
            continue;
        }
        uint32_t m = n / 2;
        w->nodes[j.node] = (sagi_binary_node){box, j.node + 2 * m, 0};
        stack[waiting].at = (job){0, j.node + 2 * m, j.first + m, j.depth + 1};
        stack[waiting++].count = n - m;
        stack[waiting].at = (job){0, j.node + 1, j.first, j.depth + 1};
        stack[waiting++].count = m;
    }
}

// Writes the node of *j, which is inner, and makes *j its left child and *right its right one; false when the
// subtree was too deep and is written.
static bool write_inner(const writer *w, job *j, job *right) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    uint32_t l = sagi_loose_count(w->tree, n->child[0]), r = n->count - l;
    uint64_t most = sagi_depth_allows(j->depth + 1);
    if (l > most || r > most) {
        write_halves(w, *j);
        return false;
    }
    w->nodes[j->node] = (sagi_binary_node){n->box, j->node + 2 * l, 0};
    *right = (job){n->child[1], j->node + 2 * l, j->first + l, j->depth + 1};
    *j = (job){n->child[0], j->node + 1, j->first, j->depth + 1};
    return true;
}

static void write_leaf(const writer *w, job j) {
    w->primitives[j.first] = w->tree->primitives[j.child & ~SAGI_LOOSE_LEAF];
    w->nodes[j.node] = (sagi_binary_node){sagi_loose_box(w->tree, j.child), j.first, 1};
}

static void write_task(void *argument, size_t index) {
    const writer *w = argument;
    job stack[SAGI_BVH_MAX_DEPTH + 1], j = w->tasks[index];
    for (int waiting = 0;;) {
        if (!(j.child & SAGI_LOOSE_LEAF)) {
            if (write_inner(w, &j, &stack[waiting])) {
                waiting++;
                continue;
            }
        } else {
            write_leaf(w, j);
        }
        if (waiting == 0) return;
        j = stack[--waiting];
    }
}

static void run_tasks(const sag_context *context, writer *w) {
    sag_parallel_for(context, w->task_count, write_task, w);
    w->task_count = 0;
}

void sagi_loose_write(const sag_context *context, const sagi_loose_tree *tree, sagi_bvh_primitive *primitives,
                      sagi_binary_node *nodes) {
    writer w = {.tree = tree, .primitives = primitives, .nodes = nodes};
    job stack[SAGI_BVH_MAX_DEPTH + 1], j = {.child = tree->root};
    for (int waiting = 0;;) {
        if (sagi_loose_count(tree, j.child) > TASK) {
            if (write_inner(&w, &j, &stack[waiting])) {
                waiting++;
                continue;
            }
        } else {
            if (w.task_count == TASKS) run_tasks(context, &w);
            w.tasks[w.task_count++] = j;
        }
        if (waiting == 0) break;
        j = stack[--waiting];
    }
    run_tasks(context, &w);
}
