// SPDX-License-Identifier: MIT
// The first two Sobol' dimensions and Owen's scrambling: what both pictures and measurements draw their
// points with.
//
// The two dimensions together are a (0, 2)-sequence: every 2ᵏ points from a multiple of 2ᵏ on lie one in each
// of the 2ᵏ boxes of size 2⁻ᵃ × 2⁻ᵇ, a + b = k. Owen's scrambling flips each bit of a coordinate by a hash of
// the bits above it, which keeps that property and makes the points random; Laine and Karras' hash does all
// 32 bits at once on the reversed number (Burley, JCGT 9(4), 2020; constants by Vegdahl).
#ifndef SAGI_MATH_SOBOL_H
#define SAGI_MATH_SOBOL_H

#include <stdint.h>

// The first dimension is the index reversed.
static inline uint32_t sagi_reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}
static inline uint64_t sagi_reverse_bits64(uint64_t x) {
    x = __builtin_bswap64(x);
    x = (x & UINT64_C(0x0F0F0F0F0F0F0F0F)) << 4 | (x >> 4 & UINT64_C(0x0F0F0F0F0F0F0F0F));
    x = (x & UINT64_C(0x3333333333333333)) << 2 | (x >> 2 & UINT64_C(0x3333333333333333));
    return (x & UINT64_C(0x5555555555555555)) << 1 | (x >> 1 & UINT64_C(0x5555555555555555));
}

// The second dimension, reversed. Its matrix is Pascal's triangle modulo 2: bit i (from the top) of the
// number is the sum of the index's bits j with C(j, i) odd, which by Lucas' theorem are those where j has all
// of i's ones. Such sums over supersets are had in one step for each of the five bits of j.
static inline uint32_t sagi_sobol_second_reversed(uint32_t index) {
    index ^= index >> 1 & 0x55555555u;
    index ^= index >> 2 & 0x33333333u;
    index ^= index >> 4 & 0x0F0F0F0Fu;
    index ^= index >> 8 & 0x00FF00FFu;
    return index ^ index >> 16;
}

// Owen's scramble of a number whose bits stand in reverse, as result and argument do: each bit changes by
// the bits below it only.
static inline uint32_t sagi_scramble_reversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

// Both of four numbers at once (tests/render/test_sampler).
typedef uint32_t sagi_u4 __attribute__((vector_size(16)));
static inline sagi_u4 sagi_reverse_bits4(sagi_u4 x) {
    x = x << 16 | x >> 16;
    x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}
static inline sagi_u4 sagi_scramble_reversed4(sagi_u4 x, sagi_u4 seed) {
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

#endif
