// SPDX-License-Identifier: MIT
/// @file spectrum.h
/// Colours and spectra: numbers by wavelength for lights, reflectances and indices of refraction.
#ifndef SAGITTA_RENDER_SPECTRUM_H
#define SAGITTA_RENDER_SPECTRUM_H

#include <sagitta/image.h>

typedef struct sag_rgb {
    double r, g, b;
} sag_rgb;

/// A spectrum of a world, counted from 1; 0 is "none".
typedef uint32_t sag_spectrum_id;

typedef enum sag_spectrum_kind {
    SAG_SPECTRUM_CONSTANT,  ///< `value` at all wavelengths
    SAG_SPECTRUM_SAMPLED,   ///< `pairs`, linear between; 0 beyond or, with `extend`, as at the ends
    SAG_SPECTRUM_BLACKBODY, ///< Planck's law at `value` kelvin, 1 at its peak
    SAG_SPECTRUM_ALBEDO, ///< a reflectance of the colour `rgb`, cut off at 0 and 1, under the space's white
    SAG_SPECTRUM_UNBOUNDED,  ///< the same without a bound above
    SAG_SPECTRUM_ILLUMINANT, ///< light of the colour `rgb`: that times the space's white at luminance 1
    SAG_SPECTRUM_NAMED, ///< one of pbrt-v4's: metal-Ag-eta, metal-Ag-k (Ag, Al, Au, Cu, CuZn, MgO, TiO2),
                        ///< glass-BK7 (BK7, BAF10, FK51A, LASF9, F5, F10, F11), stdillum-A (A, D50, D65, F1 …
                        ///< F12), illum-acesD60; lamps are at luminance 1
} sag_spectrum_kind;

/// Numbers by wavelength, from 360 to 830 nm. Used as light, 1 at every wavelength has luminance 1.
typedef struct sag_spectrum {
    sag_spectrum_kind kind;
    double value;
    sag_rgb rgb;
    sag_color_space space;
    const double *pairs; ///< wavelength in nm, rising, and value, pair_count times
    size_t pair_count;
    bool extend;
    const char *name;
    bool normalize; ///< brought to luminance 1 first
    double scale;   ///< multiplies the values; 0 counts as 1
} sag_spectrum;

#endif
