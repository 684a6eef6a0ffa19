// SPDX-License-Identifier: MIT
// The ray reader's frame: a file or pipe, a buffer of its bytes, and blocks of rays handed out one after
// another.
#include "formats/ray_table.h"

#include "formats/ray_reader.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static sag_status io_error(const sagi_ray_reader *reader, const char *what, sag_error *error) {
    return sag_error_set_at(error, SAG_ERROR_IO, reader->file, 0, 0, "%s: %s", what, strerror(errno));
}

// Whether reading now would not wait.
static bool is_waiting(int descriptor) {
    struct pollfd p = {.fd = descriptor, .events = POLLIN};
    return poll(&p, 1, 0) > 0;
}

sag_status sagi_ray_reader_fill(sagi_ray_reader *reader, sag_error *error) {
    const size_t before = reader->filled;
    while (!reader->at_end && reader->filled < SAGI_RAY_BUFFER) {
        if (!reader->is_regular && reader->filled > before && !is_waiting(reader->descriptor)) break;
        ssize_t got =
            read(reader->descriptor, reader->buffer + reader->filled, SAGI_RAY_BUFFER - reader->filled);
        if (got < 0 && errno == EINTR) {
            if (!reader->stop || !*reader->stop) continue;
            return sag_error_set_at(error, SAG_ERROR_CANCELLED, reader->file, 0, 0, "interrupted");
        }
        if (got < 0) return io_error(reader, "cannot read", error);
        if (got == 0) reader->at_end = true;
        reader->filled += (size_t)got;
        reader->read_bytes += (uint64_t)got;
    }
    return SAG_OK;
}

sag_status sagi_ray_reader_reserve(sagi_ray_reader *reader, size_t count, sag_error *error) {
    if (count <= reader->capacity) return SAG_OK;
    sag_release(reader->context, reader->rays, reader->capacity * sizeof *reader->rays);
    reader->capacity = 0;
    reader->rays = sag_allocate(reader->context, count * sizeof *reader->rays);
    if (!reader->rays) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for %zu rays", count);
    reader->capacity = count;
    return SAG_OK;
}

const char *sagi_ray_from_numbers(const double n[SAGI_RAY_COLUMNS], sag_ray *ray, int *which) {
    static const char *const nan_names[SAGI_RAY_COLUMNS] = {"ox is NaN",   "oy is NaN",  "oz is NaN",
                                                            "dx is NaN",   "dy is NaN",  "dz is NaN",
                                                            "tmin is NaN", "tmax is NaN"};
    for (*which = 0; *which < SAGI_RAY_COLUMNS; ++*which) {
        if (isnan(n[*which])) return nan_names[*which];
        if (*which < 6 && isinf(n[*which]))
            return *which < 3 ? "the origin is infinite" : "the direction is infinite";
    }
    *which = 3;
    if (n[3] == 0 && n[4] == 0 && n[5] == 0) return "the direction is zero";
    *which = 6;
    if (n[6] > n[7]) return "tmin is greater than tmax";
    *ray = (sag_ray){
        .origin = {n[0], n[1], n[2]}, .direction = {n[3], n[4], n[5]}, .t_min = n[6], .t_max = n[7]};
    return NULL;
}

static sag_status open_file(sagi_ray_reader *reader, const char *path, sag_error *error) {
    reader->path_bytes = strlen(path) + 1;
    reader->path = sag_allocate(reader->context, reader->path_bytes);
    reader->buffer = sag_allocate(reader->context, SAGI_RAY_BUFFER);
    if (!reader->path || !reader->buffer)
        return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for the rays");
    memcpy(reader->path, path, reader->path_bytes);
    const bool is_stdin = strcmp(path, "-") == 0;
    reader->file = is_stdin ? "standard input" : reader->path;
    reader->descriptor = is_stdin ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    struct stat status;
    if (reader->descriptor < 0 || fstat(reader->descriptor, &status) != 0)
        return io_error(reader, "cannot open", error);
    if (S_ISDIR(status.st_mode)) {
        errno = EISDIR;
        return io_error(reader, "cannot open", error);
    }
    // A standard input that somebody has read from already is taken as a pipe: its size says nothing.
    reader->is_regular = S_ISREG(status.st_mode) && (!is_stdin || lseek(STDIN_FILENO, 0, SEEK_CUR) == 0);
    reader->file_bytes = reader->is_regular ? (uint64_t)status.st_size : 0;
    // The first bytes tell what it is; a pipe may hand them over one at a time.
    while (!reader->at_end && reader->filled < SAGI_NPY_MAGIC_BYTES &&
           memcmp(reader->buffer, SAGI_NPY_MAGIC, reader->filled) == 0) {
        sag_status filled = sagi_ray_reader_fill(reader, error);
        if (filled != SAG_OK) return filled;
    }
    reader->is_npy = reader->filled >= SAGI_NPY_MAGIC_BYTES &&
                     memcmp(reader->buffer, SAGI_NPY_MAGIC, SAGI_NPY_MAGIC_BYTES) == 0;
    return reader->is_npy ? sagi_ray_npy_open(reader, error) : SAG_OK;
}

sag_status sagi_ray_reader_open(const sag_context *context, const char *path, sagi_ray_reader **reader,
                                sag_error *error) {
    sagi_ray_reader *r = sag_allocate(context, sizeof *r);
    if (!r) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for the rays");
    *r = (sagi_ray_reader){.context = context, .descriptor = -1};
    sag_status status = open_file(r, path, error);
    if (status != SAG_OK) {
        sagi_ray_reader_close(r);
        return status;
    }
    *reader = r;
    return SAG_OK;
}

void sagi_ray_reader_set_stop(sagi_ray_reader *reader, const volatile sig_atomic_t *stop) {
    reader->stop = stop;
}

sag_status sagi_ray_reader_next(sagi_ray_reader *reader, const sag_ray **rays, size_t *count,
                                sag_error *error) {
    size_t found = 0;
    sag_status status =
        reader->is_npy ? sagi_ray_npy_next(reader, &found, error) : sagi_ray_csv_next(reader, &found, error);
    if (status != SAG_OK) return status;
    *rays = reader->rays;
    *count = found;
    return SAG_OK;
}

double sagi_ray_reader_fraction(const sagi_ray_reader *reader) {
    if (reader->is_npy && reader->npy.shape[0] > 0)
        return (double)reader->rows_done / (double)reader->npy.shape[0];
    if (!reader->is_regular) return NAN;
    if (reader->file_bytes == 0) return 1;
    return fmin(1, (double)(reader->read_bytes - reader->filled) / (double)reader->file_bytes);
}

void sagi_ray_reader_close(sagi_ray_reader *reader) {
    if (!reader) return;
    if (reader->descriptor >= 0 && reader->file == reader->path) close(reader->descriptor);
    sag_release(reader->context, reader->rays, reader->capacity * sizeof *reader->rays);
    sag_release(reader->context, reader->buffer, SAGI_RAY_BUFFER);
    sag_release(reader->context, reader->path, reader->path_bytes);
    sag_release(reader->context, reader, sizeof *reader);
}
