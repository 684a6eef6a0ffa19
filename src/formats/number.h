// SPDX-License-Identifier: MIT
// Decimal numbers in text, the same on every machine and in every locale.
#ifndef SAGI_FORMATS_NUMBER_H
#define SAGI_FORMATS_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

// Reads a number at `begin`, not looking at or beyond `end`: [+-] digits [. digits] [e [+-] digits], or nan,
// inf, infinity in any case. The value is the double nearest to what is written (ties to even), exactly what
// strtod gives in the C locale; too large becomes ±infinity. Returns the first place behind it, NULL when
// there is no number.
const char *sagi_parse_number(const char *begin, const char *end, double *value);

// Reads [+-] digits. NULL when there is no integer, or one outside int64_t.
const char *sagi_parse_integer(const char *begin, const char *end, int64_t *value);

#endif
