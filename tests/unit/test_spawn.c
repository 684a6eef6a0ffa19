// SPDX-License-Identifier: MIT
// A spawned ray starts beyond every plane that meets the box of the position's error, exactly, at any scale.
// Distances along the normal are taken in exact arithmetic.
#include "math/expansion.h"
#include "support/random.h"
#include <sagitta/scene.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

// The sign of n·(p − q), exactly.
static int side(sag_vec3 n, sag_vec3 p, sag_vec3 q) {
    double sum[16] = {0}, next[16], d[2], term[4];
    int count = 0;
    for (int k = 0; k < 3; k++) {
        int nd = sagi_expansion_from_diff(sag_component(p, k), sag_component(q, k), d);
        int nt = sagi_expansion_scale(nd, d, sag_component(n, k), term);
        count = sagi_expansion_sum(count, sum, nt, term, next);
        for (int i = 0; i < count; i++) sum[i] = next[i];
    }
    return sagi_expansion_sign(count, sum);
}

static sag_surface random_surface(rng *r) {
    double scale = rng_log_uniform(r, 1e-9, 1e9);
    sag_surface s = {.position = rng_vec3(r, scale), .geometric_normal = rng_direction(r)};
    if (rng_one_in(r, 4)) s.geometric_normal = sag_vec3_make(0, rng_one_in(r, 2) ? 1 : -1, 0);
    sag_vec3 p = sag_abs(s.position);
    double relative = rng_one_in(r, 3) ? 0 : rng_log_uniform(r, 0x1p-53, 0x1p-30);
    s.position_error = sag_scale(p, relative);
    if (rng_one_in(r, 5)) s.position_error = sag_vec3_make(scale * 0x1p-50, 0, 0);
    if (rng_one_in(r, 8)) s.position.y = 0;
    return s;
}

// The corner of the error box that lies farthest along n.
static sag_vec3 corner(const sag_surface *s, sag_vec3 n) {
    return sag_vec3_make(s->position.x + copysign(s->position_error.x, n.x),
                         s->position.y + copysign(s->position_error.y, n.y),
                         s->position.z + copysign(s->position_error.z, n.z));
}

static void a_spawned_ray_starts_beyond_the_error(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int i = 0; i < 200000; i++) {
        sag_surface s = random_surface(&r);
        sag_vec3 d = rng_direction(&r);
        sag_ray ray = sag_spawn_ray(&s, d);
        sag_vec3 n = sag_dot(d, s.geometric_normal) < 0 ? sag_neg(s.geometric_normal) : s.geometric_normal;
        assert_true(ray.t_min == 0 && ray.t_max == INFINITY && ray.mask == 0);
        assert_true(ray.direction.x == d.x && ray.direction.y == d.y && ray.direction.z == d.z);
        assert_true(side(n, ray.origin, s.position) > 0);
        // The corner's own sum rounds to nearest: allow it its half ulp by asking for "not below" only where
        // it is exact.
        sag_vec3 c = corner(&s, n);
        bool exact = true;
        for (int k = 0; k < 3; k++) {
            double p = sag_component(s.position, k),
                   e = copysign(sag_component(s.position_error, k), sag_component(n, k));
            double parts[2], whole = sag_component(c, k);
            exact = exact && sagi_expansion_from_diff(p, -e, parts) <= 1 && whole == p + e;
        }
        if (exact) assert_true(side(n, ray.origin, c) >= 0);
        // And no farther than asked for: the error's reach along n, with one step of rounding in each
        // coordinate.
        double reach = sag_dot(sag_abs(n), s.position_error) * 1.0001;
        for (int k = 0; k < 3; k++) {
            double moved = fabs(sag_component(ray.origin, k) - sag_component(s.position, k));
            double size = fabs(sag_component(s.position, k)) + reach;
            assert_true(moved <= reach * fabs(sag_component(n, k)) + size * 0x1p-51 + 0x1p-499);
        }
    }
}

static void rays_to_points_and_surfaces_end_there(void **state) {
    (void)state;
    rng r = rng_make(2);
    for (int i = 0; i < 100000; i++) {
        sag_surface a = random_surface(&r), b = random_surface(&r);
        sag_ray ray = sag_spawn_ray_to_point(&a, b.position);
        assert_true(ray.t_min == 0 && ray.t_max == 1 && sag_ray_is_valid(&ray));
        sag_vec3 end = sag_ray_at(&ray, 1);
        double size = sag_length(a.position) + sag_length(b.position) + sag_length(a.position_error);
        assert_true(sag_length(sag_sub(end, b.position)) <= 0x1p-50 * size);
        sag_vec3 n = sag_dot(a.geometric_normal, sag_sub(b.position, a.position)) < 0
                         ? sag_neg(a.geometric_normal)
                         : a.geometric_normal;
        assert_true(side(n, ray.origin, a.position) > 0);

        ray = sag_spawn_ray_to_surface(&a, &b);
        sag_ray back = sag_spawn_ray_to_surface(&b, &a);
        assert_true(ray.t_min == 0 && ray.t_max < 1 && ray.t_max > 1 - 0x1p-52 && sag_ray_is_valid(&ray));
        assert_true(side(n, ray.origin, a.position) > 0);
        assert_true(ray.direction.x == -back.direction.x && ray.direction.y == -back.direction.y &&
                    ray.direction.z == -back.direction.z); // both ends are where the other's ray starts
    }
}

// A floor at y = 0 hit from within (t = 0, error 0): the ray began at y = 5e-324, t underflowed to 0, and the
// floor was met again, also where a transform took 5e-324 back to 0.
static void a_floor_at_zero_is_left(void **state) {
    (void)state;
    static const float corners[12] = {-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1};
    static const uint32_t faces[6] = {0, 2, 1, 0, 3, 2};
    rng r = rng_make(3);
    sag_context *context = sag_context_create(NULL);
    for (int i = 0; i < 400; i++) {
        sag_scene *scene = sag_scene_create(context);
        if (i % 4 == 0) sag_add_plane(scene, &(sag_plane){.normal = {0, 1, 0}});
        if (i % 4 == 1) sag_add_rectangle(scene, &(sag_rectangle){{-1, 0, -1}, {2, 0, 0}, {0, 0, 2}});
        if (i % 4 == 2) sag_add_disk(scene, &(sag_disk){.normal = {0, -1, 0}, .radius = 1});
        if (i % 4 == 3)
            sag_add_mesh(scene, &(sag_mesh){.positions_f32 = corners,
                                            .vertex_count = 4,
                                            .triangles = faces,
                                            .triangle_count = 2});
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        sag_affine scale = sag_affine_scale(sag_vec3_make(size, size, size));
        if (rng_one_in(&r, 2)) assert_int_equal(sag_geometry_set_transform(scene, 0, &scale), SAG_OK);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        for (int k = 0; k < 20; k++) {
            sag_ray ray = sag_ray_make(sag_scale(rng_vec3(&r, 0.4), size), rng_direction(&r));
            sag_hit hit;
            sag_surface s;
            ray.origin.y = 0;
            if (!sag_intersect(scene, &ray, &hit)) continue;
            sag_surface_at(scene, &ray, &hit, &s);
            sag_vec3 d = sag_scale(rng_direction(&r), rng_log_uniform(&r, 1e-8, 1e8));
            ray = sag_spawn_ray(&s, d);
            assert_false(sag_intersect(scene, &ray, &hit));
        }
        sag_scene_destroy(scene);
    }
    sag_context_destroy(context);
}

static void no_distance_is_no_ray(void **state) {
    (void)state;
    sag_surface s = {.position = {1, 2, 3}, .geometric_normal = {0, 0, 1}};
    sag_ray ray = sag_spawn_ray(&s, sag_vec3_make(0, 0, 0));
    assert_false(sag_ray_is_valid(&ray));
    ray = sag_spawn_ray_to_point(&s, sag_vec3_make(1, 2, NAN));
    assert_false(sag_ray_is_valid(&ray));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_spawned_ray_starts_beyond_the_error),
        cmocka_unit_test(rays_to_points_and_surfaces_end_there),
        cmocka_unit_test(a_floor_at_zero_is_left),
        cmocka_unit_test(no_distance_is_no_ray),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
