// SPDX-License-Identifier: MIT
// Known answers of the shapes of second degree: crossings, normals and texture coordinates by hand, tangents,
// degenerate and senseless input, and the regressions that other programs' users reported.
#include "support/quadric_subjects.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
// clang-format on

#define PI 3.14159265358979323846

static sag_ray line(double ox, double oy, double oz, double dx, double dy, double dz) {
    sag_ray ray = sag_ray_make(sag_vec3_make(ox, oy, oz), sag_vec3_make(dx, dy, dz));
    ray.t_min = -INFINITY;
    return ray;
}

static void assert_vec(sag_vec3 v, double x, double y, double z) {
    double off = sag_length(sag_sub(v, sag_vec3_make(x, y, z)));
    if (!(off <= 1e-13)) fail_msg("(%.17g %.17g %.17g), not (%g %g %g)", v.x, v.y, v.z, x, y, z);
}

// The crossings of a whole line, given as t and primitive in turn.
#define ASSERT_CROSSINGS(X, shape, ray, ...)                                                                 \
    do {                                                                                                     \
        const double right[] = {__VA_ARGS__, -99};                                                           \
        size_t expected_count = (sizeof right / sizeof *right - 1) / 2;                                      \
        sag_hit hits[8], first;                                                                              \
        sag_ray whole = ray;                                                                                 \
        assert_int_equal(sag_##X##_crossings(shape, &whole, hits, 8), expected_count);                       \
        for (size_t i = 0; i < expected_count; i++) {                                                        \
            if (!(fabs(hits[i].t - right[2 * i]) <= 1e-15 * fabs(right[2 * i])))                             \
                fail_msg("%s: t %.17g, not %.17g", #X, hits[i].t, right[2 * i]);                             \
            assert_int_equal(hits[i].primitive, right[2 * i + 1]);                                           \
        }                                                                                                    \
        assert_int_equal(sag_##X##_hit(shape, &whole, &first), expected_count > 0);                          \
        assert_int_equal(sag_##X##_occluded(shape, &whole), expected_count > 0);                             \
        if (expected_count > 0) assert_true(first.t == hits[0].t);                                           \
        assert_int_equal(sag_##X##_crossings(shape, &whole, NULL, 0), expected_count);                       \
    } while (0)
#define ASSERT_MISS(X, shape, ray)                                                                           \
    do {                                                                                                     \
        sag_hit untouched = {.t = 42, .primitive = 7};                                                       \
        sag_ray whole = ray;                                                                                 \
        assert_int_equal(sag_##X##_crossings(shape, &whole, NULL, 0), 0);                                    \
        assert_false(sag_##X##_hit(shape, &whole, &untouched));                                              \
        assert_true(untouched.t == 42 && untouched.primitive == 7);                                          \
        assert_false(sag_##X##_occluded(shape, &whole));                                                     \
    } while (0)

static void crossings_by_hand(void **state) {
    (void)state;
    sag_sphere ball = {.center = {1, 2, 3}, .radius = 2};
    ASSERT_CROSSINGS(sphere, &ball, line(1, 2, 10, 0, 0, -1), 5, 0, 9, 0);
    ASSERT_CROSSINGS(sphere, &ball, line(1, 2, 10, 0, 0, -0.5), 10, 0, 18, 0);
    ASSERT_CROSSINGS(sphere, &ball, line(1, 2, 3, 0, 4, 0), -0.5, 0, 0.5, 0);
    ASSERT_CROSSINGS(sphere, &ball, line(-5, 4, 3, 1, 0, 0), 6, 0, 6, 0); // a tangent
    ASSERT_MISS(sphere, &ball, line(-5, 4 + 1e-15, 3, 1, 0, 0));
    sag_ellipsoid egg = {.radii = {1, 2, 4}};
    ASSERT_CROSSINGS(ellipsoid, &egg, line(0, 0, -8, 0, 0, 2), 2, 0, 6, 0);
    ASSERT_CROSSINGS(ellipsoid, &egg, line(1, -5, 0, 0, 1, 0), 5, 0, 5, 0);
    sag_cylinder can = {.radius = 2, .z_min = -1, .z_max = 3, .closed = true};
    ASSERT_CROSSINGS(cylinder, &can, line(-5, 0, 0, 1, 0, 0), 3, 0, 7, 0);
    ASSERT_CROSSINGS(cylinder, &can, line(1, 1, 9, 0, 0, -1), 6, 2, 10, 1);
    ASSERT_CROSSINGS(cylinder, &can, line(0, 0, 4, 1, 0, -1), 1, 2, 2, 0);
    ASSERT_MISS(cylinder, &can, line(2.5, 0, 9, 0, 0, -1));
    ASSERT_CROSSINGS(cylinder, &can, line(2, 0, 9, 0, 0, -1), 6, 2, 10, 1); // along the side: on it is inside
    ASSERT_CROSSINGS(cylinder, &can, line(-5, 0, 3, 1, 0, 0), 3, 0, 7, 0);  // in the cap's plane
    can.closed = false;
    ASSERT_MISS(cylinder, &can, line(1, 1, 9, 0, 0, -1));
    ASSERT_CROSSINGS(cylinder, &can, line(0, 0, 4, 1, 0, -1), 2, 0);
    sag_cone hat = {.radius = 2, .height = 4, .closed = true};
    ASSERT_CROSSINGS(cone, &hat, line(-5, 0, 2, 1, 0, 0), 4, 0, 6, 0);
    ASSERT_CROSSINGS(cone, &hat, line(1, 0, 9, 0, 0, -1), 7, 0, 9, 1);
    ASSERT_CROSSINGS(cone, &hat, line(0, 0, 9, 0, 0, -1), 5, 0, 9, 1); // through the apex
    ASSERT_MISS(cone, &hat, line(-5, 0, 5, 1, 0, 0));                  // the mirror nappe is not part of it
    ASSERT_MISS(cone, &hat, line(1, 0, 5, 0, 1, 1));
    ASSERT_CROSSINGS(cone, &hat, line(0, 0, 2, 1, 0, -2), -0.5, 0, 1, 1); // parallel to one side;
}

static void crossings_by_hand_of_the_rest(void **state) {
    (void)state;
    sag_cone hat = {.radius = 1, .height = 1, .closed = true};
    // Parallel to the side x = 1 − z: one root of the cone, one cap.
    ASSERT_CROSSINGS(cone, &hat, line(-1, 0, 1.5, 1, 0, -1), 0.75, 0, 1.5, 1);
    sag_paraboloid bowl = {.radius = 2, .z_min = 0, .z_max = 4, .closed = true}; // z = x² + y²
    ASSERT_CROSSINGS(paraboloid, &bowl, line(1, 0, 9, 0, 0, -1), 5, 2, 8, 0);
    ASSERT_CROSSINGS(paraboloid, &bowl, line(-5, 0, 1, 1, 0, 0), 4, 0, 6, 0);
    ASSERT_CROSSINGS(paraboloid, &bowl, line(0, 0, -1, 0, 0, 1), 1, 0, 5, 2);
    ASSERT_MISS(paraboloid, &bowl, line(-5, 0, -1e-300, 1, 0, 0));
    bowl.z_min = 1;
    ASSERT_CROSSINGS(paraboloid, &bowl, line(0, 0, -1, 0, 0, 1), 2, 1, 5, 2);
    // The lines (1, s, s) turned about z: x² + y² = 1 + z².
    sag_hyperboloid vase = {.p1 = {1, -2, -2}, .p2 = {1, 2, 2}, .closed = true};
    ASSERT_CROSSINGS(hyperboloid, &vase, line(-5, 0, 0, 1, 0, 0), 4, 0, 6, 0);
    ASSERT_CROSSINGS(hyperboloid, &vase, line(0, 0, -5, 0, 0, 1), 3, 1, 7, 2);
    // x² = 1 + z² along x = 1.25: z = ±0.75, and in the caps' disks of radius √5: four crossings.
    ASSERT_CROSSINGS(hyperboloid, &vase, line(1.25, 0, -5, 0, 0, 1), 3, 1, 4.25, 0, 5.75, 0, 7, 2);
    sag_hyperboloid2 pair = {.a = 1, .c = 1, .z_min = -2, .z_max = 3, .closed = true}; // z² = 1 + ρ²
    ASSERT_CROSSINGS(hyperboloid2, &pair, line(0, 0, -5, 0, 0, 1), 3, 1, 4, 0, 6, 0, 8, 2);
    ASSERT_MISS(hyperboloid2, &pair, line(-5, 0, 0.999, 1, 0, 0));
    ASSERT_CROSSINGS(hyperboloid2, &pair, line(-5, 0, 1, 1, 0, 0), 5, 0, 5, 0);
    ASSERT_CROSSINGS(hyperboloid2, &pair, line(0.75, 0, 9, 0, 0, -1), 6, 2, 7.75, 0, 10.25, 0, 11, 1);
    sag_quadric saddle = {.coefficients = {1, -1, 0, 0, 0, 0, 0, 0, -0.5, 0},
                          .clip = {{-2, -2, -5}, {2, 2, 5}}};
    ASSERT_CROSSINGS(quadric, &saddle, line(1.5, 0.5, 9, 0, 0, -1), 7, 0); // z = x² − y²
    ASSERT_CROSSINGS(quadric, &saddle, line(-5, 0, 1, 1, 0, 0), 4, 0, 6, 0);
    ASSERT_MISS(quadric, &saddle, line(-9, 0, 4.5, 1, 0, 0)); // beyond the box
}

// Up the axis from far below: the double root in the apex takes more than 400 bits to be exactly double.
static void axis_of_a_cone_meets_its_base(void **state) {
    (void)state;
    sag_cone cone = {.radius = 3.558620054070201e-10, .height = 9.4943329201653476e-11, .closed = true};
    sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, -1.2324594975758054e-05),
                               sag_vec3_make(0, 0, 0.0038400666784588551));
    sag_hit hits[4];
    assert_int_equal(sag_cone_crossings(&cone, &ray, hits, 4), 2);
    assert_int_equal(hits[0].primitive, 1);
    assert_int_equal(hits[1].primitive, 0);
}

static void rings(void **state) {
    (void)state;
    sag_hyperboloid ring = {.p1 = {1, 0, 2}, .p2 = {3, 0, 2}};
    ASSERT_CROSSINGS(hyperboloid, &ring, line(0, 2, 5, 0, 0, -1), 3, 0);
    ASSERT_MISS(hyperboloid, &ring, line(0, 0.5, 5, 0, 0, -1));
    ASSERT_MISS(hyperboloid, &ring, line(-9, 0, 2, 1, 0, 0));     // in its plane
    sag_hyperboloid across = {.p1 = {1, -2, 0}, .p2 = {1, 1, 0}}; // passes its nearest point to the axis
    ASSERT_CROSSINGS(hyperboloid, &across, line(0, 1.0001, 5, 0, 0, -1), 5, 0);
    ASSERT_CROSSINGS(hyperboloid, &across, line(0, -2.2, 5, 0, 0, -1), 5, 0);
    ASSERT_MISS(hyperboloid, &across, line(0.9, 0, 5, 0, 0, -1));
    ASSERT_MISS(hyperboloid, &across, line(2.3, 0, 5, 0, 0, -1));
    sag_ray ray = line(0, 2, 5, 0, 0, -1);
    sag_hit hit;
    sag_surface s;
    assert_true(sag_hyperboloid_hit(&ring, &ray, &hit));
    sag_hyperboloid_surface(&ring, &ray, &hit, &s);
    assert_vec(s.position, 0, 2, 2);
    assert_vec(s.geometric_normal, 0, 0, 1);
    assert_true(fabs(s.u - 0.25) < 1e-15 && fabs(s.v - 0.5) < 1e-15);
}

// Samples of a ring: ρ² is uniform between the squares of the radii, φ in the sweep.
static void samples_of_rings(void **state) {
    (void)state;
    enum { COUNT = 20000 };
    rng r = rng_make(31);
    sag_hyperboloid rings_of[] = {{{1, 0, 2}, {3, 0, 2}, 0, false},
                                  {{1, -2, 0}, {1, 1, 0}, 0, false},
                                  {{3, 1, 0}, {0, 0, 0}, 2, false}};
    const double inner2[] = {1, 1, 0}, outer2[] = {9, 5, 10}, sweep[] = {2 * PI, 2 * PI, 2};
    for (int k = 0; k < 3; k++) {
        double area = sag_hyperboloid_area(&rings_of[k]), mean = 0, turn = 0;
        assert_true(fabs(area / (sweep[k] / 2 * (outer2[k] - inner2[k])) - 1) < 1e-14);
        for (int i = 0; i < COUNT; i++) {
            sag_surface s;
            assert_true(sag_hyperboloid_sample(&rings_of[k], rng_vec2(&r), &s));
            double rho2 = s.position.x * s.position.x + s.position.y * s.position.y;
            assert_true(rho2 >= inner2[k] - 1e-12 && rho2 <= outer2[k] + 1e-12);
            mean += rho2 / COUNT, turn += s.u / COUNT;
        }
        assert_true(fabs(mean - (inner2[k] + outer2[k]) / 2) < 0.02 * (outer2[k] - inner2[k]));
        assert_true(fabs(turn - 0.5) < 0.02);
    }
}

// A swept hyperboloid has the crossings of the whole one whose φ, counted from the segment, is in the sweep.
static void swept_hyperboloids(void **state) {
    (void)state;
    rng r = rng_make(32);
    for (int i = 0; i < 5000; i++) {
        sag_hyperboloid whole = {.p1 = rng_vec3(&r, 1), .p2 = rng_vec3(&r, 1)}, part = whole;
        part.phi_max_rad = rng_uniform(&r, 0.1, 6);
        sag_ray ray = sag_ray_make(rng_vec3(&r, 2), rng_direction(&r));
        ray.t_min = -INFINITY;
        sag_hit all[4], kept[4];
        size_t count = sag_hyperboloid_crossings(&whole, &ray, all, 4), left = 0;
        size_t found = sag_hyperboloid_crossings(&part, &ray, kept, 4);
        for (size_t k = 0; k < count; k++) {
            sag_surface s;
            sag_hyperboloid_surface(&whole, &ray, &all[k], &s);
            if (s.u * 2 * PI > part.phi_max_rad) continue;
            assert_true(left < found && kept[left].t == all[k].t);
            left++;
        }
        assert_int_equal(left, found);
    }
}

static sag_surface surface_of_sphere(const sag_sphere *s, sag_ray ray) {
    sag_hit hit;
    sag_surface surface;
    assert_true(sag_sphere_hit(s, &ray, &hit));
    sag_sphere_surface(s, &ray, &hit, &surface);
    return surface;
}

// The teaching notes': y up, longitude 0 at −z. pbrt's when a sweep is given.
static void texture_coordinates_of_spheres(void **state) {
    (void)state;
    sag_sphere whole = {.center = {0, 0, 0}, .radius = 2};
    sag_surface s = surface_of_sphere(&whole, sag_ray_make(sag_vec3_make(0, 0, 5), sag_vec3_make(0, 0, -1)));
    assert_vec(s.position, 0, 0, 2);
    assert_vec(s.geometric_normal, 0, 0, 1);
    assert_vec(s.dpdu, 4 * PI, 0, 0);
    assert_vec(s.dpdv, 0, 2 * PI, 0);
    assert_true(s.u == 0.5 && s.v == 0.5 && s.side == SAG_SIDE_FRONT);
    s = surface_of_sphere(&whole, sag_ray_make(sag_vec3_make(5, 0, 0), sag_vec3_make(-1, 0, 0)));
    assert_true(fabs(s.u - 0.75) < 1e-15 && s.v == 0.5);
    s = surface_of_sphere(&whole, sag_ray_make(sag_vec3_make(0, 0, 0), sag_vec3_make(0, 3, 0)));
    assert_true(s.v == 1 && s.side == SAG_SIDE_BACK);
    sag_sphere swept = {.radius = 2, .phi_max_rad = 2 * PI};
    s = surface_of_sphere(&swept, sag_ray_make(sag_vec3_make(0, 5, 0), sag_vec3_make(0, -1, 0)));
    assert_true(fabs(s.u - 0.25) < 1e-15 && fabs(s.v - 0.5) < 1e-15);
    assert_vec(s.dpdu, -4 * PI, 0, 0);
    assert_vec(s.dpdv, 0, 0, 2 * PI);
    sag_sphere zone = {.radius = 2, .z_min = 0, .z_max = 2, .phi_max_rad = PI};
    s = surface_of_sphere(&zone, sag_ray_make(sag_vec3_make(0, 1, 5), sag_vec3_make(0, 0, -1)));
    assert_true(fabs(s.u - 0.5) < 1e-15 && fabs(s.v - 2.0 / 3) < 1e-15);
    sag_ray other = sag_ray_make(sag_vec3_make(0, -1, 5), sag_vec3_make(0, 0, -1)); // out of the sweep
    assert_false(sag_sphere_occluded(&zone, &other));
}

// An origin on the surface: t = 0 is in the closed range, exactly; a t_max at the crossing too.
static void starts_on_the_surface(void **state) {
    (void)state;
    sag_sphere ball = {.radius = 1};
    sag_ray ray = sag_ray_make(sag_vec3_make(1, 0, 0), sag_vec3_make(-1, 0, 0));
    sag_hit hits[2];
    assert_int_equal(sag_sphere_crossings(&ball, &ray, hits, 2), 2);
    assert_true(hits[0].t == 0 && hits[1].t == 2);
    ray.t_max = 0;
    assert_int_equal(sag_sphere_crossings(&ball, &ray, hits, 2), 1);
    ray.t_min = 2, ray.t_max = 2;
    assert_true(sag_sphere_hit(&ball, &ray, hits));
    ray.t_min = nextafter(2, 3), ray.t_max = INFINITY;
    assert_false(sag_sphere_occluded(&ball, &ray));
    // 0.6² + 0.8² is not 1 in doubles: t is tiny, but it is the root of that equation.
    ray = sag_ray_make(sag_vec3_make(0.6, 0.8, 0), sag_vec3_make(-0.6, -0.8, 0));
    ray.t_min = -1;
    assert_true(sag_sphere_hit(&ball, &ray, hits));
    double over = fma(0.6, 0.6, fma(0.8, 0.8, -1)); // ρ² − 1, rounded once; t ≈ over/2
    assert_true(fabs(hits[0].t) < 1e-16 && fabs(hits[0].t - over / 2) < 1e-16);
}

static void senseless_rays_miss(void **state) {
    (void)state;
    quadric_truth truth;
    quadric_truth_init(&truth);
    rng r = rng_make(1);
    for (size_t k = 0; k < quadric_subject_count; k++) {
        const quadric_subject *subject = &quadric_subjects[k];
        any_quadric shape;
        memset(&shape, 0, sizeof shape);
        subject->make(&r, 1, &shape, &truth);
        const double bad[] = {NAN, INFINITY, -INFINITY};
        for (int i = 0; i < 20; i++) {
            sag_ray ray = sag_ray_make(rng_vec3(&r, 0.1), rng_direction(&r));
            double *numbers[] = {&ray.origin.x,    &ray.origin.y,    &ray.origin.z,
                                 &ray.direction.x, &ray.direction.y, &ray.direction.z};
            if (i < 18) *numbers[i % 6] = bad[i / 6];
            if (i == 18) ray.direction = sag_vec3_make(0, 0, 0);
            if (i == 19) ray.t_min = 1, ray.t_max = 0;
            sag_hit hit;
            assert_false(subject->hit(&shape, &ray, &hit));
            assert_false(subject->occluded(&shape, &ray));
            assert_int_equal(subject->crossings(&shape, &ray, NULL, 0), 0);
        }
    }
    quadric_truth_clear(&truth);
}

// Shapes with NaN, infinite, zero and negative numbers in every field: an error that names the shape; the
// other verbs return.
static void senseless_shapes_are_errors(void **state) {
    (void)state;
    quadric_truth truth;
    quadric_truth_init(&truth);
    rng r = rng_make(2);
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e300, 0, -1, 1e-300, -1e300};
    const size_t sizes[] = {sizeof(sag_sphere),       sizeof(sag_ellipsoid),  sizeof(sag_cylinder),
                            sizeof(sag_cone),         sizeof(sag_paraboloid), sizeof(sag_hyperboloid),
                            sizeof(sag_hyperboloid2), sizeof(sag_quadric)};
    for (size_t k = 0; k < quadric_subject_count; k++) {
        const quadric_subject *subject = &quadric_subjects[k];
        for (size_t field = 0; field < sizes[k] / sizeof(double); field++) {
            for (int b = 0; b < 8; b++) {
                any_quadric shape;
                memset(&shape, 0, sizeof shape);
                subject->make(&r, 1, &shape, &truth);
                bool flag =
                    (k >= 2 && k <= 6) && field == sizes[k] / sizeof(double) - 1; // `closed`, no number
                if (flag) continue;
                memcpy((char *)&shape + field * sizeof(double), &bad[b], sizeof(double));
                sag_error error = {0};
                sag_status status = subject->validate(&shape, &error);
                if (!isfinite(bad[b])) assert_int_equal(status, SAG_ERROR_GEOMETRY);
                if (status != SAG_OK)
                    assert_true(strncmp(error.message, subject->name, strlen(subject->name)) == 0);
                for (int i = 0; i < 10; i++) {
                    sag_ray ray = sag_ray_make(rng_vec3(&r, 2), rng_direction(&r));
                    sag_hit hit = {0};
                    sag_surface surface;
                    if (subject->hit(&shape, &ray, &hit)) subject->surface(&shape, &ray, &hit, &surface);
                    if (strcmp(subject->name, "quadric") != 0) {
                        subject->sample(&shape, rng_vec2(&r), &surface);
                        subject->area(&shape);
                    }
                    subject->contains(&shape, rng_vec3(&r, 2));
                    subject->bounds(&shape);
                }
            }
        }
    }
    quadric_truth_clear(&truth);
    sag_error error;
    assert_int_equal(sag_sphere_validate(&(sag_sphere){.radius = -2}, &error), SAG_ERROR_GEOMETRY);
    assert_string_equal(error.message, "sphere: radius -2 must be positive and at most 2^100");
    assert_int_equal(sag_cylinder_validate(&(sag_cylinder){1, 0, 1, 1, true}, &error), SAG_ERROR_GEOMETRY);
    assert_non_null(strstr(error.message, "phi_max_rad 1 "));
    assert_int_equal(sag_hyperboloid_validate(&(sag_hyperboloid){{1, 0, 0}, {2, 0, 0}, 0, true}, &error),
                     SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_quadric_validate(
                         &(sag_quadric){.coefficients = {[9] = 1}, .clip = {{0, 0, 0}, {1, 1, 1}}}, &error),
                     SAG_ERROR_GEOMETRY);
    assert_int_equal(sag_sphere_validate(&(sag_sphere){.radius = -2}, NULL), SAG_ERROR_GEOMETRY);
}

// Every shape and ray scaled by a power of two gives the same hits, scaled: from 2⁻⁹⁰ to 2⁹⁰, and any length
// of the direction.
static void powers_of_two_change_nothing(void **state) {
    (void)state;
    rng r = rng_make(11);
    for (int i = 0; i < 3000; i++) {
        sag_cone cone = {rng_uniform(&r, 0.1, 1), rng_uniform(&r, 0.1, 1), 0, true};
        sag_ellipsoid egg = {
            .center = rng_vec3(&r, 1),
            .radii = {rng_uniform(&r, 0.1, 1), rng_uniform(&r, 0.1, 1), rng_uniform(&r, 0.1, 1)}};
        sag_sphere ball = {.center = rng_vec3(&r, 1), .radius = rng_uniform(&r, 0.1, 1)};
        sag_ray ray = sag_ray_make(rng_vec3(&r, 2), rng_direction(&r));
        int k = (int)rng_below(&r, 180) - 90, m = (int)rng_below(&r, 1600) - 800;
        double size = ldexp(1, k);
        sag_cone cone2 = {cone.radius * size, cone.height * size, 0, true};
        sag_ellipsoid egg2 = {sag_scale(egg.center, size), sag_scale(egg.radii, size)};
        sag_sphere ball2 = {.center = sag_scale(ball.center, size), .radius = ball.radius * size};
        sag_ray ray2 = sag_ray_make(sag_scale(ray.origin, size), sag_scale(ray.direction, ldexp(1, m)));
        sag_hit a, b;
#define SAME(X, one, two)                                                                                    \
    do {                                                                                                     \
        bool hit = sag_##X##_hit(&one, &ray, &a);                                                            \
        assert_int_equal(sag_##X##_hit(&two, &ray2, &b), hit);                                               \
        if (hit) assert_true(b.t == ldexp(a.t, k - m));                                                      \
    } while (0)
        SAME(cone, cone, cone2);
        SAME(ellipsoid, egg, egg2);
        SAME(sphere, ball, ball2);
    }
}

// mitsuba3 PR #1871: a ray leaving a sphere must meet another 4e-5 around it; a fixed epsilon jumps over it.
static void regression_mitsuba_1871(void **state) {
    (void)state;
    rng r = rng_make(1871);
    for (int i = 0; i < 10000; i++) {
        double size = rng_log_uniform(&r, 1e-6, 1e6);
        sag_sphere inner = {.center = rng_vec3(&r, 3 * size), .radius = size};
        sag_sphere outer = {.center = inner.center, .radius = size * (1 + 4e-5)};
        sag_ray ray =
            sag_ray_make(sag_madd(inner.center, 5 * size, rng_direction(&r)), sag_vec3_make(0, 0, 0));
        ray.direction = sag_sub(sag_add(inner.center, rng_vec3(&r, 0.5 * size)), ray.origin);
        sag_hit hit;
        sag_surface s;
        if (!sag_sphere_hit(&inner, &ray, &hit)) continue;
        sag_sphere_surface(&inner, &ray, &hit, &s);
        sag_vec3 w = rng_direction(&r);
        if (sag_dot(w, s.geometric_normal) < 0) w = sag_neg(w);
        sag_ray out = sag_spawn_ray(&s, w);
        assert_false(sag_sphere_occluded(&inner, &out));
        assert_true(sag_sphere_hit(&outer, &out, &hit));
        assert_true(hit.t > 3.9e-5 * size && hit.t < 0.01 * size);
    }
}

// ziotom78/pytracer #22: a sphere 400 units away was lost in single precision. Ray Tracing Gems ch. 7: the
// textbook's discriminant fails from 2^26.5 ≈ 9.5e7 radii on in doubles. Every ray through the middle half
// must hit, with t right to the last bit or two, at any distance.
static void regression_far_spheres(void **state) {
    (void)state;
    rng r = rng_make(22);
    for (int i = 0; i < 20000; i++) {
        double radius = rng_log_uniform(&r, 1e-3, 1e3);
        double far = i % 4 == 0 ? 400 / radius : rng_log_uniform(&r, 10, 1e12);
        sag_sphere ball = {.center = {0, 0, 0}, .radius = radius};
        sag_vec3 d = rng_direction(&r), s, t;
        sag_frame(d, &s, &t);
        double off = rng_uniform(&r, 0, 0.5) * radius;
        sag_vec3 o = sag_madd(sag_scale(d, -far * radius), off, s);
        sag_ray ray = sag_ray_make(o, d);
        sag_hit hit;
        double blur = far * radius * 1e-15; // d is a unit but for rounding, which far away is much
        if (blur > 0.1 * radius) ray.direction = sag_neg(o);
        assert_true(sag_sphere_hit(&ball, &ray, &hit));
        sag_surface surface;
        sag_sphere_surface(&ball, &ray, &hit, &surface);
        assert_true(fabs(sag_length(surface.position) / radius - 1) < 1e-15);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crossings_by_hand),
        cmocka_unit_test(crossings_by_hand_of_the_rest),
        cmocka_unit_test(axis_of_a_cone_meets_its_base),
        cmocka_unit_test(rings),
        cmocka_unit_test(samples_of_rings),
        cmocka_unit_test(swept_hyperboloids),
        cmocka_unit_test(texture_coordinates_of_spheres),
        cmocka_unit_test(starts_on_the_surface),
        cmocka_unit_test(senseless_rays_miss),
        cmocka_unit_test(senseless_shapes_are_errors),
        cmocka_unit_test(powers_of_two_change_nothing),
        cmocka_unit_test(regression_mitsuba_1871),
        cmocka_unit_test(regression_far_spheres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
