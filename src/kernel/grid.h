// SPDX-License-Identifier: MIT
// The grid of a block (kernel/block.h): its zero below everything in the block, its step the smallest power
// of two with which 16 bits reach the farthest. Coordinates are in world units, not below −1 nor above 1.
#ifndef SAGI_KERNEL_GRID_H
#define SAGI_KERNEL_GRID_H

#include "kernel/block.h"
#include <string.h>

// Where it begins in direction k, at most 2⁻²⁰ below `lo`; notes it in the header.
static inline double sagi_grid_zero(sagi_block *head, int k, double lo) {
    const int32_t most = (1 << SAGI_GRID_BASE_BITS) - 1; // lo + 1 may be rounded to 2
    int32_t base = (int32_t)((lo + 1) * 0x1p20);
    base = base < most ? base : most;
    head->base |= (uint64_t)base << (k * SAGI_GRID_BASE_BITS);
    return (double)base * 0x1p-20 - 1;
}

// The largest e for which x · 2^e is at most 65535, x ≥ 0: with x = m · 2^n and m in [1, 2) that is 15 − n
// or, if m is larger than 65535 / 32768, one less.
static inline int sagi_grid_exponent(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int n = (int)(bits >> 52) - 1023;
    const uint64_t largest = 0xFFFEull << 36; // the fraction of 65535 / 32768
    int e = SAGI_GRID_BITS - 1 - n - ((bits & ((1ull << 52) - 1)) > largest);
    return e < SAGI_GRID_MAX_EXPONENT ? e : SAGI_GRID_MAX_EXPONENT;
}

// The grid's steps in a world unit when nothing is farther than `extent` from its zero; notes them, too.
static inline double sagi_grid_steps(sagi_block *head, double extent) {
    int exponent = sagi_grid_exponent(extent);
    head->exponent = (uint8_t)exponent;
    return (double)((uint64_t)1 << exponent);
}

#endif
