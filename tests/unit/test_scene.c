// SPDX-License-Identifier: MIT
// The scene's housekeeping: adding, changing, committing, sharing, and what goes wrong.
#include "scene/scene.h"
#include "support/context.h"
#include "support/failing_allocator.h"
#include "support/meshes.h"
#include "support/random_shape.h"
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static sag_sphere ball(double x, double radius) {
    return (sag_sphere){.center = {x, 0, 0}, .radius = radius};
}

// The geometry that a ray along +x from −100 meets first; SAG_INVALID_ID for none.
static uint32_t first_along_x(const sag_scene *scene, uint32_t mask) {
    sag_ray ray = sag_ray_make(sag_vec3_make(-100, 0, 0), sag_vec3_make(1, 0, 0));
    sag_hit hit;
    ray.mask = mask;
    return sag_intersect(scene, &ray, &hit) ? hit.geometry : SAG_INVALID_ID;
}

// A hit may outlive what it names, or come from a file: surface_at read beyond the arrays.
static void hits_of_what_is_not_there_have_no_surface(void **state) {
    (void)state;
    static const sag_half_space slab[2] = {{{1, 0, 0}, 1}, {{-1, 0, 0}, 1}};
    static const float center[3] = {0, 0, 0};
    static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t triangle[3] = {0, 1, 2};
    sag_scene *scene = sag_scene_create(context);
    sag_add_spheres(scene, &(sag_spheres){.centers_f32 = center, .radius = 1, .count = 1});
    sag_add_mesh(
        scene,
        &(sag_mesh){.positions_f32 = corners, .triangles = triangle, .vertex_count = 3, .triangle_count = 1});
    sag_add_polyhedron(scene, &(sag_polyhedron){slab, 2});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_ray ray = sag_ray_make(sag_vec3_make(-5, 0, 0), sag_vec3_make(1, 0, 0));
    for (uint32_t geometry = 0; geometry < 4; geometry++) {
        sag_surface s;
        sag_hit hit = {.t = 4, .primitive = 1000000, .geometry = geometry};
        sag_surface_at(scene, &ray, &hit, &s);
        if (geometry != 2) assert_int_equal(s.geometry, SAG_INVALID_ID);
        hit.instance_depth = geometry == 0 ? 1000000 : 1;
        sag_surface_at(scene, &ray, &hit, &s);
        assert_int_equal(s.geometry, SAG_INVALID_ID);
    }
    sag_scene_destroy(scene);
}

static void empty_and_uncommitted(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, 0), sag_vec3_make(1, 0, 0));
    sag_closest closest;
    sag_hit hit;
    for (int committed = 0; committed < 2; committed++) {
        sag_scene_stats stats;
        sag_scene_get_stats(scene, &stats);
        sag_box3 box = sag_scene_bounds(scene);
        assert_true(sag_box3_is_empty(&box) && sag_box3_is_empty(&stats.bounds));
        assert_int_equal(stats.primitive_count, 0);
        assert_false(sag_intersect(scene, &ray, &hit) || sag_occluded(scene, &ray));
        assert_int_equal(sag_intersect_all(scene, &ray, &hit, 1), 0);
        assert_false(sag_contains(scene, ray.origin));
        assert_false(sag_closest_point(scene, ray.origin, INFINITY, &closest));
        assert_true(isnan(sag_geometry_area(scene, 0, 0)));
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    }
    sag_scene_destroy(scene);
    sag_scene_destroy(NULL);
}

// The first failed add is what commit reports, once; the scene stays as it was and can be gone on with.
static void failed_adds(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_sphere good = ball(0, 1), bad = ball(0, -1), nan = ball(NAN, 1);
    assert_int_equal(sag_add_sphere(scene, &good), 0);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(sag_add_sphere(scene, &bad), SAG_INVALID_ID);
    assert_int_equal(sag_add_sphere(scene, &nan), SAG_INVALID_ID);
    assert_int_equal(sag_add_shape(scene, SAG_SHAPE_INSTANCE, &good), SAG_INVALID_ID);
    assert_int_equal(sag_add_instance(scene, scene, NULL), SAG_INVALID_ID);
    sag_error first, error;
    assert_int_equal(sag_sphere_validate(&bad, &first), SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_scene_commit(scene, &error), SAG_ERROR_GEOMETRY);
    assert_string_equal(error.message, first.message);
    assert_int_equal(first_along_x(scene, 0), 0);
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 0);
    sag_scene_destroy(scene);
}

static void changes(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_sphere a = ball(0, 1), b = ball(10, 1);
    assert_int_equal(sag_add_sphere(scene, &a), 0);
    assert_int_equal(sag_add_sphere(scene, &b), 1);
    assert_int_equal(sag_geometry_set_mask(scene, 0, SAG_RAY_CAMERA), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), SAG_INVALID_ID); // not yet committed
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 0);
    assert_int_equal(first_along_x(scene, SAG_RAY_CAMERA | SAG_RAY_SHADOW), 0);
    assert_int_equal(first_along_x(scene, SAG_RAY_SHADOW), 1);

    sag_affine back = sag_affine_translate(sag_vec3_make(-50, 0, 0));
    assert_int_equal(sag_geometry_set_transform(scene, 1, &back), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 0); // queries answer as before
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 1);

    assert_int_equal(sag_geometry_set_enabled(scene, 1, false), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 0);
    assert_int_equal(sag_geometry_set_enabled(scene, 1, true), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 1);

    assert_int_equal(sag_geometry_remove(scene, 1), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 1); // still there until the commit
    assert_int_equal(sag_geometry_remove(scene, 1), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_geometry_set_mask(scene, 1, 0), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(first_along_x(scene, 0), 0);
    assert_int_equal(sag_add_sphere(scene, &b), 2); // ids are not reused

    sag_affine flat = sag_affine_scale(sag_vec3_make(1, 0, 1));
    assert_int_equal(sag_geometry_set_transform(scene, 0, &flat), SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_geometry_set_transform(scene, 7, &back), SAG_ERROR_ARGUMENT);
    sag_shape_kind kind;
    const void *shape;
    assert_int_equal(sag_geometry_get(scene, 0, &kind, &shape), SAG_OK);
    assert_int_equal(kind, SAG_SHAPE_SPHERE);
    assert_memory_equal(shape, &a, sizeof a);
    assert_int_equal(sag_geometry_get(scene, 1, &kind, NULL), SAG_ERROR_ARGUMENT);
    sag_scene_destroy(scene);
}

// Everything is copied: the shapes' memory is overwritten after the add. Every kind is there.
static void arrays_are_copied(void **state) {
    (void)state;
    rng r = rng_make(5);
    random_shape *shape = malloc(sizeof *shape), *kept = malloc(sizeof *kept);
    for (int kind = 0; kind < SAG_SHAPE_INSTANCE; kind++) {
        if (kind == SAG_SHAPE_USER) continue; // its data are the caller's
        sag_scene *scenes[2] = {sag_scene_create(context), sag_scene_create(context)};
        rng again = r;
        uint32_t id = SAG_INVALID_ID;
        while (id == SAG_INVALID_ID) {
            again = r;
            random_shape_make(&r, (sag_shape_kind)kind, 1, shape);
            id = sag_add_shape(scenes[0], (sag_shape_kind)kind, &shape->as);
            if (id == SAG_INVALID_ID) sag_scene_commit(scenes[0], NULL); // forget the failure
        }
        memset(shape, 0xAA, sizeof *shape);
        random_shape_make(&again, (sag_shape_kind)kind, 1, kept);
        assert_int_equal(sag_add_shape(scenes[1], (sag_shape_kind)kind, &kept->as), 0);
        for (int i = 0; i < 2; i++) assert_int_equal(sag_scene_commit(scenes[i], NULL), SAG_OK);
        for (int i = 0; i < 200; i++) {
            sag_vec3 o = rng_vec3(&r, 3);
            sag_ray ray = sag_ray_make(o, sag_sub(rng_vec3(&r, 1), o));
            sag_hit hits[2] = {{0}};
            bool found = sag_intersect(scenes[0], &ray, &hits[0]);
            assert_int_equal(found, sag_intersect(scenes[1], &ray, &hits[1]));
            if (found) assert_memory_equal(&hits[0].t, &hits[1].t, sizeof(double));
        }
        for (int i = 0; i < 2; i++) sag_scene_destroy(scenes[i]);
    }
    free(shape), free(kept);
}

static void instances(void **state) {
    (void)state;
    sag_scene *scenes[SAG_MAX_INSTANCE_DEPTH + 2];
    sag_sphere unit = ball(0, 1);
    sag_affine step = sag_affine_translate(sag_vec3_make(5, 0, 0));
    int depth = 0;
    for (; depth <= SAG_MAX_INSTANCE_DEPTH + 1; depth++) {
        scenes[depth] = sag_scene_create(context);
        if (depth == 0) {
            sag_add_sphere(scenes[0], &unit);
            assert_int_equal(sag_add_instance(scenes[0], scenes[0], &step), SAG_INVALID_ID);
            sag_scene_commit(scenes[0], NULL);
        } else {
            sag_geometry_set_enabled(scenes[depth], sag_add_sphere(scenes[depth], &unit), false);
            assert_int_equal(sag_add_instance(scenes[depth], scenes[depth - 1], &step), 1);
        }
        sag_error error;
        sag_status expected = depth > SAG_MAX_INSTANCE_DEPTH ? SAG_ERROR_ARGUMENT : SAG_OK;
        assert_int_equal(sag_scene_commit(scenes[depth], &error), expected);
    }
    // The children go first; what was committed keeps them.
    for (int i = 0; i < SAG_MAX_INSTANCE_DEPTH; i++) sag_scene_destroy(scenes[i]);
    sag_scene *top = scenes[SAG_MAX_INSTANCE_DEPTH];
    sag_ray ray = sag_ray_make(sag_vec3_make(-100, 0, 0), sag_vec3_make(1, 0, 0));
    sag_hit hit;
    assert_true(sag_intersect(top, &ray, &hit));
    assert_true(hit.t == 100 + 5 * SAG_MAX_INSTANCE_DEPTH - 1);
    assert_int_equal(hit.instance_depth, SAG_MAX_INSTANCE_DEPTH);
    for (int i = 0; i < SAG_MAX_INSTANCE_DEPTH; i++) assert_int_equal(hit.instance_path[i], 1);
    assert_int_equal(hit.geometry, 0);
    sag_surface surface;
    sag_surface_at(top, &ray, &hit, &surface);
    assert_true(surface.geometric_normal.x == -1 && surface.position.x == 5 * SAG_MAX_INSTANCE_DEPTH - 1);
    sag_scene_destroy(top);
    sag_scene_destroy(scenes[SAG_MAX_INSTANCE_DEPTH + 1]);
}

static void uncommitted_child(void **state) {
    (void)state;
    sag_scene *child = sag_scene_create(context), *parent = sag_scene_create(context);
    sag_error error;
    assert_int_equal(sag_add_instance(parent, child, NULL), SAG_INVALID_ID);
    assert_int_equal(sag_scene_commit(parent, &error), SAG_ERROR_STATE);
    sag_sphere unit = ball(0, 1);
    sag_add_sphere(child, &unit);
    sag_scene_commit(child, NULL);
    assert_int_equal(sag_add_instance(parent, child, NULL), 0);
    assert_int_equal(sag_scene_commit(parent, &error), SAG_OK);
    assert_int_equal(first_along_x(parent, 0), 0);
    // The child changes; the parent sees it from its next commit on.
    sag_geometry_set_enabled(child, 0, false);
    sag_scene_commit(child, NULL);
    assert_int_equal(first_along_x(parent, 0), 0);
    sag_scene_commit(parent, NULL);
    assert_int_equal(first_along_x(parent, 0), SAG_INVALID_ID);
    // Scenes that hold each other are no cycle: snapshots are.
    assert_int_equal(sag_add_instance(child, parent, NULL), 1);
    assert_int_equal(sag_scene_commit(child, NULL), SAG_OK);
    sag_scene_destroy(parent);
    sag_scene_destroy(child);
}

static void surface_extras(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_sphere unit = ball(0, 1);
    sag_add_sphere(scene, &unit);
    sag_geometry_set_user_data(scene, 0, 0x123456789ABCDEFu);
    sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, 0), sag_vec3_make(1, 0, 0));
    for (int forward = 0; forward < 2; forward++) {
        sag_geometry_set_face_forward(scene, 0, forward == 1);
        sag_scene_commit(scene, NULL);
        sag_hit hit;
        sag_surface surface;
        assert_true(sag_intersect(scene, &ray, &hit));
        sag_surface_at(scene, &ray, &hit, &surface);
        assert_int_equal(surface.side, SAG_SIDE_BACK);
        assert_true(surface.geometric_normal.x == (forward ? -1 : 1));
        assert_true(surface.shading_normal.x == (forward ? -1 : 1));
        assert_true(surface.user_data == 0x123456789ABCDEFu && surface.geometry == 0);
    }
    sag_hit foreign = {.geometry = 17};
    sag_surface surface;
    sag_surface_at(scene, &ray, &foreign, &surface); // not a hit of this scene: no crash
    assert_int_equal(surface.geometry, SAG_INVALID_ID);
    sag_scene_destroy(scene);
}

// The tree, and with it every bit of every answer, is the same for any number of threads; a batch is what
// single calls are.
static void threads_and_batches(void **state) {
    (void)state;
    rng r = rng_make(8);
    test_mesh m = test_mesh_sphere(6); // 81,920 triangles: more than one thread builds alone
    test_mesh_move(&m, 1, sag_vec3_make(0.5, 0, 0), 0.001, &r);
    enum { RAYS = 3000 };
    sag_ray *rays = malloc(RAYS * sizeof *rays);
    sag_hit *hits = malloc(RAYS * sizeof *hits);
    bool *dark = malloc(RAYS);
    for (int i = 0; i < RAYS; i++) {
        sag_vec3 o = rng_vec3(&r, 2);
        rays[i] = sag_ray_make(o, sag_sub(rng_vec3(&r, 1), o));
    }
    rays[7].direction = sag_vec3_make(0, 0, 0);
    sagi_bvh_node *nodes = NULL;
    uint32_t counts[3] = {1, 2, 7}, node_count = 0;
    for (int c = 0; c < 3; c++) {
        sag_context *own = sag_context_create(&(sag_context_options){.thread_count = counts[c]});
        sag_scene *scene = sag_scene_create(own);
        sag_add_mesh(scene, &m.mesh);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        const sagi_bvh *tree = &sagi_scene_snapshot(scene)->world.tree;
        if (c == 0) {
            node_count = tree->node_count;
            nodes = malloc(node_count * sizeof *nodes);
            memcpy(nodes, tree->nodes, node_count * sizeof *nodes);
        }
        assert_int_equal(tree->node_count, node_count);
        assert_memory_equal(tree->nodes, nodes, node_count * sizeof *nodes);
        memset(hits, 0, RAYS * sizeof *hits);
        sag_intersect_batch(scene, rays, hits, RAYS);
        sag_occluded_batch(scene, rays, dark, RAYS);
        for (int i = 0; i < RAYS; i++) {
            sag_hit hit = {.t = INFINITY, .geometry = SAG_INVALID_ID};
            bool found = sag_intersect(scene, &rays[i], &hit);
            assert_int_equal(found, dark[i]);
            assert_memory_equal(&hit.t, &hits[i].t, sizeof hit.t);
            assert_int_equal(hit.primitive, hits[i].primitive);
            assert_int_equal(hit.geometry, hits[i].geometry);
        }
        sag_scene_destroy(scene);
        sag_context_destroy(own);
    }
    free(rays), free(hits), free(dark), free(nodes);
    test_mesh_free(&m);
}

// Threads of the caller's own, all asking one scene at once, each building a scene with an instance of it.
// (For the tsan preset to watch; the answers must agree too.)
typedef struct asker {
    sag_scene *shared;
    size_t hits;
} asker;

static void *ask_and_build(void *argument) {
    asker *a = argument;
    rng r = rng_make(10);
    sag_scene *own = sag_scene_create(context);
    sag_affine map = sag_affine_translate(sag_vec3_make(0.25, 0, 0));
    if (sag_add_instance(own, a->shared, &map) != 0 || sag_scene_commit(own, NULL) != SAG_OK) return NULL;
    for (int i = 0; i < 2000; i++) {
        sag_vec3 o = rng_vec3(&r, 2);
        sag_ray ray = sag_ray_make(o, sag_sub(rng_vec3(&r, 1), o));
        sag_hit hit;
        sag_surface surface;
        sag_closest closest;
        if (sag_intersect(a->shared, &ray, &hit)) {
            sag_surface_at(a->shared, &ray, &hit, &surface);
            a->hits += 1 + (surface.side == SAG_SIDE_FRONT);
        }
        a->hits += sag_count_crossings(own, &ray);
        if (i % 20 == 0) a->hits += sag_closest_point(own, o, 1, &closest);
    }
    sag_scene_destroy(own);
    return NULL;
}

static void many_threads(void **state) {
    (void)state;
    test_mesh m = test_mesh_sphere(3);
    sag_scene *scene = sag_scene_create(context);
    sag_add_mesh(scene, &m.mesh);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    enum { THREADS = 4 };
    pthread_t threads[THREADS];
    asker askers[THREADS];
    for (int i = 0; i < THREADS; i++) {
        askers[i] = (asker){scene, 0};
        assert_int_equal(pthread_create(&threads[i], NULL, ask_and_build, &askers[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
    for (int i = 0; i < THREADS; i++) assert_true(askers[i].hits > 1000 && askers[i].hits == askers[0].hits);
    sag_scene_destroy(scene);
    test_mesh_free(&m);
}

// The k-th allocation fails, for every k: an error, the scene as it was, nothing lost.
static void memory_runs_out(void **state) {
    (void)state;
    test_mesh m = test_mesh_sphere(1);
    sag_spheres set = {.centers_f32 = (const float[]){5, 0, 0, 8, 0, 0}, .radius = 1, .count = 2};
    sag_plane floor = {.point = {0, -5, 0}, .normal = {0, 1, 0}};
    sag_sphere unit = ball(20, 1);
    sag_affine map = sag_affine_translate(sag_vec3_make(-3, 0, 0));
    for (size_t k = 0;; k++) {
        failing_allocator books = {.fail_at = NEVER};
        sag_context_options options = {.allocator = failing_allocator_make(&books), .thread_count = 1};
        sag_context *own = sag_context_create(&options);
        sag_scene *child = sag_scene_create(own), *scene = sag_scene_create(own);
        sag_add_sphere(child, &unit);
        assert_int_equal(sag_scene_commit(child, NULL), SAG_OK);
        sag_add_sphere(scene, &unit);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        books.fail_at = books.calls + k;
        sag_geometry_set_transform(scene, sag_add_mesh(scene, &m.mesh), &map);
        sag_add_spheres(scene, &set);
        sag_add_plane(scene, &floor);
        sag_add_instance(scene, child, &map);
        sag_error error = {.status = SAG_OK};
        sag_status status = sag_scene_commit(scene, &error);
        bool done = books.calls <= books.fail_at;
        assert_int_equal(status, done ? SAG_OK : SAG_ERROR_MEMORY);
        assert_int_equal(error.status, status);
        assert_int_equal(first_along_x(scene, 0), done ? 1 : 0);
        books.fail_at = NEVER;
        sag_scene_destroy(child);
        sag_scene_destroy(scene);
        sag_context_destroy(own);
        failing_allocator_assert_empty(&books);
        if (done) break;
        assert_true(k < 1000);
    }
    test_mesh_free(&m);
}

static void stats(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    float positions[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, NAN, 0, 0, 2, 0, 0};
    uint32_t triangles[9] = {0, 1, 2, 0, 1, 3, 0, 1, 4};
    sag_mesh mesh = {
        .positions_f32 = positions, .triangles = triangles, .vertex_count = 5, .triangle_count = 3};
    sag_plane floor = {.point = {0, 0, 0}, .normal = {0, 1, 0}};
    sag_add_mesh(scene, &mesh);
    sag_add_plane(scene, &floor);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_scene_stats s;
    sag_scene_get_stats(scene, &s);
    assert_int_equal(s.geometry_count, 2);
    assert_int_equal(s.primitive_count, 2);
    assert_int_equal(s.dropped_not_finite, 1);
    assert_int_equal(s.dropped_degenerate, 1);
    assert_true(s.bounds.max.x == 1 && s.bounds.min.z == 0);
    assert_true(isinf(sag_scene_bounds(scene).max.x));
    assert_true(s.geometry_bytes > 0 && s.structure_bytes > 0 && s.node_count == 1 && s.leaf_count == 1);
    sag_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(empty_and_uncommitted),
        cmocka_unit_test(failed_adds),
        cmocka_unit_test(changes),
        cmocka_unit_test(arrays_are_copied),
        cmocka_unit_test(instances),
        cmocka_unit_test(uncommitted_child),
        cmocka_unit_test(surface_extras),
        cmocka_unit_test(threads_and_batches),
        cmocka_unit_test(hits_of_what_is_not_there_have_no_surface),
        cmocka_unit_test(many_threads),
        cmocka_unit_test(memory_runs_out),
        cmocka_unit_test(stats),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
