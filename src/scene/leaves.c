// SPDX-License-Identifier: MIT
// Writing leaves (kernel/block.h): triangles of one mesh and spheres of one set as blocks of their own,
// everything else as a list of references.
#include "kernel/corners.h"
#include "scene/grid.h"
#include "scene/scene.h"
#include "shapes/mesh.h"
#include <string.h>

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

// The corners of up to eight triangles, coordinate by coordinate like the block's: at[i][k][j] is coordinate
// k of corner i of triangle j. Where there are fewer, the first is repeated.
typedef double corners[3][3][SAGI_BVH_WIDTH];

static void read_corners(const sagi_item *item, const sagi_bvh_primitive *p, uint32_t count, corners at) {
    const sag_mesh *mesh = item->shape;
    const int place[3] = {0, item->mirrored ? 2 : 1, item->mirrored ? 1 : 2};
    // All indices first, then all vertices: so none waits for another to come from memory.
    size_t first[SAGI_BVH_WIDTH][3];
    for (uint32_t j = 0; j < SAGI_BVH_WIDTH; j++) {
        const uint32_t *corner = &mesh->triangles[3 * (size_t)p[j < count ? j : 0].primitive];
        for (int i = 0; i < 3; i++) first[j][i] = 3 * (size_t)corner[place[i]];
    }
    for (int j = 0; j < SAGI_BVH_WIDTH; j++)
        for (int i = 0; i < 3; i++)
            for (size_t k = 0; k < 3; k++)
                at[i][k][j] = mesh->positions_f32 ? (double)mesh->positions_f32[first[j][i] + k]
                                                  : mesh->positions_f64[first[j][i] + k];
}

// The grid: its zero below all corners, its step the smallest power of two with which 16 bits reach the
// farthest of them. Corners are in world units, above −1 and below 1.
static double choose_grid(corners at, sagi_block *head, double zero[3]) {
    double extent = 0;
    for (int k = 0; k < 3; k++) {
        double lo[SAGI_BVH_WIDTH], hi[SAGI_BVH_WIDTH];
        for (int j = 0; j < SAGI_BVH_WIDTH; j++) {
            double a = at[0][k][j], b = at[1][k][j], c = at[2][k][j];
            double less = a < b ? a : b, more = a > b ? a : b;
            lo[j] = less < c ? less : c, hi[j] = more > c ? more : c;
        }
        for (int half = SAGI_BVH_WIDTH / 2; half > 0; half /= 2)
            for (int j = 0; j < half; j++) {
                lo[j] = lo[j] < lo[j + half] ? lo[j] : lo[j + half];
                hi[j] = hi[j] > hi[j + half] ? hi[j] : hi[j + half];
            }
        zero[k] = sagi_grid_zero(head, k, lo[0]);
        extent = hi[0] - zero[k] > extent ? hi[0] - zero[k] : extent;
    }
    return sagi_grid_steps(head, extent);
}

// The byte that says how long edges are at most. (Lanes without a triangle have edges of 0.)
static uint8_t longest_edge(sagi_triangle_block *block) {
    int longest = 0;
    for (int i = 1; i < 3; i++)
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < SAGI_BVH_WIDTH; j++) {
                int edge = *sagi_block_corner(block, i, k, j) - *sagi_block_corner(block, 0, k, j);
                edge = edge < 0 ? -edge : edge;
                longest = edge > longest ? edge : longest;
            }
    return (uint8_t)(longest >> 8);
}

// What corners lack (kernel/corners.h), as it comes together: of four triangles, each number in a row.
typedef uint32_t four_numbers __attribute__((vector_size(16)));
typedef uint16_t four_short __attribute__((vector_size(8))); // as they stand in a block, side by side
typedef struct rests {
    four_numbers corner[3]; // three times seven bits
    four_numbers beyond;    // not 0: they do not fit,
    sagi_l4 bad;            // not 0: and read back it is not the vertex
} rests;

// The grid, and what makes numbers of it coordinates again.
typedef struct grid {
    double zero[3], steps, fine_steps, fine_step, unit, origin[3];
} grid;

// Coordinate k of corner i of four triangles: rounds to both grids, and reads back from the finer one.
SAGI_INLINE sagi_w4 round_four(rests *to, const grid *g, int i, int k, const double *vertex,
                               const double *at) {
    const sagi_d4 zero = sagi_d4_fill(g->zero[k]), half = sagi_d4_fill(0.5);
    const sagi_d4 away = sagi_d4_load(at) - zero;
    const sagi_w4 coarse = __builtin_convertvector(away * sagi_d4_fill(g->steps) + half, sagi_w4);
    const sagi_w4 fine = __builtin_convertvector(away * sagi_d4_fill(g->fine_steps) + half, sagi_w4);
    const four_numbers n = (four_numbers)fine + SAGI_REST_MIDDLE - ((four_numbers)coarse << SAGI_REST_BITS);
    const sagi_d4 on_grid = __builtin_convertvector(fine, sagi_d4);
    const sagi_d4 back =
        sagi_d4_fill(g->origin[k]) + (zero + on_grid * sagi_d4_fill(g->fine_step)) * sagi_d4_fill(g->unit);
    to->beyond |= n >> SAGI_REST_BITS, to->corner[i] |= n << SAGI_REST_SHIFT(0, k);
    to->bad |= (sagi_l4)back ^ (sagi_l4)sagi_d4_load(vertex);
    return coarse;
}

// A vertex (p − C)·scale errs by 2⁻⁵² in world units at most, which is 2⁻¹² grid steps at most; subtracting
// the grid's zero may add as much, scaling is exact and rounding to the grid costs half a step:
// SAGI_GRID_ERROR. The finer grid of corners.h is rounded to as well, and read back.
static void write_triangles(const sagi_snapshot *s, const sagi_bvh_primitive *p, uint32_t count,
                            sagi_triangle_block *block) {
    const double origin[3] = {s->world.origin.x, s->world.origin.y, s->world.origin.z};
    const double scale = s->world.scale;
    const sagi_item *item = &s->items[p[0].geometry];
    corners vertex, at;
    read_corners(item, p, count, vertex);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < SAGI_BVH_WIDTH; j++) at[i][k][j] = (vertex[i][k][j] - origin[k]) * scale;
    sagi_block head = {.kind = SAGI_BLOCK_TRIANGLES, .count = (uint8_t)count, .geometry = p[0].geometry};
    grid g = {.unit = 1 / scale, .origin = {origin[0], origin[1], origin[2]}};
    g.steps = choose_grid(at, &head, g.zero);
    g.fine_steps = g.steps * (1 << SAGI_REST_BITS), g.fine_step = 1 / g.fine_steps;
    block->head = head;
    for (uint32_t j = 0; j < count; j++) block->primitive[j] = p[j].primitive;
    const bool floats = ((const sag_mesh *)item->shape)->positions_f32 != NULL;
    for (uint32_t first = 0; first < count; first += 4) {
        const uint32_t here = count - first < 4 ? count - first : 4;
        const sagi_w4 lane = {0, 1, 2, 3}, there = lane < (int32_t)here;
        rests rest = {.beyond = {0}};
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                const sagi_w4 coarse = round_four(&rest, &g, i, k, &vertex[i][k][first], &at[i][k][first]);
                const four_short numbers = __builtin_convertvector(coarse & there, four_short);
                memcpy(sagi_block_corner(block, i, k, (int)first), &numbers, sizeof numbers);
            }
        for (uint32_t j = 0; j < here && floats; j++)
            if (rest.bad[j] == 0 && rest.beyond[j] == 0)
                block->rest[first + j] =
                    rest.corner[0][j] | (uint64_t)rest.corner[1][j] << SAGI_REST_SHIFT(1, 0) |
                    (uint64_t)rest.corner[2][j] << SAGI_REST_SHIFT(2, 0) | SAGI_REST_EXACT;
    }
    block->head.edge = longest_edge(block);
}

void sagi_leaf_write(const void *snapshot, const sagi_bvh_primitive *primitives, uint32_t count, void *at) {
    const sagi_snapshot *s = snapshot;
    uint32_t geometry = primitives[0].geometry;
    for (uint32_t i = 1; i < count; i++)
        if (primitives[i].geometry != geometry) geometry = SAGI_BVH_MIXED;
    switch (kind_of(s, geometry)) {
    case SAGI_BLOCK_TRIANGLES: write_triangles(s, primitives, count, at); break;
    case SAGI_BLOCK_SPHERES: sagi_sphere_leaf_write(s, primitives, count, at); break;
    case SAGI_BLOCK_REFERENCES: write_references(primitives, count, at); break;
    }
}
