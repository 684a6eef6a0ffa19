// SPDX-License-Identifier: MIT
// Light at infinity that comes in through a window: Bitterli, Novák & Jarosz, "Portal-Masked Environment Map
// Sampling" (EGSR 2015).
#ifndef SAGI_RENDER_PORTAL_H
#define SAGI_RENDER_PORTAL_H

#include "color.h"
#include "window.h"

// The picture of the surroundings as it is seen from behind the window, in coordinates in which a window is a
// rectangle from wherever it is looked through. See portal.c.
typedef struct sagi_portal {
    sag_vec3 x, y, z;   // along its edges, and outward
    sag_vec3 low, high; // two opposite corners
    uint32_t size;      // of the picture; 0: the light is the same everywhere
    sag_rgb *texels;    // size²
    sagi_window_table table;
} sagi_portal;

// Whether four corners, one after the other, are those of a rectangle, within a thousandth (pbrt-v4's
// tolerance).
bool sagi_portal_is_rectangle(const sag_vec3 corners[4]);
// `image`: square, in the equal-area mapping; empty: the same everywhere. from_world takes directions to its
// space. False when memory is short.
bool sagi_portal_init(sagi_portal *portal, const sag_context *context, const sag_vec3 corners[4],
                      const sag_image *image, const sag_affine *from_world);
void sagi_portal_clear(sagi_portal *portal, const sag_context *context);
// What comes through the window to a point from the unit direction wi. False: nothing.
bool sagi_portal_look(const sagi_portal *portal, sag_vec3 from, sag_vec3 wi, sag_rgb *texel);
// A unit direction through the window. False: nothing comes to that point.
bool sagi_portal_sample(const sagi_portal *portal, sag_vec3 from, sag_vec2 u, sag_vec3 *wi);
// The density of it per solid angle.
double sagi_portal_pdf(const sagi_portal *portal, sag_vec3 from, sag_vec3 wi);

#endif
