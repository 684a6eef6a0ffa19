// SPDX-License-Identifier: MIT
// The triangle: known answers, ranges, edges and vertices, bad input, extreme numbers, and the cases that
// users of other libraries reported, by the names of their issues.
#include "support/random.h"
#include <sagitta/shapes.h>

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const sag_triangle unit = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, false};

static sag_ray ray_of(double ox, double oy, double oz, double dx, double dy, double dz) {
    return sag_ray_make(sag_vec3_make(ox, oy, oz), sag_vec3_make(dx, dy, dz));
}

static void test_known(void **state) {
    (void)state;
    sag_hit hit;
    sag_ray down = ray_of(0.25, 0.5, 3, 0, 0, -2), up = ray_of(0.25, 0.5, -3, 0, 0, 1);
    assert_true(sag_triangle_hit(&unit, &down, &hit));
    assert_true(hit.t == 1.5 && hit.u == 0.25 && hit.v == 0.5 && hit.geometry == SAG_INVALID_ID);
    sag_surface s;
    sag_triangle_surface(&unit, &down, &hit, &s);
    assert_true(s.side == SAG_SIDE_FRONT && s.geometric_normal.z == 1 && s.position.z == 0);
    assert_true(s.u == 0.25 && s.v == 0.5 && s.dpdu.x == 1 && s.dpdv.y == 1);
    assert_true(sag_triangle_hit(&unit, &up, &hit) && hit.t == 3);
    sag_triangle_surface(&unit, &up, &hit, &s);
    assert_int_equal(s.side, SAG_SIDE_BACK);
    sag_triangle one_sided = unit;
    one_sided.one_sided = true;
    assert_true(sag_triangle_occluded(&one_sided, &down));
    assert_false(sag_triangle_occluded(&one_sided, &up));
    assert_true(sag_triangle_area(&unit) == 0.5);
    sag_vec3 near = sag_triangle_closest_point(&unit, (sag_vec3){1, 1, 5});
    assert_true(near.x == 0.5 && near.y == 0.5 && near.z == 0);
}

static void test_range_is_closed(void **state) {
    (void)state;
    sag_ray ray = ray_of(0.25, 0.5, 3, 0, 0, -2);
    ray.t_min = ray.t_max = 1.5;
    assert_true(sag_triangle_occluded(&unit, &ray));
    ray.t_min = nextafter(1.5, 2), ray.t_max = 2;
    assert_false(sag_triangle_occluded(&unit, &ray));
    ray.t_min = 0, ray.t_max = nextafter(1.5, 0);
    assert_false(sag_triangle_occluded(&unit, &ray));
    ray = ray_of(0.25, 0.5, 0, 0.1, 0.1, 1); // starts on it
    sag_hit hit;
    assert_true(sag_triangle_hit(&unit, &ray, &hit) && hit.t == 0);
    ray = ray_of(0.25, 0.5, -1, 0, 0, -1); // behind
    assert_false(sag_triangle_occluded(&unit, &ray));
    ray.t_min = -INFINITY;
    assert_true(sag_triangle_hit(&unit, &ray, &hit) && hit.t == -1);
    ray = ray_of(-1, 0.25, 0, 1, 0, 0); // in the plane
    assert_false(sag_triangle_occluded(&unit, &ray));
}

// The bits of t do not depend on the range the ray is asked for.
static void test_range_does_not_change_t(void **state) {
    (void)state;
    rng r = rng_make(3);
    for (int i = 0; i < 20000; i++) {
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_triangle s = {rng_vec3(&r, scale), rng_vec3(&r, scale), rng_vec3(&r, scale), false};
        sag_vec3 o = rng_vec3(&r, 3 * scale), target = sag_scale(sag_add(sag_add(s.a, s.b), s.c), 1.0 / 3);
        sag_ray ray = {.origin = o, .direction = sag_sub(target, o), .t_min = -INFINITY, .t_max = INFINITY};
        sag_hit hit, again;
        assert_true(sag_triangle_hit(&s, &ray, &hit));
        ray.t_min = ray.t_max = hit.t;
        assert_true(sag_triangle_hit(&s, &ray, &again) && again.t == hit.t && again.u == hit.u);
        ray.t_max = INFINITY, ray.t_min = nextafter(hit.t, INFINITY);
        assert_false(sag_triangle_occluded(&s, &ray));
        ray.t_min = -INFINITY, ray.t_max = nextafter(hit.t, -INFINITY);
        assert_false(sag_triangle_occluded(&s, &ray));
    }
}

// trimesh-1496, trimesh-2317, embree-181: of the two triangles at an edge and the six around a vertex exactly
// one takes the ray, from whichever side, however the triangles are written down.
static void test_edges_and_vertices_belong_to_one(void **state) {
    (void)state;
    const sag_vec3 hub = {0.5, 0.25, -0.125};
    rng r = rng_make(4);
    for (int i = 0; i < 2000; i++) {
        sag_vec3 rim[6];
        for (int k = 0; k < 6; k++) {
            double angle = (k + 0.3 * rng_unit(&r)) * 3.14159265358979 / 3;
            rim[k] = sag_add(hub, sag_vec3_make(cos(angle), sin(angle), rng_uniform(&r, -0.2, 0.2)));
        }
        sag_vec3 d = {rng_uniform(&r, -0.2, 0.2), rng_uniform(&r, -0.2, 0.2), rng_one_in(&r, 2) ? 1 : -1};
        if (rng_one_in(&r, 3)) d.x = d.y = 0;
        // Powers of two keep o + t d exact, so the line goes through the hub itself.
        d = sag_vec3_make(ldexp(rint(ldexp(d.x, 10)), -10), ldexp(rint(ldexp(d.y, 10)), -10), d.z);
        sag_ray ray = sag_ray_make(sag_sub(hub, sag_scale(d, 4)), d);
        int hits = 0;
        for (int k = 0; k < 6; k++) {
            const sag_vec3 p[3] = {hub, rim[k], rim[(k + 1) % 6]};
            int turn = (int)rng_below(&r, 3);
            sag_triangle s = {p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3], false};
            if (rng_one_in(&r, 2)) s = (sag_triangle){s.a, s.c, s.b, false};
            sag_hit hit;
            if (!sag_triangle_hit(&s, &ray, &hit)) continue;
            hits++;
            assert_true(hit.t == 4);
        }
        assert_int_equal(hits, 1);
    }
}

// ifc-lite-3561 and their like: NaN and infinities are misses, degenerate triangles are errors and misses.
static void test_bad_input(void **state) {
    (void)state;
    const double bad[4] = {NAN, INFINITY, -INFINITY, 0x1p101};
    sag_error error;
    sag_ray ray = ray_of(0.25, 0.25, 3, 0, 0, -1);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 9; k++) {
            double p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
            p[k] = bad[i];
            sag_triangle s = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}, false};
            assert_int_equal(sag_triangle_validate(&s, &error), SAG_ERROR_GEOMETRY);
            assert_non_null(strstr(error.message, k < 3   ? "triangle.a"
                                                  : k < 6 ? "triangle.b"
                                                          : "triangle.c"));
            if (i < 3) assert_false(sag_triangle_occluded(&s, &ray));
            sag_box3 box = sag_triangle_bounds(&s);
            assert_true(sag_box3_is_empty(&box));
        }
    const sag_triangle flat[3] = {{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, false},
                                  {{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {1, 0, 0}, false},
                                  {{0.25, 0.25, 0}, {0.25, 0.25, 0}, {0.25, 0.25, 0}, false}};
    for (int i = 0; i < 3; i++) {
        sag_surface s;
        assert_int_equal(sag_triangle_validate(&flat[i], &error), SAG_ERROR_GEOMETRY);
        assert_false(sag_triangle_occluded(&flat[i], &ray));
        assert_false(sag_triangle_sample(&flat[i], (sag_vec2){0.5, 0.5}, &s));
        assert_true(sag_triangle_area(&flat[i]) == 0);
    }
    // 0.1 is not a tenth: these three are almost on one line, but not quite, and so it is a triangle.
    const sag_triangle needle = {{0, 0, 0}, {0.1, 0.1, 0.3}, {0.3, 0.3, 0.9}, false};
    assert_int_equal(sag_triangle_validate(&needle, &error), SAG_OK);
    assert_true(sag_triangle_area(&needle) > 0);
}

// embree-387: rays at half a degree to skinny triangles (edges 11.2, 9.7 and 1.4, all within 600 of the
// origin) were reported to hit them at t = 12291. A hit lies between the nearest and the farthest vertex.
static void test_embree_387_grazing(void **state) {
    (void)state;
    rng r = rng_make(387);
    for (int i = 0; i < 50000; i++) {
        sag_vec3 a = rng_vec3(&r, 300), along = rng_direction(&r), across, n;
        sag_frame(along, &across, &n);
        sag_vec3 b = sag_madd(a, 11.2, along), c = sag_madd(sag_madd(a, 9.6, along), 1.1, across);
        sag_triangle s = {a, b, c, false};
        sag_vec3 flat = sag_normalize(sag_madd(sag_scale(along, rng_uniform(&r, -1, 1)), 1, across));
        sag_vec3 d = sag_normalize(sag_madd(flat, 0.009, n));
        sag_vec3 aim = sag_madd(sag_madd(a, rng_uniform(&r, -1, 12), along), rng_uniform(&r, -1, 2), across);
        sag_ray ray = sag_ray_make(sag_madd(aim, -rng_uniform(&r, 10, 500), d), d);
        sag_hit hit;
        if (!sag_triangle_hit(&s, &ray, &hit)) continue;
        double ta = sag_dot(sag_sub(a, ray.origin), d), tb = sag_dot(sag_sub(b, ray.origin), d);
        double tc = sag_dot(sag_sub(c, ray.origin), d);
        assert_true(hit.t >= fmin(ta, fmin(tb, tc)) - 1e-9 && hit.t <= fmax(ta, fmax(tb, tc)) + 1e-9);
    }
}

// embree-423: the edges of one mesh against the triangles of another, far away. A segment whose box is apart
// from the triangle's cannot meet it.
static void test_embree_423_apart(void **state) {
    (void)state;
    rng r = rng_make(423);
    for (int i = 0; i < 50000; i++) {
        sag_triangle s = {rng_vec3(&r, 0.01), rng_vec3(&r, 0.01), rng_vec3(&r, 0.01), false};
        // In the triangle's plane but for a rounding.
        sag_vec3 p = sag_madd(sag_madd(s.a, rng_uniform(&r, 5, 9), sag_sub(s.b, s.a)), 3, sag_sub(s.c, s.a));
        sag_vec3 q = sag_madd(p, rng_uniform(&r, -1, 1), sag_sub(s.b, s.a));
        sag_box3 box = sag_triangle_bounds(&s), edge = {{fmin(p.x, q.x), fmin(p.y, q.y), fmin(p.z, q.z)},
                                                        {fmax(p.x, q.x), fmax(p.y, q.y), fmax(p.z, q.z)}};
        bool apart = edge.min.x > box.max.x || edge.max.x < box.min.x || edge.min.y > box.max.y ||
                     edge.max.y < box.min.y || edge.min.z > box.max.z || edge.max.z < box.min.z;
        sag_ray ray = sag_ray_make(p, sag_sub(q, p));
        ray.t_max = 1;
        if (apart) assert_false(sag_triangle_occluded(&s, &ray));
    }
}

// embree-416, embree-42: a cube of 5.9e11 by 5.9e11 by 1.2e5, looked at from just above its top; and
// geometry beyond 1.8e18, which is skipped elsewhere.
static void test_embree_416_large(void **state) {
    (void)state;
    for (double k = 1; k <= 1e24; k *= 1e3) {
        double e = 5.89075e5 * k, top = 120000;
        const sag_triangle lid[2] = {{{-e, -e, top}, {e, -e, top}, {e, e, top}, false},
                                     {{-e, -e, top}, {e, e, top}, {-e, e, top}, false}};
        const sag_triangle bottom[2] = {{{-e, -e, 0}, {e, -e, 0}, {e, e, 0}, false},
                                        {{-e, -e, 0}, {e, e, 0}, {-e, e, 0}, false}};
        rng r = rng_make(416);
        for (int i = 0; i < 500; i++) {
            sag_ray ray = sag_ray_make(sag_vec3_make(rng_uniform(&r, -e, e), rng_uniform(&r, -e, e), 120500),
                                       sag_vec3_make(0, 0, -1));
            sag_hit hit;
            int hits = 0;
            for (int k2 = 0; k2 < 2; k2++)
                if (sag_triangle_hit(&lid[k2], &ray, &hit)) hits++, assert_true(hit.t == 500);
            assert_int_equal(hits, 1);
            ray.t_max = 1000; // nothing at the bottom within a thousand
            for (int k2 = 0; k2 < 2; k2++) assert_false(sag_triangle_occluded(&bottom[k2], &ray));
        }
    }
}

// Embree's SmallTriangleHitTest, commented out there: a plane of 100 × 100 quads seen from a radius of 1e6;
// each triangle must be hit by the ray aimed at its centroid.
static void test_embree_small_triangles(void **state) {
    (void)state;
    rng r = rng_make(6625);
    for (int i = 0; i < 100; i++)
        for (int j = 0; j < 100; j++) {
            sag_vec3 p = {i, j, 0}, q = {i + 1, j, 0}, s = {i, j + 1, 0};
            sag_triangle triangle = {p, q, s, false};
            sag_vec3 centroid = sag_scale(sag_add(sag_add(p, q), s), 1.0 / 3);
            sag_vec3 o = sag_scale(rng_direction(&r), 1e6);
            sag_ray ray = sag_ray_make(o, sag_normalize(sag_sub(centroid, o)));
            sag_hit hit;
            assert_true(sag_triangle_hit(&triangle, &ray, &hit));
            assert_true(fabs(hit.u - 1.0 / 3) < 1e-6 / fabs(ray.direction.z));
        }
}

// tinybvh-283: triangles of tenths of a millimetre are not lost to a fixed threshold; nor are smaller ones.
static void test_tinybvh_283_small(void **state) {
    (void)state;
    for (double k = 2e-4; k > 1e-280; k *= 1e-9) {
        sag_triangle s = {{0, 0, 0}, {k, 0, 0}, {0, k, 0}, false};
        sag_ray ray = ray_of(0.25 * k, 0.25 * k, k, 0, 0, -1);
        sag_hit hit;
        assert_true(sag_triangle_hit(&s, &ray, &hit) && fabs(hit.t - k) <= 0x1p-51 * k);
        assert_true(fabs(hit.u - 0.25) < 1e-15 && fabs(hit.v - 0.25) < 1e-15);
        ray.origin.x = 0.75 * k, ray.origin.y = 0.25 * k; // on the long edge, exactly
        sag_triangle other = {{k, k, 0}, {0, k, 0}, {k, 0, 0}, false};
        assert_int_equal(sag_triangle_occluded(&s, &ray) + sag_triangle_occluded(&other, &ray), 1);
    }
}

// Directions from the smallest to the largest number there is; origins as far as there are numbers.
static void test_extreme_rays(void **state) {
    (void)state;
    sag_hit hit;
    sag_ray ray = ray_of(0.25, 0.25, 1, 0, 0, -DBL_TRUE_MIN);
    assert_false(sag_triangle_hit(&unit, &ray, &hit)); // t = 2¹⁰⁷⁴ is beyond the doubles
    ray.direction.z = -0x1p-1020;
    assert_true(sag_triangle_hit(&unit, &ray, &hit) && hit.t == 0x1p1020);
    ray = ray_of(0.25, 0.25, 0x1p-900, 0, 0, -DBL_TRUE_MIN);
    assert_true(sag_triangle_hit(&unit, &ray, &hit) && hit.t == 0x1p174);
    ray = ray_of(0.25, 0.25, 1, 0, 0, -DBL_MAX);
    assert_true(sag_triangle_hit(&unit, &ray, &hit) && hit.t == 1 / DBL_MAX);
    ray = ray_of(0.25, 0.25, 1e270, 0, 0, -1);
    assert_true(sag_triangle_hit(&unit, &ray, &hit) && hit.t == 1e270 && hit.u == 0.25);
    ray = ray_of(0.75, 0.75, 1e270, 0, 0, -1);
    assert_false(sag_triangle_occluded(&unit, &ray));
    ray = ray_of(0.75, 0.75, DBL_MAX, 0, 0, -1); // 0.75 counts as 0 beside it: whatever comes, no crash
    assert_false(sag_triangle_occluded(&unit, &ray));
    ray = ray_of(DBL_MAX, DBL_MAX, DBL_MAX, -1, -1, -1); // through the corner
    sag_triangle_hit(&unit, &ray, &hit);
    ray = ray_of(DBL_MAX, -DBL_MAX, DBL_MAX, -1, 1e-300, -DBL_MAX);
    assert_false(sag_triangle_occluded(&unit, &ray));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known),
        cmocka_unit_test(test_range_is_closed),
        cmocka_unit_test(test_range_does_not_change_t),
        cmocka_unit_test(test_edges_and_vertices_belong_to_one),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_embree_387_grazing),
        cmocka_unit_test(test_embree_423_apart),
        cmocka_unit_test(test_embree_416_large),
        cmocka_unit_test(test_embree_small_triangles),
        cmocka_unit_test(test_tinybvh_283_small),
        cmocka_unit_test(test_extreme_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
