// SPDX-License-Identifier: MIT
// Noise: its zeros, bounds, mean and spread, smoothness, period; what octaves a footprint leaves.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/noise.h"
#include "support/random.h"

static const sag_vec3 none = {0, 0, 0};

static sag_vec3 random_point(rng *r, double size) {
    const double x = rng_uniform(r, -size, size), y = rng_uniform(r, -size, size),
                 z = rng_uniform(r, -size, size);
    return (sag_vec3){x, y, z};
}

static void noise_is_zero_on_the_lattice(void **state) {
    (void)state;
    for (int i = -300; i < 300; i += 7)
        for (int j = -5; j < 5; j++) assert_true(sagi_noise((sag_vec3){i, j, 3 * i - j}) == 0);
}

static void noise_has_a_period(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 1000; i++) {
        const sag_vec3 p = {floor(rng_uniform(&r, -40, 40)) + 0.25, floor(rng_uniform(&r, -40, 40)) + 0.375,
                            floor(rng_uniform(&r, -40, 40)) + 0.8125};
        const double value = sagi_noise(p);
        assert_true(value == sagi_noise((sag_vec3){p.x + 256, p.y, p.z}));
        assert_true(value == sagi_noise((sag_vec3){p.x, p.y - 512, p.z + 256}));
    }
}

static void noise_has_mean_zero_and_stays_in_bounds(void **state) {
    (void)state;
    rng r = rng_make(2);
    double sum = 0, square = 0, size = 0, most = 0;
    const int n = 400000;
    for (int i = 0; i < n; i++) {
        const double value = sagi_noise(random_point(&r, 128));
        sum += value, square += value * value, size += fabs(value);
        most = fmax(most, fabs(value));
    }
    assert_true(fabs(sum / n) < 0.005);
    assert_true(most <= 1.04 && most > 0.8);
    assert_true(sqrt(square / n) > 0.23 && sqrt(square / n) < 0.30);
    assert_true(fabs(size / n - 0.2) < 0.02); // what turbulence takes for it
}

// Continuous with its first derivative, over cell faces too: central differences on both sides agree.
static void noise_is_smooth(void **state) {
    (void)state;
    rng r = rng_make(3);
    const double h = 1e-4;
    for (int i = 0; i < 20000; i++) {
        sag_vec3 p = random_point(&r, 20);
        p.x = floor(p.x); // on a face
        const double here = sagi_noise(p);
        const double before = sagi_noise((sag_vec3){p.x - h, p.y, p.z});
        const double after = sagi_noise((sag_vec3){p.x + h, p.y, p.z});
        assert_true(fabs(after - before) < 3 * 2 * h);
        assert_true(fabs((after - here) - (here - before)) < 100 * h * h);
    }
}

static void noise_of_nonsense_is_zero(void **state) {
    (void)state;
    assert_true(sagi_noise((sag_vec3){NAN, 0.5, 0.5}) == 0);
    assert_true(sagi_noise((sag_vec3){0.5, INFINITY, 0.5}) == 0);
    assert_true(isfinite(sagi_noise((sag_vec3){1e300, -1e300, 1e17})));
}

static void wide_footprints_leave_fewer_octaves(void **state) {
    (void)state;
    rng r = rng_make(4);
    for (int i = 0; i < 2000; i++) {
        const sag_vec3 p = random_point(&r, 50);
        // 2⁻³ wide: −1 + 3 = 2 octaves, whatever more are asked for.
        const double two = sagi_noise(p) + 0.5 * sagi_noise(sag_scale(p, 1.99));
        assert_true(fabs(sagi_noise_fbm(p, (sag_vec3){0, 0.125, 0}, none, 0.5, 8) - two) < 1e-14);
        assert_true(fabs(sagi_noise_fbm(p, none, none, 0.5, 2) - two) < 1e-14);
        // Half a unit and more: nothing is left.
        assert_true(sagi_noise_fbm(p, none, (sag_vec3){0.3, 0.4, 0}, 0.5, 8) == 0);
        assert_true(sagi_noise_fbm(p, (sag_vec3){NAN, 0, 0}, (sag_vec3){NAN, 0, 0}, 0.5, 8) == 0);
    }
}

// A little more footprint changes little.
static void octaves_fade_in(void **state) {
    (void)state;
    rng r = rng_make(5);
    for (int i = 0; i < 200; i++) {
        const sag_vec3 p = random_point(&r, 50);
        double last_fbm = 0, last_turbulence = 0;
        for (int k = 0; k <= 6000; k++) {
            const sag_vec3 wide = {exp2(-0.5 - k * 1e-3), 0, 0};
            const double fbm = sagi_noise_fbm(p, wide, none, 0.5, 8);
            const double turbulence = sagi_noise_turbulence(p, wide, none, 0.5, 8);
            if (k > 0) assert_true(fabs(fbm - last_fbm) < 0.006);
            // (pbrt's turbulence counts the octave that fades twice while it does: it jumps where one ends.)
            if (k > 0) assert_true(fabs(turbulence - last_turbulence) < 0.25);
            last_fbm = fbm, last_turbulence = turbulence;
        }
    }
}

static void turbulence_keeps_its_mean(void **state) {
    (void)state;
    rng r = rng_make(6);
    double sharp = 0, blurred = 0;
    const int n = 20000;
    for (int i = 0; i < n; i++) {
        const sag_vec3 p = random_point(&r, 50);
        sharp += sagi_noise_turbulence(p, none, none, 0.5, 6) / n;
        blurred += sagi_noise_turbulence(p, (sag_vec3){1, 0, 0}, none, 0.5, 6) / n;
    }
    // Six octaves of mean 0.2: 0.4; all replaced: one more of them.
    assert_true(fabs(sharp - 0.4) < 0.04);
    assert_true(fabs(blurred - 0.2 * (1 + 1.96875)) < 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_zero_on_the_lattice),
        cmocka_unit_test(noise_has_a_period),
        cmocka_unit_test(noise_has_mean_zero_and_stays_in_bounds),
        cmocka_unit_test(noise_is_smooth),
        cmocka_unit_test(noise_of_nonsense_is_zero),
        cmocka_unit_test(wide_footprints_leave_fewer_octaves),
        cmocka_unit_test(octaves_fade_in),
        cmocka_unit_test(turbulence_keeps_its_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
