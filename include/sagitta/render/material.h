// SPDX-License-Identifier: MIT
/// @file material.h
/// Materials: what surfaces do to light. sag_world_add_material (world.h) adds one to a world, and
/// sag_world_set_appearance puts it on a geometry.
#ifndef SAGITTA_RENDER_MATERIAL_H
#define SAGITTA_RENDER_MATERIAL_H

#include <sagitta/render/texture.h>

typedef enum sag_material_kind {
    SAG_MATERIAL_DIFFUSE,    ///< Lambertian: reflectance
    SAG_MATERIAL_CONDUCTOR,  ///< metal: eta, k (or reflectance when both are 0); roughness
    SAG_MATERIAL_DIELECTRIC, ///< glass: eta is the index of refraction (r of a plain colour); both sides. A
                             ///< spectrum that is not constant bends each wavelength on its own way
    SAG_MATERIAL_THIN_DIELECTRIC, ///< a pane: reflection and straight transmission, all inner bounces
    SAG_MATERIAL_COATED_DIFFUSE,  ///< plastic: diffuse under a smooth or rough coat of index eta (0: 1.5)
    SAG_MATERIAL_INTERFACE,       ///< not there at all: rays go on
    SAG_MATERIAL_DIFFUSE_TRANSMISSION, ///< paper, leaves: reflectance back, transmittance through
    SAG_MATERIAL_COATED_CONDUCTOR, ///< lacquered metal: eta, k (or reflectance), roughness as a conductor,
                                   ///< under a coat of coat_eta (0: 1.5) and coat_roughness
    SAG_MATERIAL_MIX,              ///< at each point one of two materials, the second with the share `amount`
} sag_material_kind;

/// What a surface does to light. Zero-initialised: black diffuse.
typedef struct sag_material {
    sag_material_kind kind;
    sag_input reflectance;
    sag_input transmittance; ///< of what scatters to the other side; where both add up to more than 1, light
                             ///< is made
    sag_input eta, k;
    sag_input roughness_u, roughness_v; ///< Trowbridge–Reitz α; 0 is a perfect mirror
    /// Of a coated conductor's coat; a coated diffuse one has eta and roughness for it.
    sag_input coat_eta, coat_roughness_u, coat_roughness_v;
    /// Of a coat: its thickness in mean free paths of light (it takes 1 − exp(−thickness/cos) on the way; 0:
    /// clear), the share of that which it scatters (coat_albedo; 0: it absorbs all) with the mean cosine
    /// coat_g, and how many times light is scattered below the coat's outside at most, by the base, the
    /// coat's inside and what is between (0: as often as it likes). pbrt-v4's defaults are thickness 0.01 and
    /// 10 events. Where there is no formula the coat's scattering is itself found by following `samples`
    /// random paths through it (0 counts as 1).
    sag_input thickness, coat_albedo, coat_g;
    uint32_t events, samples;
    /// Of coats: lamps shine through as they do in pbrt-v4, whose sum over two ways of finding the light
    /// below a rough coat is off by their weights (by +2 to +15 %; test_layered.c). For pictures that agree
    /// with its; reciprocal and without loss only when not set.
    bool lit_as_pbrt;
    bool roughness_is_root; ///< α is the square root of what roughness_u and roughness_v (of coats too) say
    uint32_t materials[2];  ///< of a mix, added before, neither an interface; mixes may be mixed
    sag_input amount;       ///< of the second one, cut off at 0 and 1
    sag_input displacement; ///< with texture ≠ 0: shaded as if moved so far along the normal (a number)
    sag_picture_id normal_map; ///< ≠ 0, before displacement: (x + 1)/2, (y + 1)/2, (z + 1)/2 of the normal,
                               ///< by (u, v), z along the surface's own and x along dpdu
} sag_material;

#endif
