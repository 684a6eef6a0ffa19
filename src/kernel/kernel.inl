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

typedef enum question { CLOSEST, ANY, ALL } question;

// What is asked, and the answer so far.
typedef struct search {
    sag_hit *best;            // CLOSEST
    bool found;               // CLOSEST, ANY
    sagi_collector collector; // ALL
    bool both_sides;          // see sagi_kernel
    uint32_t path_length;
    uint32_t path[SAG_MAX_INSTANCE_DEPTH];
} search;

// The ray in one world's space.
typedef struct level {
    const sagi_world *world;
    sag_ray ray; // its mask is never 0; for CLOSEST t_max is the best t so far
    sagi_triangle_ray triangle_ray;
    search *search;
} level;

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
        sagi_collector_add(&s->collector, &hit);
    } else if (!s->found || sagi_hit_before(&hit, s->best)) {
        *s->best = hit, s->found = true;
        here->ray.t_max = here->triangle_ray.t_max = t;
    }
    return false;
}

static bool walk_closest(level *here);
static bool walk_any(level *here);
static bool walk_all(level *here);

#include "kernel/leaf.inl"

// A node or leaf that waits, with where it begins at the earliest.
typedef struct waiting {
    float begin;
    uint32_t child;
} waiting;

// The children that the ray meets before `limit`, with their beginnings. The loops without branches become
// vector instructions.
static inline uint32_t meet_children(const sagi_bvh_node *node, const sagi_float_ray *r, float limit,
                                     float begin[8]) {
    const float *near_x = node->plane[r->near_plane[0]], *far_x = node->plane[r->far_plane[0]];
    const float *near_y = node->plane[r->near_plane[1]], *far_y = node->plane[r->far_plane[1]];
    const float *near_z = node->plane[r->near_plane[2]], *far_z = node->plane[r->far_plane[2]];
    float end[8];
    for (int i = 0; i < 8; i++) {
        float x = near_x[i] * r->near_scale[0] + r->near_add[0];
        float y = near_y[i] * r->near_scale[1] + r->near_add[1];
        float z = near_z[i] * r->near_scale[2] + r->near_add[2];
        begin[i] = sagi_float_max(sagi_float_max(x, y), sagi_float_max(z, 0));
        x = far_x[i] * r->far_scale[0] + r->far_add[0];
        y = far_y[i] * r->far_scale[1] + r->far_add[1];
        z = far_z[i] * r->far_scale[2] + r->far_add[2];
        end[i] = sagi_float_min(sagi_float_min(x, y), sagi_float_min(z, limit));
    }
    uint32_t met = 0;
    for (int i = 0; i < 8; i++) met |= (uint32_t)(begin[i] <= end[i]) << i;
    return met;
}

// Puts the children met on the stack, for CLOSEST the nearest on top. Returns the new height.
static inline int push_children(question asked, waiting *stack, int height, const sagi_bvh_node *node,
                                uint32_t met, const float begin[8]) {
    int base = height;
    for (int i = 0; met != 0; i++, met >>= 1) {
        if ((met & 1) == 0) continue;
        int place = height++;
        if (asked == CLOSEST)
            for (; place > base && stack[place - 1].begin < begin[i]; place--)
                stack[place] = stack[place - 1];
        stack[place] = (waiting){begin[i], node->child[i]};
    }
    return height;
}

// True when the search is over.
static inline bool walk(question asked, level *here) {
    const sagi_world *world = here->world;
    if (list(asked, here, world->unbounded, world->unbounded_count)) return true;
    sagi_float_ray ray;
    if (world->tree.node_count == 0 || !sagi_float_ray_make(world, &here->ray, &ray)) return false;
    double best = here->ray.t_max;
    float limit = sagi_float_ray_limit(&ray, best);
    waiting stack[SAGI_BVH_STACK_SIZE];
    int height = 0;
    stack[height++] = (waiting){0, 0};
    while (height > 0) {
        waiting next = stack[--height];
        if (next.begin > limit) continue;
        if ((next.child & SAGI_BVH_LEAF) == 0) {
            float begin[8];
            const sagi_bvh_node *node = &world->tree.nodes[next.child];
            uint32_t met = meet_children(node, &ray, limit, begin);
            height = push_children(asked, stack, height, node, met, begin);
            continue;
        }
        if (leaf(asked, here, sagi_leaf(&world->tree, next.child))) return true;
        if (asked == CLOSEST && here->ray.t_max < best) {
            best = here->ray.t_max;
            limit = sagi_float_ray_limit(&ray, best);
        }
    }
    return false;
}

static bool walk_closest(level *here) { return walk(CLOSEST, here); }
static bool walk_any(level *here) { return walk(ANY, here); }
static bool walk_all(level *here) { return walk(ALL, here); }

static level enter(const sagi_world *world, const sag_ray *ray, search *s) {
    level here = {.world = world, .ray = *ray, .triangle_ray = sagi_triangle_prepare(ray), .search = s};
    if (here.ray.mask == 0) here.ray.mask = UINT32_MAX;
    return here;
}

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
    search s = {.collector = {hits, capacity, 0}, .both_sides = both_sides};
    level here = enter(world, ray, &s);
    walk_all(&here);
    sagi_collector_finish(&s.collector);
    return s.collector.count;
}

const sagi_kernel SAGI_KERNEL_NAME = {intersect, occluded, crossings};
