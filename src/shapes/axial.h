// SPDX-License-Identifier: MIT
// Surfaces of revolution about z between two planes: cylinder, cone, paraboloid, hyperboloids.
#ifndef SAGI_SHAPES_AXIAL_H
#define SAGI_SHAPES_AXIAL_H

#include "shapes/quadric_solve.h"
#include "shapes/sweep.h"

enum { SAGI_CURVED, SAGI_CAP_LOW, SAGI_CAP_HIGH }; // primitives

// Where a line is between the planes z = z_min and z = z_max, and which cap it enters and leaves by.
typedef struct sagi_axial_cut {
    double enter, leave;
    uint32_t enter_cap, leave_cap;
} sagi_axial_cut;

static inline sagi_axial_cut sagi_cut_slab(double z_min, double z_max, double o, double d) {
    if (d == 0) {
        bool inside = o >= z_min && o <= z_max;
        return (sagi_axial_cut){inside ? -INFINITY : INFINITY, inside ? INFINITY : -INFINITY, 0, 0};
    }
    double low = (z_min - o) / d, high = (z_max - o) / d;
    return d > 0 ? (sagi_axial_cut){low, high, SAGI_CAP_LOW, SAGI_CAP_HIGH}
                 : (sagi_axial_cut){high, low, SAGI_CAP_HIGH, SAGI_CAP_LOW};
}

// Keeps of the spans of {F ≤ 0} what lies in z_min ≤ z ≤ z_max (±INFINITY: not cut) and adds its ends that
// are in the ray's range: closed, all ends, a cut one being a cap's (so their number is even); open, only
// those that are roots of F.
void sagi_axial_collect(const sagi_spans *spans, double z_min, double z_max, bool closed, const sag_ray *ray,
                        sagi_crossings *list);
// Drops the crossings out of the sweep about the z axis.
void sagi_axial_sweep(double phi_max_rad, const sag_ray *ray, sagi_crossings *list);

// Brings a position on the curved surface that rounding moved beyond a plane back to it, along the surface's
// profile. `form` has no cross terms and stands on the z axis.
void sagi_axial_clamp(const sagi_quadric_form *form, double z_min, double z_max, sag_surface *surface);

// The surface data of the cap at height z, of the given radius, with normal (0, 0, up): all but what
// sagi_surface_finish adds.
void sagi_cap_place(double z, double radius, double up, double x, double y, sag_surface *surface);
// The same at the point of a ray.
void sagi_cap_surface(double z, double radius, double up, const sag_ray *ray, double t, sag_surface *surface);
// A point of the cap uniform by area.
void sagi_cap_sample(double z, double radius, double up, sag_vec2 random, sag_surface *surface);

// Takes its place in [0, 1) out of *random when it falls into the part [0, fraction), and stretches the rest:
// the usual way to choose between parts with one random number.
bool sagi_choose(double *random, double fraction);

// The point nearest to `point` on the sweep of the segment from (rho0, z0) to (rho1, z1) of the half plane φ
// = 0.
sag_vec3 sagi_axial_closest(double rho0, double z0, double rho1, double z1, double phi_max_rad,
                            sag_vec3 point);
// The nearer of two points to a third.
sag_vec3 sagi_nearer(sag_vec3 point, sag_vec3 a, sag_vec3 b);

#endif
