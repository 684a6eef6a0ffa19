// SPDX-License-Identifier: MIT
// What the two readers of PLY data share: ply.c, which reads everything, and ply_quick.c, which reads what
// large files hold, quickly.
#ifndef SAGI_FORMATS_PLY_H
#define SAGI_FORMATS_PLY_H

#include "formats/load.h"

#define SAGI_PLY_MAX_PROPERTIES 64
#define SAGI_PLY_MAX_CORNERS    65536

typedef enum sagi_ply_type {
    SAGI_PLY_NONE,
    SAGI_PLY_INT8,
    SAGI_PLY_UINT8,
    SAGI_PLY_INT16,
    SAGI_PLY_UINT16,
    SAGI_PLY_INT32,
    SAGI_PLY_UINT32,
    SAGI_PLY_FLOAT32,
    SAGI_PLY_FLOAT64
} sagi_ply_type;
typedef enum sagi_ply_encoding {
    SAGI_PLY_ASCII,
    SAGI_PLY_LITTLE_ENDIAN,
    SAGI_PLY_BIG_ENDIAN
} sagi_ply_encoding;
// What a property is to us.
typedef enum sagi_ply_role {
    SAGI_PLY_IGNORED,
    SAGI_PLY_X,
    SAGI_PLY_Y,
    SAGI_PLY_Z,
    SAGI_PLY_NX,
    SAGI_PLY_NY,
    SAGI_PLY_NZ,
    SAGI_PLY_U,
    SAGI_PLY_V,
    SAGI_PLY_INDICES,
    SAGI_PLY_ROLE_COUNT
} sagi_ply_role;

typedef struct sagi_ply_property {
    sagi_ply_type type, count_type; // count_type NONE: a single value, else a list's
    sagi_ply_role role;
} sagi_ply_property;

typedef struct sagi_ply_reader {
    const sag_context *context;
    const char *path;
    sag_error *error;
    const uint8_t *begin, *next, *end;
    sagi_ply_encoding encoding;
    sagi_mesh_data *mesh;
    bool seen_vertices, seen_faces;
    uint32_t largest_index;
    const uint8_t *largest_at; // where the largest index stands
} sagi_ply_reader;

size_t sagi_ply_size(sagi_ply_type type);

// Reads `count` vertices into the mesh's arrays, which are there, if they are of a kind that it knows and all
// there: then true, and r->next is behind them. Else false, and nothing has been read.
bool sagi_ply_quick_vertices(sagi_ply_reader *r, size_t count, const sagi_ply_property *properties,
                             int property_count);
// Reads faces as long as they are triangles and plain, and returns how many; the mesh has room for them.
size_t sagi_ply_quick_triangles(sagi_ply_reader *r, size_t count, const sagi_ply_property *properties,
                                int property_count);

#endif
