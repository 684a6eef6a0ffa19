// SPDX-License-Identifier: MIT
// Densities on a grid, cut to windows: the integral is that of the cells in it, samples are within the window
// and as frequent as the density says.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/window.h"
#include "support/random.h"

#include <sagitta/base.h>
#include <string.h>

enum { WIDTH = 9, HEIGHT = 6, BINS = 12, SAMPLES = 100000 };

static void samples_follow_the_window(void **state) {
    (void)state;
    rng r = rng_make(1);
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = 1});
    for (int k = -2; k < 8; k++) { // −1: the way for the whole square; −2: with its guide
        double weights[WIDTH * HEIGHT];
        for (int i = 0; i < WIDTH * HEIGHT; i++) weights[i] = rng_one_in(&r, 3) ? 0 : rng_unit(&r);
        sagi_window_table table;
        assert_true(sagi_window_table_init(&table, context, weights, WIDTH, HEIGHT));
        if (k == -2) assert_true(sagi_window_table_guide(&table, context));
        const double a = rng_unit(&r), b = rng_unit(&r), c = rng_unit(&r), d = rng_unit(&r);
        const sagi_window window = k <= 0 ? (sagi_window){{0, 0}, {1, 1}}
                                          : (sagi_window){{fmin(a, b), fmin(c, d)}, {fmax(a, b), fmax(c, d)}};
        double sum = 0;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const double w = fmin(window.high.x * WIDTH, x + 1) - fmax(window.low.x * WIDTH, x),
                             h = fmin(window.high.y * HEIGHT, y + 1) - fmax(window.low.y * HEIGHT, y);
                if (w > 0 && h > 0) sum += weights[y * WIDTH + x] * w * h / (WIDTH * HEIGHT);
            }
        assert_true(fabs(sagi_window_integral(&table, &window) - sum) < 1e-12);
        double counts[BINS][BINS];
        memset(counts, 0, sizeof counts);
        for (int i = 0; i < SAMPLES; i++) {
            sag_vec2 p;
            if (k < 0) {
                double pdf;
                size_t cell;
                assert_true(sagi_window_sample_whole(&table, rng_vec2(&r), &p, &pdf, &cell));
                assert_true(cell == (size_t)(p.y * HEIGHT) * WIDTH + (size_t)(p.x * WIDTH));
                assert_true(pdf == sagi_window_pdf_whole(&table, cell));
                assert_true(fabs(pdf / sagi_window_pdf(&table, &window, p) - 1) < 1e-12);
            } else {
                assert_true(sagi_window_sample(&table, &window, rng_vec2(&r), &p));
            }
            assert_true(p.x >= window.low.x && p.x <= window.high.x);
            assert_true(p.y >= window.low.y && p.y <= window.high.y);
            assert_true(sagi_window_pdf(&table, &window, p) > 0);
            const double x = (p.x - window.low.x) / (window.high.x - window.low.x),
                         y = (p.y - window.low.y) / (window.high.y - window.low.y);
            counts[(int)fmin(y * BINS, BINS - 1)][(int)fmin(x * BINS, BINS - 1)]++;
        }
        const double bin_x = (window.high.x - window.low.x) / BINS,
                     bin_y = (window.high.y - window.low.y) / BINS;
        double chi = 0, total = 0;
        int used = 0;
        for (int y = 0; y < BINS; y++)
            for (int x = 0; x < BINS; x++) {
                const sagi_window bin = {{window.low.x + x * bin_x, window.low.y + y * bin_y},
                                         {window.low.x + (x + 1) * bin_x, window.low.y + (y + 1) * bin_y}};
                double mean = 0; // of the density over the bin
                for (int i = 0; i < 400; i++) {
                    const sag_vec2 p = {bin.low.x + (i % 20 + 0.5) / 20 * bin_x,
                                        bin.low.y + (i / 20 + 0.5) / 20 * bin_y};
                    mean += sagi_window_pdf(&table, &window, p) / 400;
                }
                total += mean * bin_x * bin_y;
                const double n = sagi_window_integral(&table, &bin) / sum * SAMPLES;
                assert_true(fabs(mean * bin_x * bin_y * SAMPLES - n) < 0.1 * n + 0.02 * SAMPLES / BINS);
                if (n > 5) chi += (counts[y][x] - n) * (counts[y][x] - n) / n, used++;
                if (n == 0) assert_true(counts[y][x] < 2);
            }
        assert_true(fabs(total - 1) < 0.02);
        assert_true((chi - used) / sqrt(2.0 * used) < 5);
        sagi_window_table_clear(&table, context);
    }
    sag_context_destroy(context);
}

static void empty_windows(void **state) {
    (void)state;
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = 1});
    const double weights[4] = {0, 1, 0, 0};
    sagi_window_table table;
    sag_vec2 p;
    assert_true(sagi_window_table_init(&table, context, weights, 2, 2));
    assert_false(sagi_window_sample(&table, &(sagi_window){{0, 0}, {0.5, 1}}, (sag_vec2){0.5, 0.5}, &p));
    assert_false(
        sagi_window_sample(&table, &(sagi_window){{0.7, 0.2}, {0.7, 0.2}}, (sag_vec2){0.5, 0.5}, &p));
    assert_true(sagi_window_sample(&table, &(sagi_window){{0.25, 0.25}, {0.75, 1}}, (sag_vec2){0, 1}, &p));
    assert_true(p.x >= 0.5 && p.y <= 0.5);
    sagi_window_table_clear(&table, context);
    sag_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_follow_the_window),
        cmocka_unit_test(empty_windows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
