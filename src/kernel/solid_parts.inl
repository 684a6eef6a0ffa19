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

// All crossings of a shape; *inside: at the line's beginning.
static inline uint32_t shape_crossings(const solid_walk *w, const sagi_item *item,
                                       sag_hit hits[SAGI_MAX_CROSSINGS], bool *inside) {
    sag_ray moved;
    const sag_ray *ray = &w->line;
    *inside = false;
    if (item->shape == NULL) return 0;
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
    if (inside != NULL) *inside = is_in_mesh(item->child, ray);
    while (ray->t_min <= ray->t_max) {
        level below;
        s.found = false;
        enter(&below, item->child, ray, &s);
        walk_closest(&below);
        if (!s.found) return false;
        sag_ray at = *ray;
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
    if (!next_of_part(w, part, from, w->end, inside, &hit)) return;
    add_event(w, &(solid_event){.t = hit.t, .part = part, .primitive = hit.primitive, .entering = !*inside});
    w->last_asked = part, w->last_hit = hit;
}

// Takes the part's crossings up, and whether the ray is in it.
static __attribute__((noinline)) void open_part(solid_walk *w, uint32_t part) {
    bool inside;
    if (is_asked_again(w, part)) {
        inside = false;
        add_next(w, part, sagi_next_up(w->done), &inside);
        if (inside) toggle(w, part, true);
        return;
    }
    sag_hit hits[SAGI_MAX_CROSSINGS];
    uint32_t count = shape_crossings(w, item_of_part(w, part), hits, &inside), i = 0;
    for (; i < count && hits[i].t <= w->done; i++) inside = !inside;
    if (inside) toggle(w, part, true);
    for (; i < count; i++) {
        inside = !inside;
        add_event(w, &(solid_event){hits[i].t, part, hits[i].primitive, i, inside});
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
        solid_event e = {hits[i].t, part, hits[i].primitive, i, inside};
        if (!event_before(&e, from)) add_event(w, &e);
    }
}

// After a crossing of a part that is asked one by one.
static __attribute__((noinline)) void ask_again(solid_walk *w, const solid_event *e) {
    sag_hit hit;
    if (!next_of_part(w, e->part, sagi_next_up(e->t), w->end, NULL, &hit)) return;
    add_event(
        w, &(solid_event){.t = hit.t, .part = e->part, .primitive = hit.primitive, .entering = !e->entering});
    w->last_asked = e->part, w->last_hit = hit;
}

static inline void fill_hit(solid_walk *w, const solid_event *e, sag_hit *hit) {
    if (is_asked_again(w, e->part)) {
        if (w->last_asked == e->part && w->last_hit.t == e->t) {
            *hit = w->last_hit;
            return;
        }
        if (next_of_part(w, e->part, e->t, e->t, NULL, hit)) return;
    }
    write_hit(w->here->search, w->parts[e->part].geometry, e->primitive, e->t, 0, 0, hit);
}
