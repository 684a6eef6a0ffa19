// SPDX-License-Identifier: MIT
// The solvers of one instruction set, SOLVERS.
#include "support/triangle_four.h"

static bool one(const sag_ray *ray, double t_max, const sag_vec3 *a, const sag_vec3 *b, const sag_vec3 *c,
                double *t, double *u, double *v) {
    return sagi_triangle_solve_here(ray, t_max, sagi_d4_load3(&a->x), sagi_d4_load3(&b->x),
                                    sagi_d4_load3(&c->x), t, u, v);
}
static uint32_t four(sagi_triangle_four *all, uint32_t lanes) { return sagi_triangle_solve4(all, lanes); }
const triangle_solvers SOLVERS = {one, four};
