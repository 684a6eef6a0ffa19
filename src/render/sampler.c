// SPDX-License-Identifier: MIT
// Independent, stratified and Sobol' samples, all without state.
//
// Independent. sagi_mix is a bijection whose outputs for consecutive counters pass the usual batteries
// (SplitMix64's finaliser with Stafford's constants). The counter is (sample, dimension) times an odd
// constant plus the pixel's key, so within a pixel no two counters meet.
//
// Stratified. In dimension d the strata are visited in the order of a permutation of [0, count) named by
// (pixel, d): Kensler's hash ("Correlated Multi-Jittered Sampling", 2013) is a bijection of the next power of
// two, walked until it lands in range. Nothing is stored.
//
// Sobol'. A pair of dimensions uses the first two Sobol' dimensions with Owen's scrambling (math/sobol.h).
// Each pair also shuffles the points' order, by the same kind of scramble of the index, so that pairs are
// unrelated. The scramble acts on an index's low bits independently of its high bits: so only the bits that
// count − 1 has need be kept.
#include "sampler.h"

uint32_t sagi_permute(uint32_t index, uint32_t count, uint32_t seed) {
    uint32_t mask = count - 1;
    mask |= mask >> 1, mask |= mask >> 2, mask |= mask >> 4, mask |= mask >> 8, mask |= mask >> 16;
    do {
        index ^= seed;
        index *= 0xE170893Du;
        index ^= seed >> 16;
        index ^= (index & mask) >> 4;
        index ^= seed >> 8;
        index *= 0x0929EB3Fu;
        index ^= seed >> 23;
        index ^= (index & mask) >> 1;
        index *= 1 | seed >> 27;
        index *= 0x6935FA69u;
        index ^= (index & mask) >> 11;
        index *= 0x74DCB303u;
        index ^= (index & mask) >> 2;
        index *= 0x9E501CC3u;
        index ^= (index & mask) >> 2;
        index *= 0xC860A3DFu;
        index &= mask;
        index ^= index >> 5;
    } while (index >= count);
    return (uint32_t)(((uint64_t)index + seed) % count);
}

void sagi_sampler_init(sagi_sampler *sampler, sag_sampler_kind kind, uint64_t seed, uint32_t count) {
    *sampler = (sagi_sampler){.kind = kind, .count = count, .seed = sagi_mix(seed + 1), .x_count = 1};
    // The most nearly square grid of strata.
    for (uint32_t x = 1; (uint64_t)x * x <= count; x++)
        if (count % x == 0) sampler->x_count = x;
    sampler->y_count = count / sampler->x_count;
    uint32_t mask = count - 1;
    mask |= mask >> 1, mask |= mask >> 2, mask |= mask >> 4, mask |= mask >> 8, mask |= mask >> 16;
    sampler->index_mask = mask;
}

// 64 bits for this pixel and dimension, the same for all its samples.
static uint64_t dimension_bits(const sagi_sampler *sampler) {
    return sagi_mix(sampler->key ^ (sampler->dimension + UINT64_C(1)) * UINT64_C(0xD1342543DE82EF95));
}

double sagi_sampler_1d(sagi_sampler *sampler) {
    double result = 0;
    switch (sampler->kind) {
    case SAG_SAMPLER_INDEPENDENT: result = (double)(sagi_sampler_bits(sampler) >> 11) * 0x1p-53; break;
    case SAG_SAMPLER_STRATIFIED: {
        uint32_t stratum = sagi_permute(sampler->sample, sampler->count, (uint32_t)dimension_bits(sampler));
        result = (stratum + (double)(sagi_sampler_bits(sampler) >> 32) * 0x1p-32) / sampler->count;
        break;
    }
    case SAG_SAMPLER_SOBOL: {
        uint64_t seeds = dimension_bits(sampler);
        uint32_t index =
            sagi_reverse_bits(sagi_scramble_reversed(sagi_reverse_bits(sampler->sample), (uint32_t)seeds));
        // The first Sobol' dimension is the reversed index; its scramble wants the reverse of that.
        result =
            sagi_reverse_bits(sagi_scramble_reversed(index & sampler->index_mask, (uint32_t)(seeds >> 32))) *
            0x1p-32;
        break;
    }
    }
    sampler->dimension++;
    return result;
}

sag_vec2 sagi_sampler_2d(sagi_sampler *sampler) {
    sag_vec2 result = {0, 0};
    uint64_t random = 0;
    switch (sampler->kind) {
    case SAG_SAMPLER_INDEPENDENT:
        random = sagi_sampler_bits(sampler);
        result.x = (double)(random >> 32) * 0x1p-32;
        result.y = (double)(random & 0xFFFFFFFFu) * 0x1p-32;
        break;
    case SAG_SAMPLER_STRATIFIED: {
        random = sagi_sampler_bits(sampler);
        uint32_t stratum = sagi_permute(sampler->sample, sampler->count, (uint32_t)dimension_bits(sampler));
        uint32_t x = stratum % sampler->x_count, y = stratum / sampler->x_count;
        result.x = (x + (double)(random >> 32) * 0x1p-32) / sampler->x_count;
        result.y = (y + (double)(random & 0xFFFFFFFFu) * 0x1p-32) / sampler->y_count;
        break;
    }
    case SAG_SAMPLER_SOBOL: {
        uint64_t seeds = dimension_bits(sampler);
        uint64_t more = sagi_mix(seeds);
        uint32_t index =
            sagi_reverse_bits(sagi_scramble_reversed(sagi_reverse_bits(sampler->sample), (uint32_t)more));
        index &= sampler->index_mask;
        result.x = sagi_reverse_bits(sagi_scramble_reversed(index, (uint32_t)seeds)) * 0x1p-32;
        result.y = sagi_reverse_bits(sagi_scramble_reversed(sagi_reverse_bits(sagi_sobol_second(index)),
                                                            (uint32_t)(seeds >> 32))) *
                   0x1p-32;
        break;
    }
    }
    sampler->dimension++;
    return result;
}
