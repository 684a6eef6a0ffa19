// SPDX-License-Identifier: MIT
// Layers: what the camera's rays meet first, beside the picture.
#ifndef SAGI_RENDER_LAYERS_H
#define SAGI_RENDER_LAYERS_H

#include "color.h"

// What one sample's ray met first.
typedef struct sagi_first {
    bool met; // anything; else all of it is 0
    float albedo[3], normal[3], shading_normal[3], position[3], depth, uv[2];
    uint32_t ids[3]; // geometry, instance, material
} sagi_first;

// The sums of one pixel.
typedef struct sagi_layer_pixel {
    double sum[3], square[3]; // of the samples' colours
    float weight;             // of the samples that met something
    float albedo[3], normal[3], shading_normal[3], position[3], depth, uv[2];
    uint32_t ids[3], votes; // those of most samples, and by how many more
} sagi_layer_pixel;

#endif
