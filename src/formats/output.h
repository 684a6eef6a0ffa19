// SPDX-License-Identifier: MIT
// A file that appears whole or not at all: written beside its place under a temporary name, renamed over the
// place when everything is on disk. A crash, a full disk or a cancelled run leaves the old file as it was.
#ifndef SAGI_FORMATS_OUTPUT_H
#define SAGI_FORMATS_OUTPUT_H

#include <sagitta/base.h>
#include <stdio.h>

#define SAGI_MAX_PATH 4096

// Zero-initialised or discarded, it holds nothing. The caller writes to `file` and may look only there.
typedef struct sagi_output {
    FILE *file;
    bool is_temporary;             // false: a device or pipe, written in place (nothing to rename)
    char path[SAGI_MAX_PATH];      // where the file is to appear
    char temporary[SAGI_MAX_PATH]; // where it is written meanwhile
} sagi_output;

// Opens a temporary file of a unique name in the directory of `path`, with the rights a new file would have.
// Where `path` is something that exists and is no regular file (a pipe, /dev/stdout) it is opened itself.
// SAG_ERROR_IO with the path and the system's reason; *output then holds nothing.
sag_status sagi_output_open(sagi_output *output, const char *path, sag_error *error);

// Flushes to disk, closes and renames over `path`. On any failure, an earlier failed write included, the
// temporary file is removed and SAG_ERROR_IO returned. *output holds nothing afterwards.
sag_status sagi_output_commit(sagi_output *output, sag_error *error);

// Closes and removes the temporary file. Harmless on an output that holds nothing, also after commit.
void sagi_output_discard(sagi_output *output);

#endif
