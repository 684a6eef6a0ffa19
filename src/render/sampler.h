// SPDX-License-Identifier: MIT
// Random numbers as a pure function of seed, pixel, sample and dimension: no state is carried from one sample
// to the next, so a picture does not depend on the order, the threads or the machines that made it.
#ifndef SAGI_RENDER_SAMPLER_H
#define SAGI_RENDER_SAMPLER_H

#include "math/hash.h"
#include "math/sobol.h"
#include <sagitta/render.h>

// Dimensions whose seeds are kept at hand.
#define SAGI_SEEDED_DIMENSIONS 64u

// Sobol' dimensions that have columns, and how many columns, one for each bit of an index.
#define SAGI_SOBOL_DIMENSIONS 32u
#define SAGI_SOBOL_COLUMNS    64u

// What is the same for all pixels.
typedef struct sagi_sampler_plan {
    sag_sampler_kind kind;
    sag_randomization randomization; // never SAG_RANDOMIZATION_DEFAULT
    bool jitter;
    uint32_t count;            // samples per pixel
    uint32_t x_count, y_count; // strata of a pair; their product is count
    uint32_t index_mask;       // the least 2ᵏ − 1 ≥ count − 1
    uint32_t sample_bits;      // k
    uint64_t digit_mask;       // Z-order: the upper bit of each whole digit of the reversed code
    uint64_t seed;
    uint64_t seeds[SAGI_SEEDED_DIMENSIONS];
    // Sobol': what each byte of an index adds to the point, bit i being digit i; four dimensions in a row.
    sagi_u4 sums[SAGI_SOBOL_DIMENSIONS / 4][SAGI_SOBOL_COLUMNS / 8][256];
    sagi_u4 scrambles[SAGI_SOBOL_DIMENSIONS / 4]; // and their seeds
} sagi_sampler_plan;

typedef struct sagi_sampler {
    sagi_u4 ready[2]; // Sobol': this sample's numbers 8 ready_block … + 7, in 2⁻³²
    const sagi_sampler_plan *plan;
    uint64_t key;        // of the pixel: a hash; Z-order: where it stands; Halton: its first sample's index
    uint64_t index;      // of the sample among the sequence's points (reversed, but for Halton)
    uint64_t true_index; // Sobol': the index shuffled, for dimensions of their own
    uint32_t sample;     // of this pixel
    uint32_t dimension;  // of this sample: counts the calls (Halton, Sobol': the numbers)
    uint32_t ready_block;
} sagi_sampler;

// The part that is the same for all pixels. SAG_ERROR_ARGUMENT for no samples at all, more than 2³¹, or a
// sampler that cannot be randomized as asked. *plan outlives the samplers that use it.
sag_status sagi_sampler_plan_init(sagi_sampler_plan *plan, const sag_settings *settings, sag_error *error);
void sagi_sampler_start_pixel(sagi_sampler *sampler, uint32_t x, uint32_t y);
// The key of those samplers whose key is a hash.
static inline uint64_t sagi_sampler_hash(const sagi_sampler_plan *plan, uint32_t x, uint32_t y) {
    return sagi_mix(plan->seed ^ sagi_mix((uint64_t)y << 32 | x));
}
void sagi_sampler_start_sample(sagi_sampler *sampler, uint32_t sample);

// 64 random bits for this pixel, sample and dimension, of the samplers whose key is a hash.
static inline uint64_t sagi_sampler_bits(const sagi_sampler *sampler) {
    uint64_t counter = (uint64_t)sampler->sample << 32 | sampler->dimension;
    return sagi_mix(sampler->key + counter * UINT64_C(0x9E3779B97F4A7C15));
}

// One number, and a pair, in [0, 1).
double sagi_sampler_draw_1d(sagi_sampler *sampler);
sag_vec2 sagi_sampler_draw_2d(sagi_sampler *sampler);
// The same, quick where the numbers are ready.
static inline double sagi_unit_of(uint64_t bits) { return (double)(int64_t)bits * 0x1p-32; }
static inline uint32_t sagi_sampler_ready(const sagi_sampler *sampler, uint32_t dimension) {
    uint32_t number;
    memcpy(&number, (const char *)&sampler->ready + (dimension & 7) * sizeof number, sizeof number);
    return number;
}
static inline double sagi_sampler_1d(sagi_sampler *sampler) {
    const uint32_t d = sampler->dimension;
    if (d >> 3 != sampler->ready_block) return sagi_sampler_draw_1d(sampler);
    sampler->dimension = d + 1;
    return sagi_unit_of(sagi_sampler_ready(sampler, d));
}
static inline sag_vec2 sagi_sampler_2d(sagi_sampler *sampler) {
    const uint32_t d = sampler->dimension;
    if (d >> 3 != sampler->ready_block || (d & 7) == 7) return sagi_sampler_draw_2d(sampler);
    sampler->dimension = d + 2;
    return (sag_vec2){sagi_unit_of(sagi_sampler_ready(sampler, d)),
                      sagi_unit_of(sagi_sampler_ready(sampler, d + 1))};
}
// The pair that chooses the point of the pixel: once in a sample.
sag_vec2 sagi_sampler_pixel(sagi_sampler *sampler);
// Where `index` goes in the pseudo-random permutation of [0, count) that `seed` names.
uint32_t sagi_permute(uint32_t index, uint32_t count, uint32_t seed);

// Fills in the columns, bit i being digit i (sobol_dimensions.c).
void sagi_sobol_columns(uint32_t columns[SAGI_SOBOL_DIMENSIONS][SAGI_SOBOL_COLUMNS]);

// Halton's points (halton.c): the index of the first sample of a pixel (in the lowest bits, the pixel's tile
// above), the point within the pixel that an index has, and its number in any later dimension.
uint64_t sagi_halton_first(uint32_t x, uint32_t y);
sag_vec2 sagi_halton_pixel(uint64_t index);
double sagi_halton_number(const sagi_sampler *sampler, uint32_t dimension);
// Indices of a pixel's samples are this far apart; the first is smaller and has so many bits.
#define SAGI_HALTON_STRIDE UINT64_C(31104)
#define SAGI_HALTON_BITS   15

#endif
