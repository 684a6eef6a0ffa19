// SPDX-License-Identifier: MIT
// Ray against triangle in MPFR, with so many bits that every sum and product is exact: the oracle.
#ifndef TESTS_SUPPORT_EXACT_TRIANGLE_H
#define TESTS_SUPPORT_EXACT_TRIANGLE_H

#include <sagitta/shapes.h>

typedef struct exact_triangle {
    int side;       // −1, 0, 1 as sagi_triangle_side; ties by really moving the origin by (ε, ε², ε³)
    bool tie;       // the line meets an edge's line
    double t, u, v; // rounded to nearest, when side is not 0
    double t_error_ulp; // of the t asked about, in units of the last place of the true one
} exact_triangle;

// Examines the line of the ray (its t_min and t_max are not looked at); `t` is the value whose error is
// wanted. Aborts when 5,000 bits do not suffice.
exact_triangle exact_triangle_examine(const sag_ray *ray, sag_vec3 a, sag_vec3 b, sag_vec3 c, double t);

// Gives MPFR's memory back, so that leak checkers are content.
void exact_triangle_end(void);

#endif
