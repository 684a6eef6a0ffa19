// SPDX-License-Identifier: MIT
// What textures make of coordinates and noise.
#ifndef SAGI_RENDER_PATTERN_H
#define SAGI_RENDER_PATTERN_H

#include "color.h"
#include "mapping.h"

// The share of the second kind of field of a checkerboard, over the spot's extent.
double sagi_checkerboard_2d(const sagi_spot_2d *at);
double sagi_checkerboard_3d(const sagi_spot_3d *at);
// Whether the point lies in a dot.
bool sagi_in_dot(double s, double t);
double sagi_windy(const sagi_spot_3d *at);
sag_rgb sagi_marble(const sagi_spot_3d *at, double scale, double variation, double omega, int octaves);

#endif
