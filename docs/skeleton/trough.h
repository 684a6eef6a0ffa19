// SPDX-License-Identifier: MIT
// A parabolic trough, the mirror of a solar power plant: the example that docs/adding-a-shape.md walks
// through. In the library this would stand in one of include/sagitta/shapes/*.h, with SAG_API before each
// function.
#ifndef SAG_SKELETON_TROUGH_H
#define SAG_SKELETON_TROUGH_H

#include <sagitta/shapes.h>

/// The parabolic cylinder z = x²/(4f), |x| ≤ half_width, |y| ≤ half_length. A ray that comes down along −z is
/// mirrored through the line x = 0, z = f. Not closed. The front, where the normal points, is the hollow side
/// (+z).
///
/// Texture coordinates: u = (x + half_width)/(2 half_width), v = (y + half_length)/(2 half_length).
typedef struct sag_trough {
    double focal_length; ///< f > 0
    double half_width;   ///< > 0
    double half_length;  ///< > 0
} sag_trough;

/// The verbs of trough: see shapes.h. t within 4 ulp (tests/unit/test_skeleton.c).
sag_status sag_trough_validate(const sag_trough *trough, sag_error *error);
sag_box3 sag_trough_bounds(const sag_trough *trough);
bool sag_trough_hit(const sag_trough *trough, const sag_ray *ray, sag_hit *hit);
bool sag_trough_occluded(const sag_trough *trough, const sag_ray *ray);
size_t sag_trough_crossings(const sag_trough *trough, const sag_ray *ray, sag_hit *hits, size_t capacity);
void sag_trough_surface(const sag_trough *trough, const sag_ray *ray, const sag_hit *hit,
                        sag_surface *surface);
double sag_trough_area(const sag_trough *trough);
bool sag_trough_sample(const sag_trough *trough, sag_vec2 random, sag_surface *surface);

#endif
