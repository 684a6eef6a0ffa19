// SPDX-License-Identifier: MIT
// Solids whose volume and area are known by a formula.
#ifndef TESTS_SUPPORT_KNOWN_SOLIDS_H
#define TESTS_SUPPORT_KNOWN_SOLIDS_H

#include <sagitta/solid.h>

typedef struct known_solid {
    const char *name;
    sag_scene *(*make)(sag_context *context); // committed
    double reach;                             // it lies in the ball of this radius around 0
    double volume, area;                      // area 0: no formula
} known_solid;

// Writes the first `capacity` of them; returns how many there are.
size_t known_solids(known_solid *list, size_t capacity);

#endif
