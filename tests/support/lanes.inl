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

#define TAKE(to, from)                                                                                       \
    do {                                                                                                     \
        const __typeof__(from) taken = from;                                                                 \
        memcpy(to, &taken, sizeof(to));                                                                      \
    } while (0)

static void doubles(const double a[4], const double b[4], lanes_doubles *out) {
    const sagi_d4 x = sagi_d4_load(a), y = sagi_d4_load(b), p = x * y;
    TAKE(out->less, sagi_d4_less(x, y));
    TAKE(out->at_most, sagi_d4_at_most(x, y));
    TAKE(out->below, sagi_d4_below(x, b[0]));
    TAKE(out->above, sagi_d4_above(x, b[0]));
    TAKE(out->min, sagi_d4_min(x, y));
    TAKE(out->max, sagi_d4_max(x, y));
    TAKE(out->sqrt, sagi_d4_sqrt(sagi_d4_abs(x)));
    TAKE(out->turn, sagi_d4_turn(x));
    TAKE(out->even, SAGI_D4_SHUFFLE2(x, y, 0, 4, 2, 6));
    TAKE(out->odd, SAGI_D4_SHUFFLE2(x, y, 1, 5, 3, 7));
    TAKE(out->low, SAGI_D4_SHUFFLE2(x, y, 0, 1, 4, 5));
    TAKE(out->high, SAGI_D4_SHUFFLE2(x, y, 2, 3, 6, 7));
    TAKE(out->product, p);
    TAKE(out->error, sagi_d4_product_error(x, y, p));
    TAKE(out->narrow, sagi_d4_to_f4(x));
    TAKE(out->back, sagi_f4_to_d4(sagi_d4_to_f4(x)));
    out->sum3 = sagi_d4_sum3(x), out->first = sagi_d4_first(x), out->signs = sagi_d4_signs(x);
}

static void floats(const float a[8], const float b[8], lanes_floats *out) {
    sagi_f8 x, y;
    memcpy(&x, a, sizeof x), memcpy(&y, b, sizeof y);
    TAKE(out->less, sagi_f8_less(x, y));
    TAKE(out->at_most, sagi_f8_at_most(x, y));
    TAKE(out->min, sagi_f8_min(x, y));
    TAKE(out->max, sagi_f8_max(x, y));
    TAKE(out->sqrt, sagi_f8_sqrt(sagi_f8_abs(x)));
    out->most = sagi_f8_most(x), out->none = sagi_i8_none(sagi_f8_bits(x), sagi_f8_bits(y));
}

static void shorts(const uint16_t p[16], lanes_shorts *out) {
    _Alignas(32) uint16_t aligned[16];
    sagi_f8 first, second;
    memcpy(aligned, p, sizeof aligned);
    sagi_f8_rows(aligned, SAGI_ROWS_HIGH, &first, &second);
    TAKE(out->first, first);
    TAKE(out->second, second);
    TAKE(out->numbers, sagi_f8_from_h8(p + 1));
}

static void bits(uint64_t x, uint32_t n, uint32_t mask, const int64_t a[4], const int64_t b[4],
                 lanes_bits *out) {
    const sagi_l4 of_a = sagi_l4_of(a[0], a[1], a[2], a[3]), of_b = sagi_l4_of(b[0], b[1], b[2], b[3]);
    TAKE(out->rights, sagi_l4_rights(x, n, 0, 63, 21));
    TAKE(out->left, sagi_l4_left(of_a, n));
    TAKE(out->from_mask, sagi_l4_from_mask(mask));
    TAKE(out->equal, sagi_l4_equal(of_a, of_b));
    TAKE(out->equal8, sagi_i8_equal((sagi_i8)of_a, (sagi_i8)of_b));
    out->shorts = sagi_d4_to_h4(sagi_d4_of((double)(x & 0xFFFF), (double)(x >> 16 & 0xFFFF),
                                           (double)(x >> 32 & 0xFFFF), (double)(x >> 48)));
}

static void write_lanes(uint32_t mask, const float a[8], float p[16], const int32_t b[8], uint32_t q[16]) {
    sagi_f8 x;
    sagi_i8 y;
    memcpy(&x, a, sizeof x), memcpy(&y, b, sizeof y);
    sagi_write_lanes(mask, x, p, y, q);
}
static void write_pairs(uint32_t mask, const float a[8], const int32_t b[8], uint64_t p[16]) {
    sagi_f8 x;
    sagi_i8 y;
    memcpy(&x, a, sizeof x), memcpy(&y, b, sizeof y);
    sagi_write_pairs(mask, x, y, p);
}

const lanes_of_isa LANES = {min,    max,    above, in_order,    least_from, doubles,
                            floats, shorts, bits,  write_lanes, write_pairs};
