// SPDX-License-Identifier: MIT
// What waits of a solid's box tree, the nearest first (solid.inl). Part of kernel.inl. Of a small tree all
// leaves are looked at at once, eight at a time, and those that are met wait where they are.

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
SAGI_INLINE uint32_t met_children(const solid_walk *w, uint32_t at, float begin[SAGI_BVH_WIDTH],
                                  uint32_t child[SAGI_BVH_WIDTH]) {
    const sagi_bvh_node *node = sagi_bvh_node_at(&w->here->world->tree, at);
    const size_t bytes = at * SAGI_BVH_STEP;
    sagi_f8 from = begins_of(bytes, &w->slabs), end = ends_of(bytes, &w->slabs, w->here->limit);
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
    float begin[SAGI_BVH_WIDTH];
    uint32_t child[SAGI_BVH_WIDTH];
    uint32_t count = met_children(w, node, begin, child);
    for (uint32_t i = 0; i < count; i++) add_waiting(w, waiting_key(begin[i], child[i]));
}

static inline void open_leaf(solid_walk *w, uint32_t child, void (*open)(solid_walk *w, uint32_t part)) {
    const sagi_reference_block *block = (const void *)sagi_leaf(&w->here->world->tree, child);
    for (uint32_t k = 0; k < block->head.count; k++) open(w, part_at(w, block->reference[k]));
}

// Visits every leaf that the ray meets, with its key.
static __attribute__((noinline, cold)) void every_leaf(solid_walk *w,
                                                       void (*visit)(solid_walk *w, uint64_t key)) {
    if (!w->here->in_tree) return;
    uint32_t nodes[SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH], height = 0;
    nodes[height++] = 0;
    while (height > 0) {
        float begin[SAGI_BVH_WIDTH];
        uint32_t child[SAGI_BVH_WIDTH];
        uint32_t count = met_children(w, nodes[--height], begin, child);
        for (uint32_t i = 0; i < count; i++)
            if (!sagi_bvh_is_leaf(child[i]))
                nodes[height++] = child[i];
            else
                visit(w, waiting_key(begin[i], child[i]));
    }
}

static void let_wait_again(solid_walk *w, uint64_t key) {
    if (key > w->opened) add_waiting(w, key);
}
static void open_again(solid_walk *w, uint64_t key) {
    if (key <= w->opened) open_leaf(w, (uint32_t)key, reopen_part);
}
// Takes up again the crossings that were given up.
static __attribute__((noinline, cold)) void refill_events(solid_walk *w) {
    const sagi_world *world = w->here->world;
    w->events_cut = false;
    w->resume = w->events_end;
    for (uint32_t i = 0; i < world->unbounded_count; i++) reopen_part(w, part_at(w, world->unbounded[i]));
    every_leaf(w, open_again);
}

// Where the nearest of those begins that wait, or ∞.
SAGI_INLINE float nearest_of_few(const solid_walk *w) {
    sagi_f8 least = w->leaves[0];
    for (uint32_t n = 1; n < w->few; n++) least = sagi_f8_min(least, w->leaves[n]);
    uint32_t bits = sagi_i8_least(sagi_f8_bits(least));
    return begin_of((uint64_t)bits << 32);
}

// False when the ray meets none.
SAGI_INLINE bool look_at_all(solid_walk *w, const level *here) {
    const sagi_bvh *tree = &here->world->tree;
    const slabs r = slabs_of(&here->tree_ray, tree->nodes);
    const sagi_f8 never = sagi_f8_fill(INFINITY);
    uint32_t any = 0;
    for (uint32_t n = 0; n < w->few; n++) {
        const size_t at = n * sizeof(sagi_bvh_node);
        sagi_f8 begin = begins_of(at, &r), end = ends_of(at, &r, here->limit);
        sagi_i8 met =
            sagi_f8_at_most(begin, end) & sagi_i8_above(sagi_i8_fill(0), sagi_i8_load(tree->nodes[n].child));
        any |= sagi_i8_mask(met);
        w->leaves[n] = sagi_f8_select(met, begin, never);
    }
    w->nearest = any != 0 ? nearest_of_few(w) : INFINITY;
    return any != 0;
}

// Opens all that begin at `limit` or before.
SAGI_INLINE void open_few(solid_walk *w, float limit) {
    if (!(w->nearest <= limit)) return;
    const sagi_f8 until = sagi_f8_fill(sagi_float_min(limit, FLT_MAX));
    for (uint32_t n = 0; n < w->few; n++) {
        sagi_i8 now = sagi_f8_at_most(w->leaves[n], until);
        uint32_t mask = sagi_i8_mask(now);
        if (mask == 0) continue;
        w->leaves[n] = sagi_f8_select(now, sagi_f8_fill(INFINITY), w->leaves[n]);
        for (; mask != 0; mask &= mask - 1)
            open_leaf(w, w->here->world->tree.nodes[n].child[__builtin_ctz(mask)], open_part);
    }
    w->nearest = nearest_of_few(w);
}

// The τ that `until` does not exceed.
SAGI_INLINE float limit_of(const solid_walk *w, double until) {
    if (!(until < INFINITY) || !w->here->in_tree) return INFINITY;
    return sagi_float_max(sagi_float_ray_limit(&w->here->tree_ray, until), w->here->tree_ray.first_low);
}

// Opens the leaf whose box is the next, if it begins at `until` or before; false when none does.
static inline bool open_next(solid_walk *w, double until) {
    if (w->waiting_count == 0 && !w->waiting_cut) return false;
    const float limit = limit_of(w, until);
    for (;;) {
        if (w->waiting_count == 0) {
            if (!w->waiting_cut || !(begin_of(w->waiting_end) <= limit)) return false;
            w->waiting_cut = false;
            every_leaf(w, let_wait_again);
            if (w->waiting_count == 0) return false;
        }
        uint64_t key = w->waiting[w->waiting_count - 1];
        if (!(begin_of(key) <= limit)) return false;
        w->waiting_count--;
        if (sagi_bvh_is_leaf((uint32_t)key)) {
            w->opened = key;
            open_leaf(w, (uint32_t)key, open_part);
            return true;
        }
        expand(w, (uint32_t)key);
    }
}
