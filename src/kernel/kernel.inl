// SPDX-License-Identifier: MIT
// The walk of a ray through a world, for three questions: the closest hit, any hit, all crossings. The
// question is a constant wherever the functions are inlined, so each has machine code of its own.
//
// The float ray (ray.h) culls conservatively; the leaves (leaf.inl) ask the shapes themselves, in double. A
// box is skipped only when it begins strictly beyond the best t: hits at equal t are compared by (instance
// path, geometry, primitive), so the answer does not depend on the tree.
#include "kernel/block.h"
#include "kernel/kernel.h"
#include "kernel/ray.h"
#include "shapes/common.h"
#include "shapes/mesh.h"
#include "shapes/sphere_solve.h"
#include "shapes/spheres.h"
#include "shapes/triangle_solve.h"
#include "shapes/user.h"
#include <string.h>

// What a count of the kernel's steps hooks into (bench/); nothing in the library.
#ifndef SAGI_KERNEL_COUNT
#define SAGI_KERNEL_COUNT(what) ((void)0)
#endif

typedef enum question { CLOSEST, ANY, ALL } question;

// What is asked, and the answer so far.
typedef struct search {
    sag_hit *best;            // CLOSEST
    bool found;               // CLOSEST, ANY
    sagi_collector collector; // ALL
    sagi_repeats repeats;     // ALL: what of it may come again
    bool both_sides;          // see sagi_kernel
    uint32_t path_length;
    uint32_t path[SAG_MAX_INSTANCE_DEPTH];
} search;

// A certain hit that waits (triangles.inl, spheres.inl).
typedef struct candidate {
    const sagi_block *block;
    uint32_t lane;
    float earliest; // in τ
} candidate;
#define MAX_CANDIDATES 4

// The ray in one world's space.
typedef struct level {
    const sagi_world *world;
    search *search;
    const sag_ray *ray; // as it came, but for
    double t_max;       // for CLOSEST the best t so far
    uint32_t mask;      // never 0
    uint32_t candidate_count;
    bool in_tree; // tree_ray is there
    float limit;  // what begins at a later τ does not matter
    candidate candidates[MAX_CANDIDATES];
    sagi_float_ray tree_ray;
} level;

SAGI_INLINE void enter(level *here, const sagi_world *world, const sag_ray *ray, search *s) {
    here->world = world, here->search = s;
    here->ray = ray, here->t_max = ray->t_max;
    here->mask = ray->mask != 0 ? ray->mask : UINT32_MAX;
    here->candidate_count = 0;
    here->in_tree = false, here->limit = INFINITY;
}

static inline void lower_t_max(level *here, double t) {
    here->t_max = t;
    if (here->in_tree) here->limit = sagi_float_min(here->limit, sagi_float_ray_limit(&here->tree_ray, t));
}

// Whether the ray sees the geometry.
static inline bool sees(const level *here, const sagi_item *item) { return (here->mask & item->mask) != 0; }

// Only triangles of meshes are in several leaves (scene/clip.c).
static inline void collect(search *s, const sagi_world *world, const sag_hit *hit) {
    if (world->tree.repeats && world->items[hit->geometry].kind == SAG_SHAPE_MESH)
        sagi_repeats_add(&s->repeats, hit);
    else if (!s->repeats.again)
        sagi_collector_add(&s->collector, hit);
}

static inline void write_hit(const search *s, uint32_t geometry, uint32_t primitive, double t, double u,
                             double v, sag_hit *hit) {
    memset(hit, 0xFF, sizeof *hit); // SAG_INVALID_ID; padding, too, is the same everywhere
    hit->t = t, hit->u = u, hit->v = v;
    hit->primitive = primitive, hit->geometry = geometry;
    hit->instance_depth = s->path_length;
    for (uint32_t i = 0; i < s->path_length; i++) hit->instance_path[i] = s->path[i];
}
_Static_assert(SAG_INVALID_ID == UINT32_MAX, "all its bits are set");

// Takes note of a hit in the ray's range; true when the search is over. With t and the ids only: most hits
// are not the best.
static inline bool accept(question asked, level *here, uint32_t geometry, uint32_t primitive, double t,
                          double u, double v) {
    search *s = here->search;
    if (asked == ANY) return s->found = true;
    if (asked == CLOSEST && s->found && !(t <= s->best->t)) return false;
    if (asked == CLOSEST && (!s->found || t < s->best->t)) {
        write_hit(s, geometry, primitive, t, u, v, s->best), s->found = true;
        lower_t_max(here, t);
        return false;
    }
    sag_hit hit;
    write_hit(s, geometry, primitive, t, u, v, &hit);
    if (asked == ALL)
        collect(s, here->world, &hit);
    else if (sagi_hit_before(&hit, s->best)) // at the same t
        *s->best = hit;
    return false;
}

static bool walk_closest(level *here);
static bool walk_any(level *here);
static bool walk_all(level *here);

#include "kernel/triangles.inl"

#include "kernel/spheres.inl"

#include "kernel/leaf.inl"

// A node or leaf that waits: where it begins at the earliest, as the bits of a float that is not negative,
// and below them the child's number. As whole numbers they are ordered by their beginnings.
typedef uint64_t waiting;

SAGI_INLINE float begin_of(waiting w) {
    union {
        uint32_t bits;
        float value;
    } u = {(uint32_t)(w >> 32)};
    return u.value;
}

// What a step takes of the ray, spread over registers.
typedef struct spread_ray {
    sagi_f8 near_scale[3], near_add[3], far_scale[3], far_add[3], from;
    uint32_t near_at[3], far_at[3];
} spread_ray;

SAGI_INLINE spread_ray spread_of(const sagi_float_ray *r) {
    spread_ray s;
    for (int k = 0; k < 3; k++) {
        s.near_scale[k] = sagi_f8_fill(r->near_scale[k]), s.near_add[k] = sagi_f8_fill(r->near_add[k]);
        s.far_scale[k] = sagi_f8_fill(r->far_scale[k]), s.far_add[k] = sagi_f8_fill(r->far_add[k]);
        s.near_at[k] = r->near_at[k], s.far_at[k] = r->far_at[k];
    }
    s.from = sagi_f8_fill(r->from);
    return s;
}

// One step: the node's children that the ray meets before `limit`. One of them, for CLOSEST the nearest, is
// handed back; the others go on the stack. False when there is none.
SAGI_INLINE bool step(question asked, const sagi_bvh_node *node, const spread_ray *r, float limit,
                      waiting **stack, waiting *next) {
    const char *at = (const char *)node;
    sagi_f8 begin = r->from, end = sagi_f8_fill(limit);
    for (int k = 0; k < 3; k++) {
        begin = sagi_f8_max(sagi_f8_fma(sagi_f8_load(at + r->near_at[k]), r->near_scale[k], r->near_add[k]),
                            begin);
        end = sagi_f8_min(sagi_f8_fma(sagi_f8_load(at + r->far_at[k]), r->far_scale[k], r->far_add[k]), end);
    }
    SAGI_KERNEL_COUNT(nodes);
    sagi_i8 met = begin <= end;
    uint32_t mask = sagi_i8_mask(met), lane;
    if (mask == 0) return false;
    sagi_i8 bits = sagi_f8_bits(begin), children = sagi_i8_load(node->child);
    if (asked == CLOSEST) {
        // The lane's number takes the place of the last three bits of where it begins, which only moves the
        // beginning forward; what is not met comes last.
        const sagi_i8 numbers = {0, 1, 2, 3, 4, 5, 6, 7};
        uint32_t least = (uint32_t)sagi_i8_least((bits & ~7) | numbers | (~met & INT32_MAX));
        lane = least & 7;
        *next = (uint64_t)(least & ~7U) << 32 | node->child[lane];
    } else {
        lane = (uint32_t)__builtin_ctz(mask);
        *next = (uint64_t)(uint32_t)bits[lane] << 32 | node->child[lane];
    }
    *stack += sagi_append_pairs(*stack, mask & ~(1U << lane), bits, children);
    return true;
}

// True when the search is over.
SAGI_INLINE bool walk(question asked, level *here) {
    const sagi_world *world = here->world;
    if (world->unbounded_count != 0) {
        if (!sag_ray_is_valid(here->ray)) return false;
        if (list(asked, here, world->unbounded, world->unbounded_count)) return true;
    }
    if (world->tree.node_count == 0 || !sagi_float_ray_make(world, here->ray, &here->tree_ray)) return false;
    here->in_tree = true;
    here->limit = here->tree_ray.limit;
    if (here->t_max < here->ray->t_max) lower_t_max(here, here->t_max);
    waiting stack[SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH]; // eight are written at a time, however few are met
    waiting *top = stack, next = 0;                      // the root
    spread_ray ray = spread_of(&here->tree_ray);
    const sagi_bvh_node *nodes = world->tree.nodes;
    for (;;) {
        if (((uint32_t)next & SAGI_BVH_LEAF) == 0) {
            if (step(asked, &nodes[(uint32_t)next], &ray, here->limit, &top, &next)) continue;
        } else if (leaf(asked, here, sagi_leaf(&world->tree, (uint32_t)next), begin_of(next))) {
            return true;
        }
        do {
            if (top == stack) {
                if (asked == CLOSEST) settle(here);
                return false;
            }
            next = *--top;
        } while (asked == CLOSEST && begin_of(next) > here->limit);
    }
}

static bool walk_closest(level *here) { return walk(CLOSEST, here); }
static bool walk_any(level *here) { return walk(ANY, here); }
static bool walk_all(level *here) { return walk(ALL, here); }

static bool intersect(const sagi_world *world, const sag_ray *ray, sag_hit *hit) {
    search s;
    s.best = hit, s.found = false, s.both_sides = false, s.path_length = 0;
    level here;
    enter(&here, world, ray, &s);
    walk(CLOSEST, &here);
    return s.found;
}

static bool occluded(const sagi_world *world, const sag_ray *ray) {
    search s;
    s.found = false, s.both_sides = false, s.path_length = 0;
    level here;
    enter(&here, world, ray, &s);
    return walk(ANY, &here);
}

static size_t crossings(const sagi_world *world, const sag_ray *ray, bool both_sides, sag_hit *hits,
                        size_t capacity) {
    sag_hit kept[SAGI_REPEATS_KEPT];
    search s = {.collector = {hits, capacity, 0}, .both_sides = both_sides, .repeats.kept = kept};
    do {
        level here;
        enter(&here, world, ray, &s);
        walk(ALL, &here);
    } while (sagi_repeats_hand_on(&s.repeats, &s.collector));
    sagi_collector_finish(&s.collector);
    return s.collector.count;
}

#include "kernel/batch.inl"

const sagi_kernel SAGI_KERNEL_NAME = {intersect, occluded, crossings, intersect_batch, occluded_batch};
