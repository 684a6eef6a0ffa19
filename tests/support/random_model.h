// SPDX-License-Identifier: MIT
// Random models of solids (solid_model.h), and rays to ask them.
#ifndef TESTS_SUPPORT_RANDOM_MODEL_H
#define TESTS_SUPPORT_RANDOM_MODEL_H

#include "support/adversarial.h"
#include "support/closed_shape.h"
#include "support/solid_model.h"

typedef struct solid_recipe {
    double size;      // the parts lie within about this of 0; a power of two when `lattice`
    uint32_t leaves;  // parts at most, those of children not counted
    uint32_t depth;   // of the tree, at most
    uint32_t nesting; // how many levels of solids below
    bool lattice;     // all coordinates and maps are multiples of size/4, so that faces coincide and touch
    bool unmapped;    // no maps: every question is answered exactly
} solid_recipe;

// Finished (solid_model_finish); fails the test when the library refuses it.
solid_model *random_model_make(rng *r, sag_context *context, const solid_recipe *how);

enum { SOLID_POINTS = 64 };
// Special points of the parts, for adversarial_ray; returns how many (at least one, at most SOLID_POINTS).
uint32_t random_model_points(rng *r, const solid_model *model, sag_vec3 points[SOLID_POINTS]);
// A ray at it; *random says that nothing about it is special.
sag_ray random_model_ray(rng *r, const solid_recipe *how, const adversary *a, bool *random);

#endif
