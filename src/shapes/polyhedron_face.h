// SPDX-License-Identifier: MIT
// The faces of a polyhedron given by half-spaces, as polygons: for bounds, area, volume, sampling and the
// closest point. Rays do not need them.
#ifndef SAGI_SHAPES_POLYHEDRON_FACE_H
#define SAGI_SHAPES_POLYHEDRON_FACE_H

#include "math/dd.h"
#include "shapes/common.h"

#define SAGI_FACE_MAX_VERTICES (SAG_MAX_POLYHEDRON_PLANES + 4)

// A face's outline, counter-clockwise or clockwise. Where the face is unbounded, `unbounded` is true and the
// outline goes along a square very far away: coordinates beyond `far` stand for infinity.
typedef struct sagi_polyhedron_face {
    int count; // 0: the plane has no face
    bool unbounded;
    double far;
    sag_vec3 vertices[SAGI_FACE_MAX_VERTICES];
} sagi_polyhedron_face;

// Works out the face on planes[plane]. Of planes that coincide only the first has a face. The planes must be
// finite, with normals other than 0.
void sagi_polyhedron_face_find(const sag_polyhedron *polyhedron, uint32_t plane, sagi_polyhedron_face *face);

// Area of the outline, for one that is not unbounded.
double sagi_polyhedron_face_area(const sagi_polyhedron_face *face);

#endif
