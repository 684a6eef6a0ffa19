// SPDX-License-Identifier: MIT
// The box of the image of a box. A linear map takes its extremes over a box at corners, coordinate by
// coordinate (Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics Gems, 1990):
//     low  = t + Σ min(m·min, m·max),    high = t + Σ max(m·min, m·max),
// where m = 0 contributes nothing, though the box be infinite there.
//
// Rounding: each of the three products and three sums is off by a factor 1 ± 2⁻⁵³ at most, so the sum is
// within 4·2⁻⁵³·(|t| + Σ|m·x|)·(1 + 2⁻⁴⁰) of the exact one; the bound used is twice that. When all of them
// turn out exact (an identity, a right-angle turn, a move by round numbers) nothing is added and the box
// keeps its bits.
#include "math/dd.h"
#include <float.h>
#include <sagitta/math.h>

// Below this a product's rounding error may itself be flushed.
#define SMALLEST_EXACT 0x1p-900

// One bound: `sign` is −1 for the low one, 1 for the high one; works on the mirrored problem so that both are
// a maximum.
static double bound(const double row[4], const double min[3], const double max[3], double sign) {
    double sum = sign * row[3], magnitude = fabs(row[3]);
    bool exact = true;
    for (int j = 0; j < 3; j++) {
        double m = sign * row[j];
        if (m == 0) continue;
        double x = m > 0 ? max[j] : min[j];
        if (x == 0) continue;
        double product = m * x;
        if (product == INFINITY) return sign * INFINITY;
        if (product == -INFINITY) product = -DBL_MAX; // overflow; what it stands for is less still
        exact = exact && fabs(product) >= SMALLEST_EXACT && fma(m, x, -product) == 0;
        magnitude += fabs(product);
        sagi_dd s = sagi_two_sum(sum, product);
        exact = exact && s.lo == 0;
        sum = s.hi;
    }
    if (exact) return sign * sum;
    if (!(magnitude <= DBL_MAX / 4))
        return sign * INFINITY; // too near overflow for the bound to hold; NaN too
    return sign * nextafter(sum + 8 * 0x1p-53 * magnitude, INFINITY);
}

sag_box3 sag_affine_box(const sag_affine *a, const sag_box3 *box) {
    if (sag_box3_is_empty(box)) return sag_box3_empty();
    const double min[3] = {box->min.x, box->min.y, box->min.z};
    const double max[3] = {box->max.x, box->max.y, box->max.z};
    return (sag_box3){
        .min = {bound(a->m[0], min, max, -1), bound(a->m[1], min, max, -1), bound(a->m[2], min, max, -1)},
        .max = {bound(a->m[0], min, max, 1), bound(a->m[1], min, max, 1), bound(a->m[2], min, max, 1)},
    };
}
