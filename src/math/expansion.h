// SPDX-License-Identifier: MIT
// Expansions: exact sums of doubles, after Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast
// Robust Geometric Predicates", Discrete & Computational Geometry 18(3), 1997.
//
// An expansion is an array of doubles in order of increasing magnitude, none overlapping another; its value
// is their exact sum. Zero components are left out, so a count of 0 is the number 0, and the last component
// has the sign of the whole. Every function returns the number of components written to `h`, which must not
// alias the inputs. All are exact unless something overflows (beyond about 2¹⁰²³) or a product's low half
// underflows (below about 2⁻¹⁰²²).
#ifndef SAGI_MATH_EXPANSION_H
#define SAGI_MATH_EXPANSION_H

// e + f. Room needed in h: n + m.
int sagi_expansion_sum(int n, const double *e, int m, const double *f, double *h);
// e − f. Room needed in h: n + m; at most 256 components in f.
int sagi_expansion_diff(int n, const double *e, int m, const double *f, double *h);
// e · b. Room needed in h: 2n.
int sagi_expansion_scale(int n, const double *e, double b, double *h);
// e · f. Room needed in h: 2nm, at most 512.
int sagi_expansion_product(int n, const double *e, int m, const double *f, double *h);
// The same value in as few components as can be, each the rounding of what it and those below it add up to.
// Room: n.
int sagi_expansion_compress(int n, const double *e, double *h);
// a − b and a · b of two doubles. Room: 2.
int sagi_expansion_from_diff(double a, double b, double *h);
int sagi_expansion_from_product(double a, double b, double *h);

// −1, 0 or 1: exact.
static inline int sagi_expansion_sign(int n, const double *e) { return n == 0 ? 0 : e[n - 1] > 0 ? 1 : -1; }
// The value to within one ulp.
double sagi_expansion_estimate(int n, const double *e);

#endif
