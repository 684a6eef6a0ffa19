// SPDX-License-Identifier: MIT
// The hit table's two encodings. Numbers in CSV have 17 significant digits, so they are the very doubles when
// read again; a .npy row holds the doubles themselves, without padding. How many rows a .npy array has stands
// in its header, which therefore has a fixed size and is written again at the end.
#include "formats/hit_table.h"

#include "formats/decimal.h"
#include "formats/npy.h"

#include <errno.h>
#include <string.h>

#define MAX_NUMBERS 9 // t x y z nx ny nz u v
#define MAX_IDS     5 // geometry and primitive twice, instance

static const char *csv_header(sagi_hit_columns columns) {
    switch (columns) {
    case SAGI_HIT_FULL: return "ray,hit,t,x,y,z,nx,ny,nz,u,v,geometry,primitive,instance\n";
    case SAGI_HIT_FLAG: return "ray,hit\n";
    case SAGI_HIT_COUNT: return "ray,count\n";
    case SAGI_HIT_SPAN:
        return "ray,hit,t_enter,t_leave,length,geometry_enter,primitive_enter,geometry_leave,primitive_leave,"
               "instance\n";
    }
    return "";
}

// The element type as NumPy writes it, in this machine's byte order (# stands for < or >).
static const char *npy_type(sagi_hit_columns columns) {
    switch (columns) {
    case SAGI_HIT_FULL:
        return "[('ray', '#i8'), ('hit', '|b1'), ('t', '#f8'), ('x', '#f8'), ('y', '#f8'), ('z', '#f8'), "
               "('nx', '#f8'), ('ny', '#f8'), ('nz', '#f8'), ('u', '#f8'), ('v', '#f8'), "
               "('geometry', '#i8'), ('primitive', '#i8'), ('instance', '#i8')]";
    case SAGI_HIT_FLAG: return "[('ray', '#i8'), ('hit', '|b1')]";
    case SAGI_HIT_COUNT: return "[('ray', '#i8'), ('count', '#i8')]";
    case SAGI_HIT_SPAN:
        return "[('ray', '#i8'), ('hit', '|b1'), ('t_enter', '#f8'), ('t_leave', '#f8'), ('length', '#f8'), "
               "('geometry_enter', '#i8'), ('primitive_enter', '#i8'), ('geometry_leave', '#i8'), "
               "('primitive_leave', '#i8'), ('instance', '#i8')]";
    }
    return "";
}

sagi_hit_row sagi_hit_miss(uint64_t ray) {
    const sag_vec3 none = {NAN, NAN, NAN};
    return (sagi_hit_row){.ray = ray,
                          .t = INFINITY,
                          .position = none,
                          .normal = none,
                          .u = NAN,
                          .v = NAN,
                          .geometry = -1,
                          .primitive = -1,
                          .instance = -1};
}

sagi_hit_row sagi_hit_no_span(uint64_t ray) {
    sagi_hit_row row = sagi_hit_miss(ray);
    row.t = row.t_leave = NAN;
    row.geometry_leave = row.primitive_leave = -1;
    return row;
}

static sag_status write_failed(const sagi_hit_table *table, sag_error *error) {
    return sag_error_set_at(error, SAG_ERROR_IO, table->name, 0, 0, "cannot write: %s", strerror(errno));
}

static sag_status write_header(sagi_hit_table *table, sag_error *error) {
    if (!table->is_npy) {
        const char *header = csv_header(table->columns);
        return sagi_hit_table_append(table, header, strlen(header), 0, error);
    }
    char type[400], header[SAGI_NPY_WRITTEN_HEADER];
    size_t length = 0;
    for (const char *p = npy_type(table->columns); *p; p++) {
        type[length++] = *p != '#' ? *p : sagi_is_big_endian() ? '>' : '<';
    }
    type[length] = 0;
    sagi_npy_write_header(header, type, table->row_count);
    return sagi_hit_table_append(table, header, sizeof header, 0, error);
}

static bool ends_in_npy(const char *path) {
    size_t length = strlen(path);
    return length >= 4 && strcmp(path + length - 4, ".npy") == 0;
}

sag_status sagi_hit_table_open(sagi_hit_table *table, const char *path, sagi_hit_columns columns,
                               sag_error *error) {
    *table = (sagi_hit_table){.columns = columns, .is_npy = ends_in_npy(path), .name = path};
    if (strcmp(path, "-") == 0) {
        table->is_stdout = true;
        table->name = "standard output";
        table->output.file = stdout;
    } else {
        sag_status status = sagi_output_open(&table->output, path, error);
        if (status != SAG_OK) return status;
        if (table->is_npy && !table->output.is_temporary) {
            sagi_output_discard(&table->output);
            return sag_error_set_at(error, SAG_ERROR_ARGUMENT, path, 0, 0,
                                    "a .npy table must be a plain file: its header is written last");
        }
    }
    sag_status status = write_header(table, error);
    if (status != SAG_OK) sagi_hit_table_discard(table);
    return status;
}

// What follows the ray's number and the hit.
typedef struct values {
    int number_count, id_count;
    double numbers[MAX_NUMBERS];
    int64_t ids[MAX_IDS];
} values;

static values values_of(sagi_hit_columns columns, const sagi_hit_row *row) {
    switch (columns) {
    case SAGI_HIT_FULL:
        return (values){9,
                        3,
                        {row->t, row->position.x, row->position.y, row->position.z, row->normal.x,
                         row->normal.y, row->normal.z, row->u, row->v},
                        {row->geometry, row->primitive, row->instance}};
    case SAGI_HIT_SPAN:
        return (values){
            3,
            5,
            {row->t, row->t_leave, row->length},
            {row->geometry, row->primitive, row->geometry_leave, row->primitive_leave, row->instance}};
    case SAGI_HIT_FLAG:
    case SAGI_HIT_COUNT: break;
    }
    return (values){0};
}

static size_t encode_csv(sagi_hit_columns columns, const sagi_hit_row *row, char *text) {
    const values v = values_of(columns, row);
    char *p = text;
    p += sagi_format_integer((long long)row->ray, p);
    *p++ = ',';
    if (columns == SAGI_HIT_COUNT) {
        p += sagi_format_integer((long long)row->count, p);
    } else {
        *p++ = row->hit ? '1' : '0';
    }
    for (int i = 0; i < v.number_count; i++) {
        *p++ = ',';
        p += sagi_format_number(v.numbers[i], p);
    }
    for (int i = 0; i < v.id_count; i++) {
        *p++ = ',';
        p += sagi_format_integer(v.ids[i], p);
    }
    *p++ = '\n';
    return (size_t)(p - text);
}

static size_t encode_npy(sagi_hit_columns columns, const sagi_hit_row *row, char *bytes) {
    const values v = values_of(columns, row);
    const size_t number_bytes = (size_t)v.number_count * 8, id_bytes = (size_t)v.id_count * 8;
    const int64_t ray = (int64_t)row->ray, count = (int64_t)row->count;
    char *p = bytes;
    memcpy(p, &ray, 8), p += 8;
    if (columns == SAGI_HIT_COUNT) {
        memcpy(p, &count, 8), p += 8;
    } else {
        *p++ = row->hit;
    }
    memcpy(p, v.numbers, number_bytes), p += number_bytes;
    memcpy(p, v.ids, id_bytes), p += id_bytes;
    return (size_t)(p - bytes);
}

size_t sagi_hit_encode(const sagi_hit_table *table, const sagi_hit_row *row, char *bytes) {
    return table->is_npy ? encode_npy(table->columns, row, bytes) : encode_csv(table->columns, row, bytes);
}

sag_status sagi_hit_table_append(sagi_hit_table *table, const char *bytes, size_t size, uint64_t row_count,
                                 sag_error *error) {
    if (fwrite(bytes, 1, size, table->output.file) != size) return write_failed(table, error);
    table->row_count += row_count;
    return SAG_OK;
}

sag_status sagi_hit_table_flush(sagi_hit_table *table, sag_error *error) {
    return fflush(table->output.file) == 0 ? SAG_OK : write_failed(table, error);
}

sag_status sagi_hit_table_commit(sagi_hit_table *table, sag_error *error) {
    if (table->is_stdout) return sagi_hit_table_flush(table, error);
    if (table->is_npy) {
        sag_status status = fseek(table->output.file, 0, SEEK_SET) == 0 ? write_header(table, error)
                                                                        : write_failed(table, error);
        if (status != SAG_OK) {
            sagi_output_discard(&table->output);
            return status;
        }
    }
    return sagi_output_commit(&table->output, error);
}

void sagi_hit_table_discard(sagi_hit_table *table) {
    if (!table->is_stdout) sagi_output_discard(&table->output);
}
