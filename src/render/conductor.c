// SPDX-License-Identifier: MIT
// Metals: what is not reflected is absorbed. Smooth: a mirror with Fresnel's complex index. Rough: facets of
// such mirrors (Torrance & Sparrow), f = D G F/(4 |cos θo cos θi|), single scattering.
#include "bsdf.h"
#include "fresnel.h"

sagi_spectrum sagi_conductor_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    sag_vec3 wo = bsdf->wo;
    if (!(wi.z * wo.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    sag_vec3 m = sagi_normalize(sag_add(wo, wi));
    if (m.z < 0) m = sag_neg(m);
    if (!(m.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    double density;
    const double value = sagi_microfacet_value(bsdf->facets, wo, wi, m, &density);
    *pdf = density / 4;
    return sagi_fresnel_conductor_spectrum(fabs(sag_dot(wo, m)), bsdf->eta, bsdf->k) *
           (float)(value / (4 * fabs(wo.z)));
}

bool sagi_conductor_sample(const sagi_bsdf *bsdf, sag_vec2 u, sagi_bsdf_sample *sample) {
    sag_vec3 wo = bsdf->wo;
    if (bsdf->specular) {
        sample->wi = sag_vec3_make(-wo.x, -wo.y, wo.z);
        sample->weight = sagi_fresnel_conductor_spectrum(wo.z, bsdf->eta, bsdf->k);
        sample->specular = true;
        return true;
    }
    sag_vec3 m = sagi_microfacet_sample(bsdf->facets, wo, u);
    sag_vec3 wi = sag_madd(sag_neg(wo), 2 * sag_dot(wo, m), m);
    if (!(wi.z * wo.z > 0)) return false;
    double density;
    const double value = sagi_microfacet_value(bsdf->facets, wo, wi, m, &density);
    sample->wi = wi;
    sample->pdf = density / 4;
    // f |cos θi|/pdf = F D G/(4 |cos θo|)/pdf
    const double ratio = value / (fabs(wo.z) * density);
    sample->weight = sagi_fresnel_conductor_spectrum(fabs(sag_dot(wo, m)), bsdf->eta, bsdf->k) * (float)ratio;
    return true;
}
