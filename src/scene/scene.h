// SPDX-License-Identifier: MIT
// What a scene is made of.
//
// sag_scene holds the geometries as the caller describes them, and may change. A commit makes a snapshot of
// them: a world for the kernels plus what the cold queries need. Snapshots do not change; they own what they
// refer to by counting references, so removing a geometry, or giving up a scene whose snapshot is an instance
// elsewhere, takes nothing away from under a query. Snapshots refer to older snapshots only, so there are no
// cycles.
#ifndef SAGI_SCENE_SCENE_H
#define SAGI_SCENE_SCENE_H

#include "kernel/block.h"
#include "kernel/kernel.h"
#include "shapes/outline.h"
#include "shapes/sphere.h"
#include "solid/carved.h"
#include "solid/dented.h"
#include "solid/tree.h"
#include <stdatomic.h>
#include <time.h>

// A shape's description with all its arrays, in one block of memory.
typedef struct sagi_store {
    atomic_uint references;
    const sag_context *context;
    size_t bytes; // of the whole block
    const void *shape;
    const sagi_outline *outline; // NULL: it has none
    _Atomic double area;         // NAN until someone asked; every thread would find the same
    _Atomic uint8_t closedness;  // likewise: 0, or what solid_check.c says
} sagi_store;

// An array of a shape: where it is and how long. NULL: not there.
typedef struct sagi_part {
    const void *from;
    size_t bytes;
} sagi_part;
#define SAGI_MAX_PARTS 4

// The arrays of a shape; returns how many a shape of this kind has at most.
int sagi_shape_parts(sag_shape_kind kind, const void *shape, sagi_part parts[SAGI_MAX_PARTS]);

// Deep copy; NULL when memory is short.
sagi_store *sagi_store_create(const sag_context *context, sag_shape_kind kind, const void *shape);
// The same, but the arrays that the shape points to (which is not looked at) are yet to be filled in.
sagi_store *sagi_store_create_empty(const sag_context *context, sag_shape_kind kind, const void *shape);
sagi_store *sagi_store_retain(sagi_store *store);
void sagi_store_release(sagi_store *store); // NULL does nothing
// A mesh with its vertices, and normals, moved.
sagi_store *sagi_store_create_moved_mesh(const sag_context *context, const sag_mesh *mesh,
                                         const sagi_place *place);

// What a snapshot knows of one geometry besides the kernel's sagi_item.
typedef struct sagi_snapshot sagi_snapshot;
typedef struct sagi_entry {
    bool present;
    bool face_forward;
    uint64_t user_data;
    sagi_store *store;    // the description as given; NULL for an instance
    sagi_store *moved;    // a transformed mesh, else NULL
    sagi_snapshot *child; // of an instance, else NULL
    sagi_snapshot *alone; // of a mesh in a solid: a scene of nothing else, else NULL
    sagi_place place;
    bool placed;       // place is not the identity
    sag_update update; // what is expected of it
} sagi_entry;

// What is found out about many primitives.
typedef struct sagi_survey {
    sag_box3 bounds; // of the good ones
    uint64_t good, not_finite, degenerate, unbounded;
} sagi_survey;

// Geometries that share a tree (structure.h).
typedef enum sagi_group_class { SAGI_GROUP_UNCHANGING, SAGI_GROUP_SMALL, SAGI_GROUP_LARGE } sagi_group_class;
typedef struct sagi_group {
    sagi_group_class class;
    bool may_refit, is_refitted;
    uint32_t member_first, member_count; // in the snapshot's members
    sagi_survey found;
    sagi_bvh tree; // without its arrays: it is a part of the snapshot's, at these nodes and units
    uint32_t node_first, unit_first;
    uint64_t unbounded_first; // in the snapshot's unbounded
} sagi_group;

struct sagi_snapshot {
    sagi_world world;
    const sag_context *context;
    atomic_uint references;
    uint32_t count;
    sagi_item *items;              // world.items, count of them
    sagi_entry *entries;           // as many
    sagi_bvh_reference *unbounded; // world.unbounded
    sagi_group *groups;
    uint32_t *members; // ids by group
    uint32_t group_count, member_count, unbounded_capacity;
    sag_quality quality; // that the tree is built with
    sag_scene_stats stats;
    double radius;        // the largest coordinate of stats.bounds
    sagi_solid *solid;    // world.solid
    sag_box3 *part_boxes; // where each part matters
    sagi_carved *carved;  // world.carved
    sagi_dented *dented;  // world.dented
};

// A snapshot of `count` empty entries, not yet with a tree; NULL when memory is short.
sagi_snapshot *sagi_snapshot_create(const sag_context *context, uint32_t count);
sagi_snapshot *sagi_snapshot_retain(sagi_snapshot *snapshot);
void sagi_snapshot_release(sagi_snapshot *snapshot); // NULL does nothing
// Fills in the entries and items from the scene's geometries (commit.c).
sag_status sagi_snapshot_fill(sagi_snapshot *snapshot, const sag_scene *scene, sag_error *error);
// Fills in tree, bounds and counts from the entries, taking over what it can from the snapshot before (may be
// NULL; groups.c). SAG_ERROR_MEMORY, or SAG_ERROR_ARGUMENT for more than 2^31 primitives.
sag_status sagi_snapshot_build(sagi_snapshot *snapshot, const sagi_snapshot *before);
// Whether a geometry is where and what it was, as far as boxes go (commit.c).
bool sagi_geometry_is_as_before(const sagi_snapshot *snapshot, const sagi_snapshot *before, uint32_t id);

// Whether the geometry is a whole sphere that stands as it is described: one of SAGI_LONE_SPHERES.
static inline bool sagi_is_lone_sphere(const sagi_item *item) {
    return item->kind == SAG_SHAPE_SPHERE && item->place == NULL && sagi_sphere_is_whole(item->shape);
}
// Whether the snapshot is one of a solid.
static inline bool sagi_snapshot_is_solid(const sagi_snapshot *snapshot) { return snapshot->solid != NULL; }
// Whether a geometry bounds a volume: what is said of parts in solid.h. For ids below the count.
// (solid_check.c)
bool sagi_geometry_is_closed(const sagi_snapshot *snapshot, uint32_t id);
// SAG_OK when all geometries are; else SAG_ERROR_GEOMETRY with what is wrong with the first that is not, or
// SAG_ERROR_MEMORY.
sag_status sagi_solid_check_parts(const sagi_snapshot *snapshot, sag_error *error);

// All snapshots reached from one through instances, each once, children before parents (listing.c).
typedef struct sagi_listing {
    const sag_context *context;
    const sagi_snapshot **snapshots;
    uint32_t *slots;
    uint32_t count, capacity; // of snapshots; slots are twice as many
} sagi_listing;
// Adds a snapshot and what it shows; false when memory is short. Zero-initialised but for its context.
bool sagi_listing_add(sagi_listing *listing, const sagi_snapshot *snapshot);
uint32_t sagi_listing_find(const sagi_listing *listing, const sagi_snapshot *snapshot); // one that is there
void sagi_listing_release(sagi_listing *listing);

// A solid's tree from the steps; then, from tree and entries, the boxes of its parts and the worlds of its
// meshes (solid.c).
sag_status sagi_snapshot_set_solid(sagi_snapshot *snapshot, const sag_scene *scene, sag_error *error);
// A scene of nothing but this mesh, as it stands, yet without a tree; NULL when memory is short.
sagi_snapshot *sagi_snapshot_create_alone(const sagi_snapshot *snapshot, uint32_t id);
// Has the mesh asked through it, which then is the snapshot's.
void sagi_snapshot_take_alone(sagi_snapshot *snapshot, uint32_t id, sagi_snapshot *alone);
sag_status sagi_snapshot_measure_parts(sagi_snapshot *snapshot, const sagi_snapshot *before,
                                       sag_error *error);

// What follows from entries, units, bounds and tree: the spread, the statistics (structure.c).
void sagi_snapshot_measure(sagi_snapshot *snapshot);

// Bytes that a snapshot holds, its geometries' data not counted; and those of what it shows (snapshot.c).
size_t sagi_snapshot_table_bytes(const sagi_snapshot *snapshot);
// Fills in the statistic; false when memory is short.
bool sagi_snapshot_count_shared(sagi_snapshot *snapshot);

// The makers of leaves (leaves.c); `snapshot` has its units and items.
sagi_leaf_cost sagi_leaf_price(const void *snapshot, uint32_t geometry);
uint32_t sagi_leaf_units(const void *snapshot, uint32_t geometry, uint32_t count);
void sagi_leaf_write(const void *snapshot, const sagi_bvh_primitive *primitives, uint32_t count, void *at);

// The block of spheres of one set without a transform (sphere_leaves.c).
void sagi_sphere_leaf_write(const sagi_snapshot *snapshot, const sagi_bvh_primitive *primitives,
                            uint32_t count, sagi_block *block);

// The corners of sagi_clipper (clip.c).
bool sagi_primitive_corners(const void *snapshot, const sagi_bvh_primitive *primitive, double corner[3][3]);

// What became of a primitive on its way to the tree.
typedef enum sagi_primitive_state {
    SAGI_PRIMITIVE_GOOD,
    SAGI_PRIMITIVE_NOT_FINITE,
    SAGI_PRIMITIVE_DEGENERATE,
    SAGI_PRIMITIVE_UNBOUNDED,
    SAGI_PRIMITIVE_EMPTY, // an instance of an empty scene
} sagi_primitive_state;

// Adds a mesh's triangles [first, first + count) to the survey (mesh_boxes.c).
void sagi_mesh_survey(const sag_mesh *mesh, uint32_t first, uint32_t count, sagi_survey *survey);
// Writes the boxes of the good ones of them in the world's units; returns where the next would go. all_good:
// it is known that all are.
sagi_bvh_primitive *sagi_mesh_boxes(const sagi_world *world, uint32_t geometry, uint32_t first,
                                    uint32_t count, bool all_good, sagi_bvh_primitive *out);
// The box of a triangle.
sag_box3 sagi_corners_box(const sag_vec3 p[3]);
// The same for spheres of a set without a transform (sphere_boxes.c).
void sagi_sphere_survey(const sag_spheres *set, uint32_t first, uint32_t count, sagi_survey *survey);
sagi_bvh_primitive *sagi_sphere_boxes(const sagi_world *world, uint32_t geometry, uint32_t first,
                                      uint32_t count, sagi_bvh_primitive *out);
// A box in the world's units, rounded outward.
sagi_bvh_primitive sagi_world_primitive(const sagi_world *world, const sag_box3 *box, uint32_t geometry,
                                        uint32_t primitive);

// How many numbers a geometry's primitives have.
uint32_t sagi_shape_primitive_count(sag_shape_kind kind, const void *shape);
// How many primitives of a geometry the tree has, and the box of one in the scene's space (written when it is
// good). A part of a solid is one primitive, whatever it is.
uint32_t sagi_primitive_count(const sagi_snapshot *snapshot, uint32_t geometry);
sagi_primitive_state sagi_primitive_box(const sagi_snapshot *snapshot, uint32_t geometry, uint32_t primitive,
                                        sag_box3 *box);
// The box of a primitive whether the scene is a solid or not (a mesh's: of a triangle).
sagi_primitive_state sagi_own_box(const sagi_snapshot *snapshot, uint32_t geometry, uint32_t primitive,
                                  sag_box3 *box);

// Works out a place from its map; false when the map is singular.
bool sagi_place_make(const sag_affine *to_scene, sagi_place *place);
// Bounds of |M v|/|v| and whether they agree to rounding.
void sagi_affine_stretch(const sag_affine *a, double *least, double *most, bool *similarity);

// A surface from an object's space to the scene's; both its normals turned round (surface.c).
void sagi_surface_map(const sagi_place *place, sag_surface *surface);
void sagi_surface_turn(sag_surface *surface);

// What a scene's snapshot is reached by from the instances of it: it stays when the scene goes.
typedef struct sagi_cell {
    atomic_uint references;
    const sag_context *context;
    sagi_snapshot *current; // NULL before the first commit
    const sag_scene *owner; // NULL when it is gone
} sagi_cell;

sagi_cell *sagi_cell_retain(sagi_cell *cell);
void sagi_cell_release(sagi_cell *cell);

typedef struct sagi_geometry {
    sag_shape_kind kind;
    bool removed, disabled, face_forward, placed; // removed and disabled: not in the file it is loaded from
    sag_update update;
    uint32_t mask;
    uint64_t user_data;
    sag_affine to_scene; // when placed
    sagi_store *store;   // NULL for an instance
    sagi_cell *child;    // NULL for all else
} sagi_geometry;

struct sag_scene {
    const sag_context *context;
    const sagi_kernel *kernel;
    sagi_geometry *geometries;
    uint32_t count, capacity;
    sag_solid_step *solid_steps; // of the next commit; NULL: no solid
    uint32_t solid_step_count;
    sag_error add_error; // the first failed add since the last commit; status SAG_OK: none
    sagi_cell *cell;
    sag_quality quality; // of the next commit's tree
};

// A clock that only goes forward.
static inline double sagi_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// The current snapshot, NULL before the first commit.
static inline const sagi_snapshot *sagi_scene_snapshot(const sag_scene *scene) {
    return scene->cell->current;
}

#endif
