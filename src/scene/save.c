// SPDX-License-Identifier: MIT
// Writing a committed scene (file.h has the layout). The scenes that instances show are listed first,
// children before parents, each once. Then everything is written twice: once to nowhere, for the head says
// how long the whole is, so that a reader can tell a cut file from a whole one before it reads.
#include "base/checksum.h"
#include "scene/file.h"
#include <string.h>

typedef struct writer {
    const sagi_listing *list;
    sag_write_callback write; // NULL: only counts
    void *user;
    uint64_t offset;
    sag_status status;
} writer;

static void put(writer *w, const void *data, size_t bytes) {
    if (w->status != SAG_OK) return;
    if (w->write != NULL && bytes > 0 && !w->write(w->user, data, bytes))
        w->status = SAG_ERROR_IO;
    else
        w->offset += bytes;
}

static void put_section(writer *w, sagi_file_section head, const void *data, size_t bytes) {
    static const unsigned char zeros[SAGI_FILE_ALIGNMENT] = {0};
    head.bytes = bytes;
    if (w->write != NULL && w->status == SAG_OK) {
        head.checksum = sagi_checksum(data, bytes);
        head.head_checksum = sagi_checksum(&head, offsetof(sagi_file_section, head_checksum));
    }
    put(w, &head, sizeof head);
    put(w, data, bytes);
    put(w, zeros, (SAGI_FILE_ALIGNMENT - bytes % SAGI_FILE_ALIGNMENT) % SAGI_FILE_ALIGNMENT);
}

static sagi_file_scene describe(const sagi_snapshot *s) {
    const sagi_bvh *t = &s->world.tree;
    sagi_file_scene d = {.geometry_count = s->count,
                         .group_count = s->group_count,
                         .unbounded_count = s->world.unbounded_count,
                         .node_count = t->node_count,
                         .unit_count = t->unit_count,
                         .leaf_count = t->leaf_count,
                         .depth = t->depth,
                         .quality = (uint32_t)s->quality,
                         .repeats = t->repeats,
                         .sah = t->sah,
                         .step_count = s->solid != NULL ? s->solid->node_count + s->solid->part_count : 0,
                         .origin = {s->world.origin.x, s->world.origin.y, s->world.origin.z},
                         .scale = s->world.scale,
                         .primitive_count = s->stats.primitive_count,
                         .dropped_not_finite = s->stats.dropped_not_finite,
                         .dropped_degenerate = s->stats.dropped_degenerate};
    memcpy(d.box_lo, t->box.lo, sizeof d.box_lo), memcpy(d.box_hi, t->box.hi, sizeof d.box_hi);
    sagi_file_put_box(&s->stats.bounds, d.bounds_min, d.bounds_max);
    return d;
}

static sagi_file_group describe_group(const sagi_group *g) {
    sagi_file_group d = {.node_first = g->node_first,
                         .node_count = g->tree.node_count,
                         .unit_first = g->unit_first,
                         .unit_count = g->tree.unit_count,
                         .leaf_count = g->tree.leaf_count,
                         .depth = g->tree.depth,
                         .is_refitted = g->is_refitted,
                         .repeats = g->tree.repeats,
                         .sah = g->tree.sah,
                         .good = g->found.good,
                         .not_finite = g->found.not_finite,
                         .degenerate = g->found.degenerate,
                         .unbounded = g->found.unbounded,
                         .unbounded_first = g->unbounded_first};
    memcpy(d.box_lo, g->tree.box.lo, sizeof d.box_lo), memcpy(d.box_hi, g->tree.box.hi, sizeof d.box_hi);
    sagi_file_put_box(&g->found.bounds, d.bounds_min, d.bounds_max);
    return d;
}

static sagi_file_geometry describe_geometry(const writer *w, const sagi_snapshot *s, uint32_t id) {
    const sagi_entry *e = &s->entries[id];
    sagi_file_geometry g;
    memset(&g, 0, sizeof g);
    if (!e->present) return g;
    g.present = 1;
    g.kind = s->items[id].kind;
    g.placed = e->placed, g.face_forward = e->face_forward;
    g.update = (uint8_t)e->update;
    g.mask = s->items[id].mask;
    g.user_data = e->user_data;
    if (e->placed) memcpy(g.to_scene, e->place.to_scene.m, sizeof g.to_scene);
    if (e->child != NULL)
        g.child = sagi_listing_find(w->list, e->child);
    else
        sagi_shape_encode((sag_shape_kind)g.kind, e->store->shape, &g);
    return g;
}

// A section of `count` entries, made in memory that is only for it; NULL: there is none, or none is needed.
static void *begin_table(writer *w, const sagi_snapshot *s, size_t bytes) {
    if (w->status != SAG_OK || w->write == NULL) return NULL;
    void *table = sag_allocate(s->context, bytes);
    if (table == NULL && bytes > 0) w->status = SAG_ERROR_MEMORY;
    return table;
}

static void put_geometries(writer *w, const sagi_snapshot *s, uint32_t number) {
    size_t bytes = s->count * sizeof(sagi_file_geometry);
    sagi_file_geometry *all = begin_table(w, s, bytes);
    for (uint32_t i = 0; i < s->count && all != NULL; i++) all[i] = describe_geometry(w, s, i);
    put_section(w, (sagi_file_section){.tag = SAGI_FILE_GEOMETRIES, .scene = number}, all, bytes);
    sag_release(s->context, all, bytes);
}

static void put_groups(writer *w, const sagi_snapshot *s, sagi_file_section head) {
    size_t bytes = s->group_count * sizeof(sagi_file_group);
    sagi_file_group *all = begin_table(w, s, bytes);
    for (uint32_t i = 0; i < s->group_count && all != NULL; i++) all[i] = describe_group(&s->groups[i]);
    head.tag = SAGI_FILE_GROUPS;
    put_section(w, head, all, bytes);
    sag_release(s->context, all, bytes);
}

// What a scene has besides its geometries.
static void put_tree(writer *w, const sagi_snapshot *s, sagi_file_section head) {
    const sagi_bvh *t = &s->world.tree;
    head.tag = SAGI_FILE_UNBOUNDED;
    put_section(w, head, s->unbounded, s->world.unbounded_count * sizeof *s->unbounded);
    put_groups(w, s, head);
    head.tag = SAGI_FILE_NODES;
    put_section(w, head, t->nodes, t->node_count * sizeof *t->nodes);
    head.tag = SAGI_FILE_LEAVES;
    put_section(w, head, t->leaves, t->unit_count * SAGI_BVH_UNIT);
}

static void put_description(writer *w, const sagi_snapshot *s, sagi_file_section head) {
    sagi_file_scene description = describe(s);
    head.tag = SAGI_FILE_SCENE;
    put_section(w, head, &description, sizeof description);
}

static void put_steps(writer *w, const sagi_snapshot *s, uint32_t number) {
    size_t count = (size_t)s->solid->node_count + s->solid->part_count,
           bytes = count * sizeof(sagi_file_step);
    sagi_file_step *all = begin_table(w, s, bytes);
    sag_solid_step *steps = begin_table(w, s, count * sizeof *steps);
    if (all != NULL && steps != NULL) {
        sagi_solid_describe(s->solid, steps);
        for (size_t i = 0; i < count; i++)
            all[i] = (sagi_file_step){(uint32_t)steps[i].operation, steps[i].number};
    }
    put_section(w, (sagi_file_section){.tag = SAGI_FILE_SOLID, .scene = number}, all, bytes);
    sag_release(s->context, all, bytes);
    sag_release(s->context, steps, count * sizeof *steps);
}

static void put_solid(writer *w, const sagi_snapshot *s, uint32_t number) {
    put_steps(w, s, number);
    for (uint32_t i = 0; i < s->count; i++) {
        if (s->entries[i].alone == NULL) continue;
        const sagi_file_section head = {.scene = number, .geometry = i, .part = 1};
        put_description(w, s->entries[i].alone, head);
        put_tree(w, s->entries[i].alone, head);
    }
}

static void put_arrays(writer *w, const sagi_snapshot *s, uint32_t number) {
    for (uint32_t i = 0; i < s->count; i++) {
        if (s->entries[i].store == NULL) continue;
        sagi_part parts[SAGI_MAX_PARTS];
        int count = sagi_shape_parts((sag_shape_kind)s->items[i].kind, s->entries[i].store->shape, parts);
        for (int k = 0; k < count; k++)
            if (parts[k].from != NULL)
                put_section(w,
                            (sagi_file_section){
                                .tag = SAGI_FILE_ARRAY, .scene = number, .geometry = i, .part = (uint32_t)k},
                            parts[k].from, parts[k].bytes);
    }
}

static void put_all(writer *w, uint64_t total) {
    sagi_file_head file = {.byte_order = SAGI_FILE_BYTE_ORDER,
                           .version = SAGI_FILE_VERSION,
                           .bytes = total,
                           .scene_count = w->list->count};
    memcpy(file.magic, SAGI_FILE_MAGIC, sizeof file.magic);
    file.checksum = sagi_checksum(&file, offsetof(sagi_file_head, checksum));
    put(w, &file, sizeof file);
    for (uint32_t i = 0; i < w->list->count && w->status == SAG_OK; i++) {
        const sagi_snapshot *s = w->list->snapshots[i];
        const sagi_file_section head = {.scene = i};
        put_description(w, s, head);
        put_geometries(w, s, i);
        put_arrays(w, s, i);
        if (s->solid != NULL) put_solid(w, s, i);
        put_tree(w, s, head);
    }
}

static sag_status check_kinds(const sagi_listing *l, sag_error *error) {
    for (uint32_t n = 0; n < l->count; n++)
        for (uint32_t i = 0; i < l->snapshots[n]->count; i++)
            if (l->snapshots[n]->entries[i].present && l->snapshots[n]->items[i].kind == SAG_SHAPE_USER)
                return sag_error_set(error, SAG_ERROR_ARGUMENT,
                                     "geometry %u is the user's own shape: callbacks cannot be saved",
                                     (unsigned)i);
    return SAG_OK;
}

sag_status sag_scene_write(const sag_scene *scene, sag_write_callback write, void *user, sag_error *error) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL) return sag_error_set(error, SAG_ERROR_STATE, "only a committed scene can be saved");
    if (write == NULL) return sag_error_set(error, SAG_ERROR_ARGUMENT, "no callback to write with");
    sagi_listing l = {.context = scene->context};
    sag_status status = SAG_OK;
    if (!sagi_listing_add(&l, s)) status = sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
    if (status == SAG_OK) status = check_kinds(&l, error);
    if (status == SAG_OK) {
        writer counting = {.list = &l};
        put_all(&counting, 0);
        writer w = {.list = &l, .write = write, .user = user};
        put_all(&w, counting.offset);
        status = w.status;
        if (status == SAG_ERROR_MEMORY) sag_error_set(error, status, "out of memory");
        if (status == SAG_ERROR_IO)
            sag_error_set(error, status, "byte %llu: could not be written", (unsigned long long)w.offset);
    }
    sagi_listing_release(&l);
    return status;
}
