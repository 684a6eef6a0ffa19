// SPDX-License-Identifier: MIT
// Spectra as three numbers: what the scene language says by wavelength, for a renderer of three primaries.
#ifndef SAGI_FORMATS_SPECTRA_H
#define SAGI_FORMATS_SPECTRA_H

#include "formats/names.h"

#include <sagitta/render.h>

// What a spectrum is used for decides how it becomes RGB.
typedef enum sagi_spectrum_use {
    SAGI_SPECTRUM_REFLECTANCE, // 1 everywhere is white
    SAGI_SPECTRUM_LIGHT,       // the colour at luminance 1; the amount comes from elsewhere, as in pbrt
    SAGI_SPECTRUM_INDEX,       // of refraction and absorption: the values at 630, 532 and 465 nm
} sagi_spectrum_use;

// pbrt's named spectra (metal-Ag-eta, glass-BK7, stdillum-D65 …); false for an unknown name.
bool sagi_spectrum_named(sagi_slice name, sag_rgb *rgb);
// A spectrum by samples: pairs (wavelength in nm, value) by rising wavelength, linear between, constant
// beyond.
sag_rgb sagi_spectrum_sampled(const double *pairs, size_t pair_count, sagi_spectrum_use use);
// The colour of a black body at a temperature in kelvin (Planck), at luminance 1; black for one that is not >
// 0.
sag_rgb sagi_spectrum_blackbody(double kelvin);

#endif
