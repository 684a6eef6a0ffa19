// SPDX-License-Identifier: MIT
// Many rays on one thread, a dozen of them under way at once. Part of kernel.inl.
//
// A step through a node is a chain of some forty cycles in which each instruction waits for the one before,
// and now and then for memory; only another ray can use the time. So the rays take turns: each makes one
// step, asks for the memory its next one needs (prefetch), and makes way. Rays that have come to a leaf wait
// until several have, since their tests run best one after the other, and so do rays that have come to their
// end with a hit to solve. What a ray does, it does as if it were alone; only the order among rays is
// different.
#include "kernel/packet.inl"

#define FLIGHTS       16
#define FLIGHT_STACK  96 // a ray that needs more goes on alone
#define ENOUGH_LEAVES 10

typedef struct flight {
    waiting next;
    uint32_t height; // of its stack
    size_t ray;      // its number in the batch
    search search;
    level here;
    float begin[FLIGHT_STACK + SAGI_BVH_WIDTH];
    uint32_t child[FLIGHT_STACK + SAGI_BVH_WIDTH];
} flight;

// Flights that wait for the same thing.
typedef struct queue {
    uint32_t count;
    flight *at[FLIGHTS];
} queue;

typedef struct crowd {
    const sagi_world *world;
    const sag_ray *rays;
    sag_hit *hits; // CLOSEST
    bool *dark;    // ANY
    size_t count, begun;
    uint16_t *number; // which rays, count of them
    queue at_node, at_leaf, at_end;
    flight flights[FLIGHTS];
} crowd;

SAGI_INLINE void queue_up(queue *q, flight *f) { q->at[q->count++] = f; }

SAGI_INLINE void fetch(const void *at, size_t bytes) {
    for (size_t i = 0; i < bytes; i += 64) __builtin_prefetch((const char *)at + i);
}

// Sends the flight where its next node or leaf says.
SAGI_INLINE void send(crowd *c, flight *f) {
    const sagi_bvh *tree = &c->world->tree;
    if ((f->next.child & SAGI_BVH_LEAF) == 0) {
        fetch(&tree->nodes[f->next.child], sizeof *tree->nodes);
        queue_up(&c->at_node, f);
    } else {
        fetch(sagi_leaf(tree, f->next.child), sizeof(sagi_triangle_block));
        queue_up(&c->at_leaf, f);
    }
}

SAGI_INLINE void write_answer(question asked, const crowd *c, size_t ray, bool found) {
    if (asked == ANY)
        c->dark[ray] = found;
    else if (!found)
        c->hits[ray] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
}

// Begins rays in this flight until one has business in the tree, or all have begun.
static __attribute__((noinline)) void begin(question asked, crowd *c, flight *f) {
    while (c->begun < c->count) {
        f->ray = c->number[c->begun++];
        // Its answer's place, and the ray that comes a few turns later.
        search *s = &f->search;
        s->best = asked == CLOSEST ? &c->hits[f->ray] : NULL;
        if (asked == CLOSEST) {
            __builtin_prefetch(s->best, 1);
            __builtin_prefetch((const char *)s->best + sizeof *s->best - 1, 1);
        }
        if (c->begun + 4 < c->count) fetch(&c->rays[c->number[c->begun + 4]], sizeof(sag_ray));
        s->found = false, s->both_sides = false, s->path_length = 0;
        enter(&f->here, c->world, &c->rays[f->ray], s);
        bool over;
        if (come_to_tree(asked, &f->here, &over)) {
            f->next = (waiting){0, 0}, f->height = 0;
            queue_up(&c->at_node, f);
            return;
        }
        write_answer(asked, c, f->ray, s->found);
    }
}

SAGI_INLINE void end(question asked, crowd *c, flight *f) {
    write_answer(asked, c, f->ray, f->search.found);
    begin(asked, c, f);
}

// What was to be done is done; what next?
SAGI_INLINE void go_on(question asked, crowd *c, flight *f) {
    stack waits = {f->begin, f->child, f->height};
    bool more = pop(asked, f->here.limit, &waits, &f->next);
    f->height = waits.height;
    if (more) {
        send(c, f);
    } else if (asked == CLOSEST && f->here.candidate_count == 1 &&
               f->here.candidates[0].block->kind == SAGI_BLOCK_TRIANGLES) {
        fetch_corners(&f->here, &f->here.candidates[0]);
        queue_up(&c->at_end, f);
    } else {
        if (asked == CLOSEST) settle(&f->here);
        end(asked, c, f);
    }
}

// A stack that is about to overflow: the single walk has room for the deepest tree.
static __attribute__((noinline, cold)) void go_alone(question asked, crowd *c, flight *f) {
    search *s = &f->search;
    s->found = false;
    enter(&f->here, c->world, &c->rays[f->ray], s);
    if (asked == ANY)
        walk_any(&f->here);
    else
        walk_closest(&f->here);
    end(asked, c, f);
}

SAGI_INLINE void all_step(question asked, crowd *c) {
    const sagi_bvh_node *nodes = c->world->tree.nodes;
    uint32_t count = c->at_node.count;
    c->at_node.count = 0; // refilled from the front, never beyond the one at hand
    for (uint32_t i = 0; i < count; i++) {
        flight *f = c->at_node.at[i];
        stack waits = {f->begin, f->child, f->height};
        bool met = step(asked, &nodes[f->next.child], &f->here.tree_ray, f->here.limit, &waits, &f->next);
        f->height = waits.height;
        if (!met)
            go_on(asked, c, f);
        else if (waits.height > FLIGHT_STACK)
            go_alone(asked, c, f);
        else
            send(c, f);
    }
}

SAGI_INLINE void all_leaves(question asked, crowd *c) {
    uint32_t count = c->at_leaf.count;
    c->at_leaf.count = 0;
    for (uint32_t i = 0; i < count; i++) {
        flight *f = c->at_leaf.at[i];
        if (leaf(asked, &f->here, sagi_leaf(&c->world->tree, f->next.child), f->next.begin))
            end(asked, c, f);
        else
            go_on(asked, c, f);
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
        put_corners(&four, i, item[i], sagi_block_reference(c->block, c->lane).primitive);
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
    uint32_t count = c->at_end.count, begun = 0;
    flight *now[FLIGHTS];
    for (uint32_t i = 0; i < count; i++) now[i] = c->at_end.at[i];
    c->at_end.count = 0;
    for (uint32_t n; begun < count; begun += n) {
        n = count - begun < 4 ? count - begun : 4;
        settle_four(now + begun, n);
        for (uint32_t i = begun; i < begun + n; i++) end(asked, c, now[i]);
    }
}

SAGI_INLINE void trace_crowd(question asked, crowd *c) {
    c->begun = 0;
    c->at_node.count = c->at_leaf.count = c->at_end.count = 0;
    for (uint32_t i = 0; i < FLIGHTS; i++) begin(asked, c, &c->flights[i]);
    for (;;) {
        while (c->at_node.count > 0 && c->at_leaf.count < ENOUGH_LEAVES) all_step(asked, c);
        if (c->at_leaf.count > 0)
            all_leaves(asked, c);
        else if (c->at_end.count > 0)
            all_ends(asked, c);
        else
            break;
        if (c->at_end.count >= FLIGHTS / 4) all_ends(asked, c);
    }
}

// Sixteen neighbours that run alike walk the tree as one (packet.inl); the others make up the crowd.
#define CROWD 1024

static void intersect_batch(const sagi_world *world, const sag_ray *rays, sag_hit *hits, size_t count) {
    uint16_t number[CROWD];
    packet_luck luck = {0};
    crowd c;
    c.world = world, c.number = number, c.dark = NULL;
    for (size_t first = 0, end; first < count; first = end) {
        end = count - first < CROWD ? count : first + CROWD;
        c.rays = rays + first, c.hits = hits + first, c.count = 0;
        for (size_t i = first, next; i < end; i = next) {
            next = end - i < PACKET_RAYS ? end : i + PACKET_RAYS;
            if (next - i == PACKET_RAYS && packet_intersect(world, rays + i, hits + i, &luck)) continue;
            for (; i < next; i++) number[c.count++] = (uint16_t)(i - first);
        }
        trace_crowd(CLOSEST, &c);
    }
}

static void occluded_batch(const sagi_world *world, const sag_ray *rays, bool *dark, size_t count) {
    uint16_t number[CROWD];
    crowd c;
    c.world = world, c.number = number, c.hits = NULL;
    for (size_t first = 0; first < count; first += c.count) {
        c.rays = rays + first, c.dark = dark + first;
        c.count = count - first < CROWD ? count - first : CROWD;
        for (size_t i = 0; i < c.count; i++) number[i] = (uint16_t)i;
        trace_crowd(ANY, &c);
    }
}
