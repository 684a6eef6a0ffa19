// SPDX-License-Identifier: MIT
// From a material's inputs and a point of a surface to the BSDF there.
#include "bump.h"
#include "fresnel.h"
#include "math/hash.h"

static sagi_microfacet read_facets(const sag_world *world, const sag_input *u, const sag_input *v,
                                   bool is_root, const sagi_spot *at) {
    double ax = sagi_input_number(world, u, at);
    double ay = sagi_input_number(world, v, at);
    if (is_root) ax = sqrt(fmax(ax, 0)), ay = sqrt(fmax(ay, 0));
    if (!(fmax(ax, ay) >= SAGI_SMOOTH_ALPHA)) return (sagi_microfacet){0, 0};
    return (sagi_microfacet){sagi_clamp(ax, SAGI_SMOOTH_ALPHA, 1e3), sagi_clamp(ay, SAGI_SMOOTH_ALPHA, 1e3)};
}

static sagi_microfacet read_roughness(const sag_world *world, const sag_material *material,
                                      const sagi_spot *at) {
    return read_facets(world, &material->roughness_u, &material->roughness_v, material->roughness_is_root,
                       at);
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
static void read_index(const sagi_color *eta, sagi_spectrum lambda, sagi_bsdf *bsdf) {
    if (!(eta->scale > 0)) return;
    bsdf->dispersed = eta->varies;
    bsdf->ior = eta->varies ? sagi_color_at_first(eta, lambda) : (double)eta->scale;
    if (!(bsdf->ior > 0)) bsdf->ior = 1;
}

static sagi_spectrum read_albedo(const sag_world *world, const sag_input *input, const sagi_color *color,
                                 const sagi_spot *at, sagi_spectrum lambda) {
    return sagi_spectrum_clamp(sagi_input_spectrum(world, input, color, SAGI_RGB_ALBEDO, at, lambda));
}

static void read_metal(const sag_world *world, const sagi_material *entry, const sagi_spot *at,
                       sagi_spectrum lambda, sagi_bsdf *bsdf) {
    const sag_material *material = &entry->material;
    if (has_index(material)) {
        bsdf->eta = sagi_input_spectrum(world, &material->eta, &entry->eta, SAGI_RGB_UNBOUNDED, at, lambda);
        bsdf->k = sagi_input_spectrum(world, &material->k, &entry->k, SAGI_RGB_UNBOUNDED, at, lambda);
    } else {
        metal_from_reflectance(bsdf, sagi_input_spectrum(world, &material->reflectance, &entry->reflectance,
                                                         SAGI_RGB_ALBEDO, at, lambda));
    }
    bsdf->facets = read_roughness(world, material, at);
}

// Whether there is no formula for a diffuse base under its coat.
static bool wants_walk(const sag_material *material) {
    return material->thickness.texture || material->coat_albedo.texture || material->coat_albedo.spectrum ||
           !sagi_rgb_is_black(material->coat_albedo.value);
}

// The coat of a base that is read; its random numbers follow from the place.
static void read_walk(const sag_world *world, const sagi_material *entry, const sagi_spot *at,
                      sagi_spectrum lambda, sagi_bsdf *bsdf) {
    const sag_material *material = &entry->material;
    const sagi_fingerprint place = sagi_fingerprint_of(at->position);
    bsdf->layered = true;
    bsdf->seed = place.part[0];
    bsdf->walks = material->samples ? material->samples : 1;
    bsdf->events = material->events;
    bsdf->lit_as_pbrt = material->lit_as_pbrt;
    bsdf->thickness = fmax(sagi_input_number(world, &material->thickness, at), 0);
    bsdf->albedo = read_albedo(world, &material->coat_albedo, &entry->coat_albedo, at, lambda);
    bsdf->g = sagi_clamp(sagi_input_number(world, &material->coat_g, at), -0.999, 0.999);
    if (bsdf->ior == 1) bsdf->coat = (sagi_microfacet){0, 0};
}

static void read_material(const sag_world *world, const sagi_material *entry, const sagi_spot *at,
                          sagi_spectrum lambda, sagi_bsdf *bsdf) {
    const sag_material *material = &entry->material;
    switch (material->kind) {
    case SAG_MATERIAL_DIFFUSE:
        bsdf->color = read_albedo(world, &material->reflectance, &entry->reflectance, at, lambda);
        break;
    case SAG_MATERIAL_DIFFUSE_TRANSMISSION:
        bsdf->color = read_albedo(world, &material->reflectance, &entry->reflectance, at, lambda);
        bsdf->base = read_albedo(world, &material->transmittance, &entry->transmittance, at, lambda);
        break;
    case SAG_MATERIAL_CONDUCTOR:
        read_metal(world, entry, at, lambda, bsdf);
        bsdf->specular = !(bsdf->facets.ax > 0);
        break;
    case SAG_MATERIAL_COATED_CONDUCTOR:
        read_index(&entry->coat_eta, lambda, bsdf);
        read_metal(world, entry, at, lambda, bsdf);
        bsdf->eta /= (float)bsdf->ior, bsdf->k /= (float)bsdf->ior;
        bsdf->coat = read_facets(world, &material->coat_roughness_u, &material->coat_roughness_v,
                                 material->roughness_is_root, at);
        read_walk(world, entry, at, lambda, bsdf);
        bsdf->specular = !(bsdf->facets.ax > 0) && !(bsdf->coat.ax > 0) &&
                         (!(bsdf->thickness > 0) || sagi_spectrum_is_black(bsdf->albedo));
        break;
    case SAG_MATERIAL_DIELECTRIC:
    case SAG_MATERIAL_THIN_DIELECTRIC:
        read_index(&entry->eta, lambda, bsdf);
        if (material->kind == SAG_MATERIAL_DIELECTRIC && bsdf->ior != 1)
            bsdf->facets = read_roughness(world, material, at);
        bsdf->specular = !(bsdf->facets.ax > 0);
        break;
    case SAG_MATERIAL_COATED_DIFFUSE:
        read_index(&entry->eta, lambda, bsdf);
        bsdf->color = read_albedo(world, &material->reflectance, &entry->reflectance, at, lambda);
        bsdf->facets = read_roughness(world, material, at);
        if (wants_walk(material) || (bsdf->facets.ax > 0 && !entry->coat && bsdf->ior != 1)) {
            bsdf->coat = bsdf->facets;
            bsdf->facets = (sagi_microfacet){0, 0};
            read_walk(world, entry, at, lambda, bsdf);
            break;
        }
        if (entry->coat) {
            const sagi_coat *coat = (const sagi_coat *)world->coats.items + (entry->coat - 1);
            bsdf->rough_share = coat->rough_share;
            bsdf->lit_share = material->lit_as_pbrt ? coat->lit_share : coat->rough_share;
        }
        bsdf->inner_mean = entry->inner_mean;
        bsdf->thickness = material->thickness.value.r;
        bsdf->events = material->events;
        sagi_coated_prepare(bsdf);
        break;
    case SAG_MATERIAL_MIX:
    case SAG_MATERIAL_INTERFACE: break;
    }
}

// Where the material's textures are looked up.
static void find_spot(const sagi_material *entry, const sag_surface *surface, const sagi_footprint *footprint,
                      sagi_spot *at) {
    if (!entry->wants_spot) return;
    sagi_spot_at(at, surface);
    if (entry->wants_footprint && footprint) sagi_footprint_at(footprint, surface->dpdu, surface->dpdv, at);
}

// Of a mix the material that is seen from wo: the second one for as large a share of all places and
// directions as the amount says. Materials are mixed of earlier ones, so there is an end to it.
static const sagi_material *chosen(const sag_world *world, const sagi_material *entry,
                                   const sag_surface *surface, const sagi_footprint *footprint, sag_vec3 wo) {
    const sagi_material *materials = world->materials.items;
    const sagi_fingerprint place = sagi_fingerprint_of(surface->position), way = sagi_fingerprint_of(wo);
    uint64_t hash = place.part[0] + sagi_mix(way.part[1]);
    while (entry->material.kind == SAG_MATERIAL_MIX) {
        sagi_spot at;
        find_spot(entry, surface, footprint, &at);
        const double amount = sagi_input_number(world, &entry->material.amount, &at);
        hash = sagi_mix(hash + (uint64_t)(entry - materials));
        entry = &materials[entry->material.materials[(double)(hash >> 11) * 0x1p-53 < amount] - 1];
    }
    return entry;
}

static sagi_shading_frame shading_frame(const sag_world *world, const sag_material *material,
                                        const sag_surface *surface, const sagi_origin *origin,
                                        const sagi_spot *at) {
    const sagi_mipmap *normals = sagi_world_picture(world, material->normal_map);
    if (normals) return sagi_mapped_frame(normals, surface, at);
    if (material->displacement.texture != 0)
        return sagi_bumped_frame(world, &material->displacement, surface, origin, at);
    return sagi_plain_frame(surface);
}

bool sagi_material_look_up(const sag_world *world, const sagi_material *entry, const sag_surface *surface,
                           const sagi_origin *origin, const sagi_footprint *footprint, sag_vec3 wo,
                           sagi_spectrum lambda, sagi_bsdf *bsdf) {
    sagi_bsdf_begin(bsdf);
    if (entry->material.kind == SAG_MATERIAL_MIX) entry = chosen(world, entry, surface, footprint, wo);
    bsdf->kind = entry->material.kind;
    if (bsdf->kind == SAG_MATERIAL_INTERFACE) return false;
    sagi_spot at;
    find_spot(entry, surface, footprint, &at);
    read_material(world, entry, &at, lambda, bsdf);
    sagi_shading_frame frame = sagi_plain_frame(surface);
    if (entry->bent) frame = shading_frame(world, &entry->material, surface, origin, &at);
    sagi_bsdf_set_frame(bsdf, surface->geometric_normal, frame.normal, frame.tangent, wo);
    return true;
}

sag_rgb sagi_material_albedo(const sag_world *world, const sagi_appearance *appearance,
                             const sag_surface *surface, const sagi_footprint *footprint) {
    const uint32_t id = appearance ? appearance->look.material : 0;
    if (id == 0) return sagi_rgb_grey(0.5);
    const sagi_material *entry = (const sagi_material *)world->materials.items + (id - 1);
    if (entry->material.kind == SAG_MATERIAL_MIX)
        entry = chosen(world, entry, surface, footprint, sag_vec3_make(0, 0, 0));
    const sag_material *material = &entry->material;
    sagi_spot at;
    find_spot(entry, surface, footprint, &at);
    switch (material->kind) {
    case SAG_MATERIAL_DIFFUSE:
    case SAG_MATERIAL_COATED_DIFFUSE:
        return sagi_rgb_clamp(sagi_input_rgb(world, &material->reflectance, &at));
    case SAG_MATERIAL_DIFFUSE_TRANSMISSION:
        return sagi_rgb_clamp(sagi_rgb_add(sagi_input_rgb(world, &material->reflectance, &at),
                                           sagi_input_rgb(world, &material->transmittance, &at)));
    case SAG_MATERIAL_CONDUCTOR:
    case SAG_MATERIAL_COATED_CONDUCTOR: {
        if (!has_index(material)) return sagi_rgb_clamp(sagi_input_rgb(world, &material->reflectance, &at));
        if (!material->eta.texture && !material->k.texture) return entry->mirror;
        const sag_rgb eta = sagi_input_rgb(world, &material->eta, &at);
        const sag_rgb k = sagi_input_rgb(world, &material->k, &at);
        return sagi_rgb(sagi_fresnel_conductor(1, eta.r, k.r), sagi_fresnel_conductor(1, eta.g, k.g),
                        sagi_fresnel_conductor(1, eta.b, k.b));
    }
    case SAG_MATERIAL_DIELECTRIC:
    case SAG_MATERIAL_THIN_DIELECTRIC:
    case SAG_MATERIAL_MIX:
    case SAG_MATERIAL_INTERFACE: break;
    }
    return sagi_rgb_grey(1);
}
