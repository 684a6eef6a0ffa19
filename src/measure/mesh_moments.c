// SPDX-License-Identifier: MIT
// A closed mesh by the divergence theorem.
//
// The tetrahedra from one point, the origin here, to each triangle (a, b, c), counted with the sign of their
// orientation, make up the body: what lies outside of it is added and taken off again. With
// d = a · (b × c), six times the signed volume, and s = a + b + c,
//
//     ∫ dV = d/6,   ∫ x dV = d/24 s,   ∫ xᵢxⱼ dV = d/120 (sᵢsⱼ + aᵢaⱼ + bᵢbⱼ + cᵢcⱼ).
//
// (The last since ∫ over the standard simplex of λₖ² is 1/60 and of λₖλₗ 1/120. The result is that of
// Mirtich's and Eberly's face integrals, with less to get wrong.) Where parts overlap, each counts.
//
// Rounding. The origin is the middle of the mesh's box, so a mesh far away loses nothing but what its own
// coordinates have lost. d is taken as a · ((b − a) × (c − a)), which is the same: the edges are small where
// the mesh is fine, and rounded once, so d is off by less than 12 · 2⁻⁵³ of |a||b − a||c − a|. The terms are
// summed with their rounding errors carried along (Neumaier 1974): within 2⁻⁵³ of the result and n² 2⁻¹⁰⁶ of
// the terms. The bound given is 2⁻⁴⁹ Σ |a||b − a||c − a|/6.
//
// When it holds. The sum does not depend on the origin, and is the volume, if the triangles are the boundary
// of something: if every edge is run through equally often in both directions, equal positions being the same
// vertex. Each edge gets a fingerprint of 128 bits, made from its ends' positions, that is added for one
// direction and subtracted for the other; the total is 0 if all is in balance, else with a chance of 2⁻¹²⁸.
// (Triangles without area count, for they join their neighbours. src/shapes/mesh_closed.c asks likewise for
// even numbers only, which is enough for rays.)
//
// Each piece of 32,768 triangles is one task; their sums are added in order, so the number of threads does
// not matter.
#include "math/hash.h"
#include "measure/measure.h"
#include "shapes/mesh.h"

#define PIECE ((uint32_t)32768)
#define SUMS  (SAGI_RAW_COUNT + 2) // moments, area, the sum of absolute values

typedef struct sums {
    double sum[SUMS], carried[SUMS];
    uint64_t edges[2]; // fingerprints, modulo 2⁶⁴ each
} sums;

typedef struct work {
    const sag_mesh *mesh;
    const sag_affine *map;
    sag_vec3 origin;
    sums *pieces;
} work;

static void add(sums *s, int k, double x) {
    const double sum = s->sum[k] + x;
    s->carried[k] += fabs(s->sum[k]) >= fabs(x) ? (s->sum[k] - sum) + x : (x - sum) + s->sum[k];
    s->sum[k] = sum;
}

// a, b, c count from the origin; the edges b − a and c − a.
static void add_triangle(sums *s, sag_vec3 a, sag_vec3 b, sag_vec3 c, sag_vec3 ab, sag_vec3 ac) {
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    const sag_vec3 normal = sag_cross(ab, ac);
    const double d = sag_dot(a, normal);
    const double p[4][3] = {{a.x, a.y, a.z},
                            {b.x, b.y, b.z},
                            {c.x, c.y, c.z},
                            {a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z}};
    add(s, 0, d / 6);
    for (int i = 0; i < 3; i++) add(s, 1 + i, d / 24 * p[3][i]);
    for (int k = 0; k < 6; k++) {
        const int i = row[k], j = column[k];
        add(s, 4 + k,
            d / 120 * (p[3][i] * p[3][j] + p[0][i] * p[0][j] + p[1][i] * p[1][j] + p[2][i] * p[2][j]));
    }
    add(s, SAGI_RAW_COUNT, 0.5 * sag_length(normal));
    add(s, SAGI_RAW_COUNT + 1, sag_length(a) * sag_length(ab) * sag_length(ac) / 6);
}

// An edge adds the same as the way back takes off, one of no length nothing.
static void add_edges(sums *s, const sag_vec3 p[3]) {
    sagi_fingerprint f[3];
    for (int k = 0; k < 3; k++) f[k] = sagi_fingerprint_of(p[k]);
    for (int part = 0; part < 2; part++)
        for (int k = 0; k < 3; k++) {
            const uint64_t a = f[k].part[part], b = f[(k + 1) % 3].part[part];
            s->edges[part] += (a < b ? 1u : a > b ? UINT64_MAX : 0u) * sagi_mix(a ^ b ^ sagi_mix(a + b));
        }
}

static void sum_piece(void *argument, size_t index) {
    const work *w = argument;
    sums *s = &w->pieces[index];
    *s = (sums){0};
    const uint32_t first = (uint32_t)index * PIECE;
    const uint32_t count = w->mesh->triangle_count - first < PIECE ? w->mesh->triangle_count - first : PIECE;
    for (uint32_t i = 0; i < count; i++) {
        sag_vec3 p[3];
        if (sagi_mesh_triangle_state(w->mesh, first + i, p) == SAGI_TRIANGLE_NOT_FINITE) continue;
        add_edges(s, p);
        for (int k = 0; k < 3 && w->map != NULL; k++) p[k] = sag_affine_point(w->map, p[k]);
        const sag_vec3 ab = sag_sub(p[1], p[0]), ac = sag_sub(p[2], p[0]);
        add_triangle(s, sag_sub(p[0], w->origin), sag_sub(p[1], w->origin), sag_sub(p[2], w->origin), ab, ac);
    }
}

bool sagi_mesh_sum(const sag_context *context, const sag_mesh *mesh, const sag_affine *map, sag_vec3 origin,
                   sagi_mesh_sums *result) {
    const size_t count = (mesh->triangle_count - 1) / PIECE + 1;
    work w = {mesh, map, origin, sag_allocate(context, count * sizeof(sums))};
    if (w.pieces == NULL) return false;
    sag_parallel_for(context, count, sum_piece, &w);
    sums all = {0};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < SUMS; k++) {
            add(&all, k, w.pieces[i].sum[k]);
            all.carried[k] += w.pieces[i].carried[k];
        }
    for (size_t i = 0; i < count; i++)
        for (int part = 0; part < 2; part++) all.edges[part] += w.pieces[i].edges[part];
    sag_release(context, w.pieces, count * sizeof(sums));
    for (int k = 0; k < SAGI_RAW_COUNT; k++) result->raw.m[k] = all.sum[k] + all.carried[k];
    result->area = all.sum[SAGI_RAW_COUNT] + all.carried[SAGI_RAW_COUNT];
    result->balanced = all.edges[0] == 0 && all.edges[1] == 0 && result->area > 0;
    result->volume_error = 0x1p-49 * all.sum[SAGI_RAW_COUNT + 1];
    return true;
}
