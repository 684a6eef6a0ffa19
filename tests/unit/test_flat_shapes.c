// SPDX-License-Identifier: MIT
// Plane, disk and rectangle: analytic values, the properties of every shape, edges, bad input.
#include "support/shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static void plane_values(void **state) {
    (void)state;
    sag_plane plane = {.point = {0, 1, 0}, .normal = {0, 2, 0}, .s = {2, 0, 0}, .t = {1, 0, -1}};
    assert_int_equal(sag_plane_validate(&plane, NULL), SAG_OK);
    sag_ray ray = sag_ray_make((sag_vec3){3, 5, -2}, (sag_vec3){0, -2, 0});
    sag_hit hit;
    assert_true(sag_plane_hit(&plane, &ray, &hit));
    assert_true(hit.t == 2);
    sag_surface s;
    sag_plane_surface(&plane, &ray, &hit, &s);
    assert_true(s.position.x == 3 && s.position.y == 1 && s.position.z == -2);
    assert_true(s.geometric_normal.y == 1 && s.side == SAG_SIDE_FRONT);
    // (3, 0, −2) = u (2, 0, 0) + v (1, 0, −1).
    assert_true(s.u == 0.5 && s.v == 2);
    // A ray along the plane misses, also one in it; a ray away from it too, but not with a negative t_min.
    ray.direction = (sag_vec3){1, 0, 0};
    assert_false(sag_plane_hit(&plane, &ray, &hit));
    ray.origin.y = 1;
    assert_false(sag_plane_hit(&plane, &ray, &hit));
    ray.direction = (sag_vec3){1, 1, 0}, ray.origin.y = 2;
    assert_false(sag_plane_hit(&plane, &ray, &hit));
    ray.t_min = -INFINITY;
    assert_true(sag_plane_hit(&plane, &ray, &hit) && hit.t == -1);
    assert_true(sag_plane_contains(&plane, (sag_vec3){7, 1, 9}));
    assert_false(sag_plane_contains(&plane, (sag_vec3){7, nextafter(1, 2), 9}));
    assert_true(isinf(sag_plane_area(&plane)) && isinf(sag_plane_volume(&plane)));
    sag_vec3 q = sag_plane_closest_point(&plane, (sag_vec3){3, 8, 4});
    assert_true(q.x == 3 && q.y == 1 && q.z == 4);
}

// Parallel or not is decided exactly: normals and directions that cancel but for their last bits.
static void plane_parallel_exactly(void **state) {
    (void)state;
    rng r = rng_make(11);
    for (int i = 0; i < 20000; i++) {
        sag_vec3 a = {rng_double(&r, -3, 3), rng_double(&r, -3, 3), rng_double(&r, -3, 3)};
        // Integers of 26 bits: b = a × c has exact doubles, so a·b = 0 exactly.
        sag_vec3 n = {(double)rng_below(&r, 1u << 26) + 1, (double)rng_below(&r, 1u << 26),
                      (double)rng_below(&r, 1u << 26)};
        sag_vec3 c = {(double)rng_below(&r, 1u << 20), (double)rng_below(&r, 1u << 20), 3};
        sag_vec3 d = sag_cross(n, c);
        sag_plane plane = {.point = a, .normal = n};
        sag_ray ray = sag_ray_make(rng_vec3(&r, 10), d);
        ray.t_min = -INFINITY;
        assert_false(sag_plane_occluded(&plane, &ray));
        ray.direction.x = nextafter(d.x, INFINITY);
        assert_true(sag_plane_occluded(&plane, &ray));
    }
}

static void disk_values(void **state) {
    (void)state;
    sag_disk disk = {.center = {1, 2, 3},
                     .normal = {0, 0, 5},
                     .radius = 5,
                     .inner_radius = 1,
                     .phi_max_rad = PI,
                     .x_axis = {2, 0, 7}};
    assert_int_equal(sag_disk_validate(&disk, NULL), SAG_OK);
    assert_true(fabs(sag_disk_area(&disk) - PI * 12) < 1e-14);
    sag_ray ray = sag_ray_make((sag_vec3){1, 5, 7}, (sag_vec3){0, 0, -2});
    sag_hit hit;
    assert_true(sag_disk_hit(&disk, &ray, &hit) && hit.t == 2);
    sag_surface s;
    sag_disk_surface(&disk, &ray, &hit, &s);
    assert_true(fabs(s.u - 0.5) < 1e-15 && fabs(s.v - 0.5) < 1e-15); // φ = π/2, ρ = 3
    assert_true(fabs(s.dpdu.x + 3 * PI) < 1e-14 && fabs(s.dpdv.y + 4) < 1e-14);
    // On the rim (3, 4): hit. One double beyond: miss. In the hole and in the other half: miss.
    ray.origin = (sag_vec3){4, 6, 7};
    assert_true(sag_disk_hit(&disk, &ray, &hit));
    ray.origin.x = nextafter(4, 5);
    assert_false(sag_disk_hit(&disk, &ray, &hit));
    ray.origin = (sag_vec3){1, 2.5, 7};
    assert_false(sag_disk_hit(&disk, &ray, &hit));
    ray.origin = (sag_vec3){1, 3, 7};
    assert_true(sag_disk_hit(&disk, &ray, &hit));
    ray.origin.y = nextafter(3, 2);
    assert_false(sag_disk_hit(&disk, &ray, &hit));
    ray.origin = (sag_vec3){1, -1, 7};
    assert_false(sag_disk_hit(&disk, &ray, &hit));
    // In its plane: miss.
    ray = sag_ray_make((sag_vec3){-10, 4, 3}, (sag_vec3){1, 0, 0});
    assert_false(sag_disk_hit(&disk, &ray, &hit));
    sag_vec3 q = sag_disk_closest_point(&disk, (sag_vec3){2, -9, 8}); // beside the edge φ = 0
    assert_true(fabs(q.x - 2) < 1e-14 && fabs(q.y - 2) < 1e-14 && fabs(q.z - 3) < 1e-14);
}

static void rectangle_values(void **state) {
    (void)state;
    sag_rectangle rectangle = {.corner = {0, 0, 1}, .edge_u = {2, 0, 0}, .edge_v = {1, 4, 0}};
    assert_int_equal(sag_rectangle_validate(&rectangle, NULL), SAG_OK);
    assert_true(sag_rectangle_area(&rectangle) == 8);
    sag_ray ray = sag_ray_make((sag_vec3){1.5, 1, 5}, (sag_vec3){0, 0, -1});
    sag_hit hit;
    assert_true(sag_rectangle_hit(&rectangle, &ray, &hit));
    assert_true(hit.t == 4 && hit.u == 0.625 && hit.v == 0.25);
    sag_surface s;
    sag_rectangle_surface(&rectangle, &ray, &hit, &s);
    assert_true(s.geometric_normal.z == 1 && s.u == 0.625 && s.v == 0.25 && s.dpdv.y == 4);
    // All four corners and edges belong to it; nothing beyond by one double.
    const double xs[4] = {0, 2, 3, 1}, ys[4] = {0, 0, 4, 4};
    for (int i = 0; i < 4; i++) {
        ray.origin.x = xs[i], ray.origin.y = ys[i];
        assert_true(sag_rectangle_hit(&rectangle, &ray, &hit));
        ray.origin.y = ys[i] == 0 ? -0x1p-1000 : nextafter(4, 5);
        assert_false(sag_rectangle_hit(&rectangle, &ray, &hit));
    }
    sag_vec3 q = sag_rectangle_closest_point(&rectangle, (sag_vec3){1, -3, 0});
    assert_true(q.x == 1 && q.y == 0 && q.z == 1);
}

static void properties(void **state) {
    (void)state;
    rng r = rng_make(12);
    for (int i = 0; i < 40; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 center = i % 4 == 0 ? (sag_vec3){0, 0, 0} : rng_vec3(&r, 3 * scale);
        sag_vec3 n = i % 3 == 0 ? (sag_vec3){0, i % 2 ? 3 : -1, 0}
                                : sag_scale(rng_direction(&r), rng_log_uniform(&r, 1e-9, 1e9));
        sag_plane plane = {.point = center, .normal = n};
        sag_disk disk = {.center = center, .normal = n, .radius = scale};
        if (i % 2) disk.inner_radius = scale * rng_unit(&r);
        if (i % 5 == 1) disk.phi_max_rad = rng_uniform(&r, 0.5, 6), disk.x_axis = rng_direction(&r);
        sag_rectangle rectangle = {.edge_u = sag_scale(rng_direction(&r), scale),
                                   .edge_v = sag_scale(rng_direction(&r), scale)};
        rectangle.corner = sag_sub(center, sag_scale(sag_add(rectangle.edge_u, rectangle.edge_v), 0.5));
        const shape_case cases[3] = {
            {&sagi_shape_classes[SAG_SHAPE_PLANE], &plane, center, scale, LEAVING_FLAT},
            {&sagi_shape_classes[SAG_SHAPE_DISK], &disk, center, scale, LEAVING_FLAT},
            {&sagi_shape_classes[SAG_SHAPE_RECTANGLE], &rectangle, center, scale, LEAVING_FLAT}};
        for (int j = 0; j < 3; j++) {
            const shape_case *c = &cases[j];
            assert_int_equal(c->kind->validate(c->shape, NULL), SAG_OK);
            check_verbs(c, &r, 1000);
            check_surfaces(c, &r, 1000);
            check_spawned(c, &r, 1000);
            check_closest_point(c, &r, 200);
            check_bad_rays(c);
            if (j > 0 && i < 12) check_area_and_samples(c, &r, 10000);
        }
    }
}

static void messages(void **state) {
    (void)state;
    sag_error error;
    sag_plane plane = {.normal = {0, NAN, 1}};
    assert_int_equal(sag_plane_validate(&plane, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "plane: normal (0, nan, 1)"));
    sag_disk disk = {.normal = {0, 0, 1}, .radius = -2};
    assert_int_equal(sag_disk_validate(&disk, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "disk: radius -2"));
    sag_ray ray = sag_ray_make((sag_vec3){0, 0, 5}, (sag_vec3){0, 0, -1});
    assert_false(sag_disk_occluded(&disk, &ray));
    sag_box3 box = sag_disk_bounds(&disk);
    assert_true(sag_box3_is_empty(&box));
    sag_surface s;
    assert_false(sag_disk_sample(&disk, (sag_vec2){0, 0}, &s));
    sag_rectangle rectangle = {.edge_u = {1, 2, 3}, .edge_v = {2, 4, 6}};
    assert_int_equal(sag_rectangle_validate(&rectangle, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "rectangle: edge_v (2, 4, 6)"));
    assert_false(sag_rectangle_occluded(&rectangle, &ray));
    assert_false(sag_rectangle_sample(&rectangle, (sag_vec2){0, 0}, &s));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plane_values), cmocka_unit_test(plane_parallel_exactly),
        cmocka_unit_test(disk_values),  cmocka_unit_test(rectangle_values),
        cmocka_unit_test(properties),   cmocka_unit_test(messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
