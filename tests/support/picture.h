// SPDX-License-Identifier: MIT
// Small renders for tests: a world to furnish, a picture of it, and the picture's mean with its statistical
// error.
#ifndef TESTS_SUPPORT_PICTURE_H
#define TESTS_SUPPORT_PICTURE_H

#include <sagitta/render.h>

typedef struct studio {
    sag_context *context;
    sag_world *world;
    sag_scene *scene;
    sag_settings *settings;
    bool in_color; // else the sensor is such that each sample of white light is exactly 1, in all three
                   // channels: what wavelengths it has makes no noise
} studio;

// A world with a camera at (0, 0, 8) looking along −z, 32×32 pixels of 0.4 rad, 16 independent samples.
// thread_count 0: all cores.
studio studio_open(uint32_t thread_count);
void studio_close(studio *s);
// The camera elsewhere.
void studio_aim(studio *s, sag_vec3 eye, sag_vec3 target);
// An orthographic camera whose picture is (nearly) the one point `target`, seen from `eye`.
void studio_aim_point(studio *s, sag_vec3 eye, sag_vec3 target);
// A small scene with a bit of everything, in pixels that do not fill whole tiles.
void studio_furnish(studio *s);
// A material's id that must be there.
uint32_t studio_material(studio *s, sag_material material);

// The finished picture. Asserts that all went well. sag_image_clear it.
sag_image studio_render(studio *s, sag_render_stats *stats);
// Whether all bits are the same. Asserts that the sizes are.
bool same_picture(const sag_image *a, const sag_image *b);

typedef struct studio_mean {
    double mean, deviation; // of the red channel over all pixels, and the standard deviation of that mean
    double least, most;     // of any pixel
} studio_mean;
studio_mean studio_measure(studio *s);

#endif
