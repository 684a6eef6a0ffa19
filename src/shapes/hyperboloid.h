// SPDX-License-Identifier: MIT
// What hyperboloid.c and its level case, hyperboloid_ring.c, share. These expect p1.z = p2.z.
#ifndef SAGI_SHAPES_HYPERBOLOID_H
#define SAGI_SHAPES_HYPERBOLOID_H

#include "shapes/axial.h"
#include "shapes/revolve.h"

double sagi_hyperboloid_angle(const sag_hyperboloid *h, double s, double x, double y);
// u, v and the derivatives at surface->position, s being the place along the segment.
void sagi_hyperboloid_texture(const sag_hyperboloid *h, double s, sag_surface *surface);

void sagi_ring_collect(const sag_hyperboloid *ring, const sag_ray *ray, sagi_crossings *list);
void sagi_ring_surface(const sag_hyperboloid *ring, const sag_ray *ray, const sag_hit *hit,
                       sag_surface *surface);
// position_error and normal of a point of the ring's plane.
void sagi_ring_place(const sag_hyperboloid *ring, sag_vec3 point, sag_surface *surface);
// The swept area, and the place s at the given fraction of it.
double sagi_ring_area(const sag_hyperboloid *ring);
double sagi_ring_invert(const sag_hyperboloid *ring, double fraction);

#endif
