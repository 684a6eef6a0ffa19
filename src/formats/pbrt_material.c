// SPDX-License-Identifier: MIT
// Materials of a pbrt scene. What the renderer has no model for becomes the nearest it has, with a warning
// that names it. Roughness becomes Trowbridge–Reitz α as pbrt-v4 does it: α = √roughness, unless
// remaproughness is false.
#include "formats/pbrt_medium.h"
#include "formats/pbrt_promise.h"

#include "render/world.h"

#include <math.h>
#include <string.h>

#define MAX_NAME 1024

static const double half = 0.5, quarter = 0.25;

// A pair of roughnesses: u and v where they are given, else what is for both.
static void read_roughness(sagi_pbrt *p, const char *all, const char *u, const char *v, sag_input *to_u,
                           sag_input *to_v) {
    const sag_input both = sagi_pbrt_float_input(p, all, 0);
    *to_u = sagi_params_find(&p->params, u, ~0u) ? sagi_pbrt_float_input(p, u, 0) : both;
    *to_v = sagi_params_find(&p->params, v, ~0u) ? sagi_pbrt_float_input(p, v, 0) : both;
}

// Roughness to α: at once, or where the surface is shaded if one of them is a texture.
static void remap_roughness(sagi_pbrt *p, sag_material *m) {
    sag_input *const inputs[] = {&m->roughness_u, &m->roughness_v, &m->coat_roughness_u,
                                 &m->coat_roughness_v};
    if (!sagi_params_bool(&p->params, "remaproughness", true)) return;
    for (int i = 0; i < 4; i++) m->roughness_is_root |= inputs[i]->texture != 0;
    for (int i = 0; i < 4 && !m->roughness_is_root; i++) {
        const double alpha = sqrt(fmax(inputs[i]->value.r, 0));
        inputs[i]->value = (sag_rgb){alpha, alpha, alpha};
    }
}

void sagi_pbrt_roughness(sagi_pbrt *p, sag_material *m) {
    read_roughness(p, "roughness", "uroughness", "vroughness", &m->roughness_u, &m->roughness_v);
    remap_roughness(p, m);
}

static void read_coat(sagi_pbrt *p, sag_material *m) {
    m->thickness = sagi_pbrt_float_input(p, "thickness", 0.01);
    m->thickness.value.r = fmax(m->thickness.value.r, 0);
    m->coat_albedo = sagi_pbrt_spectrum_input(p, "albedo", SAGI_SPECTRUM_REFLECTANCE, 0);
    m->coat_g = sagi_pbrt_float_input(p, "g", 0);
    const int32_t depth = sagi_params_integer(&p->params, "maxdepth", 10),
                  samples = sagi_params_integer(&p->params, "nsamples", 1);
    m->events = depth > 0 ? (uint32_t)depth : 1;
    m->samples = samples > 0 ? (uint32_t)samples : 1;
    m->lit_as_pbrt = true;
}

static void read_metal(sagi_pbrt *p, const char *eta, const char *k, sag_material *m) {
    const bool by_reflectance = sagi_params_find(&p->params, "reflectance", ~0u) != NULL;
    m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, 0);
    m->eta = sagi_pbrt_spectrum_input(p, eta, SAGI_SPECTRUM_INDEX, 0);
    m->k = sagi_pbrt_spectrum_input(p, k, SAGI_SPECTRUM_INDEX, 0);
    if (by_reflectance) {
        if (m->eta.spectrum || m->k.spectrum || m->eta.texture || m->k.texture || m->eta.value.r != 0 ||
            m->k.value.r != 0)
            sagi_params_fail(&p->params, sagi_params_find(&p->params, "reflectance", ~0u),
                             "either \"reflectance\" or \"%s\" and \"%s\" can be given", eta, k);
        return;
    }
    if (!sagi_params_find(&p->params, eta, ~0u))
        m->eta.spectrum = sagi_pbrt_named_spectrum(p, "metal-Cu-eta");
    if (!sagi_params_find(&p->params, k, ~0u)) m->k.spectrum = sagi_pbrt_named_spectrum(p, "metal-Cu-k");
}

static sag_input read_index(sagi_pbrt *p, const char *name) {
    return sagi_pbrt_spectrum_input(p, name, SAGI_SPECTRUM_INDEX, 1.5);
}

bool sagi_pbrt_is_interface(const sagi_pbrt *p, uint32_t id) {
    const sagi_material *materials = p->world->materials.items;
    return id != 0 && materials[id - 1].material.kind == SAG_MATERIAL_INTERFACE;
}

// "mix" of two named materials.
static void read_mix(sagi_pbrt *p, sag_material *m) {
    sagi_params *params = &p->params;
    m->kind = SAG_MATERIAL_MIX;
    m->amount = sagi_pbrt_float_input(p, "amount", 0.5);
    const sagi_param *materials = sagi_params_find(params, "materials", SAGI_TYPE_STRING);
    if (!materials || materials->string_count != 2) {
        sagi_params_fail(params, materials, "\"string materials\" with two names expected");
        return;
    }
    for (uint32_t i = 0; i < 2 && params->status == SAG_OK; i++) {
        char room[SAGI_MAX_NAME];
        const sagi_slice name = sagi_params_name(params, materials->first_string + i, room);
        const int length = (int)(name.length < 100 ? name.length : 100);
        const bool made = sagi_pbrt_is_made(&p->materials, name);
        if (!made && p->naming)
            // As in pbrt: else it might be mixed of itself.
            sagi_params_fail(params, materials, "there is no material \"%.*s\" yet", length, name.text);
        else if (!sagi_pbrt_find(p, &p->materials, name, &m->materials[i]))
            params->status = sagi_pbrt_promise(p, materials->place, &p->materials, name, &m->materials[i]);
        else if (made && sagi_pbrt_is_interface(p, m->materials[i]))
            sagi_params_fail(params, materials, "an interface (\"%.*s\") cannot be mixed", length, name.text);
    }
}

static sag_input scaled(sagi_pbrt *p, sag_input input, double scale) {
    if (scale == 1) return input;
    if (!input.texture && !input.spectrum) {
        input.value = (sag_rgb){input.value.r * scale, input.value.g * scale, input.value.b * scale};
        return input;
    }
    const sag_texture texture = {
        .kind = SAG_TEXTURE_SCALE, .a = input, .b = {.value = {scale, scale, scale}}};
    const sag_texture_id id = sag_world_add_texture(p->world, &texture);
    return (sag_input){.texture = id};
}

// Fills the material of the kind; false for an unknown one.
static bool read_kind(sagi_pbrt *p, sagi_place place, const char *kind, sag_material *m) {
    if (strcmp(kind, "diffuse") == 0) {
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, half);
    } else if (strcmp(kind, "conductor") == 0) {
        m->kind = SAG_MATERIAL_CONDUCTOR;
        read_metal(p, "eta", "k", m);
        sagi_pbrt_roughness(p, m);
    } else if (strcmp(kind, "dielectric") == 0) {
        m->kind = SAG_MATERIAL_DIELECTRIC;
        m->eta = read_index(p, "eta");
        sagi_pbrt_roughness(p, m);
    } else if (strcmp(kind, "thindielectric") == 0) {
        m->kind = SAG_MATERIAL_THIN_DIELECTRIC;
        m->eta = read_index(p, "eta");
    } else if (strcmp(kind, "coateddiffuse") == 0) {
        m->kind = SAG_MATERIAL_COATED_DIFFUSE;
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, half);
        m->eta = read_index(p, "eta");
        sagi_pbrt_roughness(p, m);
        read_coat(p, m);
    } else if (strcmp(kind, "coatedconductor") == 0) {
        m->kind = SAG_MATERIAL_COATED_CONDUCTOR;
        read_metal(p, "conductor.eta", "conductor.k", m);
        m->coat_eta = read_index(p, "interface.eta");
        read_roughness(p, "interface.roughness", "interface.uroughness", "interface.vroughness",
                       &m->coat_roughness_u, &m->coat_roughness_v);
        read_roughness(p, "conductor.roughness", "conductor.uroughness", "conductor.vroughness",
                       &m->roughness_u, &m->roughness_v);
        remap_roughness(p, m);
        read_coat(p, m);
    } else if (strcmp(kind, "diffusetransmission") == 0) {
        const double scale = sagi_params_float(&p->params, "scale", 1);
        m->kind = SAG_MATERIAL_DIFFUSE_TRANSMISSION;
        m->reflectance =
            scaled(p, sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, quarter), scale);
        m->transmittance = scaled(
            p, sagi_pbrt_spectrum_input(p, "transmittance", SAGI_SPECTRUM_REFLECTANCE, quarter), scale);
    } else if (strcmp(kind, "mix") == 0) {
        read_mix(p, m);
    } else if (strcmp(kind, "interface") == 0 || strcmp(kind, "none") == 0 || kind[0] == '\0') {
        m->kind = SAG_MATERIAL_INTERFACE;
    } else if (!sagi_pbrt_stand_in(p, place, kind, m)) {
        return false;
    }
    m->displacement = sagi_pbrt_float_input(p, "displacement", 0);
    if (sagi_params_find(&p->params, "normalmap", ~0u))
        sagi_pbrt_picture(p, place, "normalmap", SAG_ENCODING_LINEAR, 0, &m->normal_map);
    return true;
}

// What would make no material at all is an error, what the renderer cuts off a warning.
static void check_material(sagi_pbrt *p, sagi_place place, const sag_material *m) {
    sagi_params *params = &p->params;
    const bool is_glass = m->kind == SAG_MATERIAL_DIELECTRIC || m->kind == SAG_MATERIAL_THIN_DIELECTRIC ||
                          m->kind == SAG_MATERIAL_COATED_DIFFUSE,
               is_coat = m->kind == SAG_MATERIAL_COATED_CONDUCTOR;
    const sag_input *index = is_coat ? &m->coat_eta : &m->eta;
    if ((is_glass || is_coat) && !index->spectrum && !index->texture &&
        !(index->value.r > 0 && index->value.g > 0 && index->value.b > 0))
        sagi_params_fail(params, sagi_params_find(params, is_coat ? "interface.eta" : "eta", ~0u),
                         "eta %g: an index of refraction is positive", index->value.r);
    const sag_rgb c = m->reflectance.value;
    const double least = fmin(c.r, fmin(c.g, c.b)), most = fmax(c.r, fmax(c.g, c.b));
    if (!m->reflectance.texture && !m->reflectance.spectrum && (least < 0 || most > 1))
        sagi_pbrt_warn(p, place, "%s: the reflectance %g %g %g is cut off at 0 and 1", params->what, c.r, c.g,
                       c.b);
}

// A material that is mixed of such as are to come.
static bool waits(sagi_pbrt *p, const sag_material *material) {
    if (material->kind != SAG_MATERIAL_MIX || p->naming) return false;
    const sagi_param *names = sagi_params_find(&p->params, "materials", SAGI_TYPE_STRING);
    bool waits = false;
    for (uint32_t i = 0; i < 2; i++) {
        char room[SAGI_MAX_NAME];
        const sagi_slice name = sagi_params_name(&p->params, names->first_string + i, room);
        waits |= !sagi_pbrt_is_made(&p->materials, name);
    }
    return waits;
}

// `promised` ≠ 0: the id that it already has.
static sag_status read_material(sagi_pbrt *p, sagi_place place, const char *kind, uint32_t promised,
                                uint32_t *id) {
    sag_material material = {.kind = SAG_MATERIAL_DIFFUSE};
    if (!read_kind(p, place, kind, &material))
        return sagi_place_error(place, p->error, "unknown material \"%.60s\"", kind);
    if (p->params.status == SAG_OK) check_material(p, place, &material);
    const sag_status status = sagi_pbrt_parameters_done(p);
    if (status != SAG_OK) return status;
    *id = promised;
    if (promised)
        return sagi_material_set(p->world, promised, &material) ? SAG_OK : sagi_pbrt_out_of_memory(p);
    *id = sag_world_add_material(p->world, &material);
    if (!*id) return sagi_pbrt_out_of_memory(p);
    return waits(p, &material) ? sagi_pbrt_promise_mix(p, place, *id) : SAG_OK;
}

sag_status sagi_pbrt_material(sagi_pbrt *p, sagi_place place) {
    char kind[64];
    sag_status status = sagi_pbrt_string(p, place, kind, sizeof kind);
    if (status == SAG_OK)
        status = sagi_pbrt_parameters(p, place, SAGI_TARGET_MATERIAL, "Material \"%.60s\"", kind);
    if (status != SAG_OK || p->options->geometry_only) return status;
    return read_material(p, place, kind, 0, &p->state.material);
}

sag_status sagi_pbrt_make_named_material(sagi_pbrt *p, sagi_place place) {
    char name[MAX_NAME], kind[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status == SAG_OK)
        status = sagi_pbrt_parameters(p, place, SAGI_TARGET_MATERIAL, "MakeNamedMaterial \"%.60s\"", name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    if (!sagi_params_find(&p->params, "type", SAGI_TYPE_STRING))
        return sagi_params_fail(&p->params, NULL, "its \"string type\" is missing");
    sagi_params_string(&p->params, "type", "", kind, sizeof kind);
    if (p->params.status != SAG_OK) return p->params.status;
    uint32_t id = 0;
    const uint32_t promised = sagi_pbrt_promised(p, &p->materials, name);
    p->naming = true;
    status = read_material(p, place, kind, promised, &id);
    p->naming = false;
    if (status != SAG_OK) return status;
    if (promised) return sagi_pbrt_keep(p, &p->materials, name), SAG_OK;
    return sagi_pbrt_define(p, place, &p->materials, name, id, "material");
}

sag_status sagi_pbrt_named_material(sagi_pbrt *p, sagi_place place) {
    char name[MAX_NAME];
    const sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    const sagi_slice key = {name, strlen(name)};
    if (sagi_pbrt_find(p, &p->materials, key, &p->state.material)) return SAG_OK;
    return sagi_pbrt_promise(p, place, &p->materials, key, &p->state.material);
}
