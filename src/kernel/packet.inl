// SPDX-License-Identifier: MIT
// Sixteen rays from one point in nearly one direction, as a pinhole camera sends them: they walk the tree as
// one, and a block's triangles are prepared once for all of them. Part of kernel.inl.
//
// The packet answers only what is certain: a ray whose nearest hit is one triangle beyond doubt has it solved
// as any other ray has, and the rest go on alone, with the crowd (batch.inl). So the answers are those of the
// single call, whatever the rays are.
//
// Walking. Let P be the common origin (ray.h has the units) and the Dᵢ have the same signs. A slab that a ray
// meets at N = (b − P)/Dᵢ ≥ 0 is met no sooner by a ray with the packet's largest |Dᵢ|, and left no later by
// one with the smallest; where N is negative, it is so for all. Per coordinate these are rays with a quick
// way, whose entries and exits ray.h bounds. So with the scale of the largest for the near planes, that of
// the smallest for the far ones, one step of the walk serves the packet and culls what all of them miss.
//
// Triangles. D = c + δ with c the packet's middle, in floats, and |δᵢ| ≤ Δ small. In the block's grid let o
// be P + τc at τ = begin, s that τ in grid steps, A the corner a minus o, and X, Y the edges from a (whole
// numbers and exact). For the line through P in direction D the edge functions of triangle_test.c are
//     e(a,b) = D·((A + sc) × X) = c·m + δ·(m + s k),   m = A × X,  k = c × X,
// as c·k = 0: a number and a vector that are the packet's, in which the far origin costs nothing but sΔ. In
// the same way e(c,a) with Y × A and Y × c; and e(b,c) is what both lack of D·n, n = X × Y. And with w = δ·n,
//     D·n = c·n + w,   (a − o')·n = A·n − s w,   o' = P + τD the ray's own point at τ,
// whose quotient is the time since τ. First all lines within |δᵢ| ≤ rᵢ are tested at once, eight triangles
// together: what all of them miss is done with. Then the rays, eight together, one triangle at a time.
//
// Errors, in grid steps, with v = 2⁻²⁴ and g = SAGI_GRID_ERROR. E bounds the coordinates of X and Y, L those
// of A and E; o is off by h in double, so A by α = h + 2vL; δ by vΔ; Δ ≤ ⅛; |c|, |D| ≤ 1. First against the
// grid's triangle, exact D and P:
//     m: 2αE + 4.1vLE.   k: 4.1vE.   m + sk: 2αE + 8.2v(L + s)E, itself ≤ 2(L + s)E.   n: 4.1vE².
//     c·m: three m and 16vLE for roundings: 6αE + 28.3vLE.   c·n: 28.3vE².
//     e(b,c)'s number: two c·m, c·n, roundings 18vLE + 12vE²: 12αE + 115vLE.
//     Its vector: 4αE + 30.5v(L + s)E, itself ≤ 6(L + s)E.
//     e: 12αE + 115vLE + 3Δ(4αE + 30.5v(L + s)E) + 54vLE + 72vΔ(L + s)E, the last two for roundings and δ
//        < E (13.5h + 217vL + 164vΔs), and less for the other two.
// Then the true triangle, g off in each corner. If the line meets one of the triangles, it is at a point Z of
// it. D × (p − Z) is at most 2|p − Z| in each coordinate, |p − Z| of an edge's two ends at most 3(E + 2g)
// together, and e(p,q) = D·((p − Z) × (q − Z)): so e differs by at most 18g(E + 2g) + 6g² < 9.1E. With both
//     B = E (9.1 + 14h + 220vL + 166vΔs):
// two e beyond ±B of opposite signs: not all of the true ones can have one sign, a certain miss. Three of one
// sign beyond B: the line meets the grid's triangle, so the true one, from the side that the sign says. The
// test of all lines at once adds or takes away Σ rᵢ|m + sk|ᵢ, which has the errors of δ·(m + sk).
//     D·n: 28.3vE² + 34.3vΔE² + 6.8vE² < 40vE².   (a − o')·n: E²(6α + 34.3vL + 46.3vΔs).
// A hit of the true triangle is within g of a point of the grid's in each coordinate, and |n|₁ ≤ 6E². So at
// the time t' of a true hit, with T and D the quotient's parts, D's sign folded in,
//     |T − D t'| ≤ b₀ + b₁|t'|,   b₀ = E² (3.1 + 6.1h + 48v(L + Δs)),   b₁ = 60vE² (rounding of D t'
//     included).
// Blocks in which a hit is before `begin`, not within their box, need not report it: another block does, or
// it is out of range (kernel/collect.c tells of triangles in several blocks).

#define PACKET_GROUPS 2 // of eight rays
#define PACKET_RAYS   (8 * PACKET_GROUPS)
#define PACKET_BLOCKS 256 // that nearest triangles may stand in
#define PACKET_WORK   80  // a packet that needs more, in steps through nodes, is not worth it

// After some packets in a row that were not worth it, or were none, more and more of the next go untried.
typedef struct packet_luck {
    uint32_t wait, poor;
} packet_luck;

static inline void note_luck(packet_luck *luck, bool poor) {
    luck->poor = !poor ? luck->poor / 2 : luck->poor < 9 ? luck->poor + 1 : 9;
    luck->wait = poor && luck->poor > 3 ? (1U << (luck->poor - 3)) - 1 : 0;
}

typedef struct packet {
    const sagi_world *world;
    sagi_d4 p, c;                                                 // P; c, exactly that of c_float
    sagi_f4 c_float, r;                                           // r: bounds of |δᵢ|
    sagi_f8 x[PACKET_GROUPS], y[PACKET_GROUPS], z[PACKET_GROUPS]; // δ
    sagi_f8 limit[PACKET_GROUPS];    // a later τ does not matter; −1: nothing does
    sagi_f8 earliest[PACKET_GROUPS]; // of the nearest triangle so far: a bound of its τ
    sagi_i8 nearest[PACKET_GROUPS];  // 8 · its block's place in `blocks` + its lane; −1: none
    float spread;                    // Δ
    float t_max;                     // lower bound of τ
    double t_min, error;             // as in sagi_float_ray
    uint32_t mask;
    uint32_t undecided; // rays
    uint32_t work;      // done so far
    uint32_t block_count;
    const sagi_triangle_block *blocks[PACKET_BLOCKS];
} packet;

static inline sagi_l4 bits_at(const sag_ray *ray, size_t offset) {
    return (sagi_l4)sagi_d4_load((const char *)ray + offset);
}

// Fills in the packet, and the ray that walks for it. False when the rays are no packet.
SAGI_INLINE bool packet_make(packet *p, sagi_float_ray *walker, const sagi_world *world,
                             const sag_ray *rays) {
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
    sagi_l4 usual = ((lo >= small) | (hi <= -small)) & (hi - lo <= wide) & (sum == sum) &
                    (sagi_d4_abs(q) < sagi_d4_fill(64));
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
    double unit = power_of_two(exponent) * world->scale;
    sagi_d4 down = sagi_d4_fill(power_of_two(-exponent));
    lo *= down, hi *= down;
    p->world = world, p->p = q;
    p->c_float = sagi_d4_to_f4((lo + hi) * sagi_d4_fill(0.5)), p->c = sagi_f4_to_d4(p->c_float);
    sagi_d4 r = sagi_d4_max(hi - p->c, p->c - lo);
    p->spread = (float)largest_of_three(r) * (1 + 0x1p-20F) + 0x1p-28F;
    p->r = sagi_d4_to_f4(r) * (1 + 0x1p-20F) + 0x1p-50F;

    // The quick way of ray.h, with two directions.
    sagi_f4 low = sagi_d4_to_f4(lo), high = sagi_d4_to_f4(hi), start = sagi_d4_to_f4(q);
    sagi_w4 sign = (sagi_w4)low & INT32_MIN, backward = (sagi_w4)low < 0;
    sagi_f4 near_scale = 1 / (sagi_f4)((backward & (sagi_w4)low) | (~backward & (sagi_w4)high));
    sagi_f4 far_scale = 1 / (sagi_f4)((backward & (sagi_w4)high) | (~backward & (sagi_w4)low));
    near_scale *= 1 - 0x1p-21F, far_scale *= 1 + 0x1p-21F;
    sagi_f4 margin =
        (sagi_f4)((sagi_w4)start & INT32_MAX) * 0x1p-21F + (float)(0x1p-40 + spread * (1 + 0x1p-20));
    margin = (sagi_f4)((sagi_w4)margin | sign);
    sagi_f4 near_add = -(start + margin) * near_scale, far_add = -(start - margin) * far_scale;
    walker->near_scale = near_scale, walker->near_add = near_add;
    walker->far_scale = far_scale, walker->far_add = far_add;
    walker->planes = sagi_planes[sagi_d4_signs(lo) & 7];
    double first = ray->t_min * unit, last = ray->t_max * unit;
    walker->from = (float)(first * (1 - 0x1p-22)) + 0.0F; // not −0
    p->t_min = first, p->t_max = (float)(last * (1 - 0x1p-22));
    p->error = 0x1p-43 + spread;
    p->mask = ray->mask != 0 ? ray->mask : UINT32_MAX;
    p->undecided = 0, p->work = 0, p->block_count = 0;
    for (size_t i = 0; i < PACKET_GROUPS; i++) {
        sagi_f4 d[8];
        for (size_t j = 0; j < 8; j++)
            d[j] = sagi_d4_to_f4(sagi_d4_load(&rays[8 * i + j].direction) * down - p->c);
        sagi_f4_turn8(d, &p->x[i], &p->y[i], &p->z[i]);
        p->limit[i] = sagi_f8_fill((float)(last * (1 + 0x1p-22) + 0x1p-70));
        p->earliest[i] = sagi_f8_fill(INFINITY), p->nearest[i] = (sagi_i8){-1, -1, -1, -1, -1, -1, -1, -1};
    }
    return true;
}

// What of a block is the same for all rays; e(δ) = number + δ·vector.
typedef struct packet_block {
    sagi_f8 number[3];
    f8x3 vector[3], n;
    sagi_f8 t, d; // T = t − s w, D = d + w
    float bound, b0, b1, s, step, begin, first;
    uint32_t left; // triangles that some line may meet
} packet_block;

SAGI_INLINE f8x3 add_scaled8(const f8x3 *a, sagi_f8 s, const f8x3 *b) {
    return (f8x3){sagi_f8_fma(s, b->x, a->x), sagi_f8_fma(s, b->y, a->y), sagi_f8_fma(s, b->z, a->z)};
}
SAGI_INLINE sagi_f8 dot_add8(sagi_f8 x, sagi_f8 y, sagi_f8 z, const f8x3 *b, sagi_f8 c) {
    return sagi_f8_fma(z, b->z, sagi_f8_fma(y, b->y, sagi_f8_fma(x, b->x, c)));
}

SAGI_INLINE void prepare_block(packet_block *out, const packet *p, const sagi_triangle_block *block,
                               float begin) {
    double steps = power_of_two(block->head.exponent);
    sagi_d4 at =
        ((p->p + p->c * sagi_d4_fill((double)begin)) - grid_zero(block->head.base)) * sagi_d4_fill(steps);
    float s = begin * (float)steps;
    float length = (float)(largest_of_three(sagi_d4_abs(at)) * (1 + 0x1p-20) + 0x1p16);
    float edge = (float)(block->head.edge + 1) * 256, h = (float)(p->error * steps) * (1 + 0x1p-20F);
    float turned = p->spread * s * 0x1p-24F, rounded = length * 0x1p-24F;
    out->bound = edge * (9.1F + 14 * h + 220 * rounded + 166 * turned);
    out->b0 = edge * edge * (3.1F + 6.1F * h + 48 * (rounded + turned));
    out->b1 = edge * edge * (60 * 0x1p-24F);
    out->s = s, out->begin = begin, out->step = (float)(1 / steps);
    out->first = (float)((p->t_min - (double)begin) * steps);

    f8x3 o = fill3(sagi_d4_to_f4(at)), c = fill3(p->c_float), r = fill3(p->r);
    f8x3 a = corner(block, 0), x = corner(block, 1), y = corner(block, 2);
    x = sub8(&x, &a), y = sub8(&y, &a), a = sub8(&a, &o);
    f8x3 n = cross8(&x, &y), m1 = cross8(&a, &x), m3 = cross8(&y, &a), k1 = cross8(&c, &x),
         k3 = cross8(&y, &c);
    out->n = n, out->d = dot8(&c, &n), out->t = dot8(&a, &n);
    out->number[0] = dot8(&c, &m1), out->number[2] = dot8(&c, &m3);
    out->number[1] = out->d - out->number[0] - out->number[2];
    out->vector[0] = add_scaled8(&m1, sagi_f8_fill(s), &k1),
    out->vector[2] = add_scaled8(&m3, sagi_f8_fill(s), &k3);
    out->vector[1] = sub8(&n, &out->vector[0]), out->vector[1] = sub8(&out->vector[1], &out->vector[2]);
    sagi_f8 least_upper = sagi_f8_fill(INFINITY), most_lower = sagi_f8_fill(-INFINITY);
    for (int i = 0; i < 3; i++) {
        f8x3 size = {sagi_f8_abs(out->vector[i].x), sagi_f8_abs(out->vector[i].y),
                     sagi_f8_abs(out->vector[i].z)};
        sagi_f8 way = dot8(&r, &size);
        least_upper = sagi_f8_min(out->number[i] + way, least_upper);
        most_lower = sagi_f8_max(out->number[i] - way, most_lower);
    }
    sagi_i8 missed = sagi_f8_below(least_upper, -out->bound) & sagi_f8_above(most_lower, out->bound);
    out->left = ((1U << block->head.count) - 1) & ~sagi_i8_mask(missed);
}

// Two blocks may hold the same triangle.
static inline bool same_triangle(const packet *p, int32_t nearest, const sagi_triangle_block *block,
                                 uint32_t lane) {
    if (nearest < 0) return false;
    const sagi_triangle_block *other = p->blocks[nearest >> 3];
    return other->head.geometry == block->head.geometry &&
           other->primitive[nearest & 7] == block->primitive[lane];
}

// Rays of a group that are met by a triangle they cannot be certain of, or by two too close to each other.
static __attribute__((noinline)) void leave_undecided(packet *p, size_t group, uint32_t rays,
                                                      uint32_t certain, const sagi_triangle_block *block,
                                                      uint32_t lane) {
    for (; rays != 0; rays &= rays - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(rays);
        if ((certain >> i & 1) != 0 && same_triangle(p, p->nearest[group][i], block, lane)) continue;
        p->limit[group][i] = -1;
        p->undecided |= 1U << (8 * group + i);
    }
}

// Eight rays and one triangle.
SAGI_INLINE void packet_triangle(packet *p, size_t group, const packet_block *at,
                                 const sagi_triangle_block *block, uint32_t lane, bool one_sided) {
    sagi_f8 x = p->x[group], y = p->y[group], z = p->z[group], e[3];
    for (int i = 0; i < 3; i++)
        e[i] = sagi_f8_fma(z, sagi_f8_fill(at->vector[i].z[lane]),
                           sagi_f8_fma(y, sagi_f8_fill(at->vector[i].y[lane]),
                                       sagi_f8_fma(x, sagi_f8_fill(at->vector[i].x[lane]),
                                                   sagi_f8_fill(at->number[i][lane]))));
    sagi_f8 least = sagi_f8_min(sagi_f8_min(e[0], e[1]), e[2]),
            most = sagi_f8_max(sagi_f8_max(e[0], e[1]), e[2]);
    sagi_f8 limit = p->limit[group];
    sagi_i8 maybe =
        ~(sagi_f8_below(least, -at->bound) & sagi_f8_above(most, at->bound)) & (limit >= at->begin);
    if (sagi_i8_mask(maybe) == 0) return;
    sagi_f8 w = sagi_f8_fma(z, sagi_f8_fill(at->n.z[lane]),
                            sagi_f8_fma(y, sagi_f8_fill(at->n.y[lane]), x * at->n.x[lane]));
    sagi_f8 d = at->d[lane] + w, t = at->t[lane] - at->s * w;
    sagi_i8 sign = sagi_f8_bits(d) & INT32_MIN,
            behind = most<-at->bound, front = behind, back = least> at->bound;
    t = (sagi_f8)(sagi_f8_bits(t) ^ sign), d = sagi_f8_abs(d);
    sagi_i8 known = d > 2 * at->b1;
    behind = known & (t < -at->b0);
    sagi_f8 earliest = sagi_f8_max((t - at->b0) / (d + at->b1), sagi_f8_fill(0));
    sagi_f8 latest = (t + at->b0) / (d - at->b1);
    earliest = (at->begin + earliest * at->step) * (1 - 0x1p-20F);
    latest = (at->begin + latest * at->step) * (1 + 0x1p-20F);
    maybe &= ~behind & (earliest <= limit);
    if (one_sided) maybe &= ~back;
    uint32_t met = sagi_i8_mask(maybe);
    if (met == 0) return;
    sagi_i8 certain = maybe & known & (front | back) & (latest <= p->t_max) &
                      (t - d * at->first > at->b0 + at->b1 * fabsf(at->first));
    sagi_i8 nearer = certain & (latest < p->earliest[group]);
    p->limit[group] = sagi_f8_select(nearer, latest, limit);
    uint32_t doubtful = met & ~sagi_i8_mask(nearer);
    if (doubtful != 0) leave_undecided(p, group, doubtful, sagi_i8_mask(certain), block, lane);
    int32_t number = (int32_t)(8 * p->block_count + lane);
    p->earliest[group] = sagi_f8_select(nearer, earliest, p->earliest[group]);
    p->nearest[group] = (nearer & number) | (~nearer & p->nearest[group]);
}

// What a leaf holds that only single rays can be asked.
static __attribute__((noinline)) void give_up_from(packet *p, float begin) {
    for (size_t i = 0; i < PACKET_GROUPS; i++)
        leave_undecided(p, i, sagi_i8_mask(p->limit[i] >= begin), 0, NULL, 0);
}

SAGI_INLINE void packet_leaf(packet *p, const sagi_block *leaf, float begin) {
    if (leaf->kind != SAGI_BLOCK_TRIANGLES || p->block_count == PACKET_BLOCKS) {
        give_up_from(p, begin);
        return;
    }
    const sagi_triangle_block *block = (const sagi_triangle_block *)(const void *)leaf;
    const sagi_item *item = &p->world->items[leaf->geometry];
    if ((p->mask & item->mask) == 0) return;
    SAGI_KERNEL_COUNT(packet_blocks);
    const bool one_sided = ((const sag_mesh *)item->shape)->one_sided;
    packet_block at;
    prepare_block(&at, p, block, begin);
    p->blocks[p->block_count] = block;
    p->work += 2 + (uint32_t)__builtin_popcount(at.left); // it takes as long as so many steps, about
    for (uint32_t left = at.left; left != 0; left &= left - 1) {
        SAGI_KERNEL_COUNT(packet_triangles);
        for (size_t i = 0; i < PACKET_GROUPS; i++)
            packet_triangle(p, i, &at, block, (uint32_t)__builtin_ctz(left), one_sided);
    }
    p->block_count++;
}

SAGI_INLINE float packet_limit(const packet *p) {
    sagi_f8 most = p->limit[0];
    for (size_t i = 1; i < PACKET_GROUPS; i++) most = sagi_f8_max(most, p->limit[i]);
    return sagi_f8_most(most);
}

SAGI_INLINE void packet_walk(packet *p, const sagi_float_ray *walker) {
    const sagi_bvh *tree = &p->world->tree;
    float begin[SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH];
    uint32_t child[SAGI_BVH_STACK_SIZE + SAGI_BVH_WIDTH];
    stack waits = {begin, child, 0};
    waiting next = {0, 0};
    float limit = packet_limit(p);
    const slabs r = slabs_of(walker);
    for (;;) {
        if ((next.child & SAGI_BVH_LEAF) == 0) {
            SAGI_KERNEL_COUNT(packet_nodes);
            if (++p->work > PACKET_WORK) {
                give_up_from(p, next.begin);
                limit = packet_limit(p);
            } else if (step(CLOSEST, &tree->nodes[next.child], &r, limit, &waits, &next)) {
                continue;
            }
        } else {
            packet_leaf(p, sagi_leaf(tree, next.child), next.begin);
            limit = packet_limit(p);
        }
        if (!pop(CLOSEST, limit, &waits, &next)) return;
    }
}

// The hits of up to four rays, whose numbers are in `which`: t, u and v, and all that is known already.
static void packet_solve(const packet *p, const sag_ray *rays, const uint32_t *which, uint32_t count,
                         sag_hit *hits) {
    sagi_triangle_four four;
    uint32_t geometry[4], primitive[4];
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t r = which[i < count ? i : 0];
        uint32_t nearest = (uint32_t)p->nearest[r / 8][r % 8];
        const sagi_triangle_block *block = p->blocks[nearest >> 3];
        geometry[i] = block->head.geometry, primitive[i] = block->primitive[nearest & 7];
        four.ray[i] = &rays[r], four.t_max[i] = rays[r].t_max;
        put_corners(&four, i, &p->world->items[geometry[i]], primitive[i]);
    }
    const uint32_t found = sagi_triangle_solve4(&four, (1U << count) - 1);
    const search here = {.path_length = 0};
    for (uint32_t i = 0; i < count; i++) {
        sag_hit *hit = &hits[which[i]];
        bool turned = p->world->items[geometry[i]].mirrored;
        if ((found >> i & 1) != 0)
            write_hit(&here, geometry[i], primitive[i], four.t[i], turned ? four.v[i] : four.u[i],
                      turned ? four.u[i] : four.v[i], hit);
        else if (!intersect(p->world, &rays[which[i]], hit))
            *hit = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
    }
}

#define PACKET_ALL ((uint32_t)((UINT64_C(1) << PACKET_RAYS) - 1))

// The closest hits of PACKET_RAYS rays, except those it returns, which are all when they are no packet.
static uint32_t packet_intersect(const sagi_world *world, const sag_ray *rays, sag_hit *hits,
                                 packet_luck *luck) {
    if (luck->wait > 0) {
        luck->wait--;
        return PACKET_ALL;
    }
    if (world->unbounded_count != 0 || world->tree.node_count == 0) return PACKET_ALL;
    packet p;
    sagi_float_ray walker;
    if (!packet_make(&p, &walker, world, rays)) {
        note_luck(luck, true);
        return PACKET_ALL;
    }
    packet_walk(&p, &walker);
    uint32_t missing = 0, which[PACKET_RAYS], count = 0;
    for (uint32_t i = 0; i < PACKET_GROUPS; i++) missing |= sagi_i8_mask(p.nearest[i] < 0) << 8 * i;
    missing &= ~p.undecided;
    for (uint32_t left = PACKET_ALL & ~(p.undecided | missing); left != 0; left &= left - 1)
        which[count++] = (uint32_t)__builtin_ctz(left);
    for (uint32_t i = 0; i < count; i += 4)
        packet_solve(&p, rays, which + i, count - i < 4 ? count - i : 4, hits);
    for (; missing != 0; missing &= missing - 1)
        hits[__builtin_ctz(missing)] = (sag_hit){.t = INFINITY, .geometry = SAG_INVALID_ID};
    note_luck(luck, __builtin_popcount(p.undecided) > PACKET_RAYS / 2 || p.work > PACKET_WORK);
    return p.undecided;
}
