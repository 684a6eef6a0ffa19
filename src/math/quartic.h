// SPDX-License-Identifier: MIT
// Real roots of a quartic f(x) = c₀ + c₁x + c₂x² + c₃x³ + c₄x⁴ in an interval outside whose ends, and at
// them, f is positive; c₄ > 0. By bracketing, never by formulas: between neighbouring roots of f' the
// polynomial is monotone, so the signs of f there say how many roots there are and where, and f' is treated
// the same way through f'' and f'''. A root is never invented and a pair never lost but by the sign of one
// number near 0, and how near that is, is known.
#ifndef SAGI_MATH_QUARTIC_H
#define SAGI_MATH_QUARTIC_H

#include "math/real.h"

// In doubles. sizes[k] ≥ |c[k]| is such that c[k] is good to 20·2⁻⁵³ sizes[k] (the magnitudes of its terms).
// Returns how many roots lie in (low, high) and writes, in order, between which two places each is; or −1
// when the count is not certain: two roots too close together.
int sagi_quartic_brackets(const double c[5], const double sizes[5], double low, double high,
                          double brackets[4][2]);
// The one between these places, an ordinary root good to about 2⁻⁴⁷ Σ sizes[k]|x|ᵏ/|f'(x)|.
double sagi_quartic_root(const double c[5], const double bracket[2]);

// To 400 bits, for those: always an answer. Double roots are written twice, whether f touches 0 from above or
// below; triple ones once. Roots closer than about 2⁻¹⁵⁰ of the interval's size count as one multiple root.
int sagi_quartic_roots_real(const sagi_real c[5], double low, double high, sagi_real roots[4]);

// One Newton iteration after another to 400 bits from a guess of an ordinary root; false when they do not
// settle within a millionth of |low|, |high|'s size around the guess.
bool sagi_quartic_polish_real(const sagi_real c[5], double size, double guess, sagi_real *root);

#endif
