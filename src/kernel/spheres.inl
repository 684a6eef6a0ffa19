// SPDX-License-Identifier: MIT
// A ray and a block of up to eight spheres (block.h). Part of kernel.inl.
//
// As with triangles, a float test of all eight says of each: certainly no crossing in the ray's range,
// certainly one, with bounds of the time of the nearest, or uncertain. What it says is always what
// sphere_solve.c would say of the sphere itself, so it only saves work: the uncertain go there one by one,
// and of the certain ones only the nearest's t is left to find.
//
// Calculation. As in triangles.inl the ray is o + t' d in grid steps, τ = begin + t'·2^-exponent. With A the
// centre minus o and r the radius
//     T = A·d/d·d,   w = A − T d,   q = w·w,   s = r² − q:
// T is the time of the closest approach, √q its distance from the centre, and the crossings are at
// T ∓ √(s/d·d). Subtracting T d before squaring keeps q's error small beside the grid's (Hearn & Baker's
// form; E. Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019).
//
// Errors, in grid steps; lengths are Euclidean. v = 2⁻²⁴, g = SAGI_GRID_ERROR. As in triangles.inl oᵢ is off
// by at most h = 0.13 and within 2¹⁴ of 0 … 2¹⁶; centres lie in 0 … 2¹⁶, so that |Aᵢ| ≤ 2¹⁷, |A| < 2¹⁷·√3 and
// v|A| < 0.0136; r < 2¹⁶, and ½ ≤ |d|∞ ≤ 1, so that |d| ≥ ½.
//     A: each coordinate by g + h + v2¹⁷ < 0.64, so A by 1.11.
//     d, rounded, is off by v|d|, its direction by v: w and T|d| change by 1.01v|A| each, which makes 1.13.
//     T: A·d has 3v|A||d| of roundings, 1/d·d 4.1v, the product v: 8.2v|A||d|⁻¹, 0.12 in T|d|.
//     w: product and sum 2v|A|; with T's error 10.3v|A| < 0.14:                  w is off by 1.27.
//     q: 3v, that is 1.6v of √q ≤ |A|, 0.03:                                      √q is off by 1.3.
//     r: g.
// The line certainly misses the sphere when √q > r + 2, and certainly meets it when √q < r − 2 (0.2 is left
// for the squares' roundings, 2v·2¹⁶ at most).
//     s: r² by 2gr + g², q by 1.3(2√q + 1.3), roundings 3v·2¹⁶ r; where √q ≤ r + 2 that is below 4r + 8.
//     The times: T by (1.13 + 0.12)/|d| < 2.5, and 0.03 for |d|; √(…) with the bounds of s by 4.1v of itself
//     and v for |d|, 0.05; sums and the comparison with the range, 5v·2¹⁹, and the range's own error, 2⁻³:
//     less than 3 in all.
// So the first crossing is between T − √((s + 4r + 8)/d·d) − 3 and T − √((s − 4r − 8)/d·d) + 3, with 0 for
// the root of a negative number, and the second one likewise. A crossing lies in the block's box and so at
// |t'| ≤ 2¹⁸: bounds of the range may be brought within ±2¹⁹ first.

typedef struct sphere_answer {
    uint32_t certain, uncertain; // lanes
    uint32_t second;         // of the certain: those whose second crossing it is, the first being too early
    sagi_f8 near[2], far[2]; // between which times the crossings are
} sphere_answer;

// Where the ray may cross the spheres at `begin` or later and before `limit`.
SAGI_INLINE sphere_answer meet_spheres(const sagi_block *block, const sagi_float_ray *ray, float begin,
                                       float limit) {
    sphere_answer answer;
    uint32_t left = (1U << block->count) - 1;
    double steps = grid_steps(block);
    sagi_d4 at;
    answer.certain = answer.second = 0, answer.uncertain = left;
    if (!start_on_grid(&in_blocks, block, ray, begin, steps, &at)) return answer;
    f8x3 o = fill3(sagi_d4_to_f4(at)), d = fill3(ray->direction);
    f8x3 a = {sagi_f8_from_h8(sagi_sphere_row(block, 0)), sagi_f8_from_h8(sagi_sphere_row(block, 1)),
              sagi_f8_from_h8(sagi_sphere_row(block, 2))};
    sagi_f8 r = sagi_f8_from_h8(sagi_sphere_row(block, 3));
    a = sub8(&a, &o);
    sagi_f8 inverse = 1 / dot8(&d, &d), time = dot8(&a, &d) * inverse;
    f8x3 w = {sagi_f8_fma(time, -d.x, a.x), sagi_f8_fma(time, -d.y, a.y), sagi_f8_fma(time, -d.z, a.z)};
    sagi_f8 q = dot8(&w, &w), outer = r + 2, inner = r - 2;
    answer.uncertain = left &= ~sagi_i8_mask(sagi_f8_less(outer * outer, q));
    if (left == 0) return answer;

    const sagi_f8 none = sagi_f8_fill(0);
    sagi_f8 s = r * r - q, doubt = 4 * r + 8;
    sagi_f8 most = sagi_f8_sqrt(sagi_f8_max(s + doubt, none) * inverse);
    sagi_f8 least = sagi_f8_sqrt(sagi_f8_max(s - doubt, none) * inverse);
    answer.near[0] = time - most - 3, answer.near[1] = time - least + 3;
    answer.far[0] = time + least - 3, answer.far[1] = time + most + 3;
    const float range = 0x1p19F, grid = (float)steps;
    float first = sagi_float_max((float)((ray->t_min - (double)begin) * steps), -range);
    float last = sagi_float_min((limit - begin) * grid, range);
    float last_certain = sagi_float_min((ray->t_max - begin) * grid, range);
    const sagi_f8 from = sagi_f8_fill(first), certain_to = sagi_f8_fill(last_certain);
    const sagi_i8 early = sagi_f8_less(answer.near[1], from);
    const sagi_i8 missed = sagi_f8_above(answer.near[0], last) | sagi_f8_less(answer.far[1], from) |
                           (early & sagi_f8_above(answer.far[0], last));
    const sagi_i8 met = sagi_f8_less(none, inner) & sagi_f8_less(q, inner * inner);
    const sagi_i8 at_first =
        sagi_f8_at_most(from, answer.near[0]) & sagi_f8_at_most(answer.near[1], certain_to);
    const sagi_i8 at_second =
        early & sagi_f8_at_most(from, answer.far[0]) & sagi_f8_at_most(answer.far[1], certain_to);
    left &= ~sagi_i8_mask(missed);
    answer.certain = left & sagi_i8_mask(met & (at_first | at_second));
    answer.uncertain = left & ~answer.certain;
    answer.second = sagi_i8_mask(early);
    return answer;
}

// Which one it is.
SAGI_INLINE sagi_bvh_reference sphere_reference(const sagi_block *block, uint32_t lane) {
    const uint32_t number = sagi_sphere_primitives(block)[lane];
    const bool lone = block->geometry == SAGI_LONE_SPHERES;
    return (sagi_bvh_reference){lone ? number : block->geometry, lone ? 0 : number};
}

// Centre and radius of a block's sphere.
SAGI_INLINE sagi_d4 sphere_at(const sagi_world *world, const sagi_block *block, sagi_bvh_reference r) {
    const void *shape = world->items[r.geometry].shape;
    return block->geometry == SAGI_LONE_SPHERES ? sagi_sphere_load(shape)
                                                : sagi_spheres_load(shape, r.primitive);
}

// One sphere by itself.
static inline bool sphere(question asked, level *here, const sagi_block *block, uint32_t lane) {
    const sagi_bvh_reference r = sphere_reference(block, lane);
    SAGI_KERNEL_COUNT(solved);
    double t[2];
    int found = sagi_sphere_solve(sphere_at(here->world, block, r), here->ray, here->t_max, asked != ALL, t);
    for (int i = 0; i < found; i++)
        if (accept(asked, here, r.geometry, r.primitive, t[i], 0, 0)) return true;
    return false;
}

// The only hit there is, as settle_last has it for triangles. False: that is not to be told so simply.
static __attribute__((noinline)) bool last_sphere(level *here, const candidate *c) {
    search *s = here->search;
    const sagi_bvh_reference r = sphere_reference(c->block, c->lane);
    double t;
    if (!sagi_sphere_first(sphere_at(here->world, c->block, r), here->ray, &t) || !(t >= here->ray->t_min) ||
        !(t <= here->t_max))
        return false;
    SAGI_KERNEL_COUNT(solved);
    write_hit(s, r.geometry, r.primitive, t, 0, 0, s->best);
    s->found = s->odd = true, s->near = false;
    here->t_max = t + room_of(s, t);
    return true;
}

// Those of these lanes whose geometry the ray sees.
static inline uint32_t seen_spheres(const level *here, const sagi_block *block, uint32_t lanes) {
    if (block->geometry != SAGI_LONE_SPHERES) return sees(here, item_of(here, block)) ? lanes : 0;
    uint32_t seen = 0;
    for (uint32_t left = lanes; left != 0; left &= left - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(left);
        if (sees(here, &here->world->items[sagi_sphere_primitives(block)[lane]])) seen |= 1U << lane;
    }
    return seen;
}

static inline void add_sphere(level *here, const sagi_block *block, const sphere_answer *answer,
                              uint32_t lane, float begin) {
    const sagi_f8 *between = answer->second >> lane & 1 ? answer->far : answer->near;
    float step = (float)power_of_two(-(int)block->exponent);
    float earliest = begin + sagi_float_max(between[0][lane], 0) * step,
          latest = begin + between[1][lane] * step;
    if (!add_candidate(here, block, lane, earliest * (1 - 0x1p-20F), latest * (1 + 0x1p-20F))) return;
    if (block->geometry == SAGI_LONE_SPHERES) {
        const sag_sphere *lone = here->world->items[sagi_sphere_primitives(block)[lane]].shape;
        __builtin_prefetch(&lone->center), __builtin_prefetch(&lone->radius);
        return;
    }
    const sag_spheres *set = item_of(here, block)->shape;
    const size_t primitive = sagi_sphere_primitives(block)[lane];
    __builtin_prefetch(set->centers_f64 ? (const void *)(set->centers_f64 + 3 * primitive)
                                        : (const void *)(set->centers_f32 + 3 * primitive));
    if (set->radii_f32) __builtin_prefetch(set->radii_f32 + primitive);
}

SAGI_INLINE bool sphere_block(question asked, level *here, const sagi_block *block, float begin) {
    SAGI_KERNEL_COUNT(blocks);
    sphere_answer answer = meet_spheres(block, &here->tree_ray, begin, here->limit);
    const uint32_t met = answer.certain | answer.uncertain;
    if (met == 0) return false;
    const uint32_t seen = seen_spheres(here, block, met);
    answer.certain &= seen, answer.uncertain &= seen;
    if (asked == ANY && answer.certain != 0) return here->search->found = true;
    if (asked == CLOSEST) {
        for (uint32_t left = answer.certain; left != 0; left &= left - 1)
            add_sphere(here, block, &answer, (uint32_t)__builtin_ctz(left), begin);
    } else {
        answer.uncertain |= answer.certain;
    }
    for (uint32_t left = answer.uncertain; left != 0; left &= left - 1) {
        SAGI_KERNEL_COUNT(uncertain);
        if (sphere(asked, here, block, (uint32_t)__builtin_ctz(left))) return true;
    }
    return false;
}
