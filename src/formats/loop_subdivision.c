// SPDX-License-Identifier: MIT
// Loop's scheme ("Smooth Subdivision Surfaces Based on Triangles", 1987): every triangle becomes four, with a
// new vertex on each edge. Old vertices move towards the mean of their neighbours, new ones are weighted
// means of the four around their edge; in the limit that is a smooth surface, and there are weights for where
// a vertex of any level ends on it, and for the two tangents there (Hoppe et al., "Piecewise Smooth Surface
// Reconstruction", 1994; Pharr, Jakob, Humphreys, "Physically Based Rendering", 3rd ed., 3.8). With n
// neighbours, β = 3/16 for n = 3 and 3/(8n) else:
//
//   old     (1 − nβ) p + β Σ neighbours                border: ¾ p + ⅛ (both neighbours on the border)
//   new     ⅜ (ends) + ⅛ (the two opposite)            border: ½ (ends)
//   limit   the same as old, with β = 1/(n + 3/(8β))   border: with ⅕ for ⅛
//   tangents Σ cos(2πj/n) pⱼ and Σ sin(2πj/n) pⱼ       border: along it, and Warren's weights across
// The border's limit is that of the book, and of pbrt, whose pictures are to agree with these; the curve of
// the border itself would end at 1/6. So is the side of the normals: they point to where the triangles are
// seen clockwise. (pbrt takes its tangents from limit points, which is right only for many levels.)
//
// The mesh is one of half-edges: number 3t + k leads from corner k of triangle t to the next, and twin[] is
// the one that leads back. Walking about a vertex is then: the next of the twin, or the twin of the previous.
// The children of triangle t are 4t + k at its corners k, and 4t + 3 in the middle with the new vertices as
// corners: so all twins of a level follow from those of the level before.
#include "formats/loop_subdivision.h"
#include "math/elementary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX
#define PI   3.14159265358979323846

typedef struct level {
    const sag_context *context;
    size_t vertex_count, triangle_count;
    sag_vec3 *points;  // of the vertices
    uint32_t *start;   // of each vertex: a half-edge that leaves it; NONE: it belongs to no triangle
    uint32_t *corners; // of the triangles
    uint32_t *twin;    // of the half-edges; NONE: a border
} level;

static uint32_t next_of(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static uint32_t previous_of(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

static void level_clear(level *l) {
    sag_release(l->context, l->points, l->vertex_count * sizeof *l->points);
    sag_release(l->context, l->start, l->vertex_count * sizeof *l->start);
    sag_release(l->context, l->corners, 3 * l->triangle_count * sizeof *l->corners);
    sag_release(l->context, l->twin, 3 * l->triangle_count * sizeof *l->twin);
    *l = (level){.context = l->context};
}

static bool level_make(level *l, const sag_context *context, size_t vertex_count, size_t triangle_count) {
    *l = (level){.context = context, .vertex_count = vertex_count, .triangle_count = triangle_count};
    l->points = sag_allocate(context, vertex_count * sizeof *l->points);
    l->start = sag_allocate(context, vertex_count * sizeof *l->start);
    l->corners = sag_allocate(context, 3 * triangle_count * sizeof *l->corners);
    l->twin = sag_allocate(context, 3 * triangle_count * sizeof *l->twin);
    if (l->points && l->start && l->corners && l->twin) return true;
    level_clear(l);
    return false;
}

// ---- the first level

// A half-edge by its two ends, the lower first.
typedef struct edge {
    uint64_t ends;
    uint32_t half;
} edge;

static int by_ends(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->ends != y->ends) return x->ends < y->ends ? -1 : 1;
    return (x->half > y->half) - (x->half < y->half);
}

// Two half-edges between the same ends that lead in opposite directions are twins.
static bool find_twins(level *l, uint32_t *borders) {
    const size_t count = 3 * l->triangle_count;
    edge *edges = sag_allocate(l->context, count * sizeof *edges);
    if (!edges) return false;
    memset(l->start, 0xFF, l->vertex_count * sizeof *l->start);
    for (uint32_t h = 0; h < count; h++) {
        const uint32_t from = l->corners[h], to = l->corners[next_of(h)];
        edges[h] = (edge){from < to ? (uint64_t)from << 32 | to : (uint64_t)to << 32 | from, h};
        l->start[from] = h;
        l->twin[h] = NONE;
    }
    qsort(edges, count, sizeof *edges, by_ends);
    *borders = 0;
    for (size_t i = 0, end = 0; i < count; i = end) {
        while (end < count && edges[end].ends == edges[i].ends) end++;
        const uint32_t a = edges[i].half, b = edges[end - 1].half;
        if (end - i == 2 && l->corners[a] != l->corners[b])
            l->twin[a] = b, l->twin[b] = a;
        else if (end - i > 1)
            ++*borders;
    }
    sag_release(l->context, edges, count * sizeof *edges);
    return true;
}

static bool first_level(const sagi_mesh_data *mesh, level *l, uint32_t *borders) {
    if (!level_make(l, mesh->context, mesh->vertex_count, mesh->triangle_count)) return false;
    for (size_t i = 0; i < l->vertex_count; i++) {
        const double *q = mesh->positions_f64 + 3 * i;
        l->points[i] = sag_vec3_make(q[0], q[1], q[2]);
    }
    memcpy(l->corners, mesh->triangles, 3 * l->triangle_count * sizeof *l->corners);
    if (find_twins(l, borders)) return true;
    level_clear(l);
    return false;
}

// ---- about a vertex

// The neighbours of a vertex, in the order of walking about it; on a border from one end to the other.
typedef struct ring {
    uint32_t edge; // the half-edge to go on from
    uint32_t count;
    bool border;
} ring;

static ring ring_of(const level *l, uint32_t vertex) {
    ring r = {.edge = l->start[vertex]};
    const uint32_t start = r.edge;
    uint32_t h = start;
    do { // to the last triangle in one direction
        r.count++;
        const uint32_t twin = l->twin[h];
        r.border = twin == NONE;
        if (!r.border) h = next_of(twin);
    } while (!r.border && h != start);
    if (!r.border) return r;
    r.edge = h;
    r.count = 2;
    for (; (h = l->twin[previous_of(h)]) != NONE; r.count++) {
    }
    return r;
}

// The place of neighbour j; to be called for 0, 1, 2 … of a ring.
static sag_vec3 ring_point(const level *l, ring *r, uint32_t j) {
    const uint32_t at = r->edge;
    if (!r->border) {
        r->edge = next_of(l->twin[at]);
        return l->points[l->corners[next_of(at)]];
    }
    if (j == 0) return l->points[l->corners[next_of(at)]]; // the first triangle has two
    r->edge = l->twin[previous_of(at)];
    return l->points[l->corners[previous_of(at)]];
}

static sag_vec3 weighted(const level *l, uint32_t vertex, double interior_weight, double border_weight) {
    ring r = ring_of(l, vertex);
    const sag_vec3 p = l->points[vertex];
    sag_vec3 sum = {0, 0, 0};
    for (uint32_t j = 0; j < r.count; j++) {
        const sag_vec3 q = ring_point(l, &r, j);
        if (!r.border || j == 0 || j + 1 == r.count) sum = sag_add(sum, q);
    }
    const double weight = r.border ? border_weight : interior_weight, n = r.border ? 2 : r.count;
    return sag_add(sag_scale(p, 1 - n * weight), sag_scale(sum, weight));
}

static uint32_t neighbour_count(const level *l, uint32_t vertex) { return ring_of(l, vertex).count; }

static double beta(uint32_t n) { return n == 3 ? 3.0 / 16 : 3.0 / (8.0 * n); }

static sag_vec3 moved(const level *l, uint32_t vertex) {
    if (l->start[vertex] == NONE) return l->points[vertex];
    return weighted(l, vertex, beta(neighbour_count(l, vertex)), 1.0 / 8);
}

static sag_vec3 at_limit(const level *l, uint32_t vertex) {
    if (l->start[vertex] == NONE) return l->points[vertex];
    const uint32_t n = neighbour_count(l, vertex);
    return weighted(l, vertex, 1 / (n + 3 / (8 * beta(n))), 1.0 / 5);
}

// The product of the tangents, which belong to the limit surface though the weights are the level's
// vertices'.
static sag_vec3 normal_at(const level *l, uint32_t vertex) {
    sag_vec3 s = {0, 0, 0}, t = {0, 0, 0};
    if (l->start[vertex] == NONE) return s;
    const sag_vec3 p = l->points[vertex];
    ring r = ring_of(l, vertex);
    const uint32_t n = r.count;
    const double angle = PI / (n - 1.0);
    for (uint32_t j = 0; j < n; j++) {
        const sag_vec3 q = ring_point(l, &r, j);
        double across = 0, along = (j + 1 == n) - (double)(j == 0);
        if (!r.border)
            along = sagi_cos(2 * PI * j / n), across = sagi_sin(2 * PI * j / n);
        else if (n == 2)
            across = 1;
        else if (n == 3)
            across = j == 1;
        else if (n == 4)
            across = j == 1 || j == 2 ? 2 : -1;
        else
            across =
                j == 0 || j + 1 == n ? -sagi_sin(angle) : (2 - 2 * sagi_cos(angle)) * sagi_sin(j * angle);
        // Differences from p: the weights' sums are worked off below, and large coordinates cancel early.
        s = sag_add(s, sag_scale(sag_sub(q, p), along));
        t = sag_add(t, sag_scale(sag_sub(q, p), across));
    }
    const sag_vec3 normal = sag_cross(s, t);
    return sag_dot(normal, normal) > 0 ? sag_normalize(normal) : (sag_vec3){0, 0, 0};
}

// ---- from level to level

// The numbers of the new vertices, by half-edge; returns how many vertices there are then.
static size_t number_edges(const level *l, uint32_t *middle) {
    size_t count = l->vertex_count;
    for (uint32_t h = 0; h < 3 * l->triangle_count; h++)
        middle[h] = l->twin[h] != NONE && l->twin[h] < h ? middle[l->twin[h]] : (uint32_t)count++;
    return count;
}

static void place_points(const level *l, const uint32_t *middle, level *finer) {
    for (uint32_t v = 0; v < l->vertex_count; v++) {
        finer->points[v] = moved(l, v);
        const uint32_t h = l->start[v];
        finer->start[v] = h == NONE ? NONE : 3 * (4 * (h / 3) + h % 3) + h % 3;
    }
    for (uint32_t h = 0; h < 3 * l->triangle_count; h++) {
        const uint32_t twin = l->twin[h];
        if (twin != NONE && twin < h) continue;
        const sag_vec3 ends = sag_add(l->points[l->corners[h]], l->points[l->corners[next_of(h)]]);
        sag_vec3 q = sag_scale(ends, 0.5);
        if (twin != NONE) {
            const sag_vec3 opposite =
                sag_add(l->points[l->corners[previous_of(h)]], l->points[l->corners[previous_of(twin)]]);
            q = sag_add(sag_scale(ends, 3.0 / 8), sag_scale(opposite, 1.0 / 8));
        }
        finer->points[middle[h]] = q;
        finer->start[middle[h]] = 3 * (4 * (h / 3) + 3) + h % 3;
    }
}

static void connect(const level *l, const uint32_t *middle, level *finer) {
    for (uint32_t t = 0; t < l->triangle_count; t++) {
        const uint32_t center = 3 * (4 * t + 3);
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t h = 3 * t + k, next = (k + 1) % 3, previous = (k + 2) % 3, child = 3 * (4 * t + k);
            finer->corners[child + k] = l->corners[h];
            finer->corners[child + next] = middle[h];
            finer->corners[child + previous] = middle[3 * t + previous];
            finer->corners[center + k] = middle[h];
            finer->twin[child + next] = center + previous;
            finer->twin[center + previous] = child + next;
            // Halves of the edges: a half belongs to the child at its end of the edge.
            const uint32_t out = l->twin[h], in = l->twin[3 * t + previous];
            finer->twin[child + k] = out == NONE ? NONE : 3 * (4 * (out / 3) + next_of(out) % 3) + out % 3;
            finer->twin[child + previous] = in == NONE ? NONE : 3 * (4 * (in / 3) + in % 3) + in % 3;
        }
    }
}

static bool refine(level *l) {
    const sag_context *context = l->context;
    const size_t edges = 3 * l->triangle_count;
    uint32_t *middle = sag_allocate(context, edges * sizeof *middle);
    level finer;
    const bool good =
        middle && level_make(&finer, l->context, number_edges(l, middle), 4 * l->triangle_count);
    if (good) {
        place_points(l, middle, &finer);
        connect(l, middle, &finer);
        level_clear(l);
        *l = finer;
    }
    sag_release(context, middle, edges * sizeof *middle);
    return good;
}

static bool hand_over(level *l, sagi_mesh_data *out) {
    const size_t n = l->vertex_count;
    *out = (sagi_mesh_data){.context = l->context, .vertex_count = (uint32_t)n};
    out->positions_f64 = sag_allocate(l->context, 3 * n * sizeof(double));
    out->normals = sag_allocate(l->context, 3 * n * sizeof(float));
    if (!out->positions_f64 || !out->normals) {
        sagi_mesh_data_clear(out);
        return false;
    }
    for (uint32_t v = 0; v < n; v++) {
        const sag_vec3 p = at_limit(l, v), normal = normal_at(l, v);
        const double place[3] = {p.x, p.y, p.z}, direction[3] = {normal.x, normal.y, normal.z};
        for (size_t k = 0; k < 3; k++) {
            out->positions_f64[3 * (size_t)v + k] = place[k];
            out->normals[3 * (size_t)v + k] = (float)direction[k];
        }
    }
    out->triangles = l->corners;
    out->triangle_count = (uint32_t)l->triangle_count;
    out->triangle_capacity = l->triangle_count;
    l->corners = NULL;
    return true;
}

bool sagi_loop_subdivide(const sagi_mesh_data *mesh, uint32_t levels, sagi_mesh_data *out,
                         uint32_t *borders) {
    level l;
    if (!first_level(mesh, &l, borders)) return false;
    bool good = true;
    for (uint32_t i = 0; i < levels && good; i++) good = refine(&l);
    good = good && hand_over(&l, out);
    level_clear(&l);
    return good;
}
