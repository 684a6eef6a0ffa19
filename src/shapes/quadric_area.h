// SPDX-License-Identifier: MIT
// Area and uniform sampling of a general quadric in a box.
#ifndef SAGI_SHAPES_QUADRIC_AREA_H
#define SAGI_SHAPES_QUADRIC_AREA_H

#include <sagitta/shapes.h>

double sagi_quadric_area(const sag_quadric *quadric);
// A point of the surface uniform by area, to rounding; false when none was found (the surface is missing from
// the box or nearly so).
bool sagi_quadric_sample_point(const sag_quadric *quadric, sag_vec2 random, sag_vec3 *point);

#endif
