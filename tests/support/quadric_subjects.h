// SPDX-License-Identifier: MIT
// Random shapes of second degree, each with its equation written down independently for the oracle.
#ifndef TESTS_SUPPORT_QUADRIC_SUBJECTS_H
#define TESTS_SUPPORT_QUADRIC_SUBJECTS_H

#include "support/quadric_truth.h"
#include "support/random.h"

typedef union any_quadric {
    sag_sphere sphere;
    sag_ellipsoid ellipsoid;
    sag_cylinder cylinder;
    sag_cone cone;
    sag_paraboloid paraboloid;
    sag_hyperboloid hyperboloid;
    sag_hyperboloid2 hyperboloid2;
    sag_quadric quadric;
} any_quadric;

typedef struct quadric_subject {
    const char *name;
    // Makes a random shape of about the given size, whole and closed or clipped, swept and open as it likes,
    // and writes its equation (init'ed truth).
    void (*make)(rng *r, double size, any_quadric *shape, quadric_truth *truth);
    sag_status (*validate)(const void *, sag_error *);
    sag_box3 (*bounds)(const void *);
    bool (*hit)(const void *, const sag_ray *, sag_hit *);
    bool (*occluded)(const void *, const sag_ray *);
    size_t (*crossings)(const void *, const sag_ray *, sag_hit *, size_t);
    void (*surface)(const void *, const sag_ray *, const sag_hit *, sag_surface *);
    double (*area)(const void *);
    bool (*sample)(const void *, sag_vec2, sag_surface *);
    bool (*contains)(const void *, sag_vec3);
} quadric_subject;

extern const quadric_subject quadric_subjects[];
extern const size_t quadric_subject_count;

// A ray worth trying: from inside, near, far or on the surface, towards the shape, along an axis or grazing,
// with a direction of any length.
sag_ray quadric_subject_ray(rng *r, const quadric_subject *subject, const any_quadric *shape, double size);

#endif
