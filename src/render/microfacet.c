// SPDX-License-Identifier: MIT
// Trowbridge & Reitz 1975; Walter et al. 2007; Heitz 2014 for the Smith function of the anisotropic form.
//     D(m) = 1/(π αx αy cos⁴θ (1 + e)²),  e = tan²θ (cos²φ/αx² + sin²φ/αy²)
//     Λ(w) = (√(1 + α² tan²θ) − 1)/2,  G1 = 1/(1 + Λ),  G = 1/(1 + Λ(wo) + Λ(wi)).
// With r(w) = √(cos²θ + α² sin²θ), the length of w stretched by α, and z = |cos θ|, Λ = (r/z − 1)/2, so that
//     G1/z = 2/(z + r),  G = 2 zo zi/(ro zi + ri zo),
// and D, times what α there is, has one division too.
//
// Normals are drawn from those that w sees, D_w(m) = G1(w)/|cos θ| · D(m) |w·m|: stretched by α, the surface
// becomes a hemisphere, whose visible normals are the half vectors of w with a spherical cap of directions
// that is uniformly sampled (Dupuy & Benyoub 2023).
#include "microfacet.h"

#include "math/map.h"
#include "quick.h"

double sagi_microfacet_d(sagi_microfacet facets, sag_vec3 m) {
    // D with cos⁴ multiplied in: no division by a cosine that may be 0.
    const double product = facets.ax * facets.ay, x = m.x * facets.ay, y = m.y * facets.ax, z = m.z * product;
    const double denominator = x * x + y * y + z * z;
    return product * product * product / (SAGI_RENDER_PI * denominator * denominator);
}

static inline double stretched_length(sagi_microfacet facets, sag_vec3 w) {
    return sqrt(w.z * w.z + (sagi_square(facets.ax * w.x) + sagi_square(facets.ay * w.y)));
}

double sagi_microfacet_g1(sagi_microfacet facets, sag_vec3 w) {
    const double z = fabs(w.z);
    return 2 * z / (z + stretched_length(facets, w));
}

double sagi_microfacet_g(sagi_microfacet facets, sag_vec3 wo, sag_vec3 wi) {
    const double o = fabs(wo.z), i = fabs(wi.z);
    return 2 * o * i / (stretched_length(facets, wo) * i + stretched_length(facets, wi) * o);
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
    const double d = sagi_microfacet_d(facets, m), o = fabs(wo.z), i = fabs(wi.z);
    const double stretched = stretched_length(facets, wo);
    *density = 2 * d / (o + stretched);
    return 2 * d * o * i / (stretched * i + stretched_length(facets, wi) * o);
}

double sagi_microfacet_pdf(sagi_microfacet facets, sag_vec3 w, sag_vec3 m) {
    return 2 * sagi_microfacet_d(facets, m) * fabs(sag_dot(w, m)) / (fabs(w.z) + stretched_length(facets, w));
}
