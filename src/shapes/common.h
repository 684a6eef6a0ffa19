// SPDX-License-Identifier: MIT
// What the shape files share. Each shape finds its crossings in one static function, in order of t; the verbs
// hit, occluded and crossings read that list, so they cannot disagree.
#ifndef SAGI_SHAPES_COMMON_H
#define SAGI_SHAPES_COMMON_H

#include <sagitta/shapes.h>
#include <string.h>

#define SAGI_MAX_CROSSINGS 8
#define SAGI_PI            3.14159265358979323846
#define SAGI_EPSILON       0x1p-53 // the unit roundoff u: fl(a∘b) = (a∘b)(1 + δ), |δ| ≤ u

typedef struct sagi_crossing {
    double t, u, v;
    uint32_t primitive;
} sagi_crossing;

// Crossings in order of t, at most SAGI_MAX_CROSSINGS.
typedef struct sagi_crossings {
    int count;
    sagi_crossing at[SAGI_MAX_CROSSINGS];
} sagi_crossings;

// Inserts a crossing, keeping the order: by t, then by primitive, as a scene orders hits; a new one goes
// after those of equal both. A NaN t is not inserted.
void sagi_crossings_add(sagi_crossings *list, double t, double u, double v, uint32_t primitive);
// The verbs hit and crossings, from a list that holds only what is in the ray's range.
bool sagi_crossings_first(const sagi_crossings *list, sag_hit *hit);
size_t sagi_crossings_write(const sagi_crossings *list, sag_hit *hits, size_t capacity);

// A hit of a shape used alone: no geometry, no instances.
sag_hit sagi_hit_make(double t, double u, double v, uint32_t primitive);

// A crossing beyond the doubles (t infinite, of a ray whose direction is next to 0) is none.
static inline bool sagi_in_range(const sag_ray *ray, double t) {
    return t >= ray->t_min && t <= ray->t_max && !isinf(t);
}

// The part of `surface` that is the same for every shape, once position, position_error, geometric_normal,
// dpdu, dpdv, u and v are there: shading normal := geometric normal, side by the ray's direction, primitive
// from the hit, no geometry, no user data; and a frame of the normal for derivatives that came out zero,
// parallel or not finite.
void sagi_surface_finish(sag_surface *surface, const sag_ray *ray, const sag_hit *hit);
// The same for a sampled point, seen from its front.
void sagi_surface_finish_sample(sag_surface *surface, uint32_t primitive);

// Of these the last: a frame of the normal for such derivatives.
void sagi_surface_finish_derivatives(sag_surface *surface);

// The next double towards +∞ as nextafter gives it, in a few instructions: the bits of positive doubles count
// upward, those of negative ones downward. ∞ stays, and so does NaN.
static inline double sagi_next_up(double x) {
    uint64_t bits;
    if (!(x < INFINITY)) return x;
    if (x == 0) return 0x1p-1074;
    memcpy(&bits, &x, sizeof bits);
    bits += x > 0 ? 1 : UINT64_MAX;
    memcpy(&x, &bits, sizeof x);
    return x;
}
// The same towards −∞. For outward rounding.
static inline double sagi_next_down(double x) { return -sagi_next_up(-x); }
// The box grown by `ulps` relative roundings of each coordinate's magnitude plus one step, outward.
sag_box3 sagi_box3_round_out(sag_box3 box, double ulps);

#endif
