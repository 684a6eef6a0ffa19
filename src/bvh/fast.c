// SPDX-License-Identifier: MIT
// The fast builder. Primitives are sorted along a curve (morton.c), the curve is cut into treelets, cells of
// the curve with at most TREELET primitives each, and these into leaves, cells with at most LEAF. (With
// leaves of four there is twice as much to cluster, for a tree 1.2 % cheaper.) Every treelet is clustered by
// one thread (ploc.c) while all of it is in the fastest cache, and the treelets' roots are clustered in the
// same way to one tree.
//
// A cell of one code that still holds too many primitives is sorted by itself, with a curve that fills only
// what it holds, and again, up to LEVELS times: that resolves 11 bits of each coordinate at a time, more than
// floats have. Primitives that all have one centroid are cut where they stand.
#include "bvh/morton.h"
#include "bvh/ploc.h"
#include <string.h>

#define TREELET 256u
#define LEAF    SAGI_BVH_MAX_LEAF
#define LEVELS  8
#define CHUNK   16384u

typedef struct builder {
    const sag_context *context;
    sagi_bvh_primitive *primitives; // as they came
    sagi_loose_tree tree;           // over the sorted ones
    uint64_t *keys, *scratch;
    uint8_t *leaf_size; // tree.leaf_size
    const sagi_leaf_maker *maker;
    uint32_t *first; // of each treelet in the sorted primitives, and the end
    uint32_t *roots, *slots;
    uint32_t treelet_count;
    float *memory; // for the clustering of roots
    sagi_binary_node *nodes;
    uint32_t begin, count; // what gather moves
} builder;

static void gather_chunk(void *argument, size_t index) {
    const builder *b = argument;
    uint32_t i = b->begin + (uint32_t)index * CHUNK, end = b->begin + b->count;
    if (end - i > CHUNK) end = i + CHUNK;
    const sagi_bvh_primitive *from = b->primitives + b->begin;
    for (; i < end; i++) b->tree.primitives[i] = from[b->keys[i] & ((1u << SAGI_MORTON_INDEX) - 1)];
}

// Sorts the `count` primitives from b->primitives[begin] on.
static sag_status sort(builder *b, uint32_t begin, uint32_t count) {
    sag_status status =
        sagi_morton_sort(b->context, b->primitives + begin, count, b->keys + begin, b->scratch + begin);
    if (status != SAG_OK) return status;
    b->begin = begin, b->count = count;
    sag_parallel_for(b->context, count / CHUNK + (count % CHUNK != 0), gather_chunk, b);
    return SAG_OK;
}

static uint64_t code_at(const builder *b, uint32_t i) { return b->keys[i] >> SAGI_MORTON_INDEX; }

// The bits in which codes may differ within the largest cell around `code` that does not reach `other`: those
// below the highest one in which the two differ. 0 when they are one.
static uint64_t cell_apart(uint64_t code, uint64_t other) {
    uint64_t low = code ^ other;
    low |= low >> 1, low |= low >> 2, low |= low >> 4, low |= low >> 8, low |= low >> 16, low |= low >> 32;
    return low >> 1;
}

// The same with two others.
static uint64_t cell_between(uint64_t code, uint64_t before, uint64_t beyond) {
    uint64_t low = cell_apart(code, before), high = cell_apart(code, beyond);
    return low < high ? low : high;
}

// The first of [begin, end) whose code is more than `code`; end when there is none.
static uint32_t first_beyond(const builder *b, uint32_t begin, uint32_t end, uint64_t code) {
    while (begin < end) {
        uint32_t middle = begin + (end - begin) / 2;
        if (code_at(b, middle) <= code)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

static sag_status cut(builder *b, uint32_t begin, uint32_t end, int level);

// Treelets for more primitives of one code than go into one.
static sag_status cut_cell(builder *b, uint32_t begin, uint32_t end, int level) {
    if (level < LEVELS) {
        memcpy(b->primitives + begin, b->tree.primitives + begin, (end - begin) * sizeof *b->primitives);
        sag_status status = sort(b, begin, end - begin);
        if (status != SAG_OK) return status;
        if (code_at(b, begin) != code_at(b, end - 1)) return cut(b, begin, end, level + 1);
    }
    for (; begin < end; begin += TREELET) {
        b->first[b->treelet_count++] = begin;
        if (end - begin <= TREELET) break;
    }
    return SAG_OK;
}

// Cuts a stretch of primitives that were sorted together into treelets. (Calls itself by cut_cell, at most
// LEVELS deep.)
static sag_status cut(builder *b, uint32_t begin, uint32_t end, int level) {
    uint64_t before = UINT64_MAX; // differs from every code in a bit above all
    for (uint32_t stop; begin < end; begin = stop) {
        stop = end;
        if (end - begin > TREELET) {
            uint64_t code = code_at(b, begin);
            stop =
                first_beyond(b, begin, end, code | cell_between(code, before, code_at(b, begin + TREELET)));
            before = code_at(b, stop - 1);
        }
        if (stop - begin <= TREELET) {
            b->first[b->treelet_count++] = begin;
            continue;
        }
        sag_status status = cut_cell(b, begin, stop, level);
        if (status != SAG_OK) return status;
    }
    return SAG_OK;
}

static float area_of(const builder *b, uint32_t first, uint32_t count) {
    sagi_float_box box = sagi_float_box_empty();
    for (uint32_t i = first; i < first + count; i++)
        sagi_float_box_extend(&box, b->tree.primitives[i].lo, b->tree.primitives[i].hi);
    return sagi_float_box_half_area(&box);
}

// How many of `count` primitives in a cell of the curve are in its first half; half of them when all have one
// code.
static uint32_t first_half(const builder *b, uint32_t first, uint32_t count) {
    uint64_t code = code_at(b, first), low = cell_apart(code, code_at(b, first + count - 1));
    uint32_t half = 1;
    while (half < count && (code_at(b, first + half) ^ code) <= low) half++;
    return half < count ? half : count / 2;
}

// Leaves for the sorted primitives [first, end): cells of the curve that hold few enough, and are not much
// better off as two.
static void make_leaves(const builder *b, uint32_t first, uint32_t end) {
    uint64_t before = UINT64_MAX;
    for (uint32_t i = first, size; i < end; i += size) {
        size = end - i;
        if (size > LEAF) {
            uint64_t code = code_at(b, i), low = cell_between(code, before, code_at(b, i + LEAF));
            for (size = 1; size < LEAF && (code_at(b, i + size) ^ code) <= low; size++) {
            }
        }
        if (!sagi_binary_fits(b->maker, b->tree.primitives + i, size)) size = 1;
        float area = size > 2 ? area_of(b, i, size) : 0;
        while (size > 2) {
            uint32_t half = first_half(b, i, size);
            float left = area_of(b, i, half), right = area_of(b, i + half, size - half);
            if (!(left + right < SAGI_LEAF_SHARE * area)) break;
            size = half, area = left;
        }
        before = code_at(b, i + size - 1);
        b->leaf_size[i] = (uint8_t)size;
    }
}

// Makes a treelet's leaves and counts them.
static void count_leaves(void *argument, size_t index) {
    builder *b = argument;
    uint32_t first = b->first[index], end = b->first[index + 1], count = 0;
    make_leaves(b, first, end);
    for (uint32_t i = first; i < end; i += b->leaf_size[i]) count++;
    b->slots[index] = count;
}

// A treelet of n leaves takes n − 1 of the n nodes that begin with slots[index] and leaves the last one.
static void cluster_treelet(void *argument, size_t index) {
    builder *b = argument;
    float memory[SAGI_CLUSTERS_FLOATS(TREELET)];
    sagi_clusters clusters;
    sagi_clusters_init(&clusters, memory, TREELET);
    for (uint32_t i = b->first[index]; i < b->first[index + 1]; i += b->leaf_size[i])
        sagi_clusters_add(&clusters, &b->tree, SAGI_LOOSE_LEAF | i);
    uint32_t slot = b->slots[index], count = clusters.count;
    b->roots[index] = sagi_clusters_merge(&clusters, &b->tree, NULL, slot);
    b->slots[index] = slot + count - 1;
}

// Leaves for all treelets; then nodes are allocated for as many.
static sag_status make_all_leaves(builder *b) {
    b->roots = sag_allocate(b->context, b->treelet_count * sizeof *b->roots);
    b->slots = sag_allocate(b->context, b->treelet_count * sizeof *b->slots);
    b->memory = sag_allocate(b->context, SAGI_CLUSTERS_FLOATS(b->treelet_count) * sizeof *b->memory);
    if (b->roots == NULL || b->slots == NULL || b->memory == NULL) return SAG_ERROR_MEMORY;
    sag_parallel_for(b->context, b->treelet_count, count_leaves, b);
    for (uint32_t i = 0; i < b->treelet_count; i++) {
        uint32_t count = b->slots[i];
        b->slots[i] = b->tree.count;
        b->tree.count += count;
    }
    b->tree.nodes = sag_allocate(b->context, b->tree.count * sizeof *b->tree.nodes);
    b->nodes = sag_allocate(b->context, 2 * (size_t)b->tree.count * sizeof *b->nodes);
    return b->tree.nodes != NULL && b->nodes != NULL ? SAG_OK : SAG_ERROR_MEMORY;
}

static sag_status build(builder *b, uint32_t count) {
    sag_status status = sort(b, 0, count);
    if (status == SAG_OK) status = cut(b, 0, count, 0);
    if (status != SAG_OK) return status;
    b->first[b->treelet_count] = count;
    status = make_all_leaves(b);
    if (status != SAG_OK) return status;
    sag_parallel_for(b->context, b->treelet_count, cluster_treelet, b);
    sagi_clusters clusters;
    sagi_clusters_init(&clusters, b->memory, b->treelet_count);
    for (uint32_t i = 0; i < b->treelet_count; i++) sagi_clusters_add(&clusters, &b->tree, b->roots[i]);
    b->tree.root = sagi_clusters_merge(&clusters, &b->tree, b->slots, 0);
    sagi_loose_write(b->context, NULL, &b->tree, b->primitives, b->nodes);
    return SAG_OK;
}

static bool allocate(builder *b, uint32_t count) {
    size_t n = count;
    b->tree.primitives = sag_allocate(b->context, n * sizeof *b->tree.primitives);
    b->keys = sag_allocate(b->context, n * sizeof *b->keys);
    b->scratch = sag_allocate(b->context, n * sizeof *b->scratch);
    b->first = sag_allocate(b->context, (n + 1) * sizeof *b->first);
    b->tree.leaf_size = b->leaf_size = sag_allocate(b->context, n);
    return b->tree.primitives != NULL && b->keys != NULL && b->scratch != NULL && b->first != NULL &&
           b->leaf_size != NULL;
}

static void release(builder *b, uint32_t count) {
    size_t n = count;
    sag_release(b->context, b->nodes, 2 * (size_t)b->tree.count * sizeof *b->nodes);
    sag_release(b->context, b->tree.nodes, b->tree.count * sizeof *b->tree.nodes);
    sag_release(b->context, b->tree.primitives, n * sizeof *b->tree.primitives);
    sag_release(b->context, b->keys, n * sizeof *b->keys);
    sag_release(b->context, b->scratch, n * sizeof *b->scratch);
    sag_release(b->context, b->first, (n + 1) * sizeof *b->first);
    sag_release(b->context, b->leaf_size, n);
    sag_release(b->context, b->roots, b->treelet_count * sizeof *b->roots);
    sag_release(b->context, b->slots, b->treelet_count * sizeof *b->slots);
    sag_release(b->context, b->memory, SAGI_CLUSTERS_FLOATS(b->treelet_count) * sizeof *b->memory);
}

sag_status sagi_bvh_build_fast(const sag_context *context, const sagi_bvh_options *options,
                               sagi_bvh_primitive *primitives, uint32_t count, sagi_bvh *tree) {
    builder b = {.context = context, .maker = &options->leaves, .primitives = primitives};
    sag_status status = allocate(&b, count) ? build(&b, count) : SAG_ERROR_MEMORY;
    if (status == SAG_OK)
        status = sagi_bvh_collapse(context, &options->leaves, b.nodes, 2 * b.tree.count, primitives, tree);
    release(&b, count);
    return status;
}
