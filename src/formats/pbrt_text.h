// SPDX-License-Identifier: MIT
// The text of a pbrt file: places in it, its tokens, its parameter lists.
#ifndef SAGI_FORMATS_PBRT_TEXT_H
#define SAGI_FORMATS_PBRT_TEXT_H

#include "formats/file.h"
#include "formats/names.h"
#include "formats/output.h"

// A file of the scene, in memory until everything is loaded.
typedef struct sagi_source {
    struct sagi_source *previous; // the one opened before
    sagi_file file;
    uint64_t device, inode; // which file it is, whatever its name
    char path[SAGI_MAX_PATH];
} sagi_source;

// Where something stands. Line and column are counted only when someone asks.
typedef struct sagi_place {
    const sagi_source *source;
    const char *at;
} sagi_place;

// Lines and columns (in bytes) count from 1.
void sagi_place_find(sagi_place place, int *line, int *column);
// SAG_ERROR_FORMAT with the place.
sag_status sagi_place_error(sagi_place place, sag_error *error, const char *format, ...) SAG_PRINTF(3, 4);

typedef enum sagi_token_kind {
    SAGI_TOKEN_END,
    SAGI_TOKEN_WORD,   // a directive, number, true or false
    SAGI_TOKEN_STRING, // the text between the quotes, escapes as written
    SAGI_TOKEN_OPEN,   // [
    SAGI_TOKEN_CLOSE,  // ]
} sagi_token_kind;

typedef struct sagi_token {
    sagi_token_kind kind;
    sagi_slice text;
    sagi_place place;
} sagi_token;

// A place of reading.
typedef struct sagi_cursor {
    const sagi_source *source;
    const char *next, *end;
} sagi_cursor;

// The next token; comments (# to the end of the line) and white space are passed over. An unended string is
// an error.
sag_status sagi_cursor_next(sagi_cursor *cursor, sagi_token *token, sag_error *error);

typedef enum sagi_type {
    SAGI_TYPE_INTEGER = 1 << 0,
    SAGI_TYPE_FLOAT = 1 << 1,
    SAGI_TYPE_BOOL = 1 << 2,
    SAGI_TYPE_STRING = 1 << 3,
    SAGI_TYPE_POINT2 = 1 << 4,
    SAGI_TYPE_VECTOR2 = 1 << 5,
    SAGI_TYPE_POINT3 = 1 << 6,
    SAGI_TYPE_VECTOR3 = 1 << 7,
    SAGI_TYPE_NORMAL = 1 << 8,
    SAGI_TYPE_RGB = 1 << 9,
    SAGI_TYPE_SPECTRUM = 1 << 10,
    SAGI_TYPE_BLACKBODY = 1 << 11,
    SAGI_TYPE_TEXTURE = 1 << 12,
} sagi_type;

// One "type name" [values]. Numbers (booleans as 0 and 1) and strings stand in the list's pools.
typedef struct sagi_param {
    sagi_type type;
    sagi_slice name;
    sagi_place place;                  // of the "type name"
    size_t first_number, number_count; // single numbers, not points
    size_t first_string, string_count;
    sagi_slice text; // between the brackets, when the list is skimmed
    bool used, skimmed;
} sagi_param;

// A parameter list; keeps its memory from one directive to the next.
typedef struct sagi_params {
    const sag_context *context;
    sag_error *error;
    sag_status status; // the first failure of parsing or looking up
    sagi_place place;  // of the directive
    char what[128];    // Shape "sphere": for messages
    sagi_param *items;
    size_t count, allocated;
    double *numbers;
    size_t number_count, number_allocated;
    sagi_slice *strings;
    size_t string_count, string_allocated;
    // Long arrays of numbers are not converted, only their text is noted, and they are marked as skimmed.
    bool skim;
} sagi_params;

void sagi_params_clear(sagi_params *params);
void sagi_params_empty(sagi_params *params);
// Adds the parameters that stand there, until something is no string; that token stays unread.
sag_status sagi_params_parse(sagi_params *params, sagi_cursor *cursor);
// Fails the list (keeping the first failure), with the place of `param` or, NULL, of the directive.
sag_status sagi_params_fail(sagi_params *params, const sagi_param *param, const char *format, ...)
    SAG_PRINTF(3, 4);

// The last parameter of that name, NULL when there is none; marks it used. One of another type than in the
// mask fails the list and is NULL too. So does, for the functions below, a wrong number of values.
sagi_param *sagi_params_find(sagi_params *params, const char *name, unsigned types);
double sagi_params_float(sagi_params *params, const char *name, double otherwise);
int32_t sagi_params_integer(sagi_params *params, const char *name, int32_t otherwise);
bool sagi_params_bool(sagi_params *params, const char *name, bool otherwise);
// Writes the string, escapes undone, or `otherwise`; at most size − 1 bytes (longer fails).
void sagi_params_string(sagi_params *params, const char *name, const char *otherwise, char *text,
                        size_t size);
// Three numbers of a point, vector or normal.
// The list's string of that number, escapes undone: itself where it has none, else in `room`, which is to be
// as long as the longest name.
#define SAGI_MAX_NAME 1024
sagi_slice sagi_params_name(const sagi_params *params, size_t string, char room[SAGI_MAX_NAME]);
bool sagi_params_triple(sagi_params *params, const char *name, double triple[3]);
// All numbers of a parameter, a multiple of `group`; NULL and count 0 when it is not there.
const double *sagi_params_numbers(sagi_params *params, const char *name, unsigned types, size_t group,
                                  size_t *count);

#endif
