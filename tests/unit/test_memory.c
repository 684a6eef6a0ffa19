// SPDX-License-Identifier: MIT
// What scenes say they hold is what they hold, to the byte: the context's own count tells.
#include "scene/scene.h"
#include "support/context.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include "support/saved.h"
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static size_t held(void) {
    size_t bytes;
    sag_context_memory(context, &bytes, NULL);
    return bytes;
}

static sag_scene_stats stats_of(const sag_scene *scene) {
    sag_scene_stats stats;
    sag_scene_get_stats(scene, &stats);
    return stats;
}

static void warm_up(void **state) { // the context's threads start, with memory of their own
    (void)state;
    rng r = rng_make(1);
    sag_scene_destroy(random_scene(&r, context, 200, 1));
}

static void whole_of_a_scene(void **state) {
    (void)state;
    rng r = rng_make(2);
    size_t before = held();
    sag_scene *scene = random_scene(&r, context, 100, 1);
    assert_int_equal(stats_of(scene).memory_bytes, held() - before);
    for (int step = 0; step < 40; step++) {
        uint32_t id = rng_below(&r, 100);
        sag_affine map;
        switch (rng_below(&r, 6)) {
        case 0: random_scene_add(&r, scene, (sag_shape_kind)rng_below(&r, SAG_SHAPE_USER), 1); break;
        case 1: sag_geometry_set_enabled(scene, id, rng_one_in(&r, 2)); break;
        case 2: sag_geometry_remove(scene, id); break;
        case 3: sag_geometry_set_update(scene, id, (sag_update)rng_below(&r, 3)); break;
        case 4: sag_geometry_set_transform(scene, id, random_place(&r, 1, &map) ? &map : NULL); break;
        default: {
            sag_sphere ball = {.radius = 1};
            sag_geometry_set_shape(scene, id, SAG_SHAPE_SPHERE, &ball, NULL);
        }
        }
        if (rng_one_in(&r, 2)) assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        assert_int_equal(stats_of(scene).memory_bytes, held() - before);
    }
    assert_int_equal(stats_of(scene).shared_bytes, 0);
    sag_scene_destroy(scene);
    assert_int_equal(held(), before);
}

static void trees_of_many_kinds(void **state) {
    (void)state;
    size_t before = held();
    test_mesh mesh = test_mesh_sphere(4);
    sag_scene *scene = sag_scene_create(context);
    for (int i = 0; i < 6; i++) {
        sag_affine map = sag_affine_translate(sag_vec3_make(i, 0, 0));
        uint32_t id = sag_add_mesh(scene, &mesh.mesh);
        sag_geometry_set_transform(scene, id, &map);
        sag_geometry_set_update(scene, id, (sag_update)(i % 3));
    }
    for (int step = 0; step < 6; step++) {
        assert_int_equal(sag_scene_set_quality(scene, (sag_quality)(step % 3)), SAG_OK);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        sag_scene_stats s = stats_of(scene);
        assert_int_equal(s.memory_bytes, held() - before);
        assert_true(s.geometry_bytes + s.structure_bytes < s.memory_bytes);
        sag_affine map = sag_affine_translate(sag_vec3_make(0, step, 0));
        sag_geometry_set_transform(scene, (uint32_t)step, &map);
    }
    test_mesh_free(&mesh);
    sag_scene_destroy(scene);
    assert_int_equal(held(), before);
}

// Scenes that share scenes: each counts its own, and all together are what is held.
static void scenes_in_scenes(void **state) {
    (void)state;
    rng r = rng_make(3);
    size_t before = held(), sum = 0;
    sag_scene *scenes[4];
    for (int i = 0; i < 4; i++) {
        scenes[i] = sag_scene_create(context);
        for (int k = 0; k < 10; k++) random_scene_add(&r, scenes[i], (sag_shape_kind)k, 1);
        for (int k = 0; k < 5 * i; k++) sag_add_instance(scenes[i], scenes[k % i], NULL);
        assert_int_equal(sag_scene_commit(scenes[i], NULL), SAG_OK);
        assert_true(stats_of(scenes[i]).shared_bytes <= sum);
        sum += stats_of(scenes[i]).memory_bytes;
        assert_int_equal(sum, held() - before);
    }
    // With the scenes below gone, what the last one shows is all there is besides itself: and the cells that
    // its instances reach them by.
    for (int i = 0; i < 3; i++) sag_scene_destroy(scenes[i]);
    sag_scene_stats last = stats_of(scenes[3]);
    assert_int_equal(last.memory_bytes + last.shared_bytes + 3 * sizeof(sagi_cell), held() - before);
    // And so it is in a scene that comes from a file.
    saved file = saved_from(scenes[3], NULL, NULL);
    sag_scene_destroy(scenes[3]);
    assert_int_equal(held(), before);
    sag_scene *loaded = NULL;
    assert_int_equal(saved_read(context, file.bytes, file.count, &loaded, NULL), SAG_OK);
    last = stats_of(loaded);
    assert_int_equal(last.memory_bytes + last.shared_bytes + 3 * sizeof(sagi_cell), held() - before);
    saved_free(&file);
    sag_scene_destroy(loaded);
    assert_int_equal(held(), before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(warm_up),
        cmocka_unit_test(whole_of_a_scene),
        cmocka_unit_test(trees_of_many_kinds),
        cmocka_unit_test(scenes_in_scenes),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
