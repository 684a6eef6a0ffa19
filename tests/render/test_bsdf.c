// SPDX-License-Identifier: MIT
// Materials: Fresnel's and Snell's laws, densities that match the samples, energy that is not made,
// reciprocity.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on
#include "render/bsdf.h"
#include "render/fresnel.h"
#include "render/warp.h"
#include "support/random.h"

static void fresnel_is_right_where_it_is_known(void **state) {
    (void)state;
    assert_true(fabs(sagi_fresnel_dielectric(1, 1.5) - 0.04) < 1e-15);
    assert_true(fabs(sagi_fresnel_dielectric(-1, 1.5) - 0.04) < 1e-15);
    assert_true(sagi_fresnel_dielectric(0, 1.5) == 1);
    // Brewster's angle: only the perpendicular half is left, ((η² − 1)/(η² + 1))²/2.
    double brewster = cos(atan(1.5));
    assert_true(fabs(sagi_fresnel_dielectric(brewster, 1.5) - 0.5 * pow(1.25 / 3.25, 2)) < 1e-14);
    // Total internal reflection starts at sin θ = 1/1.5.
    double critical = sqrt(1 - 1 / 2.25);
    assert_true(sagi_fresnel_dielectric(-(critical - 1e-6), 1.5) == 1);
    assert_true(sagi_fresnel_dielectric(-(critical + 1e-3), 1.5) < 1);
    // A metal that does not absorb is a dielectric; at normal incidence ((η−1)² + κ²)/((η+1)² + κ²).
    for (double c = 0.05; c <= 1; c += 0.05)
        assert_true(fabs(sagi_fresnel_conductor(c, 1.5, 0) - sagi_fresnel_dielectric(c, 1.5)) < 1e-12);
    // The same at four wavelengths, in float.
    const sagi_spectrum eta = {0.05F, 0.2F, 1.5F, 1}, k = {4, 3.9F, 0, 1e4F};
    for (double c = 0; c <= 1; c += 0.05)
        for (int i = 0; i < 4; i++)
            assert_true(fabs((double)sagi_fresnel_conductor_spectrum(c, eta, k)[i] -
                             sagi_fresnel_conductor(c, (double)eta[i], (double)k[i])) < 2e-6);
    assert_true(fabs(sagi_fresnel_conductor(1, 0.2, 3.9) - (0.64 + 15.21) / (1.44 + 15.21)) < 1e-14);
    assert_true(fabs(sagi_fresnel_conductor(1e-9, 0.2, 3.9) - 1) < 1e-6);
    // The known mean reflectance inside glass of 1.5.
    assert_true(fabs(sagi_fresnel_inner_mean(1.5, 0) - 0.5963) < 1e-3);
}

static void refraction_obeys_snell(void **state) {
    (void)state;
    rng r = rng_make(5);
    for (int i = 0; i < 10000; i++) {
        sag_vec3 n = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
        sag_vec3 w = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
        double eta = rng_uniform(&r, 1.01, 2.5), ratio, relative = sag_dot(w, n) > 0 ? eta : 1 / eta;
        double sine = sag_length(sag_cross(w, n));
        sag_vec3 out;
        if (!sagi_refract(w, n, eta, &ratio, &out)) {
            assert_true(sine / relative > 1 - 1e-12);
            continue;
        }
        assert_true(fabs(ratio / relative - 1) < 1e-15);
        assert_true(fabs(sag_dot(out, out) - 1) < 1e-12);
        assert_true(fabs(sag_length(sag_cross(out, n)) * relative - sine) < 1e-12);
        assert_true(sag_dot(out, n) * sag_dot(w, n) <= 0);
        // In the plane of incidence, going on in the same direction along the surface.
        assert_true(fabs(sag_dot(sag_cross(w, n), out)) < 1e-12);
        assert_true(sag_dot(sag_cross(w, n), sag_cross(out, n)) <= 0);
    }
}

typedef struct material_case {
    const char *name;
    sagi_bsdf bsdf;
    double lost; // the most energy that single scattering may lose
} material_case;

static const material_case cases[] = {
    {"diffuse", {.kind = SAG_MATERIAL_DIFFUSE, .color = {1, 0.5F, 0.25F, 0}}, 0},
    {"rough metal",
     {.kind = SAG_MATERIAL_CONDUCTOR, .eta = {1, 1, 1, 1}, .k = {1e4F, 3, 1, 0}, .facets = {0.3, 0.3}},
     0.3},
    {"brushed metal",
     {.kind = SAG_MATERIAL_CONDUCTOR, .eta = {1, 1, 1, 1}, .k = {1e4F, 3, 1, 0}, .facets = {0.1, 0.4}},
     0.3},
    {"rough glass", {.kind = SAG_MATERIAL_DIELECTRIC, .ior = 1.5, .facets = {0.3, 0.3}}, 0.3},
    {"coated", {.kind = SAG_MATERIAL_COATED_DIFFUSE, .ior = 1.5, .color = {1, 0.5F, 0.1F, 0}}, 0},
    {"absorbing coat",
     {.kind = SAG_MATERIAL_COATED_DIFFUSE,
      .ior = 1.5,
      .color = {1, 0.5F, 0.1F, 0},
      .thickness = 0.01,
      .events = 10},
     0.2},
    {"rough coat",
     {.kind = SAG_MATERIAL_COATED_DIFFUSE, .ior = 1.5, .color = {1, 0.5F, 0.1F, 0}, .facets = {0.2, 0.2}},
     0.3},
    {"paper",
     {.kind = SAG_MATERIAL_DIFFUSE_TRANSMISSION, .color = {0.6F, 0.5F, 0, 0}, .base = {0.4F, 0.1F, 1, 0}},
     0},
    {"glossy glass", {.kind = SAG_MATERIAL_DIELECTRIC, .ior = 1.33, .facets = {0.15, 0.5}}, 0.4},
};
#define CASE_COUNT (sizeof cases / sizeof *cases)

static sagi_bsdf make(const material_case *c, sag_vec3 wo) {
    sagi_bsdf bsdf = c->bsdf;
    if (bsdf.kind == SAG_MATERIAL_COATED_DIFFUSE) {
        bsdf.inner_mean = sagi_fresnel_inner_mean(bsdf.ior, bsdf.thickness);
        sagi_coated_prepare(&bsdf);
    }
    sagi_bsdf_set_frame(&bsdf, sag_vec3_make(0, 0, 1), sag_vec3_make(0, 0, 1), sag_vec3_make(1, 0, 0), wo);
    return bsdf;
}

static sag_vec3 outgoing(int i) {
    double cosine = (const double[]){0.95, 0.6, 0.2, -0.3, -0.9}[i], s = sqrt(1 - cosine * cosine);
    return sag_vec3_make(s * cos(1.0), s * sin(1.0), cosine);
}

// Samples fall into cells of the sphere as often as the density's integral over the cell says.
static void samples_follow_their_density(void **state) {
    (void)state;
    enum { Z = 20, PHI = 20, COUNT = 100000, FINE = 16 };
    rng r = rng_make(8);
    for (size_t c = 0; c < CASE_COUNT; c++)
        for (int w = 0; w < 5; w++) {
            sagi_bsdf bsdf = make(&cases[c], outgoing(w));
            static double expected[Z * PHI];
            static uint32_t counts[Z * PHI];
            double all = 0, drawn = 0;
            for (int i = 0; i < Z * PHI; i++) {
                expected[i] = 0;
                counts[i] = 0;
                for (int j = 0; j < FINE * FINE; j++) {
                    double z = ((i / PHI + (j / FINE + 0.5) / FINE) / Z) * 2 - 1;
                    double phi = (i % PHI + (j % FINE + 0.5) / FINE) / PHI * 2 * SAGI_RENDER_PI,
                           s = sqrt(1 - z * z), pdf;
                    sagi_bsdf_eval(&bsdf, sag_vec3_make(s * cos(phi), s * sin(phi), z), &pdf);
                    expected[i] += pdf * (4 * SAGI_RENDER_PI / (Z * PHI)) / (FINE * FINE) * COUNT;
                }
                all += expected[i];
            }
            for (int i = 0; i < COUNT; i++) {
                sagi_bsdf_sample sample;
                sag_vec2 u = {rng_unit(&r), rng_unit(&r)};
                if (!sagi_bsdf_sample_wi(&bsdf, rng_unit(&r), u, &sample)) continue;
                if (sample.specular) continue;
                drawn++;
                int z = (int)((sample.wi.z + 1) / 2 * Z);
                double turn = atan2(sample.wi.y, sample.wi.x) / (2 * SAGI_RENDER_PI);
                int phi = (int)((turn < 0 ? turn + 1 : turn) * PHI);
                counts[(z < Z ? z : Z - 1) * PHI + (phi < PHI ? phi : PHI - 1)]++;
            }
            double chi = 0;
            int cells = 0;
            for (int i = 0; i < Z * PHI; i++) {
                if (expected[i] < 20) continue;
                // The midpoint rule of `expected` is good to about half a percent at the peaks.
                double slack = fmax(0, fabs(counts[i] - expected[i]) - 0.006 * expected[i]);
                chi += slack * slack / expected[i];
                cells++;
            }
            if (!(chi < cells + 6 * sqrt(2.0 * cells)))
                print_message("%s, wo %d: chi2 %g of %d cells\n", cases[c].name, w, chi, cells);
            assert_true(chi < cells + 6 * sqrt(2.0 * cells));
            // What no single cell tells: altogether.
            const double share = drawn / COUNT, spread = sqrt(share * (1 - share) * COUNT);
            if (!(fabs(drawn - all) < 5 * spread + 0.003 * COUNT))
                fail_msg("%s, wo %d: %g samples, not %g", cases[c].name, w, drawn, all);
        }
}

// The mean of the samples' weights is the integral of f |cos|, and never over 1 for what reflects.
static void energy_is_kept(void **state) {
    (void)state;
    enum { COUNT = 50000 };
    rng r = rng_make(9);
    for (size_t c = 0; c < CASE_COUNT; c++)
        for (int w = 0; w < 5; w++) {
            sagi_bsdf bsdf = make(&cases[c], outgoing(w));
            double sum = 0, squares = 0, specular = 0, integral = 0, integral_squares = 0;
            for (int i = 0; i < COUNT; i++) {
                sagi_bsdf_sample sample;
                sag_vec2 u = {rng_unit(&r), rng_unit(&r)};
                double weight = 0, other = 0;
                if (sagi_bsdf_sample_wi(&bsdf, rng_unit(&r), u, &sample)) {
                    // Radiance is compressed in glass: energy is what is left without.
                    weight = (double)sample.weight[0] * sample.eta * sample.eta;
                    if (sample.specular)
                        specular += weight;
                    else {
                        double pdf;
                        sagi_spectrum value = sagi_bsdf_eval(&bsdf, sample.wi, &pdf);
                        assert_true(fabs(pdf / sample.pdf - 1) < 1e-6);
                        assert_true(fabs((double)value[0] / pdf - (double)sample.weight[0]) <
                                    1e-6 * (1 + (double)sample.weight[0]));
                        other = weight;
                    }
                }
                sum += weight;
                squares += other * other;
                // The same integral by uniform directions.
                sag_vec3 wi = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
                double pdf, eta = wi.z * bsdf.wo.z > 0 ? 1 : bsdf.wo.z > 0 ? bsdf.ior : 1 / bsdf.ior;
                double value = (double)sagi_bsdf_eval(&bsdf, wi, &pdf)[0] * 4 * SAGI_RENDER_PI;
                if (bsdf.kind == SAG_MATERIAL_DIELECTRIC) value *= eta * eta;
                integral += value;
                integral_squares += value * value;
            }
            sum /= COUNT, integral /= COUNT, specular /= COUNT;
            double deviation = sqrt((integral_squares / COUNT + squares / COUNT) / COUNT);
            assert_true(fabs(sum - specular - integral) < 5 * deviation + 1e-9);
            bool lossless = bsdf.kind != SAG_MATERIAL_CONDUCTOR || c == 1 || c == 2;
            if (!(sum < 1.02) || (lossless && !(sum > 1 - cases[c].lost - 0.02)))
                print_message("%s, wo %d: albedo %g\n", cases[c].name, w, sum);
            assert_true(sum < 1.02);
            if (lossless) assert_true(sum > 1 - cases[c].lost - 0.02);
        }
}

static void scattering_is_reciprocal(void **state) {
    (void)state;
    rng r = rng_make(10);
    for (size_t c = 0; c < CASE_COUNT; c++)
        for (int i = 0; i < 2000; i++) {
            sag_vec3 wo = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
            sag_vec3 wi = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
            if (cases[c].bsdf.kind == SAG_MATERIAL_COATED_DIFFUSE && (wo.z < 0 || wi.z < 0)) continue;
            sagi_bsdf forth = make(&cases[c], wo), back = make(&cases[c], wi);
            double pdf, a = (double)sagi_bsdf_eval(&forth, wi, &pdf)[1] / fabs(wi.z);
            double b = (double)sagi_bsdf_eval(&back, wo, &pdf)[1] / fabs(wo.z);
            // f(wo → wi)/η_i² = f(wi → wo)/η_o² across a boundary.
            if (wo.z * wi.z < 0 && forth.kind == SAG_MATERIAL_DIELECTRIC)
                a *= wo.z > 0 ? forth.ior * forth.ior : 1 / (forth.ior * forth.ior);
            assert_true(fabs(a - b) <= 1e-6 * (fabs(a) + fabs(b))); // colours are floats
        }
}

static void smooth_glass_splits_light_without_loss(void **state) {
    (void)state;
    material_case glass = {"glass", {.kind = SAG_MATERIAL_DIELECTRIC, .ior = 1.5, .specular = true}, 0};
    for (int w = 0; w < 5; w++) {
        sag_vec3 wo = outgoing(w);
        sagi_bsdf bsdf = make(&glass, wo);
        double reflectance = sagi_fresnel_dielectric(wo.z, 1.5);
        sagi_bsdf_sample sample;
        assert_true(sagi_bsdf_sample_wi(&bsdf, reflectance * 0.999, (sag_vec2){0, 0}, &sample));
        assert_true(sample.specular && !sample.transmission && sample.weight[0] == 1);
        assert_true(fabs(sample.wi.z - wo.z) < 1e-15 && fabs(sample.wi.x + wo.x) < 1e-15);
        if (reflectance == 1) continue; // total internal reflection: nothing gets through
        assert_true(sagi_bsdf_sample_wi(&bsdf, reflectance * 1.001, (sag_vec2){0, 0}, &sample));
        assert_true(sample.specular && sample.transmission && sample.wi.z * wo.z < 0);
        double eta = wo.z > 0 ? 1.5 : 1 / 1.5;
        assert_true(fabs(sample.eta - eta) < 1e-15 &&
                    fabs((double)sample.weight[0] - 1 / (eta * eta)) < 1e-7);
        assert_true(fabs(sample.wi.x * eta + wo.x) < 1e-12 && fabs(sample.wi.y * eta + wo.y) < 1e-12);
    }
    // A pane lets light through straight; index 1 is nothing at all.
    material_case pane = {"pane", {.kind = SAG_MATERIAL_THIN_DIELECTRIC, .ior = 1, .specular = true}, 0};
    sagi_bsdf bsdf = make(&pane, outgoing(1));
    sagi_bsdf_sample sample;
    assert_true(sagi_bsdf_sample_wi(&bsdf, 0.5, (sag_vec2){0, 0}, &sample));
    assert_true(sample.transmission && fabs(sag_dot(sample.wi, outgoing(1)) + 1) < 1e-12);
}

// pbrt-v4's rule: α below 0.3 is doubled, but stays within 0.1 and 0.3; mirrors are none any more.
static void regularized_surfaces_are_rough(void **state) {
    (void)state;
    static const double alphas[][2] = {{0, 0.1}, {0.02, 0.1}, {0.08, 0.16}, {0.2, 0.3}, {0.5, 0.5}};
    for (int i = 0; i < 5; i++) {
        sagi_bsdf bsdf = {.kind = SAG_MATERIAL_CONDUCTOR, .facets = {alphas[i][0], 0.7}, .specular = i == 0};
        sagi_bsdf_regularize(&bsdf);
        assert_true(fabs(bsdf.facets.ax - alphas[i][1]) < 1e-15 && bsdf.facets.ay == 0.7 && !bsdf.specular);
    }
    sagi_bsdf pane = {.kind = SAG_MATERIAL_THIN_DIELECTRIC, .ior = 1.5, .specular = true};
    sagi_bsdf_regularize(&pane);
    assert_true(pane.specular);
}

// pbrt-v4's rule: with a shading normal that leans, a surface scatters as one that lies across that normal,
// whichever side of the true one the directions are on. Once such directions were dropped, and rims and bumps
// were up to a quarter off pbrt's pictures.
static void shading_normals_decide_alone(void **state) {
    (void)state;
    rng r = rng_make(12);
    const sag_vec3 geometric = {0, 0, 1}, shading = sag_normalize(sag_vec3_make(0.8, 0, 0.6)), s = {0, 1, 0};
    int disagreeing = 0;
    for (int i = 0; i < 20000; i++) {
        const sag_vec3 wo = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
        sagi_bsdf leaning = make(&cases[(size_t)i % CASE_COUNT], wo), flat = leaning;
        sagi_bsdf_set_frame(&leaning, geometric, shading, s, wo);
        sagi_bsdf_set_frame(&flat, shading, shading, s, wo);
        const sag_vec2 u = {rng_unit(&r), rng_unit(&r)};
        const double choose = rng_unit(&r);
        sagi_bsdf_sample sample, same;
        const bool found = sagi_bsdf_sample_wi(&leaning, choose, u, &sample);
        assert_true(found == sagi_bsdf_sample_wi(&flat, choose, u, &same));
        if (!found) continue;
        assert_memory_equal(&sample.wi, &same.wi, sizeof same.wi);
        assert_true(sample.pdf == same.pdf && sample.transmission == same.transmission);
        disagreeing += sample.transmission != (sample.wi.z * wo.z < 0);
        double pdf, other;
        const sagi_spectrum value = sagi_bsdf_eval(&leaning, sample.wi, &pdf);
        assert_true((double)value[0] == (double)sagi_bsdf_eval(&flat, sample.wi, &other)[0] && pdf == other);
    }
    assert_true(disagreeing > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fresnel_is_right_where_it_is_known),
        cmocka_unit_test(refraction_obeys_snell),
        cmocka_unit_test(samples_follow_their_density),
        cmocka_unit_test(energy_is_kept),
        cmocka_unit_test(scattering_is_reciprocal),
        cmocka_unit_test(smooth_glass_splits_light_without_loss),
        cmocka_unit_test(regularized_surfaces_are_rough),
        cmocka_unit_test(shading_normals_decide_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
