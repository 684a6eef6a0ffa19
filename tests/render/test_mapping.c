// SPDX-License-Identifier: MIT
// Texture mappings: where they put points, and their derivatives against finite differences; the footprint of
// a pixel against rays through the pixels beside it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/footprint.h"
#include "support/random.h"

static sag_vec3 random_vector(rng *r) {
    const double x = rng_uniform(r, -1, 1), y = rng_uniform(r, -1, 1), z = rng_uniform(r, -1, 1);
    return (sag_vec3){x, y, z};
}

static sagi_mapping mapping_of(sag_mapping description) {
    sagi_mapping mapping;
    sagi_mapping_init(&mapping, &description);
    return mapping;
}

static sagi_spot_2d map(sag_mapping_kind kind, sag_vec3 p) {
    const sagi_mapping mapping = mapping_of((sag_mapping){.kind = kind});
    const sagi_spot at = {.position = p, .u = 0.25, .v = 0.75};
    return sagi_mapping_2d(&mapping, &at);
}

static void expect(sagi_spot_2d got, double s, double t) {
    assert_true(fabs(got.s - s) < 1e-14);
    assert_true(fabs(got.t - t) < 1e-14);
}

static void points_go_where_pbrt_puts_them(void **state) {
    (void)state;
    const sag_vec3 a = {1, 0, 0}, b = {0, -2, 0}, c = {0, 0, 3}, d = {-1, 0, 1}, e = {0, 5, -5};
    expect(map(SAG_MAPPING_UV, a), 0.25, 0.75);
    expect(map(SAG_MAPPING_SPHERICAL, a), 0.5, 0);
    expect(map(SAG_MAPPING_SPHERICAL, b), 0.5, 0.75);
    expect(map(SAG_MAPPING_SPHERICAL, c), 0, 0);
    expect(map(SAG_MAPPING_SPHERICAL, d), 0.25, 0.5);
    expect(map(SAG_MAPPING_SPHERICAL, e), 0.75, 0.25);
    expect(map(SAG_MAPPING_CYLINDRICAL, a), 0.5, 0);
    expect(map(SAG_MAPPING_CYLINDRICAL, b), 0.25, 0);
    expect(map(SAG_MAPPING_CYLINDRICAL, d), 1, 1);
    expect(map(SAG_MAPPING_PLANAR, (sag_vec3){3, 4, 5}), 3, 4);
    const sagi_mapping uv =
        mapping_of((sag_mapping){.u_scale = 4, .v_scale = -2, .u_offset = 0.5, .v_offset = 1});
    const sagi_spot at = {.u = 0.25, .v = 0.75};
    expect(sagi_mapping_2d(&uv, &at), 1.5, -0.5);
    const sagi_mapping planar =
        mapping_of((sag_mapping){.kind = SAG_MAPPING_PLANAR,
                                 .v1 = {0, 2, 0},
                                 .v2 = {0, 0, 3},
                                 .u_offset = 10,
                                 .v_offset = 20,
                                 .world_to_texture = sag_affine_scale((sag_vec3){2, 2, 2})});
    const sagi_spot there = {.position = {1, 1, 1}};
    expect(sagi_mapping_2d(&planar, &there), 14, 26);
}

// What a step of the surface's point does to the coordinates.
static void derivatives_are_finite_differences(void **state) {
    (void)state;
    rng r = rng_make(1);
    const sag_mapping_kind kinds[] = {SAG_MAPPING_SPHERICAL, SAG_MAPPING_CYLINDRICAL, SAG_MAPPING_PLANAR};
    for (int i = 0; i < 30000; i++) {
        sag_mapping description = {.kind = kinds[i % 3], .v1 = random_vector(&r), .v2 = random_vector(&r)};
        description.world_to_texture = sag_affine_from_columns(random_vector(&r), random_vector(&r),
                                                               random_vector(&r), random_vector(&r));
        const sagi_mapping mapping = mapping_of(description);
        sagi_spot at = {.position = random_vector(&r), .dpdx = random_vector(&r), .dpdy = random_vector(&r)};
        const sagi_spot_2d here = sagi_mapping_2d(&mapping, &at);
        const sagi_spot_3d in = sagi_mapping_3d(&mapping, &at);
        const double across = hypot(in.p.x, in.p.y);
        if (across < 0.05) continue;
        const double h = 1e-6;
        for (int axis = 0; axis < 2; axis++) {
            const sag_vec3 step = axis == 0 ? at.dpdx : at.dpdy;
            sagi_spot before = at, after = at;
            before.position = sag_madd(at.position, -h, step),
            after.position = sag_madd(at.position, h, step);
            const sagi_spot_2d p = sagi_mapping_2d(&mapping, &before), q = sagi_mapping_2d(&mapping, &after);
            const double ds = (q.s - p.s) / (2 * h), dt = (q.t - p.t) / (2 * h);
            if (fabs(ds) > 1e3 || fabs(dt) > 1e3) continue; // over the seam
            assert_true(fabs(ds - (axis == 0 ? here.dsdx : here.dsdy)) < 1e-5);
            assert_true(fabs(dt - (axis == 0 ? here.dtdx : here.dtdy)) < 1e-5);
            const sagi_spot_3d p3 = sagi_mapping_3d(&mapping, &before),
                               q3 = sagi_mapping_3d(&mapping, &after);
            const sag_vec3 d = sag_scale(sag_sub(q3.p, p3.p), 1 / (2 * h));
            assert_true(sag_length(sag_sub(d, axis == 0 ? in.dpdx : in.dpdy)) < 1e-8);
        }
    }
}

static void poles_have_no_nonsense(void **state) {
    (void)state;
    const sag_mapping_kind kinds[] = {SAG_MAPPING_SPHERICAL, SAG_MAPPING_CYLINDRICAL};
    for (int i = 0; i < 2; i++) {
        const sagi_mapping mapping = mapping_of((sag_mapping){.kind = kinds[i]});
        const sagi_spot pole = {.position = {0, 0, 1}, .dpdx = {1, 0, 0}, .dpdy = {0, 1, 0}},
                        middle = {.u = 0};
        const sagi_spot_2d a = sagi_mapping_2d(&mapping, &pole), b = sagi_mapping_2d(&mapping, &middle);
        assert_true(isfinite(a.s + a.t + a.dsdx + a.dsdy + a.dtdx + a.dtdy));
        assert_true(isfinite(b.s + b.t + b.dsdx + b.dsdy + b.dtdx + b.dtdy));
    }
}

static void uv_changes_solve_the_chain_rule(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (int i = 0; i < 1000; i++) {
        const sag_vec3 dpdu = random_vector(&r), dpdv = random_vector(&r);
        if (sag_length(sag_cross(dpdu, dpdv)) < 0.01) continue;
        const double dudx = rng_uniform(&r, -1, 1), dvdx = rng_uniform(&r, -1, 1);
        sagi_spot spot = {.dpdx = sag_add(sag_scale(dpdu, dudx), sag_scale(dpdv, dvdx)), .dpdy = dpdv};
        sagi_spot_set_uv(&spot, dpdu, dpdv);
        assert_true(fabs(spot.dudx - dudx) < 1e-9 && fabs(spot.dvdx - dvdx) < 1e-9);
        assert_true(fabs(spot.dudy) < 1e-9 && fabs(spot.dvdy - 1) < 1e-9);
    }
    // Parallel ones, zero ones, and no bounds: 0 or pbrt's bound.
    sagi_spot spot = {.dpdx = {1, 0, 0}, .dpdy = {NAN, 0, 0}};
    sagi_spot_set_uv(&spot, (sag_vec3){1, 0, 0}, (sag_vec3){2, 0, 0});
    assert_true(spot.dudx == 0 && spot.dvdy == 0);
    sagi_spot_set_uv(&spot, (sag_vec3){1e-12, 0, 0}, (sag_vec3){0, 1, 0});
    assert_true(spot.dudx == 1e8 && spot.dudy == 0);
}

// In the middle of the picture the footprint is what the pixels beside it see of the tangent plane.
static void check_footprint(sag_camera description, double x, double y, double tolerance) {
    sagi_camera camera;
    sagi_footprint footprint;
    assert_int_equal(sagi_camera_init(&camera, &description, 101, 101, NULL), SAG_OK);
    sagi_footprint_init(&footprint, &camera, 16);
    const sag_vec2 lens = {0.5, 0.5};
    const sag_vec3 n = sag_normalize((sag_vec3){0.3, -0.2, -1});
    sag_vec3 points[3];
    for (int i = 0; i < 3; i++) {
        const sag_ray ray = sagi_camera_ray(&camera, x + (i == 1), y + (i == 2), lens);
        const double t =
            (sag_dot(n, (sag_vec3){1, 2, 30}) - sag_dot(n, ray.origin)) / sag_dot(n, ray.direction);
        points[i] = sag_madd(ray.origin, t, ray.direction);
    }
    const sag_vec3 dpdx = sag_scale(sag_sub(points[1], points[0]), 0.25);
    const sag_vec3 dpdy = sag_scale(sag_sub(points[2], points[0]), 0.25);
    sagi_spot spot = {.position = points[0], .normal = n};
    sagi_footprint_at(&footprint, (sag_vec3){1, 0, 0.3}, (sag_vec3){0, 1, -0.2}, &spot);
    // The frame around the ray is turned: the area and the sum of the squares are what must agree.
    const double area = sag_length(sag_cross(dpdx, dpdy)), got = sag_length(sag_cross(spot.dpdx, spot.dpdy));
    if (!(fabs(got / area - 1) < tolerance)) print_message("area %g instead of %g\n", got, area);
    assert_true(fabs(got / area - 1) < tolerance);
    const double size = sag_length(dpdx), size_got = sag_length(spot.dpdx);
    assert_true(fabs(size_got / size - 1) < tolerance);
    // In the plane.
    assert_true(fabs(sag_dot(spot.dpdx, n)) < 1e-9 * size && fabs(sag_dot(spot.dpdy, n)) < 1e-9 * size);
    assert_true(fabs(spot.dudx - spot.dpdx.x) < 1e-9 && fabs(spot.dvdy - spot.dpdy.y) < 1e-9);
}

static void footprints_are_what_the_next_pixels_see(void **state) {
    (void)state;
    const sag_affine moved =
        sag_camera_look_at((sag_vec3){3, 2, -10}, (sag_vec3){1, 2, 30}, (sag_vec3){0, 1, 0});
    const sag_camera narrow = {.kind = SAG_CAMERA_PERSPECTIVE, .to_world = moved, .fov_rad = 0.1};
    check_footprint(narrow, 50, 50, 0.05);
    check_footprint(narrow, 80, 10, 0.05);
    sag_camera lens = narrow;
    lens.lens_radius = 0.1, lens.focal_distance = 40;
    check_footprint(lens, 50, 50, 0.05);
    sag_camera flat = {.kind = SAG_CAMERA_ORTHOGRAPHIC, .to_world = moved, .screen_window = {-2, 2, -2, 2}};
    check_footprint(flat, 50, 50, 1e-9);
    // Far from the middle too, where the point is seen from aside of where the rays go.
    flat.screen_window[0] = flat.screen_window[2] = 0, flat.screen_window[1] = flat.screen_window[3] = 400;
    check_footprint(flat, 95, 90, 1e-9);
    // Scaled cameras are no different.
    sag_camera scaled = narrow;
    const sag_affine twice = sag_affine_scale((sag_vec3){2, 2, 2});
    scaled.to_world = sag_affine_multiply(&moved, &twice);
    check_footprint(scaled, 50, 50, 0.05);
}

static void footprints_without_sense_are_points(void **state) {
    (void)state;
    sagi_camera camera;
    sagi_footprint footprint;
    sag_camera description = {.kind = SAG_CAMERA_PERSPECTIVE, .to_world = sag_affine_identity()};
    assert_int_equal(sagi_camera_init(&camera, &description, 64, 64, NULL), SAG_OK);
    sagi_footprint_init(&footprint, &camera, 1);
    sagi_spot at_eye = {.normal = {0, 0, -1}};
    sagi_footprint_at(&footprint, (sag_vec3){1, 0, 0}, (sag_vec3){0, 1, 0}, &at_eye);
    assert_true(at_eye.dudx == 0 && at_eye.dpdx.x == 0);
    sagi_spot grazing = {.position = {0, 0, 7}, .normal = {0, 1, 0}};
    sagi_footprint_at(&footprint, (sag_vec3){1, 0, 0}, (sag_vec3){0, 0, 1}, &grazing);
    assert_true(isfinite(grazing.dudx + grazing.dvdx + grazing.dudy + grazing.dvdy));
    description.to_world.m[0][0] = 0;
    assert_int_equal(sagi_camera_init(&camera, &description, 64, 64, NULL), SAG_OK);
    sagi_footprint_init(&footprint, &camera, 1);
    sagi_spot spot = {.position = {0, 0, 7}, .normal = {0, 0, 1}};
    sagi_footprint_at(&footprint, (sag_vec3){1, 0, 0}, (sag_vec3){0, 1, 0}, &spot);
    assert_true(spot.dudx == 0 && spot.dvdy == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_go_where_pbrt_puts_them),
        cmocka_unit_test(derivatives_are_finite_differences),
        cmocka_unit_test(poles_have_no_nonsense),
        cmocka_unit_test(uv_changes_solve_the_chain_rule),
        cmocka_unit_test(footprints_are_what_the_next_pixels_see),
        cmocka_unit_test(footprints_without_sense_are_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
