// SPDX-License-Identifier: MIT
// Vectors of exact fractions (GMP) and the convex clip, for oracles.
#ifndef TESTS_SUPPORT_FRACTIONS_H
#define TESTS_SUPPORT_FRACTIONS_H

#include "support/crossing_truth.h"

typedef mpq_t fraction3[3];

void fraction3_init(fraction3 v);
void fraction3_clear(fraction3 v);
void fraction3_set(fraction3 out, sag_vec3 v);
// a − b
void fraction3_set_diff(fraction3 out, sag_vec3 a, sag_vec3 b);
void fraction3_dot(mpq_t out, fraction3 a, fraction3 b);
void fraction3_cross(fraction3 out, fraction3 a, fraction3 b); // out is not a or b

// The part of a ray's line with t·den ≤ num for each of a number of faces, one after another.
typedef struct fraction_clip {
    mpq_t enter, leave, t;
    bool has_enter, has_leave, empty;
} fraction_clip;

void fraction_clip_init(fraction_clip *clip);
void fraction_clip_clear(fraction_clip *clip);
void fraction_clip_reset(fraction_clip *clip);
void fraction_clip_by(fraction_clip *clip, mpq_t num, mpq_t den);
void fraction_clip_add(fraction_clip *clip, const sag_ray *ray, crossing_truth *truth);

#endif
