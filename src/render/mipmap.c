// SPDX-License-Identifier: MIT
// Making a mipmap (Williams, "Pyramidal Parametrics", SIGGRAPH 1983).
//
// Each level has half the texels of the one below along each axis, rounded down, and each of its texels is
// the mean of the area it covers: of 2 texels, or of 2 and a part of the neighbours where the number is odd.
// So every texel counts the same and all levels have the same mean. (pbrt-v4 first stretches a picture to
// powers of two, up to four times the memory for the same content.)
//
// The means are taken of linear numbers, in 32-bit floats from level to level; what is kept of each level is
// as compact as the picture itself: bytes stay bytes, of which the nearest is taken in the encoded scale.
#include "mipmap.h"

#include "color.h"

#include <string.h>

// Which texels of a row one of the next level's covers: at most 3 from `first`.
typedef struct span {
    uint32_t first, count;
    float weights[3];
} span;

// Texel i of m over n, m = ⌊n/2⌋ or 1 of 1. Ends are in units of 1/m texel, exact.
static span span_of(uint32_t i, uint32_t m, uint32_t n) {
    const uint64_t begin = (uint64_t)i * n, end = begin + n;
    span s = {.first = (uint32_t)(begin / m), .count = 0};
    for (uint64_t at = begin; at < end; s.count++) {
        const uint64_t next = (at / m + 1) * m, stop = next < end ? next : end;
        s.weights[s.count] = (float)((double)(stop - at) / n);
        at = stop;
    }
    return s;
}

// The tables of a builder: how bytes are decoded, and from which linear number on each byte is the nearest.
typedef struct builder {
    sagi_mipmap *mipmap;
    const sag_context *context;
    float from[256];    // byte i + 1 is nearer than byte i from here on
    uint8_t guess[256]; // the byte of the number i/256
} builder;

static double decode(sagi_transfer transfer, double v) {
    if (transfer.gamma > 0) return sagi_pow(v, transfer.gamma);
    return transfer.encoding == SAG_ENCODING_LINEAR ? v : sag_srgb_decode(v);
}

static void fill_tables(builder *b, sagi_transfer transfer) {
    for (int i = 0; i < 256; i++) {
        b->mipmap->decode[i] = (float)decode(transfer, i / 255.0);
        b->from[i] = i < 255 ? (float)decode(transfer, (i + 0.5) / 255) : INFINITY;
    }
    for (int i = 0, byte = 0; i < 256; i++) {
        while (!((float)i / 256 < b->from[byte])) byte++;
        b->guess[i] = (uint8_t)byte;
    }
}

static uint8_t encode(const builder *b, float value) {
    if (!(value > 0)) return 0;
    uint32_t byte = b->guess[value < 1 ? (uint32_t)(value * 256) : 255];
    while (byte < 255 && value >= b->from[byte]) byte++;
    return (uint8_t)byte;
}

// A row of a level's numbers as floats.
static void read_row(const sagi_mipmap *m, const sagi_level *level, uint32_t y, float *out) {
    const size_t n = (size_t)level->width * m->channels, first = level->first + y * n;
    switch (m->kind) {
    case SAGI_TEXEL_BYTE: {
        const uint8_t *in = (const uint8_t *)m->texels + first;
        for (size_t i = 0; i < n; i++) out[i] = m->decode[in[i]];
        break;
    }
    case SAGI_TEXEL_HALF: {
        const uint16_t *in = (const uint16_t *)m->texels + first;
        for (size_t i = 0; i < n; i++) out[i] = sagi_half_to_float(in[i]);
        break;
    }
    case SAGI_TEXEL_FLOAT: memcpy(out, (const float *)m->texels + first, n * sizeof *out); break;
    }
}

static void write_row(const builder *b, const sagi_level *level, uint32_t y, const float *in) {
    const sagi_mipmap *m = b->mipmap;
    const size_t n = (size_t)level->width * m->channels, first = level->first + y * n;
    switch (m->kind) {
    case SAGI_TEXEL_BYTE: {
        uint8_t *out = (uint8_t *)m->texels + first;
        for (size_t i = 0; i < n; i++) out[i] = encode(b, in[i]);
        break;
    }
    case SAGI_TEXEL_HALF: {
        uint16_t *out = (uint16_t *)m->texels + first;
        for (size_t i = 0; i < n; i++) out[i] = sagi_half_from_float(in[i]);
        break;
    }
    case SAGI_TEXEL_FLOAT: memcpy((float *)m->texels + first, in, n * sizeof *in); break;
    }
}

// One row of the next level from up to three of this one.
static void halve_row(const span *down, float *const rows[3], uint32_t width, uint32_t next_width,
                      uint32_t channels, float *out) {
    for (uint32_t x = 0; x < next_width; x++) {
        const span across =
            width == 2 * next_width ? (span){2 * x, 2, {0.5F, 0.5F, 0}} : span_of(x, next_width, width);
        for (uint32_t c = 0; c < channels; c++) {
            float sum = 0;
            for (uint32_t j = 0; j < down->count; j++) {
                const float *row = rows[j] + (size_t)across.first * channels + c;
                float part = 0;
                for (uint32_t i = 0; i < across.count; i++) part += across.weights[i] * row[i * channels];
                sum += down->weights[j] * part;
            }
            out[(size_t)x * channels + c] = sum;
        }
    }
}

// All levels above the first. `whole` holds a level in floats and is then overwritten by the next, whose rows
// come before those they are made from; the first level is read row by row instead.
static void halve_all(const builder *b, float *whole, float *buffer) {
    const sagi_mipmap *m = b->mipmap;
    for (uint32_t l = 0; l + 1 < m->level_count; l++) {
        const sagi_level *level = &m->levels[l], *next = &m->levels[l + 1];
        const size_t row_size = (size_t)level->width * m->channels;
        const size_t next_size = (size_t)next->width * m->channels;
        for (uint32_t y = 0; y < next->height; y++) {
            const span down = span_of(y, next->height, level->height);
            float *rows[3];
            for (uint32_t j = 0; j < down.count; j++) {
                rows[j] = buffer + j * row_size;
                if (l == 0)
                    read_row(m, level, down.first + j, rows[j]);
                else
                    memcpy(rows[j], whole + (down.first + j) * row_size, row_size * sizeof(float));
            }
            halve_row(&down, rows, level->width, next->width, m->channels, whole + y * next_size);
            write_row(b, next, y, whole + y * next_size);
        }
    }
}

static size_t number_bytes(sagi_texel_kind kind) {
    return kind == SAGI_TEXEL_BYTE ? 1 : kind == SAGI_TEXEL_HALF ? 2 : 4;
}

// Sets the levels and makes room for them.
static bool lay_out(sagi_mipmap *m, const sag_context *context, uint32_t width, uint32_t height) {
    size_t numbers = 0;
    for (m->level_count = 0;; width = width > 1 ? width / 2 : 1, height = height > 1 ? height / 2 : 1) {
        m->levels[m->level_count++] = (sagi_level){width, height, numbers};
        numbers += (size_t)width * height * m->channels;
        if (width == 1 && height == 1) break;
    }
    m->bytes = numbers * number_bytes(m->kind);
    m->texels = sag_allocate(context, m->bytes);
    return m->texels != NULL;
}

static sag_status out_of_memory(sagi_mipmap *m, const sag_context *context, sag_error *error) {
    const sag_status status = sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for a picture of %u×%u",
                                            m->levels[0].width, m->levels[0].height);
    sagi_mipmap_clear(m, context);
    return status;
}

// The levels above the first, which is there.
static sag_status build(const builder *b, sag_error *error) {
    sagi_mipmap *m = b->mipmap;
    if (m->level_count == 1) return SAG_OK;
    const size_t whole_bytes = (size_t)m->levels[1].width * m->levels[1].height * m->channels * sizeof(float);
    const size_t buffer_bytes = 3 * (size_t)m->levels[0].width * m->channels * sizeof(float);
    float *whole = sag_allocate(b->context, whole_bytes), *buffer = sag_allocate(b->context, buffer_bytes);
    const bool enough = whole && buffer;
    if (enough) halve_all(b, whole, buffer);
    sag_release(b->context, whole, whole_bytes);
    sag_release(b->context, buffer, buffer_bytes);
    return enough ? SAG_OK : out_of_memory(m, b->context, error);
}

static bool is_half(float value) {
    const float back = sagi_half_to_float(sagi_half_from_float(value));
    return memcmp(&back, &value, sizeof back) == 0;
}

sag_status sagi_mipmap_init(sagi_mipmap *mipmap, const sag_context *context, const sag_image *image,
                            sag_error *error) {
    *mipmap = (sagi_mipmap){.kind = SAGI_TEXEL_HALF, .color_space = image->color_space};
    const uint32_t stride = image->channels;
    const size_t count = (size_t)image->width * image->height;
    const float *pixels = image->pixels;
    mipmap->channels = stride < 3 ? 1 : 3;
    for (size_t i = 0; i < count && stride == 4 && mipmap->channels == 3; i++)
        if (pixels[4 * i + 3] != 1) mipmap->channels = 4;
    const uint32_t channels = mipmap->channels;
    for (size_t i = 0; i < count && mipmap->kind == SAGI_TEXEL_HALF; i++)
        for (uint32_t c = 0; c < channels; c++)
            if (!is_half(pixels[i * stride + c])) mipmap->kind = SAGI_TEXEL_FLOAT;
    if (!lay_out(mipmap, context, image->width, image->height)) return out_of_memory(mipmap, context, error);
    float *floats = mipmap->texels;
    uint16_t *halves = mipmap->texels;
    for (size_t i = 0, n = 0; i < count; i++)
        for (uint32_t c = 0; c < channels; c++, n++) {
            if (mipmap->kind == SAGI_TEXEL_HALF)
                halves[n] = sagi_half_from_float(pixels[i * stride + c]);
            else
                floats[n] = pixels[i * stride + c];
        }
    const builder b = {.mipmap = mipmap, .context = context};
    return build(&b, error);
}

sag_status sagi_mipmap_init_bytes(sagi_mipmap *mipmap, const sag_context *context, const uint8_t *bytes,
                                  uint32_t width, uint32_t height, uint32_t channels, sagi_transfer transfer,
                                  sag_error *error) {
    *mipmap = (sagi_mipmap){.kind = SAGI_TEXEL_BYTE};
    const size_t count = (size_t)width * height;
    mipmap->channels = channels < 3 ? 1 : 3;
    for (size_t i = 0; i < count && channels == 4 && mipmap->channels == 3; i++)
        if (bytes[4 * i + 3] != 255) mipmap->channels = 4;
    if (!lay_out(mipmap, context, width, height)) return out_of_memory(mipmap, context, error);
    uint8_t *out = mipmap->texels;
    if (mipmap->channels == channels)
        memcpy(out, bytes, count * channels);
    else
        for (size_t i = 0, n = 0; i < count; i++)
            for (uint32_t c = 0; c < mipmap->channels; c++) out[n++] = bytes[i * channels + c];
    builder b = {.mipmap = mipmap, .context = context};
    fill_tables(&b, transfer);
    return build(&b, error);
}

void sagi_mipmap_clear(sagi_mipmap *mipmap, const sag_context *context) {
    sag_release(context, mipmap->texels, mipmap->bytes);
    *mipmap = (sagi_mipmap){0};
}
