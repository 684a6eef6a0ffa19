// SPDX-License-Identifier: MIT
// Pictures beside references that this program made of many samples (tests/data: the means of blocks of 8 × 8
// pixels, as PFM): every block must be the reference's but for the noise, which several pictures of other
// random numbers tell; so must all blocks together, and their mean. A change that moves the mean of any of
// them is found here, wherever it was made; that the references are right is for other tests to say.
//
// Where pictures change on purpose: SAGITTA_MAKE_REFERENCES=NAME test_references makes the reference anew
// ("all" makes all), to be looked at and committed.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
// clang-format on
#include <sagitta/image.h>

#include "support/mean.h"
#include "support/scene_files.h"
#include "support/scene_text.h"

enum {
    WIDTH = 64,
    HEIGHT = 48,
    BLOCK = 8,
    COLUMNS = WIDTH / BLOCK,
    ROWS = HEIGHT / BLOCK,
    VALUES = COLUMNS * ROWS * 3,
    PICTURES = 24,
    SAMPLES = 2,
    REFERENCE_PICTURES = 300
};

static const struct {
    const char *name, *scene;
    int integrator; // −1: the scene's
} cases[] = {
    {"lights", "lights.pbrt", -1},
    {"materials", "materials.pbrt", -1},
    {"media", "media.pbrt", -1},
    {"textures", "textures.pbrt", -1},
    {"instances", "instances.pbrt", -1},
    {"subdivided", "subdivided.pbrt", -1},
    {"everything-volpath", "everything.pbrt", SAG_INTEGRATOR_VOLPATH},
    {"everything-path", "everything.pbrt", SAG_INTEGRATOR_PATH},
    {"everything-direct", "everything.pbrt", SAG_INTEGRATOR_DIRECT},
    {"subdivided-lightpath", "subdivided.pbrt", SAG_INTEGRATOR_LIGHTPATH},
    {"everything-ao", "everything.pbrt", SAG_INTEGRATOR_AO},
    {"everything-normal", "everything.pbrt", SAG_INTEGRATOR_NORMAL},
    {"everything-uv", "everything.pbrt", SAG_INTEGRATOR_UV},
    {"everything-depth", "everything.pbrt", SAG_INTEGRATOR_DEPTH},
    {"everything-id", "everything.pbrt", SAG_INTEGRATOR_ID},
    {"everything-albedo", "everything.pbrt", SAG_INTEGRATOR_ALBEDO},
};

static sag_world *open_scene(const char *scene, int integrator) {
    sag_world *world = sag_world_create(scene_context);
    sag_error error;
    if (sag_world_load(world, scene_path(scene), &error) != SAG_OK) fail_msg("%s: %s", scene, error.message);
    sag_settings *s = sag_world_settings(world);
    s->film.width = WIDTH, s->film.height = HEIGHT;
    memset(s->film.crop_window, 0, sizeof s->film.crop_window);
    memset(s->film.pixel_bounds, 0, sizeof s->film.pixel_bounds);
    memset(s->camera.screen_window, 0, sizeof s->camera.screen_window);
    s->film.max_component = 10; // rare bright samples would be missing from mean and deviation alike
    // Curves that are negative in parts divide by sums that few samples make uncertain.
    if (s->film.filter == SAG_FILTER_MITCHELL || s->film.filter == SAG_FILTER_SINC) {
        s->film.filter = SAG_FILTER_GAUSSIAN;
        s->film.filter_radius_x = s->film.filter_radius_y = 0;
    }
    if (integrator >= 0) s->integrator = (sag_integrator_kind)integrator;
    // (Light that is followed from the lamps comes in few large pieces.)
    if (s->integrator == SAG_INTEGRATOR_LIGHTPATH) s->film.max_component = 0;
    return world;
}

// The means of the blocks, from the top left.
static void shoot(sag_world *world, uint32_t samples, uint64_t seed, float blocks[VALUES]) {
    sag_settings *s = sag_world_settings(world);
    s->samples_per_pixel = samples, s->strata_x = s->strata_y = 0;
    s->seed = seed;
    sag_error error;
    sag_image image;
    sag_render *render = sag_render_create(world, &error);
    if (!render) fail_msg("%s", error.message);
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_int_equal(sag_render_get_image(render, &image, &error), SAG_OK);
    sag_render_destroy(render);
    double sums[VALUES] = {0};
    for (size_t y = 0; y < HEIGHT; y++)
        for (size_t x = 0; x < WIDTH; x++)
            for (size_t c = 0; c < 3; c++)
                sums[(y / BLOCK * COLUMNS + x / BLOCK) * 3 + c] +=
                    (double)image.pixels[(y * WIDTH + x) * image.channels + c];
    for (int i = 0; i < VALUES; i++) blocks[i] = (float)(sums[i] / (BLOCK * BLOCK));
    sag_image_clear(scene_context, &image);
}

static void make_reference(const char *path, sag_world *world) {
    sag_image image;
    sag_error error;
    assert_int_equal(sag_image_create(scene_context, COLUMNS, ROWS, 3, &image, &error), SAG_OK);
    // As many small pictures: what textures show depends a little on the samples that a pixel has.
    double sums[VALUES] = {0};
    for (uint64_t seed = 0; seed < REFERENCE_PICTURES; seed++) {
        float blocks[VALUES];
        shoot(world, SAMPLES, 1000 + seed, blocks);
        for (int i = 0; i < VALUES; i++) sums[i] += (double)blocks[i];
    }
    for (int i = 0; i < VALUES; i++) image.pixels[i] = (float)(sums[i] / REFERENCE_PICTURES);
    if (sag_image_write(scene_context, &image, path, &error) != SAG_OK) fail_msg("%s", error.message);
    sag_image_clear(scene_context, &image);
}

static int compare(const char *name, const char *path, sag_world *world) {
    sag_image wanted;
    sag_error error;
    if (sag_image_read(scene_context, path, SAG_ENCODING_LINEAR, &wanted, &error) != SAG_OK)
        fail_msg("%s", error.message);
    assert_true(wanted.width == COLUMNS && wanted.height == ROWS && wanted.channels == 3);
    static mean means[VALUES];
    memset(means, 0, sizeof means);
    mean whole = {0};
    for (uint64_t seed = 0; seed < PICTURES; seed++) {
        float blocks[VALUES];
        double sum = 0;
        shoot(world, SAMPLES, seed, blocks);
        for (int i = 0; i < VALUES; i++) {
            mean_add(&means[i], (double)blocks[i]);
            sum += (double)blocks[i];
        }
        mean_add(&whole, sum / VALUES);
    }
    // Of 24 numbers the deviation itself is known to a seventh: Student's t, which is beyond 8 by a chance of
    // 4e-8; its square's mean is 23/21. The reference has noise too.
    const double unbiased = PICTURES / (PICTURES - 1.0), noise = 1 + (double)PICTURES / REFERENCE_PICTURES;
    double squares = 0, wanted_whole = 0, brightest = 0;
    int used = 0, wrong = 0;
    for (int i = 0; i < VALUES; i++) brightest = fmax(brightest, (double)wanted.pixels[i]);
    for (int i = 0; i < VALUES; i++) {
        const double reference = (double)wanted.pixels[i];
        // (What hardly varies is right to a float's precision, or a rare sample's share.)
        const double deviation = sqrt(unbiased * noise) * deviation_of(&means[i]) + 1e-5 * brightest;
        const double z = (mean_of(&means[i]) - reference) / deviation;
        if (!(fabs(z) < 8)) {
            print_message("%s: block %d, %d of channel %d is %g +- %g instead of %g\n", name, i / 3 % COLUMNS,
                          i / 3 / COLUMNS, i % 3, mean_of(&means[i]), deviation, reference);
            wrong++;
        }
        squares += z * z, used++;
        wanted_whole += reference / VALUES;
    }
    const double z = (mean_of(&whole) - wanted_whole) /
                     (sqrt(unbiased * noise) * deviation_of(&whole) + 1e-6 * wanted_whole);
    // Channels and neighbours go together: as many independent numbers as there are blocks at the least.
    const double mean_square = squares / used, most = 23.0 / 21 + 6 * sqrt(2.5 * 3 / used);
    if (!(fabs(z) < 6) || !(mean_square < most)) {
        print_message("%s: mean %g +- %g instead of %g, mean square deviation %g\n", name, mean_of(&whole),
                      deviation_of(&whole), wanted_whole, mean_square);
        wrong++;
    }
    sag_image_clear(scene_context, &wanted);
    return wrong;
}

static void pictures_are_their_references(void **state) {
    (void)state;
    const char *make = getenv("SAGITTA_MAKE_REFERENCES");
    int wrong = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const bool chosen = make && (strcmp(make, "all") == 0 || strcmp(make, cases[i].name) == 0);
        if (make && !chosen) continue;
        char path[1024];
        snprintf(path, sizeof path, SAGITTA_REFERENCES "/%s.pfm", cases[i].name);
        sag_world *world = open_scene(cases[i].scene, cases[i].integrator);
        if (chosen)
            make_reference(path, world);
        else
            wrong += compare(cases[i].name, path, world);
        sag_world_destroy(world);
    }
    assert_int_equal(wrong, 0);
}

static int setup(void **state) {
    if (scene_setup(state) != 0) return 1;
    scene_copy_files();
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(pictures_are_their_references)};
    return cmocka_run_group_tests(tests, setup, scene_teardown);
}
