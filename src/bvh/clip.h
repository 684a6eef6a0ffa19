// SPDX-License-Identifier: MIT
// What of a triangle lies between two planes.
#ifndef SAGI_BVH_CLIP_H
#define SAGI_BVH_CLIP_H

#include "bvh/bvh.h"

// Narrows *box, which holds all of a triangle that matters, to a box of what lies between the planes lo and
// hi of the axis; empty when nothing does. corner is the triangle in the units of boxes, |corner| ≤ 1, each
// coordinate off by at most 2⁻⁵². Never cuts off too much (clip.c; tests/unit/test_clip.c).
void sagi_clip_triangle(const double corner[3][3], int axis, float lo, float hi, sagi_float_box *box);

#endif
