// SPDX-License-Identifier: MIT
// A set of spheres answers as its spheres one by one would.
#include "support/random.h"
#include <sagitta/shapes.h>
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

enum { COUNT = 50 };

typedef struct molecule {
    float centers[3 * COUNT], radii[COUNT];
    sag_spheres set;
    sag_sphere one[COUNT];
} molecule;

static void make(molecule *m, rng *r) {
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) m->centers[3 * i + k] = (float)rng_uniform(r, -1, 1);
        m->radii[i] = (float)rng_uniform(r, 0.05, 0.3);
        m->one[i] = (sag_sphere){.center = {m->centers[3 * i], m->centers[3 * i + 1], m->centers[3 * i + 2]},
                                 .radius = m->radii[i]};
    }
    m->set = (sag_spheres){.centers_f32 = m->centers, .radii_f32 = m->radii, .count = COUNT};
}

static void set_is_its_spheres(void **state) {
    (void)state;
    rng r = rng_make(4);
    molecule m;
    make(&m, &r);
    for (int i = 0; i < 3000; i++) {
        sag_ray ray = sag_ray_make(rng_vec3(&r, 2), rng_direction(&r));
        if (rng_one_in(&r, 3)) ray.t_max = rng_uniform(&r, 0, 3);
        sag_hit nearest, hits[2 * COUNT], some[5], h[2];
        size_t all = 0;
        double first = INFINITY;
        uint32_t which = 0;
        for (uint32_t k = 0; k < COUNT; k++) {
            size_t n = sag_sphere_crossings(&m.one[k], &ray, h, 2);
            all += n;
            if (n && h[0].t < first) first = h[0].t, which = k;
        }
        assert_int_equal(sag_spheres_hit(&m.set, &ray, &nearest), all > 0);
        assert_int_equal(sag_spheres_occluded(&m.set, &ray), all > 0);
        assert_int_equal(sag_spheres_crossings(&m.set, &ray, hits, 2 * COUNT), all);
        assert_int_equal(sag_spheres_crossings(&m.set, &ray, some, 5), all);
        for (size_t k = 1; k < all; k++) assert_true(hits[k - 1].t <= hits[k].t);
        for (size_t k = 0; k < all && k < 5; k++)
            assert_true(some[k].t == hits[k].t && some[k].primitive == hits[k].primitive);
        if (all == 0) continue;
        assert_true(nearest.t == first && nearest.primitive == which && hits[0].primitive == which);
        sag_surface of_set, of_one;
        sag_spheres_surface(&m.set, &ray, &nearest, &of_set);
        sag_sphere_surface(&m.one[which], &ray, &nearest, &of_one);
        assert_memory_equal(&of_set.position, &of_one.position, sizeof of_one.position);
        assert_memory_equal(&of_set.geometric_normal, &of_one.geometric_normal,
                            sizeof of_one.geometric_normal);
        assert_true(fabs(of_set.u - of_one.u) < 1e-14 && fabs(of_set.v - of_one.v) < 1e-14);
        assert_int_equal(of_set.primitive, which);
    }
}

static void measures(void **state) {
    (void)state;
    rng r = rng_make(5);
    molecule m;
    make(&m, &r);
    double area = 0, share[COUNT] = {0};
    for (int i = 0; i < COUNT; i++) area += sag_sphere_area(&m.one[i]);
    assert_true(fabs(sag_spheres_area(&m.set) / area - 1) < 1e-14);
    for (int i = 0; i < 40000; i++) {
        sag_surface s;
        assert_true(sag_spheres_sample(&m.set, rng_vec2(&r), &s));
        share[s.primitive] += 1.0 / 40000;
        double off = sag_length(sag_sub(s.position, m.one[s.primitive].center)) / m.one[s.primitive].radius;
        assert_true(fabs(off - 1) < 1e-14);
    }
    double chi2 = 0;
    for (int i = 0; i < COUNT; i++) {
        double right = sag_sphere_area(&m.one[i]) / area;
        chi2 += 40000 * (share[i] - right) * (share[i] - right) / right;
    }
    assert_true(chi2 < COUNT + 5 * sqrt(2.0 * COUNT));
    for (int i = 0; i < 2000; i++) {
        sag_vec3 p = rng_vec3(&r, 1.2);
        bool inside = false;
        double least = INFINITY;
        for (int k = 0; k < COUNT; k++) {
            inside = inside || sag_sphere_contains(&m.one[k], p);
            least = fmin(least, sag_length(sag_sub(p, sag_sphere_closest_point(&m.one[k], p))));
        }
        assert_int_equal(sag_spheres_contains(&m.set, p), inside);
        double got = sag_length(sag_sub(p, sag_spheres_closest_point(&m.set, p)));
        assert_true(fabs(got - least) <= 1e-14);
        sag_box3 box = sag_spheres_bounds(&m.set);
        if (inside) assert_true(p.x >= box.min.x && p.y >= box.min.y && p.z >= box.min.z && p.x <= box.max.x);
    }
}

static void bad_spheres_are_left_out(void **state) {
    (void)state;
    const double centers[] = {0, 0, 0, NAN, 0, 0, 0, INFINITY, 0, 5, 0, 0};
    const float radii[] = {1, 1, 1, -1};
    sag_spheres set = {.centers_f64 = centers, .radii_f32 = radii, .count = 4};
    sag_error error;
    assert_int_equal(sag_spheres_validate(&set, &error), SAG_OK);
    sag_box3 box = sag_spheres_bounds(&set);
    assert_true(box.max.x >= 1 && box.max.x < 1.001);
    sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, 9), sag_vec3_make(0, 0, -1));
    assert_int_equal(sag_spheres_crossings(&set, &ray, NULL, 0), 2);
    assert_int_equal(sag_spheres_validate(&(sag_spheres){.centers_f64 = centers}, &error),
                     SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_spheres_validate(&(sag_spheres){.count = 3}, &error), SAG_ERROR_GEOMETRY);
    assert_int_equal(
        sag_spheres_validate(&(sag_spheres){.centers_f64 = centers, .count = 4, .radius = NAN}, &error),
        SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_spheres_crossings(&(sag_spheres){.count = 3}, &ray, NULL, 0), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(set_is_its_spheres), cmocka_unit_test(measures),
                                       cmocka_unit_test(bad_spheres_are_left_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
