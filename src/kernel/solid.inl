// SPDX-License-Identifier: MIT
// A ray and a solid. Part of kernel.inl; the parts' own crossings are in solid_parts.inl.
//
// Along a ray every part is "out", then "in", then "out" …, and so is the solid. The crossings of the parts
// are taken in order of t; the tree's numbers (solid/tree.h) say after each whether the solid's value has
// changed, and where it has is the boundary that was looked for. Nothing is done before it must be:
//
//   · What waits is a queue, nearest first, of nodes of the box tree and of parts, by the τ at which the ray
//     comes to their boxes.
//   · A part is opened, that is, asked for its crossings on the whole line, when its box begins before the
//     next crossing that is known. Those before the place we are at say whether the ray is in it there.
//     Before its box begins a part counts as out, and after it ends; that is as good as the truth
//     (solid/tree.h).
//   · Crossings known wait in a second queue, the nearest first.
//   · CLOSEST and ANY end at the first boundary.
//
// Coincidence (solid.h). A crossing that follows another by at most 2⁻⁴⁹ (|t| + |o|∞/|d|∞), in t, joins its
// group; only the values before and after the group are compared. So that all of them are known, parts are
// opened to a little beyond a crossing before it is taken.
//
// The queues are short; that they suffice for any number of parts takes three more rules.
//   · A queue that is full gives up what comes last, and remembers where that was: from there on it is not
//     complete. When it is used up to there, the tree is walked again for what is missing. Everything has a
//     place in one order (of crossings: t, part, number; of parts: τ, number), so it is never in doubt what
//     was there before.
//   · Of the nodes of the boolean tree those are kept in order whose number is not 0.
//   · Should these be too many (more than SOLID_ACTIVE operations that hold the place at once), a third way
//     needs no memory: slow_solid.
#ifndef SOLID_WAITING
#define SOLID_WAITING 96
#define SOLID_EVENTS  112
#define SOLID_ACTIVE  128
#endif
#define SOLID_GROUP 16
#define SOLID_FEW   6
#define SOLID_OWED  4

typedef struct solid_event {
    double t, error; // error: what t may be off by the part's own t, mostly 0 (solid_parts.inl)
    uint32_t part, primitive;
    uint32_t number; // which of its part's crossings
    bool entering;   // the part
    bool again;      // the part is to be asked for the next (solid_parts.inl)
    bool near;       // which may be in a group with this one
} solid_event;

typedef struct solid_walk {
    level *here;
    const sagi_solid *solid;
    const sagi_solid_node *nodes;
    const sagi_solid_part *parts;
    sag_ray line;              // the whole line
    sagi_d4 origin, direction; // the fourth place means nothing
    double squared;            // d·d
    double reach;              // |o|∞/|d|∞
    double from, done;         // crossings before the one and up to the other are accounted for
    double end;                // up to where they matter
    double most_error;         // of a crossing
    bool value;                // of the solid there
    bool rough;                // crossings may have an error
    bool crowded;              // too many active nodes
    bool waiting_cut, events_cut;
    uint64_t opened;      // the last leaf that was opened, or 0
    uint64_t waiting_end; // with waiting_cut: the first that the queue may lack
    solid_event events_end;
    solid_event resume;  // while events that were given up are found again
    bool near;           // see solid_event: of the last crossing asked for
    uint32_t owed_count; // parts that are to be asked again after the group
    solid_event owed[SOLID_OWED];
    uint32_t last_asked; // the part of a mesh or solid whose crossing last_hit is
    sag_hit last_hit;
    uint32_t few;              // nodes of the box tree, when all of them were looked at, or 0
    float nearest;             // of these leaves
    sagi_f8 leaves[SOLID_FEW]; // where those begin that wait
    slabs slabs;
    uint32_t waiting_count, event_count, active_count;
    uint64_t waiting[SOLID_WAITING]; // the nearest last: τ's bits, then the node or leaf as in the tree
    solid_event events[SOLID_EVENTS];
    uint32_t active[SOLID_ACTIVE]; // in a large tree: nodes in order; in a small one all stand at their place
    int32_t number[SOLID_ACTIVE];
} solid_walk;

static inline double tolerance(const solid_walk *w, double t) { return 0x1p-49 * (fabs(t) + w->reach); }

// What a node's number is to be changed by; its place in the table, or NULL when there is none left.
static __attribute__((noinline)) int32_t *find_active(solid_walk *w, uint32_t node) {
    uint32_t low = 0, high = w->active_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (w->active[middle] < node)
            low = middle + 1;
        else
            high = middle;
    }
    if (low < w->active_count && w->active[low] == node) return &w->number[low];
    if (w->active_count == SOLID_ACTIVE) { // those that are 0 again make room
        uint32_t kept = 0, before = 0;
        for (uint32_t i = 0; i < w->active_count; i++) {
            if (w->number[i] == 0) continue;
            before += i < low;
            w->active[kept] = w->active[i], w->number[kept++] = w->number[i];
        }
        w->active_count = kept, low = before;
        if (kept == SOLID_ACTIVE) return NULL;
    }
    for (uint32_t i = w->active_count++; i > low; i--)
        w->active[i] = w->active[i - 1], w->number[i] = w->number[i - 1];
    w->active[low] = node, w->number[low] = 0;
    return &w->number[low];
}

static inline int32_t *number_of(solid_walk *w, uint32_t node) {
    return w->solid->node_count <= SOLID_ACTIVE ? &w->number[node] : find_active(w, node);
}

// A part is in, or out, from here on.
static void toggle(solid_walk *w, uint32_t part, bool in) {
    int32_t change = in ? w->parts[part].weight : -w->parts[part].weight;
    for (uint32_t n = w->parts[part].parent;;) {
        int32_t *number = number_of(w, n);
        if (number == NULL) {
            w->crowded = true;
            return;
        }
        const sagi_solid_node *node = &w->nodes[n];
        bool before = sagi_solid_value(node, *number);
        bool after = sagi_solid_value(node, *number += change);
        if (before == after) return;
        if (n == 0) {
            w->value = after;
            return;
        }
        change = after ? node->weight : -node->weight;
        n = node->parent;
    }
}

static inline bool event_before(const solid_event *a, const solid_event *b) {
    if (a->t != b->t) return a->t < b->t;
    return a->part != b->part ? a->part < b->part : a->number < b->number;
}

static inline void add_event(solid_walk *w, const solid_event *e) {
    if (w->events_cut && !event_before(e, &w->events_end)) return;
    if (w->event_count == SOLID_EVENTS) {
        w->events_cut = true;
        w->events_end = event_before(e, &w->events[0]) ? w->events[0] : *e;
        if (!event_before(e, &w->events[0])) return;
        memmove(w->events, w->events + 1, (SOLID_EVENTS - 1) * sizeof *e);
        w->event_count--;
    }
    uint32_t place = w->event_count++;
    for (; place > 0 && event_before(&w->events[place - 1], e); place--)
        w->events[place] = w->events[place - 1];
    w->events[place] = *e;
    if (e->error > w->most_error) w->most_error = e->error;
}

// Whether the part's crossing at t is behind us.
static inline bool is_done(const solid_walk *w, double t) { return t < w->from || t <= w->done; }
static inline double begin_of_rest(const solid_walk *w) {
    return w->done > -INFINITY ? sagi_next_up(w->done) : w->from;
}

#include "kernel/solid_parts.inl"

#include "kernel/solid_queue.inl"

static inline const solid_event *next_event(const solid_walk *w) { return &w->events[w->event_count - 1]; }

// Up to where a crossing may be that is in a group with the next one.
SAGI_INLINE double end_of_next(const solid_walk *w) {
    const solid_event *e = next_event(w);
    return e->t + (e->error + tolerance(w, e->t));
}

// Brings about that the next crossing is known, and every other that may be in one group with it; false when
// there is none. (With few leaves, first all that begin before the first crossing there is.)
SAGI_INLINE bool know_next(solid_walk *w) {
    if (w->few > 0) {
        while (w->event_count == 0) {
            if (!(w->nearest < INFINITY)) return false;
            open_few(w, w->nearest);
        }
        open_few(w, limit_of(w, end_of_next(w)));
        return true;
    }
    for (;;) {
        if (w->event_count == 0 && w->events_cut) refill_events(w);
        double until = w->event_count > 0 ? end_of_next(w) : INFINITY;
        if (!open_next(w, until)) return w->event_count > 0;
    }
}

#include "kernel/solid_group.inl"

static inline void take_hit(question asked, level *here, const sag_hit *hit) {
    search *s = here->search;
    if (asked == ALL) {
        if (s->visitor != NULL)
            s->visitor->take(s->visitor->user, hit);
        else
            sagi_collector_add(&s->collector, hit);
    } else if (!s->found || sagi_hit_before(hit, s->best)) {
        *s->best = *hit, s->found = s->odd = true;
        lower_t_max(here, hit->t);
    }
}

typedef enum solid_report { BEFORE, TAKEN, BEYOND } solid_report;

static inline solid_report report(question asked, solid_walk *w, solid_event *e, bool entering) {
    level *here = w->here;
    if (e->error > 0) refine(w, e);
    if (e->t < here->ray->t_min) return BEFORE;
    if (!(e->t <= here->t_max)) return BEYOND;
    if (asked == ANY) {
        here->search->found = true;
        return TAKEN;
    }
    search *s = here->search;
    if (asked == CLOSEST && !e->again && (!s->found || e->t < s->best->t)) { // in its place at once
        write_hit(s, w->parts[e->part].geometry, e->primitive, e->t, 0, 0, s->best);
        s->best->flipped = e->entering != entering, s->found = s->odd = true;
        lower_t_max(here, e->t);
        return TAKEN;
    }
    sag_hit hit;
    fill_hit(w, e, &hit);
    hit.flipped ^= e->entering != entering;
    take_hit(asked, here, &hit);
    return TAKEN;
}

#include "kernel/solid_slow.inl"

static inline void place_line(solid_walk *w) {
    w->origin = sagi_d4_load((const char *)&w->line + offsetof(sag_ray, origin));
    w->direction = sagi_d4_load((const char *)&w->line + offsetof(sag_ray, direction));
    sagi_d4 square = w->direction * w->direction;
    w->squared = square[0] + square[1] + square[2];
}

// False when the ray has no business in the solid.
SAGI_INLINE bool begin_solid(solid_walk *w, bool rough, level *here) {
    const sagi_world *world = here->world;
    here->in_tree = world->tree.node_count != 0 && sagi_float_ray_make(world, here->ray, &here->tree_ray);
    if (!here->in_tree && (world->unbounded_count == 0 || !sag_ray_is_valid(here->ray))) return false;
    if (here->in_tree) {
        here->limit = here->tree_ray.limit;
        if (here->t_max < here->ray->t_max) lower_t_max(here, here->t_max);
    }
    w->few = rough && here->in_tree && world->tree.node_count <= SOLID_FEW ? world->tree.node_count : 0;
    if (w->few > 0 && !look_at_all(w, here) && world->unbounded_count == 0) return false;
    if (w->few == 0 && here->in_tree) w->slabs = slabs_of(&here->tree_ray, here->world->tree.nodes);
    w->rough = rough;
    w->here = here, w->solid = world->solid;
    w->nodes = sagi_solid_nodes(w->solid), w->parts = sagi_solid_parts(w->solid);
    w->line = *here->ray;
    w->line.t_min = -INFINITY, w->line.t_max = INFINITY;
    place_line(w);
    w->reach = largest_of_three(sagi_d4_abs(w->origin)) / largest_of_three(sagi_d4_abs(w->direction));
    w->from = here->ray->t_min - tolerance(w, here->ray->t_min);
    w->done = -INFINITY;
    w->end = here->t_max + 4 * tolerance(w, here->t_max);
    w->most_error = 0;
    w->value = w->crowded = w->waiting_cut = w->events_cut = false;
    w->opened = 0;
    w->waiting_count = w->event_count = w->active_count = 0;
    w->last_asked = SAG_INVALID_ID, w->owed_count = 0;
    if (w->solid->node_count <= SOLID_ACTIVE)
        for (uint32_t i = 0; i < w->solid->node_count; i++) w->number[i] = 0;
    if (here->in_tree && w->few == 0) add_waiting(w, 0); // the root
    return true;
}

// Finds the boundaries in the ray's range. True when the search is over. *inside: whether the ray is in the
// solid before the first of them. A rough search that runs out of room is begun anew.
SAGI_INLINE bool run_solid_so(question asked, bool rough, level *here, bool *inside, bool *again) {
    solid_walk w;
    solid_group group;
    *inside = false;
    if (!begin_solid(&w, rough, here)) return false;
    for (uint32_t i = 0; i < here->world->unbounded_count; i++)
        open_part(&w, part_at(&w, here->world->unbounded[i]));
    double complete = w.from;
    while (know_group(&w)) {
        if (!(next_event(&w)->t - next_event(&w)->error <= here->t_max)) break;
        bool before = w.value;
        take_group(&w, &group);
        if (rough && (w.events_cut || w.crowded)) break;
        if (w.crowded) break;
        if (w.value != before) {
            solid_event *e = group.count == 1 ? &group.at[0] : choose(&w, &group, group.at[0].t);
            if (w.crowded) break;
            solid_report done = report(asked, &w, e, !before);
            *inside = before;
            if (done != BEFORE && asked != ALL) return asked == ANY && done == TAKEN;
        }
        complete = w.done;
        if (w.owed_count > 0) pay(&w);
    }
    if (rough && (w.events_cut || w.crowded)) return !(*again = true);
    if (w.crowded) return slow_solid(asked, &w, complete, inside);
    *inside = w.value;
    return false;
}

static __attribute__((noinline, hot)) bool run_solid_exactly(question asked, level *here, bool *inside) {
    bool again;
    return run_solid_so(asked, false, here, inside, &again);
}

static __attribute__((noinline, hot)) bool run_solid(question asked, level *here, bool *inside) {
    if (asked == ALL) return run_solid_exactly(asked, here, inside);
    bool again = false, over = run_solid_so(asked, true, here, inside, &again);
    return __builtin_expect(again, 0) ? run_solid_exactly(asked, here, inside) : over;
}

// Whether the ray begins in the solid, as one crossing or none: parity is asked for. (Where a solid goes on
// for ever, the number of crossings would not tell.)
static __attribute__((noinline)) void count_inside(level *here) {
    sag_hit hit;
    search s = {.best = &hit};
    level there;
    bool inside;
    enter(&there, here->world, here->ray, &s);
    run_solid(CLOSEST, &there, &inside);
    here->search->collector.count += inside;
}

static bool search_solid(question asked, level *here) {
    bool inside;
    if (asked == ALL && here->search->repeats.again) return false; // collected in the first walk
    if (asked == ALL && here->search->both_sides && here->search->visitor == NULL) {
        count_inside(here);
        return false;
    }
    return run_solid(asked, here, &inside);
}
