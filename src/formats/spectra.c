// SPDX-License-Identifier: MIT
// Spectra to linear RGB (Rec. 709 primaries). A spectrum S(λ) has the colour X = ∫S x̄ dλ, and so on, with the
// CIE 1931 matching functions, here by the fit of Wyman, Sloan and Shirley ("Simple Analytic Approximations
// to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013), within about 1 %; a matrix makes RGB of XYZ.
// The indices of metals are the values at the primaries' wavelengths, which is what RGB renderers use.
#include "formats/spectra.h"

#include <math.h>

// exp(−(λ − mean)²/2σ²) with a width for each side.
static double lobe(double wavelength, double mean, double below, double above) {
    const double t = (wavelength - mean) / (wavelength < mean ? below : above);
    return exp(-0.5 * t * t);
}

static sag_rgb xyz_at(double w) {
    return (sag_rgb){1.056 * lobe(w, 599.8, 37.9, 31.0) + 0.362 * lobe(w, 442.0, 16.0, 26.7) -
                         0.065 * lobe(w, 501.1, 20.4, 26.2),
                     0.821 * lobe(w, 568.8, 46.9, 40.5) + 0.286 * lobe(w, 530.9, 16.3, 31.1),
                     1.217 * lobe(w, 437.0, 11.8, 36.0) + 0.681 * lobe(w, 459.0, 26.0, 13.8)};
}

static sag_rgb rgb_of_xyz(sag_rgb c) {
    return (sag_rgb){3.2404542 * c.r - 1.5371385 * c.g - 0.4985314 * c.b,
                     -0.9692660 * c.r + 1.8760108 * c.g + 0.0415560 * c.b,
                     0.0556434 * c.r - 0.2040259 * c.g + 1.0572252 * c.b};
}

static double clamp_low(double x) { return x > 0 ? x : 0; }

static double planck(double nanometres, double kelvin) {
    const double metres = nanometres * 1e-9;
    return 1 / (pow(metres, 5) * expm1(0.01438776877 / (metres * kelvin)));
}

sag_rgb sagi_spectrum_blackbody(double kelvin) {
    if (!(kelvin > 0 && isfinite(kelvin))) return (sag_rgb){0, 0, 0};
    sag_rgb sum = {0, 0, 0};
    const double norm = planck(560, kelvin);
    if (!(norm > 0)) return (sag_rgb){0, 0, 0};
    for (double w = 360; w <= 830; w += 5) {
        const double value = planck(w, kelvin) / norm;
        const sag_rgb xyz = xyz_at(w);
        sum.r += value * xyz.r, sum.g += value * xyz.g, sum.b += value * xyz.b;
    }
    if (!(sum.g > 0)) return (sag_rgb){0, 0, 0};
    const sag_rgb rgb = rgb_of_xyz((sag_rgb){sum.r / sum.g, 1, sum.b / sum.g});
    return (sag_rgb){clamp_low(rgb.r), clamp_low(rgb.g), clamp_low(rgb.b)};
}

static double sample(const double *pairs, size_t count, double wavelength) {
    if (wavelength <= pairs[0]) return pairs[1];
    for (size_t i = 1; i < count; i++) {
        const double *a = pairs + 2 * (i - 1), *b = pairs + 2 * i;
        if (wavelength < b[0])
            return b[0] > a[0] ? a[1] + (b[1] - a[1]) * (wavelength - a[0]) / (b[0] - a[0]) : b[1];
    }
    return pairs[2 * count - 1];
}

sag_rgb sagi_spectrum_sampled(const double *pairs, size_t pair_count, sagi_spectrum_use use) {
    if (pair_count == 0) return (sag_rgb){0, 0, 0};
    if (use == SAGI_SPECTRUM_INDEX)
        return (sag_rgb){sample(pairs, pair_count, 630), sample(pairs, pair_count, 532),
                         sample(pairs, pair_count, 465)};
    sag_rgb sum = {0, 0, 0}, white = {0, 0, 0};
    for (double w = 360; w <= 830; w += 5) {
        const double value = sample(pairs, pair_count, w);
        const sag_rgb xyz = xyz_at(w);
        sum.r += value * xyz.r, sum.g += value * xyz.g, sum.b += value * xyz.b;
        white.r += xyz.r, white.g += xyz.g, white.b += xyz.b;
    }
    if (use == SAGI_SPECTRUM_LIGHT) {
        if (!(sum.g > 0)) return (sag_rgb){0, 0, 0};
        const sag_rgb rgb = rgb_of_xyz((sag_rgb){sum.r / sum.g, 1, sum.b / sum.g});
        return (sag_rgb){clamp_low(rgb.r), clamp_low(rgb.g), clamp_low(rgb.b)};
    }
    const sag_rgb rgb = rgb_of_xyz(sum), one = rgb_of_xyz(white);
    return (sag_rgb){clamp_low(rgb.r / one.r), clamp_low(rgb.g / one.g), clamp_low(rgb.b / one.b)};
}

bool sagi_spectrum_named(sagi_slice name, sag_rgb *rgb) {
    // Metals: Johnson & Christy 1972 (Ag, Au, Cu), Rakić 1995 (Al), Querry 1985 (CuZn); oxides: Stephens &
    // Malitson 1952 (MgO), DeVore 1951 (TiO2). Glasses: the index at 587.6 nm. Illuminants: their colour at
    // luminance 1, daylight of 6504 K being white.
    static const struct {
        const char *name;
        sag_rgb rgb;
    } table[] = {
        {"metal-Ag-eta", {0.155265, 0.116723, 0.138381}},
        {"metal-Ag-k", {4.828370, 3.122499, 2.147030}},
        {"metal-Al-eta", {1.657460, 0.880369, 0.521229}},
        {"metal-Al-k", {9.223869, 6.269523, 4.837001}},
        {"metal-Au-eta", {0.143119, 0.374957, 1.442479}},
        {"metal-Au-k", {3.983160, 2.385721, 1.603215}},
        {"metal-Cu-eta", {0.200438, 0.924033, 1.102212}},
        {"metal-Cu-k", {3.912949, 2.452848, 2.142188}},
        {"metal-CuZn-eta", {0.444, 0.527, 1.094}},
        {"metal-CuZn-k", {3.695, 2.765, 1.829}},
        {"metal-MgO-eta", {1.7346, 1.7404, 1.7462}},
        {"metal-MgO-k", {0, 0, 0}},
        {"metal-TiO2-eta", {2.5843, 2.6588, 2.7864}},
        {"metal-TiO2-k", {0, 0, 0}},
        {"glass-BK7", {1.5168, 1.5168, 1.5168}},
        {"glass-BAF10", {1.6700, 1.6700, 1.6700}},
        {"glass-FK51A", {1.4866, 1.4866, 1.4866}},
        {"glass-LASF9", {1.8503, 1.8503, 1.8503}},
        {"glass-F5", {1.6727, 1.6727, 1.6727}},
        {"glass-F10", {1.7283, 1.7283, 1.7283}},
        {"glass-F11", {1.7847, 1.7847, 1.7847}},
        {"glass-SF5", {1.6727, 1.6727, 1.6727}},
        {"glass-SF10", {1.7283, 1.7283, 1.7283}},
        {"glass-SF11", {1.7847, 1.7847, 1.7847}},
        {"stdillum-D65", {1, 1, 1}},
        {"illum-acesD60", {1.0668, 0.9929, 0.8748}},
    };
    static const struct {
        const char *name;
        double kelvin;
    } lamps[] = {
        {"stdillum-A", 2856},  {"stdillum-D50", 5003}, {"stdillum-D55", 5503}, {"stdillum-D75", 7504},
        {"stdillum-F1", 6430}, {"stdillum-F2", 4230},  {"stdillum-F3", 3450},  {"stdillum-F4", 2940},
        {"stdillum-F5", 6350}, {"stdillum-F6", 4150},  {"stdillum-F7", 6500},  {"stdillum-F8", 5000},
        {"stdillum-F9", 4150}, {"stdillum-F10", 5000}, {"stdillum-F11", 4000}, {"stdillum-F12", 3000}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (!sagi_slice_is(name, table[i].name)) continue;
        *rgb = table[i].rgb;
        return true;
    }
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++) {
        if (!sagi_slice_is(name, lamps[i].name)) continue;
        *rgb = sagi_spectrum_blackbody(lamps[i].kelvin);
        return true;
    }
    return false;
}
