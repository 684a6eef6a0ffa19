// SPDX-License-Identifier: MIT
// The traversal's functions for one instruction set. It is written once (kernel.inl); each kernel_<isa>.c
// includes it, is compiled with that instruction set's flags and exports one table, an empty one when it was
// compiled without them. Every kernel gives the same bits.
#ifndef SAGI_KERNEL_KERNEL_H
#define SAGI_KERNEL_KERNEL_H

#include "base/cpu.h"
#include "kernel/block.h"
#include "kernel/world.h"

// Takes the crossings of a ray as they are found: in any order, and one of a mesh perhaps several times, with
// the same bits.
typedef struct sagi_visitor {
    void (*take)(void *user, const sag_hit *hit);
    void *user;
} sagi_visitor;

typedef struct sagi_kernel {
    // The verbs of scene.h: sag_intersect, sag_occluded and sag_intersect_all. Rays that are not valid miss.
    // With both_sides what is one-sided is met from behind too, and a solid counts one or nothing and writes
    // no hits, as parity needs it.
    bool (*intersect)(const sagi_world *world, const sag_ray *ray, sag_hit *hit);
    bool (*occluded)(const sagi_world *world, const sag_ray *ray);
    size_t (*crossings)(const sagi_world *world, const sag_ray *ray, bool both_sides, sag_hit *hits,
                        size_t capacity);
    // The same from both sides, for who keeps them in another order.
    void (*visit)(const sagi_world *world, const sag_ray *ray, const sagi_visitor *visitor);
    // Whether the ray, of a solid's world, is in the solid just before its first crossing in range, or where
    // there is none, for the whole of its range. *crossed: whether there is one.
    bool (*begins_inside)(const sagi_world *solid, const sag_ray *ray, bool *crossed);
    // The first two for many rays on the calling thread: the same bits. A hit that is none has t = INFINITY
    // and geometry = SAG_INVALID_ID.
    void (*intersect_batch)(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count);
    void (*occluded_batch)(const sagi_world *world, const sag_ray *rays, bool *occluded, size_t count);
    // As sag_mesh_surface, of a mesh that is valid and a primitive that it has.
    void (*mesh_surface)(const sag_mesh *mesh, const sag_ray *ray, const sag_hit *hit, sag_surface *surface);
    // A block of 1 to 8 triangles of one mesh; world has its units and items, *block is 0.
    void (*write_triangles)(const sagi_world *world, const sagi_bvh_primitive *primitives, uint32_t count,
                            sagi_triangle_block *block);
} sagi_kernel;

extern const sagi_kernel sagi_kernel_portable, sagi_kernel_sse42, sagi_kernel_avx2, sagi_kernel_avx512,
    sagi_kernel_neon;

// The kernel for an instruction set; the portable one where there is none of its own.
const sagi_kernel *sagi_kernel_pick(sagi_isa isa);

// The order of hits: by t, instance path, geometry, primitive. A path comes before those it begins.
bool sagi_hit_before(const sag_hit *a, const sag_hit *b);
// The order of the paths alone: negative, 0 or positive.
int sagi_hit_compare_paths(const sag_hit *a, const sag_hit *b);

// The first `capacity` hits, in order, of any number that come in any order, in the caller's array: a heap
// with the last of them on top.
typedef struct sagi_collector {
    sag_hit *hits;
    size_t capacity, count; // count: all that came
} sagi_collector;

// Crossings that a tree with repeats (bvh/bvh.h) may report several times: each is to count once, and a query
// asks for no memory. The first few after `last` are kept; sorted, those that are the same stand together.
// When more came than were kept, the tree is walked again for those beyond.
#define SAGI_REPEATS_KEPT 128
typedef struct sagi_repeats {
    bool again;    // not the first walk: nothing else is to be collected
    sag_hit last;  // then: of those that are counted
    size_t count;  // that came in this walk, and where they are: the rest is as in sagi_collector
    sag_hit *kept; // SAGI_REPEATS_KEPT of them
} sagi_repeats;

// Takes a crossing, by a primitive that a ray crosses once at most.
void sagi_repeats_add(sagi_repeats *repeats, const sag_hit *hit);
// After a walk: hands on what came, each crossing once. True when another walk is needed.
bool sagi_repeats_hand_on(sagi_repeats *repeats, sagi_collector *collector);

void sagi_collector_add(sagi_collector *collector, const sag_hit *hit);
// Sorts what was kept.
void sagi_collector_finish(sagi_collector *collector);

#endif
