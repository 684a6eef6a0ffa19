// SPDX-License-Identifier: MIT
// Where a ray meets a torus.
#ifndef SAGI_SHAPES_TORUS_H
#define SAGI_SHAPES_TORUS_H

#include "shapes/cut.h"

// Finds the crossings in the ray's range in order, at most `most` of them (≤ 4), and returns how many. The
// ray must be valid; radii finite, major ≥ 0, minor > 0. A tangent counts twice. cuts[i].t.hi is the t.
int sagi_torus_crossings(const sag_torus *torus, const sag_ray *ray, int most, sagi_cut cuts[4]);

// t to more than a double, from a double t that sagi_torus_crossings found.
sagi_cut sagi_torus_refine(const sag_torus *torus, const sag_ray *ray, double t);

#endif
