// SPDX-License-Identifier: MIT
// What a surface does to light at one point: a material with its textures read, in the point's frame.
// Directions point away from the surface; wo is where the light goes (back along the path), wi where it comes
// from.
#ifndef SAGI_RENDER_BSDF_H
#define SAGI_RENDER_BSDF_H

#include "math/map.h"
#include "microfacet.h"
#include "spectrum.h"

// What belongs to some kinds only is not set for others.
typedef struct sagi_bsdf {
    sagi_spectrum color;  // reflectance
    sagi_spectrum eta, k; // of a metal
    sagi_spectrum base; // of a coat: color with all inner bounces; of diffuse transmission: the transmittance
    sagi_spectrum albedo; // of what is in a coat that is walked through
    sag_vec3 s, t, n;     // shading frame; n on the front
    sag_vec3 geometric;   // unit geometric normal, on the front
    sag_vec3 wo;          // in the shading frame
    double wo_side;       // the sign of wo on the geometric normal
    sagi_microfacet facets;
    double ior; // of glass and coats
    // Of coats, see coated.c: sagi_fresnel_inner_mean, and the material's own.
    double inner_mean, thickness;
    // Of a rough coat with a formula: sagi_coat_table; else the first is NULL and the other of no meaning.
    const float *rough_share, *lit_share;
    // Of coats that are walked through, see layered.c: the coat's facets, the mean cosine of what is in it,
    // and where its random numbers begin.
    sagi_microfacet coat;
    double g;
    uint64_t seed;
    uint32_t walks;
    uint32_t events; // of coats
    sag_material_kind kind;
    bool specular;    // all that it scatters goes to single directions: eval is black, only sample finds it
    bool dispersed;   // ior is that of the first wavelength only
    bool layered;     // a coat that is walked through
    bool lit_as_pbrt; // such a one: as the material's
    // Of coats with a formula, by sagi_coated_turn: F(wo), what of the base's light leaves in that direction,
    // over η², how often the coat is chosen, and 1/η².
    double outer, leaves, coat_share, inverse_ior2;
} sagi_bsdf;

typedef struct sagi_bsdf_sample {
    sag_vec3 wi;          // in the scene's space
    sagi_spectrum weight; // f |cos θ|/pdf
    double pdf;           // per solid angle of all lobes together; of no meaning when specular
    bool specular;        // a single direction
    bool transmission;
    double eta; // of a transmission: the ratio of indices as the path crosses, else 1
} sagi_bsdf_sample;

// What all kinds have, of the default material. (To clear the whole of it takes longer than one thinks.)
static inline void sagi_bsdf_begin(sagi_bsdf *bsdf) {
    bsdf->kind = SAG_MATERIAL_DIFFUSE;
    bsdf->color = (sagi_spectrum){0.5F, 0.5F, 0.5F, 0.5F};
    bsdf->ior = 1.5;
    bsdf->facets = bsdf->coat = (sagi_microfacet){0, 0};
    bsdf->rough_share = NULL;
    bsdf->specular = bsdf->dispersed = bsdf->layered = bsdf->lit_as_pbrt = false;
}
// What a coat with a formula does to light that goes to bsdf->wo; coated.c.
void sagi_coated_turn(sagi_bsdf *bsdf);
// Sets the frame and what belongs to it. `tangent` gives the direction of the frame's s where that matters.
static inline void sagi_bsdf_set_frame(sagi_bsdf *bsdf, sag_vec3 geometric, sag_vec3 shading,
                                       sag_vec3 tangent, sag_vec3 wo) {
    const double side = sag_dot(wo, geometric);
    bsdf->geometric = geometric;
    bsdf->n = shading;
    bsdf->wo_side = side < 0 ? -1 : 1;
    sag_vec3 s, t;
    sagi_frame(shading, &s, &t);
    if (bsdf->facets.ax != bsdf->facets.ay || bsdf->coat.ax != bsdf->coat.ay) {
        const sag_vec3 along = sag_madd(tangent, -sag_dot(tangent, shading), shading);
        const double length = sag_length(along);
        if (length > 0 && isfinite(length)) {
            s = sag_scale(along, 1 / length);
            t = sag_cross(shading, s);
        }
    }
    bsdf->s = s, bsdf->t = t;
    bsdf->wo = sag_vec3_make(sag_dot(wo, s), sag_dot(wo, t), sag_dot(wo, shading));
    if (bsdf->kind == SAG_MATERIAL_COATED_DIFFUSE && !bsdf->layered) sagi_coated_turn(bsdf);
}
// f(wo, wi) |cos θi| and the density with which sample would find wi; black and 0 for specular ones.
sagi_spectrum sagi_bsdf_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf);
// Draws wi. False when the light ends here.
bool sagi_bsdf_sample_wi(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample);
// Roughens mirrors and facets with α < 0.3 to 2α, at least 0.1 and at most 0.3, as pbrt does: a path that was
// scattered before finds lights from here by sampling them, which else it would by rare chance only
// (Kaplanyan & Dachsbacher, "Path Space Regularization for Holistic and Robust Light Transport", Eurographics
// 2013).
void sagi_bsdf_regularize(sagi_bsdf *bsdf);

// The lobes, in the shading frame; used by bsdf.c. Each is as the functions above, wo and wi being local.
sagi_spectrum sagi_diffuse_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf);
sagi_spectrum sagi_conductor_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf);
bool sagi_conductor_sample(const sagi_bsdf *bsdf, sag_vec2 u, sagi_bsdf_sample *sample);
sagi_spectrum sagi_dielectric_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf);
bool sagi_dielectric_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample);
bool sagi_thin_sample(const sagi_bsdf *bsdf, double choose, sagi_bsdf_sample *sample);
sagi_spectrum sagi_layered_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf);
bool sagi_layered_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample);
// Of a rough coat (ior, coat, thickness) over a Lambertian base: how much more passes than through a smooth
// one, at cosines (i + ½)/SAGI_COAT_STEPS; and how much of a lamp's light by pbrt-v4's weights. Returns
// inner_mean.
#define SAGI_COAT_STEPS 32
double sagi_coat_table(const sagi_bsdf *coat, float shares[SAGI_COAT_STEPS], float lit[SAGI_COAT_STEPS]);
// What passes a smooth coat in direction w, w.z > 0, one way, given its reflectance there.
double sagi_coat_transmittance(const sagi_bsdf *bsdf, sag_vec3 w, double reflectance);
// Once color and the coat's numbers are known.
void sagi_coated_prepare(sagi_bsdf *bsdf);
sagi_spectrum sagi_coated_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf);
bool sagi_coated_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample);

#endif
