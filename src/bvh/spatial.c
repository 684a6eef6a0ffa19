// SPDX-License-Identifier: MIT
// A builder that splits space where that is cheaper than splitting the primitives (Stich, Friedrich &
// Dietrich, 2009). Only where the halves of the best split of primitives overlap in more than OVERLAP of the
// whole scene's area is a plane looked for. A primitive on both sides of it becomes two references, each with
// the box of its part, unless it is cheaper to leave it whole on one side.
//
// References beyond the primitives are bounded by the capacity given. A range owns a stretch of the array
// with room to spare; what its split does not use up is shared out to its halves in proportion to their
// primitives' areas, as large ones have more to gain. So a range's subtree depends on nothing outside the
// range, and threads may take ranges in any order.
#include "bvh/spatial.h"
#include "bvh/clip.h"
#include <string.h>

#define OVERLAP      1e-5f
#define FEWEST       9u  // references worth a spatial split: more than a leaf holds
#define SPATIAL_DEEP 48u // levels with spatial splits
#define LARGE        65536u
#define CHUNK        16384u

// Ranges halve below the depth cap: 32 more levels and a range of any count is one reference.
#define STACK_SIZE (SAGI_BVH_MAX_DEPTH + 34)

// References [first, first + range.count) that become a subtree below `parent`; first + capacity and node +
// capacity − 1 end what it owns.
typedef struct stretch {
    sagi_range range;
    uint32_t capacity, parent;
    int side;
} stretch;

typedef struct builder {
    const sag_context *context;
    const sagi_clipper *clipper;
    sagi_loose_tree *tree;
    sagi_bvh_primitive *scratch;
    float least_overlap;
    stretch *tasks;
    uint32_t task_count, task_capacity;
    // A large range binned by all threads.
    const stretch *large;
    sagi_bins *bins;
    sagi_spatial_bins *spatial_bins;
} builder;

// One side of a split while references come in.
typedef struct half {
    sagi_bvh_primitive *at;
    ptrdiff_t step;
    uint32_t count;
    sagi_float_box box;
    sagi_extent centroids;
    double weight;
} half;

static sagi_float_box box_of(const sagi_bvh_primitive *p) {
    return (sagi_float_box){{p->lo[0], p->lo[1], p->lo[2]}, {p->hi[0], p->hi[1], p->hi[2]}};
}

static half half_empty(sagi_bvh_primitive *at, ptrdiff_t step) {
    return (half){at, step, 0, sagi_float_box_empty(), sagi_extent_empty(), 0};
}

static void put(half *h, const sagi_bvh_primitive *p) {
    sagi_float_box box = box_of(p);
    *h->at = *p;
    h->at += h->step;
    h->count++;
    sagi_float_box_extend(&h->box, p->lo, p->hi);
    sagi_extent_add(&h->centroids, p);
    h->weight += (double)sagi_float_box_half_area(&box);
}

static void put_part(half *h, const sagi_bvh_primitive *p, const sagi_float_box *part) {
    sagi_bvh_primitive own = *p;
    memcpy(own.lo, part->lo, sizeof own.lo), memcpy(own.hi, part->hi, sizeof own.hi);
    put(h, &own);
}

static float grown_area(const sagi_float_box *box, const sagi_bvh_primitive *p) {
    sagi_float_box grown = *box;
    sagi_float_box_extend(&grown, p->lo, p->hi);
    return sagi_float_box_half_area(&grown);
}

// A reference on both sides of the plane. *spare counts down when it becomes two.
static void put_straddler(const builder *b, const sagi_plane_split *split, const sagi_bvh_primitive *p,
                          half *left, half *right, uint32_t *spare) {
    sagi_float_box l = box_of(p), r = l;
    double corner[3][3];
    int axis = split->axis;
    if (!b->clipper->corners(b->clipper->user, p, corner)) {
        put(0.5f * (p->lo[axis] + p->hi[axis]) < split->plane ? left : right, p);
        return;
    }
    sagi_clip_triangle(corner, axis, p->lo[axis], split->plane, &l);
    sagi_clip_triangle(corner, axis, split->plane, p->hi[axis], &r);
    if (sagi_float_box_is_empty(&l) || sagi_float_box_is_empty(&r)) {
        put(sagi_float_box_is_empty(&l) ? right : left, p);
        return;
    }
    float nl = (float)split->left_count, nr = (float)split->right_count;
    float al = sagi_float_box_half_area(&split->left), ar = sagi_float_box_half_area(&split->right);
    float both = al * nl + ar * nr;
    float whole_left = grown_area(&split->left, p) * nl + ar * (nr - 1);
    float whole_right = al * (nl - 1) + grown_area(&split->right, p) * nr;
    if (*spare > 0 && both <= whole_left && both <= whole_right) {
        put_part(left, p, &l), put_part(right, p, &r);
        (*spare)--;
    } else {
        put(whole_left <= whole_right ? left : right, p);
    }
}

static void part_space(const builder *b, const stretch *s, const sagi_plane_split *split, half *left,
                       half *right) {
    const sagi_bvh_primitive *p = b->tree->primitives + s->range.first;
    uint32_t spare = s->capacity - s->range.count;
    for (uint32_t i = 0; i < s->range.count; i++, p++) {
        if (p->hi[split->axis] <= split->plane)
            put(left, p);
        else if (p->lo[split->axis] >= split->plane)
            put(right, p);
        else
            put_straddler(b, split, p, left, right, &spare);
    }
}

static void part_primitives(const builder *b, const stretch *s, const sagi_split *split, half *left,
                            half *right) {
    sagi_bvh_primitive *p = b->tree->primitives + s->range.first;
    bool halve = split->verdict != SAGI_SPLIT;
    if (halve) sagi_range_halve(p - s->range.first, &s->range);
    for (uint32_t i = 0; i < s->range.count; i++, p++)
        put((halve ? i < s->range.count / 2 : sagi_split_goes_left(split, p)) ? left : right, p);
}

static void bin_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t begin = (uint32_t)index * CHUNK, left = b->large->range.count - begin;
    const sagi_bvh_primitive *p = b->tree->primitives + b->large->range.first + begin;
    sagi_bins_init(&b->bins[index], &b->large->range);
    sagi_bins_add(&b->bins[index], p, left < CHUNK ? left : CHUNK);
}

static void bin_space_chunk(void *argument, size_t index) {
    builder *b = argument;
    uint32_t begin = (uint32_t)index * CHUNK, left = b->large->range.count - begin;
    const sagi_bvh_primitive *p = b->tree->primitives + b->large->range.first + begin;
    sagi_spatial_bins_init(&b->spatial_bins[index], &b->large->range.box);
    sagi_spatial_bins_add(&b->spatial_bins[index], b->clipper, p, left < CHUNK ? left : CHUNK);
}

static uint32_t chunks_of(uint32_t count) { return count / CHUNK + (count % CHUNK != 0); }

// The best split of the primitives, ignoring the depth, which is looked after elsewhere.
static sagi_split split_primitives(builder *b, const stretch *s) {
    sagi_range range = s->range;
    range.depth = 0;
    if (range.count > LARGE) {
        uint32_t chunks = chunks_of(range.count);
        b->large = s;
        sag_parallel_for(b->context, chunks, bin_chunk, b);
        for (uint32_t i = 1; i < chunks; i++) sagi_bins_merge(&b->bins[0], &b->bins[i]);
        return sagi_bins_choose(&b->bins[0], &range);
    }
    sagi_bins bins;
    sagi_bins_init(&bins, &range);
    sagi_bins_add(&bins, b->tree->primitives + range.first, range.count);
    return sagi_bins_choose(&bins, &range);
}

static sagi_plane_split split_space(builder *b, const stretch *s) {
    if (s->range.count > LARGE) {
        uint32_t chunks = chunks_of(s->range.count);
        b->large = s;
        sag_parallel_for(b->context, chunks, bin_space_chunk, b);
        for (uint32_t i = 1; i < chunks; i++)
            sagi_spatial_bins_merge(&b->spatial_bins[0], &b->spatial_bins[i]);
        return sagi_spatial_bins_choose(&b->spatial_bins[0], s->capacity);
    }
    sagi_spatial_bins bins;
    sagi_spatial_bins_init(&bins, &s->range.box);
    sagi_spatial_bins_add(&bins, b->clipper, b->tree->primitives + s->range.first, s->range.count);
    return sagi_spatial_bins_choose(&bins, s->capacity);
}

// Whether the halves of a split of primitives overlap so much that a plane is worth looking for.
static bool worth_a_plane(const builder *b, const stretch *s, const sagi_split *split) {
    if (b->clipper->corners == NULL || s->capacity == s->range.count || s->range.count < FEWEST ||
        s->range.depth >= SPATIAL_DEEP)
        return false;
    if (split->verdict != SAGI_SPLIT) return true;
    sagi_float_box both;
    for (int k = 0; k < 3; k++) {
        both.lo[k] = sagi_float_max(split->left.lo[k], split->right.lo[k]);
        both.hi[k] = sagi_float_min(split->left.hi[k], split->right.hi[k]);
    }
    return sagi_float_box_half_area(&both) > b->least_overlap;
}

static float cost_of(const sagi_split *split, uint32_t count) {
    if (split->verdict != SAGI_SPLIT) return INFINITY;
    return (float)split->left_count * sagi_float_box_half_area(&split->left) +
           (float)(count - split->left_count) * sagi_float_box_half_area(&split->right);
}

// Splits a stretch of several references: from its place in the array to the scratch, the left half from the
// beginning on, the right half from the end, backwards.
static void part(builder *b, const stretch *s, half *left, half *right) {
    sagi_bvh_primitive *out = b->scratch + s->range.first;
    const half none_left = half_empty(out, 1), none_right = half_empty(out + s->capacity - 1, -1);
    sagi_split split = {.verdict = SAGI_HALVE};
    if (s->range.depth < SAGI_BVH_MAX_DEPTH) split = split_primitives(b, s);
    *left = none_left, *right = none_right;
    if (worth_a_plane(b, s, &split)) {
        sagi_plane_split plane = split_space(b, s);
        if (plane.cost < cost_of(&split, s->range.count)) {
            part_space(b, s, &plane, left, right);
            // With something on each side this ends, as either has less capacity than the whole.
            if (left->count > 0 && right->count > 0) return;
            *left = none_left, *right = none_right;
        }
    }
    part_primitives(b, s, &split, left, right);
}

static stretch child_of(const stretch *s, const half *h, int side, uint32_t first, uint32_t capacity,
                        uint32_t node) {
    sagi_range range = {.node = node,
                        .first = first,
                        .count = h->count,
                        .depth = s->range.depth + 1,
                        .box = h->box,
                        .centroids = sagi_extent_box(&h->centroids)};
    return (stretch){range, capacity, s->range.node, side};
}

// Makes the node of a stretch of several references, and its halves.
static void split_stretch(builder *b, const stretch *s, stretch *left, stretch *right) {
    half l, r;
    part(b, s, &l, &r);
    uint32_t spare = s->capacity - l.count - r.count;
    double share = l.weight + r.weight > 0 ? l.weight / (l.weight + r.weight) : 0.5;
    uint32_t left_capacity = l.count + (uint32_t)(share * spare);
    uint32_t first = s->range.first, node = s->range.node;
    sagi_bvh_primitive *out = b->tree->primitives + first, *from = b->scratch + first;
    memcpy(out, from, l.count * sizeof *out);
    memcpy(out + left_capacity, from + s->capacity - r.count, r.count * sizeof *out);
    b->tree->nodes[node] = (sagi_loose_node){.box = s->range.box, .parent = s->parent, .count = 1};
    *left = child_of(s, &l, 0, first, left_capacity, node + 1);
    *right = child_of(s, &r, 1, first + left_capacity, s->capacity - left_capacity, node + left_capacity);
}

// Tells the parent where the subtree begins.
static void hang(const builder *b, const stretch *s) {
    uint32_t child = s->range.count == 1 ? SAGI_LOOSE_LEAF | s->range.first : s->range.node;
    if (s->parent == SAGI_LOOSE_NONE)
        b->tree->root = child;
    else
        b->tree->nodes[s->parent].child[s->side] = child;
}

static void run_task(void *argument, size_t index) {
    builder *b = argument;
    stretch stack[STACK_SIZE], s = b->tasks[index];
    for (int waiting = 0;;) {
        hang(b, &s);
        if (s.range.count > 1) {
            stretch left;
            split_stretch(b, &s, &left, &stack[waiting++]);
            s = left;
            continue;
        }
        if (waiting == 0) return;
        s = stack[--waiting];
    }
}

static void run_tasks(builder *b) {
    sag_parallel_for(b->context, b->task_count, run_task, b);
    b->task_count = 0;
}

static void build(builder *b, stretch s) {
    stretch stack[STACK_SIZE];
    for (int waiting = 0;;) {
        if (s.range.count > LARGE) {
            stretch left;
            hang(b, &s);
            split_stretch(b, &s, &left, &stack[waiting++]);
            s = left;
            continue;
        }
        if (b->task_count == b->task_capacity) run_tasks(b);
        b->tasks[b->task_count++] = s;
        if (waiting == 0) break;
        s = stack[--waiting];
    }
    run_tasks(b);
}

// Counts the references below every node. Children have higher numbers than their parents.
static void count_below(sagi_loose_tree *tree, uint32_t capacity) {
    for (uint32_t i = capacity; i-- > 0;) {
        sagi_loose_node *n = &tree->nodes[i];
        if (n->count > 0)
            n->count = sagi_loose_count(tree, n->child[0]) + sagi_loose_count(tree, n->child[1]);
    }
    tree->count = sagi_loose_count(tree, tree->root);
}

sag_status sagi_spatial_build(const sag_context *context, const sagi_clipper *clipper, sagi_loose_tree *tree,
                              uint32_t capacity, sagi_bvh_primitive *scratch) {
    stretch all = {.capacity = capacity, .parent = SAGI_LOOSE_NONE, .range.count = tree->count};
    half measured = half_empty(scratch, 1);
    for (uint32_t i = 0; i < tree->count; i++) put(&measured, &tree->primitives[i]);
    all.range.box = measured.box, all.range.centroids = sagi_extent_box(&measured.centroids);
    memset(tree->nodes, 0, capacity * sizeof *tree->nodes);
    uint32_t chunks = capacity > LARGE ? chunks_of(capacity) : 1;
    builder b = {.context = context, .clipper = clipper, .tree = tree, .scratch = scratch};
    b.least_overlap = OVERLAP * sagi_float_box_half_area(&all.range.box);
    b.task_capacity = 2 * (capacity / LARGE) + 64;
    b.tasks = sag_allocate(context, b.task_capacity * sizeof *b.tasks);
    b.bins = sag_allocate(context, chunks * sizeof *b.bins);
    b.spatial_bins = sag_allocate(context, chunks * sizeof *b.spatial_bins);
    sag_status status = SAG_ERROR_MEMORY;
    if (b.tasks != NULL && b.bins != NULL && b.spatial_bins != NULL) {
        build(&b, all);
        count_below(tree, capacity);
        status = SAG_OK;
    }
    sag_release(context, b.tasks, b.task_capacity * sizeof *b.tasks);
    sag_release(context, b.bins, chunks * sizeof *b.bins);
    sag_release(context, b.spatial_bins, chunks * sizeof *b.spatial_bins);
    return status;
}
