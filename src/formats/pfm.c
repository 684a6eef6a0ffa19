// SPDX-License-Identifier: MIT
// PFM, the portable float map: "PF" (RGB) or "Pf" (grey), width, height, a scale whose sign tells the byte
// order (negative: little-endian), one white-space byte, then rows of 32-bit floats from the bottom up. It
// has no word for a colour space: what is read is taken for linear sRGB, and what is written becomes it, as
// with pbrt-v4.
#include "formats/image.h"

#include "formats/number.h"
#include "render/colorspace.h"

#include <math.h>
#include <string.h>

static bool is_space(uint8_t c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// The next word of the header as a number; false at the end or for something else.
static bool next_number(const sagi_image_source *source, size_t *position, double *value) {
    size_t i = *position;
    while (i < source->size && is_space(source->bytes[i])) i++;
    const char *begin = (const char *)source->bytes + i, *end = (const char *)source->bytes + source->size;
    const char *stop = sagi_parse_number(begin, end, value);
    if (!stop) return false;
    *position = (size_t)(stop - (const char *)source->bytes);
    return true;
}

sag_status sagi_pfm_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    const uint32_t channels = source->bytes[1] == 'F' ? 3 : 1;
    size_t at = 2;
    double width, height, scale;
    if (!next_number(source, &at, &width) || !next_number(source, &at, &height) ||
        !next_number(source, &at, &scale) || at >= source->size || !is_space(source->bytes[at]))
        return sagi_image_damaged(source, error, "PFM", "width, height and scale expected after the magic");
    at++;
    if (!(width >= 1 && width <= SAG_MAX_IMAGE_SIZE && height >= 1 && height <= SAG_MAX_IMAGE_SIZE))
        return sagi_image_damaged(source, error, "PFM", "width or height out of range");
    const size_t row_bytes = (size_t)width * channels * 4, rows = (size_t)height;
    if ((source->size - at) / row_bytes < rows)
        return sagi_image_damaged(source, error, "PFM", "the file is cut short");
    const sag_status status =
        sagi_image_create_for(source, (uint64_t)width, rows, channels, 32, 1, "PFM", image, error);
    if (status != SAG_OK) return status;
    const float factor = isfinite(scale) && scale != 0 ? (float)fabs(scale) : 1;
    const uint8_t *in = source->bytes + at;
    for (size_t row = 0; row < rows; row++) {
        float *out = image->pixels + (rows - 1 - row) * image->width * channels;
        for (size_t i = 0; i < row_bytes / 4; i++, in += 4) {
            const uint32_t bits =
                scale < 0
                    ? (uint32_t)in[0] | (uint32_t)in[1] << 8 | (uint32_t)in[2] << 16 | (uint32_t)in[3] << 24
                    : (uint32_t)in[3] | (uint32_t)in[2] << 8 | (uint32_t)in[1] << 16 | (uint32_t)in[0] << 24;
            float value;
            memcpy(&value, &bits, 4);
            out[i] = value * factor;
        }
    }
    return SAG_OK;
}

void sagi_pfm_write(const sag_image *image, FILE *file) {
    const bool color = image->channels >= 3;
    fprintf(file, "%s\n%u %u\n-1.0\n", color ? "PF" : "Pf", image->width, image->height);
    for (uint32_t row = image->height; row-- > 0;) {
        for (uint32_t x = 0; x < image->width; x++) {
            float pixel[4];
            memcpy(pixel, image->pixels + ((size_t)row * image->width + x) * image->channels,
                   image->channels * sizeof *pixel);
            if (color && image->color_space != SAG_COLOR_SRGB) {
                double own[3] = {(double)pixel[0], (double)pixel[1], (double)pixel[2]}, values[3];
                sagi_color_convert(image->color_space, SAG_COLOR_SRGB, own, values);
                for (int c = 0; c < 3; c++) pixel[c] = (float)values[c];
            }
            for (int c = 0; c < (color ? 3 : 1); c++) {
                uint32_t bits;
                memcpy(&bits, &pixel[c], 4);
                const uint8_t bytes[4] = {(uint8_t)bits, (uint8_t)(bits >> 8), (uint8_t)(bits >> 16),
                                          (uint8_t)(bits >> 24)};
                fwrite(bytes, 1, 4, file);
            }
        }
    }
}
