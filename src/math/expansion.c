// SPDX-License-Identifier: MIT
#include "math/expansion.h"
#include "math/dd.h"
#include <stdbool.h>
#include <string.h>

// NaN counts as zero here: an overflow must not lengthen an expansion beyond its room.
static inline bool is_nonzero(double x) { return x < 0 || x > 0; }

// Shewchuk's FAST-EXPANSION-SUM with zero elimination: merge by magnitude, then carry upward.
int sagi_expansion_sum(int n, const double *e, int m, const double *f, double *h) {
    int i = 0, j = 0, count = 0;
    double carry = 0;
    while (i < n || j < m) {
        double next;
        if (j >= m || (i < n && fabs(e[i]) < fabs(f[j])))
            next = e[i++];
        else
            next = f[j++];
        sagi_dd s = sagi_two_sum(carry, next);
        carry = s.hi;
        if (is_nonzero(s.lo)) h[count++] = s.lo;
    }
    if (carry != 0) h[count++] = carry;
    return count;
}

int sagi_expansion_diff(int n, const double *e, int m, const double *f, double *h) {
    double negated[256];
    for (int i = 0; i < m; i++) negated[i] = -f[i];
    return sagi_expansion_sum(n, e, m, negated, h);
}

// Shewchuk's SCALE-EXPANSION with zero elimination.
int sagi_expansion_scale(int n, const double *e, double b, double *h) {
    if (n == 0 || b == 0) return 0;
    int count = 0;
    sagi_dd q = sagi_two_prod(e[0], b);
    if (is_nonzero(q.lo)) h[count++] = q.lo;
    double carry = q.hi;
    for (int i = 1; i < n; i++) {
        sagi_dd p = sagi_two_prod(e[i], b);
        sagi_dd s = sagi_two_sum(carry, p.lo);
        if (is_nonzero(s.lo)) h[count++] = s.lo;
        sagi_dd t = sagi_fast_two_sum(p.hi, s.hi);
        if (is_nonzero(t.lo)) h[count++] = t.lo;
        carry = t.hi;
    }
    if (carry != 0) h[count++] = carry;
    return count;
}

int sagi_expansion_product(int n, const double *e, int m, const double *f, double *h) {
    double partial[512], sum[512];
    int count = 0;
    for (int j = 0; j < m; j++) {
        int p = sagi_expansion_scale(n, e, f[j], partial);
        int s = sagi_expansion_sum(count, h, p, partial, sum);
        memcpy(h, sum, (size_t)s * sizeof *h);
        count = s;
    }
    return count;
}

int sagi_expansion_compress(int n, const double *e, double *h) {
    if (n == 0) return 0;
    double down[1024]; // largest first
    int bottom = 0;
    double carry = e[n - 1];
    for (int i = n - 2; i >= 0; i--) {
        sagi_dd s = sagi_fast_two_sum(carry, e[i]);
        carry = s.hi;
        if (is_nonzero(s.lo)) {
            down[bottom++] = carry;
            carry = s.lo;
        }
    }
    down[bottom] = carry;
    int count = 0;
    for (int i = bottom - 1; i >= 0; i--) {
        sagi_dd s = sagi_fast_two_sum(down[i], carry);
        carry = s.hi;
        if (is_nonzero(s.lo)) h[count++] = s.lo;
    }
    if (carry != 0) h[count++] = carry;
    return count;
}

int sagi_expansion_from_diff(double a, double b, double *h) {
    sagi_dd s = sagi_two_sum(a, -b);
    int count = 0;
    if (is_nonzero(s.lo)) h[count++] = s.lo;
    if (s.hi != 0) h[count++] = s.hi;
    return count;
}

int sagi_expansion_from_product(double a, double b, double *h) {
    sagi_dd p = sagi_two_prod(a, b);
    int count = 0;
    if (p.lo != 0) h[count++] = p.lo;
    if (p.hi != 0) h[count++] = p.hi;
    return count;
}

double sagi_expansion_estimate(int n, const double *e) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += e[i];
    return sum;
}
