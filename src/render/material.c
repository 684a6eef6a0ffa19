// SPDX-License-Identifier: MIT
// From a material's inputs and a point of a surface to the BSDF there.
#include "world.h"

// Below this α the facets' highlight is narrower than anything a picture shows: a mirror (as pbrt has it).
#define SMOOTH_ALPHA 1e-3

void sagi_orient(const sagi_appearance *appearance, sag_surface *surface) {
    if (sag_dot(surface->geometric_normal, surface->shading_normal) < 0)
        surface->geometric_normal = sag_neg(surface->geometric_normal);
    if (appearance && appearance->look.flip) {
        surface->geometric_normal = sag_neg(surface->geometric_normal);
        surface->shading_normal = sag_neg(surface->shading_normal);
    }
}

static sagi_microfacet read_roughness(const sag_world *world, const sag_material *material,
                                      const sag_surface *surface) {
    double ax = sagi_input_evaluate(world, &material->roughness_u, surface).r;
    double ay = sagi_input_evaluate(world, &material->roughness_v, surface).r;
    if (!(fmax(ax, ay) >= SMOOTH_ALPHA)) return (sagi_microfacet){0, 0};
    return (sagi_microfacet){sagi_clamp(ax, SMOOTH_ALPHA, 1e3), sagi_clamp(ay, SMOOTH_ALPHA, 1e3)};
}

// A metal given by its colour at normal incidence: η = 1 and the κ that reflects as much.
static void metal_from_reflectance(sagi_bsdf *bsdf, sag_rgb reflectance) {
    sag_rgb r = sagi_rgb(sagi_clamp(reflectance.r, 0, 0.9999), sagi_clamp(reflectance.g, 0, 0.9999),
                         sagi_clamp(reflectance.b, 0, 0.9999));
    bsdf->eta = sagi_rgb_grey(1);
    bsdf->k = sagi_rgb(2 * sqrt(r.r / (1 - r.r)), 2 * sqrt(r.g / (1 - r.g)), 2 * sqrt(r.b / (1 - r.b)));
}

bool sagi_material_evaluate(const sag_world *world, const sagi_appearance *appearance,
                            const sag_surface *surface, sag_vec3 wo, sagi_bsdf *bsdf) {
    *bsdf = (sagi_bsdf){.kind = SAG_MATERIAL_DIFFUSE, .color = {0.5, 0.5, 0.5}, .ior = 1.5};
    uint32_t id = appearance ? appearance->look.material : 0;
    if (id != 0) {
        const sagi_material *entry = (const sagi_material *)world->materials.items + (id - 1);
        const sag_material *material = &entry->material;
        bsdf->kind = material->kind;
        switch (material->kind) {
        case SAG_MATERIAL_DIFFUSE:
            bsdf->color = sagi_rgb_clamp(sagi_input_evaluate(world, &material->reflectance, surface));
            break;
        case SAG_MATERIAL_CONDUCTOR:
            bsdf->eta = sagi_input_evaluate(world, &material->eta, surface);
            bsdf->k = sagi_input_evaluate(world, &material->k, surface);
            if (sagi_rgb_is_black(bsdf->eta) && sagi_rgb_is_black(bsdf->k))
                metal_from_reflectance(bsdf, sagi_input_evaluate(world, &material->reflectance, surface));
            bsdf->facets = read_roughness(world, material, surface);
            bsdf->specular = !(bsdf->facets.ax > 0);
            break;
        case SAG_MATERIAL_DIELECTRIC:
        case SAG_MATERIAL_THIN_DIELECTRIC:
            if (material->eta.value.r > 0) bsdf->ior = material->eta.value.r;
            if (material->kind == SAG_MATERIAL_DIELECTRIC && bsdf->ior != 1)
                bsdf->facets = read_roughness(world, material, surface);
            bsdf->specular = !(bsdf->facets.ax > 0);
            break;
        case SAG_MATERIAL_COATED_DIFFUSE:
            if (material->eta.value.r > 0) bsdf->ior = material->eta.value.r;
            bsdf->color = sagi_rgb_clamp(sagi_input_evaluate(world, &material->reflectance, surface));
            bsdf->facets = read_roughness(world, material, surface);
            bsdf->inner_mean = entry->inner_mean;
            bsdf->thickness = material->thickness;
            bsdf->bounces = material->bounces;
            sagi_coated_prepare(bsdf);
            break;
        case SAG_MATERIAL_INTERFACE: return false;
        }
    }
    sagi_bsdf_set_frame(bsdf, surface->geometric_normal, surface->shading_normal, surface->dpdu, wo);
    return true;
}
