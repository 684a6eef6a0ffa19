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
#define SOLID_EVENTS  128
#define SOLID_ACTIVE  128
#endif
#define SOLID_GROUP   16
#define SOLID_IS_PART 0x80000000u

typedef struct solid_event {
    double t;
    uint32_t part, primitive;
    uint32_t number; // which of its part's crossings
    bool entering;   // the part
} solid_event;

typedef struct solid_walk {
    level *here;
    const sagi_solid *solid;
    const sagi_solid_node *nodes;
    const sagi_solid_part *parts;
    sag_ray line; // the whole line
    double reach; // |o|∞/|d|∞
    double done;  // up to where crossings are accounted for
    double end;   // up to where they matter
    bool value;   // of the solid there
    bool crowded; // too many active nodes
    bool waiting_cut, events_cut;
    uint64_t opened;      // the last part that was opened, or 0
    uint64_t waiting_end; // with waiting_cut: the first that the queue may lack
    solid_event events_end;
    solid_event resume;  // while events that were given up are found again
    uint32_t last_asked; // the part of a mesh or solid whose crossing last_hit is
    sag_hit last_hit;
    slabs slabs;
    uint32_t waiting_count, event_count, active_count;
    uint64_t waiting[SOLID_WAITING]; // the nearest last: τ's bits, SOLID_IS_PART, number
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
}

#include "kernel/solid_parts.inl"

static inline void add_waiting(solid_walk *w, uint64_t key) {
    if (w->waiting_cut && key >= w->waiting_end) return;
    if (w->waiting_count == SOLID_WAITING) {
        w->waiting_cut = true;
        w->waiting_end = key < w->waiting[0] ? w->waiting[0] : key;
        if (key >= w->waiting[0]) return;
        memmove(w->waiting, w->waiting + 1, (SOLID_WAITING - 1) * sizeof key);
        w->waiting_count--;
    }
    uint32_t place = w->waiting_count++;
    for (; place > 0 && w->waiting[place - 1] < key; place--) w->waiting[place] = w->waiting[place - 1];
    w->waiting[place] = key;
}

// Beginnings are not negative: their bits are in order.
static inline uint64_t waiting_key(float begin, uint32_t what) {
    union {
        float value;
        uint32_t bits;
    } u = {.value = begin};
    return (uint64_t)u.bits << 32 | what;
}
static inline float begin_of(uint64_t key) {
    union {
        uint32_t bits;
        float value;
    } u = {.bits = (uint32_t)(key >> 32)};
    return u.value;
}

// The children of a node that the ray meets; returns how many and writes where they begin.
SAGI_INLINE uint32_t met_children(const solid_walk *w, uint32_t number, float begin[SAGI_BVH_WIDTH],
                                  uint32_t child[SAGI_BVH_WIDTH]) {
    const sagi_bvh_node *node = &w->here->world->tree.nodes[number];
    const char *at = (const char *)node;
    sagi_f8 from = begins_of(at, &w->slabs), end = ends_of(at, &w->slabs, w->here->limit);
    uint32_t count = 0;
    for (uint32_t mask = sagi_i8_mask(sagi_f8_at_most(from, end)); mask != 0; mask &= mask - 1, count++) {
        uint32_t lane = (uint32_t)__builtin_ctz(mask);
        begin[count] = from[lane], child[count] = node->child[lane];
    }
    return count;
}

static inline uint32_t part_at(const solid_walk *w, sagi_bvh_reference r) {
    return sagi_solid_part_of(w->solid)[r.geometry];
}

static inline void expand(solid_walk *w, uint32_t node) {
    const sagi_bvh *tree = &w->here->world->tree;
    float begin[SAGI_BVH_WIDTH];
    uint32_t child[SAGI_BVH_WIDTH];
    uint32_t count = met_children(w, node, begin, child);
    for (uint32_t i = 0; i < count; i++) {
        if ((child[i] & SAGI_BVH_LEAF) == 0) {
            add_waiting(w, waiting_key(begin[i], child[i]));
            continue;
        }
        const sagi_reference_block *block = (const void *)sagi_leaf(tree, child[i]);
        for (uint32_t k = 0; k < block->head.count; k++)
            add_waiting(w, waiting_key(begin[i], SOLID_IS_PART | part_at(w, block->reference[k])));
    }
}

// Visits every part that the ray meets, with its key.
static __attribute__((noinline, cold)) void every_part(solid_walk *w,
                                                       void (*visit)(solid_walk *w, uint64_t key)) {
    const sagi_world *world = w->here->world;
    for (uint32_t i = 0; i < world->unbounded_count; i++)
        visit(w, waiting_key(0, SOLID_IS_PART | part_at(w, world->unbounded[i])));
    if (!w->here->in_tree) return;
    uint32_t nodes[SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH], height = 0;
    nodes[height++] = 0;
    while (height > 0) {
        float begin[SAGI_BVH_WIDTH];
        uint32_t child[SAGI_BVH_WIDTH];
        uint32_t count = met_children(w, nodes[--height], begin, child);
        for (uint32_t i = 0; i < count; i++) {
            if ((child[i] & SAGI_BVH_LEAF) == 0) {
                nodes[height++] = child[i];
                continue;
            }
            const sagi_reference_block *block = (const void *)sagi_leaf(&world->tree, child[i]);
            for (uint32_t k = 0; k < block->head.count; k++)
                visit(w, waiting_key(begin[i], SOLID_IS_PART | part_at(w, block->reference[k])));
        }
    }
}

static void let_wait_again(solid_walk *w, uint64_t key) {
    if (key > w->opened) add_waiting(w, key);
}
static void open_again(solid_walk *w, uint64_t key) {
    if (key <= w->opened) reopen_part(w, (uint32_t)key & ~SOLID_IS_PART);
}

// Opens the part whose box is the next, if it begins at `until` or before; false when none does.
static inline bool open_next(solid_walk *w, double until) {
    float limit = INFINITY;
    if (w->here->in_tree && until < INFINITY)
        limit = sagi_float_max(sagi_float_ray_limit(&w->here->tree_ray, until), w->here->tree_ray.from);
    for (;;) {
        if (w->waiting_count == 0) {
            if (!w->waiting_cut || !(begin_of(w->waiting_end) <= limit)) return false;
            w->waiting_cut = false;
            every_part(w, let_wait_again);
            if (w->waiting_count == 0) return false;
        }
        uint64_t key = w->waiting[w->waiting_count - 1];
        if (!(begin_of(key) <= limit)) return false;
        w->waiting_count--;
        if (((uint32_t)key & SOLID_IS_PART) != 0) {
            w->opened = key;
            open_part(w, (uint32_t)key & ~SOLID_IS_PART);
            return true;
        }
        expand(w, (uint32_t)key);
    }
}

static inline const solid_event *next_event(const solid_walk *w) { return &w->events[w->event_count - 1]; }

// Brings about that the next crossing is known, and every other that may be in one group with it; false when
// there is none.
static inline bool know_next(solid_walk *w) {
    for (;;) {
        if (w->event_count == 0 && w->events_cut) {
            w->events_cut = false;
            w->resume = w->events_end;
            every_part(w, open_again);
        }
        double until = INFINITY;
        if (w->event_count > 0) until = next_event(w)->t + tolerance(w, next_event(w)->t);
        if (!open_next(w, until)) return w->event_count > 0;
    }
}

// Crossings at one place, taken: the first few of them.
typedef struct solid_group {
    uint32_t count; // of all
    solid_event at[SOLID_GROUP];
} solid_group;

static inline void take_group(solid_walk *w, solid_group *group) {
    group->count = 0;
    do {
        solid_event e = w->events[--w->event_count];
        if (group->count < SOLID_GROUP) group->at[group->count] = e;
        group->count++;
        toggle(w, e.part, e.entering);
        w->done = e.t;
        if (is_asked_again(w, e.part)) ask_again(w, &e);
    } while (know_next(w) && next_event(w)->t - w->done <= tolerance(w, w->done));
}

static __attribute__((noinline, cold)) solid_event choose_from_all(solid_walk *w, double from, double to);

// The group's first crossing of the part, where it crosses an odd number of times, else NULL; *next becomes
// the part after it.
static inline const solid_event *crossing_of(const solid_group *group, uint32_t part, uint32_t *next) {
    const solid_event *e = NULL;
    bool odd = false;
    *next = SAG_INVALID_ID;
    for (uint32_t i = group->count; i-- > 0;) {
        if (group->at[i].part > part && group->at[i].part < *next) *next = group->at[i].part;
        if (group->at[i].part == part) e = &group->at[i], odd = !odd;
    }
    return odd ? e : NULL;
}

// Whose the boundary is: the first part whose crossing alone would have changed the solid, or where there is
// none, the first whose crossing does after those of the parts before it. `first` is the t of the group's
// first crossing.
static __attribute__((noinline)) const solid_event *choose(solid_walk *w, solid_group *group, double first) {
    const bool after = w->value;
    if (group->count > SOLID_GROUP) {
        group->at[0] = choose_from_all(w, sagi_next_down(first), w->done);
        return &group->at[0];
    }
    for (uint32_t i = 0; i < group->count; i++) toggle(w, group->at[i].part, !group->at[i].entering);
    const solid_event *owner = NULL;
    for (int together = 0; together < 2 && owner == NULL; together++) {
        uint32_t taken = 0;
        for (uint32_t part = 0, next; part != SAG_INVALID_ID && owner == NULL; part = next) {
            const solid_event *e = crossing_of(group, part, &next);
            if (e == NULL) continue;
            toggle(w, part, e->entering);
            if (w->value == after) owner = e;
            if (!together || owner != NULL)
                toggle(w, part, !e->entering);
            else
                taken = part + 1;
        }
        for (uint32_t part = 0, next; part < taken; part = next) { // as they were
            const solid_event *e = crossing_of(group, part, &next);
            if (e != NULL) toggle(w, part, !e->entering);
        }
    }
    for (uint32_t i = 0; i < group->count; i++) toggle(w, group->at[i].part, group->at[i].entering);
    return owner != NULL ? owner : &group->at[0];
}

static inline void take_hit(question asked, level *here, const sag_hit *hit) {
    search *s = here->search;
    if (asked == ALL) {
        if (s->visitor != NULL)
            s->visitor->take(s->visitor->user, hit);
        else
            sagi_collector_add(&s->collector, hit);
    } else if (!s->found || sagi_hit_before(hit, s->best)) {
        *s->best = *hit, s->found = true;
        lower_t_max(here, hit->t);
    }
}

typedef enum solid_report { BEFORE, TAKEN, BEYOND } solid_report;

static inline solid_report report(question asked, solid_walk *w, const solid_event *e, bool entering) {
    level *here = w->here;
    if (e->t < here->ray->t_min) return BEFORE;
    if (!(e->t <= here->t_max)) return BEYOND;
    if (asked == ANY) {
        here->search->found = true;
        return TAKEN;
    }
    sag_hit hit;
    fill_hit(w, e, &hit);
    hit.flipped ^= e->entering != entering;
    take_hit(asked, here, &hit);
    return TAKEN;
}

#include "kernel/solid_slow.inl"

// False when the ray has no business in the solid.
static inline bool begin_solid(solid_walk *w, level *here) {
    const sagi_world *world = here->world;
    if (!sag_ray_is_valid(here->ray)) return false;
    here->in_tree = world->tree.node_count != 0 && sagi_float_ray_make(world, here->ray, &here->tree_ray);
    if (!here->in_tree && world->unbounded_count == 0) return false;
    if (here->in_tree) {
        here->limit = here->tree_ray.limit;
        if (here->t_max < here->ray->t_max) lower_t_max(here, here->t_max);
    }
    if (here->in_tree) w->slabs = slabs_of(&here->tree_ray);
    w->here = here, w->solid = world->solid;
    w->nodes = sagi_solid_nodes(w->solid), w->parts = sagi_solid_parts(w->solid);
    w->line = *here->ray;
    w->line.t_min = -INFINITY, w->line.t_max = INFINITY;
    w->reach = sag_max_component(sag_abs(w->line.origin)) / sag_max_component(sag_abs(w->line.direction));
    w->done = sagi_next_down(here->ray->t_min - tolerance(w, here->ray->t_min));
    w->end = here->t_max + 4 * tolerance(w, here->t_max);
    w->value = w->crowded = w->waiting_cut = w->events_cut = false;
    w->opened = 0;
    w->waiting_count = w->event_count = w->active_count = 0;
    w->last_asked = SAG_INVALID_ID;
    if (w->solid->node_count <= SOLID_ACTIVE) memset(w->number, 0, w->solid->node_count * sizeof *w->number);
    for (uint32_t i = 0; i < world->unbounded_count; i++)
        add_waiting(w, waiting_key(0, SOLID_IS_PART | part_at(w, world->unbounded[i])));
    if (here->in_tree) add_waiting(w, 0); // the root
    return true;
}

// Finds the boundaries in the ray's range. True when the search is over. *inside: whether the ray is in the
// solid before the first of them.
static __attribute__((noinline)) bool run_solid(question asked, level *here, bool *inside) {
    solid_walk w;
    solid_group group;
    *inside = false;
    if (!begin_solid(&w, here)) return false;
    double complete = w.done;
    while (know_next(&w)) {
        if (!(next_event(&w)->t <= here->t_max)) break;
        bool before = w.value;
        take_group(&w, &group);
        if (w.crowded) break;
        if (w.value == before) {
            complete = w.done;
            continue;
        }
        const solid_event *e = group.count == 1 ? &group.at[0] : choose(&w, &group, group.at[0].t);
        if (w.crowded) break;
        complete = w.done;
        solid_report done = report(asked, &w, e, !before);
        *inside = before;
        if (done != BEFORE && asked != ALL) return asked == ANY && done == TAKEN;
    }
    if (w.crowded) return slow_solid(asked, &w, complete, inside);
    *inside = w.value;
    return false;
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
