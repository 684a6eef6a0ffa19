// SPDX-License-Identifier: MIT
// The truth about a ray and a quadric, to 512 bits by MPFR: the roots, and which of them the shape's clips
// keep. It knows the equation only, none of the library's code.
#ifndef TESTS_SUPPORT_QUADRIC_TRUTH_H
#define TESTS_SUPPORT_QUADRIC_TRUTH_H

#include <mpfr.h>
#include <sagitta/shapes.h>

#define TRUTH_BITS 512

// A surface F = 0 in y = x − center, cut by the slabs lo ≤ y ≤ hi (±INFINITY: not cut), perhaps swept,
// perhaps closed by the parts of the two z planes with F ≤ 0.
typedef struct quadric_truth {
    mpfr_t q[10]; // a b c d e f g h i j, as in sag_quadric
    sag_vec3 center, slab_center;
    double lo[3], hi[3];
    double phi_max; // 0: full
    bool closed;
    mpfr_t o[3], d[3], a, b, c, root[2], t, x, y, z; // scratch
} quadric_truth;

// What must be found: for each crossing its t; or, where the last bits decide (within a few ulp of an edge of
// a clip or of the ray's range), that it may be found or not.
typedef struct expected {
    int count;
    double t[6];      // in order
    bool optional[6]; // may be missing
} expected;

void quadric_truth_init(quadric_truth *truth);
void quadric_truth_clear(quadric_truth *truth);
// Sets all coefficients to 0, no clips, no centre.
void quadric_truth_reset(quadric_truth *truth);

expected quadric_truth_solve(quadric_truth *truth, const sag_ray *ray);
// The sign of F at a point: exact. *relative, when not NULL, becomes |F| over the sum of its terms'
// magnitudes.
int quadric_truth_sign(quadric_truth *truth, sag_vec3 point, double *relative);
// The direction in which F grows fastest at a point, a unit vector; (0, 0, 0) where there is none.
sag_vec3 quadric_truth_normal(quadric_truth *truth, sag_vec3 point);

// |t − exact| in units in the last place of the exact value.
double ulps_between(double t, double exact);

#endif
