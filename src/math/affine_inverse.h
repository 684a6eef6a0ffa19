// SPDX-License-Identifier: MIT
// Whether a map can be undone, and whether it takes left for right, without undoing it.
#ifndef SAGI_MATH_AFFINE_INVERSE_H
#define SAGI_MATH_AFFINE_INVERSE_H

#include <math.h>
#include <sagitta/math.h>

// Rounding takes less than 2⁻⁴⁹ of the sum of the determinant's six products, all signs taken as plus: a
// determinant beyond 2⁻⁴⁰ of that is not 0. With elements within 2^±100 nothing over- or underflows either:
// the inverse's are below 2⁵⁴². Returns its sign, and 0 where that is not seen.
static inline int sagi_affine_quick_sign(const sag_affine *a) {
    double sum = 0, absolute = 0;
    bool plain = true;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            const double size = fabs(a->m[i][j]);
            plain &= (size <= 0x1p100 && size >= 0x1p-100) || size == 0;
        }
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        const double p = a->m[0][i] * a->m[1][k] * a->m[2][l], q = a->m[0][l] * a->m[1][k] * a->m[2][i];
        sum += p - q;
        absolute += fabs(p) + fabs(q);
    }
    return !plain ? 0 : sum > 0x1p-40 * absolute ? 1 : sum < -0x1p-40 * absolute ? -1 : 0;
}

// Whether sag_affine_inverse has an inverse of it, which is mostly seen at once.
bool sagi_affine_has_inverse(const sag_affine *a);

// Whether its determinant is negative, exactly. (In line, for the formats' library sees only what this one
// exports.)
static inline bool sagi_affine_is_mirror(const sag_affine *a) {
    const int sign = sagi_affine_quick_sign(a);
    return sign ? sign < 0 : sag_affine_determinant(a) < 0;
}

#endif
