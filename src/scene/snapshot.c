// SPDX-License-Identifier: MIT
// Snapshots and cells: making them and counting who holds them.
#include "scene/structure.h"
#include <string.h>

sagi_snapshot *sagi_snapshot_create(const sag_context *context, uint32_t count) {
    sagi_snapshot *s = sag_allocate(context, sizeof *s);
    if (s == NULL) return NULL;
    memset(s, 0, sizeof *s);
    atomic_init(&s->references, 1);
    s->context = context;
    s->count = count;
    s->world.tree.box = sagi_float_box_empty();
    s->items = sag_allocate(context, count * sizeof *s->items);
    s->entries = sag_allocate(context, count * sizeof *s->entries);
    if (count > 0 && (s->items == NULL || s->entries == NULL)) {
        sag_release(context, s->items, count * sizeof *s->items);
        sag_release(context, s->entries, count * sizeof *s->entries);
        sag_release(context, s, sizeof *s);
        return NULL;
    }
    if (count > 0) {
        memset(s->items, 0, count * sizeof *s->items);
        memset(s->entries, 0, count * sizeof *s->entries);
    }
    s->world.items = s->items;
    s->world.item_count = count;
    return s;
}

sagi_snapshot *sagi_snapshot_retain(sagi_snapshot *snapshot) {
    if (snapshot != NULL) atomic_fetch_add(&snapshot->references, 1);
    return snapshot;
}

// A child's release comes back here, at most SAG_MAX_INSTANCE_DEPTH deep.
void sagi_snapshot_release(sagi_snapshot *s) {
    if (s == NULL || atomic_fetch_sub(&s->references, 1) != 1) return;
    for (uint32_t i = 0; i < s->count; i++) {
        sagi_store_release(s->entries[i].store);
        sagi_store_release(s->entries[i].moved);
        sagi_snapshot_release(s->entries[i].child);
        sagi_snapshot_release(s->entries[i].alone);
    }
    sagi_groups_release(s);
    sagi_bvh_release(s->context, &s->world.tree);
    sag_release(s->context, s->unbounded, s->unbounded_capacity * sizeof *s->unbounded);
    if (s->part_boxes != NULL)
        sag_release(s->context, s->part_boxes, s->solid->part_count * sizeof *s->part_boxes);
    if (s->solid != NULL) sag_release(s->context, s->solid, sagi_solid_bytes(s->solid));
    if (s->dented != NULL) sag_release(s->context, s->dented, sizeof *s->dented);
    if (s->carved != NULL) sag_release(s->context, s->carved, sizeof *s->carved);
    sag_release(s->context, s->items, s->count * sizeof *s->items);
    sag_release(s->context, s->entries, s->count * sizeof *s->entries);
    sag_release(s->context, s, sizeof *s);
}

size_t sagi_snapshot_table_bytes(const sagi_snapshot *s) {
    size_t bytes = sizeof *s + s->count * (sizeof *s->items + sizeof *s->entries) +
                   s->group_count * sizeof *s->groups + s->member_count * sizeof *s->members;
    if (s->solid == NULL) return bytes;
    bytes += sagi_solid_bytes(s->solid) + s->solid->part_count * sizeof *s->part_boxes;
    if (s->carved != NULL) bytes += sizeof *s->carved;
    if (s->dented != NULL) bytes += sizeof *s->dented;
    for (uint32_t i = 0; i < s->count; i++)
        if (s->entries[i].alone != NULL) bytes += sagi_snapshot_table_bytes(s->entries[i].alone);
    return bytes;
}

bool sagi_snapshot_count_shared(sagi_snapshot *s) {
    sagi_listing l = {.context = s->context};
    s->stats.shared_bytes = 0;
    if (s->world.instance_levels == 0) return true;
    bool done = sagi_listing_add(&l, s);
    for (uint32_t i = 0; done && i + 1 < l.count; i++) // s itself comes last
        s->stats.shared_bytes += sagi_snapshot_table_bytes(l.snapshots[i]) +
                                 l.snapshots[i]->stats.geometry_bytes + l.snapshots[i]->stats.structure_bytes;
    sagi_listing_release(&l);
    return done;
}

sagi_cell *sagi_cell_retain(sagi_cell *cell) {
    if (cell != NULL) atomic_fetch_add(&cell->references, 1);
    return cell;
}

void sagi_cell_release(sagi_cell *cell) {
    if (cell == NULL || atomic_fetch_sub(&cell->references, 1) != 1) return;
    sagi_snapshot_release(cell->current);
    sag_release(cell->context, cell, sizeof *cell);
}
