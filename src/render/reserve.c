// SPDX-License-Identifier: MIT
// Textures and materials whose ids are used before they are known, as pbrt's scenes may: an id stands for
// grey until it is set. How deep textures nest is then found anew at the end, from what each is made of,
// until nothing changes: what nests in a circle never ends, and is found by growing beyond the bound.
#include "world.h"

sag_texture_id sagi_texture_reserve(sag_world *world, bool is_number) {
    const sag_texture grey = {
        .kind = SAG_TEXTURE_CONSTANT, .is_number = is_number, .a.value = {0.5, 0.5, 0.5}};
    const sag_texture_id id = sag_world_add_texture(world, &grey);
    // Who uses it asks for a footprint then, which it may need.
    if (id) ((sagi_texture *)world->textures.items)[id - 1].wants_footprint = true;
    return id;
}

bool sagi_texture_set(sag_world *world, sag_texture_id id, const sag_texture *texture) {
    sagi_texture entry;
    if (!sagi_texture_prepare(world, texture, &entry)) return false;
    entry.wants_footprint = true;
    ((sagi_texture *)world->textures.items)[id - 1] = entry;
    return true;
}

static bool measure(sagi_texture *textures, sagi_texture *entry) {
    const sag_texture *t = &entry->texture;
    const sag_texture_id inputs[] = {t->a.texture, t->b.texture, t->c.texture, t->d.texture,
                                     t->amount.texture};
    uint32_t depth = 1, parts = 1;
    for (int i = 0; i < 5; i++) {
        if (inputs[i] == 0) continue;
        const sagi_texture *input = &textures[inputs[i] - 1];
        if (input->depth >= depth) depth = input->depth + 1;
        parts += input->parts;
    }
    const bool changed = depth != entry->depth || parts != entry->parts;
    entry->depth = depth, entry->parts = parts;
    return changed;
}

sag_texture_id sagi_textures_settle(sag_world *world) {
    sagi_texture *textures = world->textures.items;
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < world->textures.count; i++) {
            changed |= measure(textures, &textures[i]);
            if (textures[i].depth > SAGI_MAX_TEXTURE_DEPTH || textures[i].parts > SAGI_MAX_TEXTURE_PARTS)
                return (sag_texture_id)(i + 1);
        }
    }
    return 0;
}

uint32_t sagi_material_reserve(sag_world *world) {
    return sag_world_add_material(world, &(sag_material){.reflectance.value = {0.5, 0.5, 0.5}});
}

bool sagi_material_set(sag_world *world, uint32_t id, const sag_material *material) {
    const uint32_t last = sag_world_add_material(world, material);
    if (!last) return false;
    sagi_material *materials = world->materials.items;
    materials[id - 1] = materials[last - 1];
    world->materials.count--;
    return true;
}
