// SPDX-License-Identifier: MIT
// A committed scene as the traversal sees it: a tree over references, and the geometries they refer to. It
// does not change once made; any number of threads read it.
#ifndef SAGI_KERNEL_WORLD_H
#define SAGI_KERNEL_WORLD_H

#include "bvh/bvh.h"
#include "math/simd.h"
#include <sagitta/scene.h>

typedef struct sagi_world sagi_world;
typedef struct sagi_solid sagi_solid;   // solid/tree.h
typedef struct sagi_carved sagi_carved; // solid/carved.h
typedef struct sagi_dented sagi_dented; // solid/dented.h

// Where a geometry or instance stands.
typedef struct sagi_place {
    sag_affine to_scene, to_object;
    bool mirrored;                   // the determinant is negative
    bool similarity;                 // to_scene multiplies every length by the same number, up to rounding
    double stretch_min, stretch_max; // bounds of |M v|/|v|
} sagi_place;

// A geometry. Its number in sagi_world.items is its id.
typedef struct sagi_item {
    const void *shape;       // its struct; a mesh's with the vertices where they stand in the scene
    const sagi_world *child; // of an instance; of a mesh that is a part of a solid: a world of it alone
    const sagi_place *place; // NULL: the identity, and always for meshes
    const struct sagi_outline *outline; // of some closed quadrics, else NULL (shapes/outline.h)
    uint32_t mask;                      // never 0
    uint8_t kind;                       // sag_shape_kind
    bool mirrored;                      // a mesh whose transform turned its triangles' sense of rotation
} sagi_item;

// The exponent of the finest grid on which a ray that is known so well begins near every block (ray.h).
static inline int32_t sagi_finest_of(double error) { return error <= 0x1p-31 ? 26 : -1; }

// The tree's first node's planes that a ray comes to first and last, by coordinate.
typedef struct sagi_plane_row {
    const char *near_plane[3], *far_plane[3], *unused[2];
} sagi_plane_row;

// Where nodes and leaves are, in this order: where number 0 would be, and the bytes from one to the next.
typedef struct sagi_places {
    uintptr_t first[2], unit[2];
} sagi_places;
static inline const void *sagi_place_at(const sagi_places *p, uint32_t child) {
    const size_t leaf = child >> 31;
    _Static_assert(SAGI_BVH_LEAF == 1U << 31, "a leaf is told by the highest bit");
    // Numbers of leaves begin at 2³¹, so first[1] is an address of nothing: the sum is one of whole numbers.
    return (const void *)(p->first[leaf] + child * p->unit[leaf]); // NOLINT(performance-no-int-to-ptr)
}

struct sagi_world {
    sagi_d4 center, lower, upper; // the origin, and the tree's box, in doubles for ray.h
    // The origin once more; NaN where transforms may move things by more than the scene's size, which makes
    // rays go the careful way (ray.h).
    sagi_d4 quick_center;
    sagi_d4 units; // 0, scale, 1, 1: start and unit of most rays (ray.h)
    // Of a ray that begins within 64 times the scene's size of its origin (ray.h): its error, its finest
    // grid, and what its boxes are widened by, but for what depends on the distance.
    struct sagi_quick {
        double error;
        int32_t finest;
        float wide;
    } quick;
    sagi_plane_row planes[8]; // by the signs of a ray's direction
    sagi_places places;
    sagi_bvh tree; // boxes are ((p − origin) · scale), within [−1, 1]
    sag_vec3 origin;
    double scale, unit; // a power of two, and 1 over it
    const sagi_item *items;
    const sagi_bvh_reference *unbounded; // tested for every ray
    uint32_t item_count, unbounded_count;
    uint32_t instance_levels; // 0 without instances, else one more than the children's most
    bool plain;               // a tree, and nothing beside it: neither a solid nor anything unbounded
    bool has_spread;          // one of the two below is not 0
    // A ray with origin o that is brought to an object's space and back is off by at most
    // 2⁻⁵⁰ (spread_relative |o|∞ + spread_absolute) where it meets this world's boxes; both 0 when nothing
    // here has a transform (ray.h).
    double spread_relative, spread_absolute;
    const sagi_solid *solid;   // of a solid: its tree; else NULL
    const sagi_carved *carved; // of a mesh with parts cut out of it; else NULL
    const sagi_dented *dented; // of boxes and balls, when they are of that kind; else NULL
};

#endif
