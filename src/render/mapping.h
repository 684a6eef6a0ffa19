// SPDX-License-Identifier: MIT
// From a point of a surface to the coordinates a texture is looked up at, and how far they reach over the
// picture's pixel.
#ifndef SAGI_RENDER_MAPPING_H
#define SAGI_RENDER_MAPPING_H

#include <sagitta/render.h>

// Where a texture is looked up. d…dx and d…dy are the changes from one pixel (of the samples' spacing) to the
// next in the picture's x and y; all 0: a point without an extent.
typedef struct sagi_spot {
    sag_vec3 position, normal; // world space; the normal is the geometric one
    double u, v;
    sag_vec3 dpdx, dpdy;
    double dudx, dudy, dvdx, dvdy;
} sagi_spot;

// Texture coordinates and their changes.
typedef struct sagi_spot_2d {
    double s, t, dsdx, dsdy, dtdx, dtdy;
} sagi_spot_2d;

typedef struct sagi_spot_3d {
    sag_vec3 p, dpdx, dpdy;
} sagi_spot_3d;

// A mapping made ready.
typedef struct sagi_mapping {
    sag_mapping mapping;
    bool moved; // world_to_texture is not the identity
} sagi_mapping;

// Zero scales count as 1, zero axes of the plane as x and y.
void sagi_mapping_init(sagi_mapping *mapping, const sag_mapping *description);
sagi_spot_2d sagi_mapping_2d(const sagi_mapping *mapping, const sagi_spot *at);
// The point in the texture's own space, whatever the kind.
sagi_spot_3d sagi_mapping_3d(const sagi_mapping *mapping, const sagi_spot *at);

// The spot of a surface as a point without an extent.
void sagi_spot_at(sagi_spot *spot, const sag_surface *surface);
// Sets du/dx … dv/dy from dp/dx and dp/dy.
void sagi_spot_set_uv(sagi_spot *spot, sag_vec3 dpdu, sag_vec3 dpdv);

#endif
