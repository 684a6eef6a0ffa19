// SPDX-License-Identifier: MIT
// From a point of the film to a ray.
#ifndef SAGI_RENDER_CAMERA_H
#define SAGI_RENDER_CAMERA_H

#include "color.h"

typedef struct sagi_camera {
    sag_camera camera;
    double width, height;            // of the film in pixels
    double x_min, y_max;             // of the screen window
    double x_per_pixel, y_per_pixel; // in camera space at z = 1 (orthographic: at any z)
    bool pinhole;                    // perspective, without a lens
    sag_vec3 eye;                    // where camera space has its origin
    sag_vec3 forward;                // its z, a unit
    sag_affine from_world;           // the inverse of to_world; where it has none, the identity
} sagi_camera;

// SAG_ERROR_ARGUMENT for a film without pixels, a map that is not finite or an angle out of (0°, 180°).
sag_status sagi_camera_init(sagi_camera *camera, const sag_camera *description, uint32_t width,
                            uint32_t height, sag_error *error);
// The ray through film point (x, y), in pixels from the top left corner, and the lens point that `lens`
// chooses. The direction is a unit.
sag_ray sagi_camera_ray(const sagi_camera *camera, double x, double y, sag_vec2 lens);
bool sagi_camera_has_lens(const sagi_camera *camera);

#endif
