// SPDX-License-Identifier: MIT
// What solid.h says of setting, committing and asking solids, sentence by sentence.
#include "scene/scene.h"
#include "support/context.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include "support/random_solid.h"
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define PART(id)                                                                                             \
    { SAG_SOLID_PART, (id) }
#define COUNT(a) (uint32_t)(sizeof(a) / sizeof *(a))

static sag_status set(sag_scene *s, const sag_solid_step *steps, uint32_t count) {
    return sag_scene_set_solid(s, &(sag_solid){steps, count}, NULL);
}
static sag_status commit(sag_scene *s) { return sag_scene_commit(s, NULL); }

static uint32_t add_box(sag_scene *s, double x0, double x1) {
    return sag_add_box(s, &(sag_box){{x0, -1, -1}, {x1, 1, 1}});
}
// One operation over all geometries.
static sag_scene *solid_of(sag_scene *s, sag_solid_operation operation) {
    sag_solid_step steps[16];
    uint32_t count = sagi_scene_snapshot(s) != NULL ? 0 : s->count;
    for (uint32_t i = 0; i < count; i++) steps[i] = (sag_solid_step)PART(i);
    steps[count] = (sag_solid_step){operation, count};
    assert_int_equal(set(s, steps, count + 1), SAG_OK);
    assert_int_equal(commit(s), SAG_OK);
    return s;
}

static void steps_that_are_no_tree(void **state) {
    (void)state;
    sag_scene *s = sag_scene_create(context);
    add_box(s, 0, 1), add_box(s, 2, 3);
    const sag_solid_step none[] = {{SAG_SOLID_UNION, 1}}, zero[] = {PART(0), {SAG_SOLID_UNION, 0}},
                         few[] = {PART(0), {SAG_SOLID_UNION, 2}}, left[] = {PART(0), PART(1)},
                         odd[] = {PART(0), {(sag_solid_operation)9, 1}};
    sag_error error;
    assert_int_equal(set(s, none, 1), SAG_ERROR_ARGUMENT);
    assert_int_equal(set(s, zero, 2), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_scene_set_solid(s, &(sag_solid){few, 2}, &error), SAG_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "step 1"));
    assert_int_equal(set(s, left, 2), SAG_ERROR_ARGUMENT);
    assert_int_equal(set(s, odd, 2), SAG_ERROR_ARGUMENT);
    assert_int_equal(set(s, odd, 0), SAG_ERROR_ARGUMENT);
    assert_int_equal(set(s, NULL, 0), SAG_ERROR_ARGUMENT);
    assert_int_equal(commit(s), SAG_OK); // nothing was changed: an ordinary scene
    sag_ray ray = sag_ray_make(sag_vec3_make(-1, 0, 0), sag_vec3_make(1, 0, 0));
    assert_int_equal(sag_count_crossings(s, &ray), 4);
    sag_scene_destroy(s);
}

static void how_deep(void **state) {
    (void)state;
    for (uint32_t depth = SAG_SOLID_MAX_DEPTH; depth <= SAG_SOLID_MAX_DEPTH + 1; depth++) {
        sag_scene *s = sag_scene_create(context);
        sag_solid_step steps[3 * SAG_SOLID_MAX_DEPTH];
        uint32_t count = 0;
        steps[count++] = (sag_solid_step)PART(add_box(s, 0, 1));
        for (uint32_t i = 0; i < depth;
             i++) { // operations that cannot be taken together, and one operand each
            steps[count++] = (sag_solid_step)PART(add_box(s, i % 2 ? 0 : 0.25, 1));
            steps[count++] = (sag_solid_step){i % 2 ? SAG_SOLID_UNION : SAG_SOLID_INTERSECTION, 2};
            steps[count - 1].number = 2;
        }
        assert_int_equal(set(s, steps, count), depth > SAG_SOLID_MAX_DEPTH ? SAG_ERROR_ARGUMENT : SAG_OK);
        if (depth <= SAG_SOLID_MAX_DEPTH) {
            assert_int_equal(commit(s), SAG_OK);
            assert_true(sag_contains(s, sag_vec3_make(0.5, 0, 0)));
            assert_true(sag_contains(s, sag_vec3_make(0.1, 0, 0))); // the last is a union with all of it
        }
        sag_scene_destroy(s);
    }
}

static void parts_that_a_commit_refuses(void **state) {
    (void)state;
    sag_scene *s = sag_scene_create(context), *plain = sag_scene_create(context);
    add_box(plain, 0, 1);
    assert_int_equal(commit(plain), SAG_OK);
    add_box(s, 0, 1), add_box(s, 0.5, 2);
    const sag_solid_step one[] = {PART(0)}, twice[] = {PART(0), PART(0), {SAG_SOLID_UNION, 2}},
                         both[] = {PART(0), PART(1), {SAG_SOLID_UNION, 2}},
                         three[] = {PART(0), PART(1), PART(2), {SAG_SOLID_UNION, 3}};
    assert_int_equal(set(s, one, 1), SAG_OK);
    assert_int_equal(commit(s), SAG_ERROR_ARGUMENT); // geometry 1 is no part
    assert_int_equal(set(s, twice, 3), SAG_OK);
    assert_int_equal(commit(s), SAG_ERROR_ARGUMENT);
    assert_int_equal(set(s, three, 4), SAG_OK);
    assert_int_equal(commit(s), SAG_ERROR_ARGUMENT); // geometry 2 is not there
    assert_int_equal(set(s, both, 3), SAG_OK);
    assert_int_equal(commit(s), SAG_OK);
    sag_ray ray = sag_ray_make(sag_vec3_make(-1, 0, 0), sag_vec3_make(1, 0, 0));
    assert_int_equal(sag_count_crossings(s, &ray), 2);
    sag_error error;
    assert_int_equal(set(s, three, 4), SAG_OK);
    sag_add_cylinder(s, &(sag_cylinder){.radius = 1, .z_min = 0, .z_max = 1});
    assert_int_equal(sag_scene_commit(s, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "geometry 2"));
    assert_int_equal(sag_count_crossings(s, &ray), 2); // as before
    assert_int_equal(sag_geometry_remove(s, 2), SAG_OK);
    assert_int_equal(commit(s), SAG_ERROR_ARGUMENT); // a step names it
    assert_int_equal(set(s, both, 3), SAG_OK);
    assert_int_equal(commit(s), SAG_OK);
    sag_add_instance(s, plain, NULL);
    const sag_solid_step shown[] = {PART(0), PART(1), PART(3), {SAG_SOLID_UNION, 3}};
    assert_int_equal(set(s, shown, 4), SAG_OK);
    assert_int_equal(sag_scene_commit(s, &error), SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_geometry_remove(s, 3), SAG_OK);
    assert_int_equal(sag_scene_set_solid(s, NULL, NULL), SAG_OK);
    assert_int_equal(commit(s), SAG_OK); // an ordinary scene again
    assert_int_equal(sag_count_crossings(s, &ray), 4);
    sag_scene_destroy(s), sag_scene_destroy(plain);
}

static void a_disabled_part_is_nowhere(void **state) {
    (void)state;
    sag_ray ray = sag_ray_make(sag_vec3_make(-1, 0, 0), sag_vec3_make(1, 0, 0));
    for (int operation = SAG_SOLID_UNION; operation <= SAG_SOLID_XOR; operation++) {
        sag_scene *s = sag_scene_create(context);
        add_box(s, 0, 2), add_box(s, 1, 3);
        solid_of(s, (sag_solid_operation)operation);
        assert_int_equal(sag_geometry_set_enabled(s, 1, false), SAG_OK);
        assert_int_equal(commit(s), SAG_OK);
        assert_int_equal(sag_count_crossings(s, &ray), operation == SAG_SOLID_INTERSECTION ? 0 : 2);
        assert_int_equal(sag_geometry_set_enabled(s, 1, true), SAG_OK);
        assert_int_equal(commit(s), SAG_OK);
        assert_int_equal(sag_count_crossings(s, &ray), operation == SAG_SOLID_XOR ? 4 : 2);
        sag_scene_destroy(s);
    }
}

// [0, 1] and [1 + gap, 2], or [0, 1] and [0, 1 + gap]: faces that coincide, nearly, or not.
static void coincident_faces(void **state) {
    (void)state;
    const double gaps[3] = {0, 0x1p-51, 0x1p-40};
    for (int k = 0; k < 3; k++)
        for (int operation = SAG_SOLID_UNION; operation <= SAG_SOLID_XOR; operation++)
            for (int side = 0; side < 2; side++) {
                sag_scene *s = sag_scene_create(context);
                add_box(s, 0, 1), add_box(s, 1 + gaps[k], 2);
                solid_of(s, (sag_solid_operation)operation);
                sag_ray ray =
                    sag_ray_make(sag_vec3_make(side ? 3 : -1, 0.5, 0.25), sag_vec3_make(side ? -1 : 1, 0, 0));
                bool apart = k == 2, both = operation == SAG_SOLID_UNION || operation == SAG_SOLID_XOR;
                size_t wanted = both ? (apart ? 4 : 2) : operation == SAG_SOLID_INTERSECTION ? 0 : 2;
                assert_int_equal(sag_count_crossings(s, &ray), wanted);
                sag_scene_destroy(s);
                s = sag_scene_create(context);
                add_box(s, 0, 1 + gaps[k]), add_box(s, 0, 1);
                solid_of(s, (sag_solid_operation)operation);
                bool rest = operation == SAG_SOLID_DIFFERENCE || operation == SAG_SOLID_XOR;
                assert_int_equal(sag_count_crossings(s, &ray), rest && !apart ? 0 : 2);
                sag_scene_destroy(s);
            }
}

static void ranges_ends_and_bad_rays(void **state) {
    (void)state;
    sag_scene *s = sag_scene_create(context);
    add_box(s, 0, 4), add_box(s, 1, 2);
    solid_of(s, SAG_SOLID_DIFFERENCE); // [0, 1] and [2, 4]
    sag_ray ray = sag_ray_make(sag_vec3_make(-1, 0, 0), sag_vec3_make(1, 0, 0));
    sag_hit hits[4], hit;
    assert_int_equal(sag_intersect_all(s, &ray, hits, 4), 4);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(hits[i].flipped, i == 1 || i == 2);
        assert_int_equal(hits[i].geometry, i == 1 || i == 2);
        ray.t_min = ray.t_max = hits[i].t;
        assert_true(sag_intersect(s, &ray, &hit) && hit.t == hits[i].t && sag_occluded(s, &ray));
        assert_int_equal(sag_count_crossings(s, &ray), 1);
    }
    ray.t_min = 2.5, ray.t_max = INFINITY; // from the gap
    assert_true(sag_intersect(s, &ray, &hit) && hit.t == 3 && hit.flipped == 1);
    ray.t_min = 3.5; // from within
    assert_true(sag_intersect(s, &ray, &hit) && hit.t == 5 && hit.flipped == 0);
    ray.t_min = 5.5;
    assert_false(sag_intersect(s, &ray, &hit));
    ray.t_min = -INFINITY;
    assert_int_equal(sag_count_crossings(s, &ray), 4);
    ray.direction.x = 0;
    assert_false(sag_intersect(s, &ray, &hit));
    ray.direction.x = NAN;
    assert_true(!sag_intersect(s, &ray, &hit) && !sag_occluded(s, &ray) && sag_count_crossings(s, &ray) == 0);
    sag_scene_destroy(s);
}

static void masks_and_user_data(void **state) {
    (void)state;
    sag_scene *solid = sag_scene_create(context), *s = sag_scene_create(context);
    add_box(solid, 0, 1), add_box(solid, 0.5, 2);
    sag_geometry_set_mask(solid, 0, 1), sag_geometry_set_mask(solid, 1, 2);
    sag_geometry_set_user_data(solid, 1, 77);
    solid_of(solid, SAG_SOLID_DIFFERENCE);
    uint32_t id = sag_add_instance(s, solid, NULL);
    sag_geometry_set_mask(s, id, 4);
    assert_int_equal(commit(s), SAG_OK);
    sag_ray ray = sag_ray_make(sag_vec3_make(-1, 0, 0), sag_vec3_make(1, 0, 0));
    sag_hit hits[2];
    for (uint32_t mask = 1; mask <= 4; mask *= 2) {
        ray.mask = mask;
        assert_int_equal(sag_intersect_all(s, &ray, hits, 2), mask == 4 ? 2 : 0);
    }
    sag_surface at;
    sag_surface_at(s, &ray, &hits[1], &at);
    assert_int_equal(at.user_data, 77);
    assert_true(at.side == SAG_SIDE_BACK && at.geometric_normal.x == 1); // out of the solid
    sag_scene_destroy(s), sag_scene_destroy(solid);
}

// A half-space makes solids without end.
static void without_end(void **state) {
    (void)state;
    sag_scene *s = sag_scene_create(context);
    sag_add_plane(s, &(sag_plane){.normal = {1, 0, 0}}); // x ≤ 0
    sag_add_sphere(s, &(sag_sphere){.center = {-5, 0, 0}, .radius = 1});
    solid_of(s, SAG_SOLID_DIFFERENCE);
    assert_true(isinf(sag_scene_bounds(s).min.x));
    assert_true(sag_contains(s, sag_vec3_make(-1e6, 3, 2)));
    assert_false(sag_contains(s, sag_vec3_make(-5, 0, 0)));
    assert_false(sag_contains(s, sag_vec3_make(1, 0, 0)));
    sag_ray ray = sag_ray_make(sag_vec3_make(10, 0, 0), sag_vec3_make(-1, 0, 0));
    assert_int_equal(sag_count_crossings(s, &ray), 3);
    ray.origin.y = 2;
    assert_int_equal(sag_count_crossings(s, &ray), 1);
    sag_scene_destroy(s);
}

// A ray spawned at a boundary begins on the side of it that it points to, and does not meet it again.
static void spawned_rays(void **state) {
    (void)state;
    rng r = rng_make(11);
    for (int i = 0; i < 300; i++) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        sag_scene *solid = sag_scene_create(context), *s = sag_scene_create(context);
        sag_vec3 at = rng_vec3(&r, size);
        for (int k = 0; k < 3; k++) { // two boxes that coincide in all faces, and a ball
            sag_vec3 half = sag_vec3_make(size, size, size);
            if (k < 2) sag_add_box(solid, &(sag_box){sag_sub(at, half), sag_add(at, half)});
        }
        sag_add_sphere(solid, &(sag_sphere){.center = sag_add(at, rng_vec3(&r, size)), .radius = 0.7 * size});
        solid_of(solid, i % 2 ? SAG_SOLID_UNION : SAG_SOLID_DIFFERENCE);
        const sag_solid_step steps[] = {
            PART(0), PART(1), {SAG_SOLID_UNION, 2}, PART(2), {SAG_SOLID_DIFFERENCE, 2}};
        assert_int_equal(set(solid, steps, COUNT(steps)), SAG_OK);
        assert_int_equal(commit(solid), SAG_OK);
        sag_affine map;
        sag_add_instance(s, solid, random_place(&r, size, &map) ? &map : NULL);
        assert_int_equal(commit(s), SAG_OK);
        sag_box3 b = sag_scene_bounds(s);
        for (int k = 0; k < 30; k++) {
            sag_vec3 target =
                sag_vec3_make(rng_uniform(&r, b.min.x, b.max.x), rng_uniform(&r, b.min.y, b.max.y),
                              rng_uniform(&r, b.min.z, b.max.z));
            sag_vec3 from = sag_madd(target, 5 * sag_length(sag_sub(b.max, b.min)), rng_direction(&r));
            sag_ray ray = sag_ray_make(from, sag_sub(target, from));
            sag_hit hit, next;
            if (!sag_intersect(s, &ray, &hit)) continue;
            sag_surface p;
            sag_surface_at(s, &ray, &hit, &p);
            assert_true(p.side == SAG_SIDE_FRONT);
            // Edges apart, where what is outward of one face is inward of another.
            sag_vec3 out = p.geometric_normal;
            sag_ray away = sag_spawn_ray(&p, out), into = sag_spawn_ray(&p, sag_neg(out));
            assert_false(sag_contains(s, away.origin));
            assert_true(sag_contains(s, into.origin));
            double least = sag_length(p.position_error);
            if (sag_intersect(s, &away, &next)) assert_true(next.t > 4 * least);
        }
        sag_scene_destroy(s), sag_scene_destroy(solid);
    }
}

static void what_is_held(void **state) {
    (void)state;
    size_t before, now;
    sag_scene *warm = sag_scene_create(context); // threads start
    add_box(warm, 0, 1);
    assert_int_equal(commit(warm), SAG_OK);
    sag_scene_destroy(warm);
    sag_context_memory(context, &before, NULL);
    test_mesh ball = test_mesh_sphere(3);
    rng r = rng_make(5);
    for (int i = 0; i < 20; i++) {
        sag_scene *s = random_solid(&r, context, 1 + rng_below(&r, 20), 0, 1, NULL, NULL);
        sag_scene_stats stats;
        for (int round = 0; round < 3; round++) {
            sag_context_memory(context, &now, NULL);
            sag_scene_get_stats(s, &stats);
            assert_int_equal(stats.memory_bytes, now - before);
            if (round == 1) assert_int_equal(sag_geometry_set_enabled(s, 0, false), SAG_OK);
            assert_int_equal(commit(s), SAG_OK);
        }
        sag_scene_destroy(s);
        sag_context_memory(context, &now, NULL);
        assert_int_equal(now, before);
    }
    sag_scene *s = sag_scene_create(context);
    sag_add_mesh(s, &ball.mesh);
    sag_add_sphere(s, &(sag_sphere){.center = {1, 0, 0}, .radius = 0.5});
    solid_of(s, SAG_SOLID_DIFFERENCE);
    sag_scene_stats stats;
    sag_scene_get_stats(s, &stats);
    sag_context_memory(context, &now, NULL);
    assert_int_equal(stats.memory_bytes, now - before);
    assert_int_equal(stats.primitive_count, 2);
    sag_scene_destroy(s);
    test_mesh_free(&ball);
    sag_context_memory(context, &now, NULL);
    assert_int_equal(now, before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_that_are_no_tree),
        cmocka_unit_test(how_deep),
        cmocka_unit_test(parts_that_a_commit_refuses),
        cmocka_unit_test(a_disabled_part_is_nowhere),
        cmocka_unit_test(coincident_faces),
        cmocka_unit_test(ranges_ends_and_bad_rays),
        cmocka_unit_test(masks_and_user_data),
        cmocka_unit_test(without_end),
        cmocka_unit_test(spawned_rays),
        cmocka_unit_test(what_is_held),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
