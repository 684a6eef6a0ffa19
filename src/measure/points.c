// SPDX-License-Identifier: MIT
// Points that fill the unit square evenly, again and again.
//
// The points are the first two Sobol' dimensions (math/sobol.h). Owen's scrambling keeps their even spread
// and makes every point uniform in the square, so a mean over the points is
// an unbiased estimate of the integral; its error falls like N^-1.5 for smooth functions and about N^-0.75
// for an area with a smooth outline, where independent points have N^-0.5 (Owen, "Scrambled net variance for
// integrals of smooth functions", Annals of Statistics 25(4), 1997; He & Wang, "On the convergence rate of
// randomized quasi-Monte Carlo for discontinuous functions", SIAM J. Numer. Anal. 53(5), 2015).
//
// The scramble's hash is not quite uniform over its seeds, so a random digital shift goes on top, which
// makes each point exactly uniform over the cells of 2⁻³², and random bits below those within the cell.
#include "math/hash.h"
#include "math/sobol.h"
#include "measure/measure.h"

uint64_t sagi_measure_hash(uint64_t seed, uint64_t a, uint64_t b) {
    return sagi_mix(sagi_mix(sagi_mix(seed + 0x9E3779B97F4A7C15u) + a * 0xD1342543DE82EF95u) +
                    b * 0x9E3779B97F4A7C15u + 1);
}

// The digits, shifted, and 20 random bits below.
static double coordinate(uint32_t digits, uint32_t shift, uint64_t random) {
    return ((double)(digits ^ shift) + (double)(random & 0xFFFFFu) * 0x1p-20) * 0x1p-32;
}

sag_vec2 sagi_measure_point(uint64_t key, uint64_t index) {
    const uint64_t seeds = sagi_mix(key + 1), shifts = sagi_mix(key + 2),
                   random = sagi_mix(key ^ sagi_mix(index + 3));
    const uint32_t i = (uint32_t)index;
    // The first dimension is the reversed index, and its scramble wants the reverse of that.
    const uint32_t x = sagi_reverse_bits(sagi_scramble_reversed(i, (uint32_t)seeds));
    const uint32_t y =
        sagi_reverse_bits(sagi_scramble_reversed(sagi_sobol_second_reversed(i), (uint32_t)(seeds >> 32)));
    return (sag_vec2){coordinate(x, (uint32_t)shifts, random),
                      coordinate(y, (uint32_t)(shifts >> 32), random >> 20)};
}
