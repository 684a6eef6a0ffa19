// SPDX-License-Identifier: MIT
// The render job: the same bits whatever the threads, cancellations and resumptions; bad samples, bad worlds
// and missing memory.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "support/failing_allocator.h"
#include "support/picture.h"
#include <string.h>

static void threads_do_not_matter(void **state) {
    (void)state;
    const sag_sampler_kind samplers[] = {SAG_SAMPLER_INDEPENDENT, SAG_SAMPLER_STRATIFIED,
                                         SAG_SAMPLER_SOBOL,       SAG_SAMPLER_PADDED_SOBOL,
                                         SAG_SAMPLER_ZSOBOL,      SAG_SAMPLER_HALTON};
    for (int k = 0; k < 6; k++) {
        const uint32_t threads[] = {1, 2, 7};
        studio s[3];
        sag_image images[3];
        sag_render_stats stats[3];
        for (int i = 0; i < 3; i++) {
            s[i] = studio_open(threads[i]);
            studio_furnish(&s[i]);
            s[i].settings->sampler = samplers[k];
            images[i] = studio_render(&s[i], &stats[i]);
        }
        assert_true(same_picture(&images[0], &images[1]) && same_picture(&images[0], &images[2]));
        assert_true(stats[0].rays == stats[1].rays && stats[0].rays == stats[2].rays);
        assert_int_equal(stats[0].camera_samples, 45 * 35 * 7);
        assert_int_equal(stats[0].bad_samples, 0);
        for (int i = 0; i < 3; i++) {
            sag_image_clear(s[i].context, &images[i]);
            studio_close(&s[i]);
        }
    }
}

static void seeds_matter(void **state) {
    (void)state;
    studio s = studio_open(0);
    studio_furnish(&s);
    sag_image first = studio_render(&s, NULL), again = studio_render(&s, NULL);
    s.settings->seed = 1;
    sag_image other = studio_render(&s, NULL);
    assert_true(same_picture(&first, &again));
    assert_false(same_picture(&first, &other));
    sag_image_clear(s.context, &first);
    sag_image_clear(s.context, &again);
    sag_image_clear(s.context, &other);
    studio_close(&s);
}

typedef struct watch {
    int calls, stop_at;
    bool inside;
    sag_progress last;
} watch;

static bool on_progress(void *user, const sag_progress *progress) {
    watch *w = user;
    assert_false(w->inside); // one call at a time
    w->inside = true;
    assert_true(progress->samples_done <= progress->samples_total);
    assert_true(progress->samples_done >= w->last.samples_done && progress->seconds >= w->last.seconds);
    w->last = *progress;
    w->calls++;
    w->inside = false;
    return w->calls != w->stop_at;
}

static void cancelled_and_resumed_is_the_same(void **state) {
    (void)state;
    studio s = studio_open(2);
    studio_furnish(&s);
    s.in_color = true;
    sag_image whole = studio_render(&s, NULL);
    sag_error error;
    sag_render *render = sag_render_create(s.world, &error);
    int cancelled = 0;
    watch w = {.stop_at = 1}; // each run is stopped at its first report
    uint64_t done = 0;
    while (sag_render_run(render, on_progress, &w, &error) == SAG_ERROR_CANCELLED) {
        assert_int_equal(error.status, SAG_ERROR_CANCELLED);
        sag_image image;
        assert_int_equal(sag_render_get_image(render, &image, &error), SAG_OK);
        sag_image_clear(s.context, &image);
        sag_render_stats stats;
        sag_render_get_stats(render, &stats);
        assert_true(stats.camera_samples > done); // it always gets on
        done = stats.camera_samples;
        w.calls = 0;
        cancelled++;
    }
    assert_true(cancelled > 5);
    sag_image pieced;
    assert_int_equal(sag_render_get_image(render, &pieced, &error), SAG_OK);
    assert_true(same_picture(&whole, &pieced));
    // A finished render has nothing left to do.
    assert_int_equal(sag_render_run(render, NULL, NULL, &error), SAG_OK);
    sag_render_stats stats;
    sag_render_get_stats(render, &stats);
    assert_int_equal(stats.camera_samples, 45 * 35 * 7);
    sag_render_destroy(render);
    sag_image_clear(s.context, &whole);
    sag_image_clear(s.context, &pieced);
    studio_close(&s);
}

static void progress_ends_with_all_done(void **state) {
    (void)state;
    studio s = studio_open(2);
    studio_furnish(&s);
    sag_error error;
    sag_render *render = sag_render_create(s.world, &error);
    watch w = {.stop_at = -1};
    assert_int_equal(sag_render_run(render, on_progress, &w, &error), SAG_OK);
    assert_true(w.calls >= 1 && w.last.samples_done == w.last.samples_total);
    assert_int_equal(w.last.samples_total, 45 * 35 * 7);
    sag_render_destroy(render);
    studio_close(&s);
}

// pbrt #134: one NaN must not spoil a picture, nor end a render.
static void bad_samples_are_counted_and_dropped(void **state) {
    (void)state;
    studio s = studio_open(2);
    sag_light light = {.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}};
    sag_error error;
    assert_int_equal(sag_image_create(s.context, 8, 8, 3, &light.image, &error), SAG_OK);
    for (int i = 0; i < 8 * 8 * 3; i++) light.image.pixels[i] = i % 2 ? 1 : NAN;
    light.image.pixels[7] = INFINITY;
    assert_int_not_equal(sag_world_add_light(s.world, &light), 0);
    sag_add_sphere(s.scene, &(sag_sphere){.radius = 1});
    sag_render_stats stats;
    sag_image image = studio_render(&s, &stats);
    assert_true(stats.bad_samples > 0 && stats.bad_samples <= stats.camera_samples);
    for (size_t i = 0; i < 32 * 32 * 3; i++) assert_true(isfinite(image.pixels[i]));
    sag_image_clear(s.context, &image);
    // The first of them are told, in order, and each can be shot again by itself.
    assert_int_equal(stats.bad_told, SAG_BAD_SAMPLES);
    for (int i = 1; i < SAG_BAD_SAMPLES; i++) {
        const sag_bad_sample a = stats.bad[i - 1], b = stats.bad[i];
        assert_true(a.y < b.y || (a.y == b.y && (a.x < b.x || (a.x == b.x && a.sample < b.sample))));
    }
    const sag_bad_sample last = stats.bad[SAG_BAD_SAMPLES - 1];
    uint32_t of_its_pixel = 0;
    for (int i = 0; i < SAG_BAD_SAMPLES; i++)
        of_its_pixel += stats.bad[i].x == last.x && stats.bad[i].y == last.y;
    const uint32_t bounds[4] = {last.x, last.x + 1, last.y, last.y + 1};
    memcpy(s.settings->film.pixel_bounds, bounds, sizeof bounds);
    image = studio_render(&s, &stats);
    assert_true(image.width == 1 && image.height == 1 && stats.bad_samples >= of_its_pixel);
    assert_true(stats.bad[of_its_pixel - 1].x == last.x && stats.bad[of_its_pixel - 1].y == last.y &&
                stats.bad[of_its_pixel - 1].sample == last.sample);
    sag_image_clear(s.context, &image);
    studio_close(&s);
}

static void shown_values(void **state) {
    (void)state;
    // The ball of radius 1 in the middle of the picture, from 8 away: its nearest point.
    const sag_integrator_kind kinds[] = {SAG_INTEGRATOR_DEPTH,  SAG_INTEGRATOR_NORMAL, SAG_INTEGRATOR_AO,
                                         SAG_INTEGRATOR_ALBEDO, SAG_INTEGRATOR_UV,     SAG_INTEGRATOR_ID};
    for (int k = 0; k < 6; k++) {
        studio s = studio_open(0);
        sag_add_sphere(s.scene, &(sag_sphere){.radius = 1});
        sag_vec3 eye = {0, 0, 8}, target = {0, 0, 0};
        studio_aim_point(&s, eye, target);
        s.settings->integrator = kinds[k];
        studio_mean m = studio_measure(&s);
        if (k == 0) assert_true(fabs(m.mean - 7) < 1e-6);
        if (k == 1) assert_true(fabs(m.mean - 0.5) < 1e-6);
        if (k == 2) assert_true(m.mean == 1);
        if (k == 3) assert_true(m.mean == 0.5);
        if (k > 3) assert_true(m.least >= 0 && m.most <= 1);
        studio_aim_point(&s, eye, sag_vec3_make(4, 0, 0)); // past the ball
        assert_true(studio_measure(&s).most == 0);
        studio_close(&s);
    }
}

static void depth_counts_bounces(void **state) {
    (void)state;
    // A shining white floor under nothing: depth 0 sees the shine only, further bounces add nothing but the
    // sky's light.
    const uint32_t depths[] = {0, 1, 2};
    for (int i = 0; i < 3; i++) {
        studio s = studio_open(0);
        uint32_t floor_id = sag_add_plane(s.scene, &(sag_plane){.point = {0, 0, -1}, .normal = {0, 0, 1}});
        sag_world_set_appearance(s.world, s.scene, floor_id, &(sag_appearance){.emission = {2, 2, 2}});
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
        s.settings->max_depth = depths[i];
        studio_mean m = studio_measure(&s);
        assert_true(fabs(m.mean - (i == 0 ? 2 : 2.5)) < 1e-6);
        studio_close(&s);
    }
}

static void impossible_worlds_are_errors(void **state) {
    (void)state;
    sag_error error;
    studio s = studio_open(1);
    s.settings->samples_per_pixel = 0;
    assert_null(sag_render_create(s.world, &error));
    assert_int_equal(error.status, SAG_ERROR_ARGUMENT);
    s.settings->samples_per_pixel = 1;
    s.settings->film.width = 0;
    assert_null(sag_render_create(s.world, &error));
    s.settings->film.width = 8;
    uint32_t bad = sag_add_sphere(s.scene, &(sag_sphere){.radius = -1});
    assert_int_equal(bad, SAG_INVALID_ID);
    assert_null(sag_render_create(s.world, &error));
    assert_int_equal(error.status, SAG_ERROR_GEOMETRY);
    // A texture that does not exist, or too many on top of each other; a material or geometry that does not.
    sag_texture scale = {.kind = SAG_TEXTURE_SCALE, .a.texture = 5};
    assert_int_equal(sag_world_add_texture(s.world, &scale), 0);
    scale.a.texture = 0;
    uint32_t levels = 0;
    while ((scale.a.texture = sag_world_add_texture(s.world, &scale)) != 0) levels++;
    assert_int_equal(levels, 32);
    sag_material material = {.reflectance.texture = 77};
    assert_int_equal(sag_world_add_material(s.world, &material), 0);
    sag_appearance look = {.material = 3};
    assert_int_equal(sag_world_set_appearance(s.world, s.scene, 0, &look), SAG_ERROR_ARGUMENT);
    look.material = 0;
    assert_int_equal(sag_world_set_appearance(s.world, s.scene, 99, &look), SAG_ERROR_ARGUMENT);
    studio_close(&s);
    const sag_light lights[] = {
        {.kind = SAG_LIGHT_POINT, .color = {NAN, 0, 0}},
        {.kind = SAG_LIGHT_POINT, .color = {-1, 0, 0}},
        {.kind = SAG_LIGHT_POINT, .from = {INFINITY, 0, 0}},
        {.kind = SAG_LIGHT_DISTANT, .color = {1, 1, 1}},
        {.kind = SAG_LIGHT_SPOT, .to = {0, 0, 1}, .cone_rad = 1, .cone_delta_rad = 2},
    };
    for (int i = 0; i < 5; i++) {
        s = studio_open(1);
        sag_world_add_light(s.world, &lights[i]);
        assert_null(sag_render_create(s.world, &error));
        assert_int_equal(error.status, SAG_ERROR_ARGUMENT);
        studio_close(&s);
    }
}

// The whole way with a given allocator; false when memory ran out somewhere.
static bool render_with(sag_context *context) {
    sag_error error = {.status = SAG_OK};
    studio s = {.context = context, .world = sag_world_create(context)};
    if (!s.world) return false;
    s.scene = sag_world_scene(s.world);
    s.settings = sag_world_settings(s.world);
    s.settings->camera.to_world = sag_affine_translate(sag_vec3_make(0, 0, -8));
    studio_furnish(&s);
    s.settings->film.width = s.settings->film.height = 8;
    s.settings->samples_per_pixel = 1;
    sag_texture texture = {.kind = SAG_TEXTURE_IMAGE};
    bool done = sag_image_create(context, 2, 2, 3, &texture.image, &error) == SAG_OK &&
                sag_world_add_texture(s.world, &texture) != 0;
    sag_render *render = sag_render_create(s.world, &error);
    sag_image image = {0};
    done = done && render && sag_render_run(render, NULL, NULL, &error) == SAG_OK &&
           sag_render_get_image(render, &image, &error) == SAG_OK && s.settings->max_depth == 5;
    sag_image_clear(context, &image);
    sag_render_destroy(render);
    sag_world_destroy(s.world);
    return done;
}

static void running_out_of_memory_is_an_error(void **state) {
    (void)state;
    bool reached_the_end = false;
    for (size_t k = 0; k < 1000 && !reached_the_end; k++) {
        failing_allocator books = {.fail_at = k};
        sag_context *context = sag_context_create(
            &(sag_context_options){.allocator = failing_allocator_make(&books), .thread_count = 1});
        if (context) render_with(context);
        reached_the_end = atomic_load(&books.calls) <= k;
        sag_context_destroy(context);
        failing_allocator_assert_empty(&books);
    }
    assert_true(reached_the_end);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(seeds_matter),
        cmocka_unit_test(cancelled_and_resumed_is_the_same),
        cmocka_unit_test(progress_ends_with_all_done),
        cmocka_unit_test(bad_samples_are_counted_and_dropped),
        cmocka_unit_test(shown_values),
        cmocka_unit_test(depth_counts_bounces),
        cmocka_unit_test(impossible_worlds_are_errors),
        cmocka_unit_test(running_out_of_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
