// SPDX-License-Identifier: MIT
// Shining geometry: every primitive of every shining shape, in every instance it is seen through, is a light
// of its own, whose points can be sampled from where they are wanted.
#ifndef SAGI_RENDER_AREA_H
#define SAGI_RENDER_AREA_H

#include "light_tree.h"
#include "spherical.h"
#include "world.h"

// How the primitives of a group are sampled.
typedef enum sagi_area_kind {
    SAGI_AREA_ANY,   // by area
    SAGI_AREA_FACET, // by solid angle: spherical.c
    SAGI_AREA_PATCH, // a patch that is not flat, by its parameters
    SAGI_AREA_BALL,  // by the cone they fill, where they are balls in the world: ball.c
} sagi_area_kind;

// The primitives of one shining geometry as they are reached through certain instances: lights [first, first
// + count).
typedef struct sagi_area_group {
    const sag_scene *scene; // that the geometry is in
    const void *shape;
    sag_shape_kind shape_kind;
    sagi_area_kind kind;
    uint32_t appearance; // index
    uint32_t geometry;
    uint32_t first, count;
    bool flat;                                    // uniform density on each primitive
    bool moved;                                   // to_world is not the identity
    uint32_t depth, path[SAG_MAX_INSTANCE_DEPTH]; // of instances, outermost first
    sag_affine to_world;                          // from the shape's own space
    sag_affine outward;                           // from the scene's space to the world's; depth > 0
    sag_affine inward;                            // its inverse
    double outward_volume;                        // |det| of it
} sagi_area_group;

typedef struct sagi_area {
    uint32_t group;
    uint32_t ball;  // index; SAG_INVALID_ID: none
    double density; // 1/area; 0: cannot be sampled
} sagi_area;

// A flat light made ready in the world's space, where nothing of it changes from point to point.
typedef struct sagi_flat {
    sagi_facet facet;
    sag_vec3 normal; // unit, to the front
    sag_vec3 error;  // surface.position_error of a point worked out from the facet
    bool ready;      // else it is as if it was not here
} sagi_flat;

typedef struct sagi_ball {
    sag_vec3 center;
    double radius;
} sagi_ball;

typedef struct sagi_areas {
    const sag_world *world;
    sagi_list groups; // sagi_area_group
    sagi_list balls;  // sagi_ball
    sagi_area *areas;
    uint32_t count;
    sagi_flat *flats;   // by area; NULL: none is ready
    uint32_t *group_of; // by appearance index, of the world's own scene: the group or SAG_INVALID_ID
    uint32_t appearance_count;
    uint32_t *slots; // groups within instances by what a hit says of them: open addressing, a power of two
    uint32_t slot_count;
} sagi_areas;

// What a light needs to know of the point it shines on.
typedef struct sagi_shading_point {
    sag_vec3 position;
    sag_vec3 normal;    // on the side the path came from; 0: no surface
    bool reflects_only; // light from behind the normal is of no use
} sagi_shading_point;

// Finds all of them. The scene is committed. SAG_ERROR_MEMORY, or SAG_ERROR_ARGUMENT where there are too
// many.
sag_status sagi_areas_init(sagi_areas *areas, const sag_world *world, sag_error *error);
void sagi_areas_clear(sagi_areas *areas);
// What the tree of lights is told; intensity 0 when the light cannot be sampled.
sagi_light_bounds sagi_area_bounds(const sagi_areas *areas, uint32_t index);

// A point of the light, its normals turned to the front, and the density of the direction *wi to it. Of the
// surface that is its position with the error, its geometric normal and its primitive; where the appearance
// has textures, all. False where there is none, or none that shines this way.
bool sagi_area_sample(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec2 u,
                      sag_surface *surface, sag_vec3 *wi, double *pdf);
// A point of the light, wherever it is wanted, and its density by area; its normals are as they are
// (sagi_replace_texcoords, sagi_orient). False where there is none.
bool sagi_area_point(const sagi_areas *areas, uint32_t index, sag_vec2 u, sag_surface *surface,
                     double *density);
// Which light a hit has met; SAG_INVALID_ID: one that is not sampled, or none at all.
uint32_t sagi_area_find(const sagi_areas *areas, const sag_hit *hit, const sag_surface *surface);
// The density with which sagi_area_sample finds the hit's point, per solid angle seen from there.
double sagi_area_pdf(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec3 wi,
                     const sag_hit *hit, const sag_surface *surface);

// How much the instances' maps enlarge a small piece of surface with this unit normal in the geometry's
// scene; a surface brought from there to the world's space; the corners of a facet in it.
double sagi_area_enlargement(const sagi_area_group *group, sag_vec3 normal);
void sagi_area_map_outward(const sagi_areas *areas, const sagi_area_group *group, sag_surface *surface);
double sagi_area_of_patch(const sagi_area_group *group); // (within about 1e-3)
void sagi_area_facet(const sagi_areas *areas, uint32_t index, sagi_facet *facet);
// The surface that a ray from → wi meets at t and (u, v), the way a traced ray would find it.
void sagi_area_meet(const sagi_areas *areas, const sagi_area_group *group, uint32_t primitive, sag_vec3 from,
                    sag_vec3 wi, double t, sag_vec2 uv, sag_surface *surface);

// Makes the flat lights ready; area_flat.c. False when memory is short.
bool sagi_flats_init(sagi_areas *areas, const sag_context *context);
// Whether a facet is seen so small that it is better sampled by area.
static inline bool sagi_facet_is_far(const sagi_facet *facet, sag_vec3 from) {
    const sag_vec3 d = sag_sub(facet->middle, from);
    return 8 * facet->size2 < sag_dot(d, d);
}
// Sees the facet; false where it is better sampled by area.
bool sagi_facet_fills(const sagi_facet *facet, const sagi_shading_point *from, sagi_facet_view *view);
// As sagi_area_sample, of a light that is ready.
bool sagi_flat_sample(const sagi_areas *areas, uint32_t index, const sagi_shading_point *from, sag_vec2 u,
                      sag_surface *surface, sag_vec3 *wi, double *pdf);

static inline const sagi_area_group *sagi_area_group_of(const sagi_areas *areas, uint32_t index) {
    return (const sagi_area_group *)areas->groups.items + areas->areas[index].group;
}
static inline const sagi_appearance *sagi_area_appearance(const sagi_areas *areas, uint32_t index) {
    return (const sagi_appearance *)areas->world->appearances.items +
           sagi_area_group_of(areas, index)->appearance;
}

// Balls, seen from outside; ball.c. cone: 1 − cos of the half angle, 0 when `from` is not outside.
double sagi_ball_cone(const sagi_ball *ball, sag_vec3 from);
void sagi_ball_sample(const sagi_ball *ball, sag_vec3 from, double cone, sag_vec2 u, sag_surface *surface);
// Whether this primitive of a shape is a whole ball when it is placed, and which.
bool sagi_ball_find(sag_shape_kind kind, const void *shape, const sag_affine *place, uint32_t primitive,
                    sagi_ball *ball);

#endif
