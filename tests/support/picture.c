// SPDX-License-Identifier: MIT
#include "support/picture.h"
#include "support/guarded_memory.h"

#include "render/job.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

studio studio_open(uint32_t thread_count) {
    studio s = {.in_color = false};
    s.context = sag_context_create(
        &(sag_context_options){.thread_count = thread_count, .allocator = guarded_if_asked()});
    s.world = sag_world_create(s.context);
    assert_non_null(s.world);
    s.scene = sag_world_scene(s.world);
    s.settings = sag_world_settings(s.world);
    s.settings->film.width = s.settings->film.height = 32;
    s.settings->samples_per_pixel = 16;
    s.settings->camera.fov_rad = 0.4;
    s.settings->max_depth = 100;
    sag_vec3 eye = {0, 0, 8}, target = {0, 0, 0};
    studio_aim(&s, eye, target);
    return s;
}

void studio_close(studio *s) {
    sag_world_destroy(s->world);
    sag_context_destroy(s->context);
}

void studio_aim(studio *s, sag_vec3 eye, sag_vec3 target) {
    sag_vec3 up = {0, 1, 0};
    s->settings->camera.to_world = sag_camera_look_at(eye, target, up);
}

void studio_aim_point(studio *s, sag_vec3 eye, sag_vec3 target) {
    studio_aim(s, eye, target);
    s->settings->camera.kind = SAG_CAMERA_ORTHOGRAPHIC;
    const double tiny = 1e-9;
    s->settings->camera.screen_window[0] = s->settings->camera.screen_window[2] = -tiny;
    s->settings->camera.screen_window[1] = s->settings->camera.screen_window[3] = tiny;
}

uint32_t studio_material(studio *s, sag_material material) {
    uint32_t id = sag_world_add_material(s->world, &material);
    assert_int_not_equal(id, 0);
    return id;
}

// Wavelengths all alike, and a sensor that undoes white's spectrum: a sample of white sums up to 4 · ¼.
static void see_white_alike(sag_render *render) {
    const int span = SAGI_WAVELENGTH_MAX - SAGI_WAVELENGTH_MIN;
    for (int i = 0; i <= SAGI_WAVELENGTH_STEPS; i++)
        render->wavelengths.lambda[i] =
            (float)(SAGI_WAVELENGTH_MIN + (double)span * i / SAGI_WAVELENGTH_STEPS);
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const float value = 1 / (span * sagi_color_spaces[SAG_COLOR_SRGB].illuminant[i]);
        render->sensor.response[i] = (sagi_spectrum){value, value, value, 0};
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) render->sensor.output[i][k] = i == k;
}

sag_image studio_render(studio *s, sag_render_stats *stats) {
    sag_error error = {.status = SAG_OK};
    sag_image image;
    sag_render *render = sag_render_create(s->world, &error);
    if (!render) print_message("%s\n", error.message);
    assert_non_null(render);
    if (!s->in_color) see_white_alike(render);
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_int_equal(sag_render_get_image(render, &image, &error), SAG_OK);
    if (stats) sag_render_get_stats(render, stats);
    sag_render_destroy(render);
    return image;
}

bool same_picture(const sag_image *a, const sag_image *b) {
    assert_true(a->width == b->width && a->height == b->height);
    return memcmp(a->pixels, b->pixels, (size_t)a->width * a->height * 3 * sizeof(float)) == 0;
}

studio_mean studio_measure(studio *s) {
    sag_image image = studio_render(s, NULL);
    size_t count = (size_t)image.width * image.height;
    double sum = 0, squares = 0;
    studio_mean result = {.least = INFINITY, .most = -INFINITY};
    for (size_t i = 0; i < count; i++) {
        double value = image.pixels[3 * i];
        sum += value;
        squares += value * value;
        result.least = fmin(result.least, value);
        result.most = fmax(result.most, value);
    }
    result.mean = sum / (double)count;
    result.deviation = sqrt(fmax(0, squares / (double)count - result.mean * result.mean) / (double)count);
    sag_image_clear(s->context, &image);
    return result;
}

void studio_furnish(studio *s) {
    s->settings->film.width = 45, s->settings->film.height = 35;
    s->settings->samples_per_pixel = 7;
    s->settings->max_depth = 5;
    s->settings->film.filter = SAG_FILTER_GAUSSIAN;
    sag_add_plane(s->scene, &(sag_plane){.point = {0, -1, 0}, .normal = {0, 1, 0}});
    uint32_t ball = sag_add_sphere(s->scene, &(sag_sphere){.radius = 1});
    uint32_t lamp = sag_add_sphere(s->scene, &(sag_sphere){.center = {3, 4, 3}, .radius = 1});
    uint32_t glass = sag_world_add_material(
        s->world, &(sag_material){.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.5, 0, 0}});
    sag_world_set_appearance(s->world, s->scene, ball, &(sag_appearance){.material = glass});
    sag_world_set_appearance(s->world, s->scene, lamp, &(sag_appearance){.emission = {5, 4, 3}});
    sag_world_add_light(s->world, &(sag_light){.kind = SAG_LIGHT_SKY, .color = {0.3, 0.4, 0.6}});
}
