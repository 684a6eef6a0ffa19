// SPDX-License-Identifier: MIT
// Triangle meshes written as text, turned into numbers piece by piece on all threads.
#ifndef SAGI_FORMATS_MESH_TEXT_H
#define SAGI_FORMATS_MESH_TEXT_H

#include "formats/load.h"
#include "formats/names.h"

typedef enum sagi_mesh_array {
    SAGI_MESH_POSITIONS,
    SAGI_MESH_NORMALS,
    SAGI_MESH_TEXCOORDS,
    SAGI_MESH_INDICES,
    SAGI_MESH_ARRAY_COUNT
} sagi_mesh_array;

typedef struct sagi_mesh_text {
    sagi_slice arrays[SAGI_MESH_ARRAY_COUNT]; // between the brackets; no text: it is not there
    size_t counts[SAGI_MESH_ARRAY_COUNT];     // how many words each has
    sagi_mesh_data data;                      // the result
    bool wrong; // a word is no number, an index out of range, a count does not fit: there is no result
    bool no_memory;
} sagi_mesh_text;

// Reads all of them, and calls others(argument, i) once for each i < other_count, at the same time. False
// when memory is short.
bool sagi_mesh_texts_read(const sag_context *context, sagi_mesh_text *const *texts, size_t text_count,
                          void (*others)(void *argument, size_t index), void *argument, size_t other_count);

#endif
