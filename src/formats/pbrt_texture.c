// SPDX-License-Identifier: MIT
// Textures of a pbrt scene, and parameters that may be colours, numbers, spectra or textures.
#include "formats/number.h"
#include "formats/pbrt.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// A spectrum that is the name of a file: pairs of wavelength and value, white space between, # for comments.
static sag_status read_spectrum_file(sagi_pbrt *p, const sagi_param *param, sagi_slice name,
                                     sagi_spectrum_use use, sag_rgb *rgb) {
    char text[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    snprintf(text, sizeof text, "%.*s", (int)(name.length < SAGI_MAX_PATH ? name.length : SAGI_MAX_PATH - 1),
             name.text);
    sagi_pbrt_path(p, text, path);
    sagi_source source = {.file = {0}};
    if (sagi_file_open(p->context, path, &source.file, NULL) != SAG_OK)
        return sagi_params_fail(&p->params, param, "there is no spectrum and no file called \"%.200s\"",
                                text);
    snprintf(source.path, sizeof source.path, "%s", path);
    const char *begin = (const char *)source.file.bytes;
    sagi_cursor cursor = {&source, begin, begin + source.file.size};
    double pairs[2 * 1024];
    size_t count = 0;
    sag_status status;
    sagi_token token;
    while ((status = sagi_cursor_next(&cursor, &token, p->error)) == SAG_OK && token.kind != SAGI_TOKEN_END) {
        const char *const end = token.text.text + token.text.length;
        if (count == sizeof pairs / sizeof *pairs)
            status = sagi_place_error(token.place, p->error, "more than 1024 samples");
        else if (token.kind != SAGI_TOKEN_WORD ||
                 sagi_parse_number(token.text.text, end, &pairs[count++]) != end)
            status = sagi_place_error(token.place, p->error, "a number expected");
        if (status != SAG_OK) break;
    }
    if (status == SAG_OK && (count < 2 || count % 2))
        status = sagi_place_error(token.place, p->error, "pairs of a wavelength and a value expected");
    if (status == SAG_OK) *rgb = sagi_spectrum_sampled(pairs, count / 2, use);
    sagi_file_close(&source.file);
    return p->params.status = status;
}

static sag_rgb rgb_of(sagi_pbrt *p, const sagi_param *param, sagi_spectrum_use use, sag_rgb otherwise) {
    sagi_params *params = &p->params;
    const double *numbers = params->numbers + param->first_number;
    const size_t count = param->number_count;
    sag_rgb rgb = otherwise;
    if (param->type == SAGI_TYPE_RGB) {
        if (count != 3)
            sagi_params_fail(params, param, "a colour has 3 numbers, not %zu", count);
        else
            rgb = (sag_rgb){numbers[0], numbers[1], numbers[2]};
    } else if (param->type == SAGI_TYPE_BLACKBODY) {
        if (count != 1)
            sagi_params_fail(params, param, "a black body has one temperature, not %zu", count);
        else
            rgb = sagi_spectrum_blackbody(numbers[0]);
    } else if (param->type == SAGI_TYPE_SPECTRUM && param->string_count == 1 && count == 0) {
        const sagi_slice name = params->strings[param->first_string];
        if (!sagi_spectrum_named(name, &rgb)) read_spectrum_file(p, param, name, use, &rgb);
    } else if (param->type == SAGI_TYPE_SPECTRUM && param->string_count == 0 && count >= 2 &&
               count % 2 == 0) {
        rgb = sagi_spectrum_sampled(numbers, count / 2, use);
    } else if ((param->type == SAGI_TYPE_FLOAT || param->type == SAGI_TYPE_INTEGER) && count == 1) {
        rgb = (sag_rgb){numbers[0], numbers[0], numbers[0]};
    } else {
        sagi_params_fail(params, param, "\"%.*s\": a name or pairs of a wavelength and a value expected",
                         (int)param->name.length, param->name.text);
    }
    if (!(isfinite(rgb.r) && isfinite(rgb.g) && isfinite(rgb.b)))
        sagi_params_fail(params, param, "\"%.*s\" is not finite", (int)param->name.length, param->name.text);
    return rgb;
}

#define COLOR_TYPES (SAGI_TYPE_RGB | SAGI_TYPE_SPECTRUM | SAGI_TYPE_BLACKBODY | SAGI_TYPE_FLOAT)

sag_rgb sagi_pbrt_rgb(sagi_pbrt *p, const char *name, sagi_spectrum_use use, sag_rgb otherwise) {
    const sagi_param *param = sagi_params_find(&p->params, name, COLOR_TYPES);
    return param ? rgb_of(p, param, use, otherwise) : otherwise;
}

// The texture a parameter names, in the map of its class or, with a word about it, the other.
static sag_texture_id texture_of(sagi_pbrt *p, const sagi_param *param, const sagi_names *first,
                                 const sagi_names *second) {
    sagi_params *params = &p->params;
    uint32_t id = 0;
    if (param->string_count != 1) {
        sagi_params_fail(params, param, "the name of one texture expected");
        return 0;
    }
    const sagi_slice name = params->strings[param->first_string];
    if (!sagi_names_get(first, name, &id) && !sagi_names_get(second, name, &id))
        sagi_params_fail(params, param, "there is no texture \"%.*s\"",
                         (int)(name.length < 100 ? name.length : 100), name.text);
    return id;
}

sag_input sagi_pbrt_spectrum_input(sagi_pbrt *p, const char *name, sagi_spectrum_use use, sag_rgb otherwise) {
    const sagi_param *param = sagi_params_find(&p->params, name, COLOR_TYPES | SAGI_TYPE_TEXTURE);
    sag_input input = {.value = otherwise};
    if (param && param->type == SAGI_TYPE_TEXTURE)
        input.texture = texture_of(p, param, &p->spectrum_textures, &p->float_textures);
    else if (param)
        input.value = rgb_of(p, param, use, otherwise);
    return input;
}

sag_input sagi_pbrt_float_input(sagi_pbrt *p, const char *name, double otherwise) {
    const sagi_param *param =
        sagi_params_find(&p->params, name, SAGI_TYPE_FLOAT | SAGI_TYPE_INTEGER | SAGI_TYPE_TEXTURE);
    sag_input input = {.value = {otherwise, otherwise, otherwise}};
    if (param && param->type == SAGI_TYPE_TEXTURE)
        input.texture = texture_of(p, param, &p->float_textures, &p->spectrum_textures);
    else if (param)
        input.value = rgb_of(p, param, SAGI_SPECTRUM_INDEX, input.value);
    return input;
}

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
    const sag_rgb one = {1, 1, 1}, zero = {0, 0, 0};
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
