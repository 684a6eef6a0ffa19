// SPDX-License-Identifier: MIT
// Sixteen rays of a packet (packet.inl, where P, c, δ and Δ are explained) and a block of triangles. Part of
// kernel.inl.
//
// In the block's grid let o be P + τc at τ = begin, s that τ in grid steps, A the corner a minus o, and X, Y
// the edges from a (whole numbers and exact). For the line through P in direction D the edge functions of
// triangle_test.c are
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
    double steps = grid_steps(&block->head);
    sagi_d4 at = ((p->p + p->c * sagi_d4_fill((double)begin)) - grid_zero(&in_blocks, block->head.base)) *
                 sagi_d4_fill(steps);
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
    f8x3 a, x, y;
    read_block(&in_blocks, block, &a, &x, &y);
    y = (f8x3){-y.x, -y.y, -y.z}, a = sub8(&a, &o);
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
    sagi_i8 maybe = ~(sagi_f8_below(least, -at->bound) & sagi_f8_above(most, at->bound)) &
                    sagi_f8_at_most(sagi_f8_fill(at->begin), limit);
    if (sagi_i8_mask(maybe) == 0) return;
    sagi_f8 w = sagi_f8_fma(z, sagi_f8_fill(at->n.z[lane]),
                            sagi_f8_fma(y, sagi_f8_fill(at->n.y[lane]), x * sagi_f8_fill(at->n.x[lane])));
    const sagi_f8 b0 = sagi_f8_fill(at->b0), b1 = sagi_f8_fill(at->b1), begin = sagi_f8_fill(at->begin),
                  step = sagi_f8_fill(at->step);
    sagi_f8 d = sagi_f8_fill(at->d[lane]) + w, t = sagi_f8_fill(at->t[lane]) - sagi_f8_fill(at->s) * w;
    const sagi_i8 sign = sagi_f8_bits(d) & INT32_MIN, front = sagi_f8_below(most, -at->bound),
                  back = sagi_f8_above(least, at->bound);
    t = (sagi_f8)(sagi_f8_bits(t) ^ sign), d = sagi_f8_abs(d);
    const sagi_i8 known = sagi_f8_above(d, 2 * at->b1), behind = known & sagi_f8_less(t, -b0);
    sagi_f8 earliest = sagi_f8_max((t - b0) / (d + b1), sagi_f8_fill(0));
    sagi_f8 latest = (t + b0) / (d - b1);
    earliest = (begin + earliest * step) * (1 - 0x1p-20F);
    latest = (begin + latest * step) * (1 + 0x1p-20F);
    maybe &= ~behind & sagi_f8_at_most(earliest, limit);
    if (one_sided) maybe &= ~back;
    uint32_t met = sagi_i8_mask(maybe);
    if (met == 0) return;
    const sagi_i8 certain =
        maybe & known & (front | back) & sagi_f8_at_most(latest, sagi_f8_fill(p->last)) &
        sagi_f8_above(t - d * sagi_f8_fill(at->first), at->b0 + at->b1 * fabsf(at->first));
    packet_take(p, group, met, certain, earliest, latest, &block->head, lane);
}

SAGI_INLINE void packet_triangles(packet *p, const sagi_triangle_block *block, float begin) {
    const sagi_item *item = &p->world->items[block->head.geometry];
    if ((p->mask & item->mask) == 0) return;
    SAGI_KERNEL_COUNT(packet_blocks);
    const bool one_sided = ((const sag_mesh *)item->shape)->one_sided;
    packet_block at;
    prepare_block(&at, p, block, begin);
    p->blocks[p->block_count] = &block->head;
    p->work += 2 + (uint32_t)__builtin_popcount(at.left); // it takes as long as so many steps, about
    for (uint32_t left = at.left; left != 0; left &= left - 1) {
        SAGI_KERNEL_COUNT(packet_triangles);
        for (size_t i = 0; i < PACKET_GROUPS; i++)
            packet_triangle(p, i, &at, block, (uint32_t)__builtin_ctz(left), one_sided);
    }
    p->block_count++;
}
