// SPDX-License-Identifier: MIT
// What the files of the ray reader share: ray_table.c opens, fills the buffer and hands out blocks; ray_csv.c
// and ray_npy.c turn bytes into rays.
#ifndef SAGI_FORMATS_RAY_READER_H
#define SAGI_FORMATS_RAY_READER_H

#include "formats/npy.h"
#include "formats/ray_table.h"

#define SAGI_RAY_COLUMNS   8
#define SAGI_RAY_BUFFER    ((size_t)4 << 20) // bytes of the table in memory at once
#define SAGI_RAY_MAX_LINE  ((size_t)1 << 20) // a longer line is no ray
#define SAGI_RAY_MAX_PIECE 64                // pieces of a block, parsed side by side

struct sagi_ray_reader {
    const sag_context *context;
    const volatile sig_atomic_t *stop;
    const char *file; // for messages
    char *path;
    size_t path_bytes;
    int descriptor;
    bool is_regular, at_end, is_npy;
    uint64_t file_bytes; // of a regular file
    uint64_t read_bytes; // so far

    char *buffer; // bytes [0, filled) are read but not yet rays
    size_t filled;

    sag_ray *rays;
    size_t capacity;

    // CSV
    uint64_t line;                     // lines used up
    uint32_t columns;                  // 0: no ray seen yet
    uint8_t meaning[SAGI_RAY_COLUMNS]; // which of ox … tmax each column is
    bool has_header;

    // .npy
    sagi_npy_header npy;
    uint64_t rows_done;
};

// Reads until the buffer is full, the table ends, or (not from a regular file) nothing more is waiting.
sag_status sagi_ray_reader_fill(sagi_ray_reader *reader, sag_error *error);
// Room for so many rays.
sag_status sagi_ray_reader_reserve(sagi_ray_reader *reader, size_t count, sag_error *error);

// Makes a ray of ox oy oz dx dy dz tmin tmax. NULL, or what is wrong with it; *which then is the number (0 …
// 7) to blame.
const char *sagi_ray_from_numbers(const double numbers[SAGI_RAY_COLUMNS], sag_ray *ray, int *which);

sag_status sagi_ray_csv_next(sagi_ray_reader *reader, size_t *count, sag_error *error);
sag_status sagi_ray_npy_open(sagi_ray_reader *reader, sag_error *error);
sag_status sagi_ray_npy_next(sagi_ray_reader *reader, size_t *count, sag_error *error);

#endif
