// SPDX-License-Identifier: MIT
// The frame of a scattering point, the choice among materials, and the diffuse ones.
//
// Two normals meet here. Where the ray goes on, and through which medium, the geometric one decides; what is
// scattered, and whether a direction is a reflection or goes through, the shading normal alone, as in
// pbrt-v4. Where the two disagree (at the rims of coarse meshes, on bumps seen from low) light may be sent
// behind the true surface. In closed bodies it finds the inside there; a single sheet with bent normals is
// lit a little from behind. Dropping such directions would cost energy: white would not be white in a white
// furnace (test_furnace_scenes).
#include "bsdf.h"

#include "warp.h"

static sag_vec3 to_local(const sagi_bsdf *bsdf, sag_vec3 w) {
    return sag_vec3_make(sag_dot(w, bsdf->s), sag_dot(w, bsdf->t), sag_dot(w, bsdf->n));
}

static sag_vec3 to_scene(const sagi_bsdf *bsdf, sag_vec3 w) {
    return sag_madd(sag_madd(sag_scale(bsdf->s, w.x), w.y, bsdf->t), w.z, bsdf->n);
}

static double regularized(double alpha) { return alpha < 0.3 ? fmax(0.1, fmin(2 * alpha, 0.3)) : alpha; }

void sagi_bsdf_regularize(sagi_bsdf *bsdf) {
    bool faceted = bsdf->kind == SAG_MATERIAL_CONDUCTOR || bsdf->kind == SAG_MATERIAL_COATED_DIFFUSE ||
                   bsdf->kind == SAG_MATERIAL_COATED_CONDUCTOR ||
                   (bsdf->kind == SAG_MATERIAL_DIELECTRIC && bsdf->ior != 1);
    if (!faceted) return;
    bsdf->facets = (sagi_microfacet){regularized(bsdf->facets.ax), regularized(bsdf->facets.ay)};
    if (bsdf->layered && bsdf->ior != 1)
        bsdf->coat = (sagi_microfacet){regularized(bsdf->coat.ax), regularized(bsdf->coat.ay)};
    bsdf->specular = false;
}

// Lambert's law on both sides: ρ/π back, τ/π through.
static double share_reflected(const sagi_bsdf *bsdf) {
    const float back = sagi_spectrum_max(bsdf->color), through = sagi_spectrum_max(bsdf->base);
    return back > 0 ? (double)(back / (back + through)) : 0;
}

static sagi_spectrum transmission_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    const double density = fabs(wi.z) * SAGI_INV_PI, back = share_reflected(bsdf);
    const bool reflected = wi.z * bsdf->wo.z > 0;
    *pdf = density * (reflected ? back : 1 - back);
    return (reflected ? bsdf->color : bsdf->base) * (float)density;
}

static bool transmission_sample(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample) {
    const double back = share_reflected(bsdf);
    const bool reflected = choose < back;
    sag_vec3 wi = sagi_warp_cosine(u);
    if (!(wi.z > 0)) return false;
    const double share = reflected ? back : 1 - back;
    sample->pdf = wi.z * SAGI_INV_PI * share;
    if ((bsdf->wo.z < 0) == reflected) wi.z = -wi.z;
    sample->wi = wi;
    sample->transmission = !reflected;
    sample->weight = (reflected ? bsdf->color : bsdf->base) * (float)(1 / share);
    return true;
}

sagi_spectrum sagi_bsdf_eval(const sagi_bsdf *bsdf, sag_vec3 wi_scene, double *pdf) {
    *pdf = 0;
    const sagi_spectrum black = {0, 0, 0, 0};
    if (bsdf->specular) return black;
    sag_vec3 wi = to_local(bsdf, wi_scene);
    if (wi.z == 0 || bsdf->wo.z == 0) return black;
    switch (bsdf->kind) {
    case SAG_MATERIAL_DIFFUSE: return sagi_diffuse_eval(bsdf, wi, pdf);
    case SAG_MATERIAL_CONDUCTOR: return sagi_conductor_eval(bsdf, wi, pdf);
    case SAG_MATERIAL_DIELECTRIC: return sagi_dielectric_eval(bsdf, wi, pdf);
    case SAG_MATERIAL_COATED_DIFFUSE:
        return bsdf->layered ? sagi_layered_eval(bsdf, wi, pdf) : sagi_coated_eval(bsdf, wi, pdf);
    case SAG_MATERIAL_COATED_CONDUCTOR: return sagi_layered_eval(bsdf, wi, pdf);
    case SAG_MATERIAL_DIFFUSE_TRANSMISSION: return transmission_eval(bsdf, wi, pdf);
    case SAG_MATERIAL_THIN_DIELECTRIC:
    case SAG_MATERIAL_MIX:
    case SAG_MATERIAL_INTERFACE: break;
    }
    return black;
}

static bool diffuse_sample(const sagi_bsdf *bsdf, sag_vec2 u, sagi_bsdf_sample *sample) {
    sag_vec3 wi = sagi_warp_cosine(u);
    if (!(wi.z > 0)) return false;
    sample->pdf = wi.z * SAGI_INV_PI;
    if (bsdf->wo.z < 0) wi.z = -wi.z;
    sample->wi = wi;
    sample->weight = bsdf->color;
    return true;
}

bool sagi_bsdf_sample_wi(const sagi_bsdf *bsdf, double choose, sag_vec2 u, sagi_bsdf_sample *sample) {
    *sample = (sagi_bsdf_sample){.eta = 1};
    if (bsdf->wo.z == 0) return false;
    bool found = false;
    switch (bsdf->kind) {
    case SAG_MATERIAL_DIFFUSE: found = diffuse_sample(bsdf, u, sample); break;
    case SAG_MATERIAL_CONDUCTOR: found = sagi_conductor_sample(bsdf, u, sample); break;
    case SAG_MATERIAL_DIELECTRIC: found = sagi_dielectric_sample(bsdf, choose, u, sample); break;
    case SAG_MATERIAL_THIN_DIELECTRIC: found = sagi_thin_sample(bsdf, choose, sample); break;
    case SAG_MATERIAL_COATED_DIFFUSE:
        found = bsdf->layered ? sagi_layered_sample(bsdf, choose, u, sample)
                              : sagi_coated_sample(bsdf, choose, u, sample);
        break;
    case SAG_MATERIAL_COATED_CONDUCTOR: found = sagi_layered_sample(bsdf, choose, u, sample); break;
    case SAG_MATERIAL_DIFFUSE_TRANSMISSION: found = transmission_sample(bsdf, choose, u, sample); break;
    case SAG_MATERIAL_MIX:
    case SAG_MATERIAL_INTERFACE: break;
    }
    if (!found || sagi_spectrum_is_black(sample->weight)) return false;
    sample->wi = to_scene(bsdf, sample->wi);
    return true;
}

// Lambert: the same radiance in all directions; f = ρ/π.
sagi_spectrum sagi_diffuse_eval(const sagi_bsdf *bsdf, sag_vec3 wi, double *pdf) {
    if (!(wi.z * bsdf->wo.z > 0)) return (sagi_spectrum){0, 0, 0, 0};
    *pdf = fabs(wi.z) * SAGI_INV_PI;
    return bsdf->color * (float)*pdf;
}
