// SPDX-License-Identifier: MIT
// Pictures for textures: every format, as compact as its numbers; encodings; QOI; read once however often
// asked.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/world.h"
#include "support/random.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static char folder[64];
static sag_context *context;
static sag_world *world;
static size_t held_at_first;

static const char *in_folder(const char *name) {
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_file(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static int setup(void **state) {
    (void)state;
    strcpy(folder, "/tmp/sagitta-pictures-XXXXXX");
    context = sag_context_create(NULL);
    sag_context_memory(context, &held_at_first, NULL);
    world = sag_world_create(context);
    return mkdtemp(folder) && world ? 0 : 1;
}

static int teardown(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    sag_world_destroy(world);
    size_t held;
    sag_context_memory(context, &held, NULL);
    sag_context_destroy(context);
    return system(command) == 0 && held == held_at_first ? 0 : 1;
}

// A plain encoder of QOI that uses whatever fits, in the order of the format's own.
typedef struct qoi {
    uint8_t *bytes;
    size_t size;
} qoi;

static void put(qoi *q, int byte) { q->bytes[q->size++] = (uint8_t)byte; }

static qoi qoi_encode(const uint8_t *pixels, uint32_t width, uint32_t height, uint32_t channels,
                      int colorspace) {
    qoi q = {malloc((size_t)width * height * 5 + 64), 0};
    const uint32_t sizes[2] = {width, height};
    memcpy(q.bytes, "qoif", 4), q.size = 4;
    for (int i = 0; i < 2; i++)
        for (int shift = 24; shift >= 0; shift -= 8) put(&q, (int)(sizes[i] >> shift & 255));
    put(&q, (int)channels), put(&q, colorspace);
    uint8_t seen[64][4] = {{0}}, last[4] = {0, 0, 0, 255};
    uint32_t run = 0;
    for (size_t i = 0; i < (size_t)width * height; i++) {
        uint8_t p[4] = {0, 0, 0, 255};
        memcpy(p, pixels + i * channels, channels);
        if (memcmp(p, last, 4) == 0) {
            if (++run == 62) put(&q, 0xC0 | 61), run = 0;
            continue;
        }
        if (run) put(&q, 0xC0 | (int)(run - 1)), run = 0;
        const int h = (p[0] * 3 + p[1] * 5 + p[2] * 7 + p[3] * 11) % 64;
        const int dr = (int8_t)(p[0] - last[0]), dg = (int8_t)(p[1] - last[1]), db = (int8_t)(p[2] - last[2]);
        if (memcmp(seen[h], p, 4) == 0) {
            put(&q, h);
        } else if (p[3] != last[3]) {
            put(&q, 0xFF), put(&q, p[0]), put(&q, p[1]), put(&q, p[2]), put(&q, p[3]);
        } else if (dr >= -2 && dr < 2 && dg >= -2 && dg < 2 && db >= -2 && db < 2) {
            put(&q, 0x40 | (dr + 2) << 4 | (dg + 2) << 2 | (db + 2));
        } else if (dg >= -32 && dg < 32 && dr - dg >= -8 && dr - dg < 8 && db - dg >= -8 && db - dg < 8) {
            put(&q, 0x80 | (dg + 32)), put(&q, (dr - dg + 8) << 4 | (db - dg + 8));
        } else {
            put(&q, 0xFE), put(&q, p[0]), put(&q, p[1]), put(&q, p[2]);
        }
        memcpy(seen[h], p, 4), memcpy(last, p, 4);
    }
    if (run) put(&q, 0xC0 | (int)(run - 1));
    for (int i = 0; i < 8; i++) put(&q, i == 7);
    return q;
}

// Runs, small steps, larger steps, returns to old colours, noise.
static void fill(rng *r, uint8_t *pixels, size_t count, uint32_t channels) {
    uint8_t p[4] = {10, 20, 30, 255};
    for (size_t i = 0; i < count; i++) {
        const uint32_t kind = rng_below(r, 6);
        for (uint32_t c = 0; c < channels; c++) {
            if (kind == 1 && c < 3) p[c] = (uint8_t)(p[c] + rng_below(r, 4) - 2);
            if (kind == 2 && c < 3) p[c] = (uint8_t)(p[c] + rng_below(r, 8) + 20);
            if (kind == 3) p[c] = (uint8_t)(rng_below(r, 2) * 255);
            if (kind == 4) p[c] = (uint8_t)rng_bits(r);
        }
        const size_t end = i + (kind == 5 ? rng_below(r, 200) : 0);
        for (;; i++) {
            memcpy(pixels + i * channels, p, channels);
            if (i >= end || i + 1 == count) break;
        }
    }
}

static void qoi_comes_back(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 100; i++) {
        const uint32_t width = 1 + rng_below(&r, 60), height = 1 + rng_below(&r, 60),
                       channels = i % 2 ? 4 : 3;
        const size_t count = (size_t)width * height;
        uint8_t *pixels = malloc(count * channels);
        fill(&r, pixels, count, channels);
        const qoi q = qoi_encode(pixels, width, height, channels, i / 2 % 2);
        write_file(in_folder("a.qoi"), q.bytes, q.size);
        sag_image image;
        assert_int_equal(sag_image_read(context, in_folder("a.qoi"), SAG_ENCODING_LINEAR, &image, NULL),
                         SAG_OK);
        assert_true(image.width == width && image.height == height && image.channels == channels);
        for (size_t k = 0; k < count * channels; k++)
            assert_int_equal((int)(image.pixels[k] * 255 + 0.5F), pixels[k]);
        sag_image_clear(context, &image);
        free(pixels), free(q.bytes);
    }
}

static void damaged_qoi_is_an_error(void **state) {
    (void)state;
    rng r = rng_make(2);
    uint8_t pixels[20 * 20 * 4];
    fill(&r, pixels, 400, 4);
    qoi q = qoi_encode(pixels, 20, 20, 4, 0);
    sag_image image;
    sag_error error;
    for (size_t size = 4; size < q.size; size += 3) {
        write_file(in_folder("b.qoi"), q.bytes, size);
        assert_int_equal(sag_image_read(context, in_folder("b.qoi"), SAG_ENCODING_DEFAULT, &image, &error),
                         SAG_ERROR_FORMAT);
    }
    // Any bytes are a picture or an error.
    for (int i = 0; i < 400; i++) {
        const uint32_t at = 14 + rng_below(&r, (uint32_t)q.size - 14);
        const uint8_t old = q.bytes[at];
        q.bytes[at] = (uint8_t)rng_bits(&r);
        write_file(in_folder("b.qoi"), q.bytes, q.size);
        if (sag_image_read(context, in_folder("b.qoi"), SAG_ENCODING_DEFAULT, &image, &error) == SAG_OK)
            sag_image_clear(context, &image);
        q.bytes[at] = old;
    }
    q.bytes[4] = 0x7F; // two thousand million wide
    write_file(in_folder("b.qoi"), q.bytes, q.size);
    assert_int_equal(sag_image_read(context, in_folder("b.qoi"), SAG_ENCODING_DEFAULT, &image, &error),
                     SAG_ERROR_FORMAT);
    q.bytes[4] = 0, q.bytes[12] = 7;
    write_file(in_folder("b.qoi"), q.bytes, q.size);
    assert_int_equal(sag_image_read(context, in_folder("b.qoi"), SAG_ENCODING_DEFAULT, &image, &error),
                     SAG_ERROR_FORMAT);
    free(q.bytes);
}

static const sagi_mipmap *load(const char *name, sag_encoding encoding, double gamma, sag_picture_id *id) {
    sag_error error = {0};
    assert_int_equal(sag_world_load_picture(world, in_folder(name), encoding, gamma, id, &error), SAG_OK);
    return sagi_world_picture(world, *id);
}

static double texel(const sagi_mipmap *m, int x, int y, int c) {
    return (double)sagi_mipmap_texel(m, 0, x, y, SAG_WRAP_CLAMP)[c];
}

// A ramp of colours, exact in bytes.
static sag_image ramp(uint32_t channels) {
    sag_image image;
    assert_int_equal(sag_image_create(context, 16, 8, channels, &image, NULL), SAG_OK);
    for (uint32_t i = 0; i < 16 * 8 * channels; i++)
        image.pixels[i] = (float)sag_srgb_decode((i * 7 % 256) / 255.0);
    return image;
}

static void every_format_shows_the_same(void **state) {
    (void)state;
    sag_image image = ramp(3);
    const char *const names[] = {"f.png", "f.pfm", "f.exr"};
    const sagi_texel_kind kinds[] = {SAGI_TEXEL_BYTE, SAGI_TEXEL_FLOAT, SAGI_TEXEL_FLOAT};
    for (int f = 0; f < 3; f++) {
        assert_int_equal(sag_image_write(context, &image, in_folder(names[f]), NULL), SAG_OK);
        sag_picture_id id;
        const sagi_mipmap *m = load(names[f], SAG_ENCODING_DEFAULT, 0, &id);
        assert_int_equal(m->kind, kinds[f]);
        for (int y = 0; y < 8; y++)
            for (int x = 0; x < 16; x++)
                for (int c = 0; c < 3; c++)
                    assert_true(fabs(texel(m, x, y, c) - (double)image.pixels[(y * 16 + x) * 3 + c]) < 1e-6);
    }
    sag_image_clear(context, &image);
    // What has an encoding of its own keeps it, whatever is asked for.
    const uint8_t grey[3] = {128, 128, 128};
    for (int space = 0; space < 2; space++) {
        const qoi q = qoi_encode(grey, 1, 1, 3, space);
        const char *name = space ? "linear.qoi" : "srgb.qoi";
        write_file(in_folder(name), q.bytes, q.size);
        sag_picture_id id;
        const sagi_mipmap *m = load(name, space ? SAG_ENCODING_SRGB : SAG_ENCODING_LINEAR, 0, &id);
        assert_true(fabs(texel(m, 0, 0, 0) - (space ? 128 / 255.0 : sag_srgb_decode(128 / 255.0))) < 1e-7);
        free(q.bytes);
    }
    static const uint8_t tga[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 128, 128, 128};
    write_file(in_folder("a.tga"), tga, sizeof tga);
    sag_picture_id id;
    const sagi_mipmap *m = load("a.tga", SAG_ENCODING_LINEAR, 0, &id);
    assert_true(m->kind == SAGI_TEXEL_BYTE && fabs(texel(m, 0, 0, 1) - sag_srgb_decode(128 / 255.0)) < 1e-7);
}

static void png_is_encoded_as_asked_for(void **state) {
    (void)state;
    sag_image image = ramp(4);
    assert_int_equal(sag_image_write(context, &image, in_folder("e.png"), NULL), SAG_OK);
    sag_picture_id ids[4];
    const sagi_mipmap *srgb = load("e.png", SAG_ENCODING_DEFAULT, 0, &ids[0]);
    const double value = (7 * 4 * 5 + 7) % 256 / 255.0; // green of the texel (5, 0)
    assert_true(fabs(texel(srgb, 5, 0, 1) - sag_srgb_decode(value)) < 1e-6);
    const sagi_mipmap *linear = load("e.png", SAG_ENCODING_LINEAR, 0, &ids[1]);
    assert_true(fabs(texel(linear, 5, 0, 1) - value) < 1e-6);
    const sagi_mipmap *gamma = load("e.png", SAG_ENCODING_SRGB, 1.8, &ids[2]);
    assert_true(fabs(texel(gamma, 5, 0, 1) - pow(value, 1.8)) < 1e-6);
    // Asked for again, they are there.
    const sagi_mipmap *again = load("e.png", SAG_ENCODING_SRGB, 0, &ids[3]);
    assert_ptr_equal(again, sagi_world_picture(world, ids[0]));
    assert_int_equal(ids[3], ids[0]);
    assert_true(ids[0] != ids[1] && ids[1] != ids[2]);
    sag_image_clear(context, &image);
}

static void bytes_stay_bytes(void **state) {
    (void)state;
    sag_image image;
    assert_int_equal(sag_image_create(context, 512, 512, 3, &image, NULL), SAG_OK);
    for (size_t i = 0; i < (size_t)512 * 512 * 3; i++) image.pixels[i] = (float)(i % 251) / 251;
    assert_int_equal(sag_image_write(context, &image, in_folder("g.png"), NULL), SAG_OK);
    sag_image_clear(context, &image);
    size_t before, after;
    sag_context_memory(context, &before, NULL);
    sag_picture_id id;
    load("g.png", SAG_ENCODING_DEFAULT, 0, &id);
    sag_context_memory(context, &after, NULL);
    assert_true(after - before < (size_t)512 * 512 * 3 * 4 / 3 + 4096 + 40 * sizeof(sagi_picture));
}

static void what_is_missing_is_said(void **state) {
    (void)state;
    sag_error error = {0};
    sag_picture_id id = 7;
    assert_int_equal(
        sag_world_load_picture(world, in_folder("none.png"), SAG_ENCODING_DEFAULT, 0, &id, &error),
        SAG_ERROR_IO);
    assert_int_equal(id, 0);
    write_file(in_folder("text.png"), "not a picture", 13);
    assert_int_equal(
        sag_world_load_picture(world, in_folder("text.png"), SAG_ENCODING_DEFAULT, 0, &id, &error),
        SAG_ERROR_FORMAT);
    sag_image empty = {0};
    assert_int_equal(sag_world_add_picture(world, &empty), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(qoi_comes_back),
        cmocka_unit_test(damaged_qoi_is_an_error),
        cmocka_unit_test(every_format_shows_the_same),
        cmocka_unit_test(png_is_encoded_as_asked_for),
        cmocka_unit_test(bytes_stay_bytes),
        cmocka_unit_test(what_is_missing_is_said),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
