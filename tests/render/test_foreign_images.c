// SPDX-License-Identifier: MIT
// Pictures that the libraries we read them with have trouble with, byte by byte: those that are whole are
// read, those that are damaged are an error, soon.
#define _DEFAULT_SOURCE // mkstemp
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <sagitta/image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/context.h"

enum { WIDTH = 12, HEIGHT = 3 };

typedef struct bytes {
    size_t count;
    uint8_t at[4096];
} bytes;

static void put(bytes *b, const void *from, size_t count) {
    assert_true(b->count + count <= sizeof b->at);
    memcpy(b->at + b->count, from, count);
    b->count += count;
}
static void put_number(bytes *b, uint64_t number, size_t count) { // little-endian
    for (size_t i = 0; i < count; i++) put(b, &(uint8_t){(uint8_t)(number >> 8 * i)}, 1);
}
static void put_text(bytes *b, const char *text) { put(b, text, strlen(text) + 1); }

static sag_status read_image(const bytes *b, sag_image *image, sag_error *error) {
    char path[] = "/tmp/sagitta-foreign-XXXXXX";
    const int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, b->at, b->count), b->count);
    close(file);
    const sag_status status = sag_image_read(context, path, SAG_ENCODING_DEFAULT, image, error);
    unlink(path);
    return status;
}

static void put_attribute(bytes *b, const char *name, const char *type, const uint32_t *words, size_t count) {
    put_text(b, name), put_text(b, type);
    put_number(b, 4 * count, 4);
    for (size_t i = 0; i < count; i++) put_number(b, words[i], 4);
}

// An EXR file of scan lines without compression, its channels of one letter each and halves; the one called
// `marked` is 1 everywhere, the others 0.
static bytes make_exr(const char *letters, char marked) {
    bytes b = {.count = 0};
    const uint32_t channels = (uint32_t)strlen(letters), window[4] = {0, 0, WIDTH - 1, HEIGHT - 1};
    put_number(&b, 20000630, 4), put_number(&b, 2, 4);
    put_text(&b, "channels"), put_text(&b, "chlist"), put_number(&b, channels * 18 + 1, 4);
    for (uint32_t c = 0; c < channels; c++) {
        put(&b, &letters[c], 1), put_number(&b, 0, 1);
        put_number(&b, 1, 4), put_number(&b, 0, 4), put_number(&b, 1, 4), put_number(&b, 1, 4);
    }
    put_number(&b, 0, 1);
    put_text(&b, "compression"), put_text(&b, "compression"), put_number(&b, 1, 4), put_number(&b, 0, 1);
    put_attribute(&b, "dataWindow", "box2i", window, 4);
    put_attribute(&b, "displayWindow", "box2i", window, 4);
    put_text(&b, "lineOrder"), put_text(&b, "lineOrder"), put_number(&b, 1, 4), put_number(&b, 0, 1);
    put_attribute(&b, "pixelAspectRatio", "float", &(uint32_t){0x3F800000}, 1);
    put_attribute(&b, "screenWindowCenter", "v2f", (uint32_t[]){0, 0}, 2);
    put_attribute(&b, "screenWindowWidth", "float", &(uint32_t){0x3F800000}, 1);
    put_number(&b, 0, 1);
    const size_t line = 2 * WIDTH * channels, table = b.count;
    for (size_t y = 0; y < HEIGHT; y++) put_number(&b, table + 8 * HEIGHT + y * (8 + line), 8);
    for (size_t y = 0; y < HEIGHT; y++) {
        put_number(&b, y, 4), put_number(&b, line, 4);
        for (uint32_t c = 0; c < channels; c++)
            for (int x = 0; x < WIDTH; x++) put_number(&b, letters[c] == marked ? 0x3C00 : 0, 2);
    }
    return b;
}

// openexr-1991: of three or four channels of halves one is wanted; the library wrote to all of them. Layers
// such as positions, X Y Z, are like that.
static void openexr_1991_some_channels_of_halves(void **state) {
    (void)state;
    static const struct {
        const char *letters;
        char marked;
        uint32_t channels;
    } files[] = {{"XYZ", 'Y', 1}, {"ABC", 'A', 1},  {"BGRZ", 'G', 3}, {"AYZ", 'Y', 2},
                 {"BGZ", 'B', 1}, {"ABGR", 'R', 4}, {"UVWY", 'Y', 1}, {"BGR", 'G', 3}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const bytes b = make_exr(files[i].letters, files[i].marked);
        sag_image image;
        sag_error error;
        if (read_image(&b, &image, &error) != SAG_OK) fail_msg("%s: %s", files[i].letters, error.message);
        assert_int_equal(image.channels, files[i].channels);
        float sum = 0;
        for (size_t k = 0; k < (size_t)WIDTH * HEIGHT * image.channels; k++) sum += image.pixels[k];
        assert_true(sum == WIDTH * HEIGHT);
        sag_image_clear(context, &image);
    }
}

// A Radiance picture whose lines are runs: cut anywhere, and with runs of no length, which stb_image took for
// ever and again once the file was over.
static void hdr_runs_end(void **state) {
    (void)state;
    bytes whole = {.count = 0};
    static const char head[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 12\n";
    put(&whole, head, sizeof head - 1);
    for (int y = 0; y < HEIGHT; y++) {
        put(&whole, "\x02\x02\x00\x0C", 4);
        for (int c = 0; c < 4; c++) put(&whole, "\x88\x80\x04\x80\x80\x80\x80", 7); // a run of 8, and 4
    }
    sag_image image;
    sag_error error;
    assert_int_equal(read_image(&whole, &image, &error), SAG_OK);
    assert_true(image.width == WIDTH && image.height == HEIGHT && image.channels == 3);
    sag_image_clear(context, &image);
    for (size_t cut = sizeof head - 1; cut < whole.count; cut++) {
        bytes part = whole;
        part.count = cut;
        assert_int_equal(read_image(&part, &image, &error), SAG_ERROR_FORMAT);
        for (int turn = 0; turn < 2; turn++) { // and a byte that is 0, or more than is left
            part = whole;
            part.at[cut] = turn == 0 ? 0 : 0xFF;
            if (read_image(&part, &image, &error) == SAG_OK) sag_image_clear(context, &image);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(openexr_1991_some_channels_of_halves),
        cmocka_unit_test(hdr_runs_end),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
