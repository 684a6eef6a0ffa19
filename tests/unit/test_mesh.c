// SPDX-License-Identifier: MIT
// The mesh: its verbs, its surfaces with normals and texture coordinates, and what sag_mesh_check reports.
#include "support/failing_allocator.h"
#include "support/meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void test_cube(void **state) {
    (void)state;
    test_mesh m = test_mesh_cube();
    sag_error error;
    assert_int_equal(sag_mesh_validate(&m.mesh, &error), SAG_OK);
    assert_true(sag_mesh_area(&m.mesh) == 24 && sag_mesh_volume(&m.mesh) == 8);
    assert_true(sag_mesh_contains(&m.mesh, (sag_vec3){0.9, -0.9, 0.1}));
    assert_false(sag_mesh_contains(&m.mesh, (sag_vec3){1.1, 0, 0}));
    assert_true(sag_mesh_contains(&m.mesh, (sag_vec3){0.25, 0.5, 1})); // on it
    sag_vec3 near = sag_mesh_closest_point(&m.mesh, (sag_vec3){0.5, 0.25, 3});
    assert_true(near.x == 0.5 && near.y == 0.25 && near.z == 1);
    // open3d-5669, trimesh-1496: through edges and vertices.
    sag_ray diagonal = sag_ray_make((sag_vec3){-4, -4, -4}, (sag_vec3){1, 1, 1});
    sag_hit hits[4];
    assert_int_equal(sag_mesh_crossings(&m.mesh, &diagonal, hits, 4), 2);
    assert_true(hits[0].t == 3 && hits[1].t == 5);
    assert_int_equal(sag_mesh_crossings(&m.mesh, &diagonal, hits, 1), 2);
    assert_true(hits[0].t == 3);
    diagonal.t_min = 4;
    assert_true(sag_mesh_hit(&m.mesh, &diagonal, &hits[0]) && hits[0].t == 5);
    m.mesh.one_sided = true;
    assert_false(sag_mesh_occluded(&m.mesh, &diagonal)); // leaves through a back
    assert_true(sag_mesh_contains(&m.mesh, (sag_vec3){0.9, -0.9, 0.1}));
    assert_false(sag_mesh_contains(&m.mesh, (sag_vec3){-1.1, 0, 0}));
    test_mesh_free(&m);
}

static void test_surface(void **state) {
    (void)state;
    const float positions[9] = {0, 0, 0, 2, 0, 0, 0, 4, 0};
    const float normals[9] = {0, 0, 3, 1, 0, 1, 0, 0, 0.5F};
    const float texcoords[6] = {0.25F, 0.5F, 0.75F, 0.5F, 0.25F, 1};
    const uint32_t triangle[3] = {0, 1, 2};
    sag_mesh m = {.positions_f32 = positions,
                  .normals_f32 = normals,
                  .texcoords_f32 = texcoords,
                  .triangles = triangle,
                  .vertex_count = 3,
                  .triangle_count = 1};
    sag_ray ray = sag_ray_make((sag_vec3){1, 1, 8}, (sag_vec3){0, 0, -1});
    sag_hit hit;
    assert_true(sag_mesh_hit(&m, &ray, &hit) && hit.u == 0.5 && hit.v == 0.25 && hit.t == 8);
    sag_surface s;
    sag_mesh_surface(&m, &ray, &hit, &s);
    assert_true(s.u == 0.5 && s.v == 0.625 && s.geometric_normal.z == 1);
    assert_true(s.dpdu.x == 4 && s.dpdu.y == 0 && s.dpdv.x == 0 && s.dpdv.y == 8);
    sag_vec3 known = sag_normalize((sag_vec3){0.5 * sqrt(0.5), 0, 0.25 + 0.25 + 0.5 * sqrt(0.5)});
    assert_true(sag_length(sag_sub(s.shading_normal, known)) < 1e-15);
    assert_true(sag_mesh_sample(&m, (sag_vec2){0.3, 0.7}, &s) && s.position.z == 0);

    // Texture coordinates all alike give no derivatives: a frame instead.
    const float same[6] = {1, 1, 1, 1, 1, 1};
    m.texcoords_f32 = same;
    sag_mesh_surface(&m, &ray, &hit, &s);
    assert_true(s.u == 1 && s.v == 1 && fabs(sag_length(sag_cross(s.dpdu, s.dpdv)) - 1) < 1e-15);
    const float zero[9] = {0};
    m.normals_f32 = zero;
    sag_mesh_surface(&m, &ray, &hit, &s);
    assert_true(s.shading_normal.z == 1);
}

static void test_normals(void **state) {
    (void)state;
    test_mesh m = test_mesh_cube();
    float n[24];
    sag_mesh_compute_normals(&m.mesh, n);
    for (int i = 0; i < 8; i++) // the angles make the diagonals of a face count for nothing
        for (int k = 0; k < 3; k++) assert_true(fabs(n[3 * i + k] - m.positions[3 * i + k] / sqrt(3)) < 1e-6);
    m.mesh.vertex_count = 8, m.mesh.triangle_count = 1; // vertices of no triangle
    sag_mesh_compute_normals(&m.mesh, n);
    assert_true(n[21] == 0 && n[22] == 0 && n[23] == 1);
    test_mesh_free(&m);
}

// ifc-lite-3561: one NaN triangle among good ones harms nobody.
static void test_bad_triangles(void **state) {
    (void)state;
    test_mesh m = test_mesh_cube();
    sag_context *context = sag_context_create(NULL);
    sag_mesh_report report;
    sag_error error;
    m.triangles[1] = m.triangles[0]; // no area
    m.positions[3 * 7] = NAN;        // of six triangles
    assert_int_equal(sag_mesh_check(context, &m.mesh, &report, &error), SAG_OK);
    assert_int_equal(report.triangle_count, 12);
    assert_int_equal(report.degenerate_count, 1);
    assert_int_equal(report.not_finite_count, 6);
    assert_false(report.closed);
    sag_box3 box = sag_mesh_bounds(&m.mesh);
    assert_true(box.min.x == -1 && box.max.x == 1 && box.max.z == 1);
    sag_ray ray = sag_ray_make((sag_vec3){-0.25, -0.5, -5}, (sag_vec3){0, 0, 1});
    sag_hit hit;
    assert_true(sag_mesh_hit(&m.mesh, &ray, &hit) && hit.t > 0);
    assert_true(isfinite(sag_mesh_area(&m.mesh)) && isfinite(sag_mesh_volume(&m.mesh)));

    m.triangles[3] = 8; // out of range
    assert_int_equal(sag_mesh_validate(&m.mesh, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "triangle 1 "));
    assert_int_equal(sag_mesh_check(context, &m.mesh, &report, &error), SAG_ERROR_GEOMETRY);
    sag_mesh_occluded(&m.mesh, &ray); // reads nothing it must not
    sag_mesh_closest_point(&m.mesh, ray.origin);
    m.mesh.triangle_count = 0;
    assert_int_equal(sag_mesh_validate(&m.mesh, &error), SAG_ERROR_GEOMETRY);
    m.mesh.triangle_count = 1, m.mesh.positions_f64 = NULL;
    assert_int_equal(sag_mesh_validate(&m.mesh, &error), SAG_ERROR_GEOMETRY);
    assert_false(sag_mesh_hit(&m.mesh, &ray, &hit));
    sag_context_destroy(context);
    test_mesh_free(&m);
}

static sag_mesh_report check(const sag_mesh *mesh) {
    sag_mesh_report report = {.triangle_count = 42};
    for (size_t k = 0;; k++) { // and it is an error whichever allocation fails
        failing_allocator books = {.fail_at = k};
        sag_context_options options = {.allocator = failing_allocator_make(&books)};
        sag_context *context = sag_context_create(&options);
        sag_status status = context ? sag_mesh_check(context, mesh, &report, NULL) : SAG_ERROR_MEMORY;
        sag_context_destroy(context);
        failing_allocator_assert_empty(&books);
        if (status == SAG_OK) return report;
        assert_int_equal(status, SAG_ERROR_MEMORY);
        assert_int_equal(report.triangle_count, 42);
    }
}

static void test_check(void **state) {
    (void)state;
    test_mesh m = test_mesh_torus(20, 12);
    sag_mesh_report report = check(&m.mesh);
    assert_true(report.closed && report.open_edge_count == 0 && report.duplicate_count == 0);

    uint32_t first[3] = {m.triangles[0], m.triangles[1], m.triangles[2]};
    m.triangles[1] = first[2], m.triangles[2] = first[1]; // turned over
    report = check(&m.mesh);
    assert_true(!report.closed && report.flipped_edge_count == 3 && report.open_edge_count == 0);
    memcpy(m.triangles, first, sizeof first);

    m.mesh.triangles = m.triangles + 3; // without the first
    m.mesh.triangle_count--;
    report = check(&m.mesh);
    assert_true(!report.closed && report.open_edge_count == 3);
    uint32_t a = report.open_edge[0], b = report.open_edge[1];
    assert_true((a == first[0] || a == first[1] || a == first[2]) && a != b);
    assert_true(b == first[0] || b == first[1] || b == first[2]);
    m.mesh.triangles = m.triangles;
    m.mesh.triangle_count++;

    memcpy(m.triangles + 3, first, sizeof first); // the second is the first again
    report = check(&m.mesh);
    assert_true(!report.closed && report.duplicate_count == 1 && report.open_edge_count == 2);
    assert_true(report.flipped_edge_count == 1 && report.crowded_edge_count == 2);
    test_mesh_free(&m);
}

// A vertex for each corner of each triangle, as STL files have it; −0 is 0. Any order of corners is a
// duplicate.
static void test_check_merges_positions(void **state) {
    (void)state;
    test_mesh m = test_mesh_sphere(3);
    float *soup;
    uint32_t *corners;
    const sag_mesh mesh = test_mesh_soup(&m, &soup, &corners);
    assert_true(check(&mesh).closed);
    memcpy(soup + 9, soup + 3, 3 * sizeof *soup); // triangle 1: the corners 1, 2, 0 of triangle 0
    memcpy(soup + 12, soup + 6, 3 * sizeof *soup);
    memcpy(soup + 15, soup, 3 * sizeof *soup);
    assert_int_equal(check(&mesh).duplicate_count, 1);
    free(soup);
    free(corners);
    test_mesh_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),    cmocka_unit_test(test_surface),
        cmocka_unit_test(test_normals), cmocka_unit_test(test_bad_triangles),
        cmocka_unit_test(test_check),   cmocka_unit_test(test_check_merges_positions)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
