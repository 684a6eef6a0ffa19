// SPDX-License-Identifier: MIT
// Writing a committed scene (file.h has the layout). The scenes that instances show are listed first,
// children before parents, each once. Then everything is written twice: once to nowhere, for the head says
// how long the whole is, so that a reader can tell a cut file from a whole one before it reads.
#include "base/checksum.h"
#include "scene/file.h"
#include <string.h>

// Snapshots in the order they are written in, and a table to find them in: slot = number + 1, 0 empty.
typedef struct listing {
    const sag_context *context;
    const sagi_snapshot **scenes;
    uint32_t *slots;
    uint32_t count, capacity; // of scenes; slots are twice as many
    sag_status status;
} listing;

static uint32_t *slot_of(const listing *l, const sagi_snapshot *s) {
    uint32_t mask = 2 * l->capacity - 1;
    uint64_t hash = (uint64_t)(uintptr_t)s * 0x9E3779B97F4A7C15u;
    for (uint32_t i = (uint32_t)(hash >> 32);; i++) {
        uint32_t *slot = &l->slots[i & mask];
        if (*slot == 0 || l->scenes[*slot - 1] == s) return slot;
    }
}

static void release_list(listing *l) {
    sag_release(l->context, l->scenes, l->capacity * sizeof *l->scenes);
    sag_release(l->context, l->slots, 2 * (size_t)l->capacity * sizeof *l->slots);
}

static bool grow(listing *l) {
    listing larger = *l;
    if (l->capacity > UINT32_MAX / 8) return false;
    larger.capacity = l->capacity == 0 ? 16 : 2 * l->capacity;
    larger.scenes = sag_allocate(l->context, larger.capacity * sizeof *larger.scenes);
    larger.slots = sag_allocate(l->context, 2 * (size_t)larger.capacity * sizeof *larger.slots);
    if (larger.scenes == NULL || larger.slots == NULL) {
        release_list(&larger);
        return false;
    }
    memset(larger.slots, 0, 2 * (size_t)larger.capacity * sizeof *larger.slots);
    for (uint32_t i = 0; i < l->count; i++) {
        larger.scenes[i] = l->scenes[i];
        *slot_of(&larger, l->scenes[i]) = i + 1;
    }
    release_list(l);
    *l = larger;
    return true;
}

// Comes back to itself for instances, SAG_MAX_INSTANCE_DEPTH deep at most.
static void list_scene(listing *l, const sagi_snapshot *s, sag_error *error) {
    if (l->status != SAG_OK || (l->count > 0 && *slot_of(l, s) != 0)) return;
    for (uint32_t i = 0; i < s->count && l->status == SAG_OK; i++) {
        if (s->entries[i].present && s->items[i].kind == SAG_SHAPE_USER)
            l->status =
                sag_error_set(error, SAG_ERROR_ARGUMENT,
                              "geometry %u is the user's own shape: callbacks cannot be saved", (unsigned)i);
        if (s->entries[i].child != NULL) list_scene(l, s->entries[i].child, error);
    }
    if (l->status != SAG_OK) return;
    if (l->count == l->capacity && !grow(l)) {
        l->status = sag_error_set(error, SAG_ERROR_MEMORY, "out of memory");
        return;
    }
    l->scenes[l->count++] = s;
    *slot_of(l, s) = l->count;
}

typedef struct writer {
    const listing *list;
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
                         .unbounded_count = s->world.unbounded_count,
                         .node_count = t->node_count,
                         .unit_count = t->unit_count,
                         .leaf_count = t->leaf_count,
                         .depth = t->depth,
                         .quality = (uint32_t)s->quality,
                         .sah = t->sah,
                         .origin = {s->world.origin.x, s->world.origin.y, s->world.origin.z},
                         .scale = s->world.scale,
                         .primitive_count = s->stats.primitive_count,
                         .dropped_not_finite = s->stats.dropped_not_finite,
                         .dropped_degenerate = s->stats.dropped_degenerate};
    const sag_box3 *b = &s->stats.bounds;
    memcpy(d.box_lo, t->box.lo, sizeof d.box_lo), memcpy(d.box_hi, t->box.hi, sizeof d.box_hi);
    d.bounds_min[0] = b->min.x, d.bounds_min[1] = b->min.y, d.bounds_min[2] = b->min.z;
    d.bounds_max[0] = b->max.x, d.bounds_max[1] = b->max.y, d.bounds_max[2] = b->max.z;
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
    g.mask = s->items[id].mask;
    g.user_data = e->user_data;
    if (e->placed) memcpy(g.to_scene, e->place.to_scene.m, sizeof g.to_scene);
    if (e->child != NULL)
        g.child = *slot_of(w->list, e->child) - 1;
    else
        sagi_shape_encode((sag_shape_kind)g.kind, e->store->shape, &g);
    return g;
}

static void put_geometries(writer *w, const sagi_snapshot *s, uint32_t number) {
    size_t bytes = s->count * sizeof(sagi_file_geometry);
    if (w->status != SAG_OK) return;
    sagi_file_geometry *all = w->write != NULL ? sag_allocate(s->context, bytes) : NULL;
    if (w->write != NULL && all == NULL && bytes > 0) {
        w->status = SAG_ERROR_MEMORY;
        return;
    }
    for (uint32_t i = 0; i < s->count && all != NULL; i++) all[i] = describe_geometry(w, s, i);
    put_section(w, (sagi_file_section){.tag = SAGI_FILE_GEOMETRIES, .scene = number}, all, bytes);
    sag_release(s->context, all, bytes);
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
    sagi_file_head head = {.byte_order = SAGI_FILE_BYTE_ORDER,
                           .version = SAGI_FILE_VERSION,
                           .bytes = total,
                           .scene_count = w->list->count};
    memcpy(head.magic, SAGI_FILE_MAGIC, sizeof head.magic);
    head.checksum = sagi_checksum(&head, offsetof(sagi_file_head, checksum));
    put(w, &head, sizeof head);
    for (uint32_t i = 0; i < w->list->count && w->status == SAG_OK; i++) {
        const sagi_snapshot *s = w->list->scenes[i];
        const sagi_bvh *t = &s->world.tree;
        sagi_file_scene description = describe(s);
        put_section(w, (sagi_file_section){.tag = SAGI_FILE_SCENE, .scene = i}, &description,
                    sizeof description);
        put_geometries(w, s, i);
        put_arrays(w, s, i);
        put_section(w, (sagi_file_section){.tag = SAGI_FILE_UNBOUNDED, .scene = i}, s->unbounded,
                    s->world.unbounded_count * sizeof *s->unbounded);
        put_section(w, (sagi_file_section){.tag = SAGI_FILE_NODES, .scene = i}, t->nodes,
                    t->node_count * sizeof *t->nodes);
        put_section(w, (sagi_file_section){.tag = SAGI_FILE_LEAVES, .scene = i}, t->leaves,
                    t->unit_count * SAGI_BVH_UNIT);
    }
}

sag_status sag_scene_write(const sag_scene *scene, sag_write_callback write, void *user, sag_error *error) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    if (s == NULL) return sag_error_set(error, SAG_ERROR_STATE, "only a committed scene can be saved");
    if (write == NULL) return sag_error_set(error, SAG_ERROR_ARGUMENT, "no callback to write with");
    listing l = {.context = scene->context};
    list_scene(&l, s, error);
    if (l.status == SAG_OK) {
        writer counting = {.list = &l};
        put_all(&counting, 0);
        writer w = {.list = &l, .write = write, .user = user};
        put_all(&w, counting.offset);
        l.status = w.status;
        if (w.status == SAG_ERROR_MEMORY) sag_error_set(error, w.status, "out of memory");
        if (w.status == SAG_ERROR_IO)
            sag_error_set(error, w.status, "byte %llu: could not be written", (unsigned long long)w.offset);
    }
    release_list(&l);
    return l.status;
}
