// SPDX-License-Identifier: MIT
// Light followed from the lamps (particle.c), and the camera as it is hit by it (camera_connect.c).
#ifndef SAGI_RENDER_PARTICLE_H
#define SAGI_RENDER_PARTICLE_H

#include "job.h"

// How a point of the scene is seen.
typedef struct sagi_view {
    sag_vec3 from;     // the camera's point that it is seen from
    sag_vec3 wi;       // unit, to there
    sag_vec2 film;     // where on the film, in pixels from the top left corner
    double importance; // film area in pixels by area across wi
} sagi_view;

// False when the camera does not see the point; `lens` in [0, 1)² chooses the point of a lens.
bool sagi_camera_connect(const sagi_camera *camera, sag_vec3 point, sag_vec2 lens, sagi_view *view);

// A particle leaves a light.
typedef struct sagi_leaving {
    sag_ray ray;
    sagi_spectrum power;       // what it carries
    double window;             // how far the ray goes to the portal, before which nothing must be
    bool on_surface;           // of a shining geometry, which may be seen itself
    sag_surface surface;       // that
    double density;            // of this point among all lights', by area
    const sagi_appearance *of; // the geometry's
} sagi_leaving;

// Draws one by u, choosing the light by `choose`. False where there is none.
bool sagi_lights_leave(const sagi_lights *lights, sagi_spectrum lambda, double choose, sag_vec2 u, sag_vec2 v,
                       sagi_leaving *leaving);

#endif
