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
#include "shapes/sphere.h"
#include "shapes/spheres.h"
#include "shapes/user.h"

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

// A certain hit that waits (triangles.inl).
typedef struct candidate {
    const sagi_triangle_block *block;
    uint32_t lane;
    float earliest; // in τ
} candidate;
#define MAX_CANDIDATES 4

// The ray in one world's space.
typedef struct level {
    const sagi_world *world;
    search *search;
    sag_ray ray; // its mask is never 0; for CLOSEST t_max is the best t so far
    sagi_triangle_ray triangle_ray;
    sagi_float_ray tree_ray;
    bool in_tree; // tree_ray is there
    float limit;  // what begins at a later τ does not matter
    uint32_t candidate_count;
    candidate candidates[MAX_CANDIDATES];
} level;

static inline level enter(const sagi_world *world, const sag_ray *ray, search *s) {
    level here;
    here.world = world, here.search = s;
    here.ray = *ray, here.triangle_ray = sagi_triangle_prepare(ray);
    if (here.ray.mask == 0) here.ray.mask = UINT32_MAX;
    here.in_tree = false, here.limit = INFINITY, here.candidate_count = 0;
    return here;
}

static inline void lower_t_max(level *here, double t) {
    here->ray.t_max = here->triangle_ray.t_max = t;
    if (here->in_tree) {
        float limit = sagi_float_ray_limit(&here->tree_ray, t);
        here->limit = sagi_float_min(here->limit, limit);
    }
}

// Whether the ray sees the geometry.
static inline bool sees(const level *here, const sagi_item *item) {
    return (here->ray.mask & item->mask) != 0;
}

// Only triangles of meshes are in several leaves (scene/clip.c).
static inline void collect(search *s, const sagi_world *world, const sag_hit *hit) {
    if (world->tree.repeats && world->items[hit->geometry].kind == SAG_SHAPE_MESH)
        sagi_repeats_add(&s->repeats, hit);
    else if (!s->repeats.again)
        sagi_collector_add(&s->collector, hit);
}

// Takes note of a hit in the ray's range; true when the search is over. With t and the ids only: most hits
// are not the best.
static inline bool accept(question asked, level *here, uint32_t geometry, uint32_t primitive, double t,
                          double u, double v) {
    search *s = here->search;
    if (asked == ANY) return s->found = true;
    if (asked == CLOSEST && s->found && !(t <= s->best->t)) return false;
    sag_hit hit = {.t = t, .u = u, .v = v, .primitive = primitive, .geometry = geometry};
    hit.instance_depth = s->path_length;
    for (uint32_t i = 0; i < SAG_MAX_INSTANCE_DEPTH; i++)
        hit.instance_path[i] = i < s->path_length ? s->path[i] : SAG_INVALID_ID;
    if (asked == ALL) {
        collect(s, here->world, &hit);
    } else if (!s->found || sagi_hit_before(&hit, s->best)) {
        *s->best = hit, s->found = true;
        lower_t_max(here, t);
    }
    return false;
}

static bool walk_closest(level *here);
static bool walk_any(level *here);
static bool walk_all(level *here);

#include "kernel/triangles.inl"

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

// One step: the node's children that the ray meets before `limit`. One of them, for CLOSEST the nearest, is
// handed back; the others go on the stack. False when there is none.
SAGI_INLINE bool step(question asked, const sagi_bvh_node *node, const sagi_float_ray *r, float limit,
                      waiting *stack, int *height, waiting *next) {
    const char *at = (const char *)node;
    sagi_f8 begin = sagi_f8_fill(0), end = sagi_f8_fill(limit);
    for (int k = 0; k < 3; k++) {
        begin = sagi_f8_max(sagi_f8_fma(sagi_f8_load(at + r->near_at[k]), sagi_f8_fill(r->near_scale[k]),
                                        sagi_f8_fill(r->near_add[k])),
                            begin);
        end = sagi_f8_min(sagi_f8_fma(sagi_f8_load(at + r->far_at[k]), sagi_f8_fill(r->far_scale[k]),
                                      sagi_f8_fill(r->far_add[k])),
                          end);
    }
    SAGI_KERNEL_COUNT(nodes);
    sagi_i8 met = begin <= end;
    uint32_t lane, mask;
    if (asked == CLOSEST) {
        // The lane's number takes the place of the last three bits of where it begins, which only moves the
        // beginning forward; what is not met comes last.
        const sagi_i8 numbers = {0, 1, 2, 3, 4, 5, 6, 7};
        sagi_i8 key = (sagi_f8_bits(begin) & ~7) | numbers;
        int32_t least = sagi_i8_least((met & key) | (~met & INT32_MAX));
        mask = sagi_i8_mask(met);
        if (mask == 0) return false;
        lane = (uint32_t)least & 7;
        *next = (uint64_t)((uint32_t)least & ~7U) << 32 | node->child[lane];
    } else {
        mask = sagi_i8_mask(met);
        if (mask == 0) return false;
        lane = (uint32_t)__builtin_ctz(mask);
        *next = (uint64_t)(uint32_t)sagi_f8_bits(begin)[lane] << 32 | node->child[lane];
    }
    *height += sagi_append_pairs(stack + *height, mask & ~(1U << lane), sagi_f8_bits(begin),
                                 sagi_i8_load(node->child));
    return true;
}

// True when the search is over.
SAGI_INLINE bool walk(question asked, level *here) {
    const sagi_world *world = here->world;
    if (list(asked, here, world->unbounded, world->unbounded_count)) return true;
    if (world->tree.node_count == 0 || !sagi_float_ray_make(world, &here->ray, &here->tree_ray)) return false;
    here->in_tree = true;
    here->limit = sagi_float_ray_limit(&here->tree_ray, here->ray.t_max);
    waiting stack[SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH]; // eight are written at a time, however few are met
    int height = 0;
    waiting next = 0; // the root
    for (;;) {
        if (((uint32_t)next & SAGI_BVH_LEAF) == 0) {
            if (step(asked, &world->tree.nodes[(uint32_t)next], &here->tree_ray, here->limit, stack, &height,
                     &next))
                continue;
        } else if (leaf(asked, here, sagi_leaf(&world->tree, (uint32_t)next), begin_of(next))) {
            return true;
        }
        do {
            if (height == 0) {
                if (asked == CLOSEST) settle(here);
                return false;
            }
            next = stack[--height];
        } while (asked == CLOSEST && begin_of(next) > here->limit);
    }
}

static bool walk_closest(level *here) { return walk(CLOSEST, here); }
static bool walk_any(level *here) { return walk(ANY, here); }
static bool walk_all(level *here) { return walk(ALL, here); }

static bool intersect(const sagi_world *world, const sag_ray *ray, sag_hit *hit) {
    sag_hit best;
    search s = {.best = &best};
    level here = enter(world, ray, &s);
    walk_closest(&here);
    if (s.found) *hit = best;
    return s.found;
}

static bool occluded(const sagi_world *world, const sag_ray *ray) {
    search s = {.found = false};
    level here = enter(world, ray, &s);
    return walk_any(&here);
}

static size_t crossings(const sagi_world *world, const sag_ray *ray, bool both_sides, sag_hit *hits,
                        size_t capacity) {
    sag_hit kept[SAGI_REPEATS_KEPT];
    search s = {.collector = {hits, capacity, 0}, .both_sides = both_sides, .repeats.kept = kept};
    do {
        level here = enter(world, ray, &s);
        walk_all(&here);
    } while (sagi_repeats_hand_on(&s.repeats, &s.collector));
    sagi_collector_finish(&s.collector);
    return s.collector.count;
}

const sagi_kernel SAGI_KERNEL_NAME = {intersect, occluded, crossings};
