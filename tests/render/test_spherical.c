// SPDX-License-Identifier: MIT
// Flat lights seen from a point: their solid angle against closed forms, samples against their density, by
// bins and by sums; points far off their planes, near them, and at the edge.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/spherical.h"
#include "support/random.h"

#define PI 3.14159265358979323846

static const sag_vec3 nowhere = {0, 0, 0};

static void solid_angles_are_known(void **state) {
    (void)state;
    sagi_facet_view view;
    // An octant of the sphere, whatever the lengths.
    const sagi_facet octant = {.a = {2, 0, 0}, .e = {-2, 3, 0}, .f = {-2, 0, 5}};
    sagi_facet_see(&octant, nowhere, nowhere, false, &view);
    assert_true(fabs(view.solid_angle - PI / 2) < 1e-14);
    // One of the six faces of a cube, from its middle; and nearly a half space.
    const sagi_facet face = {.a = {-1, -1, 1}, .e = {2, 0, 0}, .f = {0, 2, 0}, .parallelogram = true};
    sagi_facet_see(&face, nowhere, nowhere, false, &view);
    assert_true(fabs(view.solid_angle - 4 * PI / 6) < 1e-14);
    sagi_facet_see(&face, sag_vec3_make(0.1, 0.2, 1 - 1e-9), nowhere, false, &view);
    assert_true(fabs(view.solid_angle - 2 * PI) < 1e-7);
    // Far away: area times cosine by the square of the distance.
    sagi_facet_see(&face, sag_vec3_make(3e6, 0, 4e6 + 1), nowhere, false, &view);
    assert_true(fabs(view.solid_angle / (4 * 0.8 / 25e12) - 1) < 1e-5);
    // From its edge.
    sagi_facet_see(&face, sag_vec3_make(7, 0, 1), nowhere, false, &view);
    assert_true(view.solid_angle == 0);
}

static sagi_facet random_facet(rng *r) {
    return (sagi_facet){
        .a = rng_vec3(r, 1), .e = rng_vec3(r, 2), .f = rng_vec3(r, 2), .parallelogram = rng_one_in(r, 2)};
}

// ∫ over the sphere of 1/pdf-weighted cosines must be what a sum over the facet's own area says; the density
// that is said with a sample is the one that is said of its direction.
static void samples_have_their_density(void **state) {
    (void)state;
    enum { SAMPLES = 20000 };
    rng r = rng_make(1);
    for (int k = 0; k < 40; k++) {
        const sagi_facet facet = random_facet(&r);
        const sag_vec3 from = rng_vec3(&r, 2), normal = rng_one_in(&r, 4) ? nowhere : rng_direction(&r);
        sagi_facet_view view;
        sagi_facet_see(&facet, from, normal, k % 2, &view);
        if (!(view.solid_angle > 3e-4 && view.solid_angle < 6.22)) continue;
        double one = 0, one2 = 0, moment = 0, moment2 = 0, wanted = 0;
        const sag_vec3 n = sag_cross(facet.e, facet.f), probe = rng_direction(&r);
        for (int i = 0; i < SAMPLES; i++) {
            double pdf, u, v, t;
            const sag_vec3 wi = sagi_facet_sample(&view, rng_vec2(&r), &pdf);
            assert_true(fabs(sag_dot(wi, wi) - 1) < 1e-12 && pdf > 0);
            assert_true(fabs(sagi_facet_pdf(&view, wi) / pdf - 1) < 1e-5);
            sagi_facet_meet(&facet, from, wi, &u, &v, &t);
            const sag_vec3 p = sag_madd(sag_madd(facet.a, u, facet.e), v, facet.f);
            assert_true(t > 0 && sag_length(sag_sub(p, sag_madd(from, t, wi))) < 1e-9 * (1 + t));
            const double x = sag_dot(wi, probe) / pdf;
            one += 1 / pdf, one2 += 1 / pdf / pdf, moment += x, moment2 += x * x;
        }
        enum { SIDE = 400 };
        for (int i = 0; i < SIDE; i++) // the same moment over the area
            for (int j = 0; j < SIDE; j++) {
                double u = (i + 0.5) / SIDE, v = (j + 0.5) / SIDE;
                if (!facet.parallelogram && u + v > 1) u = 1 - u, v = 1 - v;
                const sag_vec3 d = sag_sub(sag_madd(sag_madd(facet.a, u, facet.e), v, facet.f), from);
                const double l = sag_length(d);
                wanted += fabs(sag_dot(d, n)) / (l * l * l) * sag_dot(d, probe) / l;
            }
        wanted *= (facet.parallelogram ? 1 : 0.5) / SIDE / SIDE;
        one /= SAMPLES, one2 /= SAMPLES, moment /= SAMPLES, moment2 /= SAMPLES;
        assert_true(fabs(one - view.solid_angle) <
                    5 * sqrt(fmax(0, one2 - one * one) / SAMPLES) + 1e-9 * one);
        assert_true(fabs(moment - wanted) <
                    5 * sqrt(fmax(0, moment2 - moment * moment) / SAMPLES) + 1e-3 * view.solid_angle);
    }
}

// Without a receiver the samples are uniform: parts of equal solid angle get equally many.
static void samples_are_uniform(void **state) {
    (void)state;
    enum { SAMPLES = 100000 };
    const sagi_facet facet = {.a = {-1, -1, 0.3}, .e = {3, 0, 0}, .f = {0, 2, 0}, .parallelogram = true};
    sagi_facet_view view, inner;
    sagi_facet_see(&facet, nowhere, nowhere, false, &view);
    sagi_facet part = facet;
    part.e = sag_scale(facet.e, 0.25), part.f = sag_scale(facet.f, 0.7);
    sagi_facet_see(&part, nowhere, nowhere, false, &inner);
    rng r = rng_make(2);
    int within = 0;
    for (int i = 0; i < SAMPLES; i++) {
        double pdf, u, v, t;
        const sag_vec3 wi = sagi_facet_sample(&view, rng_vec2(&r), &pdf);
        assert_true(fabs(pdf * view.solid_angle - 1) < 1e-12);
        sagi_facet_meet(&facet, nowhere, wi, &u, &v, &t);
        within += u < 0.25 && v < 0.7;
    }
    const double p = inner.solid_angle / view.solid_angle;
    assert_true(fabs(within - SAMPLES * p) < 5 * sqrt(SAMPLES * p * (1 - p)));
}

// A lamp overhead of a receiver beside it: irradiance by cosine-warped samples has less variance.
static void receivers_cosine_lessens_the_noise(void **state) {
    (void)state;
    enum { SAMPLES = 20000 };
    const sagi_facet facet = {.a = {-3, 0.2, -0.5}, .e = {0, 4, 0}, .f = {0, 0, 4}, .parallelogram = true};
    double variance[2];
    for (int warped = 0; warped < 2; warped++) {
        sagi_facet_view view;
        const sag_vec3 up = {0, 1, 0};
        sagi_facet_see(&facet, nowhere, warped ? up : nowhere, true, &view);
        rng r = rng_make(3);
        double sum = 0, sum2 = 0;
        for (int i = 0; i < SAMPLES; i++) {
            double pdf;
            const sag_vec3 wi = sagi_facet_sample(&view, rng_vec2(&r), &pdf);
            const double x = fmax(0, wi.y) / pdf;
            sum += x, sum2 += x * x;
        }
        variance[warped] = sum2 / SAMPLES - sum / SAMPLES * (sum / SAMPLES);
    }
    assert_true(variance[1] < 0.3 * variance[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solid_angles_are_known),
        cmocka_unit_test(samples_have_their_density),
        cmocka_unit_test(samples_are_uniform),
        cmocka_unit_test(receivers_cosine_lessens_the_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
