// SPDX-License-Identifier: MIT
// The spectra of RGB colours of materials and textures. While a scene is read they come from the table, which
// costs nothing; a solution costs microseconds, and there may be a million colours. So they are solved for
// before the first render, on all threads, those that repeat once in a while only. What comes out depends on
// the colour alone.
#include "world.h"

#include <string.h>

#define BLOCK 256u // of materials or textures that one task takes
#define KEPT  64u  // latest colours, by their hash

typedef struct solved {
    sag_rgb rgb;
    sagi_rgb_use use;
    sagi_color color; // near: nothing is here
} solved;

typedef struct work {
    sag_world *world;
    const sagi_color_solver *solver;
    size_t material_blocks;
} work;

static size_t slot_of(const sag_rgb *rgb, sagi_rgb_use use) {
    uint64_t bits[3], hash = (uint64_t)use;
    memcpy(bits, rgb, sizeof bits);
    for (int i = 0; i < 3; i++) hash = (hash ^ bits[i]) * UINT64_C(0x9E3779B97F4A7C15);
    return (size_t)(hash >> 58) % KEPT;
}

static void solve(const sagi_color_solver *solver, solved *kept, const sag_input *input, sagi_rgb_use use,
                  sagi_color *color) {
    if (!color->near) return;
    solved *const s = &kept[slot_of(&input->value, use)];
    if (s->color.near || s->use != use || memcmp(&s->rgb, &input->value, sizeof s->rgb) != 0)
        *s = (solved){input->value, use, sagi_color_of_srgb(solver, input->value, use)};
    *color = s->color;
}

static void solve_block(void *argument, size_t index) {
    const work *w = argument;
    solved kept[KEPT];
    for (size_t i = 0; i < KEPT; i++) kept[i].color.near = true;
    if (index < w->material_blocks) {
        sagi_material *all = w->world->materials.items;
        const size_t end = w->world->materials.count;
        for (size_t i = index * BLOCK; i < end && i < (index + 1) * BLOCK; i++) {
            sagi_material *m = &all[i];
            solve(w->solver, kept, &m->material.reflectance, SAGI_RGB_ALBEDO, &m->reflectance);
            solve(w->solver, kept, &m->material.transmittance, SAGI_RGB_ALBEDO, &m->transmittance);
            solve(w->solver, kept, &m->material.coat_albedo, SAGI_RGB_ALBEDO, &m->coat_albedo);
        }
        return;
    }
    sagi_texture *all = w->world->textures.items;
    const size_t first = (index - w->material_blocks) * BLOCK, end = w->world->textures.count;
    for (size_t i = first; i < end && i < first + BLOCK; i++) {
        const sag_texture *t = &all[i].texture;
        const sag_input *const inputs[4] = {&t->a, &t->b, &t->c, &t->d};
        for (int k = 0; k < 4; k++) {
            solve(w->solver, kept, inputs[k], SAGI_RGB_ALBEDO, &all[i].colors[0][k]);
            solve(w->solver, kept, inputs[k], SAGI_RGB_UNBOUNDED, &all[i].colors[1][k]);
        }
    }
}

void sagi_world_solve_colors(sag_world *world) {
    sagi_color_solver solver;
    sagi_color_solver_init(&solver, &sagi_color_spaces[SAG_COLOR_SRGB], 1);
    work w = {world, &solver, (world->materials.count + BLOCK - 1) / BLOCK};
    const size_t texture_blocks = (world->textures.count + BLOCK - 1) / BLOCK;
    sag_parallel_for(world->context, w.material_blocks + texture_blocks, solve_block, &w);
}
