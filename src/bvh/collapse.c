// SPDX-License-Identifier: MIT
// From two children to eight, once it is decided how (forest.c): nodes and leaves are numbered and written.
//
// Each of a wide node's children is a wide node or a leaf. Siblings stand side by side, and so do their
// leaves, in the order of the binary tree. The top of the tree is written first; what hangs below it are
// subtrees of a fixed size at most, each with a range of nodes and units of its own, which all threads count
// first and then write. So every byte is where it is for any number of threads.
#include "bvh/forest.h"
#include <string.h>

#define MOST_OF_TASK 16384u // binary nodes (by their numbers) below which a subtree is one thread's

// The children of a wide node.
typedef struct family {
    int count;
    sagi_subtree member[SAGI_BVH_WIDTH];
} family;

// Follows the choices: a forest of `trees` under a node is one tree, or two forests side by side.
static family gather(const sagi_binary_node *nodes, sagi_subtree root) {
    struct {
        sagi_subtree at;
        uint32_t trees;
    } stack[SAGI_BVH_WIDTH];
    int waiting = 0;
    family f = {0};
    uint32_t trees = sagi_forest_units(&nodes[root.root]) > 0 ? 1 : SAGI_BVH_WIDTH;
    for (sagi_subtree at = root;;) {
        const sagi_binary_node *n = &nodes[at.root];
        uint32_t left = sagi_binary_leaf_count(n) > 0 ? 0 : sagi_forest_left(n, trees);
        if (left > 0) {
            stack[waiting].at = (sagi_subtree){n->link, at.end};
            stack[waiting++].trees = trees - left;
            at = (sagi_subtree){at.root + 1, n->link};
            trees = left;
            continue;
        }
        f.member[f.count++] = at;
        if (waiting == 0) return f;
        at = stack[--waiting].at;
        trees = stack[waiting].trees;
    }
}

// The primitives of a leaf, which may stand in several leaves of the binary tree. Spatial splits put a
// primitive into several; here it is needed once.
static uint32_t gather_leaf(const sagi_binary_node *nodes, const sagi_bvh_primitive *primitives,
                            uint32_t root, sagi_bvh_primitive found[SAGI_BVH_MAX_LEAF]) {
    uint32_t stack[SAGI_BVH_MAX_LEAF], count = 0;
    int waiting = 0;
    for (uint32_t at = root;;) {
        const sagi_binary_node *n = &nodes[at];
        uint32_t here = sagi_binary_leaf_count(n);
        if (here == 0) {
            stack[waiting++] = n->link;
            at++;
            continue;
        }
        for (uint32_t i = 0; i < here; i++) {
            const sagi_bvh_primitive *p = &primitives[n->link + i];
            uint32_t k = 0;
            while (k < count && (found[k].primitive != p->primitive || found[k].geometry != p->geometry)) k++;
            if (k == count) found[count++] = *p;
        }
        if (waiting == 0) return count;
        at = stack[--waiting];
    }
}

// A binary node that becomes the wide node `wide`, `level` levels down.
typedef struct job {
    sagi_subtree binary;
    uint32_t wide, level;
} job;

// Numbers nodes and units, and writes them when the tree has memory for them.
typedef struct writer {
    const sagi_leaf_maker *maker;
    const sagi_binary_node *nodes;
    const sagi_bvh_primitive *primitives;
    const sagi_bvh *tree;
    uint32_t next_node, next_unit; // free ones
    uint32_t leaf_count, depth;
} writer;

static void write_box(sagi_bvh_node *node, int i, const sagi_float_box *box) {
    for (int k = 0; k < 3; k++) node->plane[k][i] = box->lo[k], node->plane[3 + k][i] = box->hi[k];
}

static uint32_t take_leaf(writer *w, uint32_t root) {
    uint32_t at = w->next_unit, units = sagi_forest_units(&w->nodes[root]);
    w->next_unit += units;
    w->leaf_count++;
    if (w->tree->leaves != NULL) {
        sagi_bvh_primitive found[SAGI_BVH_MAX_LEAF];
        uint32_t count = gather_leaf(w->nodes, w->primitives, root, found);
        unsigned char *to = w->tree->leaves + at * SAGI_BVH_UNIT;
        memset(to, 0, units * SAGI_BVH_UNIT);
        w->maker->write(w->maker->user, found, count, to);
    }
    return sagi_bvh_child_leaf(at);
}

// One wide node. Its children's jobs are written to jobs[]; returns how many.
static int take_node(writer *w, job j, job jobs[SAGI_BVH_WIDTH]) {
    family f = gather(w->nodes, j.binary);
    sagi_bvh_node node = {.child = {0}};
    int count = 0;
    if (j.level > w->depth) w->depth = j.level;
    for (int i = 0; i < f.count; i++) {
        const sagi_binary_node *from = &w->nodes[f.member[i].root];
        write_box(&node, i, &from->box);
        if (sagi_forest_units(from) > 0) {
            node.child[i] = take_leaf(w, f.member[i].root);
        } else {
            node.child[i] = sagi_bvh_child_node(w->next_node);
            jobs[count++] = (job){f.member[i], w->next_node++, j.level + 1};
        }
    }
    const sagi_float_box none = sagi_float_box_empty();
    for (int i = f.count; i < SAGI_BVH_WIDTH; i++) write_box(&node, i, &none);
    if (w->tree->nodes != NULL) w->tree->nodes[j.wide] = node;
    return count;
}

// Everything below a job.
static void take_all(writer *w, job first) {
    job stack[SAGI_BVH_STACK_SIZE + 1] = {first};
    for (int waiting = 1; waiting > 0;) {
        job j = stack[--waiting];
        waiting += take_node(w, j, stack + waiting);
    }
}

// The tree's top down to the tasks, which are written to tasks[] unless that is NULL; returns how many.
static uint32_t take_top(writer *w, uint32_t end, job *tasks) {
    job stack[SAGI_BVH_STACK_SIZE + 1] = {{{0, end}, w->next_node++, 1}};
    uint32_t task_count = 0;
    const uint32_t size = sagi_task_size(end, MOST_OF_TASK);
    for (int waiting = 1; waiting > 0;) {
        job j = stack[--waiting];
        if (j.binary.end - j.binary.root > size) {
            waiting += take_node(w, j, stack + waiting);
            continue;
        }
        if (tasks != NULL) tasks[task_count] = j;
        task_count++;
    }
    return task_count;
}

typedef struct collapse {
    writer start; // as every task's begins, but for the numbers
    job *tasks;
    writer *writers; // one a task: first what it counted, then where its own begin
    uint32_t task_count;
} collapse;

static void run_task(void *argument, size_t index) {
    collapse *c = argument;
    take_all(&c->writers[index], c->tasks[index]);
}

static sag_status allocate_tree(const sag_context *context, sagi_bvh *tree) {
    tree->nodes = sag_allocate(context, tree->node_capacity * sizeof *tree->nodes);
    tree->leaves = sag_allocate(context, tree->unit_count * SAGI_BVH_UNIT);
    if (tree->nodes != NULL && tree->leaves != NULL) return SAG_OK;
    sagi_bvh_release(context, tree);
    return SAG_ERROR_MEMORY;
}

// Counts, allocates, writes. `top` has counted the top.
static sag_status take_tasks(const sag_context *context, collapse *c, uint32_t end, const writer *top,
                             sagi_bvh *tree) {
    writer w = c->start;
    take_top(&w, end, c->tasks);
    for (uint32_t i = 0; i < c->task_count; i++) c->writers[i] = c->start;
    sag_parallel_for(context, c->task_count, run_task, c);
    uint64_t node = top->next_node, unit = top->next_unit;
    tree->leaf_count = top->leaf_count, tree->depth = top->depth;
    for (uint32_t i = 0; i < c->task_count; i++) {
        writer counted = c->writers[i];
        c->writers[i] = c->start;
        c->writers[i].next_node = (uint32_t)node, c->writers[i].next_unit = (uint32_t)unit;
        node += counted.next_node, unit += counted.next_unit;
        tree->leaf_count += counted.leaf_count;
        if (counted.depth > tree->depth) tree->depth = counted.depth;
    }
    // More than there are numbers for.
    if (node >= SAGI_BVH_END_OF_NODES || unit >= SAGI_BVH_END_OF_UNITS) return SAG_ERROR_MEMORY;
    tree->node_count = tree->node_capacity = (uint32_t)node, tree->unit_count = (uint32_t)unit;
    sag_status status = allocate_tree(context, tree);
    if (status != SAG_OK) return status;
    w = c->start;
    take_top(&w, end, NULL);
    sag_parallel_for(context, c->task_count, run_task, c);
    return SAG_OK;
}

sag_status sagi_bvh_collapse(const sag_context *context, const sagi_leaf_maker *maker,
                             sagi_binary_node *nodes, uint32_t end, const sagi_bvh_primitive *primitives,
                             sagi_bvh *tree) {
    sagi_bvh made = {.box = nodes[0].box};
    sag_status status = sagi_forest_decide(context, maker, primitives, nodes, end, &made.sah);
    if (status != SAG_OK) return status;
    collapse c = {.start = {.maker = maker, .nodes = nodes, .primitives = primitives, .tree = &made}};
    writer top = c.start;
    c.task_count = take_top(&top, end, NULL);
    c.tasks = sag_allocate(context, c.task_count * sizeof *c.tasks);
    c.writers = sag_allocate(context, c.task_count * sizeof *c.writers);
    status = SAG_ERROR_MEMORY;
    if (c.task_count == 0 || (c.tasks != NULL && c.writers != NULL))
        status = take_tasks(context, &c, end, &top, &made);
    sag_release(context, c.tasks, c.task_count * sizeof *c.tasks);
    sag_release(context, c.writers, c.task_count * sizeof *c.writers);
    if (status == SAG_OK) *tree = made;
    return status;
}
