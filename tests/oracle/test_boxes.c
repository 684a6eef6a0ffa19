// SPDX-License-Identifier: MIT
// Plane and axis-aligned box against exact fractions (GMP): whether they are hit, and where, at sizes from
// 1e-9 to 1e9. A million rays each. Most are settled by 64-bit significands with a certain margin, so that
// the fractions are left with the hard ones.
#include "support/adversarial.h"
#include "support/crossing_truth.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

typedef struct tally {
    size_t rays, crossings, by_fractions, wrong;
    double worst;
} tally;

static void take(tally *t, const crossing_truth *truth, const sag_hit *hits, size_t count,
                 const sag_ray *ray) {
    double ulps = crossing_truth_compare(truth, hits, count);
    t->rays++, t->crossings += count;
    if (!(ulps <= 4) && t->wrong++ < 5)
        print_message("ray %a %a %a  %a %a %a  [%a, %a]: %zu found, %d expected\n", ray->origin.x,
                      ray->origin.y, ray->origin.z, ray->direction.x, ray->direction.y, ray->direction.z,
                      ray->t_min, ray->t_max, count, truth->count);
    if (ulps > t->worst && isfinite(ulps)) t->worst = ulps;
}

static void report(const char *name, const tally *t) {
    print_message(
        "%s: %zu rays, %zu crossings, %zu by fractions, wrong decisions %zu, largest error of t %.2f ulp\n",
        name, t->rays, t->crossings, t->by_fractions, t->wrong, t->worst);
    assert_int_equal(t->wrong, 0);
    assert_true(t->worst <= 4);
}

// With 64 bits: false when the entry and exit are too close to tell.
static bool box_quickly(const sag_box *box, const sag_ray *ray, crossing_truth *truth) {
    long double enter = -INFINITY, leave = INFINITY;
    for (int i = 0; i < 3; i++) {
        long double o = sag_component(ray->origin, i), d = sag_component(ray->direction, i);
        long double lo = sag_component(box->min, i), hi = sag_component(box->max, i);
        if (d == 0 && (o < lo || o > hi)) return true;
        if (d == 0) continue;
        long double a = (lo - o) / d, b = (hi - o) / d;
        enter = fmaxl(enter, fminl(a, b)), leave = fminl(leave, fmaxl(a, b));
    }
    if (fabsl(enter - leave) <= 0x1p-60L * (fabsl(enter) + fabsl(leave)) + 0x1p-1000L) return false;
    if (enter > leave) return true;
    crossing_truth_add(truth, ray, enter);
    crossing_truth_add(truth, ray, leave);
    return true;
}

static void set_fraction(mpq_t t, double face, double o, double d) {
    mpq_t x;
    mpq_init(x);
    mpq_set_d(t, face), mpq_set_d(x, o), mpq_sub(t, t, x);
    mpq_set_d(x, d), mpq_div(t, t, x);
    mpq_clear(x);
}

static void box_by_fractions(const sag_box *box, const sag_ray *ray, crossing_truth *truth) {
    mpq_t enter, leave, a, b;
    mpq_inits(enter, leave, a, b, NULL);
    bool first = true, outside = false;
    for (int i = 0; i < 3; i++) {
        double o = sag_component(ray->origin, i), d = sag_component(ray->direction, i);
        double lo = sag_component(box->min, i), hi = sag_component(box->max, i);
        if (d == 0) {
            outside |= o < lo || o > hi;
            continue;
        }
        set_fraction(a, d > 0 ? lo : hi, o, d), set_fraction(b, d > 0 ? hi : lo, o, d);
        if (first || mpq_cmp(a, enter) > 0) mpq_set(enter, a);
        if (first || mpq_cmp(b, leave) < 0) mpq_set(leave, b);
        first = false;
    }
    if (!outside && mpq_cmp(enter, leave) <= 0) {
        crossing_truth_add_fraction(truth, ray, enter);
        crossing_truth_add_fraction(truth, ray, leave);
    }
    mpq_clears(enter, leave, a, b, NULL);
}

static void boxes(void **state) {
    (void)state;
    rng r = rng_make(201);
    tally t = {0};
    size_t rays = soak(1000000);
    for (size_t i = 0; i < rays; i += 25) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 a = rng_vec3(&r, size), b = rng_vec3(&r, size), points[8];
        if (rng_one_in(&r, 4)) a = (sag_vec3){-size, -size, -size}, b = (sag_vec3){size, size, size};
        if (rng_one_in(&r, 8)) a.y = b.y * (1 + 0x1p-40); // a thin one
        sag_box box = {{fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)},
                       {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)}};
        assert_int_equal(sag_box_validate(&box, NULL), SAG_OK);
        for (int k = 0; k < 8; k++)
            points[k] = (sag_vec3){k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                                   k & 4 ? box.max.z : box.min.z};
        adversary hard = {{0, 0, 0}, size, points, 8};
        for (int k = 0; k < 25; k++) {
            sag_ray ray = adversarial_ray(&r, &hard);
            crossing_truth truth = {0};
            if (!box_quickly(&box, &ray, &truth)) box_by_fractions(&box, &ray, &truth), t.by_fractions++;
            sag_hit hits[4];
            take(&t, &truth, hits, sag_box_crossings(&box, &ray, hits, 4), &ray);
        }
    }
    report("box", &t);
}

static bool plane_quickly(const sag_plane *plane, const sag_ray *ray, crossing_truth *truth) {
    long double num = 0, num_size = 0, den = 0, den_size = 0;
    for (int i = 0; i < 3; i++) {
        long double n = sag_component(plane->normal, i);
        long double w = (long double)sag_component(plane->point, i) - sag_component(ray->origin, i);
        num += n * w, num_size += fabsl(n * w);
        den += n * sag_component(ray->direction, i), den_size += fabsl(n * sag_component(ray->direction, i));
    }
    if (!(fabsl(num) > 0x1p-3L * num_size && fabsl(den) > 0x1p-3L * den_size)) return false;
    crossing_truth_add(truth, ray, num / den);
    return true;
}

static void plane_by_fractions(const sag_plane *plane, const sag_ray *ray, crossing_truth *truth) {
    mpq_t num, den, x, y;
    mpq_inits(num, den, x, y, NULL);
    for (int i = 0; i < 3; i++) {
        mpq_set_d(x, sag_component(plane->point, i)), mpq_set_d(y, sag_component(ray->origin, i));
        mpq_sub(x, x, y);
        mpq_set_d(y, sag_component(plane->normal, i));
        mpq_mul(x, x, y), mpq_add(num, num, x);
        mpq_set_d(x, sag_component(ray->direction, i));
        mpq_mul(x, x, y), mpq_add(den, den, x);
    }
    if (mpq_sgn(den) != 0) {
        mpq_div(num, num, den);
        crossing_truth_add_fraction(truth, ray, num);
    }
    mpq_clears(num, den, x, y, NULL);
}

static void planes(void **state) {
    (void)state;
    rng r = rng_make(202);
    tally t = {0};
    size_t rays = soak(1000000);
    for (size_t i = 0; i < rays; i += 25) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 s = rng_vec3(&r, 1), v = rng_vec3(&r, 1), point = rng_vec3(&r, size), points[4];
        if (rng_one_in(&r, 4)) s = (sag_vec3){1, 0, 0}, v = (sag_vec3){0, 1, -1};
        sag_plane plane = {.point = point,
                           .normal = sag_scale(sag_cross(s, v), rng_log_uniform(&r, 1e-9, 1e9))};
        // Points (nearly) in the plane: rays between them run (nearly) along it.
        points[0] = point;
        for (int k = 1; k < 4; k++)
            points[k] =
                sag_madd(sag_madd(point, rng_uniform(&r, -size, size), s), rng_uniform(&r, -size, size), v);
        adversary hard = {point, size, points, 4};
        for (int k = 0; k < 25; k++) {
            sag_ray ray = adversarial_ray(&r, &hard);
            crossing_truth truth = {0};
            if (!plane_quickly(&plane, &ray, &truth))
                plane_by_fractions(&plane, &ray, &truth), t.by_fractions++;
            sag_hit hits[4];
            take(&t, &truth, hits, sag_plane_crossings(&plane, &ray, hits, 4), &ray);
        }
    }
    report("plane", &t);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(boxes), cmocka_unit_test(planes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
