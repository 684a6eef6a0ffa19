// SPDX-License-Identifier: MIT
// The walk of a ray through a world, for three questions: the closest hit, any hit, all crossings. The
// question is a constant wherever the functions are inlined, so each has machine code of its own.
//
// The float ray (ray.h) culls conservatively; the leaves (leaf.inl) ask the shapes themselves, in double. A
// box is skipped only when it begins strictly beyond the best t: hits at equal t are compared by (instance
// path, geometry, primitive), so the answer does not depend on the tree.
#include "kernel/block.h"
#include "kernel/corners.h"
#include "kernel/grid.h"
#include "kernel/kernel.h"
#include "kernel/ray.h"
#include "math/map.h"
#include "shapes/closed.h"
#include "shapes/common.h"
#include "shapes/mesh.h"
#include "shapes/mesh_surface.h"
#include "shapes/outline_four.h"
#include "shapes/sphere_four.h"
#include "shapes/sphere_solve.h"
#include "shapes/spheres.h"
#include "shapes/torus_four.h"
#include "shapes/triangle_range.h"
#include "shapes/triangle_solve.h"
#include "shapes/user.h"
#include "solid/carved.h"
#include "solid/dented.h"
#include "solid/tree.h"
#include <string.h>

// What a count of the kernel's steps hooks into (bench/); nothing in the library.
#ifndef SAGI_KERNEL_COUNT
#define SAGI_KERNEL_COUNT(what) ((void)0)
#endif

typedef enum question { CLOSEST, ANY, ALL } question;

typedef struct later later;

// What is asked, and the answer so far.
typedef struct search {
    sag_hit *best;   // CLOSEST
    bool found;      // CLOSEST, ANY
    bool odd;        // CLOSEST: whether as many hits as are at the best t are an odd number
    bool near;       // CLOSEST: whether there are others in a little room beyond it:
    bool both_sides; // see sagi_kernel
    uint32_t path_length;
    later *later;                // of a batch (put_off.inl), else NULL
    const sag_hit *known;        // the first crossing of a solid's part 0, if it is known, else NULL
    double grain, reach;         // grain · (|t| + reach), mostly 0 (solid_parts.inl)
    sagi_collector collector;    // ALL
    sagi_repeats repeats;        // ALL: what of it may come again
    const sagi_visitor *visitor; // ALL: takes everything in place of these two, when there is one
    uint32_t path[SAG_MAX_INSTANCE_DEPTH];
} search;

SAGI_INLINE void begin_search(search *s, sag_hit *best) {
    s->best = best;
    sagi_zero32(&s->found), s->reach = 0;
}
_Static_assert(offsetof(search, reach) == offsetof(search, found) + 32,
               "all that begins as 0, but for reach");

// A certain hit that waits (triangle_hits.inl, spheres.inl).
typedef struct candidate {
    const sagi_block *block;
    uint32_t lane;
    float earliest; // in τ
} candidate;
#define MAX_CANDIDATES 4

// What a block of triangles answers (triangles.inl).
typedef struct block_answer {
    uint32_t certain, uncertain; // lanes
    uint32_t inside;             // of the uncertain: those of which only the time is
    uint32_t back;               // of the certain: those met from the back
    sagi_f8 t, d, b0;            // T with D's sign, |D|, b₀
    float b1;
} block_answer;

// The ray in one world's space.
typedef struct level {
    const sagi_world *world;
    search *search;
    const sag_ray *ray; // as it came
    double t_max;       // in place of the ray's own: for CLOSEST the best t so far
    uint16_t candidate_count;
    bool in_tree; // tree_ray is there
    bool lone;    // if there is a candidate, it is the only one: a triangle of lone_mesh
    float limit;  // what begins at a later τ does not matter
    candidate candidates[MAX_CANDIDATES];
    const sag_mesh *lone_mesh;
    sagi_float_ray tree_ray;
    block_answer answer;
} level;

// What is said of the tree is left to come_to_tree.
SAGI_INLINE void enter_walk(level *here, const sagi_world *world, const sag_ray *ray, search *s) {
    here->world = world, here->search = s;
    here->ray = ray, here->t_max = ray->t_max;
    here->candidate_count = 0;
}
SAGI_INLINE void enter_outside(level *here) { here->in_tree = here->lone = false, here->limit = INFINITY; }
SAGI_INLINE void enter(level *here, const sagi_world *world, const sag_ray *ray, search *s) {
    enter_walk(here, world, ray, s);
    enter_outside(here);
}

static inline void lower_t_max(level *here, double t) {
    here->t_max = t;
    if (here->in_tree) here->limit = sagi_float_min(here->limit, sagi_float_ray_limit(&here->tree_ray, t));
}

// Whether the ray sees the geometry.
static inline bool sees(const level *here, const sagi_item *item) {
    const uint32_t mask = here->ray->mask;
    return mask == 0 || (mask & item->mask) != 0;
}

// Only triangles of meshes are in several leaves (scene/clip.c).
static inline void collect(search *s, const sagi_world *world, const sag_hit *hit) {
    if (s->visitor != NULL)
        s->visitor->take(s->visitor->user, hit);
    else if (world->tree.repeats && world->items[hit->geometry].kind == SAG_SHAPE_MESH)
        sagi_repeats_add(&s->repeats, hit);
    else if (!s->repeats.again)
        sagi_collector_add(&s->collector, hit);
}

// Asks for the memory of an answer, long before it is written: stores keep their order, so all that follow
// one that is far away wait with it; and of answers that only hits write to, the processor cannot see which
// comes next.
SAGI_INLINE void fetch_answer(const sag_hit *hit) {
    __builtin_prefetch(hit, 1), __builtin_prefetch((const char *)hit + sizeof *hit - 1, 1);
}

// All bits set. (To copy it takes a few moves; to fill the memory is a call.)
#define EIGHT_ONES                                                                                           \
    UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX
static const uint64_t no_hit[16] = {EIGHT_ONES, EIGHT_ONES};
_Static_assert(sizeof(sag_hit) <= sizeof no_hit, "as long as a hit");

static inline void write_hit(const search *s, uint32_t geometry, uint32_t primitive, double t, double u,
                             double v, sag_hit *hit) {
    memcpy(hit, &no_hit, sizeof *hit); // SAG_INVALID_ID
    hit->t = t, hit->u = u, hit->v = v;
    hit->primitive = primitive, hit->geometry = geometry;
    hit->instance_depth = s->path_length, hit->flipped = 0;
    for (uint32_t i = 0; i < s->path_length; i++) hit->instance_path[i] = s->path[i];
}
_Static_assert(SAG_INVALID_ID == UINT32_MAX, "all its bits are set");

// The same of a triangle of the outermost world, with t, u, v and anything in a vector.
SAGI_INLINE void write_triangle(sagi_d4 tuv, uint32_t geometry, uint32_t primitive, sag_hit *hit) {
    static const uint32_t rest[] = {0,          UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX,
                                    UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, 0};
    _Static_assert(offsetof(sag_hit, v) == 16 && offsetof(sag_hit, primitive) == 24, "t, u, v come first");
    _Static_assert(offsetof(sag_hit, instance_depth) == 32 && sizeof(sag_hit) == 32 + sizeof rest &&
                       sizeof hit->instance_path == 32,
                   "then the path and `flipped`");
    memcpy(hit, &tuv, sizeof tuv);
    hit->primitive = primitive, hit->geometry = geometry;
    memcpy(&hit->instance_depth, rest, sizeof rest);
}

static inline double room_of(const search *s, double t) { return s->grain * (fabs(t) + s->reach); }

// Takes note of a hit in the ray's range; true when the search is over. With t and the ids only: most hits
// are not the best.
static inline bool accept(question asked, level *here, uint32_t geometry, uint32_t primitive, double t,
                          double u, double v) {
    search *s = here->search;
    if (asked == ANY) return s->found = true;
    if (asked == CLOSEST && s->found && !(t <= s->best->t)) {
        if (t - s->best->t <= room_of(s, s->best->t)) s->near = true;
        return false;
    }
    if (asked == CLOSEST && (!s->found || t < s->best->t)) {
        s->near = s->found && s->best->t - t <= room_of(s, t);
        write_hit(s, geometry, primitive, t, u, v, s->best), s->found = s->odd = true;
        lower_t_max(here, t + room_of(s, t));
        return false;
    }
    sag_hit hit;
    write_hit(s, geometry, primitive, t, u, v, &hit);
    s->odd = !s->odd;
    if (asked == ALL)
        collect(s, here->world, &hit);
    else if (sagi_hit_before(&hit, s->best)) // at the same t
        *s->best = hit;
    return false;
}

static bool walk_closest(level *here);
static bool walk_any(level *here);
static bool walk_all(level *here);
static bool search_solid(question asked, level *here);
static bool run_solid(question asked, level *here, bool *inside);
static size_t crossings(const sagi_world *world, const sag_ray *ray, bool both_sides, sag_hit *hits,
                        size_t capacity);
static inline bool can_wait(const sagi_item *item);
static bool put_off(const level *here, uint32_t geometry);

#include "kernel/triangles.inl"

#include "kernel/triangle_hits.inl"

#include "kernel/spheres.inl"

#include "kernel/leaf.inl"

SAGI_INLINE uint32_t float_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
SAGI_INLINE float float_of(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

// A node or leaf, and the τ at which the ray comes to it at the earliest.
typedef struct waiting {
    float begin;
    uint32_t child;
} waiting;

// Asks for the memory of a node or leaf. Three cache lines will do: of a node's fourth the processor thinks
// itself, of a leaf's a hit does.
SAGI_INLINE void fetch_place(const void *at) {
    const char *line = at;
    __builtin_prefetch(line), __builtin_prefetch(line + 64), __builtin_prefetch(line + 128);
}

// All of it, for a single ray, which has time for it.
SAGI_INLINE void fetch_whole(const void *at) { fetch_place(at), __builtin_prefetch((const char *)at + 192); }

// Those that wait. Eight are written at a time, however few are met: the arrays have room for so many more.
// And there is one before the first, which is never taken, so that there are always two on top.
typedef struct stack {
    float *begin;
    uint32_t *child;
    size_t height;
} stack;
#define STACK_PLACES (1 + SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH)

SAGI_INLINE stack empty_stack(float begin[STACK_PLACES], uint32_t child[STACK_PLACES]) {
    begin[0] = INFINITY, child[0] = 0;
    return (stack){begin + 1, child + 1, 0};
}

// What a step needs of the ray, each number in all lanes: with enough registers it stays there from step to
// step.
typedef struct slabs {
    sagi_same near_scale[3], near_back[3], far_scale[3], far_back[3], from;
    sagi_plane_row planes; // of the node that stands first
} slabs;

SAGI_INLINE slabs slabs_of(const sagi_float_ray *r, const void *first) {
    slabs s;
    sagi_same_fill3(&r->near_scale, s.near_scale), sagi_same_fill3(&r->near_back, s.near_back);
    sagi_same_fill3(&r->far_scale, s.far_scale), sagi_same_fill3(&r->far_back, s.far_back);
    for (int k = 0; k < 3; k++)
        s.planes.near_plane[k] = (const char *)first + r->planes.near_at[k],
        s.planes.far_plane[k] = (const char *)first + r->planes.far_at[k];
    s.from = sagi_same_fill(r->first_low);
    return s;
}
// The same of a ray of which the planes are told apart from it.
SAGI_INLINE slabs slabs_at(const sagi_float_ray *r, const sagi_plane_row *planes) {
    slabs s;
    for (int k = 0; k < 3; k++) {
        s.near_scale[k] = sagi_same_fill(r->near_scale[k]), s.near_back[k] = sagi_same_fill(r->near_back[k]);
        s.far_scale[k] = sagi_same_fill(r->far_scale[k]), s.far_back[k] = sagi_same_fill(r->far_back[k]);
    }
    s.planes = *planes;
    s.from = sagi_same_fill(r->first_low);
    return s;
}
// Of a ray that is still in registers.
SAGI_INLINE slabs slabs_now(const sagi_ray_slabs *r, const sagi_plane_row *planes) {
    slabs s;
    sagi_f4s_spread3(r->near_scale, s.near_scale), sagi_f4s_spread3(r->near_back, s.near_back);
    sagi_f4s_spread3(r->far_scale, s.far_scale), sagi_f4s_spread3(r->far_back, s.far_back);
    s.planes = *planes;
    s.from = sagi_same_fill(r->from);
    return s;
}

// Where the ray enters and leaves each child's slab of one coordinate, of the node so many bytes after the
// first one.
SAGI_INLINE sagi_f8 entry(size_t node, const slabs *r, int k) {
    return sagi_f8_fms(sagi_f8_load(r->planes.near_plane[k] + node), sagi_f8_of_same(r->near_scale[k]),
                       sagi_f8_of_same(r->near_back[k]));
}
SAGI_INLINE sagi_f8 way_out(size_t node, const slabs *r, int k) {
    return sagi_f8_fms(sagi_f8_load(r->planes.far_plane[k] + node), sagi_f8_of_same(r->far_scale[k]),
                       sagi_f8_of_same(r->far_back[k]));
}

// The later of two times of which one is neither negative nor −0, and the sooner of two of any sign, by their
// bits as whole numbers: those of negative times are below all others, and not negative ones are in order. So
// it is known whether the sooner one is negative, if not by how much, which is all that is asked of an exit:
// the child is missed then. As it is where the exit is −0, rightly: a true exit at 0 is overstated (ray.h)
// and comes out positive. This is the chain of dependent instructions that a walk waits for, and whole
// numbers take half the time.
SAGI_INLINE sagi_f8 later_of(sagi_f8 a, sagi_f8 b) {
    return (sagi_f8)sagi_i8_max(sagi_f8_bits(a), sagi_f8_bits(b));
}
SAGI_INLINE sagi_f8 sooner_of(sagi_f8 a, sagi_f8 b) {
    return (sagi_f8)sagi_i8_min(sagi_f8_bits(a), sagi_f8_bits(b));
}

// Where it comes to each child, and where it leaves it or passes `limit`, or anything negative where it has
// missed it. (Of two entries that are both negative it is not the later one that is handed on, and no matter:
// r->from is last.)
SAGI_INLINE sagi_f8 begins_of(size_t node, const slabs *r) {
    return later_of(later_of(entry(node, r, 0), entry(node, r, 1)),
                    later_of(entry(node, r, 2), sagi_f8_of_same(r->from)));
}
SAGI_INLINE sagi_f8 ends_of(size_t node, const slabs *r, float limit) {
    return sooner_of(sooner_of(way_out(node, r, 0), way_out(node, r, 1)),
                     sooner_of(way_out(node, r, 2), sagi_f8_fill(limit)));
}

// One step: the node's children that the ray meets before `limit`. One of them, for CLOSEST the nearest, is
// handed back; the others go on the stack, in any order. False when there is none.
//
// A single ray waits for memory longest where it comes back to what waits. So the first and the last of what
// goes on the stack, mostly all of it, are asked for now. (Where nothing does, it is the node's first child,
// for naught; whether something does is not to be foreseen, and to guess would take longer.)
SAGI_INLINE bool step(question asked, const sagi_bvh *tree, const sagi_places *places, const slabs *r,
                      float limit, stack *waits, waiting *next) {
    const size_t at = next->child * SAGI_BVH_STEP;
    const sagi_bvh_node *node = sagi_bvh_node_at(tree, next->child);
    sagi_f8 begin = begins_of(at, r), end = ends_of(at, r, limit);
    SAGI_KERNEL_COUNT(nodes);
    // The lane's number takes the place of the last three bits of where it begins, which only moves the
    // beginning forward.
    union {
        uint32_t bits;
        float value;
    } least;
    const sagi_i8 child = sagi_i8_load(node->child);
    uint32_t mask, lane;
    const sagi_i8 order = sagi_f8_in_order(begin, end, &mask);
    if (mask == 0) return false;
    if (asked == CLOSEST) {
        least.bits = sagi_i8_least_from(order, node->child, &next->child);
        lane = least.bits & 7;
        least.bits &= ~7U;
        next->begin = least.value;
    } else {
        lane = (uint32_t)__builtin_ctz(mask);
        next->begin = begin[lane], next->child = node->child[lane];
    }
    mask &= ~(1U << lane);
    sagi_write_lanes(mask, begin, waits->begin + waits->height, child, waits->child + waits->height);
    waits->height += (size_t)__builtin_popcount(mask);
    fetch_whole(sagi_place_at(places, node->child[31 ^ __builtin_clz(mask | 1)]));
    fetch_whole(sagi_place_at(places, node->child[sagi_lowest(mask) & 7]));
    return true;
}

// What comes before the tree. False when the ray has no business there; *over when the search is over. The
// usual ray's slabs need not wait until it has been written down. `plain`: as in sagi_world.
SAGI_INLINE bool come_to_tree(question asked, bool plain, level *here, slabs *r, size_t *signs, bool *over) {
    // (Known before anything is called: fetched from *here later on, all would wait for it.)
    const sagi_world *world = here->world;
    const sag_ray *ray = here->ray;
    *over = false;
    if (!plain && world->unbounded_count != 0) {
        if (!sag_ray_is_valid(ray)) return false;
        enter_outside(here);
        if (list(asked, here, world->unbounded, world->unbounded_count)) return !(*over = true);
    }
    if (!plain && world->tree.node_count == 0) return false;
    sagi_ray_slabs now;
    const ray_state state = sagi_float_ray_begin(world, ray, asked == ANY, &here->tree_ray, &now);
    if (state == RAY_MISSES) return false;
    *signs = now.signs;
    *r = state == RAY_NOW ? slabs_now(&now, &world->planes[now.signs])
                          : slabs_at(&here->tree_ray, &world->planes[now.signs]);
    here->in_tree = true, here->lone = false;
    here->limit = here->tree_ray.limit;
    if (!plain && world->unbounded_count != 0 && here->t_max < ray->t_max) lower_t_max(here, here->t_max);
    return true;
}

// Takes the next that still matters from the stack, for CLOSEST the nearer of the two on top; false when
// there is none. (As whole numbers, beginnings are in the same order. Which of the two it is nobody can
// foresee.)
SAGI_INLINE bool pop(question asked, float limit, stack *waits, waiting *next) {
    do {
        if (waits->height == 0) return false;
        waits->height--;
        float *begin = waits->begin + waits->height;
        uint32_t *child = waits->child + waits->height;
        if (asked != CLOSEST) {
            *next = (waiting){begin[0], child[0]};
            return true;
        }
        const uint32_t a = float_bits(begin[0]), b = float_bits(begin[-1]);
        const uint32_t child_a = child[0], child_b = child[-1];
        next->begin = float_of(sagi_if_above(a, b, b, a)), begin[-1] = float_of(sagi_if_above(a, b, a, b));
        next->child = sagi_if_above(a, b, child_b, child_a);
        child[-1] = sagi_if_above(a, b, child_a, child_b);
    } while (next->begin > limit);
    return true;
}

// A leaf by a function of its own: in one with the loop, 16 registers would not do for both (32 do). And what
// a block of triangles that are all missed does not need, by further ones: so there is nothing to save here.
#ifdef SAGI_SIMD_AVX512
#define LEAF SAGI_INLINE
#else
#define LEAF static __attribute__((noinline))
#endif
static __attribute__((noinline)) bool take_several(question asked, level *here,
                                                   const sagi_triangle_block *block,
                                                   const block_answer *answer, float begin) {
    return take_triangles(asked, here, block, answer, begin);
}
static __attribute__((noinline)) bool take_apart(question asked, level *here,
                                                 const sagi_triangle_block *block, const block_answer *answer,
                                                 float begin) {
    if (asked == CLOSEST && take_only(here, block, answer, begin)) return false;
    return take_several(asked, here, block, answer, begin);
}
static __attribute__((noinline)) bool others_apart(question asked, level *here, const sagi_block *block,
                                                   float begin) {
    return other_than_triangles(asked, here, block, begin);
}
SAGI_INLINE bool leaf_of(question asked, level *here, const sagi_block *block, float begin) {
    if (block->kind != SAGI_BLOCK_TRIANGLES) return others_apart(asked, here, block, begin);
    const sagi_triangle_block *triangles = (const sagi_triangle_block *)(const void *)block;
    SAGI_KERNEL_COUNT(blocks);
    return meet_triangles(triangles, &here->tree_ray, begin, here->limit, false, &here->answer) &&
           take_apart(asked, here, triangles, &here->answer, begin);
}
LEAF bool closest_leaf(level *here, const sagi_block *block, float begin) {
    return leaf_of(CLOSEST, here, block, begin);
}
LEAF bool any_leaf(level *here, const sagi_block *block, float begin) {
    return leaf_of(ANY, here, block, begin);
}
static __attribute__((noinline)) bool all_leaf(level *here, const sagi_block *block, float begin) {
    return leaf_of(ALL, here, block, begin);
}
SAGI_INLINE bool leaf_apart(question asked, level *here, const sagi_block *block, float begin) {
    return asked == CLOSEST ? closest_leaf(here, block, begin)
           : asked == ANY   ? any_leaf(here, block, begin)
                            : all_leaf(here, block, begin);
}

// True when the search is over.
SAGI_INLINE bool walk(question asked, bool plain, level *here) {
    bool over;
    size_t signs;
    const sagi_bvh *tree = &here->world->tree;
    slabs r;
    if (!come_to_tree(asked, plain, here, &r, &signs, &over)) return over;
    const sagi_plane_row *planes = &here->world->planes[signs];
    float begin[STACK_PLACES];
    uint32_t child[STACK_PLACES];
    stack waits = empty_stack(begin, child);
    const sagi_places places = here->world->places;
    waiting next = {0, 0}; // the root
    for (;;) {
        const float limit = here->limit;
        while (!sagi_bvh_is_leaf(next.child))
            if (!step(asked, tree, &places, &r, limit, &waits, &next) && !pop(asked, limit, &waits, &next))
                goto end;
        if (leaf_apart(asked, here, sagi_leaf(tree, next.child), next.begin)) return true;
        if (!pop(asked, here->limit, &waits, &next)) break;
        r = slabs_at(&here->tree_ray, planes); // anew, so that it need not be kept meanwhile
    }
end:
    if (asked == CLOSEST && here->candidate_count > 0) settle_last(here);
    return false;
}

#include "kernel/solid.inl"

static bool walk_closest(level *here) { return walk(CLOSEST, false, here); }
static bool walk_any(level *here) { return walk(ANY, false, here); }
static bool walk_all(level *here) { return walk(ALL, false, here); }

static __attribute__((noinline)) bool walk_any_world(question asked, level *here) {
    enter_outside(here);
    if (here->world->solid != NULL) return search_solid(asked, here);
    return asked == CLOSEST ? walk_closest(here) : walk_any(here);
}

static bool intersect(const sagi_world *world, const sag_ray *ray, sag_hit *hit) {
    search s;
    level here;
    fetch_answer(hit);
    begin_search(&s, hit), enter_walk(&here, world, ray, &s);
    if (__builtin_expect(world->plain, 1))
        walk(CLOSEST, true, &here);
    else
        walk_any_world(CLOSEST, &here);
    return s.found;
}

static bool occluded(const sagi_world *world, const sag_ray *ray) {
    search s;
    level here;
    begin_search(&s, NULL), enter_walk(&here, world, ray, &s);
    return __builtin_expect(world->plain, 1) ? walk(ANY, true, &here) : walk_any_world(ANY, &here);
}

static size_t crossings(const sagi_world *world, const sag_ray *ray, bool both_sides, sag_hit *hits,
                        size_t capacity) {
    sag_hit kept[SAGI_REPEATS_KEPT];
    search s = {.collector = {hits, capacity, 0}, .both_sides = both_sides, .repeats.kept = kept};
    do {
        level here;
        enter(&here, world, ray, &s);
        if (world->solid != NULL)
            search_solid(ALL, &here);
        else
            walk_all(&here);
    } while (sagi_repeats_hand_on(&s.repeats, &s.collector));
    sagi_collector_finish(&s.collector);
    return s.collector.count;
}

static void visit(const sagi_world *world, const sag_ray *ray, const sagi_visitor *visitor) {
    search s = {.both_sides = true, .visitor = visitor};
    level here;
    enter(&here, world, ray, &s);
    if (world->solid != NULL)
        search_solid(ALL, &here);
    else
        walk_all(&here);
}

static bool begins_inside(const sagi_world *solid, const sag_ray *ray, bool *crossed) {
    search s = {.both_sides = true};
    level here;
    bool inside;
    enter(&here, solid, ray, &s);
    run_solid(ANY, &here, &inside);
    *crossed = s.found;
    return inside;
}

#include "kernel/batch.inl"

#include "kernel/write_triangles.inl"

static void mesh_surface(const sag_mesh *mesh, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    sagi_mesh_surface(mesh, ray, hit, surface);
}

const sagi_kernel SAGI_KERNEL_NAME = {intersect,      occluded,      crossings,
                                      visit,          begins_inside, intersect_batch,
                                      occluded_batch, mesh_surface,  write_triangles};
