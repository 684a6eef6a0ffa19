// SPDX-License-Identifier: MIT
#ifndef SAGI_SHAPES_CARLSON_H
#define SAGI_SHAPES_CARLSON_H

// Carlson's symmetric elliptic integral of the second kind,
//     R_G(x, y, z) = 1/(4π) ∫ over the unit sphere of √(x n_x² + y n_y² + z n_z²),
// for x, y, z ≥ 0, to about 1e-15 of itself.
double sagi_carlson_rg(double x, double y, double z);

#endif
