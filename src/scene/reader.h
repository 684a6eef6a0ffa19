// SPDX-License-Identifier: MIT
// A saved scene's bytes on their way in (file.h has the layout).
#ifndef SAGI_SCENE_READER_H
#define SAGI_SCENE_READER_H

#include "scene/file.h"

typedef struct sagi_reader {
    const sag_context *context;
    sag_read_callback read;
    void *user;
    uint64_t offset, bytes; // of the whole file
    sag_error *error;
    sagi_cell **cells;                     // of the scenes so far
    uint32_t count, capacity, scene_count; // of cells, and of scenes in the file
} sagi_reader;

// SAG_ERROR_FORMAT at this byte.
sag_status sagi_reader_wrong(sagi_reader *r, const char *what);
sag_status sagi_reader_no_memory(sagi_reader *r);
// What a commit would refuse is no reason to believe the rest of the file: SAG_OK, SAG_ERROR_MEMORY or else
// SAG_ERROR_FORMAT.
sag_status sagi_reader_told(sagi_reader *r, sag_status status, const sag_error *why);

// The next bytes, of no section.
sag_status sagi_reader_take(sagi_reader *r, void *data, uint64_t bytes);
// The content of the section that has to come next, with this very head and content length.
sag_status sagi_reader_get(sagi_reader *r, sagi_file_section head, const char *name, void *data);
bool sagi_all_zero(const void *data, size_t bytes);

// Whether so much can still come: before memory is asked for on the file's word.
static inline bool sagi_reader_has(const sagi_reader *r, uint64_t bytes) {
    return bytes <= r->bytes - r->offset;
}

// A solid's steps, into the scene.
sag_status sagi_load_steps(sagi_reader *r, const sagi_file_scene *d, sag_scene *scene);
// A snapshot of the scene's geometries and, if it is a solid, of all that its tree is about.
sag_status sagi_load_fill(sagi_reader *r, const sagi_file_scene *d, const sag_scene *scene,
                          sagi_snapshot *snapshot);
// With geometries there: what else a scene has, looked over.
sag_status sagi_load_structure(sagi_reader *r, const sagi_file_scene *d, sagi_snapshot *snapshot,
                               sagi_file_section head);

#endif
