// SPDX-License-Identifier: MIT
// Spectra for RGB colours, as pbrt-v4 makes them of Jakob & Hanika's reflectances s (rgb_solve.c): an albedo
// is s of the colour; of an amount m = max(r, g, b) without bound, s has the colour rgb/2m, where it is
// smooth, and 2m scales it; light is that times the space's white. Grey is the same at all wavelengths.
#include "spectrum.h"

#include <float.h>

#define LEVELS SAGI_COLOR_LEVELS
#define RATIOS SAGI_COLOR_RATIOS

static sag_rgb cut_off(sag_rgb c, double high) {
    return sagi_rgb(sagi_clamp(c.r, 0, high), sagi_clamp(c.g, 0, high), sagi_clamp(c.b, 0, high));
}

// Coefficients from the table, linear between its nodes. The colour is in [0, 1] and not black.
static void look_up(sag_color_space space, const float rgb[3], float c[3]) {
    const int largest = rgb[0] > rgb[1] ? (rgb[0] > rgb[2] ? 0 : 2) : (rgb[1] > rgb[2] ? 1 : 2);
    const float z = rgb[largest], over_z = (RATIOS - 1) / z;
    const float x = rgb[largest < 2 ? largest + 1 : 0] * over_z,
                y = rgb[largest > 0 ? largest - 1 : 2] * over_z;
    const int xi = x < RATIOS - 2 ? (int)x : RATIOS - 2, yi = y < RATIOS - 2 ? (int)y : RATIOS - 2;
    int zi = sagi_color_guide[(int)(z * SAGI_COLOR_GUIDE)];
    while (zi < LEVELS - 2 && sagi_color_levels[zi + 1] <= z) zi++;
    const float low = sagi_color_levels[zi], high = sagi_color_levels[zi + 1];
    const float dx = x - (float)xi, dy = y - (float)yi, dz = (z - low) / (high - low);
    sagi_coefficients layers[2];
    for (int k = 0; k < 2; k++) {
        const sagi_coefficients *a = &sagi_color_tables[space][largest][zi + k][yi][xi], *b = a + RATIOS;
        layers[k] = (1 - dy) * ((1 - dx) * a[0] + dx * a[1]) + dy * ((1 - dx) * b[0] + dx * b[1]);
    }
    const sagi_coefficients value = ((1 - dz) * layers[0] + dz * layers[1]) / sqrtf(z);
    for (int k = 0; k < 3; k++) c[k] = value[k];
}

// By the table and, where there is a solver, exactly.
static sagi_color make(sag_color_space space, sag_rgb rgb, sagi_rgb_use use,
                       const sagi_color_solver *solver) {
    // What is no colour stays none, so that it is found out; a reflectance is cut off.
    if (use != SAGI_RGB_ALBEDO && !sagi_rgb_is_finite(rgb)) return (sagi_color){.scale = NAN};
    rgb = cut_off(rgb, use == SAGI_RGB_ALBEDO ? 1 : INFINITY);
    const float *illuminant = use == SAGI_RGB_ILLUMINANT ? sagi_color_spaces[space].illuminant : NULL;
    const double most = sagi_rgb_max(rgb);
    if (rgb.r == rgb.g && rgb.g == rgb.b)
        return (sagi_color){.scale = (float)rgb.r, .table = illuminant, .varies = illuminant != NULL};
    const double scale = use == SAGI_RGB_ALBEDO ? 1 : 2 * most;
    const double wanted[3] = {rgb.r / scale, rgb.g / scale, rgb.b / scale};
    sagi_color color = {.scale = (float)scale, .table = illuminant, .curved = true, .varies = true};
    const float near[3] = {(float)wanted[0], (float)wanted[1], (float)wanted[2]};
    if (!(fmaxf(near[0], fmaxf(near[1], near[2])) > RATIOS * FLT_MIN)) return (sagi_color){.scale = 0};
    look_up(space, near, color.c);
    if (!solver) return color;
    double c[3] = {(double)color.c[0], (double)color.c[1], (double)color.c[2]};
    sagi_color_solve(solver, wanted, c);
    for (int k = 0; k < 3; k++) color.c[k] = (float)c[k];
    return color;
}

sagi_color sagi_color_of_rgb(sag_color_space space, sag_rgb rgb, sagi_rgb_use use) {
    sagi_color color = make(space, rgb, use, NULL);
    if (!color.curved) return color;
    sagi_color_solver solver;
    sagi_color_solver_init(&solver, &sagi_color_spaces[space], 1);
    return make(space, rgb, use, &solver);
}

sagi_color sagi_color_of_srgb(const sagi_color_solver *solver, sag_rgb rgb, sagi_rgb_use use) {
    return make(SAG_COLOR_SRGB, rgb, use, solver);
}

sagi_color sagi_color_of_texel(sag_color_space space, sag_rgb rgb, sagi_rgb_use use) {
    return make(space, rgb, use, NULL);
}

void sagi_color_convert(int from, int to, const double rgb[3], double converted[3]) {
    double xyz[3];
    sagi_matrix_apply(sagi_color_spaces[from].to_xyz, rgb, xyz);
    sagi_matrix_apply(sagi_color_spaces[to].from_xyz, xyz, converted);
}
