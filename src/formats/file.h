// SPDX-License-Identifier: MIT
// A whole file as bytes in memory: mapped when it is a plain file, inflated when it is gzip's.
#ifndef SAGI_FORMATS_FILE_H
#define SAGI_FORMATS_FILE_H

#include <sagitta/base.h>

// What a gzip file may inflate to. A few kilobytes can claim terabytes; a scene that large is not meant.
// So is one that is more than a hundred times as large as its file; text and meshes are three to thirty
// times.
#define SAGI_MAX_INFLATED_BYTES   ((size_t)4 << 30)
#define SAGI_MAX_INFLATION        ((size_t)100)
#define SAGI_SMALL_INFLATED_BYTES ((size_t)64 << 20) // for small files

// Zero-initialised or closed, it holds nothing. A mapped file that another program truncates meanwhile raises
// SIGBUS, as with every mapping; scenes and meshes are not edited while they are read.
typedef struct sagi_file {
    const uint8_t *bytes; // never NULL once open, not even for an empty file; not ended by a zero byte
    size_t size;
    const sag_context *context;
    void *memory;     // what to unmap or release
    size_t allocated; // 0: mapped, or nothing
} sagi_file;

// Opens and reads `path`; gzip is told by its first two bytes and inflated. SAG_ERROR_IO with the system's
// reason, SAG_ERROR_FORMAT for damaged gzip data, SAG_ERROR_MEMORY; *file then holds nothing.
sag_status sagi_file_open(const sag_context *context, const char *path, sagi_file *file, sag_error *error);
void sagi_file_close(sagi_file *file);

#endif
