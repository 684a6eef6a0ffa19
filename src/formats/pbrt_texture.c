// SPDX-License-Identifier: MIT
// Textures of a pbrt scene, with pbrt-v4's parameters and defaults. A texture stands in the space of its
// directive: mappings from points undo the transform of that place.
#include "formats/number.h"
#include "formats/pbrt_later.h"
#include "formats/pbrt_promise.h"
#include "render/world.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The place of a word in a list that NULL ends, or −1.
static int find_word(const char *const *words, const char *word) {
    for (int i = 0; words[i]; i++)
        if (strcmp(words[i], word) == 0) return i;
    return -1;
}

static void read_space(sagi_pbrt *p, sag_mapping *mapping) {
    const sag_affine now = sagi_pbrt_transform_now(p);
    if (!sag_affine_inverse(&now, &mapping->world_to_texture))
        sagi_params_fail(&p->params, NULL, "the transform is singular: the texture has no space");
}

static void read_vector(sagi_pbrt *p, const char *name, sag_vec3 *v) {
    double triple[3];
    if (sagi_params_triple(&p->params, name, triple)) *v = (sag_vec3){triple[0], triple[1], triple[2]};
}

static void read_mapping(sagi_pbrt *p, sag_mapping *mapping) {
    static const char *const kinds[] = {"uv", "spherical", "cylindrical", "planar", NULL};
    sagi_params *params = &p->params;
    char word[32];
    sagi_params_string(params, "mapping", "uv", word, sizeof word);
    const int kind = find_word(kinds, word);
    if (kind < 0) {
        sagi_params_fail(params, sagi_params_find(params, "mapping", ~0u), "unknown texture mapping \"%s\"",
                         word);
        return;
    }
    mapping->kind = (sag_mapping_kind)kind;
    mapping->u_scale = sagi_params_float(params, "uscale", 1);
    mapping->v_scale = sagi_params_float(params, "vscale", 1);
    mapping->u_offset = sagi_params_float(params, "udelta", 0);
    mapping->v_offset = sagi_params_float(params, "vdelta", 0);
    mapping->v1 = (sag_vec3){1, 0, 0}, mapping->v2 = (sag_vec3){0, 1, 0};
    read_vector(p, "v1", &mapping->v1), read_vector(p, "v2", &mapping->v2);
    if (mapping->kind != SAG_MAPPING_UV) read_space(p, mapping);
}

// A colour or, in a texture of numbers, a number.
static sag_input read_input(sagi_pbrt *p, bool is_number, const char *name, double otherwise) {
    if (is_number) return sagi_pbrt_float_input(p, name, otherwise);
    return sagi_pbrt_spectrum_input(p, name, SAGI_SPECTRUM_REFLECTANCE, otherwise);
}

// "sRGB", "linear" or "gamma 2.2".
static void read_encoding(sagi_pbrt *p, sag_encoding *encoding, double *gamma) {
    char word[64];
    sagi_params_string(&p->params, "encoding", "sRGB", word, sizeof word);
    *encoding = strcmp(word, "linear") == 0 ? SAG_ENCODING_LINEAR : SAG_ENCODING_SRGB;
    *gamma = 0;
    if (*encoding == SAG_ENCODING_LINEAR || strcmp(word, "sRGB") == 0) return;
    const char *const end = word + strlen(word);
    const char *const number = strncmp(word, "gamma ", 6) == 0 ? word + 6 + strspn(word + 6, " ") : NULL;
    if (!number || sagi_parse_number(number, end, gamma) != end || !(*gamma > 0))
        sagi_params_fail(&p->params, sagi_params_find(&p->params, "encoding", ~0u),
                         "unknown encoding \"%s\": sRGB, linear or gamma and a number expected", word);
}

static bool ends_with(const char *path, const char *ending) {
    const size_t length = strlen(path), n = strlen(ending);
    return length >= n && strcmp(path + length - n, ending) == 0;
}

sag_status sagi_pbrt_picture(sagi_pbrt *p, sagi_place place, const char *parameter, sag_encoding encoding,
                             double gamma, sag_picture_id *id) {
    sagi_params *params = &p->params;
    char name[SAGI_MAX_PATH], path[SAGI_MAX_PATH];
    sagi_params_string(params, parameter, "", name, sizeof name);
    if (params->status != SAG_OK) return params->status;
    if (!name[0]) return sagi_params_fail(params, NULL, "the picture's \"%s\" is missing", parameter);
    sagi_pbrt_path(p, name, path);
    if ((encoding == SAG_ENCODING_LINEAR || gamma > 0) &&
        (ends_with(path, ".jpg") || ends_with(path, ".jpeg") || ends_with(path, ".tga")))
        sagi_pbrt_warn_once(p, place, "encoding", "%.200s: an encoding is for PNG files, this one is sRGB",
                            path);
    params->status = sagi_pbrt_picture_later(p, path, sagi_params_find(params, parameter, ~0u)->place,
                                             encoding, gamma, id);
    return params->status;
}

static sag_status read_image(sagi_pbrt *p, sagi_place place, sag_texture *texture) {
    static const char *const wraps[] = {"repeat", "black", "clamp", "octahedralsphere", NULL};
    static const char *const filters[] = {"bilinear", "point", "trilinear", "ewa", "EWA", NULL};
    sagi_params *params = &p->params;
    char word[64];
    texture->kind = SAG_TEXTURE_IMAGE;
    read_mapping(p, &texture->mapping);
    texture->scale = sagi_params_float(params, "scale", 1);
    texture->invert = sagi_params_bool(params, "invert", false);
    texture->max_anisotropy = sagi_params_float(params, "maxanisotropy", 8);
    sagi_params_string(params, "wrap", "repeat", word, sizeof word);
    const int wrap = find_word(wraps, word);
    if (wrap < 0)
        sagi_params_fail(params, sagi_params_find(params, "wrap", ~0u), "unknown wrap mode \"%s\"", word);
    else
        texture->wrap = (sag_wrap)wrap;
    sagi_params_string(params, "filter", "bilinear", word, sizeof word);
    const int filter = find_word(filters, word);
    if (filter < 0)
        sagi_params_fail(params, sagi_params_find(params, "filter", ~0u), "unknown filter \"%s\"", word);
    else
        texture->filter = filter == 4 ? SAG_LOOKUP_EWA : (sag_texture_filter)filter;
    sag_encoding encoding;
    double gamma;
    read_encoding(p, &encoding, &gamma);
    const sag_status status = sagi_pbrt_picture(p, place, "filename", encoding, gamma, &texture->picture);
    if (status == SAG_OK && texture->scale == 0) { // which the texture takes for 1
        texture->kind = SAG_TEXTURE_CONSTANT;
        texture->a.value.r = texture->a.value.g = texture->a.value.b = texture->invert ? 1 : 0;
    }
    return status;
}

static void read_checkerboard(sagi_pbrt *p, sag_texture *texture) {
    texture->kind = SAG_TEXTURE_CHECKERBOARD;
    texture->a = read_input(p, texture->is_number, "tex1", 1);
    texture->b = read_input(p, texture->is_number, "tex2", 0);
    const int32_t dimension = sagi_params_integer(&p->params, "dimension", 2);
    texture->dimension = (uint32_t)dimension;
    if (dimension == 2)
        read_mapping(p, &texture->mapping);
    else if (dimension == 3)
        read_space(p, &texture->mapping);
    else
        sagi_params_fail(&p->params, NULL, "dimension %d: it must be 2 or 3", dimension);
}

static void read_direction_mix(sagi_pbrt *p, sag_texture *texture) {
    texture->kind = SAG_TEXTURE_DIRECTION_MIX;
    texture->a = read_input(p, texture->is_number, "tex1", 0);
    texture->b = read_input(p, texture->is_number, "tex2", 1);
    sag_vec3 direction = {0, 1, 0};
    read_vector(p, "dir", &direction);
    const sag_affine now = sagi_pbrt_transform_now(p);
    texture->direction = sag_normalize(sag_affine_vector(&now, direction));
}

static void read_bilerp(sagi_pbrt *p, sag_texture *texture) {
    texture->kind = SAG_TEXTURE_BILERP;
    read_mapping(p, &texture->mapping);
    texture->a = read_input(p, texture->is_number, "v00", 0);
    texture->b = read_input(p, texture->is_number, "v01", 1);
    texture->c = read_input(p, texture->is_number, "v10", 0);
    texture->d = read_input(p, texture->is_number, "v11", 1);
}

// pbrt-v4 paints the dots with "outside" and the ground with "inside" (it hands the two over in the wrong
// order); its scenes are made to look right that way.
static void read_dots(sagi_pbrt *p, sag_texture *texture) {
    texture->kind = SAG_TEXTURE_DOTS;
    read_mapping(p, &texture->mapping);
    texture->a = read_input(p, texture->is_number, "inside", 1);
    texture->b = read_input(p, texture->is_number, "outside", 0);
}

static void read_noise(sagi_pbrt *p, sag_texture_kind kind, sag_texture *texture) {
    texture->kind = kind;
    read_space(p, &texture->mapping);
    if (kind == SAG_TEXTURE_WINDY) return;
    const int32_t octaves = sagi_params_integer(&p->params, "octaves", 8);
    if (octaves < 1)
        sagi_params_fail(&p->params, sagi_params_find(&p->params, "octaves", ~0u),
                         "octaves %d: there must be 1 at least", octaves);
    texture->octaves = (uint32_t)octaves;
    texture->omega = sagi_params_float(&p->params, "roughness", 0.5);
    // 0 is a value here, not the default: an octave that nobody sees.
    if (texture->omega == 0) texture->omega = 1e-30;
    if (kind != SAG_TEXTURE_MARBLE) return;
    texture->scale = sagi_params_float(&p->params, "scale", 1);
    texture->variation = sagi_params_float(&p->params, "variation", 0.2);
    if (texture->variation == 0) texture->variation = 1e-30;
}

static sag_status read_texture(sagi_pbrt *p, sagi_place place, const char *kind, sag_texture *texture) {
    static const char *const noises[] = {"fbm", "wrinkled", "windy", "marble", NULL};
    const bool is_number = texture->is_number;
    if (strcmp(kind, "constant") == 0) {
        texture->a = read_input(p, is_number, "value", 1);
    } else if (strcmp(kind, "scale") == 0) {
        texture->kind = SAG_TEXTURE_SCALE;
        texture->a = read_input(p, is_number, "tex", 1);
        texture->b = sagi_pbrt_float_input(p, "scale", 1);
    } else if (strcmp(kind, "mix") == 0) {
        texture->kind = SAG_TEXTURE_MIX;
        texture->a = read_input(p, is_number, "tex1", 0);
        texture->b = read_input(p, is_number, "tex2", 1);
        texture->amount = sagi_pbrt_float_input(p, "amount", 0.5);
    } else if (strcmp(kind, "directionmix") == 0) {
        read_direction_mix(p, texture);
    } else if (strcmp(kind, "bilerp") == 0) {
        read_bilerp(p, texture);
    } else if (strcmp(kind, "checkerboard") == 0) {
        read_checkerboard(p, texture);
    } else if (strcmp(kind, "dots") == 0) {
        read_dots(p, texture);
    } else if (find_word(noises, kind) >= 0) {
        read_noise(p, (sag_texture_kind)(SAG_TEXTURE_FBM + find_word(noises, kind)), texture);
    } else if (strcmp(kind, "imagemap") == 0) {
        return read_image(p, place, texture);
    } else if (strcmp(kind, "ptex") == 0) {
        sagi_pbrt_warn_once(p, place, kind,
                            "the texture \"ptex\" is not supported: one grey takes its place");
        for (size_t i = 0; i < p->params.count; i++) p->params.items[i].used = true;
        texture->a.value = (sag_rgb){0.5, 0.5, 0.5};
    } else {
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
    sag_texture texture = {.kind = SAG_TEXTURE_CONSTANT, .is_number = !is_color};
    status = read_texture(p, place, kind, &texture);
    if (status == SAG_OK) status = sagi_pbrt_parameters_done(p);
    if (status != SAG_OK) return status;
    sagi_names *const names = is_color ? &p->spectrum_textures : &p->float_textures;
    const sag_texture_id promised = sagi_pbrt_promised(p, names, name);
    if (promised && sagi_texture_set(p->world, promised, &texture))
        return sagi_pbrt_keep(p, names, name), SAG_OK;
    const sag_texture_id id = promised ? 0 : sag_world_add_texture(p->world, &texture);
    if (!id) { // out of memory or nested too deep, which a plain one tells apart
        const sag_texture plain = {.kind = SAG_TEXTURE_CONSTANT};
        if (!sag_world_add_texture(p->world, &plain)) return sagi_pbrt_out_of_memory(p);
        return sagi_place_error(place, p->error, "the textures \"%.60s\" is made of nest too deep", name);
    }
    return sagi_pbrt_define(p, place, names, name, id, is_color ? "spectrum texture" : "float texture");
}
