// SPDX-License-Identifier: MIT
// A committed scene as bytes.
//
// A head of 64 bytes, then sections. Each section is a head of 64 bytes that says what it is, how long and
// with which checksum, then its content, then zeros up to the next multiple of 64: read or mapped as it is,
// every array is aligned as memory from sag_allocate is. Numbers stand in the byte order of the machine that
// wrote them (the head says which), arrays as they are in memory. Nothing is left unchecked: each head holds
// a checksum of itself, and what has no meaning must be 0.
//
// The scenes follow one another, children before their parents, a shared one once; the last one is the scene
// that was saved. Each scene is
//     SCENE       one sagi_file_scene
//     GEOMETRIES  a sagi_file_geometry for each id
//     ARRAY       for each geometry its arrays, in the order of sagi_shape_parts
//     SOLID       a solid's steps, a sagi_file_step each; then for each of its meshes, which are asked one by
//                 one: SCENE, UNBOUNDED, GROUPS, NODES, LEAVES of a scene of nothing but this mesh
//     UNBOUNDED   sagi_bvh_reference
//     GROUPS      a sagi_file_group for each of sagi_groups_form's
//     NODES       sagi_bvh_node
//     LEAVES      units (kernel/block.h)
// What can be worked out to the same bits is not there: inverse maps, meshes moved by their transforms.
#ifndef SAGI_SCENE_FILE_H
#define SAGI_SCENE_FILE_H

#include "scene/scene.h"

// Goes up whenever a section's content changes its meaning, nodes and leaves included.
#define SAGI_FILE_VERSION    5u
#define SAGI_FILE_MAGIC      "\x89SAG\r\n\x1a\n" // as PNG does it: shows when a file was sent as text
#define SAGI_FILE_BYTE_ORDER 0x01020304u
#define SAGI_FILE_ALIGNMENT  ((size_t)64)

typedef struct sagi_file_head {
    unsigned char magic[8];
    uint32_t byte_order, version;
    uint64_t bytes; // of the whole file
    uint32_t scene_count, zero;
    uint64_t zeros[3];
    uint64_t checksum; // of what stands before it
} sagi_file_head;
_Static_assert(sizeof(sagi_file_head) == 64, "no padding");

typedef enum sagi_file_tag {
    SAGI_FILE_SCENE = 1,
    SAGI_FILE_GEOMETRIES,
    SAGI_FILE_ARRAY,
    SAGI_FILE_UNBOUNDED,
    SAGI_FILE_GROUPS,
    SAGI_FILE_NODES,
    SAGI_FILE_LEAVES,
    SAGI_FILE_SOLID,
} sagi_file_tag;

typedef struct sagi_file_section {
    uint32_t tag, scene;
    uint32_t geometry, part;  // of an ARRAY; of a mesh's own scene the mesh, and 1; else 0
    uint64_t bytes, checksum; // of the content, without the zeros after it
    uint64_t zeros[3];
    uint64_t head_checksum; // of what stands before it
} sagi_file_section;
_Static_assert(sizeof(sagi_file_section) == 64, "no padding");

typedef struct sagi_file_scene {
    uint32_t geometry_count, group_count, unbounded_count, node_count, unit_count, leaf_count, depth, quality;
    float sah, box_lo[3], box_hi[3]; // of the tree
    uint32_t repeats;
    uint32_t step_count, zero; // of a solid
    double origin[3], scale;
    uint64_t primitive_count, dropped_not_finite, dropped_degenerate;
    double bounds_min[3], bounds_max[3];
} sagi_file_scene;
_Static_assert(sizeof(sagi_file_scene) == 176, "no padding");

// sag_solid_step.
typedef struct sagi_file_step {
    uint32_t operation, number;
} sagi_file_step;

#define SAGI_FILE_NUMBERS 16 // doubles: the most that a shape has

// What is beyond a kind's own numbers is 0.
typedef struct sagi_file_geometry {
    uint8_t present, kind, placed, face_forward;
    uint32_t mask;
    uint64_t user_data;
    uint32_t child;     // an instance's scene
    uint32_t counts[2]; // lengths of the shape's arrays
    uint8_t arrays;     // bit i: part i is there
    uint8_t wide;       // positions in double
    uint8_t flag;       // the shape's bool: closed, one_sided
    uint8_t update;
    double to_scene[12];
    double number[SAGI_FILE_NUMBERS];
} sagi_file_geometry;
_Static_assert(sizeof(sagi_file_geometry) == 256, "no padding");

// What sagi_group has of its tree and primitives.
typedef struct sagi_file_group {
    uint32_t node_first, node_count, unit_first, unit_count, leaf_count, depth;
    uint16_t is_refitted, repeats;
    float sah, box_lo[3], box_hi[3];
    uint64_t good, not_finite, degenerate, unbounded, unbounded_first;
    double bounds_min[3], bounds_max[3];
} sagi_file_group;
_Static_assert(sizeof(sagi_file_group) == 144, "no padding");

// Any shape's struct.
typedef union sagi_any_shape {
    sag_polygon polygon;
    sag_polyhedron polyhedron;
    sag_spheres spheres;
    sag_mesh mesh;
    double number[SAGI_FILE_NUMBERS];
    unsigned char bytes[192];
} sagi_any_shape;

// A shape's own numbers, without its arrays (shape_numbers.c). *g is 0 before.
void sagi_shape_encode(sag_shape_kind kind, const void *shape, sagi_file_geometry *g);
// The other way. Arrays that are there become pointers to some place that must not be looked at. False for
// what no shape of the kind says.
bool sagi_shape_decode(const sagi_file_geometry *g, sagi_any_shape *shape);

// sag_scene_read with the length the whole has to have; UINT64_MAX: not known.
sag_status sagi_scene_read(sag_context *context, sag_read_callback read, void *user, uint64_t bytes,
                           sag_scene **scene, sag_error *error);

// Bounds and boxes to numbers and back.
static inline void sagi_file_put_box(const sag_box3 *b, double min[3], double max[3]) {
    min[0] = b->min.x, min[1] = b->min.y, min[2] = b->min.z;
    max[0] = b->max.x, max[1] = b->max.y, max[2] = b->max.z;
}
static inline sag_box3 sagi_file_get_box(const double min[3], const double max[3]) {
    return (sag_box3){{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

// Whether a query of the tree stays within what is there, whatever the numbers in it say (check.c); else
// SAG_ERROR_FORMAT and a name of what is wrong, or SAG_ERROR_MEMORY and NULL. Items and entries are valid,
// and a solid's tree.
sag_status sagi_snapshot_check(const sagi_snapshot *snapshot, const char **flaw);

#endif
