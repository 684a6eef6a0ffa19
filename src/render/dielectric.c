// SPDX-License-Identifier: MIT
// Glass: a smooth boundary, a thin pane, and a rough boundary of facets (Walter et al. 2007; PBR 4th ed.
// §9.5, §9.7). Light is followed backwards, so what crosses carries the radiance's compression 1/η² with it.
//
// The rough boundary's transmission, with m = ±normalize(wi η' + wo) the facet that bends wo into wi and
// q = (wi·m + wo·m/η')²:   f = D G (1 − F) |wi·m wo·m|/(|cos θi cos θo| q η'²),   dωm/dωi = |wi·m|/q.
#include "bsdf.h"
#include "fresnel.h"

// What eval and pdf have in common: the two lobes' facet is known, `reflected` says which lobe.
static double facet_value(const sagi_bsdf *bsdf, sag_vec3 wi, sag_vec3 m, bool reflected, double eta,
                          double *pdf) {
    sag_vec3 wo = bsdf->wo;
    double cos_o = sag_dot(wo, m), cos_i = sag_dot(wi, m);
    *pdf = 0;
    // Facets seen from behind are in the shade of others.
    if (!(cos_i * wi.z > 0) || !(cos_o * wo.z > 0)) return 0;
    double reflectance = sagi_fresnel_dielectric(cos_o, bsdf->ior);
    double density;
    const double common = sagi_microfacet_value(bsdf->facets, wo, wi, m, &density);
    if (reflected) {
        *pdf = density / 4 * reflectance;
        return common * reflectance / (4 * fabs(wo.z));
    }
    double q = sagi_square(cos_i + cos_o / eta);
    *pdf = density * fabs(cos_o * cos_i) / q * (1 - reflectance);
    return common * (1 - reflectance) * fabs(cos_i * cos_o / (wo.z * q)) / (eta * eta);
}

sagi_spectrum sagi_dielectric_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    sag_vec3 wo = bsdf->wo;
    bool reflected = wi.z * wo.z > 0;
    double eta = reflected ? 1 : wo.z > 0 ? bsdf->ior : 1 / bsdf->ior;
    sag_vec3 m = sagi_normalize(sag_madd(wo, eta, wi));
    if (m.z < 0) m = sag_neg(m);
    if (!(m.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    return sagi_spectrum_all(facet_value(bsdf, wi, m, reflected, eta, pdf));
}

static bool smooth_sample(const sagi_bsdf *bsdf, double choose, sagi_bsdf_sample *sample) {
    sag_vec3 wo = bsdf->wo;
    double reflectance = sagi_fresnel_dielectric(wo.z, bsdf->ior);
    sample->specular = true;
    if (choose < reflectance) {
        sample->wi = sag_vec3_make(-wo.x, -wo.y, wo.z);
        sample->weight = sagi_spectrum_all(1);
        return true;
    }
    if (!sagi_refract(wo, sag_vec3_make(0, 0, 1), bsdf->ior, &sample->eta, &sample->wi)) return false;
    sample->transmission = true;
    sample->weight = sagi_spectrum_all(1 / (sample->eta * sample->eta));
    return true;
}

bool sagi_dielectric_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample) {
    if (bsdf->specular) return smooth_sample(bsdf, choose, sample);
    sag_vec3 wo = bsdf->wo;
    sag_vec3 m = sagi_microfacet_sample(bsdf->facets, wo, u);
    bool reflected = choose < sagi_fresnel_dielectric(sag_dot(wo, m), bsdf->ior);
    double eta = 1;
    if (reflected) {
        sample->wi = sag_madd(sag_neg(wo), 2 * sag_dot(wo, m), m);
        if (!(sample->wi.z * wo.z > 0)) return false;
    } else {
        if (!sagi_refract(wo, m, bsdf->ior, &eta, &sample->wi)) return false;
        if (!(sample->wi.z * wo.z < 0)) return false;
        sample->transmission = true;
        sample->eta = eta;
    }
    const double value = facet_value(bsdf, sample->wi, m, reflected, eta, &sample->pdf);
    if (!(sample->pdf > 0)) return false;
    sample->weight = sagi_spectrum_all(value / sample->pdf);
    return true;
}

bool sagi_thin_sample(const sagi_bsdf *bsdf, double choose, sagi_bsdf_sample *sample) {
    sag_vec3 wo = bsdf->wo;
    // Both faces, all bounces between them: R + T R T + T R³ T + … = R + T² R/(1 − R²).
    double reflectance = sagi_fresnel_dielectric(fabs(wo.z), bsdf->ior);
    if (reflectance < 1)
        reflectance += sagi_square(1 - reflectance) * reflectance / (1 - reflectance * reflectance);
    sample->specular = true;
    sample->weight = sagi_spectrum_all(1);
    sample->transmission = !(choose < reflectance);
    sample->wi = sample->transmission ? sag_neg(wo) : sag_vec3_make(-wo.x, -wo.y, wo.z);
    return true;
}
