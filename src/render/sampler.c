// SPDX-License-Identifier: MIT
// Samplers, all without state.
//
// Independent. sagi_mix is a bijection whose outputs for consecutive counters pass the usual batteries
// (SplitMix64's finaliser with Stafford's constants). The counter is (sample, dimension) times an odd
// constant plus the pixel's key, so within a pixel no two counters meet.
//
// Stratified. In dimension d the strata are visited in the order of a permutation of [0, count) named by
// (pixel, d): Kensler's hash ("Correlated Multi-Jittered Sampling", 2013) is a bijection of the next power of
// two, walked until it lands in range. Nothing is stored.
//
// Sobol', padded. A number or pair of numbers uses the first one or two Sobol' dimensions (math/sobol.h) with
// Owen's scrambling. Each also shuffles the points' order, by the same kind of scramble of the index, so that
// pairs are unrelated (Burley, JCGT 9(4), 2020). The scramble acts on an index's low bits independently of
// its high bits: so only the bits that count − 1 has need be kept, and any 2ᵏ samples from a multiple of 2ᵏ
// on are a (0, k, 2)-net.
//
// Sobol', the sequence itself. In the same order of pixels and samples, shuffled once, but each number is of
// another dimension of the sequence (sobol_dimensions.c) as far as these reach, scrambled by itself; beyond,
// and for the order, see below. Of all that were tried it converges best where a pixel has many samples
// (Cornell's box, 64 samples: 3 % less variance than z-ordered pairs, 12 % less over 2×2 pixels; 12 % and
// 26 % less than padded ones), as more than two dimensions at a time are spread evenly; with few samples all
// are alike. pbrt orders this sequence by the pixels its first two dimensions fall into; here they place the
// sample within its pixel, whose samples are thus a net.
//
// Sobol', z-ordered (Ahmed & Wonka, SIGGRAPH Asia 2020). All pixels share one sequence, in Morton's order:
// the index is the pixel's Morton code, then the sample's number, shuffled anew for each dimension by
// permuting each digit of base 4 by a hash of the digits above it. Each pixel's samples are still a net, and
// so are those of each 2×2, 4×4 … pixels: what one has too much of, a neighbour has too little, and the eye
// averages. Permuting digit by digit costs a hash for each; here all digits are permuted at once by Laine and
// Karras' way on the reversed code, where a multiplication lets each bit depend on those above it. That alone
// gives only the 8 of the 24 permutations of four digits that keep halves together; flipping a digit's
// upper bit where its own lower bit and the one of the digit above are set mixes the halves (the idea is
// Vegdahl's, "A Fast Hash for Base-4 Owen Scrambling", 2022). Done three times, all 24 come up about equally
// often (by a factor of 0.7 to 1.25; done twice, 0.65 to 1.6).
#include "sampler.h"

#define STEP UINT64_C(0xD1342543DE82EF95) // between dimensions' seeds

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

static void prepare_sums(sagi_sampler_plan *plan) {
    uint32_t columns[SAGI_SOBOL_DIMENSIONS][SAGI_SOBOL_COLUMNS];
    sagi_sobol_columns(columns);
    for (uint32_t d = 0; d < SAGI_SOBOL_DIMENSIONS; d++)
        for (uint32_t byte = 0; byte < SAGI_SOBOL_COLUMNS / 8; byte++)
            for (uint32_t i = 1; i < 256; i++) // the lowest one, and the rest
                plan->sums[d / 4][byte][i][d % 4] = plan->sums[d / 4][byte][i & (i - 1)][d % 4] ^
                                                    columns[d][8 * byte + (uint32_t)__builtin_ctz(i)];
}

sag_status sagi_sampler_plan_init(sagi_sampler_plan *plan, const sag_settings *settings, sag_error *error) {
    const uint32_t count = settings->samples_per_pixel;
    const bool halton = settings->sampler == SAG_SAMPLER_HALTON;
    if (count == 0) return sag_error_set(error, SAG_ERROR_ARGUMENT, "samples_per_pixel is 0");
    if (count > UINT32_C(1) << 31)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "%u samples per pixel are more than 2^31", count);
    *plan = (sagi_sampler_plan){.kind = settings->sampler,
                                .randomization = settings->randomization,
                                .jitter = !settings->no_jitter,
                                .count = count,
                                .seed = sagi_mix(settings->seed + 1),
                                .x_count = 1};
    if (plan->randomization == SAG_RANDOMIZATION_DEFAULT)
        plan->randomization = halton ? SAG_RANDOMIZATION_PERMUTE_DIGITS : SAG_RANDOMIZATION_FAST_OWEN;
    if (halton && plan->randomization == SAG_RANDOMIZATION_FAST_OWEN)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "Halton's points have no fast Owen scrambling");
    if ((uint64_t)settings->strata_x * settings->strata_y == count) {
        plan->x_count = settings->strata_x;
    } else { // the most nearly square grid
        for (uint32_t x = 1; (uint64_t)x * x <= count; x++)
            if (count % x == 0) plan->x_count = x;
    }
    plan->y_count = count / plan->x_count;
    while (((UINT64_C(1) << plan->sample_bits) - 1) < count - 1) plan->sample_bits++;
    plan->index_mask = (uint32_t)((UINT64_C(1) << plan->sample_bits) - 1);
    // An odd number of bits leaves half a digit, which is scrambled as a bit.
    plan->digit_mask = UINT64_C(0x5555555555555555) & ((UINT64_C(1) << (32 + (plan->sample_bits & 30u))) - 1);
    for (uint32_t i = 0; i < SAGI_SEEDED_DIMENSIONS; i++)
        plan->seeds[i] = sagi_mix(plan->seed ^ (i + UINT64_C(1)) * STEP);
    if (plan->kind != SAG_SAMPLER_SOBOL) return SAG_OK;
    prepare_sums(plan);
    for (uint32_t d = 0; d < SAGI_SOBOL_DIMENSIONS; d++)
        plan->scrambles[d / 4][d % 4] = (uint32_t)(plan->seeds[d] >> 32);
    return SAG_OK;
}

// The reversed code with its digits permuted, as an index.
static inline uint64_t shuffled_code(const sagi_sampler_plan *plan, uint64_t x, uint64_t seed) {
    x ^= x * UINT64_C(0x9FB21C653D20ADEA);
    x ^= x >> 1 & x << 1 & plan->digit_mask;
    x += seed;
    x *= seed >> 32 | 1;
    x ^= x >> 1 & x << 1 & plan->digit_mask;
    x ^= x * UINT64_C(0xD6E8FEB805526C56);
    x ^= x >> 1 & x << 1 & plan->digit_mask;
    x ^= x * UINT64_C(0xA0761D6453A22864);
    return sagi_reverse_bits64(x) >> (32 - plan->sample_bits);
}

// Every second bit of the result is a bit of x.
static uint32_t spread_bits(uint32_t x) {
    x = (x | x << 8) & 0x00FF00FFu;
    x = (x | x << 4) & 0x0F0F0F0Fu;
    x = (x | x << 2) & 0x33333333u;
    return (x | x << 1) & 0x55555555u;
}

void sagi_sampler_start_pixel(sagi_sampler *sampler, uint32_t x, uint32_t y) {
    const sagi_sampler_plan *plan = sampler->plan;
    switch (plan->kind) {
    case SAG_SAMPLER_INDEPENDENT:
    case SAG_SAMPLER_STRATIFIED:
    case SAG_SAMPLER_PADDED_SOBOL: sampler->key = sagi_sampler_hash(plan, x, y); break;
    case SAG_SAMPLER_SOBOL:
    case SAG_SAMPLER_ZSOBOL:
        sampler->key = sagi_reverse_bits(spread_bits(y & 0xFFFF) << 1 | spread_bits(x & 0xFFFF));
        break;
    case SAG_SAMPLER_HALTON: sampler->key = sagi_halton_first(x, y); break;
    }
}

void sagi_sampler_start_sample(sagi_sampler *sampler, uint32_t sample) {
    const sagi_sampler_plan *plan = sampler->plan;
    sampler->sample = sample;
    sampler->dimension = 0;
    sampler->ready_block = UINT32_MAX;
    switch (plan->kind) {
    case SAG_SAMPLER_INDEPENDENT:
    case SAG_SAMPLER_STRATIFIED: break;
    case SAG_SAMPLER_PADDED_SOBOL: sampler->index = sagi_reverse_bits(sample); break;
    case SAG_SAMPLER_SOBOL:
    case SAG_SAMPLER_ZSOBOL: { // the code reversed: the pixel's digits, then the sample's
        const uint32_t digits = (uint32_t)((uint64_t)sample << (32 - plan->sample_bits));
        sampler->index = sampler->key | (uint64_t)sagi_reverse_bits(digits) << 32;
        if (plan->kind == SAG_SAMPLER_SOBOL)
            sampler->true_index = shuffled_code(plan, sampler->index, plan->seed);
        break;
    }
    case SAG_SAMPLER_HALTON:
        sampler->index = (sampler->key & ((1u << SAGI_HALTON_BITS) - 1)) + sample * SAGI_HALTON_STRIDE;
        sampler->dimension = 2;
        break;
    }
}

// 64 bits for a dimension, the same for all pixels.
static inline uint64_t seed_of(const sagi_sampler_plan *plan, uint32_t dimension) {
    return dimension < SAGI_SEEDED_DIMENSIONS ? plan->seeds[dimension]
                                              : sagi_mix(plan->seed ^ (dimension + UINT64_C(1)) * STEP);
}

// Owen's scrambling bit by bit, of a reversed number: each bit is flipped by a hash of those below it.
static uint32_t scramble_exactly(uint32_t x, uint32_t seed) {
    uint32_t result = x;
    for (uint32_t i = 0; i < 32; i++) {
        const uint64_t below = x & ((UINT64_C(1) << i) - 1);
        result ^= (uint32_t)(sagi_mix((uint64_t)seed << 32 ^ below ^ (uint64_t)i << 58) >> 40 & 1) << i;
    }
    return result;
}

static inline uint32_t scramble(sag_randomization way, uint32_t reversed, uint32_t seed) {
    switch (way) {
    case SAG_RANDOMIZATION_DEFAULT:
    case SAG_RANDOMIZATION_FAST_OWEN: break;
    case SAG_RANDOMIZATION_NONE: return reversed;
    case SAG_RANDOMIZATION_PERMUTE_DIGITS: return reversed ^ seed;
    case SAG_RANDOMIZATION_OWEN: return scramble_exactly(reversed, seed);
    }
    return sagi_scramble_reversed(reversed, seed);
}

// The index, before this dimension's shuffle, in Sobol's sequence; *seeds scramble the numbers.
static inline uint64_t sobol_index(const sagi_sampler *sampler, uint64_t *seeds) {
    const sagi_sampler_plan *plan = sampler->plan;
    const uint64_t seed = seed_of(plan, sampler->dimension);
    if (plan->kind == SAG_SAMPLER_PADDED_SOBOL) {
        const uint64_t own = sagi_mix(sampler->key ^ seed);
        *seeds = own;
        const uint32_t order = (uint32_t)(own * STEP >> 32);
        return sagi_reverse_bits(sagi_scramble_reversed((uint32_t)sampler->index, order)) & plan->index_mask;
    }
    *seeds = seed * STEP ^ seed >> 29;
    return shuffled_code(plan, sampler->index, seed);
}

// The sums of the columns of the index's ones in four dimensions, eight columns at a time. Four bytes at
// least are the pixel's.
static inline sagi_u4 sums_of(const sagi_u4 (*sums)[256], uint64_t index) {
    sagi_u4 x = sums[0][index & 255] ^ sums[1][index >> 8 & 255] ^ sums[2][index >> 16 & 255] ^
                sums[3][index >> 24 & 255];
    for (index >>= 32, sums += 4; index != 0; index >>= 8) x ^= (*sums++)[index & 255];
    return x;
}

static sagi_u4 scramble_slowly(sag_randomization way, sagi_u4 x, sagi_u4 seed) {
    for (int i = 0; i < 4; i++) x[i] = scramble(way, x[i], seed[i]);
    return x;
}

// The numbers of Sobol's point in eight dimensions of its own. (Two of one are under way at a time.)
static void make_ready(sagi_sampler *sampler, uint32_t block) {
    const sagi_sampler_plan *plan = sampler->plan;
    const uint64_t index = sampler->true_index;
    const sag_randomization way = plan->randomization;
    const sagi_u4 *seed = &plan->scrambles[2 * block];
    sagi_u4 x = sums_of(plan->sums[2 * block], index), y = sums_of(plan->sums[2 * block + 1], index);
    if (way == SAG_RANDOMIZATION_FAST_OWEN)
        x = sagi_scramble_reversed4(x, seed[0]), y = sagi_scramble_reversed4(y, seed[1]);
    else
        x = scramble_slowly(way, x, seed[0]), y = scramble_slowly(way, y, seed[1]);
    sampler->ready[0] = sagi_reverse_bits4(x), sampler->ready[1] = sagi_reverse_bits4(y);
    sampler->ready_block = block;
}

// Whether the next number is of a dimension of its own; then it is made ready.
static bool is_ready(sagi_sampler *sampler) {
    if (sampler->plan->kind != SAG_SAMPLER_SOBOL || sampler->dimension >= SAGI_SOBOL_DIMENSIONS) return false;
    if (sampler->ready_block != sampler->dimension / 8) make_ready(sampler, sampler->dimension / 8);
    return true;
}
_Static_assert(SAGI_SOBOL_DIMENSIONS % 8 == 0 && SAGI_SOBOL_DIMENSIONS <= SAGI_SEEDED_DIMENSIONS,
               "whole blocks, with seeds");

double sagi_sampler_draw_1d(sagi_sampler *sampler) {
    const sagi_sampler_plan *plan = sampler->plan;
    if (is_ready(sampler)) return sagi_sampler_1d(sampler);
    double result = 0;
    switch (plan->kind) {
    case SAG_SAMPLER_INDEPENDENT:
        result = (double)(int64_t)(sagi_sampler_bits(sampler) >> 11) * 0x1p-53;
        break;
    case SAG_SAMPLER_STRATIFIED: {
        const uint64_t order = sagi_mix(sampler->key ^ seed_of(plan, sampler->dimension));
        const uint32_t stratum = sagi_permute(sampler->sample, plan->count, (uint32_t)order);
        const double within = plan->jitter ? sagi_unit_of(sagi_sampler_bits(sampler) >> 32) : 0.5;
        result = (stratum + within) / plan->count;
        break;
    }
    case SAG_SAMPLER_SOBOL:
    case SAG_SAMPLER_PADDED_SOBOL:
    case SAG_SAMPLER_ZSOBOL: {
        uint64_t seeds;
        const uint32_t index = (uint32_t)sobol_index(sampler, &seeds);
        result =
            sagi_unit_of(sagi_reverse_bits(scramble(plan->randomization, index, (uint32_t)(seeds >> 32))));
        break;
    }
    case SAG_SAMPLER_HALTON: result = sagi_halton_number(sampler, sampler->dimension); break;
    }
    sampler->dimension++;
    return result;
}

sag_vec2 sagi_sampler_draw_2d(sagi_sampler *sampler) {
    const sagi_sampler_plan *plan = sampler->plan;
    if (sampler->dimension + 1 < SAGI_SOBOL_DIMENSIONS && is_ready(sampler)) {
        const double x = sagi_sampler_1d(sampler);
        return (sag_vec2){x, sagi_sampler_1d(sampler)};
    }
    sag_vec2 result = {0, 0};
    switch (plan->kind) {
    case SAG_SAMPLER_INDEPENDENT: {
        const uint64_t random = sagi_sampler_bits(sampler);
        result = (sag_vec2){sagi_unit_of(random >> 32), sagi_unit_of(random & 0xFFFFFFFFu)};
        break;
    }
    case SAG_SAMPLER_STRATIFIED: {
        const uint64_t random = sagi_sampler_bits(sampler);
        const uint64_t order = sagi_mix(sampler->key ^ seed_of(plan, sampler->dimension));
        const uint32_t stratum = sagi_permute(sampler->sample, plan->count, (uint32_t)order);
        const uint32_t y = stratum / plan->x_count, x = stratum - y * plan->x_count;
        result.x = (x + (plan->jitter ? sagi_unit_of(random >> 32) : 0.5)) / plan->x_count;
        result.y = (y + (plan->jitter ? sagi_unit_of(random & 0xFFFFFFFFu) : 0.5)) / plan->y_count;
        break;
    }
    case SAG_SAMPLER_SOBOL:
    case SAG_SAMPLER_PADDED_SOBOL:
    case SAG_SAMPLER_ZSOBOL: {
        uint64_t seeds;
        const uint64_t index = sobol_index(sampler, &seeds);
        const uint32_t second = sagi_sobol_second_reversed((uint32_t)index ^ (uint32_t)(index >> 32));
        const uint32_t x = scramble(plan->randomization, (uint32_t)index, (uint32_t)(seeds >> 32));
        const uint32_t y = scramble(plan->randomization, second, (uint32_t)seeds);
        const uint64_t both = sagi_reverse_bits64((uint64_t)y << 32 | x);
        result = (sag_vec2){sagi_unit_of(both >> 32), sagi_unit_of(both & 0xFFFFFFFFu)};
        break;
    }
    case SAG_SAMPLER_HALTON:
        result.x = sagi_halton_number(sampler, sampler->dimension++);
        result.y = sagi_halton_number(sampler, sampler->dimension);
        break;
    }
    sampler->dimension++;
    return result;
}

sag_vec2 sagi_sampler_pixel(sagi_sampler *sampler) {
    if (sampler->plan->kind == SAG_SAMPLER_HALTON) return sagi_halton_pixel(sampler->index);
    return sagi_sampler_2d(sampler);
}
