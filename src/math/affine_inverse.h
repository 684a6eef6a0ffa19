// SPDX-License-Identifier: MIT
// Whether a map can be undone, without undoing it.
#ifndef SAGI_MATH_AFFINE_INVERSE_H
#define SAGI_MATH_AFFINE_INVERSE_H

#include <sagitta/math.h>

// Whether sag_affine_inverse has an inverse of it, which is mostly seen at once.
bool sagi_affine_has_inverse(const sag_affine *a);
// Whether its determinant is negative, exactly: it takes left for right.
bool sagi_affine_is_mirror(const sag_affine *a);

#endif
