// SPDX-License-Identifier: MIT
// sagi_triangle_solve_here and sagi_triangle_solve4 as the kernels of each instruction set have them.
#ifndef TESTS_SUPPORT_TRIANGLE_FOUR_H
#define TESTS_SUPPORT_TRIANGLE_FOUR_H

#include "shapes/triangle_solve.h"

typedef struct triangle_solvers { // NULL: not built
    bool (*one)(const sag_ray *ray, double t_max, const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c,
                double *t, double *u, double *v);
    uint32_t (*four)(sagi_triangle_four *four, uint32_t lanes);
} triangle_solvers;
extern const triangle_solvers triangle_solvers_portable, triangle_solvers_avx2, triangle_solvers_avx512;

#endif
