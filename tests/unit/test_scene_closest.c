// SPDX-License-Identifier: MIT
// The closest point of a scene against asking everything: meshes under any map, shapes under similarities,
// nested instances.
#include "shapes/shape.h"
#include "shapes/triangle.h"
#include "support/meshes.h"
#include "support/random_shape.h"
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static double distance(sag_vec3 a, sag_vec3 b) { return sag_length(sag_sub(a, b)); }

// The smallest distance to the mesh's triangles under the map.
static double mesh_distance(const sag_mesh *m, const sag_affine *map, sag_vec3 point) {
    double best = INFINITY;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        sag_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const double *at = m->positions_f64 + 3 * (size_t)m->triangles[3 * i + (uint32_t)k];
            p[k] = sag_affine_point(map, sag_vec3_make(at[0], at[1], at[2]));
        }
        best = fmin(best, distance(sagi_triangle_closest_point(&p[0], &p[1], &p[2], point), point));
    }
    return best;
}

static void meshes_under_any_map(void **state) {
    (void)state;
    rng r = rng_make(1);
    sag_context *context = sag_context_create(NULL);
    for (size_t round = 0; round < soak(40); round++) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        test_mesh m = test_mesh_torus(20, 12);
        test_mesh_move(&m, size, sag_vec3_make(0, 0, 0), 0.02, &r);
        sag_scene *low = sag_scene_create(context), *top = sag_scene_create(context);
        sag_affine own, placed, whole;
        random_place(&r, size, &own), random_place(&r, size, &placed);
        whole = sag_affine_multiply(&placed, &own);
        assert_int_equal(sag_add_mesh(low, &m.mesh), 0);
        assert_int_equal(sag_geometry_set_transform(low, 0, &own), SAG_OK);
        assert_int_equal(sag_scene_commit(low, NULL), SAG_OK);
        assert_int_equal(sag_add_instance(top, low, &placed), 0);
        assert_int_equal(sag_scene_commit(top, NULL), SAG_OK);
        for (int i = 0; i < 30; i++) {
            sag_vec3 p = rng_vec3(&r, (rng_one_in(&r, 4) ? 1e3 : 4) * size);
            double expected = mesh_distance(&m.mesh, &whole, p);
            sag_closest c;
            assert_true(sag_closest_point(top, p, INFINITY, &c));
            double error =
                1e-13 * (sag_max_component(sag_abs(p)) + 30 * size); // two maps after another, or one
            assert_true(fabs(c.distance - expected) <= error);
            assert_true(fabs(distance(c.point, p) - c.distance) <= error);
            assert_int_equal(c.instance_depth, 1);
            assert_int_equal(c.instance_path[0], 0);
            assert_true(sag_closest_point(top, p, c.distance, &c)); // the limit belongs to it
            if (c.distance > 0) assert_false(sag_closest_point(top, p, c.distance * (1 - 1e-12), &c));
        }
        sag_scene_destroy(low), sag_scene_destroy(top);
        test_mesh_free(&m);
    }
    sag_context_destroy(context);
}

static void shapes_under_similarities(void **state) {
    (void)state;
    rng r = rng_make(2);
    sag_context *context = sag_context_create(NULL);
    enum { COUNT = 40 };
    random_shape *shapes = malloc(COUNT * sizeof *shapes);
    sag_affine maps[COUNT];
    for (size_t round = 0; round < soak(30); round++) {
        sag_scene *scene = sag_scene_create(context);
        for (uint32_t i = 0; i < COUNT; i++) {
            sag_shape_kind kind = (sag_shape_kind)(i % SAG_SHAPE_INSTANCE);
            do random_shape_make(&r, kind, 1, &shapes[i]);
            while (sagi_shape_classes[kind].validate(&shapes[i].as, NULL) != SAG_OK);
            sag_affine turn = sag_affine_rotate(rng_uniform(&r, 0, 6), rng_direction(&r));
            double s = rng_uniform(&r, 0.5, 2);
            sag_affine scale = sag_affine_scale(sag_vec3_make(s, -s, s));
            sag_affine shift = sag_affine_translate(rng_vec3(&r, 20));
            maps[i] = sag_affine_multiply(&turn, &scale);
            maps[i] = sag_affine_multiply(&shift, &maps[i]);
            assert_int_equal(sag_add_shape(scene, kind, &shapes[i].as), i);
            assert_int_equal(sag_geometry_set_transform(scene, i, &maps[i]), SAG_OK);
            if (kind == SAG_SHAPE_PLANE) sag_geometry_set_enabled(scene, i, false);
        }
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        for (int k = 0; k < 40; k++) {
            sag_vec3 p = rng_vec3(&r, 30);
            double best = INFINITY;
            for (uint32_t i = 0; i < COUNT; i++) {
                const sagi_shape_class *class = &sagi_shape_classes[shapes[i].kind];
                if (class->closest_point == NULL || shapes[i].kind == SAG_SHAPE_PLANE) continue;
                sag_affine back;
                assert_true(sag_affine_inverse(&maps[i], &back));
                sag_vec3 q = class->closest_point(&shapes[i].as, sag_affine_point(&back, p));
                best = fmin(best, distance(sag_affine_point(&maps[i], q), p));
            }
            sag_closest c;
            assert_true(sag_closest_point(scene, p, INFINITY, &c));
            assert_true(fabs(c.distance - best) <= 1e-12);
        }
        sag_scene_destroy(scene);
    }
    free(shapes);
    sag_context_destroy(context);
}

static void bad_points(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_scene *scene = sag_scene_create(context);
    sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_closest c;
    assert_false(sag_closest_point(scene, sag_vec3_make(NAN, 0, 0), INFINITY, &c));
    assert_false(sag_closest_point(scene, sag_vec3_make(3, 0, 0), NAN, &c));
    assert_false(sag_closest_point(scene, sag_vec3_make(3, 0, 0), 1.9, &c));
    assert_true(sag_closest_point(scene, sag_vec3_make(3, 0, 0), 2, &c) && c.distance == 2);
    assert_true(sag_closest_point(scene, sag_vec3_make(1e200, 0, 0), INFINITY, &c) && c.distance > 0.99e200);
    sag_scene_destroy(scene);
    sag_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_under_any_map),
        cmocka_unit_test(shapes_under_similarities),
        cmocka_unit_test(bad_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
