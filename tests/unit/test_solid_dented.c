// SPDX-License-Identifier: MIT
// Packets of camera rays and solids of boxes and balls (src/solid/dented.h): every ray has the bits of the
// single call, with dents that overlap, follow each other, touch or share faces, under any map, seen from
// outside, from within, along an axis, near and far; for every instruction set of this machine.
#include "base/cpu.h"
#include "shapes/common.h"
#include "support/batch_check.h"
#include "support/random.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 48, RAYS = SIDE * SIDE };

// Numbers of which many are the same, or not.
static double number(rng *r, double size, bool round) {
    const double x = rng_uniform(r, -size, size);
    return round ? rint(4 * x) / 4 : x;
}

static uint32_t add_part(rng *r, sag_scene *solid, double most, bool round, bool convex) {
    const sag_vec3 at = {number(r, convex ? 0.3 : 1, round), number(r, convex ? 0.3 : 1, round),
                         number(r, convex ? 0.3 : 1, round)};
    double half[3];
    for (int k = 0; k < 3; k++)
        half[k] = round ? 0.25 * (1 + rng_below(r, 4)) : rng_uniform(r, 0.1, 1) * most;
    const sag_vec3 room = {half[0], half[1], half[2]};
    if (rng_one_in(r, 2)) return sag_add_box(solid, &(sag_box){sag_sub(at, room), sag_add(at, room)});
    return sag_add_sphere(solid, &(sag_sphere){.center = at, .radius = half[0] * (convex ? 1.3 : 1)});
}

static sag_scene *make_solid(rng *r, sag_context *context) {
    sag_scene *solid = sag_scene_create(context);
    const bool round = rng_one_in(r, 3);
    const uint32_t convex = 1 + rng_below(r, 3), dents = rng_below(r, 16);
    sag_solid_step steps[32];
    uint32_t count = 0;
    for (uint32_t i = 0; i < convex; i++)
        steps[count++] = (sag_solid_step){SAG_SOLID_PART, add_part(r, solid, 1, round, true)};
    if (convex > 1) steps[count++] = (sag_solid_step){SAG_SOLID_INTERSECTION, convex};
    for (uint32_t i = 0; i < dents; i++)
        steps[count++] = (sag_solid_step){SAG_SOLID_PART, add_part(r, solid, 0.5, round, false)};
    if (dents > 0 || convex == 1) steps[count++] = (sag_solid_step){SAG_SOLID_DIFFERENCE, dents + 1};
    assert_int_equal(sag_scene_set_solid(solid, &(sag_solid){steps, count}, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
    return solid;
}

static sag_affine somewhere(rng *r, sag_vec3 to, double size, int kind) {
    const sag_affine turn = sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r));
    const double flat = kind == 3 ? 0.02 : 0.7;
    const sag_affine scale = sag_affine_scale(sag_vec3_make(size, kind < 2 ? size : -size * flat, size));
    const sag_affine there = sag_affine_translate(to);
    const sag_affine turned = kind == 0 ? scale : sag_affine_multiply(&turn, &scale);
    return sag_affine_multiply(&there, &turned);
}

static void make_rays(rng *r, sag_vec3 center, double size, double distance, sag_ray *rays) {
    const bool straight = rng_one_in(r, 4);
    const sag_vec3 back = straight ? sag_vec3_make(0, 0, 1) : rng_direction(r);
    const sag_vec3 eye = sag_madd(center, distance * size, back);
    const double wide = size * (distance > 1 ? 1.2 : 0.7 * (distance + 0.1)),
                 shift = rng_one_in(r, 2) ? 0 : 0.5;
    sag_vec3 right, up;
    sag_frame(back, &right, &up);
    for (size_t i = 0; i < RAYS; i++) {
        const double x = ((double)(i % SIDE) + shift) / SIDE * 2 - 1,
                     y = ((double)(i / SIDE) + shift) / SIDE * 2 - 1;
        const sag_vec3 middle = distance > 1 ? center : sag_madd(eye, -size * (distance + 0.1), back);
        sag_vec3 to = sag_madd(sag_madd(middle, x * wide, right), y * wide, up);
        rays[i] = sag_ray_make(eye, sag_sub(to, eye));
    }
    const double range = rng_uniform(r, 0.6, 1.4);
    const int kind = (int)rng_below(r, 4);
    for (size_t i = 0; i < RAYS && kind < 2; i++) *(kind ? &rays[i].t_max : &rays[i].t_min) = range;
}

static void check_world(rng *r, sag_context *context, batch_counts *c) {
    static sag_ray rays[RAYS];
    const double scales[] = {1, 1, 1e-6, 1e5}, distances[] = {0.2, 1.1, 3, 20, 1000};
    const double scale = scales[rng_below(r, 4)];
    const sag_vec3 center = rng_vec3(r, rng_one_in(r, 2) ? 0 : 100 * scale);
    sag_scene *solids[2] = {make_solid(r, context), make_solid(r, context)};
    sag_scene *scene = sag_scene_create(context);
    const int count = rng_one_in(r, 3) ? 1 : 12;
    for (int i = 0; i < count; i++) {
        const sag_affine to =
            somewhere(r, sag_add(center, rng_vec3(r, count > 1 ? 2 * scale : 0)),
                      scale * (count > 1 ? rng_uniform(r, 0.2, 1) : 1), (int)rng_below(r, 4));
        const uint32_t id = sag_add_instance(scene, solids[i % 2], &to);
        assert_int_not_equal(id, SAG_INVALID_ID);
        if (rng_one_in(r, 8)) assert_int_equal(sag_geometry_set_mask(scene, id, 2), SAG_OK);
    }
    if (rng_one_in(r, 3))
        for (int i = 0; i < 10; i++) {
            const sag_vec3 at = sag_add(center, rng_vec3(r, 2 * scale));
            sag_add_sphere(scene, &(sag_sphere){.center = at, .radius = 0.2 * scale});
            sag_add_triangle(scene, &(sag_triangle){at, sag_add(at, rng_vec3(r, scale)), center, false});
        }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (int i = 0; i < 6; i++) {
        make_rays(r, center, (count > 1 ? 3 : 1.5) * scale, distances[rng_below(r, 5)], rays);
        for (size_t k = 0; k < RAYS && i == 0; k++) rays[k].mask = 1;
        batch_check(scene, rays, RAYS, c);
    }
    sag_scene_destroy(scene);
    for (int i = 0; i < 2; i++) sag_scene_destroy(solids[i]);
}

static void packets_answer_as_single_calls(void **state) {
    (void)state;
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_context *context =
            sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i), .thread_count = 1});
        if (context == NULL) continue;
        batch_counts c = {0};
        rng r = rng_make(77);
        for (size_t k = 0; k < soak(24); k++) check_world(&r, context, &c);
        print_message("met %zu, of these in dents %zu, missed %zu\n", c.met, c.flipped, c.missed);
        assert_true(c.met > 10000 && c.flipped > 1000 && c.missed > 10000);
        sag_context_destroy(context);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(packets_answer_as_single_calls)};
    return cmocka_run_group_tests_name("solid_dented", tests, NULL, NULL);
}
