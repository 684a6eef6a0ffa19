// SPDX-License-Identifier: MIT
// Each kind of texture against what it is said to be, and its footprint; what scenes say of them.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/noise.h"
#include "render/pattern.h"
#include "render/world.h"
#include "support/random.h"
#include "support/scene_text.h"

#include <stdio.h>
#include <string.h>

static double number_at(const sag_world *world, sag_texture_id id, const sagi_spot *at) {
    const sag_input input = {.texture = id};
    return sagi_input_number(world, &input, at);
}

static sag_rgb color_at(const sag_world *world, sag_texture_id id, const sagi_spot *at) {
    const sag_input input = {.texture = id};
    return sagi_input_rgb(world, &input, at);
}

static sagi_spot random_spot(rng *r) {
    const double x = rng_uniform(r, -3, 3), y = rng_uniform(r, -3, 3), z = rng_uniform(r, -3, 3);
    return (sagi_spot){.position = {x, y, z}, .u = rng_uniform(r, -3, 3), .v = rng_uniform(r, -3, 3)};
}

// The texture `t` of a scene.
#define SCENE "Camera \"perspective\" WorldBegin\n"
static sag_world *world_with(const char *textures) {
    char text[4096];
    snprintf(text, sizeof text, SCENE "%s\nShape \"sphere\"\n", textures);
    return scene_load_good(text);
}

static sag_texture_id last(const sag_world *world) { return (sag_texture_id)world->textures.count; }

static void bilerp_meets_its_corners(void **state) {
    (void)state;
    sag_world *world =
        world_with("Texture \"a\" \"float\" \"bilerp\" \"float v00\" 1 \"float v01\" 2 \"float v10\" 4 "
                   "\"float v11\" 8 \"float uscale\" 2");
    const sag_texture_id id = last(world);
    const double corners[2][2] = {{1, 2}, {4, 8}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            const sagi_spot at = {.u = i * 0.5, .v = j};
            assert_true(number_at(world, id, &at) == corners[i][j]);
        }
    const sagi_spot middle = {.u = 0.25, .v = 0.5};
    assert_true(number_at(world, id, &middle) == 15 / 4.0);
    sag_world_destroy(world);
}

static void direction_mix_follows_the_normal(void **state) {
    (void)state;
    sag_world *world =
        world_with("Rotate 90 1 0 0 Texture \"a\" \"float\" \"directionmix\" \"float tex1\" 10 "
                   "\"float tex2\" 20 \"vector3 dir\" [0 3 0]");
    const sag_texture_id id = last(world);
    // y turned to z.
    const sagi_spot along = {.normal = {0, 0, 1}}, against = {.normal = {0, 0, -1}},
                    beside = {.normal = {1, 0, 0}};
    assert_true(fabs(number_at(world, id, &along) - 10) < 1e-12);
    assert_true(fabs(number_at(world, id, &against) - 10) < 1e-12);
    assert_true(fabs(number_at(world, id, &beside) - 20) < 1e-12);
    sag_world_destroy(world);
}

static void dots_are_round_and_whole(void **state) {
    (void)state;
    sag_world *world =
        world_with("Texture \"a\" \"spectrum\" \"dots\" \"rgb inside\" [1 0 0] \"rgb outside\" [0 1 0] "
                   "\"float uscale\" 3");
    const sag_texture_id id = last(world);
    int dots = 0;
    double area = 0;
    const int cells = 60, steps = 40;
    for (int i = 0; i < cells; i++)
        for (int j = 0; j < cells; j++) {
            int inside = 0;
            for (int k = 0; k < steps * steps; k++) {
                const double s = i - 0.5 + (k % steps + 0.5) / steps,
                             t = j - 0.5 + ((int)(k / steps) + 0.5) / steps;
                inside += sagi_in_dot(s, t);
                if (k % 97 == 0) {
                    const sagi_spot at = {.u = s / 3, .v = t};
                    const sag_rgb c = color_at(world, id, &at);
                    // As pbrt-v4 has it, "outside" is the dot.
                    assert_true(c.r == !sagi_in_dot(3 * (s / 3), t) && c.g == 1 - c.r);
                }
            }
            dots += inside > 0;
            if (inside) area += inside / (double)(steps * steps);
        }
    assert_true(dots > 0.35 * cells * cells && dots < 0.45 * cells * cells);
    assert_true(fabs(area / dots - 0.35 * 0.35 * 3.14159265) < 0.005);
    sag_world_destroy(world);
}

static void boards_fade_to_grey(void **state) {
    (void)state;
    sag_world *world =
        world_with("Texture \"a\" \"float\" \"checkerboard\" \"float tex1\" 1 \"float tex2\" 3\n"
                   "Scale 0.5 0.5 0.5 Texture \"b\" \"float\" \"checkerboard\" \"integer dimension\" 3 "
                   "\"float tex1\" 1 \"float tex2\" 3");
    rng r = rng_make(1);
    for (int i = 0; i < 20000; i++) {
        sagi_spot at = random_spot(&r);
        const double size = rng_log_uniform(&r, 1e-4, 10);
        at.dudx = size, at.dvdy = size;
        at.dpdx = (sag_vec3){size, 0, size}, at.dpdy = (sag_vec3){0, size, 0};
        const double flat = number_at(world, 1, &at), solid = number_at(world, 2, &at);
        assert_true(flat >= 1 - 1e-9 && flat <= 3 + 1e-9 && solid >= 1 - 1e-9 && solid <= 3 + 1e-9);
        if (size > 3) assert_true(fabs(flat - 2) < 0.05 && fabs(solid - 2) < 0.05);
        const double parity = floor(at.u) + floor(at.v);
        const double du = at.u - floor(at.u), dv = at.v - floor(at.v);
        const bool far = fmin(fmin(du, 1 - du), fmin(dv, 1 - dv)) > 1.5 * size;
        if (far) assert_true(flat == (fmod(parity, 2) != 0 ? 3 : 1));
    }
    // Against the integral with the triangle filter, by summation.
    const sagi_spot_2d edge = {.s = 0.9, .t = 0.5, .dsdx = 0.2, .dtdy = 0.02};
    double sum = 0, weights = 0;
    for (int i = -3000; i < 3000; i++) {
        const double y = (i + 0.5) * 1e-4, weight = 0.3 - fabs(y);
        weights += weight, sum += weight * (0.9 + y < 1 ? 0 : 1);
    }
    assert_true(fabs(sagi_checkerboard_2d(&edge) - sum / weights) < 1e-6);
    sag_world_destroy(world);
}

static void noises_are_as_their_names_say(void **state) {
    (void)state;
    sag_world *world = world_with(
        "Scale 2 2 2 Texture \"a\" \"float\" \"fbm\" \"integer octaves\" 3 \"float roughness\" 0.4\n"
        "Texture \"b\" \"float\" \"wrinkled\" \"integer octaves\" 2\nTexture \"c\" \"float\" \"windy\"\n"
        "Texture \"d\" \"spectrum\" \"marble\" \"float scale\" 3 \"float variation\" 0.5");
    rng r = rng_make(2);
    const sag_vec3 none = {0, 0, 0};
    double marble_mean = 0;
    for (int i = 0; i < 3000; i++) {
        const sagi_spot at = random_spot(&r);
        const sag_vec3 p = sag_scale(at.position, 0.5);
        assert_true(fabs(number_at(world, 1, &at) - sagi_noise_fbm(p, none, none, 0.4, 3)) < 1e-14);
        assert_true(fabs(number_at(world, 2, &at) - sagi_noise_turbulence(p, none, none, 0.5, 2)) < 1e-14);
        const double windy = fabs(sagi_noise_fbm(sag_scale(p, 0.1), none, none, 0.5, 3)) *
                             sagi_noise_fbm(p, none, none, 0.5, 6);
        assert_true(fabs(number_at(world, 3, &at) - windy) < 1e-14);
        const sag_rgb marble = color_at(world, 4, &at);
        assert_true(marble.r > 0.29 && marble.r < 0.91 && marble.b > 0.4 && marble.b < 0.91);
        marble_mean += marble.r / 3000;
        // A colour of numbers is grey.
        const sag_rgb grey = color_at(world, 1, &at);
        assert_true(grey.r == grey.b && grey.r == number_at(world, 1, &at));
    }
    assert_true(marble_mean > 0.7 && marble_mean < 0.87);
    sag_world_destroy(world);
}

static void mappings_come_from_scenes(void **state) {
    (void)state;
    sag_world *world = world_with("Translate 1 0 0 Texture \"a\" \"float\" \"bilerp\" \"string mapping\" "
                                  "\"planar\" \"vector3 v1\" [0 2 0] "
                                  "\"vector3 v2\" [1 0 0] \"float udelta\" 5 \"float v00\" 0 \"float v01\" 0 "
                                  "\"float v10\" 1 \"float v11\" 1\n"
                                  "Texture \"b\" \"float\" \"bilerp\" \"string mapping\" \"cylindrical\" "
                                  "\"float v01\" 1 \"float v11\" 1\n"
                                  "Texture \"c\" \"float\" \"bilerp\" \"string mapping\" \"spherical\" "
                                  "\"float v01\" 0 \"float v10\" 1");
    const sagi_spot at = {.position = {1, 3, 7}};
    assert_true(fabs(number_at(world, 1, &at) - 11) < 1e-12); // s = 2 y + 5
    assert_true(fabs(number_at(world, 2, &at) - 7) < 1e-12);  // t = z
    assert_true(fabs(number_at(world, 3, &at) - atan2(3, 7) / 3.14159265358979) < 1e-12);
    sag_world_destroy(world);
}

// Red 64, green 128, blue 192 and alpha 0 of 255 as a PNG.
static void write_picture(const char *name, uint32_t channels) {
    sag_image image;
    assert_int_equal(sag_image_create(scene_context, 1, 1, channels, &image, NULL), SAG_OK);
    for (uint32_t c = 0; c < 3; c++) image.pixels[c] = (float)sag_srgb_decode((64 + 64 * c) / 255.0);
    if (channels == 4) image.pixels[3] = 128 / 255.0F;
    assert_int_equal(sag_image_write(scene_context, &image, scene_path(name), NULL), SAG_OK);
    sag_image_clear(scene_context, &image);
}

static void pictures_as_numbers(void **state) {
    (void)state;
    write_picture("rgb.png", 3), write_picture("rgba.png", 4);
    sag_world *world =
        world_with("Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"rgb.png\" \"string encoding\" "
                   "\"linear\"\n"
                   "Texture \"b\" \"float\" \"imagemap\" \"string filename\" \"rgba.png\" \"string "
                   "encoding\" \"linear\"\n"
                   "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"rgba.png\" \"string "
                   "encoding\" \"gamma 2\" "
                   "\"float scale\" 2 \"bool invert\" true \"string filter\" \"EWA\" \"string wrap\" "
                   "\"octahedralsphere\"\n"
                   "Texture \"d\" \"float\" \"imagemap\" \"string filename\" \"rgb.png\" \"float scale\" 0 "
                   "\"bool invert\" true\n"
                   "Texture \"e\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"texture scale\" \"a\"");
    const sagi_spot at = {.u = 0.3, .v = 0.4};
    assert_true(fabs(number_at(world, 1, &at) - 128 / 255.0) < 1e-6); // the mean
    assert_true(fabs(number_at(world, 2, &at) - 128 / 255.0) < 1e-6); // alpha
    const sag_rgb c = color_at(world, 3, &at);
    assert_true(fabs(c.r - (1 - 2 * 64.0 * 64 / 255 / 255)) < 1e-6 && c.b == 0);
    assert_true(number_at(world, 4, &at) == 1);
    const sag_rgb e = color_at(world, 5, &at);
    assert_true(fabs(e.r - c.r * 128 / 255.0) < 1e-6 && e.b == 0);
    assert_int_equal(world->pictures.count, 4); // each way of reading a file once
    sag_world_destroy(world);
}

static void what_scenes_get_wrong(void **state) {
    (void)state;
    write_picture("rgb.png", 3);
#define IMAGE SCENE "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"rgb.png\"\n"
    scene_fails(IMAGE "\"string wrap\" \"mirror\"", 3, 1, "unknown wrap mode \"mirror\"");
    scene_fails(IMAGE "\"string filter\" \"lanczos\"", 3, 1, "unknown filter \"lanczos\"");
    scene_fails(IMAGE "\"string encoding\" \"gamma\"", 3, 1, "unknown encoding \"gamma\"");
    scene_fails(IMAGE "\"string encoding\" \"gamma 2x\"", 3, 1, "unknown encoding");
    scene_fails(IMAGE "\"string encoding\" \"gamma -2\"", 3, 1, "unknown encoding");
    scene_fails(IMAGE "\"string mapping\" \"cubic\"", 3, 1, "unknown texture mapping \"cubic\"");
    scene_fails(SCENE "Texture \"t\" \"float\" \"imagemap\"", 2, 1, "\"filename\" is missing");
    scene_fails(SCENE "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"no.exr\"", 2, 32, "no.exr");
    scene_fails(SCENE "Texture \"t\" \"float\" \"fbm\" \"integer octaves\" 0", 2, 27, "octaves 0");
    scene_fails(SCENE "Texture \"t\" \"float\" \"stucco\"", 2, 1, "unknown texture \"stucco\"");
    // Pictures are read after the text, and yet what comes first is said first.
    scene_fails(SCENE "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"no.png\"\nShape \"blob\"",
                2, 32, "Texture \"t\": ");
    scene_fails(SCENE "Material \"diffuse\" \"string normalmap\" \"no.png\"", 2, 20, "no.png");
    scene_fails_without_memory(
        IMAGE "\"float scale\" 2 Texture \"u\" \"spectrum\" \"imagemap\" \"string filename\" "
              "\"rgb.png\" \"string encoding\" \"linear\" Material \"diffuse\" "
              "\"texture reflectance\" \"u\" \"texture displacement\" \"t\" "
              "\"string normalmap\" \"rgb.png\" Shape \"sphere\" \"float alpha\" 0.5");
    sag_world *world = world_with("Texture \"t\" \"float\" \"ptex\" \"string filename\" \"a.ptx\"");
    assert_int_equal(scene_warning_count, 1);
    assert_non_null(strstr(scene_warnings, "ptex"));
    sag_world_destroy(world);
}

// Each level twice the one below: a billion lookups for one colour.
static void graphs_that_explode_are_refused(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_world *world = sag_world_create(context);
    sag_texture texture = {.kind = SAG_TEXTURE_CONSTANT, .a.value = {1, 1, 1}};
    sag_texture_id id = sag_world_add_texture(world, &texture);
    int levels = 0;
    while (id != 0 && levels < 31) {
        texture = (sag_texture){.kind = SAG_TEXTURE_MIX, .a.texture = id, .b.texture = id};
        id = sag_world_add_texture(world, &texture);
        levels += id != 0;
    }
    assert_int_equal(levels, 11); // 2¹² − 1 parts
    texture = (sag_texture){.kind = SAG_TEXTURE_IMAGE, .picture = 1};
    assert_int_equal(sag_world_add_texture(world, &texture), 0); // there is none
    sag_world_destroy(world);
    sag_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bilerp_meets_its_corners),
        cmocka_unit_test(direction_mix_follows_the_normal),
        cmocka_unit_test(dots_are_round_and_whole),
        cmocka_unit_test(boards_fade_to_grey),
        cmocka_unit_test(noises_are_as_their_names_say),
        cmocka_unit_test(mappings_come_from_scenes),
        cmocka_unit_test(pictures_as_numbers),
        cmocka_unit_test(what_scenes_get_wrong),
        cmocka_unit_test(graphs_that_explode_are_refused),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
