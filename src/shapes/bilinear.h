// SPDX-License-Identifier: MIT
// What the files of the bilinear patch share.
#ifndef SAGI_SHAPES_BILINEAR_H
#define SAGI_SHAPES_BILINEAR_H

#include "shapes/common.h"

// The crossings of a valid ray with the patch, in its range; at most two.
void sagi_bilinear_solve(const sag_bilinear_patch *patch, const sag_ray *ray, sagi_crossings *list);

// dp/du = u_edge + v twist, dp/dv = v_edge + u twist; their cross product, the area element, is n + u n_u +
// v n_v: no term in uv, since twist × twist = 0.
typedef struct sagi_bilinear_frame {
    sag_vec3 u_edge, v_edge, twist;
    sag_vec3 n, n_u, n_v;
} sagi_bilinear_frame;

sagi_bilinear_frame sagi_bilinear_make_frame(const sag_bilinear_patch *patch);
// To a relative 1e-9 and usually the last few bits.
double sagi_bilinear_area(const sagi_bilinear_frame *frame);
// The u, v of a point uniform by area; `area` is the patch's.
sag_vec2 sagi_bilinear_sample(const sagi_bilinear_frame *frame, double area, sag_vec2 random);

#endif
