// SPDX-License-Identifier: MIT
// TGA, BMP and Radiance HDR through stb_image. stb_image reads zeros beyond the end of a file without a word,
// so it gets its bytes from a callback that notices: it asks either to refill its buffer (always the same
// address, and only when it needs one more byte) or for an exact number of bytes. Beyond the end it gets
// ones: a run of HDR pixels that is 0 long it would take for ever and again.
#include "formats/image.h"

#include <string.h>

// Private to this file, used or not.
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#ifndef __clang_analyzer__ // what it suspects in there is not ours
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#endif
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_NO_SIMD
#define STBI_MAX_DIMENSIONS SAG_MAX_IMAGE_SIZE
#include <stb/stb_image.h>

typedef struct reader {
    const sagi_image_source *source;
    size_t position;
    const char *refill; // stb_image's buffer: where its first call asks for bytes
    bool cut_short;
} reader;

static int on_read(void *user, char *out, int count) {
    reader *r = user;
    if (!r->refill) r->refill = out;
    const size_t left = r->source->size - r->position, wanted = (size_t)count;
    const size_t got = left < wanted ? left : wanted;
    if (got == 0 || (got < wanted && out != r->refill)) r->cut_short = true;
    if (got == 0 && out == r->refill) {
        memset(out, 1, wanted);
        return count;
    }
    memcpy(out, r->source->bytes + r->position, got);
    r->position += got;
    return (int)got;
}

static void on_skip(void *user, int count) {
    reader *r = user;
    const size_t left = r->source->size - r->position;
    if (count < 0 || (size_t)count > left) {
        r->cut_short = true;
        count = (int)(left < INT32_MAX ? left : INT32_MAX);
    }
    r->position += (size_t)count;
}

static int on_eof(void *user) {
    const reader *r = user;
    return r->position >= r->source->size;
}

sag_status sagi_stb_read(const sagi_image_source *source, sag_image *image, sag_error *error) {
    const char *unknown = "not a picture in a known format (PNG, JPEG, TGA, BMP, HDR, EXR, PFM, QOI)";
    const stbi_io_callbacks callbacks = {on_read, on_skip, on_eof};
    const int size = source->size > INT32_MAX ? INT32_MAX : (int)source->size;
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(source->bytes, size, &width, &height, &channels))
        return sag_error_set_at(error, SAG_ERROR_FORMAT, source->path, 0, 0, "%s", unknown);
    const bool hdr = stbi_is_hdr_from_memory(source->bytes, size) != 0;
    const char *format = hdr ? "HDR" : source->bytes[0] == 'B' && source->bytes[1] == 'M' ? "BMP" : "TGA";
    // The densest is TGA's run of 128 pixels in two bytes.
    sag_status status = sagi_image_create_for(source, (uint64_t)width, (uint64_t)height, (uint32_t)channels,
                                              hdr ? 32 : 8, 64, format, image, error);
    if (status != SAG_OK) return status;
    if (source->kept && !hdr) source->kept->encoding = SAG_ENCODING_SRGB;
    reader r = {.source = source};
    int got_width = 0, got_height = 0, got_channels = 0;
    void *pixels = hdr ? (void *)stbi_loadf_from_callbacks(&callbacks, &r, &got_width, &got_height,
                                                           &got_channels, channels)
                       : (void *)stbi_load_from_callbacks(&callbacks, &r, &got_width, &got_height,
                                                          &got_channels, channels);
    if (pixels == NULL)
        status = sagi_image_damaged(source, error, format,
                                    r.cut_short ? "the file is cut short" : stbi_failure_reason());
    else if (r.cut_short || got_width != width || got_height != height)
        status = sagi_image_damaged(source, error, format, "the file is cut short");
    if (status == SAG_OK && pixels != NULL) {
        const size_t row = (size_t)width * (size_t)channels;
        if (hdr)
            memcpy(image->pixels, pixels, row * (size_t)height * sizeof(float));
        else
            for (size_t y = 0; y < (size_t)height; y++)
                sagi_image_decode_row(source, (const uint8_t *)pixels + y * row, 8, (uint32_t)y, image);
    }
    stbi_image_free(pixels);
    return status;
}
