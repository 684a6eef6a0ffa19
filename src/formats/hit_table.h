// SPDX-License-Identifier: MIT
// Hits into a table: CSV or a structured NumPy .npy array, row by row, in a stream.
//
// Rows are encoded by any threads at once (sagi_hit_encode keeps no state) and appended by one, in order. The
// file appears whole or not at all.
#ifndef SAGI_FORMATS_HIT_TABLE_H
#define SAGI_FORMATS_HIT_TABLE_H

#include "formats/output.h"

#include <sagitta/math.h>

// What the rows hold.
typedef enum sagi_hit_columns {
    SAGI_HIT_FULL,  // ray,hit,t,x,y,z,nx,ny,nz,u,v,geometry,primitive,instance
    SAGI_HIT_FLAG,  // ray,hit
    SAGI_HIT_COUNT, // ray,count
    SAGI_HIT_SPAN,  // ray,hit,t_enter,t_leave,length,geometry_enter,primitive_enter,geometry_leave,
                    // primitive_leave,instance
} sagi_hit_columns;

// One row. A miss has hit false, t infinite, NaN for the other numbers and -1 for the ids. Of a span t,
// geometry and primitive are where it begins.
typedef struct sagi_hit_row {
    uint64_t ray; // number of the ray, from 0
    bool hit;
    uint64_t count; // SAGI_HIT_COUNT only
    double t;
    sag_vec3 position, normal;
    double u, v;
    int64_t geometry, primitive, instance; // -1: none
    // SAGI_HIT_SPAN only. Of a miss NaN, but length 0, so that lengths can be added up.
    double t_leave, length;
    int64_t geometry_leave, primitive_leave;
} sagi_hit_row;

// No row is longer.
#define SAGI_HIT_ROW_BYTES 352

typedef struct sagi_hit_table {
    sagi_output output;
    sagi_hit_columns columns;
    bool is_npy;
    bool is_stdout;
    const char *name; // for messages
    uint64_t row_count;
} sagi_hit_table;

// The row of a ray that hits nothing, and of one that is in nothing.
sagi_hit_row sagi_hit_miss(uint64_t ray);
sagi_hit_row sagi_hit_no_span(uint64_t ray);

// Opens a table and writes its header: .npy by the ending of `path`, else CSV; "-" is the standard output
// (CSV). `path` must outlive the table. SAG_ERROR_IO; SAG_ERROR_ARGUMENT for a .npy that is no plain file
// (its header is written last).
sag_status sagi_hit_table_open(sagi_hit_table *table, const char *path, sagi_hit_columns columns,
                               sag_error *error);

// Writes a row to `bytes` (SAGI_HIT_ROW_BYTES of room) and returns its length. Thread-safe.
size_t sagi_hit_encode(const sagi_hit_table *table, const sagi_hit_row *row, char *bytes);

// Appends encoded rows. SAG_ERROR_IO with the system's reason.
sag_status sagi_hit_table_append(sagi_hit_table *table, const char *bytes, size_t size, uint64_t row_count,
                                 sag_error *error);

// Hands on what is buffered, for a reader at the other end of a pipe.
sag_status sagi_hit_table_flush(sagi_hit_table *table, sag_error *error);

// Completes the file and gives it its name. On failure it is removed.
sag_status sagi_hit_table_commit(sagi_hit_table *table, sag_error *error);

// Removes what was written (of a file). Harmless after commit.
void sagi_hit_table_discard(sagi_hit_table *table);

#endif
