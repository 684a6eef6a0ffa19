// SPDX-License-Identifier: MIT
// The bilinear patch: known crossings, area, sampling, surfaces, bad input.
#include "support/random.h"
#include <sagitta/shapes.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const sag_bilinear_patch saddle = {{-1, -1, 1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, 1}}; // z = xy

static sag_vec3 point_of(const sag_bilinear_patch *s, double u, double v) {
    sag_vec3 a = sag_madd(sag_scale(s->p00, 1 - u), u, s->p10);
    sag_vec3 b = sag_madd(sag_scale(s->p01, 1 - u), u, s->p11);
    return sag_madd(sag_scale(a, 1 - v), v, b);
}

static void test_known_crossings(void **state) {
    (void)state;
    sag_ray down = {.origin = {0.5, 0.25, 5}, .direction = {0, 0, -2}, .t_max = INFINITY};
    sag_hit hit;
    assert_true(sag_bilinear_patch_hit(&saddle, &down, &hit));
    assert_true(hit.t == (5 - 0.125) / 2 && hit.u == 0.75 && hit.v == 0.625);
    // Along x = y the saddle is z = x²: the line z = 1/4 meets it twice.
    sag_ray across = {.origin = {-2, -2, 0.25}, .direction = {1, 1, 0}, .t_max = INFINITY};
    sag_hit hits[3];
    assert_int_equal(sag_bilinear_patch_crossings(&saddle, &across, hits, 3), 2);
    assert_true(hits[0].t == 1.5 && hits[1].t == 2.5);
    across.t_min = 2;
    assert_true(sag_bilinear_patch_hit(&saddle, &across, &hit) && hit.t == 2.5);
    across.t_min = 2.6;
    assert_false(sag_bilinear_patch_occluded(&saddle, &across));
    sag_ray past = {.origin = {3, 3, 5}, .direction = {0, 0, -1}, .t_max = INFINITY};
    assert_false(sag_bilinear_patch_hit(&saddle, &past, &hit));
    sag_ray ruling = {.origin = {-3, 0, 0}, .direction = {1, 0, 0}, .t_max = INFINITY};
    assert_false(sag_bilinear_patch_hit(&saddle, &ruling, &hit)); // lies in the patch
}

// Rays parallel to the patch's segment at u = 2/3 or 1/3, beside it: there is no crossing at that u, though
// no binary fraction says so exactly.
static void test_segments_along_the_ray(void **state) {
    (void)state;
    static const struct {
        sag_bilinear_patch patch;
        sag_vec3 origin, direction;
    } cases[] = {
        {{{0, 0, 32}, {-16, 32, -32}, {-32, 0, -32}, {0, 16, 16}}, {16, 32, -32}, {0, 1, -1}},
        {{{2, 1, 2}, {-1, -2, 1}, {-2, -2, 2}, {1, 1, -2}}, {1, -2, 0}, {0, -1, 2}},
        {{{-2, -1, -1}, {1, -1, 2}, {-2, 1, 0}, {-2, -2, 0}}, {0, -1, -1}, {1, -1, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sag_ray ray = {.origin = cases[i].origin,
                       .direction = cases[i].direction,
                       .t_min = -INFINITY,
                       .t_max = INFINITY};
        assert_int_equal(sag_bilinear_patch_crossings(&cases[i].patch, &ray, NULL, 0), 0);
    }
}

static void test_area_and_sampling(void **state) {
    (void)state;
    const sag_bilinear_patch square = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {2, 3, 0}};
    assert_true(fabs(sag_bilinear_patch_area(&square) - 6) < 1e-14);
    // ∫∫ √(1 + x² + y²) over [−1, 1]².
    const double pi = 3.14159265358979324;
    const double known = 4 * (sqrt(3.0) / 3 + 4.0 / 3 * log((1 + sqrt(3.0)) / sqrt(2.0)) - pi / 18);
    assert_true(fabs(sag_bilinear_patch_area(&saddle) - known) < 1e-9 * known);
    // A folded flat patch, p = (u, v (1 − 2u)): its element |1 − 2u| has a kink.
    const sag_bilinear_patch bow = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, -1, 0}};
    assert_true(fabs(sag_bilinear_patch_area(&bow) - 0.5) < 1e-9);
    // Uniform by area: the share with x < 0, y < 0 is a quarter; and the mean of x² is that of the area.
    rng r = rng_make(5);
    int quarter = 0, count = 4000;
    for (int i = 0; i < count; i++) {
        sag_surface surface;
        assert_true(sag_bilinear_patch_sample(&saddle, rng_vec2(&r), &surface));
        sag_vec3 p = surface.position;
        assert_true(fabs(p.z - p.x * p.y) < 1e-15);
        quarter += p.x < 0 && p.y < 0;
    }
    assert_true(fabs((double)quarter / count - 0.25) < 0.03);
}

static void test_surfaces_and_spawned_rays(void **state) {
    (void)state;
    rng r = rng_make(6);
    for (int i = 0; i < 3000; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 away = rng_vec3(&r, scale * rng_log_uniform(&r, 1, 1e4));
        sag_bilinear_patch s = {sag_add(away, rng_vec3(&r, scale)), sag_add(away, rng_vec3(&r, scale)),
                                sag_add(away, rng_vec3(&r, scale)), sag_add(away, rng_vec3(&r, scale))};
        sag_vec3 target = point_of(&s, rng_unit(&r), rng_unit(&r));
        sag_vec3 origin = sag_madd(target, scale * 10, rng_direction(&r));
        sag_ray ray = sag_ray_make(origin, sag_sub(target, origin));
        sag_hit hit;
        if (!sag_bilinear_patch_hit(&s, &ray, &hit)) continue;
        sag_surface surface;
        sag_bilinear_patch_surface(&s, &ray, &hit, &surface);
        sag_vec3 off = sag_sub(surface.position, sag_ray_at(&ray, hit.t));
        assert_true(sag_length(off) <= 1e-12 * (scale + sag_length(away)));
        sag_vec3 direction = rng_direction(&r);
        sag_ray spawned = sag_spawn_ray(&surface, direction);
        // The patch is curved, so the ray may meet it again, but not where it starts.
        if (sag_bilinear_patch_hit(&s, &spawned, &hit)) assert_true(hit.t > 1e-9 * scale);
    }
}

// A floor in the plane z = 0: its points have z = 0 exactly, and rays that leave it did not.
static void test_floor_at_zero(void **state) {
    (void)state;
    rng r = rng_make(9);
    for (int i = 0; i < 3000; i++) {
        const double size = rng_log_uniform(&r, 1e-9, 1e9);
        const sag_bilinear_patch floor = {
            {-size, -size, 0}, {size, -size, 0}, {-size, size, 0}, {size, size, 0}};
        sag_surface surface;
        assert_true(sag_bilinear_patch_sample(&floor, rng_vec2(&r), &surface));
        assert_true(surface.position.z == 0);
        sag_vec3 way = rng_direction(&r);
        const sag_ray ray = sag_spawn_ray(&surface, way);
        assert_false(sag_bilinear_patch_occluded(&floor, &ray));
    }
}

static void test_bad_input(void **state) {
    (void)state;
    sag_error error;
    const sag_bilinear_patch line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
    const sag_bilinear_patch nan = {{0, NAN, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
    assert_int_equal(sag_bilinear_patch_validate(&saddle, &error), SAG_OK);
    assert_int_equal(sag_bilinear_patch_validate(&line, &error), SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_bilinear_patch_validate(&nan, &error), SAG_ERROR_GEOMETRY);
    sag_ray ray = sag_ray_make((sag_vec3){0, 0, -3}, (sag_vec3){0, 0, 1});
    sag_hit hit;
    assert_false(sag_bilinear_patch_hit(&line, &ray, &hit));
    assert_false(sag_bilinear_patch_hit(&nan, &ray, &hit));
    ray.direction.x = NAN;
    assert_false(sag_bilinear_patch_hit(&saddle, &ray, &hit));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_crossings),   cmocka_unit_test(test_segments_along_the_ray),
        cmocka_unit_test(test_area_and_sampling), cmocka_unit_test(test_surfaces_and_spawned_rays),
        cmocka_unit_test(test_floor_at_zero),     cmocka_unit_test(test_bad_input)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
