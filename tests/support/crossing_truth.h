// SPDX-License-Identifier: MIT
// What the crossings of a ray must be, by an oracle, and how far those found are from it.
#ifndef TESTS_SUPPORT_CROSSING_TRUTH_H
#define TESTS_SUPPORT_CROSSING_TRUTH_H

#include <gmp.h>
#include <sagitta/shapes.h>

typedef struct crossing_truth {
    int count;
    long double t[8]; // in order, good to 2⁻⁶² of themselves
    bool optional[8]; // within 5 ulp of an end of the ray's range: may be found or not
} crossing_truth;

// Adds the crossing at t, unless it is out of the ray's range.
void crossing_truth_add(crossing_truth *truth, const sag_ray *ray, long double t);
// The same for a fraction numerator/denominator.
void crossing_truth_add_fraction(crossing_truth *truth, const sag_ray *ray, mpq_t t);

// The largest error in ulp of the hits as the crossings expected, in the way kindest to the optional ones;
// INFINITY when there is none.
double crossing_truth_compare(const crossing_truth *truth, const sag_hit *hits, size_t count);

#endif
