// SPDX-License-Identifier: MIT
// What other programs got wrong about solids, each by the number of its report, on solids made of the same
// things.
#include "support/context.h"
#include "support/random.h"
#include <sagitta/solid.h>
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

// A scene that shows the solid of two geometries; `solid` is given up.
static sag_scene *show(sag_scene *solid, uint32_t a, sag_solid_operation operation, uint32_t b,
                       const sag_affine *map) {
    const sag_solid_step steps[3] = {{SAG_SOLID_PART, a}, {SAG_SOLID_PART, b}, {operation, 2}};
    const sag_affine here = sag_affine_identity();
    assert_int_equal(sag_scene_set_solid(solid, &(sag_solid){steps, 3}, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
    sag_scene *scene = sag_scene_create(context);
    sag_add_instance(scene, solid, map ? map : &here);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_scene_destroy(solid);
    return scene;
}

// From a place on the boundary, whose solid is bounded, a ray to either side: outward it meets an even number
// of boundaries, inward an odd one.
static void leave(const sag_scene *scene, const sag_surface *s, rng *r) {
    sag_vec3 d = rng_direction(r);
    if (sag_dot(d, s->geometric_normal) < 0) d = sag_neg(d);
    sag_ray out = sag_spawn_ray(s, d), in = sag_spawn_ray(s, sag_neg(d));
    assert_int_equal(sag_count_crossings(scene, &out) % 2, 0);
    assert_int_equal(sag_count_crossings(scene, &in) % 2, 1);
}

// Rays at a solid within `reach` of 0, and on from every boundary.
static void leave_everywhere(const sag_scene *scene, double reach, rng *r, int rays) {
    for (int i = 0; i < rays; i++) {
        sag_vec3 o = rng_vec3(r, 2 * reach);
        sag_ray ray = sag_ray_make(o, sag_sub(rng_vec3(r, reach), o));
        ray.t_min = -INFINITY;
        sag_hit hits[16];
        size_t n = sag_intersect_all(scene, &ray, hits, 16);
        assert_true(n <= 16 && n % 2 == 0);
        for (size_t k = 0; k < n; k++) {
            sag_surface s;
            sag_surface_at(scene, &ray, &hits[k], &s);
            assert_int_equal(s.side == SAG_SIDE_FRONT, k % 2 == 0);
            leave(scene, &s, r);
        }
    }
}

// openmc-1933, openmc-2053: a particle that started on a torus of R = 139 or R = 1000 met it again at once,
// or never. Here on the wall of a pipe bent to a ring.
static void openmc_1933_2053_start_on_a_torus(void **state) {
    (void)state;
    rng r = rng_make(1933);
    const double majors[3] = {139, 1000, 1e-6};
    for (int i = 0; i < 6; i++) {
        double major = majors[i % 3], minor = major * (i < 3 ? 0.5 : 0.0625);
        sag_scene *solid = sag_scene_create(context);
        uint32_t outer = sag_add_torus(solid, &(sag_torus){major, minor});
        uint32_t inner = sag_add_torus(solid, &(sag_torus){major, 0.5 * minor});
        sag_scene *scene = show(solid, outer, SAG_SOLID_DIFFERENCE, inner, NULL);
        double reach = major + minor;
        sag_hit hits[8];
        sag_ray ray = sag_ray_make((sag_vec3){reach, 0, 0}, (sag_vec3){-1, 0, 0});
        if (reach - major == minor) { // exactly on it: t = 0 is a boundary, and seven more come
            assert_int_equal(sag_intersect_all(scene, &ray, hits, 8), 8);
            assert_true(hits[0].t == 0 && fabs(hits[1].t / minor - 0.5) < 1e-12);
            ray.direction.x = 1;
            assert_int_equal(sag_count_crossings(scene, &ray), 1);
        }
        leave_everywhere(scene, reach, &r, 100);
        sag_scene_destroy(scene);
    }
}

// openmc-2589: a torus that meets itself. Its lens is inside, the sheet around it no boundary.
static void openmc_2589_spindle(void **state) {
    (void)state;
    rng r = rng_make(2589);
    for (int k = 0; k < 2; k++) {
        sag_scene *solid = sag_scene_create(context);
        uint32_t spindle = sag_add_torus(solid, &(sag_torus){3, 5}); // meets itself at z = ±4
        uint32_t ball = sag_add_sphere(solid, &(sag_sphere){.radius = 0.5});
        sag_scene *scene = show(solid, spindle, k ? SAG_SOLID_DIFFERENCE : SAG_SOLID_UNION, ball, NULL);
        sag_ray ray = sag_ray_make((sag_vec3){-10, 0, 0}, (sag_vec3){1, 0, 0});
        sag_hit hits[8];
        assert_int_equal(sag_intersect_all(scene, &ray, hits, 8), k ? 4 : 2);
        assert_true(hits[0].t == 2 && hits[k ? 3 : 1].t == 18);
        if (k) assert_true(hits[1].t == 9.5 && hits[1].flipped && hits[2].t == 10.5 && hits[2].flipped);
        assert_int_equal(sag_contains(scene, (sag_vec3){0.01, 0.02, 0.03}), k == 0);
        assert_true(sag_contains(scene, (sag_vec3){0, 0, 3.9}));
        assert_false(sag_contains(scene, (sag_vec3){0, 0, 4.1}));         // in the dimple
        ray = sag_ray_make((sag_vec3){1, 0, 4.75}, (sag_vec3){-1, 0, 0}); // through the dimple
        ray.t_min = -INFINITY;
        assert_int_equal(sag_count_crossings(scene, &ray), 4);
        leave_everywhere(scene, 8, &r, 200);
        sag_scene_destroy(scene);
    }
}

// pov-125: gaps and walls thinner than a fixed least depth were lost.
static void pov_125_thin_gaps_and_walls(void **state) {
    (void)state;
    rng r = rng_make(125);
    for (int i = 0; i < 400; i++) {
        double size = rng_log_uniform(&r, 1e-6, 1e6), thin = size * rng_log_uniform(&r, 1e-11, 1e-3);
        bool wall = i % 2;
        sag_box low = {{-size, -size, -size}, {size, size, 0}},
                high = {{-size, -size, thin}, {size, size, size}};
        sag_box most = {{-size, -size, thin}, {size, size, 2 * size}},
                whole = {{-size, -size, 0}, {size, size, size}};
        sag_scene *solid = sag_scene_create(context);
        uint32_t a = sag_add_box(solid, wall ? &whole : &low), b = sag_add_box(solid, wall ? &most : &high);
        sag_scene *scene = show(solid, a, wall ? SAG_SOLID_DIFFERENCE : SAG_SOLID_UNION, b, NULL);
        sag_vec3 o = {rng_uniform(&r, -0.4, 0.4) * size, rng_uniform(&r, -0.4, 0.4) * size, -2 * size};
        sag_vec3 d = {rng_uniform(&r, -0.1, 0.1), rng_uniform(&r, -0.1, 0.1), 1};
        sag_ray ray = sag_ray_make(o, d);
        sag_hit hits[4];
        assert_int_equal(sag_intersect_all(scene, &ray, hits, 4), wall ? 2 : 4);
        double width = hits[wall ? 1 : 2].t - hits[wall ? 0 : 1].t;
        assert_true(fabs(width / thin - 1) < 1e-14 * size / thin + 1e-12);
        // From within the gap, and to the wall's back from its front.
        sag_surface s;
        sag_surface_at(scene, &ray, &hits[wall ? 0 : 1], &s);
        ray = sag_spawn_ray(&s, d);
        assert_true(sag_intersect(scene, &ray, hits) &&
                    fabs(hits[0].t / thin - 1) < 1e-13 * size / thin + 1e-12);
        sag_scene_destroy(scene);
    }
}

// pov-358: roots of a quartic were off by up to 0.1. Every boundary of a bitten torus is on one of the two.
static void pov_358_boundaries_are_on_the_surfaces(void **state) {
    (void)state;
    rng r = rng_make(358);
    for (int i = 0; i < 40; i++) {
        sag_torus torus = {rng_log_uniform(&r, 0.5, 5), rng_log_uniform(&r, 0.01, 0.4)};
        sag_sphere bite = {.center = {torus.major_radius, 0, 0}, .radius = 0.7};
        double reach = torus.major_radius + torus.minor_radius;
        sag_scene *solid = sag_scene_create(context);
        uint32_t a = sag_add_torus(solid, &torus), b = sag_add_sphere(solid, &bite);
        sag_scene *scene = show(solid, a, SAG_SOLID_DIFFERENCE, b, NULL);
        for (int k = 0; k < 200; k++) {
            sag_vec3 o = rng_vec3(&r, 3 * reach), target = rng_vec3(&r, reach);
            target.z = rng_uniform(&r, -1, 1) * torus.minor_radius;
            sag_ray ray = sag_ray_make(o, sag_sub(target, o));
            sag_hit hits[8];
            size_t n = sag_intersect_all(scene, &ray, hits, 8);
            for (size_t j = 0; j < n; j++) {
                sag_vec3 p = sag_ray_at(&ray, hits[j].t);
                double off = hits[j].geometry == a
                                 ? hypot(hypot(p.x, p.y) - torus.major_radius, p.z) - torus.minor_radius
                                 : sag_length(sag_sub(p, bite.center)) - bite.radius;
                assert_true(fabs(off) < 1e-14 * (reach + sag_length(o)));
            }
        }
        leave_everywhere(scene, reach, &r, 50);
        sag_scene_destroy(scene);
    }
}

// mitsuba-1871: a ray that leaves a sphere must meet another 4e-5 around it. Here the two sides of a shell.
static void mitsuba_1871_thin_shell(void **state) {
    (void)state;
    rng r = rng_make(1871);
    for (int i = 0; i < 40; i++) {
        double size = rng_log_uniform(&r, 1e-6, 1e6);
        sag_vec3 center = rng_vec3(&r, 3 * size);
        sag_scene *solid = sag_scene_create(context);
        uint32_t outer = sag_add_sphere(solid, &(sag_sphere){.center = center, .radius = size * (1 + 4e-5)});
        uint32_t inner = sag_add_sphere(solid, &(sag_sphere){.center = center, .radius = size});
        sag_scene *scene = show(solid, outer, SAG_SOLID_DIFFERENCE, inner, NULL);
        for (int k = 0; k < 100; k++) {
            sag_ray ray = sag_ray_make(center, rng_direction(&r));
            sag_hit hit;
            sag_surface s;
            assert_true(sag_intersect(scene, &ray, &hit) && hit.geometry == inner && hit.flipped);
            sag_surface_at(scene, &ray, &hit, &s);
            assert_true(s.side == SAG_SIDE_FRONT);
            leave(scene, &s, &r);
            ray = sag_spawn_ray(&s, ray.direction);
            assert_true(sag_intersect(scene, &ray, &hit) && hit.geometry == outer && !hit.flipped);
            assert_true(fabs(hit.t / (4e-5 * size) - 1) < 1e-8);
        }
        sag_scene_destroy(scene);
    }
}

// pov-209, pov-139: faces that coincide left speckles: a skin where one solid is cut from another with a face
// in common, a wall between two that touch. At places that are no round numbers, turned as a whole.
static void pov_209_139_coincident_faces(void **state) {
    (void)state;
    rng r = rng_make(209);
    for (int i = 0; i < 200; i++) {
        double a = rng_uniform(&r, 0.5, 1), b = rng_uniform(&r, -0.3, 0.3), c = rng_uniform(&r, 0.5, 1);
        bool round = i % 2, apart = i / 2 % 2; // apart: what is left of b is one piece; else they touch in b
        sag_scene *solid = sag_scene_create(context);
        uint32_t first, second;
        if (round) {
            first = sag_add_cylinder(solid, &(sag_cylinder){0.8, -a, apart ? c : b, 0, true});
            second = sag_add_cylinder(solid, &(sag_cylinder){0.8, b, c, 0, true});
        } else {
            first = sag_add_box(solid, &(sag_box){{-0.6, -0.6, -a}, {0.6, 0.6, apart ? c : b}});
            second = sag_add_box(solid, &(sag_box){{-0.6, -0.6, b}, {0.6, 0.6, c}});
        }
        sag_affine turn = sag_affine_rotate(rng_uniform(&r, 0, 6), rng_direction(&r));
        sag_affine map = sag_affine_translate(rng_vec3(&r, 100));
        map = sag_affine_multiply(&map, &turn);
        sag_scene *scene = show(solid, first, apart ? SAG_SOLID_DIFFERENCE : SAG_SOLID_UNION, second, &map);
        for (int k = 0; k < 200; k++) {
            sag_ray ray = sag_ray_make(rng_vec3(&r, 3), (sag_vec3){0, 0, 0});
            ray.direction = sag_sub(rng_vec3(&r, 0.6), ray.origin), ray.t_min = -INFINITY;
            ray = sag_ray_transform(&map, &ray);
            sag_hit hits[4];
            size_t n = sag_intersect_all(scene, &ray, hits, 4);
            assert_true(n == 0 || n == 2); // it is convex
            assert_true(n == 0 || hits[1].t - hits[0].t > 1e-13);
        }
        leave_everywhere(scene, 100, &r, 5);
        sag_scene_destroy(scene);
    }
}

// Leaves rubbish where the next function will have its variables.
static __attribute__((noinline)) void soil_the_stack(void) {
    volatile char rubbish[100000];
    for (size_t i = 0; i < sizeof rubbish; i++) rubbish[i] = 0x24;
}

// A face of a solid that stands on another surface: both are met at the same t, and the one of the scene
// itself is told. (What nobody had written was read, to be thrown away: the sanitizer said so of dice on a
// table.)
static void solids_that_stand_on_something(void **state) {
    (void)state;
    rng r = rng_make(8);
    for (uint32_t first = 0; first < 2; first++) {
        sag_scene *solid = sag_scene_create(context), *scene = sag_scene_create(context);
        const sag_solid_step steps[5] = {{SAG_SOLID_PART, 0},
                                         {SAG_SOLID_PART, 1},
                                         {SAG_SOLID_UNION, 2},
                                         {SAG_SOLID_PART, 2},
                                         {SAG_SOLID_DIFFERENCE, 2}};
        sag_add_box(solid, &(sag_box){{-1, -1, 0}, {1, 1, 1}});
        sag_add_sphere(solid,
                       &(sag_sphere){.center = {2, 0, -0.5}, .radius = 0.5}); // the solid's box begins sooner
        sag_add_cylinder(solid, &(sag_cylinder){.radius = 0.2, .z_min = 0.5, .z_max = 2, .closed = true});
        assert_int_equal(sag_scene_set_solid(solid, &(sag_solid){steps, 5}, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
        if (first == 1) sag_add_instance(scene, solid, NULL);
        sag_add_disk(scene, &(sag_disk){.normal = {0, 0, 1}, .radius = 3});
        if (first == 0) sag_add_instance(scene, solid, NULL);
        for (int i = 0; i < 30; i++) // so that the two are in different leaves
            sag_add_disk(scene, &(sag_disk){.center = {i, 9, 0}, .normal = {0, 0, 1}, .radius = 0.1});
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        sag_ray rays[64];
        sag_hit hits[64], hit, all[2];
        for (int i = 0; i < 64; i++) // from below, as in a picture and as they come
            rays[i] = sag_ray_make((sag_vec3){0, 0, -2}, sag_vec3_make(i % 8 / 20.0, i / 8 / 20.0, 1));
        for (int turn = 0; turn < 2; turn++) {
            soil_the_stack();
            sag_intersect_batch(scene, rays, hits, 64);
            for (int i = 0; i < 64; i++) {
                soil_the_stack();
                assert_true(sag_intersect(scene, &rays[i], &hit));
                assert_memory_equal(&hit, &hits[i], sizeof hit);
                assert_true(sag_intersect_all(scene, &rays[i], all, 2) >= 2);
                assert_true(all[0].t == all[1].t && hit.t == all[0].t);
                assert_int_equal(hit.instance_depth, 0);
                rays[i] = sag_ray_make(sag_vec3_make(rng_uniform(&r, -1, 1), rng_uniform(&r, -1, 1), -2),
                                       sag_vec3_make(0, 0, 2));
            }
        }
        sag_scene_destroy(scene), sag_scene_destroy(solid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(openmc_1933_2053_start_on_a_torus),
        cmocka_unit_test(openmc_2589_spindle),
        cmocka_unit_test(pov_125_thin_gaps_and_walls),
        cmocka_unit_test(pov_358_boundaries_are_on_the_surfaces),
        cmocka_unit_test(mitsuba_1871_thin_shell),
        cmocka_unit_test(pov_209_139_coincident_faces),
        cmocka_unit_test(solids_that_stand_on_something),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
