// SPDX-License-Identifier: MIT
// Layers: what a ball and a plane show from known places, beside an unchanged picture.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/job.h"
#include "support/picture.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SIZE 33

// A red ball of radius 1 at the origin in front of an instanced square at z = −2, seen from (0, 0, 8); right
// and left of the square there is nothing.
static void furnish(studio *s) {
    s->settings->film.width = s->settings->film.height = SIZE;
    s->settings->film.layers = SAG_LAYER_ALL;
    s->settings->camera.fov_rad = 0.8;
    sag_world_add_light(s->world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
    const uint32_t red = studio_material(s, (sag_material){.reflectance.value = {0.75, 0.25, 0.125}});
    const uint32_t ball = sag_add_sphere(s->scene, &(sag_sphere){.radius = 1});
    sag_world_set_appearance(s->world, s->scene, ball, &(sag_appearance){.material = red});
    sag_scene *object = sag_world_add_object(s->world);
    sag_add_rectangle(object,
                      &(sag_rectangle){.corner = {-2, -2, -2}, .edge_u = {4, 0, 0}, .edge_v = {0, 4, 0}});
    assert_int_equal(sag_scene_commit(object, NULL), SAG_OK);
    const sag_affine map = sag_affine_identity();
    assert_int_not_equal(sag_add_instance(s->scene, object, &map), SAG_INVALID_ID);
}

static sag_layers layers_of(studio *s, uint32_t wave_size) {
    sag_error error;
    sag_layers layers = {0};
    sag_render *render = sag_render_create(s->world, &error);
    assert_non_null(render);
    if (wave_size) render->wave_size = wave_size;
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_int_equal(sag_render_get_layers(render, &layers, &error), SAG_OK);
    sag_render_destroy(render);
    return layers;
}

static float at(const sag_layers *layers, uint32_t x, uint32_t y, const char *name) {
    for (uint32_t c = 0; c < layers->channel_count; c++)
        if (strcmp(layers->names[c], name) == 0)
            return layers->pixels[((size_t)y * layers->width + x) * layers->channel_count + c];
    fail_msg("no channel %s", name);
    return 0;
}

static uint32_t id_at(const sag_layers *layers, uint32_t x, uint32_t y, const char *name) {
    const float bits = at(layers, x, y, name);
    uint32_t id;
    memcpy(&id, &bits, sizeof id);
    return id;
}

static void assert_near(float found, double expected, double error) {
    if (!(fabs((double)found - expected) <= error)) fail_msg("%g, not %g", (double)found, expected);
}

static void layers_show_what_is_there(void **state) {
    (void)state;
    for (int in_camera = 0; in_camera < 2; in_camera++) {
        studio s = studio_open(2);
        furnish(&s);
        s.settings->film.layers_in_camera_space = in_camera;
        sag_layers l = layers_of(&s, 0);
        assert_int_equal(l.channel_count, 24);
        const uint32_t m = SIZE / 2;
        // The ball's middle. Camera space looks along +z, the scene's camera along −z.
        const double sign = in_camera ? -1 : 1;
        assert_near(at(&l, m, m, "Albedo.R"), 0.75, 1e-6), assert_near(at(&l, m, m, "Albedo.B"), 0.125, 1e-6);
        assert_near(at(&l, m, m, "N.Z"), sign, 1e-3), assert_near(at(&l, m, m, "Ns.Z"), sign, 1e-3);
        assert_near(at(&l, m, m, "Z"), 7, 0.02);
        assert_near(at(&l, m, m, "P.Z"), in_camera ? 7 : 1, 0.02);
        assert_near(at(&l, m, m, "P.X"), 0, 0.05);
        assert_int_equal(id_at(&l, m, m, "id.geometry"), 1);
        assert_int_equal(id_at(&l, m, m, "id.instance"), 0);
        assert_int_equal(id_at(&l, m, m, "id.material"), 1);
        // The square beside it: depth is that of the plane, not the distance.
        assert_near(at(&l, 10, m, "Z"), 10, 1e-4), assert_near(at(&l, 10, m, "Albedo.R"), 0.5, 1e-6);
        assert_near(at(&l, 10, m, "P.Z"), in_camera ? 10 : -2, 1e-4);
        assert_true(at(&l, 10, m, "P.X") < -1 && at(&l, 22, m, "P.X") > 1);
        assert_true(at(&l, m, 10, "P.Y") > 1); // up is up in both spaces
        const double u = ((double)at(&l, 10, m, "P.X") + 2) / 4;
        assert_near(at(&l, 10, m, "u"), u, 1e-5), assert_near(at(&l, 10, m, "v"), 0.5, 0.02);
        assert_int_not_equal(id_at(&l, 10, m, "id.instance"), 0);
        assert_int_equal(id_at(&l, 10, m, "id.material"), 0);
        // Nothing.
        const char *const zero[] = {"Albedo.R", "N.Z", "Ns.X", "Z", "P.Z", "u"};
        for (int i = 0; i < 6; i++) assert_true(at(&l, 0, m, zero[i]) == 0);
        assert_int_equal(id_at(&l, 0, m, "id.geometry"), 0);
        assert_near(at(&l, 0, m, "R"), 1, 0.5); // few wavelengths: coloured noise
        sag_layers_clear(s.context, &l);
        studio_close(&s);
    }
}

// The picture has the bits that it has without layers, and layers the same for any threads and waves.
static void layers_change_no_bit_of_the_picture(void **state) {
    (void)state;
    for (int filter = 0; filter < 2; filter++) {
        studio s = studio_open(1), t = studio_open(7);
        furnish(&s), furnish(&t);
        s.settings->film.filter = t.settings->film.filter = filter ? SAG_FILTER_SINC : SAG_FILTER_GAUSSIAN;
        sag_layers a = layers_of(&s, 0), b = layers_of(&t, 1);
        const size_t count = (size_t)SIZE * SIZE * a.channel_count;
        assert_memory_equal(a.pixels, b.pixels, count * sizeof(float));
        s.settings->film.layers = 0;
        s.in_color = true;
        sag_render_stats stats;
        sag_image image = studio_render(&s, &stats);
        sag_layers plain = layers_of(&s, 0);
        assert_int_equal(plain.channel_count, 3);
        for (size_t i = 0; i < (size_t)SIZE * SIZE * 3; i++) {
            assert_true(image.pixels[i] == a.pixels[i / 3 * a.channel_count + i % 3]);
            assert_true(image.pixels[i] == plain.pixels[i]);
        }
        sag_image_clear(s.context, &image);
        sag_layers_clear(s.context, &plain);
        sag_layers_clear(s.context, &a), sag_layers_clear(t.context, &b);
        studio_close(&s), studio_close(&t);
    }
}

// Ambient occlusion's samples are 0 or 1: with a mean of p their variance is n/(n − 1) p (1 − p).
static void variance_is_that_of_the_samples(void **state) {
    (void)state;
    studio s = studio_open(0);
    furnish(&s);
    s.settings->integrator = SAG_INTEGRATOR_AO;
    s.settings->samples_per_pixel = 64;
    sag_layers l = layers_of(&s, 0);
    double most = 0;
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            const double p = (double)at(&l, x, y, "R");
            assert_near(at(&l, x, y, "Variance.R"), p * (1 - p) * 64 / 63, 1e-6);
            most = fmax(most, p * (1 - p));
        }
    assert_true(most > 0.2);
    sag_layers_clear(s.context, &l);
    studio_close(&s);
}

static void layers_go_to_one_file(void **state) {
    (void)state;
    studio s = studio_open(2);
    furnish(&s);
    const uint32_t bounds[4] = {3, 30, 7, 20};
    memcpy(s.settings->film.pixel_bounds, bounds, sizeof bounds);
    sag_layers l = layers_of(&s, 0);
    assert_true(l.x == 3 && l.y == 7 && l.width == 27 && l.height == 13 && l.full_width == SIZE);
    char directory[] = "/tmp/sagitta-layers-XXXXXX", path[64];
    assert_non_null(mkdtemp(directory));
    snprintf(path, sizeof path, "%s/layers.exr", directory);
    sag_error error;
    const sag_status status = sag_layers_write(s.context, &l, path, &error);
    if (status == SAG_OK) { // else built without OpenEXR
        sag_image image;
        assert_int_equal(sag_image_read(s.context, path, SAG_ENCODING_LINEAR, &image, &error), SAG_OK);
        assert_true(image.width == 27 && image.height == 13 && image.channels == 3);
        for (size_t i = 0; i < (size_t)27 * 13 * 3; i++)
            assert_true(image.pixels[i] == l.pixels[i / 3 * l.channel_count + i % 3]);
        sag_image_clear(s.context, &image);
        char head[4096] = {0};
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        const size_t size = fread(head, 1, sizeof head, file);
        fclose(file);
        for (uint32_t c = 0; c < l.channel_count; c++) {
            bool found = false;
            const size_t length = strlen(l.names[c]) + 1;
            for (size_t i = 0; i + length <= size && !found; i++)
                found = memcmp(head + i, l.names[c], length) == 0;
            assert_true(found);
        }
    } else {
        assert_int_equal(status, SAG_ERROR_ARGUMENT);
    }
    assert_int_equal(sag_layers_write(s.context, &l, "/tmp/layers.png", &error), SAG_ERROR_ARGUMENT);
    unlink(path);
    rmdir(directory);
    sag_layers_clear(s.context, &l);
    assert_int_equal(sag_layers_write(s.context, &l, path, &error), SAG_ERROR_ARGUMENT);
    studio_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_show_what_is_there),
        cmocka_unit_test(layers_change_no_bit_of_the_picture),
        cmocka_unit_test(variance_is_that_of_the_samples),
        cmocka_unit_test(layers_go_to_one_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
