// SPDX-License-Identifier: MIT
// Lights of pbrt scenes: amounts by power and illuminance, pictures, portals, what is wrong with them.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/light.h"
#include "support/scene_text.h"

#define W  "WorldBegin\n"
#define PI 3.14159265358979323846

// A picture of these grey values, the first row above, as a portable float map.
static void write_picture(const char *name, int width, int height, const float *grey) {
    char bytes[4096];
    int at = snprintf(bytes, sizeof bytes, "PF\n%d %d\n-1.0\n", width, height);
    for (int y = height; y-- > 0;)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++) {
                memcpy(bytes + at, &grey[y * width + x], sizeof *grey);
                at += (int)sizeof *grey;
            }
    scene_write(name, bytes, (size_t)at);
}

static const sag_light *light_of(const sag_world *world, size_t i) {
    assert_true(i < world->lights.count);
    return (const sag_light *)world->lights.items + i;
}

static void near(double got, double wanted) {
    if (!(fabs(got - wanted) <= 1e-6 * fabs(wanted))) fail_msg("%.9g instead of %.9g", got, wanted);
}

static void test_power(void **state) {
    (void)state;
    sag_world *world = scene_load_good(
        W "LightSource \"point\" \"rgb I\" [1 1 1] \"float power\" 100\n"
          "LightSource \"spot\" \"rgb I\" [1 1 1] \"float power\" 100 \"float scale\" 2\n"
          "LightSource \"goniometric\" \"string filename\" \"g.pfm\" \"rgb I\" [1 1 1] \"float power\" 100\n"
          "LightSource \"projection\" \"string filename\" \"p.pfm\" \"float power\" 100 \"float fov\" 60\n"
          "LightSource \"distant\" \"rgb L\" [1 1 1] \"float illuminance\" 7\n"
          "LightSource \"infinite\" \"rgb L\" [2 2 2] \"float illuminance\" 7\n"
          "LightSource \"infinite\" \"string filename\" \"g.pfm\" \"float illuminance\" 7\n");
    if (scene_warning_count != 0) fail_msg("%s", scene_warnings);
    near(light_of(world, 0)->color.g, 100 / (4 * PI));
    const double start = cos(25 * PI / 180), end = cos(30 * PI / 180);
    near(light_of(world, 1)->color.g, 2 * 100 / (2 * PI * ((1 - start) + (start - end) / 2)));
    near(light_of(world, 2)->color.g, 100 / (4 * PI * 2.5)); // the picture's mean
    // The projected rectangle: pixels in proportion to their solid angles. All of it is 3.
    const double y = tan(PI / 6), x = 2 * y;
    double sum = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 2; j++) {
            const double a = (2 * (i + 0.5) / 4 - 1) * x, b = (2 * (j + 0.5) / 2 - 1) * y;
            sum += pow(1 + a * a + b * b, -1.5) / 8;
        }
    near(light_of(world, 3)->color.g, 100 / (3 * 4 * x * y * sum));
    near(light_of(world, 3)->fov_rad, PI / 3);
    near(light_of(world, 4)->color.g, 7);
    near(light_of(world, 5)->color.g, 2 * 7 / PI);
    assert_true(light_of(world, 6)->color.g > 0);
    sag_world_destroy(world);
}

// A spot under a transform that is no similarity is stretched with it.
static void test_a_spot_is_stretched_by_its_transform(void **state) {
    (void)state;
    sag_world *world = scene_load_good(W "Translate 0 1 0 Scale 3 1 1\n"
                                         "LightSource \"spot\" \"point3 to\" [1 0 0]\n");
    near(light_of(world, 0)->to_world.m[0][0], 3);
    near(light_of(world, 0)->to.x, 3);
    near(light_of(world, 0)->to.y, 1);
    sag_world_destroy(world);
}

// pbrt's scale for the illuminance of a picture that is the same everywhere: half of what π would ask for.
static void test_illuminance_of_a_picture(void **state) {
    (void)state;
    float grey[64 * 64 / 16];
    for (int i = 0; i < 256; i++) grey[i] = 2;
    write_picture("even.pfm", 16, 16, grey);
    sag_world *world = scene_load_good(
        W "LightSource \"infinite\" \"string filename\" \"even.pfm\" \"float illuminance\" 7\n");
    const double got =
        light_of(world, 0)->color.g * 2 * PI / 7; // 2 is what exactly π per radiance gives in pbrt
    assert_true(fabs(got - 2) < 0.05);
    sag_world_destroy(world);
}

// pbrt weighs an EXR's channels by their luminance in the order of their names, B G R: red counts for blue.
static void test_illuminance_of_an_exr_picture_counts_red_for_blue(void **state) {
    (void)state;
    sag_image image;
    sag_error error;
    double scale[2];
    assert_int_equal(sag_image_create(scene_context, 16, 16, 3, &image, &error), SAG_OK);
    for (size_t i = 0; i < 256; i++) image.pixels[3 * i] = 2;
    for (int k = 0; k < 2; k++) {
        const char *const name = k ? "red.EXR" : "red.pfm";
        char text[200];
        assert_int_equal(sag_image_write(scene_context, &image, scene_path(name), &error), SAG_OK);
        snprintf(text, sizeof text,
                 W "LightSource \"infinite\" \"string filename\" \"%s\" \"float illuminance\" 7\n", name);
        sag_world *world = scene_load_good(text);
        scale[k] = light_of(world, 0)->color.g;
        assert_true(light_of(world, 0)->image.pixels[0] == 2 && light_of(world, 0)->image.pixels[2] == 0);
        sag_world_destroy(world);
    }
    near(scale[1] / scale[0], 0.2126 / 0.0722);
    sag_image_clear(scene_context, &image);
}

static void test_places(void **state) {
    (void)state;
    sag_world *world =
        scene_load_good(W "Translate 1 2 3 Rotate 90 0 0 1\n"
                          "LightSource \"goniometric\" \"string filename\" \"g.pfm\"\n"
                          "LightSource \"projection\" \"string filename\" \"p.pfm\"\n"
                          "LightSource \"infinite\" \"point3 portal\" [0 0 0  0 1 0  1 1 0  1 0 0]\n");
    if (scene_warning_count != 0) fail_msg("%s", scene_warnings);
    for (size_t i = 0; i < 2; i++) {
        const sag_vec3 from = light_of(world, i)->from;
        assert_true(from.x == 1 && from.y == 2 && from.z == 3);
    }
    // The pole of the picture is the light's y axis, turned.
    const sag_affine *to_world = &light_of(world, 0)->to_world;
    const sag_vec3 pole = sag_affine_vector(to_world, sag_vec3_make(0, 0, 1));
    assert_true(fabs(pole.x + 1) < 1e-12);
    // Down in the picture is the light's −y... its first row is at the projector's lower edge, upside down.
    const sag_vec3 row = sag_affine_vector(&light_of(world, 1)->to_world, sag_vec3_make(0, 1, 0));
    assert_true(fabs(row.x - 1) < 1e-12);
    const sag_light *window = light_of(world, 2);
    assert_true(window->has_portal && window->portal[2].x == 1 &&
                window->portal[2].y == 1); // in the world's space
    sag_world_destroy(world);
}

static const sagi_appearance *look_of(const sag_world *world, size_t i) {
    assert_true(i < world->appearances.count);
    return (const sagi_appearance *)world->appearances.items + i;
}

static void test_area_lights(void **state) {
    (void)state;
    sag_world *world = scene_load_good(
        W "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 12 \"bool twosided\" "
          "true\n"
          "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 5 0] \"integer indices\" [0 1 2 0 1 3]\n"
          "Shape \"disk\" \"float radius\" 2 AttributeEnd\n"
          "AttributeBegin AreaLightSource \"diffuse\" \"string filename\" \"p.pfm\" \"float power\" 12\n"
          "Shape \"disk\" \"float radius\" 2 AttributeEnd\n"
          "AttributeBegin AreaLightSource \"diffuse\" \"string filename\" \"p.pfm\" \"float scale\" 5\n"
          "Shape \"disk\" \"float alpha\" 0 AttributeEnd\n");
    if (scene_warning_count != 0) fail_msg("%s", scene_warnings);
    // Each triangle by itself, as pbrt has it.
    assert_true(look_of(world, 0)->look.emission_over_area && look_of(world, 0)->look.two_sided);
    near(look_of(world, 0)->look.emission.g, 12 / (2 * PI));
    near(look_of(world, 1)->look.emission.g, 12 / (2 * PI * PI * 4));
    near(look_of(world, 2)->look.emission.g, 12 / (PI * PI * 4 * 3)); // the picture is 3
    near(look_of(world, 3)->look.emission.g, 5);
    assert_true(look_of(world, 2)->look.emission_texture != 0);
    assert_true(sagi_alpha_is_nowhere(look_of(world, 3)) && !sagi_alpha_is_nowhere(look_of(world, 2)));
    // The radiance of a triangle: power by π, sides and its own area, ½ and 2½.
    const sag_surface front = {.geometric_normal = {0, 0, 1}, .primitive = 0},
                      other = {.geometric_normal = {0, 0, 1}, .primitive = 1};
    const sagi_spectrum lambda = {550, 550, 550, 550};
    const sag_vec3 up = {0, 0, 1};
    const double a = (double)sagi_emission(look_of(world, 0), &front, up, lambda)[0],
                 b = (double)sagi_emission(look_of(world, 0), &other, up, lambda)[0];
    assert_true(fabs(a / b - 5) < 1e-5);
    sag_world_destroy(world);
    // A bent patch has the area of nine flat pieces there, 2.45557; its own is 2.46005.
    world = scene_load_good(W "AreaLightSource \"diffuse\" \"float power\" 12\n"
                              "Shape \"bilinearmesh\" \"point3 P\" [-1 2 0 1 2.4 0 -1 2.2 1 1 1.9 1.4]\n");
    near(look_of(world, 0)->look.emission.g, 12 / (PI * 2.455571703195186));
    sag_world_destroy(world);
    world = scene_load_good(W "AreaLightSource \"diffuse\" \"float power\" 3\n"
                              "Shape \"disk\" \"float radius\" 1e-200\n");
    assert_non_null(strstr(scene_warnings, "without area"));
    sag_world_destroy(world);
}

static void test_what_is_wrong(void **state) {
    (void)state;
    scene_fails(W "LightSource \"projection\"", 2, 1, "\"filename\" is missing");
    scene_fails(W "LightSource \"projection\" \"string filename\" \"p.pfm\" \"float fov\" 180", 2, 52,
                "fov 180");
    scene_fails(W "LightSource \"goniometric\" \"string filename\" \"p.pfm\"", 2, 27, "square");
    scene_fails(W "LightSource \"goniometric\" \"string filename\" \"none.pfm\"", 2, 27, "none.pfm");
    scene_fails(W "LightSource \"infinite\" \"string filename\" \"nan.pfm\"", 2, 24, "NaN");
    scene_fails(W "LightSource \"infinite\" \"string filename\" \"g.pfm\" \"rgb L\" [1 1 1]", 2, 1, "both");
    scene_fails(W "AreaLightSource \"diffuse\" \"string filename\" \"g.pfm\" \"rgb L\" [1 1 1]", 2, 1,
                "both");
    scene_fails(W "LightSource \"infinite\" \"point3 portal\" [0 0 0 0 1 0 1 1 0]", 2, 24, "4 corners");
    scene_fails(W "LightSource \"infinite\" \"point3 portal\" [0 0 0 0 1 0 1 1 0 3 0 0]", 2, 24,
                "no rectangle");
    scene_fails(W "LightSource \"infinite\" \"rgb L\" [1 -1 1]", 2, 1, "negative");
    scene_fails_without_memory(W
                               "LightSource \"goniometric\" \"string filename\" \"g.pfm\"\n"
                               "AreaLightSource \"diffuse\" \"string filename\" \"p.pfm\" Shape \"disk\"\n");
}

static int setup(void **state) {
    const int status = scene_setup(state);
    write_picture("g.pfm", 2, 2, (const float[]){1, 2, 3, 4});
    write_picture("p.pfm", 4, 2, (const float[]){3, 3, 3, 3, 3, 3, 3, 3});
    write_picture("nan.pfm", 2, 2, (const float[]){1, 2, NAN, 4});
    return status;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_power),
        cmocka_unit_test(test_a_spot_is_stretched_by_its_transform),
        cmocka_unit_test(test_illuminance_of_a_picture),
        cmocka_unit_test(test_illuminance_of_an_exr_picture_counts_red_for_blue),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_area_lights),
        cmocka_unit_test(test_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, setup, scene_teardown);
}
