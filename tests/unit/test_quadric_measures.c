// SPDX-License-Identifier: MIT
// Areas, volumes, uniform samples, inside tests, closest points and boxes of the shapes of second degree,
// against closed forms, moments and brute force.
#include "support/quadric_subjects.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
// clang-format on

#define PI 3.14159265358979323846

static void assert_near(double value, double right, double relative) {
    if (!(fabs(value - right) <= relative * fabs(right)))
        fail_msg("%.17g is not within %g of %.17g", value, relative, right);
}

static void areas_have_closed_forms(void **state) {
    (void)state;
    assert_near(sag_sphere_area(&(sag_sphere){.radius = 3}), 36 * PI, 1e-15);
    assert_near(sag_sphere_area(&(sag_sphere){.radius = 3, .z_min = -1, .z_max = 2, .phi_max_rad = 1}), 9,
                1e-15);
    assert_near(sag_ellipsoid_area(&(sag_ellipsoid){.radii = {3, 3, 3}}), 36 * PI, 1e-14);
    // Oblate and prolate spheroids (Zwillinger, CRC Standard Mathematical Tables).
    double e = sqrt(1 - 1.0 / 4);
    assert_near(sag_ellipsoid_area(&(sag_ellipsoid){.radii = {2, 2, 1}}),
                2 * PI * 4 * (1 + (1 - e * e) / e * atanh(e)), 1e-14);
    assert_near(sag_ellipsoid_area(&(sag_ellipsoid){.radii = {1, 2, 1}}), 2 * PI * (1 + 2 / e * asin(e)),
                1e-14);
    // A thin disk has two faces; a needle the area of a thin spindle, π² a b.
    assert_near(sag_ellipsoid_area(&(sag_ellipsoid){.radii = {1, 1e-9, 1}}), 2 * PI, 1e-12);
    assert_near(sag_ellipsoid_area(&(sag_ellipsoid){.radii = {1e-9, 1, 1e-9}}), PI * PI * 1e-9, 1e-12);
    assert_near(sag_cylinder_area(&(sag_cylinder){.radius = 2, .z_min = -1, .z_max = 2}), 12 * PI, 1e-15);
    assert_near(sag_cylinder_area(&(sag_cylinder){.radius = 2, .z_min = -1, .z_max = 2, .closed = true}),
                20 * PI, 1e-15);
    assert_near(sag_cone_area(&(sag_cone){.radius = 3, .height = 4, .phi_max_rad = PI}), 7.5 * PI, 1e-15);
    assert_near(sag_cone_area(&(sag_cone){.radius = 3, .height = 4, .closed = true}), 24 * PI, 1e-15);
    // z = ρ² up to 2: (π/6)(9^{3/2} − 1).
    assert_near(sag_paraboloid_area(&(sag_paraboloid){.radius = sqrt(2), .z_max = 2}), PI / 6 * 26, 1e-14);
    // A hyperboloid's special cases: cylinder, cone, ring; and ρ² = 1 + z² for |z| ≤ 1, 2π ∫ √(1 + 2z²) dz.
    assert_near(sag_hyperboloid_area(&(sag_hyperboloid){.p1 = {2, 0, -1}, .p2 = {2, 0, 2}}), 12 * PI, 1e-14);
    assert_near(sag_hyperboloid_area(&(sag_hyperboloid){.p1 = {0, 3, 0}, .p2 = {0, 0, 4}}), 15 * PI, 1e-14);
    assert_near(sag_hyperboloid_area(&(sag_hyperboloid){.p1 = {3, 0, 1}, .p2 = {0, 5, 1}}),
                PI * (25 - 9 * 25 / 34.0), 1e-14);
    assert_near(sag_hyperboloid_area(&(sag_hyperboloid){.p1 = {-1, 1, -1}, .p2 = {1, 1, 1}}),
                2 * PI * (sqrt(3) + asinh(sqrt(2)) / sqrt(2)), 1e-13);
    assert_near(sag_hyperboloid_area(&(sag_hyperboloid){.p1 = {-1, 1, -1}, .p2 = {1, 1, 1}, .closed = true}),
                2 * PI * (sqrt(3) + asinh(sqrt(2)) / sqrt(2)) + 4 * PI, 1e-13);
    // ρ² = z² − 1 for 1 ≤ z ≤ 2: 2π ∫ √(2z² − 1) dz.
    double top = sqrt(7),
           all = 2 * PI * ((2 * top - 1) / 2 - (acosh(2 * sqrt(2)) - acosh(sqrt(2))) / (2 * sqrt(2)));
    assert_near(sag_hyperboloid2_area(&(sag_hyperboloid2){.a = 1, .c = 1, .z_min = 0, .z_max = 2}), all,
                1e-13);
    assert_near(sag_hyperboloid2_area(&(sag_hyperboloid2){.a = 1, .c = 1, .z_min = -2, .z_max = 2}), 2 * all,
                1e-13);
}

static void areas_of_general_quadrics(void **state) {
    (void)state;
    sag_quadric s = {.coefficients = {1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, .clip = {{-2, -2, -2}, {2, 2, 2}}};
    assert_near(sag_quadric_area(&s), 4 * PI, 1e-8);
    s.clip.max.z = 0.5; // a zone
    assert_near(sag_quadric_area(&s), 3 * PI, 1e-8);
    sag_quadric plane = {.coefficients = {0, 0, 0, 0, 0, 0, 1, 1, 1, 0}, .clip = {{-1, -1, -1}, {1, 1, 1}}};
    assert_near(sag_quadric_area(&plane), 3 * sqrt(3), 1e-6); // a regular hexagon of side √2
    sag_quadric saddle = {.coefficients = {0, 0, 0, 1, 0, 0, 0, 0, -0.5, 0}, .clip = {{0, 0, -9}, {1, 1, 9}}};
    // z = 2xy: ∬ √(1 + 4x² + 4y²) over the unit square, by Gauss–Legendre to 15 digits.
    assert_near(sag_quadric_area(&saddle), 1.86156418075309, 1e-7);
}

static void volumes(void **state) {
    (void)state;
    assert_near(sag_sphere_volume(&(sag_sphere){.radius = 3}), 36 * PI, 1e-15);
    assert_near(sag_ellipsoid_volume(&(sag_ellipsoid){.radii = {1, 2, 3}}), 8 * PI, 1e-15);
    assert_near(sag_cylinder_volume(&(sag_cylinder){.radius = 2, .z_min = -1, .z_max = 2, .closed = true}),
                12 * PI, 1e-15);
    assert_near(sag_cone_volume(&(sag_cone){.radius = 3, .height = 4, .closed = true}), 12 * PI, 1e-15);
    assert_near(sag_paraboloid_volume(&(sag_paraboloid){.radius = 2, .z_max = 3, .closed = true}), 6 * PI,
                1e-15);
    assert_near(
        sag_hyperboloid_volume(&(sag_hyperboloid){.p1 = {-1, 1, -1}, .p2 = {1, 1, 1}, .closed = true}),
        PI * 8 / 3, 1e-15);
    assert_near(
        sag_hyperboloid2_volume(&(sag_hyperboloid2){.a = 1, .c = 1, .z_min = -2, .z_max = 2, .closed = true}),
        2 * PI * 4 / 3, 1e-15);
    assert_true(sag_cone_volume(&(sag_cone){.radius = 3, .height = 4}) == 0); // open: no solid
}

// For samples uniform by area, a fine grid over the surface must be hit in proportion. The grid here is the
// cells of the box that holds the shape; what they should get is the share of a second, independent way to
// hit the surface evenly: the crossings of random lines (Crofton: lines uniform in space cross equal areas
// equally often).
static void samples_are_uniform(void **state) {
    (void)state;
    enum { CELLS = 4, COUNT = 20000 };
    quadric_truth truth;
    quadric_truth_init(&truth);
    for (size_t k = 0; k < quadric_subject_count; k++) {
        const quadric_subject *subject = &quadric_subjects[k];
        rng r = rng_make(99 + k);
        for (int i = 0; i < 4; i++) {
            any_quadric shape;
            memset(&shape, 0, sizeof shape);
            subject->make(&r, 1, &shape, &truth);
            sag_box3 box = subject->bounds(&shape);
            sag_vec3 size = sag_sub(box.max, box.min), middle = sag_scale(sag_add(box.min, box.max), 0.5);
            double ball = sag_length(size) / 2, by_samples[CELLS * CELLS * CELLS] = {0},
                   by_lines[CELLS * CELLS * CELLS] = {0}, lines = 0, samples = 0;
            sag_surface f;
            if (!subject->sample(&shape, rng_vec2(&r), &f)) continue;
            double thin = fmin(size.x, fmin(size.y, size.z)) / sag_max_component(size);
            if (thin < 0.05) continue; // few lines meet it
#define CELL(p)                                                                                              \
    ((int)fmin(fmax(((p).x - box.min.x) / size.x * CELLS, 0), CELLS - 1) * CELLS * CELLS +                   \
     (int)fmin(fmax(((p).y - box.min.y) / size.y * CELLS, 0), CELLS - 1) * CELLS +                           \
     (int)fmin(fmax(((p).z - box.min.z) / size.z * CELLS, 0), CELLS - 1))
            for (int j = 0; j < COUNT; j++) {
                if (!subject->sample(&shape, rng_vec2(&r), &f)) continue;
                by_samples[CELL(f.position)]++, samples++;
                // A line uniform among those that meet the ball: a point of its great disk across a
                // direction.
                sag_vec3 d = rng_direction(&r), s, t;
                sag_frame(d, &s, &t);
                double rho = ball * sqrt(rng_unit(&r)), phi = 2 * PI * rng_unit(&r);
                sag_vec3 o = sag_madd(sag_madd(middle, rho * cos(phi), s), rho * sin(phi), t);
                sag_ray ray = sag_ray_make(o, d);
                ray.t_min = -INFINITY;
                sag_hit hits[8];
                size_t count = subject->crossings(&shape, &ray, hits, 8);
                for (size_t h = 0; h < count; h++) by_lines[CELL(sag_ray_at(&ray, hits[h].t))]++, lines++;
            }
            if (lines < 2000) continue;
            // Two samples of one distribution: χ² = Σ (√(N/M) m − √(M/N) n)²/(m + n).
            double chi2 = 0, cells = 0, ratio = sqrt(lines / samples);
            for (int c = 0; c < CELLS * CELLS * CELLS; c++) {
                double sum = by_samples[c] + by_lines[c], gap = ratio * by_samples[c] - by_lines[c] / ratio;
                if (sum < 10) continue;
                chi2 += gap * gap / sum, cells++;
            }
            // Crossings come in pairs, which may double the variance.
            double limit = 2 * (cells + 5 * sqrt(2 * cells) + 5);
            if (chi2 > limit) print_message("%s: chi2 %g of %g cells\n", subject->name, chi2, cells);
            assert_true(chi2 <= limit);
            // Crofton again: the mean number of crossings of a line is 2 A / (4π ball²) · … = A/(2π ball²).
            double crofton = lines / COUNT * 2 * PI * ball * ball, area = subject->area(&shape);
            double sigma = 2 / sqrt(lines);
            if (!(fabs(area / crofton - 1) < 5 * sigma))
                print_message("%s: area %g, by lines %g\n", subject->name, area, crofton);
            assert_true(fabs(area / crofton - 1) < 5 * sigma);
        }
    }
    quadric_truth_clear(&truth);
}

// A point is inside when a line through it has crossed the closed shape an odd number of times before it.
static void contains_agrees_with_parity(void **state) {
    (void)state;
    quadric_truth truth;
    quadric_truth_init(&truth);
    for (size_t k = 0; k < quadric_subject_count; k++) {
        const quadric_subject *subject = &quadric_subjects[k];
        rng r = rng_make(5 + k);
        for (int i = 0; i < 3000; i++) {
            any_quadric shape;
            double size = rng_log_uniform(&r, 1e-8, 1e8);
            memset(&shape, 0, sizeof shape);
            subject->make(&r, size, &shape, &truth);
            bool ball = strcmp(subject->name, "ellipsoid") == 0;
            if (!truth.closed && !ball) continue;
            sag_box3 box = subject->bounds(&shape);
            sag_vec3 p = {rng_uniform(&r, box.min.x, box.max.x), rng_uniform(&r, box.min.y, box.max.y),
                          rng_uniform(&r, box.min.z, box.max.z)};
            sag_ray ray = sag_ray_make(p, rng_direction(&r));
            sag_hit hits[8];
            size_t count = subject->crossings(&shape, &ray, hits, 8);
            assert_int_equal(subject->contains(&shape, p), count % 2 == 1);
        }
        sag_vec3 nan = {NAN, 0, 0};
        any_quadric shape;
        memset(&shape, 0, sizeof shape);
        subject->make(&r, 1, &shape, &truth);
        assert_false(subject->contains(&shape, nan));
    }
    quadric_truth_clear(&truth);
}

static double distance(sag_vec3 a, sag_vec3 b) { return sag_length(sag_sub(a, b)); }

// No sample of the surface is nearer than the closest point, and some come near it.
static void check_closest(const char *name, sag_vec3 point, sag_vec3 closest, const sag_vec3 *samples,
                          int count) {
    double least = INFINITY, to_surface = INFINITY;
    for (int i = 0; i < count; i++) {
        least = fmin(least, distance(point, samples[i]));
        to_surface = fmin(to_surface, distance(closest, samples[i]));
    }
    double d = distance(point, closest);
    if (!(d <= least * (1 + 1e-12))) fail_msg("%s: %g is farther than %g", name, d, least);
    if (!(least <= d + 0.2)) fail_msg("%s: %g is nearer than any point, %g", name, d, least);
    assert_true(to_surface < 0.2);
}

static void closest_points(void **state) {
    (void)state;
    enum { COUNT = 4000 };
    static sag_vec3 samples[COUNT];
    rng r = rng_make(3);
    for (int i = 0; i < 60; i++) {
        sag_sphere sphere = {.center = rng_vec3(&r, 1), .radius = rng_uniform(&r, 0.3, 1)};
        sag_ellipsoid ellipsoid = {.center = rng_vec3(&r, 1),
                                   .radii = {rng_uniform(&r, 0.01, 1), rng_uniform(&r, 0.3, 1), 0.7}};
        bool closed = rng_one_in(&r, 2);
        double sweep = closed || rng_one_in(&r, 2) ? 0 : rng_uniform(&r, 0.5, 6);
        sag_cylinder cylinder = {0.7, -0.4, 0.5, sweep, closed};
        sag_cone cone = {0.7, 0.9, sweep, closed};
        sag_vec3 p = rng_vec3(&r, i % 2 ? 2 : 0.5);
        if (i % 7 == 0) p.x = i % 14 ? ellipsoid.center.x : 0;
        sag_surface f;
#define CHECK(shape)                                                                                         \
    for (int k = 0; k < COUNT; k++) {                                                                        \
        assert_true(sag_##shape##_sample(&shape, rng_vec2(&r), &f));                                         \
        samples[k] = f.position;                                                                             \
    }                                                                                                        \
    check_closest(#shape, p, sag_##shape##_closest_point(&shape, p), samples, COUNT)
        CHECK(sphere);
        CHECK(ellipsoid);
        CHECK(cylinder);
        CHECK(cone);
    }
    sag_ellipsoid e = {.radii = {1, 2, 3}};
    sag_vec3 q = sag_ellipsoid_closest_point(&e, sag_vec3_make(0, 0, 0));
    assert_near(fabs(q.x), 1, 1e-15);
    q = sag_ellipsoid_closest_point(&e, sag_vec3_make(0, 0, 30));
    assert_near(q.z, 3, 1e-15);
    q = sag_sphere_closest_point(&(sag_sphere){.radius = 2}, sag_vec3_make(0, 0, 0));
    assert_near(sag_length(q), 2, 1e-15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_have_closed_forms),
        cmocka_unit_test(areas_of_general_quadrics),
        cmocka_unit_test(volumes),
        cmocka_unit_test(samples_are_uniform),
        cmocka_unit_test(contains_agrees_with_parity),
        cmocka_unit_test(closest_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
