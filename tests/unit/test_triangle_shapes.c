// SPDX-License-Identifier: MIT
// Triangle, mesh, polygon and bilinear patch: what is true of every shape (shape_properties.h), at several
// scales.
#include "support/meshes.h"
#include "support/shape_properties.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const sagi_shape_class *kind(sag_shape_kind k) { return &sagi_shape_classes[k]; }

static void check_common(const shape_case *c, rng *r) {
    check_verbs(c, r, 1000);
    check_surfaces(c, r, 600);
    check_spawned(c, r, 600);
    check_bad_rays(c);
    check_area_and_samples(c, r, 8000);
}

static const double scales[3] = {1, 1e-9, 1e9};

static void test_one_triangle(void **state) {
    (void)state;
    rng r = rng_make(31);
    for (int i = 0; i < 3; i++) {
        double k = scales[i];
        sag_triangle s = {{-k, -k, 0.5 * k}, {k, -0.5 * k, 0}, {0, k, -0.5 * k}, false};
        shape_case c = {kind(SAG_SHAPE_TRIANGLE), &s, {0, 0, 0}, 1.6 * k, LEAVING_FLAT};
        check_common(&c, &r);
        check_closest_point(&c, &r, 200);
    }
}

static void test_polygon(void **state) {
    (void)state;
    rng r = rng_make(32);
    static const uint32_t loops[2] = {6, 4};
    for (int i = 0; i < 3; i++) {
        double k = scales[i];
        // An L with a hole, in the plane z = x + y / 2.
        sag_vec3 p[10] = {{-1, -1, -1.5},
                          {1, -1, 0.5},
                          {1, 0, 1},
                          {0, 0, 0},
                          {0, 1, 0.5},
                          {-1, 1, -0.5},
                          {-.75, -.75, -1.125},
                          {-.75, -.25, -.875},
                          {-.25, -.25, -.375},
                          {-.25, -.75, -.625}};
        for (int j = 0; j < 10; j++) p[j] = sag_scale(p[j], k);
        sag_polygon s = {p, 10, loops, 2};
        sag_error error;
        assert_int_equal(sag_polygon_validate(&s, &error), SAG_OK);
        assert_true(fabs(sag_polygon_area(&s) - 1.5 * 2.75 * k * k) < 1e-14 * k * k);
        shape_case c = {kind(SAG_SHAPE_POLYGON), &s, {0, 0, 0}, 2.2 * k, LEAVING_FLAT};
        check_common(&c, &r);
        check_closest_point(&c, &r, 200);
    }
}

static void test_patch(void **state) {
    (void)state;
    rng r = rng_make(33);
    for (int i = 0; i < 3; i++) {
        double k = scales[i];
        sag_bilinear_patch s = {
            {-k, -k, 0.5 * k}, {k, -k, -0.3 * k}, {-k, 0.8 * k, -0.5 * k}, {1.1 * k, k, 0.4 * k}};
        shape_case c = {kind(SAG_SHAPE_BILINEAR_PATCH), &s, {0, 0, 0}, 1.7 * k, LEAVING_ANY};
        check_common(&c, &r);
    }
}

static void test_a_mesh(void **state) {
    (void)state;
    rng r = rng_make(34);
    for (int i = 0; i < 3; i++) {
        double k = scales[i];
        test_mesh m = test_mesh_sphere(1);
        test_mesh_move(&m, k, (sag_vec3){0, 0, 0}, 0, &r);
        shape_case c = {kind(SAG_SHAPE_MESH), &m.mesh, {0, 0, 0}, k, LEAVING_CONVEX};
        check_common(&c, &r);
        check_volume(&c, &r, 5000);
        check_closest_point(&c, &r, 50);
        test_mesh_free(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_triangle), cmocka_unit_test(test_polygon),
                                       cmocka_unit_test(test_patch), cmocka_unit_test(test_a_mesh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
