// SPDX-License-Identifier: MIT
// What simd_avx2.h, where it is explained, says of eight floats or four doubles, for machines whose registers
// hold half of them. Also what operators can say but GCC does not lower well: it takes a comparison of eight
// apart into eight of one, and puts eight numbers together in memory, from where they come back late, as a
// load that is wider than the stores before it waits for them. So vectors are filled, made of numbers,
// compared and shuffled by the functions here, half by half; sums, products and what is done to bits may be
// written with operators.
#ifndef SAGI_MATH_SIMD_HALVES_H
#define SAGI_MATH_SIMD_HALVES_H

#include "math/simd_half.h"

// Eight or four as two halves, and back.
typedef union sagi_f8_halves {
    sagi_f8 all;
    sagi_f4 half[2];
} sagi_f8_halves;
typedef union sagi_i8_halves {
    sagi_i8 all;
    sagi_w4 half[2];
} sagi_i8_halves;
typedef union sagi_d4_halves {
    sagi_d4 all;
    sagi_d2 half[2];
} sagi_d4_halves;
typedef union sagi_l4_halves {
    sagi_l4 all;
    sagi_l2 half[2];
} sagi_l4_halves;
SAGI_INLINE sagi_f8 sagi_f8_join(sagi_f4 a, sagi_f4 b) { return ((sagi_f8_halves){.half = {a, b}}).all; }
SAGI_INLINE sagi_i8 sagi_i8_join(sagi_w4 a, sagi_w4 b) { return ((sagi_i8_halves){.half = {a, b}}).all; }
SAGI_INLINE sagi_d4 sagi_d4_join(sagi_d2 a, sagi_d2 b) { return ((sagi_d4_halves){.half = {a, b}}).all; }
SAGI_INLINE sagi_l4 sagi_l4_join(sagi_l2 a, sagi_l2 b) { return ((sagi_l4_halves){.half = {a, b}}).all; }
SAGI_INLINE sagi_d2 sagi_d4_half(sagi_d4 a, int i) { return ((sagi_d4_halves){a}).half[i]; }

// The same function of either half.
#define SAGI_HALVES1(type, from, function, a)                                                                \
    const from##_halves sagi_a = {a};                                                                        \
    return type##_join(function(sagi_a.half[0]), function(sagi_a.half[1]))
#define SAGI_HALVES2(type, from, function, a, b)                                                             \
    const from##_halves sagi_a = {a}, sagi_b = {b};                                                          \
    return type##_join(function(sagi_a.half[0], sagi_b.half[0]), function(sagi_a.half[1], sagi_b.half[1]))
#define SAGI_HALVES3(type, function, a, b, c)                                                                \
    const type##_halves sagi_a = {a}, sagi_b = {b}, sagi_c = {c};                                            \
    return type##_join(function(sagi_a.half[0], sagi_b.half[0], sagi_c.half[0]),                             \
                       function(sagi_a.half[1], sagi_b.half[1], sagi_c.half[1]))
#define SAGI_LESS(a, b)    ((a) < (b))
#define SAGI_AT_MOST(a, b) ((a) <= (b))
#define SAGI_EQUAL(a, b)   ((a) == (b))

SAGI_INLINE sagi_f8 sagi_f8_fill(float x) {
    const sagi_f4 half = {x, x, x, x};
    return sagi_f8_join(half, half);
}
typedef sagi_f4 sagi_same;
SAGI_INLINE sagi_same sagi_same_fill(float x) { return (sagi_same){x, x, x, x}; }
SAGI_INLINE sagi_f8 sagi_f8_of_same(sagi_same a) { return sagi_f8_join(a, a); }
SAGI_INLINE sagi_i8 sagi_i8_fill(int32_t x) {
    const sagi_w4 half = {x, x, x, x};
    return sagi_i8_join(half, half);
}
SAGI_INLINE sagi_d4 sagi_d4_fill(double x) { return sagi_d4_join((sagi_d2){x, x}, (sagi_d2){x, x}); }
SAGI_INLINE sagi_l4 sagi_l4_fill(int64_t x) { return sagi_l4_join((sagi_l2){x, x}, (sagi_l2){x, x}); }
SAGI_INLINE sagi_l4 sagi_l4_of(int64_t x, int64_t y, int64_t z, int64_t w) {
    return sagi_l4_join((sagi_l2){x, y}, (sagi_l2){z, w});
}
SAGI_INLINE sagi_d4 sagi_d4_of(double x, double y, double z, double w) {
    return sagi_d4_join((sagi_d2){x, y}, (sagi_d2){z, w});
}

SAGI_INLINE sagi_f8 sagi_f8_fma(sagi_f8 a, sagi_f8 b, sagi_f8 c) {
    SAGI_HALVES3(sagi_f8, sagi_f4_fma, a, b, c);
}
SAGI_INLINE sagi_f8 sagi_f8_fms(sagi_f8 a, sagi_f8 b, sagi_f8 c) {
    SAGI_HALVES3(sagi_f8, sagi_f4_fms, a, b, c);
}
SAGI_INLINE sagi_d4 sagi_d4_fma(sagi_d4 a, sagi_d4 b, sagi_d4 c) {
    SAGI_HALVES3(sagi_d4, sagi_d2_fma, a, b, c);
}
SAGI_INLINE sagi_f8 sagi_f8_min(sagi_f8 a, sagi_f8 b) { SAGI_HALVES2(sagi_f8, sagi_f8, sagi_f4_min, a, b); }
SAGI_INLINE sagi_f8 sagi_f8_max(sagi_f8 a, sagi_f8 b) { SAGI_HALVES2(sagi_f8, sagi_f8, sagi_f4_max, a, b); }
SAGI_INLINE sagi_i8 sagi_i8_min(sagi_i8 a, sagi_i8 b) { SAGI_HALVES2(sagi_i8, sagi_i8, sagi_w4_min, a, b); }
SAGI_INLINE sagi_i8 sagi_i8_max(sagi_i8 a, sagi_i8 b) { SAGI_HALVES2(sagi_i8, sagi_i8, sagi_w4_max, a, b); }
SAGI_INLINE sagi_d4 sagi_d4_min(sagi_d4 a, sagi_d4 b) { SAGI_HALVES2(sagi_d4, sagi_d4, sagi_d2_min, a, b); }
SAGI_INLINE sagi_d4 sagi_d4_max(sagi_d4 a, sagi_d4 b) { SAGI_HALVES2(sagi_d4, sagi_d4, sagi_d2_max, a, b); }
SAGI_INLINE sagi_f8 sagi_f8_sqrt(sagi_f8 a) { SAGI_HALVES1(sagi_f8, sagi_f8, sagi_f4_sqrt, a); }
SAGI_INLINE sagi_d4 sagi_d4_sqrt(sagi_d4 a) { SAGI_HALVES1(sagi_d4, sagi_d4, sagi_d2_sqrt, a); }
SAGI_INLINE sagi_i8 sagi_f8_less(sagi_f8 a, sagi_f8 b) { SAGI_HALVES2(sagi_i8, sagi_f8, SAGI_LESS, a, b); }
SAGI_INLINE sagi_i8 sagi_f8_at_most(sagi_f8 a, sagi_f8 b) {
    SAGI_HALVES2(sagi_i8, sagi_f8, SAGI_AT_MOST, a, b);
}
SAGI_INLINE sagi_i8 sagi_i8_above(sagi_i8 a, sagi_i8 b) { SAGI_HALVES2(sagi_i8, sagi_i8, SAGI_LESS, b, a); }
SAGI_INLINE sagi_l4 sagi_d4_less(sagi_d4 a, sagi_d4 b) { SAGI_HALVES2(sagi_l4, sagi_d4, SAGI_LESS, a, b); }
SAGI_INLINE sagi_l4 sagi_d4_at_most(sagi_d4 a, sagi_d4 b) {
    SAGI_HALVES2(sagi_l4, sagi_d4, SAGI_AT_MOST, a, b);
}
SAGI_INLINE sagi_i8 sagi_i8_equal(sagi_i8 a, sagi_i8 b) { SAGI_HALVES2(sagi_i8, sagi_i8, SAGI_EQUAL, a, b); }
SAGI_INLINE sagi_l4 sagi_l4_equal(sagi_l4 a, sagi_l4 b) { SAGI_HALVES2(sagi_l4, sagi_l4, SAGI_EQUAL, a, b); }
SAGI_INLINE sagi_l4 sagi_l4_from_mask(uint32_t bits) {
    return sagi_l4_of(-(int64_t)(bits & 1), -(int64_t)(bits >> 1 & 1), -(int64_t)(bits >> 2 & 1),
                      -(int64_t)(bits >> 3 & 1));
}
SAGI_INLINE sagi_l4 sagi_l4_rights(uint64_t x, uint64_t i, uint64_t j, uint64_t k, uint64_t l) {
    return sagi_l4_of((int64_t)(x >> i), (int64_t)(x >> j), (int64_t)(x >> k), (int64_t)(x >> l));
}
SAGI_INLINE sagi_l4 sagi_l4_left(sagi_l4 a, uint64_t n) {
    const sagi_l4_halves x = {a};
    return sagi_l4_join(sagi_l2_left(x.half[0], n), sagi_l2_left(x.half[1], n));
}
SAGI_INLINE uint32_t sagi_i8_mask(sagi_i8 a) {
    const sagi_i8_halves x = {a};
    return sagi_w4_mask(x.half[0]) | sagi_w4_mask(x.half[1]) << 4;
}
SAGI_INLINE uint32_t sagi_d4_signs(sagi_d4 a) {
    const sagi_l4_halves x = {(sagi_l4)a};
    return sagi_l2_mask(x.half[0]) | sagi_l2_mask(x.half[1]) << 2;
}
SAGI_INLINE uint32_t sagi_i8_least(sagi_i8 a) {
    const sagi_i8_halves x = {a};
    return sagi_w4_least(x.half[0], x.half[1]);
}
SAGI_INLINE uint32_t sagi_i8_least_from(sagi_i8 a, const uint32_t from[8], uint32_t *chosen) {
    const uint32_t least = sagi_i8_least(a);
    *chosen = from[least & 7];
    return least;
}
SAGI_INLINE bool sagi_i8_none(sagi_i8 a, sagi_i8 mask) {
    const sagi_l4_halves x = {(sagi_l4)(a & mask)};
    const sagi_l2 both = x.half[0] | x.half[1];
    return (both[0] | both[1]) == 0;
}

#ifdef SAGI_SIMD_NEON
SAGI_INLINE sagi_d4 sagi_d4_product_error(sagi_d4 a, sagi_d4 b, sagi_d4 p) { return sagi_d4_fma(a, b, -p); }
#else
SAGI_INLINE sagi_d4 sagi_d4_product_error(sagi_d4 a, sagi_d4 b, sagi_d4 p) { // Veltkamp and Dekker: dd.h
    const sagi_d4 splitter = sagi_d4_fill(0x1p27 + 1);
    sagi_d4 ta = splitter * a, tb = splitter * b, ah = ta - (ta - a), bh = tb - (tb - b);
    sagi_d4 al = a - ah, bl = b - bh;
    return ((ah * bh - p) + ah * bl + al * bh) + al * bl;
}
#endif

// Lanes of two vectors by number (simd.h).
#define SAGI_LANE_OF(a, b, i)                                                                                \
    ((i) < 4 ? (double)sagi_d4_half(a, (i) >> 1 & 1)[(i)&1] : (double)sagi_d4_half(b, (i) >> 1 & 1)[(i)&1])
#define SAGI_D4_SHUFFLE2(a, b, i, j, k, l)                                                                   \
    sagi_d4_of(SAGI_LANE_OF(a, b, i), SAGI_LANE_OF(a, b, j), SAGI_LANE_OF(a, b, k), SAGI_LANE_OF(a, b, l))
SAGI_INLINE sagi_d4 sagi_d4_turn(sagi_d4 a) {
    const sagi_d4_halves x = {a};
    return sagi_d4_join(x.half[1], x.half[0]);
}
SAGI_INLINE double sagi_d4_first(sagi_d4 a) { return sagi_d4_half(a, 0)[0]; }
SAGI_INLINE double sagi_d4_sum3(sagi_d4 a) {
    const sagi_d2 xy = sagi_d4_half(a, 0), zw = sagi_d4_half(a, 1);
    return (xy[0] + xy[1]) + zw[0];
}
SAGI_INLINE sagi_f4 sagi_d4_to_f4(sagi_d4 a) { return sagi_f4_of(sagi_d4_half(a, 0), sagi_d4_half(a, 1)); }
SAGI_INLINE sagi_d4 sagi_f4_to_d4(sagi_f4 a) { return sagi_d4_join(sagi_f4_low(a), sagi_f4_high(a)); }
SAGI_INLINE uint64_t sagi_d4_to_h4(sagi_d4 a) {
    const sagi_d2 xy = sagi_d4_half(a, 0), zw = sagi_d4_half(a, 1);
    const uint64_t low = (uint64_t)(int64_t)xy[0] | (uint64_t)(int64_t)xy[1] << 16;
    const uint64_t high = (uint64_t)(int64_t)zw[0] | (uint64_t)(int64_t)zw[1] << 16;
    return low | high << 32;
}
SAGI_INLINE sagi_d4 sagi_d4_load3(const double *p) { return sagi_d4_of(p[0], p[1], p[2], 0); }
SAGI_INLINE sagi_d4 sagi_d4_load3_float(const float *p) { return sagi_d4_of(p[0], p[1], p[2], 0); }
SAGI_INLINE sagi_d4 sagi_d4_load4_float(const float *p) {
    sagi_f4 a;
    memcpy(&a, p, sizeof a);
    return sagi_f4_to_d4(a);
}

// simd_avx2.h has what the numbers' upper halves are.
#define SAGI_ROWS_PLUS 0x1p23F
#define SAGI_ROWS_HIGH (0x1p23F + 0x4B00)
SAGI_INLINE void sagi_f8_rows(const uint16_t p[16], float high, sagi_f8 *first, sagi_f8 *second) {
    (void)high;
    const sagi_h8 upper = {0x4B00, 0x4B00, 0x4B00, 0x4B00, 0x4B00, 0x4B00, 0x4B00, 0x4B00};
    sagi_h8 rows[2];
    memcpy(rows, p, sizeof rows);
    *first = (sagi_f8)sagi_i8_join(sagi_h8_zip_low(rows[0], upper), sagi_h8_zip_low(rows[1], upper));
    *second = (sagi_f8)sagi_i8_join(sagi_h8_zip_high(rows[0], upper), sagi_h8_zip_high(rows[1], upper));
}
SAGI_INLINE sagi_f8 sagi_f8_from_h8(const uint16_t p[8]) { // of any alignment
    const sagi_h8 zero = {0};
    sagi_h8 h;
    memcpy(&h, p, sizeof h);
    return sagi_f8_join(__builtin_convertvector(sagi_h8_zip_low(h, zero), sagi_f4),
                        __builtin_convertvector(sagi_h8_zip_high(h, zero), sagi_f4));
}

// Four numbers that are there twice where a register has room for eight: here once.
typedef sagi_f4 sagi_f4s;
typedef sagi_w4 sagi_w4s;
SAGI_INLINE sagi_f4s sagi_f4s_of(sagi_f4 a) { return a; }
SAGI_INLINE sagi_f4s sagi_f4s_fill(float x) { return (sagi_f4s){x, x, x, x}; }
SAGI_INLINE sagi_f4s sagi_f4s_signed(sagi_f4s a, sagi_f4s b) {
    return (sagi_f4s)((sagi_w4s)a | ((sagi_w4s)b & INT32_MIN));
}
SAGI_INLINE sagi_f4 sagi_f4s_once(sagi_f4s a) { return a; }
SAGI_INLINE sagi_f4s sagi_f4s_fma(sagi_f4s a, sagi_f4s b, sagi_f4s c) { return sagi_f4_fma(a, b, c); }
SAGI_INLINE void sagi_f4s_spread3(sagi_f4s a, sagi_same out[3]) {
    out[0] = sagi_same_fill(a[0]), out[1] = sagi_same_fill(a[1]), out[2] = sagi_same_fill(a[2]);
}
SAGI_INLINE void sagi_f4_spread3(sagi_f4 a, sagi_same out[3]) { sagi_f4s_spread3(a, out); }
SAGI_INLINE void sagi_same_fill3(const sagi_f4 *a, sagi_same out[3]) { sagi_f4s_spread3(*a, out); }

#ifdef SAGI_HAS_SET_LANES
SAGI_INLINE void sagi_write_lanes(uint32_t mask, sagi_f8 a, float *p, sagi_i8 b, uint32_t *q) {
    const sagi_i8_halves x = {(sagi_i8)a}, y = {b};
    const uint32_t low = mask & 15, high = mask >> 4, count = (uint32_t)__builtin_popcount(low);
    const sagi_w4 out[4] = {sagi_w4_set_lanes(x.half[0], low), sagi_w4_set_lanes(x.half[1], high),
                            sagi_w4_set_lanes(y.half[0], low), sagi_w4_set_lanes(y.half[1], high)};
    memcpy(p, &out[0], 16), memcpy(p + count, &out[1], 16);
    memcpy(q, &out[2], 16), memcpy(q + count, &out[3], 16);
}
SAGI_INLINE void sagi_write_pairs4(uint32_t mask, sagi_w4 upper, sagi_w4 lower, uint64_t *p) {
    upper = sagi_w4_set_lanes(upper, mask), lower = sagi_w4_set_lanes(lower, mask);
    const sagi_w4 out[2] = {sagi_w4_zip_low(lower, upper), sagi_w4_zip_high(lower, upper)};
    memcpy(p, out, 32);
}
SAGI_INLINE void sagi_write_pairs(uint32_t mask, sagi_f8 a, sagi_i8 b, uint64_t *p) {
    const sagi_i8_halves x = {(sagi_i8)a}, y = {b};
    sagi_write_pairs4(mask & 15, x.half[0], y.half[0], p);
    sagi_write_pairs4(mask >> 4, x.half[1], y.half[1], p + __builtin_popcount(mask & 15));
}
#else
SAGI_INLINE void sagi_write_lanes(uint32_t mask, sagi_f8 a, float *p, sagi_i8 b, uint32_t *q) {
    for (uint32_t left = mask; left != 0; left &= left - 1) {
        int i = __builtin_ctz(left);
        *p++ = a[i], *q++ = (uint32_t)b[i];
    }
}
SAGI_INLINE void sagi_write_pairs(uint32_t mask, sagi_f8 a, sagi_i8 b, uint64_t *p) {
    for (uint32_t left = mask; left != 0; left &= left - 1) {
        int i = __builtin_ctz(left);
        *p++ = (uint64_t)(uint32_t)sagi_f8_bits(a)[i] << 32 | (uint32_t)b[i];
    }
}
#endif

#endif
