// SPDX-License-Identifier: MIT
// Mipmaps: 16-bit floats, encodings, means of the levels, wrapping, and what the filters make of pictures.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/mipmap.h"
#include "support/random.h"

#include <string.h>

static const sag_texture_filter all_filters[] = {SAG_LOOKUP_BILINEAR, SAG_LOOKUP_POINT, SAG_LOOKUP_TRILINEAR,
                                                 SAG_LOOKUP_EWA};

static sagi_lookup look(sag_texture_filter filter, sag_wrap wrap) {
    return (sagi_lookup){.filter = filter, .wrap = wrap, .max_anisotropy = 8};
}

// A mipmap of numbers made by a function of the place, each channel another.
static sagi_mipmap mipmap_of(sag_context *context, uint32_t width, uint32_t height, uint32_t channels,
                             float (*value)(uint32_t x, uint32_t y, uint32_t c)) {
    sag_image image = {0};
    assert_int_equal(sag_image_create(context, width, height, channels, &image, NULL), SAG_OK);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            for (uint32_t c = 0; c < channels; c++)
                image.pixels[((size_t)y * width + x) * channels + c] = value(x, y, c);
    sagi_mipmap mipmap;
    assert_int_equal(sagi_mipmap_init(&mipmap, context, &image, NULL), SAG_OK);
    sag_image_clear(context, &image);
    return mipmap;
}

static void halves_survive_and_others_round(void **state) {
    (void)state;
    for (uint32_t h = 0; h < 65536; h++) {
        const float f = sagi_half_to_float((uint16_t)h);
        if ((h & 0x7C00) == 0x7C00 && (h & 0x3FF)) {
            assert_true(isnan(f) && isnan(sagi_half_to_float(sagi_half_from_float(f))));
            continue;
        }
        assert_int_equal(sagi_half_from_float(f), h);
        if ((h & 0x7C00) == 0x7C00) continue;
        // Between this one and the next: the nearer, the even one in the middle.
        const float next = sagi_half_to_float((uint16_t)(h + 1)), middle = (f + next) / 2;
        if ((h & 0x7FFF) == 0x7BFF) continue; // next is infinite
        assert_int_equal(sagi_half_from_float(middle), h & 1 ? h + 1 : h);
        assert_int_equal(sagi_half_from_float(nextafterf(middle, f)), h);
        assert_int_equal(sagi_half_from_float(nextafterf(middle, next)), h + 1);
    }
    assert_true(sagi_half_to_float(0x3C00) == 1 && sagi_half_to_float(0x7BFF) == 65504);
    assert_true(sagi_half_to_float(1) == 0x1p-24F && sagi_half_to_float(0x8400) == -0x1p-14F);
    assert_int_equal(sagi_half_from_float(65519), 0x7BFF);
    assert_int_equal(sagi_half_from_float(65520), 0x7C00);
    assert_int_equal(sagi_half_from_float(-INFINITY), 0xFC00);
}

static float noisy(uint32_t x, uint32_t y, uint32_t c) {
    return (float)((x * 37 + y * 101 + c * 17) % 97) / 64 - 0.3F;
}
static float sixteenths(uint32_t x, uint32_t y, uint32_t c) { return (float)((x * 5 + y * 3 + c) % 16) / 16; }

static double mean_of_level(const sagi_mipmap *m, uint32_t l, int channel) {
    double sum = 0;
    for (uint32_t y = 0; y < m->levels[l].height; y++)
        for (uint32_t x = 0; x < m->levels[l].width; x++)
            sum += sagi_mipmap_texel(m, l, x, y, SAG_WRAP_CLAMP)[channel];
    return sum / m->levels[l].width / m->levels[l].height;
}

static void all_levels_have_the_same_mean(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    const uint32_t sizes[][2] = {{64, 64}, {75, 37}, {1, 100}, {129, 3}, {33, 256}, {1, 1}, {2, 3}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint32_t channels = 1; channels <= 4; channels++) {
            sagi_mipmap m = mipmap_of(context, sizes[i][0], sizes[i][1], channels, noisy);
            assert_int_equal(m.kind, SAGI_TEXEL_FLOAT);
            assert_int_equal(m.channels, channels == 2 ? 1 : channels);
            const sagi_level *top = &m.levels[m.level_count - 1];
            assert_true(top->width == 1 && top->height == 1);
            for (int c = 0; c < 4; c++) {
                const double mean = mean_of_level(&m, 0, c);
                for (uint32_t l = 1; l < m.level_count; l++)
                    assert_true(fabs(mean_of_level(&m, l, c) - mean) < 2e-6);
            }
            sagi_mipmap_clear(&m, context);
        }
    sag_context_destroy(context);
}

static void pictures_are_stored_compactly(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 64, 64, 3, sixteenths);
    assert_int_equal(m.kind, SAGI_TEXEL_HALF);
    assert_true(m.bytes < 64 * 64 * 3 * 2 * 1.34);
    assert_true(sagi_mipmap_texel(&m, 0, 5, 7, SAG_WRAP_CLAMP)[1] == sixteenths(5, 7, 1));
    sagi_mipmap_clear(&m, context);
    // An opaque fourth channel goes, another stays.
    uint8_t bytes[4 * 4];
    memset(bytes, 255, sizeof bytes);
    assert_int_equal(sagi_mipmap_init_bytes(&m, context, bytes, 2, 2, 4, (sagi_transfer){0}, NULL), SAG_OK);
    assert_true(m.channels == 3 && m.kind == SAGI_TEXEL_BYTE && m.bytes == 3 * 5);
    sagi_mipmap_clear(&m, context);
    bytes[3] = 0;
    assert_int_equal(sagi_mipmap_init_bytes(&m, context, bytes, 2, 2, 4, (sagi_transfer){0}, NULL), SAG_OK);
    assert_true(m.channels == 4);
    assert_true(sagi_mipmap_texel(&m, 0, 0, 0, SAG_WRAP_CLAMP)[3] == 0);
    assert_true(sagi_mipmap_texel(&m, 0, 1, 0, SAG_WRAP_CLAMP)[3] == 1);
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

// All bytes as one row: what they decode to, and that the levels above hold the nearest byte of the mean.
static void check_encoding(sag_context *context, sagi_transfer transfer, double (*decoded)(double)) {
    uint8_t bytes[512];
    for (int i = 0; i < 512; i++) bytes[i] = (uint8_t)(i / 2 + (i % 2 ? 1 : 0) * (i < 510));
    sagi_mipmap m;
    assert_int_equal(sagi_mipmap_init_bytes(&m, context, bytes, 512, 1, 1, transfer, NULL), SAG_OK);
    for (int i = 0; i < 512; i++) {
        const float value = sagi_mipmap_texel(&m, 0, i, 0, SAG_WRAP_CLAMP)[0];
        assert_true(fabs(value - decoded(bytes[i] / 255.0)) < 1e-7);
    }
    for (int i = 0; i < 256; i++) {
        // The mean of two neighbours is one of the two.
        const float low = sagi_mipmap_texel(&m, 0, 2 * i, 0, SAG_WRAP_CLAMP)[0];
        const float high = sagi_mipmap_texel(&m, 0, 2 * i + 1, 0, SAG_WRAP_CLAMP)[0];
        const float mean = sagi_mipmap_texel(&m, 1, i, 0, SAG_WRAP_CLAMP)[0];
        assert_true(mean == low || mean == high);
    }
    for (uint32_t l = 1; l < m.level_count; l++)
        assert_true(fabs(mean_of_level(&m, l, 0) - mean_of_level(&m, 0, 0)) < 0.006);
    sagi_mipmap_clear(&m, context);
}

static double power_22(double v) { return pow(v, 2.2); }
static double same(double v) { return v; }

static void encodings_are_exact(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    check_encoding(context, (sagi_transfer){SAG_ENCODING_DEFAULT, 0}, sag_srgb_decode);
    check_encoding(context, (sagi_transfer){SAG_ENCODING_SRGB, 0}, sag_srgb_decode);
    check_encoding(context, (sagi_transfer){SAG_ENCODING_LINEAR, 0}, same);
    check_encoding(context, (sagi_transfer){SAG_ENCODING_SRGB, 2.2}, power_22);
    sag_context_destroy(context);
}

static float numbered(uint32_t x, uint32_t y, uint32_t c) { return (float)(10 * y + x + 100 * c); }

static void texels_wrap_exactly(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 4, 4, 1, numbered);
    for (int y = -9; y < 13; y++)
        for (int x = -9; x < 13; x++) {
            const bool inside = x >= 0 && x < 4 && y >= 0 && y < 4;
            const int cx = x < 0 ? 0 : x > 3 ? 3 : x, cy = y < 0 ? 0 : y > 3 ? 3 : y;
            const int rx = ((x % 4) + 4) % 4, ry = ((y % 4) + 4) % 4;
            assert_true(sagi_mipmap_texel(&m, 0, x, y, SAG_WRAP_BLACK)[0] == (inside ? 10 * y + x : 0));
            assert_true(sagi_mipmap_texel(&m, 0, x, y, SAG_WRAP_CLAMP)[0] == 10 * cy + cx);
            assert_true(sagi_mipmap_texel(&m, 0, x, y, SAG_WRAP_REPEAT)[0] == 10 * ry + rx);
        }
    // Over each edge of the octahedral square to the mirrored texel on the same edge; over a corner to the
    // opposite one.
    for (int i = 0; i < 4; i++) {
        assert_true(sagi_mipmap_texel(&m, 0, -1, i, SAG_WRAP_OCTAHEDRAL)[0] == 10 * (3 - i));
        assert_true(sagi_mipmap_texel(&m, 0, 4, i, SAG_WRAP_OCTAHEDRAL)[0] == 10 * (3 - i) + 3);
        assert_true(sagi_mipmap_texel(&m, 0, i, -1, SAG_WRAP_OCTAHEDRAL)[0] == 3 - i);
        assert_true(sagi_mipmap_texel(&m, 0, i, 4, SAG_WRAP_OCTAHEDRAL)[0] == 30 + 3 - i);
    }
    assert_true(sagi_mipmap_texel(&m, 0, -1, -1, SAG_WRAP_OCTAHEDRAL)[0] == 33);
    assert_true(sagi_mipmap_texel(&m, 0, 4, -1, SAG_WRAP_OCTAHEDRAL)[0] == 30);
    // Any whole numbers give some texel.
    rng r = rng_make(1);
    for (int i = 0; i < 10000; i++) {
        const int64_t x = (int64_t)(rng_bits(&r) >> 2) - (INT64_C(1) << 61),
                      y = (int64_t)(rng_bits(&r) >> 30);
        const float value = sagi_mipmap_texel(&m, 0, x, y, i % 2 ? SAG_WRAP_OCTAHEDRAL : SAG_WRAP_REPEAT)[0];
        assert_true(value >= 0 && value <= 33);
    }
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

static float sevenths(uint32_t x, uint32_t y, uint32_t c) { return (void)x, (void)y, (float)(c + 1) / 7; }
static float board(uint32_t x, uint32_t y, uint32_t c) { return (void)c, (x + y) % 2 ? 1.0F : 0.0F; }
static float stripes(uint32_t x, uint32_t y, uint32_t c) { return (void)c, (void)x, (float)(y % 2); }

static sagi_spot_2d random_spot(rng *r) {
    return (sagi_spot_2d){.s = rng_uniform(r, -2, 2),
                          .t = rng_uniform(r, -2, 2),
                          .dsdx = rng_uniform(r, -1, 1) * rng_log_uniform(r, 1e-4, 1),
                          .dsdy = rng_uniform(r, -1, 1) * rng_log_uniform(r, 1e-4, 1),
                          .dtdx = rng_uniform(r, -1, 1) * rng_log_uniform(r, 1e-4, 1),
                          .dtdy = rng_uniform(r, -1, 1) * rng_log_uniform(r, 1e-4, 1)};
}

static void a_plain_picture_stays_plain(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 100, 60, 3, sevenths);
    rng r = rng_make(2);
    for (int i = 0; i < 20000; i++) {
        const sagi_spot_2d at = random_spot(&r);
        const sagi_lookup how = look(all_filters[i % 4], i % 3 ? SAG_WRAP_REPEAT : SAG_WRAP_CLAMP);
        const sagi_texel value = sagi_mipmap_lookup(&m, &how, &at);
        for (int c = 0; c < 3; c++) assert_true(fabsf(value[c] - (float)(c + 1) / 7) < 1e-5F);
        assert_true(fabsf(value[3] - 2.0F / 7) < 1e-5F);
    }
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

static void a_board_far_away_is_grey(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 256, 256, 1, board);
    rng r = rng_make(3);
    for (int i = 0; i < 5000; i++) {
        sagi_spot_2d at = random_spot(&r);
        at.dsdx = at.dtdy = rng_log_uniform(&r, 3.0 / 256, 0.5), at.dsdy = at.dtdx = 0;
        for (int f = 0; f < 4; f++) {
            const sagi_lookup how = look(all_filters[f], SAG_WRAP_REPEAT);
            assert_true(fabsf(sagi_mipmap_lookup(&m, &how, &at)[0] - 0.5F) < 1e-3F);
        }
    }
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

// Stripes along s at a slant: EWA averages along the ellipse only, the others all around.
static void ewa_keeps_what_lies_across_the_ellipse(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 256, 256, 1, stripes);
    const sagi_lookup ewa = look(SAG_LOOKUP_EWA, SAG_WRAP_REPEAT),
                      square = look(SAG_LOOKUP_TRILINEAR, SAG_WRAP_REPEAT);
    // The middle of a bright row (odd ones; row 101 from the top).
    sagi_spot_2d at = {.s = 0.3, .t = 1 - 101.5 / 256, .dsdx = 4.0 / 256, .dtdy = 0.5 / 256};
    assert_true(sagi_mipmap_lookup(&m, &ewa, &at)[0] > 0.65F);
    assert_true(fabsf(sagi_mipmap_lookup(&m, &square, &at)[0] - 0.5F) < 1e-3F);
    // The other way round, it is grey.
    at.dsdx = 0.5 / 256, at.dtdy = 4.0 / 256;
    assert_true(fabsf(sagi_mipmap_lookup(&m, &ewa, &at)[0] - 0.5F) < 0.01F);
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

static float smooth(uint32_t x, uint32_t y, uint32_t c) {
    return (float)(0.5 + 0.4 * sin(x * 0.0981747704246810387 + c) * cos(y * 0.0981747704246810387));
}

// A picture without detail looks the same through all filters while the footprint is small.
static void filters_agree_on_smooth_pictures(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 64, 64, 3, smooth);
    rng r = rng_make(4);
    for (int i = 0; i < 5000; i++) {
        sagi_spot_2d at = {.s = rng_uniform(&r, -2, 2), .t = rng_uniform(&r, -2, 2)};
        at.dsdx = rng_uniform(&r, -1, 1) / 64, at.dtdx = rng_uniform(&r, -1, 1) / 64;
        at.dsdy = rng_uniform(&r, -1, 1) / 64, at.dtdy = rng_uniform(&r, -1, 1) / 64;
        const sagi_spot_2d exact = {.s = at.s, .t = at.t};
        const sagi_lookup plain = look(SAG_LOOKUP_BILINEAR, SAG_WRAP_REPEAT);
        const sagi_texel value = sagi_mipmap_lookup(&m, &plain, &exact);
        for (int f = 0; f < 4; f++) {
            const sagi_lookup how = look(all_filters[f], SAG_WRAP_REPEAT);
            const sagi_texel other = sagi_mipmap_lookup(&m, &how, &at);
            for (int c = 0; c < 4; c++) assert_true(fabsf(other[c] - value[c]) < (f == 1 ? 0.09F : 0.04F));
        }
        // A point without an extent is a bilinear look at the picture itself.
        const sagi_lookup ewa = look(SAG_LOOKUP_EWA, SAG_WRAP_REPEAT);
        assert_true(sagi_mipmap_lookup(&m, &ewa, &exact)[0] == value[0]);
    }
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

static void nonsense_ends_well(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_mipmap m = mipmap_of(context, 40, 7, 1, sixteenths);
    const double odd[] = {0, -0.0, 1e-300, 0.25, 1, 1e8, -1e18, 1e300, INFINITY, -INFINITY, NAN};
    rng r = rng_make(5);
    for (int i = 0; i < 30000; i++) {
        double n[6];
        for (int k = 0; k < 6; k++) n[k] = odd[rng_below(&r, sizeof odd / sizeof *odd)];
        const sagi_spot_2d at = {n[0], n[1], n[2], n[3], n[4], n[5]};
        const sagi_lookup how = look(all_filters[i % 4], (sag_wrap)(i / 4 % 4));
        const float value = sagi_mipmap_lookup(&m, &how, &at)[0];
        assert_true(value >= 0 && value <= 1);
        if (!isfinite(n[0]) || !isfinite(n[1])) assert_true(value == 0);
    }
    const sagi_mipmap empty = {0};
    const sagi_lookup how = look(SAG_LOOKUP_EWA, SAG_WRAP_REPEAT);
    assert_true(sagi_mipmap_lookup(&empty, &how, &(sagi_spot_2d){.s = 0.5})[0] == 0);
    sagi_mipmap_clear(&m, context);
    sag_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(halves_survive_and_others_round),
        cmocka_unit_test(all_levels_have_the_same_mean),
        cmocka_unit_test(pictures_are_stored_compactly),
        cmocka_unit_test(encodings_are_exact),
        cmocka_unit_test(texels_wrap_exactly),
        cmocka_unit_test(a_plain_picture_stays_plain),
        cmocka_unit_test(a_board_far_away_is_grey),
        cmocka_unit_test(ewa_keeps_what_lies_across_the_ellipse),
        cmocka_unit_test(filters_agree_on_smooth_pictures),
        cmocka_unit_test(nonsense_ends_well),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
