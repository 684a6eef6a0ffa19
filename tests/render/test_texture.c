// SPDX-License-Identifier: MIT
// Textures: pictures with every wrap, checkerboards, mixtures; and what a material makes of its inputs.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/world.h"

typedef struct room {
    sag_context *context;
    sag_world *world;
} room;

static room room_open(void) {
    sag_context *context = sag_context_create(NULL);
    return (room){context, sag_world_create(context)};
}

static void room_close(room *r) {
    sag_world_destroy(r->world);
    sag_context_destroy(r->context);
}

static double value_at(const room *r, sag_texture_id id, double u, double v) {
    const sagi_spot at = {.u = u, .v = v};
    const sag_input input = {.value = {-1, -1, -1}, .texture = id};
    return sagi_input_rgb(r->world, &input, &at).r;
}

// Two by two texels, from the top left: 1 2 / 3 4.
static sag_texture small_picture(const room *r, sag_wrap wrap) {
    sag_texture texture = {.kind = SAG_TEXTURE_IMAGE, .wrap = wrap};
    assert_int_equal(sag_image_create(r->context, 2, 2, 1, &texture.image, NULL), SAG_OK);
    for (int i = 0; i < 4; i++) texture.image.pixels[i] = (float)(i + 1);
    return texture;
}

static void pictures_are_bilinear_from_the_bottom(void **state) {
    (void)state;
    room r = room_open();
    sag_texture texture = small_picture(&r, SAG_WRAP_CLAMP);
    sag_texture_id id = sag_world_add_texture(r.world, &texture);
    assert_int_equal(id, 1);
    // Texel centres; v = 0 is the bottom.
    assert_true(value_at(&r, id, 0.25, 0.75) == 1 && value_at(&r, id, 0.75, 0.75) == 2);
    assert_true(value_at(&r, id, 0.25, 0.25) == 3 && value_at(&r, id, 0.75, 0.25) == 4);
    assert_true(value_at(&r, id, 0.5, 0.5) == 2.5);
    assert_true(value_at(&r, id, 0.5, 0.75) == 1.5);
    // Beyond the edge.
    assert_true(value_at(&r, id, -7, 9) == 1 && value_at(&r, id, 12, -3) == 4);
    assert_true(value_at(&r, id, NAN, 0.5) == 0 && value_at(&r, id, INFINITY, 0.5) == 0);
    texture = small_picture(&r, SAG_WRAP_BLACK);
    id = sag_world_add_texture(r.world, &texture);
    assert_true(value_at(&r, id, 0.25, 0.75) == 1 && value_at(&r, id, -7, 9) == 0);
    assert_true(value_at(&r, id, 0, 0.75) == 0.5); // half of it is outside
    texture = small_picture(&r, SAG_WRAP_REPEAT);
    id = sag_world_add_texture(r.world, &texture);
    assert_true(value_at(&r, id, 0, 0.75) == 1.5);
    for (int i = -3; i <= 3; i++) assert_true(value_at(&r, id, 0.25 + i, 0.75 - 2 * i) == 1);
    assert_true(value_at(&r, id, 1e300, 0.75) >= 1); // some texel, but one that is there
    room_close(&r);
}

static void pictures_are_scaled_inverted_and_placed(void **state) {
    (void)state;
    room r = room_open();
    sag_texture texture = small_picture(&r, SAG_WRAP_REPEAT);
    texture.scale = 0.25, texture.invert = true;
    texture.mapping.u_scale = 2, texture.mapping.v_offset = 0.5;
    sag_texture_id id = sag_world_add_texture(r.world, &texture);
    assert_true(value_at(&r, id, 0.125, 0.25) == 1 - 0.25);
    assert_true(value_at(&r, id, 0.375, 0.25) == 1 - 0.5);
    assert_true(value_at(&r, id, 0.125, -0.25) == 1 - 0.75);
    texture = small_picture(&r, SAG_WRAP_REPEAT);
    texture.scale = 10, texture.invert = true;
    id = sag_world_add_texture(r.world, &texture);
    assert_true(value_at(&r, id, 0.25, 0.75) == 0); // never below
    room_close(&r);
}

static void checkerboards_alternate(void **state) {
    (void)state;
    room r = room_open();
    sag_texture texture = {
        .kind = SAG_TEXTURE_CHECKERBOARD, .a.value = {1, 0, 0}, .b.value = {2, 0, 0}, .mapping.u_scale = 4};
    sag_texture_id id = sag_world_add_texture(r.world, &texture);
    assert_true(value_at(&r, id, 0.1, 0.1) == 1 && value_at(&r, id, 0.3, 0.1) == 2);
    assert_true(value_at(&r, id, 0.3, 1.1) == 1 && value_at(&r, id, -0.1, 0.1) == 2 &&
                value_at(&r, id, -0.1, -0.1) == 1);
    texture.dimension = 3;
    texture.mapping.world_to_texture = sag_affine_scale(sag_vec3_make(2, 2, 2));
    id = sag_world_add_texture(r.world, &texture);
    sag_input input = {.texture = id};
    for (int i = -3; i < 4; i++)
        for (int j = -3; j < 4; j++)
            for (int k = -3; k < 4; k++) {
                const sagi_spot at = {.position = {(i + 0.5) / 2, (j + 0.5) / 2, (k + 0.5) / 2}};
                assert_true(sagi_input_rgb(r.world, &input, &at).r == ((i + j + k) % 2 == 0 ? 1 : 2));
            }
    room_close(&r);
}

static void textures_combine(void **state) {
    (void)state;
    room r = room_open();
    sag_texture board = {.kind = SAG_TEXTURE_CHECKERBOARD, .a.value = {1, 1, 1}, .b.value = {3, 3, 3}};
    sag_texture_id inner = sag_world_add_texture(r.world, &board);
    sag_texture scale = {.kind = SAG_TEXTURE_SCALE, .a.texture = inner, .b.value = {5, 5, 5}};
    sag_texture_id scaled = sag_world_add_texture(r.world, &scale);
    sag_texture mix = {
        .kind = SAG_TEXTURE_MIX, .a.texture = scaled, .b.value = {7, 7, 7}, .amount.value = {0.25, 0, 0}};
    sag_texture_id mixed = sag_world_add_texture(r.world, &mix);
    sag_texture constant = {.kind = SAG_TEXTURE_CONSTANT, .a.texture = mixed};
    sag_texture_id outer = sag_world_add_texture(r.world, &constant);
    assert_true(value_at(&r, scaled, 0.5, 0.5) == 5 && value_at(&r, scaled, 1.5, 0.5) == 15);
    assert_true(value_at(&r, outer, 0.5, 0.5) == 0.75 * 5 + 0.25 * 7);
    assert_true(value_at(&r, outer, 1.5, 0.5) == 0.75 * 15 + 0.25 * 7);
    assert_true(value_at(&r, 0, 1, 1) == -1); // no texture: the value
    room_close(&r);
}

static void materials_read_their_inputs(void **state) {
    (void)state;
    room r = room_open();
    sag_surface surface = {.geometric_normal = {0, 0, 1}, .shading_normal = {0, 0, 1}, .dpdu = {1, 0, 0}};
    sag_vec3 wo = {0, 0, 1};
    const sagi_spectrum lambda = {450, 530, 600, 700};
    sagi_bsdf bsdf;
    assert_true(sagi_material_evaluate(r.world, NULL, &surface, NULL, NULL, wo, lambda, &bsdf));
    assert_true(bsdf.kind == SAG_MATERIAL_DIFFUSE && bsdf.color[2] == 0.5F);
    sagi_appearance look = {.look.material = 1};
    // Reflectances are held within [0, 1], NaN is nothing; tiny roughness is a mirror.
    sag_material diffuse = {.reflectance.value = {7, -1, NAN}};
    assert_int_equal(sag_world_add_material(r.world, &diffuse), 1);
    assert_true(sagi_material_evaluate(r.world, &look, &surface, NULL, NULL, wo, lambda, &bsdf));
    for (int i = 0; i < 4; i++) assert_true(bsdf.color[i] >= 0 && bsdf.color[i] <= 1);
    assert_true(bsdf.color[0] < 0.1F && bsdf.color[3] > 0.9F);
    const sag_rgb red = sagi_material_albedo(r.world, &look, &surface, NULL);
    assert_true(red.r == 1 && red.g == 0 && red.b == 0);
    sag_material metal = {.kind = SAG_MATERIAL_CONDUCTOR,
                          .reflectance.value = {0.5, 0.9, 0},
                          .roughness_u.value = {1e-4, 0, 0}};
    look.look.material = sag_world_add_material(r.world, &metal);
    assert_true(sagi_material_evaluate(r.world, &look, &surface, NULL, NULL, wo, lambda, &bsdf));
    sag_rgb color = sagi_material_albedo(r.world, &look, &surface, NULL);
    assert_true(bsdf.specular && fabs(color.r - 0.5) < 1e-12 && fabs(color.g - 0.9) < 1e-12 &&
                color.b < 1e-12);
    // Under a coat a metal's index is that against the coat.
    sag_material lacquered = {.kind = SAG_MATERIAL_COATED_CONDUCTOR, .coat_eta.value = {1.6, 1.6, 1.6}};
    const sag_spectrum eta = {.kind = SAG_SPECTRUM_CONSTANT, .value = 0.4},
                       k = {.kind = SAG_SPECTRUM_CONSTANT, .value = 3.2};
    assert_int_equal(sag_world_add_spectrum(r.world, &eta, &lacquered.eta.spectrum), SAG_OK);
    assert_int_equal(sag_world_add_spectrum(r.world, &k, &lacquered.k.spectrum), SAG_OK);
    look.look.material = sag_world_add_material(r.world, &lacquered);
    assert_true(sagi_material_evaluate(r.world, &look, &surface, NULL, NULL, wo, lambda, &bsdf));
    for (int i = 0; i < 4; i++)
        assert_true(fabsf(bsdf.eta[i] - 0.25F) < 1e-6F && fabsf(bsdf.k[i] - 2) < 1e-5F);
    sag_material air = {.kind = SAG_MATERIAL_INTERFACE};
    look.look.material = sag_world_add_material(r.world, &air);
    assert_false(sagi_material_evaluate(r.world, &look, &surface, NULL, NULL, wo, lambda, &bsdf));
    room_close(&r);
}

// Which of its materials a mix is, by place and direction: χ² of the shares in cells of both, and of how
// often neighbours in a fine lattice are both the second one, for a mix and a mix of mixes.
static void mixes_choose_by_their_amounts(void **state) {
    (void)state;
    enum { CELLS = 8, WAYS = 4, SIDE = 64 };
    room r = room_open();
    sag_surface surface = {.geometric_normal = {0, 0, 1}, .shading_normal = {0, 0, 1}, .dpdu = {1, 0, 0}};
    const sagi_spectrum lambda = {450, 530, 600, 700};
    const sag_material kinds[] = {{.kind = SAG_MATERIAL_DIFFUSE},
                                  {.kind = SAG_MATERIAL_CONDUCTOR, .reflectance.value = {0.5, 0.5, 0.5}},
                                  {.kind = SAG_MATERIAL_DIFFUSE_TRANSMISSION}};
    for (uint32_t i = 0; i < 3; i++) assert_int_equal(sag_world_add_material(r.world, &kinds[i]), i + 1);
    const sag_material mixes[] = {
        {.kind = SAG_MATERIAL_MIX, .materials = {1, 2}, .amount.value = {0.3, 0, 0}},
        {.kind = SAG_MATERIAL_MIX, .materials = {3, 4}, .amount.value = {0.6, 0, 0}},
        {.kind = SAG_MATERIAL_MIX, .materials = {1, 2}, .amount.value = {0.96, 0, 0}}};
    const double shares[] = {0.3, 0.6 * 0.3, 0.96}; // of the conductor
    for (uint32_t m = 0; m < 3; m++) {
        const sagi_appearance look = {.look.material = sag_world_add_material(r.world, &mixes[m])};
        const double p = shares[m];
        double chi2 = 0;
        uint32_t pairs = 0, all = 0;
        for (int way = 0; way < WAYS; way++) {
            const sag_vec3 wo = sag_normalize(sag_vec3_make(cos(2.0 * way), sin(2.0 * way), 0.3 + way));
            uint32_t met[CELLS] = {0};
            for (int y = 0; y < SIDE; y++)
                for (int x = 0, before = 0; x < SIDE; x++) {
                    sagi_bsdf bsdf;
                    surface.position = sag_vec3_make(0.001 * x, 0.001 * y, 0);
                    assert_true(
                        sagi_material_evaluate(r.world, &look, &surface, NULL, NULL, wo, lambda, &bsdf));
                    const int second = bsdf.kind == SAG_MATERIAL_CONDUCTOR;
                    met[y * CELLS / SIDE] += (uint32_t)second;
                    pairs += (uint32_t)(second && before);
                    all += x > 0;
                    before = second;
                }
            const double n = SIDE * SIDE / CELLS;
            for (int i = 0; i < CELLS; i++) chi2 += (met[i] - n * p) * (met[i] - n * p) / (n * p * (1 - p));
        }
        // 32 degrees of freedom: beyond 73 once in 20,000; of pairs next to each other two thirds more vary.
        assert_true(chi2 > 8 && chi2 < 73);
        assert_true(fabs(pairs - all * p * p) < 5 * sqrt(3 * all * p * p * (1 - p)));
    }
    room_close(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_bilinear_from_the_bottom),
        cmocka_unit_test(pictures_are_scaled_inverted_and_placed),
        cmocka_unit_test(checkerboards_alternate),
        cmocka_unit_test(textures_combine),
        cmocka_unit_test(materials_read_their_inputs),
        cmocka_unit_test(mixes_choose_by_their_amounts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
