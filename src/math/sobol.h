// SPDX-License-Identifier: MIT
// The first two Sobol' dimensions and Owen's scrambling: what both pictures and measurements draw their points
// with.
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
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
    return x << 16 | x >> 16;
}

// The second; its direction numbers are 2³¹ and each from the one before by x ^ x/2.
static inline uint32_t sagi_sobol_second(uint32_t index) {
    uint32_t result = 0;
    for (uint32_t direction = 0x80000000u; index; index >>= 1, direction ^= direction >> 1)
        if (index & 1) result ^= direction;
    return result;
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

#endif
