// SPDX-License-Identifier: MIT
// What the readers and writers of picture formats share. Each reader gets the whole file in memory and makes
// an image; the library that decodes it uses the C library's memory for its own needs, the pixels are the
// context's.
#ifndef SAGI_FORMATS_IMAGE_H
#define SAGI_FORMATS_IMAGE_H

#include <sagitta/image.h>
#include <stdio.h>

// The numbers of an 8-bit file as they stand in it.
typedef struct sagi_image_bytes {
    uint8_t *bytes; // width × height × channels, the context's; NULL: the file has other numbers
    size_t size;
    sag_encoding encoding; // what the format lays down; SAG_ENCODING_DEFAULT: nothing
} sagi_image_bytes;

typedef struct sagi_image_source {
    const sag_context *context;
    const char *path; // for messages
    const uint8_t *bytes;
    size_t size;
    sag_encoding encoding;
    sagi_image_bytes *kept; // not NULL: an 8-bit file is kept there, and the image has no pixels of its own
} sagi_image_source;

// Decodes a whole file in memory, whatever the format (image.c).
sag_status sagi_image_decode(const sagi_image_source *source, sag_image *image, sag_error *error);

sag_status sagi_png_read(const sagi_image_source *source, sag_image *image, sag_error *error);
sag_status sagi_jpeg_read(const sagi_image_source *source, sag_image *image, sag_error *error);
sag_status sagi_exr_read(const sagi_image_source *source, sag_image *image, sag_error *error);
sag_status sagi_pfm_read(const sagi_image_source *source, sag_image *image, sag_error *error);
sag_status sagi_qoi_read(const sagi_image_source *source, sag_image *image, sag_error *error);
sag_status sagi_stb_read(const sagi_image_source *source, sag_image *image, sag_error *error);

// What an EXR file is to hold: pixels of so many channels, a part (x, y, width, height) of the full picture.
typedef struct sagi_exr_picture {
    uint32_t width, height, x, y, full_width, full_height, channel_count;
    const char *const *names;
    const bool *is_id; // the floats are the bits of uint32_t; NULL: none are
    const float *pixels;
    sag_color_space color_space;
} sagi_exr_picture;

// Writers append to `file`; a failure to write shows in ferror(file), which the caller looks at.
sag_status sagi_png_write(const sag_image *image, FILE *file, const char *path, sag_error *error);
sag_status sagi_exr_write(const sag_context *context, const sagi_exr_picture *picture, FILE *file,
                          const char *path, sag_error *error);
void sagi_pfm_write(const sag_image *image, FILE *file);

// SAG_ERROR_FORMAT with the path and a message.
sag_status sagi_image_damaged(const sagi_image_source *source, sag_error *error, const char *format,
                              const char *what);

// Makes the image a header claims, after checking that a file of this size can hold so many pixels when a
// byte stands for `most_per_byte` of them at best: a few hostile bytes must not cost gigabytes. `bits` are
// those of its numbers.
sag_status sagi_image_create_for(const sagi_image_source *source, uint64_t width, uint64_t height,
                                 uint32_t channels, int bits, uint64_t most_per_byte, const char *format,
                                 sag_image *image, sag_error *error);

// One row of 8- or 16-bit numbers (16-bit ones in the machine's order) to linear floats; an alpha channel
// (2nd of 2, 4th of 4) is linear always. Bytes that are kept are copied.
void sagi_image_decode_row(const sagi_image_source *source, const void *row, int bits, uint32_t y,
                           sag_image *image);

#endif
