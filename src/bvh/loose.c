// SPDX-License-Identifier: MIT
// Writing a loose tree in the order of binary.h: parents before children, a subtree's nodes and primitives
// side by side. How many leaves and primitives a subtree holds says where it goes, so subtrees are written by
// all threads at once. The walk down has a stack, which the depth cap bounds; the walk through a subtree that
// is too deep has none and finds its way back by the parents.
#include "bvh/loose.h"
#include <string.h>

#define TASK  2048u // leaves that one thread writes at a time
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

static void write_leaf(const writer *w, uint32_t child, uint32_t first, sagi_binary_node *node) {
    uint32_t from = child & ~SAGI_LOOSE_LEAF, size = sagi_loose_leaf_size(w->tree, from);
    memcpy(w->primitives + first, w->tree->primitives + from, size * sizeof *w->primitives);
    *node = (sagi_binary_node){sagi_loose_box(w->tree, child), first, size};
}

// Writes the leaves below an inner node to nodes[0], nodes[1] …, from left to right.
static void write_leaves(const writer *w, uint32_t root, uint32_t first, sagi_binary_node *nodes) {
    const sagi_loose_node *loose = w->tree->nodes;
    uint32_t node = root;
    for (int side = 0;;) {
        uint32_t child = loose[node].child[side];
        if (!(child & SAGI_LOOSE_LEAF)) {
            node = child, side = 0;
            continue;
        }
        write_leaf(w, child, first, nodes);
        first += nodes++->count;
        for (; side == 1; node = loose[node].parent) {
            if (node == root) return;
            side = loose[loose[node].parent].child[1] == node;
        }
        side = 1;
    }
}

// A subtree as deep as its count needs: halves of halves of the leaves in their order, to which neighbours in
// the loose tree give some sense. The n leaves are first written to the last n of the 2n − 1 numbers. From
// there they go to their places: in front of leaf i are at most n − 1 inner nodes and i leaves, so nothing is
// written over a leaf that waits.
static void write_halves(const writer *w, job root) {
    struct {
        uint32_t begin, count, parent;
    } stack[SAGI_BVH_MAX_DEPTH + 1];
    uint32_t n = w->tree->nodes[root.child].count, begin = 0, count = n, next = root.node;
    sagi_binary_node *leaf = w->nodes + root.node + n - 1;
    write_leaves(w, root.child, root.first, leaf);
    for (int waiting = 0;;) {
        if (count > 1) {
            sagi_float_box box = sagi_float_box_empty();
            for (uint32_t i = begin; i < begin + count; i++)
                sagi_float_box_extend(&box, leaf[i].box.lo, leaf[i].box.hi);
            uint32_t half = count / 2;
            stack[waiting].begin = begin + half, stack[waiting].count = count - half;
            stack[waiting++].parent = next;
            w->nodes[next++] = (sagi_binary_node){box, 0, 0};
            count = half;
            continue;
        }
        sagi_binary_node own = leaf[begin];
        w->nodes[next++] = own;
        if (waiting == 0) return;
        begin = stack[--waiting].begin, count = stack[waiting].count;
        w->nodes[stack[waiting].parent].link = next;
    }
}

// The most leaves a node at this depth may have below it, all leaves being at SAGI_BVH_MAX_DEPTH at most.
static uint64_t depth_allows(uint32_t depth) {
    if (depth > SAGI_BVH_MAX_DEPTH) return 0;
    uint32_t levels = SAGI_BVH_MAX_DEPTH - depth;
    return levels >= 32 ? UINT64_MAX : (uint64_t)1 << levels;
}

// Whether an inner node can be written as it is, or is too deep for what it holds.
static bool is_shallow(const writer *w, const job *j) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    uint32_t left = sagi_loose_count(w->tree, n->child[0]), right = n->count - left;
    uint64_t most = depth_allows(j->depth + 1);
    return left <= most && right <= most;
}

// Whether a subtree becomes a leaf though the collapse might split it: because that gains little (split.c).
static bool joins(const writer *w, const job *j) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    if (w->maker == NULL || n->count > SAGI_BVH_MAX_LEAF) return false; // (with a maker leaves have one each)
    sagi_float_box a = sagi_loose_box(w->tree, n->child[0]), b = sagi_loose_box(w->tree, n->child[1]);
    if (sagi_float_box_half_area(&a) + sagi_float_box_half_area(&b) <
        SAGI_LEAF_SHARE * sagi_float_box_half_area(&n->box))
        return false;
    write_leaves(w, j->child, j->first, w->nodes + j->node);
    return sagi_binary_fits(w->maker, w->primitives + j->first, n->count);
}

// The jobs of an inner node's children, but for their nodes.
static void descend(const writer *w, const job *j, job *left, job *right) {
    const sagi_loose_node *n = &w->tree->nodes[j->child];
    uint32_t size = sagi_loose_size(w->tree, n->child[0]);
    *right = (job){.child = n->child[1], .first = j->first + size, .depth = j->depth + 1};
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
            write_leaf(w, j.child, j.first, &w->nodes[j.node]);
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
        left.node = j.node + 1, right->node = j.node + 2 * sagi_loose_count(tree, left.child);
        nodes[j.node] = (sagi_binary_node){tree->nodes[j.child].box, right->node, 0};
        j = left;
    }
    run_tasks(context, &w);
}
