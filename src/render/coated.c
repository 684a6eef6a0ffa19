// SPDX-License-Identifier: MIT
// Plastic: a Lambertian base ρ under a clear coat of index η. Light that the coat lets in (1 − F(θi)) spreads
// in the base and bounces below the coat, whose inner side returns the share r of diffuse light each time,
// until it gets out at 1 − F(θo):
//     f = (1 − F(θi)) (1 − F(θo)) ρ/(π η² (1 − ρ r)),   r = 1 − (1 − mean F)/η²
// (1/η² because radiance inside is compressed). Integrated over wi this is (1 − F(θo)) ρ (1 − r)/(1 − ρ r):
// with the coat's own F(θo) exactly 1 for ρ = 1, so nothing is lost or made. A rough coat replaces the mirror
// by facets. A Lambertian base forgets where light came from, so the rest keeps its form: what passes one way
// and r are other functions of the angle, tabulated for each material (layered.c).
//
// pbrt-v4 makes a random walk of it that loses a little more, and pictures are compared with its: the coat
// absorbs exp(−τ/μ') on each way through (τ its thickness, μ' the cosine inside), so that r becomes ∫ F
// e^(−2τ/μ) 2μ dμ; and the walk ends, so that 1/(1 − ρr) = 1 + ρr + (ρr)² + … has N terms. With τ = 0 and N =
// 0 (meaning ∞) it is the lossless coat above. Moreover, the light of lamps that are sampled comes through a
// rough coat there by other shares than it should (layered.c); on request it does so here.
#include "bsdf.h"
#include "fresnel.h"
#include "math/elementary.h"
#include "warp.h"

// The sum of the first `terms` powers of x, all for 0; 0 ≤ x < 1.
static sagi_spectrum bounces_sum(sagi_spectrum x, uint32_t terms) {
    sagi_spectrum power = {1, 1, 1, 1}, square = x;
    if (terms == 0) return 1 / (1 - x);
    for (uint32_t rest = terms; rest != 0; rest >>= 1, square *= square)
        if (rest & 1) power *= square;
    return (1 - power) / (1 - x);
}

void sagi_coated_prepare(sagi_bsdf *bsdf) {
    bsdf->base =
        bsdf->color * bounces_sum(bsdf->color * (float)bsdf->inner_mean, bsdf->events / 2 + bsdf->events % 2);
}

// exp x for x ≤ 0, most often near 0, where Taylor's series is good to 2⁻⁵³.
static inline double decay(double x) {
    if (!(x > -0.0625)) return sagi_exp(x);
    const double x2 = x * x, x4 = x2 * x2;
    const double low = (1 + x) + x2 * (1.0 / 2 + x * (1.0 / 6));
    const double high = (1.0 / 24 + x * (1.0 / 120)) + x2 * (1.0 / 720 + x * (1.0 / 5040));
    return low + x4 * (high + x4 * (1.0 / 40320));
}

double sagi_coat_transmittance(const sagi_bsdf *bsdf, sag_vec3 w, double reflectance) {
    if (!(bsdf->thickness > 0)) return 1 - reflectance;
    const double sine2 = 1 - w.z * w.z, inside = sqrt(1 - (sine2 < 1 ? sine2 : 1) / (bsdf->ior * bsdf->ior));
    return (1 - reflectance) * decay(-bsdf->thickness / inside);
}

// The same at a cosine > 0, smooth or rough, with the reflectance: all of it by one division, as eval is
// asked twice at each surface. (Fresnel's equations as in fresnel.c, their two denominators and cos θt
// together.)
static inline double transmittance(const sagi_bsdf *bsdf, const float *shares, double cosine,
                                   double *reflectance) {
    const double eta = bsdf->ior, sin2_t = (1 - cosine * cosine) * bsdf->inverse_ior2;
    *reflectance = 1;
    if (!(sin2_t < 1)) return 0;
    const double cos_t = sqrt(1 - sin2_t);
    const double parallel = eta * cosine + cos_t, perpendicular = cosine + eta * cos_t;
    const double product = parallel * perpendicular, inverse = 1 / (product * cos_t);
    const double a = (eta * cosine - cos_t) * perpendicular, b = (cosine - eta * cos_t) * parallel;
    const double scale = cos_t * inverse;
    *reflectance = (a * a + b * b) * (scale * scale) / 2;
    double smooth = 1 - *reflectance;
    if (bsdf->thickness > 0) smooth *= decay(-bsdf->thickness * (product * inverse));
    if (!bsdf->rough_share) return smooth;
    const double x = sagi_clamp(cosine * SAGI_COAT_STEPS - 0.5, 0, SAGI_COAT_STEPS - 1);
    const int i = x < SAGI_COAT_STEPS - 2 ? (int)x : SAGI_COAT_STEPS - 2;
    const double share = (double)shares[i] * (1 - (x - i)) + (double)shares[i + 1] * (x - i);
    // What pbrt-v4 finds of a lamp may be more than there is.
    return smooth * share < 1 || shares != bsdf->rough_share ? smooth * share : 1;
}

static double coat_probability(const sagi_bsdf *bsdf, double reflectance) {
    double base_share = (1 - reflectance) * (double)sagi_spectrum_max(bsdf->base) * (1 - bsdf->inner_mean);
    // In proportion to what each gives back, but the coat, which may show a bright light, never seldom.
    return sagi_clamp(reflectance / (reflectance + base_share), 0.1, 1);
}

void sagi_coated_turn(sagi_bsdf *bsdf) {
    bsdf->inverse_ior2 = 1 / (bsdf->ior * bsdf->ior);
    bsdf->leaves =
        transmittance(bsdf, bsdf->rough_share, fabs(bsdf->wo.z), &bsdf->outer) * bsdf->inverse_ior2;
    bsdf->coat_share = coat_probability(bsdf, bsdf->outer);
}

// The coat is the same from both sides: both directions are turned up.
static sag_vec3 upward(const sagi_bsdf *bsdf, sag_vec3 w) { return bsdf->wo.z < 0 ? sag_neg(w) : w; }

// `shares`: of the light that comes in.
static sagi_spectrum eval_upward(const sagi_bsdf *bsdf, const float *shares, sag_vec3 wo, sag_vec3 wi,
                                 double *pdf) {
    double ignored;
    const double coat = bsdf->coat_share,
                 through = bsdf->leaves * transmittance(bsdf, shares, wi.z, &ignored);
    const sagi_spectrum value = bsdf->base * (float)(through * wi.z * SAGI_INV_PI);
    *pdf = (1 - coat) * wi.z * SAGI_INV_PI;
    if (!(bsdf->facets.ax > 0)) return value;
    const sag_vec3 m = sagi_normalize(sag_add(wo, wi));
    double density;
    const double facets = sagi_microfacet_value(bsdf->facets, wo, wi, m, &density) / (4 * wo.z);
    *pdf += coat * density / 4;
    return value + (float)(facets * sagi_fresnel_dielectric(sag_dot(wo, m), bsdf->ior));
}

sagi_spectrum sagi_coated_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    if (!(wi.z * bsdf->wo.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    return eval_upward(bsdf, bsdf->lit_share, upward(bsdf, bsdf->wo), upward(bsdf, wi), pdf);
}

bool sagi_coated_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample) {
    sag_vec3 wo = upward(bsdf, bsdf->wo), wi;
    if (choose < bsdf->coat_share) {
        if (!(bsdf->facets.ax > 0)) {
            sample->wi = upward(bsdf, sag_vec3_make(-wo.x, -wo.y, wo.z));
            sample->weight = sagi_spectrum_all(bsdf->outer / bsdf->coat_share);
            sample->specular = true;
            return true;
        }
        sag_vec3 m = sagi_microfacet_sample(bsdf->facets, wo, u);
        wi = sag_madd(sag_neg(wo), 2 * sag_dot(wo, m), m);
    } else {
        wi = sagi_warp_cosine(u);
    }
    if (!(wi.z > 0)) return false;
    const sagi_spectrum value = eval_upward(bsdf, bsdf->rough_share, wo, wi, &sample->pdf);
    if (!(sample->pdf > 0)) return false;
    sample->weight = value * (float)(1 / sample->pdf);
    sample->wi = upward(bsdf, wi);
    return true;
}
