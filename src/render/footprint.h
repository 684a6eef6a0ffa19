// SPDX-License-Identifier: MIT
// How far the points of a surface are apart that neighbouring samples of the picture show.
#ifndef SAGI_RENDER_FOOTPRINT_H
#define SAGI_RENDER_FOOTPRINT_H

#include "camera.h"
#include "mapping.h"

// The smallest changes of the camera's ray from one pixel to the next, in the frame in which it looks along
// +z.
typedef struct sagi_footprint {
    sag_affine to_world, from_world;
    sag_vec3 origin_x, origin_y, direction_x, direction_y;
    double scale;  // samples are closer than pixels
    bool parallel; // the camera's rays: they are the z axis, wherever the point is
    bool known;    // false: the camera's map has no inverse, all footprints are points
} sagi_footprint;

void sagi_footprint_init(sagi_footprint *footprint, const sagi_camera *camera, uint32_t samples_per_pixel);
// Sets the changes of the spot, which is otherwise complete.
void sagi_footprint_at(const sagi_footprint *footprint, sag_vec3 dpdu, sag_vec3 dpdv, sagi_spot *spot);

#endif
