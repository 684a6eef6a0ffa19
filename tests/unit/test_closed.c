// SPDX-License-Identifier: MIT
// Which shapes bound a volume (shapes/closed.h) and what a solid's parts are told when they do not.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "support/failing_allocator.h"
#include "support/meshes.h"
#include "support/random_shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const sag_shape_kind always[] = {SAG_SHAPE_PLANE,        SAG_SHAPE_ELLIPSOID,  SAG_SHAPE_BOX,
                                        SAG_SHAPE_ORIENTED_BOX, SAG_SHAPE_POLYHEDRON, SAG_SHAPE_CAPSULE,
                                        SAG_SHAPE_TORUS};
static const sag_shape_kind never[] = {SAG_SHAPE_DISK,     SAG_SHAPE_RECTANGLE,      SAG_SHAPE_POLYGON,
                                       SAG_SHAPE_TRIANGLE, SAG_SHAPE_BILINEAR_PATCH, SAG_SHAPE_SPHERES,
                                       SAG_SHAPE_USER};

static bool has(const char *text, const char *part) { return text != NULL && strstr(text, part) != NULL; }

static void kinds(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof always / sizeof *always; i++) assert_null(sagi_shape_flaw(always[i], NULL));
    for (size_t i = 0; i < sizeof never / sizeof *never; i++)
        assert_non_null(sagi_shape_flaw(never[i], NULL));
    assert_null(
        sagi_shape_flaw(SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 1, .z_max = 1, .closed = true}));
    assert_true(
        has(sagi_shape_flaw(SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 1, .z_max = 1}), ".closed"));
    assert_true(has(sagi_shape_flaw(SAG_SHAPE_CONE, &(sag_cone){.radius = 1, .height = 1}), ".closed"));
    const sag_sphere whole = {.radius = 2}, whole_too = {.radius = 2, .z_min = -2, .z_max = 2},
                     cut = {.radius = 2, .z_min = -2, .z_max = 1}, swept = {.radius = 2, .phi_max_rad = 3};
    assert_null(sagi_shape_flaw(SAG_SHAPE_SPHERE, &whole));
    assert_null(sagi_shape_flaw(SAG_SHAPE_SPHERE, &whole_too));
    assert_true(has(sagi_shape_flaw(SAG_SHAPE_SPHERE, &cut), ".z_min"));
    assert_true(has(sagi_shape_flaw(SAG_SHAPE_SPHERE, &swept), ".phi_max_rad"));
}

static const char *flaw_of(const double c[10], double size) {
    sag_quadric q = {.clip = {{-size, -size, -size}, {size, size, size}}};
    memcpy(q.coefficients, c, sizeof q.coefficients);
    return sagi_shape_flaw(SAG_SHAPE_QUADRIC, &q);
}

static void quadrics(void **state) {
    (void)state;
    const double ball[10] = {1, 1, 1, 0, 0, 0, 0, 0, 0, -1},
                 turned_out[10] = {-1, -1, -1, 0, 0, 0, 0, 0, 0, 1},
                 tilted[10] = {2, 3, 1, 0.5, -0.25, 0.75, 0.1, 0, -0.2, -1},
                 pipe[10] = {1, 1, 0, 0, 0, 0, 0, 0, 0, -1}, paraboloid[10] = {1, 1, 0, 0, 0, 0, 0, 0, -1, 0},
                 aside[10] = {1, 1, 1, 0, 0, 0, -1, 0, 0, 0.75};
    assert_null(flaw_of(ball, 1.001));
    assert_null(flaw_of(turned_out, 1.001));
    assert_null(flaw_of(tilted, 2));
    assert_null(flaw_of(aside, 1.6)); // within 0.5 of (1, 0, 0)
    assert_non_null(flaw_of(aside, 1.4));
    assert_non_null(flaw_of(ball, 1)); // touches the box
    assert_non_null(flaw_of(ball, 0.99));
    assert_non_null(flaw_of(tilted, 0.9));
    assert_non_null(flaw_of(pipe, 5));
    assert_non_null(flaw_of(paraboloid, 5));
    // Only the middles of the faces are cut: where the gradient is 0 in them.
    for (int k = 0; k < 3; k++) {
        double c[10] = {1, 1, 1, 0, 0, 0, 0, 0, 0, -1};
        c[k] = 0.9;
        assert_non_null(flaw_of(c, 1.05));
        assert_null(flaw_of(c, 1.06));
    }
}

// A random quadric is closed when lines cross it evenly; said to be closed, they all do.
static void quadrics_said_closed_are_crossed_evenly(void **state) {
    (void)state;
    rng r = rng_make(7);
    int closed = 0;
    for (int i = 0; i < 3000; i++) {
        sag_quadric q = {.clip = {{-2, -2, -2}, {2, 2, 2}}};
        for (int k = 0; k < 10; k++) q.coefficients[k] = rng_uniform(&r, -1, 1) * (k < 3 || k == 9 ? 2 : 0.4);
        if (sagi_shape_flaw(SAG_SHAPE_QUADRIC, &q) != NULL) continue;
        closed++;
        for (int k = 0; k < 50; k++) {
            sag_ray ray = {.origin = {rng_uniform(&r, -3, 3), rng_uniform(&r, -3, 3), rng_uniform(&r, -3, 3)},
                           .direction = rng_direction(&r),
                           .t_min = -INFINITY,
                           .t_max = INFINITY};
            assert_int_equal(sag_quadric_crossings(&q, &ray, NULL, 0) % 2, 0);
        }
    }
    assert_true(closed > 100);
}

// Where a line begins, against the place of a point and the crossings up to it.
static void lines_that_begin_inside(void **state) {
    (void)state;
    rng r = rng_make(8);
    int inside = 0;
    for (int i = 0; i < 20000; i++) {
        sag_half_space planes[3];
        for (int k = 0; k < 3; k++) planes[k] = (sag_half_space){rng_direction(&r), rng_uniform(&r, 0.1, 1)};
        const sag_polyhedron polyhedron = {planes, 1 + (uint32_t)i % 3};
        const sag_plane plane = {.point = sag_scale(planes[0].normal, planes[0].offset),
                                 .normal = planes[0].normal};
        sag_ray ray = {.origin = {rng_uniform(&r, -3, 3), rng_uniform(&r, -3, 3), rng_uniform(&r, -3, 3)},
                       .direction = rng_direction(&r),
                       .t_min = -INFINITY};
        if (i % 5 == 0) // along the face
            ray.direction = sag_cross(planes[0].normal, ray.direction);
        bool begins = sagi_shape_begins_inside(SAG_SHAPE_POLYHEDRON, &polyhedron, &ray);
        bool odd = sag_polyhedron_crossings(&polyhedron, &ray, NULL, 0) % 2 == 1;
        assert_int_equal(begins != odd, sag_polyhedron_contains(&polyhedron, ray.origin));
        inside += begins;
        begins = sagi_shape_begins_inside(SAG_SHAPE_PLANE, &plane, &ray);
        odd = sag_plane_crossings(&plane, &ray, NULL, 0) % 2 == 1;
        assert_int_equal(begins != odd, sag_plane_contains(&plane, ray.origin));
    }
    assert_true(inside > 1000);
    const sag_sphere ball = {.radius = 1};
    sag_ray ray = sag_ray_make((sag_vec3){0, 0, 0}, (sag_vec3){0, 0, 1});
    assert_false(sagi_shape_begins_inside(SAG_SHAPE_SPHERE, &ball, &ray));
}

// What is found of a mesh, whichever allocation fails.
static sagi_odd_edges odd_edges(const sag_mesh *mesh) {
    for (size_t k = 0;; k++) {
        sagi_odd_edges odd;
        failing_allocator books = {.fail_at = k};
        sag_context_options options = {.allocator = failing_allocator_make(&books)};
        sag_context *context = sag_context_create(&options);
        sag_status status = context ? sagi_mesh_find_odd_edges(context, mesh, &odd) : SAG_ERROR_MEMORY;
        sag_context_destroy(context);
        failing_allocator_assert_empty(&books);
        if (status == SAG_OK) {
            assert_int_equal(odd.count == 0, sagi_mesh_is_closed(mesh));
            return odd;
        }
        assert_int_equal(status, SAG_ERROR_MEMORY);
    }
}

static void meshes(void **state) {
    (void)state;
    test_mesh m = test_mesh_torus(20, 12);
    assert_int_equal(odd_edges(&m.mesh).count, 0);
    uint32_t first[3] = {m.triangles[0], m.triangles[1], m.triangles[2]};
    m.triangles[1] = first[2], m.triangles[2] = first[1]; // turned over: no matter
    assert_int_equal(odd_edges(&m.mesh).count, 0);

    m.mesh.triangles += 3, m.mesh.triangle_count--; // without the first
    sagi_odd_edges odd = odd_edges(&m.mesh);
    assert_true(odd.count == 3 && odd.triangles == 1 && odd.on_it == SAG_INVALID_ID);
    assert_true(odd.vertex[0] == first[0] || odd.vertex[0] == first[1] || odd.vertex[0] == first[2]);
    m.mesh.triangles -= 3, m.mesh.triangle_count++;

    uint32_t second[3] = {m.triangles[3], m.triangles[4], m.triangles[5]};
    memcpy(m.triangles + 3, first, sizeof first); // twice the first: as if neither were there
    assert_int_equal(odd_edges(&m.mesh).count, 4);
    memcpy(m.triangles + 3, second, sizeof second);
    m.positions[3 * first[0]] = NAN; // its triangles are not there
    assert_true(odd_edges(&m.mesh).count > 3);
    test_mesh_free(&m);
}

// Three edges meet where three triangles stand on one, as in a T-shaped wall; twice two are no harm.
static void crowded_edges(void **state) {
    (void)state;
    // Two tetrahedra that share the edge 0 1: four triangles there.
    const float p[18] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, -1, 0, 0, -1, -1, 0};
    uint32_t t[27] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2, 0, 1, 4, 0, 4, 5, 0, 5, 1, 1, 5, 4, 0, 1, 3};
    sag_mesh mesh = {.positions_f32 = p, .triangles = t, .vertex_count = 6, .triangle_count = 8};
    assert_int_equal(odd_edges(&mesh).count, 0);
    mesh.triangle_count = 9; // a wall between 0 1 and 3: five and three triangles, and one edge fewer even
    sagi_odd_edges odd = odd_edges(&mesh);
    assert_true(odd.count == 3 && odd.vertex[0] == 0 && odd.vertex[1] == 1 && odd.triangles == 5);
}

// A unit square's edge from x = 0 to 1 at y = z = 0 that one side has in one piece and the other in two.
static void triangles_without_area_close(void **state) {
    (void)state;
    const float p[15] = {0, 0, 0, 1, 0, 0, 0.5F, 0, 0, 0.5F, 1, 0, 0.5F, 0.5F, 1};
    // A tetrahedron 0 1 3 4 whose face 0 1 4 is cut in two at 2.
    const uint32_t t[15] = {0, 1, 3, 1, 4, 3, 0, 3, 4, 0, 4, 2, 2, 4, 1};
    uint32_t with_sliver[18];
    sag_mesh mesh = {.positions_f32 = p, .triangles = t, .vertex_count = 5, .triangle_count = 5};
    sagi_odd_edges odd = odd_edges(&mesh);
    assert_true(odd.count == 3 && odd.vertex[0] == 0 && odd.vertex[1] == 1 && odd.on_it == 2);
    memcpy(with_sliver, t, sizeof t);
    with_sliver[15] = 0, with_sliver[16] = 2, with_sliver[17] = 1;
    mesh.triangles = with_sliver, mesh.triangle_count = 6;
    assert_int_equal(odd_edges(&mesh).count, 0);
    with_sliver[16] = 1; // from 0 to 1 and back: joins nothing
    assert_int_equal(odd_edges(&mesh).count, 3);
}

// As STL files have it: a vertex for each corner, and −0.
static void positions_decide(void **state) {
    (void)state;
    test_mesh m = test_mesh_sphere(3);
    float *soup;
    uint32_t *corners;
    const sag_mesh mesh = test_mesh_soup(&m, &soup, &corners);
    assert_int_equal(odd_edges(&mesh).count, 0);
    soup[100] = nextafterf(soup[100], 9); // one corner a little aside
    assert_int_equal(odd_edges(&mesh).count, 4);
    free(soup), free(corners);
    test_mesh_free(&m);
}

static void parts_are_told(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_scene *scene = sag_scene_create(context);
    sag_error error = {0};
    test_mesh m = test_mesh_cube();
    sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    sag_add_mesh(scene, &m.mesh);
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    assert_int_equal(sagi_solid_check_parts(sagi_scene_snapshot(scene), &error), SAG_OK);
    m.mesh.triangle_count--;
    uint32_t open = sag_add_mesh(scene, &m.mesh);
    // Moved, too.
    sag_affine half = sag_affine_scale((sag_vec3){0.3, 0.3, 0.3});
    sag_geometry_set_transform(scene, open, &half);
    uint32_t cylinder = sag_add_cylinder(scene, &(sag_cylinder){.radius = 1, .z_max = 1});
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    assert_int_equal(sagi_solid_check_parts(sagi_scene_snapshot(scene), &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "geometry 2, a mesh, is not closed: the edge between vertices "));
    assert_non_null(strstr(error.message, " has a triangle on one side only (3 such edges in all)"));
    sag_geometry_set_enabled(scene, open, false); // what is not there need not be closed
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    assert_int_equal(sagi_solid_check_parts(sagi_scene_snapshot(scene), &error), SAG_ERROR_GEOMETRY);
    assert_string_equal(error.message, "geometry 3, a cylinder, is not closed: set .closed");
    sag_geometry_remove(scene, cylinder);
    sag_scene *empty = sag_scene_create(context);
    assert_int_equal(sag_scene_commit(empty, &error), SAG_OK);
    uint32_t shown = sag_add_instance(scene, empty, NULL);
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    assert_int_equal(sagi_solid_check_parts(sagi_scene_snapshot(scene), &error), SAG_ERROR_GEOMETRY);
    assert_string_equal(error.message, "geometry 4, an instance, shows a scene that is not a solid");
    sag_geometry_remove(scene, shown);
    sag_scene_destroy(empty);
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    assert_int_equal(sagi_solid_check_parts(sagi_scene_snapshot(scene), &error), SAG_OK);
    sag_scene_destroy(scene);
    sag_context_destroy(context);
    test_mesh_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kinds),
        cmocka_unit_test(quadrics),
        cmocka_unit_test(quadrics_said_closed_are_crossed_evenly),
        cmocka_unit_test(lines_that_begin_inside),
        cmocka_unit_test(meshes),
        cmocka_unit_test(crowded_edges),
        cmocka_unit_test(triangles_without_area_close),
        cmocka_unit_test(positions_decide),
        cmocka_unit_test(parts_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
