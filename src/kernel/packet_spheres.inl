// SPDX-License-Identifier: MIT
// Sixteen rays of a packet (packet.inl, where P, c, δ and Δ are explained) and a block of spheres. Part of
// kernel.inl.
//
// The calculation is that of spheres.inl, with the rays as lanes in place of the spheres. In the block's grid
// let o be P + τc at τ = begin, s that τ in grid steps and A a centre minus o. For a ray with direction D =
// c + δ, which is at o + sδ then,
//     A' = A − sδ,   T = A'·D/D·D,   w = A' − T D,   q = w·w,
// T being the time of the closest approach, √q its distance from the centre, and the crossings at
// T ∓ √((r² − q)/D·D).
//
// Errors, in grid steps, lengths being Euclidean, with v = 2⁻²⁴ and g = SAGI_GRID_ERROR. o is off by h in
// double, L bounds the coordinates of A and o, so that A' has coordinates of at most L + sΔ and a length of
// at most M = √3(L + sΔ). |D|∞ ≤ 1 and Δ ≤ ⅛ |D|∞, |D|∞ ≥ 7/16.
//     A': g for the centre, h for o, 2vL for o and A in floats, 2vsΔ for δ and its product, v(L + sΔ): by α =
//         g + h + 3v(L + sΔ) in each coordinate, √3(g + h) + 3vM in all.
//     D: δ by vΔ, the sum by v|D|: its direction by 1.5v; w and T|D| change by 1.6vM.
//     T: A'·D has 3v|A'||D| of roundings, 1/D·D 4.1v, the product v: 8.2vM in T|D|.
//     w: product and sum 2vM, with T's error 10.3vM.   q: 3v, that is 1.6vM of √q.
//     √q is so off by at most √3(g + h) + 16.5vM, the radius by g.
// With M in full and g < 0.501 both are less than B − 0.02 for
//     B = 1.4 + 1.75h + 30v(L + sΔ):
// √q > r + B is a certain miss, √q < r − B a certain crossing (0.02 and the round factors are for B's own
// rounding and those of the squares, 1.5v(2¹⁶ + B)).
//     r² − q, where √q ≤ r + B: 2gr + g², 2B(r + B) + B² less what B has over √q's error, 3v2¹⁶r for
//     roundings: less than 2Br + 3B².
//     T: √3(g + h) + 14.3vM over |D|, |D| itself included: less than 2.3(B − 0.5). The root with the bounds
//     of r² − q by 5.6v of itself, 0.06; the range and its comparison 0.05 + h, sums 4.6vM.
// So the first crossing is within 2.3B + h + 0.3 of T − √((r² − q ± (2Br + 3B²))/D·D), with 0 for the root of
// a negative number, and the second one likewise.
//
// All at once. A ray's direction and c enclose an angle of at most θ, sin θ ≤ |δ|/|D|; so it passes a centre
// at no less than √q of c's own line less ℓθ, ℓ ≤ s|c| + |A| being the centre's distance from P. What all
// rays miss by that is done with, eight spheres together. (θ < 1.01 sin θ, as Δ ≤ ⅛ |D|∞.)

typedef struct packet_sphere_block {
    f8x3 a;
    sagi_f8 r;
    float bound, wide, begin, step, first; // B; of the times; τ where o is; a grid step; t_min
    uint32_t left;                         // spheres that some ray may meet
} packet_sphere_block;

// What all blocks of spheres take of the packet.
static __attribute__((noinline)) void measure_packet(packet *p) {
    const f8x3 c = fill3(p->c_float);
    sagi_f8 turn = sagi_f8_fill(0);
    for (size_t i = 0; i < PACKET_GROUPS; i++) {
        const f8x3 away = {p->x[i], p->y[i], p->z[i]};
        p->d[i] = (f8x3){c.x + away.x, c.y + away.y, c.z + away.z};
        p->inverse[i] = 1 / dot8(&p->d[i], &p->d[i]);
        turn = sagi_f8_max(turn, dot8(&away, &away) * p->inverse[i]);
    }
    p->c_square = dot8(&c, &c)[0];
    p->c_length = sqrtf(p->c_square) * (1 + 0x1p-20F), p->turn = sqrtf(sagi_f8_most(turn)) * (1 + 0x1p-20F);
    p->measured = true;
}

SAGI_INLINE void prepare_spheres(packet_sphere_block *out, const packet *p, const sagi_block *block,
                                 float begin, f8x3 moved[PACKET_GROUPS]) {
    double steps = grid_steps(block);
    sagi_d4 at = ((p->p + p->c * sagi_d4_fill((double)begin)) - grid_zero(&in_blocks, block->base)) *
                 sagi_d4_fill(steps);
    float s = begin * (float)steps;
    float length = (float)(largest_of_three(sagi_d4_abs(at)) * (1 + 0x1p-20) + 0x1p16);
    float h = (float)(p->error * steps) * (1 + 0x1p-20F);
    out->bound = 1.4F + 1.75F * h + 30 * 0x1p-24F * (length + s * p->spread);
    out->wide = 2.3F * out->bound + h + 0.3F;
    out->begin = begin, out->step = (float)(1 / steps);
    out->first = (float)((p->t_min - (double)begin) * steps);
    for (size_t i = 0; i < PACKET_GROUPS; i++) moved[i] = scaled8(&p->x[i], &p->y[i], &p->z[i], s);
    f8x3 o = fill3(sagi_d4_to_f4(at)), c = fill3(p->c_float);
    f8x3 a = {sagi_f8_from_h8(sagi_sphere_row(block, 0)), sagi_f8_from_h8(sagi_sphere_row(block, 1)),
              sagi_f8_from_h8(sagi_sphere_row(block, 2))};
    out->r = sagi_f8_from_h8(sagi_sphere_row(block, 3));
    out->a = a = sub8(&a, &o);
    sagi_f8 time = dot8(&a, &c) * sagi_f8_fill(1 / p->c_square);
    f8x3 w = {sagi_f8_fma(time, -c.x, a.x), sagi_f8_fma(time, -c.y, a.y), sagi_f8_fma(time, -c.z, a.z)};
    float cone = 1.02F * p->turn * (s * p->c_length + 1.74F * length);
    sagi_f8 outer = out->r + sagi_f8_fill(out->bound + cone);
    out->left = ((1U << block->count) - 1) & ~sagi_i8_mask(sagi_f8_less(outer * outer, dot8(&w, &w)));
}

// Eight rays and one sphere.
SAGI_INLINE void packet_sphere(packet *p, size_t group, const packet_sphere_block *at, const f8x3 *moved,
                               const sagi_block *block, uint32_t lane) {
    const f8x3 d = p->d[group];
    const sagi_f8 inverse = p->inverse[group], limit = p->limit[group], none = sagi_f8_fill(0);
    const float r = at->r[lane], outer = r + at->bound, inner = sagi_float_max(r - at->bound, 0);
    f8x3 a = {sagi_f8_fill(at->a.x[lane]) - moved->x, sagi_f8_fill(at->a.y[lane]) - moved->y,
              sagi_f8_fill(at->a.z[lane]) - moved->z};
    sagi_f8 time = dot8(&a, &d) * inverse;
    f8x3 w = {sagi_f8_fma(time, -d.x, a.x), sagi_f8_fma(time, -d.y, a.y), sagi_f8_fma(time, -d.z, a.z)};
    sagi_f8 q = dot8(&w, &w);
    sagi_i8 maybe =
        sagi_f8_at_most(q, sagi_f8_fill(outer * outer)) & sagi_f8_at_most(sagi_f8_fill(at->begin), limit);
    if (sagi_i8_mask(maybe) == 0) return;
    const sagi_f8 doubt = sagi_f8_fill(at->bound * (2 * r + 3 * at->bound)), wide = sagi_f8_fill(at->wide);
    const sagi_f8 s = sagi_f8_fill(r * r) - q, block_begin = sagi_f8_fill(at->begin),
                  step = sagi_f8_fill(at->step);
    sagi_f8 most = sagi_f8_sqrt(sagi_f8_max(s + doubt, none) * inverse) + wide;
    sagi_f8 least = sagi_f8_sqrt(sagi_f8_max(s - doubt, none) * inverse) - wide;
    sagi_f8 from = time - most, to = time - least;
    sagi_i8 certain = sagi_f8_less(q, sagi_f8_fill(inner * inner));
    sagi_i8 begun = sagi_f8_at_most(sagi_f8_fill(at->first), from);
    if (sagi_i8_mask(maybe & ~begun) != 0) { // of some rays the first crossing may be too early
        sagi_f8 second = time + least, last = time + most;
        sagi_i8 early = sagi_f8_less(to, sagi_f8_fill(at->first));
        maybe &= sagi_f8_at_most(sagi_f8_fill(at->first), last);
        certain &= begun | (early & sagi_f8_at_most(sagi_f8_fill(at->first), second));
        from = sagi_f8_select(early, second, from), to = sagi_f8_select(begun, to, last);
    }
    sagi_f8 earliest = (block_begin + sagi_f8_max(from, none) * step) * (1 - 0x1p-20F);
    sagi_f8 latest = (block_begin + to * step) * (1 + 0x1p-20F);
    maybe &= sagi_f8_at_most(earliest, limit);
    uint32_t met = sagi_i8_mask(maybe);
    if (met == 0) return;
    certain &= maybe & sagi_f8_at_most(latest, sagi_f8_fill(p->last));
    packet_take(p, group, met, certain, earliest, latest, block, lane);
}

SAGI_INLINE void packet_spheres(packet *p, const sagi_block *block, float begin) {
    const bool lone = block->geometry == SAGI_LONE_SPHERES;
    SAGI_KERNEL_COUNT(packet_blocks);
    if (!p->measured) measure_packet(p);
    packet_sphere_block at;
    f8x3 moved[PACKET_GROUPS];
    prepare_spheres(&at, p, block, begin, moved);
    p->work++;
    if (at.left == 0) return;
    p->blocks[p->block_count] = block;
    for (uint32_t left = at.left; left != 0; left &= left - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(left);
        const uint32_t geometry = lone ? sagi_sphere_primitives(block)[lane] : block->geometry;
        if ((p->mask & p->world->items[geometry].mask) == 0) continue;
        for (size_t i = 0; i < PACKET_GROUPS; i++) packet_sphere(p, i, &at, &moved[i], block, lane);
    }
    p->block_count++;
}
