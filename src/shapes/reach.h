// SPDX-License-Identifier: MIT
// Close boxes of turned shapes.
#ifndef SAGI_SHAPES_REACH_H
#define SAGI_SHAPES_REACH_H

#include <sagitta/shapes.h>

// The largest n·p of the points p of the shape (of a partial one at least that); false for kinds that it is
// not known of.
bool sagi_shape_reach(sag_shape_kind kind, const void *shape, sag_vec3 n, double *reach);
// A box of the shape's image under the map, `own` being its box: sag_affine_box's, or within it.
sag_box3 sagi_shape_turned_box(sag_shape_kind kind, const void *shape, const sag_box3 *own,
                               const sag_affine *map);

#endif
