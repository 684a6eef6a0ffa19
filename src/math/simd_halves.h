// SPDX-License-Identifier: MIT
// What operators cannot say of eight floats (simd.h) where registers hold four: SSE4.2 and 64-bit NEON. Also
// what they can say but GCC 12 does not lower well: it takes a comparison of eight apart into eight of one.
// (A library such as SIMDe would say the same of the halves; vector types need none.)
#ifndef SAGI_MATH_SIMD_HALVES_H
#define SAGI_MATH_SIMD_HALVES_H

#ifdef SAGI_SIMD_SSE4
typedef __m128 sagi_half;
SAGI_INLINE sagi_half sagi_half_min(sagi_half a, sagi_half b) { return _mm_min_ps(a, b); }
SAGI_INLINE sagi_half sagi_half_max(sagi_half a, sagi_half b) { return _mm_max_ps(a, b); }
SAGI_INLINE sagi_half sagi_half_sqrt(sagi_half a) { return _mm_sqrt_ps(a); }
SAGI_INLINE sagi_half sagi_half_less(sagi_half a, sagi_half b) { return _mm_cmplt_ps(a, b); }
SAGI_INLINE sagi_half sagi_half_at_most(sagi_half a, sagi_half b) { return _mm_cmple_ps(a, b); }
SAGI_INLINE sagi_half sagi_half_bits_min(sagi_half a, sagi_half b) {
    return _mm_castsi128_ps(_mm_min_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
}
SAGI_INLINE sagi_half sagi_half_bits_max(sagi_half a, sagi_half b) {
    return _mm_castsi128_ps(_mm_max_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
}
SAGI_INLINE sagi_half sagi_half_bits_above(sagi_half a, sagi_half b) {
    return _mm_castsi128_ps(_mm_cmpgt_epi32(_mm_castps_si128(a), _mm_castps_si128(b)));
}
SAGI_INLINE uint32_t sagi_half_mask(sagi_half a) { return (uint32_t)_mm_movemask_ps(a); }
SAGI_INLINE uint32_t sagi_half_least(sagi_half a, sagi_half b) {
    __m128i m = _mm_min_epu32(_mm_castps_si128(a), _mm_castps_si128(b));
    m = _mm_min_epu32(m, _mm_shuffle_epi32(m, 0x4e));
    m = _mm_min_epu32(m, _mm_shuffle_epi32(m, 0xb1));
    return (uint32_t)_mm_cvtsi128_si32(m);
}
SAGI_INLINE sagi_half sagi_half_from_u16(const uint16_t p[4]) {
    return _mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_loadl_epi64((const __m128i *)(const void *)p)));
}
#else
typedef float32x4_t sagi_half;
// As the others have it: b where one of them is a NaN.
SAGI_INLINE sagi_half sagi_half_min(sagi_half a, sagi_half b) { return vbslq_f32(vcltq_f32(a, b), a, b); }
SAGI_INLINE sagi_half sagi_half_max(sagi_half a, sagi_half b) { return vbslq_f32(vcgtq_f32(a, b), a, b); }
SAGI_INLINE sagi_half sagi_half_sqrt(sagi_half a) { return vsqrtq_f32(a); }
SAGI_INLINE sagi_half sagi_half_less(sagi_half a, sagi_half b) {
    return vreinterpretq_f32_u32(vcltq_f32(a, b));
}
SAGI_INLINE sagi_half sagi_half_at_most(sagi_half a, sagi_half b) {
    return vreinterpretq_f32_u32(vcleq_f32(a, b));
}
SAGI_INLINE sagi_half sagi_half_bits_min(sagi_half a, sagi_half b) {
    return vreinterpretq_f32_s32(vminq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b)));
}
SAGI_INLINE sagi_half sagi_half_bits_max(sagi_half a, sagi_half b) {
    return vreinterpretq_f32_s32(vmaxq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b)));
}
SAGI_INLINE sagi_half sagi_half_bits_above(sagi_half a, sagi_half b) {
    return vreinterpretq_f32_u32(vcgtq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b)));
}
SAGI_INLINE uint32_t sagi_half_mask(sagi_half a) {
    const uint32_t bits[4] = {1, 2, 4, 8};
    return vaddvq_u32(vandq_u32(vreinterpretq_u32_f32(a), vld1q_u32(bits)));
}
SAGI_INLINE uint32_t sagi_half_least(sagi_half a, sagi_half b) {
    return vminvq_u32(vminq_u32(vreinterpretq_u32_f32(a), vreinterpretq_u32_f32(b)));
}
SAGI_INLINE sagi_half sagi_half_from_u16(const uint16_t p[4]) {
    return vcvtq_f32_u32(vmovl_u16(vld1_u16(p)));
}
#endif

typedef union sagi_halves {
    sagi_f8 all;
    sagi_half half[2];
} sagi_halves;

SAGI_INLINE sagi_f8 sagi_f8_of(sagi_half low, sagi_half high) {
    sagi_halves x = {.half = {low, high}};
    return x.all;
}
SAGI_INLINE sagi_f8 sagi_f8_min(sagi_f8 a, sagi_f8 b) {
    sagi_halves x = {a}, y = {b};
    return sagi_f8_of(sagi_half_min(x.half[0], y.half[0]), sagi_half_min(x.half[1], y.half[1]));
}
SAGI_INLINE sagi_f8 sagi_f8_max(sagi_f8 a, sagi_f8 b) {
    sagi_halves x = {a}, y = {b};
    return sagi_f8_of(sagi_half_max(x.half[0], y.half[0]), sagi_half_max(x.half[1], y.half[1]));
}
SAGI_INLINE sagi_f8 sagi_f8_sqrt(sagi_f8 a) {
    sagi_halves x = {a};
    return sagi_f8_of(sagi_half_sqrt(x.half[0]), sagi_half_sqrt(x.half[1]));
}
SAGI_INLINE sagi_i8 sagi_f8_less(sagi_f8 a, sagi_f8 b) {
    sagi_halves x = {a}, y = {b};
    return (sagi_i8)sagi_f8_of(sagi_half_less(x.half[0], y.half[0]), sagi_half_less(x.half[1], y.half[1]));
}
SAGI_INLINE sagi_i8 sagi_f8_at_most(sagi_f8 a, sagi_f8 b) {
    sagi_halves x = {a}, y = {b};
    return (sagi_i8)sagi_f8_of(sagi_half_at_most(x.half[0], y.half[0]),
                               sagi_half_at_most(x.half[1], y.half[1]));
}
SAGI_INLINE sagi_i8 sagi_i8_min(sagi_i8 a, sagi_i8 b) {
    sagi_halves x = {(sagi_f8)a}, y = {(sagi_f8)b};
    return (sagi_i8)sagi_f8_of(sagi_half_bits_min(x.half[0], y.half[0]),
                               sagi_half_bits_min(x.half[1], y.half[1]));
}
SAGI_INLINE sagi_i8 sagi_i8_max(sagi_i8 a, sagi_i8 b) {
    sagi_halves x = {(sagi_f8)a}, y = {(sagi_f8)b};
    return (sagi_i8)sagi_f8_of(sagi_half_bits_max(x.half[0], y.half[0]),
                               sagi_half_bits_max(x.half[1], y.half[1]));
}
SAGI_INLINE sagi_i8 sagi_i8_above(sagi_i8 a, sagi_i8 b) {
    sagi_halves x = {(sagi_f8)a}, y = {(sagi_f8)b};
    return (sagi_i8)sagi_f8_of(sagi_half_bits_above(x.half[0], y.half[0]),
                               sagi_half_bits_above(x.half[1], y.half[1]));
}
SAGI_INLINE uint32_t sagi_i8_mask(sagi_i8 a) {
    sagi_halves x = {(sagi_f8)a};
    return sagi_half_mask(x.half[0]) | sagi_half_mask(x.half[1]) << 4;
}
SAGI_INLINE uint32_t sagi_i8_least(sagi_i8 a) {
    sagi_halves x = {(sagi_f8)a};
    return sagi_half_least(x.half[0], x.half[1]);
}
SAGI_INLINE sagi_f8 sagi_f8_from_h8(const uint16_t p[8]) {
    return sagi_f8_of(sagi_half_from_u16(p), sagi_half_from_u16(p + 4));
}

#endif
