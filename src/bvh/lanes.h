// SPDX-License-Identifier: MIT
// Four floats at once, for the builder's inner loops: a box's corner is three and takes one register. SSE
// where there is, which every 64-bit x86 has; else plain loops, with the same results.
#ifndef SAGI_BVH_LANES_H
#define SAGI_BVH_LANES_H

#include <stdbool.h>
#ifdef __SSE2__
#include <emmintrin.h>

typedef __m128 sagi_lanes;

static inline sagi_lanes sagi_lanes_load(const void *p) { return _mm_loadu_ps((const float *)p); }
// Three floats; the fourth lane is 0.
static inline sagi_lanes sagi_lanes_load3(const float *p) {
    return _mm_movelh_ps(_mm_unpacklo_ps(_mm_load_ss(p), _mm_load_ss(p + 1)), _mm_load_ss(p + 2));
}
static inline sagi_lanes sagi_lanes_fill(float x) { return _mm_set1_ps(x); }
static inline void sagi_lanes_store(float *p, sagi_lanes a) { _mm_storeu_ps(p, a); }
static inline sagi_lanes sagi_lanes_add(sagi_lanes a, sagi_lanes b) { return _mm_add_ps(a, b); }
static inline sagi_lanes sagi_lanes_sub(sagi_lanes a, sagi_lanes b) { return _mm_sub_ps(a, b); }
static inline sagi_lanes sagi_lanes_mul(sagi_lanes a, sagi_lanes b) { return _mm_mul_ps(a, b); }
static inline sagi_lanes sagi_lanes_min(sagi_lanes a, sagi_lanes b) { return _mm_min_ps(a, b); }
static inline sagi_lanes sagi_lanes_max(sagi_lanes a, sagi_lanes b) { return _mm_max_ps(a, b); }
// Lane k of row i becomes lane i of row k.
static inline void sagi_lanes_transpose(sagi_lanes row[4]) {
    _MM_TRANSPOSE4_PS(row[0], row[1], row[2], row[3]);
}
// The fourth lane made 0.
static inline sagi_lanes sagi_lanes_clear(sagi_lanes a) {
    return _mm_and_ps(a, _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)));
}
static inline sagi_lanes sagi_lanes_abs(sagi_lanes a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
// Whether no lane's absolute value is above the limit; NaN is.
static inline bool sagi_lanes_within(sagi_lanes a, float limit) {
    return _mm_movemask_ps(_mm_cmple_ps(sagi_lanes_abs(a), _mm_set1_ps(limit))) == 15;
}
// (a − origin)·scale, calculated in double and rounded to nearest.
static inline sagi_lanes sagi_lanes_place(sagi_lanes a, const double origin[4], double scale) {
    __m128d low = _mm_cvtps_pd(a), high = _mm_cvtps_pd(_mm_movehl_ps(a, a)), by = _mm_set1_pd(scale);
    low = _mm_mul_pd(_mm_sub_pd(low, _mm_loadu_pd(origin)), by);
    high = _mm_mul_pd(_mm_sub_pd(high, _mm_loadu_pd(origin + 2)), by);
    return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
}
// Replaces the last three bits, 0 ≤ tag < 8.
static inline sagi_lanes sagi_lanes_tag(sagi_lanes a, int tag) {
    __m128i kept = _mm_and_si128(_mm_castps_si128(a), _mm_set1_epi32(~7));
    return _mm_castsi128_ps(_mm_or_si128(kept, _mm_set1_epi32(tag)));
}
// Rounded towards 0; what does not fit gives any number.
static inline void sagi_lanes_to_int(int *p, sagi_lanes a) {
    _mm_storeu_si128((__m128i *)(void *)p, _mm_cvttps_epi32(a));
}

#else
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct sagi_lanes {
    float at[4];
} sagi_lanes;

// (Whatever is there, floats or not.)
static inline sagi_lanes sagi_lanes_load(const void *p) {
    sagi_lanes a;
    memcpy(&a, p, sizeof a);
    return a;
}
// Three floats; the fourth lane is 0.
static inline sagi_lanes sagi_lanes_load3(const float *p) { return (sagi_lanes){{p[0], p[1], p[2], 0}}; }
static inline sagi_lanes sagi_lanes_fill(float x) { return (sagi_lanes){{x, x, x, x}}; }
static inline void sagi_lanes_store(float *p, sagi_lanes a) {
    for (int k = 0; k < 4; k++) p[k] = a.at[k];
}
static inline sagi_lanes sagi_lanes_add(sagi_lanes a, sagi_lanes b) {
    for (int k = 0; k < 4; k++) a.at[k] += b.at[k];
    return a;
}
static inline sagi_lanes sagi_lanes_sub(sagi_lanes a, sagi_lanes b) {
    for (int k = 0; k < 4; k++) a.at[k] -= b.at[k];
    return a;
}
static inline sagi_lanes sagi_lanes_mul(sagi_lanes a, sagi_lanes b) {
    for (int k = 0; k < 4; k++) a.at[k] *= b.at[k];
    return a;
}
static inline sagi_lanes sagi_lanes_min(sagi_lanes a, sagi_lanes b) {
    for (int k = 0; k < 4; k++) a.at[k] = a.at[k] < b.at[k] ? a.at[k] : b.at[k];
    return a;
}
static inline sagi_lanes sagi_lanes_max(sagi_lanes a, sagi_lanes b) {
    for (int k = 0; k < 4; k++) a.at[k] = a.at[k] > b.at[k] ? a.at[k] : b.at[k];
    return a;
}
// Replaces the last three bits, 0 ≤ tag < 8.
static inline sagi_lanes sagi_lanes_tag(sagi_lanes a, int tag) {
    for (int k = 0; k < 4; k++) {
        uint32_t bits;
        memcpy(&bits, &a.at[k], sizeof bits);
        bits = (bits & ~7u) | (uint32_t)tag;
        memcpy(&a.at[k], &bits, sizeof bits);
    }
    return a;
}
// Lane k of row i becomes lane i of row k.
static inline void sagi_lanes_transpose(sagi_lanes row[4]) {
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < i; k++) {
            float x = row[i].at[k];
            row[i].at[k] = row[k].at[i], row[k].at[i] = x;
        }
}
// The fourth lane made 0.
static inline sagi_lanes sagi_lanes_clear(sagi_lanes a) {
    a.at[3] = 0;
    return a;
}
static inline sagi_lanes sagi_lanes_abs(sagi_lanes a) {
    for (int k = 0; k < 4; k++) a.at[k] = fabsf(a.at[k]);
    return a;
}
// Whether no lane's absolute value is above the limit; NaN is.
static inline bool sagi_lanes_within(sagi_lanes a, float limit) {
    bool within = true;
    for (int k = 0; k < 4; k++) within &= fabsf(a.at[k]) <= limit;
    return within;
}
// (a − origin)·scale, calculated in double and rounded to nearest.
static inline sagi_lanes sagi_lanes_place(sagi_lanes a, const double origin[4], double scale) {
    for (int k = 0; k < 4; k++) a.at[k] = (float)(((double)a.at[k] - origin[k]) * scale);
    return a;
}
// Rounded towards 0. Only the first three lanes are numbers for certain; the fourth gives 0.
static inline void sagi_lanes_to_int(int *p, sagi_lanes a) {
    for (int k = 0; k < 3; k++) p[k] = (int)a.at[k];
    p[3] = 0;
}

#endif
#endif
