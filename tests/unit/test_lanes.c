// SPDX-License-Identifier: MIT
// What simd.h says of numbers side by side, and what the walk makes of times by their bits, against plain
// code, for every instruction set this machine has.
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

// Of the bits' order and the numbers' own, and NaN's; any of them may be one.
static double draw_double(rng *r) {
    static const double special[] = {0, -0.0, INFINITY, -INFINITY, NAN, 1, -1, 0x1p-1074, 0x1p200, -0x1p-200};
    if (rng_one_in(r, 4)) return special[rng_below(r, sizeof special / sizeof special[0])];
    return ldexp(rng_uniform(r, -1, 1), (int)rng_below(r, 200) - 100);
}
static bool same_double(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}
static bool same_float(float a, float b) { return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b)); }

static void doubles_are_as_in_c(void **state) {
    (void)state;
    static const int even[4] = {0, 4, 2, 6}, odd[4] = {1, 5, 3, 7}, low[4] = {0, 1, 4, 5},
                     high[4] = {2, 3, 6, 7};
    for (sagi_isa isa = 0; isa < SAGI_ISA_COUNT; isa++) {
        if (!is_here(isa)) continue;
        rng r = rng_make(3);
        for (int round = 0; round < 10000; round++) {
            double a[8], *b = a + 4;
            for (int i = 0; i < 8; i++) a[i] = draw_double(&r);
            if (rng_one_in(&r, 4)) memcpy(b, a, 2 * sizeof *a);
            lanes_doubles of;
            isas[isa]->doubles(a, b, &of);
            uint32_t signs = 0;
            for (int i = 0; i < 4; i++) {
                assert_int_equal(of.less[i], a[i] < b[i] ? -1 : 0);
                assert_int_equal(of.at_most[i], a[i] <= b[i] ? -1 : 0);
                assert_int_equal(of.below[i], a[i] < b[0] ? -1 : 0);
                assert_int_equal(of.above[i], a[i] > b[0] ? -1 : 0);
                assert_true(same_double(of.min[i], a[i] < b[i] ? a[i] : b[i]));
                assert_true(same_double(of.max[i], a[i] > b[i] ? a[i] : b[i]));
                assert_true(same_double(of.sqrt[i], sqrt(fabs(a[i]))));
                assert_true(same_double(of.turn[i], a[i ^ 2]));
                assert_true(same_double(of.even[i], a[even[i]]) && same_double(of.odd[i], a[odd[i]]));
                assert_true(same_double(of.low[i], a[low[i]]) && same_double(of.high[i], a[high[i]]));
                assert_true(same_double(of.product[i], a[i] * b[i]));
                if (fabs(a[i] * b[i]) > 0x1p-900 && fabs(a[i]) < 0x1p150 && fabs(b[i]) < 0x1p150)
                    assert_true(same_double(of.error[i], fma(a[i], b[i], -(a[i] * b[i]))));
                const volatile float narrow = (float)a[i];
                assert_true(same_float(of.narrow[i], narrow) && same_double(of.back[i], (double)narrow));
                signs |= (uint32_t)(signbit(a[i]) != 0) << i;
            }
            assert_int_equal(of.signs, signs);
            assert_true(same_double(of.sum3, (a[0] + a[1]) + a[2]) && same_double(of.first, a[0]));
        }
    }
}

static void floats_are_as_in_c(void **state) {
    (void)state;
    for (sagi_isa isa = 0; isa < SAGI_ISA_COUNT; isa++) {
        if (!is_here(isa)) continue;
        rng r = rng_make(4);
        for (int round = 0; round < 10000; round++) {
            float a[8], b[8], most = -INFINITY;
            uint32_t common = 0;
            for (int i = 0; i < 8; i++) {
                a[i] = draw_time(&r), b[i] = rng_one_in(&r, 3) ? NAN : draw_time(&r);
                if (rng_one_in(&r, 2)) b[i] = float_of_bits(~bits_of(a[i]));
                most = a[i] > most ? a[i] : most, common |= bits_of(a[i]) & bits_of(b[i]);
            }
            lanes_floats of;
            isas[isa]->floats(a, b, &of);
            for (int i = 0; i < 8; i++) {
                assert_int_equal(of.less[i], a[i] < b[i] ? -1 : 0);
                assert_int_equal(of.at_most[i], a[i] <= b[i] ? -1 : 0);
                assert_true(same_float(of.min[i], a[i] < b[i] ? a[i] : b[i]));
                assert_true(same_float(of.max[i], a[i] > b[i] ? a[i] : b[i]));
                assert_true(same_float(of.sqrt[i], sqrtf(fabsf(a[i]))));
            }
            assert_true(of.most == most);
            assert_int_equal(of.none, common == 0);
        }
    }
}

static void whole_numbers_are_brought_to_lanes(void **state) {
    (void)state;
    for (sagi_isa isa = 0; isa < SAGI_ISA_COUNT; isa++) {
        if (!is_here(isa)) continue;
        rng r = rng_make(5);
        for (int round = 0; round < 10000; round++) {
            uint16_t p[16];
            for (int i = 0; i < 16; i++) p[i] = (uint16_t)rng_bits(&r);
            lanes_shorts of;
            isas[isa]->shorts(p, &of);
            for (int i = 0; i < 8; i++) {
                const int at = (i & 3) + ((i & 4) << 1);
                assert_true(of.first[i] == 0x1p23F + p[at] && of.second[i] == 0x1p23F + p[at + 4]);
                assert_true(of.numbers[i] == p[i + 1]);
            }
            const uint64_t x = rng_bits(&r);
            const uint32_t n = (uint32_t)rng_below(&r, 64), mask = (uint32_t)rng_below(&r, 16);
            int64_t a[4], b[4];
            int32_t a8[8], b8[8];
            for (int i = 0; i < 4; i++) {
                a[i] = (int64_t)rng_bits(&r);
                b[i] = rng_one_in(&r, 2) ? a[i] : a[i] ^ (int64_t)1 << rng_below(&r, 63);
            }
            memcpy(a8, a, sizeof a8), memcpy(b8, b, sizeof b8);
            lanes_bits bits;
            isas[isa]->bits(x, n, mask, a, b, &bits);
            const uint64_t right[4] = {x >> n, x, x >> 63, x >> 21};
            for (int i = 0; i < 4; i++) {
                assert_int_equal((uint64_t)bits.rights[i], right[i]);
                assert_int_equal((uint64_t)bits.left[i], (uint64_t)a[i] << n);
                assert_int_equal(bits.from_mask[i], -(int64_t)(mask >> i & 1));
                assert_int_equal(bits.equal[i], a[i] == b[i] ? -1 : 0);
            }
            for (int i = 0; i < 8; i++) assert_int_equal(bits.equal8[i], a8[i] == b8[i] ? -1 : 0);
            assert_int_equal(bits.shorts, x);
        }
    }
}

// For every mask; what follows after the last one may be anything.
static void lanes_are_written_in_order(void **state) {
    (void)state;
    for (sagi_isa isa = 0; isa < SAGI_ISA_COUNT; isa++) {
        if (!is_here(isa)) continue;
        rng r = rng_make(6);
        for (uint32_t mask = 0; mask < 256; mask++) {
            float a[8], p[16] = {0};
            int32_t b[8];
            uint32_t q[16] = {0}, n = 0;
            uint64_t pairs[16] = {0};
            for (int i = 0; i < 8; i++)
                a[i] = draw_time(&r), b[i] = (int32_t)rng_below(&r, 1 << 30) - (1 << 29);
            isas[isa]->write_lanes(mask, a, p, b, q), isas[isa]->write_pairs(mask, a, b, pairs);
            for (int i = 0; i < 8; i++) {
                if (!(mask >> i & 1)) continue;
                assert_int_equal(bits_of(p[n]), bits_of(a[i]));
                assert_int_equal(q[n], (uint32_t)b[i]);
                assert_int_equal(pairs[n], (uint64_t)bits_of(a[i]) << 32 | (uint32_t)b[i]);
                n++;
            }
            for (int i = 8; i < 16; i++) assert_true(q[i] == 0 && pairs[i] == 0 && bits_of(p[i]) == 0);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_numbers_are_compared_as_in_c),
        cmocka_unit_test(children_are_in_order),
        cmocka_unit_test(doubles_are_as_in_c),
        cmocka_unit_test(floats_are_as_in_c),
        cmocka_unit_test(whole_numbers_are_brought_to_lanes),
        cmocka_unit_test(lanes_are_written_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
