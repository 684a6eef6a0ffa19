// SPDX-License-Identifier: MIT
// Solids of so many parts on one ray that no fixed list holds them: in a row, over each other, all in one
// place, with faces that coincide by the hundred.
#include "shapes/shape.h"
#include "support/context.h"
#include "support/random_model.h"
#include "support/solid_check.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

static void put_ball(solid_model *m, double x, double y, double z, double radius) {
    random_shape *s = &solid_model_add(m)->shape;
    s->kind = SAG_SHAPE_SPHERE, s->as.sphere = (sag_sphere){.center = {x, y, z}, .radius = radius};
}
static void put_box(solid_model *m, sag_vec3 min, sag_vec3 max) {
    random_shape *s = &solid_model_add(m)->shape;
    s->kind = SAG_SHAPE_BOX, s->as.box = (sag_box){min, max};
}

// Finishes the model and sends rays along its length (the x axis, about `length` long) and askew.
static void check(const char *name, solid_model *model, rng *r, double length, size_t rays) {
    sag_error error = {0};
    solid_tally tally = {0};
    if (solid_model_finish(model, context, r, &error) != SAG_OK) fail_msg("%s", error.message);
    solid_world world;
    solid_world_make(&world, context, model, NULL, 1);
    for (size_t i = 0; i < rays; i++) {
        sag_ray ray = sag_ray_make((sag_vec3){-0.7 * length, 0, 0}, (sag_vec3){1, 0, 0});
        if (i % 4 == 1) ray.origin.x = rng_uniform(r, -0.5, 0.5) * length;
        if (i % 4 > 1) {
            ray.origin = sag_vec3_make(-0.7 * length, rng_uniform(r, -0.2, 0.2), rng_uniform(r, -0.2, 0.2));
            sag_vec3 to = {0.7 * length, rng_uniform(r, -0.2, 0.2), rng_uniform(r, -0.2, 0.2)};
            ray.direction = sag_scale(sag_sub(to, ray.origin), rng_uniform(r, 0.5, 2));
        }
        if (i % 8 >= 4) ray.origin.x = -ray.origin.x, ray.direction.x = -ray.direction.x;
        if (i % 16 >= 12) {
            ray.t_min = rng_uniform(r, 0, 1.4) * length / fabs(ray.direction.x);
            ray.t_max = ray.t_min * rng_uniform(r, 1, 1.5);
        }
        solid_check_ray(&world, &ray, r, i % 4 > 1, &tally);
    }
    solid_world_free(&world);
    solid_tally_finish(&tally, name);
}

// 700 balls in a row, apart, touching or overlapping, as a union, as holes of a bar, under exclusive or.
static void rows(void **state) {
    (void)state;
    rng r = rng_make(60);
    const double radii[4] = {0.4, 0.5, 0.8, 40}; // of a step of 1
    for (int k = 0; k < 12; k++) {
        solid_model *m = solid_model_create();
        if (k / 4 == 1) put_box(m, (sag_vec3){-400, -1, -1}, (sag_vec3){400, 1, 1});
        for (int i = 0; i < 700; i++) put_ball(m, i - 350, 0, 0, radii[k % 4]);
        solid_model_step(m, k / 4 == 2 ? SAG_SOLID_XOR : SAG_SOLID_UNION, 700);
        if (k / 4 == 1) solid_model_step(m, SAG_SOLID_DIFFERENCE, 2);
        check("row", m, &r, 700, soak(8));
    }
}

// 500 concentric balls: all boxes overlap. And 500 boxes that share all but one face, or every face.
static void piles(void **state) {
    (void)state;
    rng r = rng_make(61);
    static const sag_solid_operation operations[4] = {SAG_SOLID_UNION, SAG_SOLID_INTERSECTION,
                                                      SAG_SOLID_DIFFERENCE, SAG_SOLID_XOR};
    for (int k = 0; k < 4; k++) {
        solid_model *m = solid_model_create();
        for (int i = 0; i < 500; i++) put_ball(m, 0, 0, 0, 0.2 + 0.001 * (k == 2 ? 500 - i : i));
        solid_model_step(m, operations[k], 500);
        check("concentric", m, &r, 2, soak(8));
        for (int same = 0; same < 2; same++) {
            m = solid_model_create();
            for (int i = 0; i < 501; i++)
                put_box(m, (sag_vec3){-1, -1, -1}, (sag_vec3){same ? 1 : 1 - 0.003 * i, 1, 1});
            solid_model_step(m, operations[k], 501);
            check("boxes with common faces", m, &r, 4, soak(8));
        }
    }
}

// A comb: pairs of slabs that meet, 600 of them, each pair a solid of its own.
static void comb(void **state) {
    (void)state;
    rng r = rng_make(62);
    for (int k = 0; k < 2; k++) {
        solid_model *m = solid_model_create();
        for (int i = 0; i < 600; i++) {
            put_box(m, (sag_vec3){i - 300, -1, -1}, (sag_vec3){i - 299.5, 1, 1});
            put_box(m, (sag_vec3){i - 299.5, -1, -1}, (sag_vec3){i - 299 - 0.25 * k, 1, 1});
            solid_model_step(m, SAG_SOLID_UNION, 2);
        }
        solid_model_step(m, SAG_SOLID_XOR, 600);
        check("comb", m, &r, 600, soak(8));
    }
}

// Hundreds of random shapes over each other; in every third thicket in pairs, so that more operations are
// under way at one place than a query has room for.
static void thickets(void **state) {
    (void)state;
    solid_tally tally = {0};
    for (uint64_t seed = 0; seed < soak(12); seed++) {
        rng r = rng_make(tally.seed = 6300 + seed);
        solid_recipe how = {.size = 1, .leaves = 600, .depth = 8, .unmapped = true, .lattice = seed % 2};
        solid_model *model = solid_model_create();
        const bool pairs = seed % 3 == 2;
        uint32_t parts = (pairs ? 700 : 300) + rng_below(&r, 300), group = 0;
        for (uint32_t i = 0; i < parts; i++) {
            model_part *part = solid_model_add(model);
            do closed_shape_make(&r, how.size, how.lattice, &part->shape);
            while (sagi_shape_classes[part->shape.kind].validate(&part->shape.as, NULL) != SAG_OK);
            uint32_t full = pairs ? 2 : 3 + rng_below(&r, 6);
            if (++group < full && i + 1 < parts) continue;
            solid_model_step(model, (sag_solid_operation)(SAG_SOLID_UNION + rng_below(&r, pairs ? 3 : 4)),
                             group);
            group = 0;
        }
        uint32_t groups = 0;
        for (uint32_t i = 0; i < model->step_count; i++)
            groups += model->steps[i].operation != SAG_SOLID_PART;
        solid_model_step(model, SAG_SOLID_XOR, groups);
        sag_error error = {0};
        if (solid_model_finish(model, context, &r, &error) != SAG_OK) fail_msg("%s", error.message);
        solid_world world;
        solid_world_make(&world, context, model, NULL, how.size);
        sag_vec3 points[SOLID_POINTS];
        adversary a = {{0, 0, 0}, how.size, points, random_model_points(&r, model, points)};
        for (int k = 0; k < (pairs ? 4 : 16); k++) {
            bool random;
            sag_ray ray = random_model_ray(&r, &how, &a, &random);
            solid_check_ray(&world, &ray, &r, random, &tally);
        }
        solid_world_free(&world);
    }
    solid_tally_finish(&tally, "thickets");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rows), cmocka_unit_test(piles),
                                       cmocka_unit_test(comb), cmocka_unit_test(thickets)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
