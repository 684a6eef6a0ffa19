// SPDX-License-Identifier: MIT
// The bodies of a scene: every geometry at every place where instances put it, and every solid as one. In
// order of the ids along the path, so the list is the same whatever else changes. The walk comes back to
// itself for instances, SAG_MAX_INSTANCE_DEPTH deep at most; a scene that shows a million trees a million
// times has more bodies than memory, so it stops taking them at a limit. How many
// more there are follows from the numbers of each snapshot, without a walk to all of them.
#include "measure/measure.h"
#include "shapes/mesh.h"
#include "shapes/shape.h"
#include <string.h>

static bool grow(sagi_body_list *list) {
    if (list->count < list->capacity) return true;
    size_t capacity = list->capacity == 0 ? 16 : 2 * list->capacity;
    if (capacity > list->limit) capacity = list->limit;
    sag_body *bodies = sag_allocate(list->context, capacity * sizeof *bodies);
    sagi_subject *subjects = sag_allocate(list->context, capacity * sizeof *subjects);
    if (bodies == NULL || subjects == NULL) {
        sag_release(list->context, bodies, capacity * sizeof *bodies);
        sag_release(list->context, subjects, capacity * sizeof *subjects);
        return false;
    }
    if (list->count > 0) {
        memcpy(bodies, list->bodies, list->count * sizeof *bodies);
        memcpy(subjects, list->subjects, list->count * sizeof *subjects);
    }
    sag_release(list->context, list->bodies, list->capacity * sizeof *bodies);
    sag_release(list->context, list->subjects, list->capacity * sizeof *subjects);
    list->bodies = bodies, list->subjects = subjects, list->capacity = capacity;
    return true;
}

// Where the walk is.
typedef struct place {
    uint32_t depth;
    uint32_t path[SAG_MAX_INSTANCE_DEPTH];
    sag_affine to_scene;
    uint64_t user_data; // of the innermost instance
} place;

sag_box3 sagi_subject_box(const sagi_subject *subject, uint32_t geometry) {
    const sagi_snapshot *s = subject->snapshot;
    if (geometry == SAG_INVALID_ID) {
        const sag_box3 everywhere = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
        return s->world.unbounded_count > 0 ? everywhere : s->stats.bounds;
    }
    const sagi_item *item = &s->items[geometry];
    const sag_box3 box = sagi_shape_classes[item->kind].bounds(item->shape);
    return item->place != NULL ? sag_affine_box(&item->place->to_scene, &box) : box;
}

static bool add_body(sagi_body_list *list, const sagi_snapshot *s, const place *at, uint32_t geometry) {
    if (list->count == list->limit) {
        list->omitted++;
        return true;
    }
    if (!grow(list)) return false;
    sag_body *body = &list->bodies[list->count];
    sagi_subject *subject = &list->subjects[list->count++];
    *body = (sag_body){.instance_depth = at->depth, .geometry = geometry};
    memcpy(body->instance_path, at->path, sizeof at->path);
    *subject = (sagi_subject){.snapshot = s, .to_scene = at->to_scene};
    subject->slot = list->first_slot[sagi_listing_find(&list->listing, s)];
    if (geometry == SAG_INVALID_ID) {
        body->kind = SAG_SHAPE_INSTANCE;
        body->user_data = at->user_data;
    } else {
        subject->slot += geometry;
        body->kind = (sag_shape_kind)s->items[geometry].kind;
        body->shape = s->entries[geometry].store->shape;
        body->user_data = s->entries[geometry].user_data;
    }
    const sag_box3 box = sagi_subject_box(subject, geometry);
    const bool moved = !sag_affine_is_identity(&at->to_scene);
    body->bounds = moved && !sag_box3_is_empty(&box) ? sag_affine_box(&at->to_scene, &box) : box;
    return true;
}

// A sum of two that are no more than this, neither is it.
#define MOST_BODIES (UINT64_MAX / 2)
static uint64_t plus(uint64_t a, uint64_t b) { return a + b < MOST_BODIES ? a + b : MOST_BODIES; }

// Its children have been counted.
static uint64_t count_bodies(const sagi_body_list *list, const sagi_snapshot *s) {
    uint64_t count = 0;
    if (sagi_snapshot_is_solid(s)) return 1;
    for (uint32_t i = 0; i < s->count; i++) {
        const sagi_entry *entry = &s->entries[i];
        if (entry->present && entry->child != NULL)
            count = plus(count, list->body_counts[sagi_listing_find(&list->listing, entry->child)]);
        else if (entry->present && s->items[i].shape != NULL)
            count = plus(count, 1);
    }
    return count;
}

static bool walk(sagi_body_list *list, const sagi_snapshot *s, const place *at) {
    if (list->count == list->limit) {
        list->omitted = plus(list->omitted, list->body_counts[sagi_listing_find(&list->listing, s)]);
        return true;
    }
    if (sagi_snapshot_is_solid(s)) return add_body(list, s, at, SAG_INVALID_ID);
    for (uint32_t i = 0; i < s->count; i++) {
        const sagi_entry *entry = &s->entries[i];
        if (!entry->present) continue;
        if (entry->child == NULL) {
            if (s->items[i].shape != NULL && !add_body(list, s, at, i)) return false;
            continue;
        }
        if (at->depth == SAG_MAX_INSTANCE_DEPTH) continue;
        place inner = *at;
        inner.path[inner.depth++] = i;
        inner.user_data = entry->user_data;
        const sagi_place *p = s->items[i].place;
        if (p != NULL) inner.to_scene = sag_affine_multiply(&at->to_scene, &p->to_scene);
        if (!walk(list, entry->child, &inner)) return false;
    }
    return true;
}

// Each geometry of each snapshot gets a number, whatever the number of instances.
static bool number_slots(sagi_body_list *list) {
    list->first_slot = sag_allocate(list->context, list->listing.count * sizeof *list->first_slot);
    list->body_counts = sag_allocate(list->context, list->listing.count * sizeof *list->body_counts);
    if (list->first_slot == NULL || list->body_counts == NULL) return false;
    for (uint32_t i = 0; i < list->listing.count; i++) {
        list->first_slot[i] = list->slot_count;
        list->slot_count += list->listing.snapshots[i]->count;
        list->body_counts[i] = count_bodies(list, list->listing.snapshots[i]);
    }
    return true;
}

bool sagi_body_list_make(sagi_body_list *list, const sagi_snapshot *snapshot) {
    list->listing = (sagi_listing){.context = list->context};
    const place top = {.to_scene = sag_affine_identity()};
    return sagi_listing_add(&list->listing, snapshot) && number_slots(list) && walk(list, snapshot, &top);
}

void sagi_body_list_release(sagi_body_list *list) {
    sag_release(list->context, list->bodies, list->capacity * sizeof *list->bodies);
    sag_release(list->context, list->subjects, list->capacity * sizeof *list->subjects);
    sag_release(list->context, list->first_slot, list->listing.count * sizeof *list->first_slot);
    sag_release(list->context, list->body_counts, list->listing.count * sizeof *list->body_counts);
    sagi_listing_release(&list->listing);
}
