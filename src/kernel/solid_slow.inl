// SPDX-License-Identifier: MIT
// A ray and a solid of which more operations are under way at one place than a query has room for
// (solid.inl). Part of kernel.inl. Nothing is kept but the place: all parts are asked for their next
// crossing, and all of them for the value on either side of it, with one number for each node above the part
// at hand.

// Whether the ray is in the part just after `at`; *next: its next crossing then, or ∞.
static bool slow_state(solid_walk *w, uint32_t part, double at, solid_event *next) {
    bool inside = false;
    *next = (solid_event){.t = INFINITY, .part = part, .again = is_asked_again(w, part)};
    if (next->again) {
        sag_hit hit;
        if (next_of_part(w, part, sagi_next_up(at), w->end, &inside, &hit))
            next->t = hit.t, next->primitive = hit.primitive;
    } else {
        sag_hit hits[SAGI_MAX_CROSSINGS];
        uint32_t count = shape_crossings(w, item_of_part(w, part), hits, &inside), i = 0;
        for (; i < count && hits[i].t <= at; i++) inside = !inside;
        if (i < count) next->t = hits[i].t, next->primitive = hits[i].primitive;
    }
    next->entering = !inside;
    return inside;
}

// The nodes above the part at hand, the root first.
typedef struct slow_path {
    uint32_t height, node[SAG_SOLID_MAX_DEPTH];
    int32_t number[SAG_SOLID_MAX_DEPTH];
} slow_path;

// Done with the nodes from this height on.
static void slow_close(const solid_walk *w, slow_path *path, uint32_t height) {
    while (path->height > height) {
        const sagi_solid_node *node = &w->nodes[path->node[--path->height]];
        if (sagi_solid_value(node, path->number[path->height]))
            path->number[path->height - 1] += node->weight;
    }
}

// The solid's value just after `at`, but with the parts from `first` to `last` as they are just after
// `there`.
static bool slow_value(solid_walk *w, double at, uint32_t first, uint32_t last, double there) {
    slow_path path = {.height = 1, .node = {0}, .number = {0}};
    for (uint32_t i = 0; i < w->solid->part_count; i++) {
        solid_event next;
        if (!slow_state(w, i, i >= first && i <= last ? there : at, &next)) continue;
        uint32_t above[SAG_SOLID_MAX_DEPTH], count = 0, common = 0;
        for (uint32_t n = w->parts[i].parent; n != SAG_INVALID_ID; n = w->nodes[n].parent) above[count++] = n;
        while (common < count && common < path.height && path.node[common] == above[count - 1 - common])
            common++;
        slow_close(w, &path, common);
        for (; path.height < count; path.height++)
            path.node[path.height] = above[count - 1 - path.height], path.number[path.height] = 0;
        path.number[count - 1] += w->parts[i].weight;
    }
    slow_close(w, &path, 1);
    return sagi_solid_value(&w->nodes[0], path.number[0]);
}

// The first crossing after `at`, of all parts.
static double slow_next(solid_walk *w, double at) {
    double first = INFINITY;
    for (uint32_t i = 0; i < w->solid->part_count; i++) {
        solid_event next;
        slow_state(w, i, at, &next);
        if (next.t < first) first = next.t;
    }
    return first;
}

// As choose, for the crossings after `from` up to `to`.
static __attribute__((noinline, cold)) solid_event slow_choose(solid_walk *w, double from, double to,
                                                               bool after) {
    solid_event next = {.part = SAG_INVALID_ID}, unused;
    for (int together = 0; together < 2; together++)
        for (uint32_t i = 0; i < w->solid->part_count; i++) {
            bool before = slow_state(w, i, from, &next);
            if (!(next.t <= to) || slow_state(w, i, to, &unused) == before) continue;
            if (slow_value(w, from, together ? 0 : i, i, to) == after) return next;
        }
    return next;
}

// As choose, for a group of more crossings than are kept, those after `from` up to `to`. The tree's numbers
// are made anew for the place before, from all parts: which of them the boxes have culled is not known here.
static __attribute__((noinline, cold)) solid_event choose_from_all(solid_walk *w, double from, double to) {
    const bool after = w->value;
    const uint32_t count = w->solid->part_count, active_count = w->active_count;
    uint32_t active[SOLID_ACTIVE];
    int32_t number[SOLID_ACTIVE];
    memcpy(active, w->active, sizeof active), memcpy(number, w->number, sizeof number);
    memset(w->number, 0, sizeof w->number);
    w->active_count = 0, w->value = false;
    solid_event owner = {.part = SAG_INVALID_ID}, next, unused;
    for (uint32_t i = 0; i < count; i++)
        if (slow_state(w, i, from, &next)) toggle(w, i, true);
    for (int together = 0; together < 2 && owner.part == SAG_INVALID_ID; together++)
        for (uint32_t i = 0; i < count && owner.part == SAG_INVALID_ID; i++) {
            bool before = slow_state(w, i, from, &next);
            if (!(next.t <= to) || slow_state(w, i, to, &unused) == before) continue;
            toggle(w, i, !before);
            if (w->value == after) owner = next;
            if (!together) toggle(w, i, before);
        }
    bool crowded = w->crowded;
    memcpy(w->active, active, sizeof active), memcpy(w->number, number, sizeof number);
    w->active_count = active_count, w->value = after, w->crowded = false;
    return crowded ? slow_choose(w, from, to, after) : owner;
}

static __attribute__((noinline, cold)) bool slow_solid(question asked, solid_walk *w, double done,
                                                       bool *inside) {
    bool value = slow_value(w, done, 0, 0, done);
    for (double t; (t = slow_next(w, done)) <= w->here->t_max && t < INFINITY;) {
        double last = t, next;
        while ((next = slow_next(w, last)) - last <= tolerance(w, last) && next < INFINITY) last = next;
        bool after = slow_value(w, last, 0, 0, last);
        if (after != value) {
            solid_event e = slow_choose(w, done, last, after);
            solid_report told = report(asked, w, &e, after);
            *inside = value;
            if (told != BEFORE && asked != ALL) return asked == ANY && told == TAKEN;
        }
        done = last, value = after;
    }
    *inside = value;
    return false;
}
