// SPDX-License-Identifier: MIT
// Four floats at once, for the builder's inner loops: a box's corner is three and takes one register. SSE
// where there is, which every 64-bit x86 has; else plain loops, with the same results.
#ifndef SAGI_BVH_LANES_H
#define SAGI_BVH_LANES_H

#ifdef __SSE2__
#include <emmintrin.h>

typedef __m128 sagi_lanes;

static inline sagi_lanes sagi_lanes_load(const void *p) { return _mm_loadu_ps((const float *)p); }
static inline sagi_lanes sagi_lanes_fill(float x) { return _mm_set1_ps(x); }
static inline void sagi_lanes_store(float *p, sagi_lanes a) { _mm_storeu_ps(p, a); }
static inline sagi_lanes sagi_lanes_add(sagi_lanes a, sagi_lanes b) { return _mm_add_ps(a, b); }
static inline sagi_lanes sagi_lanes_sub(sagi_lanes a, sagi_lanes b) { return _mm_sub_ps(a, b); }
static inline sagi_lanes sagi_lanes_mul(sagi_lanes a, sagi_lanes b) { return _mm_mul_ps(a, b); }
static inline sagi_lanes sagi_lanes_min(sagi_lanes a, sagi_lanes b) { return _mm_min_ps(a, b); }
static inline sagi_lanes sagi_lanes_max(sagi_lanes a, sagi_lanes b) { return _mm_max_ps(a, b); }
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
// Rounded towards 0. Only the first three lanes are numbers for certain; the fourth gives 0.
static inline void sagi_lanes_to_int(int *p, sagi_lanes a) {
    for (int k = 0; k < 3; k++) p[k] = (int)a.at[k];
    p[3] = 0;
}

#endif
#endif
