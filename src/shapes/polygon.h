// SPDX-License-Identifier: MIT
// What the files of the polygon share.
#ifndef SAGI_SHAPES_POLYGON_H
#define SAGI_SHAPES_POLYGON_H

#include "math/dd.h"
#include <sagitta/shapes.h>

// The plane of the first loop in double-doubles: normal by Newell's rule (its length is twice the loop's
// area) times 2^-2k, with k = scale_exponent about the size of the loop; middle − positions[0], the centroid
// of the loop's points, times 2^-k.
typedef struct sagi_polygon_plane {
    sagi_dd normal[3], middle[3];
    sag_vec3 unit;      // the normal as a unit vector
    int scale_exponent; // k
    double size;        // the largest |p_i − p_0| times 2^-k, in [1, 2)
    double sum;         // the sum of the normal's products' absolute values
} sagi_polygon_plane;

// Whether the arrays can be read: counts that add up, three points in each loop, finite and within
// SAG_MAX_COORDINATE.
bool sagi_polygon_is_readable(const sag_polygon *polygon);
// False when the loop has no area.
bool sagi_polygon_make_plane(const sag_polygon *polygon, sagi_polygon_plane *plane);
// The parameter of a readable polygon's plane on a line, within 4 ulp; NaN when they are parallel.
double sagi_polygon_plane_t(const sag_polygon *polygon, const sagi_polygon_plane *plane, const sag_ray *ray);
// How far off the plane the farthest of all points is.
double sagi_polygon_deviation(const sag_polygon *polygon, const sagi_polygon_plane *plane);

// Seen along the normal's largest component the polygon lies in a plane of two axes, as the points' own
// coordinates say: "below", the even-odd area with y under a limit, is what area and sampling need.
sag_vec2 sagi_polygon_flatten(sag_vec3 p, int dropped_axis);
// Even-odd area of the flattened polygon.
double sagi_polygon_flat_area(const sag_polygon *polygon, int dropped_axis);
// A uniform point of it from two numbers in [0, 1).
sag_vec2 sagi_polygon_flat_sample(const sag_polygon *polygon, int dropped_axis, sag_vec2 random);
// Whether edges cross; the first points of two that do.
bool sagi_polygon_crosses_itself(const sag_polygon *polygon, int dropped_axis, uint32_t edges[2]);

// The end of the edge that starts at position i of the loop [first, first + size).
static inline uint32_t sagi_polygon_next(uint32_t i, uint32_t first, uint32_t size) {
    return i + 1 < first + size ? i + 1 : first;
}

#endif
