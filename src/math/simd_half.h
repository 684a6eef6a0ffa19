// SPDX-License-Identifier: MIT
// What operators cannot say of four floats or two doubles, a register of SSE or 64-bit NEON: halves of
// simd.h's numbers (simd_halves.h). By the instruction where there is one, in plain C for machines of which
// nothing is known; comparisons are the operators', −1 where they hold.
#ifndef SAGI_MATH_SIMD_HALF_H
#define SAGI_MATH_SIMD_HALF_H

typedef double sagi_d2 __attribute__((vector_size(16)));
typedef int64_t sagi_l2 __attribute__((vector_size(16)));

// a b + c and a b − c, rounded once or twice; the smaller and the larger, b where one is a NaN; roots; the
// signs of lanes as bits; two pairs of doubles as four floats, and the first or last two of four floats as
// doubles.
#if defined(SAGI_SIMD_SSE)
SAGI_INLINE sagi_f4 sagi_f4_fma(sagi_f4 a, sagi_f4 b, sagi_f4 c) { return a * b + c; }
SAGI_INLINE sagi_f4 sagi_f4_fms(sagi_f4 a, sagi_f4 b, sagi_f4 c) { return a * b - c; }
SAGI_INLINE sagi_d2 sagi_d2_fma(sagi_d2 a, sagi_d2 b, sagi_d2 c) { return a * b + c; }
SAGI_INLINE sagi_f4 sagi_f4_min(sagi_f4 a, sagi_f4 b) { return (sagi_f4)_mm_min_ps((__m128)a, (__m128)b); }
SAGI_INLINE sagi_f4 sagi_f4_max(sagi_f4 a, sagi_f4 b) { return (sagi_f4)_mm_max_ps((__m128)a, (__m128)b); }
SAGI_INLINE sagi_f4 sagi_f4_sqrt(sagi_f4 a) { return (sagi_f4)_mm_sqrt_ps((__m128)a); }
SAGI_INLINE sagi_d2 sagi_d2_min(sagi_d2 a, sagi_d2 b) { return (sagi_d2)_mm_min_pd((__m128d)a, (__m128d)b); }
SAGI_INLINE sagi_d2 sagi_d2_max(sagi_d2 a, sagi_d2 b) { return (sagi_d2)_mm_max_pd((__m128d)a, (__m128d)b); }
SAGI_INLINE sagi_d2 sagi_d2_sqrt(sagi_d2 a) { return (sagi_d2)_mm_sqrt_pd((__m128d)a); }
SAGI_INLINE uint32_t sagi_w4_mask(sagi_w4 a) { return (uint32_t)_mm_movemask_ps((__m128)a); }
SAGI_INLINE uint32_t sagi_l2_mask(sagi_l2 a) { return (uint32_t)_mm_movemask_pd((__m128d)a); }
SAGI_INLINE sagi_f4 sagi_f4_of(sagi_d2 a, sagi_d2 b) {
    return (sagi_f4)_mm_movelh_ps(_mm_cvtpd_ps((__m128d)a), _mm_cvtpd_ps((__m128d)b));
}
SAGI_INLINE sagi_d2 sagi_f4_low(sagi_f4 a) { return (sagi_d2)_mm_cvtps_pd((__m128)a); }
SAGI_INLINE sagi_d2 sagi_f4_high(sagi_f4 a) {
    return (sagi_d2)_mm_cvtps_pd(_mm_movehl_ps((__m128)a, (__m128)a));
}

#elif defined(SAGI_SIMD_NEON)
SAGI_INLINE sagi_f4 sagi_f4_fma(sagi_f4 a, sagi_f4 b, sagi_f4 c) {
    return (sagi_f4)vfmaq_f32((float32x4_t)c, (float32x4_t)a, (float32x4_t)b);
}
SAGI_INLINE sagi_f4 sagi_f4_fms(sagi_f4 a, sagi_f4 b, sagi_f4 c) { return sagi_f4_fma(a, b, -c); }
SAGI_INLINE sagi_d2 sagi_d2_fma(sagi_d2 a, sagi_d2 b, sagi_d2 c) {
    return (sagi_d2)vfmaq_f64((float64x2_t)c, (float64x2_t)a, (float64x2_t)b);
}
SAGI_INLINE sagi_f4 sagi_f4_min(sagi_f4 a, sagi_f4 b) {
    return (sagi_f4)vbslq_f32((uint32x4_t)(a < b), (float32x4_t)a, (float32x4_t)b);
}
SAGI_INLINE sagi_f4 sagi_f4_max(sagi_f4 a, sagi_f4 b) {
    return (sagi_f4)vbslq_f32((uint32x4_t)(a > b), (float32x4_t)a, (float32x4_t)b);
}
SAGI_INLINE sagi_f4 sagi_f4_sqrt(sagi_f4 a) { return (sagi_f4)vsqrtq_f32((float32x4_t)a); }
SAGI_INLINE sagi_d2 sagi_d2_min(sagi_d2 a, sagi_d2 b) {
    return (sagi_d2)vbslq_f64((uint64x2_t)(a < b), (float64x2_t)a, (float64x2_t)b);
}
SAGI_INLINE sagi_d2 sagi_d2_max(sagi_d2 a, sagi_d2 b) {
    return (sagi_d2)vbslq_f64((uint64x2_t)(a > b), (float64x2_t)a, (float64x2_t)b);
}
SAGI_INLINE sagi_d2 sagi_d2_sqrt(sagi_d2 a) { return (sagi_d2)vsqrtq_f64((float64x2_t)a); }
SAGI_INLINE uint32_t sagi_w4_mask(sagi_w4 a) {
    const uint32_t bits[4] = {1, 2, 4, 8};
    return vaddvq_u32(vandq_u32((uint32x4_t)a, vld1q_u32(bits)));
}
SAGI_INLINE uint32_t sagi_l2_mask(sagi_l2 a) {
    return (uint32_t)((uint64_t)a[0] >> 63 | (uint64_t)a[1] >> 63 << 1);
}
SAGI_INLINE sagi_f4 sagi_f4_of(sagi_d2 a, sagi_d2 b) {
    return (sagi_f4)vcvt_high_f32_f64(vcvt_f32_f64((float64x2_t)a), (float64x2_t)b);
}
SAGI_INLINE sagi_d2 sagi_f4_low(sagi_f4 a) { return (sagi_d2)vcvt_f64_f32(vget_low_f32((float32x4_t)a)); }
SAGI_INLINE sagi_d2 sagi_f4_high(sagi_f4 a) { return (sagi_d2)vcvt_high_f64_f32((float32x4_t)a); }

#else
SAGI_INLINE sagi_f4 sagi_f4_fma(sagi_f4 a, sagi_f4 b, sagi_f4 c) { return a * b + c; }
SAGI_INLINE sagi_f4 sagi_f4_fms(sagi_f4 a, sagi_f4 b, sagi_f4 c) { return a * b - c; }
SAGI_INLINE sagi_d2 sagi_d2_fma(sagi_d2 a, sagi_d2 b, sagi_d2 c) { return a * b + c; }
SAGI_INLINE sagi_f4 sagi_f4_min(sagi_f4 a, sagi_f4 b) {
    const sagi_w4 less = a < b;
    return (sagi_f4)((less & (sagi_w4)a) | (~less & (sagi_w4)b));
}
SAGI_INLINE sagi_f4 sagi_f4_max(sagi_f4 a, sagi_f4 b) {
    const sagi_w4 greater = a > b;
    return (sagi_f4)((greater & (sagi_w4)a) | (~greater & (sagi_w4)b));
}
SAGI_INLINE sagi_f4 sagi_f4_sqrt(sagi_f4 a) {
    return (sagi_f4){__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]),
                     __builtin_sqrtf(a[3])};
}
SAGI_INLINE sagi_d2 sagi_d2_min(sagi_d2 a, sagi_d2 b) {
    const sagi_l2 less = a < b;
    return (sagi_d2)((less & (sagi_l2)a) | (~less & (sagi_l2)b));
}
SAGI_INLINE sagi_d2 sagi_d2_max(sagi_d2 a, sagi_d2 b) {
    const sagi_l2 greater = a > b;
    return (sagi_d2)((greater & (sagi_l2)a) | (~greater & (sagi_l2)b));
}
SAGI_INLINE sagi_d2 sagi_d2_sqrt(sagi_d2 a) { return (sagi_d2){__builtin_sqrt(a[0]), __builtin_sqrt(a[1])}; }
SAGI_INLINE uint32_t sagi_w4_mask(sagi_w4 a) {
    const sagi_w4 bit = a & (sagi_w4){1, 2, 4, 8};
    return (uint32_t)((bit[0] | bit[1]) | (bit[2] | bit[3]));
}
SAGI_INLINE uint32_t sagi_l2_mask(sagi_l2 a) {
    return (uint32_t)((uint64_t)a[0] >> 63 | (uint64_t)a[1] >> 63 << 1);
}
SAGI_INLINE sagi_f4 sagi_f4_of(sagi_d2 a, sagi_d2 b) {
    return (sagi_f4){(float)a[0], (float)a[1], (float)b[0], (float)b[1]};
}
SAGI_INLINE sagi_d2 sagi_f4_low(sagi_f4 a) { return (sagi_d2){a[0], a[1]}; }
SAGI_INLINE sagi_d2 sagi_f4_high(sagi_f4 a) { return (sagi_d2){a[2], a[3]}; }
#endif

// Of whole numbers; the least of eight without a sign.
#if defined(SAGI_SIMD_SSE4)
SAGI_INLINE sagi_w4 sagi_w4_min(sagi_w4 a, sagi_w4 b) {
    return (sagi_w4)_mm_min_epi32((__m128i)a, (__m128i)b);
}
SAGI_INLINE sagi_w4 sagi_w4_max(sagi_w4 a, sagi_w4 b) {
    return (sagi_w4)_mm_max_epi32((__m128i)a, (__m128i)b);
}
SAGI_INLINE uint32_t sagi_w4_least(sagi_w4 a, sagi_w4 b) {
    __m128i m = _mm_min_epu32((__m128i)a, (__m128i)b);
    m = _mm_min_epu32(m, _mm_shuffle_epi32(m, 0x4e));
    m = _mm_min_epu32(m, _mm_shuffle_epi32(m, 0xb1));
    return (uint32_t)_mm_cvtsi128_si32(m);
}
#elif defined(SAGI_SIMD_NEON)
SAGI_INLINE sagi_w4 sagi_w4_min(sagi_w4 a, sagi_w4 b) {
    return (sagi_w4)vminq_s32((int32x4_t)a, (int32x4_t)b);
}
SAGI_INLINE sagi_w4 sagi_w4_max(sagi_w4 a, sagi_w4 b) {
    return (sagi_w4)vmaxq_s32((int32x4_t)a, (int32x4_t)b);
}
SAGI_INLINE uint32_t sagi_w4_least(sagi_w4 a, sagi_w4 b) {
    return vminvq_u32(vminq_u32((uint32x4_t)a, (uint32x4_t)b));
}
#else
SAGI_INLINE sagi_w4 sagi_w4_min(sagi_w4 a, sagi_w4 b) { return ((a < b) & a) | (~(a < b) & b); }
SAGI_INLINE sagi_w4 sagi_w4_max(sagi_w4 a, sagi_w4 b) { return ((a > b) & a) | (~(a > b) & b); }
SAGI_INLINE uint32_t sagi_w4_least(sagi_w4 a, sagi_w4 b) {
    const sagi_w4 top = {INT32_MIN, INT32_MIN, INT32_MIN, INT32_MIN};
    const sagi_w4 m = sagi_w4_min(a ^ top, b ^ top) ^ top;
    const uint32_t x = (uint32_t)m[0] < (uint32_t)m[1] ? (uint32_t)m[0] : (uint32_t)m[1];
    const uint32_t y = (uint32_t)m[2] < (uint32_t)m[3] ? (uint32_t)m[2] : (uint32_t)m[3];
    return x < y ? x : y;
}
#endif

// n bits to the left.
typedef uint64_t sagi_u2 __attribute__((vector_size(16)));
SAGI_INLINE sagi_l2 sagi_l2_left(sagi_l2 a, uint64_t n) {
#ifdef SAGI_SIMD_SSE
    return (sagi_l2)_mm_sll_epi64((__m128i)a, _mm_cvtsi32_si128((int32_t)n));
#else
    return (sagi_l2)((sagi_u2)a << (sagi_u2){n, n});
#endif
}

// The first, or the last, of two vectors' numbers, one of each in turn.
#if defined(SAGI_SIMD_SSE)
SAGI_INLINE sagi_w4 sagi_h8_zip_low(sagi_h8 a, sagi_h8 b) {
    return (sagi_w4)_mm_unpacklo_epi16((__m128i)a, (__m128i)b);
}
SAGI_INLINE sagi_w4 sagi_h8_zip_high(sagi_h8 a, sagi_h8 b) {
    return (sagi_w4)_mm_unpackhi_epi16((__m128i)a, (__m128i)b);
}
SAGI_INLINE sagi_w4 sagi_w4_zip_low(sagi_w4 a, sagi_w4 b) {
    return (sagi_w4)_mm_unpacklo_epi32((__m128i)a, (__m128i)b);
}
SAGI_INLINE sagi_w4 sagi_w4_zip_high(sagi_w4 a, sagi_w4 b) {
    return (sagi_w4)_mm_unpackhi_epi32((__m128i)a, (__m128i)b);
}
#else
#if defined(__clang__) || __GNUC__ >= 12
#define SAGI_ZIP(a, b, type, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define SAGI_ZIP(a, b, type, ...) __builtin_shuffle(a, b, (type){__VA_ARGS__})
#endif
SAGI_INLINE sagi_w4 sagi_h8_zip_low(sagi_h8 a, sagi_h8 b) {
    return (sagi_w4)SAGI_ZIP(a, b, sagi_h8, 0, 8, 1, 9, 2, 10, 3, 11);
}
SAGI_INLINE sagi_w4 sagi_h8_zip_high(sagi_h8 a, sagi_h8 b) {
    return (sagi_w4)SAGI_ZIP(a, b, sagi_h8, 4, 12, 5, 13, 6, 14, 7, 15);
}
SAGI_INLINE sagi_w4 sagi_w4_zip_low(sagi_w4 a, sagi_w4 b) { return SAGI_ZIP(a, b, sagi_w4, 0, 4, 1, 5); }
SAGI_INLINE sagi_w4 sagi_w4_zip_high(sagi_w4 a, sagi_w4 b) { return SAGI_ZIP(a, b, sagi_w4, 2, 6, 3, 7); }
#endif

// The lanes in the mask, in order, and then anything. Row m of the table: the lanes set in m, as the numbers
// of their bytes.
#if defined(SAGI_SIMD_SSE4) || defined(SAGI_SIMD_NEON)
#define SAGI_HAS_SET_LANES 1
#define SAGI_LANE_BYTES(i) 4 * (i), 4 * (i) + 1, 4 * (i) + 2, 4 * (i) + 3
#define SAGI_WAY(i, j, k, l)                                                                                 \
    { SAGI_LANE_BYTES(i), SAGI_LANE_BYTES(j), SAGI_LANE_BYTES(k), SAGI_LANE_BYTES(l) }
static const uint8_t sagi_ways[16][16] __attribute__((aligned(16))) = {
    SAGI_WAY(0, 0, 0, 0), SAGI_WAY(0, 0, 0, 0), SAGI_WAY(1, 0, 0, 0), SAGI_WAY(0, 1, 0, 0),
    SAGI_WAY(2, 0, 0, 0), SAGI_WAY(0, 2, 0, 0), SAGI_WAY(1, 2, 0, 0), SAGI_WAY(0, 1, 2, 0),
    SAGI_WAY(3, 0, 0, 0), SAGI_WAY(0, 3, 0, 0), SAGI_WAY(1, 3, 0, 0), SAGI_WAY(0, 1, 3, 0),
    SAGI_WAY(2, 3, 0, 0), SAGI_WAY(0, 2, 3, 0), SAGI_WAY(1, 2, 3, 0), SAGI_WAY(0, 1, 2, 3)};
SAGI_INLINE sagi_w4 sagi_w4_set_lanes(sagi_w4 a, uint32_t mask) {
#ifdef SAGI_SIMD_NEON
    return (sagi_w4)vqtbl1q_u8((uint8x16_t)a, vld1q_u8(sagi_ways[mask]));
#else
    return (sagi_w4)_mm_shuffle_epi8((__m128i)a, *(const __m128i *)(const void *)sagi_ways[mask]);
#endif
}
#endif

#endif
