// SPDX-License-Identifier: MIT
// Objects of a pbrt scene: ObjectBegin "name" … ObjectEnd, and their instances.
//
// An object is a scene of its own. One that is a solid and nothing else needs no scene around it: its
// instances place the solid itself.
//
// Within a solid an instance of an object means the union of its bodies. It is written out, part by part with
// the operations of its solids: the solid that takes it in then has one tree for all, of which a ray asks the
// parts one by one, while an instance has to say at once where it begins and ends along the whole ray. For
// unions of unions of struts that is twenty times as fast. What is large is an instance all the same, of a
// solid that is made of the object when one is first asked for: so a mesh is not copied and objects of
// objects of objects do not fill the memory.
#include "formats/pbrt_blocks.h"
#include "formats/pbrt_later.h"
#include "formats/pbrt_promise.h"
#include "formats/pbrt_solid.h"

#include <string.h>

#define MAX_WRITTEN_OUT 4096  // primitives that are written out together
#define MAX_TAKEN_IN    65536 // into one solid

sag_status sagi_pbrt_object_part(sagi_pbrt *p, const sagi_part *part, size_t weight) {
    void *parts = p->object_parts;
    if (!sagi_pbrt_reserve(p, &parts, &p->object_part_allocated, p->object_part_count,
                           sizeof *p->object_parts))
        return sagi_pbrt_out_of_memory(p);
    p->object_parts = parts;
    p->object_parts[p->object_part_count++] = *part;
    sagi_object *object = &p->objects[p->object_count - 1];
    object->part_count++;
    object->weight += weight;
    return SAG_OK;
}

sag_status sagi_pbrt_object_begin(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    if (p->solid.scene)
        return sagi_place_error(place, p->error, "ObjectBegin within a solid: put it before SolidBegin");
    if (p->in_object) return sagi_place_error(place, p->error, "ObjectBegin within an object");
    const sagi_slice key = {name, strlen(name)};
    if (sagi_names_get(&p->object_names, key, NULL))
        return sagi_place_error(place, p->error, "there is an object \"%.100s\" already", name);
    if ((status = sagi_pbrt_push(p, place, SAGI_BLOCK_OBJECT)) != SAG_OK) return status;
    void *objects = p->objects;
    if (!sagi_pbrt_reserve(p, &objects, &p->object_allocated, p->object_count, sizeof *p->objects))
        return sagi_pbrt_out_of_memory(p);
    p->objects = objects;
    sag_scene *scene = sag_world_add_object(p->world);
    if (!scene || !sagi_names_set(&p->object_names, key, (uint32_t)p->object_count))
        return sagi_pbrt_out_of_memory(p);
    p->objects[p->object_count++] = (sagi_object){.scene = scene, .part_first = p->object_part_count};
    p->scene = scene;
    p->in_object = true;
    return SAG_OK;
}

sag_status sagi_pbrt_object_end(sagi_pbrt *p, sagi_place place) {
    sag_status status = sagi_pbrt_pop(p, place, SAGI_BLOCK_OBJECT);
    if (status != SAG_OK) return status;
    sagi_object *object = &p->objects[p->object_count - 1];
    sagi_pbrt_commit_later(p, place, (uint32_t)(p->object_count - 1), &status);
    if (status != SAG_OK) return status;
    status = sag_scene_commit(object->scene, p->error);
    if (status != SAG_OK) {
        char message[sizeof p->error->message];
        memcpy(message, p->error->message, sizeof message);
        sagi_place_error(place, p->error, "the object cannot be built: %.400s", message);
        return p->error->status = status;
    }
    object->committed = true;
    p->in_object = false;
    p->scene = sag_world_scene(p->world);
    return SAG_OK;
}

// ---- as a solid

typedef union capped {
    sag_cylinder cylinder;
    sag_cone cone;
    sag_paraboloid paraboloid;
    sag_hyperboloid hyperboloid;
    sag_hyperboloid2 hyperboloid2;
} capped;

// The shape with its caps, in *copy, where it has such; else the shape itself.
static const void *with_caps(sag_shape_kind kind, const void *shape, capped *copy) {
#define CAP(name) (copy->name = *(const sag_##name *)shape, copy->name.closed = true, copy)
    if (kind == SAG_SHAPE_CYLINDER) return CAP(cylinder);
    if (kind == SAG_SHAPE_CONE) return CAP(cone);
    if (kind == SAG_SHAPE_PARABOLOID) return CAP(paraboloid);
    if (kind == SAG_SHAPE_HYPERBOLOID) return CAP(hyperboloid);
    if (kind == SAG_SHAPE_HYPERBOLOID2) return CAP(hyperboloid2);
#undef CAP
    return shape;
}

static bool fits(const sagi_pbrt *p, size_t weight) {
    return weight <= MAX_WRITTEN_OUT && p->solid.part_count + weight <= MAX_TAKEN_IN;
}

// Where a geometry of a finished scene stands when the scene is placed; `map` NULL: as it is.
static sag_status placed_by(const sag_scene *scene, uint32_t geometry, const sag_affine *map,
                            sag_affine *placed) {
    const sag_status status = sag_geometry_get_transform(scene, geometry, placed);
    if (status == SAG_OK && map) *placed = sag_affine_multiply(map, placed);
    return status;
}

static sag_status add_shape(sagi_pbrt *p, const sag_scene *scene, const sagi_part *part,
                            const sag_affine *placed) {
    sag_shape_kind kind;
    const void *shape;
    capped copy;
    const sag_status status = sag_geometry_get(scene, part->geometry, &kind, &shape);
    if (status != SAG_OK) return status;
    return sagi_pbrt_solid_shape(p, part->place, kind, with_caps(kind, shape, &copy), placed, &part->look);
}

// A solid as an operand: its parts and operations become the open one's, or it is an instance.
static sag_status add_solid(sagi_pbrt *p, sagi_place place, uint32_t index, const sag_affine *map) {
    const sagi_solid *solid = &p->solids[index];
    if (!fits(p, solid->weight)) return sagi_pbrt_solid_instance(p, place, index, map);
    const sag_solid tree = sag_scene_get_solid(solid->scene);
    sag_status status = SAG_OK;
    for (uint32_t i = 0; i < tree.step_count && status == SAG_OK; i++) {
        const sag_solid_step *step = &tree.steps[i];
        if (step->operation != SAG_SOLID_PART) {
            status = sagi_pbrt_solid_step(p, step->operation, step->number);
            continue;
        }
        const sagi_part *part = &p->solid_parts[solid->part_first + step->number];
        sag_affine placed;
        status = placed_by(solid->scene, part->geometry, map, &placed);
        if (status != SAG_OK) break;
        status = part->solid // was too large before
                     ? sagi_pbrt_solid_instance(p, part->place, part->solid - 1, &placed)
                     : add_shape(p, solid->scene, part, &placed);
    }
    return status;
}

// The union of an object's bodies as an operand.
static sag_status add_object(sagi_pbrt *p, sagi_place place, const sagi_object *object, const char *name,
                             const sag_affine *map) {
    for (size_t i = 0; i < object->part_count; i++) {
        const sagi_part *part = &p->object_parts[object->part_first + i];
        sag_affine placed;
        sag_shape_kind kind;
        const void *shape;
        sag_status status = sag_geometry_get(object->scene, part->geometry, &kind, &shape);
        if (status == SAG_OK) status = placed_by(object->scene, part->geometry, map, &placed);
        if (status != SAG_OK) return status;
        const char *const wrong = part->solid ? NULL : sagi_pbrt_not_closed(kind, shape);
        int line, column;
        if (wrong) {
            sagi_place_find(part->place, &line, &column);
            return sagi_place_error(place, p->error,
                                    "the object \"%.100s\" cannot be a part of a solid: its %s of line %d %s",
                                    name, sag_shape_kind_name(kind), line, wrong);
        }
        status = part->solid ? add_solid(p, part->place, part->solid - 1, &placed)
                             : add_shape(p, object->scene, part, &placed);
        if (status != SAG_OK) return status;
    }
    if (object->part_count == 0)
        return sagi_place_error(place, p->error, "the object \"%.100s\" is empty and no part for a solid",
                                name);
    return sagi_pbrt_solid_step(p, SAG_SOLID_UNION, (uint32_t)object->part_count);
}

// A scene for that.
static sag_status make_solid(sagi_pbrt *p, sagi_place place, sagi_object *object, const char *name) {
    const sagi_solid_reader outer = p->solid;
    p->solid = (sagi_solid_reader){.scene = sag_world_add_object(p->world)};
    uint32_t index;
    sag_status status =
        p->solid.scene ? add_object(p, place, object, name, NULL) : sagi_pbrt_out_of_memory(p);
    if (status == SAG_OK) status = sagi_pbrt_solid_commit(p, place, &index);
    if (status == SAG_OK) object->solid = index + 1;
    sagi_pbrt_solid_clear(p);
    p->solid = outer;
    return status;
}

// The solid that is all there is in an object: index + 1, and where it stands; 0: there is more, or none.
static uint32_t only_solid(const sagi_pbrt *p, const sagi_object *object, const sag_affine *map,
                           sag_affine *placed) {
    if (object->part_count != 1) return 0;
    const sagi_part *only = &p->object_parts[object->part_first];
    if (!only->solid || placed_by(object->scene, only->geometry, map, placed) != SAG_OK) return 0;
    return only->solid;
}

// An instance as the next operand of the open solid.
static sag_status operand(sagi_pbrt *p, sagi_place place, sagi_object *object, const char *name) {
    const sag_affine *const map = &p->state.ctm;
    sag_affine placed;
    const uint32_t only = only_solid(p, object, map, &placed);
    sagi_pbrt_solid_operand(p);
    if (only) return add_solid(p, place, only - 1, &placed);
    if (fits(p, object->weight)) return add_object(p, place, object, name, map);
    const sag_status status = object->solid ? SAG_OK : make_solid(p, place, object, name);
    return status == SAG_OK ? sagi_pbrt_solid_instance(p, place, object->solid - 1, map) : status;
}

sag_status sagi_pbrt_place_object(sagi_pbrt *p, sagi_place place, const char *name, const sag_affine *map) {
    uint32_t index;
    if (!sagi_names_get(&p->object_names, (sagi_slice){name, strlen(name)}, &index))
        return sagi_place_error(place, p->error, "there is no object \"%.100s\"", name);
    sagi_object *object = &p->objects[index];
    if (!object->committed)
        return sagi_place_error(place, p->error, "the object \"%.100s\" is not finished here", name);
    if (p->solid.scene) {
        // Its meshes become parts: they have to be there.
        const sag_status status = sagi_pbrt_catch_up(p);
        return status == SAG_OK ? operand(p, place, object, name) : status;
    }
    sag_affine placed = *map;
    const uint32_t only = only_solid(p, object, map, &placed);
    sag_scene *scene = only ? p->solids[only - 1].scene : object->scene;
    return sag_add_instance(p->scene, scene, &placed) != SAG_INVALID_ID ? SAG_OK : sagi_pbrt_out_of_memory(p);
}

sag_status sagi_pbrt_object_instance(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    const sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    if (p->in_object && !p->solid.scene)
        return sagi_place_error(place, p->error, "ObjectInstance within an object");
    sag_affine inverse;
    if (!sag_affine_inverse(&p->state.ctm, &inverse))
        return sagi_place_error(place, p->error,
                                "the object \"%.100s\" cannot be placed: the transform is singular", name);
    if (!p->solid.scene && !sagi_names_get(&p->object_names, (sagi_slice){name, strlen(name)}, NULL))
        return sagi_pbrt_promise_instance(p, place, name);
    return sagi_pbrt_place_object(p, place, name, &p->state.ctm);
}
