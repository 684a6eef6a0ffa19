// SPDX-License-Identifier: MIT
// Pictures: making them, telling which format a file is, sRGB. The formats themselves are in png.c, jpeg.c,
// exr.c, pfm.c, qoi.c and stb.c.
//
// sRGB (IEC 61966-2-1): linear below 0.0031308, a power of 2.4 above, meeting (nearly) at 0.04045.
#include "formats/image.h"

#include "formats/file.h"
#include "formats/output.h"
#include "math/elementary.h"

#include <math.h>
#include <string.h>
#include <strings.h>

sag_status sag_image_create(const sag_context *context, uint32_t width, uint32_t height, uint32_t channels,
                            sag_image *image, sag_error *error) {
    if (width == 0 || height == 0 || width > SAG_MAX_IMAGE_SIZE || height > SAG_MAX_IMAGE_SIZE)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "image size %u×%u: each must be in 1 … %u", width,
                             height, SAG_MAX_IMAGE_SIZE);
    if (channels < 1 || channels > 4)
        return sag_error_set(error, SAG_ERROR_ARGUMENT, "image with %u channels: 1 … 4 it must be", channels);
    const size_t bytes = (size_t)width * height * channels * sizeof(float);
    float *pixels = sag_allocate(context, bytes);
    if (!pixels)
        return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for an image of %u×%u, %zu bytes", width,
                             height, bytes);
    memset(pixels, 0, bytes);
    *image = (sag_image){.width = width, .height = height, .channels = channels, .pixels = pixels};
    return SAG_OK;
}

void sag_image_clear(const sag_context *context, sag_image *image) {
    if (!image || !image->pixels) return;
    sag_release(context, image->pixels,
                (size_t)image->width * image->height * image->channels * sizeof(float));
    *image = (sag_image){0};
}

double sag_srgb_encode(double linear) {
    const double x = fabs(linear);
    const double y = x <= 0.0031308 ? 12.92 * x : 1.055 * sagi_pow(x, 1 / 2.4) - 0.055;
    return copysign(y, linear);
}

double sag_srgb_decode(double encoded) {
    const double x = fabs(encoded);
    const double y = x <= 0.04045 ? x / 12.92 : sagi_pow((x + 0.055) / 1.055, 2.4);
    return copysign(y, encoded);
}

sag_status sagi_image_damaged(const sagi_image_source *source, sag_error *error, const char *format,
                              const char *what) {
    return sag_error_set_at(error, SAG_ERROR_FORMAT, source->path, 0, 0, "damaged %s file: %s", format, what);
}

static sag_status keep_bytes(const sagi_image_source *source, uint32_t width, uint32_t height,
                             uint32_t channels, sag_image *image, sag_error *error) {
    sagi_image_bytes *kept = source->kept;
    kept->size = (size_t)width * height * channels;
    kept->bytes = sag_allocate(source->context, kept->size);
    if (!kept->bytes)
        return sag_error_set_at(error, SAG_ERROR_MEMORY, source->path, 0, 0,
                                "out of memory for an image of %u×%u", width, height);
    *image = (sag_image){.width = width, .height = height, .channels = channels};
    return SAG_OK;
}

sag_status sagi_image_create_for(const sagi_image_source *source, uint64_t width, uint64_t height,
                                 uint32_t channels, int bits, uint64_t most_per_byte, const char *format,
                                 sag_image *image, sag_error *error) {
    if (width == 0 || height == 0 || width > SAG_MAX_IMAGE_SIZE || height > SAG_MAX_IMAGE_SIZE)
        return sag_error_set_at(error, SAG_ERROR_FORMAT, source->path, 0, 0,
                                "%s image of %llu×%llu pixels: each must be in 1 … %u", format,
                                (unsigned long long)width, (unsigned long long)height, SAG_MAX_IMAGE_SIZE);
    if (width * height / most_per_byte > source->size)
        return sag_error_set_at(error, SAG_ERROR_FORMAT, source->path, 0, 0,
                                "%s image of %llu×%llu pixels in a file of %zu bytes: the file is cut short",
                                format, (unsigned long long)width, (unsigned long long)height, source->size);
    if (bits == 8 && source->kept)
        return keep_bytes(source, (uint32_t)width, (uint32_t)height, channels, image, error);
    const sag_status status =
        sag_image_create(source->context, (uint32_t)width, (uint32_t)height, channels, image, error);
    if (status != SAG_OK && error) snprintf(error->file, sizeof error->file, "%s", source->path);
    return status;
}

void sagi_image_decode_row(const sagi_image_source *source, const void *row, int bits, uint32_t y,
                           sag_image *image) {
    const bool srgb =
        source->encoding == SAG_ENCODING_SRGB || (source->encoding == SAG_ENCODING_DEFAULT && bits == 8);
    const uint32_t n = image->width * image->channels;
    if (bits == 8 && source->kept) {
        memcpy(source->kept->bytes + (size_t)y * n, row, n);
        return;
    }
    float *out = image->pixels + (size_t)y * n;
    const uint8_t *row8 = row;
    const uint16_t *row16 = row;
    float table[256];
    if (bits == 8)
        for (int i = 0; i < 256; i++) table[i] = (float)(srgb ? sag_srgb_decode(i / 255.0) : i / 255.0);
    const bool has_alpha = image->channels == 2 || image->channels == 4;
    for (uint32_t i = 0; i < n; i++) {
        const bool is_alpha = has_alpha && i % image->channels == image->channels - 1;
        if (bits == 8)
            out[i] = is_alpha ? (float)(row8[i] / 255.0) : table[row8[i]];
        else
            out[i] = (float)(srgb && !is_alpha ? sag_srgb_decode(row16[i] / 65535.0) : row16[i] / 65535.0);
    }
}

static bool starts_with(const sagi_image_source *source, const char *magic, size_t length) {
    return source->size >= length && memcmp(source->bytes, magic, length) == 0;
}

sag_status sagi_image_decode(const sagi_image_source *source, sag_image *image, sag_error *error) {
    sag_status status;
    sag_image made = {0};
    if (source->size == 0)
        status = sag_error_set_at(error, SAG_ERROR_FORMAT, source->path, 0, 0, "the image file is empty");
    else if (starts_with(source, "\x89PNG", 4))
        status = sagi_png_read(source, &made, error);
    else if (starts_with(source, "\xff\xd8\xff", 3))
        status = sagi_jpeg_read(source, &made, error);
    else if (starts_with(source, "\x76\x2f\x31\x01", 4))
        status = sagi_exr_read(source, &made, error);
    else if (starts_with(source, "PF", 2) || starts_with(source, "Pf", 2))
        status = sagi_pfm_read(source, &made, error);
    else if (starts_with(source, "qoif", 4))
        status = sagi_qoi_read(source, &made, error);
    else
        status = sagi_stb_read(source, &made, error);
    if (status == SAG_OK) {
        *image = made;
        return SAG_OK;
    }
    sag_image_clear(source->context, &made);
    if (source->kept) {
        sag_release(source->context, source->kept->bytes, source->kept->size);
        *source->kept = (sagi_image_bytes){0};
    }
    return status;
}

sag_status sag_image_read(const sag_context *context, const char *path, sag_encoding encoding,
                          sag_image *image, sag_error *error) {
    sagi_file file;
    sag_status status = sagi_file_open(context, path, &file, error);
    if (status != SAG_OK) return status;
    const sagi_image_source source = {context, path, file.bytes, file.size, encoding, NULL};
    status = sagi_image_decode(&source, image, error);
    sagi_file_close(&file);
    return status;
}

static bool ends_with(const char *path, const char *ending) {
    const size_t length = strlen(path), n = strlen(ending);
    return length > n && strcasecmp(path + length - n, ending) == 0;
}

static sag_status write_exr(const sag_context *context, const sag_image *image, FILE *file, const char *path,
                            sag_error *error) {
    static const char *const names[4][4] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    const sagi_exr_picture picture = {.width = image->width,
                                      .height = image->height,
                                      .full_width = image->width,
                                      .full_height = image->height,
                                      .channel_count = image->channels,
                                      .names = names[image->channels - 1],
                                      .pixels = image->pixels,
                                      .color_space = image->color_space};
    return sagi_exr_write(context, &picture, file, path, error);
}

sag_status sag_image_write(const sag_context *context, const sag_image *image, const char *path,
                           sag_error *error) {
    if (!image || !image->pixels || image->channels < 1 || image->channels > 4 ||
        image->color_space > SAG_COLOR_ACES2065_1)
        return sag_error_set_at(error, SAG_ERROR_ARGUMENT, path, 0, 0, "there is no image to write");
    const bool png = ends_with(path, ".png"), pfm = ends_with(path, ".pfm"), exr = ends_with(path, ".exr");
    if (!png && !pfm && !exr)
        return sag_error_set_at(error, SAG_ERROR_ARGUMENT, path, 0, 0,
                                "unknown ending of an image's name: .png, .exr and .pfm can be written");
    sagi_output output;
    sag_status status = sagi_output_open(&output, path, error);
    if (status != SAG_OK) return status;
    if (png)
        status = sagi_png_write(image, output.file, path, error);
    else if (exr)
        status = write_exr(context, image, output.file, path, error);
    else
        sagi_pfm_write(image, output.file);
    if (status == SAG_OK) return sagi_output_commit(&output, error);
    sagi_output_discard(&output);
    return status;
}
