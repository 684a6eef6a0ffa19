// SPDX-License-Identifier: MIT
// Measured numbers: what the eye, lamps, metals, glasses and cameras do by wavelength.
#ifndef SAGI_RENDER_SPECTRUM_DATA_H
#define SAGI_RENDER_SPECTRUM_DATA_H

// Wavelengths go from 360 to 830 nm, and light is a number for each nanometre.
#define SAGI_WAVELENGTH_MIN   360
#define SAGI_WAVELENGTH_MAX   830
#define SAGI_WAVELENGTH_COUNT 471

extern const float sagi_cie_xyz[SAGI_WAVELENGTH_COUNT][3];

// A lamp at first, first + step … nm; beyond them as at the ends.
typedef struct sagi_lamp {
    const char *name;
    int first, step, count;
    const float *values;
} sagi_lamp;
#define SAGI_LAMP_COUNT 16
extern const sagi_lamp sagi_lamps[SAGI_LAMP_COUNT];

// S0, S1, S2 at 300, 305 … 830 nm.
#define SAGI_DAYLIGHT_COUNT 107
extern const float sagi_daylight[3][SAGI_DAYLIGHT_COUNT];

// An index at rising wavelengths; beyond them as at the ends.
typedef struct sagi_index {
    const char *name;
    int count;
    const float *wavelengths, *values;
} sagi_index;
#define SAGI_INDEX_COUNT 24
extern const sagi_index sagi_indices[SAGI_INDEX_COUNT];

#define SAGI_CAMERA_SAMPLES 35
typedef struct sagi_camera_curves {
    const char *name;
    const float (*rgb)[SAGI_CAMERA_SAMPLES];
} sagi_camera_curves;
#define SAGI_CAMERA_COUNT 17
extern const sagi_camera_curves sagi_cameras[SAGI_CAMERA_COUNT];

#define SAGI_SWATCH_COUNT   24
#define SAGI_SWATCH_SAMPLES 36
extern const float sagi_swatches[SAGI_SWATCH_COUNT][SAGI_SWATCH_SAMPLES];

#endif
