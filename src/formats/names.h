// SPDX-License-Identifier: MIT
// A map from names to numbers: what a scene file calls its materials, textures, objects.
#ifndef SAGI_FORMATS_NAMES_H
#define SAGI_FORMATS_NAMES_H

#include <sagitta/base.h>
#include <string.h>

// A piece of text that lives elsewhere; no zero byte ends it.
typedef struct sagi_slice {
    const char *text;
    size_t length;
} sagi_slice;

// In line: a word is looked for among many, and most differ in their first letter.
static inline bool sagi_slice_is(sagi_slice slice, const char *text) {
    if (slice.length == 0 || slice.text[0] != text[0]) return slice.length == 0 && text[0] == '\0';
    return strlen(text) == slice.length && memcmp(slice.text, text, slice.length) == 0;
}

// Zero-initialised but for the context: empty.
typedef struct sagi_names {
    const sag_context *context;
    struct sagi_name *slots; // open addressing, at most half full
    size_t slot_count, name_count;
} sagi_names;

// Gives a name (copied) a value, in place of the one it had. False when memory is short.
bool sagi_names_set(sagi_names *names, sagi_slice name, uint32_t value);
// Whether the name has a value, written to *value (which may be NULL).
bool sagi_names_get(const sagi_names *names, sagi_slice name, uint32_t *value);
void sagi_names_clear(sagi_names *names);

#endif
