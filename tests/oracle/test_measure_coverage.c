// SPDX-License-Identifier: MIT
// What rays measure: a 95 % interval holds the truth for about 95 % of seeds, for bodies of which the truth
// is known, for errors that are reached at once and such that are reached by doubling; solids whose volume
// and area have a name.
#include "support/context.h"
#include "support/random.h"
#include <sagitta/measure.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static sag_body measured(const sag_scene *scene, const sag_measure_options *options) {
    sag_measurement m;
    sag_error error;
    if (sag_measure(scene, options, &m, &error) != SAG_OK) fail_msg("%s", error.message);
    assert_int_equal(m.body_count, 1);
    const sag_body body = m.bodies[0];
    sag_measurement_clear(&m);
    return body;
}

static sag_scene *scene_of_shape(sag_shape_kind kind, const void *shape) {
    sag_scene *scene = sag_scene_create(context);
    sag_add_shape(scene, kind, shape);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}

static bool holds(sag_estimate interval, sag_estimate truth) {
    return fabs(interval.value - truth.value) <= interval.error;
}

// Of n seeds k hold; n p misses are expected, and twice the deviation more is too many.
static void assert_coverage(const char *what, size_t k, size_t n, double wanted) {
    const double share = (double)k / (double)n, deviation = sqrt(wanted * (1 - wanted) / (double)n);
    if (share < wanted - 0.01 - 2.5 * deviation)
        fail_msg("%s: %zu of %zu intervals of %g hold the truth", what, k, n, wanted);
}

static void intervals_hold_what_they_say(void **state) {
    (void)state;
    const sag_half_space planes[] = {{{-1, 0, 0}, 0}, {{0, -1, 0}, 0}, {{0, 0, -1}, 0}, {{1, 1, 1}, 1}};
    const struct {
        sag_shape_kind kind;
        const void *shape;
        double error, confidence;
    } cases[] = {
        {SAG_SHAPE_SPHERE, &(sag_sphere){.center = {1, 2, 3}, .radius = 2}, 1e-2, 0.95},
        {SAG_SHAPE_TORUS, &(sag_torus){2, 0.5}, 1e-2, 0.95},
        {SAG_SHAPE_CYLINDER, &(sag_cylinder){.radius = 1, .z_max = 3, .closed = true}, 1e-2, 0.5},
        {SAG_SHAPE_POLYHEDRON, &(sag_polyhedron){planes, 4}, 5e-3, 0.95},
    };
    const size_t seeds = soak(50);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sag_scene *scene = scene_of_shape(cases[i].kind, cases[i].shape);
        const sag_body truth = measured(scene, &(sag_measure_options){.no_thickness = true});
        size_t volume = 0, area = 0, center = 0, inertia = 0, principal = 0;
        for (size_t seed = 0; seed < seeds; seed++) {
            const sag_measure_options options = {.error = cases[i].error,
                                                 .confidence = cases[i].confidence,
                                                 .seed = seed,
                                                 .no_thickness = true,
                                                 .sample_all = true};
            const sag_body b = measured(scene, &options);
            volume += holds(b.volume, truth.volume);
            area += holds(b.area, truth.area);
            for (int k = 0; k < 3; k++) {
                center += holds(b.center[k], truth.center[k]);
                inertia += holds(b.inertia[k][k], truth.inertia[k][k]);
                principal += holds(b.principal[k], truth.principal[k]);
            }
        }
        const double wanted = cases[i].confidence;
        assert_coverage("volume", volume, seeds, wanted);
        assert_coverage("area", area, seeds, wanted);
        assert_coverage("centre", center / 3, seeds, wanted);
        assert_coverage("inertia", inertia / 3, seeds, wanted);
        assert_coverage("principal moments", principal / 3, seeds, wanted);
        sag_scene_destroy(scene);
    }
}

// ---- solids

static sag_body measured_solid(sag_scene *solid, const sag_solid_step *steps, uint32_t count, double error) {
    sag_error why;
    if (sag_scene_set_solid(solid, &(sag_solid){steps, count}, &why) != SAG_OK ||
        sag_scene_commit(solid, &why) != SAG_OK)
        fail_msg("%s", why.message);
    const sag_body b = measured(solid, &(sag_measure_options){.error = error, .seed = 7});
    sag_scene_destroy(solid);
    assert_int_equal(b.geometry, SAG_INVALID_ID);
    assert_true(b.by_rays && b.reached);
    return b;
}

static void assert_within(const char *what, sag_estimate e, double truth) {
    if (!(fabs(e.value - truth) <= 2 * e.error + 1e-12 * fabs(truth)))
        fail_msg("%s: %.10g +- %g, truth %.10g", what, e.value, e.error, truth);
}

static uint32_t add_cylinder(sag_scene *s, int axis) {
    const sag_cylinder c = {.radius = 1, .z_min = -2, .z_max = 2, .closed = true};
    const uint32_t id = sag_add_cylinder(s, &c);
    const sag_affine turn = sag_affine_rotate(PI / 2, axis == 0   ? (sag_vec3){0, 1, 0}
                                                      : axis == 1 ? (sag_vec3){1, 0, 0}
                                                                  : (sag_vec3){0, 0, 1});
    sag_geometry_set_transform(s, id, &turn);
    return id;
}

static const sag_solid_step two_intersect[] = {
    {SAG_SOLID_PART, 0}, {SAG_SOLID_PART, 1}, {SAG_SOLID_INTERSECTION, 2}};
static const sag_solid_step two_differ[] = {
    {SAG_SOLID_PART, 0}, {SAG_SOLID_PART, 1}, {SAG_SOLID_DIFFERENCE, 2}};

static void steinmetz_solids(void **state) {
    (void)state;
    sag_scene *two = sag_scene_create(context);
    add_cylinder(two, 0), add_cylinder(two, 1);
    const sag_body b = measured_solid(two, two_intersect, 3, 3e-3);
    assert_within("two cylinders, volume", b.volume, 16 / 3.0);
    assert_within("two cylinders, area", b.area, 16);
    assert_true(fabs(b.thickness.percentiles[3] - 2) < 1e-9); // through the axis
    sag_scene *three = sag_scene_create(context);
    add_cylinder(three, 0), add_cylinder(three, 1), add_cylinder(three, 2);
    const sag_solid_step steps[] = {
        {SAG_SOLID_PART, 0}, {SAG_SOLID_PART, 1}, {SAG_SOLID_PART, 2}, {SAG_SOLID_INTERSECTION, 3}};
    const sag_body c = measured_solid(three, steps, 4, 3e-3);
    assert_within("three cylinders, volume", c.volume, 16 - 8 * sqrt(2));
    assert_within("three cylinders, area", c.area, 48 - 24 * sqrt(2));
}

static void lens_napkin_ring_and_hollow(void **state) {
    (void)state;
    // Two balls of radius 1, their centres 1 apart: V = 5π/12, two caps of height 1/2, 2π each half.
    sag_scene *lens = sag_scene_create(context);
    sag_add_sphere(lens, &(sag_sphere){.radius = 1});
    sag_add_sphere(lens, &(sag_sphere){.center = {1, 0, 0}, .radius = 1});
    const sag_body a = measured_solid(lens, two_intersect, 3, 3e-3);
    assert_within("lens, volume", a.volume, 5 * PI / 12);
    assert_within("lens, area", a.area, 2 * PI);
    assert_within("lens, centre", a.center[0], 0.5);
    // A napkin ring of height 2: 4π/3 whatever the ball.
    sag_scene *ring = sag_scene_create(context);
    sag_add_sphere(ring, &(sag_sphere){.radius = 2});
    sag_add_cylinder(ring, &(sag_cylinder){.radius = sqrt(3), .z_min = -3, .z_max = 3, .closed = true});
    const sag_body r = measured_solid(ring, two_differ, 3, 3e-3);
    assert_within("napkin ring, volume", r.volume, 4 * PI / 3);
    assert_within("napkin ring, area", r.area, 2 * PI * 2 * 2 + 2 * PI * sqrt(3) * 2);
    // A hollow ball: both walls count as area; it is a millimetre thick.
    sag_scene *hollow = sag_scene_create(context);
    sag_add_sphere(hollow, &(sag_sphere){.radius = 1});
    sag_add_sphere(hollow, &(sag_sphere){.radius = 0.999});
    const sag_body h = measured_solid(hollow, two_differ, 3, 3e-3);
    assert_within("hollow ball, volume", h.volume, 4 * PI / 3 * (1 - 0.999 * 0.999 * 0.999));
    assert_within("hollow ball, area", h.area, 4 * PI * (1 + 0.999 * 0.999));
    assert_true(fabs(h.thickness.min - 1e-3) < 1e-12 && fabs(h.thickness.max - 1e-3) < 1e-12);
    // Two boxes with a face in common: nothing between them.
    sag_scene *pair = sag_scene_create(context);
    sag_add_box(pair, &(sag_box){{0, 0, 0}, {1, 1, 1}});
    sag_add_box(pair, &(sag_box){{1, 0, 0}, {3, 1, 1}});
    const sag_solid_step join[] = {{SAG_SOLID_PART, 0}, {SAG_SOLID_PART, 1}, {SAG_SOLID_UNION, 2}};
    const sag_body p = measured_solid(pair, join, 3, 3e-3);
    assert_within("two boxes, volume", p.volume, 3);
    assert_within("two boxes, area", p.area, 14);
    assert_within("two boxes, Jxx", p.inertia[0][0], 0.5);
    // A ball cut by a half-space, and one that is cut away altogether.
    sag_scene *half = sag_scene_create(context);
    sag_add_sphere(half, &(sag_sphere){.radius = 1});
    sag_add_plane(half, &(sag_plane){.normal = {0, 0, 1}});
    const sag_body d = measured_solid(half, two_intersect, 3, 3e-3);
    assert_within("half a ball, volume", d.volume, 2 * PI / 3);
    assert_within("half a ball, area", d.area, 3 * PI);
    assert_within("half a ball, centre", d.center[2], -3 / 8.0);
}

static void empty_and_unbounded_solids(void **state) {
    (void)state;
    const sag_plane ground = {.normal = {0, 0, 1}};
    sag_scene *wide = sag_scene_create(context);
    sag_add_plane(wide, &ground);
    sag_add_sphere(wide, &(sag_sphere){.radius = 1});
    sag_scene_set_solid(wide, &(sag_solid){two_differ, 3}, NULL);
    assert_int_equal(sag_scene_commit(wide, NULL), SAG_OK);
    const sag_body b = measured(wide, NULL);
    assert_int_equal(b.state, SAG_BODY_UNBOUNDED);
    assert_true(isinf(b.volume.value));
    sag_scene_destroy(wide);
    sag_scene *none = sag_scene_create(context);
    sag_add_sphere(none, &(sag_sphere){.radius = 1});
    sag_add_sphere(none, &(sag_sphere){.radius = 2});
    sag_scene_set_solid(none, &(sag_solid){two_differ, 3}, NULL);
    assert_int_equal(sag_scene_commit(none, NULL), SAG_OK);
    const sag_body c = measured(none, NULL);
    assert_int_equal(c.state, SAG_BODY_EMPTY);
    assert_true(c.volume.value == 0 && c.area.value == 0);
    sag_scene_destroy(none);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_hold_what_they_say),
        cmocka_unit_test(steinmetz_solids),
        cmocka_unit_test(lens_napkin_ring_and_hollow),
        cmocka_unit_test(empty_and_unbounded_solids),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
