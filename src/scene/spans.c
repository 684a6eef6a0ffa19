// SPDX-License-Identifier: MIT
// The intervals of a ray within bodies.
//
// A line passes from outside a body to its inside and back at every crossing. So the intervals of one body
// follow from its crossings in order of t and from where the line begins at −∞: outside, unless the body is
// unbounded (shapes/closed.h). Crossings before t_min are followed too, for they say whether the ray begins
// inside, unless it begins clear of everything; those beyond t_max are of no interest. Several crossings of
// one body at the same t count as one when they are odd, as none when they are even: so there are no
// intervals without length.
//
// In what order? By time, bodies overlap, and as many of them may be open at once as there are. One body
// after the other there is one open interval at most: nothing has to be remembered but that. But the
// traversal finds crossings in an order of its own, and no memory is asked for. So the first KEPT, in order
// of body and then of t, are kept in a heap; when more came than were kept, the scene is walked again for
// those after the last one. n crossings cost n/KEPT + 1 walks, one in practice. (One of a mesh may be found
// several times, see sagi_visitor: then they are neighbours in this order, and the same.)
//
// The intervals come out body by body as well; the caller's array is a heap of the first `capacity` of them
// by the order that was promised, sorted at the end.
//
// Unbounded bodies may hold the whole ray, with no crossing that would tell of them. They stand in lists of
// their own, which are gone through afterwards.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include "shapes/spheres.h"
#include <sagitta/solid.h>
#include <string.h>

#define KEPT 192u

// A crossing and which body's: the first `depth` ids of its path, then a geometry (SAG_INVALID_ID: the path
// leads to a solid) and, for a set of spheres, a sphere.
typedef struct event {
    sag_hit hit;
    uint32_t depth, geometry, part;
} event;

typedef struct search {
    const sagi_snapshot *scene;
    const sagi_kernel *kernel;
    sag_ray line; // to the ray's t_max, from −∞ where bodies may be before t_min
    double t_min; // the ray's own
    sag_span *spans;
    size_t capacity, count;
    // this walk
    event *kept;
    size_t event_count; // all that came
    bool again;         // not the first walk: it takes what comes after `last`
    event last;
    // the body whose crossings are gone through
    bool any, inside;
    event body;    // its first crossing
    sag_hit enter; // when inside
    size_t equal;  // crossings at the t of `first`, which are not yet done
    sag_hit first;
} search;

static int compare_ids(uint32_t a, uint32_t b) { return a < b ? -1 : a > b; }

static int compare_bodies(const event *a, const event *b) {
    for (uint32_t i = 0; i < a->depth && i < b->depth; i++)
        if (a->hit.instance_path[i] != b->hit.instance_path[i])
            return compare_ids(a->hit.instance_path[i], b->hit.instance_path[i]);
    if (a->depth != b->depth) return compare_ids(a->depth, b->depth);
    if (a->geometry != b->geometry) return compare_ids(a->geometry, b->geometry);
    return compare_ids(a->part, b->part);
}

static bool event_before(const event *a, const event *b) {
    int bodies = compare_bodies(a, b);
    return bodies != 0 ? bodies < 0 : sagi_hit_before(&a->hit, &b->hit);
}

// Puts `e` into the hole at `place`, moving later children up: the last one is on top.
static void sift_event(event *events, size_t count, size_t place, const event *e) {
    for (size_t child; (child = 2 * place + 1) < count; place = child) {
        if (child + 1 < count && event_before(&events[child], &events[child + 1])) child++;
        if (!event_before(e, &events[child])) break;
        events[place] = events[child];
    }
    events[place] = *e;
}

// The line as it is in the space that a path leads to.
static sag_ray follow(const sagi_snapshot **s, const sag_ray *line, const uint32_t *path, uint32_t depth) {
    sag_ray here = *line;
    for (uint32_t i = 0; i < depth; i++) {
        const sagi_place *place = (*s)->items[path[i]].place;
        if (place != NULL) here = sag_ray_transform(&place->to_object, &here);
        *s = (*s)->entries[path[i]].child;
    }
    return here;
}

// Whether the crossing with a torus is a boundary. (closed.h; asked of spindles only)
static bool is_outer(const search *s, const sagi_item *item, const sag_hit *hit) {
    const sagi_snapshot *where = s->scene;
    sag_ray line = follow(&where, &s->line, hit->instance_path, hit->instance_depth);
    if (item->place != NULL) line = sag_ray_transform(&item->place->to_object, &line);
    line.t_min = -INFINITY, line.t_max = INFINITY;
    sag_hit all[4];
    size_t count = sag_torus_crossings(item->shape, &line, all, 4);
    count = sagi_torus_leave_outer(item->shape, &line, all, count);
    for (size_t i = 0; i < count; i++)
        if (all[i].t == hit->t) return true;
    return false;
}

// Which body a crossing is of; false when of none.
static bool find_body(const search *from, const sag_hit *hit, event *e) {
    const sagi_snapshot *s = from->scene;
    uint32_t depth = 0;
    for (; depth < hit->instance_depth && !sagi_snapshot_is_solid(s); depth++)
        s = s->entries[hit->instance_path[depth]].child;
    *e = (event){.hit = *hit, .depth = depth, .geometry = SAG_INVALID_ID};
    if (sagi_snapshot_is_solid(s)) return true;
    const sagi_item *item = &s->items[hit->geometry];
    e->geometry = hit->geometry;
    if (item->kind == SAG_SHAPE_SPHERES) {
        e->part = hit->primitive;
        return true;
    }
    if (item->kind == SAG_SHAPE_TORUS) {
        const sag_torus *torus = item->shape;
        return torus->major_radius >= torus->minor_radius || is_outer(from, item, hit);
    }
    return sagi_geometry_is_closed(s, hit->geometry);
}

static void take(void *user, const sag_hit *hit) {
    search *s = user;
    event e;
    if (!find_body(s, hit, &e) || (s->again && !event_before(&s->last, &e))) return;
    size_t place = s->event_count++;
    if (place >= KEPT) {
        if (event_before(&e, &s->kept[0])) sift_event(s->kept, KEPT, 0, &e);
        return;
    }
    for (; place > 0 && event_before(&s->kept[(place - 1) / 2], &e); place = (place - 1) / 2)
        s->kept[place] = s->kept[(place - 1) / 2];
    s->kept[place] = e;
}

// By where it begins, then by body. (Two of the same body do not begin at the same place, except spheres of
// one set that hold the ray's beginning.)
static bool span_before(const sag_span *a, const sag_span *b) {
    if (sagi_hit_before(&a->enter, &b->enter)) return true;
    return !sagi_hit_before(&b->enter, &a->enter) && sagi_hit_before(&a->leave, &b->leave);
}

static void sift_span(sag_span *spans, size_t count, size_t place, sag_span span) {
    for (size_t child; (child = 2 * place + 1) < count; place = child) {
        if (child + 1 < count && span_before(&spans[child], &spans[child + 1])) child++;
        if (!span_before(&span, &spans[child])) break;
        spans[place] = spans[child];
    }
    spans[place] = span;
}

static void add_span(search *s, const sag_hit *enter, const sag_hit *leave) {
    const sag_span span = {*enter, *leave};
    size_t place = s->count++;
    if (place >= s->capacity) {
        if (s->capacity > 0 && span_before(&span, &s->spans[0])) sift_span(s->spans, s->capacity, 0, span);
        return;
    }
    for (; place > 0 && span_before(&s->spans[(place - 1) / 2], &span); place = (place - 1) / 2)
        s->spans[place] = s->spans[(place - 1) / 2];
    s->spans[place] = span;
}

static void sort_spans(search *s) {
    for (size_t n = s->count < s->capacity ? s->count : s->capacity; n > 1; n--) {
        sag_span last = s->spans[n - 1];
        s->spans[n - 1] = s->spans[0];
        sift_span(s->spans, n - 1, 0, last);
    }
}

// An end of the ray within a body.
static sag_hit end_within(const event *body, double t) {
    sag_hit hit;
    memset(&hit, 0xFF, sizeof hit); // SAG_INVALID_ID
    hit.t = t, hit.u = hit.v = 0;
    hit.geometry = body->geometry;
    hit.instance_depth = body->depth, hit.flipped = 0;
    memcpy(hit.instance_path, body->hit.instance_path, body->depth * sizeof *hit.instance_path);
    return hit;
}

// Whether the line comes from inside of a geometry that is closed. `line` is in the snapshot's space.
static bool begins_inside(const sagi_snapshot *s, uint32_t id, const sag_ray *line) {
    const sagi_item *item = &s->items[id];
    sag_ray local = item->place != NULL ? sag_ray_transform(&item->place->to_object, line) : *line;
    return sagi_shape_begins_inside((sag_shape_kind)item->kind, item->shape, &local);
}

static bool body_begins_inside(const search *s, const event *body) {
    const sagi_snapshot *where = s->scene;
    sag_ray here = follow(&where, &s->line, body->hit.instance_path, body->depth);
    if (where->world.unbounded_count == 0) return false;
    bool crossed;
    return body->geometry == SAG_INVALID_ID ? s->kernel->begins_inside(&where->world, &here, &crossed)
                                            : begins_inside(where, body->geometry, &here);
}

// The crossings at one t.
static void finish_crossings(search *s) {
    if (s->equal % 2 == 1) {
        const sag_hit *hit = &s->first;
        if (!s->inside)
            s->enter = hit->t >= s->t_min ? *hit : end_within(&s->body, s->t_min);
        else if (hit->t > s->enter.t)
            add_span(s, &s->enter, hit);
        s->inside = !s->inside;
    }
    s->equal = 0;
}

static void finish_body(search *s) {
    if (!s->any) return;
    finish_crossings(s);
    if (!s->inside || !(s->line.t_max > s->enter.t || s->line.t_max == s->t_min)) return;
    sag_hit leave = end_within(&s->body, s->line.t_max);
    add_span(s, &s->enter, &leave);
}

static void pass(search *s, const event *e) {
    if (!s->any || compare_bodies(&s->body, e) != 0) {
        finish_body(s);
        s->any = true, s->body = *e, s->equal = 0;
        s->inside = body_begins_inside(s, e);
        s->enter = end_within(e, s->t_min);
    }
    if (s->equal > 0 && e->hit.t > s->first.t) finish_crossings(s);
    if (s->equal++ == 0) s->first = e->hit;
}

// The first KEPT events after the last that are not done yet, in order. False when there are no more.
static bool pass_some(search *s) {
    const sagi_visitor visitor = {take, s};
    s->event_count = 0;
    s->kernel->visit(&s->scene->world, &s->line, &visitor);
    size_t kept = s->event_count < KEPT ? s->event_count : KEPT;
    for (size_t n = kept; n > 1; n--) {
        event last = s->kept[n - 1];
        s->kept[n - 1] = s->kept[0];
        sift_event(s->kept, n - 1, 0, &last);
    }
    for (size_t i = 0; i < kept; i++)
        if (i == 0 || event_before(&s->kept[i - 1], &s->kept[i])) pass(s, &s->kept[i]);
    if (s->event_count <= KEPT) return false;
    s->again = true, s->last = s->kept[KEPT - 1];
    return true;
}

// A body that holds the whole ray.
static void add_whole(search *s, const event *body) {
    const sag_hit enter = end_within(body, s->t_min), leave = end_within(body, s->line.t_max);
    add_span(s, &enter, &leave);
}

// The unbounded bodies of a scene without a crossing. `at` has its path; instances nest
// SAG_MAX_INSTANCE_DEPTH deep at most.
static void add_uncrossed(search *s, const sagi_snapshot *where, const sag_ray *line, event *at) {
    at->geometry = SAG_INVALID_ID;
    if (sagi_snapshot_is_solid(where)) {
        bool crossed = true;
        if (where->world.unbounded_count > 0 && s->kernel->begins_inside(&where->world, line, &crossed) &&
            !crossed)
            add_whole(s, at);
        return;
    }
    for (uint32_t i = 0; i < where->world.unbounded_count; i++) {
        uint32_t id = where->world.unbounded[i].geometry;
        const sagi_item *item = &where->items[id];
        if ((s->line.mask != 0 ? s->line.mask & item->mask : item->mask) == 0) continue;
        sag_ray local = item->place != NULL ? sag_ray_transform(&item->place->to_object, line) : *line;
        if (!sag_ray_is_valid(&local)) continue;
        if (item->kind == SAG_SHAPE_INSTANCE) {
            at->hit.instance_path[at->depth++] = id;
            add_uncrossed(s, where->entries[id].child, &local, at);
            at->depth--;
        } else if (sagi_geometry_is_closed(where, id) && begins_inside(where, id, line) &&
                   !sagi_shape_classes[item->kind].occluded(item->shape, &local)) {
            at->geometry = id;
            add_whole(s, at);
        }
    }
}

// Whether the ray begins clear of everything. Then what is before t_min does not matter: as many crossings of
// a body are ways in as ways out. Clear: by more than rounding in the maps of instances can move a ray
// (world.h).
static bool begins_outside(const sagi_snapshot *s, const sag_ray *ray) {
    const sag_box3 *box = &s->stats.bounds;
    const double o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double low[3] = {box->min.x, box->min.y, box->min.z},
                 high[3] = {box->max.x, box->max.y, box->max.z};
    if (s->world.unbounded_count > 0 || isinf(ray->t_min)) return false;
    double moved = 0x1p-40 * (s->world.spread_relative * sag_max_component(sag_abs(ray->origin)) +
                              s->world.spread_absolute);
    for (int k = 0; k < 3; k++) {
        double p = o[k] + ray->t_min * d[k];
        double room = moved + 0x1p-40 * (fabs(o[k]) + fabs(ray->t_min * d[k]) + fabs(low[k]) + fabs(high[k]));
        if (p < low[k] - room || p > high[k] + room) return true;
    }
    return false;
}

size_t sag_scene_spans(const sag_scene *scene, const sag_ray *ray, sag_span *spans, size_t capacity) {
    const sagi_snapshot *snapshot = sagi_scene_snapshot(scene);
    if (snapshot == NULL || !sag_ray_is_valid(ray)) return 0;
    event kept[KEPT], at = {.depth = 0};
    search s = {.scene = snapshot,
                .kernel = scene->kernel,
                .line = *ray,
                .t_min = ray->t_min,
                .spans = spans,
                .capacity = capacity,
                .kept = kept};
    if (!begins_outside(snapshot, ray)) s.line.t_min = -INFINITY;
    while (pass_some(&s)) {
    }
    finish_body(&s);
    add_uncrossed(&s, snapshot, &s.line, &at);
    sort_spans(&s);
    return s.count;
}
