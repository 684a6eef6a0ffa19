// SPDX-License-Identifier: MIT
// Random solids of every closed shape, trees up to eight operations deep, in general position and on a
// lattice where faces coincide, nested and mapped, against the membership of points decided exactly
// (support/region.h). Prints how many decisions there were; not one may be wrong.
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

#define RAYS_PER_SOLID 250

static void check_solids(const char *name, uint64_t seed, size_t count, const solid_recipe *kind,
                         bool placed) {
    solid_tally tally = {0};
    for (size_t i = 0; i < count; i++) {
        tally.seed = seed + i;
        rng r = rng_make(seed + i);
        solid_recipe how = *kind;
        how.leaves = 1 + rng_below(&r, kind->leaves), how.depth = rng_below(&r, kind->depth + 1);
        int exponent = rng_one_in(&r, 2) ? 0 : (int)rng_below(&r, 60) - 30;
        how.size = how.lattice ? ldexp(1, exponent) : ldexp(rng_uniform(&r, 1, 2), exponent);
        solid_model *model = random_model_make(&r, context, &how);
        sag_affine map;
        bool moved = placed && random_place(&r, how.size, &map);
        solid_world world;
        solid_world_make(&world, context, model, moved ? &map : NULL, how.size);
        sag_vec3 points[SOLID_POINTS];
        adversary a = {{0, 0, 0}, how.size, points, random_model_points(&r, model, points)};
        for (int k = 0; k < RAYS_PER_SOLID; k++) {
            bool random;
            sag_ray ray = random_model_ray(&r, &how, &a, &random);
            if (moved) ray = sag_ray_transform(&map, &ray);
            solid_check_ray(&world, &ray, &r, random && !moved, &tally);
        }
        solid_world_free(&world);
    }
    solid_tally_finish(&tally, name);
}

static void general(void **state) {
    (void)state;
    solid_recipe how = {.leaves = 24, .depth = 8, .unmapped = true};
    check_solids("general", 1000000, soak(1500), &how, false);
}

static void lattice(void **state) {
    (void)state;
    solid_recipe how = {.leaves = 24, .depth = 8, .unmapped = true, .lattice = true};
    check_solids("lattice", 2000000, soak(1600), &how, false);
}

static void mapped(void **state) {
    (void)state;
    solid_recipe how = {.leaves = 24, .depth = 8};
    check_solids("mapped", 3000000, soak(700), &how, true);
}

static void nested(void **state) {
    (void)state;
    solid_recipe how = {.leaves = 10, .depth = 4, .nesting = 2};
    check_solids("nested", 4000000, soak(550), &how, true);
}

static void nested_lattice(void **state) {
    (void)state;
    solid_recipe how = {.leaves = 10, .depth = 4, .nesting = 2, .lattice = true};
    check_solids("nested lattice", 5000000, soak(550), &how, false);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(general), cmocka_unit_test(lattice),        cmocka_unit_test(mapped),
        cmocka_unit_test(nested),  cmocka_unit_test(nested_lattice),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
