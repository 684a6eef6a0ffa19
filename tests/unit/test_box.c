// SPDX-License-Identifier: MIT
// The axis-aligned box: analytic values, the properties of every shape, edges and vertices counted once.
#include "support/shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const sag_box unit = {{0, 0, 0}, {1, 1, 1}};

static size_t count(const sag_box *box, sag_vec3 o, sag_vec3 d) {
    sag_ray ray = sag_ray_make(o, d);
    return sag_box_crossings(box, &ray, NULL, 0);
}

static void values(void **state) {
    (void)state;
    sag_box box = {{-1, -2, -3}, {1, 2, 3}};
    sag_ray ray = sag_ray_make((sag_vec3){0.5, 1, -7}, (sag_vec3){0, 0, 2});
    sag_hit hits[2];
    assert_int_equal(sag_box_crossings(&box, &ray, hits, 2), 2);
    assert_true(hits[0].t == 2 && hits[1].t == 5);
    assert_int_equal(hits[0].primitive, 4);
    assert_int_equal(hits[1].primitive, 5);
    sag_surface s;
    sag_box_surface(&box, &ray, &hits[0], &s);
    assert_true(s.position.x == 0.5 && s.position.y == 1 && s.position.z == -3);
    assert_true(s.geometric_normal.z == -1 && s.side == SAG_SIDE_FRONT);
    assert_true(s.u == 0.75 && s.v == 0.75 && s.dpdu.x == 2 && s.dpdv.y == 4);
    sag_box_surface(&box, &ray, &hits[1], &s);
    assert_true(s.geometric_normal.z == 1 && s.side == SAG_SIDE_BACK);
    // From inside the far face is the hit; behind, nothing.
    ray.origin.z = 0;
    assert_true(sag_box_hit(&box, &ray, hits) && hits[0].t == 1.5 && hits[0].primitive == 5);
    ray.origin.z = 3.5;
    assert_false(sag_box_hit(&box, &ray, hits));
    assert_true(sag_box_area(&box) == 88 && sag_box_volume(&box) == 48);
    sag_vec3 q = sag_box_closest_point(&box, (sag_vec3){0.9, 0, 0});
    assert_true(q.x == 1 && q.y == 0 && q.z == 0);
    q = sag_box_closest_point(&box, (sag_vec3){4, 1, -8});
    assert_true(q.x == 1 && q.y == 1 && q.z == -3);
}

// trimesh-1496: a ray through an edge or a vertex of a box was counted twice. In and out, once each.
static void trimesh_1496_edges_and_vertices_count_once(void **state) {
    (void)state;
    assert_int_equal(count(&unit, (sag_vec3){-1, -1, -1}, (sag_vec3){1, 1, 1}), 2);  // vertex to vertex
    assert_int_equal(count(&unit, (sag_vec3){-1, -1, 0.5}, (sag_vec3){1, 1, 0}), 2); // edge to edge
    assert_int_equal(count(&unit, (sag_vec3){-1, 0, 0.5}, (sag_vec3){1, 0, 0}), 2);  // in a face
    assert_int_equal(count(&unit, (sag_vec3){-1, 0, 1}, (sag_vec3){1, 0, 0}), 2);    // along an edge
    assert_int_equal(count(&unit, (sag_vec3){-1, 1, 0.5}, (sag_vec3){1, -1, 0}), 2); // touches an edge
    assert_int_equal(count(&unit, (sag_vec3){-1, -0x1p-40, 0.5}, (sag_vec3){1, 0, 0}), 0);
    // The edge x = 0, y = 1 touched from below at t = 1/4, and missed or cut by one double's step.
    sag_vec3 o = {-0.25, 0.75, 0.25}, d = {1, 1, 0};
    assert_int_equal(count(&unit, o, d), 2);
    o.y = nextafter(0.75, 1);
    assert_int_equal(count(&unit, o, d), 0);
    o.y = nextafter(0.75, 0);
    assert_int_equal(count(&unit, o, d), 2);
    o.y = 0.75, o.x = nextafter(-0.25, -1);
    assert_int_equal(count(&unit, o, d), 0);
    // t = 1/3 rounded is the same for both slabs; the exact quotients differ.
    sag_vec3 third = {3, 3, 0};
    assert_int_equal(count(&unit, (sag_vec3){-1, 0, 0.25}, third), 2);
    assert_int_equal(count(&unit, (sag_vec3){-1, 0x1p-60, 0.25}, third), 0);
    assert_int_equal(count(&unit, (sag_vec3){-1, -0x1p-60, 0.25}, third), 2);
}

// Rays aimed at the vertices of boxes of every size from every side: 0 or 2, never 1, from outside; and a ray
// through the vertex into the middle always 2.
static void vertices_from_everywhere(void **state) {
    (void)state;
    rng r = rng_make(21);
    for (int i = 0; i < 20000; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 a = rng_vec3(&r, scale), b = rng_vec3(&r, scale);
        sag_box box = {{fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)},
                       {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)}};
        uint32_t v = rng_below(&r, 8);
        sag_vec3 vertex = {v & 1 ? box.max.x : box.min.x, v & 2 ? box.max.y : box.min.y,
                           v & 4 ? box.max.z : box.min.z};
        sag_vec3 middle = sag_scale(sag_add(box.min, box.max), 0.5);
        sag_vec3 outside = sag_madd(vertex, rng_log_uniform(&r, 1e-3, 1e3) * 2, sag_sub(vertex, middle));
        size_t n = count(&box, outside, sag_sub(vertex, outside));
        assert_true(n == 0 || n == 2);
        n = count(&box, outside, sag_sub(middle, outside));
        assert_int_equal(n, 2);
        sag_ray from_vertex = sag_ray_make(vertex, sag_sub(middle, vertex));
        from_vertex.t_min = -INFINITY;
        assert_int_equal(sag_box_crossings(&box, &from_vertex, NULL, 0), 2);
    }
}

static void properties(void **state) {
    (void)state;
    rng r = rng_make(22);
    for (int i = 0; i < 40; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 center = i % 4 == 0 ? (sag_vec3){0, 0, 0} : rng_vec3(&r, 3 * scale);
        sag_vec3 half = {scale * (0.1 + rng_unit(&r)), scale * (0.1 + rng_unit(&r)),
                         scale * (0.1 + rng_unit(&r))};
        sag_box box = {sag_sub(center, half), sag_add(center, half)};
        if (i % 4 == 1) box.min = sag_vec3_make(0, 0, 0), box.max = sag_scale(half, 2), center = half;
        shape_case c = {&sagi_shape_classes[SAG_SHAPE_BOX], &box, center, sag_length(half), LEAVING_CONVEX};
        assert_int_equal(sag_box_validate(&box, NULL), SAG_OK);
        check_verbs(&c, &r, 2000);
        check_surfaces(&c, &r, 2000);
        check_spawned(&c, &r, 2000);
        check_closest_point(&c, &r, 200);
        check_bad_rays(&c);
        if (i < 12) check_area_and_samples(&c, &r, 10000), check_volume(&c, &r, 10000);
    }
}

static void messages(void **state) {
    (void)state;
    sag_error error;
    sag_box box = {{0, 2, 0}, {1, 1, 1}};
    assert_int_equal(sag_box_validate(&box, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "box: min (0, 2, 0) must be below max (1, 1, 1)"));
    box.max.x = INFINITY;
    assert_int_equal(sag_box_validate(&box, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "box: max (inf, 1, 1)"));
    sag_box flat = {{0, 0, 0}, {1, 1, 0}};
    sag_surface s;
    assert_int_equal(count(&flat, (sag_vec3){0.5, 0.5, 1}, (sag_vec3){0, 0, -1}), 0);
    assert_false(sag_box_sample(&flat, (sag_vec2){0, 0}, &s));
    sag_box3 bounds = sag_box_bounds(&flat);
    assert_true(sag_box3_is_empty(&bounds));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values),
        cmocka_unit_test(trimesh_1496_edges_and_vertices_count_once),
        cmocka_unit_test(vertices_from_everywhere),
        cmocka_unit_test(properties),
        cmocka_unit_test(messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
