// SPDX-License-Identifier: MIT
// The scenes beside the project, beside the pictures that pbrt-v4 made of the very files (1024 samples a
// pixel): the mean luminance is the same but for the noise, and so are the means of blocks of 8 × 8 pixels.
// Eight pictures of one sample a pixel tell how much noise that is. Skipped where the scenes are not there.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include <cmocka.h>
// clang-format on
#include <sagitta/image.h>
#include <sagitta/render.h>

#include "support/mean.h"

enum { PICTURES = 8, BLOCK = 8, MOST_BLOCKS = 2048 };

static const struct {
    const char *name;
    uint32_t width, height;
} scenes[] = {{"cornell-box", 256, 256}, {"veach-mis", 400, 225},   {"spaceship", 400, 225},
              {"coffee", 240, 300},      {"dining-room", 400, 225}, {"staircase2", 256, 256}};

// The mean luminances of the blocks; returns how many.
static size_t blocks_of(const sag_image *image, double *blocks) {
    size_t count = 0;
    for (uint32_t y0 = 0; y0 < image->height; y0 += BLOCK)
        for (uint32_t x0 = 0; x0 < image->width; x0 += BLOCK) {
            mean m = {0};
            for (uint32_t y = y0; y < y0 + BLOCK && y < image->height; y++)
                for (uint32_t x = x0; x < x0 + BLOCK && x < image->width; x++) {
                    const float *p = image->pixels + ((size_t)y * image->width + x) * image->channels;
                    mean_add(&m, 0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2]);
                }
            assert_true(count < MOST_BLOCKS);
            blocks[count++] = mean_of(&m);
        }
    return count;
}

static void compare(sag_context *context, const char *folder, size_t which) {
    static double wanted[MOST_BLOCKS], got[MOST_BLOCKS];
    static mean means[MOST_BLOCKS];
    char path[1024];
    sag_error error;
    sag_image image;
    snprintf(path, sizeof path, "%s/scenes/reference/%s.exr", folder, scenes[which].name);
    if (sag_image_read(context, path, SAG_ENCODING_DEFAULT, &image, &error) != SAG_OK)
        fail_msg("%s", error.message);
    assert_true(image.width == scenes[which].width && image.height == scenes[which].height);
    const size_t count = blocks_of(&image, wanted);
    sag_image_clear(context, &image);
    sag_world *world = sag_world_create(context);
    snprintf(path, sizeof path, "%s/scenes/%s/scene-v4.pbrt", folder, scenes[which].name);
    if (sag_world_load(world, path, &error) != SAG_OK) fail_msg("%s: %s", path, error.message);
    sag_settings *settings = sag_world_settings(world);
    settings->film.width = scenes[which].width, settings->film.height = scenes[which].height;
    settings->samples_per_pixel = 1;
    mean whole = {0};
    for (size_t i = 0; i < count; i++) means[i] = (mean){0};
    for (uint64_t seed = 0; seed < PICTURES; seed++) {
        settings->seed = seed;
        sag_render *render = sag_render_create(world, &error);
        if (!render) fail_msg("%s", error.message);
        assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
        assert_int_equal(sag_render_get_image(render, &image, &error), SAG_OK);
        sag_render_destroy(render);
        blocks_of(&image, got);
        sag_image_clear(context, &image);
        double sum = 0;
        for (size_t i = 0; i < count; i++) mean_add(&means[i], got[i]), sum += got[i];
        mean_add(&whole, sum / (double)count);
    }
    sag_world_destroy(world);
    // Of normal errors the mean size is √(2/π) of the deviation. (Of eight numbers the deviation comes
    // out 3.5 % too small.)
    const double unbiased = sqrt(PICTURES / (PICTURES - 1.0));
    double reference = 0, apart = 0, noise = 0;
    for (size_t i = 0; i < count; i++) {
        reference += wanted[i] / (double)count;
        apart += fabs(mean_of(&means[i]) - wanted[i]);
        noise += sqrt(2 / 3.14159265358979323846) * unbiased * deviation_of(&means[i]) / 0.965;
    }
    const double ratio = mean_of(&whole) / reference, deviation = unbiased * deviation_of(&whole) / reference;
    print_message("%-12s luminance %.4f +- %.4f, blocks %.3f of what the noise makes (%.2f %%)\n",
                  scenes[which].name, ratio, deviation, apart / noise,
                  100 * apart / (double)count / reference);
    // Half a percent, and Student's t of eight numbers.
    assert_true(fabs(ratio - 1) < 0.005 + 7 * deviation && deviation < 0.04);
    assert_true(apart < 1.25 * noise);
}

static void pictures_are_those_of_pbrt(void **state) {
    (void)state;
    const char *data = getenv("SAGITTA_DATA"), *folder = data ? data : "../shared";
    char path[1024];
    snprintf(path, sizeof path, "%s/scenes/reference/coffee.exr", folder);
    if (access(path, R_OK) != 0) {
        print_message("SAGITTA_DATA is not there: skipped\n");
        skip();
    }
    sag_context *context = sag_context_create(NULL);
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) compare(context, folder, i);
    sag_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures_are_those_of_pbrt)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
