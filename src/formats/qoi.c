// SPDX-License-Identifier: MIT
// QOI, the "quite OK image format" (qoiformat.org, version 1.0), reading only. Behind a header of 14 bytes
// (the magic, width and height with the high byte first, channels, colour space) each pixel is said by one
// of:
//   0xFE r g b, 0xFF r g b a     itself
//   00iiiiii                     the pixel last seen of hash i
//   01rrggbb                     the one before plus small differences, −2 … 1
//   10gggggg rrrrbbbb            plus a green difference −32 … 31, red and blue −8 … 7 beyond that
//   11nnnnnn                     the one before, n + 1 times more, n < 62
// Bytes wrap around. Seven 0 and a 1 end the file.
#include "formats/image.h"

#include <string.h>

#define HEADER_BYTES 14

typedef struct pixel {
    uint8_t r, g, b, a;
} pixel;

typedef struct reader {
    const uint8_t *at, *end;
    pixel seen[64], last;
    uint32_t run; // how many more pixels are the last one
} reader;

static uint32_t big_endian(const uint8_t *p) {
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static pixel changed(pixel p, int r, int g, int b) {
    return (pixel){(uint8_t)(p.r + r), (uint8_t)(p.g + g), (uint8_t)(p.b + b), p.a};
}

// The next pixel. False when the file is cut short.
static bool next_pixel(reader *r) {
    if (r->run > 0) {
        r->run--;
        return true;
    }
    if (r->at == r->end) return false;
    const uint8_t tag = *r->at++;
    const int low = tag & 63;
    const size_t more = tag == 0xFE ? 3 : tag == 0xFF ? 4 : tag >> 6 == 2 ? 1 : 0;
    if ((size_t)(r->end - r->at) < more) return false;
    const uint8_t *in = r->at;
    r->at += more;
    if (more >= 3)
        r->last = (pixel){in[0], in[1], in[2], more == 4 ? in[3] : r->last.a};
    else if (tag >> 6 == 0)
        r->last = r->seen[low];
    else if (tag >> 6 == 1)
        r->last = changed(r->last, (low >> 4) - 2, (low >> 2 & 3) - 2, (low & 3) - 2);
    else if (tag >> 6 == 2)
        r->last = changed(r->last, low - 32 + (in[0] >> 4) - 8, low - 32, low - 32 + (in[0] & 15) - 8);
    else
        r->run = (uint32_t)low;
    const pixel p = r->last;
    r->seen[(p.r * 3 + p.g * 5 + p.b * 7 + p.a * 11) % 64] = p;
    return true;
}

sag_status sagi_qoi_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    const uint8_t *header = source->bytes;
    if (source->size < HEADER_BYTES + 8)
        return sagi_image_damaged(source, error, "QOI", "the file is cut short");
    const uint32_t channels = header[12];
    if ((channels != 3 && channels != 4) || header[13] > 1)
        return sagi_image_damaged(source, error, "QOI", "its header names no known layout");
    const sag_encoding encoding = header[13] == 1 ? SAG_ENCODING_LINEAR : SAG_ENCODING_SRGB;
    const sag_status status = sagi_image_create_for(source, big_endian(header + 4), big_endian(header + 8),
                                                    channels, 8, 62, "QOI", image, error);
    if (status != SAG_OK) return status;
    if (source->kept) source->kept->encoding = encoding;
    sagi_image_source as_it_says = *source;
    if (source->encoding == SAG_ENCODING_DEFAULT) as_it_says.encoding = encoding;
    const size_t row_bytes = (size_t)image->width * channels;
    uint8_t *row = sag_allocate(source->context, row_bytes);
    if (!row) return sag_error_set_at(error, SAG_ERROR_MEMORY, source->path, 0, 0, "out of memory");
    reader r = {.at = header + HEADER_BYTES, .end = header + source->size - 8, .last = {0, 0, 0, 255}};
    bool complete = true;
    for (uint32_t y = 0; y < image->height && complete; y++) {
        for (uint32_t x = 0; x < image->width && complete; x++) {
            complete = next_pixel(&r);
            memcpy(row + (size_t)x * channels, &r.last, channels);
        }
        if (complete) sagi_image_decode_row(&as_it_says, row, 8, y, image);
    }
    sag_release(source->context, row, row_bytes);
    return complete ? SAG_OK : sagi_image_damaged(source, error, "QOI", "the file is cut short");
}
