// SPDX-License-Identifier: MIT
// Scenes that are solids: their description, and what a commit makes of it: the tree (solid/tree.h), a box
// for each part that says where it matters, and for each mesh a world of its own. (The kernel asks a mesh
// for its next crossing after the last; the other shapes hand out all of theirs at once.)
#include "scene/scene.h"
#include <string.h>

sag_status sag_scene_set_solid(sag_scene *scene, const sag_solid *solid, sag_error *error) {
    sag_solid_step *steps = NULL;
    uint32_t count = 0;
    if (solid != NULL) {
        if (solid->steps == NULL) return sag_error_set(error, SAG_ERROR_ARGUMENT, "a solid without steps");
        sag_status status = sagi_solid_compile(scene->context, solid, 0, NULL, error);
        if (status != SAG_OK) return status;
        size_t bytes = solid->step_count * sizeof *solid->steps;
        steps = sag_allocate(scene->context, bytes);
        if (steps == NULL) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for a solid");
        memcpy(steps, solid->steps, bytes);
        count = solid->step_count;
    }
    sag_release(scene->context, scene->solid_steps, scene->solid_step_count * sizeof *scene->solid_steps);
    scene->solid_steps = steps, scene->solid_step_count = count;
    return SAG_OK;
}

sag_solid sag_scene_get_solid(const sag_scene *scene) {
    return (sag_solid){scene->solid_steps, scene->solid_step_count};
}

sag_status sagi_snapshot_set_solid(sagi_snapshot *s, const sag_scene *scene, sag_error *error) {
    const sag_solid steps = sag_scene_get_solid(scene);
    sag_status status = sagi_solid_compile(s->context, &steps, scene->count, &s->solid, error);
    if (status != SAG_OK) return status;
    s->world.solid = s->solid;
    for (uint32_t i = 0; i < scene->count; i++) {
        bool is_part = sagi_solid_part_of(s->solid)[i] != SAG_INVALID_ID;
        if (is_part && scene->geometries[i].removed && !scene->geometries[i].disabled)
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "geometry %u of the solid is not there",
                                 (unsigned)i);
        if (!is_part && !scene->geometries[i].removed)
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "geometry %u is no part of the solid",
                                 (unsigned)i);
    }
    return SAG_OK;
}

sagi_snapshot *sagi_snapshot_create_alone(const sagi_snapshot *s, uint32_t id) {
    const sagi_entry *e = &s->entries[id];
    sagi_snapshot *alone = sagi_snapshot_create(s->context, 1);
    if (alone == NULL) return NULL;
    alone->quality = s->quality;
    alone->entries[0] = (sagi_entry){
        .present = true, .store = sagi_store_retain(e->store), .moved = sagi_store_retain(e->moved)};
    alone->items[0] = s->items[id];
    alone->items[0].mask = UINT32_MAX;
    return alone;
}

void sagi_snapshot_take_alone(sagi_snapshot *s, uint32_t id, sagi_snapshot *alone) {
    s->entries[id].alone = alone;
    s->items[id].child = &alone->world;
}

static sag_status set_alone(sagi_snapshot *s, const sagi_snapshot *before, uint32_t id) {
    if (sagi_geometry_is_as_before(s, before, id) && before->entries[id].alone != NULL &&
        before->quality == s->quality) {
        sagi_snapshot_take_alone(s, id, sagi_snapshot_retain(before->entries[id].alone));
        return SAG_OK;
    }
    sagi_snapshot *alone = sagi_snapshot_create_alone(s, id);
    sag_status status = alone != NULL ? sagi_snapshot_build(alone, NULL) : SAG_ERROR_MEMORY;
    if (status == SAG_OK)
        sagi_snapshot_take_alone(s, id, alone);
    else
        sagi_snapshot_release(alone);
    return status;
}

static sag_box3 box_of(const sagi_snapshot *s, uint32_t id) {
    sag_box3 box;
    if (!s->entries[id].present) return sag_box3_empty();
    if (s->entries[id].alone != NULL) return s->entries[id].alone->stats.bounds;
    switch (sagi_own_box(s, id, 0, &box)) {
    case SAGI_PRIMITIVE_GOOD: return box;
    case SAGI_PRIMITIVE_UNBOUNDED:
        return (sag_box3){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    case SAGI_PRIMITIVE_NOT_FINITE:
    case SAGI_PRIMITIVE_DEGENERATE:
    case SAGI_PRIMITIVE_EMPTY: break;
    }
    return sag_box3_empty();
}

// What batches want to know of a mesh with cutters.
static sag_status set_carved(sagi_snapshot *s) {
    const uint32_t part = sagi_carved_part(s->solid);
    if (part == SAG_INVALID_ID) return SAG_OK;
    const uint32_t id = sagi_solid_parts(s->solid)[part].geometry;
    const sagi_item *mesh = &s->items[id];
    if (!s->entries[id].present || mesh->kind != SAG_SHAPE_MESH || mesh->child->tree.node_count == 0 ||
        mesh->child->unbounded_count > 0 || mesh->child->tree.repeats ||
        ((const sag_mesh *)mesh->shape)->one_sided)
        return SAG_OK;
    sagi_carved *carved = sag_allocate(s->context, sizeof *carved);
    if (carved == NULL) return SAG_ERROR_MEMORY;
    *carved = (sagi_carved){.geometry = id};
    bool good = true;
    for (uint32_t i = 0, count = 0; i < s->solid->part_count && good; i++) {
        const sagi_item *item = &s->items[sagi_solid_parts(s->solid)[i].geometry];
        if (i == part || sag_box3_is_empty(&s->part_boxes[i])) continue;
        const sag_sphere *ball = sagi_is_lone_sphere(item) ? item->shape : NULL;
        good = sagi_carved_add(carved, count++, &s->part_boxes[i], ball ? ball->center : (sag_vec3){0, 0, 0},
                               ball ? ball->radius : INFINITY);
    }
    if (good)
        s->world.carved = s->carved = carved;
    else
        sag_release(s->context, carved, sizeof *carved);
    return SAG_OK;
}

static bool make_dented(const sagi_snapshot *s, uint32_t node, sagi_dented *dented) {
    const sagi_solid_part *parts = sagi_solid_parts(s->solid);
    sag_box3 common = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    for (int pass = 0; pass < 3; pass++) { // where it is; the convex ones; the dents
        if (pass == 1 && !sagi_dented_begin(dented, &common)) return false;
        if (pass == 2) dented->convex_count = dented->count;
        for (uint32_t i = 0; i < s->solid->part_count; i++) {
            const uint32_t id = parts[i].geometry;
            const sagi_item *item = &s->items[id];
            const bool is_ball = sagi_is_lone_sphere(item);
            const bool convex = node == SAG_INVALID_ID ? i == 0 : parts[i].parent == node;
            if (!s->entries[id].present || item->place != NULL || (!is_ball && item->kind != SAG_SHAPE_BOX))
                return false;
            sag_box3 box = s->part_boxes[i];
            if (pass == 0 && convex) {
                if (sag_box3_is_empty(&box)) return false;
                common = box; // all of them have the same one
            } else if (pass > 0 && convex == (pass == 1) && !sag_box3_is_empty(&box)) {
                if (!is_ball)
                    box =
                        (sag_box3){((const sag_box *)item->shape)->min, ((const sag_box *)item->shape)->max};
                if (!sagi_dented_add(dented, i, &box, is_ball ? item->shape : NULL)) return false;
            }
        }
    }
    return true;
}

// What packets want to know of a few boxes and balls.
static sag_status set_dented(sagi_snapshot *s) {
    uint32_t node;
    if (!sagi_dented_tree(s->solid, &node)) return SAG_OK;
    sagi_dented *dented = sag_allocate(s->context, sizeof *dented);
    if (dented == NULL) return SAG_ERROR_MEMORY;
    if (make_dented(s, node, dented))
        s->world.dented = s->dented = dented;
    else
        sag_release(s->context, dented, sizeof *dented);
    return SAG_OK;
}

sag_status sagi_snapshot_measure_parts(sagi_snapshot *s, const sagi_snapshot *before, sag_error *error) {
    const sagi_solid *solid = s->solid;
    const sagi_solid_part *parts = sagi_solid_parts(solid);
    size_t bytes = solid->node_count * sizeof(sag_box3);
    sag_box3 *node_box = sag_allocate(s->context, bytes);
    s->part_boxes = sag_allocate(s->context, solid->part_count * sizeof *s->part_boxes);
    sag_status status = node_box != NULL && s->part_boxes != NULL ? SAG_OK : SAG_ERROR_MEMORY;
    for (uint32_t i = 0; i < solid->part_count && status == SAG_OK; i++) {
        uint32_t id = parts[i].geometry;
        const sagi_entry *e = &s->entries[id];
        if (e->present && s->items[id].kind == SAG_SHAPE_MESH && e->alone == NULL)
            status = set_alone(s, before, id);
        if (status == SAG_OK) s->part_boxes[i] = box_of(s, id);
    }
    if (status == SAG_OK) sagi_solid_clip_boxes(solid, s->part_boxes, node_box);
    sag_release(s->context, node_box, bytes);
    if (status == SAG_OK) status = set_carved(s);
    if (status == SAG_OK) status = set_dented(s);
    return status == SAG_OK ? SAG_OK : sag_error_set(error, status, "out of memory for a solid");
}
