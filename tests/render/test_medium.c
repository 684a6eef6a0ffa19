// SPDX-License-Identifier: MIT
// Participating media: densities, what comes through, and furnaces.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/medium.h"
#include "support/picture.h"
#include "support/random.h"

#define PI 3.14159265358979323846

// The phase function's integral is 1, light is turned by g in the mean, and sample draws with its density.
static void phase_is_a_density(void **state) {
    (void)state;
    static const double gs[] = {-0.9, -0.5, 0, 0.0005, 0.3, 0.8, 0.95};
    rng r = rng_make(1);
    for (size_t k = 0; k < sizeof gs / sizeof *gs; k++) {
        const double g = gs[k];
        enum { BINS = 20, DRAWS = 40000, STEPS = 4000 };
        double integral = 0, mean = 0, chi2 = 0, drawn_mean = 0;
        int counts[BINS] = {0};
        double expected[BINS];
        for (int b = 0; b < BINS; b++) {
            expected[b] = 0;
            for (int i = 0; i < STEPS; i++) {
                const double cosine = -1 + 2 * (b + (i + 0.5) / STEPS) / BINS;
                const double part = sagi_phase(g, cosine) * 2 * PI * 2 / BINS / STEPS;
                expected[b] += part, mean -= cosine * part;
            }
            integral += expected[b];
        }
        assert_true(fabs(integral - 1) < 1e-3 && fabs(mean - g) < 1e-3);
        const sag_vec3 wo = rng_direction(&r);
        for (int i = 0; i < DRAWS; i++) {
            sag_vec3 wi;
            const double pdf = sagi_phase_sample(g, wo, (sag_vec2){rng_unit(&r), rng_unit(&r)}, &wi);
            const double cosine = sag_dot(wo, wi);
            assert_true(fabs(sag_length(wi) - 1) < 1e-12);
            assert_true(fabs(pdf - sagi_phase(g, cosine)) <= 1e-9 * pdf);
            drawn_mean -= cosine / DRAWS;
            const int bin = (int)((cosine + 1) / 2 * BINS);
            counts[bin < BINS ? bin : BINS - 1]++;
        }
        assert_true(fabs(drawn_mean - g) < 5 / sqrt(DRAWS));
        int used = 0;
        for (int b = 0; b < BINS; b++) {
            if (expected[b] * DRAWS < 5) continue;
            chi2 +=
                (counts[b] - expected[b] * DRAWS) * (counts[b] - expected[b] * DRAWS) / (expected[b] * DRAWS);
            used++;
        }
        assert_true(chi2 < used + 6 * sqrt(2 * used)); // mean and six deviations
    }
}

static const sag_medium chromatic = {.absorption.value = {0.1, 0.4, 1.2},
                                     .scattering.value = {0.9, 0.5, 0.1}};

// Whichever wavelength draws the distance, each gets what is its own: T(d) comes through, the rest but what
// is absorbed meets a particle.
static void flights_have_the_right_mean(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_world *world = sag_world_create(context);
    const uint32_t id = sag_world_add_medium(world, &chromatic);
    assert_int_equal(id, 1);
    const sagi_medium *medium = sagi_medium_of(world, id);
    const sagi_spectrum lambda = {450, 520, 600, 680};
    const sagi_spectrum a = sagi_color_at(&medium->absorption, lambda),
                        s = sagi_color_at(&medium->scattering, lambda);
    for (int dispersed = 0; dispersed < 2; dispersed++)
        for (double length = 0.25; length <= 4; length *= 4) {
            enum { DRAWS = 200000 };
            double through[4] = {0}, met[4] = {0}, through2[4] = {0}, met2[4] = {0};
            for (int i = 0; i < DRAWS; i++) {
                const sagi_flight f = sagi_medium_fly(medium, lambda, dispersed, length, (i + 0.5) / DRAWS);
                for (int k = 0; k < 4; k++) {
                    const double w = (double)f.weight[k] / DRAWS;
                    if (f.scattered)
                        met[k] += w, met2[k] += w * w;
                    else
                        through[k] += w, through2[k] += w * w;
                }
            }
            for (int k = 0; k < (dispersed ? 1 : 4); k++) {
                const double sigma = (double)(a[k] + s[k]), t = exp(-sigma * length);
                assert_true(fabs(through[k] - t) < 1e-4);
                assert_true(fabs(met[k] - (double)s[k] / sigma * (1 - t)) < 1e-3);
            }
        }
    sag_world_destroy(world);
    sag_context_destroy(context);
}

// Looking straight at a wall that shines through a box of the medium, which nothing else bounds.
static studio behind_box(sag_medium medium, double thickness) {
    studio s = studio_open(0);
    s.settings->integrator = SAG_INTEGRATOR_VOLPATH;
    s.settings->max_depth = 1000;
    studio_aim_point(&s, (sag_vec3){0, 0, 8}, (sag_vec3){0, 0, 0});
    const uint32_t id = sag_world_add_medium(s.world, &medium);
    const uint32_t interface = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
    const uint32_t black = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE});
    const uint32_t box = sag_add_box(s.scene, &(sag_box){{-9, -9, 1}, {9, 9, 1 + thickness}});
    const uint32_t wall = sag_add_box(s.scene, &(sag_box){{-99, -99, -1}, {99, 99, 0}});
    sag_world_set_appearance(s.world, s.scene, box, &(sag_appearance){.material = interface, .inside = id});
    sag_world_set_appearance(s.world, s.scene, wall,
                             &(sag_appearance){.material = black, .emission = {1, 1, 1}});
    return s;
}

static void absorption_is_exact(void **state) {
    (void)state;
    for (double sigma = 0.1; sigma < 20; sigma *= 3) {
        studio s =
            behind_box((sag_medium){.absorption.value = {sigma / 2, sigma / 2, sigma / 2}, .scale = 2}, 0.7);
        const studio_mean m = studio_measure(&s);
        const double truth = exp(-sigma * 0.7);
        assert_true(m.least > truth * (1 - 1e-4) && m.most < truth * (1 + 1e-4));
        studio_close(&s);
        s = behind_box((sag_medium){.absorption.value = {sigma, sigma, sigma}, .emission.value = {1, 1, 1}},
                       0.7);
        const studio_mean warm = studio_measure(&s); // as warm as the wall
        assert_true(warm.least > 1 - 1e-4 && warm.most < 1 + 1e-4);
        studio_close(&s);
    }
}

// A shadow ray through the medium, from a lamp to a floor.
static void shadows_are_dimmed(void **state) {
    (void)state;
    double bright[2];
    for (int with = 0; with < 2; with++) {
        studio s = studio_open(1);
        s.settings->integrator = SAG_INTEGRATOR_VOLPATH;
        s.settings->max_depth = 1;
        studio_aim_point(&s, (sag_vec3){0, 8, 1}, (sag_vec3){0, 0, 0});
        const uint32_t id = sag_world_add_medium(
            s.world, &(sag_medium){.absorption.value = {0.2, 0.2, 0.2}, .scattering.value = {0.1, 0.1, 0.1}});
        const uint32_t interface = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
        sag_add_box(s.scene, &(sag_box){{-99, -1, -99}, {99, 0, 99}});
        if (with) {
            const uint32_t box = sag_add_box(s.scene, &(sag_box){{2, 1, -9}, {9, 3, 9}});
            sag_world_set_appearance(s.world, s.scene, box,
                                     &(sag_appearance){.material = interface, .inside = id});
        }
        sag_world_add_light(s.world,
                            &(sag_light){.kind = SAG_LIGHT_POINT, .color = {9, 9, 9}, .from = {4, 4, 0}});
        bright[with] = studio_measure(&s).mean;
        studio_close(&s);
    }
    // From (2, 2) to (3, 3) of the way: √2, and from there nothing more but 45° through x ≥ 2.
    assert_true(bright[0] > 0);
    assert_true(fabs(bright[1] / bright[0] - exp(-0.3 * sqrt(2))) < 1e-4);
}

// Nothing is lost and nothing is made: clouds that absorb nothing, alone, in glass, or around a mirror, and
// ones that shine as much as they absorb, in light of radiance 1.
static void furnaces(void **state) {
    (void)state;
    static const double gs[] = {0, 0.7, -0.5};
    for (int kind = 0; kind < 4; kind++)
        for (size_t k = 0; k < 3; k++)
            for (int strategy = SAG_STRATEGY_MIS; strategy <= SAG_STRATEGY_SURFACES; strategy++) {
                studio s = studio_open(0);
                s.settings->film.width = s.settings->film.height = 24;
                s.settings->integrator = SAG_INTEGRATOR_VOLPATH;
                s.settings->strategy = (sag_strategy)strategy;
                s.settings->max_depth = 10000;
                const bool warm = kind == 3;
                const uint32_t id = sag_world_add_medium(
                    s.world, &(sag_medium){.absorption.value = {warm, warm / 2.0, warm / 4.0},
                                           .scattering.value = {1, 2, 0.5},
                                           .emission.value = {warm, warm, warm},
                                           .g = gs[k]});
                const uint32_t skin = studio_material(
                    &s, kind == 1 ? (sag_material){.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.2, 0, 0}}
                                  : (sag_material){.kind = SAG_MATERIAL_INTERFACE});
                const uint32_t mirror = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_CONDUCTOR,
                                                                           .eta.value = {1, 1, 1},
                                                                           .k.value = {1e8, 1e8, 1e8}});
                sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
                const uint32_t ball = sag_add_sphere(s.scene, &(sag_sphere){.radius = 1});
                sag_world_set_appearance(s.world, s.scene, ball,
                                         &(sag_appearance){.material = skin, .inside = id});
                if (kind == 2) {
                    const uint32_t inner = sag_add_sphere(s.scene, &(sag_sphere){.radius = 0.5});
                    sag_world_set_appearance(s.world, s.scene, inner, &(sag_appearance){.material = mirror});
                }
                const studio_mean m = studio_measure(&s);
                if (!(fabs(m.mean - 1) < 5 * m.deviation + 1e-4))
                    fail_msg("kind %d, g %g, strategy %d: %g +- %g", kind, gs[k], strategy, m.mean,
                             m.deviation);
                assert_true(m.deviation < 0.05);
                studio_close(&s);
            }
}

static void threads_do_not_matter(void **state) {
    (void)state;
    sag_image pictures[3];
    static const uint32_t threads[3] = {1, 2, 7};
    sag_context *contexts[3];
    studio s[3];
    for (int i = 0; i < 3; i++) {
        s[i] = studio_open(threads[i]);
        s[i].settings->integrator = SAG_INTEGRATOR_VOLPATH;
        s[i].settings->camera_medium = sag_world_add_medium(s[i].world, &chromatic);
        sag_world_add_light(s[i].world,
                            &(sag_light){.kind = SAG_LIGHT_POINT, .color = {9, 9, 9}, .from = {2, 2, 2}});
        sag_add_sphere(s[i].scene, &(sag_sphere){.radius = 1});
        contexts[i] = s[i].context;
        pictures[i] = studio_render(&s[i], NULL);
    }
    for (int i = 1; i < 3; i++) assert_true(same_picture(&pictures[0], &pictures[i]));
    for (int i = 0; i < 3; i++) sag_image_clear(contexts[i], &pictures[i]), studio_close(&s[i]);
}

static void wrong_media_are_refused(void **state) {
    (void)state;
    studio s = studio_open(1);
    assert_int_equal(sag_world_add_medium(s.world, &(sag_medium){.g = 1}), 0);
    assert_int_equal(sag_world_add_medium(s.world, &(sag_medium){.g = -1.5}), 0);
    assert_int_equal(sag_world_add_medium(s.world, &(sag_medium){.absorption.value = {1, 1, INFINITY}}), 0);
    assert_int_equal(sag_world_add_medium(s.world, &(sag_medium){.scattering.texture = 1}), 0);
    assert_int_equal(sag_world_set_medium(s.world, 1, &(sag_medium){.g = 0}), SAG_ERROR_ARGUMENT);
    const uint32_t ball = sag_add_sphere(s.scene, &(sag_sphere){.radius = 1});
    assert_int_equal(sag_world_set_appearance(s.world, s.scene, ball, &(sag_appearance){.inside = 1}),
                     SAG_ERROR_ARGUMENT);
    studio_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(phase_is_a_density),
        cmocka_unit_test(flights_have_the_right_mean),
        cmocka_unit_test(absorption_is_exact),
        cmocka_unit_test(shadows_are_dimmed),
        cmocka_unit_test(furnaces),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(wrong_media_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
