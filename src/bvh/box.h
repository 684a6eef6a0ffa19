// SPDX-License-Identifier: MIT
// Boxes of floats, and the way from doubles to floats that never cuts anything off.
#ifndef SAGI_BVH_BOX_H
#define SAGI_BVH_BOX_H

#include <math.h>
#include <stdbool.h>

typedef struct sagi_float_box {
    float lo[3], hi[3];
} sagi_float_box;

static inline sagi_float_box sagi_float_box_empty(void) {
    return (sagi_float_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static inline float sagi_float_min(float a, float b) { return a < b ? a : b; }
static inline float sagi_float_max(float a, float b) { return a > b ? a : b; }

static inline void sagi_float_box_extend(sagi_float_box *box, const float lo[3], const float hi[3]) {
    for (int k = 0; k < 3; k++) {
        box->lo[k] = sagi_float_min(lo[k], box->lo[k]);
        box->hi[k] = sagi_float_max(hi[k], box->hi[k]);
    }
}

static inline bool sagi_float_box_is_empty(const sagi_float_box *box) {
    return !(box->lo[0] <= box->hi[0] && box->lo[1] <= box->hi[1] && box->lo[2] <= box->hi[2]);
}

// Half the surface; 0 for an empty box.
static inline float sagi_float_box_half_area(const sagi_float_box *box) {
    float x = box->hi[0] - box->lo[0], y = box->hi[1] - box->lo[1], z = box->hi[2] - box->lo[2];
    return x >= 0 && y >= 0 && z >= 0 ? x * y + y * z + z * x : 0;
}

// A float ≤ x and one ≥ x, for |x| below the largest float. The conversion rounds to nearest; where it went
// the wrong way, a step of |f| 2⁻²³ + 2⁻¹⁴⁹ leads at least to the neighbouring float: neighbours are at most
// |f| 2⁻²³ apart, denormal ones 2⁻¹⁴⁹. Written without branches, so that loops over vertices vectorise.
static inline float sagi_float_down(double x) {
    float f = (float)x;
    float step = (double)f > x ? fabsf(f) * 0x1p-23f + 0x1p-149f : 0;
    return f - step;
}
static inline float sagi_float_up(double x) { return -sagi_float_down(-x); }

#endif
