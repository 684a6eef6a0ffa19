// SPDX-License-Identifier: MIT
// The high-quality builder. Splits of space (spatial.c) give a tree over references, at most GROWTH times as
// many as there are primitives. Then subtrees are moved to where they cost less (reinsert.c), first whole
// leaves of the eight-wide tree to be, then all. What reinsertion makes less is the areas of the binary
// tree's nodes, which is not quite the cost of what is made of it, and now and then more costly; so after
// each step the eight-wide tree's cost is worked out, and the cheapest tree is taken.
#include "bvh/forest.h"
#include "bvh/reinsert.h"
#include "bvh/spatial.h"
#include <string.h>

#define GROWTH 1.3

// A tree written out, and its cost.
typedef struct written {
    sagi_bvh_primitive *primitives;
    sagi_binary_node *nodes;
    float cost;
} written;

typedef struct builder {
    const sag_context *context;
    const sagi_bvh_options *options;
    uint32_t capacity; // of everything
    sagi_loose_tree tree;
    written best, next;
} builder;

static bool allocate_written(const builder *b, written *w) {
    w->primitives = sag_allocate(b->context, b->capacity * sizeof *w->primitives);
    w->nodes = sag_allocate(b->context, 2 * (size_t)b->capacity * sizeof *w->nodes);
    return w->primitives != NULL && w->nodes != NULL;
}

static void release_written(const builder *b, written *w) {
    sag_release(b->context, w->primitives, b->capacity * sizeof *w->primitives);
    sag_release(b->context, w->nodes, 2 * (size_t)b->capacity * sizeof *w->nodes);
}

static bool allocate(builder *b) {
    b->tree.nodes = sag_allocate(b->context, b->capacity * sizeof *b->tree.nodes);
    b->tree.primitives = sag_allocate(b->context, b->capacity * sizeof *b->tree.primitives);
    bool best = allocate_written(b, &b->best), next = allocate_written(b, &b->next);
    return b->tree.nodes != NULL && b->tree.primitives != NULL && best && next;
}

static void release(builder *b) {
    sag_release(b->context, b->tree.nodes, b->capacity * sizeof *b->tree.nodes);
    sag_release(b->context, b->tree.primitives, b->capacity * sizeof *b->tree.primitives);
    release_written(b, &b->best), release_written(b, &b->next);
}

// Writes the tree as it is now, and keeps it when it is the cheapest so far.
static sag_status consider(builder *b) {
    sagi_loose_write(b->context, &b->options->leaves, &b->tree, b->next.primitives, b->next.nodes);
    sag_status status = sagi_forest_decide(b->context, &b->options->leaves, b->next.primitives, b->next.nodes,
                                           2 * b->tree.count, &b->next.cost);
    if (status == SAG_OK && b->next.cost < b->best.cost) {
        written w = b->best;
        b->best = b->next, b->next = w;
    }
    return status;
}

// Takes the choices back (forest.h), for the collapse makes them itself.
static void undecide(const written *w, uint32_t count) {
    for (uint32_t i = 0; i < 2 * count - 1; i++) w->nodes[i].count &= 15;
}

static sag_status build(builder *b, const sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree) {
    memcpy(b->tree.primitives, primitives, count * sizeof *primitives);
    b->tree.count = count;
    b->best.cost = INFINITY;
    sag_status status =
        sagi_spatial_build(b->context, &b->options->clipper, &b->tree, b->capacity, b->next.primitives);
    if (status == SAG_OK) status = consider(b);
    for (uint32_t least = SAGI_BVH_MAX_LEAF; status == SAG_OK && least > 0; least /= 8) {
        status = sagi_reinsert(b->context, &b->tree, b->capacity, least);
        if (status == SAG_OK) status = consider(b);
    }
    if (status != SAG_OK) return status;
    undecide(&b->best, b->tree.count);
    status = sagi_bvh_collapse(b->context, &b->options->leaves, b->best.nodes, 2 * b->tree.count,
                               b->best.primitives, tree);
    if (status == SAG_OK) tree->repeats = b->tree.count > count;
    return status;
}

sag_status sagi_bvh_build_high(const sag_context *context, const sagi_bvh_options *options,
                               const sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree) {
    double most = options->clipper.corners != NULL ? GROWTH * (double)count : (double)count;
    builder b = {
        .context = context, .options = options, .capacity = most < INT32_MAX ? (uint32_t)most : INT32_MAX};
    sag_status status = allocate(&b) ? build(&b, primitives, count, tree) : SAG_ERROR_MEMORY;
    release(&b);
    return status;
}
