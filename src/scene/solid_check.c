// SPDX-License-Identifier: MIT
// Which geometries bound a volume, and that all parts of a solid do. What a shape's description says is found
// out once, by whoever asks first, and kept beside it; every thread would find the same.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include <stdio.h>
#include <string.h>

typedef enum closedness { NOT_KNOWN, CLOSED, OPEN } closedness;

static bool find_out(sag_shape_kind kind, const void *shape) {
    return kind == SAG_SHAPE_MESH ? sagi_mesh_is_closed(shape) : sagi_shape_flaw(kind, shape) == NULL;
}

bool sagi_geometry_is_closed(const sagi_snapshot *s, uint32_t id) {
    const sagi_entry *e = &s->entries[id];
    if (e->child != NULL) return sagi_snapshot_is_solid(e->child);
    sagi_store *store = e->moved != NULL ? e->moved : e->store;
    if (store == NULL) return false;
    uint8_t known = atomic_load_explicit(&store->closedness, memory_order_relaxed);
    if (known == NOT_KNOWN) {
        known = find_out((sag_shape_kind)s->items[id].kind, store->shape) ? CLOSED : OPEN;
        atomic_store_explicit(&store->closedness, known, memory_order_relaxed);
    }
    return known == CLOSED;
}

static sag_status say_open_mesh(const sagi_snapshot *s, uint32_t id, sag_error *error) {
    sagi_odd_edges odd;
    sag_status status = sagi_mesh_find_odd_edges(s->context, s->items[id].shape, &odd);
    if (status == SAG_ERROR_MEMORY) return sag_error_set(error, status, "out of memory");
    if (status != SAG_OK)
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "geometry %u, a mesh, is not closed", (unsigned)id);
    if (odd.count == 0)
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "geometry %u, a mesh, has no finite triangle",
                             (unsigned)id);
    char triangles[64] = "a triangle on one side only", on_it[80] = "";
    if (odd.triangles > 1) snprintf(triangles, sizeof triangles, "%u triangles", (unsigned)odd.triangles);
    if (odd.on_it != SAG_INVALID_ID)
        snprintf(on_it, sizeof on_it, "; vertex %u lies on it, which does not join them (a T-junction)",
                 (unsigned)odd.on_it);
    return sag_error_set(error, SAG_ERROR_GEOMETRY,
                         "geometry %u, a mesh, is not closed: the edge between vertices %u and %u has %s "
                         "(%llu such edge%s in all)%s",
                         (unsigned)id, (unsigned)odd.vertex[0], (unsigned)odd.vertex[1], triangles,
                         (unsigned long long)odd.count, odd.count == 1 ? "" : "s", on_it);
}

sag_status sagi_solid_check_parts(const sagi_snapshot *s, sag_error *error) {
    for (uint32_t id = 0; id < s->count; id++) {
        if (!s->entries[id].present || sagi_geometry_is_closed(s, id)) continue;
        sag_shape_kind kind = (sag_shape_kind)s->items[id].kind;
        if (kind == SAG_SHAPE_MESH) return say_open_mesh(s, id, error);
        if (kind == SAG_SHAPE_INSTANCE)
            return sag_error_set(error, SAG_ERROR_GEOMETRY,
                                 "geometry %u, an instance, shows a scene that is not a solid", (unsigned)id);
        const char *name = sag_shape_kind_name(kind);
        return sag_error_set(error, SAG_ERROR_GEOMETRY, "geometry %u, a%s %s, %s", (unsigned)id,
                             strchr("aeiou", name[0]) != NULL && kind != SAG_SHAPE_USER ? "n" : "", name,
                             sagi_shape_flaw(kind, s->items[id].shape));
    }
    return SAG_OK;
}
