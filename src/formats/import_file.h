// SPDX-License-Identifier: MIT
// Files as Assimp gets them: looked at before, and read through us.
#ifndef SAGI_FORMATS_IMPORT_FILE_H
#define SAGI_FORMATS_IMPORT_FILE_H

#include <assimp/cfileio.h>
#include <sagitta/base.h>

// Whether the file may be of the format that its name promises. SAG_ERROR_IO, SAG_ERROR_FORMAT with a word
// why it is not, SAG_ERROR_MEMORY.
sag_status sagi_import_check(const sag_context *context, const char *path, sag_error *error);

// How Assimp opens files: the model and what it names. The context must outlive it.
struct aiFileIO sagi_import_files(const sag_context *context);

#endif
