// SPDX-License-Identifier: MIT
// Spectra: colours come back from the spectra that stand for them, white is white, lamps and metals have the
// colours they are known for, wavelengths are drawn with their density.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/job.h"
#include "support/picture.h"
#include "support/random.h"

#include <string.h>

static double worst_of(sag_rgb a, sag_rgb b) {
    return fmax(fabs(a.r - b.r), fmax(fabs(a.g - b.g), fabs(a.b - b.b)));
}

// How far colours come back from where they were, at most and on the mean, and the mean shift of their
// components.
static void expect_round_trip(int space, double low, double high, bool exactly, double most, double mean,
                              double shift) {
    rng r = rng_make(3);
    const int count = exactly ? 300 : 2000;
    double worst = 0, sum = 0, moved = 0;
    for (int i = 0; i < count; i++) {
        const sag_rgb wanted =
            sagi_rgb(rng_uniform(&r, low, high), rng_uniform(&r, low, high), rng_uniform(&r, low, high));
        const sagi_color color = (exactly ? sagi_color_of_rgb : sagi_color_of_texel)((sag_color_space)space,
                                                                                     wanted, SAGI_RGB_ALBEDO);
        const sag_rgb got = sagi_color_to_rgb(&color, (sag_color_space)space, false);
        const double off = worst_of(wanted, got);
        worst = fmax(worst, off);
        sum += off / count;
        moved += (sagi_rgb_mean(got) - sagi_rgb_mean(wanted)) / count;
    }
    if (!(worst < most && sum < mean && fabs(moved) < shift))
        print_message("space %d, %g to %g: at most %g, mean %g, shift %g\n", space, low, high, worst, sum,
                      moved);
    assert_true(worst < most && sum < mean && fabs(moved) < shift);
}

static void colors_come_back(void **state) {
    (void)state;
    // Solved for: to the accuracy of float. In the widest space not all colours are some reflectance's.
    for (int space = SAG_COLOR_SRGB; space <= SAG_COLOR_REC2020; space++)
        expect_round_trip(space, 0.1, 0.6, true, 2e-5, 5e-6, 2e-6);
    expect_round_trip(SAG_COLOR_SRGB, 0.02, 0.98, true, 2e-5, 5e-6, 2e-6);
    expect_round_trip(SAG_COLOR_ACES2065_1, 0.3, 0.5, true, 2e-5, 5e-6, 2e-6);
    // From the table.
    expect_round_trip(SAG_COLOR_SRGB, 0.05, 0.65, false, 0.005, 0.0007, 0.0002);
    expect_round_trip(SAG_COLOR_SRGB, 0, 1, false, 0.03, 0.0015, 0.0003);
    expect_round_trip(SAG_COLOR_DCI_P3, 0.05, 0.65, false, 0.005, 0.0007, 0.0002);
    expect_round_trip(SAG_COLOR_REC2020, 0.1, 0.6, false, 0.005, 0.0007, 0.0002);
    expect_round_trip(SAG_COLOR_ACES2065_1, 0.3, 0.5, false, 0.005, 0.0007, 0.0002);
}

static void amounts_and_lights_come_back(void **state) {
    (void)state;
    rng r = rng_make(4);
    for (int i = 0; i < 300; i++) {
        const double scale = exp(rng_uniform(&r, -12, 12));
        const sag_rgb wanted = sagi_rgb(scale * rng_unit(&r), scale * rng_unit(&r), scale * rng_unit(&r));
        const sagi_color light = sagi_color_of_rgb(SAG_COLOR_SRGB, wanted, SAGI_RGB_ILLUMINANT);
        const sagi_color amount = sagi_color_of_rgb(SAG_COLOR_SRGB, wanted, SAGI_RGB_UNBOUNDED);
        assert_true(worst_of(sagi_color_to_rgb(&light, SAG_COLOR_SRGB, true), wanted) < 1e-4 * scale);
        assert_true(worst_of(sagi_color_to_rgb(&amount, SAG_COLOR_SRGB, false), wanted) < 1e-4 * scale);
    }
    // Grey is the same at all wavelengths, to the bit; negative parts are cut off; what is no number stays
    // none.
    for (double g = 0; g <= 4; g += 0.25) {
        const sagi_color grey = sagi_color_of_texel(SAG_COLOR_REC2020, sagi_rgb_grey(g), SAGI_RGB_UNBOUNDED);
        for (double w = 360; w <= 830; w++)
            assert_true(sagi_color_at(&grey, sagi_spectrum_all(w))[2] == (float)g);
    }
    const sagi_color cut = sagi_color_of_rgb(SAG_COLOR_SRGB, sagi_rgb(-3, 0.5, 0.2), SAGI_RGB_ALBEDO);
    assert_true(worst_of(sagi_color_to_rgb(&cut, SAG_COLOR_SRGB, false), sagi_rgb(0, 0.5, 0.2)) < 1e-2);
    const sagi_color none = sagi_color_of_texel(SAG_COLOR_SRGB, sagi_rgb(1, NAN, 0), SAGI_RGB_ILLUMINANT);
    assert_true(isnan(sagi_color_at(&none, sagi_spectrum_all(500))[0]));
    // Reflectances stay within [0, 1].
    for (int i = 0; i < 2000; i++) {
        const sag_rgb any = sagi_rgb(rng_unit(&r) < 0.3, rng_unit(&r), rng_unit(&r) < 0.5 ? rng_unit(&r) : 1);
        const sagi_color color = sagi_color_of_texel((sag_color_space)(i % 4), any, SAGI_RGB_ALBEDO);
        for (double w = 360; w <= 830; w += 10) {
            const float value = sagi_color_at(&color, sagi_spectrum_all(w))[0];
            assert_true(value >= 0 && value <= 1);
        }
    }
}

// What a sensor makes of a spectrum, in RGB of the film, without noise.
static sag_rgb seen_by(const sagi_sensor *sensor, const float *light) {
    double sum[3] = {0, 0, 0}, rgb[3];
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++)
        for (int k = 0; k < 3; k++) sum[k] += (double)light[i] * (double)sensor->response[i][k];
    sagi_matrix_apply(sensor->output, sum, rgb);
    return sagi_rgb(rgb[0], rgb[1], rgb[2]);
}

static void white_is_white(void **state) {
    (void)state;
    static sagi_sensor sensor;
    for (int space = 0; space < SAGI_COLOR_SPACE_COUNT; space++) {
        const sag_film film = {.color_space = (sag_color_space)space};
        assert_int_equal(sagi_sensor_init(&sensor, &film, NULL), SAG_OK);
        const sag_rgb white = seen_by(&sensor, sagi_color_spaces[space].illuminant);
        assert_true(worst_of(white, sagi_rgb_grey(1)) < 1e-6);
    }
    // Daylight of a temperature, balanced for; twice the ISO is twice as bright, a third of the time a third.
    float daylight[SAGI_WAVELENGTH_COUNT];
    for (double kelvin = 3000; kelvin <= 12000; kelvin += 3000) {
        sag_film film = {.white_balance_kelvin = kelvin, .iso = 200, .exposure_seconds = 1.0 / 3};
        assert_int_equal(sagi_sensor_init(&sensor, &film, NULL), SAG_OK);
        sagi_daylight_table(kelvin, daylight);
        sagi_color light = {.scale = 1, .table = daylight};
        const sag_rgb white = seen_by(&sensor, daylight);
        const double luminance = sagi_color_luminance(&light);
        assert_true(worst_of(white, sagi_rgb_grey(luminance * 2 / 3)) < 1e-6 * luminance);
    }
    // Cameras: as near as 24 patches let it be, in the light they are balanced for.
    for (int i = 0; i < SAGI_CAMERA_COUNT; i++) {
        sag_film film = {.color_space = SAG_COLOR_SRGB};
        strcpy(film.sensor, sagi_cameras[i].name);
        assert_true(sag_sensor_is_known(film.sensor));
        assert_int_equal(sagi_sensor_init(&sensor, &film, NULL), SAG_OK);
        sagi_daylight_table(6500, daylight);
        sagi_color light = {.scale = 1, .table = daylight};
        const double luminance = sagi_color_luminance(&light);
        for (int k = 0; k < SAGI_WAVELENGTH_COUNT; k++)
            daylight[k] = (float)((double)daylight[k] / luminance);
        const sag_rgb white = seen_by(&sensor, daylight);
        if (!(worst_of(white, sagi_rgb_grey(1)) < 0.03))
            print_message("%s: %g %g %g\n", film.sensor, white.r, white.g, white.b);
        assert_true(worst_of(white, sagi_rgb_grey(1)) < 0.03);
    }
    const sag_film bad[] = {{.sensor = "eye"},
                            {.iso = -1},
                            {.exposure_seconds = NAN},
                            {.white_balance_kelvin = -5},
                            {.color_space = (sag_color_space)9}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(sagi_sensor_init(&sensor, &bad[i], NULL), SAG_ERROR_ARGUMENT);
}

static void lamps_have_their_colors(void **state) {
    (void)state;
    // Chromaticities: CIE 015:2018, tables 5, 10 and T.3 (D50 is not the CIE's but pbrt-v4's, see
    // lamp_data.c); black bodies: Wyszecki & Stiles 1982, table 1(3.11).
    static const struct {
        const char *name;
        double kelvin, x, y;
    } lamps[] = {{"stdillum-A", 0, 0.44758, 0.40745},    {"stdillum-D50", 0, 0.33681, 0.35798},
                 {"stdillum-D65", 0, 0.31272, 0.32903},  {"stdillum-F2", 0, 0.37208, 0.37529},
                 {"stdillum-F7", 0, 0.31292, 0.32933},   {"stdillum-F11", 0, 0.38052, 0.37713},
                 {"illum-acesD60", 0, 0.32168, 0.33767}, {NULL, 2856, 0.4475, 0.4075},
                 {NULL, 5000, 0.3451, 0.3516},           {NULL, 6500, 0.3135, 0.3237}};
    studio s = studio_open(1);
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++) {
        sag_spectrum_id id;
        const sag_spectrum lamp = {.kind = lamps[i].name ? SAG_SPECTRUM_NAMED : SAG_SPECTRUM_BLACKBODY,
                                   .name = lamps[i].name,
                                   .value = lamps[i].kelvin,
                                   .normalize = true,
                                   .scale = 3};
        assert_int_equal(sag_world_add_spectrum(s.world, &lamp, &id), SAG_OK);
        assert_true(fabs(sag_world_spectrum_luminance(s.world, id) - 3) < 1e-6);
        const sag_rgb c = sag_world_spectrum_color(s.world, id, true);
        const double rgb[3] = {c.r, c.g, c.b};
        double xyz[3];
        sagi_matrix_apply(sagi_color_spaces[SAG_COLOR_SRGB].to_xyz, rgb, xyz);
        const double x = xyz[0] / (xyz[0] + xyz[1] + xyz[2]), y = xyz[1] / (xyz[0] + xyz[1] + xyz[2]);
        if (!(fabs(x - lamps[i].x) < 3e-4 && fabs(y - lamps[i].y) < 3e-4))
            print_message("lamp %zu: %.5f %.5f\n", i, x, y);
        assert_true(fabs(x - lamps[i].x) < 3e-4 && fabs(y - lamps[i].y) < 3e-4);
    }
    // Wien: the peak of 5000 K is at 579.6 nm.
    sag_spectrum_id id;
    const sag_spectrum body = {.kind = SAG_SPECTRUM_BLACKBODY, .value = 5000};
    assert_int_equal(sag_world_add_spectrum(s.world, &body, &id), SAG_OK);
    assert_true(fabs(sag_world_spectrum_value(s.world, id, 579.6) - 1) < 1e-5);
    assert_true(sag_world_spectrum_value(s.world, id, 400) < 0.75);
    studio_close(&s);
}

static void metals_have_their_colors(void **state) {
    (void)state;
    // Linear sRGB at normal incidence, as often tabled from the same measurements (Hoffman, SIGGRAPH course
    // 2010).
    static const struct {
        const char *eta, *k;
        sag_rgb rgb;
    } metals[] = {{"metal-Au-eta", "metal-Au-k", {1.02, 0.77, 0.34}},
                  {"metal-Cu-eta", "metal-Cu-k", {0.955, 0.638, 0.538}},
                  {"metal-Ag-eta", "metal-Ag-k", {0.972, 0.960, 0.915}},
                  {"metal-Al-eta", "metal-Al-k", {0.913, 0.922, 0.924}}};
    studio s = studio_open(1);
    for (size_t i = 0; i < 4; i++) {
        sag_material metal = {.kind = SAG_MATERIAL_CONDUCTOR};
        sag_world_add_spectrum(s.world, &(sag_spectrum){.kind = SAG_SPECTRUM_NAMED, .name = metals[i].eta},
                               &metal.eta.spectrum);
        sag_world_add_spectrum(s.world, &(sag_spectrum){.kind = SAG_SPECTRUM_NAMED, .name = metals[i].k},
                               &metal.k.spectrum);
        assert_true(metal.eta.spectrum && metal.k.spectrum);
        const sagi_appearance look = {.look.material = studio_material(&s, metal)};
        const sag_surface surface = {.geometric_normal = {0, 0, 1}, .shading_normal = {0, 0, 1}};
        const sag_rgb got = sagi_material_albedo(s.world, &look, &surface, NULL);
        if (!(worst_of(got, metals[i].rgb) < 0.05))
            print_message("%s: %g %g %g\n", metals[i].eta, got.r, got.g, got.b);
        assert_true(worst_of(got, metals[i].rgb) < 0.05);
    }
    // Crown glass: n(F), n(d), n(C) of Schott's data sheet.
    sag_spectrum_id id;
    assert_int_equal(sag_world_add_spectrum(
                         s.world, &(sag_spectrum){.kind = SAG_SPECTRUM_NAMED, .name = "glass-BK7"}, &id),
                     SAG_OK);
    assert_true(fabs(sag_world_spectrum_value(s.world, id, 486) - 1.52238) < 1e-4);
    assert_true(fabs(sag_world_spectrum_value(s.world, id, 588) - 1.5168) < 1e-4);
    assert_true(fabs(sag_world_spectrum_value(s.world, id, 656) - 1.51432) < 1e-4);
    studio_close(&s);
}

static void wavelengths_follow_their_density(void **state) {
    (void)state;
    enum { CELLS = 47, COUNT = 200000 };
    static sagi_wavelength_table table;
    sagi_wavelength_table_init(&table);
    rng r = rng_make(6);
    double counts[CELLS] = {0}, sum = 0, chi = 0;
    for (int i = 0; i < COUNT; i++) {
        const sagi_wavelengths w = sagi_wavelengths_sample(&table, rng_unit(&r));
        for (int k = 0; k < 4; k++) {
            assert_true(w.lambda[k] >= 360 && w.lambda[k] <= 830 && w.weight[k] > 0);
            const int cell = (int)((w.lambda[k] - 360) / 10);
            counts[cell < CELLS ? cell : CELLS - 1] += 0.25; // the four are not independent
            sum += (double)w.weight[k];
            // The density is the one it is taken from, but for the steps' width.
            const double pdf = 0.0039398042 / sagi_square(cosh(0.0072 * ((double)w.lambda[k] - 538)));
            if (w.lambda[k] > 400 && w.lambda[k] < 760)
                assert_true(fabs((double)w.weight[k] * 4 * pdf - 1) < 0.02);
        }
    }
    for (int i = 0; i < CELLS; i++) {
        const double a = tanh(0.0072 * (360 + 10 * i - 538)), b = tanh(0.0072 * (370 + 10 * i - 538));
        const double expected = COUNT * (b - a) * 0.0039398042 / 0.0072;
        chi += (counts[i] - expected) * (counts[i] - expected) / expected;
    }
    assert_true(chi < CELLS + 6 * sqrt(2.0 * CELLS));
    assert_true(fabs(sum / COUNT - 470) < 1); // ∫ dλ
    // Each one's part of [0, 1) again, and nothing outside.
    const sagi_wavelengths first = sagi_wavelengths_sample(&table, 0),
                           last = sagi_wavelengths_sample(&table, SAGI_ONE_MINUS);
    assert_true(first.lambda[0] == 360 && fabsf(last.lambda[3] - first.lambda[3]) < 1);
}

// A coloured floor under a white sky shows its colour; a coloured light on a white floor its own.
static void pictures_have_the_colors_asked_for(void **state) {
    (void)state;
    static const sag_rgb colors[] = {{0.8, 0.2, 0.1}, {0.1, 0.6, 0.3}, {0.2, 0.3, 0.9}, {0.5, 0.5, 0.5}};
    for (int i = 0; i < 8; i++) {
        studio s = studio_open(0);
        s.in_color = true;
        s.settings->sampler = SAG_SAMPLER_SOBOL;
        s.settings->samples_per_pixel = 64;
        s.settings->film.width = s.settings->film.height = 16;
        const sag_rgb color = colors[i / 2], white = {1, 1, 1};
        const bool on_floor = i % 2 == 0;
        const uint32_t floor_id =
            sag_add_plane(s.scene, &(sag_plane){.point = {0, 0, -1}, .normal = {0, 0, 1}});
        const uint32_t paint =
            studio_material(&s, (sag_material){.reflectance.value = on_floor ? color : white});
        sag_world_set_appearance(s.world, s.scene, floor_id, &(sag_appearance){.material = paint});
        sag_world_add_light(s.world,
                            &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = on_floor ? white : color});
        sag_image image = studio_render(&s, NULL);
        double sum[3] = {0, 0, 0};
        for (size_t p = 0; p < 16 * 16; p++)
            for (size_t k = 0; k < 3; k++) sum[k] += (double)image.pixels[3 * p + k] / (16 * 16);
        const sag_rgb got = sagi_rgb(sum[0], sum[1], sum[2]);
        if (!(worst_of(got, color) < 0.005)) print_message("%d: %g %g %g\n", i, got.r, got.g, got.b);
        assert_true(worst_of(got, color) < 0.005);
        sag_image_clear(s.context, &image);
        studio_close(&s);
    }
}

// Glass that disperses sends no light astray: all of it is there, in all colours.
static void dispersion_keeps_white_light(void **state) {
    (void)state;
    studio s = studio_open(0);
    s.in_color = true;
    s.settings->sampler = SAG_SAMPLER_SOBOL;
    s.settings->samples_per_pixel = 64;
    s.settings->film.width = s.settings->film.height = 16;
    sag_material glass = {.kind = SAG_MATERIAL_DIELECTRIC};
    sag_world_add_spectrum(s.world, &(sag_spectrum){.kind = SAG_SPECTRUM_NAMED, .name = "glass-F11"},
                           &glass.eta.spectrum);
    const uint32_t ball = sag_add_sphere(s.scene, &(sag_sphere){.radius = 3});
    sag_world_set_appearance(s.world, s.scene, ball,
                             &(sag_appearance){.material = studio_material(&s, glass)});
    sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
    sag_image image = studio_render(&s, NULL);
    double sum[3] = {0, 0, 0};
    for (size_t p = 0; p < 16 * 16; p++)
        for (size_t k = 0; k < 3; k++) sum[k] += (double)image.pixels[3 * p + k] / (16 * 16);
    const sag_rgb got = sagi_rgb(sum[0], sum[1], sum[2]);
    if (!(worst_of(got, sagi_rgb_grey(1)) < 0.01)) print_message("%g %g %g\n", got.r, got.g, got.b);
    assert_true(worst_of(got, sagi_rgb_grey(1)) < 0.01);
    sag_image_clear(s.context, &image);
    studio_close(&s);
}

static void impossible_spectra_are_errors(void **state) {
    (void)state;
    const double falling[] = {500, 1, 400, 1}, infinite[] = {400, 1, 500, INFINITY},
                 fine[] = {450, 1, 550, 3};
    const sag_spectrum bad[] = {{.kind = SAG_SPECTRUM_NAMED, .name = "metal-X"},
                                {.kind = SAG_SPECTRUM_NAMED},
                                {.kind = SAG_SPECTRUM_BLACKBODY},
                                {.kind = SAG_SPECTRUM_BLACKBODY, .value = NAN},
                                {.kind = SAG_SPECTRUM_SAMPLED},
                                {.kind = SAG_SPECTRUM_SAMPLED, .pairs = falling, .pair_count = 2},
                                {.kind = SAG_SPECTRUM_SAMPLED, .pairs = infinite, .pair_count = 2},
                                {.kind = SAG_SPECTRUM_CONSTANT, .value = INFINITY},
                                {.kind = SAG_SPECTRUM_ALBEDO, .rgb = {NAN, 0, 0}},
                                {.kind = SAG_SPECTRUM_ALBEDO, .space = (sag_color_space)7},
                                {.kind = (sag_spectrum_kind)77}};
    studio s = studio_open(1);
    sag_spectrum_id id;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(sag_world_add_spectrum(s.world, &bad[i], &id), SAG_ERROR_ARGUMENT);
        assert_int_equal(id, 0);
    }
    sag_spectrum line = {.kind = SAG_SPECTRUM_SAMPLED, .pairs = fine, .pair_count = 2};
    assert_int_equal(sag_world_add_spectrum(s.world, &line, &id), SAG_OK);
    assert_true(sag_world_spectrum_value(s.world, id, 500) == 2 &&
                sag_world_spectrum_value(s.world, id, 449) == 0);
    assert_true(sag_world_spectrum_value(s.world, id, 550) == 3 &&
                sag_world_spectrum_value(s.world, id, 551) == 0);
    line.extend = true;
    assert_int_equal(sag_world_add_spectrum(s.world, &line, &id), SAG_OK);
    assert_true(sag_world_spectrum_value(s.world, id, 361) == 1 &&
                sag_world_spectrum_value(s.world, id, 830) == 3);
    assert_true(sag_world_spectrum_value(s.world, id, 831) == 0 &&
                sag_world_spectrum_value(s.world, 99, 500) == 0);
    // Inputs that name one that is not there.
    assert_int_equal(sag_world_add_material(s.world, &(sag_material){.reflectance.spectrum = 99}), 0);
    assert_int_equal(sag_world_add_light(s.world, &(sag_light){.spectrum = 99}), 0);
    studio_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colors_come_back),
        cmocka_unit_test(amounts_and_lights_come_back),
        cmocka_unit_test(white_is_white),
        cmocka_unit_test(lamps_have_their_colors),
        cmocka_unit_test(metals_have_their_colors),
        cmocka_unit_test(wavelengths_follow_their_density),
        cmocka_unit_test(pictures_have_the_colors_asked_for),
        cmocka_unit_test(dispersion_keeps_white_light),
        cmocka_unit_test(impossible_spectra_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
