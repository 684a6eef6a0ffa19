// SPDX-License-Identifier: MIT
// Random numbers: uniform, stratified as they say, unrelated between dimensions and pixels; warps and tables
// have the densities they claim.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/distribution.h"
#include "render/sampler.h"
#include "render/warp.h"
#include "support/random.h"

#define BINS 16

// Every sampler with every way to randomize it that leaves nothing regular.
static const struct {
    sag_sampler_kind kind;
    sag_randomization way;
} kinds[] = {
    {SAG_SAMPLER_INDEPENDENT, SAG_RANDOMIZATION_DEFAULT},
    {SAG_SAMPLER_STRATIFIED, SAG_RANDOMIZATION_DEFAULT},
    {SAG_SAMPLER_SOBOL, SAG_RANDOMIZATION_DEFAULT},
    {SAG_SAMPLER_PADDED_SOBOL, SAG_RANDOMIZATION_FAST_OWEN},
    {SAG_SAMPLER_PADDED_SOBOL, SAG_RANDOMIZATION_OWEN},
    {SAG_SAMPLER_PADDED_SOBOL, SAG_RANDOMIZATION_PERMUTE_DIGITS},
    {SAG_SAMPLER_ZSOBOL, SAG_RANDOMIZATION_FAST_OWEN},
    {SAG_SAMPLER_ZSOBOL, SAG_RANDOMIZATION_OWEN},
    {SAG_SAMPLER_HALTON, SAG_RANDOMIZATION_PERMUTE_DIGITS},
    {SAG_SAMPLER_HALTON, SAG_RANDOMIZATION_OWEN},
};
#define KINDS (sizeof kinds / sizeof *kinds)

static sagi_sampler make_way(sagi_sampler_plan *plan, sag_sampler_kind kind, sag_randomization way,
                             uint64_t seed, uint32_t count) {
    const sag_settings settings = {
        .sampler = kind, .randomization = way, .seed = seed, .samples_per_pixel = count};
    assert_int_equal(sagi_sampler_plan_init(plan, &settings, NULL), SAG_OK);
    return (sagi_sampler){.plan = plan};
}

static sagi_sampler make(sagi_sampler_plan *plan, sag_sampler_kind kind, uint64_t seed, uint32_t count) {
    return make_way(plan, kind, SAG_RANDOMIZATION_DEFAULT, seed, count);
}

// χ² of counts that should be equal; for n − 1 degrees of freedom its mean is n − 1, its deviation √(2(n −
// 1)).
static double chi_squared_excess(const uint32_t *counts, size_t n) {
    double sum = 0, chi = 0;
    for (size_t i = 0; i < n; i++) sum += counts[i];
    for (size_t i = 0; i < n; i++) chi += (counts[i] - sum / n) * (counts[i] - sum / n) / (sum / n);
    return (chi - (n - 1.0)) / sqrt(2 * (n - 1.0));
}

static void numbers_are_uniform(void **state) {
    (void)state;
    for (size_t k = 0; k < KINDS; k++) {
        sagi_sampler_plan plan;
        sagi_sampler sampler = make_way(&plan, kinds[k].kind, kinds[k].way, 7, 16);
        uint32_t one[BINS] = {0}, two[BINS * BINS] = {0}, mixed[BINS * BINS] = {0};
        for (uint32_t pixel = 0; pixel < 2000; pixel++) {
            sagi_sampler_start_pixel(&sampler, pixel % 50, pixel / 50);
            // One sample a pixel: the strata of one pixel would be too even for χ².
            sagi_sampler_start_sample(&sampler, pixel % 16);
            for (int d = 0; d < 10; d++) {
                double a = sagi_sampler_1d(&sampler), b = sagi_sampler_1d(&sampler);
                sag_vec2 c = sagi_sampler_2d(&sampler);
                assert_true(a >= 0 && a < 1 && c.x >= 0 && c.x < 1 && c.y >= 0 && c.y < 1);
                one[(int)(a * BINS)]++;
                two[(int)(c.x * BINS) * BINS + (int)(c.y * BINS)]++;
                mixed[(int)(b * BINS) * BINS + (int)(c.x * BINS)]++;
            }
        }
        assert_true(fabs(chi_squared_excess(one, BINS)) < 5);
        assert_true(fabs(chi_squared_excess(two, (size_t)BINS * BINS)) < 5);
        assert_true(fabs(chi_squared_excess(mixed, (size_t)BINS * BINS)) < 5);
    }
}

// Within a pixel every pair of dimensions is spread over the unit square without relation to another pair.
static void dimensions_of_one_pixel_are_unrelated(void **state) {
    (void)state;
    for (size_t k = 0; k < KINDS; k++) {
        sagi_sampler_plan plan;
        sagi_sampler sampler = make_way(&plan, kinds[k].kind, kinds[k].way, 3, 4096);
        sagi_sampler_start_pixel(&sampler, 5, 9);
        uint32_t counts[4][BINS * BINS] = {{0}};
        for (uint32_t i = 0; i < 4096; i++) {
            sagi_sampler_start_sample(&sampler, i);
            sag_vec2 a = sagi_sampler_2d(&sampler), b = sagi_sampler_2d(&sampler);
            double c = sagi_sampler_1d(&sampler), d = sagi_sampler_1d(&sampler);
            counts[0][(int)(a.x * BINS) * BINS + (int)(b.x * BINS)]++;
            counts[1][(int)(a.y * BINS) * BINS + (int)(b.y * BINS)]++;
            counts[2][(int)(c * BINS) * BINS + (int)(d * BINS)]++;
            counts[3][(int)(a.x * BINS) * BINS + (int)(c * BINS)]++;
        }
        for (int j = 0; j < 4; j++) assert_true(chi_squared_excess(counts[j], (size_t)BINS * BINS) < 5);
    }
}

static void strata_have_one_sample_each(void **state) {
    (void)state;
    const uint32_t sizes[] = {1, 2, 7, 12, 16, 64, 100};
    for (int s = 0; s < 7; s++) {
        uint32_t count = sizes[s];
        sagi_sampler_plan plan;
        sagi_sampler sampler = make(&plan, SAG_SAMPLER_STRATIFIED, 11, count);
        assert_int_equal(plan.x_count * plan.y_count, count);
        for (uint32_t pixel = 0; pixel < 20; pixel++) {
            uint32_t one[100] = {0}, two[100] = {0};
            sagi_sampler_start_pixel(&sampler, pixel, 3);
            for (uint32_t i = 0; i < count; i++) {
                sagi_sampler_start_sample(&sampler, i);
                one[(uint32_t)(sagi_sampler_1d(&sampler) * count)]++;
                sag_vec2 p = sagi_sampler_2d(&sampler);
                two[(uint32_t)(p.y * plan.y_count) * plan.x_count + (uint32_t)(p.x * plan.x_count)]++;
            }
            for (uint32_t i = 0; i < count; i++) assert_true(one[i] == 1 && two[i] == 1);
        }
    }
}

// Whether 2ᵏ points lie one in each box 2⁻ᵃ × 2⁻ᵇ, a + b = k, whatever a; k ≤ 8.
static void assert_net(const sag_vec2 *points, uint32_t k) {
    const uint32_t count = 1u << k;
    for (uint32_t a = 0; a <= k; a++) {
        const uint32_t nx = 1u << a, ny = 1u << (k - a);
        uint32_t counts[256] = {0};
        for (uint32_t i = 0; i < count; i++)
            counts[(uint32_t)(points[i].y * ny) * nx + (uint32_t)(points[i].x * nx)]++;
        for (uint32_t i = 0; i < count; i++) assert_int_equal(counts[i], 1);
    }
}

static void sobol_points_fill_every_elementary_box(void **state) {
    (void)state;
    const sag_sampler_kind sobol[] = {SAG_SAMPLER_SOBOL, SAG_SAMPLER_PADDED_SOBOL, SAG_SAMPLER_ZSOBOL};
    for (int s = 0; s < 3; s++) {
        for (sag_randomization way = SAG_RANDOMIZATION_NONE; way <= SAG_RANDOMIZATION_OWEN; way++) {
            for (uint32_t k = 0; k <= 7; k++) {
                sagi_sampler_plan plan;
                sagi_sampler sampler = make_way(&plan, sobol[s], way, 1, 1u << k);
                for (uint32_t pixel = 0; pixel < 20; pixel++) {
                    sag_vec2 points[128], later[128];
                    uint32_t counts[128] = {0};
                    sagi_sampler_start_pixel(&sampler, 517 * pixel, 40000 - pixel);
                    for (uint32_t i = 0; i < 1u << k; i++) {
                        sagi_sampler_start_sample(&sampler, i);
                        points[i] = sagi_sampler_pixel(&sampler);
                        counts[(uint32_t)(sagi_sampler_1d(&sampler) * (1u << k))]++;
                        sampler.dimension = 100 + pixel;
                        later[i] = sagi_sampler_2d(&sampler);
                    }
                    assert_net(points, k);
                    assert_net(later, k);
                    for (uint32_t i = 0; i < 1u << k; i++) assert_int_equal(counts[i], 1);
                }
            }
        }
    }
}

// The second dimension is the one that pairs use; every one has a number in each interval of 2⁻ᵏ; and (what
// the starting numbers were chosen for) 2¹⁰ points lie evenly over the 8×8 boxes of any pair of the first
// five.
static void sobol_has_many_dimensions(void **state) {
    (void)state;
    uint32_t columns[SAGI_SOBOL_DIMENSIONS][SAGI_SOBOL_COLUMNS];
    sagi_sobol_columns(columns);
    for (uint32_t j = 0; j < 32; j++) assert_int_equal(columns[1][j], sagi_sobol_second_reversed(1u << j));
    sagi_sampler_plan plan;
    sagi_sampler sampler = make(&plan, SAG_SAMPLER_SOBOL, 8, 1024);
    static double numbers[SAGI_SOBOL_DIMENSIONS][1024];
    sagi_sampler_start_pixel(&sampler, 313, 1);
    for (uint32_t i = 0; i < 1024; i++) {
        sagi_sampler_start_sample(&sampler, i);
        for (uint32_t d = 0; d < SAGI_SOBOL_DIMENSIONS; d++) numbers[d][i] = sagi_sampler_1d(&sampler);
    }
    for (uint32_t d = 0; d < SAGI_SOBOL_DIMENSIONS; d++) {
        uint8_t counts[1024] = {0};
        for (uint32_t i = 0; i < 1024; i++) counts[(uint32_t)(numbers[d][i] * 1024)]++;
        for (uint32_t i = 0; i < 1024; i++) assert_int_equal(counts[i], 1);
    }
    for (uint32_t d = 0; d < 5; d++)
        for (uint32_t e = 0; e < d; e++) {
            uint32_t counts[64] = {0};
            for (uint32_t i = 0; i < 1024; i++)
                counts[(uint32_t)(numbers[d][i] * 8) * 8 + (uint32_t)(numbers[e][i] * 8)]++;
            for (uint32_t i = 0; i < 64; i++) assert_int_equal(counts[i], 16);
        }
}

// Samples come in an order whose first 4ᵏ are a net too, so that a render that is stopped is a good one of
// fewer samples; and 3 of every 4 samples are of no use as a count, but work.
static void first_samples_are_a_net_too(void **state) {
    (void)state;
    const sag_sampler_kind sobol[] = {SAG_SAMPLER_PADDED_SOBOL, SAG_SAMPLER_ZSOBOL};
    const uint32_t counts[] = {64, 96, 128, 1000};
    for (int s = 0; s < 2; s++) {
        for (int c = 0; c < 4; c++) {
            sagi_sampler_plan plan;
            sagi_sampler sampler = make(&plan, sobol[s], 5, counts[c]);
            // The digits of base 4 count from the pixel's: those of a sample's number are whole from the top.
            const uint32_t k = plan.sample_bits & 1 ? 5 : 6;
            for (uint32_t pixel = 0; pixel < 50; pixel++) {
                sag_vec2 points[64];
                sagi_sampler_start_pixel(&sampler, pixel, 77);
                for (uint32_t i = 0; i < 1u << k; i++) {
                    sagi_sampler_start_sample(&sampler, i);
                    points[i] = sagi_sampler_2d(&sampler);
                }
                assert_net(points, k);
            }
        }
    }
}

// What makes the noise blue: the samples of 2ᵏ×2ᵏ neighbours together are a net.
static void neighbours_share_a_net(void **state) {
    (void)state;
    sagi_sampler_plan plan;
    for (uint32_t k = 0; k <= 3; k++) {
        sagi_sampler sampler = make(&plan, SAG_SAMPLER_ZSOBOL, 9, 4);
        for (uint32_t block = 0; block < 30; block++) {
            sag_vec2 points[256], later[256];
            uint32_t n = 0;
            for (uint32_t y = 0; y < 1u << k; y++)
                for (uint32_t x = 0; x < 1u << k; x++)
                    for (uint32_t i = 0; i < 4; i++, n++) {
                        sagi_sampler_start_pixel(&sampler, (block << k) + x, (3 * block << k) + y);
                        sagi_sampler_start_sample(&sampler, i);
                        points[n] = sagi_sampler_2d(&sampler);
                        later[n] = sagi_sampler_2d(&sampler);
                    }
            assert_net(points, 2 * k + 2);
            assert_net(later, 2 * k + 2);
        }
    }
}

// The order in which four pixels, and one pixel's four samples, take the four quarters of a number: all 24
// come up about equally often, so that no direction is preferred.
static void all_orders_of_four_come_up(void **state) {
    (void)state;
    sagi_sampler_plan plan;
    uint32_t counts[2][256] = {{0}}, present[2][24];
    for (uint32_t seed = 0; seed < 200; seed++) {
        sagi_sampler sampler = make(&plan, SAG_SAMPLER_ZSOBOL, seed, 1);
        sagi_sampler_plan four;
        sagi_sampler samples = make(&four, SAG_SAMPLER_ZSOBOL, seed, 4);
        for (uint32_t block = 0; block < 120; block++) {
            uint32_t order = 0, inner = 0;
            for (uint32_t i = 0; i < 4; i++) {
                sagi_sampler_start_pixel(&sampler, 2 * block + (i & 1), 2 * (block % 7) + (i >> 1));
                sagi_sampler_start_sample(&sampler, 0);
                sampler.dimension = 3;
                order = order << 2 | (uint32_t)(4 * sagi_sampler_1d(&sampler));
                sagi_sampler_start_pixel(&samples, block, 11);
                sagi_sampler_start_sample(&samples, i);
                samples.dimension = 2;
                inner = inner << 2 | (uint32_t)(4 * sagi_sampler_1d(&samples));
            }
            counts[0][order]++, counts[1][inner]++;
        }
    }
    for (int j = 0; j < 2; j++) {
        uint32_t n = 0;
        for (uint32_t i = 0; i < 256; i++) {
            if (counts[j][i] == 0) continue;
            assert_true(n < 24);
            present[j][n++] = counts[j][i];
        }
        assert_int_equal(n, 24);
        for (uint32_t i = 0; i < 24; i++) assert_true(present[j][i] > 600 && present[j][i] < 1400);
    }
}

// Which cell of 2⁷ × 3⁵ a point of Halton's lies in decides whose it is: a pixel's film points, put back into
// its cell, are the sequence's own.
static void halton_points_come_down_in_their_pixels(void **state) {
    (void)state;
    sagi_sampler_plan plan;
    sagi_sampler sampler = make_way(&plan, SAG_SAMPLER_HALTON, SAG_RANDOMIZATION_NONE, 0, 16);
    for (uint32_t n = 0; n < 2000; n++) {
        double base2 = 0, base3 = 0, scale = 1;
        uint32_t rest = n;
        for (scale = 0.5; rest; rest /= 2, scale /= 2) base2 += (rest % 2) * scale;
        rest = n;
        for (scale = 1.0 / 3; rest; rest /= 3, scale /= 3) base3 += (rest % 3) * scale;
        const uint32_t x = (uint32_t)(base2 * 128), y = (uint32_t)(base3 * 243 + 1e-9);
        if (y >= 128) continue;
        sagi_sampler_start_pixel(&sampler, x, y);
        sagi_sampler_start_sample(&sampler, 0);
        assert_int_equal(sampler.index, n);
        const sag_vec2 within = sagi_sampler_pixel(&sampler);
        assert_true(fabs(within.x - (base2 * 128 - x)) < 1e-9);
        assert_true(fabs(within.y - (base3 * 243 - y)) < 1e-9);
        // The next dimension is base 5.
        double base5 = 0;
        rest = n;
        for (scale = 0.2; rest; rest /= 5, scale /= 5) base5 += (rest % 5) * scale;
        assert_true(fabs(sagi_sampler_1d(&sampler) - base5) < 1e-9);
    }
}

// 5ᵏ consecutive points have one number in each interval of 5⁻ᵏ, permuted or not.
static void halton_numbers_fill_every_interval(void **state) {
    (void)state;
    for (sag_randomization way = SAG_RANDOMIZATION_NONE; way <= SAG_RANDOMIZATION_OWEN; way++) {
        if (way == SAG_RANDOMIZATION_FAST_OWEN) continue;
        sagi_sampler_plan plan;
        sagi_sampler sampler = make_way(&plan, SAG_SAMPLER_HALTON, way, 4, 125);
        sagi_sampler_start_pixel(&sampler, 200, 300);
        uint32_t five[125] = {0}, seven[49] = {0};
        for (uint32_t i = 0; i < 125; i++) {
            sagi_sampler_start_sample(&sampler, i);
            const sag_vec2 p = sagi_sampler_2d(&sampler);
            five[(uint32_t)(p.x * 125 + 1e-7)]++;
            if (i < 49) seven[(uint32_t)(p.y * 49 + 1e-7)]++;
        }
        for (int i = 0; i < 125; i++) assert_int_equal(five[i], 1);
        for (int i = 0; i < 49; i++) assert_int_equal(seven[i], 1);
    }
}

static void strata_are_as_asked(void **state) {
    (void)state;
    sag_settings settings = {.sampler = SAG_SAMPLER_STRATIFIED,
                             .samples_per_pixel = 10,
                             .strata_x = 5,
                             .strata_y = 2,
                             .no_jitter = true};
    sagi_sampler_plan plan;
    assert_int_equal(sagi_sampler_plan_init(&plan, &settings, NULL), SAG_OK);
    sagi_sampler sampler = {.plan = &plan};
    sagi_sampler_start_pixel(&sampler, 1, 2);
    uint32_t counts[10] = {0};
    for (uint32_t i = 0; i < 10; i++) {
        sagi_sampler_start_sample(&sampler, i);
        const sag_vec2 p = sagi_sampler_2d(&sampler);
        const double x = p.x * 5 - 0.5, y = p.y * 2 - 0.5;
        assert_true(fabs(x - round(x)) < 1e-12 && fabs(y - round(y)) < 1e-12);
        counts[(int)(round(x) + 5 * round(y))]++;
    }
    for (int i = 0; i < 10; i++) assert_int_equal(counts[i], 1);
    settings.samples_per_pixel = 12; // they no longer fit
    assert_int_equal(sagi_sampler_plan_init(&plan, &settings, NULL), SAG_OK);
    assert_true(plan.x_count == 3 && plan.y_count == 4);
}

static void impossible_samplers_are_errors(void **state) {
    (void)state;
    sagi_sampler_plan plan;
    sag_settings settings = {.samples_per_pixel = 0};
    assert_int_equal(sagi_sampler_plan_init(&plan, &settings, NULL), SAG_ERROR_ARGUMENT);
    settings.samples_per_pixel = UINT32_MAX;
    assert_int_equal(sagi_sampler_plan_init(&plan, &settings, NULL), SAG_ERROR_ARGUMENT);
    settings.samples_per_pixel = UINT32_C(1) << 31;
    assert_int_equal(sagi_sampler_plan_init(&plan, &settings, NULL), SAG_OK);
    settings.sampler = SAG_SAMPLER_HALTON;
    settings.randomization = SAG_RANDOMIZATION_FAST_OWEN;
    assert_int_equal(sagi_sampler_plan_init(&plan, &settings, NULL), SAG_ERROR_ARGUMENT);
}

static void numbers_are_a_function_of_their_place(void **state) {
    (void)state;
    for (size_t k = 0; k < KINDS; k++) {
        sagi_sampler_plan plan;
        sagi_sampler a = make_way(&plan, kinds[k].kind, kinds[k].way, 42, 9), b = a;
        sagi_sampler_start_pixel(&b, 100, 200);
        sagi_sampler_start_sample(&b, 8);
        sagi_sampler_1d(&b);
        for (uint32_t i = 0; i < 9; i++) {
            sagi_sampler_start_pixel(&a, 3, 4);
            sagi_sampler_start_sample(&a, i);
            sagi_sampler_start_pixel(&b, 3, 4);
            sagi_sampler_start_sample(&b, i);
            assert_true(sagi_sampler_1d(&a) == sagi_sampler_1d(&b));
            assert_true(sagi_sampler_2d(&a).y == sagi_sampler_2d(&b).y);
        }
    }
}

static void permutations_are_bijections(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (uint32_t count = 1; count <= 200; count++) {
        bool seen[200] = {false};
        uint32_t seed = (uint32_t)rng_bits(&r);
        for (uint32_t i = 0; i < count; i++) {
            uint32_t j = sagi_permute(i, count, seed);
            assert_true(j < count && !seen[j]);
            seen[j] = true;
        }
    }
}

static void equal_area_map_is_its_own_inverse_and_keeps_areas(void **state) {
    (void)state;
    rng r = rng_make(2);
    uint32_t counts[8 * 16] = {0};
    for (int i = 0; i < 100000; i++) {
        sag_vec2 p = {rng_unit(&r), rng_unit(&r)};
        sag_vec3 d = sagi_equal_area_to_sphere(p);
        assert_true(fabs(sag_dot(d, d) - 1) < 1e-12);
        sag_vec2 q = sagi_equal_area_from_sphere(d);
        assert_true(fabs(q.x - p.x) < 1e-7 && fabs(q.y - p.y) < 1e-7);
        int z = (int)((d.z + 1) / 2 * 8), phi = (int)((atan2(d.y, d.x) / SAGI_RENDER_PI + 1) / 2 * 16);
        counts[(z > 7 ? 7 : z) * 16 + (phi > 15 ? 15 : phi)]++;
    }
    assert_true(fabs(chi_squared_excess(counts, 128)) < 5);
    sag_vec3 center = sagi_equal_area_to_sphere((sag_vec2){0.5, 0.5});
    assert_true(center.z == 1);
}

static void alias_table_has_its_weights(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    const double weights[] = {0, 3, 1, 0.25, 0, 7, 1e-3};
    double sum = 11.251;
    sagi_alias alias;
    assert_true(sagi_alias_init(&alias, context, weights, 7));
    // The exact share of each index: the widths of its pieces of the table.
    double share[7] = {0}, rest, last = -1;
    for (int i = 0; i < 7; i++) {
        double keep = fmin(alias.entries[i].keep, 1);
        share[i] += keep / 7;
        share[alias.entries[i].other] += (1 - keep) / 7;
    }
    for (int i = 0; i < 7; i++) {
        assert_true(fabs(share[i] - weights[i] / sum) < 1e-15);
        assert_true(fabs(alias.entries[i].probability - weights[i] / sum) < 1e-15);
    }
    for (double u = 0; u < 1; u += 0x1p-12) {
        uint32_t index = sagi_alias_sample(&alias, u, &rest);
        assert_true(index < 7 && weights[index] > 0 && rest >= 0 && rest < 1);
        last = u;
    }
    assert_true(last > 0.99);
    sagi_alias_clear(&alias, context);
    const double none[] = {0, 0};
    assert_true(sagi_alias_init(&alias, context, none, 2));
    assert_int_equal(alias.count, 0);
    sag_context_destroy(context);
}

static void four_numbers_at_once_are_as_one_by_one(void **state) {
    (void)state;
    rng r = rng_make(17);
    for (int i = 0; i < 10000; i++) {
        const sagi_u4 x = {rng_below(&r, UINT32_MAX), rng_below(&r, UINT32_MAX), (uint32_t)i, UINT32_MAX};
        const sagi_u4 seed = {(uint32_t)i, UINT32_MAX, rng_below(&r, UINT32_MAX), rng_below(&r, UINT32_MAX)};
        const sagi_u4 reversed = sagi_reverse_bits4(x), scrambled = sagi_scramble_reversed4(x, seed);
        for (int k = 0; k < 4; k++) {
            assert_int_equal(reversed[k], sagi_reverse_bits(x[k]));
            assert_int_equal(scrambled[k], sagi_scramble_reversed(x[k], seed[k]));
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_uniform),
        cmocka_unit_test(four_numbers_at_once_are_as_one_by_one),
        cmocka_unit_test(dimensions_of_one_pixel_are_unrelated),
        cmocka_unit_test(strata_have_one_sample_each),
        cmocka_unit_test(strata_are_as_asked),
        cmocka_unit_test(sobol_points_fill_every_elementary_box),
        cmocka_unit_test(sobol_has_many_dimensions),
        cmocka_unit_test(first_samples_are_a_net_too),
        cmocka_unit_test(neighbours_share_a_net),
        cmocka_unit_test(all_orders_of_four_come_up),
        cmocka_unit_test(halton_points_come_down_in_their_pixels),
        cmocka_unit_test(halton_numbers_fill_every_interval),
        cmocka_unit_test(impossible_samplers_are_errors),
        cmocka_unit_test(numbers_are_a_function_of_their_place),
        cmocka_unit_test(permutations_are_bijections),
        cmocka_unit_test(equal_area_map_is_its_own_inverse_and_keeps_areas),
        cmocka_unit_test(alias_table_has_its_weights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
