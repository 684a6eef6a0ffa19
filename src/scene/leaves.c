// SPDX-License-Identifier: MIT
// Writing leaves (kernel/block.h): triangles of one mesh and spheres of one set as blocks of their own,
// everything else as a list of references.
#include "base/context.h"
#include "scene/scene.h"

static sagi_block_kind kind_of(const sagi_snapshot *s, uint32_t geometry) {
    if (geometry == SAGI_BVH_MIXED || s->solid != NULL) return SAGI_BLOCK_REFERENCES;
    if (geometry == SAGI_LONE_SPHERES) return SAGI_BLOCK_SPHERES;
    const sagi_item *item = &s->items[geometry];
    if (item->kind == SAG_SHAPE_MESH) return SAGI_BLOCK_TRIANGLES;
    return item->kind == SAG_SHAPE_SPHERES && item->place == NULL ? SAGI_BLOCK_SPHERES
                                                                  : SAGI_BLOCK_REFERENCES;
}

// A block of triangles or spheres costs the same however many there are. The other shapes are tested one by
// one, in double, and further boxes are much cheaper; parts of a solid have a leaf each wherever they differ.
sagi_leaf_cost sagi_leaf_price(const void *snapshot, uint32_t geometry) {
    switch (kind_of(snapshot, geometry)) {
    case SAGI_BLOCK_TRIANGLES: return (sagi_leaf_cost){.all = 1.2f};
    case SAGI_BLOCK_SPHERES: return (sagi_leaf_cost){.all = 0.6f};
    case SAGI_BLOCK_REFERENCES: break;
    }
    const sagi_snapshot *s = snapshot;
    if (s->solid != NULL) return (sagi_leaf_cost){.each = 16};
    return (sagi_leaf_cost){.all = 0.5f, .each = 2};
}

uint32_t sagi_leaf_units(const void *snapshot, uint32_t geometry, uint32_t count) {
    size_t bytes = sagi_block_bytes(kind_of(snapshot, geometry), count);
    return (uint32_t)((bytes + SAGI_BVH_UNIT - 1) / SAGI_BVH_UNIT);
}

static bool comes_before(sagi_bvh_reference a, sagi_bvh_reference b) {
    return a.geometry != b.geometry ? a.geometry < b.geometry : a.primitive < b.primitive;
}

// Sorted by insertion: there are at most SAGI_BVH_MAX_LEAF.
static void write_references(const sagi_bvh_primitive *p, uint32_t count, sagi_reference_block *block) {
    sagi_bvh_reference *sorted = block->reference;
    block->head = (sagi_block){.kind = SAGI_BLOCK_REFERENCES, .count = (uint8_t)count};
    for (uint32_t i = 0; i < count; i++) {
        sagi_bvh_reference r = {p[i].geometry, p[i].primitive};
        if (r.geometry == SAGI_LONE_SPHERES) r = (sagi_bvh_reference){r.primitive, 0};
        uint32_t place = i;
        for (; place > 0 && comes_before(r, sorted[place - 1]); place--) sorted[place] = sorted[place - 1];
        sorted[place] = r;
    }
}

void sagi_leaf_write(const void *snapshot, const sagi_bvh_primitive *primitives, uint32_t count, void *at) {
    const sagi_snapshot *s = snapshot;
    uint32_t geometry = primitives[0].geometry;
    for (uint32_t i = 1; i < count; i++)
        if (primitives[i].geometry != geometry) geometry = SAGI_BVH_MIXED;
    switch (kind_of(s, geometry)) {
    case SAGI_BLOCK_TRIANGLES:
        sagi_kernel_pick(s->context->isa)->write_triangles(&s->world, primitives, count, at);
        break;
    case SAGI_BLOCK_SPHERES: sagi_sphere_leaf_write(s, primitives, count, at); break;
    case SAGI_BLOCK_REFERENCES: write_references(primitives, count, at); break;
    }
}
