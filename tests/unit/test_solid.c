// SPDX-License-Identifier: MIT
// Solids: what set and commit accept, and what rays meet.
#include "support/context.h"
#include "support/meshes.h"
#include "support/random.h"
#include <sagitta/solid.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#define PART(id)                                                                                             \
    { SAG_SOLID_PART, (id) }
#define UNION(n)                                                                                             \
    { SAG_SOLID_UNION, (n) }
#define INTERSECTION(n)                                                                                      \
    { SAG_SOLID_INTERSECTION, (n) }
#define DIFFERENCE(n)                                                                                        \
    { SAG_SOLID_DIFFERENCE, (n) }
#define XOR(n)                                                                                               \
    { SAG_SOLID_XOR, (n) }
#define COUNT(a)      (uint32_t)(sizeof(a) / sizeof *(a))
#define SET(scene, a) assert_int_equal(sag_scene_set_solid(scene, &(sag_solid){a, COUNT(a)}, NULL), SAG_OK)
#define COMMIT(scene) assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK)

static uint32_t add_cube(sag_scene *s, double lo, double hi) {
    return sag_add_box(s, &(sag_box){{lo, lo, lo}, {hi, hi, hi}});
}
static uint32_t add_ball(sag_scene *s, double x, double y, double z, double radius) {
    return sag_add_sphere(s, &(sag_sphere){.center = {x, y, z}, .radius = radius});
}
static sag_ray along_x(double x, double y, double z) {
    return sag_ray_make(sag_vec3_make(x, y, z), sag_vec3_make(1, 0, 0));
}

// A die: the box and the ball have corners in common, and six sides with one pip each.
static sag_scene *make_die(void) {
    sag_scene *s = sag_scene_create(context);
    add_cube(s, -1, 1);
    add_ball(s, 0, 0, 0, 1.4);
    for (int k = 0; k < 6; k++)
        add_ball(s,
                 k == 0   ? 1
                 : k == 1 ? -1
                          : 0,
                 k == 2   ? 1
                 : k == 3 ? -1
                          : 0,
                 k == 4   ? 1
                 : k == 5 ? -1
                          : 0,
                 0.2);
    const sag_solid_step steps[] = {PART(0), PART(1), INTERSECTION(2), PART(2), PART(3),
                                    PART(4), PART(5), PART(6),         PART(7), DIFFERENCE(7)};
    SET(s, steps);
    COMMIT(s);
    return s;
}

static void a_die(void **state) {
    (void)state;
    sag_scene *die = make_die();
    sag_ray ray = along_x(-5, 0, 0);
    sag_hit hit, all[8];
    assert_true(sag_intersect(die, &ray, &hit)); // the bottom of the pip at x = −1
    assert_true(fabs(hit.t - 4.2) < 1e-12);
    assert_int_equal(hit.geometry, 3);
    assert_int_equal(hit.flipped, 1);
    assert_int_equal(hit.instance_depth, 0);
    assert_int_equal(sag_intersect_all(die, &ray, all, 8), 2);
    assert_int_equal(all[1].geometry, 2);
    assert_true(fabs(all[1].t - 5.8) < 1e-12);
    sag_surface at;
    sag_surface_at(die, &ray, &hit, &at);
    assert_true(at.geometric_normal.x < -0.999 && at.side == SAG_SIDE_FRONT);
    sag_surface_at(die, &ray, &all[1], &at);
    assert_true(at.geometric_normal.x > 0.999 && at.side == SAG_SIDE_BACK);
    ray = along_x(-5, 0.5, 0.5);
    assert_true(sag_intersect(die, &ray, &hit));
    assert_true(hit.geometry == 0 && hit.flipped == 0 && hit.t == 4);
    ray = along_x(-5, 0.98, 0.98); // the ball has taken the edge away
    assert_int_equal(sag_count_crossings(die, &ray), 2);
    assert_true(sag_intersect(die, &ray, &hit) && hit.geometry == 1);
    assert_true(sag_contains(die, sag_vec3_make(0, 0, 0)));
    assert_false(sag_contains(die, sag_vec3_make(0.99, 0, 0)));
    assert_false(sag_contains(die, sag_vec3_make(0.99, 0.99, 0.99)));
    sag_box3 b = sag_scene_bounds(die);
    assert_true(fabs(b.max.x - 1) < 1e-12 && fabs(b.min.z + 1) < 1e-12);
    sag_scene_destroy(die);
}

static void instances_of_a_die(void **state) {
    (void)state;
    sag_scene *die = make_die(), *s = sag_scene_create(context);
    for (int i = 0; i < 3; i++) {
        sag_affine map = sag_affine_translate(sag_vec3_make(3 * i, 0, 0));
        sag_add_instance(s, die, &map);
    }
    COMMIT(s);
    sag_ray ray = along_x(-5, 0.5, 0);
    sag_hit hit, all[9];
    assert_int_equal(sag_intersect_all(s, &ray, all, 9), 6);
    for (int i = 0; i < 6; i++) assert_int_equal(all[i].instance_path[0], i / 2);
    assert_true(sag_intersect(s, &ray, &hit) && hit.t == 4 && hit.geometry == 0 && hit.instance_depth == 1);
    assert_true(sag_occluded(s, &ray));
    ray.t_min = 4.5, ray.t_max = 5.5;
    assert_false(sag_occluded(s, &ray));
    ray.t_max = 6;
    assert_true(sag_occluded(s, &ray));
    sag_closest near;
    assert_false(sag_closest_point(s, sag_vec3_make(0, 0, 0), INFINITY, &near));
    sag_scene_destroy(die), sag_scene_destroy(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_die),
        cmocka_unit_test(instances_of_a_die),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
