// SPDX-License-Identifier: MIT
// The random numbers every test shares: seeded, the same on every machine. The generator is splitmix64
// (Steele, Lea & Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014).
#ifndef TESTS_SUPPORT_RANDOM_H
#define TESTS_SUPPORT_RANDOM_H

#include <sagitta/math.h>
#include <stdlib.h>

typedef struct rng {
    uint64_t state;
} rng;

static inline rng rng_make(uint64_t seed) { return (rng){seed * 0x9E3779B97F4A7C15u + 1}; }

static inline uint64_t rng_bits(rng *r) {
    uint64_t z = (r->state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

// An integer in [0, n), n > 0.
static inline uint32_t rng_below(rng *r, uint32_t n) { return (uint32_t)(((rng_bits(r) >> 32) * n) >> 32); }
// True once in `n` calls on average.
static inline bool rng_one_in(rng *r, uint32_t n) { return rng_below(r, n) == 0; }

// Uniform in [0, 1): a multiple of 2⁻⁵³.
static inline double rng_unit(rng *r) { return (double)(rng_bits(r) >> 11) * 0x1p-53; }
static inline double rng_uniform(rng *r, double low, double high) { return low + (high - low) * rng_unit(r); }
// As likely in [1e-9, 1e-8] as in [1e8, 1e9] for (1e-9, 1e9); both > 0.
static inline double rng_log_uniform(rng *r, double low, double high) {
    return low * exp(rng_unit(r) * log(high / low));
}
// Random sign, all 53 bits of the significand random, exponent uniform: magnitude in [2^low, 2^(high+1)).
static inline double rng_double(rng *r, int low, int high) {
    double significand = 1 + (double)(rng_bits(r) >> 12) * 0x1p-52;
    int exponent = low + (int)rng_below(r, (uint32_t)(high - low + 1));
    return ldexp(rng_bits(r) >> 63 ? -significand : significand, exponent);
}

// Uniform in the cube [−size, size]³.
static inline sag_vec3 rng_vec3(rng *r, double size) {
    double x = rng_uniform(r, -size, size), y = rng_uniform(r, -size, size), z = rng_uniform(r, -size, size);
    return sag_vec3_make(x, y, z);
}
// Uniform on the unit sphere: a point of the ball, normalised.
static inline sag_vec3 rng_direction(rng *r) {
    for (;;) {
        sag_vec3 v = rng_vec3(r, 1);
        double d = sag_dot(v, v);
        if (d > 0x1p-20 && d <= 1) return sag_scale(v, 1 / sqrt(d));
    }
}
static inline sag_vec2 rng_vec2(rng *r) {
    double x = rng_unit(r), y = rng_unit(r);
    return (sag_vec2){x, y};
}

static inline double soak_factor(const char *name) {
    const char *value = getenv(name);
    double f = value ? atof(value) : 1;
    return f > 0 ? f : 1;
}
// How often a loop of an oracle test runs: `count`, times the environment's SAGITTA_SOAK (make soak) and
// SAGITTA_SHARE (less for further instruction sets: tests/CMakeLists.txt) where they are set.
static inline size_t soak(size_t count) {
    double n = (double)count * soak_factor("SAGITTA_SOAK") * soak_factor("SAGITTA_SHARE");
    return n > 1 ? (size_t)n : 1;
}

#endif
