// SPDX-License-Identifier: MIT
// The builder's top: large ranges are binned and partitioned by all threads together, from one array to
// another and back; once a range is small it becomes a task that one thread finishes alone (binary.c). What
// is large depends on the number of primitives alone, and partitions keep their order, so the tree is the
// same for any number of threads.
#include "bvh/binary.h"
#include <stdatomic.h>
#include <string.h>

#define MOST_SMALL  65536u // no task has more primitives
#define LEAST_LARGE 1024u  // and none with so few is split by all threads
#define TASKS       64u    // there should be about so many where that allows it
#define CHUNK       2048u  // primitives a thread takes at a time from a large range
#define SPARE       32u    // nodes that a task has beyond one a primitive

// A range of primitives in work.
typedef struct part {
    sagi_range range;
    bool aside;  // they stand in scratch
    uint32_t of; // the top whose right child it is
} part;

// What one thread finds out about its chunk of a large range.
typedef struct chunk {
    sagi_bins bins;
    sagi_float_box box, left, right; // of the primitives; of the centroids that go left and right
    uint32_t left_first, right_first;
    bool packs; // leaves of these cost the same however many they hold
} chunk;

// A node above the tasks. They are kept aside, as the nodes' memory is scratch meanwhile.
typedef struct top {
    uint32_t number;
    sagi_binary_node node;
} top;

typedef struct builder {
    const sag_context *context;
    const sagi_leaf_maker *maker;
    sagi_bvh_primitive *primitives;
    sagi_bvh_primitive *scratch; // as many; the memory of the nodes, of the same size
    sagi_binary_node *nodes;
    chunk *chunks;
    uint32_t chunk_count; // of the part in work
    part part;
    sagi_split split;
    part *tasks;
    top *tops;
    uint32_t task_count, top_count, task_capacity;
    uint32_t node_count, node_capacity;
    bool several; // a primitive may need two nodes
    atomic_bool short_of_nodes;
    uint32_t large; // parts of more primitives are split by all threads
} builder;

static uint32_t chunks_of(uint32_t count) { return count / CHUNK + (count % CHUNK != 0); }

static sagi_bvh_primitive *array_of(const builder *b, bool aside) {
    return aside ? b->scratch : b->primitives;
}

static sagi_bvh_primitive *chunk_begin(const builder *b, size_t index, uint32_t *count) {
    const sagi_range *r = &b->part.range;
    uint32_t done = (uint32_t)index * CHUNK, left = r->count - done;
    *count = left < CHUNK ? left : CHUNK;
    return array_of(b, b->part.aside) + r->first + done;
}

static void measure_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    chunk *c = &b->chunks[index];
    sagi_extent centroids = sagi_extent_empty();
    c->box = sagi_float_box_empty();
    c->packs = true;
    for (uint32_t i = 0; i < count; i++) {
        if (i == 0 || p[i].geometry != p[i - 1].geometry)
            c->packs &= !(b->maker->cost(b->maker->user, p[i].geometry).each > 0);
        sagi_float_box_extend(&c->box, p[i].lo, p[i].hi);
        sagi_extent_add(&centroids, &p[i]);
    }
    c->left = sagi_extent_box(&centroids);
}

static void bin_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    sagi_bins_init(&b->chunks[index].bins, &b->part.range);
    sagi_bins_add(&b->chunks[index].bins, p, count);
}

static void scatter_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    chunk *c = &b->chunks[index];
    sagi_bvh_primitive *to = array_of(b, !b->part.aside) + b->part.range.first;
    sagi_bvh_primitive *left = to + c->left_first, *right = to + c->right_first;
    sagi_extent l = sagi_extent_empty(), r = sagi_extent_empty();
    for (uint32_t i = 0; i < count; i++) {
        if (sagi_split_goes_left(&b->split, &p[i])) {
            *left++ = p[i];
            sagi_extent_add(&l, &p[i]);
        } else {
            *right++ = p[i];
            sagi_extent_add(&r, &p[i]);
        }
    }
    c->left = sagi_extent_box(&l), c->right = sagi_extent_box(&r);
}

static void all_chunks(builder *b, void (*work)(void *, size_t)) {
    b->chunk_count = chunks_of(b->part.range.count);
    sag_parallel_for(b->context, b->chunk_count, work, b);
}

static void measure_all(builder *b, part *p) {
    b->part = *p;
    all_chunks(b, measure_chunk);
    sagi_range *range = &p->range;
    range->box = range->centroids = sagi_float_box_empty();
    for (uint32_t i = 0; i < b->chunk_count; i++) {
        sagi_float_box_extend(&range->box, b->chunks[i].box.lo, b->chunks[i].box.hi);
        sagi_float_box_extend(&range->centroids, b->chunks[i].left.lo, b->chunks[i].left.hi);
    }
}

// Moves the part's primitives to the other array, left ones before right ones, and measures both sides'
// centroids. Each chunk's bins know how many of it go left; the first's have been merged with all others and
// know it of the part.
static void partition_all(builder *b, part *left, part *right) {
    uint32_t left_at = 0, right_at = b->split.left_count;
    for (uint32_t i = b->chunk_count; i-- > 1;) {
        chunk *c = &b->chunks[i];
        uint32_t count, goes_left = sagi_bins_left(&c->bins, &b->split);
        chunk_begin(b, i, &count);
        left_at += goes_left, right_at += count - goes_left;
        c->left_first = b->split.left_count - left_at;
        c->right_first = b->split.left_count + b->part.range.count - right_at;
    }
    b->chunks[0].left_first = 0, b->chunks[0].right_first = b->split.left_count;
    all_chunks(b, scatter_chunk);
    left->aside = right->aside = !b->part.aside;
    left->range.centroids = right->range.centroids = sagi_float_box_empty();
    for (uint32_t i = 0; i < b->chunk_count; i++) {
        sagi_float_box_extend(&left->range.centroids, b->chunks[i].left.lo, b->chunks[i].left.hi);
        sagi_float_box_extend(&right->range.centroids, b->chunks[i].right.lo, b->chunks[i].right.hi);
    }
}

// Splits a large part. A large part is never a leaf. The left side's number is the next one; the right one's
// is known when the left side has its own.
static void split_large(builder *b, part whole, part *left, part *right) {
    b->part = whole;
    const sagi_range *range = &b->part.range;
    all_chunks(b, bin_chunk);
    for (uint32_t i = 1; i < b->chunk_count; i++) sagi_bins_merge(&b->chunks[0].bins, &b->chunks[i].bins);
    b->split = sagi_bins_choose(&b->chunks[0].bins, range);
    bool halve = b->split.verdict == SAGI_HALVE;
    uint32_t m = halve ? range->count / 2 : b->split.left_count;
    *left = *right = (part){.aside = whole.aside, .of = b->top_count};
    left->range = (sagi_range){.first = range->first, .count = m, .depth = range->depth + 1};
    right->range =
        (sagi_range){.first = range->first + m, .count = range->count - m, .depth = range->depth + 1};
    if (halve) {
        sagi_range_halve(array_of(b, whole.aside), range);
        measure_all(b, left), measure_all(b, right);
    } else {
        left->range.box = b->split.left, right->range.box = b->split.right;
        partition_all(b, left, right);
    }
    b->tops[b->top_count++] = (top){whole.range.node, (sagi_binary_node){whole.range.box, 0, 0}};
}

static void bring_back(void *argument, size_t index) {
    const builder *b = argument;
    const sagi_range *r = &b->tasks[index].range;
    if (b->tasks[index].aside)
        memcpy(b->primitives + r->first, b->scratch + r->first, r->count * sizeof *b->scratch);
}

// A subtree of n primitives has at most 2n − 1 nodes, and where several primitives may be one leaf a third of
// that is usual: numbers for little more than n, and the memory for them, do but in the strangest cases. Then
// all is done again with numbers for 2n.
static uint32_t numbers_for(const builder *b, uint32_t primitives) {
    const uint32_t all = 2 * primitives - 1, few = primitives + SPARE;
    return b->several || all < few ? all : few;
}

static void run_task(void *argument, size_t index) {
    builder *b = argument;
    const sagi_range *r = &b->tasks[index].range;
    if (!sagi_binary_build_range(b->maker, b->primitives, b->nodes, *r, r->node + numbers_for(b, r->count)))
        atomic_store(&b->short_of_nodes, true);
}

// More tasks than are to be expected would need more numbers than `build` has memory for: then nothing is
// done but to say so.
static void build_binary(builder *b, part whole) {
    part stack[SAGI_BVH_MAX_DEPTH + 1];
    int waiting = 0;
    for (;;) {
        whole.range.node = b->node_count;
        if (whole.range.count > b->large) {
            part left;
            split_large(b, whole, &left, &stack[waiting++]);
            b->node_count++;
            whole = left;
            continue;
        }
        b->node_count += numbers_for(b, whole.range.count);
        b->tasks[b->task_count++] = whole;
        if (waiting == 0) break;
        whole = stack[--waiting];
        b->tops[whole.of].node.link = b->node_count;
    }
    if (b->node_count > b->node_capacity) {
        atomic_store(&b->short_of_nodes, true);
        return;
    }
    sag_parallel_for(b->context, b->task_count, bring_back, b);
    for (uint32_t i = 0; i < b->top_count; i++) b->nodes[b->tops[i].number] = b->tops[i].node;
    sag_parallel_for(b->context, b->task_count, run_task, b);
}

// The builder's memory but for the nodes. Each level of the tree has fewer than count/large large parts.
static bool allocate(builder *b, uint32_t count) {
    uint32_t large = count / TASKS;
    b->large = large < LEAST_LARGE ? LEAST_LARGE : large > MOST_SMALL ? MOST_SMALL : large;
    b->task_capacity = (count / b->large) * SAGI_BVH_MAX_DEPTH + 1;
    b->tasks = sag_allocate(b->context, b->task_capacity * sizeof *b->tasks);
    b->tops = sag_allocate(b->context, b->task_capacity * sizeof *b->tops);
    b->chunks = sag_allocate(b->context, chunks_of(count) * sizeof *b->chunks);
    return b->tasks != NULL && b->tops != NULL && b->chunks != NULL;
}

static void release(builder *b, uint32_t count) {
    sag_release(b->context, b->tasks, b->task_capacity * sizeof *b->tasks);
    sag_release(b->context, b->tops, b->task_capacity * sizeof *b->tops);
    sag_release(b->context, b->chunks, chunks_of(count) * sizeof *b->chunks);
}

// Allocates the nodes and builds them, from `all`, which is measured.
static sag_status build(builder *b, const part *all) {
    b->node_count = b->top_count = b->task_count = 0;
    atomic_store(&b->short_of_nodes, false);
    const uint64_t most = 2 * (uint64_t)all->range.count - 1;
    const uint64_t tasks =
        4 * (uint64_t)(all->range.count / b->large) + 8; // of which half are seldom exceeded
    const uint64_t few = all->range.count + tasks * (SPARE + 1);
    b->node_capacity = (uint32_t)(b->several || most < few ? most : few);
    b->nodes = sag_allocate(b->context, b->node_capacity * sizeof *b->nodes);
    b->scratch = (sagi_bvh_primitive *)(void *)b->nodes;
    if (b->nodes == NULL) return SAG_ERROR_MEMORY;
    build_binary(b, *all);
    return SAG_OK;
}

static void release_nodes(builder *b) {
    sag_release(b->context, b->nodes, b->node_capacity * sizeof *b->nodes);
    b->nodes = NULL;
}

static sag_status build_and_collapse(builder *b, uint32_t count, sagi_bvh *tree) {
    part all = {.range.count = count};
    measure_all(b, &all);
    for (uint32_t i = 0; i < b->chunk_count; i++) b->several |= !b->chunks[i].packs;
    sag_status status = build(b, &all);
    if (status == SAG_OK && atomic_load(&b->short_of_nodes)) {
        release_nodes(b);
        b->several = true;
        status = build(b, &all);
    }
    if (status == SAG_OK)
        status = sagi_bvh_collapse(b->context, b->maker, b->nodes, b->node_count, b->primitives, tree);
    release_nodes(b);
    return status;
}

sag_status sagi_bvh_build(const sag_context *context, const sagi_bvh_options *options,
                          sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree) {
    if (count == 0) {
        *tree = (sagi_bvh){.box = sagi_float_box_empty()};
        return SAG_OK;
    }
    if (count > INT32_MAX) return SAG_ERROR_MEMORY; // node numbers go to twice the count
    if (options->quality == SAG_QUALITY_FAST)
        return sagi_bvh_build_fast(context, options, primitives, count, tree);
    if (options->quality == SAG_QUALITY_HIGH)
        return sagi_bvh_build_high(context, options, primitives, count, tree);
    builder b = {.context = context, .maker = &options->leaves, .primitives = primitives};
    sag_status status = SAG_ERROR_MEMORY;
    if (allocate(&b, count)) status = build_and_collapse(&b, count, tree);
    release(&b, count);
    return status;
}

void sagi_bvh_release(const sag_context *context, sagi_bvh *tree) {
    sag_release(context, tree->nodes, tree->node_capacity * sizeof *tree->nodes);
    sag_release(context, tree->leaves, tree->unit_count * SAGI_BVH_UNIT);
    *tree = (sagi_bvh){.box = sagi_float_box_empty()};
}

size_t sagi_bvh_bytes(const sagi_bvh *tree) {
    return tree->node_capacity * sizeof *tree->nodes + tree->unit_count * SAGI_BVH_UNIT;
}
