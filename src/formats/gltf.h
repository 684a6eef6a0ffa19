// SPDX-License-Identifier: MIT
// A glTF file's JSON as Assimp gets it: without what a still picture does not show.
#ifndef SAGI_FORMATS_GLTF_H
#define SAGI_FORMATS_GLTF_H

#include "formats/file.h"

// Whether the file, a .glb where `binary`, holds JSON of which every sparse accessor is within its buffer
// views. SAG_ERROR_FORMAT with the place, SAG_ERROR_MEMORY.
sag_status sagi_gltf_check(const sagi_file *file, bool binary, const char *path, sag_error *error);

// The same file for Assimp: *out, *size bytes, to be released with sag_release; NULL where the file is not
// one of glTF 2, which Assimp gets as it is. False where memory is short.
bool sagi_gltf_still(const sagi_file *file, bool binary, uint8_t **out, size_t *size);

#endif
