// SPDX-License-Identifier: MIT
// A 64-bit checksum of bytes: XXH64 with seed 0 (checksum.c).
#ifndef SAGI_BASE_CHECKSUM_H
#define SAGI_BASE_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

// The same for the same bytes on every machine, of whatever byte order.
uint64_t sagi_checksum(const void *data, size_t bytes);

#endif
