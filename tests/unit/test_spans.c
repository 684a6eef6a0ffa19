// SPDX-License-Identifier: MIT
// sag_scene_spans against each body asked by itself: its crossings one by one, and whether the ray's origin
// is inside.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include "shapes/spheres.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include "support/span_truth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static sag_context *context;

static int set_up(void **state) {
    (void)state;
    return (context = sag_context_create(NULL)) == NULL;
}

static int tear_down(void **state) {
    (void)state;
    sag_context_destroy(context);
    return 0;
}

static void expect_shape(span_truth *w, uint32_t id, sag_shape_kind kind, const void *shape,
                         const sag_ray *line) {
    const sagi_shape_class *class = &sagi_shape_classes[kind];
    sag_mesh mesh;
    sag_hit hits[256];
    if (kind == SAG_SHAPE_MESH) { // inside is a matter of both sides
        mesh = *(const sag_mesh *)shape, mesh.one_sided = false;
        shape = &mesh;
    }
    size_t count = class->crossings(shape, line, hits, 256), before = 0;
    assert_true(count <= 256);
    if (kind == SAG_SHAPE_TORUS) {
        sag_ray whole = *line;
        whole.t_max = INFINITY;
        count = sag_torus_crossings(shape, &whole, hits, 4);
        count = sagi_torus_leave_outer(shape, &whole, hits, count);
    }
    while (before < count && hits[before].t < 0) before++;
    bool unbounded = kind == SAG_SHAPE_PLANE || kind == SAG_SHAPE_POLYHEDRON;
    bool inside = unbounded && class->contains(shape, line->origin) != (before % 2 == 1);
    for (size_t i = 0; i < count; i++) hits[i] = span_truth_hit(w, id, hits[i]);
    span_truth_add(w, id, hits, count, inside);
}

static void expect_scene(span_truth *w, const sagi_snapshot *s, const sag_ray *line) {
    for (uint32_t id = 0; id < s->count; id++) {
        const sagi_item *item = &s->items[id];
        if (!s->entries[id].present || (line->mask != 0 && (line->mask & item->mask) == 0)) continue;
        sag_ray local = item->place != NULL ? sag_ray_transform(&item->place->to_object, line) : *line;
        sag_shape_kind kind = (sag_shape_kind)item->kind;
        if (kind == SAG_SHAPE_INSTANCE) {
            w->path[w->depth++] = id;
            expect_scene(w, s->entries[id].child, &local);
            w->depth--, w->path[w->depth] = SAG_INVALID_ID;
        } else if (kind == SAG_SHAPE_SPHERES) {
            for (uint32_t i = 0; i < sagi_primitive_count(s, id); i++) {
                sag_sphere sphere = {.radius = 0};
                sag_hit hits[2];
                sagi_spheres_get(item->shape, i, &sphere.center, &sphere.radius);
                size_t count = sag_sphere_crossings(&sphere, &local, hits, 2);
                for (size_t k = 0; k < count; k++)
                    hits[k] = span_truth_hit(w, id, hits[k]), hits[k].primitive = i;
                span_truth_add(w, id, hits, count, false);
            }
        } else if (sagi_geometry_is_closed(s, id)) {
            expect_shape(w, id, kind, item->shape, &local);
        }
    }
}

static size_t check(const sag_scene *scene, const sag_ray *ray, rng *r) {
    static span_truth truth;
    sag_ray line = *ray;
    line.t_min = -INFINITY;
    span_truth_begin(&truth, ray);
    if (sag_ray_is_valid(ray)) expect_scene(&truth, sagi_scene_snapshot(scene), &line);
    span_truth_assert(&truth, scene, r);
    return truth.count;
}

static void everything_nested(void **state) {
    (void)state;
    rng r = rng_make(21);
    size_t found = 0;
    for (int i = 0; i < 12; i++) {
        double size = rng_log_uniform(&r, 1e-3, 1e3);
        sag_scene *scene = random_nested_scene(&r, context, 44, i % 4, size);
        assert_non_null(scene);
        for (size_t k = 0; k < soak(400); k++) {
            sag_ray ray = random_scene_ray(&r, size);
            if (rng_one_in(&r, 10)) ray.t_max = ray.t_min = rng_uniform(&r, 0, 1) / sag_length(ray.direction);
            found += check(scene, &ray, &r);
        }
        sag_scene_destroy(scene);
    }
    assert_true(found > 10000);
}

// A spindle torus holds its lens, as it says itself: alone and as a solid.
static void spindles(void **state) {
    (void)state;
    rng r = rng_make(25);
    size_t through = 0;
    for (int i = 0; i < 40; i++) {
        const sag_torus torus = {i == 0 ? 0 : rng_uniform(&r, 0, 1), 1};
        const sag_solid_step step = {SAG_SOLID_PART, 0};
        sag_scene *scene = sag_scene_create(context), *solid = sag_scene_create(context);
        sag_add_torus(scene, &torus), sag_add_torus(solid, &torus);
        assert_int_equal(sag_scene_set_solid(solid, &(sag_solid){&step, 1}, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
        for (int k = 0; k < 200; k++) {
            sag_vec3 from = rng_vec3(&r, 3), to = rng_vec3(&r, 0.8);
            if (i % 4 == 1)
                from.x = from.y = 0, to = sag_vec3_make(0, 0, 0); // along the axis, through the tips
            const sag_ray ray = {from, sag_sub(to, from), 0, 1, 0};
            sag_span spans[4], in_solid[4];
            size_t count = sag_scene_spans(scene, &ray, spans, 4);
            assert_int_equal(sag_scene_spans(solid, &ray, in_solid, 4), count);
            assert_true(count <= 2);
            double end = 0;
            for (size_t j = 0; j < count; j++) {
                double enter = spans[j].enter.t, leave = spans[j].leave.t;
                assert_true(enter == in_solid[j].enter.t && leave == in_solid[j].leave.t);
                sag_vec3 inside = sag_madd(from, 0.5 * (enter + leave), ray.direction);
                sag_vec3 before = sag_madd(from, 0.5 * (end + enter), ray.direction);
                if (leave - enter > 1e-9) assert_true(sag_torus_contains(&torus, inside));
                if (enter - end > 1e-9) assert_false(sag_torus_contains(&torus, before));
                end = leave;
            }
            if (i % 4 != 1) assert_int_equal(sag_contains(solid, to), sag_torus_contains(&torus, to));
            through += sag_count_crossings(scene, &ray) > 2 * count;
        }
        sag_scene_destroy(scene), sag_scene_destroy(solid);
    }
    assert_true(through > 100);
}

static sag_ray along_x(double from) { return sag_ray_make((sag_vec3){from, 0, 0}, (sag_vec3){1, 0, 0}); }

// A ball from 1 to 3, a cube from 2 to 4 and the half-space beyond 10.
static sag_scene *three_bodies(void) {
    sag_scene *scene = sag_scene_create(context);
    sag_add_sphere(scene, &(sag_sphere){.center = {2, 0, 0}, .radius = 1});
    sag_add_box(scene, &(sag_box){{2, -1, -1}, {4, 1, 1}});
    sag_add_plane(scene, &(sag_plane){.point = {10, 0, 0}, .normal = {-1, 0, 0}});
    sag_add_disk(scene, &(sag_disk){.center = {5, 0, 0}, .normal = {1, 0, 0}, .radius = 2}); // no body
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}

typedef struct known {
    uint32_t geometry;
    double enter, leave;
    bool begins, ends; // within
} known;

static void assert_known(const sag_scene *scene, sag_ray ray, size_t count, const known *k) {
    sag_span spans[4];
    assert_int_equal(sag_scene_spans(scene, &ray, spans, 4), count);
    for (size_t i = 0; i < count; i++) {
        const sag_hit *enter = &spans[i].enter, *leave = &spans[i].leave;
        assert_true(enter->geometry == k[i].geometry && leave->geometry == k[i].geometry);
        assert_true(enter->t == k[i].enter && leave->t == k[i].leave);
        assert_int_equal(enter->primitive == SAG_INVALID_ID, k[i].begins);
        assert_int_equal(leave->primitive == SAG_INVALID_ID, k[i].ends);
    }
}

static void ranges(void **state) {
    (void)state;
    sag_scene *scene = three_bodies();
    sag_ray ray = along_x(0);
    assert_known(scene, ray, 3,
                 (known[]){{0, 1, 3, false, false}, {1, 2, 4, false, false}, {2, 10, INFINITY, false, true}});
    ray.t_min = 2.5, ray.t_max = 3.5; // begins in both, ends in the cube
    assert_known(scene, ray, 2, (known[]){{0, 2.5, 3, true, false}, {1, 2.5, 3.5, true, true}});
    ray.t_min = 1, ray.t_max = 2; // on the ball's surface, to that of the cube
    assert_known(scene, ray, 1, (known[]){{0, 1, 2, false, true}});
    ray.t_min = 3, ray.t_max = 4; // where it is left there is nothing more of it
    assert_known(scene, ray, 1, (known[]){{1, 3, 4, true, false}});
    ray.t_min = ray.t_max = 2.5; // which bodies a point is in
    assert_known(scene, ray, 2, (known[]){{0, 2.5, 2.5, true, true}, {1, 2.5, 2.5, true, true}});
    ray.t_min = ray.t_max = 1;
    assert_known(scene, ray, 1, (known[]){{0, 1, 1, false, true}});
    ray.t_min = ray.t_max = 3;
    assert_known(scene, ray, 1, (known[]){{1, 3, 3, true, true}});
    ray.t_min = 20, ray.t_max = 30; // nothing but the half-space, before its surface and behind
    assert_known(scene, ray, 1, (known[]){{2, 20, 30, true, true}});
    ray.t_min = -30, ray.t_max = -20;
    assert_known(scene, ray, 0, NULL);
    ray.t_min = -INFINITY, ray.t_max = INFINITY, ray.direction.x = -1;
    assert_known(
        scene, ray, 3,
        (known[]){{2, -INFINITY, -10, true, false}, {1, -4, -2, false, false}, {0, -3, -1, false, false}});
    ray.origin.x = 11, ray.direction = (sag_vec3){0, 1, 0}; // within the half-space for ever
    assert_known(scene, ray, 1, (known[]){{2, -INFINITY, INFINITY, true, true}});
    ray.origin.x = 9;
    assert_known(scene, ray, 0, NULL);
    ray.t_max = NAN;
    assert_known(scene, ray, 0, NULL);
    sag_scene_destroy(scene);
    scene = sag_scene_create(context);
    ray = along_x(0);
    assert_known(scene, ray, 0, NULL); // never committed
    sag_scene_destroy(scene);
}

// As many open at once as there are, in instances too: many times more than are kept of one walk.
static void a_thousand_shells(void **state) {
    (void)state;
    rng r = rng_make(22);
    sag_scene *shells = sag_scene_create(context), *scene = sag_scene_create(context);
    for (int i = 0; i < 500; i++) sag_add_sphere(shells, &(sag_sphere){.radius = 1 + i});
    assert_int_equal(sag_scene_commit(shells, NULL), SAG_OK);
    for (int i = 0; i < 500; i++) sag_add_sphere(scene, &(sag_sphere){.radius = 0.5 + i});
    sag_affine aside = sag_affine_translate((sag_vec3){7.25, 0, 0});
    sag_add_instance(scene, shells, NULL);
    sag_add_instance(scene, shells, &aside);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int i = 0; i < 6; i++) {
        sag_ray ray = along_x(-600 + 150 * i);
        if (i > 3) ray.direction = rng_direction(&r), ray.t_max = 400;
        size_t count = check(scene, &ray, &r);
        assert_true(i > 3 || count == 1500 || ray.origin.x > -500);
    }
    sag_scene_destroy(shells), sag_scene_destroy(scene);
}

// One mesh with more crossings than are kept, and one whose triangles stand in several leaves.
static void many_crossings_of_one_mesh(void **state) {
    (void)state;
    rng r = rng_make(23);
    enum { CUBES = 120 };
    static double positions[24 * CUBES];
    static uint32_t triangles[36 * CUBES];
    test_mesh cube = test_mesh_cube();
    for (uint32_t i = 0; i < CUBES; i++) {
        for (uint32_t k = 0; k < 24; k++)
            positions[24 * i + k] = cube.positions[k] * (k % 3 == 0 ? 0.3 : 50) + (k % 3 == 0 ? i : 0);
        for (uint32_t k = 0; k < 36; k++) triangles[36 * i + k] = cube.triangles[k] + 8 * i;
    }
    sag_mesh mesh = {.positions_f64 = positions,
                     .triangles = triangles,
                     .vertex_count = 8 * CUBES,
                     .triangle_count = 12 * CUBES};
    sag_scene *scene = sag_scene_create(context);
    sag_affine turned = sag_affine_rotate(0.5, (sag_vec3){1, 2, 3});
    sag_geometry_set_transform(scene, sag_add_mesh(scene, &mesh), &turned);
    sag_add_mesh(scene, &mesh);
    sag_add_sphere(scene, &(sag_sphere){.center = {CUBES / 2, 0, 0}, .radius = 10});
    sag_scene_set_quality(scene, SAG_QUALITY_HIGH);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int i = 0; i < 40; i++) {
        sag_ray ray = along_x(i % 2 ? -5 : CUBES / 2);
        ray.origin.y = rng_uniform(&r, -40, 40), ray.origin.z = rng_uniform(&r, -40, 40);
        if (i % 3 == 0) ray.direction = rng_direction(&r);
        size_t count = check(scene, &ray, &r);
        assert_true(i != 1 || count >= CUBES);
    }
    sag_scene_destroy(scene);
    test_mesh_free(&cube);
}

// Edges and corners of meshes, exactly: touching is not being inside.
static void through_edges(void **state) {
    (void)state;
    rng r = rng_make(24);
    test_mesh cube = test_mesh_cube();
    sag_scene *scene = sag_scene_create(context);
    sag_add_mesh(scene, &cube.mesh);
    sag_add_box(scene, &(sag_box){{-1, -1, -1}, {1, 1, 1}});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int i = 0; i < 500; i++) {
        sag_vec3 from = {(double)rng_below(&r, 9) - 4, (double)rng_below(&r, 9) - 4,
                         (double)rng_below(&r, 9) - 4};
        sag_vec3 to = {(double)rng_below(&r, 3) - 1, (double)rng_below(&r, 3) - 1,
                       (double)rng_below(&r, 3) - 1};
        sag_ray ray = sag_ray_make(from, sag_sub(to, from));
        if (rng_one_in(&r, 3)) ray.t_max = 1;
        check(scene, &ray, &r);
    }
    sag_scene_destroy(scene);
    test_mesh_free(&cube);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_nested),
        cmocka_unit_test(spindles),
        cmocka_unit_test(ranges),
        cmocka_unit_test(a_thousand_shells),
        cmocka_unit_test(many_crossings_of_one_mesh),
        cmocka_unit_test(through_edges),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
