// SPDX-License-Identifier: MIT
// What operators cannot say of eight floats or four doubles (simd.h), where a register holds them: AVX2 and
// AVX-512.
#ifndef SAGI_MATH_SIMD_AVX2_H
#define SAGI_MATH_SIMD_AVX2_H

SAGI_INLINE sagi_f8 sagi_f8_fill(float x) { return (sagi_f8){x, x, x, x, x, x, x, x}; }
// The same number in eight lanes, where it waits: a register here, half of one elsewhere.
typedef sagi_f8 sagi_same;
SAGI_INLINE sagi_same sagi_same_fill(float x) { return sagi_f8_fill(x); }
SAGI_INLINE sagi_f8 sagi_f8_of_same(sagi_same a) { return a; }
SAGI_INLINE sagi_i8 sagi_i8_fill(int32_t x) { return (sagi_i8){x, x, x, x, x, x, x, x}; }
SAGI_INLINE sagi_d4 sagi_d4_fill(double x) { return (sagi_d4){x, x, x, x}; }
SAGI_INLINE sagi_l4 sagi_l4_fill(int64_t x) { return (sagi_l4){x, x, x, x}; }
SAGI_INLINE sagi_l4 sagi_l4_of(int64_t x, int64_t y, int64_t z, int64_t w) { return (sagi_l4){x, y, z, w}; }
SAGI_INLINE sagi_d4 sagi_d4_of(double x, double y, double z, double w) { return (sagi_d4){x, y, z, w}; }
SAGI_INLINE sagi_f8 sagi_f8_join(sagi_f4 a, sagi_f4 b) {
    return (sagi_f8){a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]};
}

// Lanes of two vectors, numbered 0 … 3 and 4 … 7.
#if defined(__clang__) || __GNUC__ >= 12
#define SAGI_D4_SHUFFLE2(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define SAGI_D4_SHUFFLE2(a, b, i, j, k, l) __builtin_shuffle(a, b, (sagi_l4){i, j, k, l})
#endif

// a b + c, rounded once here and twice elsewhere: the bounds of the kernels hold for both.
SAGI_INLINE sagi_f8 sagi_f8_fma(sagi_f8 a, sagi_f8 b, sagi_f8 c) { return (sagi_f8)_mm256_fmadd_ps(a, b, c); }
SAGI_INLINE sagi_f8 sagi_f8_fms(sagi_f8 a, sagi_f8 b, sagi_f8 c) { return (sagi_f8)_mm256_fmsub_ps(a, b, c); }
SAGI_INLINE sagi_f4 sagi_f4_fma(sagi_f4 a, sagi_f4 b, sagi_f4 c) { return (sagi_f4)_mm_fmadd_ps(a, b, c); }
// a < b ? a : b and a > b ? a : b
SAGI_INLINE sagi_f8 sagi_f8_min(sagi_f8 a, sagi_f8 b) { return (sagi_f8)_mm256_min_ps(a, b); }
SAGI_INLINE sagi_f8 sagi_f8_max(sagi_f8 a, sagi_f8 b) { return (sagi_f8)_mm256_max_ps(a, b); }
// −1 in lanes where a < b, or a ≤ b, else 0. (Lanes, on AVX-512, too: a mask is two cycles longer on its way
// into other lanes.)
SAGI_INLINE sagi_i8 sagi_f8_less(sagi_f8 a, sagi_f8 b) { return (sagi_i8)_mm256_cmp_ps(a, b, _CMP_LT_OQ); }
SAGI_INLINE sagi_i8 sagi_f8_at_most(sagi_f8 a, sagi_f8 b) { return (sagi_i8)_mm256_cmp_ps(a, b, _CMP_LE_OQ); }
SAGI_INLINE sagi_l4 sagi_d4_less(sagi_d4 a, sagi_d4 b) { return a < b; }
SAGI_INLINE sagi_l4 sagi_d4_at_most(sagi_d4 a, sagi_d4 b) { return a <= b; }
SAGI_INLINE sagi_i8 sagi_i8_equal(sagi_i8 a, sagi_i8 b) { return a == b; }
SAGI_INLINE sagi_l4 sagi_l4_equal(sagi_l4 a, sagi_l4 b) { return a == b; }
// Lane i: whether bit i is set.
SAGI_INLINE sagi_l4 sagi_l4_from_mask(uint32_t bits) {
    const sagi_l4 bit = {1, 2, 4, 8};
    return (sagi_l4_fill(bits) & bit) == bit;
}
// x without a sign, so many bits to the right in each lane; and a, n bits to the left.
SAGI_INLINE sagi_l4 sagi_l4_rights(uint64_t x, uint64_t i, uint64_t j, uint64_t k, uint64_t l) {
    typedef uint64_t whole __attribute__((vector_size(32)));
    return (sagi_l4)((whole){x, x, x, x} >> (whole){i, j, k, l});
}
SAGI_INLINE sagi_l4 sagi_l4_left(sagi_l4 a, uint64_t n) {
    typedef uint64_t whole __attribute__((vector_size(32)));
    return (sagi_l4)((whole)a << n);
}
// The smaller and the larger of whole numbers, one cycle where floats take two; −1 where a > b, else 0.
// (Written as instructions: GCC makes masks of comparisons, too, if it may.)
SAGI_INLINE sagi_i8 sagi_i8_min(sagi_i8 a, sagi_i8 b) {
    return (sagi_i8)_mm256_min_epi32((__m256i)a, (__m256i)b);
}
SAGI_INLINE sagi_i8 sagi_i8_max(sagi_i8 a, sagi_i8 b) {
    return (sagi_i8)_mm256_max_epi32((__m256i)a, (__m256i)b);
}
SAGI_INLINE sagi_i8 sagi_i8_above(sagi_i8 a, sagi_i8 b) {
#ifdef SAGI_SIMD_AVX512
    sagi_i8 above;
    __asm__("vpcmpgtd %2, %1, %0" : "=x"(above) : "x"(a), "x"(b));
    return above;
#else
    return (sagi_i8)_mm256_cmpgt_epi32((__m256i)a, (__m256i)b);
#endif
}
// a b − p, rounded once: for p the rounded product, the product's error, and exact.
SAGI_INLINE sagi_d4 sagi_d4_product_error(sagi_d4 a, sagi_d4 b, sagi_d4 p) {
    return (sagi_d4)_mm256_fmsub_pd(a, b, p);
}
SAGI_INLINE sagi_f8 sagi_f8_sqrt(sagi_f8 a) { return (sagi_f8)_mm256_sqrt_ps(a); }
SAGI_INLINE sagi_d4 sagi_d4_sqrt(sagi_d4 a) { return (sagi_d4)_mm256_sqrt_pd(a); }
SAGI_INLINE sagi_f4 sagi_f4_sqrt(sagi_f4 a) { return (sagi_f4)_mm_sqrt_ps((__m128)a); }
SAGI_INLINE sagi_f4 sagi_f4_max(sagi_f4 a, sagi_f4 b) { return (sagi_f4)_mm_max_ps((__m128)a, (__m128)b); }
SAGI_INLINE sagi_d4 sagi_d4_min(sagi_d4 a, sagi_d4 b) { return (sagi_d4)_mm256_min_pd(a, b); }
SAGI_INLINE sagi_d4 sagi_d4_max(sagi_d4 a, sagi_d4 b) { return (sagi_d4)_mm256_max_pd(a, b); }
// Whether no bit of the mask is set.
SAGI_INLINE bool sagi_i8_none(sagi_i8 a, sagi_i8 mask) {
    return _mm256_testz_si256((__m256i)a, (__m256i)mask) != 0;
}
// Three numbers; the fourth lane holds anything.
SAGI_INLINE sagi_d4 sagi_d4_load3(const double *p) {
    return (sagi_d4)_mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_loadu_pd(p)), _mm_load_sd(p + 2), 1);
}
SAGI_INLINE sagi_d4 sagi_d4_load3_float(const float *p) {
    __m128 xy = _mm_castsi128_ps(_mm_loadl_epi64((const __m128i *)(const void *)p));
    return (sagi_d4)_mm256_cvtps_pd(_mm_movelh_ps(xy, _mm_load_ss(p + 2)));
}
SAGI_INLINE sagi_d4 sagi_d4_load4_float(const float *p) { return (sagi_d4)_mm256_cvtps_pd(_mm_loadu_ps(p)); }
// (a₀ + a₁) + a₂. (By lanes, GCC takes a way through memory.)
SAGI_INLINE double sagi_d4_sum3(sagi_d4 a) {
    __m128d xy = _mm256_castpd256_pd128((__m256d)a);
    xy = _mm_add_sd(xy, _mm_unpackhi_pd(xy, xy));
    return _mm_cvtsd_f64(_mm_add_sd(xy, _mm256_extractf128_pd((__m256d)a, 1)));
}
// The last two lanes first, then the first two.
SAGI_INLINE sagi_d4 sagi_d4_turn(sagi_d4 a) {
    return (sagi_d4)_mm256_permute2f128_pd((__m256d)a, (__m256d)a, 1);
}
SAGI_INLINE double sagi_d4_first(sagi_d4 a) { return _mm_cvtsd_f64(_mm256_castpd256_pd128((__m256d)a)); }
SAGI_INLINE sagi_f4 sagi_d4_to_f4(sagi_d4 a) { return (sagi_f4)_mm256_cvtpd_ps(a); }
SAGI_INLINE sagi_d4 sagi_f4_to_d4(sagi_f4 a) { return (sagi_d4)_mm256_cvtps_pd(a); }
// a b + c, as above.
SAGI_INLINE sagi_d4 sagi_d4_fma(sagi_d4 a, sagi_d4 b, sagi_d4 c) { return (sagi_d4)_mm256_fmadd_pd(a, b, c); }
// Two rows of eight whole numbers, each plus 2²³: that number is what the bits of a float with the exponent
// of 2²³ say. p, aligned to 32 bytes: four of the first row, four of the second, and the same again.
// `high` is SAGI_ROWS_HIGH, whose bits are those of the upper half of 2²³, twice.
#define SAGI_ROWS_PLUS 0x1p23F
#define SAGI_ROWS_HIGH (0x1p23F + 0x4B00)
SAGI_INLINE void sagi_f8_rows(const uint16_t p[16], float high, sagi_f8 *first, sagi_f8 *second) {
    const __m256i rows = _mm256_load_si256((const __m256i *)(const void *)p);
    const __m256i upper = _mm256_castps_si256(_mm256_set1_ps(high));
    *first = (sagi_f8)_mm256_unpacklo_epi16(rows, upper);
    *second = (sagi_f8)_mm256_unpackhi_epi16(rows, upper);
}
SAGI_INLINE sagi_f8 sagi_f8_from_h8(const uint16_t p[8]) { // of any alignment
    __m128i h = _mm_loadu_si128((const __m128i *)(const void *)p);
    return (sagi_f8)_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(h));
}
// Four whole numbers below 2¹⁶, side by side.
SAGI_INLINE uint64_t sagi_d4_to_h4(sagi_d4 a) {
    typedef uint16_t four_short __attribute__((vector_size(8)));
    return (uint64_t) __builtin_convertvector(__builtin_convertvector(a, sagi_w4), four_short);
}
// The first lane of a mask is bit 0.
SAGI_INLINE uint32_t sagi_i8_mask(sagi_i8 a) {
    return (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps((__m256i)a));
}
SAGI_INLINE uint32_t sagi_d4_signs(sagi_d4 a) { return (uint32_t)_mm256_movemask_pd((__m256d)a); }
// Each of the first three of four numbers, which stand at a multiple of 16 bytes, in all lanes: by one load
// and three permutations, for where it is loads that there are most of.
SAGI_INLINE void sagi_same_fill3(const sagi_f4 *a, sagi_same out[3]) {
    __m256 twice = _mm256_broadcast_ps((const __m128 *)(const void *)a);
    __asm__("" : "+x"(twice)); // or the compiler would load them one by one after all
    out[0] = (sagi_f8)_mm256_permute_ps(twice, 0x00), out[1] = (sagi_f8)_mm256_permute_ps(twice, 0x55);
    out[2] = (sagi_f8)_mm256_permute_ps(twice, 0xaa);
}
// The same from a register, of four numbers that are there twice where a register has room for eight.
typedef sagi_f8 sagi_f4s;
typedef sagi_i8 sagi_w4s;
SAGI_INLINE sagi_f4s sagi_f4s_of(sagi_f4 a) { return (sagi_f4s)_mm256_set_m128((__m128)a, (__m128)a); }
SAGI_INLINE sagi_f4s sagi_f4s_fill(float x) { return (sagi_f4s){x, x, x, x, x, x, x, x}; }
// a, which has no sign, with the sign of b.
SAGI_INLINE sagi_f4s sagi_f4s_signed(sagi_f4s a, sagi_f4s b) {
#ifdef SAGI_SIMD_AVX512
    const __m256i rest = _mm256_set1_epi32(INT32_MAX);
    return (sagi_f4s)_mm256_ternarylogic_epi32((__m256i)a, (__m256i)b, rest, 0xf4); // a | (b & ~rest)
#else
    return (sagi_f4s)((sagi_w4s)a | ((sagi_w4s)b & INT32_MIN));
#endif
}
SAGI_INLINE sagi_f4 sagi_f4s_once(sagi_f4s a) { return (sagi_f4)_mm256_castps256_ps128((__m256)a); }
SAGI_INLINE sagi_f4s sagi_f4s_fma(sagi_f4s a, sagi_f4s b, sagi_f4s c) { return sagi_f8_fma(a, b, c); }
SAGI_INLINE void sagi_f4s_spread3(sagi_f4s a, sagi_same out[3]) {
    out[0] = (sagi_f8)_mm256_permute_ps((__m256)a, 0x00),
    out[1] = (sagi_f8)_mm256_permute_ps((__m256)a, 0x55);
    out[2] = (sagi_f8)_mm256_permute_ps((__m256)a, 0xaa);
}
SAGI_INLINE void sagi_f4_spread3(sagi_f4 a, sagi_same out[3]) { sagi_f4s_spread3(sagi_f4s_of(a), out); }
// The least of eight whole numbers without a sign.
SAGI_INLINE __m128i sagi_i8_least_lane(sagi_i8 a) {
    __m128i m = _mm_min_epu32(_mm256_castsi256_si128((__m256i)a), _mm256_extracti128_si256((__m256i)a, 1));
    m = _mm_min_epu32(m, _mm_shuffle_epi32(m, 0x4e));
    return _mm_min_epu32(m, _mm_shuffle_epi32(m, 0xb1));
}
SAGI_INLINE uint32_t sagi_i8_least(sagi_i8 a) { return (uint32_t)_mm_cvtsi128_si32(sagi_i8_least_lane(a)); }
// The same, and that one of eight numbers, aligned to 32 bytes, which its last three bits say. (From
// registers: by way of memory it comes two cycles later.)
SAGI_INLINE uint32_t sagi_i8_least_from(sagi_i8 a, const uint32_t from[8], uint32_t *chosen) {
    const __m128i m = sagi_i8_least_lane(a);
#ifdef SAGI_SIMD_AVX512
    const __m128i *half = (const __m128i *)(const void *)from;
    *chosen = (uint32_t)_mm_cvtsi128_si32(_mm_permutex2var_epi32(half[0], m, half[1]));
#else
    const __m256i all = _mm256_load_si256((const __m256i *)(const void *)from);
    *chosen = (uint32_t)_mm_cvtsi128_si32(
        _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(all, _mm256_castsi128_si256(m))));
#endif
    return (uint32_t)_mm_cvtsi128_si32(m);
}

// Writes the lanes in the mask of two vectors, in order, one after the other to p and q, each of which must
// have room for eight.
#ifndef SAGI_SIMD_AVX512
// Row m: the numbers of the bits set in m, a byte each, in order.
#define SAGI_BIT(m, i)   ((uint64_t)((m) >> (i)&1))
#define SAGI_BELOW(m, i) __builtin_popcount((m) & ((1 << (i)) - 1))
#define SAGI_PUT(m, i)   (SAGI_BIT(m, i) * (i) << (8 * (SAGI_BELOW(m, i) & 7)))
#define SAGI_ROW(m)                                                                                          \
    (SAGI_PUT(m, 1) | SAGI_PUT(m, 2) | SAGI_PUT(m, 3) | SAGI_PUT(m, 4) | SAGI_PUT(m, 5) | SAGI_PUT(m, 6) |   \
     SAGI_PUT(m, 7))
#define SAGI_ROWS4(m)  SAGI_ROW(m), SAGI_ROW((m) + 1), SAGI_ROW((m) + 2), SAGI_ROW((m) + 3)
#define SAGI_ROWS16(m) SAGI_ROWS4(m), SAGI_ROWS4((m) + 4), SAGI_ROWS4((m) + 8), SAGI_ROWS4((m) + 12)
#define SAGI_ROWS64(m) SAGI_ROWS16(m), SAGI_ROWS16((m) + 16), SAGI_ROWS16((m) + 32), SAGI_ROWS16((m) + 48)
static const uint64_t sagi_bits_set[256] = {SAGI_ROWS64(0), SAGI_ROWS64(64), SAGI_ROWS64(128),
                                            SAGI_ROWS64(192)};
#endif
SAGI_INLINE void sagi_write_lanes(uint32_t mask, sagi_f8 a, float *p, sagi_i8 b, uint32_t *q) {
#if defined(SAGI_SIMD_AVX512)
    _mm256_storeu_ps(p, _mm256_maskz_compress_ps((__mmask8)mask, (__m256)a));
    _mm256_storeu_si256((__m256i *)(void *)q, _mm256_maskz_compress_epi32((__mmask8)mask, (__m256i)b));
#else
    __m256i way = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)&sagi_bits_set[mask]));
    _mm256_storeu_ps(p, _mm256_permutevar8x32_ps((__m256)a, way));
    _mm256_storeu_si256((__m256i *)(void *)q, _mm256_permutevar8x32_epi32((__m256i)b, way));
#endif
}

// The same, as pairs: b's lanes in the lower halves of whole numbers, a's bits in the upper ones.
SAGI_INLINE void sagi_write_pairs(uint32_t mask, sagi_f8 a, sagi_i8 b, uint64_t *p) {
#if defined(SAGI_SIMD_AVX512)
    __m256i upper = _mm256_maskz_compress_epi32((__mmask8)mask, (__m256i)a);
    __m256i lower = _mm256_maskz_compress_epi32((__mmask8)mask, (__m256i)b);
#else
    __m256i way = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)&sagi_bits_set[mask]));
    __m256i upper = _mm256_permutevar8x32_epi32((__m256i)a, way);
    __m256i lower = _mm256_permutevar8x32_epi32((__m256i)b, way);
#endif
    __m256i even = _mm256_unpacklo_epi32(lower, upper), odd = _mm256_unpackhi_epi32(lower, upper);
    _mm256_storeu_si256((__m256i *)(void *)p, _mm256_permute2x128_si256(even, odd, 0x20));
    _mm256_storeu_si256((__m256i *)(void *)(p + 4), _mm256_permute2x128_si256(even, odd, 0x31));
}

#endif
