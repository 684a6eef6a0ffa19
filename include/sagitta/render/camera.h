// SPDX-License-Identifier: MIT
/// @file camera.h
/// Cameras: where the picture is seen from.
#ifndef SAGITTA_RENDER_CAMERA_H
#define SAGITTA_RENDER_CAMERA_H

#include <sagitta/math.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum sag_camera_kind {
    SAG_CAMERA_PERSPECTIVE,
    SAG_CAMERA_ORTHOGRAPHIC,
    SAG_CAMERA_ENVIRONMENT, ///< all directions: longitude 0 … 2π from left to right, the pole y at the top
    SAG_CAMERA_EQUAL_AREA,  ///< all directions, each pixel the same solid angle: Clarberg's mapping as of
                            ///< infinite lights' pictures, with y and z exchanged (pbrt's); best square
} sag_camera_kind;

/// Looks along +z with +x right and +y up in its own space (pbrt's: left-handed), which to_world places.
typedef struct sag_camera {
    sag_camera_kind kind;
    sag_affine to_world;
    double fov_rad;          ///< of the shorter image side (perspective); 0 counts as 90°
    double screen_window[4]; ///< x_min x_max y_min y_max; all 0: [−1, 1] on the shorter side, as pbrt
    double lens_radius;      ///< depth of field; 0: none
    double focal_distance;   ///< what is sharp with a lens; 0: infinity
} sag_camera;

/// The to_world of a camera at `eye` that looks at `target` with `up` (of any length) upward in the picture,
/// in a right-handed world: its columns are right = z × up, right × z and z, the direction to the target.
/// Since camera space is left-handed the map mirrors. (pbrt takes the world to be left-handed: there right is
/// up × z.) When up is along z, any upright will do; when eye and target are equal, z = (0, 0, 1). Not finite
/// in, not finite out. Thread-safe. Test: tests/render/test_camera.c.
SAG_API sag_affine sag_camera_look_at(sag_vec3 eye, sag_vec3 target, sag_vec3 up);

#ifdef __cplusplus
}
#endif
#endif
