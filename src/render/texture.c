// SPDX-License-Identifier: MIT
// Textures: colours and numbers that vary over a surface. They form a graph without cycles, at most
// SAGI_MAX_TEXTURE_DEPTH deep and of SAGI_MAX_TEXTURE_PARTS parts (sagi_texture_prepare sees to it), so the
// recursion here is bounded, in depth and in time.
//
// Each can be asked for a number, an RGB colour or a spectrum. The last is not made of the second: what is
// mixed are spectra, so that two measured ones mix as they do in nature; only pictures and marble are RGB to
// begin with.
//
// Most kinds are a mean of their inputs, with weights that depend on the place; inputs of weight 0 are not
// looked at. The others are a product, a picture, or made of noise.
#include "noise.h"
#include "pattern.h"
#include "world.h"

static const sagi_texture *texture_of(const sag_world *world, const sag_input *input) {
    if (input->texture == 0 || input->texture > world->textures.count) return NULL;
    return (const sagi_texture *)world->textures.items + (input->texture - 1);
}

// The weights of a, b, c and d.
typedef struct weights {
    double of[4];
} weights;

static weights bilinear_weights(const sagi_spot_2d *at) {
    const double s = at->s, t = at->t;
    return (weights){{(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t}};
}

static weights weights_of(const sag_world *world, const sagi_texture *entry, const sagi_spot *at) {
    const sag_texture *texture = &entry->texture;
    double b = 0;
    switch (texture->kind) {
    case SAG_TEXTURE_MIX: b = sagi_input_number(world, &texture->amount, at); break;
    case SAG_TEXTURE_DIRECTION_MIX: b = 1 - fabs(sag_dot(at->normal, texture->direction)); break;
    case SAG_TEXTURE_CHECKERBOARD: {
        if (texture->dimension == 3) {
            const sagi_spot_3d in = sagi_mapping_3d(&entry->mapping, at);
            b = sagi_checkerboard_3d(&in);
        } else {
            const sagi_spot_2d in = sagi_mapping_2d(&entry->mapping, at);
            b = sagi_checkerboard_2d(&in);
        }
        break;
    }
    case SAG_TEXTURE_DOTS: {
        const sagi_spot_2d in = sagi_mapping_2d(&entry->mapping, at);
        b = sagi_in_dot(in.s, in.t) ? 1 : 0;
        break;
    }
    case SAG_TEXTURE_BILERP: {
        const sagi_spot_2d in = sagi_mapping_2d(&entry->mapping, at);
        return bilinear_weights(&in);
    }
    case SAG_TEXTURE_CONSTANT:
    case SAG_TEXTURE_SCALE:
    case SAG_TEXTURE_IMAGE:
    case SAG_TEXTURE_FBM:
    case SAG_TEXTURE_WRINKLED:
    case SAG_TEXTURE_WINDY:
    case SAG_TEXTURE_MARBLE: break;
    }
    return (weights){{1 - b, b, 0, 0}};
}

static const sag_input *input_of(const sag_texture *texture, int i) {
    const sag_input *const inputs[] = {&texture->a, &texture->b, &texture->c, &texture->d};
    return inputs[i];
}

static sagi_texel look_up(const sag_world *world, const sagi_texture *entry, const sagi_spot *at) {
    const sagi_mipmap *picture = sagi_world_picture(world, entry->texture.picture);
    if (!picture) return (sagi_texel){0};
    const sagi_spot_2d in = sagi_mapping_2d(&entry->mapping, at);
    return sagi_mipmap_lookup(picture, &entry->lookup, &in) * (float)entry->texture.scale;
}

static double noise_of(const sagi_texture *entry, const sagi_spot *at) {
    const sag_texture *texture = &entry->texture;
    const sagi_spot_3d in = sagi_mapping_3d(&entry->mapping, at);
    const int octaves = (int)texture->octaves;
    if (texture->kind == SAG_TEXTURE_FBM)
        return sagi_noise_fbm(in.p, in.dpdx, in.dpdy, texture->omega, octaves);
    if (texture->kind == SAG_TEXTURE_WINDY) return sagi_windy(&in);
    return sagi_noise_turbulence(in.p, in.dpdx, in.dpdy, texture->omega, octaves);
}

static sag_rgb marble_of(const sagi_texture *entry, const sagi_spot *at) {
    const sag_texture *texture = &entry->texture;
    const sagi_spot_3d in = sagi_mapping_3d(&entry->mapping, at);
    return sagi_marble(&in, texture->scale, texture->variation, texture->omega, (int)texture->octaves);
}

static double number(const sag_world *world, const sagi_texture *entry, const sagi_spot *at) {
    const sag_texture *texture = &entry->texture;
    switch (texture->kind) {
    case SAG_TEXTURE_CONSTANT: return sagi_input_number(world, &texture->a, at);
    case SAG_TEXTURE_SCALE: {
        const double factor = sagi_input_number(world, &texture->b, at);
        return factor == 0 ? 0 : factor * sagi_input_number(world, &texture->a, at);
    }
    case SAG_TEXTURE_IMAGE: {
        const double value = (double)look_up(world, entry, at)[3];
        return texture->invert ? fmax(0, 1 - value) : value;
    }
    case SAG_TEXTURE_FBM:
    case SAG_TEXTURE_WRINKLED:
    case SAG_TEXTURE_WINDY: return noise_of(entry, at);
    case SAG_TEXTURE_MARBLE: return sagi_rgb_mean(marble_of(entry, at));
    case SAG_TEXTURE_MIX:
    case SAG_TEXTURE_CHECKERBOARD:
    case SAG_TEXTURE_DIRECTION_MIX:
    case SAG_TEXTURE_BILERP:
    case SAG_TEXTURE_DOTS: break;
    }
    const weights w = weights_of(world, entry, at);
    double sum = 0;
    for (int i = 0; i < 4; i++)
        if (w.of[i] != 0) sum += w.of[i] * sagi_input_number(world, input_of(texture, i), at);
    return sum;
}

double sagi_input_looked_up(const sag_world *world, const sag_input *input, const sagi_spot *at) {
    const sagi_texture *entry = texture_of(world, input);
    return entry ? number(world, entry, at) : sagi_input_plain(world, input).r;
}

static sag_rgb picture_color(const sag_world *world, const sagi_texture *entry, const sagi_spot *at) {
    const sagi_texel t = look_up(world, entry, at);
    sag_rgb value = sagi_rgb((double)t[0], (double)t[1], (double)t[2]);
    if (entry->texture.invert) value = sagi_rgb_sub(sagi_rgb_grey(1), value);
    return sagi_rgb(fmax(value.r, 0), fmax(value.g, 0), fmax(value.b, 0));
}

static sag_color_space picture_space(const sag_world *world, const sagi_texture *entry) {
    const sagi_mipmap *picture = sagi_world_picture(world, entry->texture.picture);
    return picture ? picture->color_space : SAG_COLOR_SRGB;
}

static sag_rgb color(const sag_world *world, const sagi_texture *entry, const sagi_spot *at) {
    const sag_texture *texture = &entry->texture;
    if (texture->is_number) return sagi_rgb_grey(number(world, entry, at));
    switch (texture->kind) {
    case SAG_TEXTURE_CONSTANT: return sagi_input_rgb(world, &texture->a, at);
    case SAG_TEXTURE_SCALE: {
        const sag_rgb factor = sagi_input_rgb(world, &texture->b, at);
        if (sagi_rgb_is_black(factor)) return sagi_rgb_grey(0);
        return sagi_rgb_mul(factor, sagi_input_rgb(world, &texture->a, at));
    }
    case SAG_TEXTURE_IMAGE: {
        const sag_rgb own = picture_color(world, entry, at);
        const sag_color_space space = picture_space(world, entry);
        return space == SAG_COLOR_SRGB ? own : sagi_rgb_convert(space, SAG_COLOR_SRGB, own);
    }
    case SAG_TEXTURE_FBM:
    case SAG_TEXTURE_WRINKLED:
    case SAG_TEXTURE_WINDY: return sagi_rgb_grey(noise_of(entry, at));
    case SAG_TEXTURE_MARBLE: return marble_of(entry, at);
    case SAG_TEXTURE_MIX:
    case SAG_TEXTURE_CHECKERBOARD:
    case SAG_TEXTURE_DIRECTION_MIX:
    case SAG_TEXTURE_BILERP:
    case SAG_TEXTURE_DOTS: break;
    }
    const weights w = weights_of(world, entry, at);
    sag_rgb sum = {0, 0, 0};
    for (int i = 0; i < 4; i++)
        if (w.of[i] != 0)
            sum = sagi_rgb_add(sum, sagi_rgb_scale(sagi_input_rgb(world, input_of(texture, i), at), w.of[i]));
    return sum;
}

sag_rgb sagi_input_rgb(const sag_world *world, const sag_input *input, const sagi_spot *at) {
    const sagi_texture *entry = texture_of(world, input);
    return entry ? color(world, entry, at) : sagi_input_plain(world, input);
}

// A factor is a number where nothing says that it is a colour.
static bool is_number(const sag_world *world, const sag_input *input) {
    const sagi_texture *entry = texture_of(world, input);
    if (entry) return entry->texture.is_number;
    return input->spectrum == 0 && input->value.r == input->value.g && input->value.g == input->value.b;
}

static sagi_spectrum spectrum(const sag_world *world, const sagi_texture *entry, sagi_rgb_use use,
                              const sagi_spot *at, sagi_spectrum lambda) {
    const sag_texture *texture = &entry->texture;
    if (texture->is_number) return sagi_spectrum_all(number(world, entry, at));
    const sagi_color *colors = entry->colors[use == SAGI_RGB_UNBOUNDED];
    switch (texture->kind) {
    case SAG_TEXTURE_CONSTANT: return sagi_input_spectrum(world, &texture->a, &colors[0], use, at, lambda);
    case SAG_TEXTURE_SCALE: {
        const sagi_spectrum factor =
            is_number(world, &texture->b)
                ? sagi_spectrum_all(sagi_input_number(world, &texture->b, at))
                : sagi_input_spectrum(world, &texture->b, &colors[1], use, at, lambda);
        if (sagi_spectrum_is_black(factor)) return sagi_spectrum_all(0);
        return factor * sagi_input_spectrum(world, &texture->a, &colors[0], use, at, lambda);
    }
    case SAG_TEXTURE_IMAGE: {
        const sagi_color texel =
            sagi_color_of_texel(picture_space(world, entry), picture_color(world, entry, at), use);
        return sagi_color_at(&texel, lambda);
    }
    case SAG_TEXTURE_MARBLE: {
        const sagi_color texel = sagi_color_of_texel(SAG_COLOR_SRGB, color(world, entry, at), use);
        return sagi_color_at(&texel, lambda);
    }
    case SAG_TEXTURE_FBM:
    case SAG_TEXTURE_WRINKLED:
    case SAG_TEXTURE_WINDY: return sagi_spectrum_all(noise_of(entry, at));
    case SAG_TEXTURE_MIX:
    case SAG_TEXTURE_CHECKERBOARD:
    case SAG_TEXTURE_DIRECTION_MIX:
    case SAG_TEXTURE_BILERP:
    case SAG_TEXTURE_DOTS: break;
    }
    const weights w = weights_of(world, entry, at);
    sagi_spectrum sum = sagi_spectrum_all(0);
    for (int i = 0; i < 4; i++)
        if (w.of[i] != 0)
            sum += (float)w.of[i] *
                   sagi_input_spectrum(world, input_of(texture, i), &colors[i], use, at, lambda);
    return sum;
}

sagi_spectrum sagi_input_textured(const sag_world *world, const sag_input *input, const sagi_color *made,
                                  sagi_rgb_use use, const sagi_spot *at, sagi_spectrum lambda) {
    const sagi_texture *entry = texture_of(world, input);
    if (!entry) return sagi_color_at(made, lambda);
    if (use != SAGI_RGB_ILLUMINANT) return spectrum(world, entry, use, at, lambda);
    const sagi_color texel = sagi_color_of_texel(SAG_COLOR_SRGB, color(world, entry, at), use);
    return sagi_color_at(&texel, lambda);
}
