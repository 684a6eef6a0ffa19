// SPDX-License-Identifier: MIT
// Double-double arithmetic: a number as the unevaluated sum of two doubles, about 106 bits.
//
// The two error-free transforms below are exact (barring overflow and, for products, underflow of the low
// part):
//     two_sum:  a + b = hi + lo        (Knuth; six operations)
//     two_prod: a · b = hi + lo        (Dekker, Veltkamp; or one fused multiply-add, which gives the same
//     bits)
// On them stand dd sums with relative error ≤ 3·2⁻¹⁰⁶ and products ≤ 5·2⁻¹⁰⁶ (Joldes, Muller & Popescu,
// "Tight and rigorous error bounds for basic building blocks of double-word arithmetic", TOMS 44(2), 2017).
// Must be compiled without contraction (-ffp-contract=off).
#ifndef SAGI_MATH_DD_H
#define SAGI_MATH_DD_H

#include <math.h>

typedef struct sagi_dd {
    double hi, lo; // |lo| ≤ ulp(hi)/2
} sagi_dd;

static inline sagi_dd sagi_two_sum(double a, double b) {
    double s = a + b;
    double bb = s - a;
    return (sagi_dd){s, (a - (s - bb)) + (b - bb)};
}

// As two_sum, for |a| ≥ |b| or a = 0.
static inline sagi_dd sagi_fast_two_sum(double a, double b) {
    double s = a + b;
    return (sagi_dd){s, b - (s - a)};
}

static inline sagi_dd sagi_two_prod(double a, double b) {
    double p = a * b;
#if defined(__FP_FAST_FMA) || defined(__FMA__)
    return (sagi_dd){p, fma(a, b, -p)};
#else
    const double splitter = 0x1p27 + 1;
    double ta = splitter * a, tb = splitter * b;
    double ah = ta - (ta - a), bh = tb - (tb - b);
    double al = a - ah, bl = b - bh;
    return (sagi_dd){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
#endif
}

// As two_prod, for factors of any size: the splitting of one beyond 2⁹⁹⁶ would overflow.
static inline sagi_dd sagi_two_prod_any(double a, double b) {
    if (fabs(a) > 0x1p900) return sagi_two_prod(a * 0x1p-200, b * 0x1p200);
    if (fabs(b) > 0x1p900) return sagi_two_prod(a * 0x1p200, b * 0x1p-200);
    return sagi_two_prod(a, b);
}

static inline sagi_dd sagi_dd_from(double a) { return (sagi_dd){a, 0}; }
static inline sagi_dd sagi_dd_neg(sagi_dd a) { return (sagi_dd){-a.hi, -a.lo}; }
static inline double sagi_dd_to_double(sagi_dd a) { return a.hi + a.lo; }

static inline sagi_dd sagi_dd_add(sagi_dd a, sagi_dd b) {
    sagi_dd s = sagi_two_sum(a.hi, b.hi);
    sagi_dd t = sagi_two_sum(a.lo, b.lo);
    s = sagi_fast_two_sum(s.hi, s.lo + t.hi);
    return sagi_fast_two_sum(s.hi, s.lo + t.lo);
}

static inline sagi_dd sagi_dd_add_double(sagi_dd a, double b) {
    sagi_dd s = sagi_two_sum(a.hi, b);
    return sagi_fast_two_sum(s.hi, s.lo + a.lo);
}

static inline sagi_dd sagi_dd_sub(sagi_dd a, sagi_dd b) { return sagi_dd_add(a, sagi_dd_neg(b)); }

static inline sagi_dd sagi_dd_mul(sagi_dd a, sagi_dd b) {
    sagi_dd p = sagi_two_prod(a.hi, b.hi);
    return sagi_fast_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static inline sagi_dd sagi_dd_mul_double(sagi_dd a, double b) {
    sagi_dd p = sagi_two_prod(a.hi, b);
    return sagi_fast_two_sum(p.hi, p.lo + a.lo * b);
}

// a/b, relative error a few 2⁻¹⁰⁶; b ≠ 0.
static inline sagi_dd sagi_dd_div(sagi_dd a, sagi_dd b) {
    double q = a.hi / b.hi;
    sagi_dd r = sagi_dd_sub(a, sagi_dd_mul_double(b, q));
    double q2 = r.hi / b.hi;
    r = sagi_dd_sub(r, sagi_dd_mul_double(b, q2));
    sagi_dd s = sagi_fast_two_sum(q, q2);
    return sagi_dd_add_double(s, r.hi / b.hi);
}

// √a for a ≥ 0 (Karp & Markstein); 0 for a ≤ 0.
static inline sagi_dd sagi_dd_sqrt(sagi_dd a) {
    if (!(a.hi > 0)) return (sagi_dd){0, 0};
    double x = sqrt(a.hi);
    sagi_dd r = sagi_dd_sub(a, sagi_two_prod(x, x));
    return sagi_fast_two_sum(x, r.hi / (2 * x));
}

#endif
