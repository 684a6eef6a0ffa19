// SPDX-License-Identifier: MIT
// Solids of any number of parts in the short queues of a query: thousands of them at one place, and a kernel
// whose queues are next to nothing, which must give the same bits.
#define SOLID_WAITING 9
#define SOLID_EVENTS  3
#define SOLID_ACTIVE  2
#define SAGI_SIMD_PLAIN
#define SAGI_KERNEL_NAME tight_kernel
#include "kernel/kernel.inl"
#include "scene/scene.h"
#include "support/context.h"
#include "support/random_scene.h"
#include "support/random_solid.h"
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#define MAX_HITS 1024

static void compare(sag_scene *scene, const sag_ray *ray) {
    static sag_hit a[MAX_HITS], b[MAX_HITS];
    const sagi_kernel *usual = scene->kernel;
    sag_hit first;
    size_t count = sag_intersect_all(scene, ray, a, MAX_HITS);
    scene->kernel = &tight_kernel;
    size_t found = sag_intersect_all(scene, ray, b, MAX_HITS);
    bool met = sag_intersect(scene, ray, &first), dark = sag_occluded(scene, ray);
    bool inside = sag_contains(scene, ray->origin);
    scene->kernel = usual;
    assert_int_equal(found, count);
    for (size_t i = 0; i < count && i < MAX_HITS; i++) assert_memory_equal(&a[i], &b[i], sizeof a[i]);
    assert_true(met == (count > 0) && dark == met);
    if (met) assert_memory_equal(&first, &a[0], sizeof first);
    assert_int_equal(inside, sag_contains(scene, ray->origin));
}

static void short_queues(void **state) {
    (void)state;
    rng r = rng_make(3);
    for (int i = 0; i < 60; i++) {
        int levels = i % 3 == 0; // (the slow way within the slow way takes its time)
        uint32_t parts = 1 + rng_below(&r, levels > 0 ? 7 : i % 5 == 0 ? 60 : 16);
        sag_scene *solid = random_solid(&r, context, parts, levels, 1, NULL, NULL);
        assert_non_null(solid);
        for (int k = 0; k < 40; k++) {
            sag_ray ray = random_scene_ray(&r, 1);
            compare(solid, &ray);
        }
        sag_scene_destroy(solid);
    }
}

static sag_scene *solid_of(sag_scene *scene, uint32_t count, sag_solid_operation operation) {
    sag_solid all = {.step_count = count + 1};
    sag_solid_step *steps = malloc((count + 1) * sizeof *steps);
    for (uint32_t i = 0; i < count; i++) steps[i] = (sag_solid_step){SAG_SOLID_PART, i};
    steps[count] = (sag_solid_step){operation, count};
    all.steps = steps;
    assert_int_equal(sag_scene_set_solid(scene, &all, NULL), SAG_OK);
    free(steps);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}

// Balls one within the other, as onions are.
static void thousands_of_skins(void **state) {
    (void)state;
    const uint32_t n = 4000;
    for (int operation = SAG_SOLID_UNION; operation <= SAG_SOLID_XOR; operation++) {
        sag_scene *s = sag_scene_create(context);
        for (uint32_t i = 0; i < n; i++) sag_add_sphere(s, &(sag_sphere){.radius = n - i});
        solid_of(s, n, (sag_solid_operation)operation);
        sag_ray ray = sag_ray_make(sag_vec3_make(-2.0 * n, 0, 0), sag_vec3_make(1, 0, 0));
        sag_hit hits[4];
        size_t count = sag_intersect_all(s, &ray, hits, 4);
        uint32_t outer = operation == SAG_SOLID_INTERSECTION ? n - 1 : 0, inner = n - 1;
        assert_int_equal(count, operation == SAG_SOLID_XOR          ? 2 * n
                                : operation == SAG_SOLID_DIFFERENCE ? 4
                                                                    : 2);
        assert_true(hits[0].geometry == outer && hits[0].t == 2.0 * n - (n - outer) && !hits[0].flipped);
        if (operation == SAG_SOLID_DIFFERENCE) assert_true(hits[1].geometry == 1 && hits[1].flipped);
        if (operation == SAG_SOLID_UNION) assert_true(hits[1].geometry == 0 && hits[1].t == 3.0 * n);
        ray.origin.x = 0; // within all of them
        assert_int_equal(sag_contains(s, ray.origin), operation < SAG_SOLID_DIFFERENCE);
        assert_true(sag_intersect(s, &ray, hits));
        assert_int_equal(hits[0].geometry, operation == SAG_SOLID_XOR            ? inner
                                           : operation == SAG_SOLID_INTERSECTION ? inner
                                           : operation == SAG_SOLID_UNION        ? 0
                                                                                 : 1);
        sag_scene_destroy(s);
    }
}

// The very same ball ten thousand times.
static void ten_thousand_alike(void **state) {
    (void)state;
    const uint32_t n = 10000;
    for (int operation = SAG_SOLID_UNION; operation <= SAG_SOLID_XOR; operation++) {
        sag_scene *s = sag_scene_create(context);
        for (uint32_t i = 0; i < n; i++) sag_add_sphere(s, &(sag_sphere){.radius = 1});
        solid_of(s, n, (sag_solid_operation)operation);
        sag_ray ray = sag_ray_make(sag_vec3_make(-3, 0, 0), sag_vec3_make(1, 0, 0));
        sag_hit hits[4];
        bool something = operation < SAG_SOLID_DIFFERENCE;
        assert_int_equal(sag_intersect_all(s, &ray, hits, 4), something ? 2 : 0);
        // The first enters a union, and leaves an intersection, alone; the other way round it takes all.
        uint32_t last = n - 1;
        if (operation == SAG_SOLID_UNION) assert_true(hits[0].geometry == 0 && hits[1].geometry == last);
        if (operation == SAG_SOLID_INTERSECTION)
            assert_true(hits[0].geometry == last && hits[1].geometry == 0);
        if (something) assert_true(hits[0].t == 2 && hits[1].t == 4);
        sag_scene_destroy(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_queues),
        cmocka_unit_test(thousands_of_skins),
        cmocka_unit_test(ten_thousand_alike),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
