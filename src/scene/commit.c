// SPDX-License-Identifier: MIT
// Commit: a new snapshot beside the old one, then the exchange. Whatever fails, the old one stays.
#include "scene/scene.h"
#include "shapes/shape.h"
#include <string.h>

// A user's shape is asked for its boxes anew every time.
bool sagi_geometry_is_as_before(const sagi_snapshot *s, const sagi_snapshot *before, uint32_t id) {
    if (before == NULL || id >= before->count || !before->entries[id].present) return false;
    const sagi_entry *a = &s->entries[id], *b = &before->entries[id];
    return s->items[id].kind == before->items[id].kind && s->items[id].kind != SAG_SHAPE_USER &&
           a->store == b->store && a->child == b->child && a->placed == b->placed &&
           (!a->placed || memcmp(&a->place.to_scene, &b->place.to_scene, sizeof a->place.to_scene) == 0);
}

// A mesh with a transform is moved vertex by vertex; the kernel then sees it without one.
static sag_status fill_mesh(sagi_snapshot *s, const sagi_snapshot *before, uint32_t id) {
    sagi_entry *e = &s->entries[id];
    sagi_item *item = &s->items[id];
    item->mirrored = e->placed && e->place.mirrored;
    if (!e->placed) return SAG_OK;
    e->moved = sagi_geometry_is_as_before(s, before, id)
                   ? sagi_store_retain(before->entries[id].moved)
                   : sagi_store_create_moved_mesh(s->context, e->store->shape, &e->place);
    if (e->moved == NULL) return SAG_ERROR_MEMORY;
    item->shape = e->moved->shape;
    item->place = NULL;
    s->stats.geometry_bytes += e->moved->bytes;
    return SAG_OK;
}

static sag_status fill_instance(sagi_snapshot *s, const sagi_geometry *g, sagi_entry *e, sagi_item *item,
                                sag_error *error) {
    e->child = sagi_snapshot_retain(g->child->current);
    item->child = &e->child->world;
    uint32_t levels = e->child->world.instance_levels + 1;
    if (levels > SAG_MAX_INSTANCE_DEPTH)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "instances nest %u deep, more than %d",
                             (unsigned)levels, SAG_MAX_INSTANCE_DEPTH);
    if (levels > s->world.instance_levels) s->world.instance_levels = levels;
    return SAG_OK;
}

static sag_status fill(sagi_snapshot *s, const sagi_snapshot *before, const sagi_geometry *g, uint32_t id,
                       sag_error *error) {
    sagi_entry *e = &s->entries[id];
    sagi_item *item = &s->items[id];
    e->present = true;
    e->face_forward = g->face_forward;
    e->user_data = g->user_data;
    e->store = sagi_store_retain(g->store);
    e->placed = g->placed;
    e->update = g->update;
    if (g->placed && !sagi_place_make(&g->to_scene, &e->place))
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "geometry %u: singular transform", (unsigned)id);
    item->kind = (uint8_t)g->kind;
    item->mask = g->mask != 0 ? g->mask : UINT32_MAX;
    item->shape = g->store != NULL ? g->store->shape : NULL;
    item->outline = g->store != NULL ? g->store->outline : NULL;
    item->place = g->placed ? &e->place : NULL;
    s->stats.geometry_count++;
    s->stats.geometry_bytes += g->store != NULL ? g->store->bytes : 0;
    sag_status status = SAG_OK;
    if (g->kind == SAG_SHAPE_MESH) status = fill_mesh(s, before, id);
    if (g->kind == SAG_SHAPE_INSTANCE) return fill_instance(s, g, e, item, error);
    return status == SAG_OK ? SAG_OK : sag_error_set(error, status, "out of memory");
}

sag_status sagi_snapshot_fill(sagi_snapshot *s, const sag_scene *scene, sag_error *error) {
    const sagi_snapshot *before = scene->cell->current;
    for (uint32_t i = 0; i < scene->count; i++) {
        const sagi_geometry *g = &scene->geometries[i];
        if (g->removed || g->disabled) continue;
        sag_status status = fill(s, before, g, i, error);
        if (status != SAG_OK) return status;
    }
    return SAG_OK;
}

static sag_status make(const sag_scene *scene, sagi_snapshot *s, sag_error *error) {
    sag_status status = SAG_OK;
    if (scene->solid_steps != NULL) status = sagi_snapshot_set_solid(s, scene, error);
    if (status == SAG_OK) status = sagi_snapshot_fill(s, scene, error);
    if (status == SAG_OK && s->solid != NULL)
        status = sagi_snapshot_measure_parts(s, scene->cell->current, error);
    if (status == SAG_OK && s->solid != NULL) status = sagi_solid_check_parts(s, error);
    if (status != SAG_OK) return status;
    status = sagi_snapshot_build(s, scene->cell->current);
    if (status == SAG_OK && !sagi_snapshot_count_shared(s)) status = SAG_ERROR_MEMORY;
    if (status == SAG_ERROR_ARGUMENT) return sag_error_set(error, status, "more than 2^31 primitives");
    return status == SAG_OK ? SAG_OK : sag_error_set(error, status, "out of memory while building the scene");
}

sag_status sag_scene_commit(sag_scene *scene, sag_error *error) {
    double begin = sagi_seconds();
    if (scene->add_error.status != SAG_OK) {
        sag_status status = scene->add_error.status;
        if (error != NULL) *error = scene->add_error;
        scene->add_error.status = SAG_OK;
        return status;
    }
    sagi_snapshot *s = sagi_snapshot_create(scene->context, scene->count);
    if (s == NULL) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
    s->quality = scene->quality;
    sag_status status = make(scene, s, error);
    if (status != SAG_OK) {
        sagi_snapshot_release(s);
        return status;
    }
    s->stats.build_seconds = sagi_seconds() - begin;
    sagi_snapshot_release(scene->cell->current);
    scene->cell->current = s;
    return SAG_OK;
}

// The committed data and tables, the scene's own, and the descriptions that are not (any more, or yet) the
// committed ones.
static uint64_t memory_of(const sag_scene *scene, const sagi_snapshot *s) {
    uint64_t bytes = sizeof *scene + sizeof *scene->cell + scene->capacity * sizeof *scene->geometries +
                     scene->solid_step_count * sizeof *scene->solid_steps;
    bytes += sagi_snapshot_table_bytes(s) + s->stats.geometry_bytes + s->stats.structure_bytes;
    for (uint32_t i = 0; i < scene->count; i++) {
        const sagi_store *store = scene->geometries[i].store;
        if (store != NULL && (i >= s->count || s->entries[i].store != store)) bytes += store->bytes;
    }
    return bytes;
}

void sag_scene_get_stats(const sag_scene *scene, sag_scene_stats *stats) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    *stats = s != NULL ? s->stats : (sag_scene_stats){.bounds = sag_box3_empty()};
    if (s != NULL) stats->memory_bytes = memory_of(scene, s);
}

sag_box3 sag_scene_bounds(const sag_scene *scene) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL) return sag_box3_empty();
    if (s->world.unbounded_count > 0)
        return (sag_box3){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
    return s->stats.bounds;
}
