// SPDX-License-Identifier: MIT
// Between decimal and binary by exact whole-number arithmetic: correctly rounded, the same in every locale,
// and fast enough that a table of millions of rays is limited by the disk.
#ifndef SAGI_FORMATS_DECIMAL_H
#define SAGI_FORMATS_DECIMAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The longest text sagi_format_number writes: -1.2345678901234567e-308.
#define SAGI_NUMBER_BYTES 24

#define SAGI_MAX_DECIMAL_POWER 64
// The leading 128 bits of 5^q (decimal_powers.c).
extern const uint64_t sagi_decimal_powers[2 * (2 * SAGI_MAX_DECIMAL_POWER + 1)];

// The double nearest to whole·10^exponent, ties to even. False, writing nothing, for 0, where |exponent| >
// 64, and next to the middle between two doubles (one in 2⁷⁰): there, and on a machine without 128-bit
// integers, sagi_parse_number finds another way.
bool sagi_decimal_to_double(uint64_t whole, int exponent, double *value);

// Writes the value as printf's "%.17g" does in the C locale, without a zero byte ("nan" has no sign): 17
// digits give the same double when they are read again. Returns the length.
size_t sagi_format_number(double value, char text[SAGI_NUMBER_BYTES]);

// Writes a whole number in decimal, without a zero byte. Returns the length, at most 20.
size_t sagi_format_integer(long long value, char *text);

#endif
