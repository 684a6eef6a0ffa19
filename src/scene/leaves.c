// SPDX-License-Identifier: MIT
// Writing leaves (kernel/block.h): triangles of one mesh as a block of their own, everything else as a list
// of references.
#include "kernel/block.h"
#include "scene/scene.h"
#include "shapes/mesh.h"
#include <string.h>

static sagi_block_kind kind_of(const sagi_snapshot *s, const sagi_bvh_primitive *p, uint32_t count) {
    for (uint32_t i = 1; i < count; i++)
        if (p[i].geometry != p[0].geometry) return SAGI_BLOCK_REFERENCES;
    return s->items[p[0].geometry].kind == SAG_SHAPE_MESH ? SAGI_BLOCK_TRIANGLES : SAGI_BLOCK_REFERENCES;
}

// A block of triangles costs the same however many there are. The other shapes are tested one by one, in
// double, and further boxes are much cheaper.
sagi_leaf_cost sagi_leaf_price(const void *snapshot, uint32_t geometry) {
    const sagi_snapshot *s = snapshot;
    if (s->items[geometry].kind == SAG_SHAPE_MESH) return (sagi_leaf_cost){.all = 1.2f};
    return (sagi_leaf_cost){.all = 0.5f, .each = 2};
}

uint32_t sagi_leaf_units(const void *snapshot, const sagi_bvh_primitive *primitives, uint32_t count) {
    size_t bytes = sagi_block_bytes(kind_of(snapshot, primitives, count), count);
    return (uint32_t)((bytes + SAGI_BVH_UNIT - 1) / SAGI_BVH_UNIT);
}

static bool comes_before(const sagi_bvh_primitive *a, const sagi_bvh_primitive *b) {
    return a->geometry != b->geometry ? a->geometry < b->geometry : a->primitive < b->primitive;
}

// Sorted by insertion: there are at most SAGI_BVH_MAX_LEAF.
static void write_references(const sagi_bvh_primitive *p, uint32_t count, sagi_reference_block *block) {
    const sagi_bvh_primitive *sorted[SAGI_BVH_MAX_LEAF];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t place = i;
        for (; place > 0 && comes_before(&p[i], sorted[place - 1]); place--)
            sorted[place] = sorted[place - 1];
        sorted[place] = &p[i];
    }
    block->head = (sagi_block){.kind = SAGI_BLOCK_REFERENCES, .count = (uint8_t)count};
    for (uint32_t i = 0; i < count; i++)
        block->reference[i] = (sagi_bvh_reference){sorted[i]->geometry, sorted[i]->primitive};
}

// The grid: its zero below all corners, its step the smallest power of two with which 16 bits reach the
// farthest of them. lo and hi are in world units.
static void choose_grid(const double lo[3], const double hi[3], sagi_block *head, double zero[3]) {
    const int64_t most = ((int64_t)1 << SAGI_GRID_BASE_BITS) - 1;
    double extent = 0;
    for (int k = 0; k < 3; k++) {
        int64_t base = (int64_t)floor((lo[k] + 1) * 0x1p20);
        base = base < 0 ? 0 : base > most ? most : base;
        head->base |= (uint64_t)base << (k * SAGI_GRID_BASE_BITS);
        zero[k] = (double)base * 0x1p-20 - 1;
        extent = fmax(extent, hi[k] - zero[k]);
    }
    int exponent = SAGI_GRID_MAX_EXPONENT;
    while (ldexp(extent, exponent) > (1 << SAGI_GRID_BITS) - 1) exponent--;
    head->exponent = (uint8_t)exponent;
}

// A vertex (p − C)·scale errs by 2⁻⁵² in world units at most, which is 2⁻¹² grid steps at most; subtracting
// the grid's zero may add as much, scaling is exact and rounding to the grid costs half a step:
// SAGI_GRID_ERROR.
static void write_triangles(const sagi_snapshot *s, const sagi_bvh_primitive *p, uint32_t count,
                            sagi_triangle_block *block) {
    const sagi_item *item = &s->items[p[0].geometry];
    const double origin[3] = {s->world.origin.x, s->world.origin.y, s->world.origin.z};
    double at[SAGI_BVH_MAX_LEAF][3][3], lo[3] = {1, 1, 1}, hi[3] = {-1, -1, -1}, zero[3];
    memset(block, 0, sizeof *block);
    block->head =
        (sagi_block){.kind = SAGI_BLOCK_TRIANGLES, .count = (uint8_t)count, .geometry = p[0].geometry};
    for (uint32_t j = 0; j < count; j++) {
        sag_vec3 v[3];
        block->primitive[j] = p[j].primitive;
        sagi_mesh_triangle(item->shape, p[j].primitive, v);
        for (int i = 0; i < 3; i++) {
            const sag_vec3 *from = &v[i == 0 ? 0 : item->mirrored ? 3 - i : i];
            const double c[3] = {from->x, from->y, from->z};
            for (int k = 0; k < 3; k++) {
                double x = (c[k] - origin[k]) * s->world.scale;
                at[j][i][k] = x;
                lo[k] = x < lo[k] ? x : lo[k], hi[k] = x > hi[k] ? x : hi[k];
            }
        }
    }
    choose_grid(lo, hi, &block->head, zero);
    double steps = ldexp(1, block->head.exponent);
    for (uint32_t j = 0; j < count; j++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                block->corner[i][k][j] = (uint16_t)fmax((at[j][i][k] - zero[k]) * steps + 0.5, 0);
}

void sagi_leaf_write(const void *snapshot, const sagi_bvh_primitive *primitives, uint32_t count, void *at) {
    const sagi_snapshot *s = snapshot;
    memset(at, 0, sagi_leaf_units(s, primitives, count) * SAGI_BVH_UNIT);
    switch (kind_of(s, primitives, count)) {
    case SAGI_BLOCK_TRIANGLES: write_triangles(s, primitives, count, at); break;
    case SAGI_BLOCK_REFERENCES: write_references(primitives, count, at); break;
    }
}
