// SPDX-License-Identifier: MIT
// Every instruction set gives the same bits as the portable kernel (embree #423, #20): hits, crossings and
// shadows of random and of mean rays through a scene of meshes, curved shapes and instances.
#include "base/cpu.h"
#include "support/random.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 60, MOST = 64 };

// A square net of triangles, wavy, with vertices on round numbers here and there.
static uint32_t add_net(sag_scene *scene) {
    static float p[(SIDE + 1) * (SIDE + 1) * 3];
    static uint32_t t[SIDE * SIDE * 6];
    uint32_t n = 0, m = 0;
    for (int i = 0; i <= SIDE; i++)
        for (int j = 0; j <= SIDE; j++) {
            p[n++] = (float)i / 8 - 3.75f;
            p[n++] = (i + j) % 3 == 0 ? 0 : (float)(0.3 * sin(i) * cos(j));
            p[n++] = (float)j / 8 - 3.75f;
        }
    for (uint32_t i = 0; i < SIDE; i++)
        for (uint32_t j = 0; j < SIDE; j++) {
            uint32_t a = i * (SIDE + 1) + j, b = a + SIDE + 1, corners[6] = {a, a + 1, b, a + 1, b + 1, b};
            for (int k = 0; k < 6; k++) t[m++] = corners[k];
        }
    sag_mesh mesh = {.positions_f32 = p, .vertex_count = n / 3, .triangles = t, .triangle_count = m / 3};
    return sag_add_mesh(scene, &mesh);
}

static sag_scene *make_scene(sag_context *context, sag_scene **child) {
    rng r = rng_make(1);
    *child = sag_scene_create(context);
    add_net(*child);
    for (int i = 0; i < 40; i++) {
        sag_sphere s = {.center = rng_vec3(&r, 4), .radius = rng_log_uniform(&r, 0.01, 1)};
        sag_torus torus = {.major_radius = rng_uniform(&r, 0.1, 1),
                           .minor_radius = rng_uniform(&r, 0.05, 0.5)};
        sag_add_sphere(*child, &s);
        uint32_t id = sag_add_torus(*child, &torus);
        sag_affine place = sag_affine_along(rng_vec3(&r, 4), rng_vec3(&r, 4));
        sag_geometry_set_transform(*child, id, &place);
    }
    sag_error error;
    assert_int_equal(sag_scene_commit(*child, &error), SAG_OK);
    sag_scene *scene = sag_scene_create(context);
    add_net(scene);
    sag_plane floor = {.point = {0, -5, 0}, .normal = {0, 1, 0}};
    sag_add_plane(scene, &floor);
    for (int i = 0; i < 10; i++) {
        sag_affine turn = sag_affine_rotate(rng_uniform(&r, 0, 6), rng_direction(&r)),
                   move = sag_affine_translate(rng_vec3(&r, 9));
        sag_affine both = sag_affine_multiply(&move, &turn);
        sag_add_instance(scene, *child, &both);
    }
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    return scene;
}

static sag_ray random_ray(rng *r) {
    sag_vec3 origin = rng_vec3(r, rng_one_in(r, 4) ? 1e6 : 12), aim = rng_vec3(r, 4);
    if (rng_one_in(r, 3))
        aim = sag_vec3_make(rint(aim.x * 8) / 8, 0, rint(aim.z * 8) / 8); // a vertex of the net
    sag_ray ray = sag_ray_make(origin, sag_sub(aim, origin));
    if (rng_one_in(r, 8)) ray.direction.x = 0;
    if (rng_one_in(r, 16)) ray.origin.x = aim.x, ray.direction = sag_vec3_make(0, -1, 0);
    if (rng_one_in(r, 8)) ray.direction = sag_scale(ray.direction, rng_log_uniform(r, 1e-200, 1e200));
    if (rng_one_in(r, 4)) ray.t_max = rng_uniform(r, 0, 2);
    if (rng_one_in(r, 32)) ray.t_min = -INFINITY;
    return ray;
}

// All but the padding at the end of the struct.
static bool same_hits(const sag_hit *a, const sag_hit *b, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (memcmp(&a[i], &b[i], offsetof(sag_hit, instance_path) + sizeof a->instance_path) != 0)
            return false;
    return true;
}

static void every_instruction_set_gives_the_same_bits(void **state) {
    (void)state;
    sag_context *contexts[SAGI_ISA_COUNT] = {0};
    sag_scene *scenes[SAGI_ISA_COUNT] = {0}, *children[SAGI_ISA_COUNT] = {0};
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        contexts[i] =
            sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i), .thread_count = 2});
        if (contexts[i] == NULL) continue;
        printf("  %s\n", sag_context_isa(contexts[i]));
        scenes[i] = make_scene(contexts[i], &children[i]);
    }
    rng r = rng_make(2);
    size_t met = 0;
    for (size_t k = 0, n = soak(200000); k < n; k++) {
        sag_ray ray = random_ray(&r);
        sag_hit expected[MOST], hits[MOST], nearest;
        size_t all = sag_intersect_all(scenes[SAGI_ISA_PORTABLE], &ray, expected, MOST);
        size_t kept = all < MOST ? all : MOST;
        met += all > 0;
        for (int i = 1; i < SAGI_ISA_COUNT; i++) {
            if (scenes[i] == NULL) continue;
            assert_int_equal(sag_intersect_all(scenes[i], &ray, hits, MOST), all);
            assert_true(same_hits(hits, expected, kept));
            assert_int_equal(sag_occluded(scenes[i], &ray), all > 0);
            assert_int_equal(sag_intersect(scenes[i], &ray, &nearest), all > 0);
            if (all > 0) assert_true(same_hits(&nearest, expected, 1));
        }
    }
    assert_true(met > 1000);
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_scene_destroy(scenes[i]);
        sag_scene_destroy(children[i]);
        sag_context_destroy(contexts[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_instruction_set_gives_the_same_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
