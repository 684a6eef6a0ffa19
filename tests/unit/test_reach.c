// SPDX-License-Identifier: MIT
// Boxes of turned shapes: points of the shape, taken along, are within them, they are within the box of the
// turned box, and they are close: some point comes near each side.
#include "shapes/reach.h"
#include "support/random.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

typedef union shape {
    sag_cylinder cylinder;
    sag_cone cone;
    sag_paraboloid paraboloid;
    sag_hyperboloid hyperboloid;
    sag_ellipsoid ellipsoid;
    sag_torus torus;
} shape;

static const sag_shape_kind kinds[] = {SAG_SHAPE_CYLINDER,    SAG_SHAPE_CONE,      SAG_SHAPE_PARABOLOID,
                                       SAG_SHAPE_HYPERBOLOID, SAG_SHAPE_ELLIPSOID, SAG_SHAPE_TORUS};

static void make(rng *r, sag_shape_kind kind, double size, shape *s, sag_box3 *own) {
    const double a = size * rng_uniform(r, 0.2, 1), b = size * rng_uniform(r, 0.2, 1),
                 c = size * rng_uniform(r, 0.2, 1);
    if (kind == SAG_SHAPE_CYLINDER) {
        s->cylinder = (sag_cylinder){.radius = a, .z_min = -b, .z_max = c, .closed = true};
        *own = sag_cylinder_bounds(&s->cylinder);
    } else if (kind == SAG_SHAPE_CONE) {
        s->cone = (sag_cone){.radius = a, .height = b, .closed = true};
        *own = sag_cone_bounds(&s->cone);
    } else if (kind == SAG_SHAPE_PARABOLOID) {
        s->paraboloid =
            (sag_paraboloid){.radius = a, .z_min = rng_one_in(r, 2) ? 0 : b / 3, .z_max = b, .closed = true};
        *own = sag_paraboloid_bounds(&s->paraboloid);
    } else if (kind == SAG_SHAPE_HYPERBOLOID) {
        s->hyperboloid = (sag_hyperboloid){.p1 = {a, -b, -c}, .p2 = {a, b, c / 2}, .closed = true};
        *own = sag_hyperboloid_bounds(&s->hyperboloid);
    } else if (kind == SAG_SHAPE_ELLIPSOID) {
        s->ellipsoid = (sag_ellipsoid){rng_vec3(r, size), {a, b, c}};
        *own = sag_ellipsoid_bounds(&s->ellipsoid);
    } else {
        s->torus = (sag_torus){a, b / 2};
        *own = sag_torus_bounds(&s->torus);
    }
}

static sag_vec3 point_of(rng *r, sag_shape_kind kind, const shape *s) {
    sag_surface at;
    const sag_vec2 u = {rng_unit(r), rng_unit(r)};
    bool good = false;
    if (kind == SAG_SHAPE_CYLINDER) good = sag_cylinder_sample(&s->cylinder, u, &at);
    if (kind == SAG_SHAPE_CONE) good = sag_cone_sample(&s->cone, u, &at);
    if (kind == SAG_SHAPE_PARABOLOID) good = sag_paraboloid_sample(&s->paraboloid, u, &at);
    if (kind == SAG_SHAPE_HYPERBOLOID) good = sag_hyperboloid_sample(&s->hyperboloid, u, &at);
    if (kind == SAG_SHAPE_ELLIPSOID) good = sag_ellipsoid_sample(&s->ellipsoid, u, &at);
    if (kind == SAG_SHAPE_TORUS) good = sag_torus_sample(&s->torus, u, &at);
    assert_true(good);
    return at.position;
}

static void boxes_hold_and_are_close(void **state) {
    (void)state;
    rng r = rng_make(23);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (int round = 0; round < 60; round++) {
            const double size = rng_one_in(&r, 2) ? 1 : rng_log_uniform(&r, 1e-9, 1e9);
            shape s;
            sag_box3 own;
            make(&r, kinds[k], size, &s, &own);
            sag_affine map = sag_affine_rotate(rng_uniform(&r, 0, 6), rng_direction(&r));
            if (rng_one_in(&r, 3)) { // any map
                for (int i = 0; i < 3; i++)
                    for (int j = 0; j < 3; j++) map.m[i][j] = rng_uniform(&r, -1, 1);
            }
            for (int i = 0; i < 3; i++) map.m[i][3] = size * rng_uniform(&r, -3, 3);
            const sag_box3 loose = sag_affine_box(&map, &own),
                           box = sagi_shape_turned_box(kinds[k], &s, &own, &map);
            sag_vec3 nearest = {INFINITY, INFINITY, INFINITY}, farthest = sag_neg(nearest);
            for (int i = 0; i < 4000; i++) {
                const sag_vec3 p = sag_affine_point(&map, point_of(&r, kinds[k], &s));
                nearest = sag_vec3_make(fmin(nearest.x, p.x), fmin(nearest.y, p.y), fmin(nearest.z, p.z));
                farthest = sag_vec3_make(fmax(farthest.x, p.x), fmax(farthest.y, p.y), fmax(farthest.z, p.z));
            }
            for (int i = 0; i < 3; i++) {
                const double low = sag_component(box.min, i), high = sag_component(box.max, i);
                const double least = sag_component(nearest, i), most = sag_component(farthest, i);
                assert_true(low >= sag_component(loose.min, i) && high <= sag_component(loose.max, i));
                assert_true(low <= least && most <= high);
                assert_true(least - low < 0.15 * (high - low) && high - most < 0.15 * (high - low));
            }
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(boxes_hold_and_are_close)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
