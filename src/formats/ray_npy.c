// SPDX-License-Identifier: MIT
// Rays from a .npy array. In C order the rows follow each other and are read as a stream. In Fortran order
// the columns do, so that a block of rows is as many short stretches of the file: these are read where they
// lie.
#include "formats/ray_reader.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#define ROWS_PER_TASK 4096

static sag_status malformed(const sagi_ray_reader *reader, const char *message, sag_error *error) {
    return sag_error_set_at(error, SAG_ERROR_FORMAT, reader->file, 0, 0, "%s", message);
}

static size_t row_bytes(const sagi_ray_reader *reader) {
    return (size_t)reader->columns * reader->npy.item_bytes;
}

static sag_status too_short(const sagi_ray_reader *reader, uint64_t rows, sag_error *error) {
    return sag_error_set_at(error, SAG_ERROR_FORMAT, reader->file, 0, 0,
                            "the file is cut off: the .npy header says %" PRIu64 " rows, there are %" PRIu64,
                            reader->npy.shape[0], rows);
}

static sag_status check_header(sagi_ray_reader *reader, sag_error *error) {
    const sagi_npy_header *h = &reader->npy;
    if (h->type != 'f' || (h->item_bytes != 8 && h->item_bytes != 4)) {
        return sag_error_set_at(error, SAG_ERROR_FORMAT, reader->file, 0, 0,
                                "the .npy array has elements of type '%c%u'; rays are float64 or float32",
                                h->type, h->item_bytes);
    }
    if (h->dimension_count != 2 || (h->shape[1] != 6 && h->shape[1] != 8)) {
        return malformed(reader,
                         "the .npy array must have the shape (N, 6) or (N, 8): ox,oy,oz,dx,dy,dz[,tmin,tmax]",
                         error);
    }
    reader->columns = (uint32_t)h->shape[1];
    if (h->shape[0] > (UINT64_MAX >> 1) / row_bytes(reader))
        return malformed(reader, "the .npy header says more rows than any file holds", error);
    if (h->fortran_order && !reader->is_regular)
        return malformed(reader, "an array in Fortran order can be read from a file only, not from a pipe",
                         error);
    if (reader->is_regular) {
        const uint64_t size = reader->file_bytes > h->data_offset ? reader->file_bytes - h->data_offset : 0;
        const uint64_t rows = size / row_bytes(reader);
        if (rows < h->shape[0]) return too_short(reader, rows, error);
    }
    return SAG_OK;
}

sag_status sagi_ray_npy_open(sagi_ray_reader *reader, sag_error *error) {
    size_t length = SAGI_NPY_PREFIX_BYTES;
    while (reader->filled < length || (length = sagi_npy_header_length(reader->buffer)) > reader->filled) {
        if (length > SAGI_NPY_MAX_HEADER || reader->at_end)
            return malformed(reader, "the .npy header is damaged or cut off", error);
        sag_status status = sagi_ray_reader_fill(reader, error);
        if (status != SAG_OK) return status;
    }
    sag_status status =
        sagi_npy_read_header(reader->buffer, reader->filled, reader->file, &reader->npy, error);
    if (status == SAG_OK) status = check_header(reader, error);
    if (status != SAG_OK) return status;
    reader->filled -= reader->npy.data_offset;
    memmove(reader->buffer, reader->buffer + reader->npy.data_offset, reader->filled);
    return SAG_OK;
}

typedef struct npy_block {
    sagi_ray_reader *reader;
    size_t row_count;
    const char *problem[SAGI_RAY_BUFFER / 24 / ROWS_PER_TASK + 1]; // of each task's first bad row
    size_t bad_row[SAGI_RAY_BUFFER / 24 / ROWS_PER_TASK + 1];
} npy_block;

static double number_at(const sagi_npy_header *h, const char *bytes) {
    unsigned char b[8] = {0};
    const bool swap = h->big_endian != sagi_is_big_endian();
    for (uint32_t i = 0; i < h->item_bytes; i++)
        b[i] = (unsigned char)bytes[swap ? h->item_bytes - 1 - i : i];
    if (h->item_bytes == 4) {
        float f;
        memcpy(&f, b, 4);
        return f;
    }
    double d;
    memcpy(&d, b, 8);
    return d;
}

static void convert(void *argument, size_t task) {
    npy_block *block = argument;
    const sagi_ray_reader *reader = block->reader;
    const size_t columns = reader->columns, item = reader->npy.item_bytes;
    const size_t column_step = reader->npy.fortran_order ? block->row_count * item : item;
    const size_t row_step = reader->npy.fortran_order ? item : columns * item;
    size_t last = (task + 1) * ROWS_PER_TASK;
    if (last > block->row_count) last = block->row_count;
    for (size_t row = task * ROWS_PER_TASK; row < last; row++) {
        double numbers[SAGI_RAY_COLUMNS] = {[7] = INFINITY};
        for (size_t c = 0; c < columns; c++)
            numbers[c] = number_at(&reader->npy, reader->buffer + row * row_step + c * column_step);
        int which;
        block->problem[task] = sagi_ray_from_numbers(numbers, &reader->rays[row], &which);
        block->bad_row[task] = row;
        if (block->problem[task]) return;
    }
}

// The rows' part of each column, one after another into the buffer.
static sag_status read_columns(sagi_ray_reader *reader, size_t rows, sag_error *error) {
    const size_t item = reader->npy.item_bytes;
    for (size_t c = 0; c < reader->columns; c++) {
        const uint64_t start =
            reader->npy.data_offset + (c * reader->npy.shape[0] + reader->rows_done) * item;
        for (size_t done = 0; done < rows * item;) {
            ssize_t got = pread(reader->descriptor, reader->buffer + c * rows * item + done,
                                rows * item - done, (off_t)(start + done));
            if (got < 0 && errno == EINTR) continue;
            if (got < 0)
                return sag_error_set_at(error, SAG_ERROR_IO, reader->file, 0, 0, "cannot read: %s",
                                        strerror(errno));
            if (got == 0) return too_short(reader, reader->rows_done, error);
            done += (size_t)got;
        }
    }
    return SAG_OK;
}

// So many whole rows, in the buffer.
static sag_status read_rows(sagi_ray_reader *reader, size_t *rows, sag_error *error) {
    const uint64_t left = reader->npy.shape[0] - reader->rows_done;
    *rows = 0;
    if (reader->npy.fortran_order) {
        *rows = SAGI_RAY_BUFFER / row_bytes(reader);
        if (*rows > left) *rows = (size_t)left;
        return read_columns(reader, *rows, error);
    }
    while (reader->filled < row_bytes(reader) && left > 0) {
        if (reader->at_end) return too_short(reader, reader->rows_done, error);
        sag_status status = sagi_ray_reader_fill(reader, error);
        if (status != SAG_OK) return status;
    }
    *rows = reader->filled / row_bytes(reader);
    if (*rows > left) *rows = (size_t)left;
    return SAG_OK;
}

sag_status sagi_ray_npy_next(sagi_ray_reader *reader, size_t *count, sag_error *error) {
    size_t rows;
    sag_status status = read_rows(reader, &rows, error);
    if (status == SAG_OK) status = sagi_ray_reader_reserve(reader, rows, error);
    if (status != SAG_OK) return status;
    npy_block block = {.reader = reader, .row_count = rows};
    const size_t tasks = (rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    sag_parallel_for(reader->context, tasks, convert, &block);
    for (size_t i = 0; i < tasks; i++) {
        if (!block.problem[i]) continue;
        return sag_error_set_at(error, SAG_ERROR_FORMAT, reader->file, 0, 0,
                                "row %" PRIu64 " (the first is 0): %s", reader->rows_done + block.bad_row[i],
                                block.problem[i]);
    }
    if (!reader->npy.fortran_order) {
        const size_t used = rows * row_bytes(reader);
        reader->filled -= used;
        memmove(reader->buffer, reader->buffer + used, reader->filled);
    }
    reader->rows_done += rows;
    *count = rows;
    return SAG_OK;
}
