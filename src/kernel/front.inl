// SPDX-License-Identifier: MIT
// Sixteen rays from one point in nearly one direction: what bounds them all, and where in the tree those of
// them may begin that walk alone. Part of kernel.inl.
//
// The bundle. Let P be the common origin (ray.h has the units) and the Dᵢ have the same signs. A slab that a
// ray meets at N = (b − P)/Dᵢ ≥ 0 is met no sooner by a ray with the bundle's largest |Dᵢ|, and left no later
// by one with the smallest; where N is negative, it is so for all. Per coordinate these are rays with a quick
// way, whose entries and exits ray.h bounds. So with the scale of the largest for the near planes, that of
// the smallest for the far ones, one step of a walk serves all of them and culls what all of them miss.
//
// The front. Where triangles are smaller than pixels, sixteen rays soon part, but in the upper nodes they
// have taken the same steps. So the bundle takes these once: a node makes way for those of its children that
// the bundle meets, as long as all together are few and none of them is a leaf (how a ray comes to a leaf,
// only its own step says: ray.h). What is left, the front, together holds all that any of the rays can meet,
// and each begins there in place of the root. Where a ray meets one of m children only, it takes m steps, at
// the children, in place of two: so a long front costs more than it saves, unless hits come early. A bundle's
// steps are as long a chain as a ray's, and the nodes are as far away: fronts are found in turns.
//
// The places in the front say from which τ on they matter, in the units of a ray that goes the quick way with
// the bundle's exponent. Where not all of them certainly do, there is no front.

// After some packets in a row that were not worth it, or were none, more and more of the next go untried.
typedef struct packet_luck {
    uint32_t wait, poor;
} packet_luck;

static inline bool try_luck(packet_luck *luck) {
    if (luck->wait == 0) return true;
    luck->wait--;
    return false;
}
static inline void note_luck(packet_luck *luck, bool poor) {
    luck->poor = !poor ? luck->poor / 2 : luck->poor < 9 ? luck->poor + 1 : 9;
    luck->wait = poor && luck->poor > 3 ? (1U << (luck->poor - 3)) - 1 : 0;
}

#define PACKET_GROUPS 2 // of eight rays
#define PACKET_RAYS   (8 * PACKET_GROUPS)
#define FRONT         8  // places at most; longer ones make rays take steps in vain
#define FRONT_STEPS   20 // of a bundle, at most
#define FRONT_RAYS    4  // of a bundle; fewer are not worth it
#define FRONT_GAIN    2  // nodes that made way: with fewer it was not worth it
#define FRONTS        16 // that are looked for in turns

// Below all that waits on a walk's stack: a leaf that begins, by its bits, later than any limit.
#define NOTHING ((uint64_t)UINT32_MAX << 32 | SAGI_BVH_LEAF)

// Where walks begin: places, as in batch.inl, the nearest one last, and NOTHING before the first.
typedef struct front_places {
    uint64_t places[FRONT];
} front_places;

typedef struct bundle {
    sagi_d4 p, lo, hi;          // P; bounds of D
    double spread, unit, down;  // τ = t · unit; D = d · down
    int exponent;               // 2^(exponent − 1) ≤ max|dᵢ| < 2^exponent
    float limit;                // of τ
    sagi_float_ray walker;      // only what `step` needs of it
    front_places *front;        // to be found:
    uint32_t at, count, gained; // those below `at` stay
    uint64_t places[FRONT + SAGI_BVH_WIDTH];
} bundle;

// Bundles that wait until there are enough of them.
typedef struct front_crowd {
    uint32_t count;
    bool used; // the fronts below are there
    packet_luck luck;
    bundle bundles[FRONTS];
    front_places fronts[CROWD / PACKET_RAYS];
} front_crowd;

static inline sagi_l4 bits_at(const sag_ray *ray, size_t offset) {
    return (sagi_l4)sagi_d4_load((const char *)ray + offset);
}

// Fills in the bundle; false when the rays are none.
SAGI_INLINE bool bundle_make(bundle *b, const sagi_world *world, const sag_ray *rays) {
    // Equal: the origins, t_min, t_max and masks. Directions: their bounds. (A sum has a NaN if one is
    // there.)
    const size_t tail = offsetof(sag_ray, direction.z);
    sagi_l4 origin = bits_at(rays, 0), end = bits_at(rays, tail), other_origin = origin ^ origin,
            other_end = other_origin;
    sagi_d4 lo = sagi_d4_load(&rays->direction), hi = lo, sum = lo;
    for (size_t i = 1; i < PACKET_RAYS; i++) {
        sagi_d4 d = sagi_d4_load(&rays[i].direction); // the fourth is t_min
        other_origin |= bits_at(&rays[i], 0) ^ origin, other_end |= bits_at(&rays[i], tail) ^ end;
        lo = sagi_d4_min(lo, d), hi = sagi_d4_max(hi, d), sum += d;
    }
    const union {
        uint32_t half[8];
        sagi_l4 all;
    } mask_only = {.half = {0, 0, ~0U, ~0U, ~0U, ~0U, ~0U, 0}}; // not d.z, nor what follows the mask
    sagi_l4 other = (other_origin & (sagi_l4){-1, -1, -1, 0}) | (other_end & mask_only.all);
    if (((other[0] | other[1]) | (other[2] | other[3])) != 0) return false;

    const sag_ray *ray = rays;
    sagi_d4 size = sagi_d4_max(sagi_d4_abs(lo), sagi_d4_abs(hi));
    double largest = largest_of_three(size), spread = 0;
    sagi_d4 q = (sagi_d4_load(&ray->origin) - world->center) * sagi_d4_fill(world->scale);
    sagi_d4 small = sagi_d4_fill(largest * 0x1p-38), wide = sagi_d4_fill(largest * 0x1p-4);
    const sagi_l4 usual = (sagi_d4_at_most(small, lo) | sagi_d4_at_most(hi, -small)) &
                          sagi_d4_at_most(hi - lo, wide) & sagi_d4_at_most(sum, sum) /* no NaN */ &
                          sagi_d4_below(sagi_d4_abs(q), 64);
    if (world->has_spread)
        spread = (greater(greater(fabs(ray->origin.x), fabs(ray->origin.y)), fabs(ray->origin.z)) *
                      world->spread_relative +
                  world->spread_absolute) *
                 world->scale * 0x1p-50;
    if (!(largest > 0x1p-100 && largest < 0x1p100 && ray->t_min >= 0 && ray->t_min <= ray->t_max &&
          (sagi_d4_signs((sagi_d4)usual) & 7) == 7 && spread < 1))
        return false;

    union {
        double value;
        uint64_t bits;
    } u = {.value = largest};
    int exponent = (int)(u.bits >> 52) - 1022; // 2^(exponent − 1) ≤ largest < 2^exponent
    b->unit = power_of_two(exponent) * world->scale, b->down = power_of_two(-exponent);
    sagi_d4 down = sagi_d4_fill(b->down);
    lo *= down, hi *= down;
    b->p = q, b->lo = lo, b->hi = hi, b->spread = spread;
    b->exponent = exponent;
    b->limit = (float)(ray->t_max * b->unit * (1 + 0x1p-22) + 0x1p-70);

    // The quick way of ray.h, with two directions.
    sagi_float_ray *walker = &b->walker;
    sagi_f4 low = sagi_d4_to_f4(lo), high = sagi_d4_to_f4(hi), start = sagi_d4_to_f4(q);
    sagi_w4 sign = (sagi_w4)low & INT32_MIN, backward = (sagi_w4)low < 0;
    sagi_f4 near_scale = 1 / (sagi_f4)((backward & (sagi_w4)low) | (~backward & (sagi_w4)high));
    sagi_f4 far_scale = 1 / (sagi_f4)((backward & (sagi_w4)high) | (~backward & (sagi_w4)low));
    near_scale *= 1 - 0x1p-21F, far_scale *= 1 + 0x1p-21F;
    sagi_f4 margin =
        (sagi_f4)((sagi_w4)start & INT32_MAX) * 0x1p-21F + (float)(0x1p-40 + spread * (1 + 0x1p-20));
    margin = (sagi_f4)((sagi_w4)margin | sign);
    sagi_f4 near_back = (start + margin) * near_scale, far_back = (start - margin) * far_scale;
    walker->near_scale = near_scale, walker->near_back = near_back;
    walker->far_scale = far_scale, walker->far_back = far_back;
    walker->planes = sagi_planes[sagi_d4_signs(lo) & 7];
    walker->first_low = (float)(ray->t_min * b->unit * (1 - 0x1p-22)) + 0.0F; // not −0
    return true;
}

// To begin with, all of a crowd's rays begin at the root.
static __attribute__((noinline)) void begin_fronts(front_crowd *c) {
    c->used = true;
    for (size_t i = 0; i < CROWD / PACKET_RAYS; i++)
        for (size_t j = 0; j < FRONT; j++) c->fronts[i].places[j] = j < FRONT - 1 ? NOTHING : 0;
}

// Whether each of the rays certainly goes the quick way, with the bundle's exponent: besides what a bundle
// asks, the largest |dᵢ| must be for each of them at least 2^(exponent − 1).
SAGI_INLINE bool front_allowed(const bundle *b, const sagi_world *world) {
    const sagi_d4 least = sagi_d4_min(sagi_d4_abs(b->lo), sagi_d4_abs(b->hi));
    return largest_of_three(least) >= 0.5 && b->exponent > -58 && b->exponent < 58 &&
           world->quick_center[0] == world->center[0];
}

// One step of a front: its node at `at` makes way for its children, if it may. True when all are done.
SAGI_INLINE bool front_step(const sagi_bvh *tree, bundle *b) {
    const uint32_t at = b->at, last = b->count - 1;
    const sagi_bvh_node *node = sagi_bvh_node_at(tree, (uint32_t)b->places[at]);
    const slabs r = slabs_of(&b->walker, node);
    const sagi_f8 begin = begins_of(0, &r), end = ends_of(0, &r, b->limit);
    const sagi_i8 child = sagi_i8_load(node->child);
    uint32_t mask;
    const sagi_i8 order = sagi_f8_in_order(begin, end, &mask);
    const uint32_t lane = sagi_i8_least(order) & 7;
    const uint32_t more = (uint32_t)__builtin_popcount(mask);
    SAGI_KERNEL_COUNT(packet_nodes);
    const bool leaf_met = (sagi_i8_mask(sagi_i8_above(sagi_i8_fill(0), child)) & mask) != 0;
    const bool stays = (more > FRONT - last) | leaf_met;
    uint64_t *top = b->places + b->count;
    // The nearest one takes its place, or what is last in the list; the others go there.
    const uint64_t old = b->places[at], nearest = (uint64_t)float_bits(begin[lane]) << 32 | node->child[lane];
    sagi_write_pairs(mask & ~(1U << lane), begin, child, top);
    const uint64_t next = sagi_if_above_long(more, 0, nearest, b->places[last]);
    b->places[at] = sagi_if_above_long(stays, 0, old, next);
    b->count = (uint32_t)sagi_if_above_long(stays, 0, b->count, last + more);
    b->at += stays, b->gained += !stays;
    fetch_place(sagi_bvh_node_at(tree, (uint32_t)b->places[b->at]));
    return b->at >= b->count;
}

SAGI_INLINE void front_order(uint64_t *p, size_t i, size_t j) {
    const uint64_t x = p[i], y = p[j];
    p[i] = x > y ? x : y, p[j] = x > y ? y : x;
}

// The places in order, by a network for eight (Knuth, The Art of Computer Programming 3, 5.3.4).
SAGI_INLINE void front_write(bundle *b) {
    static const uint8_t pairs[][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6},
                                       {5, 7}, {1, 2}, {5, 6}, {0, 4}, {3, 7}, {1, 5}, {2, 6},
                                       {1, 4}, {3, 6}, {2, 4}, {3, 5}, {3, 4}};
    uint64_t *p = b->front->places;
    for (uint32_t i = 0; i < FRONT; i++) p[i] = i < b->count ? b->places[i] : NOTHING;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) front_order(p, pairs[i][0], pairs[i][1]);
}

// Finds the fronts of all that wait: in turns, as rays walk (batch.inl).
static __attribute__((noinline)) void find_fronts(const sagi_world *world, front_crowd *c) {
    bundle *going[FRONTS];
    uint32_t left = c->count;
    for (uint32_t i = 0; i < left; i++) {
        bundle *b = going[i] = &c->bundles[i];
        b->at = b->gained = 0, b->count = 1, b->places[0] = 0;
    }
    for (uint32_t step = 0; step < FRONT_STEPS && left > 0; step++) {
        uint32_t stay = 0;
        for (uint32_t i = 0; i < left; i++) {
            bundle *b = going[i];
            const bool done = front_step(&world->tree, b);
            going[stay] = b, stay += !done;
        }
        left = stay;
    }
    for (uint32_t i = 0; i < c->count; i++) {
        front_write(&c->bundles[i]);
        note_luck(&c->luck, c->bundles[i].gained < FRONT_GAIN);
    }
    c->count = 0;
}
