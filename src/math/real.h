// SPDX-License-Identifier: MIT
// Real numbers to about 400 bits: expansions cut to their eight leading components. The last resort of the
// shapes' solvers, for the few rays that doubles and double-doubles cannot settle (a start exactly on the
// surface, a tangent). Slow (a product is about a microsecond) and simple: pure functions on values. Each
// operation's result has a relative error below 2⁻³⁹⁰; sums and products that need no more than eight
// components are exact. That holds for leading components between about 2⁻⁵⁰⁰ and 2⁹⁰⁰: below, the tail
// underflows. Proved by tests/oracle/test_exact.
#ifndef SAGI_MATH_REAL_H
#define SAGI_MATH_REAL_H

#include <stdbool.h>

#define SAGI_REAL_TERMS 8

typedef struct sagi_real {
    int count;
    double terms[SAGI_REAL_TERMS]; // an expansion: increasing magnitude (expansion.h)
} sagi_real;

sagi_real sagi_real_from(double a);
// a − b exactly.
sagi_real sagi_real_from_diff(double a, double b);
sagi_real sagi_real_add(sagi_real a, sagi_real b);
sagi_real sagi_real_sub(sagi_real a, sagi_real b);
sagi_real sagi_real_mul(sagi_real a, sagi_real b);
sagi_real sagi_real_scale(sagi_real a, double b);
sagi_real sagi_real_neg(sagi_real a);
// a/b; 0 when b is 0.
sagi_real sagi_real_div(sagi_real a, sagi_real b);
// √a; 0 for a ≤ 0.
sagi_real sagi_real_sqrt(sagi_real a);
// −1, 0 or 1.
int sagi_real_sign(const sagi_real *a);
int sagi_real_compare(sagi_real a, sagi_real b);
// Rounded to the nearest double (the leading component; at most one ulp off in rare ties).
double sagi_real_to_double(const sagi_real *a);

#endif
