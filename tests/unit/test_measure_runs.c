// SPDX-License-Identifier: MIT
// sag_measure as a call: the same bits whatever the threads, stopping, short memory, options, the points and
// intervals it is made of.
#include "measure/measure.h"
#include "support/context.h"
#include "support/failing_allocator.h"
#include "support/meshes.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// A ball less a box, twice, one of them stretched; a mesh, a set of spheres.
static sag_scene *mixed_scene(sag_context *c) {
    const sag_solid_step steps[] = {{SAG_SOLID_PART, 0}, {SAG_SOLID_PART, 1}, {SAG_SOLID_DIFFERENCE, 2}};
    const float centers[] = {5, 0, 0, 5.5f, 0.5f, 0};
    sag_scene *solid = sag_scene_create(c), *scene = sag_scene_create(c);
    test_mesh cube = test_mesh_cube();
    bool good = solid != NULL && scene != NULL;
    if (good) {
        sag_add_sphere(solid, &(sag_sphere){.radius = 1});
        sag_add_box(solid, &(sag_box){{0, -0.5, -0.25}, {2, 2, 2}});
        good = sag_scene_set_solid(solid, &(sag_solid){steps, 3}, NULL) == SAG_OK &&
               sag_scene_commit(solid, NULL) == SAG_OK;
    }
    if (good) {
        const sag_affine here = sag_affine_identity(), wide = sag_affine_scale(sag_vec3_make(3, 1, 2));
        sag_add_instance(scene, solid, &here);
        sag_add_instance(scene, solid, &wide);
        sag_add_mesh(scene, &cube.mesh);
        sag_add_spheres(scene, &(sag_spheres){.centers_f32 = centers, .radius = 0.6, .count = 2});
        good = sag_scene_commit(scene, NULL) == SAG_OK;
    }
    test_mesh_free(&cube);
    sag_scene_destroy(solid);
    if (good) return scene;
    sag_scene_destroy(scene);
    return NULL;
}

// Loosely, so that a run takes no time.
static const sag_measure_options quick = {.error = 0.05, .seed = 3};

static bool measure(const sag_scene *scene, sag_measurement *m) {
    return sag_measure(scene, &quick, m, NULL) == SAG_OK;
}

static void the_same_bits_whatever_the_threads(void **state) {
    (void)state;
    sag_measurement first = {0};
    sag_context *contexts[3];
    const uint32_t threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        contexts[i] = sag_context_create(&(sag_context_options){.thread_count = threads[i]});
        sag_scene *scene = mixed_scene(contexts[i]);
        sag_measurement m;
        assert_true(scene != NULL && measure(scene, &m));
        assert_int_equal(m.body_count, 4);
        for (size_t k = 0; k < m.body_count; k++) m.bodies[k].shape = NULL; // that of this scene
        if (i == 0) {
            first = m;
        } else {
            assert_memory_equal(m.bodies, first.bodies, m.body_count * sizeof *m.bodies);
            assert_true(m.rays == first.rays);
            sag_measurement_clear(&m);
        }
        sag_scene_destroy(scene);
    }
    assert_int_equal(first.bodies[2].kind, SAG_SHAPE_MESH);
    assert_true(first.bodies[0].by_rays && first.bodies[1].by_rays && first.bodies[3].by_rays);
    sag_measurement_clear(&first);
    for (int i = 0; i < 3; i++) sag_context_destroy(contexts[i]);
}

static void another_seed_other_rays(void **state) {
    (void)state;
    sag_scene *scene = mixed_scene(context);
    sag_measurement a, b;
    sag_measure_options other = quick;
    other.seed++;
    assert_true(measure(scene, &a));
    assert_int_equal(sag_measure(scene, &other, &b, NULL), SAG_OK);
    assert_true(a.bodies[0].volume.value != b.bodies[0].volume.value);
    assert_true(fabs(a.bodies[0].volume.value - b.bodies[0].volume.value) <=
                2 * (a.bodies[0].volume.error + b.bodies[0].volume.error));
    sag_measurement_clear(&a);
    sag_measurement_clear(&b);
    sag_scene_destroy(scene);
}

static bool measure_with(sag_context *c) {
    sag_scene *scene = mixed_scene(c);
    sag_measurement m;
    const bool done = scene != NULL && measure(scene, &m);
    if (done) sag_measurement_clear(&m);
    sag_scene_destroy(scene);
    return done;
}

static void short_memory_is_an_error(void **state) {
    (void)state;
    // Every early allocation, then ever rarer ones: there are some for each task.
    for (size_t k = 0;; k += k < 60 ? 1 : k) {
        failing_allocator books = {.fail_at = k};
        sag_context_options options = {.allocator = failing_allocator_make(&books), .thread_count = 1};
        sag_context *c = sag_context_create(&options);
        const bool done = c != NULL && measure_with(c);
        sag_context_destroy(c);
        failing_allocator_assert_empty(&books);
        if (done) break;
    }
}

static bool stop_at_second(void *user, const sag_measure_progress *p) {
    int *calls = user;
    assert_true(p->body < p->body_count && p->fraction >= 0 && p->fraction <= 1);
    return ++*calls < 2;
}

static void it_can_be_stopped(void **state) {
    (void)state;
    sag_scene *scene = mixed_scene(context);
    int calls = 0;
    sag_measure_options options = {.error = 1e-9, .progress = stop_at_second, .user = &calls};
    sag_measurement m;
    sag_error error;
    assert_int_equal(sag_measure(scene, &options, &m, &error), SAG_ERROR_CANCELLED);
    assert_int_equal(calls, 2);
    // Stopped by a number of rays it says that it did not get there.
    options = (sag_measure_options){.error = 1e-9, .max_rays = 50000, .max_bodies = 3, .no_thickness = true};
    assert_int_equal(sag_measure(scene, &options, &m, &error), SAG_OK);
    assert_int_equal(m.body_count, 3);
    assert_int_equal(m.omitted_count, 1);
    assert_false(m.bodies[0].reached);
    assert_true(m.bodies[0].rays <= 50000 && m.bodies[0].rays > 40000);
    assert_true(m.bodies[2].reached && m.bodies[2].rays == 0);
    sag_measurement_clear(&m);
    sag_scene_destroy(scene);
}

static void wrong_options_are_errors(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_measurement m;
    sag_error error;
    assert_int_equal(sag_measure(scene, NULL, &m, &error), SAG_ERROR_STATE);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    const sag_measure_options wrong[] = {
        {.error = -1}, {.error = 2}, {.error = (double)NAN}, {.confidence = 1}, {.confidence = -0.5}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(sag_measure(scene, &wrong[i], &m, &error), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_measure(scene, NULL, &m, &error), SAG_OK);
    assert_int_equal(m.body_count, 0);
    sag_measurement_clear(&m);
    sag_scene_destroy(scene);
}

// Face forward turns normals towards rays; inside stays inside.
// A thousand times a thousand … of one ball: those beyond max_bodies are counted without a walk to each.
static void a_million_million_bodies_are_counted(void **state) {
    (void)state;
    enum { LEVELS = 7 };
    static const uint64_t wanted[LEVELS + 1] = {
        0, 997, 999997, 999999997, 999999999997, 999999999999997, 999999999999999997, INT64_MAX};
    const sag_affine here = sag_affine_identity();
    const sag_measure_options three = {.max_bodies = 3, .no_thickness = true};
    sag_scene *scene = sag_scene_create(context);
    assert_non_null(scene);
    sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int level = 1; level <= LEVELS; level++) {
        sag_scene *outer = sag_scene_create(context);
        assert_non_null(outer);
        for (int i = 0; i < 1000; i++) assert_int_equal(sag_add_instance(outer, scene, &here), i);
        assert_int_equal(sag_scene_commit(outer, NULL), SAG_OK);
        sag_scene_destroy(scene);
        scene = outer;
        sag_measurement m;
        assert_int_equal(sag_measure(scene, &three, &m, NULL), SAG_OK);
        assert_int_equal(m.body_count, 3);
        assert_true(m.omitted_count == wanted[level]);
        sag_measurement_clear(&m);
    }
    sag_scene_destroy(scene);
}

static void facing_does_not_matter(void **state) {
    (void)state;
    const float centers[] = {0, 0, 0, 1, 0, 0};
    double volumes[2];
    for (int i = 0; i < 2; i++) {
        sag_scene *scene = sag_scene_create(context);
        const uint32_t id =
            sag_add_spheres(scene, &(sag_spheres){.centers_f32 = centers, .radius = 1, .count = 2});
        sag_geometry_set_face_forward(scene, id, i == 1);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        sag_measurement m;
        assert_true(measure(scene, &m));
        volumes[i] = m.bodies[0].volume.value;
        assert_false(m.bodies[0].overlaps || m.bodies[0].inside_out);
        assert_true(fabs(volumes[i] - 2.25 * 3.14159265358979) <= 2 * m.bodies[0].volume.error);
        sag_measurement_clear(&m);
        sag_scene_destroy(scene);
    }
    assert_true(volumes[0] == volumes[1]);
}

// Student's quantiles from the tables (Abramowitz & Stegun 26.10).
static void student_quantiles(void **state) {
    (void)state;
    const struct {
        double confidence, t;
        int freedom;
    } table[] = {{0.5, 1, 1},           {0.95, 12.7062047, 1},  {0.95, 4.30265273, 2},
                 {0.95, 2.57058184, 5}, {0.95, 2.03951345, 31}, {0.99, 2.75000, 30}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        assert_true(fabs(sagi_student_quantile(table[i].confidence, table[i].freedom) - table[i].t) < 1e-5);
}

// Every 2ᵏ points from a multiple of 2ᵏ on, one in each box.
static void points_are_nets(void **state) {
    (void)state;
    enum { LOG = 8, COUNT = 1 << LOG };
    for (uint64_t key = 0; key < 20; key++)
        for (int a = 0; a <= LOG; a++) {
            bool met[COUNT] = {false};
            for (uint64_t i = 0; i < COUNT; i++) {
                const sag_vec2 p = sagi_measure_point(sagi_measure_hash(key, 1, 2), 3 * COUNT + i);
                const int x = (int)ldexp(p.x, a), y = (int)ldexp(p.y, LOG - a);
                assert_true(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
                assert_false(met[x << (LOG - a) | y]);
                met[x << (LOG - a) | y] = true;
            }
        }
}

static void eigenvalues_of_any_size(void **state) {
    (void)state;
    rng r = rng_make(5);
    for (int i = 0; i < 200; i++) {
        const double size = rng_log_uniform(&r, 1e-150, 1e150);
        double a[3][3], values[3];
        sag_vec3 v[3];
        for (int k = 0; k < 3; k++)
            for (int l = 0; l <= k; l++) a[k][l] = a[l][k] = size * rng_uniform(&r, -1, 1);
        sagi_symmetric_eigen(a, values, v);
        assert_true(values[0] <= values[1] && values[1] <= values[2]);
        for (int k = 0; k < 3; k++) {
            const sag_vec3 image = {a[0][0] * v[k].x + a[0][1] * v[k].y + a[0][2] * v[k].z,
                                    a[1][0] * v[k].x + a[1][1] * v[k].y + a[1][2] * v[k].z,
                                    a[2][0] * v[k].x + a[2][1] * v[k].y + a[2][2] * v[k].z};
            const sag_vec3 off = sag_sub(image, sag_scale(v[k], values[k]));
            assert_true(sag_max_component(sag_abs(off)) <= 1e-14 * size);
        }
        assert_true(fabs(sag_dot(v[0], sag_cross(v[1], v[2])) - 1) < 1e-14);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_bits_whatever_the_threads),
        cmocka_unit_test(another_seed_other_rays),
        cmocka_unit_test(short_memory_is_an_error),
        cmocka_unit_test(it_can_be_stopped),
        cmocka_unit_test(wrong_options_are_errors),
        cmocka_unit_test(a_million_million_bodies_are_counted),
        cmocka_unit_test(facing_does_not_matter),
        cmocka_unit_test(student_quantiles),
        cmocka_unit_test(points_are_nets),
        cmocka_unit_test(eigenvalues_of_any_size),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
