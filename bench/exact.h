// SPDX-License-Identifier: MIT
// One ray and one primitive, exactly (GMP). The judge of settle.c.
#ifndef BENCH_EXACT_H
#define BENCH_EXACT_H

#include "bench.h"
#include <gmp.h>

typedef struct exact_hit {
    bool touched; // the closed primitive and the ray's range have a point in common
    bool hit;     // Sagitta's rule, which gives each point of a shared edge to one triangle alone
    mpf_t t;      // when touched: of the crossing, to 4,096 bits
} exact_hit;

void exact_init(exact_hit *h);
void exact_clear(exact_hit *h);
void exact_copy(exact_hit *to, const exact_hit *from);

// All coordinates must be floats.
void exact_examine(exact_hit *h, const model *m, const sag_ray *ray, uint32_t primitive);
// False only when the ray certainly misses the primitive: a quick look in double.
bool exact_worth_a_look(const model *m, const sag_ray *ray, uint32_t primitive);

#endif
