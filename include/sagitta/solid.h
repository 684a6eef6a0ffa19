// SPDX-License-Identifier: MIT
/// @file solid.h
/// Solids: constructive solid geometry of closed shapes, and the intervals that a ray spends in solids.
///
/// A solid is a scene of a special kind: its geometries are the parts, and a tree of union, intersection,
/// difference and exclusive or says of which points the solid consists. It is made like any scene (add,
/// transform, commit) and placed in others with sag_add_instance, as often as wanted, under any invertible
/// map; a solid may be part of another solid in the same way.
///
///     sag_scene *die = sag_scene_create(context);
///     uint32_t box  = sag_add_box(die, &(sag_box){{-1, -1, -1}, {1, 1, 1}});
///     uint32_t ball = sag_add_sphere(die, &(sag_sphere){.radius = 1.4});
///     uint32_t pip  = sag_add_sphere(die, &(sag_sphere){.center = {0, 0, 1}, .radius = 0.2});
///     const sag_solid_step steps[] = {{SAG_SOLID_PART, box}, {SAG_SOLID_PART, ball},
///     {SAG_SOLID_INTERSECTION, 2},
///                                     {SAG_SOLID_PART, pip}, {SAG_SOLID_DIFFERENCE, 2}};
///     sag_scene_set_solid(die, &(sag_solid){steps, 5}, &error);
///     sag_scene_commit(die, &error);
///     sag_add_instance(scene, die, &where);
///
/// What rays meet of a solid is its boundary: a crossing of a part's surface where the solid begins or ends.
/// sag_hit says which part it is (geometry, primitive: those of the solid's scene; instance_path leads
/// there), and `flipped` when the solid lies on the outer side of that part's surface, as it does where a
/// difference has cut. sag_surface_at turns the normals then, so that they always point out of the solid; the
/// part's user_data, and with it its material, stays its own. All queries of scene.h speak of the boundary
/// alone, except that sag_closest_point passes solids over. The masks of parts are not looked at, that of the
/// instance is.
///
/// Coincident faces. Crossings closer to each other than 2⁻⁴⁹ of the coordinates there (t|dᵢ| + |oᵢ|), the
/// grain of double precision at that place, are taken as one: the state before the first is compared with the
/// state after the last, so that faces that coincide leave neither a sliver nor a gap, whatever part comes
/// first. The boundary there belongs to the first part, in the order of the steps, whose crossing alone would
/// have changed the solid, or where none would, to the first whose crossing does after those of the parts
/// before it. (tests/unit/test_solid.c, tests/oracle/test_solid_trees.c)
#ifndef SAGITTA_SOLID_H
#define SAGITTA_SOLID_H

#include <sagitta/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A step of a solid's description.
typedef enum sag_solid_operation {
    SAG_SOLID_PART,         ///< a geometry of the scene
    SAG_SOLID_UNION,        ///< what is in any of the operands
    SAG_SOLID_INTERSECTION, ///< what is in all of them
    SAG_SOLID_DIFFERENCE,   ///< what is in the first and in none of the others
    SAG_SOLID_XOR,          ///< what is in an odd number of them
} sag_solid_operation;

/// One step: puts a part on the stack, or takes operands from it and puts the result there.
typedef struct sag_solid_step {
    sag_solid_operation operation;
    uint32_t number; ///< of SAG_SOLID_PART: the geometry's id; else how many operands, at least 1
} sag_solid_step;

/// A tree, written operands first (reverse Polish). At the end one result is left on the stack.
typedef struct sag_solid {
    const sag_solid_step *steps;
    uint32_t step_count;
} sag_solid;

/// How deep operations may nest, once those that do not matter (a union in a union, a difference as the first
/// operand of a difference …) are taken together.
#define SAG_SOLID_MAX_DEPTH 64

/// Makes the scene a solid from the next commit on; the steps are copied. NULL: an ordinary scene again.
/// SAG_ERROR_ARGUMENT, changing nothing, for steps that are no tree, with the number of the step that is
/// wrong; SAG_ERROR_MEMORY.
///
/// The commit then fails with SAG_ERROR_GEOMETRY, naming the geometry, when a part is not closed: it must be
/// a sphere, ellipsoid, box, oriented box, polyhedron, capsule, torus, closed cylinder, cone, paraboloid,
/// hyperboloid or quadric, a plane (the half-space behind it), a mesh of which every edge has a triangle on
/// either side (an open edge is named), or an instance of a solid; all of them whole (no partial sweep). And
/// with SAG_ERROR_ARGUMENT when a geometry of the scene is no part, or twice, or a step names one that is not
/// there. A disabled part is nowhere. A spindle torus is one body with the lens in its middle: its inner
/// sheet is no boundary.
SAG_API sag_status sag_scene_set_solid(sag_scene *scene, const sag_solid *solid, sag_error *error);

/// The steps that sag_scene_set_solid was given last; none (step_count 0) for an ordinary scene. They are the
/// scene's own, there until the next such call or the scene's end.
SAG_API sag_solid sag_scene_get_solid(const sag_scene *scene);

/// An interval of a ray within one body: a geometry that is closed (as the parts of a solid have to be), a
/// sphere of a set, or a solid.
typedef struct sag_span {
    sag_hit enter; ///< where the ray enters it; when it begins inside, t = t_min and primitive =
                   ///< SAG_INVALID_ID, geometry and instance_path are the body's (a solid's has no geometry:
                   ///< SAG_INVALID_ID)
    sag_hit leave; ///< where it leaves it; when it ends inside, the same with t = t_max
} sag_span;

/// The intervals of [t_min, t_max] that the ray spends in the bodies of the scene: for mass, thickness,
/// attenuation. In order of enter.t (at equal t of the body's instance path and id); bodies that overlap have
/// intervals that do. Writes the first `capacity` of them to spans[] (which may be NULL when capacity is 0)
/// and returns how many there are in all. Geometries that are not closed have none. For a body that is a
/// solid, enter and leave name parts, mostly different ones; that both are of one body shows in the path.
///
/// Inside is where the number of crossings since t = −∞ is odd, whichever way the normals look, or for a
/// body that the ray's line comes from inside of (a half-space), even; one-sided triangles count. Crossings
/// of one body at the same t are one or, when their number is even, none: intervals have a length. Only for
/// t_min = t_max they do not: then there is one for each body that the point is in, or is just entered there.
/// No memory is asked for, whatever the number of crossings or bodies: every 192 crossings (of which those
/// before t_min are some) cost a walk through the scene. Thread-safe. (tests/unit/test_spans.c,
/// test_spans_solids.c)
SAG_API size_t sag_scene_spans(const sag_scene *scene, const sag_ray *ray, sag_span *spans, size_t capacity);

#ifdef __cplusplus
}
#endif
#endif
