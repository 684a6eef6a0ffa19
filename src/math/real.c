// SPDX-License-Identifier: MIT
#include "math/real.h"
#include "math/expansion.h"
#include <math.h>

// The leading components of an expansion, compressed first so that each carries a full double's worth of
// bits.
static sagi_real cut(int count, const double *expansion) {
    double small[2 * SAGI_REAL_TERMS * SAGI_REAL_TERMS];
    int n = sagi_expansion_compress(count, expansion, small);
    int first = n > SAGI_REAL_TERMS ? n - SAGI_REAL_TERMS : 0;
    sagi_real r = {.count = n - first};
    for (int i = first; i < n; i++) r.terms[i - first] = small[i];
    return r;
}

sagi_real sagi_real_from(double a) { return (sagi_real){.count = a != 0, .terms = {a}}; }

sagi_real sagi_real_from_diff(double a, double b) {
    sagi_real r = {0};
    r.count = sagi_expansion_from_diff(a, b, r.terms);
    return r;
}

sagi_real sagi_real_add(sagi_real a, sagi_real b) {
    double h[2 * SAGI_REAL_TERMS];
    return cut(sagi_expansion_sum(a.count, a.terms, b.count, b.terms, h), h);
}

sagi_real sagi_real_neg(sagi_real a) {
    for (int i = 0; i < a.count; i++) a.terms[i] = -a.terms[i];
    return a;
}

sagi_real sagi_real_sub(sagi_real a, sagi_real b) { return sagi_real_add(a, sagi_real_neg(b)); }

sagi_real sagi_real_mul(sagi_real a, sagi_real b) {
    double h[2 * SAGI_REAL_TERMS * SAGI_REAL_TERMS];
    return cut(sagi_expansion_product(a.count, a.terms, b.count, b.terms, h), h);
}

sagi_real sagi_real_scale(sagi_real a, double b) {
    double h[2 * SAGI_REAL_TERMS];
    return cut(sagi_expansion_scale(a.count, a.terms, b, h), h);
}

// Long division with doubles for digits: each step takes 50 bits or more off the remainder.
sagi_real sagi_real_div(sagi_real a, sagi_real b) {
    sagi_real quotient = {0};
    if (b.count == 0) return quotient;
    double divisor = b.terms[b.count - 1];
    for (int i = 0; i <= SAGI_REAL_TERMS && a.count > 0; i++) {
        double digit = a.terms[a.count - 1] / divisor;
        quotient = sagi_real_add(quotient, sagi_real_from(digit));
        a = sagi_real_sub(a, sagi_real_scale(b, digit));
    }
    return quotient;
}

// Newton's correction of the residual a − x², with the first double of 2√a as the divisor throughout.
sagi_real sagi_real_sqrt(sagi_real a) {
    if (sagi_real_sign(&a) <= 0) return (sagi_real){0};
    double first = sqrt(a.terms[a.count - 1]);
    sagi_real x = sagi_real_from(first);
    for (int i = 0; i <= SAGI_REAL_TERMS; i++) {
        sagi_real residual = sagi_real_sub(a, sagi_real_mul(x, x));
        if (residual.count == 0) break;
        x = sagi_real_add(x, sagi_real_from(residual.terms[residual.count - 1] / (2 * first)));
    }
    return x;
}

int sagi_real_sign(const sagi_real *a) { return sagi_expansion_sign(a->count, a->terms); }

int sagi_real_compare(sagi_real a, sagi_real b) {
    sagi_real d = sagi_real_sub(a, b);
    return sagi_real_sign(&d);
}

double sagi_real_to_double(const sagi_real *a) { return a->count == 0 ? 0 : a->terms[a->count - 1]; }
