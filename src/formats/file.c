// SPDX-License-Identifier: MIT
// Reading whole files. A plain file is mapped: nothing is copied, and what a reader never looks at is never
// read, so a gigabyte of something foreign costs one page. Pipes are read to their end; gzip data (RFC 1952,
// also several members one after the other) are inflated into memory that doubles as it fills.
#include "formats/file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#define ZLIB_CONST
#include <zlib.h>

static sag_status fail_io(sag_error *error, const char *path, int reason) {
    return sag_error_set_at(error, SAG_ERROR_IO, path, 0, 0, "cannot read: %s", strerror(reason));
}

// Bytes that grow.
typedef struct buffer {
    const sag_context *context;
    uint8_t *bytes;
    size_t size, allocated;
} buffer;

static bool buffer_grow(buffer *b) {
    const size_t larger = b->allocated ? 2 * b->allocated : (size_t)1 << 16;
    uint8_t *bytes = sag_allocate(b->context, larger);
    if (!bytes) return false;
    if (b->size) memcpy(bytes, b->bytes, b->size);
    sag_release(b->context, b->bytes, b->allocated);
    b->bytes = bytes;
    b->allocated = larger;
    return true;
}

static void file_from_buffer(sagi_file *file, const buffer *b) {
    file->memory = b->bytes;
    file->bytes = b->bytes ? b->bytes : (const uint8_t *)"";
    file->size = b->size;
    file->allocated = b->allocated;
}

static sag_status read_stream(const char *path, int descriptor, sagi_file *file, sag_error *error) {
    buffer b = {.context = file->context};
    for (;;) {
        if (b.size == b.allocated && !buffer_grow(&b)) {
            sag_release(b.context, b.bytes, b.allocated);
            return sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0, "out of memory reading the file");
        }
        const ssize_t got = read(descriptor, b.bytes + b.size, b.allocated - b.size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            const int reason = errno;
            sag_release(b.context, b.bytes, b.allocated);
            return fail_io(error, path, reason);
        }
        if (got == 0) break;
        b.size += (size_t)got;
    }
    file_from_buffer(file, &b);
    return SAG_OK;
}

// The size that the end of gzip data claims, if there is one member and it is not a lie: memory to begin
// with.
static size_t claimed_size(const sagi_file *file, size_t most) {
    if (file->size < 18) return 0;
    const uint8_t *p = file->bytes + file->size - 4;
    const size_t claim = (size_t)p[0] | (size_t)p[1] << 8 | (size_t)p[2] << 16 | (size_t)p[3] << 24;
    return claim >= file->size && claim < most ? claim + 1 : 0;
}

// Whether so much has come out of so little that the file is refused without waiting for all of it: beyond
// what is common, several times as much as of a whole file, for some parts are all the same.
static bool is_bomb(size_t inflated, size_t consumed) {
    return inflated > SAGI_SMALL_INFLATED_BYTES &&
           (inflated - SAGI_SMALL_INFLATED_BYTES) / 4 / SAGI_MAX_INFLATION > consumed;
}

// Inflates into b until the data end. Returns zlib's code: Z_STREAM_END when all went well.
static int inflate_all(z_stream *stream, const uint8_t *bytes, size_t size, size_t most, buffer *b) {
    const uint8_t *next = bytes;
    const uint8_t *const end = bytes + size;
    int code = Z_OK;
    for (;;) {
        if (b->size == b->allocated) {
            if (b->size >= most || is_bomb(b->size, (size_t)(next - bytes))) return Z_STREAM_ERROR;
            if (!buffer_grow(b)) return Z_MEM_ERROR;
        }
        const size_t left = (size_t)(end - next), room = b->allocated - b->size;
        stream->next_in = next;
        stream->avail_in = left > 1u << 30 ? 1u << 30 : (uInt)left;
        stream->next_out = b->bytes + b->size;
        stream->avail_out = room > 1u << 24 ? 1u << 24 : (uInt)room;
        code = inflate(stream, Z_NO_FLUSH);
        next = stream->next_in;
        b->size = (size_t)(stream->next_out - b->bytes);
        if (code == Z_STREAM_END && b->size > most) return Z_STREAM_ERROR;
        if (code == Z_STREAM_END) {
            // Another member may follow; anything else behind the end is padding and ignored, as gzip does.
            if (end - next < 2 || next[0] != 0x1f || next[1] != 0x8b) return Z_STREAM_END;
            code = inflateReset(stream);
        }
        if (is_bomb(b->size, (size_t)(next - bytes))) return Z_STREAM_ERROR;
        if (code == Z_BUF_ERROR && stream->avail_out == 0) code = Z_OK;
        if (code != Z_OK) return code;
    }
}

static sag_status inflate_file(const char *path, sagi_file *file, sag_error *error) {
    z_stream stream = {0};
    if (inflateInit2(&stream, 15 + 16) != Z_OK)
        return sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0, "out of memory inflating the file");
    buffer b = {.context = file->context};
    const size_t least = SAGI_MAX_INFLATION < SAGI_MAX_INFLATED_BYTES / (file->size + 1)
                             ? SAGI_MAX_INFLATION * file->size + SAGI_SMALL_INFLATED_BYTES
                             : SAGI_MAX_INFLATED_BYTES;
    const size_t most = least < SAGI_MAX_INFLATED_BYTES ? least : SAGI_MAX_INFLATED_BYTES;
    b.allocated = claimed_size(file, most);
    b.bytes = b.allocated ? sag_allocate(b.context, b.allocated) : NULL;
    if (!b.bytes) b.allocated = 0;
    const int code = inflate_all(&stream, file->bytes, file->size, most, &b);
    inflateEnd(&stream);
    if (code == Z_STREAM_END) {
        sagi_file whole = {.context = file->context};
        file_from_buffer(&whole, &b);
        sagi_file_close(file);
        *file = whole;
        return SAG_OK;
    }
    sag_release(b.context, b.bytes, b.allocated);
    if (code == Z_MEM_ERROR)
        return sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0,
                                "out of memory inflating the file (over %zu bytes)", b.size);
    if (code == Z_STREAM_ERROR)
        return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0,
                                "gzip data of %zu bytes that inflate to %zu and more: no scene does",
                                file->size, b.size);
    return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0, "gzip data %s after %zu bytes",
                            code == Z_BUF_ERROR ? "end too soon" : "are damaged", b.size);
}

sag_status sagi_file_open(const sag_context *context, const char *path, sagi_file *file, sag_error *error) {
    *file = (sagi_file){.context = context};
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return fail_io(error, path, errno);
    struct stat status;
    sag_status result = SAG_OK;
    if (fstat(descriptor, &status) != 0) {
        result = fail_io(error, path, errno);
    } else if (S_ISDIR(status.st_mode)) {
        result = fail_io(error, path, EISDIR);
    } else if (!S_ISREG(status.st_mode)) {
        result = read_stream(path, descriptor, file, error);
    } else if (status.st_size == 0) {
        file->bytes = (const uint8_t *)"";
    } else if ((uintmax_t)status.st_size > PTRDIFF_MAX) {
        result = fail_io(error, path, EFBIG);
    } else {
        void *memory = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
        if (memory == MAP_FAILED) {
            result = fail_io(error, path, errno);
        } else {
            file->memory = memory;
            file->bytes = memory;
            file->size = (size_t)status.st_size;
        }
    }
    close(descriptor);
    if (result == SAG_OK && file->size >= 2 && file->bytes[0] == 0x1f && file->bytes[1] == 0x8b)
        result = inflate_file(path, file, error);
    if (result != SAG_OK) sagi_file_close(file);
    return result;
}

void sagi_file_close(sagi_file *file) {
    if (file->allocated) {
        sag_release(file->context, file->memory, file->allocated);
    } else if (file->memory) {
        munmap(file->memory, file->size);
    }
    *file = (sagi_file){0};
}
