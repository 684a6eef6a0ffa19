// SPDX-License-Identifier: MIT
// Rays from a table, block by block: however long the table, the memory stays the same.
//
// A table is CSV or a NumPy .npy array; which of the two is told by its first bytes.
//
// CSV: a ray a line, `ox,oy,oz,dx,dy,dz[,tmin,tmax]`. Columns are separated by a comma, a semicolon or
// blanks. A first line of these names (in any order; x, y, z also mean ox, oy, oz) says which column is
// which. Blank lines and what follows a # are passed over; lines end in \n or \r\n; a byte order mark is
// allowed. .npy: N×6 or N×8 numbers of 4 or 8 bytes, either byte order, C or Fortran order (the latter from a
// file only).
//
// Without tmin and tmax a ray reaches from 0 to infinity. A number that is NaN, an infinite origin or
// direction, a zero direction and tmin > tmax are errors that say where: so a ray that comes out of here is
// valid.
#ifndef SAGI_FORMATS_RAY_TABLE_H
#define SAGI_FORMATS_RAY_TABLE_H

#include <sagitta/math.h>
#include <signal.h>

typedef struct sagi_ray_reader sagi_ray_reader;

// Opens a table; "-" is the standard input. SAG_ERROR_IO, SAG_ERROR_FORMAT (a damaged .npy header) or
// SAG_ERROR_MEMORY; *reader is written on SAG_OK only. The context must outlive the reader.
sag_status sagi_ray_reader_open(const sag_context *context, const char *path, sagi_ray_reader **reader,
                                sag_error *error);

// The next block: *rays points to *count of them, good until the next call; *count is 0 at the end of the
// table. Reading from a pipe gives what is there rather than waiting for more. Parses on the context's
// threads; one thread at a time may call.
sag_status sagi_ray_reader_next(sagi_ray_reader *reader, const sag_ray **rays, size_t *count,
                                sag_error *error);

// How much of the table has been read, 0 … 1; NAN when its size is not known (a pipe).
double sagi_ray_reader_fraction(const sagi_ray_reader *reader);

// When a signal interrupts a wait for input, *stop tells whether to give up (SAG_ERROR_CANCELLED) or to go
// on.
void sagi_ray_reader_set_stop(sagi_ray_reader *reader, const volatile sig_atomic_t *stop);

// Closes the table and frees the reader. NULL does nothing.
void sagi_ray_reader_close(sagi_ray_reader *reader);

#endif
