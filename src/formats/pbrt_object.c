// SPDX-License-Identifier: MIT
// Objects of a pbrt scene: ObjectBegin "name" … ObjectEnd, and their instances.
//
// An object is a scene of its own. Within a solid an instance of it means the union of its bodies: the first
// such instance makes a second scene of the object's shapes, which is that solid, and all others use it too.
// An object that is one solid and nothing else needs no scene around it: its instances place the solid
// itself.
#include "formats/pbrt_blocks.h"
#include "formats/pbrt_solid.h"

#include <string.h>

sag_status sagi_pbrt_object_part(sagi_pbrt *p, sagi_place place, uint32_t geometry,
                                 const sag_appearance *look, sag_scene *solid) {
    void *parts = p->object_parts;
    if (!sagi_pbrt_reserve(p, &parts, &p->object_part_allocated, p->object_part_count,
                           sizeof *p->object_parts))
        return sagi_pbrt_out_of_memory(p);
    p->object_parts = parts;
    p->object_parts[p->object_part_count++] = (sagi_object_part){.solid = solid,
                                                                 .place = place,
                                                                 .geometry = geometry,
                                                                 .material = look ? look->material : 0,
                                                                 .flip = look && look->flip};
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
    object->part_count = p->object_part_count - object->part_first;
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

// Puts the geometries of an object into the open solid.
static sag_status add_parts(sagi_pbrt *p, sagi_place place, const sagi_object *object, const char *name) {
    for (size_t i = 0; i < object->part_count; i++) {
        const sagi_object_part *part = &p->object_parts[object->part_first + i];
        sag_affine placed;
        sag_shape_kind kind;
        const void *shape;
        capped copy;
        sag_status status = sag_geometry_get(object->scene, part->geometry, &kind, &shape);
        if (status == SAG_OK) status = sag_geometry_get_transform(object->scene, part->geometry, &placed);
        if (status != SAG_OK) return sagi_pbrt_out_of_memory(p);
        if (part->solid) {
            status = sagi_pbrt_solid_instance(p, part->place, part->solid, &placed);
        } else {
            const char *const wrong = sagi_pbrt_not_closed(kind, shape);
            int line, column;
            sagi_place_find(part->place, &line, &column);
            if (wrong)
                return sagi_place_error(
                    place, p->error,
                    "the object \"%.100s\" cannot be a part of a solid: its %s of line %d %s", name,
                    sag_shape_kind_name(kind), line, wrong);
            const sag_appearance look = {.material = part->material, .flip = part->flip};
            status =
                sagi_pbrt_solid_shape(p, part->place, kind, with_caps(kind, shape, &copy), &placed, &look);
        }
        if (status != SAG_OK) return status;
    }
    return SAG_OK;
}

// The union of an object's bodies, made when it is first asked for.
static sag_status make_solid(sagi_pbrt *p, sagi_place place, sagi_object *object, const char *name) {
    const sagi_solid_reader outer = p->solid;
    sagi_solid_level level = {.operation = SAG_SOLID_UNION, .place = place};
    p->solid =
        (sagi_solid_reader){.scene = sag_world_add_object(p->world), .levels = &level, .level_count = 1};
    sag_status status = p->solid.scene ? add_parts(p, place, object, name) : sagi_pbrt_out_of_memory(p);
    if (status == SAG_OK) status = sagi_pbrt_solid_step(p, SAG_SOLID_UNION, level.operand_count);
    if (status == SAG_OK) status = sagi_pbrt_solid_commit(p, place);
    if (status == SAG_OK) object->solid = p->solid.scene;
    p->solid.levels = NULL;
    sagi_pbrt_solid_clear(p);
    p->solid = outer;
    return status;
}

// The solid that an object is within solids, and how that stands in the object's space.
static sag_status solid_of(sagi_pbrt *p, sagi_place place, sagi_object *object, const char *name,
                           sag_scene **solid, sag_affine *placed) {
    const sagi_object_part *part = &p->object_parts[object->part_first];
    if (object->part_count == 0)
        return sagi_place_error(place, p->error, "the object \"%.100s\" is empty and no part for a solid",
                                name);
    if (object->part_count == 1 && part->solid) {
        *solid = part->solid;
        return sag_geometry_get_transform(object->scene, part->geometry, placed);
    }
    if (!object->solid) {
        const sag_status status = make_solid(p, place, object, name);
        if (status != SAG_OK) return status;
    }
    *solid = object->solid;
    *placed = sag_affine_identity();
    return SAG_OK;
}

sag_status sagi_pbrt_object_instance(sagi_pbrt *p, sagi_place place) {
    char name[1024];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK) return status;
    uint32_t index;
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
    const bool is_solid = object->part_count == 1 && p->object_parts[object->part_first].solid != NULL;
    sag_scene *scene = object->scene;
    sag_affine placed = sag_affine_identity();
    if (is_solid || p->solid.scene) status = solid_of(p, place, object, name, &scene, &placed);
    if (status != SAG_OK) return status;
    placed = sag_affine_multiply(&p->state.ctm, &placed);
    if (p->solid.scene) return sagi_pbrt_solid_instance(p, place, scene, &placed);
    return sag_add_instance(p->scene, scene, &placed) != SAG_INVALID_ID ? SAG_OK : sagi_pbrt_out_of_memory(p);
}
