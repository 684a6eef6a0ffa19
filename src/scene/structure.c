// SPDX-License-Identifier: MIT
// From a snapshot's geometries to its tree.
//
// All primitives of all geometries are numbered through and taken in chunks by all threads, twice: first to
// find out which are good and where everything lies, then, once it is known, to write their boxes as floats
// relative to the middle of it all, each chunk to its own place. Nothing depends on who does which chunk.
#include "base/context.h"
#include "scene/scene.h"
#include <string.h>

#define CHUNK 4096u

typedef struct chunk {
    sagi_survey found;
    uint64_t good_first, unbounded_first; // where this chunk's go
} chunk;

typedef struct work {
    sagi_snapshot *snapshot;
    uint64_t *first; // of each geometry's primitives in the numbering; one more than there are geometries
    uint64_t count;
    chunk *chunks;
    size_t chunk_count;
    sagi_bvh_primitive *primitives; // in the second round
    uint64_t good;
} work;

// Visits the primitives of a chunk one after the other.
typedef struct visitor {
    const work *w;
    uint64_t at, end;
    uint32_t geometry;
} visitor;

static visitor visit(const work *w, size_t index) {
    visitor v = {.w = w, .at = (uint64_t)index * CHUNK};
    v.end = w->count - v.at < CHUNK ? w->count : v.at + CHUNK;
    uint32_t low = 0, high = w->snapshot->count; // the last geometry with first ≤ at
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (w->first[middle] <= v.at)
            low = middle;
        else
            high = middle;
    }
    v.geometry = low;
    return v;
}

// Primitives of one geometry that follow one another.
typedef struct run {
    uint32_t geometry, first, count;
} run;

static bool next(visitor *v, run *r) {
    if (v->at == v->end) return false;
    while (v->at >= v->w->first[v->geometry + 1]) v->geometry++;
    uint64_t end = v->w->first[v->geometry + 1];
    r->geometry = v->geometry;
    r->first = (uint32_t)(v->at - v->w->first[v->geometry]);
    r->count = (uint32_t)((end < v->end ? end : v->end) - v->at);
    v->at += r->count;
    return true;
}

static void survey_run(const sagi_snapshot *s, run r, sagi_survey *found) {
    for (uint32_t i = r.first; i < r.first + r.count; i++) {
        sag_box3 box;
        switch (sagi_primitive_box(s, r.geometry, i, &box)) {
        case SAGI_PRIMITIVE_GOOD:
            found->good++;
            found->bounds = sag_box3_union(found->bounds, box);
            break;
        case SAGI_PRIMITIVE_NOT_FINITE: found->not_finite++; break;
        case SAGI_PRIMITIVE_DEGENERATE: found->degenerate++; break;
        case SAGI_PRIMITIVE_UNBOUNDED: found->unbounded++; break;
        case SAGI_PRIMITIVE_EMPTY: break;
        }
    }
}

static void survey(void *argument, size_t index) {
    const work *w = argument;
    sagi_survey found = {.bounds = sag_box3_empty()};
    visitor v = visit(w, index);
    for (run r; next(&v, &r);) {
        const sagi_item *item = &w->snapshot->items[r.geometry];
        if (item->kind == SAG_SHAPE_MESH)
            sagi_mesh_survey(item->shape, r.first, r.count, &found);
        else
            survey_run(w->snapshot, r, &found);
    }
    w->chunks[index].found = found;
}

// (x − origin)·scale rounded down: the difference errs by at most 2⁻⁵³ of itself, the scaling not at all but
// where it underflows, which 2⁻¹⁴⁹, the step of float_down, is far above.
static float float_below(double x, double origin, double scale) {
    double d = (x - origin) * scale;
    return sagi_float_down(d - fabs(d) * 0x1p-52);
}
static float float_above(double x, double origin, double scale) { return -float_below(-x, -origin, scale); }

sagi_bvh_primitive sagi_world_primitive(const sagi_world *world, const sag_box3 *box, uint32_t geometry,
                                        uint32_t primitive) {
    const sag_vec3 o = world->origin;
    const double scale = world->scale;
    return (sagi_bvh_primitive){
        .lo = {float_below(box->min.x, o.x, scale), float_below(box->min.y, o.y, scale),
               float_below(box->min.z, o.z, scale)},
        .geometry = geometry,
        .hi = {float_above(box->max.x, o.x, scale), float_above(box->max.y, o.y, scale),
               float_above(box->max.z, o.z, scale)},
        .primitive = primitive,
    };
}

static void write_boxes(void *argument, size_t index) {
    const work *w = argument;
    sagi_snapshot *s = w->snapshot;
    const chunk *c = &w->chunks[index];
    sagi_bvh_primitive *out = w->primitives + c->good_first;
    uint64_t unbounded = c->unbounded_first;
    visitor v = visit(w, index);
    bool all_good = c->found.good == v.end - v.at;
    for (run r; next(&v, &r);) {
        if (s->items[r.geometry].kind == SAG_SHAPE_MESH) {
            out = sagi_mesh_boxes(&s->world, r.geometry, r.first, r.count, all_good, out);
            continue;
        }
        for (uint32_t i = r.first; i < r.first + r.count; i++) {
            sag_box3 box;
            sagi_primitive_state state = sagi_primitive_box(s, r.geometry, i, &box);
            if (state == SAGI_PRIMITIVE_UNBOUNDED)
                s->unbounded[unbounded++] = (sagi_bvh_reference){r.geometry, i};
            if (state == SAGI_PRIMITIVE_GOOD) *out++ = sagi_world_primitive(&s->world, &box, r.geometry, i);
        }
    }
}

// The world's units: its middle, and the power of two that brings everything within [−1, 1].
static void choose_units(sagi_snapshot *s) {
    const sag_box3 *b = &s->stats.bounds;
    s->world.origin = (sag_vec3){0, 0, 0};
    s->world.scale = 1;
    if (sag_box3_is_empty(b)) return;
    sag_vec3 c = sag_scale(sag_add(b->min, b->max), 0.5);
    double reach = fmax(sag_max_component(sag_sub(b->max, c)), sag_max_component(sag_sub(c, b->min)));
    int exponent;
    frexp(reach, &exponent);
    s->world.origin = c;
    s->world.scale = ldexp(1, -(exponent < -900 ? -900 : exponent));
}

// The same for the kernel's eyes; the fourth place means nothing.
static void describe_units(sagi_snapshot *s) {
    const sagi_float_box *b = &s->world.tree.box;
    s->world.center = (sagi_d4){s->world.origin.x, s->world.origin.y, s->world.origin.z, 0};
    s->world.lower = (sagi_d4){b->lo[0], b->lo[1], b->lo[2], 0};
    s->world.upper = (sagi_d4){b->hi[0], b->hi[1], b->hi[2], 0};
}

// ‖A‖∞, the largest row sum, of |M|, of |M⁻¹| and of |M||M⁻¹|, and |M| times the largest |translation back|.
static double row_norm(const sag_affine *a) {
    double norm = 0;
    for (int i = 0; i < 3; i++) norm = fmax(norm, fabs(a->m[i][0]) + fabs(a->m[i][1]) + fabs(a->m[i][2]));
    return norm;
}

// World.spread (world.h). A ray (o, d) brought to an object's space errs there by at most, coordinate by
// coordinate, 6u(|M⁻¹|(|o| + t|d|) + |t⁻¹|): the entries of the inverse are within an ulp, three products and
// three sums follow. Brought back by |M| that is below 2⁻⁵⁰ (K (|o|∞ + t|d|∞) + A) with K = ‖M‖‖M⁻¹‖ and
// A = ‖M‖|t⁻¹|∞; where a hit is, t|d|∞ ≤ |o|∞ + R, R the scene's largest coordinate. An instance's child
// world has a spread of its own (and 2 for the shapes' own rounding), seen from an origin of at most
// ‖M⁻¹‖|o|∞ + |t⁻¹|∞ and enlarged by ‖M‖.
static void add_spread(sagi_snapshot *s, const sagi_place *place, const sagi_world *child) {
    double forth = 1, back = 1, shift = 0;
    double relative = 0, absolute = 0;
    if (place != NULL) {
        forth = row_norm(&place->to_scene), back = row_norm(&place->to_object);
        for (int i = 0; i < 3; i++) shift = fmax(shift, fabs(place->to_object.m[i][3]));
        relative = 2 * forth * back;
        absolute = forth * back * s->radius + forth * shift;
    }
    if (child != NULL) {
        relative += forth * back * (child->spread_relative + 2);
        absolute += forth * ((child->spread_relative + 2) * shift + child->spread_absolute);
    }
    s->world.spread_relative = fmax(s->world.spread_relative, relative);
    s->world.spread_absolute = fmax(s->world.spread_absolute, absolute);
}

void sagi_snapshot_measure(sagi_snapshot *s) {
    const sag_box3 *b = &s->stats.bounds;
    if (!sag_box3_is_empty(b))
        s->radius = fmax(sag_max_component(sag_abs(b->min)), sag_max_component(sag_abs(b->max)));
    for (uint32_t i = 0; i < s->count; i++)
        if (s->entries[i].present && (s->items[i].place != NULL || s->items[i].child != NULL))
            add_spread(s, s->items[i].place, s->items[i].child);
    describe_units(s);
    s->stats.node_count = s->world.tree.node_count;
    s->stats.leaf_count = s->world.tree.leaf_count;
    s->stats.depth = s->world.tree.depth;
    s->stats.sah = (double)s->world.tree.sah;
    s->stats.structure_bytes = sagi_bvh_bytes(&s->world.tree) + s->unbounded_capacity * sizeof *s->unbounded;
}

static void sum_up(work *w) {
    sagi_snapshot *s = w->snapshot;
    uint64_t good = 0, unbounded = 0;
    s->stats.bounds = sag_box3_empty();
    for (size_t i = 0; i < w->chunk_count; i++) {
        const sagi_survey *found = &w->chunks[i].found;
        w->chunks[i].good_first = good, w->chunks[i].unbounded_first = unbounded;
        good += found->good, unbounded += found->unbounded;
        s->stats.dropped_not_finite += found->not_finite;
        s->stats.dropped_degenerate += found->degenerate;
        s->stats.bounds = sag_box3_union(s->stats.bounds, found->bounds);
    }
    w->good = good;
    s->stats.primitive_count = good + unbounded;
    s->world.unbounded_count = s->unbounded_capacity = (uint32_t)unbounded;
}

static void number_primitives(work *w) {
    w->first[0] = 0;
    for (uint32_t i = 0; i < w->snapshot->count; i++)
        w->first[i + 1] = w->first[i] + sagi_primitive_count(w->snapshot, i);
    w->count = w->first[w->snapshot->count];
    w->chunk_count = (size_t)((w->count + CHUNK - 1) / CHUNK);
}

// Both rounds and the tree; w->first and w->chunks are allocated.
static sag_status build(work *w) {
    sagi_snapshot *s = w->snapshot;
    const sag_context *context = s->context;
    sag_parallel_for(context, w->chunk_count, survey, w);
    sum_up(w);
    choose_units(s);
    if (w->good > INT32_MAX || s->stats.primitive_count > UINT32_MAX) return SAG_ERROR_ARGUMENT;
    size_t bytes = (size_t)w->good * sizeof *w->primitives;
    w->primitives = sag_allocate(context, bytes);
    s->unbounded = sag_allocate(context, s->unbounded_capacity * sizeof *s->unbounded);
    s->world.unbounded = s->unbounded;
    sag_status status = SAG_ERROR_MEMORY;
    if ((w->good == 0 || w->primitives != NULL) && (s->unbounded_capacity == 0 || s->unbounded != NULL)) {
        sag_parallel_for(context, w->chunk_count, write_boxes, w);
        sagi_bvh_options options = {.quality = s->quality,
                                    .leaves = {s, sagi_leaf_price, sagi_leaf_units, sagi_leaf_write}};
        status = sagi_bvh_build(context, &options, w->primitives, (uint32_t)w->good, &s->world.tree);
    }
    sag_release(context, w->primitives, bytes);
    return status;
}

sag_status sagi_snapshot_build(sagi_snapshot *s) {
    work w = {.snapshot = s};
    size_t first_bytes = ((size_t)s->count + 1) * sizeof *w.first;
    w.first = sag_allocate(s->context, first_bytes);
    if (w.first == NULL) return SAG_ERROR_MEMORY;
    number_primitives(&w);
    size_t chunk_bytes = w.chunk_count * sizeof *w.chunks;
    w.chunks = sag_allocate(s->context, chunk_bytes);
    sag_status status = w.chunks != NULL || chunk_bytes == 0 ? build(&w) : SAG_ERROR_MEMORY;
    sag_release(s->context, w.chunks, chunk_bytes);
    sag_release(s->context, w.first, first_bytes);
    sagi_snapshot_measure(s);
    return status;
}
