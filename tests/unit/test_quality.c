// SPDX-License-Identifier: MIT
// Every quality of the acceleration structure gives the same bits, keeps the depth cap whatever the input,
// does not depend on the number of threads, and survives running out of memory.
#include "scene/scene.h"
#include "support/context.h"
#include "support/failing_allocator.h"
#include "support/meshes.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const sag_quality qualities[] = {SAG_QUALITY_DEFAULT, SAG_QUALITY_FAST, SAG_QUALITY_HIGH};
enum { QUALITIES = 3, MOST_HITS = 256 };

static sag_scene *commit(sag_context *c, sag_quality quality, const sag_mesh *mesh) {
    sag_scene *scene = sag_scene_create(c);
    if (scene == NULL) return NULL;
    sag_scene_set_quality(scene, quality);
    sag_add_mesh(scene, mesh);
    if (sag_scene_commit(scene, NULL) == SAG_OK) return scene;
    sag_scene_destroy(scene);
    return NULL;
}

static void assert_same_hits(const sag_hit *a, const sag_hit *b, size_t count) {
    for (size_t i = 0; i < count; i++) assert_memory_equal(&a[i], &b[i], sizeof a[i]);
}

// A ray's answers from two scenes.
static void compare_ray(const sag_scene *a, const sag_scene *b, const sag_ray *ray) {
    static sag_hit of_a[MOST_HITS], of_b[MOST_HITS];
    const size_t capacities[] = {0, 1, 3, MOST_HITS};
    sag_hit hit_a, hit_b;
    memset(&hit_a, 0, sizeof hit_a), memset(&hit_b, 0, sizeof hit_b);
    assert_int_equal(sag_intersect(a, ray, &hit_a), sag_intersect(b, ray, &hit_b));
    assert_same_hits(&hit_a, &hit_b, 1);
    assert_int_equal(sag_occluded(a, ray), sag_occluded(b, ray));
    size_t count = sag_count_crossings(a, ray);
    // (Where a hundred thousand cross, each question takes its time.)
    for (size_t c = count < 50000 ? 0 : 3; c < sizeof capacities / sizeof *capacities; c++) {
        assert_int_equal(sag_intersect_all(a, ray, of_a, capacities[c]), count);
        assert_int_equal(sag_intersect_all(b, ray, of_b, capacities[c]), count);
        assert_same_hits(of_a, of_b, count < capacities[c] ? count : capacities[c]);
    }
}

static void compare_point(const sag_scene *a, const sag_scene *b, sag_vec3 point) {
    sag_closest of_a, of_b;
    memset(&of_a, 0, sizeof of_a), memset(&of_b, 0, sizeof of_b);
    assert_int_equal(sag_contains(a, point), sag_contains(b, point));
    assert_int_equal(sag_closest_point(a, point, INFINITY, &of_a),
                     sag_closest_point(b, point, INFINITY, &of_b));
    assert_memory_equal(&of_a, &of_b, sizeof of_a);
}

static sag_vec3 in_box(rng *r, const sag_box3 *box) {
    return sag_vec3_make(rng_uniform(r, box->min.x, box->max.x), rng_uniform(r, box->min.y, box->max.y),
                         rng_uniform(r, box->min.z, box->max.z));
}

// A point of the mesh, or near it.
static sag_vec3 on_mesh(rng *r, const sag_mesh *mesh) {
    const uint32_t *t = mesh->triangles + 3 * (size_t)rng_below(r, mesh->triangle_count);
    double w[3] = {rng_unit(r), rng_unit(r), rng_unit(r)}, sum = w[0] + w[1] + w[2];
    sag_vec3 p = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        const double *v = mesh->positions_f64 + 3 * (size_t)t[k];
        p = sag_madd(p, w[k] / sum, sag_vec3_make(v[0], v[1], v[2]));
    }
    return p;
}

static void compare_qualities(const sag_mesh *mesh, size_t rays) {
    rng r = rng_make(mesh->triangle_count);
    sag_scene *scenes[QUALITIES];
    for (int q = 0; q < QUALITIES; q++) {
        scenes[q] = commit(context, qualities[q], mesh);
        assert_non_null(scenes[q]);
        sag_scene_stats stats;
        sag_scene_get_stats(scenes[q], &stats);
        assert_true(stats.depth <= SAGI_BVH_MAX_DEPTH + 1);
    }
    sag_box3 box = sag_scene_bounds(scenes[0]);
    double size = sag_length(sag_sub(box.max, box.min));
    for (size_t i = 0, n = soak(rays); i < n; i++) {
        sag_vec3 target = on_mesh(&r, mesh), origin = in_box(&r, &box);
        if (rng_one_in(&r, 2))
            origin = sag_madd(target, rng_log_uniform(&r, 1, 1e6) * size, rng_direction(&r));
        sag_ray ray = sag_ray_make(origin, sag_sub(target, origin));
        for (int q = 1; q < QUALITIES; q++) {
            compare_ray(scenes[0], scenes[q], &ray);
            if (mesh->triangle_count < 50000) // a point looks at all that is equally near
                compare_point(scenes[0], scenes[q], i % 2 ? origin : in_box(&r, &box));
        }
    }
    for (int q = 0; q < QUALITIES; q++) sag_scene_destroy(scenes[q]);
}

// `count` loose triangles; corner says where they are.
static test_mesh loose(rng *r, uint32_t count, sag_vec3 (*corner)(rng *r, uint32_t triangle, int k)) {
    test_mesh m = {.positions = malloc(9 * (size_t)count * sizeof *m.positions),
                   .triangles = malloc(3 * (size_t)count * sizeof *m.triangles)};
    for (uint32_t i = 0; i < 3 * count; i++) {
        sag_vec3 p = corner(r, i / 3, (int)(i % 3));
        m.positions[3 * i] = p.x, m.positions[3 * i + 1] = p.y, m.positions[3 * i + 2] = p.z;
        m.triangles[i] = i;
    }
    m.mesh = (sag_mesh){.positions_f64 = m.positions,
                        .triangles = m.triangles,
                        .vertex_count = 3 * count,
                        .triangle_count = count};
    return m;
}

static void compare_loose(uint32_t count, size_t rays, sag_vec3 (*corner)(rng *r, uint32_t triangle, int k)) {
    rng r = rng_make(count);
    test_mesh m = loose(&r, count, corner);
    compare_qualities(&m.mesh, rays);
    test_mesh_free(&m);
}

static sag_vec3 anywhere(rng *r, uint32_t triangle, int k) {
    (void)triangle, (void)k;
    return rng_vec3(r, 1);
}
// Wires: corner 2 is near corner 1, far from corner 0.
static sag_vec3 wire(rng *r, uint32_t triangle, int k) {
    rng own = rng_make(triangle);
    sag_vec3 p = rng_vec3(&own, 1);
    return k == 0 ? p : sag_madd(rng_vec3(&own, 1), 1e-3, rng_vec3(r, 1));
}
static sag_vec3 same(rng *r, uint32_t triangle, int k) {
    (void)r, (void)triangle;
    return sag_vec3_make(k == 0, k == 1, k == 2);
}
static sag_vec3 one_centroid(rng *r, uint32_t triangle, int k) {
    (void)triangle;
    static double x;
    if (k == 0) x = rng_unit(r);
    return sag_vec3_make(k == 0 ? x : -x, k == 1 ? x : -x, k == 2 ? x : -x);
}
static sag_vec3 line_of_slivers(rng *r, uint32_t triangle, int k) {
    (void)r;
    return sag_vec3_make(triangle + 0.5 * (k == 2), 1e-6 * (k == 1), k == 2 ? 1e-9 : 0);
}
// Ever smaller towards a corner, so that splitting off one after the other is what a heuristic likes best.
static sag_vec3 progression(rng *r, uint32_t triangle, int k) {
    (void)r;
    double size = ldexp(1, -(int)(triangle % 120));
    return sag_vec3_make(size * (1 + 0.4 * (k == 1)), size * (1 + 0.4 * (k == 2)), size);
}
// A crowd too dense for one curve, and a few who stand far off.
static sag_vec3 crowd(rng *r, uint32_t triangle, int k) {
    (void)k;
    if (triangle % 500 == 0) return rng_vec3(r, 1e6);
    return sag_add(sag_vec3_make(1, 2, 3), rng_vec3(r, triangle % 3 == 0 ? 1e-3 : 1));
}

static void meshes(void **state) {
    (void)state;
    test_mesh sphere = test_mesh_sphere(5), torus = test_mesh_torus(90, 60);
    compare_qualities(&sphere.mesh, 300);
    compare_qualities(&torus.mesh, 300);
    test_mesh_free(&sphere), test_mesh_free(&torus);
}

static void few(void **state) {
    (void)state;
    const uint32_t counts[] = {1, 2, 7, 8, 9, 16, 17, 255, 256, 257};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        compare_loose(counts[i], 40, anywhere);
        compare_loose(counts[i], 40, wire);
        compare_loose(counts[i], 10, same);
        compare_loose(counts[i], 10, line_of_slivers);
    }
}

static void wires(void **state) {
    (void)state;
    compare_loose(5000, 300, wire);
}

// A bundle of needles side by side, along the diagonal of a cube, so that their boxes are much the same until
// space is split; and nine specks of dust for each, which leave references to split with.
static sag_vec3 bundle(rng *r, uint32_t triangle, int k) {
    if (triangle % 10 != 0) return sag_madd(sag_vec3_make(2, triangle * 1e-3, 0), 1e-3, rng_vec3(r, 1));
    double x = k == 0 ? -1 : 1, shift = triangle * 1e-4;
    return sag_vec3_make(x + shift, x - shift, x + (k == 2 ? 0.01 : 0));
}
// Through all of the needles (at from −1 to 1).
static sag_ray across(double at) {
    return sag_ray_make(sag_vec3_make(at - 2, at + 2, at + 0.002), sag_vec3_make(1, -1, 0));
}

static test_mesh needles(uint32_t count) {
    rng r = rng_make(1);
    return loose(&r, count, bundle);
}

// More crossings of primitives in several leaves than a walk keeps.
static void many_crossings_of_split_triangles(void **state) {
    (void)state;
    enum { NEEDLES = 600 };
    test_mesh mesh = needles(10 * NEEDLES);
    sag_scene *split = commit(context, SAG_QUALITY_HIGH, &mesh.mesh);
    sag_scene *plain = commit(context, SAG_QUALITY_DEFAULT, &mesh.mesh);
    assert_true(sagi_scene_snapshot(split)->world.tree.repeats);
    assert_false(sagi_scene_snapshot(plain)->world.tree.repeats);
    for (int i = 0; i < 20; i++) {
        sag_ray ray = across(0.04 * i);
        size_t count = sag_count_crossings(split, &ray);
        assert_true(count > SAGI_REPEATS_KEPT && count <= NEEDLES);
        compare_ray(plain, split, &ray);
        static sag_hit hits[NEEDLES], expected[NEEDLES];
        assert_int_equal(sag_intersect_all(plain, &ray, expected, NEEDLES), count);
        assert_int_equal(sag_intersect_all(split, &ray, hits, NEEDLES), count);
        assert_same_hits(hits, expected, count);
    }
    sag_scene_destroy(split), sag_scene_destroy(plain);
    test_mesh_free(&mesh);
}

// Split triangles in instances, side by side with other shapes and with themselves.
static void split_triangles_in_instances(void **state) {
    (void)state;
    rng r = rng_make(5);
    test_mesh mesh = needles(3000);
    sag_affine shift = sag_affine_identity();
    shift.m[2][3] = 0.05;
    sag_scene *parents[2];
    for (int q = 0; q < 2; q++) {
        sag_scene *child = commit(context, q == 0 ? SAG_QUALITY_DEFAULT : SAG_QUALITY_HIGH, &mesh.mesh);
        parents[q] = sag_scene_create(context);
        sag_add_instance(parents[q], child, NULL);
        sag_add_instance(parents[q], child, &shift);
        sag_add_instance(parents[q], child, NULL);
        sag_sphere sphere = {.center = {0, 0, 0.1}, .radius = 0.1};
        sag_add_sphere(parents[q], &sphere);
        sag_add_mesh(parents[q], &mesh.mesh);
        sag_scene_set_quality(parents[q], SAG_QUALITY_FAST);
        assert_int_equal(sag_scene_commit(parents[q], NULL), SAG_OK);
        sag_scene_destroy(child);
    }
    for (int i = 0; i < 60; i++) {
        sag_ray ray = across(rng_uniform(&r, -1, 1));
        compare_ray(parents[0], parents[1], &ray);
        compare_point(parents[0], parents[1], rng_vec3(&r, 1));
    }
    sag_scene_destroy(parents[0]), sag_scene_destroy(parents[1]);
    test_mesh_free(&mesh);
}

static void large_overlapping(void **state) {
    (void)state;
    compare_loose(3000, 100, anywhere);
}

static void identical(void **state) {
    (void)state;
    compare_loose(100000, 1, same);
}

static void degenerate(void **state) {
    (void)state;
    compare_loose(1000, 4, one_centroid);
    compare_loose(3000, 20, line_of_slivers);
    compare_loose(2000, 4, crowd);
}

// A tree that follows the heuristic here would go deeper than the cap.
static void deep(void **state) {
    (void)state;
    compare_loose(120, 100, progression);
    compare_loose(1000, 20, progression);
}

// What each quality is for, by the builder's own reckoning.
static void costs(void **state) {
    (void)state;
    test_mesh sphere = test_mesh_sphere(5), split = needles(3000);
    const sag_mesh *models[2] = {&sphere.mesh, &split.mesh};
    for (int m = 0; m < 2; m++) {
        sag_scene_stats stats[QUALITIES];
        for (int q = 0; q < QUALITIES; q++) {
            sag_scene *scene = commit(context, qualities[q], models[m]);
            sag_scene_get_stats(scene, &stats[q]);
            sag_scene_destroy(scene);
            assert_true(stats[q].leaf_count < models[m]->triangle_count / 3);
        }
        assert_true(stats[1].sah < 1.25 * stats[0].sah);
        assert_true(stats[2].sah < (m == 0 ? 1.0 : 0.6) * stats[0].sah);
    }
    test_mesh_free(&sphere), test_mesh_free(&split);
}

static void same_tree_for_any_threads(void **state) {
    (void)state;
    test_mesh mesh = test_mesh_sphere(6);
    for (int q = 0; q < QUALITIES; q++) {
        sag_context *one = sag_context_create(&(sag_context_options){.thread_count = 1});
        sag_context *five = sag_context_create(&(sag_context_options){.thread_count = 5});
        sag_scene *a = commit(one, qualities[q], &mesh.mesh), *b = commit(five, qualities[q], &mesh.mesh);
        const sagi_bvh *s = &sagi_scene_snapshot(a)->world.tree, *t = &sagi_scene_snapshot(b)->world.tree;
        assert_int_equal(s->node_count, t->node_count);
        assert_int_equal(s->unit_count, t->unit_count);
        assert_memory_equal(s->nodes, t->nodes, s->node_count * sizeof *s->nodes);
        assert_memory_equal(s->leaves, t->leaves, s->unit_count * SAGI_BVH_UNIT);
        sag_scene_destroy(a), sag_scene_destroy(b);
        sag_context_destroy(one), sag_context_destroy(five);
    }
    test_mesh_free(&mesh);
}

static void out_of_memory(void **state) {
    (void)state;
    test_mesh mesh = test_mesh_sphere(3);
    for (int q = 0; q < QUALITIES; q++)
        for (size_t k = 0;; k++) {
            failing_allocator books = {.fail_at = k};
            sag_context *c = sag_context_create(
                &(sag_context_options){.allocator = failing_allocator_make(&books), .thread_count = 1});
            sag_scene *scene = c != NULL ? commit(c, qualities[q], &mesh.mesh) : NULL;
            bool done = scene != NULL;
            sag_scene_destroy(scene);
            sag_context_destroy(c);
            failing_allocator_assert_empty(&books);
            if (done) break;
        }
    test_mesh_free(&mesh);
}

static void unknown_quality(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    int number = 3; // (not a constant, so that no compiler minds)
    assert_int_equal(sag_scene_set_quality(scene, (sag_quality)number), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_scene_set_quality(scene, SAG_QUALITY_HIGH), SAG_OK);
    sag_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes),
        cmocka_unit_test(few),
        cmocka_unit_test(wires),
        cmocka_unit_test(many_crossings_of_split_triangles),
        cmocka_unit_test(split_triangles_in_instances),
        cmocka_unit_test(large_overlapping),
        cmocka_unit_test(identical),
        cmocka_unit_test(degenerate),
        cmocka_unit_test(deep),
        cmocka_unit_test(costs),
        cmocka_unit_test(same_tree_for_any_threads),
        cmocka_unit_test(out_of_memory),
        cmocka_unit_test(unknown_quality),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
