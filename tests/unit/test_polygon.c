// SPDX-License-Identifier: MIT
// The polygon: what is not one, holes, area and samples, and polygons beside triangles.
#include "support/random.h"
#include <sagitta/shapes.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void check_invalid(const sag_vec3 *p, uint32_t count, const uint32_t *sizes, uint32_t loops,
                          const char *word) {
    sag_polygon s = {p, count, sizes, loops};
    sag_error error;
    assert_int_equal(sag_polygon_validate(&s, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, word));
    sag_ray ray = sag_ray_make((sag_vec3){0.3, 0.4, 5}, (sag_vec3){0, 0, -1});
    sag_surface surface;
    sag_polygon_occluded(&s, &ray); // whatever comes, nothing is read that is not there
    sag_polygon_sample(&s, (sag_vec2){0.5, 0.5}, &surface);
}

static void test_invalid(void **state) {
    (void)state;
    const uint32_t three = 3, four = 4, two = 2, split[2] = {4, 4};
    const sag_vec3 square[8] = {{0, 0, 0},   {1, 0, 0},   {1, 1, 0},   {0, 1, 0},
                                {0.5, 0, 0}, {2, 0.5, 0}, {0.5, 1, 0}, {0.2, 0.5, 0}};
    sag_vec3 p[4];
    check_invalid(NULL, 4, &four, 1, "positions");
    check_invalid(square, 4, &four, 0, "positions");
    check_invalid(square, 2, &two, 1, "loop_sizes[0] is 2");
    check_invalid(square, 4, &three, 1, "add up");
    check_invalid(square, 8, split, 2, "crosses itself"); // the hole sticks out
    memcpy(p, square, sizeof p);
    p[2].z = 1e-8;
    check_invalid(p, 4, &four, 1, "not planar");
    p[2].z = 1e-10; // within 1e-9 of the extent
    sag_polygon s = {p, 4, &four, 1};
    assert_int_equal(sag_polygon_validate(&s, NULL), SAG_OK);
    p[2].z = NAN;
    check_invalid(p, 4, &four, 1, "positions[2]");
    const sag_vec3 bow[4] = {{0, 0, 0}, {2, 1, 0}, {2, 0, 0}, {0, 2, 0}};
    check_invalid(bow, 4, &four, 1, "crosses itself");
    const sag_vec3 line[3] = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
    check_invalid(line, 3, &three, 1, "no area");
}

// A hole, and an island in it; every loop turned as it comes.
static void test_even_odd(void **state) {
    (void)state;
    const uint32_t sizes[3] = {4, 4, 4};
    for (int turns = 0; turns < 8; turns++) {
        sag_vec3 p[12];
        for (int l = 0; l < 3; l++) {
            double k = 3 - l;
            const sag_vec3 loop[4] = {{-k, -k, 0}, {k, -k, 0}, {k, k, 0}, {-k, k, 0}};
            for (int i = 0; i < 4; i++) p[4 * l + i] = loop[turns >> l & 1 ? 3 - i : i];
        }
        sag_polygon s = {p, 12, sizes, 3};
        assert_int_equal(sag_polygon_validate(&s, NULL), SAG_OK);
        assert_true(fabs(sag_polygon_area(&s) - (36 - 16 + 4)) < 1e-12);
        for (int i = 0; i < 4; i++) {
            sag_ray down = sag_ray_make((sag_vec3){i + 0.5, 0.25, 2}, (sag_vec3){0, 0, -1});
            assert_true(sag_polygon_occluded(&s, &down) == (i == 0 || i == 2));
        }
        sag_ray flat = sag_ray_make((sag_vec3){-9, 0.25, 0}, (sag_vec3){1, 0, 0});
        assert_false(sag_polygon_occluded(&s, &flat));
        rng r = rng_make(5);
        int island = 0, count = 2000;
        for (int i = 0; i < count; i++) {
            sag_surface surface;
            assert_true(sag_polygon_sample(&s, rng_vec2(&r), &surface));
            double edge = fmax(fabs(surface.position.x), fabs(surface.position.y));
            assert_true(edge <= 1 + 1e-12 || (edge >= 2 - 1e-12 && edge <= 3 + 1e-12));
            assert_true(surface.position.z == 0 && fabs(surface.geometric_normal.z) == 1);
            island += edge <= 1 + 1e-12;
        }
        assert_true(fabs((double)island / count - 4.0 / 24) < 0.03);
    }
}

// A box of four polygons and four triangles has no leaks: shared edges are decided alike by both kinds.
static void test_polygons_and_triangles_are_watertight(void **state) {
    (void)state;
    rng r = rng_make(6);
    for (int trial = 0; trial < 100; trial++) {
        sag_vec3 x = rng_vec3(&r, 1), y = rng_vec3(&r, 1), z = rng_vec3(&r, 1), corner[8];
        for (int i = 0; i < 8; i++) {
            sag_vec3 p = sag_scale(x, i & 1);
            corner[i] = sag_madd(sag_madd(p, i >> 1 & 1, y), i >> 2 & 1, z);
        }
        static const int faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
        for (int i = 0; i < 40; i++) {
            sag_vec3 a = corner[rng_below(&r, 8)], b = corner[rng_below(&r, 8)];
            double along = rng_one_in(&r, 2) ? 0 : rng_unit(&r);
            sag_vec3 target = sag_madd(a, along, sag_sub(b, a)), origin = rng_vec3(&r, 5);
            sag_ray ray = {origin, sag_sub(target, origin), -INFINITY, INFINITY, 0};
            int crossings = 0;
            for (int f = 0; f < 6; f++) {
                const uint32_t size = 4;
                sag_vec3 p[4];
                for (int k = 0; k < 4; k++) p[k] = corner[faces[f][k]];
                sag_polygon face = {p, 4, &size, 1};
                const sag_triangle half[2] = {{p[0], p[1], p[2], false}, {p[0], p[2], p[3], false}};
                crossings +=
                    f < 4 ? sag_polygon_occluded(&face, &ray)
                          : sag_triangle_occluded(&half[0], &ray) + sag_triangle_occluded(&half[1], &ray);
            }
            assert_int_equal(crossings % 2, 0);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_invalid), cmocka_unit_test(test_even_odd),
                                       cmocka_unit_test(test_polygons_and_triangles_are_watertight)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
