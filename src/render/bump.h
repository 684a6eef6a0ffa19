// SPDX-License-Identifier: MIT
// Detail of a surface that its shading has and its shape has not.
#ifndef SAGI_RENDER_BUMP_H
#define SAGI_RENDER_BUMP_H

#include "world.h"

// The shading frame of a point: the unit normal and a direction along the surface.
typedef struct sagi_shading_frame {
    sag_vec3 normal, tangent;
} sagi_shading_frame;

// The surface's own.
static inline sagi_shading_frame sagi_plain_frame(const sag_surface *surface) {
    return (sagi_shading_frame){surface->shading_normal, surface->dpdu};
}

// As if the surface were moved along its normal by `displacement` (a number, in scene units); where its
// origin is not known (NULL) it is taken for flat.
sagi_shading_frame sagi_bumped_frame(const sag_world *world, const sag_input *displacement,
                                     const sag_surface *surface, const sagi_origin *origin,
                                     const sagi_spot *at);
// With the normal of a picture whose red, green and blue are (x + 1)/2 … of directions in the frame of dpdu,
// across it, and the normal.
sagi_shading_frame sagi_mapped_frame(const sagi_mipmap *normals, const sag_surface *surface,
                                     const sagi_spot *at);

#endif
