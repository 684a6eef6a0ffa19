// SPDX-License-Identifier: MIT
// Oriented box, polyhedron, frustum and capsule: analytic values, the properties of every shape, bad input.
#include "support/shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static void check_all(const shape_case *c, rng *r, bool statistics) {
    assert_int_equal(c->kind->validate(c->shape, NULL), SAG_OK);
    check_verbs(c, r, 1000);
    check_surfaces(c, r, 1000);
    check_spawned(c, r, 1000);
    check_closest_point(c, r, statistics ? 50 : 5);
    check_bad_rays(c);
    if (statistics) check_area_and_samples(c, r, 8000), check_volume(c, r, 8000);
}

static void oriented_box_values(void **state) {
    (void)state;
    // A left-handed one, turned by 45 degrees about z.
    sag_oriented_box box = {.center = {0, 0, 5}, .half_axes = {{1, -1, 0}, {1, 1, 0}, {0, 0, -2}}};
    assert_int_equal(sag_oriented_box_validate(&box, NULL), SAG_OK);
    sag_ray ray = sag_ray_make((sag_vec3){-10, 0, 5}, (sag_vec3){4, 0, 0});
    sag_hit hits[2];
    assert_int_equal(sag_oriented_box_crossings(&box, &ray, hits, 2), 2); // vertex edge to vertex edge
    assert_true(hits[0].t == 2 && hits[1].t == 3);
    ray = sag_ray_make((sag_vec3){0.5, 0.5, 0}, (sag_vec3){0, 0, 1});
    assert_int_equal(sag_oriented_box_crossings(&box, &ray, hits, 2), 2);
    assert_true(hits[0].t == 3 && hits[1].t == 7);
    assert_int_equal(hits[0].primitive, 5); // the third axis points down
    sag_surface s;
    sag_oriented_box_surface(&box, &ray, &hits[0], &s);
    assert_true(s.geometric_normal.z == -1 && s.position.z == 3 && s.side == SAG_SIDE_FRONT);
    assert_true(s.u == 0.5 && s.v == 0.75);
    assert_true(fabs(sag_oriented_box_volume(&box) - 32) < 1e-14);
    assert_true(fabs(sag_oriented_box_area(&box) - (2 * 8 + 4 * 8 * sqrt(2))) < 1e-13);
    assert_true(sag_oriented_box_contains(&box, (sag_vec3){2, 0, 3}));
    assert_false(sag_oriented_box_contains(&box, (sag_vec3){nextafter(2, 3), 0, 3}));
}

static void oriented_box_properties(void **state) {
    (void)state;
    rng r = rng_make(31);
    for (int i = 0; i < 30; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9), radius = 0;
        sag_oriented_box box = {.center = i % 4 == 0 ? (sag_vec3){0, 0, 0} : rng_vec3(&r, 3 * scale)};
        for (int k = 0; k < 3; k++) {
            box.half_axes[k] = sag_scale(rng_direction(&r), scale * (0.1 + rng_unit(&r)));
            radius += sag_length(box.half_axes[k]);
        }
        shape_case c = {&sagi_shape_classes[SAG_SHAPE_ORIENTED_BOX], &box, box.center, radius,
                        LEAVING_CONVEX};
        check_all(&c, &r, i < 10);
    }
}

// A box given both ways has the same crossings.
static void polyhedron_is_box(void **state) {
    (void)state;
    const sag_half_space planes[6] = {{{-2, 0, 0}, 2}, {{1, 0, 0}, 1},  {{0, -1, 0}, 2},
                                      {{0, 4, 0}, 8},  {{0, 0, -1}, 3}, {{0, 0, 1}, 3}};
    sag_polyhedron polyhedron = {planes, 6};
    sag_box box = {{-1, -2, -3}, {1, 2, 3}};
    assert_int_equal(sag_polyhedron_validate(&polyhedron, NULL), SAG_OK);
    assert_true(sag_polyhedron_area(&polyhedron) == 88);
    assert_true(fabs(sag_polyhedron_volume(&polyhedron) - 48) < 1e-13);
    sag_box3 bounds = sag_polyhedron_bounds(&polyhedron);
    assert_true(bounds.min.x <= -1 && bounds.max.z >= 3 && bounds.min.x > -1 - 1e-12 &&
                bounds.max.z < 3 + 1e-12);
    rng r = rng_make(32);
    shape_case c = {&sagi_shape_classes[SAG_SHAPE_POLYHEDRON], &polyhedron, {0, 0, 0}, 4, LEAVING_CONVEX};
    for (int i = 0; i < 20000; i++) {
        sag_ray ray = shape_random_ray(&r, &c);
        sag_hit a[2], b[2];
        size_t n = sag_polyhedron_crossings(&polyhedron, &ray, a, 2);
        assert_int_equal(sag_box_crossings(&box, &ray, b, 2), n);
        for (size_t k = 0; k < n; k++) {
            assert_int_equal(a[k].primitive, b[k].primitive);
            assert_true(fabs(a[k].t - b[k].t) <= 0x1p-51 * fabs(b[k].t));
        }
    }
}

static void polyhedron_unbounded(void **state) {
    (void)state;
    // A slab between z = 1 and z = 2, and a half-space, and a wedge.
    const sag_half_space planes[3] = {{{0, 0, -1}, -1}, {{0, 0, 1}, 2}, {{1, 0, 1}, 5}};
    sag_polyhedron slab = {planes, 2}, half = {planes, 1}, wedge = {planes, 3};
    assert_int_equal(sag_polyhedron_validate(&slab, NULL), SAG_OK);
    assert_int_equal(sag_polyhedron_validate(&half, NULL), SAG_OK);
    assert_int_equal(sag_polyhedron_validate(&wedge, NULL), SAG_OK);
    assert_true(isinf(sag_polyhedron_area(&slab)) && isinf(sag_polyhedron_volume(&slab)));
    sag_box3 b = sag_polyhedron_bounds(&slab);
    assert_true(isinf(b.min.x) && isinf(b.max.y) && b.min.z <= 1 && b.min.z > 0.999 && b.max.z >= 2 &&
                b.max.z < 2.001);
    b = sag_polyhedron_bounds(&half);
    assert_true(b.min.z <= 1 && b.min.z > 0.999 && isinf(b.max.z) && isinf(b.min.x));
    b = sag_polyhedron_bounds(&wedge);
    assert_true(isinf(b.min.x) && b.max.x >= 4 && b.max.x < 4.001);
    sag_surface s;
    assert_false(sag_polyhedron_sample(&slab, (sag_vec2){0.5, 0.5}, &s));
    sag_ray ray = sag_ray_make((sag_vec3){0, 0, 0}, (sag_vec3){0, 0, 1});
    sag_hit hits[2];
    assert_int_equal(sag_polyhedron_crossings(&slab, &ray, hits, 2), 2);
    assert_int_equal(sag_polyhedron_crossings(&half, &ray, hits, 2), 1);
    ray.direction = (sag_vec3){1, 0, 0}, ray.origin.z = 1; // in a face, all of it inside
    assert_int_equal(sag_polyhedron_crossings(&slab, &ray, hits, 2), 0);
    sag_vec3 q = sag_polyhedron_closest_point(&slab, (sag_vec3){7, -3, 1.75});
    assert_true(q.x == 7 && q.y == -3 && q.z == 2);
}

static void polyhedron_properties(void **state) {
    (void)state;
    rng r = rng_make(33);
    for (int i = 0; i < 24; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 center = i % 4 == 0 ? (sag_vec3){0, 0, 0} : rng_vec3(&r, 3 * scale);
        sag_half_space planes[40];
        uint32_t n = 6 + rng_below(&r, i % 8 == 7 ? 34 : 6);
        for (uint32_t k = 0; k < n; k++) {
            // Six sides of a turned box first, so that it is bounded; planes near the ball of radius scale.
            sag_vec3 d = rng_direction(&r);
            if (k < 6)
                d = (sag_vec3){k / 2 == 0 ? (k & 1 ? 1 : -1) : 0.1, k / 2 == 1 ? (k & 1 ? 1 : -1) : 0.1,
                               k / 2 == 2 ? (k & 1 ? 1 : -1) : 0.1};
            d = sag_scale(d, rng_log_uniform(&r, 0.01, 100));
            planes[k] =
                (sag_half_space){d, sag_dot(d, center) + sag_length(d) * scale * rng_uniform(&r, 0.5, 1)};
        }
        sag_polyhedron polyhedron = {planes, n};
        shape_case c = {&sagi_shape_classes[SAG_SHAPE_POLYHEDRON], &polyhedron, center, 3 * scale,
                        LEAVING_CONVEX};
        check_all(&c, &r, i < 5);
    }
}

static void polyhedron_messages(void **state) {
    (void)state;
    sag_error error;
    sag_half_space planes[3] = {{{0, 0, -1}, -2}, {{0, 0, 1}, 1}, {{1, 0, 0}, 1}};
    sag_polyhedron empty = {planes, 2};
    assert_int_equal(sag_polyhedron_validate(&empty, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "no common inside"));
    sag_ray ray = sag_ray_make((sag_vec3){0, 0, -5}, (sag_vec3){0, 0, 1});
    assert_false(sag_polyhedron_occluded(&empty, &ray));
    planes[0].offset = -1; // flat
    assert_int_equal(sag_polyhedron_validate(&empty, &error), SAG_ERROR_GEOMETRY);
    planes[0].normal.z = 0;
    assert_int_equal(sag_polyhedron_validate(&empty, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "planes[0] normal (0, 0, 0)"));
    assert_false(sag_polyhedron_occluded(&empty, &ray));
    empty.plane_count = 257;
    assert_int_equal(sag_polyhedron_validate(&empty, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "plane_count 257"));
    assert_false(sag_polyhedron_occluded(&empty, &ray));
    // The corner cut off entirely by a third plane: a triangle-shaped nothing.
    sag_half_space corner[4] = {{{-1, 0, 0}, 0}, {{0, -1, 0}, 0}, {{0, 0, -1}, 0}, {{1, 1, 1}, -1e-9}};
    sag_polyhedron nothing = {corner, 4};
    assert_int_equal(sag_polyhedron_validate(&nothing, NULL), SAG_ERROR_GEOMETRY);
    corner[3].offset = 1e-9;
    assert_int_equal(sag_polyhedron_validate(&nothing, NULL), SAG_OK);
}

// 256 planes around a ball: as many faces, in reasonable time.
static void polyhedron_of_256_planes(void **state) {
    (void)state;
    rng r = rng_make(34);
    sag_half_space planes[SAG_MAX_POLYHEDRON_PLANES];
    for (int i = 0; i < SAG_MAX_POLYHEDRON_PLANES; i++) planes[i] = (sag_half_space){rng_direction(&r), 1};
    sag_polyhedron ball = {planes, SAG_MAX_POLYHEDRON_PLANES};
    assert_int_equal(sag_polyhedron_validate(&ball, NULL), SAG_OK);
    double volume = sag_polyhedron_volume(&ball), area = sag_polyhedron_area(&ball);
    assert_true(fabs(volume - area / 3) < 1e-12); // all faces are at distance 1
    assert_true(volume > 4 * PI / 3 && volume < 1.05 * 4 * PI / 3);
}

static void frustum(void **state) {
    (void)state;
    sag_half_space planes[6];
    sag_vec3 eye = {1, 2, 3};
    assert_int_equal(
        sag_frustum_planes(eye, (sag_vec3){0, 0, 2}, (sag_vec3){0, 5, 1}, PI / 4, PI / 6, 1, 4, planes, NULL),
        SAG_OK);
    sag_polyhedron view = {planes, 6};
    assert_int_equal(sag_polyhedron_validate(&view, NULL), SAG_OK);
    // Frustum of half sizes tan 45° = 1 and tan 30° times the distance: V = (4 tan/3)(4³ − 1³).
    assert_true(fabs(sag_polyhedron_volume(&view) - 4 * tan(PI / 6) / 3 * 63) < 1e-12);
    assert_true(sag_polyhedron_contains(&view, (sag_vec3){1, 2, 4.5}));
    assert_false(sag_polyhedron_contains(&view, (sag_vec3){1, 2, 3.5}));
    // Forward is z and up y, so right is −x: planes[1] is the right one.
    assert_true(planes[1].normal.x < 0 && planes[3].normal.y > 0 && planes[5].normal.z > 0);
    assert_int_equal(
        sag_frustum_planes(eye, (sag_vec3){0, 0, 2}, (sag_vec3){0, 5, 1}, PI / 4, PI / 6, 0, 4, planes, NULL),
        SAG_OK);
    assert_int_equal(sag_polyhedron_validate(&view, NULL), SAG_OK);
    sag_error error;
    assert_int_equal(sag_frustum_planes(eye, (sag_vec3){0, 0, 2}, (sag_vec3){0, 0, 1}, PI / 4, PI / 6, 1, 4,
                                        planes, &error),
                     SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "up (0, 0, 1)"));
    assert_int_equal(sag_frustum_planes(eye, (sag_vec3){0, 0, 2}, (sag_vec3){0, 1, 1}, PI / 4, PI / 6, 4, 4,
                                        planes, &error),
                     SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "far_distance 4"));
}

static void capsule_values(void **state) {
    (void)state;
    sag_capsule capsule = {{0, 0, 0}, {0, 0, 3}, 1};
    assert_int_equal(sag_capsule_validate(&capsule, NULL), SAG_OK);
    assert_true(fabs(sag_capsule_area(&capsule) - 2 * PI * 5) < 1e-14);
    assert_true(fabs(sag_capsule_volume(&capsule) - PI * (3 + 4.0 / 3)) < 1e-14);
    sag_hit hits[2];
    sag_ray ray = sag_ray_make((sag_vec3){-3, 0, 1}, (sag_vec3){2, 0, 0});
    assert_int_equal(sag_capsule_crossings(&capsule, &ray, hits, 2), 2);
    assert_true(hits[0].t == 1 && hits[1].t == 2 && hits[0].primitive == 0);
    sag_surface s;
    sag_capsule_surface(&capsule, &ray, &hits[0], &s);
    assert_true(fabs(s.geometric_normal.x + 1) < 1e-15 && fabs(s.v - 0.4) < 1e-15 && fabs(s.u - 0.5) < 1e-15);
    ray = sag_ray_make((sag_vec3){0, 0, 1.5}, (sag_vec3){0, 0, 0.5}); // inside, along the axis
    assert_int_equal(sag_capsule_crossings(&capsule, &ray, hits, 2), 1);
    assert_true(hits[0].t == 5 && hits[0].primitive == 2);
    sag_capsule_surface(&capsule, &ray, &hits[0], &s);
    assert_true(s.geometric_normal.z == 1 && s.v == 1 && s.side == SAG_SIDE_BACK);
    ray.origin.z = -2;
    assert_int_equal(sag_capsule_crossings(&capsule, &ray, hits, 2), 2);
    assert_true(hits[0].t == 2 && hits[1].t == 12 && hits[0].primitive == 1);
    // Through both seams.
    ray = sag_ray_make((sag_vec3){-2, 0, 0}, (sag_vec3){1, 0, 0});
    assert_int_equal(sag_capsule_crossings(&capsule, &ray, hits, 2), 2);
    assert_true(hits[0].t == 1 && hits[1].t == 3);
    sag_vec3 q = sag_capsule_closest_point(&capsule, (sag_vec3){0, 4, 3});
    assert_true(q.y == 1 && q.z == 3);
    sag_error error;
    capsule.radius = 0;
    assert_int_equal(sag_capsule_validate(&capsule, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "capsule: radius 0"));
    assert_false(sag_capsule_occluded(&capsule, &ray));
}

static void capsule_properties(void **state) {
    (void)state;
    rng r = rng_make(35);
    for (int i = 0; i < 30; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 center = i % 4 == 0 ? (sag_vec3){0, 0, 0} : rng_vec3(&r, 3 * scale);
        sag_vec3 half = sag_scale(rng_direction(&r), i % 5 == 0 ? 0 : scale * rng_unit(&r));
        sag_capsule capsule = {sag_sub(center, half), sag_add(center, half),
                               scale * rng_log_uniform(&r, 0.01, 2)};
        shape_case c = {&sagi_shape_classes[SAG_SHAPE_CAPSULE], &capsule, center,
                        sag_length(half) + capsule.radius, LEAVING_CONVEX};
        check_all(&c, &r, i < 10);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oriented_box_values),      cmocka_unit_test(oriented_box_properties),
        cmocka_unit_test(polyhedron_is_box),        cmocka_unit_test(polyhedron_unbounded),
        cmocka_unit_test(polyhedron_properties),    cmocka_unit_test(polyhedron_messages),
        cmocka_unit_test(polyhedron_of_256_planes), cmocka_unit_test(frustum),
        cmocka_unit_test(capsule_values),           cmocka_unit_test(capsule_properties),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
