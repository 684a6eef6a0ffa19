// SPDX-License-Identifier: MIT
// Saved scenes in memory, to be damaged.
#ifndef TESTS_SUPPORT_SAVED_H
#define TESTS_SUPPORT_SAVED_H

#include <sagitta/scene.h>

typedef struct saved {
    unsigned char *bytes; // from malloc
    size_t count, capacity;
} saved;

// What sag_scene_write says of the scene; count 0 when it failed.
saved saved_from(const sag_scene *scene, sag_status *status, sag_error *error);
// sag_scene_read of exactly these bytes.
sag_status saved_read(sag_context *context, const unsigned char *bytes, size_t count, sag_scene **scene,
                      sag_error *error);
// Gives every head and content of a whole file its right checksum again.
void saved_seal(saved *file);
void saved_free(saved *file);

#endif
