// SPDX-License-Identifier: MIT
// Random numbers as a pure function of seed, pixel, sample and dimension: no state is carried from one sample
// to the next, so a picture does not depend on the order, the threads or the machines that made it.
#ifndef SAGI_RENDER_SAMPLER_H
#define SAGI_RENDER_SAMPLER_H

#include "math/hash.h"
#include "math/sobol.h"
#include <sagitta/render.h>

typedef struct sagi_sampler {
    sag_sampler_kind kind;
    uint32_t count;            // samples per pixel
    uint32_t x_count, y_count; // strata of a pair; their product is count
    uint32_t index_mask;       // Sobol': the least 2ᵏ − 1 ≥ count − 1
    uint64_t seed;
    uint64_t key;       // of seed and pixel
    uint32_t sample;    // of this pixel
    uint32_t dimension; // of this sample: counts the calls
} sagi_sampler;

static inline void sagi_sampler_start_pixel(sagi_sampler *sampler, uint32_t x, uint32_t y) {
    sampler->key = sagi_mix(sampler->seed ^ sagi_mix((uint64_t)y << 32 | x));
}
static inline void sagi_sampler_start_sample(sagi_sampler *sampler, uint32_t sample) {
    sampler->sample = sample;
    sampler->dimension = 0;
}

// 64 random bits for this pixel, sample and dimension.
static inline uint64_t sagi_sampler_bits(const sagi_sampler *sampler) {
    uint64_t counter = (uint64_t)sampler->sample << 32 | sampler->dimension;
    return sagi_mix(sampler->key + counter * UINT64_C(0x9E3779B97F4A7C15));
}

// The part that is the same for all pixels. count > 0.
void sagi_sampler_init(sagi_sampler *sampler, sag_sampler_kind kind, uint64_t seed, uint32_t count);
// One number, and a pair, in [0, 1).
double sagi_sampler_1d(sagi_sampler *sampler);
sag_vec2 sagi_sampler_2d(sagi_sampler *sampler);
// Where `index` goes in the pseudo-random permutation of [0, count) that `seed` names.
uint32_t sagi_permute(uint32_t index, uint32_t count, uint32_t seed);

#endif
