// SPDX-License-Identifier: MIT
// Perlin's gradient noise and the sums of octaves that textures are made of.
#ifndef SAGI_RENDER_NOISE_H
#define SAGI_RENDER_NOISE_H

#include <sagitta/math.h>

// Gradient noise in about [−1, 1], 0 at whole coordinates, twice continuously differentiable, of period 256
// in each coordinate. Not finite in, 0 out.
double sagi_noise(sag_vec3 p);
// In the plane z = 1/2, as pbrt takes noise of two coordinates.
double sagi_noise_2d(double x, double y);

// Σ ωⁱ noise(1.99ⁱ p) over `octaves` terms, fewer where the footprint (how p changes from one pixel to the
// next) is so wide that the higher ones would alias.
double sagi_noise_fbm(sag_vec3 p, sag_vec3 dpdx, sag_vec3 dpdy, double omega, int octaves);
// The same of |noise|; what is left out counts as its mean.
double sagi_noise_turbulence(sag_vec3 p, sag_vec3 dpdx, sag_vec3 dpdy, double omega, int octaves);

#endif
