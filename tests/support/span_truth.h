// SPDX-License-Identifier: MIT
// The intervals of a ray in bodies, from the crossings of each body alone, and whether sag_scene_spans says
// the same.
#ifndef TESTS_SUPPORT_SPAN_TRUTH_H
#define TESTS_SUPPORT_SPAN_TRUTH_H

#include "support/random.h"
#include <sagitta/solid.h>

#define MAX_TRUE_SPANS 4096

typedef struct span_truth {
    sag_span spans[MAX_TRUE_SPANS];
    size_t count;
    sag_ray ray;
    uint32_t path[SAG_MAX_INSTANCE_DEPTH], depth; // where its bodies are: changed by the caller
} span_truth;

void span_truth_begin(span_truth *truth, const sag_ray *ray);
// A hit of a geometry at truth's path.
sag_hit span_truth_hit(const span_truth *truth, uint32_t geometry, sag_hit hit);
// Adds a body with these crossings in order of t; `inside`: the line comes from inside of it. `geometry` is
// SAG_INVALID_ID for a solid.
void span_truth_add(span_truth *truth, uint32_t geometry, const sag_hit *hits, size_t count, bool inside);
// Fails the test unless the scene says the same, with room for all, for none and for some.
void span_truth_assert(span_truth *truth, const sag_scene *scene, rng *r);

#endif
