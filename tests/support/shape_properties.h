// SPDX-License-Identifier: MIT
// What is true of every shape, tried on one with random rays: the verbs agree with each other, the surface is
// where the hit is, a spawned ray does not meet its own surface, samples are spread by area.
#ifndef TESTS_SUPPORT_SHAPE_PROPERTIES_H
#define TESTS_SUPPORT_SHAPE_PROPERTIES_H

#include "random.h"
#include "shapes/shape.h"

// What a ray that leaves a hit of the shape may meet of the same shape.
typedef enum leaving {
    LEAVING_FLAT,   // nothing, on either side
    LEAVING_CONVEX, // nothing outside; exactly one exit inside
    LEAVING_ANY,    // anything, but not the place it left: rays within 60 degrees of the normal are asked
} leaving;

typedef struct shape_case {
    const sagi_shape_class *kind;
    const void *shape;
    sag_vec3 center; // of a ball that holds the shape, or the part of it that the rays are aimed at
    double radius;
    leaving leaving;
} shape_case;

// A random ray near the shape: most start in or around the ball and are aimed at it, some start far away, run
// along an axis, have a direction of odd length or a limited range.
sag_ray shape_random_ray(rng *r, const shape_case *c);

// Each of these asserts (cmocka) on `count` random rays.
void check_verbs(const shape_case *c, rng *r, size_t count); // hit ≡ occluded ≡ first of crossings; ranges
void check_surfaces(const shape_case *c, rng *r, size_t count); // position, error, normal, derivatives, side
void check_spawned(const shape_case *c, rng *r, size_t count);  // no ray meets the surface it leaves
void check_bad_rays(const shape_case *c);                       // NaN, Inf, zero direction, t_min > t_max
// The area by the count of crossings of random lines (Cauchy and Crofton), and the samples' spread beside
// that of the crossings of random lines, which is uniform by area too (a chi-squared test over the six sides
// and the octants of the ball).
void check_area_and_samples(const shape_case *c, rng *r, size_t count);
// The volume by the lengths of random chords, and `contains` by the parity of crossings.
void check_volume(const shape_case *c, rng *r, size_t count);
// No random point of the surface (by sampling) is nearer than closest_point's, which is its own closest
// point.
void check_closest_point(const shape_case *c, rng *r, size_t count);

#endif
