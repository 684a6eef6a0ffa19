// SPDX-License-Identifier: MIT
// Paths followed together get the light that each gets alone: the same bits for waves of one path (each then
// traced to its end before the next is begun) as for any other size, on any number of threads.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/job.h"
#include "support/failing_allocator.h"
#include "support/picture.h"

#define SAMPLES 7

// Mirrors, glass, plastic and a lamp under the sky; with `veiled` behind a chequered veil with holes, in a
// case of nothing.
static void furnish(studio *s, bool veiled) {
    s->settings->film.width = 29, s->settings->film.height = 21;
    s->settings->samples_per_pixel = SAMPLES;
    s->settings->max_depth = 6;
    s->settings->camera.lens_radius = 0.05, s->settings->camera.focal_distance = 8;
    s->settings->regularize = true;
    const sag_material materials[] = {
        {.kind = SAG_MATERIAL_DIELECTRIC, .eta.value = {1.5, 0, 0}},
        {.kind = SAG_MATERIAL_CONDUCTOR, .reflectance.value = {0.9, 0.8, 0.7}},
        {.kind = SAG_MATERIAL_COATED_DIFFUSE,
         .reflectance.value = {0.2, 0.5, 0.3},
         .roughness_u.value = {0.1, 0.1, 0.1},
         .roughness_v.value = {0.1, 0.1, 0.1}},
    };
    sag_add_plane(s->scene, &(sag_plane){.point = {0, -1, 0}, .normal = {0, 1, 0}});
    for (int i = 0; i < 3; i++) {
        uint32_t ball =
            sag_add_sphere(s->scene, &(sag_sphere){.center = {1.1 * i - 1.1, 0, 0}, .radius = 0.5});
        sag_world_set_appearance(s->world, s->scene, ball,
                                 &(sag_appearance){.material = studio_material(s, materials[i])});
    }
    uint32_t lamp = sag_add_sphere(s->scene, &(sag_sphere){.center = {3, 4, 3}, .radius = 1});
    sag_world_set_appearance(s->world, s->scene, lamp, &(sag_appearance){.emission = {5, 4, 3}});
    sag_world_add_light(s->world, &(sag_light){.kind = SAG_LIGHT_SKY, .color = {0.3, 0.4, 0.6}});
    sag_world_add_light(s->world,
                        &(sag_light){.kind = SAG_LIGHT_POINT, .color = {9, 9, 9}, .from = {-3, 3, 3}});
    if (!veiled) return;
    sag_texture holes = {
        .kind = SAG_TEXTURE_CHECKERBOARD, .b.value = {1, 1, 1}, .mapping = {.u_scale = 20, .v_scale = 20}};
    uint32_t veil = sag_add_rectangle(
        s->scene, &(sag_rectangle){.corner = {-2, -2, 1}, .edge_u = {4, 0, 0}, .edge_v = {0, 4, 0}});
    sag_world_set_appearance(s->world, s->scene, veil,
                             &(sag_appearance){.alpha.texture = sag_world_add_texture(s->world, &holes)});
    uint32_t nothing = studio_material(s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
    uint32_t box = sag_add_box(s->scene, &(sag_box){.min = {-2, -1, -2}, .max = {2, 2, 2}});
    sag_world_set_appearance(s->world, s->scene, box, &(sag_appearance){.material = nothing});
}

static sag_image render_in_waves(studio *s, uint32_t wave_size, sag_render_stats *stats) {
    sag_error error;
    sag_image image;
    sag_render *render = sag_render_create(s->world, &error);
    assert_non_null(render);
    render->wave_size = wave_size;
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_int_equal(sag_render_get_image(render, &image, &error), SAG_OK);
    sag_render_get_stats(render, stats);
    sag_render_destroy(render);
    return image;
}

static void waves_change_no_bit(void **state) {
    (void)state;
    const sag_integrator_kind integrators[] = {SAG_INTEGRATOR_PATH, SAG_INTEGRATOR_DIRECT, SAG_INTEGRATOR_AO,
                                               SAG_INTEGRATOR_DEPTH, SAG_INTEGRATOR_LIGHTPATH};
    const struct {
        uint32_t wave_size, threads;
    } ways[] = {{7, 1}, {SAGI_WAVE_SIZE, 1}, {SAGI_WAVE_SIZE, 2}, {SAGI_WAVE_SIZE, 3}, {1, 3}};
    for (int k = 0; k < 5; k++) {
        for (int veiled = 0; veiled < 2; veiled++) {
            studio alone = studio_open(1);
            furnish(&alone, veiled);
            alone.settings->integrator = integrators[k];
            sag_render_stats expected_stats, stats;
            sag_image expected = render_in_waves(&alone, 1, &expected_stats);
            for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
                studio s = studio_open(ways[i].threads);
                furnish(&s, veiled);
                s.settings->integrator = integrators[k];
                sag_image image = render_in_waves(&s, ways[i].wave_size, &stats);
                assert_true(same_picture(&expected, &image));
                assert_true(stats.rays == expected_stats.rays);
                sag_image_clear(s.context, &image);
                studio_close(&s);
            }
            sag_image_clear(alone.context, &expected);
            studio_close(&alone);
        }
    }
}

// More surfaces that are not there than any ray may pass: it ends somewhere, with the light from far away.
static void no_ray_passes_without_end(void **state) {
    (void)state;
    studio s = studio_open(1);
    sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
    uint32_t nothing = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_INTERFACE});
    for (int i = 0; i < 10100; i++) {
        uint32_t pane = sag_add_rectangle(
            s.scene,
            &(sag_rectangle){.corner = {-1, -1, -0.01 * i}, .edge_u = {2, 0, 0}, .edge_v = {0, 2, 0}});
        sag_world_set_appearance(s.world, s.scene, pane, &(sag_appearance){.material = nothing});
    }
    studio_aim_point(&s, sag_vec3_make(0, 0, 8), sag_vec3_make(0, 0, 0));
    s.settings->film.width = s.settings->film.height = 1;
    s.settings->samples_per_pixel = 1;
    sag_render_stats stats;
    sag_image image = studio_render(&s, &stats);
    assert_int_equal(stats.rays, 10000);
    assert_true(image.pixels[0] == 1);
    sag_image_clear(s.context, &image);
    studio_close(&s);
}

// All memory is had when the render is made; running it takes no more.
static void running_allocates_nothing(void **state) {
    (void)state;
    failing_allocator books = {.fail_at = NEVER};
    sag_context *context = sag_context_create(
        &(sag_context_options){.allocator = failing_allocator_make(&books), .thread_count = 2});
    studio s = {.context = context, .world = sag_world_create(context)};
    s.scene = sag_world_scene(s.world);
    s.settings = sag_world_settings(s.world);
    furnish(&s, true);
    sag_error error;
    sag_render *render = sag_render_create(s.world, &error);
    assert_non_null(render);
    books.fail_at = atomic_load(&books.calls);
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    assert_true(atomic_load(&books.calls) == books.fail_at);
    sag_render_destroy(render);
    sag_world_destroy(s.world);
    sag_context_destroy(context);
    failing_allocator_assert_empty(&books);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waves_change_no_bit),
        cmocka_unit_test(no_ray_passes_without_end),
        cmocka_unit_test(running_allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
