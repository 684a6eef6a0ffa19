// SPDX-License-Identifier: MIT
// Determinants of three vectors whose coordinates are differences of doubles, three times over: in double
// with an error bound (the filter), in double-double with an error bound (for distances), and to 400 bits
// (for what the others cannot tell). Coordinates are exact double-doubles: a difference of two doubles always
// is one.
//
//     det(a, b, c) = a·(b×c) = Σ aᵢ (bⱼ cₖ − bₖ cⱼ),   permanent P = Σ |aᵢ| (|bⱼ cₖ| + |bₖ cⱼ|)
//
// In double each coordinate is off by u = 2⁻⁵³ relative (three a product), two products, one difference and
// two sums add six more: the error is at most 9u(1 + O(u)) P ≤ 10u P. In double-double a product is off by at
// most 5·2⁻¹⁰⁶ and a sum by 3·2⁻¹⁰⁶ relative (dd.h): two products and three sums make 19·2⁻¹⁰⁶ P < 2⁻¹⁰¹ P.
#ifndef SAGI_MATH_DETERMINANT_H
#define SAGI_MATH_DETERMINANT_H

#include "math/dd.h"
#include "math/real.h"
#include <sagitta/math.h>

typedef struct sagi_dd3 {
    sagi_dd x, y, z;
} sagi_dd3;

static inline sagi_dd3 sagi_dd3_from(sag_vec3 a) { return (sagi_dd3){{a.x, 0}, {a.y, 0}, {a.z, 0}}; }

// a − b exactly.
static inline sagi_dd3 sagi_dd3_from_diff(sag_vec3 a, sag_vec3 b) {
    return (sagi_dd3){sagi_two_sum(a.x, -b.x), sagi_two_sum(a.y, -b.y), sagi_two_sum(a.z, -b.z)};
}

static inline sag_vec3 sagi_dd3_round(sagi_dd3 a) { return sag_vec3_make(a.x.hi, a.y.hi, a.z.hi); }

// The determinant in double; *error bounds its absolute error.
double sagi_determinant(sag_vec3 a, sag_vec3 b, sag_vec3 c, double *error);
// The same in double-double.
sagi_dd sagi_determinant_dd(sagi_dd3 a, sagi_dd3 b, sagi_dd3 c, double *error);
// The same to 400 bits of the permanent, which is exact for coordinates within 2¹⁰⁰ of each other.
sagi_real sagi_determinant_real(sagi_dd3 a, sagi_dd3 b, sagi_dd3 c);

// a × b, each coordinate to within an ulp or so, also for nearly parallel vectors.
sag_vec3 sagi_cross_accurate(sag_vec3 a, sag_vec3 b);

// a·b in double-double; the error is at most 2⁻¹⁰³ Σ|aᵢ bᵢ|.
sagi_dd sagi_dot_dd(sagi_dd3 a, sagi_dd3 b);
// a·b of an exact difference and doubles to 400 bits.
sagi_real sagi_dot_real(sagi_dd3 a, sagi_dd3 b);

#endif
