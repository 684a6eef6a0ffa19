// SPDX-License-Identifier: MIT
// Light and colours by wavelength. A path carries four wavelengths (Wilkie et al., "Hero Wavelength Spectral
// Sampling", EGSR 2014), drawn where the eye sees best; all that is light or a colour is a number for each of
// them.
//
// Amounts: light of power 1 at every nanometre has luminance 1, and so has the white of a colour space.
#ifndef SAGI_RENDER_SPECTRUM_H
#define SAGI_RENDER_SPECTRUM_H

#include "color.h"
#include "colorspace.h"
#include "math/simd.h"

// Values at a path's four wavelengths. + − · / go lane by lane, also with a float.
typedef float sagi_spectrum __attribute__((vector_size(16)));
typedef int32_t sagi_lanes __attribute__((vector_size(16)));

// A path's wavelengths in nm, and what each counts for in an integral over wavelengths: 1/(4 pdf).
typedef struct sagi_wavelengths {
    sagi_spectrum lambda, weight;
} sagi_wavelengths;

static inline sagi_spectrum sagi_spectrum_all(double x) {
    const float f = (float)x;
    return (sagi_spectrum){f, f, f, f};
}
// Light or a colour that is only one at the first wavelength.
static inline sagi_spectrum sagi_spectrum_first(sagi_spectrum s, float factor) {
    return (sagi_spectrum){s[0] * factor, 0, 0, 0};
}
static inline sagi_spectrum sagi_spectrum_choose(sagi_lanes which, sagi_spectrum a, sagi_spectrum b) {
    return (sagi_spectrum)((which & (sagi_lanes)a) | (~which & (sagi_lanes)b));
}
static inline sagi_spectrum sagi_spectrum_clamp(sagi_spectrum s) { // to [0, 1]; NaN to 0
    const sagi_spectrum zero = {0, 0, 0, 0}, one = {1, 1, 1, 1};
    s = sagi_spectrum_choose(s > zero, s, zero);
    return sagi_spectrum_choose(s < one, s, one);
}
static inline sagi_spectrum sagi_spectrum_sqrt(sagi_spectrum s) { return sagi_f4_sqrt(s); }
static inline float sagi_spectrum_max(sagi_spectrum s) {
    const float a = s[0] > s[1] ? s[0] : s[1], b = s[2] > s[3] ? s[2] : s[3];
    return a > b ? a : b;
}
static inline float sagi_spectrum_mean(sagi_spectrum s) { return (s[0] + s[1] + s[2] + s[3]) / 4; }
// True for zeros, negative numbers and NaN.
static inline bool sagi_spectrum_is_black(sagi_spectrum s) {
    return !(s[0] > 0 || s[1] > 0 || s[2] > 0 || s[3] > 0);
}
static inline bool sagi_spectrum_is_finite(sagi_spectrum s) {
    const sagi_spectrum zero = s * 0;
    return zero[0] + zero[1] + zero[2] + zero[3] == 0;
}

// A spectrum made ready: value(λ) = scale · reflectance(λ) · table(λ).
typedef struct sagi_color {
    float scale;
    float c[3];         // of the reflectance (rgb_solve.c), where `curved`
    const float *table; // by nanometre; NULL: 1
    bool curved;        // else the reflectance is 1
    bool varies;        // it is not the same at all wavelengths
    bool near;          // `c` is from the table and will be solved for (exact_colors.c)
} sagi_color;

// The nearest nanometres, as places in a table.
static inline sagi_lanes sagi_wavelength_places(sagi_spectrum lambda) {
    return __builtin_convertvector(lambda - (SAGI_WAVELENGTH_MIN - 0.5F), sagi_lanes);
}
static inline sagi_spectrum sagi_table_at(const float *table, sagi_spectrum lambda) {
    const sagi_lanes i = sagi_wavelength_places(lambda);
    return (sagi_spectrum){table[i[0]], table[i[1]], table[i[2]], table[i[3]]};
}
static inline sagi_spectrum sagi_curve_at(const float c[3], sagi_spectrum lambda) {
    const sagi_spectrum t = (lambda - SAGI_WAVELENGTH_MIN) * (1.0F / (SAGI_WAVELENGTH_COUNT - 1));
    const sagi_spectrum p = (c[0] * t + c[1]) * t + c[2];
    return 0.5F + 0.5F * p / sagi_spectrum_sqrt(1 + p * p);
}
static inline sagi_spectrum sagi_color_at(const sagi_color *color, sagi_spectrum lambda) {
    sagi_spectrum value = {color->scale, color->scale, color->scale, color->scale};
    if (color->curved) value *= sagi_curve_at(color->c, lambda);
    if (color->table) value *= sagi_table_at(color->table, lambda);
    return value;
}
// At the first wavelength, between its neighbours in the table: indices of refraction, where steps of a
// nanometre would show as bands in a rainbow.
double sagi_color_at_first(const sagi_color *color, sagi_spectrum lambda);

// What an RGB colour stands for.
typedef enum sagi_rgb_use {
    SAGI_RGB_ALBEDO,     // a reflectance, each component in [0, 1] (else it is cut off)
    SAGI_RGB_UNBOUNDED,  // any amount ≥ 0
    SAGI_RGB_ILLUMINANT, // light: (1, 1, 1) is the space's white
} sagi_rgb_use;

// A spectrum for a linear RGB colour: exactly solved for, and from the table, which is quicker. Negative
// components are cut off.
sagi_color sagi_color_of_rgb(sag_color_space space, sag_rgb rgb, sagi_rgb_use use);
sagi_color sagi_color_of_srgb(const sagi_color_solver *solver, sag_rgb rgb, sagi_rgb_use use); // for many
sagi_color sagi_color_of_texel(sag_color_space space, sag_rgb rgb, sagi_rgb_use use);
static inline sag_rgb sagi_rgb_convert(sag_color_space from, sag_color_space to, sag_rgb rgb) {
    const double own[3] = {rgb.r, rgb.g, rgb.b};
    double other[3];
    sagi_color_convert((int)from, (int)to, own, other);
    return sagi_rgb(other[0], other[1], other[2]);
}
// A spectrum to linear RGB of a space: of light as it is, of a reflectance under the space's white.
sag_rgb sagi_color_to_rgb(const sagi_color *color, sag_color_space space, bool light);
double sagi_color_luminance(const sagi_color *color);

// Steps in which wavelengths are drawn.
#define SAGI_WAVELENGTH_STEPS 1024
// The wavelength below which each share of the density lies.
typedef struct sagi_wavelength_table {
    float lambda[SAGI_WAVELENGTH_STEPS + 1];
} sagi_wavelength_table;

void sagi_wavelength_table_init(sagi_wavelength_table *table);
// Four wavelengths from u in [0, 1), a quarter of the density apart.
static inline sagi_wavelengths sagi_wavelengths_sample(const sagi_wavelength_table *table, double u) {
    const float scaled = (float)u * SAGI_WAVELENGTH_STEPS;
    uint32_t step = (uint32_t)scaled;
    const float part = scaled - (float)step;
    sagi_wavelengths w;
    for (int i = 0; i < 4; i++, step += SAGI_WAVELENGTH_STEPS / 4) {
        const float *at = &table->lambda[step % SAGI_WAVELENGTH_STEPS];
        const float width = at[1] - at[0];
        w.lambda[i] = at[0] + part * width;
        w.weight[i] = width * (SAGI_WAVELENGTH_STEPS / 4.0F);
    }
    return w;
}

// A spectrum of a world (sag_world_add_spectrum), made ready.
typedef struct sagi_spectrum_entry {
    sagi_color color;
    float *table; // its own, or NULL
    double luminance;
    double brightness;          // how bright it is as a light, for choosing among lights; > 0 unless black
    sag_rgb light, reflectance; // in Rec. 709
} sagi_spectrum_entry;

// SAG_ERROR_ARGUMENT for a description that is none, SAG_ERROR_MEMORY.
sag_status sagi_spectrum_make(const sag_context *context, const sag_spectrum *description,
                              sagi_spectrum_entry *entry);
void sagi_spectrum_clear(const sag_context *context, sagi_spectrum_entry *entry);
// Daylight of a temperature in K (D50 has 5000), as pbrt counts it; a black body below 4000 K.
void sagi_daylight_table(double kelvin, float table[SAGI_WAVELENGTH_COUNT]);

#endif
