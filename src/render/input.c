// SPDX-License-Identifier: MIT
// Inputs that are no textures: spectra, and colours made ready beforehand.
#include "world.h"

const sagi_spectrum_entry *sagi_spectrum_of(const sag_world *world, sag_spectrum_id id) {
    if (id == 0 || id > world->spectra.count) return NULL;
    return (const sagi_spectrum_entry *)world->spectra.items + (id - 1);
}

sagi_color sagi_input_color(const sag_world *world, const sag_input *input, sagi_rgb_use use) {
    const sagi_spectrum_entry *entry = sagi_spectrum_of(world, input->spectrum);
    return entry ? entry->color : sagi_color_of_rgb(SAG_COLOR_SRGB, input->value, use);
}

sagi_color sagi_input_color_soon(const sag_world *world, const sag_input *input, sagi_rgb_use use) {
    if (input->spectrum) return sagi_input_color(world, input, use);
    sagi_color color = sagi_color_of_texel(SAG_COLOR_SRGB, input->value, use);
    color.near = color.curved;
    return color;
}

sag_rgb sagi_input_plain(const sag_world *world, const sag_input *input) {
    const sagi_spectrum_entry *entry = sagi_spectrum_of(world, input->spectrum);
    return entry ? entry->reflectance : input->value;
}
