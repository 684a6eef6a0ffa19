// SPDX-License-Identifier: MIT
// PNG through libpng. Palettes and fewer than 8 bits are expanded, transparency becomes alpha, interlaced
// files are put together. libpng reports errors by longjmp; each function that calls setjmp keeps what it
// needs afterwards in a struct of its caller, where no register can lose it.
#include "formats/image.h"
#include "render/colorspace.h"

#include <math.h>
#include <png.h>
#include <string.h>

typedef struct reader {
    const sagi_image_source *source;
    size_t position;
    sag_image *image;
    sag_error *error;
    sag_status status;
    uint8_t *rows; // the decoded file
    size_t rows_bytes;
    png_structp png;
    png_infop info;
    char message[128];
} reader;

static void on_error(png_structp png, png_const_charp message) {
    char *out = png_get_error_ptr(png);
    snprintf(out, 128, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) { (void)png, (void)message; }

static void read_bytes(png_structp png, png_bytep out, size_t count) {
    reader *r = png_get_io_ptr(png);
    if (r->source->size - r->position < count) png_error(png, "the file is cut short");
    memcpy(out, r->source->bytes + r->position, count);
    r->position += count;
}

static void read_image(reader *r) {
    if (setjmp(png_jmpbuf(r->png))) {
        r->status = sagi_image_damaged(r->source, r->error, "PNG", r->message);
        return;
    }
    png_set_read_fn(r->png, r, read_bytes);
    png_set_user_limits(r->png, SAG_MAX_IMAGE_SIZE, SAG_MAX_IMAGE_SIZE);
    png_read_info(r->png, r->info);
    const int bits = png_get_bit_depth(r->png, r->info) == 16 ? 16 : 8;
    png_set_expand(r->png);
    const uint16_t probe = 1;
    if (bits == 16 && *(const uint8_t *)&probe == 1) png_set_swap(r->png);
    const int passes = png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    const uint32_t height = png_get_image_height(r->png, r->info);
    // Deflate packs at most 1032 to 1; 8 pixels of one bit in a byte.
    r->status =
        sagi_image_create_for(r->source, png_get_image_width(r->png, r->info), height,
                              png_get_channels(r->png, r->info), bits, 8 * 1032, "PNG", r->image, r->error);
    if (r->status != SAG_OK) return;
    const size_t row_bytes = png_get_rowbytes(r->png, r->info);
    r->rows_bytes = row_bytes * height;
    r->rows = sag_allocate(r->source->context, r->rows_bytes);
    if (!r->rows) {
        r->status = sag_error_set_at(r->error, SAG_ERROR_MEMORY, r->source->path, 0, 0, "out of memory");
        return;
    }
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < height; y++) png_read_row(r->png, r->rows + y * row_bytes, NULL);
    png_read_end(r->png, NULL);
    for (uint32_t y = 0; y < height; y++)
        sagi_image_decode_row(r->source, r->rows + y * row_bytes, bits, y, r->image);
}

sag_status sagi_png_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    reader r = {.source = source, .image = image, .error = error};
    r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, r.message, on_error, on_warning);
    r.info = r.png ? png_create_info_struct(r.png) : NULL;
    if (r.info)
        read_image(&r);
    else
        r.status = sag_error_set_at(error, SAG_ERROR_MEMORY, source->path, 0, 0, "out of memory");
    png_destroy_read_struct(&r.png, &r.info, NULL);
    sag_release(source->context, r.rows, r.rows_bytes);
    return r.status;
}

typedef struct writer {
    const sag_image *image;
    png_structp png;
    png_infop info;
    char message[128];
} writer;

// The nearest of 0 … 255; NaN counts as 0.
static uint8_t to_byte(double x) { return x > 0 ? (uint8_t)(fmin(x, 1) * 255 + 0.5) : 0; }

static bool write_image(writer *w, FILE *file) {
    if (setjmp(png_jmpbuf(w->png))) return false;
    static const int color_types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                      PNG_COLOR_TYPE_RGB_ALPHA};
    const sag_image *image = w->image;
    png_init_io(w->png, file);
    png_set_IHDR(w->png, w->info, image->width, image->height, 8, color_types[image->channels - 1],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(w->png, w->info, PNG_sRGB_INTENT_RELATIVE);
    png_write_info(w->png, w->info);
    const bool has_alpha = image->channels == 2 || image->channels == 4;
    for (uint32_t y = 0; y < image->height; y++) {
        // libpng wants whole rows; a band of them on the stack would need a bound, so write through its own.
        png_bytep row = png_malloc(w->png, (size_t)image->width * image->channels);
        for (uint32_t x = 0; x < image->width; x++) {
            const float *pixel = image->pixels + ((size_t)y * image->width + x) * image->channels;
            double values[4] = {0};
            for (uint32_t c = 0; c < image->channels; c++) values[c] = (double)pixel[c];
            if (image->color_space != SAG_COLOR_SRGB && image->channels >= 3) {
                const double own[3] = {values[0], values[1], values[2]};
                sagi_color_convert(image->color_space, SAG_COLOR_SRGB, own, values);
            }
            for (uint32_t c = 0; c < image->channels; c++) {
                const double value = values[c];
                const bool is_alpha = has_alpha && c == image->channels - 1;
                row[x * image->channels + c] = to_byte(is_alpha ? value : sag_srgb_encode(value));
            }
        }
        png_write_row(w->png, row);
        png_free(w->png, row);
    }
    png_write_end(w->png, w->info);
    return true;
}

sag_status sagi_png_write(const sag_image *image, FILE *file, const char *path, sag_error *error) {
    writer w = {.image = image};
    w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, w.message, on_error, on_warning);
    w.info = w.png ? png_create_info_struct(w.png) : NULL;
    sag_status status = SAG_OK;
    if (!w.info)
        status = sag_error_set_at(error, SAG_ERROR_MEMORY, path, 0, 0, "out of memory");
    else if (!write_image(&w, file))
        status = sag_error_set_at(error, SAG_ERROR_IO, path, 0, 0, "cannot write: %s", w.message);
    png_destroy_write_struct(&w.png, &w.info);
    return status;
}
