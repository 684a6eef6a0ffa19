// SPDX-License-Identifier: MIT
// Sensors, as pbrt-v4 has them (Langlands & Fascione, "PhysLight", SIGGRAPH talks 2020). The eye's is CIE XYZ
// as it is, or white balanced: the white of daylight of a temperature becomes the film's white by von Kries's
// adaptation of the cones' signals (Bradford's matrix). A camera's three channels are brought to XYZ by the
// matrix that does best, by least squares, for the 24 patches of a ColorChecker: seen by the camera in
// daylight of that temperature, and by the eye under the film's white. All is scaled by the imaging ratio,
// exposure seconds · ISO/100.
#include "sensor.h"

#include <float.h>
#include <string.h>

#define CHANNELS 3

static const double bradford[3][3] = {
    {0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}};

static void white_balance(const float *seen, const double white[3], double matrix[3][3]) {
    double xyz[3] = {0, 0, 0}, cones_seen[3], cones_white[3], scaled[3][3], back[3][3];
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
        for (int k = 0; k < 3; k++) xyz[k] += (double)sagi_cie_xyz[i][k] * (double)seen[i];
    const double luminance = xyz[1];
    for (int k = 0; k < 3; k++) xyz[k] /= luminance;
    sagi_matrix_apply(bradford, xyz, cones_seen);
    sagi_matrix_apply(bradford, white, cones_white);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) scaled[i][k] = bradford[i][k] * cones_white[i] / cones_seen[i];
    sagi_matrix_invert(bradford, back);
    sagi_matrix_multiply(back, scaled, matrix);
}

// A function at 380, 390 … nm, linear between, as at the ends beyond.
static double every_ten(const float *values, int count, int wavelength) {
    int offset = wavelength - 380;
    if (offset < 0) offset = 0;
    if (offset > 10 * (count - 1)) offset = 10 * (count - 1);
    const int k = offset / 10, next = k + 1 < count ? k + 1 : k;
    return (double)values[k] + ((double)values[next] - (double)values[k]) * (offset % 10) / 10.0;
}

// The matrix from a camera's channels to XYZ.
static bool match_camera(const float (*curves)[SAGI_CAMERA_SAMPLES], const float *seen,
                         const sagi_color_space *space, double matrix[3][3]) {
    double green = 0, luminance = 0, white = 0, camera[SAGI_SWATCH_COUNT][3] = {{0}},
           eye[SAGI_SWATCH_COUNT][3] = {{0}};
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const int wavelength = SAGI_WAVELENGTH_MIN + i;
        double channel[3];
        for (int k = 0; k < 3; k++)
            channel[k] = every_ten(curves[k], SAGI_CAMERA_SAMPLES, wavelength) * (double)seen[i];
        green += channel[1];
        luminance += (double)sagi_cie_xyz[i][1] * (double)seen[i];
        white += (double)sagi_cie_xyz[i][1] * (double)space->illuminant[i];
        for (int s = 0; s < SAGI_SWATCH_COUNT; s++) {
            const double reflectance = every_ten(sagi_swatches[s], SAGI_SWATCH_SAMPLES, wavelength);
            for (int k = 0; k < 3; k++) {
                camera[s][k] += channel[k] * reflectance;
                eye[s][k] += (double)sagi_cie_xyz[i][k] * (double)space->illuminant[i] * reflectance;
            }
        }
    }
    // Least squares: M minimises Σ |M camera − eye|², so M = (Σ eye cameraᵀ)(Σ camera cameraᵀ)⁻¹.
    double square[3][3] = {{0}}, product[3][3] = {{0}}, inverse[3][3];
    for (int s = 0; s < SAGI_SWATCH_COUNT; s++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                square[i][k] += camera[s][i] / green * camera[s][k] / green;
                product[i][k] += eye[s][i] / white * (luminance / green) * camera[s][k] / green;
            }
    if (!sagi_matrix_invert(square, inverse)) return false;
    sagi_matrix_multiply(product, inverse, matrix);
    return true;
}

static const sagi_camera_curves *find_camera(const char *name) {
    for (int i = 0; i < SAGI_CAMERA_COUNT; i++)
        if (strcmp(sagi_cameras[i].name, name) == 0) return &sagi_cameras[i];
    return NULL;
}

bool sag_sensor_is_known(const char *name) {
    return name[0] == 0 || strcmp(name, "cie1931") == 0 || find_camera(name) != NULL;
}

sag_status sagi_sensor_init(sagi_sensor *sensor, const sag_film *film, sag_error *error) {
    const double exposure = film->exposure_seconds == 0 ? 1 : film->exposure_seconds;
    const double iso = film->iso == 0 ? 100 : film->iso, ratio = exposure * iso / 100;
    if (!(ratio >= FLT_MIN && ratio <= FLT_MAX))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "an exposure of %g s at ISO %g", exposure, iso);
    if (film->color_space < SAG_COLOR_SRGB || film->color_space > SAG_COLOR_ACES2065_1)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "unknown colour space %d", (int)film->color_space);
    const bool is_eye = film->sensor[0] == 0 || strcmp(film->sensor, "cie1931") == 0;
    const sagi_camera_curves *camera = is_eye ? NULL : find_camera(film->sensor);
    if (!is_eye && !camera)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "unknown sensor \"%.63s\"", film->sensor);
    const double kelvin = film->white_balance_kelvin == 0 && camera ? 6500 : film->white_balance_kelvin;
    if (kelvin != 0 && !(kelvin >= 500 && kelvin <= 25000))
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "a white balance of %g K: it must be in 500 … 25000",
                             kelvin);
    const sagi_color_space *space = &sagi_color_spaces[film->color_space];
    float daylight[SAGI_WAVELENGTH_COUNT];
    if (kelvin != 0) sagi_daylight_table(kelvin, daylight);
    double to_xyz[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (camera) {
        if (!match_camera(camera->rgb, daylight, space, to_xyz))
            return sag_error_set(error, SAG_ERROR_ARGUMENT, "the sensor \"%s\" cannot be matched",
                                 film->sensor);
    } else if (kelvin != 0) {
        white_balance(daylight, space->white, to_xyz);
    }
    sagi_matrix_multiply(space->from_xyz, to_xyz, sensor->output);
    const double norm = ratio / sagi_luminance_norm();
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
        for (int k = 0; k < CHANNELS; k++) {
            const double value = camera
                                     ? every_ten(camera->rgb[k], SAGI_CAMERA_SAMPLES, SAGI_WAVELENGTH_MIN + i)
                                     : (double)sagi_cie_xyz[i][k];
            sensor->response[i][k] = (float)(value * norm);
        }
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) sensor->response[i][3] = 0;
    return SAG_OK;
}
