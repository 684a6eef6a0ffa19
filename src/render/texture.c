// SPDX-License-Identifier: MIT
// Textures: numbers that vary over a surface. They form a graph without cycles, at most
// SAGI_MAX_TEXTURE_DEPTH deep (sag_world_add_texture sees to it), so the recursion here is bounded.
#include "world.h"

// Which texel stands at index i of n, or −1: none.
static int64_t wrap_index(double i, uint32_t n, sag_wrap wrap) {
    if (i >= 0 && i < n) return (int64_t)i;
    switch (wrap) {
    case SAG_WRAP_REPEAT: return (int64_t)sagi_clamp(i - floor(i / n) * n, 0, n - 1.0);
    case SAG_WRAP_CLAMP: return i < 0 ? 0 : n - 1;
    case SAG_WRAP_OCTAHEDRAL:
    case SAG_WRAP_BLACK: break;
    }
    return -1;
}

static sag_rgb texel(const sag_image *image, double x, double y, sag_wrap wrap) {
    int64_t column = wrap_index(x, image->width, wrap), row = wrap_index(y, image->height, wrap);
    if (column < 0 || row < 0) return (sag_rgb){0, 0, 0};
    const float *p = image->pixels + ((size_t)row * image->width + (size_t)column) * image->channels;
    return image->channels < 3 ? sagi_rgb_grey(p[0]) : sagi_rgb(p[0], p[1], p[2]);
}

// Bilinear between the four nearest texel centres; v = 0 is the bottom edge.
static sag_rgb image_value(const sag_texture *texture, double u, double v) {
    const sag_image *image = &texture->image;
    if (!image->pixels || !isfinite(u) || !isfinite(v)) return (sag_rgb){0, 0, 0};
    double x = u * image->width - 0.5, y = (1 - v) * image->height - 0.5;
    double x0 = floor(x), y0 = floor(y), dx = x - x0, dy = y - y0;
    sag_rgb top = sagi_rgb_add(sagi_rgb_scale(texel(image, x0, y0, texture->wrap), 1 - dx),
                               sagi_rgb_scale(texel(image, x0 + 1, y0, texture->wrap), dx));
    sag_rgb bottom = sagi_rgb_add(sagi_rgb_scale(texel(image, x0, y0 + 1, texture->wrap), 1 - dx),
                                  sagi_rgb_scale(texel(image, x0 + 1, y0 + 1, texture->wrap), dx));
    sag_rgb value = sagi_rgb_add(sagi_rgb_scale(top, 1 - dy), sagi_rgb_scale(bottom, dy));
    if (texture->invert) value = sagi_rgb_sub(sagi_rgb_grey(1), value);
    return sagi_rgb_scale(value, texture->scale);
}

static bool is_odd(double sum_of_floors) { return fmod(sum_of_floors, 2) != 0; }

static bool checkerboard_is_odd(const sagi_texture *entry, const sag_surface *surface, double u, double v) {
    if (entry->texture.dimension != 3) return is_odd(floor(u) + floor(v));
    sag_vec3 p = surface->position;
    if (entry->mapped) p = sag_affine_point(&entry->texture.world_to_texture, p);
    return is_odd(floor(p.x) + floor(p.y) + floor(p.z));
}

static sag_rgb evaluate(const sag_world *world, sag_texture_id id, const sag_surface *surface) {
    const sagi_texture *entry = (const sagi_texture *)world->textures.items + (id - 1);
    const sag_texture *texture = &entry->texture;
    double u = surface->u * texture->u_scale + texture->u_offset;
    double v = surface->v * texture->v_scale + texture->v_offset;
    switch (texture->kind) {
    case SAG_TEXTURE_CONSTANT: return sagi_input_evaluate(world, &texture->a, surface);
    case SAG_TEXTURE_SCALE:
        return sagi_rgb_mul(sagi_input_evaluate(world, &texture->a, surface),
                            sagi_input_evaluate(world, &texture->b, surface));
    case SAG_TEXTURE_MIX: {
        double amount = sagi_input_evaluate(world, &texture->amount, surface).r;
        return sagi_rgb_add(sagi_rgb_scale(sagi_input_evaluate(world, &texture->a, surface), 1 - amount),
                            sagi_rgb_scale(sagi_input_evaluate(world, &texture->b, surface), amount));
    }
    case SAG_TEXTURE_CHECKERBOARD:
        return sagi_input_evaluate(
            world, checkerboard_is_odd(entry, surface, u, v) ? &texture->b : &texture->a, surface);
    case SAG_TEXTURE_IMAGE: return image_value(texture, u, v);
    }
    return (sag_rgb){0, 0, 0};
}

sag_rgb sagi_input_evaluate(const sag_world *world, const sag_input *input, const sag_surface *surface) {
    if (input->texture == 0 || input->texture > world->textures.count) return sagi_input_plain(world, input);
    return evaluate(world, input->texture, surface);
}
