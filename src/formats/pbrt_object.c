// SPDX-License-Identifier: MIT
// Objects of a pbrt scene: ObjectBegin "name" … ObjectEnd, and their instances.
//
// An object is a scene of its own. Within a solid an instance of it means the union of its bodies: the first
// such instance makes a second scene of the object's shapes, which is that solid. An object that is one solid
// and nothing else needs no scene around it: its instances place the solid itself.
//
// Within a solid, a solid that is not large is written out, part by part, with its operations: the solid that
// takes it in then has one tree for all, of which a ray asks the parts one by one, while an instance has to
// say at once where it begins and ends along the whole ray. For unions of unions of struts that is twenty
// times as fast. Large ones are instances, so that a mesh is not copied and objects of objects of objects do
// not fill the memory.
#include "formats/pbrt_blocks.h"
#include "formats/pbrt_solid.h"

#include <string.h>

#define MAX_WRITTEN_OUT 4096  // the weight of a solid up to which it is
#define MAX_PARTS       65536 // of the solid that takes it in

sag_status sagi_pbrt_object_part(sagi_pbrt *p, sagi_place place, uint32_t geometry,
                                 const sag_appearance *look, uint32_t solid) {
    void *parts = p->object_parts;
    if (!sagi_pbrt_reserve(p, &parts, &p->object_part_allocated, p->object_part_count,
                           sizeof *p->object_parts))
        return sagi_pbrt_out_of_memory(p);
    p->object_parts = parts;
    sagi_part *part = &p->object_parts[p->object_part_count++];
    *part = (sagi_part){.place = place, .geometry = geometry, .solid = solid};
    if (look) part->look = *look;
    p->objects[p->object_count - 1].part_count++;
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

// A geometry of a finished scene, object or solid, put into the open solid.
static sag_status add_part(sagi_pbrt *p, const sag_scene *scene, const sagi_part *part,
                           const sag_affine *map) {
    sag_affine placed;
    sag_shape_kind kind;
    const void *shape;
    capped copy;
    sag_status status = sag_geometry_get(scene, part->geometry, &kind, &shape);
    if (status == SAG_OK) status = sag_geometry_get_transform(scene, part->geometry, &placed);
    if (status != SAG_OK) return sagi_pbrt_out_of_memory(p);
    if (map) placed = sag_affine_multiply(map, &placed);
    return part->solid ? sagi_pbrt_solid_instance(p, part->place, part->solid - 1, &placed)
                       : sagi_pbrt_solid_shape(p, part->place, kind, with_caps(kind, shape, &copy), &placed,
                                               &part->look);
}

// A solid's parts and operations become the open one's.
static sag_status write_out(sagi_pbrt *p, const sagi_solid *solid, const sag_affine *map) {
    const sag_solid tree = sag_scene_get_solid(solid->scene);
    sag_status status = SAG_OK;
    for (uint32_t i = 0; i < tree.step_count && status == SAG_OK; i++) {
        const sag_solid_step *step = &tree.steps[i];
        status = step->operation == SAG_SOLID_PART
                     ? add_part(p, solid->scene, &p->solid_parts[solid->part_first + step->number], map)
                     : sagi_pbrt_solid_step(p, step->operation, step->number);
    }
    return status;
}

// Puts the geometries of an object into the open solid.
static sag_status add_parts(sagi_pbrt *p, sagi_place place, const sagi_object *object, const char *name) {
    sag_status status = SAG_OK;
    for (size_t i = 0; i < object->part_count && status == SAG_OK; i++) {
        const sagi_part *part = &p->object_parts[object->part_first + i];
        sag_shape_kind kind;
        const void *shape;
        if (sag_geometry_get(object->scene, part->geometry, &kind, &shape) != SAG_OK)
            return sagi_pbrt_out_of_memory(p);
        const char *const wrong = part->solid ? NULL : sagi_pbrt_not_closed(kind, shape);
        int line, column;
        sagi_place_find(part->place, &line, &column);
        if (wrong)
            return sagi_place_error(place, p->error,
                                    "the object \"%.100s\" cannot be a part of a solid: its %s of line %d %s",
                                    name, sag_shape_kind_name(kind), line, wrong);
        sagi_pbrt_solid_operand(p);
        status = add_part(p, object->scene, part, NULL);
    }
    return status;
}

// The union of an object's bodies, made when it is first asked for.
static sag_status make_solid(sagi_pbrt *p, sagi_place place, sagi_object *object, const char *name) {
    const sagi_solid_reader outer = p->solid;
    sagi_solid_level level = {.operation = SAG_SOLID_UNION, .place = place};
    p->solid =
        (sagi_solid_reader){.scene = sag_world_add_object(p->world), .levels = &level, .level_count = 1};
    uint32_t index;
    sag_status status = p->solid.scene ? add_parts(p, place, object, name) : sagi_pbrt_out_of_memory(p);
    if (status == SAG_OK) status = sagi_pbrt_solid_step(p, SAG_SOLID_UNION, level.operand_count);
    if (status == SAG_OK) status = sagi_pbrt_solid_commit(p, place, &index);
    if (status == SAG_OK) object->solid = index + 1;
    p->solid.levels = NULL;
    sagi_pbrt_solid_clear(p);
    p->solid = outer;
    return status;
}

// The solid that an object is within solids, and how that stands in the object's space.
static sag_status solid_of(sagi_pbrt *p, sagi_place place, sagi_object *object, const char *name,
                           uint32_t *solid, sag_affine *placed) {
    const sagi_part *part = &p->object_parts[object->part_first];
    if (object->part_count == 0)
        return sagi_place_error(place, p->error, "the object \"%.100s\" is empty and no part for a solid",
                                name);
    if (object->part_count == 1 && part->solid) {
        *solid = part->solid - 1;
        return sag_geometry_get_transform(object->scene, part->geometry, placed);
    }
    if (!object->solid) {
        const sag_status status = make_solid(p, place, object, name);
        if (status != SAG_OK) return status;
    }
    *solid = object->solid - 1;
    *placed = sag_affine_identity();
    return SAG_OK;
}

sag_status sagi_pbrt_object_instance(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    uint32_t index, solid = 0;
    if (p->in_object && !p->solid.scene)
        return sagi_place_error(place, p->error, "ObjectInstance within an object");
    if (!sagi_names_get(&p->object_names, (sagi_slice){name, strlen(name)}, &index))
        return sagi_place_error(place, p->error, "there is no object \"%.100s\"", name);
    sagi_object *object = &p->objects[index];
    if (!object->committed)
        return sagi_place_error(place, p->error, "the object \"%.100s\" is not finished here", name);
    sag_affine inverse;
    if (!sag_affine_inverse(&p->state.ctm, &inverse))
        return sagi_place_error(place, p->error,
                                "the object \"%.100s\" cannot be placed: the transform is singular", name);
    const bool is_solid = object->part_count == 1 && p->object_parts[object->part_first].solid != 0;
    sag_affine placed = sag_affine_identity();
    if (is_solid || p->solid.scene) status = solid_of(p, place, object, name, &solid, &placed);
    if (status != SAG_OK) return status;
    placed = sag_affine_multiply(&p->state.ctm, &placed);
    if (p->solid.scene) {
        const sagi_solid *it = &p->solids[solid];
        sagi_pbrt_solid_operand(p);
        return it->weight <= MAX_WRITTEN_OUT && p->solid.part_count + it->part_count <= MAX_PARTS
                   ? write_out(p, it, &placed)
                   : sagi_pbrt_solid_instance(p, place, solid, &placed);
    }
    sag_scene *scene = is_solid ? p->solids[solid].scene : object->scene;
    return sag_add_instance(p->scene, scene, &placed) != SAG_INVALID_ID ? SAG_OK : sagi_pbrt_out_of_memory(p);
}
