// SPDX-License-Identifier: MIT
// All snapshots that are reached from one through instances, each once, children before their parents: an
// array, and a table with open addressing to find them in (slot = number + 1; 0 is empty).
#include "scene/scene.h"
#include <string.h>

static uint32_t *slot_of(const sagi_listing *l, const sagi_snapshot *s) {
    uint32_t mask = 2 * l->capacity - 1;
    uint64_t hash = (uint64_t)(uintptr_t)s * 0x9E3779B97F4A7C15u;
    for (uint32_t i = (uint32_t)(hash >> 32);; i++) {
        uint32_t *slot = &l->slots[i & mask];
        if (*slot == 0 || l->snapshots[*slot - 1] == s) return slot;
    }
}

void sagi_listing_release(sagi_listing *l) {
    sag_release(l->context, l->snapshots, l->capacity * sizeof *l->snapshots);
    sag_release(l->context, l->slots, 2 * (size_t)l->capacity * sizeof *l->slots);
    *l = (sagi_listing){.context = l->context};
}

static bool grow(sagi_listing *l) {
    sagi_listing larger = {.context = l->context, .count = l->count};
    if (l->capacity > UINT32_MAX / 8) return false;
    larger.capacity = l->capacity == 0 ? 16 : 2 * l->capacity;
    larger.snapshots = sag_allocate(l->context, larger.capacity * sizeof *larger.snapshots);
    larger.slots = sag_allocate(l->context, 2 * (size_t)larger.capacity * sizeof *larger.slots);
    if (larger.snapshots == NULL || larger.slots == NULL) {
        sagi_listing_release(&larger);
        return false;
    }
    memset(larger.slots, 0, 2 * (size_t)larger.capacity * sizeof *larger.slots);
    for (uint32_t i = 0; i < l->count; i++) {
        larger.snapshots[i] = l->snapshots[i];
        *slot_of(&larger, l->snapshots[i]) = i + 1;
    }
    sagi_listing_release(l);
    *l = larger;
    return true;
}

// Comes back to itself for instances, SAG_MAX_INSTANCE_DEPTH deep at most.
bool sagi_listing_add(sagi_listing *l, const sagi_snapshot *s) {
    if (l->count > 0 && *slot_of(l, s) != 0) return true;
    for (uint32_t i = 0; s->world.instance_levels > 0 && i < s->count; i++)
        if (s->entries[i].child != NULL && !sagi_listing_add(l, s->entries[i].child)) return false;
    if (l->count == l->capacity && !grow(l)) return false;
    l->snapshots[l->count++] = s;
    *slot_of(l, s) = l->count;
    return true;
}

uint32_t sagi_listing_find(const sagi_listing *l, const sagi_snapshot *s) { return *slot_of(l, s) - 1; }
