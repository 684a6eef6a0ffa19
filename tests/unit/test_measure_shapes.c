// SPDX-License-Identifier: MIT
// sag_measure: closed forms against the textbook and against rays, under transforms and instances; meshes
// against both; what is not closed.
#include "support/context.h"
#include "support/meshes.h"
#include <sagitta/measure.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static void assert_near(double value, double right, double relative) {
    if (!(fabs(value - right) <= relative * fabs(right)))
        fail_msg("%.17g is not within %g of %.17g", value, relative, right);
}

// Measures a scene and gives it up.
static sag_measurement measured(sag_scene *scene, sag_measure_options options) {
    sag_error error;
    sag_measurement m;
    if (sag_scene_commit(scene, &error) != SAG_OK) fail_msg("%s", error.message);
    if (sag_measure(scene, &options, &m, &error) != SAG_OK) fail_msg("%s", error.message);
    sag_scene_destroy(scene);
    return m;
}

static sag_body measured_shape(sag_shape_kind kind, const void *shape, const sag_affine *map,
                               sag_measure_options options) {
    sag_scene *scene = sag_scene_create(context);
    const uint32_t id = sag_add_shape(scene, kind, shape);
    assert_int_equal(id, 0);
    if (map) assert_int_equal(sag_geometry_set_transform(scene, id, map), SAG_OK);
    sag_measurement m = measured(scene, options);
    assert_int_equal(m.body_count, 1);
    const sag_body body = m.bodies[0];
    sag_measurement_clear(&m);
    return body;
}

static const sag_measure_options exact = {.no_thickness = true};

// Volume, area, centre z and the moments about the axes, from the books (Beer & Johnston, Vector Mechanics).
static void assert_body(sag_shape_kind kind, const void *shape, double volume, double area, double center_z,
                        double jx, double jz) {
    const sag_body b = measured_shape(kind, shape, NULL, exact);
    assert_int_equal(b.state, SAG_BODY_CLOSED);
    assert_false(b.by_rays);
    assert_near(b.volume.value, volume, 1e-14);
    assert_near(b.area.value, area, 1e-13);
    assert_true(fabs(b.center[2].value - center_z) < 1e-14);
    assert_near(b.inertia[0][0].value, jx, 1e-14);
    assert_near(b.inertia[2][2].value, jz, 1e-14);
}

static void closed_forms_are_those_of_the_books(void **state) {
    (void)state;
    const double v = 32 * PI / 3;
    assert_body(SAG_SHAPE_SPHERE, &(sag_sphere){.radius = 2}, v, 16 * PI, 0, v * 1.6, v * 1.6);
    assert_body(SAG_SHAPE_ELLIPSOID, &(sag_ellipsoid){.radii = {2, 2, 2}}, v, 16 * PI, 0, v * 1.6, v * 1.6);
    assert_body(SAG_SHAPE_BOX, &(sag_box){{-1, 0, 0}, {2, 4, 5}}, 60, 94, 2.5, 60 * 41 / 12.0,
                60 * 25 / 12.0);
    assert_body(SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 2, .z_min = 0, .z_max = 3, .closed = true},
                12 * PI, 20 * PI, 1.5, 12 * PI * (12 + 9) / 12, 12 * PI * 2);
    assert_body(SAG_SHAPE_CONE, &(sag_cone){.radius = 3, .height = 4, .closed = true}, 12 * PI, 24 * PI, 1,
                12 * PI * (0.15 * 9 + 0.0375 * 16), 12 * PI * 2.7);
    // z = ρ²: V = π/2 h², centre 2h/3, J_z = V ρ²/3, ∫ z² about the centre V h²/18.
    assert_body(SAG_SHAPE_PARABOLOID, &(sag_paraboloid){.radius = 2, .z_max = 4, .closed = true}, 8 * PI,
                PI / 6 * (17 * sqrt(17) - 1) + 4 * PI, 8 / 3.0, 8 * PI * (4 / 6.0 + 16 / 18.0),
                8 * PI * 4 / 3.0);
    const double ring = 2 * PI * PI * 3;
    assert_body(SAG_SHAPE_TORUS, &(sag_torus){3, 1}, ring, 12 * PI * PI, 0, ring * (4.5 + 5 / 8.0),
                ring * 9.75);
    // A spindle with R = 0 is a ball.
    assert_body(SAG_SHAPE_TORUS, &(sag_torus){0, 2}, v, 16 * PI, 0, v * 1.6, v * 1.6);
    // A capsule without length is a ball; a hyperboloid of a vertical segment a cylinder, of a slanted one
    // in a plane with the axis a cone.
    assert_body(SAG_SHAPE_CAPSULE, &(sag_capsule){.radius = 2}, v, 16 * PI, 0, v * 1.6, v * 1.6);
    assert_body(SAG_SHAPE_HYPERBOLOID, &(sag_hyperboloid){.p1 = {2, 0, 0}, .p2 = {2, 0, 3}, .closed = true},
                12 * PI, 20 * PI, 1.5, 12 * PI * (12 + 9) / 12, 12 * PI * 2);
    assert_body(SAG_SHAPE_HYPERBOLOID, &(sag_hyperboloid){.p1 = {3, 0, 0}, .p2 = {0, 0, 4}, .closed = true},
                12 * PI, 24 * PI, 1, 12 * PI * (0.15 * 9 + 0.0375 * 16), 12 * PI * 2.7);
    const sag_quadric ball = {.coefficients = {1, 1, 1, 0, 0, 0, 0, 0, -1, -3},
                              .clip = {{-4, -4, -4}, {4, 4, 4}}};
    assert_body(SAG_SHAPE_QUADRIC, &ball, v, 16 * PI, 1, v * 1.6, v * 1.6);
    // The corner tetrahedron: the unit simplex.
    const sag_half_space planes[] = {{{-1, 0, 0}, 0}, {{0, -1, 0}, 0}, {{0, 0, -1}, 0}, {{1, 1, 1}, 1}};
    assert_body(SAG_SHAPE_POLYHEDRON, &(sag_polyhedron){planes, 4}, 1 / 6.0, 1.5 + sqrt(3) / 2, 0.25, 0.0125,
                0.0125);
}

// Exact and sampled numbers of one body: the sampled intervals, half as wide again, hold the exact ones.
static void assert_agree(const sag_body *a, const sag_body *s, const char *what) {
    const struct {
        const char *name;
        sag_estimate exact, sampled;
    } pairs[] = {
        {"volume", a->volume, s->volume},
        {"area", a->area, s->area},
        {"x", a->center[0], s->center[0]},
        {"y", a->center[1], s->center[1]},
        {"z", a->center[2], s->center[2]},
        {"Jxx", a->inertia[0][0], s->inertia[0][0]},
        {"Jyy", a->inertia[1][1], s->inertia[1][1]},
        {"Jzz", a->inertia[2][2], s->inertia[2][2]},
        {"Jxy", a->inertia[0][1], s->inertia[0][1]},
        {"Jxz", a->inertia[0][2], s->inertia[0][2]},
        {"Jyz", a->inertia[1][2], s->inertia[1][2]},
    };
    assert_true(s->by_rays && s->reached);
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        const double slack = 1.5 * pairs[i].sampled.error + pairs[i].exact.error + 1e-12 * a->volume.value;
        if (!(fabs(pairs[i].exact.value - pairs[i].sampled.value) <= slack))
            fail_msg("%s, %s: %.17g, by rays %.17g +- %g", what, pairs[i].name, pairs[i].exact.value,
                     pairs[i].sampled.value, pairs[i].sampled.error);
    }
    assert_true(s->volume.error <= 5e-3 * s->volume.value && s->area.error <= 5e-3 * s->area.value);
}

// Every closed shape, plain, and under a map that leaves nothing similar.
static void rays_agree_with_closed_forms(void **state) {
    (void)state;
    const sag_half_space planes[] = {{{-1, 0, 0}, 0}, {{0, -1, 0}, 0}, {{0, 0, -1}, 0}, {{1, 2, 1}, 1}};
    const struct {
        sag_shape_kind kind;
        const void *shape;
    } shapes[] = {
        {SAG_SHAPE_SPHERE, &(sag_sphere){.center = {1, 2, 3}, .radius = 2}},
        {SAG_SHAPE_ELLIPSOID, &(sag_ellipsoid){.center = {1, 0, 0}, .radii = {1, 2, 3}}},
        {SAG_SHAPE_BOX, &(sag_box){{-1, 0, 0}, {2, 4, 5}}},
        {SAG_SHAPE_ORIENTED_BOX, &(sag_oriented_box){{1, 1, 1}, {{1, 1, 0}, {-1, 1, 0.5}, {0, 0, 2}}}},
        {SAG_SHAPE_POLYHEDRON, &(sag_polyhedron){planes, 4}},
        {SAG_SHAPE_CAPSULE, &(sag_capsule){{0, 0, 1}, {1, 2, 2}, 0.5}},
        {SAG_SHAPE_TORUS, &(sag_torus){2, 0.5}},
        {SAG_SHAPE_TORUS, &(sag_torus){0.5, 1}},
        {SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 1, .z_min = -1, .z_max = 2, .closed = true}},
        {SAG_SHAPE_CONE, &(sag_cone){.radius = 1, .height = 2, .closed = true}},
        {SAG_SHAPE_PARABOLOID, &(sag_paraboloid){.radius = 1, .z_min = 0.2, .z_max = 2, .closed = true}},
        {SAG_SHAPE_HYPERBOLOID, &(sag_hyperboloid){.p1 = {-1, 1, -1}, .p2 = {1, 1, 2}, .closed = true}},
        {SAG_SHAPE_HYPERBOLOID2,
         &(sag_hyperboloid2){.a = 1, .c = 1, .z_min = -2, .z_max = 3, .closed = true}},
        {SAG_SHAPE_QUADRIC, &(sag_quadric){.coefficients = {2, 1, 0.5, 0.2, 0.1, 0, 0.3, 0, 0, -1},
                                           .clip = {{-2, -2, -2}, {2, 2, 2}}}},
    };
    const sag_affine sheared = {{{1, 0.5, 0, 3}, {0, 2, -0.25, 1}, {0.3, 0, -0.5, 7}}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int k = 0; k < 2; k++) {
            const sag_affine *map = k ? &sheared : NULL;
            const sag_body a = measured_shape(shapes[i].kind, shapes[i].shape, map, exact);
            const sag_body s = measured_shape(
                shapes[i].kind, shapes[i].shape, map,
                (sag_measure_options){.error = 5e-3, .no_thickness = true, .sample_all = true, .seed = i});
            assert_agree(&a, &s, sag_shape_kind_name(shapes[i].kind));
        }
}

static void maps_make_other_shapes_of_shapes(void **state) {
    (void)state;
    // A scaled sphere is an ellipsoid; through a transform, and through an instance.
    const sag_affine squeezed = sag_affine_scale(sag_vec3_make(1, 2, 3));
    const sag_sphere ball = {.radius = 2};
    const sag_body right =
        measured_shape(SAG_SHAPE_ELLIPSOID, &(sag_ellipsoid){.radii = {2, 4, 6}}, NULL, exact);
    const sag_body one = measured_shape(SAG_SHAPE_SPHERE, &ball, &squeezed, exact);
    sag_scene *inner = sag_scene_create(context), *outer = sag_scene_create(context);
    sag_add_sphere(inner, &ball);
    assert_int_equal(sag_scene_commit(inner, NULL), SAG_OK);
    sag_add_instance(outer, inner, &squeezed);
    sag_measurement m = measured(outer, exact);
    sag_scene_destroy(inner);
    assert_int_equal(m.body_count, 1);
    assert_int_equal(m.bodies[0].instance_depth, 1);
    const sag_body *bodies[2] = {&one, &m.bodies[0]};
    for (int i = 0; i < 2; i++) {
        assert_false(bodies[i]->by_rays);
        assert_near(bodies[i]->volume.value, right.volume.value, 1e-14);
        assert_near(bodies[i]->area.value, right.area.value, 1e-13);
        for (int k = 0; k < 3; k++) {
            assert_near(bodies[i]->principal[k].value, right.principal[k].value, 1e-14);
            assert_near(bodies[i]->inertia[k][k].value, right.inertia[k][k].value, 1e-14);
        }
    }
    sag_measurement_clear(&m);
    // A mesh under the same map, of a cube.
    test_mesh cube = test_mesh_cube();
    const sag_body box = measured_shape(SAG_SHAPE_MESH, &cube.mesh, &squeezed, exact);
    assert_near(box.volume.value, 48, 1e-15);
    assert_near(box.area.value, 88, 1e-15);
    assert_near(box.inertia[0][0].value, 48 * (16 + 36) / 12.0, 1e-15);
    test_mesh_free(&cube);
}

// Instances share one measurement; mirrored, turned and scaled they are what they are.
static void instances_are_mapped(void **state) {
    (void)state;
    sag_scene *inner = sag_scene_create(context), *outer = sag_scene_create(context);
    test_mesh cube = test_mesh_cube();
    sag_add_mesh(inner, &cube.mesh);
    sag_add_cone(inner, &(sag_cone){.radius = 1, .height = 2, .closed = true});
    assert_int_equal(sag_scene_commit(inner, NULL), SAG_OK);
    const sag_affine maps[] = {sag_affine_identity(), sag_affine_scale(sag_vec3_make(3, 3, -3)),
                               sag_affine_rotate(0.7, sag_vec3_make(1, 2, 3)),
                               sag_affine_scale(sag_vec3_make(1, 1, 5))};
    for (int i = 0; i < 4; i++) sag_add_instance(outer, inner, &maps[i]);
    sag_measurement m = measured(outer, (sag_measure_options){0});
    sag_scene_destroy(inner);
    test_mesh_free(&cube);
    assert_int_equal(m.body_count, 8);
    const sag_body *b = m.bodies;
    assert_near(b[2].volume.value, 8 * 27, 1e-15);
    assert_near(b[2].area.value, 24 * 9, 1e-15);
    assert_false(b[2].inside_out);
    assert_near(b[2].thickness.percentiles[3], 6, 1e-12);
    assert_int_equal(b[2].rays, 0); // the first one's
    assert_near(b[3].center[2].value, -1.5, 1e-14);
    assert_near(b[4].principal[2].value, b[0].principal[2].value, 1e-14);
    assert_near(b[5].volume.value, b[1].volume.value, 1e-14);
    for (int i = 0; i < 3; i++) assert_near(b[5].principal[i].value, b[1].principal[i].value, 1e-13);
    assert_near(b[6].volume.value, 40, 1e-15);
    assert_near(b[6].area.value, 8 + 80, 1e-15);
    assert_near(b[6].thickness.max, 10, 1e-12);
    // The area of a stretched cone has no closed form here: r = 1, h = 10.
    assert_true(b[7].by_rays && b[7].reached);
    assert_true(fabs(b[7].area.value - PI * (1 + sqrt(101))) <= 2 * b[7].area.error);
    assert_true(b[7].area.error <= 1e-4 * b[7].area.value);
    sag_measurement_clear(&m);
}

static void meshes_far_small_and_inside_out(void **state) {
    (void)state;
    rng r = rng_make(1);
    const double scales[] = {1, 1e-9, 1e9};
    for (int i = 0; i < 3; i++) {
        test_mesh cube = test_mesh_cube();
        const double s = scales[i];
        test_mesh_move(&cube, s, sag_vec3_make(1e6 * s, -2e6 * s, 3e6 * s), 0, &r);
        const sag_body b = measured_shape(SAG_SHAPE_MESH, &cube.mesh, NULL, (sag_measure_options){0});
        assert_int_equal(b.state, SAG_BODY_CLOSED);
        assert_near(b.volume.value, 8 * s * s * s, 1e-8); // the coordinates' own rounding
        assert_near(b.principal[0].value, 16 / 3.0 * s * s * s * s * s, 1e-8);
        assert_near(b.center[2].value, 3e6 * s, 1e-15);
        assert_near(b.thickness.min, 2 * s, 1e-8);
        for (uint32_t k = 0; k < cube.mesh.triangle_count; k++) {
            const uint32_t swap = cube.triangles[3 * k];
            cube.triangles[3 * k] = cube.triangles[3 * k + 1], cube.triangles[3 * k + 1] = swap;
        }
        const sag_body turned = measured_shape(SAG_SHAPE_MESH, &cube.mesh, NULL, exact);
        assert_true(turned.inside_out && !b.inside_out);
        assert_true(turned.volume.value == b.volume.value);
        test_mesh_free(&cube);
    }
    // A fine ball: moments of the inscribed polyhedron approach the ball's, from below.
    test_mesh ball = test_mesh_sphere(5);
    const sag_body b = measured_shape(SAG_SHAPE_MESH, &ball.mesh, NULL, exact);
    assert_true(b.volume.value < 4 * PI / 3 && b.volume.value > 4 * PI / 3 * (1 - 2e-3));
    assert_near(b.inertia[0][0].value, b.inertia[2][2].value, 1e-12);
    const sag_body s = measured_shape(SAG_SHAPE_MESH, &ball.mesh, NULL,
                                      (sag_measure_options){.error = 5e-3, .sample_all = true});
    assert_agree(&b, &s, "mesh");
    test_mesh_free(&ball);
}

// Regression: a mesh of which one triangle is turned round is closed for rays; its exact sum would be wrong.
static void a_turned_triangle_is_measured_by_rays(void **state) {
    (void)state;
    test_mesh cube = test_mesh_cube();
    const uint32_t swap = cube.triangles[0];
    cube.triangles[0] = cube.triangles[1], cube.triangles[1] = swap;
    const sag_body b = measured_shape(SAG_SHAPE_MESH, &cube.mesh, NULL, (sag_measure_options){0});
    assert_int_equal(b.state, SAG_BODY_CLOSED);
    assert_true(b.by_rays && b.overlaps);
    assert_int_equal(b.report.flipped_edge_count, 3);
    assert_near(b.volume.value, 8, 1e-3);
    assert_near(b.area.value, 24, 1e-15);
    assert_near(b.thickness.percentiles[3], 2, 1e-12);
    test_mesh_free(&cube);
}

static void what_is_not_closed_says_so(void **state) {
    (void)state;
    test_mesh cube = test_mesh_cube();
    cube.mesh.triangle_count--;
    sag_scene *scene = sag_scene_create(context);
    sag_add_mesh(scene, &cube.mesh);
    sag_add_plane(scene, &(sag_plane){.normal = {0, 0, 1}});
    sag_add_cylinder(scene, &(sag_cylinder){.radius = 1, .z_max = 2});
    sag_add_sphere(scene, &(sag_sphere){.radius = 1, .phi_max_rad = PI});
    const sag_half_space slab[] = {{{0, 0, 1}, 1}, {{0, 0, -1}, 1}};
    sag_add_polyhedron(scene, &(sag_polyhedron){slab, 2});
    sag_add_disk(scene, &(sag_disk){.normal = {0, 0, 1}, .radius = 2});
    const sag_affine stretched = sag_affine_scale(sag_vec3_make(3, 1, 1));
    sag_geometry_set_transform(scene, 5, &stretched);
    sag_measurement m = measured(scene, (sag_measure_options){0});
    test_mesh_free(&cube);
    assert_int_equal(m.body_count, 6);
    const sag_body_state states[] = {SAG_BODY_OPEN, SAG_BODY_UNBOUNDED, SAG_BODY_OPEN,
                                     SAG_BODY_OPEN, SAG_BODY_UNBOUNDED, SAG_BODY_OPEN};
    const double areas[] = {22, INFINITY, 4 * PI, 2 * PI, INFINITY, 12 * PI};
    for (int i = 0; i < 6; i++) {
        assert_int_equal(m.bodies[i].state, states[i]);
        assert_int_equal(m.bodies[i].geometry, i);
        assert_true(m.bodies[i].area.value == areas[i] ||
                    fabs(m.bodies[i].area.value - areas[i]) < 1e-13 * areas[i]);
        assert_int_equal(m.bodies[i].thickness.sample_count, 0);
    }
    assert_true(isnan(m.bodies[0].volume.value) && isinf(m.bodies[1].volume.value));
    assert_int_equal(m.bodies[0].report.open_edge_count, 3);
    assert_int_equal(m.rays, 0);
    sag_measurement_clear(&m);
    sag_measurement_clear(&m);
    sag_measurement_clear(NULL);
}

// Wall thickness by the inward ray, where it is known everywhere.
static void walls_are_as_thick_as_they_are(void **state) {
    (void)state;
    const sag_body box =
        measured_shape(SAG_SHAPE_BOX, &(sag_box){{0, 0, 0}, {1, 2, 10}}, NULL, (sag_measure_options){0});
    const sag_thickness *t = &box.thickness;
    assert_near(t->min, 1, 1e-12);
    assert_near(t->max, 10, 1e-12);
    assert_near(t->percentiles[1], 1, 1e-12);
    assert_near(t->percentiles[3], 1, 1e-12); // 40 of 64 units of area
    assert_near(t->percentiles[4], 2, 1e-12);
    assert_true(fabs(t->mean.value - (40 * 1 + 20 * 2 + 4 * 10) / 64.0) <= 2 * t->mean.error + 1e-12);
    double sum = 0;
    for (int i = 0; i < SAG_THICKNESS_BINS; i++) sum += t->histogram[i];
    assert_near(sum, 1, 1e-12);
    assert_near(t->histogram[SAG_THICKNESS_BINS / 10], 40 / 64.0, 1e-2);
    // A ring is as thick as its tube; a needle's wall, a millionth of its length.
    const sag_body ring =
        measured_shape(SAG_SHAPE_TORUS, &(sag_torus){2, 0.25}, NULL, (sag_measure_options){0});
    assert_near(ring.thickness.min, 0.5, 1e-12);
    assert_near(ring.thickness.max, 0.5, 1e-12);
    const sag_body needle = measured_shape(SAG_SHAPE_CAPSULE, &(sag_capsule){{0, 0, 0}, {0, 1, 0}, 5e-7},
                                           NULL, (sag_measure_options){0});
    assert_near(needle.thickness.percentiles[3], 1e-6, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms_are_those_of_the_books),
        cmocka_unit_test(rays_agree_with_closed_forms),
        cmocka_unit_test(maps_make_other_shapes_of_shapes),
        cmocka_unit_test(instances_are_mapped),
        cmocka_unit_test(meshes_far_small_and_inside_out),
        cmocka_unit_test(a_turned_triangle_is_measured_by_rays),
        cmocka_unit_test(what_is_not_closed_says_so),
        cmocka_unit_test(walls_are_as_thick_as_they_are),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
