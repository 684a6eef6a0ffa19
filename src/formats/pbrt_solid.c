// SPDX-License-Identifier: MIT
// SolidBegin "difference" … SolidEnd: solids of a scene file.
//
// The outermost SolidBegin opens a scene of its own; shapes and object instances up to its SolidEnd are its
// geometries, and SolidBegins within are operations of the same tree, written down in the order of their
// ends: operands first, which is what sag_scene_set_solid wants.
//
// A solid has the space in which its SolidBegin stands, as if the transform began there anew: parts that
// touch are written with small numbers, far from the world's origin too, and their faces keep coinciding.
// The instance that places the solid has the rest. A transform that is set (Identity, Transform,
// CoordSysTransform) and not multiplied means the world's space here as everywhere.
#include "formats/pbrt_solid.h"

#include "formats/pbrt_blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_whole(double phi_max_rad) { return phi_max_rad == 0 || phi_max_rad >= 2 * 3.14159265358979; }

const char *sagi_pbrt_not_closed(sag_shape_kind kind, const void *shape) {
    static const char flat[] =
        "has no inside: in a solid stand bodies, such as a thin box, or a plane for all behind it";
    static const char swept[] =
        "is only part of its sweep: in a solid it must be whole (intersect it with what "
        "shall be left of it)";
    double phi_max_rad = 0;
    switch (kind) {
    case SAG_SHAPE_DISK:
    case SAG_SHAPE_RECTANGLE:
    case SAG_SHAPE_POLYGON:
    case SAG_SHAPE_TRIANGLE:
    case SAG_SHAPE_BILINEAR_PATCH: return flat;
    case SAG_SHAPE_SPHERE: {
        const sag_sphere *s = shape;
        if (s->z_min != 0 || s->z_max != 0)
            return "is cut off by zmin or zmax and open: in a solid it must be whole (intersect it with a "
                   "box)";
        phi_max_rad = s->phi_max_rad;
        break;
    }
    case SAG_SHAPE_CYLINDER: phi_max_rad = ((const sag_cylinder *)shape)->phi_max_rad; break;
    case SAG_SHAPE_CONE: phi_max_rad = ((const sag_cone *)shape)->phi_max_rad; break;
    case SAG_SHAPE_PARABOLOID: phi_max_rad = ((const sag_paraboloid *)shape)->phi_max_rad; break;
    case SAG_SHAPE_HYPERBOLOID: phi_max_rad = ((const sag_hyperboloid *)shape)->phi_max_rad; break;
    case SAG_SHAPE_HYPERBOLOID2: phi_max_rad = ((const sag_hyperboloid2 *)shape)->phi_max_rad; break;
    case SAG_SHAPE_PLANE:
    case SAG_SHAPE_ELLIPSOID:
    case SAG_SHAPE_QUADRIC:
    case SAG_SHAPE_BOX:
    case SAG_SHAPE_ORIENTED_BOX:
    case SAG_SHAPE_POLYHEDRON:
    case SAG_SHAPE_CAPSULE:
    case SAG_SHAPE_TORUS:
    case SAG_SHAPE_SPHERES:
    case SAG_SHAPE_MESH:
    case SAG_SHAPE_USER:
    case SAG_SHAPE_INSTANCE: break;
    }
    return is_whole(phi_max_rad) ? NULL : swept;
}

void sagi_pbrt_solid_clear(sagi_pbrt *p) {
    sagi_solid_reader *s = &p->solid;
    sag_release(p->context, s->steps, s->step_allocated * sizeof *s->steps);
    sag_release(p->context, s->levels, s->level_allocated * sizeof *s->levels);
    sag_release(p->context, s->parts, s->part_allocated * sizeof *s->parts);
}

// ---- operands

sag_status sagi_pbrt_solid_step(sagi_pbrt *p, sag_solid_operation operation, uint32_t number) {
    sagi_solid_reader *s = &p->solid;
    void *steps = s->steps;
    if (!sagi_pbrt_reserve(p, &steps, &s->step_allocated, s->step_count, sizeof *s->steps))
        return sagi_pbrt_out_of_memory(p);
    s->steps = steps;
    s->steps[s->step_count++] = (sag_solid_step){operation, number};
    return SAG_OK;
}

void sagi_pbrt_solid_operand(sagi_pbrt *p) { p->solid.levels[p->solid.level_count - 1].operand_count++; }

// A geometry of the solid's scene; their ids count up from 0.
static sag_status add_part(sagi_pbrt *p, const sagi_part *part, size_t weight) {
    sagi_solid_reader *s = &p->solid;
    void *parts = s->parts;
    if (!sagi_pbrt_reserve(p, &parts, &s->part_allocated, s->part_count, sizeof *s->parts))
        return sagi_pbrt_out_of_memory(p);
    s->parts = parts;
    s->parts[s->part_count++] = *part;
    s->weight += weight;
    return sagi_pbrt_solid_step(p, SAG_SOLID_PART, part->geometry);
}

size_t sagi_pbrt_weight(sag_shape_kind kind, const void *shape) {
    if (kind == SAG_SHAPE_MESH) return ((const sag_mesh *)shape)->triangle_count;
    return kind == SAG_SHAPE_SPHERES ? ((const sag_spheres *)shape)->count : 1;
}

static sag_status add_shape(sagi_pbrt *p, sagi_place place, sag_shape_kind kind, const void *shape,
                            const sag_affine *placed, const sag_appearance *look) {
    sag_scene *scene = p->solid.scene;
    const uint32_t geometry = sag_add_shape(scene, kind, shape);
    sag_error reason = {0};
    if (geometry == SAG_INVALID_ID) { // the scene kept the reason
        if (sag_scene_commit(scene, &reason) != SAG_ERROR_GEOMETRY) return sagi_pbrt_out_of_memory(p);
        return sagi_place_error(place, p->error, "this cannot be a part of a solid: %.400s", reason.message);
    }
    sag_status status = SAG_OK;
    if (!sag_affine_is_identity(placed)) status = sag_geometry_set_transform(scene, geometry, placed);
    if (status == SAG_ERROR_GEOMETRY) return sagi_place_error(place, p->error, "the transform is singular");
    if (status == SAG_OK && !p->options->geometry_only)
        status = sag_world_set_appearance(p->world, scene, geometry, look);
    if (status != SAG_OK) return sagi_pbrt_out_of_memory(p);
    return add_part(p, &(sagi_part){.look = *look, .place = place, .geometry = geometry},
                    sagi_pbrt_weight(kind, shape));
}

// One sphere of a set; false for one that a scene drops.
static bool sphere_of(const sag_spheres *set, uint32_t i, sag_sphere *sphere) {
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = set->centers_f64 ? set->centers_f64[3 * (size_t)i + (size_t)k]
                                : (double)set->centers_f32[3 * (size_t)i + (size_t)k];
    *sphere = (sag_sphere){.center = {c[0], c[1], c[2]},
                           .radius = set->radii_f32 ? (double)set->radii_f32[i] : set->radius};
    return sag_sphere_validate(sphere, NULL) == SAG_OK;
}

static sag_status add_spheres(sagi_pbrt *p, sagi_place place, const sag_spheres *set,
                              const sag_affine *placed, const sag_appearance *look) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        sag_sphere sphere;
        if (!sphere_of(set, i, &sphere)) continue;
        const sag_status status = add_shape(p, place, SAG_SHAPE_SPHERE, &sphere, placed, look);
        if (status != SAG_OK) return status;
        count++;
    }
    if (count == 0)
        return sagi_place_error(place, p->error, "none of the spheres has a finite place and a radius");
    return sagi_pbrt_solid_step(p, SAG_SOLID_UNION, count);
}

sag_status sagi_pbrt_solid_shape(sagi_pbrt *p, sagi_place place, sag_shape_kind kind, const void *shape,
                                 const sag_affine *placed, const sag_appearance *look) {
    return kind == SAG_SHAPE_SPHERES ? add_spheres(p, place, shape, placed, look)
                                     : add_shape(p, place, kind, shape, placed, look);
}

sag_status sagi_pbrt_solid_instance(sagi_pbrt *p, sagi_place place, uint32_t solid,
                                    const sag_affine *placed) {
    const uint32_t geometry = sag_add_instance(p->solid.scene, p->solids[solid].scene, placed);
    if (geometry == SAG_INVALID_ID) return sagi_pbrt_out_of_memory(p);
    return add_part(p, &(sagi_part){.place = place, .geometry = geometry, .solid = solid + 1}, 1);
}

// ---- the scene

// The geometry that a commit's message speaks of: "geometry N …".
static bool find_geometry(const char *message, size_t count, size_t *found) {
    const char *at = strstr(message, "geometry ");
    if (!at) return false;
    char *end;
    const unsigned long number = strtoul(at + 9, &end, 10);
    *found = number;
    return end != at + 9 && number < count;
}

// The message without "step N of the solid: ", which counts what the file does not show.
static const char *without_step(const char *message) {
    const char *after = strncmp(message, "step ", 5) == 0 ? strstr(message, ": ") : NULL;
    return after ? after + 2 : message;
}

// Keeps the solid that is open for others.
static sag_status keep(sagi_pbrt *p, uint32_t *index) {
    const sagi_solid_reader *s = &p->solid;
    void *solids = p->solids;
    if (!sagi_pbrt_reserve(p, &solids, &p->solid_allocated, p->solid_count, sizeof *p->solids))
        return sagi_pbrt_out_of_memory(p);
    p->solids = solids;
    const size_t first = p->solid_part_count;
    for (size_t i = 0; i < s->part_count; i++) {
        void *parts = p->solid_parts;
        if (!sagi_pbrt_reserve(p, &parts, &p->solid_part_allocated, p->solid_part_count,
                               sizeof *p->solid_parts))
            return sagi_pbrt_out_of_memory(p);
        p->solid_parts = parts;
        p->solid_parts[p->solid_part_count++] = s->parts[i];
    }
    p->solids[p->solid_count] = (sagi_solid){
        .scene = s->scene, .part_first = first, .part_count = s->part_count, .weight = s->weight};
    *index = (uint32_t)p->solid_count++;
    return SAG_OK;
}

sag_status sagi_pbrt_solid_commit(sagi_pbrt *p, sagi_place place, uint32_t *index) {
    sagi_solid_reader *s = &p->solid;
    const sag_solid solid = {s->steps, (uint32_t)s->step_count};
    sag_error reason = {0};
    sag_status status = sag_scene_set_solid(s->scene, &solid, &reason);
    if (status == SAG_OK) status = sag_scene_commit(s->scene, &reason);
    if (status == SAG_OK) return index ? keep(p, index) : SAG_OK;
    size_t geometry;
    if (status == SAG_ERROR_GEOMETRY && find_geometry(reason.message, s->part_count, &geometry))
        sagi_place_error(s->parts[geometry].place, p->error, "this cannot be a part of a solid: %.400s",
                         reason.message);
    else
        sagi_place_error(place, p->error, "the solid cannot be built: %.400s", without_step(reason.message));
    return p->error->status = status;
}

static bool find_operation(const char *name, sag_solid_operation *operation) {
    static const struct {
        const char *name;
        sag_solid_operation operation;
    } operations[] = {{"union", SAG_SOLID_UNION},
                      {"intersection", SAG_SOLID_INTERSECTION},
                      {"difference", SAG_SOLID_DIFFERENCE},
                      {"xor", SAG_SOLID_XOR}};
    for (size_t i = 0; i < sizeof operations / sizeof *operations; i++) {
        if (strcmp(name, operations[i].name) != 0) continue;
        *operation = operations[i].operation;
        return true;
    }
    return false;
}

static sag_status open_scene(sagi_pbrt *p, sagi_place place) {
    sagi_solid_reader *s = &p->solid;
    sag_affine inverse;
    if (!sag_affine_inverse(&p->state.ctm, &inverse))
        return sagi_place_error(place, p->error, "the solid cannot be placed: the transform is singular");
    sag_scene *scene = sag_world_add_object(p->world);
    if (!scene) return sagi_pbrt_out_of_memory(p);
    s->scene = scene;
    s->outside = p->scene;
    s->to_outside = p->state.ctm;
    s->step_count = s->part_count = s->weight = 0;
    p->scene = scene;
    p->state.ctm = sag_affine_identity();
    return SAG_OK;
}

sag_status sagi_pbrt_solid_begin(sagi_pbrt *p, sagi_place place) {
    sagi_solid_reader *s = &p->solid;
    char name[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    sagi_solid_level level = {.place = place};
    if (!find_operation(name, &level.operation))
        return sagi_place_error(
            place, p->error,
            "unknown operation \"%.60s\": \"union\", \"intersection\", \"difference\" or \"xor\" expected",
            name);
    status = sagi_pbrt_push(p, place, SAGI_BLOCK_SOLID);
    if (status == SAG_OK && !s->scene) status = open_scene(p, place);
    if (status != SAG_OK) return status;
    void *levels = s->levels;
    if (!sagi_pbrt_reserve(p, &levels, &s->level_allocated, s->level_count, sizeof *s->levels))
        return sagi_pbrt_out_of_memory(p);
    s->levels = levels;
    s->levels[s->level_count++] = level;
    return SAG_OK;
}

// The whole solid has been read: builds it and places it where it belongs. Within an object the object has
// it.
static sag_status close_scene(sagi_pbrt *p, sagi_place place) {
    sagi_solid_reader *s = &p->solid;
    sag_scene *const scene = s->scene;
    uint32_t index = 0;
    p->scene = s->outside;
    sag_status status = sagi_pbrt_solid_commit(p, place, p->in_object ? &index : NULL);
    s->scene = NULL;
    if (status != SAG_OK) return status;
    const uint32_t geometry = sag_add_instance(p->scene, scene, &s->to_outside);
    if (geometry == SAG_INVALID_ID) return sagi_pbrt_out_of_memory(p);
    const sagi_part part = {.place = place, .geometry = geometry, .solid = index + 1};
    return p->in_object ? sagi_pbrt_object_part(p, &part, p->solids[index].weight) : SAG_OK;
}

sag_status sagi_pbrt_solid_end(sagi_pbrt *p, sagi_place place) {
    sagi_solid_reader *s = &p->solid;
    sag_status status = sagi_pbrt_pop(p, place, SAGI_BLOCK_SOLID);
    if (status != SAG_OK) return status;
    const sagi_solid_level level = s->levels[--s->level_count];
    if (level.operand_count == 0)
        return sagi_place_error(level.place, p->error,
                                "this solid is empty: shapes, object instances or solids expected");
    status = sagi_pbrt_solid_step(p, level.operation, level.operand_count);
    if (status != SAG_OK) return status;
    if (s->level_count == 0) return close_scene(p, level.place);
    s->levels[s->level_count - 1].operand_count++;
    return SAG_OK;
}
