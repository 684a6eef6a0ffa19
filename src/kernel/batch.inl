// SPDX-License-Identifier: MIT
// Many rays on one thread, a dozen of them under way at once. Part of kernel.inl.
//
// A step through a node is a chain of some sixty cycles in which each instruction waits for the one before,
// and now and then for memory; only another ray can use the time. So the rays take turns: each makes one
// step, asks for the memory its next one needs (prefetch), and makes way. Rays that have come to a leaf wait
// until several have, and so do rays that have come to their end with a hit to solve. What a ray does, it
// does as if it were alone; only the order among rays is different.
//
// Two things keep the processor from filling the time. A branch that it guesses wrong throws away what it has
// done for the rays behind: so a flight goes from queue to queue by arithmetic, whatever its step came to
// (send), and only what is rare is a branch. And it looks ahead some 300 instructions at most, less than
// three steps: so a step is cut in two where most of its waiting is, and each half is done for all rays in a
// row.
#include "kernel/put_off.inl"

#include "kernel/front.inl"

#include "kernel/packet.inl"
#include "kernel/solid_batch.inl"

#define FLIGHTS       16
#define FLIGHT_STACK  200 // enough for 27 levels below a front; in deeper trees rays go alone
#define ENOUGH_LEAVES 10
#define UNDER         2 // places below a flight's stack, so that there are always two on top

// A child, with the bits of the float where it begins above its number: such pairs are in the order of their
// beginnings, as those are not negative.
typedef uint64_t place;

typedef struct flight {
    const void *at; // its next node or leaf,
    place next;     // which that is,
    place limit;    // and the last one that still matters
    place *top;     // of its stack: the first that is free
    size_t ray;     // its number in the batch
    search search;
    level here;
    const sagi_triangle_block *block; // the one that was met last (here.answer)
    float block_begin;
    place stack[FLIGHT_STACK + SAGI_BVH_WIDTH];
} flight;

// What flights wait for: a node; a leaf; to look what is next, as what was on top of the stack does not
// matter any more; to take note of triangles that were met; to have a hit solved.
typedef enum errand { AT_NODE, AT_LEAF, AT_LOOK, AT_MET, AT_END, ERRAND_COUNT } errand;

typedef struct crowd {
    flight **last[ERRAND_COUNT]; // of those that wait for the same: the next place
    const sagi_world *world;
    const sag_ray *rays;
    sag_hit *hits;  // CLOSEST
    bool *dark;     // ANY
    bool *doubtful; // of a mesh within a solid: whether the hit is not one crossing and alone; else NULL
    later *later;   // or NULL
    size_t count, begun;
    uint16_t *number;           // which rays, count of them
    const front_places *fronts; // where they begin, one for PACKET_RAYS rays; or NULL
    bool deep;                  // a flight's stack might not do
    bool plain;                 // that is not so, nor is anything else unusual (sagi_world.plain)
    sagi_places places;
    flight *waiting[ERRAND_COUNT][FLIGHTS];
    flight flights[FLIGHTS];
} crowd;

SAGI_INLINE void queue_up(crowd *c, size_t e, flight *f) {
    *c->last[e] = f;
    c->last[e]++;
}

SAGI_INLINE uint32_t count_of(const crowd *c, errand e) { return (uint32_t)(c->last[e] - c->waiting[e]); }
// Empties the queue, which may be refilled from the front while it is read.
SAGI_INLINE uint32_t take_queue(crowd *c, errand e) {
    uint32_t count = count_of(c, e);
    c->last[e] = c->waiting[e];
    return count;
}

SAGI_INLINE float place_begin(place p) { return float_of((uint32_t)(p >> 32)); }

// Of the two places on top of a flight's stack, the nearer one comes to stand above.
SAGI_INLINE void nearer_above(place *top) {
    const place a = top[-1], b = top[-2];
    top[-1] = sagi_if_above_long(a, b, b, a), top[-2] = sagi_if_above_long(a, b, a, b);
}
SAGI_INLINE place take(question asked, place **top) {
    if (asked == CLOSEST) nearer_above(*top);
    return *--*top;
}

// The last one that begins at the limit.
SAGI_INLINE place last_place(float limit) { return (place)float_bits(limit) << 32 | UINT32_MAX; }

// What follows from here.limit, whenever that may have changed.
SAGI_INLINE void set_limit(flight *f) { f->limit = last_place(f->here.limit); }

// Sends the flight on to its next place, or first to take note of what it met. Which it will be nobody can
// foresee, so nothing here is a branch.
SAGI_INLINE void send(crowd *c, flight *f, place next, bool met) {
    const size_t leaf = (uint32_t)next >> 31;
    const void *at = sagi_place_at(&c->places, (uint32_t)next);
    f->next = next, f->at = at;
    fetch_place(at);
    size_t e = sagi_if_above_long(next, f->limit, AT_LOOK, leaf);
    if (!__builtin_constant_p(met)) e = sagi_if_above_long(met, 0, AT_MET, e);
    queue_up(c, e, f);
}

SAGI_INLINE void write_answer(question asked, const crowd *c, size_t ray, bool found) {
    if (asked == ANY)
        c->dark[ray] = found;
    else if (!found)
        c->hits[ray] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
}

SAGI_INLINE void leave(question asked, crowd *c, flight *f) {
    if (asked == CLOSEST && c->doubtful != NULL)
        c->doubtful[f->ray] = f->search.found && (f->search.near || !f->search.odd);
    write_answer(asked, c, f->ray, f->search.found);
}

// Brings the flight to the tree, or through all of it where its stack might not do. False when that is the
// end of it. `plain`: as in crowd.
SAGI_INLINE bool set_out(question asked, bool plain, crowd *c, flight *f) {
    slabs unused;
    bool over;
    size_t signs;
    if (!plain && c->deep) {
        if (asked == ANY)
            walk_any(&f->here);
        else
            walk_closest(&f->here);
        return false;
    }
    if (!come_to_tree(asked, plain, &f->here, &unused, &signs, &over)) return false;
    f->here.tree_ray.planes = sagi_planes[signs];
    f->limit = last_place(f->here.limit);
    f->top = f->stack + UNDER, f->at = c->world->tree.nodes, f->next = 0;
    if (asked == ANY || c->fronts == NULL) return true;
    const front_places *from = &c->fronts[f->ray / PACKET_RAYS];
    memcpy(f->top, from->places, sizeof from->places);
    f->top += FRONT - 1, f->next = *f->top;
    if (f->next == NOTHING) return false;
    f->at = sagi_bvh_node_at(&c->world->tree, (uint32_t)f->next);
    fetch_place(f->at);
    return true;
}

// Begins rays in this flight until one has business in the tree, or all have begun.
static __attribute__((noinline)) void begin(question asked, crowd *c, flight *f) {
    while (c->begun < c->count) {
        f->ray = c->number[c->begun++];
        // Its answer's place, and the ray that comes a few turns later.
        search *s = &f->search;
        begin_search(s, asked == CLOSEST ? &c->hits[f->ray] : NULL);
        if (asked == CLOSEST) fetch_answer(s->best);
        if (c->begun + 4 < c->count) {
            const sag_ray *ahead = &c->rays[c->number[c->begun + 4]];
            __builtin_prefetch(ahead), __builtin_prefetch((const char *)ahead + 64);
        }
        enter_walk(&f->here, c->world, &c->rays[f->ray], s);
        bool out;
        if (__builtin_expect(c->plain, 1)) {
            out = set_out(asked, true, c, f);
        } else {
            s->later = c->later;
            if (c->doubtful != NULL)
                s->grain = 0x1p-48, s->reach = reach_of(&c->rays[f->ray]), s->near = false;
            out = set_out(asked, false, c, f);
        }
        if (__builtin_expect(out, 1)) {
            queue_up(c, AT_NODE, f);
            return;
        }
        leave(asked, c, f);
    }
}

SAGI_INLINE void end(question asked, crowd *c, flight *f) {
    leave(asked, c, f);
    begin(asked, c, f);
}

SAGI_INLINE void all_steps(question asked, crowd *c) {
    uint32_t count = take_queue(c, AT_NODE);
    // Which children each ray meets, and which of them first.
    sagi_f8 begins[FLIGHTS];
    uint32_t lanes[FLIGHTS], masks[FLIGHTS];
    for (uint32_t i = 0; i < count; i++) {
        const flight *f = c->waiting[AT_NODE][i];
        const slabs r = slabs_of(&f->here.tree_ray, f->at);
        sagi_f8 begin = begins_of(0, &r), end = ends_of(0, &r, f->here.limit);
        SAGI_KERNEL_COUNT(nodes);
        begins[i] = begin;
        const sagi_i8 order = sagi_f8_in_order(begin, end, &masks[i]);
        if (asked == CLOSEST) lanes[i] = sagi_i8_least(order); // else any child will do as the first
    }
    // The first is next, or what is on top of the stack; the others go on it.
    for (uint32_t i = 0; i < count; i++) {
        flight *f = c->waiting[AT_NODE][i];
        const sagi_bvh_node *node = f->at;
        const uint32_t mask = masks[i];
        const uint32_t lane = asked == ANY ? (uint32_t)__builtin_ctz(mask | 0x80) : lanes[i] & 7;
        const uint32_t begin = asked == ANY ? float_bits(((const float *)&begins[i])[lane]) : lanes[i] & ~7U;
        place *top = f->top;
        if (asked == CLOSEST) nearer_above(top);
        const place next = sagi_if_above_long(mask, 0, (place)begin << 32 | node->child[lane], top[-1]);
        sagi_write_pairs(mask & ~(1U << lane), begins[i], sagi_i8_load(node->child), top);
        f->top = top + __builtin_popcount(mask) - 1;
        send(c, f, next, false);
    }
}

// A leaf that holds something else than triangles.
static __attribute__((noinline)) void other_leaf(question asked, crowd *c, flight *f) {
    if (leaf(asked, &f->here, f->at, place_begin(f->next))) {
        end(asked, c, f);
        return;
    }
    set_limit(f);
    send(c, f, take(asked, &f->top), false);
}

SAGI_INLINE void all_leaves(question asked, crowd *c) {
    uint32_t count = take_queue(c, AT_LEAF);
    for (uint32_t i = 0; i < count; i++) {
        flight *f = c->waiting[AT_LEAF][i];
        const sagi_triangle_block *block = f->at;
        if (__builtin_expect(block->head.kind != SAGI_BLOCK_TRIANGLES, 0)) {
            other_leaf(asked, c, f);
            continue;
        }
        SAGI_KERNEL_COUNT(blocks);
        f->block = block, f->block_begin = place_begin(f->next);
        bool met =
            meet_triangles(block, &f->here.tree_ray, f->block_begin, f->here.limit, true, &f->here.answer);
        send(c, f, take(asked, &f->top), met);
    }
}

SAGI_INLINE void all_met(question asked, crowd *c) {
    uint32_t count = take_queue(c, AT_MET);
    for (uint32_t i = 0; i < count; i++) {
        flight *f = c->waiting[AT_MET][i];
        if (take_triangles(asked, &f->here, f->block, &f->here.answer, f->block_begin)) {
            end(asked, c, f);
            continue;
        }
        set_limit(f);
        queue_up(c, f->next > f->limit ? AT_LOOK : (uint32_t)f->next >> 31, f);
    }
}

// Finds the next that still matters, or that there is none.
SAGI_INLINE void all_look(question asked, crowd *c) {
    uint32_t count = take_queue(c, AT_LOOK);
    for (uint32_t i = 0; i < count; i++) {
        flight *f = c->waiting[AT_LOOK][i];
        place next = f->next, *top = f->top;
        while (next > f->limit && next != NOTHING) next = take(asked, &top);
        f->top = top;
        if (next != NOTHING) {
            send(c, f, next, false);
        } else if (asked == CLOSEST && f->here.candidate_count == 1 &&
                   f->here.candidates[0].block->kind == SAGI_BLOCK_TRIANGLES) {
            fetch_corners(&f->here, &f->here.candidates[0]);
            queue_up(c, AT_END, f);
        } else {
            if (asked == CLOSEST && f->here.candidate_count != 0) settle(&f->here);
            end(asked, c, f);
        }
    }
}

// t, u and v of up to four rays that have come to their end with one candidate each.
static __attribute__((noinline)) void settle_four(flight *const at[], uint32_t count) {
    sagi_triangle_four four;
    const sagi_item *item[4];
    const candidate *found[4];
    for (uint32_t i = 0; i < 4; i++) {
        const level *here = &at[i < count ? i : 0]->here;
        const candidate *c = found[i] = &here->candidates[0];
        item[i] = item_of(here, c->block);
        four.ray[i] = here->ray;
        four.t_max[i] = here->t_max;
        put_corners(&four, i, here->world, (const sagi_triangle_block *)(const void *)c->block, c->lane);
    }
    uint32_t hit = sagi_triangle_solve4(&four, (1U << count) - 1);
    for (; hit != 0; hit &= hit - 1) {
        const int i = __builtin_ctz(hit);
        const candidate *c = found[i];
        double u = four.u[i], v = four.v[i];
        accept(CLOSEST, &at[i]->here, c->block->geometry, sagi_block_reference(c->block, c->lane).primitive,
               four.t[i], item[i]->mirrored ? v : u, item[i]->mirrored ? u : v);
    }
}

SAGI_INLINE void all_ends(question asked, crowd *c) {
    uint32_t count = take_queue(c, AT_END), begun = 0;
    flight **now = c->waiting[AT_END];
    for (uint32_t n; begun < count; begun += n) {
        n = count - begun < 4 ? count - begun : 4;
        settle_four(now + begun, n);
        for (uint32_t i = begun; i < begun + n; i++) end(asked, c, now[i]);
    }
}

SAGI_INLINE void trace_crowd(question asked, crowd *c) {
    c->begun = 0;
    c->deep = c->world->tree.depth > (FLIGHT_STACK - UNDER - FRONT) / (SAGI_BVH_WIDTH - 1);
    c->places = c->world->places;
    for (int i = 0; i < ERRAND_COUNT; i++) c->last[i] = c->waiting[i];
    c->plain = c->world->plain && !c->deep && c->doubtful == NULL && c->later == NULL;
    for (uint32_t i = 0; i < FLIGHTS; i++) {
        for (int k = 0; k < UNDER; k++) c->flights[i].stack[k] = NOTHING;
        begin(asked, c, &c->flights[i]);
    }
    for (;;) {
        while (count_of(c, AT_NODE) > 0 && count_of(c, AT_LEAF) < ENOUGH_LEAVES) {
            all_steps(asked, c);
            all_look(asked, c);
        }
        if (count_of(c, AT_LEAF) > 0) {
            all_leaves(asked, c);
            all_met(asked, c);
            all_look(asked, c);
        } else if (count_of(c, AT_END) > 0) {
            all_ends(asked, c);
        } else {
            break;
        }
        if (count_of(c, AT_END) >= FLIGHTS / 4) all_ends(asked, c);
    }
}

// Sixteen neighbours that run alike walk the tree as one (packet.inl); the others make up the crowd. doubtful
// (or NULL): as in crowd.
static void intersect_all_of(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count,
                             bool *doubtful) {
    uint16_t number[CROWD];
    front_crowd wanted;
    packet_luck luck = {0};
    later put;
    crowd c;
    wanted.count = 0, wanted.luck = luck;
    c.world = world, c.number = number, c.dark = NULL;
    c.later = doubtful == NULL && world->instance_levels > 0 ? &put : NULL;
    for (size_t first = 0, end; first < count; first = end) {
        end = count - first < CROWD ? count : first + CROWD;
        c.rays = put.rays = rays + first, c.hits = hits + first, c.count = 0;
        c.doubtful = doubtful != NULL ? doubtful + first : NULL;
        put.count = 0, wanted.used = false;
        for (size_t i = first, next; i < end; i = next) {
            const uint32_t put_before = put.count;
            next = end - i < PACKET_RAYS ? end : i + PACKET_RAYS;
            uint32_t left = (1U << (next - i)) - 1;
            if (next - i == PACKET_RAYS)
                left = packet_intersect(world, rays + i, hits + i, doubtful != NULL ? doubtful + i : NULL,
                                        c.later, &luck, &wanted, &wanted.fronts[(i - first) / PACKET_RAYS]);
            if (put.count > put_before) forget_put_off(&put, put_before, (uint32_t)(i - first), left);
            for (; left != 0; left &= left - 1)
                number[c.count++] = (uint16_t)(i - first + (size_t)__builtin_ctz(left));
        }
        if (wanted.count > 0) find_fronts(world, &wanted);
        c.fronts = wanted.used ? wanted.fronts : NULL;
        trace_crowd(CLOSEST, &c);
        if (put.count > 0) take_up(world, &put, hits + first);
    }
}

static void intersect_batch(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count) {
    if (world->carved != NULL) {
        intersect_carved(world, rays, hits, count);
    } else if (world->solid == NULL) {
        intersect_all_of(world, rays, hits, count, NULL);
    } else { // has no tree of primitives
        for (size_t i = 0; i < count; i++)
            if (!intersect(world, &rays[i], &hits[i]))
                hits[i] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
    }
}

static void occluded_batch(const sagi_world *world, const sag_ray *rays, bool *dark, size_t count) {
    if (world->solid != NULL) {
        for (size_t i = 0; i < count; i++) dark[i] = occluded(world, &rays[i]);
        return;
    }
    uint16_t number[CROWD];
    crowd c;
    c.world = world, c.number = number, c.hits = NULL, c.fronts = NULL, c.doubtful = NULL, c.later = NULL;
    for (size_t first = 0; first < count; first += c.count) {
        c.rays = rays + first, c.dark = dark + first;
        c.count = count - first < CROWD ? count - first : CROWD;
        for (size_t i = 0; i < c.count; i++) number[i] = (uint16_t)i;
        trace_crowd(ANY, &c);
    }
}
