// SPDX-License-Identifier: MIT
// From light by wavelength to the numbers of a picture.
#ifndef SAGI_RENDER_SENSOR_H
#define SAGI_RENDER_SENSOR_H

#include "spectrum.h"

typedef struct sagi_sensor {
    sagi_spectrum response[SAGI_WAVELENGTH_COUNT]; // the three channels' by nanometre, and 0
    double output[3][3]; // from the channels to linear RGB of the film's colour space
} sagi_sensor;

// SAG_ERROR_ARGUMENT for a name, colour space, temperature or exposure that is none.
sag_status sagi_sensor_init(sagi_sensor *sensor, const sag_film *film, sag_error *error);

// What the sensor measures of a sample.
static inline sag_rgb sagi_sensor_measure(const sagi_sensor *sensor, sagi_spectrum light,
                                          const sagi_wavelengths *w) {
    const sagi_lanes at = sagi_wavelength_places(w->lambda);
    light *= w->weight;
    const sagi_spectrum sum = light[0] * sensor->response[at[0]] + light[1] * sensor->response[at[1]] +
                              light[2] * sensor->response[at[2]] + light[3] * sensor->response[at[3]];
    return sagi_rgb((double)sum[0], (double)sum[1], (double)sum[2]);
}

#endif
