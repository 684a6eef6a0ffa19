// SPDX-License-Identifier: MIT
// Spectra of all kinds made ready for paths: each becomes a smooth reflectance (three coefficients), a table
// by nanometre, or both, so that at a path's wavelengths it costs a handful of instructions.
//
// Wavelengths are drawn with pbrt-v4's density, near to what the eye makes of them,
//     pdf(λ) ∝ 1/cosh²(0.0072 (λ − 538)) on [360, 830] nm:   λ(u) = 538 − 138.889 atanh(0.85691062
//     − 1.82750197 u),
// by a table of λ(u) that is linear between. What is drawn has then the density 1/(steps · width) exactly,
// whatever λ(u) is.
#include "spectrum.h"

#include "math/elementary.h"

#include <string.h>

void sagi_wavelength_table_init(sagi_wavelength_table *table) {
    for (int i = 0; i <= SAGI_WAVELENGTH_STEPS; i++) {
        const double u = (double)i / SAGI_WAVELENGTH_STEPS;
        const double x = 0.85691062 - 1.82750197 * u, atanh_x = 0.5 * sagi_log((1 + x) / (1 - x));
        table->lambda[i] = (float)(538 - 138.888889 * atanh_x);
    }
    table->lambda[0] = SAGI_WAVELENGTH_MIN;
    table->lambda[SAGI_WAVELENGTH_STEPS] = SAGI_WAVELENGTH_MAX;
}

double sagi_color_at_first(const sagi_color *color, sagi_spectrum lambda) {
    const sagi_color smooth = {
        .scale = color->scale, .c = {color->c[0], color->c[1], color->c[2]}, .curved = color->curved};
    const double value = (double)sagi_color_at(&smooth, lambda)[0];
    if (!color->table) return value;
    const double place = (double)lambda[0] - SAGI_WAVELENGTH_MIN;
    int i = (int)place;
    if (i > SAGI_WAVELENGTH_COUNT - 2) i = SAGI_WAVELENGTH_COUNT - 2;
    const double a = (double)color->table[i], b = (double)color->table[i + 1];
    return value * (a + (b - a) * (place - i));
}

// ∫ color · (x, y, z), also under an illuminant; white has Y = 1.
static void integrate(const sagi_color *color, const float *illuminant, double xyz[3]) {
    xyz[0] = xyz[1] = xyz[2] = 0;
    double norm = 0;
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const double light = illuminant ? (double)illuminant[i] : 1;
        const double value =
            (double)sagi_color_at(color, sagi_spectrum_all(SAGI_WAVELENGTH_MIN + i))[0] * light;
        norm += (double)sagi_cie_xyz[i][1] * light;
        for (int k = 0; k < 3; k++) xyz[k] += value * (double)sagi_cie_xyz[i][k];
    }
    for (int k = 0; k < 3; k++) xyz[k] /= norm;
}

sag_rgb sagi_color_to_rgb(const sagi_color *color, sag_color_space space, bool light) {
    const sagi_color_space *s = &sagi_color_spaces[space];
    double xyz[3], rgb[3];
    integrate(color, light ? NULL : s->illuminant, xyz);
    sagi_matrix_apply(s->from_xyz, xyz, rgb);
    return sagi_rgb(rgb[0], rgb[1], rgb[2]);
}

double sagi_color_luminance(const sagi_color *color) {
    double xyz[3];
    integrate(color, NULL, xyz);
    return xyz[1];
}

// Planck's law, 1 at its peak (Wien's displacement).
static double black_body(double nanometres, double kelvin) {
    const double c2 = 0.01438776877, peak = 2.897771955e-3 / kelvin,
                 metres = nanometres * 1e-9; // CODATA 2018
    const double ratio = peak / metres;
    return ratio * ratio * ratio * ratio * ratio * sagi_expm1(c2 / (peak * kelvin)) /
           sagi_expm1(c2 / (metres * kelvin));
}

void sagi_daylight_table(double kelvin, float table[SAGI_WAVELENGTH_COUNT]) {
    const double t = kelvin * 1.4388 / 1.4380; // the temperature scale of 1931
    double m1 = 0, m2 = 0;
    if (t >= 4000) {
        const double x = t <= 7000 ? ((-4.607e9 / t + 2.9678e6) / t + 0.09911e3) / t + 0.244063
                                   : ((-2.0064e9 / t + 1.9018e6) / t + 0.24748e3) / t + 0.23704;
        const double y = (-3 * x + 2.87) * x - 0.275, m = 0.0241 + 0.2562 * x - 0.7341 * y;
        m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
        m2 = (0.03 - 31.4424 * x + 30.0717 * y) / m;
    }
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const int offset = SAGI_WAVELENGTH_MIN + i - 300, k = offset / 5;
        const int next = k + 1 < SAGI_DAYLIGHT_COUNT ? k + 1 : k;
        double value[3];
        for (int s = 0; s < 3; s++) {
            const double a = (double)sagi_daylight[s][k], b = (double)sagi_daylight[s][next];
            value[s] = a + (b - a) * (offset % 5) / 5.0;
        }
        table[i] = (float)(t >= 4000 ? (value[0] + m1 * value[1] + m2 * value[2]) * 0.01
                                     : black_body(SAGI_WAVELENGTH_MIN + i, t));
    }
}

// Linear between pairs of rising wavelengths; beyond them 0 or, extended, as at the ends.
static void fill_sampled(const double *pairs, size_t count, bool extend, float table[SAGI_WAVELENGTH_COUNT]) {
    size_t k = 0;
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const double w = SAGI_WAVELENGTH_MIN + i;
        while (k + 1 < count && pairs[2 * (k + 1)] <= w) k++;
        const double *at = pairs + 2 * k;
        double value = at[1];
        if (w < at[0])
            value = extend ? at[1] : 0;
        else if (k + 1 < count)
            value = at[1] + (at[3] - at[1]) * (w - at[0]) / (at[2] - at[0]);
        else if (w > at[0])
            value = extend ? at[1] : 0;
        table[i] = (float)value;
    }
}

static bool fill_named(const char *name, float table[SAGI_WAVELENGTH_COUNT], bool *is_lamp) {
    double pairs[2 * SAGI_DAYLIGHT_COUNT];
    for (int l = 0; l < SAGI_LAMP_COUNT; l++) {
        const sagi_lamp *lamp = &sagi_lamps[l];
        if (strcmp(lamp->name, name) != 0) continue;
        for (int i = 0; i < lamp->count; i++)
            pairs[2 * i] = lamp->first + i * lamp->step, pairs[2 * i + 1] = (double)lamp->values[i];
        fill_sampled(pairs, (size_t)lamp->count, true, table);
        *is_lamp = true;
        return true;
    }
    for (int l = 0; l < SAGI_INDEX_COUNT; l++) {
        const sagi_index *index = &sagi_indices[l];
        if (strcmp(index->name, name) != 0) continue;
        for (int i = 0; i < index->count; i++)
            pairs[2 * i] = (double)index->wavelengths[i], pairs[2 * i + 1] = (double)index->values[i];
        fill_sampled(pairs, (size_t)index->count, true, table);
        return true;
    }
    return false;
}

// What the kinds by wavelength put into the table. False for a description that is none.
static bool fill(const sag_spectrum *d, float table[SAGI_WAVELENGTH_COUNT], bool *is_lamp) {
    switch (d->kind) {
    case SAG_SPECTRUM_SAMPLED:
        if (!d->pairs || d->pair_count == 0) return false;
        for (size_t i = 0; i < d->pair_count; i++) {
            if (!isfinite(d->pairs[2 * i]) || !isfinite(d->pairs[2 * i + 1])) return false;
            if (i > 0 && !(d->pairs[2 * i] > d->pairs[2 * i - 2])) return false;
        }
        fill_sampled(d->pairs, d->pair_count, d->extend, table);
        return true;
    case SAG_SPECTRUM_BLACKBODY:
        if (!(d->value > 0 && isfinite(d->value))) return false;
        for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
            table[i] = (float)black_body(SAGI_WAVELENGTH_MIN + i, d->value);
        return true;
    case SAG_SPECTRUM_NAMED: return d->name && fill_named(d->name, table, is_lamp);
    case SAG_SPECTRUM_CONSTANT:
    case SAG_SPECTRUM_ALBEDO:
    case SAG_SPECTRUM_UNBOUNDED:
    case SAG_SPECTRUM_ILLUMINANT: break;
    }
    return false;
}

static sag_status make_table(const sag_context *context, const sag_spectrum *d, sagi_spectrum_entry *entry) {
    entry->table = sag_allocate(context, SAGI_WAVELENGTH_COUNT * sizeof *entry->table);
    if (!entry->table) return SAG_ERROR_MEMORY;
    bool is_lamp = false;
    if (!fill(d, entry->table, &is_lamp)) return SAG_ERROR_ARGUMENT;
    entry->color = (sagi_color){.scale = 1, .table = entry->table, .varies = true};
    if (!is_lamp) return SAG_OK;
    const double luminance = sagi_color_luminance(&entry->color);
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
        entry->table[i] = (float)((double)entry->table[i] / luminance);
    return SAG_OK;
}

sag_status sagi_spectrum_make(const sag_context *context, const sag_spectrum *d, sagi_spectrum_entry *entry) {
    *entry = (sagi_spectrum_entry){.table = NULL};
    const bool known_space = d->space >= SAG_COLOR_SRGB && d->space <= SAG_COLOR_ACES2065_1;
    const bool known_kind = d->kind >= SAG_SPECTRUM_CONSTANT && d->kind <= SAG_SPECTRUM_NAMED;
    if (!known_space || !known_kind || !isfinite(d->scale) || !sagi_rgb_is_finite(d->rgb))
        return SAG_ERROR_ARGUMENT;
    sag_status status = SAG_OK;
    switch (d->kind) {
    case SAG_SPECTRUM_CONSTANT:
        if (!isfinite(d->value)) return SAG_ERROR_ARGUMENT;
        entry->color = (sagi_color){.scale = (float)d->value};
        break;
    case SAG_SPECTRUM_ALBEDO: entry->color = sagi_color_of_rgb(d->space, d->rgb, SAGI_RGB_ALBEDO); break;
    case SAG_SPECTRUM_UNBOUNDED:
        entry->color = sagi_color_of_rgb(d->space, d->rgb, SAGI_RGB_UNBOUNDED);
        break;
    case SAG_SPECTRUM_ILLUMINANT:
        entry->color = sagi_color_of_rgb(d->space, d->rgb, SAGI_RGB_ILLUMINANT);
        break;
    case SAG_SPECTRUM_SAMPLED:
    case SAG_SPECTRUM_BLACKBODY:
    case SAG_SPECTRUM_NAMED: status = make_table(context, d, entry); break;
    }
    if (status != SAG_OK) {
        sagi_spectrum_clear(context, entry);
        return status;
    }
    double scale = d->scale == 0 ? 1 : d->scale;
    if (d->normalize) {
        const double luminance = sagi_color_luminance(&entry->color);
        scale = luminance > 0 ? scale / luminance : 0;
    }
    entry->color.scale = (float)((double)entry->color.scale * scale);
    double xyz[3];
    integrate(&entry->color, NULL, xyz);
    entry->luminance = xyz[1];
    entry->brightness = (xyz[0] + xyz[1] + xyz[2]) / 3;
    entry->light = sagi_color_to_rgb(&entry->color, SAG_COLOR_SRGB, true);
    entry->reflectance = sagi_color_to_rgb(&entry->color, SAG_COLOR_SRGB, false);
    return SAG_OK;
}

void sagi_spectrum_clear(const sag_context *context, sagi_spectrum_entry *entry) {
    if (entry->table) sag_release(context, entry->table, SAGI_WAVELENGTH_COUNT * sizeof *entry->table);
    *entry = (sagi_spectrum_entry){.table = NULL};
}
