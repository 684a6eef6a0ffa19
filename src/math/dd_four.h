// SPDX-License-Identifier: MIT
// Four double-doubles at once, for the kernels: the operations of dd.h in the same order, so that each lane
// has the bits that those give.
#ifndef SAGI_MATH_DD_FOUR_H
#define SAGI_MATH_DD_FOUR_H

#include "math/dd.h"
#include "math/simd.h"

typedef struct sagi_dd4 {
    sagi_d4 hi, lo;
} sagi_dd4;

SAGI_INLINE sagi_dd4 sagi_dd4_fill(sagi_dd a) { return (sagi_dd4){sagi_d4_fill(a.hi), sagi_d4_fill(a.lo)}; }

SAGI_INLINE sagi_dd4 sagi_two_sum4(sagi_d4 a, sagi_d4 b) {
    sagi_d4 s = a + b, bb = s - a;
    return (sagi_dd4){s, (a - (s - bb)) + (b - bb)};
}

SAGI_INLINE sagi_dd4 sagi_fast_two_sum4(sagi_d4 a, sagi_d4 b) {
    sagi_d4 s = a + b;
    return (sagi_dd4){s, b - (s - a)};
}

SAGI_INLINE sagi_dd4 sagi_two_prod4(sagi_d4 a, sagi_d4 b) {
    sagi_d4 p = a * b;
    return (sagi_dd4){p, sagi_d4_product_error(a, b, p)};
}

SAGI_INLINE sagi_dd4 sagi_dd4_add(sagi_dd4 a, sagi_dd4 b) {
    sagi_dd4 s = sagi_two_sum4(a.hi, b.hi), t = sagi_two_sum4(a.lo, b.lo);
    s = sagi_fast_two_sum4(s.hi, s.lo + t.hi);
    return sagi_fast_two_sum4(s.hi, s.lo + t.lo);
}

SAGI_INLINE sagi_dd4 sagi_dd4_add_double(sagi_dd4 a, sagi_d4 b) {
    sagi_dd4 s = sagi_two_sum4(a.hi, b);
    return sagi_fast_two_sum4(s.hi, s.lo + a.lo);
}

SAGI_INLINE sagi_dd4 sagi_dd4_mul(sagi_dd4 a, sagi_dd4 b) {
    sagi_dd4 p = sagi_two_prod4(a.hi, b.hi);
    return sagi_fast_two_sum4(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

SAGI_INLINE sagi_dd4 sagi_dd4_mul_double(sagi_dd4 a, sagi_d4 b) {
    sagi_dd4 p = sagi_two_prod4(a.hi, b);
    return sagi_fast_two_sum4(p.hi, p.lo + a.lo * b);
}

#endif
