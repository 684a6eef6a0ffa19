// SPDX-License-Identifier: MIT
// Lights with pictures: what they send adds up to the power they are said to have; samples of what comes from
// infinity, through a window or not, have the density they claim, and sum up to what all directions bring.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/light.h"
#include "render/warp.h"
#include "support/failing_allocator.h"
#include "support/mean.h"
#include "support/picture.h"
#include "support/random.h"

#include <string.h>

#define PI 3.14159265358979323846

static const sagi_spectrum green = {540, 540, 540, 540};

// A picture of grey noise; some of it much brighter, some black.
static sag_image noise(studio *s, rng *r, uint32_t width, uint32_t height) {
    sag_image image;
    sag_error error;
    assert_int_equal(sag_image_create(s->context, width, height, 3, &image, &error), SAG_OK);
    for (size_t i = 0; i < (size_t)width * height; i++) {
        const float value = rng_one_in(r, 8) ? 0 : (float)(rng_unit(r) * (rng_one_in(r, 20) ? 30 : 1));
        for (size_t c = 0; c < 3; c++) image.pixels[3 * i + c] = value;
    }
    return image;
}

static double picture_mean(const sag_image *image) {
    double sum = 0;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) sum += (double)image->pixels[3 * i];
    return sum / image->width / image->height;
}

static sag_affine random_turn(rng *r) { return sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r)); }

// Light that is 1 at the wavelength looked at, in the units of a light's color.
static double unit(const sagi_lights *lights) {
    (void)lights;
    const sagi_color white = sagi_color_of_rgb(SAG_COLOR_SRGB, (sag_rgb){1, 1, 1}, SAGI_RGB_ILLUMINANT);
    return (double)sagi_color_at(&white, green)[0];
}

static void prepare(studio *s, sagi_lights *lights) {
    sag_error error = {.status = SAG_OK};
    assert_int_equal(sag_scene_commit(s->scene, &error), SAG_OK);
    if (sagi_lights_init(lights, s->world, &error) != SAG_OK) fail_msg("%s", error.message);
}

// The power of beams: the integral of their intensity over the sphere.
static void beams_have_the_power_of_their_pictures(void **state) {
    (void)state;
    enum { SIDE = 600 };
    rng r = rng_make(1);
    for (int kind = 0; kind < 4; kind++) {
        studio s = studio_open(1);
        sag_light light = {.kind = kind == 0 ? SAG_LIGHT_GONIOMETRIC : SAG_LIGHT_PROJECTION,
                           .color = {2, 2, 2},
                           .from = {1, 2, 3},
                           .to_world = random_turn(&r),
                           .image = noise(&s, &r, kind == 2 ? 40 : 20, kind == 3 ? 35 : 20),
                           .fov_rad = kind == 1 ? 0 : 0.7};
        const double mean_texel = picture_mean(&light.image), width = light.image.width,
                     height = light.image.height;
        assert_int_equal(sag_world_add_light(s.world, &light), 1);
        sagi_lights lights;
        prepare(&s, &lights);
        double sum = 0;
        int below = 0;
        for (int i = 0; i < SIDE; i++)
            for (int j = 0; j < SIDE; j++) {
                const double c = 1 - 2 * (i + 0.5) / SIDE, phi = 2 * PI * (j + 0.5) / SIDE,
                             t = sqrt(1 - c * c);
                const sag_vec3 away = {t * cos(phi), t * sin(phi), c};
                const double value = (double)sagi_beam_intensity(&lights.lights[0], away, green)[0];
                sum += value;
                const sag_vec3 axis = sag_affine_vector(&light.to_world, sag_vec3_make(0, 0, 1));
                below += value > 0 && sag_dot(axis, away) < 0;
            }
        sum *= 4 * PI / SIDE / SIDE / unit(&lights) / 2;
        const sagi_light *made = &lights.lights[0];
        assert_true(fabs(sum / (made->mean * made->solid_angle) - 1) < 0.02);
        if (kind == 0) {
            assert_true(fabs(made->mean / mean_texel - 1) < 1e-6 && made->solid_angle == 4 * PI);
        } else {
            const double opposite = tan((kind == 1 ? PI / 2 : 0.7) / 2),
                         a = width > height ? width / height : 1, b = height > width ? height / width : 1,
                         x = opposite * a, y = opposite * b;
            // The solid angle of a pyramid.
            const double whole = 4 * asin(x * y / sqrt((1 + x * x) * (1 + y * y)));
            assert_true(fabs(made->solid_angle / whole - 1) < 0.01);
            assert_int_equal(below, 0);
        }
        // Chosen from where it shines.
        const sag_vec3 axis = sag_affine_vector(&light.to_world, sag_vec3_make(0, 0, 1));
        const sagi_shading_point in_front = {.position = sag_madd(light.from, 5, axis)};
        assert_true(sagi_lights_choice(&lights, &in_front, 0) == 1);
        sagi_lights_clear(&lights);
        studio_close(&s);
    }
}

static const sag_vec3 window[4] = {{-1, -0.5, 2}, {-1, 0.7, 2}, {0.8, 0.7, 2}, {0.8, -0.5, 2}};

// Samples against all directions, at some points; with a window, only directions through it count.
static void check_far(rng *r, sag_strategy strategy, bool picture, bool portal) {
    enum { SAMPLES = 30000 };
    studio s = studio_open(1);
    s.settings->strategy = strategy;
    sag_light light = {.kind = SAG_LIGHT_INFINITE, .color = {2, 2, 2}, .has_portal = portal};
    for (int i = 0; i < 4; i++) light.portal[i] = window[i];
    if (picture) light.image = noise(&s, r, 16, 16), light.to_world = random_turn(r);
    assert_int_equal(sag_world_add_light(s.world, &light), 1);
    sagi_lights lights;
    prepare(&s, &lights);
    for (int k = 0; k < 4; k++) {
        const sagi_shading_point from = {
            .position = {rng_uniform(r, -2, 2), rng_uniform(r, -2, 2), k == 3 ? 3 : 0.5},
            .normal = rng_direction(r),
            .reflects_only = rng_one_in(r, 2)};
        mean sampled = {0}, found = {0}, one = {0};
        for (int i = 0; i < SAMPLES; i++) {
            sagi_light_sample sample;
            double x = 0;
            if (sagi_lights_sample(&lights, &from, green, rng_unit(r), rng_vec2(r), &sample)) {
                x = (double)sample.radiance[0] / sample.pdf;
                assert_true(fabs(sagi_sky_pdf(&lights.lights[0], &from, sample.wi) / sample.pdf - 1) < 1e-6);
                if (portal) { // it goes through the window
                    const double t = (2 - from.position.z) / sample.wi.z;
                    const sag_vec3 p = sag_madd(from.position, t, sample.wi);
                    assert_true(t > 0 && p.x > -1 - 1e-9 && p.x < 0.8 + 1e-9 && p.y > -0.5 - 1e-9 &&
                                p.y < 0.7 + 1e-9);
                }
            }
            mean_add(&sampled, x);
            const sag_vec3 wi = rng_direction(r);
            const double pdf = sagi_sky_pdf(&lights.lights[0], &from, wi);
            const double radiance =
                (double)sagi_lights_far(&lights, NULL, from.position, wi, green, 0)[0] * 4 * PI;
            mean_add(&one, pdf * 4 * PI);
            // What sampling leaves out is left to surfaces' samples, if they are to count; and what is
            // behind.
            mean_add(&found, pdf > 0 ? radiance : 0);
            const bool leaves_out = strategy == SAG_STRATEGY_MIS && picture && !portal;
            if (radiance > 0 && !leaves_out && (picture || portal || !from.reflects_only))
                assert_true(pdf > 0);
        }
        const double allowed = 5 * hypot(deviation_of(&sampled), deviation_of(&found));
        if (!(fabs(mean_of(&sampled) - mean_of(&found)) <= allowed))
            fail_msg("strategy %d, picture %d, portal %d: %g +- %g, but %g +- %g", strategy, picture, portal,
                     mean_of(&sampled), deviation_of(&sampled), mean_of(&found), deviation_of(&found));
        if (!portal || k != 3) assert_true(fabs(mean_of(&one) - 1) < 5 * deviation_of(&one) + 1e-9);
        if (portal && k == 3) assert_true(mean_of(&found) == 0); // before the window: nothing
    }
    sagi_lights_clear(&lights);
    studio_close(&s);
}

// The picture's density, texel by texel: together 1, and each as bright as its share (in excess of the mean,
// where surfaces' samples bring the rest).
static void texels_have_their_share(void **state) {
    (void)state;
    rng r = rng_make(4);
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_LIGHTS; strategy++) {
        enum { SIDE = 16 };
        studio s = studio_open(1);
        s.settings->strategy = (sag_strategy)strategy;
        sag_light light = {.kind = SAG_LIGHT_INFINITE, .color = {2, 2, 2}, .to_world = random_turn(&r)};
        light.image = noise(&s, &r, SIDE, SIDE);
        double texels[SIDE * SIDE], all = 0, sum = 0;
        const double bias = strategy == SAG_STRATEGY_MIS ? picture_mean(&light.image) : 0;
        for (size_t i = 0; i < SIDE * SIDE; i++)
            all += texels[i] = fmax(0, (double)light.image.pixels[3 * i] - bias);
        const sag_affine turn = light.to_world;
        assert_int_equal(sag_world_add_light(s.world, &light), 1);
        sagi_lights lights;
        prepare(&s, &lights);
        const sagi_shading_point from = {.normal = {0, 0, 1}};
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            const sag_vec2 at = {((double)(i % SIDE) + 0.5) / SIDE, ((double)(i / SIDE) + 0.5) / SIDE};
            const sag_vec3 wi = sag_affine_vector(&turn, sagi_equal_area_to_sphere(at));
            const double share = sagi_sky_pdf(&lights.lights[0], &from, wi) * 4 * PI / (SIDE * SIDE);
            assert_true(fabs(share - texels[i] / all) < 1e-6);
            sum += share;
        }
        assert_true(fabs(sum - 1) < 1e-6);
        sagi_lights_clear(&lights);
        studio_close(&s);
    }
}

static void light_from_far_is_sampled_as_it_comes(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (int i = 0; i < 8; i++)
        check_far(&r, i & 1 ? SAG_STRATEGY_LIGHTS : SAG_STRATEGY_MIS, (i & 2) != 0, (i & 4) != 0);
}

// A floor under a window: E = π L F, the form factor of the rectangle from its corner, four times over.
static void window_over_a_floor(void **state) {
    (void)state;
    for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
        studio s = studio_open(0);
        sag_add_plane(s.scene, &(sag_plane){.normal = {0, 1, 0}});
        sag_vec3 eye = {0.5, 0.5, 0.5}, target = {0, 0, 0};
        studio_aim_point(&s, eye, target);
        s.settings->integrator = SAG_INTEGRATOR_DIRECT;
        s.settings->strategy = (sag_strategy)strategy;
        s.settings->film.width = s.settings->film.height = 64;
        // Outward is up: (portal[3] − portal[0]) × (portal[1] − portal[0]).
        sag_light light = {.kind = SAG_LIGHT_INFINITE,
                           .color = {3, 3, 3},
                           .has_portal = true,
                           .portal = {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}};
        sag_world_add_light(s.world, &light);
        const double corner = 2 * (1 / sqrt(2)) * atan(1 / sqrt(2)) / (2 * PI);
        const double expected = 0.5 * 3 * 4 * corner; // of reflectance ½
        studio_mean m = studio_measure(&s);
        if (!(fabs(m.mean - expected) < 5 * m.deviation + 1e-5))
            fail_msg("strategy %d: %g +- %g instead of %g", strategy, m.mean, m.deviation, expected);
        studio_close(&s);
    }
}

static void bad_lights_are_refused(void **state) {
    (void)state;
    rng r = rng_make(3);
    for (int i = 0; i < 5; i++) {
        studio s = studio_open(1);
        sag_light light = {.kind = SAG_LIGHT_GONIOMETRIC, .color = {1, 1, 1}};
        const char *const reasons[] = {"no picture", "square", "fov", "singular", "rectangle"};
        if (i == 1) light.image = noise(&s, &r, 4, 3);
        if (i == 2) light.kind = SAG_LIGHT_PROJECTION, light.image = noise(&s, &r, 4, 3), light.fov_rad = 4;
        if (i == 3) light.image = noise(&s, &r, 4, 4), light.to_world.m[0][0] = 1;
        if (i == 4) light.kind = SAG_LIGHT_INFINITE, light.has_portal = true;
        sag_world_add_light(s.world, &light);
        sag_error error = {.status = SAG_OK};
        assert_null(sag_render_create(s.world, &error));
        assert_int_equal(error.status, SAG_ERROR_ARGUMENT);
        if (!strstr(error.message, reasons[i])) fail_msg("%s", error.message);
        studio_close(&s);
    }
}

// Lights of all kinds, some in instances, made ready for rendering. True when there was memory for all.
static bool furnish_and_prepare(sag_context *context) {
    static const float corners[] = {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1};
    static const uint32_t faces[] = {0, 1, 2, 0, 2, 3};
    const sag_mesh mesh = {
        .positions_f32 = corners, .vertex_count = 4, .triangles = faces, .triangle_count = 2};
    sag_world *world = sag_world_create(context);
    sag_scene *scene = world ? sag_world_add_object(world) : NULL;
    sag_error error = {.status = SAG_OK};
    bool good = scene != NULL;
    if (good) {
        sag_settings *settings = sag_world_settings(world);
        settings->film.width = settings->film.height = 4;
        const sag_appearance look = {.emission = {1, 1, 1}};
        const uint32_t id = sag_add_mesh(scene, &mesh);
        good = id != SAG_INVALID_ID && sag_world_set_appearance(world, scene, id, &look) == SAG_OK &&
               sag_scene_commit(scene, &error) == SAG_OK;
        for (int i = 0; i < 3 && good; i++) {
            const sag_affine there = sag_affine_translate(sag_vec3_make(3 * i, 0, 0));
            good = sag_add_instance(sag_world_scene(world), scene, &there) != SAG_INVALID_ID;
        }
    }
    for (int i = 0; i < 4 && good; i++) {
        sag_light light = {.kind = i == 3 ? SAG_LIGHT_GONIOMETRIC : SAG_LIGHT_INFINITE,
                           .color = {1, 1, 1},
                           .has_portal = i == 1 || i == 2};
        for (int k = 0; k < 4; k++) light.portal[k] = window[k];
        good = i == 2 || sag_image_create(context, 4, 4, 3, &light.image, &error) == SAG_OK;
        good = good && sag_world_add_light(world, &light) != 0;
    }
    sag_render *render = good ? sag_render_create(world, &error) : NULL;
    good = render != NULL;
    sag_render_destroy(render);
    sag_world_destroy(world);
    return good;
}

static void memory_may_run_out(void **state) {
    (void)state;
    for (size_t k = 0;; k++) {
        failing_allocator f = {.fail_at = k};
        sag_context *context = sag_context_create(
            &(sag_context_options){.thread_count = 1, .allocator = failing_allocator_make(&f)});
        const bool done = context && furnish_and_prepare(context);
        sag_context_destroy(context);
        failing_allocator_assert_empty(&f);
        if (done) break;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beams_have_the_power_of_their_pictures),
        cmocka_unit_test(light_from_far_is_sampled_as_it_comes),
        cmocka_unit_test(texels_have_their_share),
        cmocka_unit_test(window_over_a_floor),
        cmocka_unit_test(bad_lights_are_refused),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
