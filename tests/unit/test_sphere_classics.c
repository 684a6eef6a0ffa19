// SPDX-License-Identifier: MIT
// The two textbook ways to intersect a ray and a sphere beside Sagitta's, at growing distance: what
// docs/sphere.md tells is measured here. Truth is the library's own root, which tests/oracle/test_quadrics.c
// holds against MPFR.
#include "support/random.h"
#include <sagitta/shapes.h>
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

// Algebraic: put o + t d into |p − c|² = r² and solve a t² + b t + c = 0 by the formula from school. Writes
// the smaller root; false when the discriminant is negative.
static bool algebraic(const sag_sphere *s, const sag_ray *ray, double *t) {
    sag_vec3 l = sag_sub(ray->origin, s->center);
    double a = sag_dot(ray->direction, ray->direction), b = 2 * sag_dot(l, ray->direction);
    double c = sag_dot(l, l) - s->radius * s->radius, discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0)) return false;
    *t = (-b - sqrt(discriminant)) / (2 * a);
    return true;
}

// Geometric: go to the point of the ray nearest to the centre (Pythagoras gives its distance), and back by
// half the chord. The direction must be a unit, so it is made one.
static bool geometric(const sag_sphere *s, const sag_ray *ray, double *t) {
    double length = sag_length(ray->direction);
    sag_vec3 l = sag_sub(s->center, ray->origin), unit = sag_scale(ray->direction, 1 / length);
    double along = sag_dot(l, unit), distance2 = sag_dot(l, l) - along * along;
    if (!(distance2 <= s->radius * s->radius)) return false;
    *t = (along - sqrt(s->radius * s->radius - distance2)) / length;
    return true;
}

typedef bool (*method)(const sag_sphere *, const sag_ray *, double *);

typedef struct tally {
    int wrong;    // hit where there is none, or the other way
    double worst; // largest error of the hit point, in radii
} tally;

static void judge(method m, const sag_sphere *s, const sag_ray *ray, bool hit, double t, tally *out) {
    double got;
    if (m(s, ray, &got) != hit)
        out->wrong++;
    else if (hit)
        out->worst = fmax(out->worst, fabs(got - t) * sag_length(ray->direction) / s->radius);
}

// Rays from `far` radii away, aimed at the disk of 1.2 radii about the centre.
static void measure(double far, int count, tally *by_algebra, tally *by_geometry) {
    rng r = rng_make(1989);
    *by_algebra = *by_geometry = (tally){0, 0};
    for (int i = 0; i < count; i++) {
        sag_sphere s = {.center = rng_vec3(&r, 1), .radius = rng_uniform(&r, 0.5, 2)};
        sag_vec3 o = sag_madd(s.center, far * s.radius, rng_direction(&r));
        sag_vec3 target = sag_madd(s.center, 1.2 * s.radius * sqrt(rng_unit(&r)), rng_direction(&r));
        sag_ray ray = sag_ray_make(o, sag_scale(sag_sub(target, o), rng_uniform(&r, 0.5, 2)));
        ray.t_min = -INFINITY;
        sag_hit hit = {.t = 0};
        bool there = sag_sphere_hit(&s, &ray, &hit);
        judge(algebraic, &s, &ray, there, hit.t, by_algebra);
        judge(geometric, &s, &ray, there, hit.t, by_geometry);
    }
}

static void classics_agree_nearby_and_fail_far_away(void **state) {
    (void)state;
    enum { COUNT = 20000 };
    tally algebra, geometry;
    print_message("   radii | algebraic: wrong, error in radii | geometric: wrong, error in radii\n");
    for (double far = 3; far < 1e13; far *= far < 10 ? 10.0 / 3 : 10) {
        measure(far, COUNT, &algebra, &geometry);
        print_message(" %7.0e | %10.3f %% %10.1e          | %10.3f %% %10.1e\n", far,
                      100.0 * algebra.wrong / COUNT, algebra.worst, 100.0 * geometry.wrong / COUNT,
                      geometry.worst);
        if (far <= 1000) assert_true(algebra.wrong <= 1 && algebra.worst < 1e-6);
        if (far <= 1000) assert_true(geometry.wrong <= 1 && geometry.worst < 1e-6);
        if (far >= 1e9) assert_true(algebra.wrong > COUNT / 20 && geometry.wrong > COUNT / 20);
    }
}

// What the classics do to the near root of a ray that starts close to the surface: −b and √D, or the way to
// the middle of the chord and back, nearly cancel.
static void classics_lose_the_small_root(void **state) {
    (void)state;
    sag_sphere s = {.center = {0, 0, 0}, .radius = 1};
    print_message("   gap in radii | largest relative error of t: algebraic, geometric\n");
    for (int k = 2; k <= 14; k += 2) {
        rng r = rng_make(7);
        double gap = pow(10, -k), by_algebra = 0, by_geometry = 0;
        for (int i = 0; i < 2000; i++) {
            sag_vec3 n = rng_direction(&r), target = rng_vec3(&r, 0.5);
            sag_ray ray = sag_ray_make(sag_scale(n, 1 + gap), sag_sub(target, n));
            sag_hit hit;
            double t;
            assert_true(sag_sphere_hit(&s, &ray, &hit));
            if (algebraic(&s, &ray, &t)) by_algebra = fmax(by_algebra, fabs(t / hit.t - 1));
            if (geometric(&s, &ray, &t)) by_geometry = fmax(by_geometry, fabs(t / hit.t - 1));
        }
        print_message("   %10.0e | %.1e %.1e\n", gap, by_algebra, by_geometry);
        if (k >= 10) assert_true(by_algebra > 1e-7 && by_geometry > 1e-7);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(classics_agree_nearby_and_fail_far_away),
                                       cmocka_unit_test(classics_lose_the_small_root)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
