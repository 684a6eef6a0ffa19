// SPDX-License-Identifier: MIT
// Reading and writing the header of .npy files. The literal is read by a parser for the three keys NumPy
// writes, in any order and spacing; nothing is evaluated.
#include "formats/npy.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

bool sagi_is_big_endian(void) {
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

size_t sagi_npy_header_length(const char *bytes) {
    const unsigned char *b = (const unsigned char *)bytes;
    if (memcmp(bytes, SAGI_NPY_MAGIC, SAGI_NPY_MAGIC_BYTES) != 0) return 0;
    if (b[6] == 1) return 10 + (size_t)b[8] + ((size_t)b[9] << 8);
    if (b[6] == 2 || b[6] == 3) {
        return 12 + (size_t)b[8] + ((size_t)b[9] << 8) + ((size_t)b[10] << 16) + ((size_t)b[11] << 24);
    }
    return 0;
}

// The literal as it is read.
typedef struct cursor {
    const char *p, *end;
} cursor;

static void skip_blanks(cursor *c) {
    while (c->p < c->end && (*c->p == ' ' || *c->p == '\t' || *c->p == '\n' || *c->p == '\r')) c->p++;
}

static bool take(cursor *c, char wanted) {
    skip_blanks(c);
    if (c->p == c->end || *c->p != wanted) return false;
    c->p++;
    return true;
}

static bool take_word(cursor *c, const char *word) {
    skip_blanks(c);
    size_t length = strlen(word);
    if ((size_t)(c->end - c->p) < length || memcmp(c->p, word, length) != 0) return false;
    c->p += length;
    return true;
}

static bool take_string(cursor *c, char *text, size_t capacity) {
    skip_blanks(c);
    if (c->p == c->end || (*c->p != '\'' && *c->p != '"')) return false;
    char quote = *c->p++;
    size_t length = 0;
    while (c->p < c->end && *c->p != quote) {
        if (length + 1 >= capacity) return false;
        text[length++] = *c->p++;
    }
    if (c->p == c->end) return false;
    c->p++;
    text[length] = 0;
    return true;
}

static bool take_count(cursor *c, uint64_t *value) {
    skip_blanks(c);
    const char *start = c->p;
    uint64_t n = 0;
    for (; c->p < c->end && *c->p >= '0' && *c->p <= '9'; c->p++) {
        uint64_t digit = (uint64_t)(*c->p - '0');
        if (n > (UINT64_MAX - digit) / 10) return false;
        n = n * 10 + digit;
    }
    if (c->p < c->end && *c->p == 'L') c->p++; // as Python 2 wrote it
    *value = n;
    return c->p > start;
}

static bool take_shape(cursor *c, sagi_npy_header *h) {
    if (!take(c, '(')) return false;
    while (!take(c, ')')) {
        if (h->dimension_count == SAGI_NPY_MAX_DIMENSIONS) return false;
        if (!take_count(c, &h->shape[h->dimension_count++])) return false;
        if (!take(c, ',')) return take(c, ')');
    }
    return true;
}

// "<f8": byte order, kind, bytes.
static bool read_type(const char *text, sagi_npy_header *h) {
    if (!strchr("<>|=", text[0]) || !text[0] || !text[1]) return false;
    h->big_endian = text[0] == '>' || (text[0] == '=' && sagi_is_big_endian());
    h->type = text[1];
    cursor digits = {text + 2, text + strlen(text)};
    uint64_t bytes = 0;
    if (!take_count(&digits, &bytes) || digits.p != digits.end || bytes == 0 || bytes > 1024) return false;
    h->item_bytes = (uint32_t)bytes;
    return true;
}

sag_status sagi_npy_read_header(const char *bytes, size_t length, const char *file, sagi_npy_header *header,
                                sag_error *error) {
    size_t whole = length >= SAGI_NPY_PREFIX_BYTES ? sagi_npy_header_length(bytes) : 0;
    if (whole == 0 || whole > length) {
        return sag_error_set_at(error, SAG_ERROR_FORMAT, file, 0, 0,
                                "the .npy header is damaged or of a version that is not known");
    }
    sagi_npy_header h = {.data_offset = whole};
    cursor c = {bytes + (bytes[6] == 1 ? 10 : 12), bytes + whole};
    bool has_type = false, has_order = false, has_shape = false, good = take(&c, '{');
    while (good && !take(&c, '}')) {
        char key[32], type[64];
        good = take_string(&c, key, sizeof key) && take(&c, ':');
        if (!good) break;
        if (strcmp(key, "descr") == 0) {
            skip_blanks(&c);
            if (c.p < c.end && *c.p == '[') {
                return sag_error_set_at(error, SAG_ERROR_FORMAT, file, 0, 0,
                                        "the .npy array is structured; it must hold plain numbers");
            }
            good = !has_type && take_string(&c, type, sizeof type) && read_type(type, &h);
            has_type = true;
        } else if (strcmp(key, "fortran_order") == 0) {
            h.fortran_order = take_word(&c, "True");
            good = !has_order && (h.fortran_order || take_word(&c, "False"));
            has_order = true;
        } else {
            good = strcmp(key, "shape") == 0 && !has_shape && take_shape(&c, &h);
            has_shape = true;
        }
        if (good && !take(&c, ',')) {
            good = take(&c, '}');
            break;
        }
    }
    if (!good || !has_type || !has_order || !has_shape) {
        return sag_error_set_at(error, SAG_ERROR_FORMAT, file, 0, 0,
                                "the .npy header is malformed at byte %zu", (size_t)(c.p - bytes));
    }
    *header = h;
    return SAG_OK;
}

void sagi_npy_write_header(char bytes[SAGI_NPY_WRITTEN_HEADER], const char *descr, uint64_t rows) {
    static const size_t prefix = 10;
    char text[SAGI_NPY_WRITTEN_HEADER];
    int length = snprintf(text, sizeof text,
                          "{'descr': %s, 'fortran_order': False, 'shape': (%" PRIu64 ",), }", descr, rows);
    const size_t room = SAGI_NPY_WRITTEN_HEADER - prefix;
    memset(bytes, ' ', SAGI_NPY_WRITTEN_HEADER);
    memcpy(bytes, SAGI_NPY_MAGIC "\x01", 7); // version 1.0
    bytes[7] = 0;
    bytes[8] = (char)(room & 0xFF);
    bytes[9] = (char)(room >> 8);
    memcpy(bytes + prefix, text, length > 0 && (size_t)length < room ? (size_t)length : room - 1);
    bytes[SAGI_NPY_WRITTEN_HEADER - 1] = '\n';
}
