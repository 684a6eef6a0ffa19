// SPDX-License-Identifier: MIT
// The header of NumPy's .npy files (NEP 1): magic, version, length, and a Python literal such as
// {'descr': '<f8', 'fortran_order': False, 'shape': (1000, 6), }
#ifndef SAGI_FORMATS_NPY_H
#define SAGI_FORMATS_NPY_H

#include <sagitta/base.h>

#define SAGI_NPY_MAGIC          "\x93NUMPY"
#define SAGI_NPY_MAGIC_BYTES    6
#define SAGI_NPY_PREFIX_BYTES   12    // magic, version and the longer form of the length
#define SAGI_NPY_MAX_HEADER     65536 // more is taken for damage
#define SAGI_NPY_MAX_DIMENSIONS 4
#define SAGI_NPY_WRITTEN_HEADER 512 // what sagi_npy_write_header writes, always

typedef struct sagi_npy_header {
    size_t data_offset; // where the numbers begin
    char type;          // 'f': floating point, 'i', 'u' …
    uint32_t item_bytes;
    bool big_endian;
    bool fortran_order; // the first index runs fastest
    uint32_t dimension_count;
    uint64_t shape[SAGI_NPY_MAX_DIMENSIONS];
} sagi_npy_header;

// The whole length of the header, from its first SAGI_NPY_PREFIX_BYTES bytes; 0 when they are no such header.
size_t sagi_npy_header_length(const char *bytes);

// Reads a header of which all bytes are there. SAG_ERROR_FORMAT, naming the file, for anything but an array
// of plain numbers; *header is then untouched.
sag_status sagi_npy_read_header(const char *bytes, size_t length, const char *file, sagi_npy_header *header,
                                sag_error *error);

// Writes a header for a one-dimensional array of `rows` elements, padded so that its length does not depend
// on the count: it can be written again when the count is known. `descr` is the element type as a Python
// literal, of at most 400 bytes.
void sagi_npy_write_header(char bytes[SAGI_NPY_WRITTEN_HEADER], const char *descr, uint64_t rows);

// Whether this machine's numbers begin with their high byte.
bool sagi_is_big_endian(void);

#endif
