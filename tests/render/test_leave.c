// SPDX-License-Identifier: MIT
// Particles that leave lamps carry, on the average, just the lamp's power; what can be worked out on paper.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/particle.h"
#include "support/mean.h"
#include "support/picture.h"
#include "support/random.h"

#define PI 3.14159265358979323846

static const sagi_spectrum green = {540, 540, 540, 540};

// A world with nothing but a small ball at the origin and the lamp, which is yet to be added.
static studio open_world(void) {
    studio s = studio_open(1);
    s.settings->integrator = SAG_INTEGRATOR_LIGHTPATH;
    sag_add_sphere(s.scene, &(sag_sphere){.radius = 0.5});
    return s;
}

// The mean of what particles carry, over light of 1 in the lamp's units, is the power, the scene's disk
// (πR², for far lights) being `disks` times a factor of it.
static void expect(studio *s, const char *what, double power, double disks) {
    enum { DRAWS = 20000 };
    sag_error error = {.status = SAG_OK};
    sag_render *render = sag_render_create(s->world, &error);
    if (!render) fail_msg("%s: %s", what, error.message);
    const sagi_color white = sagi_color_of_rgb(SAG_COLOR_SRGB, (sag_rgb){1, 1, 1}, SAGI_RGB_ILLUMINANT);
    const double unit = (double)sagi_color_at(&white, green)[0], radius = render->lights.radius;
    power += disks * PI * radius * radius;
    rng r = rng_make(3);
    mean m = {0};
    for (int i = 0; i < DRAWS; i++) {
        sagi_leaving leaving = {.density = 1};
        double carried = 0;
        // Strata of one of the numbers, so that what depends on it alone has no noise.
        const sag_vec2 u = {(i + rng_unit(&r)) / DRAWS, rng_unit(&r)};
        if (sagi_lights_leave(&render->lights, green, rng_unit(&r), u, rng_vec2(&r), &leaving)) {
            carried = (double)leaving.power[0] / unit;
            assert_true(fabs(sag_length(leaving.ray.direction) - 1) < 1e-9);
        }
        mean_add(&m, carried);
    }
    const double most = 5 * deviation_of(&m) + 2e-3 * power;
    if (!(fabs(mean_of(&m) - power) < most && deviation_of(&m) < 0.005 * power))
        fail_msg("%s: %g +- %g instead of %g", what, mean_of(&m), deviation_of(&m), power);
    sag_render_destroy(render);
    studio_close(s);
}

static void lamps(void **state) {
    (void)state;
    static const sag_light_kind kinds[] = {SAG_LIGHT_POINT, SAG_LIGHT_SPOT, SAG_LIGHT_DISTANT,
                                           SAG_LIGHT_INFINITE, SAG_LIGHT_SKY};
    const double cone = 0.7, delta = 0.3, full = cos(cone - delta), end = cos(cone);
    // Spots: ∫ x² (3 − 2x) from the cone's end to where it is full is half of that. Sky: from 0.4 at the
    // horizon and below, to 1 overhead.
    const double powers[] = {4 * PI * 3, 2 * PI * 3 * ((1 - full) + (full - end) / 2), 0, 0, 0},
                 disks[] = {0, 0, 3, 4 * PI * 3, 2 * PI * 0.4 * 3 + 2 * PI * 0.7 * 3};
    for (int i = 0; i < 5; i++) {
        studio s = open_world();
        sag_light light = {.kind = kinds[i],
                           .color = {3, 3, 3},
                           .horizon = {1.2, 1.2, 1.2},
                           .from = {1, 2, 3},
                           .cone_rad = cone,
                           .cone_delta_rad = delta};
        assert_int_equal(sag_world_add_light(s.world, &light), 1);
        expect(&s, "lamp", powers[i], disks[i]);
    }
    studio s = open_world();
    sag_light portal = {.kind = SAG_LIGHT_INFINITE,
                        .color = {3, 3, 3},
                        .has_portal = true,
                        .portal = {{-1, 2, -1}, {1, 2, -1}, {1, 2, 2}, {-1, 2, 2}}};
    assert_int_equal(sag_world_add_light(s.world, &portal), 1);
    expect(&s, "window", PI * 6 * 3, 0);
}

// Pictures: a goniometric light's mean over all directions, a projector's over its screen, the sky's.
static void lamps_with_pictures(void **state) {
    (void)state;
    static const sag_light_kind kinds[] = {SAG_LIGHT_GONIOMETRIC, SAG_LIGHT_PROJECTION, SAG_LIGHT_INFINITE};
    for (int i = 0; i < 3; i++) {
        enum { SIDE = 8 };
        studio s = open_world();
        sag_error error;
        sag_light light = {.kind = kinds[i], .color = {3, 3, 3}, .from = {1, 2, 3}, .fov_rad = 0.9};
        assert_int_equal(sag_image_create(s.context, SIDE, SIDE, 3, &light.image, &error), SAG_OK);
        double plain = 0, weighted = 0;
        const double half = tan(0.45);
        for (size_t k = 0; k < SIDE * SIDE; k++) {
            const double value = 0.5 + (double)(k % 5) / 3 + (k / SIDE == 2 ? 2 : 0);
            for (size_t c = 0; c < 3; c++) light.image.pixels[3 * k + c] = (float)value;
            plain += value / (SIDE * SIDE);
            enum { FINE = 16 }; // the texel's solid angle
            for (int j = 0; j < FINE * FINE; j++) {
                const double x = (((double)(k % SIDE) + (j % FINE + 0.5) / FINE) / SIDE * 2 - 1) * half,
                             y = (((double)(k / SIDE) + (j / FINE + 0.5) / FINE) / SIDE * 2 - 1) * half;
                weighted += pow(1 + x * x + y * y, -1.5) * value;
            }
        }
        const double screen = 4 * half * half * weighted / (SIDE * SIDE * 16 * 16);
        assert_int_equal(sag_world_add_light(s.world, &light), 1);
        const double powers[] = {4 * PI * 3 * plain, 3 * screen, 0}, disks[] = {0, 0, 4 * PI * 3 * plain};
        expect(&s, "picture", powers[i], disks[i]);
    }
}

// π L times the area, on the sides that shine; in an instance the area that it has there.
static void surfaces(void **state) {
    (void)state;
    const sag_appearance shining = {.emission = {3, 3, 3}}, both = {.emission = {3, 3, 3}, .two_sided = true};
    studio s = open_world();
    uint32_t id = sag_add_sphere(s.scene, &(sag_sphere){.center = {2, 0, 0}, .radius = 0.7});
    sag_world_set_appearance(s.world, s.scene, id, &shining);
    expect(&s, "ball", PI * 3 * 4 * PI * 0.49, 0);
    s = open_world();
    id = sag_add_torus(s.scene, &(sag_torus){.major_radius = 1, .minor_radius = 0.3});
    sag_world_set_appearance(s.world, s.scene, id, &both);
    expect(&s, "torus", 2 * PI * 3 * 4 * PI * PI * 0.3, 0);
    s = open_world();
    sag_scene *object = sag_world_add_object(s.world);
    id = sag_add_disk(object, &(sag_disk){.normal = {0, 0, 1}, .radius = 1});
    sag_world_set_appearance(s.world, object, id, &shining);
    sag_error error;
    assert_int_equal(sag_scene_commit(object, &error), SAG_OK);
    const sag_affine stretch = {{{-2, 0, 0, 3}, {0, 0.5, 0, 0}, {0, 0, 1, 1}}},
                     aside = {{{1, 0, 0, -3}, {0, 1, 0, 0}, {0, 0, 3, 0}}};
    sag_add_instance(s.scene, object, &stretch);
    sag_add_instance(s.scene, object, &aside);
    expect(&s, "instances", PI * 3 * (PI + PI), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamps),
        cmocka_unit_test(lamps_with_pictures),
        cmocka_unit_test(surfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
