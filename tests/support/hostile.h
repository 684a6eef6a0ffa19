// SPDX-License-Identifier: MIT
// Changing saved scenes to do harm: every checksum is right, the numbers are not.
#ifndef TESTS_SUPPORT_HOSTILE_H
#define TESTS_SUPPORT_HOSTILE_H

#include "scene/file.h"
#include "support/random.h"
#include "support/saved.h"

// A section of a file in memory.
typedef struct place {
    size_t at, bytes;
} place;

// The first of its kind of a scene; fails the test when there is none.
place hostile_find(const saved *file, sagi_file_tag tag, uint32_t scene);
// A number that may lead somewhere, in place of `now`.
uint32_t hostile_word(rng *r, uint32_t now);
// Loads the file; what comes of it is asked, changed, committed and asked again. Whether it was loaded.
bool hostile_try(rng *r, sag_context *context, saved *file);

// Tries files of seeds 1 … `seeds`, some words of each changed, `tries` times in all; fails the test unless
// some were loaded and some refused.
void hostile_words(rng *r, sag_context *context, saved (*make)(uint64_t seed), uint64_t seeds,
                   uint32_t tries);

#endif
