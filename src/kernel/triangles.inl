// SPDX-License-Identifier: MIT
// A ray and a block of eight triangles (block.h). Part of kernel.inl.
//
// A float test of all eight says of each: certainly missed, certainly hit in the ray's range, or uncertain.
// What it says is always what triangle_test.c would say of the true vertices, so it only saves work: the
// uncertain go there one by one, and of the certain ones only t, u and v are left to find, for the nearest.
//
// Calculation. In the grid's coordinates the ray is o + t' d, with o the point of the ray where it meets the
// block's box at the earliest (τ = begin), and time counts grid steps: τ = begin + t'·2^-exponent. With A the
// corner a minus o, X = b − a, Z = a − c, n = (b − a) × (c − a) = Z × X and m = d × A,
//     e(a,b) = m·X,  e(c,a) = m·Z,  D = d·n,  e(b,c) = D − e(a,b) − e(c,a),  T = A·n,  t' = T/D,
// which are the edge functions of triangle_test.c (d × a · b there, with the corners less o) and the t of
// triangle_solve.h.
//
// Errors, in grid steps. v = 2⁻²⁴, g = SAGI_GRID_ERROR. The ray begins near the block, −2¹⁴ ≤ oᵢ ≤ 2¹⁶ + 2¹⁴,
// and o is off by at most h = 0.13 (sagi_float_ray.error, ⅛ at most, and its own rounding); where that is not
// so all is uncertain. L = 2¹⁶ + 2¹⁴ bounds every |Aᵢ|, and |dᵢ| ≤ 1 up to v. E ≤ 2¹⁶ = 0.8L bounds the
// edges' coordinates (sagi_block.edge); edges of whole numbers are exact but for the corners' own errors, 2g.
//     Aᵢ is off by σ = g + h + vL < 0.64.
//     m: two products each off by σ + vL (that of d), and 4vL for roundings:     μ = 2σ + 6.1vL;  |m| ≤ 2L.
//     e(a,b), e(c,a): three products each off by 4gL + μE + 2gμ, and 16vLE for roundings:
//         ΔE = 12gL + 3μE + 6gμ + 16vLE < 6.03L + 3.98E = B.
//     n: each edge is off by 2g, so nᵢ by 8gE + 8g² and 4.1vE² for roundings:   ν = 8.1gE + 4.1vE²;  |n| ≤
//     2E². D: 3ν, and 6vE² for d, 18vE² for roundings:        ΔD = 24.3gE + 37vE² < E(12.5 + 60vE) = b₁.
//     e(b,c) is worked out times 0.32: 2ΔE + ΔD, and v(12E² + 36LE) for roundings (24LE where the sum is
//         fused), which is below 12.03L + 20.93E; times 0.32 less than 3.85L + 6.70E ≤ B.
//     T: ν|A|₁, 6E²σ, 3νσ, 10vE²|A|₁ for roundings:      ΔT < ⅓ b₁|A|₁ + 4E² = b₀.
// (|A|₁ = Σ|Aᵢ| is a triangle's own: small where a ray leaves the triangle, so that most such rays are
// certain.) An e beyond ±B, e(b,c) times 0.32, has the sign of the true one: two of opposite signs are a
// certain miss, three of one sign a certain hit of the triangle's inside. With |D| > 2b₁ the sign of D is
// certain, and for any time x
//     X = sign(D) T − |D| x  is off by at most  b₀ + b₁|x|  (and 5vE²|x| for roundings, which b₁ has room
//     for, and v(2E²|A|₁ + b₀) where T ∓ b₀ is rounded, which b₀ has),
// so that beyond that X says for certain on which side of x the hit is. Every hit lies in the block's box,
// which begins at t' = 0 or later, so 0 ≤ t' ≤ 2.1L (|d|∞ ≥ ½), and bounds x may be brought within ±2¹⁹
// first.

typedef struct f8x3 {
    sagi_f8 x, y, z;
} f8x3;

SAGI_INLINE f8x3 scaled8(const sagi_f8 *x, const sagi_f8 *y, const sagi_f8 *z, float s) {
    const sagi_f8 times = sagi_f8_fill(s);
    return (f8x3){*x * times, *y * times, *z * times};
}
SAGI_INLINE f8x3 sub8(const f8x3 *a, const f8x3 *b) { return (f8x3){a->x - b->x, a->y - b->y, a->z - b->z}; }
SAGI_INLINE f8x3 cross8(const f8x3 *a, const f8x3 *b) {
    return (f8x3){sagi_f8_fms(a->y, b->z, a->z * b->y), sagi_f8_fms(a->z, b->x, a->x * b->z),
                  sagi_f8_fms(a->x, b->y, a->y * b->x)};
}
SAGI_INLINE sagi_f8 dot8(const f8x3 *a, const f8x3 *b) {
    return sagi_f8_fma(a->z, b->z, sagi_f8_fma(a->y, b->y, a->x * b->x));
}
SAGI_INLINE void spread3(sagi_f4 a, f8x3 *out) {
    sagi_same to[3];
    sagi_f4_spread3(a, to);
    *out = (f8x3){sagi_f8_of_same(to[0]), sagi_f8_of_same(to[1]), sagi_f8_of_same(to[2])};
}
SAGI_INLINE f8x3 fill3(sagi_f4 a) {
    return (f8x3){sagi_f8_fill(a[0]), sagi_f8_fill(a[1]), sagi_f8_fill(a[2])};
}

// B, −B, b₁, twice b₁, and what b₀ is made of, for each sagi_block.edge.
typedef struct edge_bounds {
    float outside, minus_outside, b1, twice_b1, b0_way, b0;
} edge_bounds;
#define EDGE(i)    ((float)((i) + 1) * 256)
#define OUTSIDE(i) (6.03F * 81920 + 3.98F * EDGE(i))
#define B1(i)      (EDGE(i) * (12.5F + EDGE(i) * (60 * 0x1p-24F)))
#define BOUNDS(i)                                                                                            \
    { OUTSIDE(i), -OUTSIDE(i), B1(i), 2 * B1(i), B1(i) * (1 / 3.0F), 4 * EDGE(i) * EDGE(i) }
#define BOUNDS4(i)  BOUNDS(i), BOUNDS((i) + 1), BOUNDS((i) + 2), BOUNDS((i) + 3)
#define BOUNDS16(i) BOUNDS4(i), BOUNDS4((i) + 4), BOUNDS4((i) + 8), BOUNDS4((i) + 12)
#define BOUNDS64(i) BOUNDS16(i), BOUNDS16((i) + 16), BOUNDS16((i) + 32), BOUNDS16((i) + 48)
// How many grid steps a world unit has, for each sagi_block.exponent.
#define STEPS(i)  (double)((uint64_t)1 << (i))
#define STEPS4(i) STEPS(i), STEPS((i) + 1), STEPS((i) + 2), STEPS((i) + 3)
// And one over 128 times as many: a step of the fine grid (corners.h).
#define FINE(i)  (1 / ((double)(1 << SAGI_REST_BITS) * STEPS(i)))
#define FINE4(i) FINE(i), FINE((i) + 1), FINE((i) + 2), FINE((i) + 3)

// What blocks' tests need of constants.
typedef struct block_constants {
    float plus, high, third, minus_third, range;
    uint32_t sign, all_but_sign;
    double zero;
    uint64_t zero_bits, zero_exponent;
    double steps[SAGI_GRID_MAX_EXPONENT + 1], fine[SAGI_GRID_MAX_EXPONENT + 1];
    edge_bounds bounds[256];
    sagi_rest_constants rest;
} block_constants;
static const block_constants in_blocks = {
    .plus = SAGI_ROWS_PLUS,
    .high = SAGI_ROWS_HIGH,
    .third = 0.32F,
    .minus_third = -0.32F,
    .range = 0x1p19F,
    .sign = 0x80000000,
    .all_but_sign = 0x7FFFFFFF,
    .zero = 0x1p32 + 1,
    .zero_bits = ((uint64_t)1 << SAGI_GRID_BASE_BITS) - 1,
    .zero_exponent = 0x41F0000000000000,
    .steps = {STEPS4(0), STEPS4(4), STEPS4(8), STEPS4(12), STEPS4(16), STEPS4(20), STEPS4(24), STEPS4(28),
              STEPS4(32), STEPS4(36), STEPS(40)},
    .fine = {FINE4(0), FINE4(4), FINE4(8), FINE4(12), FINE4(16), FINE4(20), FINE4(24), FINE4(28), FINE4(32),
             FINE4(36), FINE(40)},
    .bounds = {BOUNDS64(0), BOUNDS64(64), BOUNDS64(128), BOUNDS64(192)},
    .rest = SAGI_REST_CONSTANTS,
};
_Static_assert(SAGI_GRID_MAX_EXPONENT == 40, "the last of the steps");
SAGI_INLINE double grid_steps(const sagi_block *head) { return in_blocks.steps[head->exponent]; }

// A block's corners a, and its edges x = b − a and z = a − c, all of them exact.
SAGI_INLINE void read_block(const block_constants *k, const sagi_triangle_block *block, f8x3 *a, f8x3 *x,
                            f8x3 *z) {
    f8x3 b, c;
    const sagi_f8 plus = sagi_f8_fill(k->plus);
    sagi_f8_rows(block->pair[0], k->high, &a->x, &b.x), sagi_f8_rows(block->pair[1], k->high, &a->y, &b.y);
    sagi_f8_rows(block->pair[2], k->high, &a->z, &b.z), sagi_f8_rows(block->pair[3], k->high, &c.x, &c.y);
    c.z = sagi_f8_from_h8(block->last);
    *x = sub8(&b, a);
    z->x = a->x - c.x, z->y = a->y - c.y;
    a->x -= plus, a->y -= plus, a->z -= plus;
    z->z = a->z - c.z;
}

// The grid's zero, in world units. The numbers have 21 bits: as the last ones of a double that begins with
// 2³² they stand for themselves times 2⁻²⁰.
SAGI_INLINE sagi_d4 grid_zero(const block_constants *k, uint64_t base) {
    const sagi_l4 n = sagi_l4_rights(base, 0, SAGI_GRID_BASE_BITS, 2 * SAGI_GRID_BASE_BITS, 63);
    return (sagi_d4)((n & sagi_l4_fill(k->zero_bits)) | sagi_l4_fill(k->zero_exponent)) -
           sagi_d4_fill(k->zero);
}

// The ray where τ = begin, on the block's grid. False when that is not as near or not known as well as the
// bounds of blocks' tests take for granted: −2¹⁴ ≤ oᵢ ≤ 2¹⁶ + 2¹⁴, off by 2⁻³ at most.
SAGI_INLINE bool is_near(const sagi_float_ray *ray, sagi_d4 at, double steps) {
    return (sagi_d4_signs(
                (sagi_d4)sagi_d4_at_most(sagi_d4_abs(at - sagi_d4_fill(0x1p15)), sagi_d4_fill(0xCp12))) &
            7) == 7 &&
           ray->error * steps <= 0.125;
}
SAGI_INLINE bool start_on_grid(const block_constants *k, const sagi_block *head, const sagi_float_ray *ray,
                               float begin, double steps, sagi_d4 *at) {
    *at = (sagi_d4_fma(ray->d, sagi_d4_fill((double)begin), ray->p) - grid_zero(k, head->base)) *
          sagi_d4_fill(steps);
    return __builtin_expect(head->exponent <= ray->finest, 1) || is_near(ray, *at, steps);
}

// `begin` is a lower bound of the τ where the ray meets the block's box, `limit` an upper bound of the τ that
// still matter. True when a triangle is met or may be; *answer need not be written otherwise, unless
// `always`.
SAGI_INLINE bool meet_triangles(const sagi_triangle_block *block, const sagi_float_ray *ray, float begin,
                                float limit, bool always, block_answer *answer) {
    const block_constants *k = sagi_hidden(&in_blocks);
    const double steps = k->steps[block->head.exponent];
    sagi_d4 at;
    const float last_certain = sagi_float_min(ray->t_max, limit);
    if (__builtin_expect(!start_on_grid(k, &block->head, ray, begin, steps, &at) || begin > last_certain,
                         0)) {
        answer->certain = answer->inside = answer->back = 0;
        answer->uncertain = sagi_last_bits(UINT32_MAX, block->head.count);
        return true;
    }
    f8x3 o, d = fill3(ray->direction), a, x, z;
    spread3(sagi_d4_to_f4(at), &o), read_block(k, block, &a, &x, &z);
    a = sub8(&a, &o);
    f8x3 m = cross8(&d, &a), n = cross8(&z, &x);
    sagi_f8 ab = dot8(&m, &x), ca = dot8(&m, &z), den = dot8(&d, &n), num = dot8(&a, &n);
    sagi_f8 bc = sagi_f8_fma(ab + ca, sagi_f8_fill(k->minus_third), den * sagi_f8_fill(k->third));
    sagi_f8 least = sagi_f8_min(sagi_f8_min(ab, ca), bc), most = sagi_f8_max(sagi_f8_max(ab, ca), bc);
    const edge_bounds *e = &k->bounds[block->head.edge];
    const sagi_i8 outside = sagi_f8_below(least, e->minus_outside) & sagi_f8_above(most, e->outside);
    const sagi_i8 inside = sagi_f8_above(least, e->outside) | sagi_f8_below(most, e->minus_outside);

    // When: on which side of the ray's first and last times, where T ∓ b₀ is beyond |D| x ± b₁|x|.
    const float grid = (float)steps, b1 = e->b1;
    const float first = (float)((ray->t_min - (double)begin) * steps), first_error = fabsf(first) * b1;
    const float last = sagi_float_min((limit - begin) * grid, k->range), last_error = last * b1;
    const float certain = sagi_float_min((last_certain - begin) * grid, k->range);
    const sagi_i8 sign = sagi_f8_bits(den) & sagi_i8_fill((int32_t)k->sign),
                  no_sign = sagi_i8_fill((int32_t)k->all_but_sign);
    const sagi_f8 t = (sagi_f8)(sagi_f8_bits(num) ^ sign), size = sagi_f8_and(den, no_sign);
    const sagi_f8 way = sagi_f8_and(a.x, no_sign) + sagi_f8_and(a.y, no_sign) + sagi_f8_and(a.z, no_sign);
    const sagi_f8 b0 = sagi_f8_fma(way, sagi_f8_fill(e->b0_way), sagi_f8_fill(e->b0));
    const sagi_f8 low = t - b0, high = t + b0, at_first = sagi_f8_fill(first);
    const sagi_i8 known = sagi_f8_above(size, e->twice_b1);
    const sagi_i8 beyond = sagi_f8_less(high, sagi_f8_fms(size, at_first, sagi_f8_fill(first_error))) |
                           sagi_f8_less(sagi_f8_fma(size, sagi_f8_fill(last), sagi_f8_fill(last_error)), low);
    const sagi_i8 within =
        known & inside & sagi_f8_less(sagi_f8_fma(size, at_first, sagi_f8_fill(first_error)), low) &
        sagi_f8_less(high, sagi_f8_fms(size, sagi_f8_fill(certain), sagi_f8_fill(last_error)));
    const uint32_t there = sagi_last_bits(~sagi_i8_mask(outside | (beyond & known)), block->head.count);
    if (!always && there == 0) return false;
    answer->certain = there & sagi_i8_mask(within), answer->uncertain = there & ~answer->certain;
    answer->inside = sagi_i8_mask(inside);
    answer->back = ~sagi_i8_mask(sagi_f8_below(den, 0));
    answer->t = t, answer->d = size, answer->b0 = b0, answer->b1 = b1;
    return there != 0;
}
