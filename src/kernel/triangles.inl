// SPDX-License-Identifier: MIT
// A ray and a block of eight triangles (block.h). Part of kernel.inl.
//
// A float test of all eight says of each: certainly missed, certainly hit in the ray's range, or uncertain.
// What it says is always what triangle_test.c would say of the true vertices, so it only saves work: the
// uncertain go there one by one, and of the certain ones only t, u and v are left to find, for the nearest.
//
// Calculation. In the grid's coordinates the ray is o + t' d, with o the point of the ray where it meets the
// block's box at the earliest (τ = begin), and time counts grid steps: τ = begin + t'·2^-exponent. With A, B,
// C the corners minus o,
//     m_a = d × A,  m_b = d × B,     e(a,b) = m_a·B,  e(b,c) = m_b·C,  e(c,a) = −m_a·C,
//     D = e(a,b) + e(b,c) + e(c,a),  T = A·(B × C),   t' = T/D,
// which are the edge functions of triangle_test.c and the t of triangle_solve.c: m_a·A = 0, and so on.
//
// Errors, in grid steps. v = 2⁻²⁴, g = SAGI_GRID_ERROR, R = max|oᵢ|, h = the error of o: what the ray's own
// is (sagi_float_ray.error), and vR. L = 2¹⁶ + R exceeds every |Aᵢ|, and |dᵢ| ≤ 1 up to v.
//     Aᵢ is off by σ = g + h + vL.
//     m: two products each off by σ + vL (that of d), and 4vL for roundings:     μ = 2σ + 6.1vL;  |m| ≤ 2L.
//     e: three products each off by μL + 2Lσ + μσ, and 20vL² for roundings:
//         ΔE = 12Lσ + 38.3vL² + 3μσ ≤ (12.5L + 7h)(g + h) + 52vL².               (3μσ ≤ 6σ² + …)
//     B = (13L + 8h)(g + h) + 54vL² in float is above ΔE, its own roundings included.
//     D is off by 3ΔE and 30vL² of roundings: 3.6B.
//     T: n = B × C has |nᵢ| ≤ 2L², off by 4Lσ + 2σ² + 4.1vL²; A·n is then off by
//         18L²σ + 6Lσ² + 31vL³ ≤ 1.5LB.
// So an e beyond ±B has the sign of the true one: two of opposite signs are a certain miss, three of one sign
// a certain hit of the triangle's inside.
//
// Times. Every true hit lies in the block and so has |t'| ≤ 2.1L (|d|∞ ≥ ½): bounds on t' may be brought
// within ±4L first. Let X = |D|x − sign(D) T for such a bound x. With D and T off as said, 3.1LB for
// roundings and 3LB for the error of x, X is off by less than 14.4LB + 1.5LB + 3.1LB + 3LB < 40LB. So X <
// −40LB is a certain t' > x, and X > 40LB a certain t' < x; even where D's sign itself is not certain: then
// |D| < 7.2B is the true one's bound and |T| > (40 − 14.4 − 1.5 − 6.1)LB, so that |t'| > 2.4L, no hit at all.
//
// What is not finite here (a ray from too far away has error ∞) fails all comparisons and stays uncertain.

typedef struct block_answer {
    uint32_t certain, uncertain; // lanes
    uint32_t back;               // of the certain: those met from the back
    sagi_f8 t, d, error;         // T with D's sign, |D|, 40LB: for bounds of t'
    float most;                  // 4L
} block_answer;

typedef struct f8x3 {
    sagi_f8 x, y, z;
} f8x3;

SAGI_INLINE f8x3 corner(const sagi_triangle_block *block, int i, const f8x3 *o) {
    return (f8x3){sagi_f8_from_h8(block->corner[i][0]) - o->x, sagi_f8_from_h8(block->corner[i][1]) - o->y,
                  sagi_f8_from_h8(block->corner[i][2]) - o->z};
}
SAGI_INLINE f8x3 cross8(const f8x3 *a, const f8x3 *b) {
    return (f8x3){sagi_f8_fms(a->y, b->z, a->z * b->y), sagi_f8_fms(a->z, b->x, a->x * b->z),
                  sagi_f8_fms(a->x, b->y, a->y * b->x)};
}
SAGI_INLINE sagi_f8 dot8(const f8x3 *a, const f8x3 *b) {
    return sagi_f8_fma(a->z, b->z, sagi_f8_fma(a->y, b->y, a->x * b->x));
}
SAGI_INLINE f8x3 fill3(sagi_f4 a) {
    return (f8x3){sagi_f8_fill(a[0]), sagi_f8_fill(a[1]), sagi_f8_fill(a[2])};
}

// The grid's zero, in world units. The numbers have 21 bits: as the last ones of 2⁵² + n they are a double.
SAGI_INLINE sagi_d4 grid_zero(uint64_t base) {
    typedef uint64_t u4 __attribute__((vector_size(32)));
    u4 n = (u4){base, base, base, base} >> (u4){0, SAGI_GRID_BASE_BITS, 2 * SAGI_GRID_BASE_BITS, 63};
    n = (n & (((uint64_t)1 << SAGI_GRID_BASE_BITS) - 1)) | 0x4330000000000000;
    return ((sagi_d4)n - sagi_d4_fill(0x1p52)) * sagi_d4_fill(0x1p-20) - sagi_d4_fill(1);
}

// `begin` is a lower bound of the τ where the ray meets the block's box, `limit` an upper bound of the τ that
// still matter.
SAGI_INLINE block_answer meet_triangles(const sagi_triangle_block *block, const sagi_float_ray *ray,
                                        float begin, float limit) {
    double steps = power_of_two(block->head.exponent);
    sagi_d4 at =
        ((ray->p + ray->d * sagi_d4_fill((double)begin)) - grid_zero(block->head.base)) * sagi_d4_fill(steps);
    f8x3 o = fill3(sagi_d4_to_f4(at)), d = fill3(ray->direction);
    sagi_f8 r = sagi_f8_max(sagi_f8_max(sagi_f8_abs(o.x), sagi_f8_abs(o.y)), sagi_f8_abs(o.z));
    sagi_f8 l = r + 65536.0F, h = r * 0x1p-24F + (float)(ray->error * steps);
    sagi_f8 bound = (l * 13 + h * 8) * (h + (float)SAGI_GRID_ERROR) + l * l * (54 * 0x1p-24F);

    f8x3 a = corner(block, 0, &o), b = corner(block, 1, &o), c = corner(block, 2, &o);
    f8x3 ma = cross8(&d, &a), mb = cross8(&d, &b), n = cross8(&b, &c);
    sagi_f8 ab = dot8(&ma, &b), bc = dot8(&mb, &c), ca = -dot8(&ma, &c);
    sagi_f8 least = sagi_f8_min(sagi_f8_min(ab, bc), ca), most = sagi_f8_max(sagi_f8_max(ab, bc), ca);
    sagi_i8 outside = (least < -bound) & (most > bound), inside = (least > bound) | (most < -bound);

    sagi_f8 den = ab + bc + ca, num = dot8(&a, &n);
    sagi_i8 sign = sagi_f8_bits(den) & INT32_MIN;
    sagi_f8 t = (sagi_f8)(sagi_f8_bits(num) ^ sign), size = sagi_f8_abs(den);
    sagi_f8 range = l * 4, error = l * bound * 40;
    float grid = (float)steps;
    sagi_f8 last = sagi_f8_min(sagi_f8_fill((limit - begin) * grid), range);
    sagi_f8 last_certain = sagi_f8_min(sagi_f8_fill((ray->t_max - begin) * grid), last);
    sagi_f8 first = sagi_f8_max(sagi_f8_fill((ray->t_min - begin) * grid), -range);
    sagi_i8 beyond = (t - size * last > error) | (t - size * first < -error);
    sagi_i8 within = (size * last_certain - t > error) & (t - size * first > error);

    uint32_t there = (1U << block->head.count) - 1;
    uint32_t missed = sagi_i8_mask(outside | beyond), certain = sagi_i8_mask(inside & within) & there;
    return (block_answer){.certain = certain,
                          .uncertain = there & ~missed & ~certain,
                          .back = certain & ~sagi_i8_mask(sign),
                          .t = t,
                          .d = size,
                          .error = error,
                          .most = range[0]};
}

static inline const sagi_item *item_of(const level *here, const sagi_block *head) {
    return &here->world->items[head->geometry];
}

typedef struct mesh_corners {
    sag_vec3 a, b, c;
} mesh_corners;

// A mesh whose transform mirrors it has its vertices where they stand, but the sense of rotation that says
// which side is the front is the one before: the second and third vertex change places, and so do their
// weights in the hit.
static inline mesh_corners corners_of(const sagi_item *item, uint32_t primitive) {
    const sag_mesh *mesh = item->shape;
    const uint32_t *corner = mesh->triangles + 3 * (size_t)primitive;
    return (mesh_corners){sagi_mesh_vertex(mesh, corner[0]),
                          sagi_mesh_vertex(mesh, corner[item->mirrored ? 2 : 1]),
                          sagi_mesh_vertex(mesh, corner[item->mirrored ? 1 : 2])};
}

// One triangle by the exact test.
static inline bool triangle(question asked, level *here, const sagi_item *item, sagi_bvh_reference r) {
    const sag_mesh *mesh = item->shape;
    const bool one_sided = mesh->one_sided && !here->search->both_sides;
    mesh_corners at = corners_of(item, r.primitive);
    double t, u, v;
    SAGI_KERNEL_COUNT(exact_tests);
    if (!sagi_triangle_hit(&here->triangle_ray, &at.a, &at.b, &at.c, one_sided, &t, &u, &v)) return false;
    return accept(asked, here, r.geometry, r.primitive, t, item->mirrored ? v : u, item->mirrored ? u : v);
}

// One that is certainly hit.
static inline bool certain_triangle(question asked, level *here, const sagi_triangle_block *block,
                                    uint32_t lane) {
    const sagi_item *item = item_of(here, &block->head);
    mesh_corners at = corners_of(item, block->primitive[lane]);
    double t, u, v;
    SAGI_KERNEL_COUNT(solved);
    if (!sagi_triangle_solve(&here->triangle_ray, &at.a, &at.b, &at.c, &t, &u, &v)) return false;
    return accept(asked, here, block->head.geometry, block->primitive[lane], t, item->mirrored ? v : u,
                  item->mirrored ? u : v);
}

// CLOSEST: finds t, u and v of the candidates that may still be the nearest.
static inline void settle(level *here) {
    for (uint32_t i = 0; i < here->candidate_count; i++) {
        const candidate *c = &here->candidates[i];
        if (c->earliest <= here->limit) certain_triangle(CLOSEST, here, c->block, c->lane);
    }
    here->candidate_count = 0;
}

// CLOSEST: a certain hit bounds what still matters, though its t is not known yet.
static inline void add_candidate(level *here, const sagi_triangle_block *block, const block_answer *answer,
                                 uint32_t lane, float begin) {
    float step = (float)power_of_two(-(int)block->head.exponent), error = answer->error[0];
    float t = answer->t[lane], d = answer->d[lane];
    float latest = begin + sagi_float_min((t + error) / d, answer->most) * step;
    float earliest = begin + (t - error) / d * step;
    latest += (fabsf(latest) + begin) * 0x1p-20F, earliest -= (fabsf(earliest) + begin) * 0x1p-20F;
    here->limit = sagi_float_min(here->limit, latest);
    if (!(earliest <= here->limit)) return;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < here->candidate_count; i++)
        if (here->candidates[i].earliest <= here->limit) here->candidates[kept++] = here->candidates[i];
    here->candidate_count = kept;
    if (kept == MAX_CANDIDATES) settle(here);
    here->candidates[here->candidate_count++] = (candidate){block, lane, earliest};
    const sag_mesh *mesh = item_of(here, &block->head)->shape;
    __builtin_prefetch(mesh->triangles + 3 * (size_t)block->primitive[lane]);
}

static inline bool triangle_block(question asked, level *here, const sagi_triangle_block *block,
                                  float begin) {
    const sagi_item *item = item_of(here, &block->head);
    if (!sees(here, item)) return false;
    SAGI_KERNEL_COUNT(blocks);
    block_answer answer = meet_triangles(block, &here->tree_ray, begin, here->limit);
    uint32_t certain = answer.certain;
    if (((const sag_mesh *)item->shape)->one_sided && !here->search->both_sides) certain &= ~answer.back;
    if (asked == ANY && certain != 0) return here->search->found = true;
    for (; certain != 0; certain &= certain - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(certain);
        if (asked == CLOSEST)
            add_candidate(here, block, &answer, lane, begin);
        else
            certain_triangle(asked, here, block, lane);
    }
    for (uint32_t left = answer.uncertain; left != 0; left &= left - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(left);
        SAGI_KERNEL_COUNT(uncertain);
        if (triangle(asked, here, item, (sagi_bvh_reference){block->head.geometry, block->primitive[lane]}))
            return true;
    }
    return false;
}
