// SPDX-License-Identifier: MIT
// Coats that are walked through, against a slow walk that knows nothing but the coat's and the base's own
// scattering; reciprocity, energy, and white things under coats.
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
#include "render/medium.h"
#include "render/warp.h"
#include "support/random.h"

// Cells of the upper hemisphere, of equal solid angle.
enum { Z = 5, PHI = 6, CELLS = Z * PHI };

typedef struct coat_case {
    const char *name;
    sagi_bsdf bsdf;
} coat_case;

#define METAL .kind = SAG_MATERIAL_COATED_CONDUCTOR, .layered = true, .walks = 1, .ior = 1.5
#define GOLD  .eta = {0.15F, 0.4F, 1, 1}, .k = {2.3F, 1.5F, 1, 1e4F}
#define PAINT                                                                                                \
    .kind = SAG_MATERIAL_COATED_DIFFUSE, .layered = true, .walks = 1, .ior = 1.5,                            \
    .color = {0.8F, 0.5F, 0.1F, 1}

static const coat_case cases[] = {
    {"mirrors", {METAL, GOLD, .thickness = 0.01, .events = 10, .specular = true}},
    {"rough metal, smooth coat", {METAL, GOLD, .facets = {0.4, 0.4}, .thickness = 0.01, .events = 10}},
    {"smooth metal, rough coat", {METAL, GOLD, .coat = {0.3, 0.3}, .thickness = 0.05}},
    {"both brushed", {METAL, GOLD, .facets = {0.2, 0.5}, .coat = {0.5, 0.2}, .thickness = 0.01}},
    {"mirrors and fog", {METAL, GOLD, .thickness = 0.5, .albedo = {0.8F, 0.5F, 0, 1}, .g = 0.5}},
    {"rough and fog",
     {METAL, GOLD, .facets = {0.3, 0.3}, .coat = {0.3, 0.3}, .thickness = 0.3, .albedo = {0.9F, 0.5F, 0, 1}}},
    {"paint and fog", {PAINT, .thickness = 0.4, .albedo = {0.7F, 0.5F, 0, 1}, .g = -0.4}},
    {"paint and rough fog", {PAINT, .coat = {0.3, 0.3}, .thickness = 0.4, .albedo = {0.7F, 0.5F, 0, 1}}},
    {"paint and haze", {PAINT, .thickness = 0.1, .events = 10}},
};
#define CASE_COUNT (sizeof cases / sizeof *cases)

static sagi_bsdf make(const coat_case *c, sag_vec3 wo, uint64_t seed) {
    sagi_bsdf bsdf = c->bsdf;
    bsdf.seed = seed;
    const sag_vec3 up = {0, 0, 1}, tangent = {1, 0, 0};
    sagi_bsdf_set_frame(&bsdf, up, up, tangent, wo);
    return bsdf;
}

static sag_vec3 outgoing(int i) {
    const double cosine = (const double[]){0.95, 0.5, 0.15}[i], s = sqrt(1 - cosine * cosine);
    return sag_vec3_make(s * cos(1.0), s * sin(1.0), cosine);
}

static int cell_of(sag_vec3 w) {
    const double turn = atan2(w.y, w.x) / (2 * SAGI_RENDER_PI);
    const int z = (int)(fabs(w.z) * Z), phi = (int)((turn < 0 ? turn + 1 : turn) * PHI);
    return (z < Z ? z : Z - 1) * PHI + (phi < PHI ? phi : PHI - 1);
}

static bool slow_walk(const sagi_bsdf *whole, sag_vec3 wo, rng *r, sag_vec3 *wi, double *weight,
                      bool *specular) {
    sagi_bsdf coat = {.kind = SAG_MATERIAL_DIELECTRIC, .ior = whole->ior, .facets = whole->coat},
              base = *whole;
    coat.specular = !(coat.facets.ax > 0);
    base.kind = whole->kind == SAG_MATERIAL_COATED_CONDUCTOR ? SAG_MATERIAL_CONDUCTOR : SAG_MATERIAL_DIFFUSE;
    base.specular = base.kind == SAG_MATERIAL_CONDUCTOR && !(base.facets.ax > 0);
    const sag_vec3 up = {0, 0, 1}, tangent = {1, 0, 0};
    *weight = 1;
    *specular = true;
    double z = whole->thickness;
    sag_vec3 w = sag_neg(wo);
    bool at_coat = true;
    for (int event = 0; event <= (whole->events ? (int)whole->events : 400); event++) {
        sagi_bsdf *at = at_coat ? &coat : &base;
        sagi_bsdf_set_frame(at, up, up, tangent, sag_neg(w));
        sagi_bsdf_sample sample;
        const sag_vec2 u = {rng_unit(r), rng_unit(r)};
        if (!sagi_bsdf_sample_wi(at, rng_unit(r), u, &sample)) return false;
        *weight *= (double)sample.weight[0];
        *specular &= sample.specular;
        w = sample.wi;
        if (at_coat && w.z > 0) {
            *wi = w;
            return true;
        }
        // To the next boundary.
        for (;;) {
            const double step = -log(1 - rng_unit(r)) * fabs(w.z), left = w.z > 0 ? whole->thickness - z : z;
            if (step >= left) break;
            *weight *= (double)whole->albedo[0];
            if (!(*weight > 0)) return false;
            z += w.z > 0 ? step : -step;
            sag_vec3 next;
            sagi_phase_sample(whole->g, sag_neg(w), (sag_vec2){rng_unit(r), rng_unit(r)}, &next);
            w = next;
            *specular = false;
        }
        at_coat = w.z > 0;
        z = at_coat ? whole->thickness : 0;
    }
    return false;
}

// What a coat with a formula scatters altogether is what the slow walk says.
static void formulas_agree_with_the_slow_walk(void **state) {
    (void)state;
    enum { COUNT = 40000 };
    rng r = rng_make(36);
    static const double roughness[] = {0, 0.1, 0.3}, slack[] = {0.008, 0.008, 0.008};
    for (int c = 0; c < 3; c++)
        for (int w = 0; w < 3; w++)
            for (int thick = 0; thick < 2; thick++) {
                sagi_bsdf bsdf = {.kind = SAG_MATERIAL_COATED_DIFFUSE, .ior = 1.5, .events = 10};
                bsdf.color = sagi_spectrum_all(0.7);
                bsdf.thickness = thick ? 0.2 : 0.01;
                bsdf.facets = bsdf.coat = (sagi_microfacet){roughness[c], roughness[c]};
                float shares[SAGI_COAT_STEPS], lit[SAGI_COAT_STEPS];
                bsdf.inner_mean = c ? sagi_coat_table(&bsdf, shares, lit)
                                    : sagi_fresnel_inner_mean(bsdf.ior, bsdf.thickness);
                if (c) bsdf.rough_share = shares;
                sagi_coated_prepare(&bsdf);
                const coat_case one = {"", bsdf};
                bsdf = make(&one, outgoing(w), 0);
                double slow = 0, formula = 0;
                for (int i = 0; i < COUNT; i++) {
                    sag_vec3 wi;
                    double weight;
                    bool specular;
                    if (slow_walk(&bsdf, outgoing(w), &r, &wi, &weight, &specular)) slow += weight / COUNT;
                    sagi_bsdf_sample sample;
                    const sag_vec2 u = {rng_unit(&r), rng_unit(&r)};
                    if (sagi_bsdf_sample_wi(&bsdf, rng_unit(&r), u, &sample))
                        formula += (double)sample.weight[0] / COUNT;
                }
                if (!(fabs(slow - formula) < slack[c]))
                    print_message("roughness %g, thickness %g, wo %d: %g, not %g\n", roughness[c],
                                  bsdf.thickness, w, formula, slow);
                assert_true(fabs(slow - formula) < slack[c]);
            }
}

typedef struct tally {
    double sum[CELLS + 1], squares[CELLS + 1]; // the last one is for single directions
} tally;

static void count(tally *t, int cell, double value) {
    t->sum[cell] += value;
    t->squares[cell] += value * value;
}

static void compare(const char *name, int w, const char *what, const tally *a, const tally *b, int cells,
                    double n) {
    double chi = 0;
    int used = 0;
    for (int i = 0; i < cells; i++) {
        const double mean_a = a->sum[i] / n, mean_b = b->sum[i] / n;
        const double variance =
            (a->squares[i] / n - mean_a * mean_a + b->squares[i] / n - mean_b * mean_b) / n;
        if (!(variance > 1e-14)) {
            assert_true(fabs(mean_a - mean_b) < 1e-6);
            continue;
        }
        chi += sagi_square(mean_a - mean_b) / variance;
        used++;
    }
    if (!(chi < used + 5 * sqrt(2.0 * used) + 3)) {
        print_message("%s, wo %d, %s: chi2 %g of %d\n", name, w, what, chi, used);
        for (int i = 0; i < cells; i++) print_message(" %g/%g", a->sum[i] / n, b->sum[i] / n);
        print_message("\n");
    }
    assert_true(chi < used + 5 * sqrt(2.0 * used) + 3);
}

// The same over all cells, materials and directions: a few percent too much everywhere show in no cell alone.
typedef struct balance {
    double difference, variance, sum;
} balance;

// How much more `t` has than the slow walk. `of_each`: every sample fell into one cell; else each cell has
// had its share of them. Sharp peaks, of great variance, would hide the others, and are left out.
static void weigh(balance *all, const tally *slow, const tally *t, bool of_each, int cells, double n) {
    double sums[2] = {0, 0}, variance = 0;
    for (int k = 0; k < 2; k++) {
        const tally *one = k ? t : slow;
        double squares = 0, within = 0;
        for (int i = 0; i < cells; i++) {
            sums[k] += one->sum[i], squares += one->squares[i];
            within += sagi_square(one->sum[i]) * cells / n;
        }
        variance += (squares - (!k || of_each ? sums[k] * sums[k] / n : within)) / (n * n);
    }
    if (!(variance < 1e-4)) return;
    all->difference += (sums[1] - sums[0]) / n;
    all->variance += variance;
    all->sum += sums[0] / n;
}

static void assert_balanced(const char *what, const balance *all) {
    const double deviation = sqrt(all->variance);
    if (!(fabs(all->difference) < 4 * deviation && deviation < 0.005 * all->sum))
        fail_msg("%s: %g +- %g too much, of %g", what, all->difference, deviation, all->sum);
}

static void walks_agree_with_the_slow_one(void **state) {
    (void)state;
    enum { COUNT = 12000 };
    rng r = rng_make(31);
    balance samples = {0}, values = {0};
    for (size_t c = 0; c < CASE_COUNT; c++)
        for (int w = 0; w < 3; w++) {
            const sag_vec3 wo = outgoing(w);
            tally slow = {{0}, {0}}, sampled = {{0}, {0}}, evaluated = {{0}, {0}};
            for (uint64_t i = 0; i < COUNT; i++) {
                const sagi_bsdf bsdf = make(&cases[c], wo, i);
                sag_vec3 wi;
                double weight, pdf;
                bool specular;
                if (slow_walk(&bsdf, wo, &r, &wi, &weight, &specular))
                    count(&slow, specular ? CELLS : cell_of(wi), weight);
                sagi_bsdf_sample sample;
                const sag_vec2 u = {rng_unit(&r), rng_unit(&r)};
                if (sagi_bsdf_sample_wi(&bsdf, rng_unit(&r), u, &sample)) {
                    assert_true(sample.specular || sample.pdf > 0);
                    count(&sampled, sample.specular ? CELLS : cell_of(sample.wi), (double)sample.weight[0]);
                }
                // A direction for each cell in turn.
                const int cell = (int)(i % CELLS);
                const double z = (cell / PHI + rng_unit(&r)) / Z,
                             phi = (cell % PHI + rng_unit(&r)) / PHI * 2 * SAGI_RENDER_PI,
                             s = sqrt(1 - z * z);
                const sag_vec3 to = sag_vec3_make(s * cos(phi), s * sin(phi), z);
                count(&evaluated, cell, (double)sagi_bsdf_eval(&bsdf, to, &pdf)[0] * 2 * SAGI_RENDER_PI);
            }
            compare(cases[c].name, w, "sample", &slow, &sampled, CELLS + 1, COUNT);
            compare(cases[c].name, w, "eval", &slow, &evaluated, CELLS, COUNT);
            weigh(&samples, &slow, &sampled, true, CELLS + 1, COUNT);
            weigh(&values, &slow, &evaluated, false, CELLS, COUNT);
        }
    assert_balanced("samples", &samples);
    assert_balanced("values", &values);
}

// The density is an estimate, but one of a density: it is 1 altogether or less.
static void densities_are_densities(void **state) {
    (void)state;
    enum { COUNT = 40000 };
    rng r = rng_make(32);
    for (size_t c = 1; c < CASE_COUNT; c++)
        for (int w = 0; w < 3; w++) {
            double sum = 0, squares = 0, pdf;
            const sagi_bsdf bsdf = make(&cases[c], outgoing(w), 1);
            for (int i = 0; i < COUNT; i++) {
                sag_vec3 wi = sagi_warp_sphere((sag_vec2){rng_unit(&r), rng_unit(&r)});
                wi.z = fabs(wi.z);
                sagi_bsdf_eval(&bsdf, wi, &pdf);
                pdf *= 2 * SAGI_RENDER_PI;
                sum += pdf, squares += pdf * pdf;
            }
            sum /= COUNT;
            assert_true(sum < 1 + 5 * sqrt(squares) / COUNT);
        }
}

static void walks_are_reciprocal(void **state) {
    (void)state;
    enum { COUNT = 12000 };
    rng r = rng_make(33);
    for (size_t c = 1; c < CASE_COUNT; c++)
        for (int i = 0; i < 4; i++) {
            sag_vec3 wo = sagi_warp_cosine((sag_vec2){rng_unit(&r), rng_unit(&r)});
            sag_vec3 wi = sagi_warp_cosine((sag_vec2){rng_unit(&r), rng_unit(&r)});
            tally forth = {{0}, {0}}, back = {{0}, {0}};
            for (uint64_t seed = 0; seed < COUNT; seed++) {
                const sagi_bsdf one = make(&cases[c], wo, seed), other = make(&cases[c], wi, seed);
                double pdf;
                count(&forth, 0, (double)sagi_bsdf_eval(&one, wi, &pdf)[0] / wi.z);
                count(&back, 0, (double)sagi_bsdf_eval(&other, wo, &pdf)[0] / wo.z);
            }
            compare(cases[c].name, i, "reciprocity", &forth, &back, 1, COUNT);
        }
}

// White paint in white fog under a smooth coat gives back what it gets; the last wavelength is white.
static void nothing_is_lost_or_made(void **state) {
    (void)state;
    enum { COUNT = 12000 };
    rng r = rng_make(34);
    for (size_t c = 0; c < CASE_COUNT; c++)
        for (int w = 0; w < 3; w++) {
            double sum = 0;
            for (uint64_t i = 0; i < COUNT; i++) {
                sagi_bsdf bsdf = make(&cases[c], outgoing(w), i);
                const sagi_spectrum white = {1, 1, 1, 1};
                bsdf.events = 0;
                if (sagi_spectrum_is_black(bsdf.albedo)) bsdf.thickness = 0;
                bsdf.albedo = bsdf.color = white;
                bsdf.eta = white, bsdf.k = white * 1e4F;
                sagi_bsdf_sample sample;
                const sag_vec2 u = {rng_unit(&r), rng_unit(&r)};
                if (sagi_bsdf_sample_wi(&bsdf, rng_unit(&r), u, &sample))
                    sum += (double)sample.weight[3] / COUNT;
            }
            const bool smooth = !(cases[c].bsdf.coat.ax > 0) && !(cases[c].bsdf.facets.ax > 0);
            if (!(sum < 1.02 && sum > (smooth ? 0.97 : 0.4)))
                print_message("%s, wo %d: %g\n", cases[c].name, w, sum);
            assert_true(sum < 1.02 && sum > (smooth ? 0.97 : 0.4));
        }
}

// Grazing light through rough fog was NaN: nothing passed, and was divided by.
static void grazing_directions_are_numbers(void **state) {
    (void)state;
    rng r = rng_make(35);
    for (size_t c = 0; c < CASE_COUNT; c++)
        for (uint64_t i = 0; i < 5000; i++) {
            const double z[2] = {pow(10, -8 * rng_unit(&r)), pow(10, -8 * rng_unit(&r))};
            sag_vec3 w[2];
            for (int k = 0; k < 2; k++) {
                const double phi = 2 * SAGI_RENDER_PI * rng_unit(&r), s = sqrt(1 - z[k] * z[k]);
                w[k] = sag_vec3_make(s * cos(phi), s * sin(phi), z[k]);
            }
            const sagi_bsdf bsdf = make(&cases[c], w[0], i);
            double pdf;
            assert_true(sagi_spectrum_is_finite(sagi_bsdf_eval(&bsdf, w[1], &pdf)) && isfinite(pdf));
            sagi_bsdf_sample sample;
            if (sagi_bsdf_sample_wi(&bsdf, rng_unit(&r), (sag_vec2){rng_unit(&r), rng_unit(&r)}, &sample))
                assert_true(sagi_spectrum_is_finite(sample.weight) &&
                            (sample.specular || isfinite(sample.pdf)));
        }
}

// What pbrt-v4's BxDF::f, asked a million times for lamps all over the sky, says of coats of α 0.3 and 0.6 by
// the cosine of wo (to ± 0.001): more than what its own walk lets out, which the last column is.
static void lamps_shine_through_rough_coats_as_in_pbrt(void **state) {
    (void)state;
    static const struct {
        const char *name;
        sagi_bsdf bsdf;
        double lit[2][3][2];
    } coats[] = {
        {"paint",
         {.kind = SAG_MATERIAL_COATED_DIFFUSE, .layered = true, .thickness = 0.01},
         {{{0.4315, 0.4013}, {0.4294, 0.4005}, {0.4489, 0.4229}},
          {{0.3486, 0.3163}, {0.3248, 0.2963}, {0.3284, 0.3027}}}},
        {"metal",
         {.kind = SAG_MATERIAL_COATED_CONDUCTOR, .layered = true, .thickness = 0.01, .facets = {0.3, 0.3}},
         {{{0.5748, 0.5263}, {0.4950, 0.4460}, {0.4656, 0.4256}},
          {{0.4494, 0.3935}, {0.3662, 0.3182}, {0.3421, 0.3028}}}},
        {"paint and fog",
         {.kind = SAG_MATERIAL_COATED_DIFFUSE, .layered = true, .thickness = 0.4, .g = -0.4},
         {{{0.3075, 0.2889}, {0.3037, 0.2853}, {0.3311, 0.3154}},
          {{0.2547, 0.2337}, {0.2328, 0.2153}, {0.2384, 0.2244}}}},
        {"paint by formula",
         {.kind = SAG_MATERIAL_COATED_DIFFUSE, .thickness = 0.01},
         {{{0.4315, 0.4013}, {0.4294, 0.4005}, {0.4489, 0.4229}},
          {{0.3486, 0.3163}, {0.3248, 0.2963}, {0.3284, 0.3027}}}},
    };
    enum { COUNT = 100000 };
    rng r = rng_make(44);
    for (size_t c = 0; c < sizeof coats / sizeof *coats; c++)
        for (int rough = 0; rough < 2; rough++)
            for (int w = 0; w < 3; w++)
                for (int walk = 0; walk < 2; walk++) {
                    coat_case one = {coats[c].name, coats[c].bsdf};
                    float shares[SAGI_COAT_STEPS], lit[SAGI_COAT_STEPS];
                    sagi_bsdf *b = &one.bsdf;
                    const double alpha = rough ? 0.6 : 0.3, expected = coats[c].lit[rough][w][walk];
                    b->ior = 1.5, b->walks = 1, b->events = 10, b->lit_as_pbrt = walk == 0;
                    b->coat = (sagi_microfacet){alpha, alpha};
                    b->color = sagi_spectrum_all(0.7);
                    b->albedo = sagi_spectrum_all(b->thickness > 0.1 ? 0.7 : 0);
                    b->eta = sagi_spectrum_all(0.15), b->k = sagi_spectrum_all(2.3);
                    if (!b->layered) {
                        b->facets = b->coat;
                        b->inner_mean = sagi_coat_table(b, shares, lit);
                        b->rough_share = shares, b->lit_share = walk ? shares : lit;
                        sagi_coated_prepare(b);
                    }
                    double sum = 0, pdf;
                    for (uint64_t i = 0; i < COUNT; i++) {
                        const sagi_bsdf at = make(&one, outgoing(w), i);
                        const sag_vec3 wi = sagi_warp_cosine((sag_vec2){rng_unit(&r), rng_unit(&r)});
                        const double value = (double)sagi_bsdf_eval(&at, wi, &pdf)[0];
                        sum += wi.z > 0 ? value * SAGI_RENDER_PI / wi.z / COUNT : 0;
                    }
                    const double slack = (w == 2 ? 0.035 : 0.015) * expected; // noise is larger there
                    if (!(fabs(sum - expected) < slack))
                        print_message("%s, alpha %g, wo %d%s: %g, not %g\n", one.name, alpha, w,
                                      walk ? " by rights" : "", sum, expected);
                    assert_true(fabs(sum - expected) < slack);
                }
}

// A brushed coat over anything lies along the surface's u, as brushed metal does; it lay anywhere.
static void brushed_coats_lie_along_u(void **state) {
    (void)state;
    const sag_vec3 up = {0, 0, 1}, along = sag_normalize(sag_vec3_make(1, 2, 0));
    for (int of_coat = 0; of_coat < 2; of_coat++) {
        sagi_bsdf bsdf = {METAL};
        *(of_coat ? &bsdf.coat : &bsdf.facets) = (sagi_microfacet){0.1, 0.4};
        sagi_bsdf_set_frame(&bsdf, up, up, along, up);
        assert_true(sag_dot(bsdf.s, along) > 1 - 1e-12);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walks_agree_with_the_slow_one),
        cmocka_unit_test(formulas_agree_with_the_slow_walk),
        cmocka_unit_test(densities_are_densities),
        cmocka_unit_test(walks_are_reciprocal),
        cmocka_unit_test(lamps_shine_through_rough_coats_as_in_pbrt),
        cmocka_unit_test(brushed_coats_lie_along_u),
        cmocka_unit_test(nothing_is_lost_or_made),
        cmocka_unit_test(grazing_directions_are_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
