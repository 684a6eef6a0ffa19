// SPDX-License-Identifier: MIT
// Scenes with everything in them, rays to ask them, and whether two scenes give the same answers.
#ifndef TESTS_SUPPORT_RANDOM_SCENE_H
#define TESTS_SUPPORT_RANDOM_SCENE_H

#include "support/random_shape.h"

// Adds a random shape of a kind, placed at random, with a random mask and user data; returns its id. A user's
// shape needs callbacks, so `kind` is any before SAG_SHAPE_USER.
uint32_t random_scene_add(rng *r, sag_scene *scene, sag_shape_kind kind, double size);
// A committed scene of `count` shapes of all kinds and a small mesh, or NULL when memory is short.
sag_scene *random_scene(rng *r, sag_context *context, uint32_t count, double size);
// The same with `levels` of scenes below, each shown by instances twice in the one above, one of them in two
// scenes.
sag_scene *random_nested_scene(rng *r, sag_context *context, uint32_t count, int levels, double size);

// A ray at a scene of about this size: near, far, along axes, with limits and masks.
sag_ray random_scene_ray(rng *r, double size);
// Fails the test unless both scenes give the same bits to every query, `rays` times.
void assert_same_answers(const sag_scene *a, const sag_scene *b, rng *r, size_t rays, double size);

#endif
