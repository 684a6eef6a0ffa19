// SPDX-License-Identifier: MIT
// The epsilon problem: a ray that leaves a surface must not meet it again, and must meet what is close to it.
// The two classic cures, a smallest t and an origin moved along the normal, each by a constant, beside the
// error bound. docs/epsilon.md quotes the table this prints.
#include "support/random.h"
#include <sagitta/shapes.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

typedef sag_ray leave(const sag_surface *surface, const sag_ray *arrived, const sag_hit *hit,
                      sag_vec3 direction);

// The constant of many a renderer, in whatever unit the scene has.
#define EPSILON 1e-4

static sag_ray leave_as_it_is(const sag_surface *s, const sag_ray *arrived, const sag_hit *hit, sag_vec3 d) {
    (void)s;
    return sag_ray_make(sag_ray_at(arrived, hit->t), d);
}

static sag_ray leave_by_t_min(const sag_surface *s, const sag_ray *arrived, const sag_hit *hit, sag_vec3 d) {
    sag_ray ray = leave_as_it_is(s, arrived, hit, d);
    ray.t_min = EPSILON;
    return ray;
}

static sag_ray leave_by_normal(const sag_surface *s, const sag_ray *arrived, const sag_hit *hit, sag_vec3 d) {
    double side = sag_dot(s->geometric_normal, d) > 0 ? EPSILON : -EPSILON;
    return sag_ray_make(sag_madd(sag_ray_at(arrived, hit->t), side, s->geometric_normal), d);
}

static sag_ray leave_by_bound(const sag_surface *s, const sag_ray *arrived, const sag_hit *hit, sag_vec3 d) {
    (void)arrived;
    (void)hit;
    return sag_spawn_ray(s, d);
}

enum { CURES = 4, BY_BOUND = 3 };
static const struct {
    const char *name;
    leave *leave;
} cures[CURES] = {{"nothing", leave_as_it_is},
                  {"t_min", leave_by_t_min},
                  {"moved", leave_by_normal},
                  {"bound", leave_by_bound}};

typedef struct counts {
    int rays;
    int again[CURES]; // met the surface they left
    int lost[CURES];  // did not meet the neighbour, 1e-5 sizes away
} counts;

static sag_vec3 away_from(sag_vec3 normal, rng *r) {
    sag_vec3 d = rng_direction(r);
    return sag_dot(d, normal) < 0 ? sag_neg(d) : d;
}

// A sphere within another.
static counts leave_spheres(double size, rng *r) {
    counts c = {0};
    sag_vec3 center = {3 * size, -2 * size, 5 * size};
    sag_sphere ball = {.center = center, .radius = size},
               shell = {.center = center, .radius = size * (1 + 1e-5)};
    for (int i = 0; i < 1000; i++) {
        sag_vec3 target = sag_madd(center, size, rng_direction(r));
        sag_vec3 origin = sag_madd(center, 10 * size, rng_direction(r));
        sag_ray ray = sag_ray_make(origin, sag_normalize(sag_sub(target, origin)));
        sag_hit hit, other;
        sag_surface s;
        if (!sag_sphere_hit(&ball, &ray, &hit)) continue;
        sag_sphere_surface(&ball, &ray, &hit, &s);
        sag_vec3 d = away_from(s.geometric_normal, r);
        c.rays++;
        for (int k = 0; k < CURES; k++) {
            sag_ray left = cures[k].leave(&s, &ray, &hit, d);
            c.again[k] += sag_sphere_occluded(&ball, &left);
            c.lost[k] += !sag_sphere_hit(&shell, &left, &other);
        }
    }
    return c;
}

// A triangle just above another, as large as it; left almost along the normal, near the middle.
static counts leave_triangles(double size, rng *r) {
    counts c = {0};
    for (int i = 0; i < 1000; i++) {
        sag_vec3 at = rng_vec3(r, 5 * size), x = rng_direction(r), y, n;
        sag_frame(x, &y, &n); // y × n = x: the normal of a triangle over y and n is x
        sag_triangle s = {at, sag_madd(at, size, y), sag_madd(at, size, n), false}, above = s;
        sag_vec3 gap = sag_scale(x, 1e-5 * size);
        above.a = sag_add(s.a, gap), above.b = sag_add(s.b, gap), above.c = sag_add(s.c, gap);
        sag_vec3 target = sag_madd(sag_madd(at, 0.3 * size, y), 0.3 * size, n);
        sag_vec3 origin = sag_add(target, rng_vec3(r, 10 * size));
        sag_ray ray = sag_ray_make(origin, sag_normalize(sag_sub(target, origin)));
        sag_hit hit, other;
        sag_surface surface;
        if (!sag_triangle_hit(&s, &ray, &hit)) continue;
        sag_triangle_surface(&s, &ray, &hit, &surface);
        sag_vec3 any = away_from(x, r), steep = sag_madd(any, 2, x);
        c.rays++;
        for (int k = 0; k < CURES; k++) {
            sag_ray left = cures[k].leave(&surface, &ray, &hit, any);
            c.again[k] += sag_triangle_occluded(&s, &left);
            left = cures[k].leave(&surface, &ray, &hit, sag_normalize(steep));
            c.lost[k] += !sag_triangle_hit(&above, &left, &other);
        }
    }
    return c;
}

static void print_line(const char *shape, double size, const counts *c) {
    printf("%-8s %5.0e %5d rays, met again/neighbour lost:", shape, size, c->rays);
    for (int k = 0; k < CURES; k++) printf("  %s %d/%d", cures[k].name, c->again[k], c->lost[k]);
    printf("\n");
}

static void test_cures(void **state) {
    (void)state;
    rng r = rng_make(1);
    counts sums[2] = {{0}};
    for (int scale = -9; scale <= 12; scale += 3) {
        double size = pow(10, scale);
        for (int shape = 0; shape < 2; shape++) {
            counts c = shape == 0 ? leave_spheres(size, &r) : leave_triangles(size, &r);
            print_line(shape == 0 ? "sphere" : "triangle", size, &c);
            for (int k = 0; k < CURES; k++) {
                sums[shape].again[k] += c.again[k];
                sums[shape].lost[k] += c.lost[k];
            }
        }
    }
    for (int shape = 0; shape < 2; shape++)
        for (int k = 0; k < CURES; k++) {
            int bad = sums[shape].again[k] + sums[shape].lost[k];
            if (k == BY_BOUND)
                assert_int_equal(bad, 0);
            else
                assert_true(bad > 0); // each of the others fails somewhere between 1e-9 and 1e12
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cures)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
