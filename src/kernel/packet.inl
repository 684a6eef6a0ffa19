// SPDX-License-Identifier: MIT
// Sixteen rays from one point in nearly one direction, as a pinhole camera sends them: they walk the tree as
// one, and a block's triangles are prepared once for all of them. Part of kernel.inl.
//
// The packet answers only what is certain: a ray whose nearest hit is one triangle or sphere beyond doubt has
// it solved as any other ray has, shapes of other kinds are asked by their own verbs or what gives the same
// bits, and the rest go on alone, with the crowd (batch.inl). So the answers are those of the single call,
// whatever the rays are.
//
// Walking is said in front.inl: P is the common origin, one step culls what all rays miss.
//
// Leaves. D = c + δ with c the packet's middle, in floats, and |δᵢ| ≤ Δ small. What blocks make of that, and
// within which bounds, is said in packet_triangles.inl and packet_spheres.inl; what references stand for is
// asked in packet_shapes.inl. Whatever a ray has met is known by bounds of its τ: those of a candidate whose
// t is left to find, or those of a hit that is there already, with its t. What certainly comes earlier takes
// its place, what certainly comes later is forgotten, and where neither is certain the ray is left undecided.

#define PACKET_GROUPS 2 // of eight rays
#define PACKET_RAYS   (8 * PACKET_GROUPS)
#define PACKET_BLOCKS 256 // that nearest primitives may stand in
#define PACKET_FOUND  (8 * PACKET_BLOCKS)
#define PACKET_WORK   80 // a packet that needs more, in steps through nodes, is not worth it

typedef struct packet {
    const sagi_world *world;
    const sag_ray *rays;
    sag_hit *hits;
    sagi_d4 p, c;                                                 // P; c, exactly that of c_float
    sagi_f4 c_float, r;                                           // r: bounds of |δᵢ|
    sagi_f8 x[PACKET_GROUPS], y[PACKET_GROUPS], z[PACKET_GROUPS]; // δ
    f8x3 d[PACKET_GROUPS];                                        // D,
    sagi_f8 inverse[PACKET_GROUPS];                               // and 1/D·D
    sagi_f8 limit[PACKET_GROUPS];    // a later τ does not matter; −1: nothing does
    sagi_f8 earliest[PACKET_GROUPS]; // of the nearest so far: a bound of its τ
    sagi_i8 nearest[PACKET_GROUPS];  // 8 · its block's place in `blocks` + its lane, or PACKET_FOUND: it is
                                     // in `hits`; −1: none
    sagi_d4 t_max[PACKET_RAYS / 4];  // the rays' own, or the best t where that is known
    sagi_d4 way[PACKET_RAYS / 4][3]; // their directions by coordinate, where `turned`
    bool turned;                     // t_max and way are there,
    bool measured;                   // and so are d, inverse, c_length, c_square and turn
    float spread;                    // Δ
    float c_length, c_square, turn;  // |c| rounded up, |c|²; a bound of |δ|/|D|
    float last;                      // lower bound of τ of the rays' t_max
    double t_min, error, unit;       // as in sagi_float_ray
    uint32_t mask;
    uint32_t undecided; // rays
    uint32_t work;      // done so far
    uint32_t block_count;
    const sagi_block *blocks[PACKET_BLOCKS];
    later *later;   // of the batch, or NULL
    bool *doubtful; // of a mesh within a solid, else NULL: as in crowd (batch.inl)
} packet;

// Fills in the packet of rays that run alike. Within a solid hits closer to each other than
// 2⁻⁴⁸ (|t| + |o|∞/|d|∞) are not certain: in τ, that is at most 130 and twice |o|∞ in these units.
SAGI_INLINE void packet_make(packet *p, const bundle *b, const sagi_world *world, const sag_ray *rays,
                             sag_hit *hits) {
    const sag_ray *ray = rays;
    const sagi_d4 q = b->p, lo = b->lo, hi = b->hi, down = sagi_d4_fill(b->down);
    const double spread = b->spread, unit = b->unit;
    p->world = world, p->rays = rays, p->hits = hits, p->p = q;
    p->c_float = sagi_d4_to_f4((lo + hi) * sagi_d4_fill(0.5)), p->c = sagi_f4_to_d4(p->c_float);
    sagi_d4 r = sagi_d4_max(hi - p->c, p->c - lo);
    p->spread = (float)largest_of_three(r) * (1 + 0x1p-20F) + 0x1p-28F;
    p->r = sagi_d4_to_f4(r) * (1 + 0x1p-20F) + 0x1p-50F;
    double first = ray->t_min * unit, last = ray->t_max * unit;
    p->t_min = first, p->last = (float)(last * (1 - 0x1p-22)), p->unit = unit;
    p->error = 0x1p-43 + spread;
    if (p->doubtful != NULL)
        p->error += 0x1p-47 * (65 + largest_of_three(sagi_d4_abs(sagi_d4_load(&ray->origin))) * world->scale);
    p->mask = ray->mask != 0 ? ray->mask : UINT32_MAX;
    p->undecided = 0, p->work = 0, p->block_count = 0, p->turned = p->measured = false;
    for (size_t i = 0; i < PACKET_GROUPS; i++) {
        sagi_f4 d[8];
        for (size_t j = 0; j < 8; j++)
            d[j] = sagi_d4_to_f4(sagi_d4_load(&rays[8 * i + j].direction) * down - p->c);
        sagi_f4_turn8(d, &p->x[i], &p->y[i], &p->z[i]);
        p->limit[i] = sagi_f8_fill(b->limit);
        p->earliest[i] = sagi_f8_fill(INFINITY), p->nearest[i] = (sagi_i8){-1, -1, -1, -1, -1, -1, -1, -1};
    }
}

// Two blocks may hold the same triangle.
static inline bool same_primitive(const packet *p, int32_t nearest, const sagi_block *block, uint32_t lane) {
    if (nearest < 0 || nearest == PACKET_FOUND || block == NULL) return false;
    const sagi_bvh_reference a = sagi_block_reference(p->blocks[nearest >> 3], nearest & 7),
                             b = sagi_block_reference(block, lane);
    return a.geometry == b.geometry && a.primitive == b.primitive;
}

// Rays of a group that are met by a primitive they cannot be certain of, or by two too close to each other.
static __attribute__((noinline)) void leave_undecided(packet *p, size_t group, uint32_t rays,
                                                      uint32_t certain, const sagi_block *block,
                                                      uint32_t lane) {
    for (; rays != 0; rays &= rays - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(rays);
        if ((certain >> i & 1) != 0 && same_primitive(p, p->nearest[group][i], block, lane)) continue;
        p->limit[group][i] = -1;
        p->undecided |= 1U << (8 * group + i);
    }
}

// Takes note of a primitive that rays of a group (`met`) meet before their limits, some of them certainly and
// between those bounds. Its block is the next one in `blocks`.
SAGI_INLINE void packet_take(packet *p, size_t group, uint32_t met, sagi_i8 certain, sagi_f8 earliest,
                             sagi_f8 latest, const sagi_block *block, uint32_t lane) {
    sagi_i8 nearer = certain & sagi_f8_less(latest, p->earliest[group]);
    p->limit[group] = sagi_f8_select(nearer, latest, p->limit[group]);
    uint32_t doubtful = met & ~sagi_i8_mask(nearer);
    if (doubtful != 0) leave_undecided(p, group, doubtful, sagi_i8_mask(certain), block, lane);
    int32_t number = (int32_t)(8 * p->block_count + lane);
    p->earliest[group] = sagi_f8_select(nearer, earliest, p->earliest[group]);
    p->nearest[group] = (nearer & sagi_i8_fill(number)) | (~nearer & p->nearest[group]);
}

// What only single rays can be asked.
static __attribute__((noinline)) void give_up_from(packet *p, float begin) {
    for (size_t i = 0; i < PACKET_GROUPS; i++)
        leave_undecided(p, i, sagi_i8_mask(sagi_f8_at_most(sagi_f8_fill(begin), p->limit[i])), 0, NULL, 0);
}

#include "kernel/packet_triangles.inl"

#include "kernel/packet_spheres.inl"

#include "kernel/packet_shapes.inl"

SAGI_INLINE void packet_leaf(packet *p, const sagi_block *leaf, float begin) {
    if (leaf->kind == SAGI_BLOCK_REFERENCES)
        packet_references(p, ((const sagi_reference_block *)(const void *)leaf)->reference, leaf->count,
                          begin);
    else if (p->block_count == PACKET_BLOCKS)
        give_up_from(p, begin);
    else if (leaf->kind == SAGI_BLOCK_TRIANGLES)
        packet_triangles(p, (const sagi_triangle_block *)(const void *)leaf, begin);
    else
        packet_spheres(p, leaf, begin);
}

SAGI_INLINE float packet_limit(const packet *p) {
    sagi_f8 most = p->limit[0];
    for (size_t i = 1; i < PACKET_GROUPS; i++) most = sagi_f8_max(most, p->limit[i]);
    return sagi_f8_most(most);
}

SAGI_INLINE void packet_walk(packet *p, const sagi_float_ray *walker) {
    const sagi_bvh *tree = &p->world->tree;
    float begin[STACK_PLACES];
    uint32_t child[STACK_PLACES];
    stack waits = empty_stack(begin, child);
    const sagi_places places = p->world->places;
    waiting next = {0, 0};
    float limit = packet_limit(p);
    const slabs r = slabs_of(walker, tree->nodes);
    for (;;) {
        if (!sagi_bvh_is_leaf(next.child)) {
            SAGI_KERNEL_COUNT(packet_nodes);
            if (++p->work > PACKET_WORK) {
                give_up_from(p, next.begin);
                limit = packet_limit(p);
            } else if (step(CLOSEST, tree, &places, &r, limit, &waits, &next)) {
                continue;
            }
        } else {
            packet_leaf(p, sagi_leaf(tree, next.child), next.begin);
            limit = packet_limit(p);
        }
        if (!pop(CLOSEST, limit, &waits, &next)) return;
    }
}

// t, u and v of up to four rays' hits, whose numbers are in `which` and whose nearest are triangles; false
// where the single call has to be asked after all.
static uint32_t solve_triangles(const packet *p, const uint32_t *which, uint32_t count) {
    sagi_triangle_four four;
    uint32_t geometry[4], primitive[4], turned = 0;
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t r = which[i < count ? i : 0];
        uint32_t nearest = ((const uint32_t *)p->nearest)[r];
        const sagi_triangle_block *block = (const sagi_triangle_block *)(const void *)p->blocks[nearest >> 3];
        geometry[i] = block->head.geometry, primitive[i] = block->primitive[nearest & 7];
        four.ray[i] = &p->rays[r], four.t_max[i] = p->rays[r].t_max;
        const sagi_item *item = &p->world->items[geometry[i]];
        turned |= item->mirrored;
        put_corners(&four, i, p->world, block, nearest & 7);
    }
    const uint32_t found = sagi_triangle_solve4(&four, (1U << count) - 1);
    if (__builtin_expect(turned != 0, 0))
        for (uint32_t i = 0; i < count; i++)
            if (p->world->items[geometry[i]].mirrored) {
                const double u = four.u[i];
                four.u[i] = four.v[i], four.v[i] = u;
            }
    // t, u, v of each.
    const sagi_d4 even = SAGI_D4_SHUFFLE2(four.t, four.u, 0, 4, 2, 6),
                  odd = SAGI_D4_SHUFFLE2(four.t, four.u, 1, 5, 3, 7),
                  odd_v = SAGI_D4_SHUFFLE2(four.v, four.v, 1, 0, 3, 2);
    const sagi_d4 tuv[4] = {
        SAGI_D4_SHUFFLE2(even, four.v, 0, 1, 4, 5), SAGI_D4_SHUFFLE2(odd, odd_v, 0, 1, 4, 5),
        SAGI_D4_SHUFFLE2(even, four.v, 2, 3, 6, 7), SAGI_D4_SHUFFLE2(odd, odd_v, 2, 3, 6, 7)};
    for (uint32_t i = 0; i < 4; i++) // (found has no others than count)
        if ((found >> i & 1) != 0) write_triangle(tuv[i], geometry[i], primitive[i], &p->hits[which[i]]);
    return found;
}

// The same of spheres.
static uint32_t solve_spheres(const packet *p, const uint32_t *which, uint32_t count) {
    sagi_sphere_four four;
    sagi_bvh_reference at[4];
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t r = which[i < count ? i : 0];
        uint32_t nearest = (uint32_t)p->nearest[r / 8][r % 8];
        const sagi_block *block = p->blocks[nearest >> 3];
        at[i] = sagi_block_reference(block, nearest & 7);
        four.ray[i] = &p->rays[r];
        four.at[i] = sphere_at(p->world, block, at[i]);
    }
    const uint32_t found = sagi_sphere_solve4(&four, (1U << count) - 1);
    const search here = {.path_length = 0};
    for (uint32_t i = 0; i < count; i++)
        if ((found >> i & 1) != 0)
            write_hit(&here, at[i].geometry, at[i].primitive, four.t[i], 0, 0, &p->hits[which[i]]);
    return found;
}

// The hits of rays whose nearest is known to be one primitive of a block of this kind.
static void packet_solve(const packet *p, uint32_t rays, sagi_block_kind kind) {
    uint32_t which[PACKET_RAYS], count = 0;
    for (; rays != 0; rays &= rays - 1) which[count++] = (uint32_t)__builtin_ctz(rays);
    for (uint32_t i = 0; i < count && p->doubtful != NULL; i++) p->doubtful[which[i]] = false;
    for (uint32_t i = 0; i < count; i += 4) {
        const uint32_t n = count - i < 4 ? count - i : 4;
        uint32_t left =
            kind == SAGI_BLOCK_TRIANGLES ? solve_triangles(p, which + i, n) : solve_spheres(p, which + i, n);
        for (left ^= (1U << n) - 1; left != 0; left &= left - 1) {
            const uint32_t r = which[i + (uint32_t)__builtin_ctz(left)];
            if (p->doubtful != NULL) p->doubtful[r] = true;
            if (!intersect(p->world, &p->rays[r], &p->hits[r]))
                p->hits[r] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
        }
    }
}

#define PACKET_ALL ((uint32_t)((UINT64_C(1) << PACKET_RAYS) - 1))

// The closest hits of PACKET_RAYS rays that run alike, except those it returns.
static __attribute__((noinline)) uint32_t packet_trace(const bundle *b, const sagi_world *world,
                                                       const sag_ray *rays, sag_hit *hits, bool *doubtful,
                                                       later *put, packet_luck *luck) {
    packet p;
    p.doubtful = doubtful, p.later = put;
    packet_make(&p, b, world, rays, hits);
    if (world->unbounded_count != 0) packet_references(&p, world->unbounded, world->unbounded_count, 0);
    packet_walk(&p, &b->walker);
    uint32_t of[2] = {0, 0}, missing = 0; // by the kind of what they met
    for (uint32_t i = 0; i < PACKET_GROUPS; i++)
        missing |= sagi_i8_mask(sagi_i8_above(sagi_i8_fill(0), p.nearest[i])) << 8 * i;
    missing &= ~p.undecided;
    for (uint32_t left = PACKET_ALL & ~(p.undecided | missing); left != 0; left &= left - 1) {
        const uint32_t r = (uint32_t)__builtin_ctz(left);
        const int32_t nearest = p.nearest[r / 8][r % 8];
        if (nearest != PACKET_FOUND) of[p.blocks[nearest >> 3]->kind != SAGI_BLOCK_TRIANGLES] |= 1U << r;
    }
    packet_solve(&p, of[0], SAGI_BLOCK_TRIANGLES), packet_solve(&p, of[1], SAGI_BLOCK_SPHERES);
    for (; missing != 0; missing &= missing - 1)
        hits[__builtin_ctz(missing)] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
    note_luck(luck, __builtin_popcount(p.undecided) > PACKET_RAYS / 2 || p.work > PACKET_WORK);
    return p.undecided;
}

// The closest hits of PACKET_RAYS rays, except those it returns, which are all when they do not run alike or
// luck is low; and for these, if there is something to gain, the front is asked for.
static uint32_t packet_intersect(const sagi_world *world, const sag_ray *rays, sag_hit *hits, bool *doubtful,
                                 later *put, packet_luck *luck, front_crowd *fronts, front_places *front) {
    const bool tried = try_luck(luck), deeper = try_luck(&fronts->luck);
    if (!(tried | deeper) || world->tree.node_count == 0) return PACKET_ALL;
    bundle *b = &fronts->bundles[fronts->count];
    if (!bundle_make(b, world, rays)) {
        if (tried) note_luck(luck, true);
        if (deeper) note_luck(&fronts->luck, true);
        return PACKET_ALL;
    }
    const uint32_t left = tried ? packet_trace(b, world, rays, hits, doubtful, put, luck) : PACKET_ALL;
    if (deeper && __builtin_popcount(left) >= FRONT_RAYS && front_allowed(b, world)) {
        if (!fronts->used) begin_fronts(fronts);
        b->front = front;
        if (++fronts->count == FRONTS) find_fronts(world, fronts);
    }
    return left;
}
