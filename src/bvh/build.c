// SPDX-License-Identifier: MIT
// The builder's top: large ranges are binned and partitioned by all threads together; once a range is small
// it becomes a task that one thread finishes alone (binary.c). What is large is a fixed number, and
// partitions keep the order of the primitives, so the tree is the same for any number of threads.
#include "bvh/binary.h"
#include <string.h>

#define LARGE 65536u // ranges over this many primitives are split by all threads together
#define CHUNK 8192u  // primitives a thread takes at a time from a large range

// What one thread finds out about its chunk of a large range.
typedef struct chunk {
    sagi_bins bins;
    sagi_float_box box, left, right; // of the primitives; of the centroids that go left and right
    uint32_t left_first, right_first;
} chunk;

typedef struct builder {
    const sag_context *context;
    const sagi_leaf_maker *maker;
    sagi_bvh_primitive *primitives, *scratch; // scratch: as many, when the range is large
    sagi_binary_node *nodes;
    chunk *chunks;
    uint32_t chunk_count; // of the range in work
    sagi_range range;
    sagi_split split;
    sagi_range *tasks;
    uint32_t task_count, task_capacity;
} builder;

static uint32_t chunks_of(uint32_t count) { return count / CHUNK + (count % CHUNK != 0); }

static sagi_bvh_primitive *chunk_begin(const builder *b, size_t index, uint32_t *count) {
    uint32_t done = (uint32_t)index * CHUNK, left = b->range.count - done;
    *count = left < CHUNK ? left : CHUNK;
    return b->primitives + b->range.first + done;
}

static void measure_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    chunk *c = &b->chunks[index];
    sagi_extent centroids = sagi_extent_empty();
    c->box = sagi_float_box_empty();
    for (uint32_t i = 0; i < count; i++) {
        sagi_float_box_extend(&c->box, p[i].lo, p[i].hi);
        sagi_extent_add(&centroids, &p[i]);
    }
    c->left = sagi_extent_box(&centroids);
}

static void bin_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    sagi_bins_init(&b->chunks[index].bins, &b->range);
    sagi_bins_add(&b->chunks[index].bins, p, count);
}

// How many of the chunk go left; into left_first, from which the places are summed up.
static void count_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count, left = 0;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    for (uint32_t i = 0; i < count; i++) left += sagi_split_goes_left(&b->split, &p[i]);
    b->chunks[index].left_first = left;
}

static void scatter_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    const sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    chunk *c = &b->chunks[index];
    sagi_bvh_primitive *left = b->scratch + c->left_first, *right = b->scratch + c->right_first;
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

static void copy_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t count;
    sagi_bvh_primitive *p = chunk_begin(b, index, &count);
    memcpy(p, b->scratch + index * CHUNK, count * sizeof *p);
}

static void all_chunks(builder *b, void (*work)(void *, size_t)) {
    b->chunk_count = chunks_of(b->range.count);
    sag_parallel_for(b->context, b->chunk_count, work, b);
}

static void measure_all(builder *b, sagi_range *range) {
    b->range = *range;
    all_chunks(b, measure_chunk);
    range->box = range->centroids = sagi_float_box_empty();
    for (uint32_t i = 0; i < b->chunk_count; i++) {
        sagi_float_box_extend(&range->box, b->chunks[i].box.lo, b->chunks[i].box.hi);
        sagi_float_box_extend(&range->centroids, b->chunks[i].left.lo, b->chunks[i].left.hi);
    }
}

// Moves the range's left primitives before its right ones and measures both sides' centroids.
static void partition_all(builder *b, sagi_range *left, sagi_range *right) {
    all_chunks(b, count_chunk);
    uint32_t left_at = 0, right_at = b->split.left_count;
    for (uint32_t i = 0; i < b->chunk_count; i++) {
        uint32_t count, goes_left = b->chunks[i].left_first;
        chunk_begin(b, i, &count);
        b->chunks[i].left_first = left_at, b->chunks[i].right_first = right_at;
        left_at += goes_left, right_at += count - goes_left;
    }
    all_chunks(b, scatter_chunk);
    all_chunks(b, copy_chunk);
    left->centroids = right->centroids = sagi_float_box_empty();
    for (uint32_t i = 0; i < b->chunk_count; i++) {
        sagi_float_box_extend(&left->centroids, b->chunks[i].left.lo, b->chunks[i].left.hi);
        sagi_float_box_extend(&right->centroids, b->chunks[i].right.lo, b->chunks[i].right.hi);
    }
}

// Splits a large range. A large range is never a leaf.
static void split_large(builder *b, sagi_range range, sagi_range *left, sagi_range *right) {
    b->range = range;
    all_chunks(b, bin_chunk);
    for (uint32_t i = 1; i < b->chunk_count; i++) sagi_bins_merge(&b->chunks[0].bins, &b->chunks[i].bins);
    b->split = sagi_bins_choose(&b->chunks[0].bins, &range);
    bool halve = b->split.verdict == SAGI_HALVE;
    uint32_t m = halve ? range.count / 2 : b->split.left_count;
    *left = (sagi_range){.node = range.node + 1, .first = range.first, .count = m, .depth = range.depth + 1};
    *right = (sagi_range){.node = range.node + 2 * m,
                          .first = range.first + m,
                          .count = range.count - m,
                          .depth = range.depth + 1};
    if (halve) {
        sagi_range_halve(b->primitives, &range);
        measure_all(b, left), measure_all(b, right);
    } else {
        left->box = b->split.left, right->box = b->split.right;
        partition_all(b, left, right);
    }
    b->nodes[range.node] = (sagi_binary_node){range.box, right->node, 0};
}

static void run_task(void *argument, size_t index) {
    builder *b = argument;
    sagi_binary_build_range(b->maker, b->primitives, b->nodes, b->tasks[index]);
}

static void run_tasks(builder *b) {
    sag_parallel_for(b->context, b->task_count, run_task, b);
    b->task_count = 0;
}

static void build_binary(builder *b, sagi_range range) {
    sagi_range stack[SAGI_BVH_MAX_DEPTH + 1];
    int waiting = 0;
    for (;;) {
        if (range.count > LARGE) {
            sagi_range left;
            split_large(b, range, &left, &stack[waiting++]);
            range = left;
            continue;
        }
        if (b->task_count == b->task_capacity) run_tasks(b);
        b->tasks[b->task_count++] = range;
        if (waiting == 0) break;
        range = stack[--waiting];
    }
    run_tasks(b);
}

// The builder's memory: 2 binary nodes and, beyond LARGE, a scratch copy for each primitive.
static bool allocate(builder *b, uint32_t count) {
    bool large = count > LARGE;
    b->task_capacity = 2 * (count / LARGE) + 64;
    b->nodes = sag_allocate(b->context, (size_t)count * 2 * sizeof *b->nodes);
    b->tasks = sag_allocate(b->context, b->task_capacity * sizeof *b->tasks);
    b->chunks = sag_allocate(b->context, chunks_of(count) * sizeof *b->chunks);
    b->scratch = large ? sag_allocate(b->context, (size_t)count * sizeof *b->scratch) : NULL;
    return b->nodes != NULL && b->tasks != NULL && b->chunks != NULL && (!large || b->scratch != NULL);
}

static void release(builder *b, uint32_t count) {
    sag_release(b->context, b->nodes, (size_t)count * 2 * sizeof *b->nodes);
    sag_release(b->context, b->tasks, b->task_capacity * sizeof *b->tasks);
    sag_release(b->context, b->chunks, chunks_of(count) * sizeof *b->chunks);
    sag_release(b->context, b->scratch, (size_t)count * sizeof *b->scratch);
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
    builder b = {.context = context, .maker = &options->leaves, .primitives = primitives};
    sag_status status = SAG_ERROR_MEMORY;
    if (allocate(&b, count)) {
        sagi_range range = {.count = count};
        measure_all(&b, &range);
        build_binary(&b, range);
        status = sagi_bvh_collapse(context, &options->leaves, b.nodes, 2 * count, primitives, tree);
    }
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
