// SPDX-License-Identifier: MIT
// What the walk makes of times by their bits (simd.h), against plain code, for every instruction set this
// machine has.
#include "base/cpu.h"
#include "support/lanes.h"
#include "support/random.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const lanes_of_isa *const isas[SAGI_ISA_COUNT] = {[SAGI_ISA_PORTABLE] = &lanes_portable,
                                                         [SAGI_ISA_SSE42] = &lanes_sse42,
                                                         [SAGI_ISA_AVX2] = &lanes_avx2,
                                                         [SAGI_ISA_AVX512] = &lanes_avx512,
                                                         [SAGI_ISA_NEON] = &lanes_neon};

static bool is_here(sagi_isa isa) { return isas[isa]->min != NULL && sagi_cpu_has(isa); }

static float float_of_bits(uint32_t bits) {
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}
static uint32_t bits_of(float f) {
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

// Any bits that are no NaN's; often a limit, often such as others are near to.
static float draw_time(rng *r) {
    static const float special[] = {0, -0.0F, INFINITY, -INFINITY, 0x1p-149F, -0x1p-149F, 1, -1};
    if (rng_one_in(r, 4)) return special[rng_below(r, sizeof special / sizeof special[0])];
    if (rng_one_in(r, 2)) return float_of_bits(bits_of(1) + (uint32_t)rng_below(r, 20));
    for (;;) {
        const float f = float_of_bits((uint32_t)rng_bits(r));
        if (!isnan(f)) return f;
    }
}

static void whole_numbers_are_compared_as_in_c(void **state) {
    (void)state;
    for (sagi_isa isa = 0; isa < SAGI_ISA_COUNT; isa++) {
        if (!is_here(isa)) continue;
        const lanes_of_isa *lanes = isas[isa];
        rng r = rng_make(1);
        for (int round = 0; round < 10000; round++) {
            int32_t a[8], b[8], least[8], most[8], above[8];
            for (int i = 0; i < 8; i++) {
                const uint32_t x = bits_of(draw_time(&r)), y = bits_of(draw_time(&r));
                memcpy(&a[i], &x, sizeof x), memcpy(&b[i], &y, sizeof y);
            }
            lanes->min(a, b, least), lanes->max(a, b, most), lanes->above(a, b, above);
            for (int i = 0; i < 8; i++) {
                assert_int_equal(least[i], a[i] < b[i] ? a[i] : b[i]);
                assert_int_equal(most[i], a[i] > b[i] ? a[i] : b[i]);
                assert_int_equal(above[i], a[i] > b[i] ? -1 : 0);
            }
        }
    }
}

// Children are met where they begin no later than they end, and never where they end at a time with a sign;
// in the order of their beginnings, but for the last three bits, and the nearest one's number comes with it.
static void children_are_in_order(void **state) {
    (void)state;
    size_t met_count = 0, missed_count = 0;
    for (sagi_isa isa = 0; isa < SAGI_ISA_COUNT; isa++) {
        if (!is_here(isa)) continue;
        const lanes_of_isa *lanes = isas[isa];
        rng r = rng_make(2);
        for (int round = 0; round < 10000; round++) {
            float begin[8], end[8];
            uint32_t order[8], met, child[8], chosen;
            for (uint32_t i = 0; i < 8; i++) {
                begin[i] = fabsf(draw_time(&r)), end[i] = draw_time(&r);
                child[i] = (uint32_t)rng_bits(&r);
            }
            lanes->in_order(begin, end, order, &met);
            assert_int_equal(met >> 8, 0);
            uint32_t nearest = 8;
            for (uint32_t i = 0; i < 8; i++) {
                const bool is_met = !signbit(end[i]) && begin[i] <= end[i];
                assert_int_equal(met >> i & 1, is_met);
                assert_int_equal(order[i], is_met ? (bits_of(begin[i]) & ~7U) | i : UINT32_MAX);
                if (is_met && (nearest == 8 || order[i] < order[nearest])) nearest = i;
                met_count += is_met, missed_count += !is_met;
            }
            if (nearest == 8) continue;
            assert_int_equal(lanes->least_from(order, child, &chosen), order[nearest]);
            assert_int_equal(chosen, child[nearest]);
        }
    }
    assert_true(met_count > 10000 && missed_count > 10000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_numbers_are_compared_as_in_c),
        cmocka_unit_test(children_are_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
