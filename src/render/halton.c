// SPDX-License-Identifier: MIT
// Halton's sequence (1960): number d of point i is i written in base p_d, the d-th prime, mirrored at the
// point: 0.i₀i₁i₂… Its first two dimensions, bases 2 and 3, place the sample on the film, as in pbrt: over a
// tile of 128×128 pixels, stretched to 2⁷ × 3⁵ cells, the points come down in an order in which every cell
// gets every 31104th one. The last 7 binary digits of such an index, mirrored, are the cell's column, the
// last 5 ternary ones its row, and the Chinese remainder theorem finds the index from both.
//
// Large bases need a remedy: their first points lie on few lines. Each digit is permuted, by one permutation
// for all points (randomization by permuted digits) or by one for each value of the digits above (Owen's).
// The permutations are the maps d ↦ m d + c modulo the base, m ≠ 0, which is enough for Owen's variance:
// where two different digits go, as a pair, is uniform (Matoušek, "On the L2-discrepancy for anchored boxes",
// 1998). m and c are hashed: nothing is stored. Tiles differ by their seeds. Dimensions for which the table
// of primes does not reach are independent numbers: points of such bases are no better.
#include "sampler.h"

#define PRIME_COUNT 128u

static const uint16_t primes[PRIME_COUNT] = {
    2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,  59,  61,  67,
    71,  73,  79,  83,  89,  97,  101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163,
    167, 173, 179, 181, 191, 193, 197, 199, 211, 223, 227, 229, 233, 239, 241, 251, 257, 263, 269,
    271, 277, 281, 283, 293, 307, 311, 313, 317, 331, 337, 347, 349, 353, 359, 367, 373, 379, 383,
    389, 397, 401, 409, 419, 421, 431, 433, 439, 443, 449, 457, 461, 463, 467, 479, 487, 491, 499,
    503, 509, 521, 523, 541, 547, 557, 563, 569, 571, 577, 587, 593, 599, 601, 607, 613, 617, 619,
    631, 641, 643, 647, 653, 659, 661, 673, 677, 683, 691, 701, 709, 719,
};

// The lowest `digits` digits of x in this base, mirrored.
static uint32_t mirror(uint32_t x, uint32_t base, uint32_t digits) {
    uint32_t result = 0;
    for (uint32_t i = 0; i < digits; i++, x /= base) result = result * base + x % base;
    return result;
}

uint64_t sagi_halton_first(uint32_t x, uint32_t y) {
    const uint32_t column = mirror(x & 127, 2, 7), row = mirror(y & 127, 3, 5);
    // 243·59 is 1 modulo 128, 128·131 is 1 modulo 243.
    const uint64_t within = (column * UINT64_C(243) * 59 + row * UINT64_C(128) * 131) % SAGI_HALTON_STRIDE;
    const uint64_t tile = (uint64_t)(y >> 7) << 16 | x >> 7;
    return tile << SAGI_HALTON_BITS | within;
}

// The mirrored number to the last digit above 2⁻³⁴.
static double mirrored(uint64_t index, uint32_t base) {
    double result = 0, scale = 1;
    while (index != 0 && scale > 0x1p-34) {
        const uint64_t rest = index / base;
        scale /= base;
        result += (double)(index - rest * base) * scale;
        index = rest;
    }
    return result;
}

sag_vec2 sagi_halton_pixel(uint64_t index) {
    return (sag_vec2){mirrored(index >> 7, 2), mirrored(index / 243, 3)};
}

double sagi_halton_number(const sagi_sampler *sampler, uint32_t dimension) {
    const sagi_sampler_plan *plan = sampler->plan;
    const uint64_t tile = sampler->key >> SAGI_HALTON_BITS;
    const uint64_t seed =
        sagi_mix((plan->seed ^ (dimension + UINT64_C(1)) * UINT64_C(0xD1342543DE82EF95)) + tile);
    uint64_t index = sampler->index;
    if (dimension >= PRIME_COUNT) return (double)(sagi_mix(seed + index) >> 11) * 0x1p-53;
    const uint32_t base = primes[dimension];
    if (plan->randomization == SAG_RANDOMIZATION_NONE) return mirrored(index, base);
    const bool owen = plan->randomization == SAG_RANDOMIZATION_OWEN;
    uint64_t above = 0;
    double result = 0, scale = 1;
    while (scale > 0x1p-34) {
        const uint64_t rest = index / base;
        const uint32_t digit = (uint32_t)(index - rest * base);
        const uint64_t random = sagi_mix(seed + above);
        const uint32_t m = 1 + (uint32_t)((random >> 32) * (base - 1) >> 32);
        const uint32_t c = (uint32_t)((random & 0xFFFFFFFFu) * base >> 32);
        const uint32_t permuted = (m * digit + c) % base;
        // What names the next digit's permutation: the digits so far, or how many they are.
        above = owen ? above * base + digit + 1 : above + 1;
        scale /= base;
        result += permuted * scale;
        index = rest;
    }
    return result < 1 - 0x1p-33 ? result : 1 - 0x1p-33;
}
