// SPDX-License-Identifier: MIT
// Trowbridge & Reitz 1975; Walter et al. 2007; Heitz 2014 for the Smith function of the anisotropic form.
//     D(m) = 1/(π αx αy cos⁴θ (1 + e)²),  e = tan²θ (cos²φ/αx² + sin²φ/αy²)
//     Λ(w) = (√(1 + α² tan²θ) − 1)/2,  G1 = 1/(1 + Λ),  G = 1/(1 + Λ(wo) + Λ(wi)).
//
// Normals are drawn from those that w sees, D_w(m) = G1(w)/|cos θ| · D(m) |w·m|: stretched by α, the surface
// becomes a hemisphere, whose visible normals are the half vectors of w with a spherical cap of directions
// that is uniformly sampled (Dupuy & Benyoub 2023).
#include "microfacet.h"

#include "math/map.h"
#include "quick.h"

double sagi_microfacet_d(sagi_microfacet facets, sag_vec3 m) {
    // D with cos⁴ multiplied in: no division by a cosine that may be 0.
    double x = m.x / facets.ax, y = m.y / facets.ay;
    double denominator = x * x + y * y + m.z * m.z;
    return 1 / (SAGI_RENDER_PI * facets.ax * facets.ay * denominator * denominator);
}

static double lambda(sagi_microfacet facets, sag_vec3 w) {
    double z2 = w.z * w.z;
    if (!(z2 > 0)) return INFINITY;
    return (sqrt(1 + (sagi_square(facets.ax * w.x) + sagi_square(facets.ay * w.y)) / z2) - 1) / 2;
}

double sagi_microfacet_g1(sagi_microfacet facets, sag_vec3 w) { return 1 / (1 + lambda(facets, w)); }

double sagi_microfacet_g(sagi_microfacet facets, sag_vec3 wo, sag_vec3 wi) {
    return 1 / (1 + lambda(facets, wo) + lambda(facets, wi));
}

sag_vec3 sagi_microfacet_sample(sagi_microfacet facets, sag_vec3 w, sag_vec2 u) {
    if (w.z < 0) w = sag_neg(w);
    sag_vec3 stretched = sagi_normalize(sag_vec3_make(facets.ax * w.x, facets.ay * w.y, w.z));
    double z = (1 - u.y) * (1 + stretched.z) - stretched.z;
    double s = sqrt(sagi_clamp(1 - z * z, 0, 1));
    double sine, cosine;
    sagi_quick_turn(u.x, &sine, &cosine);
    sag_vec3 half = sag_add(sag_vec3_make(s * cosine, s * sine, z), stretched);
    return sagi_normalize(sag_vec3_make(facets.ax * half.x, facets.ay * half.y, half.z > 0 ? half.z : 0));
}

double sagi_microfacet_value(sagi_microfacet facets, sag_vec3 wo, sag_vec3 wi, sag_vec3 m, double *density) {
    const double d = sagi_microfacet_d(facets, m), shade = 1 + lambda(facets, wo);
    *density = d / (shade * fabs(wo.z));
    return d / (shade + lambda(facets, wi));
}

double sagi_microfacet_pdf(sagi_microfacet facets, sag_vec3 w, sag_vec3 m) {
    return sagi_microfacet_g1(facets, w) / fabs(w.z) * sagi_microfacet_d(facets, m) * fabs(sag_dot(w, m));
}
