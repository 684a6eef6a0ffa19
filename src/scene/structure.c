// SPDX-License-Identifier: MIT
// From a group's geometries to its tree.
//
// All primitives of all members are numbered through and taken in chunks by all threads, twice: first to
// find out which are good and where everything lies, then, once the scene's units are known, to write their
// boxes as floats relative to these, each chunk to its own place. Nothing depends on who does which chunk.
#include "scene/structure.h"
#include "base/context.h"

#define CHUNK 1024u

typedef struct sagi_chunk {
    sagi_survey found;
    uint64_t good_first, unbounded_first; // where this chunk's go, counted from the group's first
} sagi_chunk;

// Visits the primitives of a chunk one after the other.
typedef struct visitor {
    const sagi_structure *w;
    uint64_t at, end;
    uint32_t member;
} visitor;

static visitor visit(const sagi_structure *w, size_t index) {
    visitor v = {.w = w, .at = (uint64_t)index * CHUNK};
    v.end = w->count - v.at < CHUNK ? w->count : v.at + CHUNK;
    uint32_t low = 0, high = w->group->member_count; // the last member with first ≤ at
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (w->first[middle] <= v.at)
            low = middle;
        else
            high = middle;
    }
    v.member = low;
    return v;
}

// Primitives of one geometry that follow one another.
typedef struct run {
    uint32_t geometry, first, count;
} run;

static bool next(visitor *v, run *r) {
    if (v->at == v->end) return false;
    const sagi_structure *w = v->w;
    while (v->at >= w->first[v->member + 1]) v->member++;
    uint64_t end = w->first[v->member + 1];
    r->geometry = w->snapshot->members[w->group->member_first + v->member];
    r->first = (uint32_t)(v->at - w->first[v->member]);
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
    const sagi_structure *w = argument;
    sagi_survey found = {.bounds = sag_box3_empty()};
    visitor v = visit(w, index);
    for (run r; next(&v, &r);) {
        const sagi_item *item = &w->snapshot->items[r.geometry];
        if (w->snapshot->solid != NULL)
            survey_run(w->snapshot, r, &found);
        else if (item->kind == SAG_SHAPE_MESH)
            sagi_mesh_survey(item->shape, r.first, r.count, &found);
        else if (item->kind == SAG_SHAPE_SPHERES && item->place == NULL)
            sagi_sphere_survey(item->shape, r.first, r.count, &found);
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
    const sagi_structure *w = argument;
    sagi_snapshot *s = w->snapshot;
    const sagi_chunk *c = &w->chunks[index];
    sagi_bvh_primitive *out = w->primitives + c->good_first;
    uint64_t unbounded = w->group->unbounded_first + c->unbounded_first;
    visitor v = visit(w, index);
    bool all_good = c->found.good == v.end - v.at;
    for (run r; next(&v, &r);) {
        if (s->items[r.geometry].kind == SAG_SHAPE_MESH && s->solid == NULL) {
            out = sagi_mesh_boxes(&s->world, r.geometry, r.first, r.count, all_good, out);
            continue;
        }
        if (s->items[r.geometry].kind == SAG_SHAPE_SPHERES && s->items[r.geometry].place == NULL &&
            s->solid == NULL) {
            out = sagi_sphere_boxes(&s->world, r.geometry, r.first, r.count, out);
            continue;
        }
        for (uint32_t i = r.first; i < r.first + r.count; i++) {
            sag_box3 box;
            sagi_primitive_state state = sagi_primitive_box(s, r.geometry, i, &box);
            if (state == SAGI_PRIMITIVE_UNBOUNDED)
                s->unbounded[unbounded++] = (sagi_bvh_reference){r.geometry, i};
            if (state != SAGI_PRIMITIVE_GOOD) continue;
            *out++ = s->solid == NULL && sagi_is_lone_sphere(&s->items[r.geometry])
                         ? sagi_world_primitive(&s->world, &box, SAGI_LONE_SPHERES, r.geometry)
                         : sagi_world_primitive(&s->world, &box, r.geometry, i);
        }
    }
}

// What rays that begin within 64 scenes' sizes have in common (kernel/ray.h): |o|∞ ≤ |C|∞ + 64/scale.
static struct sagi_quick describe_quick(const sagi_world *w) {
    double furthest = sag_max_component(sag_abs(w->origin)) + 64 / w->scale;
    double spread = (furthest * w->spread_relative + w->spread_absolute) * w->scale * 0x1p-50 * (1 + 0x1p-20);
    if (!w->has_spread) spread = 0;
    if (!(spread < 1)) spread = INFINITY;
    return (struct sagi_quick){.error = 0x1p-43 + spread,
                               .finest = sagi_finest_of(0x1p-43 + spread),
                               .wide = (float)((0x1p-40 + spread) * (1 + 0x1p-20))};
}

// The same for the kernel's eyes; the fourth place means nothing.
static void describe_units(sagi_snapshot *s) {
    const sagi_float_box *b = &s->world.tree.box;
    s->world.has_spread = s->world.spread_relative != 0 || s->world.spread_absolute != 0;
    s->world.center = (sagi_d4){s->world.origin.x, s->world.origin.y, s->world.origin.z, 0};
    s->world.lower = (sagi_d4){b->lo[0], b->lo[1], b->lo[2], 0};
    s->world.upper = (sagi_d4){b->hi[0], b->hi[1], b->hi[2], 0};
    s->world.units = (sagi_d4){0, s->world.scale, 1, 1};
    s->world.unit = 1 / s->world.scale;
    s->world.quick = describe_quick(&s->world);
    s->world.quick_center = s->world.center;
    if (!(s->world.quick.error < INFINITY)) s->world.quick_center = (sagi_d4){NAN, NAN, NAN, NAN};
    s->world.plain = s->world.tree.node_count > 0 && s->world.unbounded_count == 0 && s->world.solid == NULL;
    if (s->world.tree.node_count == 0) return;
    s->world.places = (sagi_places){
        {(uintptr_t)s->world.tree.nodes, (uintptr_t)s->world.tree.leaves - SAGI_BVH_LEAF * SAGI_BVH_UNIT},
        {SAGI_BVH_STEP, SAGI_BVH_UNIT}};
    for (uint32_t signs = 0; signs < 8; signs++)
        for (uint32_t k = 0; k < 3; k++) {
            const bool falls = (signs >> k & 1) != 0;
            const sagi_bvh_node *first = s->world.tree.nodes;
            s->world.planes[signs].near_plane[k] = (const char *)first->plane[falls ? k + 3 : k];
            s->world.planes[signs].far_plane[k] = (const char *)first->plane[falls ? k : k + 3];
        }
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
    if (s->solid != NULL) {
        // Crossings within 2⁻⁴⁹ (|o|∞ + t|d|∞) of each other are looked at together, a few of them in a row.
        s->world.spread_relative += 8;
        s->world.spread_absolute += 4 * s->radius;
    }
    describe_units(s);
    s->stats.node_count = s->world.tree.node_count;
    s->stats.leaf_count = s->world.tree.leaf_count;
    s->stats.depth = s->world.tree.depth;
    s->stats.sah = (double)s->world.tree.sah;
    s->stats.structure_bytes = sagi_bvh_bytes(&s->world.tree) + s->unbounded_capacity * sizeof *s->unbounded;
    for (uint32_t i = 0; i < s->count; i++) {
        if (s->entries[i].alone == NULL) continue;
        const sag_scene_stats *alone = &s->entries[i].alone->stats;
        s->stats.structure_bytes += alone->structure_bytes;
        s->stats.dropped_not_finite += alone->dropped_not_finite;
        s->stats.dropped_degenerate += alone->dropped_degenerate;
    }
}

static void sum_up(sagi_structure *w) {
    sagi_survey *all = &w->group->found;
    *all = (sagi_survey){.bounds = sag_box3_empty()};
    for (size_t i = 0; i < w->chunk_count; i++) {
        const sagi_survey *found = &w->chunks[i].found;
        w->chunks[i].good_first = all->good, w->chunks[i].unbounded_first = all->unbounded;
        all->good += found->good, all->unbounded += found->unbounded;
        all->not_finite += found->not_finite, all->degenerate += found->degenerate;
        all->bounds = sag_box3_union(all->bounds, found->bounds);
    }
}

static size_t first_bytes(const sagi_structure *w) {
    return (w->group->member_count + (size_t)1) * sizeof *w->first;
}

sag_status sagi_structure_survey(sagi_structure *w) {
    const sag_context *context = w->snapshot->context;
    const uint32_t *members = w->snapshot->members + w->group->member_first;
    w->first = sag_allocate(context, first_bytes(w));
    if (w->first == NULL) return SAG_ERROR_MEMORY;
    w->first[0] = 0;
    for (uint32_t i = 0; i < w->group->member_count; i++)
        w->first[i + 1] = w->first[i] + sagi_primitive_count(w->snapshot, members[i]);
    w->count = w->first[w->group->member_count];
    w->chunk_count = (size_t)((w->count + CHUNK - 1) / CHUNK);
    w->chunks = sag_allocate(context, w->chunk_count * sizeof *w->chunks);
    if (w->chunk_count > 0 && w->chunks == NULL) return SAG_ERROR_MEMORY;
    sag_parallel_for(context, w->chunk_count, survey, w);
    sum_up(w);
    return SAG_OK;
}

sag_status sagi_structure_build(sagi_structure *w, sagi_bvh *tree) {
    sagi_snapshot *s = w->snapshot;
    size_t bytes = (size_t)w->group->found.good * sizeof *w->primitives;
    w->primitives = sag_allocate(s->context, bytes);
    if (bytes > 0 && w->primitives == NULL) return SAG_ERROR_MEMORY;
    sag_parallel_for(s->context, w->chunk_count, write_boxes, w);
    sagi_bvh_options options = {.quality = s->quality,
                                .leaves = {s, sagi_leaf_price, sagi_leaf_units, sagi_leaf_write},
                                .clipper = {s, sagi_primitive_corners}};
    sag_status status =
        sagi_bvh_build(s->context, &options, w->primitives, (uint32_t)w->group->found.good, tree);
    sag_release(s->context, w->primitives, bytes);
    sagi_structure_release(w);
    return status;
}

void sagi_structure_release(sagi_structure *w) {
    const sag_context *context = w->snapshot->context;
    sag_release(context, w->chunks, w->chunk_count * sizeof *w->chunks);
    if (w->first != NULL) sag_release(context, w->first, first_bytes(w));
    w->chunks = NULL, w->first = NULL, w->chunk_count = 0;
}
