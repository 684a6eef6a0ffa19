// SPDX-License-Identifier: MIT
// Making a texture ready: what is 0 becomes what it counts as, and what depends on the inputs is found once.
#include "world.h"

static bool varies_with_extent(const sag_texture *texture) {
    switch (texture->kind) {
    case SAG_TEXTURE_CHECKERBOARD:
    case SAG_TEXTURE_IMAGE:
    case SAG_TEXTURE_FBM:
    case SAG_TEXTURE_WRINKLED:
    case SAG_TEXTURE_WINDY:
    case SAG_TEXTURE_MARBLE: return true;
    case SAG_TEXTURE_CONSTANT:
    case SAG_TEXTURE_SCALE:
    case SAG_TEXTURE_MIX:
    case SAG_TEXTURE_DIRECTION_MIX:
    case SAG_TEXTURE_BILERP:
    case SAG_TEXTURE_DOTS: break;
    }
    return false;
}

// Depth, parts and want of a footprint over the inputs.
static bool read_inputs(const sag_world *world, const sag_texture *texture, sagi_texture *entry) {
    const sagi_texture *textures = world->textures.items;
    const sag_input *inputs[] = {&texture->a, &texture->b, &texture->c, &texture->d, &texture->amount};
    entry->depth = entry->parts = 1;
    entry->wants_footprint = varies_with_extent(texture);
    for (int i = 0; i < 5; i++) {
        const sag_texture_id id = inputs[i]->texture;
        if (id > world->textures.count || inputs[i]->spectrum > world->spectra.count) return false;
        if (i < 4) {
            entry->colors[0][i] = sagi_input_color_soon(world, inputs[i], SAGI_RGB_ALBEDO);
            entry->colors[1][i] = sagi_input_color_soon(world, inputs[i], SAGI_RGB_UNBOUNDED);
        }
        if (id == 0) continue;
        const sagi_texture *input = &textures[id - 1];
        if (input->depth >= entry->depth) entry->depth = input->depth + 1;
        entry->parts += input->parts;
        entry->wants_footprint |= input->wants_footprint;
    }
    return entry->depth <= SAGI_MAX_TEXTURE_DEPTH && entry->parts <= SAGI_MAX_TEXTURE_PARTS;
}

static double or_else(double value, double otherwise) { return value != 0 ? value : otherwise; }

bool sagi_texture_prepare(const sag_world *world, const sag_texture *texture, sagi_texture *entry) {
    *entry = (sagi_texture){.texture = *texture};
    if (!read_inputs(world, texture, entry) || texture->picture > world->pictures.count) return false;
    sag_texture *t = &entry->texture;
    t->image = (sag_image){0};
    sagi_mapping_init(&entry->mapping, &texture->mapping);
    entry->lookup = (sagi_lookup){.filter = t->filter,
                                  .wrap = t->wrap,
                                  .max_anisotropy = sagi_clamp(or_else(t->max_anisotropy, 8), 1, 64)};
    if (t->octaves == 0) t->octaves = 8;
    if (t->octaves > 64) t->octaves = 64; // 1.99⁶⁴ cells a unit: beyond what doubles tell apart
    t->omega = or_else(t->omega, 0.5);
    t->variation = or_else(t->variation, 0.2);
    t->scale = or_else(t->scale, 1);
    if (t->direction.x == 0 && t->direction.y == 0 && t->direction.z == 0) t->direction.y = 1;
    return true;
}
