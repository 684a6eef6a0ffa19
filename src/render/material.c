// SPDX-License-Identifier: MIT
// From a material's inputs and a point of a surface to the BSDF there.
#include "bump.h"
#include "fresnel.h"

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
                                      const sagi_spot *at) {
    double ax = sagi_input_number(world, &material->roughness_u, at);
    double ay = sagi_input_number(world, &material->roughness_v, at);
    if (material->roughness_is_root) ax = sqrt(fmax(ax, 0)), ay = sqrt(fmax(ay, 0));
    if (!(fmax(ax, ay) >= SMOOTH_ALPHA)) return (sagi_microfacet){0, 0};
    return (sagi_microfacet){sagi_clamp(ax, SMOOTH_ALPHA, 1e3), sagi_clamp(ay, SMOOTH_ALPHA, 1e3)};
}

// A metal given by its colour at normal incidence: η = 1 and the κ that reflects as much.
static void metal_from_reflectance(sagi_bsdf *bsdf, sagi_spectrum reflectance) {
    const sagi_spectrum most = {0.9999F, 0.9999F, 0.9999F, 0.9999F};
    sagi_spectrum r = sagi_spectrum_clamp(reflectance);
    r = sagi_spectrum_choose(r < most, r, most);
    bsdf->eta = sagi_spectrum_all(1);
    bsdf->k = 2 * sagi_spectrum_sqrt(r / (1 - r));
}

static bool has_index(const sag_material *material) {
    return material->eta.texture || material->k.texture || material->eta.spectrum || material->k.spectrum ||
           !sagi_rgb_is_black(material->eta.value) || !sagi_rgb_is_black(material->k.value);
}

// The index of refraction of glass or a coat.
static void read_index(const sagi_material *entry, sagi_spectrum lambda, sagi_bsdf *bsdf) {
    if (!(entry->eta.scale > 0)) return;
    bsdf->dispersed = entry->eta.varies;
    bsdf->ior = entry->eta.varies ? sagi_color_at_first(&entry->eta, lambda) : (double)entry->eta.scale;
    if (!(bsdf->ior > 0)) bsdf->ior = 1;
}

static void read_material(const sag_world *world, const sagi_material *entry, const sagi_spot *at,
                          sagi_spectrum lambda, sagi_bsdf *bsdf) {
    const sag_material *material = &entry->material;
    switch (material->kind) {
    case SAG_MATERIAL_DIFFUSE:
        bsdf->color = sagi_spectrum_clamp(sagi_input_spectrum(
            world, &material->reflectance, &entry->reflectance, SAGI_RGB_ALBEDO, at, lambda));
        break;
    case SAG_MATERIAL_CONDUCTOR:
        if (has_index(material)) {
            bsdf->eta =
                sagi_input_spectrum(world, &material->eta, &entry->eta, SAGI_RGB_UNBOUNDED, at, lambda);
            bsdf->k = sagi_input_spectrum(world, &material->k, &entry->k, SAGI_RGB_UNBOUNDED, at, lambda);
        } else {
            metal_from_reflectance(bsdf,
                                   sagi_input_spectrum(world, &material->reflectance, &entry->reflectance,
                                                       SAGI_RGB_ALBEDO, at, lambda));
        }
        bsdf->facets = read_roughness(world, material, at);
        bsdf->specular = !(bsdf->facets.ax > 0);
        break;
    case SAG_MATERIAL_DIELECTRIC:
    case SAG_MATERIAL_THIN_DIELECTRIC:
        read_index(entry, lambda, bsdf);
        if (material->kind == SAG_MATERIAL_DIELECTRIC && bsdf->ior != 1)
            bsdf->facets = read_roughness(world, material, at);
        bsdf->specular = !(bsdf->facets.ax > 0);
        break;
    case SAG_MATERIAL_COATED_DIFFUSE:
        read_index(entry, lambda, bsdf);
        bsdf->color = sagi_spectrum_clamp(sagi_input_spectrum(
            world, &material->reflectance, &entry->reflectance, SAGI_RGB_ALBEDO, at, lambda));
        bsdf->facets = read_roughness(world, material, at);
        bsdf->inner_mean = entry->inner_mean;
        bsdf->thickness = material->thickness;
        bsdf->bounces = material->bounces;
        sagi_coated_prepare(bsdf);
        break;
    case SAG_MATERIAL_INTERFACE: break;
    }
}

// Where the material's textures are looked up.
static void find_spot(const sagi_material *entry, const sag_surface *surface, const sagi_footprint *footprint,
                      sagi_spot *at) {
    sagi_spot_at(at, surface);
    if (entry->wants_footprint && footprint) sagi_footprint_at(footprint, surface->dpdu, surface->dpdv, at);
}

static sagi_shading_frame shading_frame(const sag_world *world, const sag_material *material,
                                        const sag_surface *surface, const sagi_spot *at) {
    const sagi_mipmap *normals = sagi_world_picture(world, material->normal_map);
    if (normals) return sagi_mapped_frame(normals, surface, at);
    if (material->displacement.texture != 0)
        return sagi_bumped_frame(world, &material->displacement, surface, at);
    return sagi_plain_frame(surface);
}

bool sagi_material_evaluate(const sag_world *world, const sagi_appearance *appearance,
                            const sag_surface *surface, const sagi_footprint *footprint, sag_vec3 wo,
                            sagi_spectrum lambda, sagi_bsdf *bsdf) {
    *bsdf = (sagi_bsdf){.kind = SAG_MATERIAL_DIFFUSE, .color = {0.5F, 0.5F, 0.5F, 0.5F}, .ior = 1.5};
    const uint32_t id = appearance ? appearance->look.material : 0;
    sagi_shading_frame frame = sagi_plain_frame(surface);
    if (id != 0) {
        const sagi_material *entry = (const sagi_material *)world->materials.items + (id - 1);
        bsdf->kind = entry->material.kind;
        if (bsdf->kind == SAG_MATERIAL_INTERFACE) return false;
        sagi_spot at;
        find_spot(entry, surface, footprint, &at);
        read_material(world, entry, &at, lambda, bsdf);
        frame = shading_frame(world, &entry->material, surface, &at);
    }
    sagi_bsdf_set_frame(bsdf, surface->geometric_normal, frame.normal, frame.tangent, wo);
    return true;
}

sag_rgb sagi_material_albedo(const sag_world *world, const sagi_appearance *appearance,
                             const sag_surface *surface, const sagi_footprint *footprint) {
    const uint32_t id = appearance ? appearance->look.material : 0;
    if (id == 0) return sagi_rgb_grey(0.5);
    const sagi_material *entry = (const sagi_material *)world->materials.items + (id - 1);
    const sag_material *material = &entry->material;
    sagi_spot at;
    find_spot(entry, surface, footprint, &at);
    switch (material->kind) {
    case SAG_MATERIAL_DIFFUSE:
    case SAG_MATERIAL_COATED_DIFFUSE:
        return sagi_rgb_clamp(sagi_input_rgb(world, &material->reflectance, &at));
    case SAG_MATERIAL_CONDUCTOR: {
        if (!has_index(material)) return sagi_rgb_clamp(sagi_input_rgb(world, &material->reflectance, &at));
        if (!material->eta.texture && !material->k.texture) return entry->mirror;
        const sag_rgb eta = sagi_input_rgb(world, &material->eta, &at);
        const sag_rgb k = sagi_input_rgb(world, &material->k, &at);
        return sagi_rgb(sagi_fresnel_conductor(1, eta.r, k.r), sagi_fresnel_conductor(1, eta.g, k.g),
                        sagi_fresnel_conductor(1, eta.b, k.b));
    }
    case SAG_MATERIAL_DIELECTRIC:
    case SAG_MATERIAL_THIN_DIELECTRIC:
    case SAG_MATERIAL_INTERFACE: break;
    }
    return sagi_rgb_grey(1);
}
