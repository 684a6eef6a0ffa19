// SPDX-License-Identifier: MIT
// Many lamps cost little more than one: the noise of a thousand, at as many samples, is not far from that of
// one when they are chosen by the tree, and far above it when they are chosen alike. The mean is the same
// however they are chosen.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "support/picture.h"
#include "support/random.h"

#include <stdio.h>

// A floor 40 wide under a ceiling of small square lamps that look down (and some up), `side` to a side; the
// picture is a patch of the floor in the middle.
static studio hall(int side, sag_light_sampler sampler, uint32_t samples) {
    studio s = studio_open(0);
    s.settings->light_sampler = sampler;
    s.settings->integrator = SAG_INTEGRATOR_DIRECT;
    s.settings->samples_per_pixel = samples;
    s.settings->film.width = s.settings->film.height = 16;
    const sag_vec3 eye = {0, 3, 4}, target = {0, 0, 0};
    studio_aim(&s, eye, target);
    sag_add_plane(s.scene, &(sag_plane){.normal = {0, 1, 0}});
    for (int i = 0; i < side * side; i++) {
        const double step = 40.0 / side, x = (i % side + 0.5) * step - 20, z = (i / side + 0.5) * step - 20,
                     h = side == 1 ? 0.2 : 0.2;
        const sag_rectangle lamp = {{x - h, 2, z - h}, {2 * h, 0, 0}, {0, 0, 2 * h}};
        const uint32_t id = sag_add_rectangle(s.scene, &lamp);
        const sag_appearance look = {.emission = {10, 10, 10}, .flip = i % 5 == 0 && side > 1};
        assert_int_equal(sag_world_set_appearance(s.world, s.scene, id, &look), SAG_OK);
    }
    return s;
}

// The mean of the pixels and, against a converged picture, their mean square error relative to it.
static double relative_error(int side, sag_light_sampler sampler, uint32_t samples, double *mean_value) {
    studio fine = hall(side, SAG_LIGHT_SAMPLER_BVH, 512), coarse = hall(side, sampler, samples);
    coarse.settings->seed = 5;
    sag_image a = studio_render(&fine, NULL), b = studio_render(&coarse, NULL);
    double squares = 0, sum = 0, level = 0;
    const size_t count = (size_t)a.width * a.height;
    for (size_t i = 0; i < count; i++) {
        const double x = (double)a.pixels[3 * i], y = (double)b.pixels[3 * i];
        squares += (x - y) * (x - y), sum += y, level += x;
    }
    sag_image_clear(fine.context, &a);
    sag_image_clear(coarse.context, &b);
    studio_close(&fine);
    studio_close(&coarse);
    *mean_value = sum / (double)count;
    return sqrt(squares / (double)count) / (level / (double)count);
}

static void a_thousand_lamps(void **state) {
    (void)state;
    double mean, many_mean, power_mean, alike_mean;
    const double one = relative_error(1, SAG_LIGHT_SAMPLER_BVH, 16, &mean);
    const double many = relative_error(32, SAG_LIGHT_SAMPLER_BVH, 16, &many_mean);
    const double power = relative_error(32, SAG_LIGHT_SAMPLER_POWER, 16, &power_mean);
    const double alike = relative_error(32, SAG_LIGHT_SAMPLER_UNIFORM, 16, &alike_mean);
    print_message("error of one lamp %.3f; of 1024: %.3f by the tree, %.3f by power, %.3f alike\n", one, many,
                  power, alike);
    assert_true(many < 0.35 * alike); // an eighth of the samples for the same noise
    assert_true(fabs(power_mean / many_mean - 1) < 0.2 && fabs(alike_mean / many_mean - 1) < 0.2);
}

static void the_mean_does_not_depend_on_the_sampler(void **state) {
    (void)state;
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_LIGHTS; strategy++) {
        studio_mean means[3];
        for (int k = 0; k < 3; k++) {
            studio s = hall(5, (sag_light_sampler)k, 512);
            s.settings->seed = (uint64_t)k + 10;
            s.settings->strategy = (sag_strategy)strategy;
            sag_world_add_light(
                s.world, &(sag_light){.kind = SAG_LIGHT_POINT, .color = {30, 30, 30}, .from = {3, 2, 1}});
            sag_world_add_light(
                s.world, &(sag_light){.kind = SAG_LIGHT_DISTANT, .color = {1, 1, 1}, .from = {1, 5, 0}});
            sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_SPOT,
                                                      .color = {40, 40, 40},
                                                      .from = {-2, 3, 0},
                                                      .to = {0, 0, 0},
                                                      .cone_rad = 0.6,
                                                      .cone_delta_rad = 0.3});
            sag_image image = studio_render(&s, NULL);
            const size_t count = (size_t)image.width * image.height;
            double sum = 0;
            for (size_t i = 0; i < count; i++) sum += (double)image.pixels[3 * i];
            means[k].mean = sum / (double)count;
            sag_image_clear(s.context, &image);
            studio_close(&s);
        }
        if (!(fabs(means[1].mean / means[0].mean - 1) < 0.02 &&
              fabs(means[2].mean / means[0].mean - 1) < 0.02))
            fail_msg("strategy %d: %g %g %g", strategy, means[0].mean, means[1].mean, means[2].mean);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_thousand_lamps),
        cmocka_unit_test(the_mean_does_not_depend_on_the_sampler),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
