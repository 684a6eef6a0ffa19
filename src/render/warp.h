// SPDX-License-Identifier: MIT
// Random numbers turned into points and directions: each says the density it has.
#ifndef SAGI_RENDER_WARP_H
#define SAGI_RENDER_WARP_H

#include "color.h"

// Uniform on the unit disk, neighbours staying neighbours (Shirley & Chiu 1997). Density 1/π.
sag_vec2 sagi_warp_disk(sag_vec2 u);
// On the unit hemisphere z ≥ 0, density cos θ/π (Malley: the disk lifted up).
sag_vec3 sagi_warp_cosine(sag_vec2 u);
// Uniform on the unit sphere, density 1/4π (Archimedes: the sphere's area is that of its cylinder).
sag_vec3 sagi_warp_sphere(sag_vec2 u);
// On the unit square with a density in proportion to weights > 0 at the corners (0, 0), (1, 0), (0, 1), (1,
// 1) and bilinear between; and that density.
sag_vec2 sagi_warp_bilinear(const double weights[4], sag_vec2 u);
double sagi_warp_bilinear_pdf(const double weights[4], sag_vec2 p);
// In [−radius, radius], density (1 − |x|/radius)/radius.
double sagi_warp_tent(double u, double radius);
// The unit square to the unit sphere and back, areas kept in proportion 4π: Clarberg's octahedral mapping
// (JGT 13(1), 2008), as pbrt-v4 lays its sky pictures. (½, ½) is +z.
sag_vec3 sagi_equal_area_to_sphere(sag_vec2 p);
sag_vec2 sagi_equal_area_from_sphere(sag_vec3 d);

#endif
