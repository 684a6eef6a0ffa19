// SPDX-License-Identifier: MIT
// Cameras: which ray belongs to which pixel.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/camera.h"
#include "support/random.h"

#define NEAR(a, b) assert_true(fabs((a) - (b)) < 1e-12)

static const sag_vec2 no_lens = {0.5, 0.5};

static sagi_camera make(sag_camera description, uint32_t width, uint32_t height) {
    sagi_camera camera;
    assert_int_equal(sagi_camera_init(&camera, &description, width, height, NULL), SAG_OK);
    return camera;
}

static void perspective_covers_its_angle(void **state) {
    (void)state;
    sag_camera description = {.to_world = sag_affine_identity(), .fov_rad = 1};
    // The angle belongs to the shorter side, whichever that is.
    const uint32_t sizes[2][2] = {{200, 100}, {100, 200}};
    for (int i = 0; i < 2; i++) {
        double width = sizes[i][0], height = sizes[i][1];
        sagi_camera camera = make(description, sizes[i][0], sizes[i][1]);
        sag_ray center = sagi_camera_ray(&camera, width / 2, height / 2, no_lens);
        NEAR(center.direction.z, 1);
        sag_ray top = sagi_camera_ray(&camera, width / 2, 0, no_lens);
        sag_ray right = sagi_camera_ray(&camera, width, height / 2, no_lens);
        assert_true(top.direction.y > 0 && right.direction.x > 0);
        NEAR(top.direction.y / top.direction.z, tan(0.5) * (i == 0 ? 1 : 2));
        NEAR(right.direction.x / right.direction.z, tan(0.5) * (i == 0 ? 2 : 1));
        NEAR(sag_length(top.direction), 1);
    }
}

static void rays_through_a_lens_meet_where_it_is_sharp(void **state) {
    (void)state;
    rng r = rng_make(3);
    sag_camera description = {
        .to_world = sag_camera_look_at((sag_vec3){1, 2, 3}, (sag_vec3){4, 4, 4}, (sag_vec3){0, 1, 0}),
        .lens_radius = 0.25,
        .focal_distance = 7};
    sagi_camera camera = make(description, 64, 48);
    sag_camera pinhole_description = description;
    pinhole_description.lens_radius = 0;
    sagi_camera pinhole = make(pinhole_description, 64, 48);
    sag_vec3 eye = {1, 2, 3}, forward = sag_normalize(sag_vec3_make(3, 2, 1));
    for (int i = 0; i < 1000; i++) {
        double x = rng_uniform(&r, 0, 64), y = rng_uniform(&r, 0, 48);
        sag_ray sharp = sagi_camera_ray(&pinhole, x, y, no_lens);
        sag_vec3 point = sag_ray_at(&sharp, 7 / sag_dot(sharp.direction, forward));
        sag_ray ray = sagi_camera_ray(&camera, x, y, (sag_vec2){rng_unit(&r), rng_unit(&r)});
        assert_true(sag_length(sag_sub(ray.origin, eye)) <= 0.25 * (1 + 1e-12));
        NEAR(sag_dot(sag_sub(ray.origin, eye), forward), 0);
        NEAR(sag_length(sag_cross(sag_sub(point, ray.origin), ray.direction)), 0);
    }
}

static void orthographic_rays_are_parallel(void **state) {
    (void)state;
    sag_camera description = {
        .kind = SAG_CAMERA_ORTHOGRAPHIC, .to_world = sag_affine_identity(), .screen_window = {-3, 5, -1, 2}};
    sagi_camera camera = make(description, 80, 30);
    sag_ray corner = sagi_camera_ray(&camera, 0, 0, no_lens),
            other = sagi_camera_ray(&camera, 80, 30, no_lens);
    NEAR(corner.origin.x, -3), NEAR(corner.origin.y, 2), NEAR(corner.direction.z, 1);
    NEAR(other.origin.x, 5), NEAR(other.origin.y, -1), NEAR(other.direction.z, 1);
}

static void environment_sees_all_directions(void **state) {
    (void)state;
    sag_camera description = {.kind = SAG_CAMERA_ENVIRONMENT, .to_world = sag_affine_identity()};
    sagi_camera camera = make(description, 400, 200);
    NEAR(sagi_camera_ray(&camera, 100, 0, no_lens).direction.y, 1);
    NEAR(sagi_camera_ray(&camera, 100, 200, no_lens).direction.y, -1);
    NEAR(sagi_camera_ray(&camera, 0, 100, no_lens).direction.x, 1);
    NEAR(sagi_camera_ray(&camera, 100, 100, no_lens).direction.z, 1);
    NEAR(sagi_camera_ray(&camera, 200, 100, no_lens).direction.x, -1);
}

static void orthographic_lens_is_sharp_at_its_distance(void **state) {
    (void)state;
    rng r = rng_make(5);
    sag_camera description = {.kind = SAG_CAMERA_ORTHOGRAPHIC,
                              .to_world = sag_affine_identity(),
                              .lens_radius = 0.5,
                              .focal_distance = 4};
    sagi_camera camera = make(description, 64, 64);
    for (int i = 0; i < 200; i++) {
        const double x = rng_uniform(&r, 0, 64), y = rng_uniform(&r, 0, 64);
        const sag_ray ray = sagi_camera_ray(&camera, x, y, (sag_vec2){rng_unit(&r), rng_unit(&r)});
        const sag_vec3 p = sag_ray_at(&ray, 4 / ray.direction.z);
        NEAR(p.x, x / 32 - 1), NEAR(p.y, 1 - y / 32), NEAR(ray.origin.z, 0);
    }
}

// The middle looks up (y), the corners down; the middles of the edges along x and z; each pixel sees the same
// solid angle; beyond an edge the picture goes on, mirrored in the edge's middle.
static void equal_area_sees_all_directions_evenly(void **state) {
    (void)state;
    sag_camera description = {.kind = SAG_CAMERA_EQUAL_AREA, .to_world = sag_affine_identity()};
    sagi_camera camera = make(description, 32, 32);
    NEAR(sagi_camera_ray(&camera, 16, 16, no_lens).direction.y, 1);
    NEAR(sagi_camera_ray(&camera, 0, 0, no_lens).direction.y, -1);
    NEAR(sagi_camera_ray(&camera, 32, 0, no_lens).direction.y, -1);
    NEAR(sagi_camera_ray(&camera, 32, 16, no_lens).direction.x, 1);
    NEAR(sagi_camera_ray(&camera, 16, 32, no_lens).direction.z, 1);
    NEAR(sagi_camera_ray(&camera, 16, 0, no_lens).direction.z, -1);
    for (uint32_t y = 0; y < 32; y++) {
        for (uint32_t x = 0; x < 32; x++) { // a small square within the pixel
            const double h = 1e-3, x0 = x + 0.4, y0 = y + 0.3;
            const sag_vec3 a = sagi_camera_ray(&camera, x0, y0, no_lens).direction;
            const sag_vec3 b = sagi_camera_ray(&camera, x0 + h, y0, no_lens).direction;
            const sag_vec3 c = sagi_camera_ray(&camera, x0 + h, y0 + h, no_lens).direction;
            const sag_vec3 d = sagi_camera_ray(&camera, x0, y0 + h, no_lens).direction;
            const double area = sag_length(sag_cross(sag_sub(c, a), sag_sub(d, b))) / 2;
            assert_true(fabs(area * 1024 / (h * h) / (4 * SAGI_RENDER_PI) - 1) < 1e-3);
        }
    }
    const sag_vec3 out = sagi_camera_ray(&camera, 33, 5, no_lens).direction,
                   in = sagi_camera_ray(&camera, 31, 27, no_lens).direction;
    assert_true(out.x == in.x && out.y == in.y && out.z == in.z);
}

static void look_at_puts_up_upward(void **state) {
    (void)state;
    sag_vec3 up = {0, 3, 0}, eye = {0, 5, 10}, target = {0, 0, 0};
    sag_affine to_world = sag_camera_look_at(eye, target, up);
    sag_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    // Seen from +z, with y up, x is to the right.
    NEAR(sag_affine_vector(&to_world, x).x, 1);
    assert_true(sag_affine_vector(&to_world, y).y > 0);
    NEAR(sag_dot(sag_affine_vector(&to_world, z), sag_normalize(sag_sub(target, eye))), 1);
    NEAR(sag_affine_determinant(&to_world), -1);
    // Degenerate wishes still make a camera.
    sag_affine straight = sag_camera_look_at(eye, sag_vec3_make(0, 0, 10), up);
    NEAR(fabs(sag_affine_determinant(&straight)), 1);
    sag_affine nowhere = sag_camera_look_at(eye, eye, up);
    NEAR(fabs(sag_affine_determinant(&nowhere)), 1);
}

static void impossible_cameras_are_errors(void **state) {
    (void)state;
    sagi_camera camera;
    sag_error error;
    sag_camera good = {.to_world = sag_affine_identity()}, bad = good;
    assert_int_equal(sagi_camera_init(&camera, &good, 0, 10, &error), SAG_ERROR_ARGUMENT);
    assert_int_equal(sagi_camera_init(&camera, &good, 10, 100000, &error), SAG_ERROR_ARGUMENT);
    bad.fov_rad = 4;
    assert_int_equal(sagi_camera_init(&camera, &bad, 10, 10, &error), SAG_ERROR_ARGUMENT);
    bad = good;
    bad.to_world.m[1][2] = NAN;
    assert_int_equal(sagi_camera_init(&camera, &bad, 10, 10, &error), SAG_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(perspective_covers_its_angle),
        cmocka_unit_test(rays_through_a_lens_meet_where_it_is_sharp),
        cmocka_unit_test(orthographic_rays_are_parallel),
        cmocka_unit_test(environment_sees_all_directions),
        cmocka_unit_test(orthographic_lens_is_sharp_at_its_distance),
        cmocka_unit_test(equal_area_sees_all_directions_evenly),
        cmocka_unit_test(look_at_puts_up_upward),
        cmocka_unit_test(impossible_cameras_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
