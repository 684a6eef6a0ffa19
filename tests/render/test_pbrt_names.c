// SPDX-License-Identifier: MIT
// Names that are used before what they stand for is defined, as pbrt-v4 allows: the same picture, to the bit,
// as in the other order; an error at the first use of what never comes.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "support/picture.h"
#include "support/scene_text.h"

#include <stdio.h>
#include <string.h>

#define HEAD                                                                                                 \
    "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 40\n"                                  \
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24 Sampler \"independent\" "            \
    "\"integer pixelsamples\" 8\nWorldBegin LightSource \"infinite\" LightSource \"distant\"\n"

static sag_image picture_of(const char *text) {
    sag_world *world = scene_load_good(text);
    sag_error error;
    sag_render *render = sag_render_create(world, &error);
    assert_non_null(render);
    sag_image image;
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_int_equal(sag_render_get_image(render, &image, &error), SAG_OK);
    sag_render_destroy(render);
    sag_world_destroy(world);
    return image;
}

// Both orders of a use and a definition.
static void either_order(const char *use, const char *definition) {
    char text[2][2048];
    snprintf(text[0], sizeof text[0], HEAD "%s\n%s\n", definition, use);
    snprintf(text[1], sizeof text[1], HEAD "%s\n%s\n", use, definition);
    sag_image a = picture_of(text[0]), b = picture_of(text[1]);
    if (!same_picture(&a, &b)) print_message("%s\n", use);
    assert_true(same_picture(&a, &b));
    double sum = 0; // something is there
    for (size_t i = 0; i < 3u * 24 * 24; i++) sum += (double)a.pixels[i];
    assert_true(sum > 0);
    sag_image_clear(scene_context, &a);
    sag_image_clear(scene_context, &b);
}

#define BALL "Shape \"sphere\" \"float radius\" 1.5"
#define RED  "MakeNamedMaterial \"red\" \"string type\" \"diffuse\" \"rgb reflectance\" [ .8 .1 .1 ]"
#define CHECKS                                                                                               \
    "Texture \"checks\" \"spectrum\" \"checkerboard\" \"float uscale\" 5 \"float vscale\" 9 \"rgb tex1\" [ " \
    "1 0 .5 ]"

static void either_order_is_right(void **state) {
    (void)state;
    either_order("NamedMaterial \"red\" " BALL, RED);
    either_order(
        "Material \"mix\" \"string materials\" [ \"red\" \"blue\" ] \"float amount\" .3 " BALL,
        RED " MakeNamedMaterial \"blue\" \"string type\" \"coateddiffuse\" \"rgb reflectance\" [ .1 .1 .8 ]");
    either_order("Material \"diffuse\" \"texture reflectance\" \"checks\" " BALL, CHECKS);
    either_order(
        "Material \"diffusetransmission\" \"texture reflectance\" \"checks\" \"float scale\" .5 " BALL,
        CHECKS);
    either_order("Texture \"dim\" \"spectrum\" \"scale\" \"texture tex\" \"checks\" \"float scale\" .5 "
                 "Material \"diffuse\" \"texture reflectance\" \"dim\" " BALL,
                 CHECKS);
    either_order("Material \"conductor\" \"texture roughness\" \"rough\" \"float vroughness\" .1 " BALL,
                 "Texture \"rough\" \"float\" \"fbm\"");
    either_order(BALL " \"texture alpha\" \"holes\" ", "Texture \"holes\" \"float\" \"checkerboard\"");
    either_order("NamedMaterial \"red\" " BALL,
                 "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [ 0 1 0 ] MakeNamedMaterial \"red\" "
                 "\"string type\" \"diffuse\" \"texture reflectance\" \"t\"");
    either_order("NamedMaterial \"gone\" " BALL,
                 "MakeNamedMaterial \"gone\" \"string type\" \"interface\" Material \"diffuse\" "
                 "Shape \"disk\" \"float height\" 2 \"float radius\" .5");
    either_order("AttributeBegin Translate .5 0 0 Scale .5 1 1 ObjectInstance \"thing\" AttributeEnd",
                 "AttributeBegin Rotate 30 0 1 0 ObjectBegin \"thing\" Material \"conductor\" " BALL
                 " ObjectEnd AttributeEnd");
}

static void what_never_comes_is_an_error(void **state) {
    (void)state;
    scene_fails("WorldBegin\nNamedMaterial \"a\" Shape \"sphere\"\nNamedMaterial \"a\"", 2, 1,
                "there is no material \"a\"");
    scene_fails("WorldBegin\n ObjectInstance \"a\" Shape \"sphere\"", 2, 2, "there is no object \"a\"");
    scene_fails("WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nTexture \"u\" \"spectrum\" "
                "\"constant\"",
                2, 20, "there is no texture \"t\"");
    // A texture of the other kind under the same name is another one.
    scene_fails("WorldBegin\nMaterial \"conductor\" \"texture roughness\" \"t\"\nTexture \"t\" \"spectrum\" "
                "\"constant\"",
                2, 22, "there is no texture \"t\"");
    scene_fails(
        "WorldBegin\nMakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"]", 2,
        43, "there is no material \"a\" yet");
    scene_fails("WorldBegin NamedMaterial \"m\"\nMakeNamedMaterial \"m\" \"string type\" \"mix\" \"string "
                "materials\" [\"m\" \"m\"]",
                2, 43, "there is no material \"m\" yet");
    scene_fails("WorldBegin\n Material \"mix\" \"string materials\" [\"a\" \"a\"]\nMakeNamedMaterial \"a\" "
                "\"string type\" \"interface\"",
                2, 2, "an interface cannot be mixed");
    scene_fails("WorldBegin NamedMaterial \"a\" " RED "\n" RED " MakeNamedMaterial \"a\" \"string type\" "
                "\"diffuse\"",
                2, 1, "there is a material \"red\" already");
}

static void circles_end(void **state) {
    (void)state;
    scene_fails("WorldBegin\nTexture \"a\" \"float\" \"scale\" \"texture tex\" \"b\"\n"
                "Texture \"b\" \"float\" \"scale\" \"texture tex\" \"a\"",
                2, 29, "nest too deep, or in a circle");
    scene_fails(
        "WorldBegin\nMaterial \"conductor\" \"texture roughness\" \"a\" Texture \"a\" \"float\" \"mix\" "
        "\"texture tex1\" \"a\" \"texture tex2\" \"a\"",
        2, 22, "nest too deep, or in a circle");
    // From the end to the beginning, one more than may be.
    char text[4096] = "WorldBegin\n";
    for (int i = 0; i < 33; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text),
                 "Texture \"t%d\" \"float\" \"scale\" \"texture tex\" \"t%d\"\n", i, i + 1);
    strcat(text, "Texture \"t33\" \"float\" \"constant\" \"float value\" 1 ");
    scene_fails(text, 2, 30, "nest too deep");
}

// What is defined as "a\"b" is used as that: escapes are undone in both.
static void names_with_escapes_are_found(void **state) {
    (void)state;
    sag_world *world =
        scene_load_good("WorldBegin Texture \"a\\\"b\" \"spectrum\" \"constant\" \"rgb value\" [.8 .2 .2]\n"
                        "Material \"diffuse\" \"texture reflectance\" \"a\\\"b\"\n"
                        "MakeNamedMaterial \"m\\\\\" \"string type\" \"diffuse\"\n"
                        "Material \"mix\" \"string materials\" [\"m\\\\\" \"m\\\\\"] Shape \"sphere\"");
    assert_int_equal(scene_warning_count, 0);
    sag_world_destroy(world);
}

static void memory_may_be_short(void **state) {
    (void)state;
    scene_fails_without_memory(
        HEAD "NamedMaterial \"red\" " BALL " ObjectInstance \"o\" Material \"mix\" \"string "
             "materials\" [\"red\" \"red\"] " BALL " \"texture alpha\" \"a\" " RED
             " Texture \"a\" \"float\" \"constant\" ObjectBegin \"o\" " BALL " ObjectEnd");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(either_order_is_right), cmocka_unit_test(what_never_comes_is_an_error),
        cmocka_unit_test(circles_end),           cmocka_unit_test(names_with_escapes_are_found),
        cmocka_unit_test(memory_may_be_short),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
