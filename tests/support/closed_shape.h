// SPDX-License-Identifier: MIT
// Random closed shapes, as solids are made of.
#ifndef TESTS_SUPPORT_CLOSED_SHAPE_H
#define TESTS_SUPPORT_CLOSED_SHAPE_H

#include "support/random_shape.h"

// One of about the given size near 0, of any kind that a solid takes: in general position, or with all its
// numbers multiples of size/4. It may not be valid (a skew box without volume). *shape must not move.
void closed_shape_make(rng *r, double size, bool lattice, random_shape *shape);
void closed_shape_copy(random_shape *to, const random_shape *from);
// A point of [-size, size]³ whose coordinates are multiples of size/4.
sag_vec3 lattice_point(rng *r, double size);

#endif
