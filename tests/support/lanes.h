// SPDX-License-Identifier: MIT
// What simd.h says of eight numbers or four doubles, as the kernels of each instruction set have it.
#ifndef TESTS_SUPPORT_LANES_H
#define TESTS_SUPPORT_LANES_H

#include <stdint.h>

typedef struct lanes_doubles {
    int64_t less[4], at_most[4], below[4], above[4]; // than b; than b's first number
    double min[4], max[4], sqrt[4], turn[4], even[4], odd[4], low[4], high[4], product[4], error[4], back[4];
    float narrow[4];
    double sum3, first;
    uint32_t signs;
} lanes_doubles;
typedef struct lanes_floats {
    int32_t less[8], at_most[8];
    float min[8], max[8], sqrt[8], most;
    uint32_t none; // a bit for whether a, b, have no bit in common
} lanes_floats;
typedef struct lanes_shorts {
    float first[8], second[8], numbers[8];
} lanes_shorts;
typedef struct lanes_bits {
    int64_t rights[4], left[4], from_mask[4], equal[4];
    int32_t equal8[8];
    uint64_t shorts;
} lanes_bits;

typedef struct lanes_of_isa { // NULL: not built
    void (*min)(const int32_t a[8], const int32_t b[8], int32_t out[8]);
    void (*max)(const int32_t a[8], const int32_t b[8], int32_t out[8]);
    void (*above)(const int32_t a[8], const int32_t b[8], int32_t out[8]);
    void (*in_order)(const float a[8], const float b[8], uint32_t order[8], uint32_t *met);
    uint32_t (*least_from)(const uint32_t a[8], const uint32_t from[8], uint32_t *chosen);
    void (*doubles)(const double a[4], const double b[4], lanes_doubles *out);
    void (*floats)(const float a[8], const float b[8], lanes_floats *out);
    void (*shorts)(const uint16_t p[16], lanes_shorts *out);
    void (*bits)(uint64_t x, uint32_t n, uint32_t mask, const int64_t a[4], const int64_t b[4],
                 lanes_bits *out);
    void (*write_lanes)(uint32_t mask, const float a[8], float p[16], const int32_t b[8], uint32_t q[16]);
    void (*write_pairs)(uint32_t mask, const float a[8], const int32_t b[8], uint64_t p[16]);
} lanes_of_isa;
extern const lanes_of_isa lanes_portable, lanes_sse42, lanes_avx2, lanes_avx512, lanes_neon;

#endif
