// SPDX-License-Identifier: MIT
// The float copy of a ray that walks the tree. It may only cull what the ray certainly misses, so every
// number in it is a bound.
//
// Units. The world's boxes are b = (p − C)·2⁻ᵏ with |b| ≤ 1, C being its origin (exact: rounded outward when
// they were made, bvh/box.h). With e such that max|dᵢ|·2⁻ᵉ is in [½, 1) let
//     q = (o − C)·2⁻ᵏ,   D = d·2⁻ᵉ,   τ = t·2ᵉ⁻ᵏ − τ₀,   P = q + τ₀D:
// in these units the ray is P + τD, and starts at τ = 0. τ₀ is where it enters the box of everything, or its
// t_min if that is later, so that a far origin costs no accuracy: |P| is of the order of 1.
//
// Error of P. Let u = 2⁻⁵³. o − C is rounded once (u|q|), the product and the sum once each, so that P is off
// by at most 2u(|q| + |τ₀D|)(1 + small) in each coordinate. Geometry with a transform meets another ray, the
// one brought to its space in double; where that ray, taken back, stands relative to this one is bounded by
// the world's spread (world.h). The sum of both, doubled for the shapes' own last-bit decisions, is
//     δ = 2⁻⁵⁰ (|q| + |τ₀D|) + 2⁻⁵⁰ spread + 2⁻⁹⁰.
// (2⁻⁹⁰ of the scene's size stands for whatever underflows.) True coordinates lie in P ± δ.
//
// Slabs. With ρ = 1/D the ray enters a slab at N = (b − P)ρ, b its near plane. We compute
//     fl(fl(b r) − a),   r = fl(ρ(1 − 2⁻²²)),   a = fl(P r + (2⁻²²|P r| + δ|r|(1 + 2⁻²⁰) + 2⁻¹⁰⁰)).
// Let v = 2⁻²⁴. r = ρ(1 − η) with 3v ≤ η ≤ 5v. The product errs by at most v|b r| ≤ v(|P r| + |N|), the
// conversion of a by v|P r| plus v of the rest (the factor 1 + 2⁻²⁰ pays for that), the last sum by
// v·max(N, 0) in the direction that matters. So the result is at most
//     N(1 − η) + v|N| + vN + (v + v − 4v)|P r| ≤ N   when N ≥ 0,   and ≤ 0 when N ≤ 0,
// which is as good, since it is compared with 0 next. In the same way, with 1 + 2⁻²² and the signs turned,
// the exit is at least its true value when that is ≥ 0. So a box that the ray meets at some τ ≥ 0 is never
// culled, and its entry is never overstated: that, and not the widening of boxes alone, is what conservative
// takes (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013, treats the case of equal precision).
//
// Small |Dᵢ| < 2⁻⁴⁰. r = ±2⁴⁰ stands in for ρ, so that no infinity meets a zero. Let T be a bound of the τ at
// which the ray leaves the box of everything: until then the coordinate moves by less than 2⁻⁴⁰T, which times
// |r| is T. For a slab that the ray meets, (b − P)r is so at most T for the near plane and at least −T for
// the far one, and widening a by 2T puts the slab around all of [0, T]. Slabs further off are still culled.
// (T is not always of the order of 1: seen from 2⁶⁰ scenes away, the ray's start is known to a few hundred
// scenes.)
//
// The far end. t·2ᵉ⁻ᵏ − τ₀ is rounded up to float, after adding 2⁻⁴⁸ of both terms for the rounding of the
// difference and because a shape's t may be 4 ulp from the true one: a box that holds a hit at the best t
// must not be lost, for the order among equal t decides.
//
// Blocks of triangles (triangles.inl) take P and D themselves. `error` bounds what P, points P + τD that are
// calculated in double within the box of everything, and times, their rounding by shapes included, can be
// off by: δ, and 2⁻⁴⁹ of every number that takes part.
//
// The quick way. Nearly all rays begin within 64 scenes' sizes, are of ordinary length, have no small Dᵢ and
// t_min ≥ 0 (or so little less that the widening below covers it). For them τ₀ = 0, P = q, and floats will
// do: p = fl(P), r = fl((1 − 2⁻²¹)/fl(D)) for the entry, which is ρ(1 − η) with 5.9v ≤ η ≤ 10.1v, and
// fl(r(1 + 18v)) for the exit, which is ρ(1 + η) with 6.9v ≤ η ≤ 13.1v. Then, r' being one or the other,
//     a = fl((p ± w) r'),   w = 2⁻²¹|p| + 2⁻⁴⁰ + spread, the sign being D's for the entry:
// p is off by v|P| and δ, its sum with w by v|p|, the product by v|p r'|, the fused difference by v of |a| or
// of N and the product b r' by v|b r'| ≤ v(|P r'| + |N|): 4.1v|p| < 2⁻²¹|p| pays for those that go with P,
// and the factor, at least 5.9v away from ρ, for those that go with N. That is the same bound in coarser
// coin: boxes widened by 2⁻²¹ of the distance from the scene's middle. The spread is that of the furthest
// origin that comes this way, one for all of a world's rays: it is less than 2⁻³⁸ unless transforms are
// steep. (Where it is not below 1, no ray comes this way.)
//
// Where a ray comes to a block (block.h): begin, the τ that is handed on with it, is at least the calculated
// entry of each coordinate, but for the last three bits of which it is robbed (2⁻²⁰ of it), and at most the
// calculated exit of each. Those are off, the entry downwards and the exit upwards, by what the boxes are
// widened by and by the roundings that this pays for: in the quick way, times |Dᵢ|, less than
//     (13.1v + 2v)|b − P| + (8v + 5v)|P| + v|b| + 2⁻⁴⁰ + spread,
// and 2⁻²⁰ begin|Dᵢ| ≤ 16v(|P| + 1.01), as the ray has left the scene by then. With |b| ≤ 1 and |P| ≤ 64 that
// is below 46v · 65 + 2⁻³¹ < 2⁻¹²·⁴ in all: so far at most, and 2⁻²⁴ for the box's own rounding, does
// P + begin·D lie outside the numbers that the block's grid has. In the careful way |P| ≤ 1 + 2δ, and the
// factors are nearer to 1; a coordinate of small |Dᵢ| has (b − P)r ≤ begin + 2T(1 + 2⁻²⁰) + 1 + roundings, so
// that it is outside by 2⁻⁴⁰(begin + 2T + 2) more at most, where begin ≤ 4.1 and T ≤ 4.1, since another |Dᵢ|
// is at least ½. On a grid with lines 2⁻²⁶ apart both are less than 2¹⁴ steps; and 2⁻⁵ of its steps are 2⁻³¹,
// which `error` stays below wherever the spread does. `finest` is that exponent, if error ≤ 2⁻³¹.
#ifndef SAGI_KERNEL_RAY_H
#define SAGI_KERNEL_RAY_H

#include "kernel/world.h"
#include "math/simd.h"
#include <float.h>
#include <math.h>
#include <stddef.h>

// Where in a node the planes stand that a ray comes to first and last, in bytes: for each coordinate that
// increases the lower ones first. By the signs of D, bit k set where coordinate k decreases.
typedef struct sagi_plane_order {
    uint32_t near_at[3], far_at[3], unused[2];
} sagi_plane_order;

#define SAGI_PLANE_BYTES (SAGI_BVH_WIDTH * (uint32_t)sizeof(float))
#define SAGI_FIRST(s, k) (((k) + 3 * ((s) >> (k)&1)) * SAGI_PLANE_BYTES)
#define SAGI_LAST(s, k)  (((k) + 3 - 3 * ((s) >> (k)&1)) * SAGI_PLANE_BYTES)
#define SAGI_PLANE_ORDER(s)                                                                                  \
    {                                                                                                        \
        {SAGI_FIRST(s, 0), SAGI_FIRST(s, 1), SAGI_FIRST(s, 2)},                                              \
            {SAGI_LAST(s, 0), SAGI_LAST(s, 1), SAGI_LAST(s, 2)}, {                                           \
            0, 0                                                                                             \
        }                                                                                                    \
    }
static const sagi_plane_order sagi_planes[8] = {
    SAGI_PLANE_ORDER(0), SAGI_PLANE_ORDER(1), SAGI_PLANE_ORDER(2), SAGI_PLANE_ORDER(3),
    SAGI_PLANE_ORDER(4), SAGI_PLANE_ORDER(5), SAGI_PLANE_ORDER(6), SAGI_PLANE_ORDER(7),
};

// Of three coordinates; the fourth place means nothing.
typedef struct sagi_float_ray {
    sagi_f4 near_scale, near_back; // entry = plane · scale − back
    sagi_f4 far_scale, far_back;   // exit
    sagi_plane_order planes;
    union {
        struct {
            float first_low, first_high; // lower and upper bound of τ of the ray's t_min, the lower one of
                                         // all that matter: at least 0 and not −0
            float t_max, limit;          // the same of its t_max
        };
        sagi_f4 times; // all four
    };
    sagi_f4 direction; // D, rounded
    sagi_d4 p, d;      // P and D
    union {
        struct {
            double error;
            int32_t
                finest; // with grids of this exponent and below (block.h), a block that the ray comes to at
                        // τ = begin has P + begin·D at most 2¹⁴ steps outside, known to 2⁻⁵ steps; or −1
        };
        struct sagi_quick quick;
    };
    double t_min; // τ of the ray's t_min
    union {
        struct {
            double start, unit[3]; // τ = t · unit[0] · unit[1] · unit[2] − start
        };
        sagi_d4 units;
    };
} sagi_float_ray;

static inline double power_of_two(int exponent) { // −1022 … 1023
    union {
        uint64_t bits;
        double value;
    } u = {.bits = (uint64_t)(exponent + 1023) << 52};
    return u.value;
}

static inline double scaled_time(const sagi_float_ray *ray, double t) {
    return t * ray->unit[0] * ray->unit[1] * ray->unit[2];
}

// The float that τ of a hit at t or sooner does not exceed.
static inline float sagi_float_ray_limit(const sagi_float_ray *ray, double t) {
    double tau = scaled_time(ray, t);
    double limit = (tau - ray->start) + 0x1p-48 * (fabs(tau) + fabs(ray->start)) + 0x1p-70;
    return (float)(limit * (1 + 0x1p-22));
}

// A lower bound of τ at t.
static inline float time_floor(const sagi_float_ray *ray, double t) {
    double tau = scaled_time(ray, t);
    if (isinf(tau)) return (float)tau;
    double floor = (tau - ray->start) - 0x1p-48 * (fabs(tau) + fabs(ray->start)) - 0x1p-70;
    return (float)(floor - fabs(floor) * 0x1p-22);
}

// An upper bound of τ at t.
static inline float time_ceiling(const sagi_float_ray *ray, double t) {
    double tau = scaled_time(ray, t);
    if (isinf(tau)) return (float)tau;
    double ceiling = (tau - ray->start) + 0x1p-48 * (fabs(tau) + fabs(ray->start)) + 0x1p-70;
    return (float)(ceiling + fabs(ceiling) * 0x1p-22);
}

// (fmax and fmin of libm are calls, for the sake of NaN.)
static inline double greater(double a, double b) { return a > b ? a : b; }
static inline double lesser(double a, double b) { return a < b ? a : b; }
static inline double largest_of_three(sagi_d4 a) { return greater(a[0], greater(a[1], a[2])); }

// What is left once P, D and everything per coordinate is there.
static inline void finish(sagi_float_ray *out, const sag_ray *ray, double enter, double leave, double delta) {
    out->start = enter;
    // A t beyond the doubles, as very short directions have it, is no hit.
    out->t_min = scaled_time(out, greater(ray->t_min, -DBL_MAX)) - enter;
    out->first_low = sagi_float_max(time_floor(out, greater(ray->t_min, -DBL_MAX)), 0);
    out->first_high = time_ceiling(out, greater(ray->t_min, -DBL_MAX));
    out->t_max = time_floor(out, lesser(ray->t_max, DBL_MAX));
    out->limit = sagi_float_ray_limit(out, ray->t_max);
    out->direction = sagi_d4_to_f4(out->d);
    out->error = delta + 0x1p-49 * (fabs(enter) + fabs(leave) + largest_of_three(sagi_d4_abs(out->p)) + 3);
    out->finest = sagi_finest_of(out->error);
}

// For a ray so far away (2¹⁰⁰ times the scene's size) or with so long a direction that doubles say nothing
// about it: nothing is culled.
static inline void make_blind(sagi_float_ray *out) {
    for (int k = 0; k < 3; k++) {
        out->near_scale[k] = out->far_scale[k] = 1;
        out->near_back[k] = FLT_MAX, out->far_back[k] = -FLT_MAX;
    }
    out->p = out->d = sagi_d4_fill(0);
    out->direction = (sagi_f4){0, 0, 0, 0};
    out->error = INFINITY;
    out->t_min = -INFINITY, out->finest = -1;
    out->first_low = 0, out->t_max = -INFINITY, out->first_high = out->limit = INFINITY;
    out->start = -INFINITY; // makes every limit infinite
}

static inline void set_axis(sagi_float_ray *out, int k, double p, double d, double error, double run) {
    bool small = fabs(d) < 0x1p-40;
    double inverse = small ? copysign(0x1p40, d) : 1 / d;
    float near = (float)(inverse * (1 - 0x1p-22)), far = (float)(inverse * (1 + 0x1p-22));
    double reach = fabs((double)far) * error * (1 + 0x1p-20) + 0x1p-100;
    if (small) reach += 2 * run * (1 + 0x1p-20) + 1;
    double near_back = p * near + (0x1p-22 * fabs(p * near) + reach);
    double far_back = p * far - (0x1p-22 * fabs(p * far) + reach);
    out->near_scale[k] = near, out->far_scale[k] = far;
    out->near_back[k] = (float)fmin(near_back, FLT_MAX), out->far_back[k] = (float)fmax(far_back, -FLT_MAX);
}

// Fills *out; false when the ray certainly misses everything in the tree or is not valid.
static __attribute__((noinline, cold)) bool make_carefully(const sagi_world *world, const sag_ray *ray,
                                                           sagi_float_ray *out) {
    if (!sag_ray_is_valid(ray)) return false;
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double c[3] = {world->origin.x, world->origin.y, world->origin.z};
    int exponent;
    frexp(fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2]))), &exponent);
    int half = exponent / 2, rest = exponent - half; // in two steps, since 2ᵉ alone may overflow
    double down[2] = {power_of_two(-half), power_of_two(-rest)};
    out->unit[0] = power_of_two(half), out->unit[1] = power_of_two(rest), out->unit[2] = world->scale;
    out->start = 0;
    // Directions so long that times are subnormal numbers: those are rounded by more than all of the bounds.
    if (scaled_time(out, 0x1p-1074) > 0x1p-72) {
        make_blind(out);
        return true;
    }

    double q[3], direction[3], spread = 0;
    for (int k = 0; k < 3; k++) {
        q[k] = (o[k] - c[k]) * world->scale;
        direction[k] = d[k] * down[0] * down[1];
        spread = fmax(spread, fabs(o[k]));
    }
    spread = (spread * world->spread_relative + world->spread_absolute) * world->scale * 0x1p-50;
    if (!(fabs(q[0]) < 0x1p100 && fabs(q[1]) < 0x1p100 && fabs(q[2]) < 0x1p100 && spread < 0x1p100)) {
        make_blind(out);
        return true;
    }
    // Where the ray is in the box of everything: bounds from both sides. (b − q)/D errs by at most
    // 3u(1 + |q|)/|D| in either.
    double enter = scaled_time(out, ray->t_min), leave = scaled_time(out, ray->t_max);
    enter -= 0x1p-48 * fabs(enter) + 0x1p-70, leave += 0x1p-48 * fabs(leave) + 0x1p-70;
    for (int k = 0; k < 3; k++) {
        double lo = world->tree.box.lo[k], hi = world->tree.box.hi[k];
        double error = 0x1p-50 * (1 + fabs(q[k])) + spread + 0x1p-90;
        if (fabs(direction[k]) < 0x1p-200) { // moves by less than 2⁻⁹⁰, as τ < 2¹⁰²
            if (!(q[k] >= lo - error && q[k] <= hi + error)) return false;
            continue;
        }
        double inverse = 1 / direction[k];
        double a = (lo - q[k]) * inverse, b = (hi - q[k]) * inverse, margin = 2 * error * fabs(inverse);
        enter = fmax(enter, fmin(a, b) - margin), leave = fmin(leave, fmax(a, b) + margin);
    }
    if (!(enter <= leave)) return false;
    double delta = 0;
    for (int k = 0; k < 3; k++) {
        double walked = enter * direction[k];
        double error = 0x1p-50 * (fabs(q[k]) + fabs(walked)) + spread + 0x1p-90;
        out->p[k] = q[k] + walked, out->d[k] = direction[k];
        set_axis(out, k, out->p[k], direction[k], error, leave - enter);
        delta = fmax(delta, error);
    }
    out->p[3] = out->d[3] = 0;
    finish(out, ray, enter, leave, delta);
    return true;
}

// What a walk needs of the ray first of all, before it is written down.
typedef struct sagi_ray_slabs {
    sagi_f4s near_scale, near_back, far_scale, far_back;
    float from;
    size_t signs; // of D
} sagi_ray_slabs;

// What the quick way does, for directions of which 2^(exponent − 1) ≤ max|dᵢ| < 2^exponent; with an exponent
// other than 0, t_min may be a little below 0. (The reciprocals are those of d itself, so that they need not
// wait for its exponent; powers of two change no bit.) The planes' order is left to who needs it.
SAGI_INLINE sagi_ray_slabs take_quick_way(const sagi_world *world, const sag_ray *ray, sagi_d4 q, sagi_d4 d,
                                          sagi_f4 p_once, sagi_f4 raw_once, bool scaled, int exponent,
                                          size_t signs, sagi_float_ray *out) {
    const float up = scaled ? (float)power_of_two(exponent) : 1;
    const sagi_f4s p = sagi_f4s_of(p_once), raw = sagi_f4s_of(raw_once);
    const sagi_f4s size = (sagi_f4s)((sagi_w4s)p & INT32_MAX);
    const sagi_f4s wide =
        sagi_f4s_signed(sagi_f4s_fma(size, sagi_f4s_fill(0x1p-21F), sagi_f4s_fill(world->quick.wide)), raw);
    sagi_ray_slabs now;
    now.near_scale = (up * (1 - 0x1p-21F)) / raw, now.far_scale = now.near_scale * (1 + 18 * 0x1p-24F);
    now.near_back = (p + wide) * now.near_scale, now.far_back = (p - wide) * now.far_scale;
    now.signs = signs;
    out->near_scale = sagi_f4s_once(now.near_scale), out->near_back = sagi_f4s_once(now.near_back);
    out->far_scale = sagi_f4s_once(now.far_scale), out->far_back = sagi_f4s_once(now.far_back);
    out->p = q, out->d = d, out->direction = raw_once;
    out->units = world->units, out->quick = world->quick;
    double unit = world->scale;
    if (scaled) {
        const double down = power_of_two(-exponent);
        out->d *= sagi_d4_fill(down), out->direction *= (float)down;
        out->unit[0] = unit *= power_of_two(exponent);
    }
    out->t_min = ray->t_min * unit;
    // A product of doubles with powers of two, one rounding to float and two at most here (v each, less than
    // 4v together): bounds, and t may be 4 ulp off. (Where numbers are so small that floats do not hold them,
    // they are off by 2⁻¹⁵⁰: no matter, since exits are overstated by 2⁻⁴⁰.)
    const sagi_d4 range =
        sagi_d4_load((const char *)ray + offsetof(sag_ray, direction.y)); // the last two of it
    const sagi_d4 times = SAGI_D4_SHUFFLE2(range, range, 2, 2, 3, 3);
    const sagi_f4 scales = {1 - 0x1p-22F, 1 + 0x1p-22F, 1 - 0x1p-22F, 1 + 0x1p-22F};
    const sagi_f4 shifts = {0, 0x1p-70F, -0x1p-70F, 0x1p-70F};
    const sagi_f4 bounds = sagi_f4_fma(sagi_d4_to_f4(times * sagi_d4_fill(unit)), scales, shifts);
    out->times = bounds, now.from = bounds[0];
    if (scaled) out->first_low = now.from = bounds[0] > 0 ? bounds[0] : 0;
    return now;
}

// How a ray is there: not at all, as it certainly misses everything in the tree or is not valid; written
// down; or also still in registers.
typedef enum ray_state { RAY_MISSES, RAY_WRITTEN, RAY_NOW } ray_state;

static inline ray_state careful_state(const sagi_world *world, const sag_ray *ray, sagi_float_ray *out,
                                      sagi_ray_slabs *now) {
    if (!make_carefully(world, ray, out)) return RAY_MISSES;
    now->signs = sagi_d4_signs(out->d) & 7;
    return RAY_WRITTEN;
}

// Directions of any length: the quick way where it is allowed, else the careful one.
SAGI_INLINE ray_state make_any_length(const sagi_world *world, const sag_ray *ray, sagi_float_ray *out,
                                      sagi_ray_slabs *now) {
    sagi_d4 d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction)); // the fourth is t_min
    sagi_d4 o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin));    // the fourth is d.x
    sagi_d4 size = sagi_d4_abs(d), q = (o - world->quick_center) * sagi_d4_fill(world->scale);
    const double largest = largest_of_three(size);
    const sagi_l4 usual =
        sagi_d4_at_most(sagi_d4_fill(largest * 0x1p-39), size) & sagi_d4_below(sagi_d4_abs(q), 64); // no NaN
    if (!(largest > 0x1p-60 && largest < 0x1p60 && ray->t_min <= ray->t_max &&
          (sagi_d4_signs((sagi_d4)usual) & 7) == 7))
        return careful_state(world, ray, out, now);
    union {
        double value;
        uint64_t bits;
    } u = {.value = largest};
    int exponent = (int)(u.bits >> 52) - 1022;
    if (!(ray->t_min * power_of_two(exponent) * world->scale >= -0x1p-44 && ray->t_max >= 0))
        return careful_state(world, ray, out, now);
    *now = take_quick_way(world, ray, q, d, sagi_d4_to_f4(q), sagi_d4_to_f4(d), true, exponent,
                          sagi_d4_signs(d) & 7, out);
    return RAY_NOW;
}
static __attribute__((noinline)) uint32_t make_unusual(const sagi_world *world, const sag_ray *ray,
                                                       sagi_float_ray *out) {
    sagi_ray_slabs made;
    return make_any_length(world, ray, out, &made) != RAY_MISSES ? made.signs : UINT32_MAX;
}

SAGI_INLINE bool likely(bool x) { return __builtin_expect(x, 1); }

// Fills *out but for the planes' order. Mostly max|dᵢ| is in [½, 1) as it comes, unless the ray is one
// between two points (`shadow`), and no |dᵢ| is below 2⁻³²; then there is little to do, and nothing of it in
// a row. (Rounded to floats, numbers are still ≥ 2⁻³²; what rounds to something below 1 is below 1, and what
// rounds to more than ½ is at least ½.) Floats without a sign are in order as whole numbers, so that one sum
// says where each of six is: in [2⁻³², 1) where it has none of the first four bits, below 64 where it has not
// the first; and another one, whether one is above ½.
SAGI_INLINE ray_state sagi_float_ray_begin(const sagi_world *world, const sag_ray *ray, bool shadow,
                                           sagi_float_ray *out, sagi_ray_slabs *now) {
    sagi_d4 d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction)); // the fourth is t_min
    sagi_d4 o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin));
    sagi_d4 q = (o - world->quick_center) * sagi_d4_fill(world->scale);
    sagi_f4 raw = sagi_d4_to_f4(d), p = sagi_d4_to_f4(q);
    const int32_t least = -0x2F800000 /* 2⁻³² */, most = 0x3D800000 /* 2³¹ less 64 */, no = INT32_MIN;
    const sagi_i8 shift = {least, least, least, 0, most, most, most, 0};
    const sagi_i8 at = sagi_i8_wrapping_sum(sagi_f8_bits(sagi_f8_abs(sagi_f8_join(raw, p))), shift);
    const int32_t high = no | 0x70000000, half = 0x10000000;
    const size_t signs = sagi_d4_signs(d);
    if (likely(sagi_i8_none(at, (sagi_i8){high, high, high, 0, no, no, no, 0})) &&
        likely(!sagi_i8_none(sagi_i8_wrapping_sum(at, sagi_i8_fill(0x7FFFFF)),
                             (sagi_i8){half, half, half, 0, 0, 0, 0, 0})) &&
        likely(signs < 8) && likely(ray->t_min <= ray->t_max)) {
        *now = take_quick_way(world, ray, q, d, p, raw, false, 0, signs, out);
        return RAY_NOW;
    }
    if (shadow) return make_any_length(world, ray, out, now);
    now->signs = make_unusual(world, ray, out);
    return now->signs < 8 ? RAY_WRITTEN : RAY_MISSES;
}

// All of it; false when it is not there.
SAGI_INLINE bool sagi_float_ray_make(const sagi_world *world, const sag_ray *ray, sagi_float_ray *out) {
    sagi_ray_slabs now;
    if (sagi_float_ray_begin(world, ray, false, out, &now) == RAY_MISSES) return false;
    out->planes = sagi_planes[now.signs];
    return true;
}

#endif
