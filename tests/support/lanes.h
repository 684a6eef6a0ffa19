// SPDX-License-Identifier: MIT
// What simd.h says of eight whole numbers or times, as the kernels of each instruction set have it.
#ifndef TESTS_SUPPORT_LANES_H
#define TESTS_SUPPORT_LANES_H

#include <stdint.h>

typedef struct lanes_of_isa { // NULL: not built
    void (*min)(const int32_t a[8], const int32_t b[8], int32_t out[8]);
    void (*max)(const int32_t a[8], const int32_t b[8], int32_t out[8]);
    void (*above)(const int32_t a[8], const int32_t b[8], int32_t out[8]);
    void (*in_order)(const float a[8], const float b[8], uint32_t order[8], uint32_t *met);
    uint32_t (*least_from)(const uint32_t a[8], const uint32_t from[8], uint32_t *chosen);
} lanes_of_isa;
extern const lanes_of_isa lanes_portable, lanes_sse42, lanes_avx2, lanes_avx512, lanes_neon;

#endif
