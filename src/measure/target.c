// SPDX-License-Identifier: MIT
// One body, met by rays: what else is in its scene is passed over.
//
// A solid has a snapshot of its own, whose crossings are the solid's boundary. A geometry that is one shape
// is asked itself; meshes and sets of spheres are asked through the tree of the scene they are in, and what
// belongs to others is left out.
//
// Inside is where the number of crossings from the line's beginning is odd: that needs no normals, and an
// inside-out mesh measures as well as any. A set of spheres, which overlap, and a spindle torus, whose inner
// sheet is not part of its boundary, go by depth instead: as many as are entered and not yet left.
#include "measure/measure.h"
#include "shapes/shape.h"
#include <string.h>

void sagi_line_buffer_release(sagi_line_buffer *buffer) {
    sag_release(buffer->context, buffer->hits, buffer->capacity * sizeof *buffer->hits);
    sag_release(buffer->context, buffer->boundaries, buffer->capacity * sizeof *buffer->boundaries);
    buffer->hits = NULL, buffer->boundaries = NULL, buffer->capacity = 0;
}

// Room for so many, keeping the first `kept` hits.
static bool reserve(sagi_line_buffer *buffer, size_t count, size_t kept) {
    if (count <= buffer->capacity) return true;
    size_t capacity = 64;
    while (capacity < count) capacity *= 2;
    sag_hit *hits = sag_allocate(buffer->context, capacity * sizeof *hits);
    sagi_boundary *boundaries = sag_allocate(buffer->context, capacity * sizeof *boundaries);
    if (hits == NULL || boundaries == NULL) {
        sag_release(buffer->context, hits, capacity * sizeof *hits);
        sag_release(buffer->context, boundaries, capacity * sizeof *boundaries);
        buffer->failed = true;
        return false;
    }
    if (kept > 0) memcpy(hits, buffer->hits, kept * sizeof *hits);
    sagi_line_buffer_release(buffer);
    buffer->hits = hits, buffer->boundaries = boundaries, buffer->capacity = capacity;
    return true;
}

static bool is_ours(const sagi_target *t, const sag_hit *hit) {
    return t->geometry == SAG_INVALID_ID || (hit->instance_depth == 0 && hit->geometry == t->geometry);
}

// Whether the tree of the scene has to be asked.
static bool is_many(uint8_t kind) {
    return kind == SAG_SHAPE_MESH || kind == SAG_SHAPE_SPHERES || kind == SAG_SHAPE_USER;
}

// Of a solid, or of one shape: all that there is.
static size_t all_of(const sagi_target *t, const sag_ray *here, sag_hit *hits, size_t capacity) {
    if (t->geometry == SAG_INVALID_ID)
        return t->kernel->crossings(&t->snapshot->world, here, false, hits, capacity);
    const sagi_item *item = &t->snapshot->items[t->geometry];
    const sag_ray local = item->place != NULL ? sag_ray_transform(&item->place->to_object, here) : *here;
    const size_t count = sagi_shape_classes[item->kind].crossings(item->shape, &local, hits, capacity);
    for (size_t i = 0; i < count && i < capacity; i++) hits[i].geometry = t->geometry;
    return count;
}

// Of many: what is ours of what the tree has.
typedef struct chooser {
    const sagi_target *target;
    sagi_line_buffer *buffer;
    size_t count;
} chooser;

static void choose(void *user, const sag_hit *hit) {
    chooser *c = user;
    if (!is_ours(c->target, hit) || !reserve(c->buffer, c->count + 1, c->count)) return;
    sag_hit *hits = c->buffer->hits;
    size_t at = c->count;
    while (at > 0 && sagi_hit_before(hit, &hits[at - 1])) at--;
    if (at > 0 && !sagi_hit_before(&hits[at - 1], hit)) return; // once more the same
    memmove(hits + at + 1, hits + at, (c->count++ - at) * sizeof *hits);
    hits[at] = *hit;
}

// The body's crossings in order, in buffer->hits.
static size_t crossings(const sagi_target *t, const sag_ray *ray, sagi_line_buffer *buffer) {
    const sag_ray here = t->mapped ? sag_ray_transform(&t->place.to_object, ray) : *ray;
    if (t->geometry != SAG_INVALID_ID && is_many(t->snapshot->items[t->geometry].kind)) {
        chooser c = {t, buffer, 0};
        t->kernel->visit(&t->snapshot->world, &here, &(sagi_visitor){choose, &c});
        return c.count;
    }
    const size_t count = all_of(t, &here, buffer->hits, buffer->capacity);
    if (count <= buffer->capacity) return count;
    return reserve(buffer, count, 0) ? all_of(t, &here, buffer->hits, buffer->capacity) : 0;
}

void sagi_target_surface(const sagi_target *t, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    const sag_ray here = t->mapped ? sag_ray_transform(&t->place.to_object, ray) : *ray;
    sagi_cell cell = {.context = t->context};
    cell.current = (sagi_snapshot *)t->snapshot; // a scene that shows just this, for the moment
    const sag_scene view = {.context = t->context, .kernel = t->kernel, .cell = &cell};
    sag_surface_at(&view, &here, hit, surface);
    if (t->mapped) sagi_surface_map(&t->place, surface);
}

size_t sagi_target_cross(const sagi_target *t, const sag_ray *ray, sagi_line_buffer *buffer) {
    const size_t count = crossings(t, ray, buffer);
    size_t boundaries = 0;
    int depth = 0;
    for (size_t i = 0; i < count; i++) {
        bool entering = depth == 0;
        if (t->by_depth) {
            sag_surface s;
            sagi_target_surface(t, ray, &buffer->hits[i], &s);
            entering = s.side == SAG_SIDE_FRONT;
        }
        if (depth == (entering ? 0 : 1))
            buffer->boundaries[boundaries++] = (sagi_boundary){buffer->hits[i], entering};
        if (entering || depth > 0) depth += entering ? 1 : -1;
    }
    // A line that enters leaves; should rounding have lost the end, the last crossing counts for nothing.
    return boundaries - boundaries % 2;
}

// The nearest hit of the tree, when it is known to be the answer.
static bool nearest(const sagi_target *t, const sag_ray *ray, sag_hit *hit) {
    const sagi_item *item = &t->snapshot->items[t->geometry];
    if (item->kind != SAG_SHAPE_MESH || ((const sag_mesh *)item->shape)->one_sided) return false;
    const sag_ray here = t->mapped ? sag_ray_transform(&t->place.to_object, ray) : *ray;
    return t->kernel->intersect(&t->snapshot->world, &here, hit) && is_ours(t, hit);
}

// A solid is asked for all crossings of a part on the line, and a root next to the ray's origin, to 4 ulp,
// takes many digits. So the ray begins well before its first point, and its range just beyond where that is
// to rounding.
static bool solid_inward(const sagi_target *t, const sag_ray *ray, double *end) {
    const double reach = sag_length(sag_sub(t->box.max, t->box.min));
    sag_ray back = *ray;
    back.origin = sag_madd(ray->origin, -reach, ray->direction);
    back.t_min = reach + 0x1p-46 * (reach + sag_max_component(sag_abs(back.origin)));
    sag_hit hit;
    if (t->mapped) back = sag_ray_transform(&t->place.to_object, &back);
    if (!t->kernel->intersect(&t->snapshot->world, &back, &hit)) return false;
    *end = hit.t - reach;
    return true;
}

bool sagi_target_inward(const sagi_target *t, const sag_ray *ray, sagi_line_buffer *buffer, double *end) {
    if (t->geometry == SAG_INVALID_ID) return solid_inward(t, ray, end);
    sag_hit hit;
    if (nearest(t, ray, &hit)) {
        *end = hit.t;
        return true;
    }
    const size_t count = crossings(t, ray, buffer);
    int depth = 1;
    for (size_t i = 0; i < count; i++) {
        *end = buffer->hits[i].t;
        if (!t->by_depth) return true;
        sag_surface s;
        sagi_target_surface(t, ray, &buffer->hits[i], &s);
        depth += s.side == SAG_SIDE_FRONT ? 1 : -1;
        if (depth == 0) return true;
    }
    return false;
}
