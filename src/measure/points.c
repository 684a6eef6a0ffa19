// SPDX-License-Identifier: MIT
// Points that fill the unit square evenly, again and again.
//
// The first two Sobol' dimensions are a (0, 2)-sequence: every 2ᵏ points from a multiple of 2ᵏ on lie one in
// each of the 2ᵏ boxes of size 2⁻ᵃ × 2⁻ᵇ, a + b = k. Owen's scrambling flips each bit by a hash of the bits
// above it. It keeps that property and makes every point uniform in the square, so a mean over the points is
// an unbiased estimate of the integral; its error falls like N^-1.5 for smooth functions and about N^-0.75
// for an area with a smooth outline, where independent points have N^-0.5 (Owen, "Scrambled net variance for
// integrals of smooth functions", Annals of Statistics 25(4), 1997; He & Wang, "On the convergence rate of
// randomized quasi-Monte Carlo for discontinuous functions", SIAM J. Numer. Anal. 53(5), 2015).
//
// Laine and Karras' hash scrambles all 32 bits at once on the reversed number (Burley, JCGT 9(4), 2020;
// constants by Vegdahl). It is not quite uniform over its seeds, so a random digital shift goes on top, which
// makes each point exactly uniform over the cells of 2⁻³², and random bits below those within the cell.
#include "measure/measure.h"

static uint64_t mix(uint64_t x) { // SplitMix64's finaliser
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

uint64_t sagi_measure_hash(uint64_t seed, uint64_t a, uint64_t b) {
    return mix(mix(mix(seed + 0x9E3779B97F4A7C15u) + a * 0xD1342543DE82EF95u) + b * 0x9E3779B97F4A7C15u + 1);
}

static uint32_t reverse_bits(uint32_t x) {
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0F0F0F0Fu) << 4 | (x >> 4 & 0x0F0F0F0Fu);
    x = (x & 0x00FF00FFu) << 8 | (x >> 8 & 0x00FF00FFu);
    return x << 16 | x >> 16;
}

// Owen's scramble of a number whose bits stand in reverse: each bit changes by the bits below it only.
static uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= seed >> 16 | 1;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    return x;
}

// The second Sobol' dimension; its direction numbers are 2³¹ and each from the one before by x ^ x/2.
static uint32_t sobol_second(uint32_t index) {
    uint32_t result = 0;
    for (uint32_t direction = 0x80000000u; index; index >>= 1, direction ^= direction >> 1)
        if (index & 1) result ^= direction;
    return result;
}

// The digits, shifted, and 20 random bits below.
static double coordinate(uint32_t digits, uint32_t shift, uint64_t random) {
    return ((double)(digits ^ shift) + (double)(random & 0xFFFFFu) * 0x1p-20) * 0x1p-32;
}

sag_vec2 sagi_measure_point(uint64_t key, uint64_t index) {
    const uint64_t seeds = mix(key + 1), shifts = mix(key + 2), random = mix(key ^ mix(index + 3));
    const uint32_t i = (uint32_t)index;
    // The first dimension is the reversed index, and its scramble wants the reverse of that.
    const uint32_t x = reverse_bits(scramble_reversed(i, (uint32_t)seeds));
    const uint32_t y =
        reverse_bits(scramble_reversed(reverse_bits(sobol_second(i)), (uint32_t)(seeds >> 32)));
    return (sag_vec2){coordinate(x, (uint32_t)shifts, random),
                      coordinate(y, (uint32_t)(shifts >> 32), random >> 20)};
}
