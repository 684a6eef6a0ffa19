// SPDX-License-Identifier: MIT
// Rough surfaces as many small mirrors: the Trowbridge–Reitz (GGX) distribution of their normals. Directions
// are in the shading frame, z along the normal.
#ifndef SAGI_RENDER_MICROFACET_H
#define SAGI_RENDER_MICROFACET_H

#include "color.h"

// Below this α the facets' highlight is narrower than anything a picture shows: a mirror (as pbrt has it).
#define SAGI_SMOOTH_ALPHA 1e-3

typedef struct sagi_microfacet {
    double ax, ay; // roughness α along the frame's x and y, > 0
} sagi_microfacet;

// Density of facet normals m (m.z > 0) per projected area.
double sagi_microfacet_d(sagi_microfacet facets, sag_vec3 m);
// Smith's masking of direction w, and the joint masking and shadowing of two directions (height-correlated).
double sagi_microfacet_g1(sagi_microfacet facets, sag_vec3 w);
double sagi_microfacet_g(sagi_microfacet facets, sag_vec3 wo, sag_vec3 wi);
// A facet normal as seen from w (w.z ≠ 0; below the surface it is mirrored up), and its density per solid
// angle.
// D G, and what the density of m is in proportion to |w·m|: both at once, for they have most in common.
double sagi_microfacet_value(sagi_microfacet facets, sag_vec3 wo, sag_vec3 wi, sag_vec3 m, double *density);
sag_vec3 sagi_microfacet_sample(sagi_microfacet facets, sag_vec3 w, sag_vec2 u);
double sagi_microfacet_pdf(sagi_microfacet facets, sag_vec3 w, sag_vec3 m);

#endif
