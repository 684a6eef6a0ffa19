// SPDX-License-Identifier: MIT
// Writing a loose tree in the order of binary.h: parents before children, a subtree's nodes and primitives
// side by side. How many primitives a subtree holds says where it goes, so subtrees are written by all
// threads at once. The walk down has a stack, which the depth cap bounds; the walk through a subtree that is
// too deep has none and finds its way back by the parents.
#include "bvh/loose.h"
#include <string.h>

#define TASK  4096u // primitives that one thread writes at a time
#define TASKS 512u

// A loose subtree and its place in the written tree.
typedef struct job {
    uint32_t child, node, first, depth;
} job;

typedef struct writer {
    const sagi_loose_tree *tree;
    const sagi_leaf_maker *maker; // NULL: leaves are as they are
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
        child &= ~SAGI_LOOSE_LEAF;
        uint32_t size = sagi_loose_leaf_size(w->tree, child);
        memcpy(out, w->tree->primitives + child, size * sizeof *out);
        out += size;
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

// Whether an inner node can be written as it is, or is too deep for what it holds.
static bool is_shallow(const writer *w, const job *j) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    uint32_t left = sagi_loose_count(w->tree, n->child[0]), right = n->count - left;
    uint64_t most = sagi_depth_allows(j->depth + 1);
    return left <= most && right <= most;
}

// Whether a subtree becomes a leaf though the collapse might split it: because that gains little (split.c).
static bool joins(const writer *w, const job *j) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    if (w->maker == NULL || n->count > SAGI_BVH_MAX_LEAF) return false;
    sagi_float_box a = sagi_loose_box(w->tree, n->child[0]), b = sagi_loose_box(w->tree, n->child[1]);
    if (sagi_float_box_half_area(&a) + sagi_float_box_half_area(&b) <
        SAGI_LEAF_SHARE * sagi_float_box_half_area(&n->box))
        return false;
    copy_leaves(w, j->child, w->primitives + j->first);
    return sagi_binary_fits(w->maker, w->primitives + j->first, n->count);
}

static void write_leaf(const writer *w, job j) {
    uint32_t first = j.child & ~SAGI_LOOSE_LEAF, size = sagi_loose_leaf_size(w->tree, first);
    memcpy(w->primitives + j.first, w->tree->primitives + first, size * sizeof *w->primitives);
    w->nodes[j.node] = (sagi_binary_node){sagi_loose_box(w->tree, j.child), j.first, size};
}

// The jobs of an inner node's children, but for their nodes.
static void descend(const writer *w, const job *j, job *left, job *right) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    uint32_t count = sagi_loose_count(w->tree, n->child[0]);
    *right = (job){.child = n->child[1], .first = j->first + count, .depth = j->depth + 1};
    *left = (job){.child = n->child[0], .first = j->first, .depth = j->depth + 1};
}

// One thread's subtree. Its nodes stand closely, each next to the one before; a right child on the stack has
// its parent's number until it gets its own.
static void write_task(void *argument, size_t index) {
    const writer *w = argument;
    job stack[SAGI_BVH_MAX_DEPTH + 1], j = w->tasks[index];
    uint32_t next = j.node + 1;
    for (int waiting = 0;;) {
        if (j.child & SAGI_LOOSE_LEAF) {
            write_leaf(w, j);
        } else if (joins(w, &j)) {
            const sagi_loose_node *n = &w->tree->nodes[j.child];
            w->nodes[j.node] = (sagi_binary_node){n->box, j.first, n->count};
        } else if (is_shallow(w, &j)) {
            job left, *right = &stack[waiting++];
            w->nodes[j.node] = (sagi_binary_node){w->tree->nodes[j.child].box, 0, 0};
            descend(w, &j, &left, right);
            right->node = j.node, left.node = next++;
            j = left;
            continue;
        } else {
            write_halves(w, j);
            next = j.node + 2 * w->tree->nodes[j.child].count - 1;
        }
        if (waiting == 0) return;
        j = stack[--waiting];
        w->nodes[j.node].link = next;
        j.node = next++;
    }
}

static void run_tasks(const sag_context *context, writer *w) {
    sag_parallel_for(context, w->task_count, write_task, w);
    w->task_count = 0;
}

void sagi_loose_write(const sag_context *context, const sagi_leaf_maker *maker, const sagi_loose_tree *tree,
                      sagi_bvh_primitive *primitives, sagi_binary_node *nodes) {
    writer w = {.tree = tree, .maker = maker, .primitives = primitives, .nodes = nodes};
    job stack[SAGI_BVH_MAX_DEPTH + 1], j = {.child = tree->root};
    for (int waiting = 0;;) {
        if (sagi_loose_count(tree, j.child) <= TASK || !is_shallow(&w, &j)) {
            if (w.task_count == TASKS) run_tasks(context, &w);
            w.tasks[w.task_count++] = j;
            if (waiting == 0) break;
            j = stack[--waiting];
            continue;
        }
        job left, *right = &stack[waiting++];
        descend(&w, &j, &left, right);
        left.node = j.node + 1, right->node = j.node + 2 * (right->first - left.first);
        nodes[j.node] = (sagi_binary_node){tree->nodes[j.child].box, right->node, 0};
        j = left;
    }
    run_tasks(context, &w);
}
