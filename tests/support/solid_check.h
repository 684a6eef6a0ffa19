// SPDX-License-Identifier: MIT
// One ray through one solid: everything that the library says about it, beside the truth.
#ifndef TESTS_SUPPORT_SOLID_CHECK_H
#define TESTS_SUPPORT_SOLID_CHECK_H

#include "support/solid_model.h"

// A scene that shows a model; it goes on where the caller leaves it.
typedef struct solid_world {
    solid_model *model;
    sag_scene *scene;
    uint32_t instance; // the model's id there
    bool mapped;       // by map, back and inverse
    bool exact;        // no maps anywhere: every question can be decided
    sag_affine map, back;
    inverse_map inverse;
    double size; // of the solid in the scene
    // room for the work
    model_crossing *crossings;
    size_t crossing_capacity, hit_capacity;
    sag_hit *hits;
    signed char *enters; // of each hit: whether the solid begins there; -1: not known
    membership *states[3];
} solid_world;

typedef struct solid_tally {
    size_t rays, decisions, undecided, wrong;
    size_t boundaries, owners, normals; // of how many these were checked
    uint64_t seed;                      // of the solid at hand, for messages
} solid_tally;

// Takes the model over; map NULL: the scene is the instance under the identity.
void solid_world_make(solid_world *world, sag_context *context, solid_model *model, const sag_affine *map,
                      double size);
void solid_world_free(solid_world *world);

// `random`: nothing about the ray is special, so that normals can be checked too.
void solid_check_ray(solid_world *world, const sag_ray *ray, rng *r, bool random, solid_tally *tally);
// sag_contains at a point.
void solid_check_point(solid_world *world, sag_vec3 point, solid_tally *tally);
// Prints the counts; fails the test when anything was wrong or too much undecided.
void solid_tally_finish(const solid_tally *tally, const char *name);

#endif
