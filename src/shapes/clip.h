// SPDX-License-Identifier: MIT
// Where a ray runs inside a convex solid given by faces: what oriented box and polyhedron share.
//
// Face i is a half-space; along the ray o + t d it reads t·denᵢ ≤ numᵢ. So den > 0 is a face where the ray
// leaves, at t = num/den, den < 0 one where it enters, and den = 0 lets all of the ray in (num ≥ 0, closed)
// or none. The solid is met from the largest entering t to the smallest leaving t, if those are in order:
// always in once and out once. All comparisons are exact: intervals of double values first, double-double
// next, and where those overlap num₁·den₂ beside num₂·den₁ to 400 bits.
#ifndef SAGI_SHAPES_CLIP_H
#define SAGI_SHAPES_CLIP_H

#include "shapes/cut.h"

typedef struct sagi_clip_face {
    double num, num_error, den, den_error;
} sagi_clip_face;

typedef struct sagi_clip_dd {
    sagi_dd num, den;
    double num_error, den_error;
} sagi_clip_dd;

typedef struct sagi_clip_real {
    sagi_real num, den;
} sagi_clip_real;

// The faces of a solid, three times over: quick, in double-double, and to 400 bits. The ray they get has a
// direction of ordinary length.
typedef struct sagi_clip_solid {
    const void *solid;
    uint32_t face_count;
    void (*quick)(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_face *out);
    void (*accurate)(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_dd *out);
    void (*exact)(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_real *out);
} sagi_clip_solid;

#define SAGI_CLIP_NO_FACE 0xFFFFFFFFu

typedef struct sagi_clip_span {
    sagi_cut enter, leave;           // rounded to doubles in order: enter.t.hi ≤ leave.t.hi
    uint32_t enter_face, leave_face; // SAGI_CLIP_NO_FACE: the ray comes from, or goes to, infinity inside
} sagi_clip_span;

// The part of the ray's line inside the solid; false when there is none, or when neither end is in [t_min,
// t_max] for certain. An end that is SAGI_CLIP_NO_FACE has no t.
bool sagi_clip_find(const sagi_clip_solid *solid, const sag_ray *ray, sagi_clip_span *span);

// Widens the position error of a point of a face, its normal being filled in, so that the quick test turns a
// ray spawned there away from the face for certain (sagi_clear_distance).
void sagi_clip_clear(const sagi_clip_solid *solid, uint32_t face, sag_surface *surface);

// The crossings of a span that are in the ray's range, primitive being the face.
sagi_crossings sagi_clip_crossings(const sagi_clip_span *span, const sag_ray *ray);

#endif
