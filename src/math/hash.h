// SPDX-License-Identifier: MIT
// Hashes of numbers.
#ifndef SAGI_MATH_HASH_H
#define SAGI_MATH_HASH_H

#include <sagitta/math.h>
#include <string.h>

// A bijection of 64 bits that leaves no visible relation between near arguments: SplitMix64's finaliser with
// Stafford's constants.
static inline uint64_t sagi_mix(uint64_t x) {
    x ^= x >> 30;
    x *= UINT64_C(0xBF58476D1CE4E5B9);
    x ^= x >> 27;
    x *= UINT64_C(0x94D049BB133111EB);
    return x ^ (x >> 31);
}

// 128 bits that stand for something; what is different has different ones but for a chance of 2⁻¹²⁸ (to
// whoever does not look for collisions).
typedef struct sagi_fingerprint {
    uint64_t part[2];
} sagi_fingerprint;

// Of a position; 0 and −0 are the same.
static inline sagi_fingerprint sagi_fingerprint_of(sag_vec3 p) {
    const double coordinates[3] = {p.x + 0.0, p.y + 0.0, p.z + 0.0};
    uint64_t x[3];
    memcpy(x, coordinates, sizeof x);
    const uint64_t xy = sagi_mix(x[0] + sagi_mix(x[1] + UINT64_C(0x9E3779B97F4A7C15))),
                   yz = sagi_mix(x[1] + sagi_mix(x[2] + UINT64_C(0xD1B54A32D192ED03)));
    return (sagi_fingerprint){{sagi_mix(xy + x[2]), sagi_mix(yz ^ x[0])}};
}

#endif
