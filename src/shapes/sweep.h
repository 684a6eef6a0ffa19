// SPDX-License-Identifier: MIT
// The sweep of a surface of revolution about z: the part with φ = atan2(y, x) in [0, phi_max].
#ifndef SAGI_SHAPES_SWEEP_H
#define SAGI_SHAPES_SWEEP_H

#include "math/elementary.h"
#include "shapes/common.h"
#include "shapes/validate.h"

#define SAGI_TWO_PI (2 * SAGI_PI)

// The sweep's end: 0 counts as the full turn.
static inline double sagi_sweep_end(double phi_max_rad) {
    return phi_max_rad > 0 && phi_max_rad < SAGI_TWO_PI ? phi_max_rad : SAGI_TWO_PI;
}

static inline bool sagi_sweep_is_full(double phi_max_rad) {
    return sagi_sweep_end(phi_max_rad) == SAGI_TWO_PI;
}

// φ of (x, y) in [0, 2π).
static inline double sagi_sweep_angle(double x, double y) {
    double phi = sagi_atan2(y, x);
    if (phi < 0) phi += SAGI_TWO_PI;
    return phi < SAGI_TWO_PI ? phi : 0;
}

// Whether the point of the ray at t, about the axis through `center`, is in the sweep. x and y come from
// double-doubles, so that their signs (which side of φ = 0) are right also for a far origin.
bool sagi_sweep_holds(double phi_max_rad, sag_vec3 center, const sag_ray *ray, double t);

// The box, not rounded, of the sweep of everything with ρ ≤ radius and z_min ≤ z ≤ z_max.
sag_box3 sagi_sweep_bounds(double phi_max_rad, double radius, double z_min, double z_max);

// SAG_OK when phi_max_rad is in [0, 2π], else the message. `shape` names it.
sag_status sagi_sweep_validate(sag_error *error, const char *shape, double phi_max_rad);
// SAG_OK when both are coordinates and z_min < z_max.
sag_status sagi_check_interval(sag_error *error, const char *shape, double z_min, double z_max);
// SAG_OK unless a closed shape is swept partly.
sag_status sagi_check_closed(sag_error *error, const char *shape, bool closed, double phi_max_rad);

#endif
