// SPDX-License-Identifier: MIT
// lanes.h for the instruction set that the file is compiled for; LANES is the table's name.
#include "math/simd.h"
#include "support/lanes.h"

#define OF_TWO(name)                                                                                         \
    static void name(const int32_t a[8], const int32_t b[8], int32_t out[8]) {                               \
        sagi_i8 x, y;                                                                                        \
        memcpy(&x, a, sizeof x), memcpy(&y, b, sizeof y);                                                    \
        x = sagi_i8_##name(x, y);                                                                            \
        memcpy(out, &x, sizeof x);                                                                           \
    }
OF_TWO(min)
OF_TWO(max)
OF_TWO(above)

static void in_order(const float a[8], const float b[8], uint32_t order[8], uint32_t *met) {
    sagi_f8 x, y;
    memcpy(&x, a, sizeof x), memcpy(&y, b, sizeof y);
    const sagi_i8 all = sagi_f8_in_order(x, y, met);
    memcpy(order, &all, sizeof all);
}

static uint32_t least_from(const uint32_t a[8], const uint32_t from[8], uint32_t *chosen) {
    sagi_i8 x;
    _Alignas(32) uint32_t aligned[8];
    memcpy(&x, a, sizeof x), memcpy(aligned, from, sizeof aligned);
    return sagi_i8_least_from(x, aligned, chosen);
}

const lanes_of_isa LANES = {min, max, above, in_order, least_from};
