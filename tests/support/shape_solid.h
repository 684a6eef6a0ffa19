// SPDX-License-Identifier: MIT
// Solids of random closed shapes, meshes and smaller solids under random trees.
#ifndef TESTS_SUPPORT_SHAPE_SOLID_H
#define TESTS_SUPPORT_SHAPE_SOLID_H

#include "support/random.h"
#include <sagitta/solid.h>

#define SHAPE_SOLID_PARTS 8 // at most

// A solid and what it was made of.
typedef struct shape_solid {
    sag_scene *scene; // committed; the caller destroys it
    sag_solid_step steps[2 * SHAPE_SOLID_PARTS];
    uint32_t step_count;
    const struct shape_solid *shown[SHAPE_SOLID_PARTS]; // by parts that are instances
} shape_solid;

// Some parts are instances of `smaller`, when it is not NULL. (A tree of n parts has fewer than 2 n steps: an
// operation has two operands or more, but perhaps the topmost.)
void shape_solid_make(rng *r, sag_context *context, shape_solid *solid, double size,
                      const shape_solid *smaller);

#endif
