// SPDX-License-Identifier: MIT
// What a pbrt scene says by wavelength: lights at luminance 1 times their scale, colour spaces, files, names.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <math.h>
#include <cmocka.h>
// clang-format on
#include "render/world.h"
#include "support/scene_text.h"

#define W "WorldBegin\n"

static const sag_light *light_of(const sag_world *world, size_t i) {
    assert_true(i < world->lights.count);
    return (const sag_light *)world->lights.items + i;
}
static const sag_material *material_of(const sag_world *world, size_t i) {
    assert_true(i < world->materials.count);
    return &((const sagi_material *)world->materials.items)[i].material;
}

static void lights_by_wavelength(void **state) {
    (void)state;
    sag_world *world = scene_load_good(
        W "LightSource \"point\" \"blackbody I\" 3000 \"float scale\" 5\n"
          "LightSource \"distant\" \"spectrum L\" \"stdillum-F2\" \"float illuminance\" 7\n"
          "LightSource \"infinite\" \"spectrum L\" [400 2 500 6 600 4] \"float scale\" 3\n"
          "LightSource \"point\" \"rgb I\" [1 2 3] \"float power\" 12.566370614359172 \"float scale\" 2\n"
          "LightSource \"point\"\n"
          "AreaLightSource \"diffuse\" \"blackbody L\" 6500 \"float scale\" 4 Shape \"sphere\"\n");
    assert_int_equal(scene_warning_count, 0);
    // What the spectrum leaves to the colour is the amount.
    static const double amounts[] = {5, 7, 3};
    for (size_t i = 0; i < 3; i++) {
        assert_true(fabs(sag_world_spectrum_luminance(world, light_of(world, i)->spectrum) - 1) < 1e-6);
        assert_true(fabs(light_of(world, i)->color.r / amounts[i] - 1) < 1e-6);
    }
    // Of an rgb only its white counts for the power, as in pbrt: 4π over 4π.
    assert_int_equal(light_of(world, 3)->spectrum, 0);
    assert_true(fabs(light_of(world, 3)->color.b - 6) < 1e-6);
    assert_true(light_of(world, 4)->spectrum == 0 && light_of(world, 4)->color.g == 1);
    const sagi_appearance *look = world->appearances.items;
    assert_true(fabs(sagi_color_luminance(&look->emission) - 4) < 1e-5);
    sag_world_destroy(world);
}

static void colors_in_their_spaces(void **state) {
    (void)state;
    // One colour, said in four spaces (white D65 but for ACES's), and the film's.
    sag_world *world =
        scene_load_good("ColorSpace \"rec2020\" Film \"rgb\" \"string sensor\" \"nikon_d850\" "
                        "\"float iso\" 400 \"float whitebalance\" 5000 ColorSpace \"srgb\"\n"
                        "Camera \"perspective\" \"float shutteropen\" 1 \"float shutterclose\" 1.5\n" W
                        "Material \"diffuse\" \"rgb reflectance\" [.6 .2 .3]\n"
                        "AttributeBegin ColorSpace \"rec2020\"\n"
                        "Material \"diffuse\" \"rgb reflectance\" [.45529 .22878 .29612]\n"
                        "LightSource \"point\" \"rgb I\" [1 1 1] AttributeEnd\n"
                        "Material \"diffuse\" \"rgb reflectance\" [.6 .2 .3]\n"
                        "ColorSpace \"aces2065-1\" LightSource \"point\"");
    assert_int_equal(scene_warning_count, 0);
    const sag_film *film = &sag_world_settings(world)->film;
    assert_int_equal(film->color_space, SAG_COLOR_REC2020);
    assert_string_equal(film->sensor, "nikon_d850");
    assert_true(film->iso == 400 && film->white_balance_kelvin == 5000 && film->exposure_seconds == 0.5);
    assert_int_equal(material_of(world, 0)->reflectance.spectrum, 0);
    const sag_rgb same = sag_world_spectrum_color(world, material_of(world, 1)->reflectance.spectrum, false);
    if (!(fabs(same.r - 0.6) < 2e-3 && fabs(same.g - 0.2) < 2e-3 && fabs(same.b - 0.3) < 2e-3))
        print_message("%g %g %g\n", same.r, same.g, same.b);
    assert_true(fabs(same.r - 0.6) < 2e-3 && fabs(same.g - 0.2) < 2e-3 && fabs(same.b - 0.3) < 2e-3);
    assert_int_equal(material_of(world, 2)->reflectance.spectrum, 0); // AttributeEnd
    const sag_rgb white = sag_world_spectrum_color(world, light_of(world, 0)->spectrum, true);
    assert_true(fabs(white.r - 1) < 1e-6 && fabs(white.b - 1) < 1e-6);
    const sag_rgb warm = sag_world_spectrum_color(world, light_of(world, 1)->spectrum, true);
    assert_true(warm.r > warm.b + 0.1); // D60 is warmer than D65
    sag_world_destroy(world);
}

static void spectra_of_all_kinds(void **state) {
    (void)state;
    sag_world *world =
        scene_load_good(W "Material \"diffuse\" \"spectrum reflectance\" [300 .25 900 .25]\n"
                          "Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"\n"
                          "Material \"dielectric\" \"float eta\" 1.7\n"
                          "Material \"conductor\"\n"
                          "Material \"conductor\" \"rgb eta\" [.2 .9 1.1] \"rgb k\" [3.9 2.4 2.2]\n"
                          "Material \"conductor\" \"rgb reflectance\" [.9 .5 .2]\n");
    assert_int_equal(scene_warning_count, 0);
    const sag_rgb grey = sag_world_spectrum_color(world, material_of(world, 0)->reflectance.spectrum, false);
    assert_true(fabs(grey.r - 0.25) < 1e-6 && fabs(grey.g - 0.25) < 1e-6 && fabs(grey.b - 0.25) < 1e-6);
    assert_true(fabs(sag_world_spectrum_value(world, material_of(world, 1)->eta.spectrum, 588) - 1.5168) <
                1e-4);
    const sagi_material *all = world->materials.items;
    assert_true(all[1].eta.varies && !all[2].eta.varies && all[2].eta.scale == 1.7F);
    assert_true(material_of(world, 3)->eta.spectrum && material_of(world, 3)->k.spectrum); // copper
    assert_true(all[3].mirror.r > 0.9 && all[3].mirror.b < 0.6);
    assert_true(all[4].eta.varies && !material_of(world, 4)->eta.spectrum);
    assert_true(material_of(world, 5)->reflectance.value.r == 0.9 && !material_of(world, 5)->eta.spectrum);
    sag_world_destroy(world);
}

// While a scene is read its materials' colours are near; before a render all of them are exact, also those of
// many materials, which threads share.
static void colors_of_many_materials_are_exact(void **state) {
    (void)state;
    static char text[120000];
    size_t at = (size_t)snprintf(text, sizeof text,
                                 "Film \"rgb\" \"integer xresolution\" 2 \"integer yresolution\" 2 " W);
    for (int i = 0; i < 700; i++)
        at += (size_t)snprintf(text + at, sizeof text - at,
                               "Material \"diffuse\" \"rgb reflectance\" [%g %g %g]\n", i % 10 * 0.1,
                               i / 10 % 10 * 0.1, i / 100 * 0.1);
    snprintf(text + at, sizeof text - at,
             "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.1 .5 .9] Shape \"sphere\"");
    sag_world *world = scene_load_good(text);
    sag_render *render = sag_render_create(world, NULL);
    assert_non_null(render);
    for (size_t i = 0; i < 700; i++) {
        const sagi_material *m = (const sagi_material *)world->materials.items + i;
        const sagi_color exact =
            sagi_color_of_rgb(SAG_COLOR_SRGB, m->material.reflectance.value, SAGI_RGB_ALBEDO);
        assert_true(!m->reflectance.near && m->reflectance.curved == exact.curved);
        assert_memory_equal(m->reflectance.c, exact.c, sizeof exact.c);
        const sag_rgb back = sagi_color_to_rgb(&exact, SAG_COLOR_SRGB, false),
                      is = m->material.reflectance.value;
        const bool has_one = fmin(is.r, fmin(is.g, is.b)) >= 0.05; // others may be too pure for a reflectance
        assert_true(!has_one ||
                    (fabs(back.r - is.r) < 1e-5 && fabs(back.g - is.g) < 1e-5 && fabs(back.b - is.b) < 1e-5));
    }
    const sagi_texture *texture = world->textures.items;
    const sagi_color exact = sagi_color_of_rgb(SAG_COLOR_SRGB, (sag_rgb){.1, .5, .9}, SAGI_RGB_UNBOUNDED);
    assert_true(!texture->colors[0][0].near && !texture->colors[1][0].near);
    assert_memory_equal(texture->colors[1][0].c, exact.c, sizeof exact.c);
    sag_render_destroy(render);
    sag_world_destroy(world);
}

static void files_and_faults(void **state) {
    (void)state;
    const char good[] = "# a lamp\n400 1\n500 3 600 2\n";
    scene_write("lamp.spd", good, sizeof good - 1);
    sag_world *world = scene_load_good(W "LightSource \"point\" \"spectrum I\" \"lamp.spd\"\n"
                                         "Material \"diffuse\" \"spectrum reflectance\" \"lamp.spd\"");
    assert_true(
        fabs(sag_world_spectrum_value(world, material_of(world, 0)->reflectance.spectrum, 550) - 2.5) < 1e-6);
    assert_true(fabs(sag_world_spectrum_luminance(world, light_of(world, 0)->spectrum) - 1) < 1e-6);
    sag_world_destroy(world);
    const char falling[] = "500 1 400 2", odd[] = "400 1 500", word[] = "400 one";
    scene_write("falling.spd", falling, sizeof falling - 1);
    scene_write("odd.spd", odd, sizeof odd - 1);
    scene_write("word.spd", word, sizeof word - 1);
    sag_error error;
    static const char *const names[] = {"falling.spd", "odd.spd", "word.spd", "none.spd", "metal-X"};
    for (size_t i = 0; i < 5; i++) {
        char text[200];
        snprintf(text, sizeof text, W "Material \"diffuse\" \"spectrum reflectance\" \"%s\"", names[i]);
        assert_int_not_equal(scene_load(text, &world, &error), SAG_OK);
        sag_world_destroy(world);
    }
    scene_fails(W "Material \"diffuse\" \"spectrum reflectance\" [500 1 400 1]", 2, 20, "rising");
    scene_fails(W "LightSource \"point\" \"blackbody I\" -5", 2, 21, "-5 K");
    scene_fails("ColorSpace \"cmyk\"", 1, 1, "cmyk");
    scene_fails("Film \"rgb\" \"string sensor\" \"eye\"", 1, 12, "eye");
    scene_fails("Camera \"perspective\" \"float shutterclose\" 0", 1, 1, "shutter");
    scene_fails_without_memory(W "LightSource \"point\" \"spectrum I\" \"lamp.spd\"\n"
                                 "LightSource \"distant\" \"blackbody L\" 4000 Material \"conductor\"\n"
                                 "ColorSpace \"rec2020\" LightSource \"infinite\"");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lights_by_wavelength), cmocka_unit_test(colors_in_their_spaces),
        cmocka_unit_test(spectra_of_all_kinds), cmocka_unit_test(colors_of_many_materials_are_exact),
        cmocka_unit_test(files_and_faults),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
