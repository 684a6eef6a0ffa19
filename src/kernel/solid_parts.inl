// SPDX-License-Identifier: MIT
// The crossings of a ray and a solid's parts. Part of kernel.inl.
//
// A shape says at once where it crosses the whole line: eight times at most. Meshes and solids may do so any
// number of times; they are asked for one crossing after the other. A mesh may cross several times at one t
// (two sheets that touch, or closer than doubles tell): an even number of times is no crossing.

static inline bool is_asked_again(const solid_walk *w, uint32_t part) {
    uint8_t kind = w->here->world->items[w->parts[part].geometry].kind;
    return kind == SAG_SHAPE_MESH || kind == SAG_SHAPE_INSTANCE;
}

static inline const sagi_item *item_of_part(const solid_walk *w, uint32_t part) {
    return &w->here->world->items[w->parts[part].geometry];
}

// The two crossings of a box or sphere without a detour: most parts are those.
typedef struct quick_crossings {
    uint32_t count, primitive[2];
    double t[2], error;
} quick_crossings;

// As shapes/box.c, where no axis is along a face and the ray does not just touch. The same bits.
SAGI_INLINE bool quick_box(const solid_walk *w, const sag_box *box, quick_crossings *q) {
    const sagi_d4 zero = sagi_d4_fill(0), d = w->direction;
    const sagi_d4 lo = sagi_d4_of(box->min.x, box->min.y, box->min.z, 0),
                  hi = sagi_d4_of(box->max.x, box->max.y, box->max.z, 0);
    if (d[0] == 0 || d[1] == 0 || d[2] == 0) return false;
    const sagi_l4 down = sagi_d4_less(d, zero);
    sagi_d4 near = (sagi_d4_select(down, hi, lo) - w->origin) / d;
    sagi_d4 far = (sagi_d4_select(down, lo, hi) - w->origin) / d;
    uint32_t enter = near[1] > near[0], leave = far[1] < far[0];
    if (near[2] > near[enter]) enter = 2;
    if (far[2] < far[leave]) leave = 2;
    const double t0 = near[enter], t1 = far[leave];
    const double error = 4 * SAGI_EPSILON * (fabs(t0) + fabs(t1)) + 0x1p-1022;
    q->count = 0, q->error = 0;
    if (t0 - t1 > error) return true;
    if (!(t1 - t0 > error && t1 - t0 < INFINITY)) return false;
    q->t[0] = t0, q->t[1] = t1, q->count = 2;
    q->primitive[0] = 2 * enter + (d[enter] < 0), q->primitive[1] = 2 * leave + (d[leave] > 0);
    return true;
}

// As sphere_solve.h, whose names these are. Roughly: the roots in double. With s = l² + r², b and the root
// of D are off by 5u|l||d| and, as D is off by e = 32u a s at most, by e/√D; because √D ≤ √(a s), e/√D is at
// least 32u√(a s), beside which the other roundings, of b and √D and of sum and quotient, are small: t is off
// by 2e/(a√D) = 64u s/√D at most.
SAGI_INLINE bool quick_sphere(const solid_walk *w, const sag_sphere *sphere, bool rough, quick_crossings *q) {
    const double radius = sphere->radius, a = w->squared;
    q->primitive[0] = q->primitive[1] = 0, q->error = 0;
    if (!rough) {
        q->count = (uint32_t)sagi_sphere_solve(sagi_sphere_load(sphere), &w->line, INFINITY, false, q->t);
        return true;
    }
    sagi_d4 l = w->origin - sagi_sphere_load(sphere), ld = l * w->direction, square = l * l;
    double b = ld[0] + ld[1] + ld[2], ll = square[0] + square[1] + square[2], rr = radius * radius;
    double size = ll + rr, d2 = b * b - a * (ll - rr), d2_error = 32 * SAGI_EPSILON * a * size;
    if (!(a > 0x1p-120 && a < 0x1p120 && rr > 0x1p-200 && size < 0x1p250)) return false;
    q->count = 0;
    if (d2 < -d2_error) return true;
    if (!(d2 > 64 * d2_error)) return false;
    const double root = sqrt(d2), inverse = 1 / a;
    q->t[0] = (-b - root) * inverse, q->t[1] = (-b + root) * inverse, q->count = 2;
    q->error = 72 * SAGI_EPSILON * size / root;
    return true;
}

SAGI_INLINE bool quick_shape(const solid_walk *w, const sagi_item *item, bool rough, quick_crossings *q) {
    if (item->kind == SAG_SHAPE_BOX) return quick_box(w, item->shape, q);
    return item->kind == SAG_SHAPE_SPHERE && quick_sphere(w, item->shape, rough, q); // whole: it is closed
}

// All crossings of a shape; *inside: at the line's beginning.
static inline uint32_t shape_crossings(const solid_walk *w, const sagi_item *item,
                                       sag_hit hits[SAGI_MAX_CROSSINGS], bool *inside) {
    sag_ray moved;
    const sag_ray *ray = &w->line;
    *inside = false;
    if (item->shape == NULL) return 0;
    quick_crossings q;
    if (item->place == NULL && quick_shape(w, item, false, &q)) {
        for (uint32_t i = 0; i < q.count; i++) hits[i].t = q.t[i], hits[i].primitive = q.primitive[i];
        return q.count;
    }
    if (item->place != NULL) {
        moved = sag_ray_transform(&item->place->to_object, ray);
        if (!sag_ray_is_valid(&moved)) return 0;
        ray = &moved;
    }
    size_t count = ask(ALL, (sag_shape_kind)item->kind, item->shape, ray, hits);
    if (count < 2 && (item->kind == SAG_SHAPE_PLANE || item->kind == SAG_SHAPE_POLYHEDRON))
        *inside = sagi_shape_begins_inside((sag_shape_kind)item->kind, item->shape, ray);
    if (count == 4 && item->kind == SAG_SHAPE_TORUS)
        count = sagi_torus_leave_outer(item->shape, ray, hits, count);
    return count < SAGI_MAX_CROSSINGS ? (uint32_t)count : SAGI_MAX_CROSSINGS;
}

// A search of its own, with the path so far.
static inline void search_below(const solid_walk *w, search *s, sag_hit *hit) {
    const search *above = w->here->search;
    s->best = hit, s->found = false, s->both_sides = true;
    s->repeats.again = false;
    s->grain = s->reach = 0, s->later = NULL, s->known = NULL;
    s->path_length = above->path_length;
    for (uint32_t i = 0; i < s->path_length; i++) s->path[i] = above->path[i];
}

// Whether the ray, from t on, crosses the mesh an odd number of times. Where it is outside of the mesh's box
// there is no need to count.
static __attribute__((noinline)) bool is_in_mesh(const sagi_world *world, const sag_ray *ray) {
    if (isinf(ray->t_min) || world->tree.node_count == 0) return false;
    const double p[3] = {ray->origin.x + ray->t_min * ray->direction.x,
                         ray->origin.y + ray->t_min * ray->direction.y,
                         ray->origin.z + ray->t_min * ray->direction.z};
    const double c[3] = {world->origin.x, world->origin.y, world->origin.z};
    for (int k = 0; k < 3; k++) {
        double q = (p[k] - c[k]) * world->scale,
               room = 0x1p-30 * (1 + (fabs(p[k]) + fabs(c[k])) * world->scale);
        if (q < (double)world->tree.box.lo[k] - room || q > (double)world->tree.box.hi[k] + room)
            return false;
    }
    sag_ray beyond = *ray;
    beyond.t_max = INFINITY;
    return crossings(world, &beyond, true, NULL, 0) % 2 == 1;
}

static __attribute__((noinline)) bool next_of_mesh(solid_walk *w, const sagi_item *item, sag_ray *ray,
                                                   bool *inside, sag_hit *hit) {
    search s;
    search_below(w, &s, hit);
    s.grain = 0x1p-48, s.reach = w->reach; // twice the tolerance
    if (inside != NULL) *inside = is_in_mesh(item->child, ray);
    while (ray->t_min <= ray->t_max) {
        level below;
        s.found = false;
        enter(&below, item->child, ray, &s);
        walk_closest(&below);
        if (!s.found) return false;
        w->near = s.near || item->child->tree.repeats;
        if (!item->child->tree.repeats) {
            if (s.odd) return true;
            ray->t_min = sagi_next_up(hit->t);
            continue;
        }
        sag_ray at = *ray; // a triangle may have been met twice
        at.t_min = at.t_max = hit->t;
        if (crossings(item->child, &at, true, NULL, 0) % 2 == 1) return true;
        ray->t_min = sagi_next_up(hit->t);
    }
    return false;
}

static __attribute__((noinline)) bool next_of_solid(solid_walk *w, const sagi_item *item, uint32_t geometry,
                                                    const sag_ray *ray, bool *inside, sag_hit *hit) {
    search s;
    level below;
    bool in = false;
    search_below(w, &s, hit);
    s.path[s.path_length++] = geometry;
    if (item->child != NULL && item->child->solid != NULL) {
        enter(&below, item->child, ray, &s);
        run_solid(CLOSEST, &below, &in);
    }
    w->near = true;
    if (inside != NULL) *inside = in;
    return s.found;
}

// The next crossing, at `from` or later, of a part that is asked one by one. *inside, where it is asked for:
// before that.
static bool next_of_part(solid_walk *w, uint32_t part, double from, double end, bool *inside, sag_hit *hit) {
    const sagi_item *item = item_of_part(w, part);
    const uint32_t geometry = w->parts[part].geometry;
    sag_ray ray = w->line;
    if (inside != NULL) *inside = false;
    if (item->place != NULL) ray = sag_ray_transform(&item->place->to_object, &ray);
    ray.t_min = from, ray.t_max = end;
    if (item->child == NULL || !sag_ray_is_valid(&ray)) return false;
    bool found = item->kind == SAG_SHAPE_MESH ? next_of_mesh(w, item, &ray, inside, hit)
                                              : next_of_solid(w, item, geometry, &ray, inside, hit);
    if (found && item->kind == SAG_SHAPE_MESH) hit->geometry = geometry;
    return found;
}

static void add_next(solid_walk *w, uint32_t part, double from, bool *inside) {
    sag_hit hit;
    const sag_hit *known = w->here->search->known;
    if (known != NULL && part == 0 && known->t >= from) {
        if (known->t > w->end) return;
        hit = *known, w->near = false; // (a batch has seen to it: solid_batch.inl)
    } else if (!next_of_part(w, part, from, w->end, inside, &hit)) {
        return;
    }
    add_event(w, &(solid_event){.t = hit.t,
                                .part = part,
                                .primitive = hit.primitive,
                                .entering = !*inside,
                                .again = true,
                                .near = w->near});
    w->last_asked = part, w->last_hit = hit;
}

// Makes a crossing's t that of the part itself.
static __attribute__((noinline, hot)) void refine(solid_walk *w, solid_event *e) {
    const sagi_item *item = item_of_part(w, e->part);
    const double room = 2 * e->error;
    double t[2];
    sag_ray ray = w->line;
    ray.t_min = e->t - room, ray.t_max = e->t + room;
    e->error = 0;
    if (sagi_sphere_solve(sagi_sphere_load(item->shape), &ray, ray.t_max, false, t) == 1) {
        e->t = t[0];
        return;
    }
    sag_hit hits[SAGI_MAX_CROSSINGS];
    bool inside;
    uint32_t count = shape_crossings(w, item, hits, &inside);
    if (e->number < count) e->t = hits[e->number].t;
}

SAGI_INLINE bool open_roughly(solid_walk *w, uint32_t part) {
    const sagi_item *item = item_of_part(w, part);
    quick_crossings q;
    if (item->place != NULL || !quick_shape(w, item, true, &q)) return false;
    uint32_t i = 0;
    for (uint32_t k = 0; k < q.count; k++)
        if (fabs(q.t[k] - w->from) <= q.error) return false; // before or after?
    for (; i < q.count && is_done(w, q.t[i]); i++) {
    }
    if (i % 2 != 0) toggle(w, part, true);
    for (; i < q.count; i++)
        add_event(w, &(solid_event){q.t[i], q.error, part, q.primitive[i], i, i == 0, false, false});
    return true;
}

// Takes the part's crossings up, and whether the ray is in it.
static __attribute__((noinline, hot)) void open_part(solid_walk *w, uint32_t part) {
    bool inside;
    if (w->rough && open_roughly(w, part)) return;
    if (is_asked_again(w, part)) {
        inside = false;
        add_next(w, part, begin_of_rest(w), &inside);
        if (inside) toggle(w, part, true);
        return;
    }
    sag_hit hits[SAGI_MAX_CROSSINGS];
    uint32_t count = shape_crossings(w, item_of_part(w, part), hits, &inside), i = 0;
    for (; i < count && is_done(w, hits[i].t); i++) inside = !inside;
    if (inside) toggle(w, part, true);
    for (; i < count; i++) {
        inside = !inside;
        add_event(w, &(solid_event){hits[i].t, 0, part, hits[i].primitive, i, inside, false, false});
    }
}

// Takes up those crossings again that were given up.
static __attribute__((noinline, cold)) void reopen_part(solid_walk *w, uint32_t part) {
    const solid_event *from = &w->resume;
    bool inside;
    if (is_asked_again(w, part)) {
        inside = false;
        add_next(w, part, part >= from->part ? from->t : sagi_next_up(from->t), &inside);
        return;
    }
    sag_hit hits[SAGI_MAX_CROSSINGS];
    uint32_t count = shape_crossings(w, item_of_part(w, part), hits, &inside);
    for (uint32_t i = 0; i < count; i++) {
        inside = !inside;
        solid_event e = {hits[i].t, 0, part, hits[i].primitive, i, inside, false, false};
        if (!event_before(&e, from)) add_event(w, &e);
    }
}

// After a crossing of a part that is asked one by one.
static __attribute__((noinline)) void ask_again(solid_walk *w, const solid_event *e) {
    sag_hit hit;
    if (!next_of_part(w, e->part, sagi_next_up(e->t), w->end, NULL, &hit)) return;
    add_event(w, &(solid_event){.t = hit.t,
                                .part = e->part,
                                .primitive = hit.primitive,
                                .entering = !e->entering,
                                .again = true,
                                .near = w->near});
    w->last_asked = e->part, w->last_hit = hit;
}

static inline void fill_hit(solid_walk *w, const solid_event *e, sag_hit *hit) {
    if (e->again) {
        if (w->last_asked == e->part && w->last_hit.t == e->t) {
            *hit = w->last_hit;
            return;
        }
        if (next_of_part(w, e->part, e->t, e->t, NULL, hit)) return;
    }
    write_hit(w->here->search, w->parts[e->part].geometry, e->primitive, e->t, 0, 0, hit);
}
