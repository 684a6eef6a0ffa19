// SPDX-License-Identifier: MIT
// Metals: what is not reflected is absorbed. Smooth: a mirror with Fresnel's complex index. Rough: facets of
// such mirrors (Torrance & Sparrow), f = D G F/(4 |cos θo cos θi|), single scattering.
#include "bsdf.h"
#include "fresnel.h"

sagi_spectrum sagi_conductor_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    sag_vec3 wo = bsdf->wo;
    if (!(wi.z * wo.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    sag_vec3 m = sag_normalize(sag_add(wo, wi));
    if (m.z < 0) m = sag_neg(m);
    if (!(m.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    double cos_m = fabs(sag_dot(wo, m));
    *pdf = sagi_microfacet_pdf(bsdf->facets, wo, m) / (4 * cos_m);
    double scale =
        sagi_microfacet_d(bsdf->facets, m) * sagi_microfacet_g(bsdf->facets, wo, wi) / (4 * fabs(wo.z));
    return sagi_fresnel_conductor_spectrum(cos_m, bsdf->eta, bsdf->k) * (float)scale;
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
    double cos_m = fabs(sag_dot(wo, m));
    sample->wi = wi;
    sample->pdf = sagi_microfacet_pdf(bsdf->facets, wo, m) / (4 * cos_m);
    // f |cos θi|/pdf = F G/G1: everything else cancels.
    double ratio = sagi_microfacet_g(bsdf->facets, wo, wi) / sagi_microfacet_g1(bsdf->facets, wo);
    sample->weight = sagi_fresnel_conductor_spectrum(cos_m, bsdf->eta, bsdf->k) * (float)ratio;
    return true;
}
