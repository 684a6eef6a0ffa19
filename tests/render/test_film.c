// SPDX-License-Identifier: MIT
// The film: parts of it, bright samples, weights of both signs.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "base/cpu.h"
#include "render/film.h"
#include "support/picture.h"
#include <stdlib.h>
#include <string.h>

// A part of the film has the bits that it has in the whole picture: paths and glances, whatever the sampler
// and filter.
static void crop_is_the_cut_of_the_whole(void **state) {
    (void)state;
    const sag_sampler_kind samplers[] = {SAG_SAMPLER_INDEPENDENT, SAG_SAMPLER_STRATIFIED,
                                         SAG_SAMPLER_SOBOL,       SAG_SAMPLER_PADDED_SOBOL,
                                         SAG_SAMPLER_ZSOBOL,      SAG_SAMPLER_HALTON};
    const sag_filter_kind filters[] = {SAG_FILTER_BOX,      SAG_FILTER_TRIANGLE, SAG_FILTER_GAUSSIAN,
                                       SAG_FILTER_MITCHELL, SAG_FILTER_SINC,     SAG_FILTER_SINC};
    for (int k = 0; k < 6; k++) {
        for (int depth = 0; depth < 2; depth++) {
            studio s = studio_open(k % 2 ? 1 : 2);
            studio_furnish(&s);
            s.settings->sampler = samplers[k];
            s.settings->film.filter = filters[k];
            if (depth) s.settings->integrator = SAG_INTEGRATOR_DEPTH;
            sag_render_stats stats;
            sag_image whole = studio_render(&s, &stats);
            sag_film *film = &s.settings->film;
            const uint32_t bounds[4] = {7, 41, 13, 99};
            memcpy(film->pixel_bounds, bounds, sizeof bounds);
            if (k == 2) { // the same by shares, which go before pixels
                const double window[4] = {6.5 / 45, 40.5 / 45, 12.2 / 35, 1};
                memcpy(film->crop_window, window, sizeof window);
                film->pixel_bounds[0] = 0;
            }
            sag_image part = studio_render(&s, &stats);
            assert_true(part.width == 34 && part.height == 22);
            assert_int_equal(stats.camera_samples, 34 * 22 * 7);
            for (uint32_t y = 0; y < 22; y++)
                assert_memory_equal(part.pixels + (size_t)y * 34 * 3,
                                    whole.pixels + ((size_t)(y + 13) * 45 + 7) * 3, 34 * 3 * sizeof(float));
            sag_image_clear(s.context, &whole);
            sag_image_clear(s.context, &part);
            studio_close(&s);
        }
    }
}

static void impossible_films_are_errors(void **state) {
    (void)state;
    const sag_film bad[] = {
        {.pixel_bounds = {5, 5, 0, 9}},
        {.pixel_bounds = {1000, 2000, 0, 9}},
        {.crop_window = {0.5, 0.25, 0, 1}},
        {.crop_window = {0, (double)NAN, 0, 1}},
        {.max_component = -1},
        {.max_component = (double)NAN},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        studio s = studio_open(1);
        s.settings->film = bad[i];
        s.settings->film.width = s.settings->film.height = 16;
        sag_error error;
        assert_null(sag_render_create(s.world, &error));
        assert_int_equal(error.status, SAG_ERROR_ARGUMENT);
        studio_close(&s);
    }
}

// A sample brighter than allowed is dimmed, its colour kept; the others are left alone.
static void bright_samples_are_dimmed(void **state) {
    (void)state;
    sagi_pixel pixel = {0};
    assert_true(sagi_pixel_add(&pixel, 1, (sag_rgb){8, 2, 4}, 4));
    assert_true(pixel.r == 4 && pixel.g == 1 && pixel.b == 2);
    assert_true(sagi_pixel_add(&pixel, 1, (sag_rgb){4, 1, 1}, 4));
    assert_true(pixel.r == 8 && pixel.g == 2 && pixel.weight == 2 && pixel.count == 2);
    assert_false(sagi_pixel_add(&pixel, 1, (sag_rgb){(double)INFINITY, 1, 1}, 4));
    assert_int_equal(pixel.count, 2);
    studio s = studio_open(1);
    studio_furnish(&s);
    sag_render_stats stats;
    s.settings->film.max_component = 0.125;
    sag_image image = studio_render(&s, &stats);
    float most = 0;
    for (size_t i = 0; i < (size_t)45 * 35 * 3; i++) most = fmaxf(most, image.pixels[i]);
    assert_true(most > 0.1F && most < 0.3F); // of the sensor's components, not the picture's
    sag_image_clear(s.context, &image);
    // But distances are kept.
    s.settings->integrator = SAG_INTEGRATOR_DEPTH;
    image = studio_render(&s, &stats);
    for (size_t i = 0; i < (size_t)45 * 35 * 3; i++) most = fmaxf(most, image.pixels[i]);
    assert_true(most > 1);
    sag_image_clear(s.context, &image);
    studio_close(&s);
}

// Weights of both signs: what is the same everywhere stays the same, with one sample or many.
static void negative_lobes_keep_what_is_even(void **state) {
    (void)state;
    for (uint32_t spp = 1; spp < 20; spp++) {
        studio s = studio_open(1);
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
        s.settings->film.filter = SAG_FILTER_SINC;
        s.settings->sampler = SAG_SAMPLER_ZSOBOL;
        s.settings->samples_per_pixel = spp;
        sag_render_stats stats;
        sag_image image = studio_render(&s, &stats);
        uint32_t off = 0;
        for (size_t i = 0; i < (size_t)32 * 32 * 3; i++) {
            off += fabsf(image.pixels[i] - 1) > 1e-5F;
        }
        // 3072 numbers. Equally many of both signs leave nothing to divide by; that becomes rare.
        assert_true(off <= (spp < 6 && spp % 2 ? 0 : spp < 16 ? 1200 : 120));
        sag_image_clear(s.context, &image);
        studio_close(&s);
    }
}

// The kernels of every instruction set give the same picture, whatever the sampler.
static void instruction_sets_change_no_bit(void **state) {
    (void)state;
    static const char *const names[] = {"portable", "sse42", "avx2", "avx512", "neon"};
    for (sag_sampler_kind kind = SAG_SAMPLER_INDEPENDENT; kind <= SAG_SAMPLER_HALTON; kind++) {
        studio best = studio_open(2);
        studio_furnish(&best);
        best.settings->sampler = kind;
        sag_image expected = studio_render(&best, NULL);
        for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
            sagi_isa isa;
            if (!sagi_isa_choose(names[i], &isa)) continue;
            assert_int_equal(setenv("SAG_ISA", names[i], 1), 0);
            studio s = studio_open(1);
            assert_int_equal(unsetenv("SAG_ISA"), 0);
            assert_string_equal(sag_context_isa(s.context), names[i]);
            studio_furnish(&s);
            s.settings->sampler = kind;
            sag_image image = studio_render(&s, NULL);
            assert_true(same_picture(&expected, &image));
            sag_image_clear(s.context, &image);
            studio_close(&s);
        }
        sag_image_clear(best.context, &expected);
        studio_close(&best);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crop_is_the_cut_of_the_whole),     cmocka_unit_test(instruction_sets_change_no_bit),
        cmocka_unit_test(impossible_films_are_errors),      cmocka_unit_test(bright_samples_are_dimmed),
        cmocka_unit_test(negative_lobes_keep_what_is_even),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
