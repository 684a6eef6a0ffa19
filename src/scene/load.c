// SPDX-License-Identifier: MIT
// Reading a committed scene (file.h has the layout). A file may be cut, damaged, foreign or hostile: nothing
// in it is believed. Every head and every content has to have its checksum, every length has to be what the
// numbers before it ask for and to be there, shapes go through their own validate, and the tree is looked
// over before it may be walked (check.c). What could be allocated is never more than the file's own length
// asks for.
#include "base/checksum.h"
#include "scene/reader.h"
#include "scene/structure.h"
#include "shapes/shape.h"
#include <string.h>

static sag_status get_arrays(sagi_reader *r, uint32_t scene, uint32_t id, sag_shape_kind kind,
                             const sagi_store *store) {
    sagi_part parts[SAGI_MAX_PARTS];
    int count = sagi_shape_parts(kind, store->shape, parts);
    sag_status status = SAG_OK;
    for (int k = 0; k < count && status == SAG_OK; k++)
        if (parts[k].from != NULL)
            status = sagi_reader_get(r,
                                     (sagi_file_section){.tag = SAGI_FILE_ARRAY,
                                                         .scene = scene,
                                                         .geometry = id,
                                                         .part = (uint32_t)k,
                                                         .bytes = parts[k].bytes},
                                     "a geometry's arrays", (void *)parts[k].from);
    return status;
}

static sag_status get_shape(sagi_reader *r, uint32_t scene, uint32_t id, const sagi_file_geometry *g,
                            sagi_store **store) {
    sagi_any_shape shape;
    sagi_part parts[SAGI_MAX_PARTS];
    uint64_t bytes = 0;
    sag_shape_kind kind = (sag_shape_kind)g->kind;
    if (g->kind >= SAGI_SHAPE_KIND_COUNT || !sagi_shape_decode(g, &shape))
        return sagi_reader_wrong(r, "a geometry that is none");
    for (int k = sagi_shape_parts(kind, &shape, parts); k-- > 0;)
        if (parts[k].from != NULL) bytes += parts[k].bytes;
    if (!sagi_reader_has(r, bytes)) return sagi_reader_wrong(r, "a geometry larger than the file");
    *store = sagi_store_create_empty(r->context, kind, &shape);
    if (*store == NULL) return sagi_reader_no_memory(r);
    sag_status status = get_arrays(r, scene, id, kind, *store);
    if (status != SAG_OK) return status;
    sag_error why = {0};
    if (sagi_shape_classes[kind].validate((*store)->shape, &why) == SAG_OK) return SAG_OK;
    return sag_error_set(r->error, SAG_ERROR_FORMAT, "byte %llu: geometry %u: %.400s",
                         (unsigned long long)r->offset, (unsigned)id, why.message);
}

// Into the scene's table, from where a commit makes the snapshot's entries as it always does.
static sag_status get_geometry(sagi_reader *r, uint32_t scene, uint32_t id, const sagi_file_geometry *g,
                               sagi_geometry *out) {
    sagi_place place;
    *out = (sagi_geometry){.kind = (sag_shape_kind)g->kind, .removed = !g->present, .disabled = !g->present};
    if (!g->present)
        return sagi_all_zero(g, sizeof *g) ? SAG_OK : sagi_reader_wrong(r, "an absent geometry with numbers");
    if (g->present > 1 || g->placed > 1 || g->face_forward > 1 || g->update > SAG_UPDATE_REFIT ||
        g->mask == 0)
        return sagi_reader_wrong(r, "a geometry with impossible flags");
    out->face_forward = g->face_forward, out->placed = g->placed;
    out->update = (sag_update)g->update, out->mask = g->mask, out->user_data = g->user_data;
    memcpy(out->to_scene.m, g->to_scene, sizeof g->to_scene);
    if (out->placed && !sagi_place_make(&out->to_scene, &place))
        return sagi_reader_wrong(r, "a singular transform");
    if (g->kind != SAG_SHAPE_INSTANCE) return get_shape(r, scene, id, g, &out->store);
    if (g->child >= r->count) return sagi_reader_wrong(r, "an instance of what does not come before it");
    out->child = sagi_cell_retain(r->cells[g->child]);
    return SAG_OK;
}

static sag_status get_geometries(sagi_reader *r, const sagi_file_scene *d, sag_scene *scene) {
    uint64_t bytes = (uint64_t)d->geometry_count * sizeof(sagi_file_geometry);
    if (!sagi_reader_has(r, bytes)) return sagi_reader_wrong(r, "more geometries than the file has room for");
    sagi_file_geometry *table = sag_allocate(r->context, (size_t)bytes);
    scene->geometries = sag_allocate(r->context, d->geometry_count * sizeof *scene->geometries);
    if (scene->geometries != NULL) scene->capacity = d->geometry_count;
    sag_status status = SAG_OK;
    if (d->geometry_count > 0 && (table == NULL || scene->geometries == NULL))
        status = sagi_reader_no_memory(r);
    if (status == SAG_OK)
        status = sagi_reader_get(
            r, (sagi_file_section){.tag = SAGI_FILE_GEOMETRIES, .scene = r->count, .bytes = bytes},
            "the geometries", table);
    for (uint32_t i = 0; i < d->geometry_count && status == SAG_OK; i++) {
        status = get_geometry(r, r->count, i, &table[i], &scene->geometries[i]);
        scene->count = i + 1;
    }
    sag_release(r->context, table, (size_t)bytes);
    return status;
}

static void take_description(const sagi_file_scene *d, sagi_snapshot *s) {
    sagi_bvh *t = &s->world.tree;
    s->quality = (sag_quality)d->quality;
    s->world.origin = sag_vec3_make(d->origin[0], d->origin[1], d->origin[2]);
    s->world.scale = d->scale;
    t->leaf_count = d->leaf_count, t->depth = d->depth, t->sah = d->sah, t->repeats = d->repeats != 0;
    memcpy(t->box.lo, d->box_lo, sizeof d->box_lo), memcpy(t->box.hi, d->box_hi, sizeof d->box_hi);
    s->stats.primitive_count = d->primitive_count;
    s->stats.dropped_not_finite = d->dropped_not_finite;
    s->stats.dropped_degenerate = d->dropped_degenerate;
    s->stats.bounds = sagi_file_get_box(d->bounds_min, d->bounds_max);
}

static void take_group(const sagi_file_group *d, sagi_group *g) {
    g->node_first = d->node_first, g->unit_first = d->unit_first;
    g->tree.node_count = g->tree.node_capacity = d->node_count, g->tree.unit_count = d->unit_count;
    g->tree.leaf_count = d->leaf_count, g->tree.depth = d->depth, g->tree.sah = d->sah;
    memcpy(g->tree.box.lo, d->box_lo, sizeof d->box_lo), memcpy(g->tree.box.hi, d->box_hi, sizeof d->box_hi);
    g->is_refitted = d->is_refitted != 0, g->tree.repeats = d->repeats != 0;
    g->found = (sagi_survey){.bounds = sagi_file_get_box(d->bounds_min, d->bounds_max),
                             .good = d->good,
                             .not_finite = d->not_finite,
                             .degenerate = d->degenerate,
                             .unbounded = d->unbounded};
    g->unbounded_first = d->unbounded_first;
}

// The groups follow from the geometries: as a commit forms them, or all in one.
static sag_status get_groups(sagi_reader *r, const sagi_file_scene *d, sagi_snapshot *s,
                             sagi_file_section head) {
    for (int single = s->solid != NULL; single <= 1; single++) {
        if (sagi_groups_form(s, single != 0) != SAG_OK) return sagi_reader_no_memory(r);
        if (s->group_count == d->group_count) break;
        sagi_groups_release(s);
    }
    if (s->group_count != d->group_count)
        return sagi_reader_wrong(r, "groups that do not fit the geometries");
    size_t bytes = s->group_count * sizeof(sagi_file_group);
    sagi_file_group *table = sag_allocate(r->context, bytes);
    if (table == NULL && bytes > 0) return sagi_reader_no_memory(r);
    head.tag = SAGI_FILE_GROUPS, head.bytes = bytes;
    sag_status status = sagi_reader_get(r, head, "the groups", table);
    for (uint32_t i = 0; i < s->group_count && status == SAG_OK; i++) take_group(&table[i], &s->groups[i]);
    sag_release(r->context, table, bytes);
    return status;
}

// The three arrays of the tree, straight to where they stay.
static sag_status get_tree(sagi_reader *r, const sagi_file_scene *d, sagi_snapshot *s,
                           sagi_file_section head) {
    sagi_bvh *t = &s->world.tree;
    uint64_t unbounded = (uint64_t)d->unbounded_count * sizeof *s->unbounded;
    uint64_t nodes = (uint64_t)d->node_count * sizeof *t->nodes;
    uint64_t leaves = (uint64_t)d->unit_count * SAGI_BVH_UNIT;
    if (!sagi_reader_has(r, unbounded + nodes + leaves))
        return sagi_reader_wrong(r, "a tree larger than the file");
    s->unbounded = sag_allocate(r->context, (size_t)unbounded);
    if (s->unbounded != NULL) s->unbounded_capacity = s->world.unbounded_count = d->unbounded_count;
    s->world.unbounded = s->unbounded;
    t->nodes = sag_allocate(r->context, (size_t)nodes);
    if (t->nodes != NULL) t->node_capacity = t->node_count = d->node_count;
    t->leaves = sag_allocate(r->context, (size_t)leaves);
    if (t->leaves != NULL) t->unit_count = d->unit_count;
    if ((unbounded > 0 && s->unbounded == NULL) || (nodes > 0 && t->nodes == NULL) ||
        (leaves > 0 && t->leaves == NULL))
        return sagi_reader_no_memory(r);
    head.tag = SAGI_FILE_UNBOUNDED, head.bytes = unbounded;
    sag_status status = sagi_reader_get(r, head, "the unbounded primitives", s->unbounded);
    if (status == SAG_OK) status = get_groups(r, d, s, head);
    head.tag = SAGI_FILE_NODES, head.bytes = nodes;
    if (status == SAG_OK) status = sagi_reader_get(r, head, "the tree's nodes", t->nodes);
    head.tag = SAGI_FILE_LEAVES, head.bytes = leaves;
    if (status == SAG_OK) status = sagi_reader_get(r, head, "the tree's leaves", t->leaves);
    return status;
}

sag_status sagi_load_structure(sagi_reader *r, const sagi_file_scene *d, sagi_snapshot *s,
                               sagi_file_section head) {
    take_description(d, s);
    sag_status status = get_tree(r, d, s, head);
    if (status != SAG_OK) return status;
    const char *flaw = NULL;
    status = sagi_snapshot_check(s, &flaw);
    if (status != SAG_OK) return flaw != NULL ? sagi_reader_wrong(r, flaw) : sagi_reader_no_memory(r);
    sagi_snapshot_measure(s);
    return SAG_OK;
}

// Everything of one scene; its snapshot becomes current.
static sag_status get_scene(sagi_reader *r, sag_scene *scene) {
    sagi_file_scene d;
    sagi_file_section head = {.tag = SAGI_FILE_SCENE, .scene = r->count, .bytes = sizeof d};
    sag_status status = sagi_reader_get(r, head, "a scene", &d);
    if (status != SAG_OK) return status;
    if (d.zero != 0 || sag_scene_set_quality(scene, (sag_quality)d.quality) != SAG_OK)
        return sagi_reader_wrong(r, "a quality that is none");
    status = get_geometries(r, &d, scene);
    if (status == SAG_OK && d.step_count > 0) status = sagi_load_steps(r, &d, scene);
    if (status != SAG_OK) return status;
    sagi_snapshot *s = sagi_snapshot_create(r->context, scene->count);
    if (s == NULL) return sagi_reader_no_memory(r);
    status = sagi_load_fill(r, &d, scene, s);
    scene->cell->current = s;
    if (status == SAG_OK) status = sagi_load_structure(r, &d, s, head);
    if (status != SAG_OK) return status;
    return sagi_snapshot_count_shared(s) ? SAG_OK : sagi_reader_no_memory(r);
}

static sag_status get_file_head(sagi_reader *r, uint64_t limit) {
    sagi_file_head head;
    r->bytes = sizeof head;
    sag_status status = sagi_reader_take(r, &head, sizeof head);
    r->offset = 0;
    if (status != SAG_OK) return status;
    if (memcmp(head.magic, SAGI_FILE_MAGIC, sizeof head.magic) != 0)
        return sagi_reader_wrong(r, "not a saved scene");
    if (head.byte_order != SAGI_FILE_BYTE_ORDER)
        return sagi_reader_wrong(r, "saved on a machine of another byte order");
    if (head.version != SAGI_FILE_VERSION)
        return sag_error_set(r->error, SAG_ERROR_FORMAT,
                             "saved in version %u of the format; this library reads version %u",
                             (unsigned)head.version, SAGI_FILE_VERSION);
    if (head.checksum != sagi_checksum(&head, offsetof(sagi_file_head, checksum)) || head.zero != 0 ||
        !sagi_all_zero(head.zeros, sizeof head.zeros))
        return sagi_reader_wrong(r, "damaged: the head does not have its checksum");
    if (limit != UINT64_MAX && head.bytes != limit)
        return sag_error_set(r->error, SAG_ERROR_FORMAT, "%llu bytes long instead of %llu",
                             (unsigned long long)limit, (unsigned long long)head.bytes);
    // Six sections are the least that a scene has.
    if (head.scene_count == 0 || head.bytes / (6 * sizeof(sagi_file_section)) < head.scene_count)
        return sagi_reader_wrong(r, "an impossible number of scenes");
    r->offset = sizeof head, r->bytes = head.bytes, r->scene_count = head.scene_count;
    return SAG_OK;
}

// Keeps a scene's cell, which instances in later ones share. Room grows as scenes come, not as they are
// announced.
static bool keep_cell(sagi_reader *r, sagi_cell *cell) {
    if (r->count == r->capacity) {
        uint32_t capacity = r->capacity < r->scene_count / 2 ? 2 * r->capacity + 1 : r->scene_count;
        sagi_cell **grown = sag_allocate(r->context, capacity * sizeof *grown);
        if (grown == NULL) return false;
        if (r->count > 0) memcpy(grown, r->cells, r->count * sizeof *grown);
        sag_release(r->context, r->cells, r->capacity * sizeof *grown);
        r->cells = grown, r->capacity = capacity;
    }
    r->cells[r->count++] = sagi_cell_retain(cell);
    return true;
}

static sag_status get_scenes(sagi_reader *r, sag_scene **out) {
    while (r->count < r->scene_count) {
        sag_scene *scene = sag_scene_create((sag_context *)r->context);
        sag_status status = scene != NULL ? get_scene(r, scene) : sagi_reader_no_memory(r);
        if (status == SAG_OK && r->count + 1 == r->scene_count && r->offset != r->bytes)
            status = sagi_reader_wrong(r, "the file goes on after its end");
        if (status == SAG_OK && !keep_cell(r, scene->cell)) status = sagi_reader_no_memory(r);
        if (status != SAG_OK) {
            sag_scene_destroy(scene);
            return status;
        }
        if (r->count == r->scene_count)
            *out = scene;
        else
            sag_scene_destroy(scene);
    }
    return SAG_OK;
}

sag_status sagi_scene_read(sag_context *context, sag_read_callback read, void *user, uint64_t limit,
                           sag_scene **out, sag_error *error) {
    double begin = sagi_seconds();
    sagi_reader r = {.context = context, .read = read, .user = user, .error = error};
    sag_scene *scene = NULL;
    sag_status status = get_file_head(&r, limit);
    if (status == SAG_OK) status = get_scenes(&r, &scene);
    for (uint32_t i = 0; i < r.count; i++) sagi_cell_release(r.cells[i]);
    sag_release(context, r.cells, r.capacity * sizeof *r.cells);
    if (status != SAG_OK) return status;
    scene->cell->current->stats.build_seconds = sagi_seconds() - begin;
    *out = scene;
    return SAG_OK;
}

sag_status sag_scene_read(sag_context *context, sag_read_callback read, void *user, sag_scene **scene,
                          sag_error *error) {
    return sagi_scene_read(context, read, user, UINT64_MAX, scene, error);
}
