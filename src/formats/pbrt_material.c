// SPDX-License-Identifier: MIT
// Materials of a pbrt scene. What the renderer has no model for becomes the nearest it has, with a warning
// that names it. Roughness becomes Trowbridge–Reitz α as pbrt-v4 does it: α = √roughness, unless
// remaproughness is false.
#include "formats/pbrt.h"

#include <math.h>
#include <string.h>

#define MAX_NAME 1024

static const double half = 0.5;

static void read_roughness(sagi_pbrt *p, const char *all, const char *u, const char *v, sag_material *m) {
    const sag_input both = sagi_pbrt_float_input(p, all, 0);
    m->roughness_u = sagi_pbrt_float_input(p, u, both.value.r);
    m->roughness_v = sagi_pbrt_float_input(p, v, both.value.r);
    sag_input *const inputs[] = {&m->roughness_u, &m->roughness_v};
    const bool remap = sagi_params_bool(&p->params, "remaproughness", true);
    for (int i = 0; i < 2; i++)
        if (inputs[i]->texture == 0 && both.texture && inputs[i]->value.r == both.value.r)
            inputs[i]->texture = both.texture;
    m->roughness_is_root = remap && (m->roughness_u.texture || m->roughness_v.texture);
    for (int i = 0; i < 2 && remap && !m->roughness_is_root; i++) {
        const double alpha = sqrt(fmax(inputs[i]->value.r, 0));
        inputs[i]->value = (sag_rgb){alpha, alpha, alpha};
    }
}

static void read_metal(sagi_pbrt *p, const char *eta, const char *k, sag_material *m) {
    m->kind = SAG_MATERIAL_CONDUCTOR;
    const bool by_reflectance = sagi_params_find(&p->params, "reflectance", ~0u) != NULL;
    m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, 0);
    m->eta = sagi_pbrt_spectrum_input(p, eta, SAGI_SPECTRUM_INDEX, 0);
    m->k = sagi_pbrt_spectrum_input(p, k, SAGI_SPECTRUM_INDEX, 0);
    if (by_reflectance) return;
    if (!sagi_params_find(&p->params, eta, ~0u))
        m->eta.spectrum = sagi_pbrt_named_spectrum(p, "metal-Cu-eta");
    if (!sagi_params_find(&p->params, k, ~0u)) m->k.spectrum = sagi_pbrt_named_spectrum(p, "metal-Cu-k");
}

static sag_input read_index(sagi_pbrt *p, const char *name) {
    return sagi_pbrt_spectrum_input(p, name, SAGI_SPECTRUM_INDEX, 1.5);
}

static void warn_nearest(sagi_pbrt *p, sagi_place place, const char *kind, const char *nearest) {
    sagi_pbrt_warn_once(p, place, kind, "the material \"%s\" is not supported: %s takes its place", kind,
                        nearest);
    for (size_t i = 0; i < p->params.count; i++) p->params.items[i].used = true;
}

// "mix": the material that has the larger share.
static sag_status read_mix(sagi_pbrt *p, sagi_place place, uint32_t *id) {
    const sagi_param *materials = sagi_params_find(&p->params, "materials", SAGI_TYPE_STRING);
    if (!materials || materials->string_count != 2)
        return sagi_params_fail(&p->params, materials, "\"string materials\" with two names expected");
    const sag_input amount = sagi_pbrt_float_input(p, "amount", 0.5);
    const sagi_slice name = p->params.strings[materials->first_string + (amount.value.r > 0.5)];
    if (!sagi_names_get(&p->materials, name, id))
        return sagi_params_fail(&p->params, materials, "there is no material \"%.*s\"",
                                (int)(name.length < 100 ? name.length : 100), name.text);
    sagi_pbrt_warn_once(p, place, "mix",
                        "the material \"mix\" is not supported: the larger part stands for both");
    return sagi_pbrt_parameters_done(p);
}

// Fills the material of the kind; false for an unknown one.
static bool read_kind(sagi_pbrt *p, sagi_place place, const char *kind, sag_material *m) {
    if (strcmp(kind, "diffuse") == 0) {
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, half);
    } else if (strcmp(kind, "conductor") == 0) {
        read_metal(p, "eta", "k", m);
        read_roughness(p, "roughness", "uroughness", "vroughness", m);
    } else if (strcmp(kind, "dielectric") == 0) {
        m->kind = SAG_MATERIAL_DIELECTRIC;
        m->eta = read_index(p, "eta");
        read_roughness(p, "roughness", "uroughness", "vroughness", m);
    } else if (strcmp(kind, "thindielectric") == 0) {
        m->kind = SAG_MATERIAL_THIN_DIELECTRIC;
        m->eta = read_index(p, "eta");
    } else if (strcmp(kind, "coateddiffuse") == 0) {
        m->kind = SAG_MATERIAL_COATED_DIFFUSE;
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, half);
        m->eta = read_index(p, "eta");
        read_roughness(p, "roughness", "uroughness", "vroughness", m);
        m->thickness = fmax(sagi_pbrt_float_input(p, "thickness", 0.01).value.r, 0);
        // pbrt's walk counts each layer it meets: the base is every other one.
        const int32_t depth = sagi_params_integer(&p->params, "maxdepth", 10);
        m->bounces = depth > 0 ? (uint32_t)depth / 2 + (uint32_t)depth % 2 : 1;
        sagi_pbrt_ignore(p, "nsamples", NULL);
        sagi_pbrt_ignore(p, "albedo", "(of the medium within the coat) is not supported");
        sagi_pbrt_ignore(p, "g", NULL);
    } else if (strcmp(kind, "coatedconductor") == 0) {
        read_metal(p, "conductor.eta", "conductor.k", m);
        read_roughness(p, "conductor.roughness", "conductor.uroughness", "conductor.vroughness", m);
        warn_nearest(p, place, kind, "the metal without its coat");
    } else if (strcmp(kind, "diffusetransmission") == 0) {
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, 0.25);
        warn_nearest(p, place, kind, "a diffuse one without transmission");
    } else if (strcmp(kind, "interface") == 0 || strcmp(kind, "none") == 0 || kind[0] == '\0') {
        m->kind = SAG_MATERIAL_INTERFACE;
    } else if (strcmp(kind, "subsurface") == 0 || strcmp(kind, "hair") == 0 ||
               strcmp(kind, "measured") == 0) {
        m->reflectance = sagi_pbrt_spectrum_input(p, "reflectance", SAGI_SPECTRUM_REFLECTANCE, half);
        warn_nearest(p, place, kind, "a diffuse one");
    } else {
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
                          m->kind == SAG_MATERIAL_COATED_DIFFUSE;
    if (is_glass && !m->eta.spectrum && !(m->eta.value.r > 0 && m->eta.value.g > 0 && m->eta.value.b > 0) &&
        !m->eta.texture)
        sagi_params_fail(params, sagi_params_find(params, "eta", ~0u),
                         "eta %g: an index of refraction is positive", m->eta.value.r);
    const sag_rgb c = m->reflectance.value;
    const double least = fmin(c.r, fmin(c.g, c.b)), most = fmax(c.r, fmax(c.g, c.b));
    if (!m->reflectance.texture && !m->reflectance.spectrum && (least < 0 || most > 1))
        sagi_pbrt_warn(p, place, "%s: the reflectance %g %g %g is cut off at 0 and 1", params->what, c.r, c.g,
                       c.b);
}

static sag_status read_material(sagi_pbrt *p, sagi_place place, const char *kind, uint32_t *id) {
    if (strcmp(kind, "mix") == 0) return read_mix(p, place, id);
    sag_material material = {.kind = SAG_MATERIAL_DIFFUSE};
    if (!read_kind(p, place, kind, &material))
        return sagi_place_error(place, p->error, "unknown material \"%.60s\"", kind);
    check_material(p, place, &material);
    const sag_status status = sagi_pbrt_parameters_done(p);
    if (status != SAG_OK) return status;
    *id = sag_world_add_material(p->world, &material);
    return *id ? SAG_OK : sagi_pbrt_out_of_memory(p);
}

sag_status sagi_pbrt_material(sagi_pbrt *p, sagi_place place) {
    char kind[64];
    sag_status status = sagi_pbrt_string(p, place, kind, sizeof kind);
    if (status == SAG_OK)
        status = sagi_pbrt_parameters(p, place, SAGI_TARGET_MATERIAL, "Material \"%.60s\"", kind);
    if (status != SAG_OK || p->options->geometry_only) return status;
    return read_material(p, place, kind, &p->state.material);
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
    status = read_material(p, place, kind, &id);
    if (status != SAG_OK) return status;
    return sagi_pbrt_define(p, place, &p->materials, name, id, "material");
}

sag_status sagi_pbrt_named_material(sagi_pbrt *p, sagi_place place) {
    char name[MAX_NAME];
    const sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    if (!sagi_names_get(&p->materials, (sagi_slice){name, strlen(name)}, &p->state.material))
        return sagi_place_error(place, p->error, "there is no material \"%.100s\"", name);
    return SAG_OK;
}
