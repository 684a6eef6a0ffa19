// SPDX-License-Identifier: MIT
// Materials of models that Assimp reads, as ours.
//
// glTF 2.0 (Khronos, appendix B) describes a surface by base colour, metallic m and roughness r: a metal that
// reflects the base colour with the share m, else a coat of index 1.5 over a diffuse base of that colour, α =
// r² for both. That is a mix of two of our materials; one where m is 0 or 1 throughout. Metallic is a
// picture's blue, roughness its green; alpha is the base colour's. Transmission makes it glass.
//
// Wavefront's MTL has Kd, Ks, the exponent Ns of Phong's highlight and d, how opaque it is. A highlight cosⁿ
// is about as wide as that of facets of α = √(2/(n + 2)) (Walter et al. 2007). So Ks makes a coat, or a metal
// where there is no Kd; what is hardly opaque is glass. bump has no unit: its heights are taken to be a
// hundredth of the picture's width, and made a normal map.
//
// KHR_materials_unlit shows its colour whatever the light: it shines so itself.
#include "formats/import_material.h"

#include "formats/file.h"
#include "formats/image.h"
#include "formats/output.h"

#include <assimp/cimport.h>
#include <assimp/GltfMaterial.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define BUMP_HEIGHT 0.01

// ---- pictures

static const struct aiTexture *embedded_of(const sagi_import_source *s, const struct aiString *name) {
    if (name->data[0] != '*') return NULL;
    unsigned index = 0;
    for (const char *p = name->data + 1; *p >= '0' && *p <= '9' && index < 1000000; p++)
        index = 10 * index + (unsigned)(*p - '0');
    return index < s->scene->mNumTextures ? s->scene->mTextures[index] : NULL;
}

static bool path_of(const sagi_import_source *s, const struct aiString *name, char path[SAGI_MAX_PATH]) {
    const int length =
        snprintf(path, SAGI_MAX_PATH, "%s%s", name->data[0] == '/' ? "" : s->directory, name->data);
    for (char *p = path; *p; p++)
        if (*p == '\\') *p = '/';
    return length >= 0 && length < SAGI_MAX_PATH && name->data[0] != '*';
}

static void warn(const sagi_import_source *s, const struct aiString *name, const char *what) {
    sag_context_log(sag_world_context(s->world), SAG_LOG_WARNING, "%s: warning: texture %s: %s", s->path,
                    name->data, what);
}

// A picture as floats. False with a warning.
static bool read_image(const sagi_import_source *s, const struct aiString *name, sag_encoding encoding,
                       sag_image *image) {
    const sag_context *context = sag_world_context(s->world);
    const struct aiTexture *embedded = embedded_of(s, name);
    char path[SAGI_MAX_PATH];
    sag_error error;
    sag_status status = SAG_OK;
    if (embedded && embedded->mHeight == 0) {
        const sagi_image_source source = {context,          s->path,  (const uint8_t *)embedded->pcData,
                                          embedded->mWidth, encoding, NULL};
        status = sagi_image_decode(&source, image, &error);
    } else if (!path_of(s, name, path)) {
        warn(s, name, "it is not there");
        return false;
    } else {
        status = sag_image_read(context, path, encoding, image, &error);
    }
    if (status != SAG_OK) warn(s, name, error.message);
    return status == SAG_OK;
}

// A picture of the world. 0 with a warning.
static sag_picture_id add_picture(const sagi_import_source *s, const struct aiString *name,
                                  sag_encoding encoding) {
    char path[SAGI_MAX_PATH];
    sag_picture_id id = 0;
    if (embedded_of(s, name) || !path_of(s, name, path)) {
        sag_image image;
        return read_image(s, name, encoding, &image) ? sag_world_add_picture(s->world, &image) : 0;
    }
    sag_error error;
    if (sag_world_load_picture(s->world, path, encoding, 0, &id, &error) == SAG_OK) return id;
    warn(s, name, error.message);
    return 0;
}

static bool find_texture(const struct aiMaterial *from, unsigned type, struct aiString *name) {
    return aiGetMaterialTexture(from, (enum aiTextureType)type, 0, name, NULL, NULL, NULL, NULL, NULL,
                                NULL) == aiReturn_SUCCESS;
}

// One channel of a picture, times a factor, through `shape`, as a texture of numbers; 0 with a warning.
static sag_texture_id add_channel(const sagi_import_source *s, const struct aiString *name, uint32_t channel,
                                  double factor, double (*shape)(double value, double parameter),
                                  double parameter) {
    const sag_context *context = sag_world_context(s->world);
    sag_image from;
    if (!read_image(s, name, SAG_ENCODING_LINEAR, &from)) return 0;
    sag_texture texture = {.kind = SAG_TEXTURE_IMAGE, .is_number = true};
    const bool is_alpha = channel == 3, has_alpha = from.channels == 2 || from.channels == 4;
    if (is_alpha && has_alpha) channel = from.channels - 1;
    const bool present = is_alpha ? has_alpha : true;
    const uint32_t at = channel < from.channels ? channel : 0;
    sag_texture_id id = 0;
    if (present && sag_image_create(context, from.width, from.height, 1, &texture.image, NULL) == SAG_OK) {
        const size_t count = (size_t)from.width * from.height;
        for (size_t i = 0; i < count; i++)
            texture.image.pixels[i] =
                (float)shape((double)from.pixels[i * from.channels + at] * factor, parameter);
        id = sag_world_add_texture(s->world, &texture);
    }
    sag_image_clear(context, &from);
    return id;
}

static double as_it_is(double value, double parameter) {
    (void)parameter;
    return value;
}
static double squared(double value, double parameter) {
    (void)parameter;
    return value * value;
}
static double cut(double value, double parameter) { return value >= parameter ? 1 : 0; }

// The normals of a picture of heights, which wraps around; 0 with a warning. Rows run down, v up.
static sag_picture_id add_bump(const sagi_import_source *s, const struct aiString *name, double scale) {
    const sag_context *context = sag_world_context(s->world);
    sag_image heights, normals;
    if (!read_image(s, name, SAG_ENCODING_LINEAR, &heights)) return 0;
    const uint32_t w = heights.width, h = heights.height, n = heights.channels;
    if (sag_image_create(context, w, h, 3, &normals, NULL) != SAG_OK) {
        sag_image_clear(context, &heights);
        return 0;
    }
    const double slope = scale * BUMP_HEIGHT * w / 2; // of the difference over two texels
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            const float *row = heights.pixels + (size_t)y * w * n;
            const float *above = heights.pixels + (size_t)((y + h - 1) % h) * w * n,
                        *below = heights.pixels + (size_t)((y + 1) % h) * w * n;
            const double dx = (double)(row[(size_t)((x + 1) % w) * n] - row[(size_t)((x + w - 1) % w) * n]),
                         dy = (double)(above[(size_t)x * n] - below[(size_t)x * n]);
            const sag_vec3 normal = sag_normalize(sag_vec3_make(-slope * dx, -slope * dy, 1));
            float *p = normals.pixels + ((size_t)y * w + x) * 3;
            p[0] = (float)(normal.x + 1) / 2, p[1] = (float)(normal.y + 1) / 2;
            p[2] = (float)(normal.z + 1) / 2;
        }
    sag_image_clear(context, &heights);
    return sag_world_add_picture(s->world, &normals);
}

// ---- numbers and colours

static bool get_color(const struct aiMaterial *material, const char *key, unsigned type, unsigned index,
                      sag_rgb *rgb) {
    struct aiColor4D c;
    if (aiGetMaterialColor(material, key, type, index, &c) != aiReturn_SUCCESS) return false;
    *rgb = (sag_rgb){(double)c.r, (double)c.g, (double)c.b};
    return true;
}

static double get_number(const struct aiMaterial *material, const char *key, unsigned type, unsigned index,
                         double otherwise) {
    float value;
    unsigned count = 1;
    return aiGetMaterialFloatArray(material, key, type, index, &value, &count) == aiReturn_SUCCESS
               ? (double)value
               : otherwise;
}

static sag_input constant(double x) { return (sag_input){.value = {x, x, x}}; }
static double most(sag_rgb c) { return fmax(c.r, fmax(c.g, c.b)); }

// A colour that may have a picture, which it multiplies.
static sag_input color_input(const sagi_import_source *s, const struct aiMaterial *from, sag_rgb color,
                             unsigned type) {
    const sag_input plain = {.value = color};
    struct aiString name;
    sag_texture texture = {.kind = SAG_TEXTURE_IMAGE};
    if (!find_texture(from, type, &name)) return plain;
    texture.picture = add_picture(s, &name, SAG_ENCODING_DEFAULT);
    if (texture.picture == 0) return plain;
    const sag_texture_id picture = sag_world_add_texture(s->world, &texture);
    // Kd of materials that have a picture is often left black by what wrote them.
    if ((color.r == 1 && color.g == 1 && color.b == 1) || most(color) == 0)
        return (sag_input){.texture = picture};
    const sag_texture product = {.kind = SAG_TEXTURE_SCALE, .a = {.texture = picture}, .b = plain};
    return (sag_input){.texture = sag_world_add_texture(s->world, &product)};
}

// ---- the kinds

typedef struct look_parts {
    sag_input color, roughness, metallic; // α; the share of metal
    double index, transmission;
} look_parts;

static double index_of(const struct aiMaterial *from) {
    const double index = get_number(from, AI_MATKEY_REFRACTI, 1.5);
    return index > 1 && index < 4 ? index : 1.5;
}

static void read_metallic_roughness(const sagi_import_source *s, const struct aiMaterial *from,
                                    look_parts *parts) {
    const double metallic = get_number(from, AI_MATKEY_METALLIC_FACTOR, 1),
                 roughness = get_number(from, AI_MATKEY_ROUGHNESS_FACTOR, 1);
    parts->metallic = constant(metallic);
    parts->roughness = constant(roughness * roughness);
    struct aiString name;
    const bool both = find_texture(from, aiTextureType_UNKNOWN, &name);
    if (roughness > 0 && (both || find_texture(from, aiTextureType_DIFFUSE_ROUGHNESS, &name)))
        parts->roughness.texture = add_channel(s, &name, 1, roughness, squared, 0);
    if (metallic > 0 && (both || find_texture(from, aiTextureType_METALNESS, &name)))
        parts->metallic.texture = add_channel(s, &name, 2, metallic, as_it_is, 0);
}

static void read_normals(const sagi_import_source *s, const struct aiMaterial *from, sag_material *material) {
    struct aiString name;
    if (find_texture(from, aiTextureType_NORMALS, &name))
        material->normal_map = add_picture(s, &name, SAG_ENCODING_LINEAR);
    else if (find_texture(from, aiTextureType_HEIGHT, &name))
        material->normal_map =
            add_bump(s, &name, get_number(from, "$tex.bumpmult", aiTextureType_HEIGHT, 0, 1));
}

// Glass, metal, coated or mixed, with the normal map.
static uint32_t add_material(const sagi_import_source *s, const struct aiMaterial *from,
                             const look_parts *parts) {
    sag_material material = {
        .reflectance = parts->color, .roughness_u = parts->roughness, .roughness_v = parts->roughness};
    read_normals(s, from, &material);
    const bool some_metal = parts->metallic.texture || parts->metallic.value.r > 0,
               all_metal = !parts->metallic.texture && parts->metallic.value.r >= 1;
    sag_material metal = material, plain = material;
    metal.kind = SAG_MATERIAL_CONDUCTOR;
    plain.kind = SAG_MATERIAL_COATED_DIFFUSE;
    plain.eta = constant(parts->index);
    if (parts->transmission > 0.5) plain.kind = SAG_MATERIAL_DIELECTRIC;
    if (all_metal) return sag_world_add_material(s->world, &metal);
    const uint32_t base = sag_world_add_material(s->world, &plain);
    if (!some_metal || base == 0) return base;
    const sag_material mix = {.kind = SAG_MATERIAL_MIX,
                              .materials = {base, sag_world_add_material(s->world, &metal)},
                              .amount = parts->metallic};
    return sag_world_add_material(s->world, &mix);
}

static uint32_t add_physical(const sagi_import_source *s, const struct aiMaterial *from, sag_rgb color) {
    struct aiString name;
    const bool own = find_texture(from, aiTextureType_BASE_COLOR, &name);
    look_parts parts = {
        .color = color_input(s, from, color, own ? aiTextureType_BASE_COLOR : aiTextureType_DIFFUSE),
        .index = index_of(from),
        .transmission = get_number(from, AI_MATKEY_TRANSMISSION_FACTOR, 0)};
    read_metallic_roughness(s, from, &parts);
    return add_material(s, from, &parts);
}

static uint32_t add_phong(const sagi_import_source *s, const struct aiMaterial *from, sag_rgb color,
                          double opacity) {
    sag_rgb highlight = {0, 0, 0};
    get_color(from, AI_MATKEY_COLOR_SPECULAR, &highlight);
    const double exponent = fmax(get_number(from, AI_MATKEY_SHININESS, 0), 0);
    const double alpha = sqrt(2 / (exponent + 2));
    look_parts parts = {.color = color_input(s, from, color, aiTextureType_DIFFUSE),
                        .index = index_of(from),
                        .transmission = opacity < 0.5 ? 1 : 0,
                        .roughness = constant(opacity < 0.5 && exponent == 0 ? 0 : alpha)};
    const bool shines = most(highlight) > 0.01 && exponent > 1;
    if (shines && most(color) == 0 && !parts.color.texture && opacity >= 0.5) {
        parts.color.value = highlight;
        parts.metallic = constant(1);
    } else if (!shines && opacity >= 0.5) {
        sag_material plain = {.kind = SAG_MATERIAL_DIFFUSE, .reflectance = parts.color};
        read_normals(s, from, &plain);
        return sag_world_add_material(s->world, &plain);
    }
    return add_material(s, from, &parts);
}

// ---- what a look has beside its material

static void read_alpha(const sagi_import_source *s, const struct aiMaterial *from, double opacity,
                       sag_appearance *look) {
    struct aiString mode, name;
    const bool is_gltf = aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS;
    const bool is_mask = is_gltf && strcmp(mode.data, "MASK") == 0,
               is_blend = is_gltf && strcmp(mode.data, "BLEND") == 0;
    const double cutoff = get_number(from, AI_MATKEY_GLTF_ALPHACUTOFF, 0.5);
    if (is_mask || is_blend) {
        if (find_texture(from, aiTextureType_BASE_COLOR, &name))
            look->alpha.texture =
                add_channel(s, &name, 3, opacity, is_mask ? cut : as_it_is, is_mask ? cutoff : 0);
        if (look->alpha.texture) return;
        if (is_mask) opacity = cut(opacity, cutoff);
    } else if (is_gltf) {
        return;
    } else if (find_texture(from, aiTextureType_OPACITY, &name)) {
        look->alpha.texture = add_channel(s, &name, 0, 1, as_it_is, 0);
        return;
    } else if (opacity < 0.5) {
        return; // glass
    }
    if (opacity >= 1) return;
    const sag_texture texture = {.kind = SAG_TEXTURE_CONSTANT, .is_number = true, .a = constant(opacity)};
    look->alpha.texture = sag_world_add_texture(s->world, &texture);
}

static void read_emission(const sagi_import_source *s, const struct aiMaterial *from, sag_appearance *look) {
    if (!get_color(from, AI_MATKEY_COLOR_EMISSIVE, &look->emission) || most(look->emission) == 0) return;
    const double strength = get_number(from, AI_MATKEY_EMISSIVE_INTENSITY, 1);
    look->emission =
        (sag_rgb){look->emission.r * strength, look->emission.g * strength, look->emission.b * strength};
    struct aiString name;
    if (!find_texture(from, aiTextureType_EMISSIVE, &name)) return;
    sag_texture texture = {.kind = SAG_TEXTURE_IMAGE};
    texture.picture = add_picture(s, &name, SAG_ENCODING_DEFAULT);
    if (texture.picture != 0) look->emission_texture = sag_world_add_texture(s->world, &texture);
}

bool sagi_import_look(const sagi_import_source *s, const struct aiMaterial *from, sag_appearance *look) {
    *look = (sag_appearance){0};
    struct aiString name, mode;
    sag_rgb color = {0.6, 0.6, 0.6};
    const bool named = aiGetMaterialString(from, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS;
    const bool is_gltf = aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS;
    const bool is_physical = is_gltf || get_number(from, AI_MATKEY_METALLIC_FACTOR, -1) >= 0;
    const bool has_color =
        get_color(from, AI_MATKEY_BASE_COLOR, &color) || get_color(from, AI_MATKEY_COLOR_DIFFUSE, &color);
    if (!has_color || (named && strcmp(name.data, "DefaultMaterial") == 0)) {
        look->material = sagi_default_material(s->world);
        return look->material != 0;
    }
    double opacity = get_number(from, AI_MATKEY_OPACITY, 1);
    struct aiColor4D base;
    if (is_gltf && aiGetMaterialColor(from, AI_MATKEY_BASE_COLOR, &base) == aiReturn_SUCCESS)
        opacity = (double)base.a;
    int shading = 0;
    unsigned count = 1;
    if (aiGetMaterialIntegerArray(from, AI_MATKEY_SHADING_MODEL, &shading, &count) == aiReturn_SUCCESS &&
        is_gltf && shading == aiShadingMode_Unlit) {
        const bool own = find_texture(from, aiTextureType_BASE_COLOR, &name);
        const sag_input shown =
            color_input(s, from, (sag_rgb){1, 1, 1}, own ? aiTextureType_BASE_COLOR : aiTextureType_DIFFUSE);
        look->emission = color;
        look->emission_texture = shown.texture;
        look->two_sided = true;
        look->material = sag_world_add_material(s->world, &(sag_material){.kind = SAG_MATERIAL_DIFFUSE});
        read_alpha(s, from, opacity, look);
        return look->material != 0;
    }
    look->material = is_physical ? add_physical(s, from, color) : add_phong(s, from, color, opacity);
    read_alpha(s, from, opacity, look);
    read_emission(s, from, look);
    return look->material != 0;
}
