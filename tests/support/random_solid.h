// SPDX-License-Identifier: MIT
// Solids of random closed shapes under random trees.
#ifndef TESTS_SUPPORT_RANDOM_SOLID_H
#define TESTS_SUPPORT_RANDOM_SOLID_H

#include "support/random_shape.h"
#include <sagitta/solid.h>

#define RANDOM_SOLID_STEPS 512

// The steps of a random tree over geometries 0 … parts − 1, parts ≤ RANDOM_SOLID_STEPS / 2; returns how many.
uint32_t random_solid_steps(rng *r, uint32_t parts, sag_solid_step steps[RANDOM_SOLID_STEPS]);
// A committed solid of so many parts, with meshes, planes and, to so many levels, solids among them. *tree
// (if not NULL) gets the steps, written to steps[RANDOM_SOLID_STEPS].
sag_scene *random_solid(rng *r, sag_context *context, uint32_t parts, int levels, double size,
                        sag_solid_step *steps, sag_solid *tree);

#endif
