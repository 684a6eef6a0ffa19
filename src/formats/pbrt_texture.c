// SPDX-License-Identifier: MIT
// Textures of a pbrt scene.
#include "formats/pbrt.h"

#include <string.h>

// (u, v) scaled and moved; other mappings than that are taken for it.
static void read_mapping(sagi_pbrt *p, sagi_place place, sag_texture *texture) {
    sagi_params *params = &p->params;
    char mapping[32];
    sagi_params_string(params, "mapping", "uv", mapping, sizeof mapping);
    texture->u_scale = sagi_params_float(params, "uscale", 1);
    texture->v_scale = sagi_params_float(params, "vscale", 1);
    texture->u_offset = sagi_params_float(params, "udelta", 0);
    texture->v_offset = sagi_params_float(params, "vdelta", 0);
    if (strcmp(mapping, "uv") == 0) return;
    sagi_pbrt_warn_once(p, place, "mapping",
                        "the texture mapping \"%s\" is not supported: (u, v) takes its place", mapping);
    sagi_pbrt_ignore(p, "v1", NULL), sagi_pbrt_ignore(p, "v2", NULL);
}

static sag_status read_image(sagi_pbrt *p, sagi_place place, sag_texture *texture) {
    sagi_params *params = &p->params;
    char name[SAGI_MAX_PATH], path[SAGI_MAX_PATH], word[64];
    texture->kind = SAG_TEXTURE_IMAGE;
    read_mapping(p, place, texture);
    texture->scale = sagi_params_float(params, "scale", 1);
    texture->invert = sagi_params_bool(params, "invert", false);
    sagi_params_string(params, "wrap", "repeat", word, sizeof word);
    texture->wrap = strcmp(word, "black") == 0   ? SAG_WRAP_BLACK
                    : strcmp(word, "clamp") == 0 ? SAG_WRAP_CLAMP
                                                 : SAG_WRAP_REPEAT;
    sagi_params_string(params, "encoding", "sRGB", word, sizeof word);
    sag_encoding encoding = SAG_ENCODING_DEFAULT;
    if (strcmp(word, "linear") == 0)
        encoding = SAG_ENCODING_LINEAR;
    else if (strcmp(word, "sRGB") != 0)
        sagi_pbrt_warn_once(p, place, "encoding",
                            "the encoding \"%s\" is not supported: sRGB takes its place", word);
    sagi_pbrt_ignore(p, "filter", NULL), sagi_pbrt_ignore(p, "maxanisotropy", NULL);
    sagi_params_string(params, "filename", "", name, sizeof name);
    if (!name[0]) return sagi_params_fail(params, NULL, "the picture's \"filename\" is missing");
    if (params->status != SAG_OK) return params->status;
    sagi_pbrt_path(p, name, path);
    sag_error reason;
    const sag_status status = sag_image_read(p->context, path, encoding, &texture->image, &reason);
    if (status == SAG_OK) return SAG_OK;
    sagi_params_fail(params, sagi_params_find(params, "filename", ~0u), "%.200s: %.180s", path,
                     reason.message);
    p->error->status = status;
    return params->status = status;
}

// What has no counterpart here becomes the mean of what it would vary between.
static void approximate(sagi_pbrt *p, sagi_place place, const char *kind, sag_texture *texture) {
    sagi_pbrt_warn_once(p, place, kind, "the texture \"%s\" is not supported: one colour takes its place",
                        kind);
    for (size_t i = 0; i < p->params.count; i++) p->params.items[i].used = true;
    texture->kind = SAG_TEXTURE_CONSTANT;
    texture->a.value = (sag_rgb){0.5, 0.5, 0.5};
}

static sag_status read_texture(sagi_pbrt *p, sagi_place place, const char *kind, sag_texture *texture) {
    const double one = 1, zero = 0;
    const sagi_spectrum_use use = SAGI_SPECTRUM_REFLECTANCE;
    static const char *const missing[] = {"bilerp", "directionmix", "dots",  "fbm",
                                          "marble", "ptex",         "windy", "wrinkled"};
    if (strcmp(kind, "constant") == 0) {
        texture->kind = SAG_TEXTURE_CONSTANT;
        texture->a = sagi_pbrt_spectrum_input(p, "value", use, one);
    } else if (strcmp(kind, "scale") == 0) {
        texture->kind = SAG_TEXTURE_SCALE;
        texture->a = sagi_pbrt_spectrum_input(p, "tex", use, one);
        texture->b = sagi_pbrt_spectrum_input(p, "scale", use, one);
    } else if (strcmp(kind, "mix") == 0) {
        texture->kind = SAG_TEXTURE_MIX;
        texture->a = sagi_pbrt_spectrum_input(p, "tex1", use, zero);
        texture->b = sagi_pbrt_spectrum_input(p, "tex2", use, one);
        texture->amount = sagi_pbrt_float_input(p, "amount", 0.5);
    } else if (strcmp(kind, "checkerboard") == 0) {
        texture->kind = SAG_TEXTURE_CHECKERBOARD;
        texture->a = sagi_pbrt_spectrum_input(p, "tex1", use, one);
        texture->b = sagi_pbrt_spectrum_input(p, "tex2", use, zero);
        const int32_t dimension = sagi_params_integer(&p->params, "dimension", 2);
        if (dimension != 2 && dimension != 3)
            return sagi_params_fail(&p->params, NULL, "dimension %d: it must be 2 or 3", dimension);
        texture->dimension = (uint32_t)dimension;
        const sag_affine now = sagi_pbrt_transform_now(p);
        if (dimension == 2)
            read_mapping(p, place, texture);
        else if (!sag_affine_inverse(&now, &texture->world_to_texture))
            return sagi_params_fail(&p->params, NULL, "the transform is singular");
    } else if (strcmp(kind, "imagemap") == 0) {
        return read_image(p, place, texture);
    } else {
        for (size_t i = 0; i < sizeof missing / sizeof *missing; i++)
            if (strcmp(kind, missing[i]) == 0) return approximate(p, place, kind, texture), SAG_OK;
        return sagi_place_error(place, p->error, "unknown texture \"%.60s\"", kind);
    }
    return p->params.status;
}

sag_status sagi_pbrt_texture(sagi_pbrt *p, sagi_place place) {
    char name[1024], type[32], kind[64];
    sag_status status = sagi_pbrt_string(p, place, name, sizeof name);
    if (status == SAG_OK) status = sagi_pbrt_string(p, place, type, sizeof type);
    if (status == SAG_OK) status = sagi_pbrt_string(p, place, kind, sizeof kind);
    if (status == SAG_OK)
        status = sagi_pbrt_parameters(p, place, SAGI_TARGET_TEXTURE, "Texture \"%.60s\"", name);
    if (status != SAG_OK || p->options->geometry_only) return status;
    const bool is_color = strcmp(type, "spectrum") == 0 || strcmp(type, "color") == 0;
    if (!is_color && strcmp(type, "float") != 0)
        return sagi_place_error(place, p->error, "a texture is of type \"float\" or \"spectrum\", not \"%s\"",
                                type);
    sag_texture texture = {.kind = SAG_TEXTURE_CONSTANT};
    status = read_texture(p, place, kind, &texture);
    if (status == SAG_OK) status = sagi_pbrt_parameters_done(p);
    if (status != SAG_OK) {
        sag_image_clear(p->context, &texture.image);
        return status;
    }
    const sag_texture_id id = sag_world_add_texture(p->world, &texture);
    if (!id) { // out of memory or nested too deep, which a plain one tells apart
        const sag_texture plain = {.kind = SAG_TEXTURE_CONSTANT};
        if (!sag_world_add_texture(p->world, &plain)) return sagi_pbrt_out_of_memory(p);
        return sagi_place_error(place, p->error, "the textures \"%.60s\" is made of nest too deep", name);
    }
    sagi_names *names = is_color ? &p->spectrum_textures : &p->float_textures;
    return sagi_names_set(names, (sagi_slice){name, strlen(name)}, id) ? SAG_OK : sagi_pbrt_out_of_memory(p);
}
