// SPDX-License-Identifier: MIT
// Every crossing of the surfaces of second degree against the roots by MPFR, at sizes from 1e-9 to 1e9: rays
// from inside, near, far (to 1e9 sizes away), from the surface, grazing, along axes, with directions of any
// length. Prints the largest error of t for each shape.
#include "support/quadric_subjects.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
// clang-format on

#define RAYS_PER_SHAPE 25

static void explain(const quadric_subject *subject, const any_quadric *shape, const sag_ray *ray,
                    const expected *e, const sag_hit *hits, size_t count) {
    const double *numbers = (const double *)shape;
    print_message("%s:", subject->name);
    for (size_t i = 0; i < 14 && i * sizeof(double) < sizeof *shape; i++) print_message(" %.17g", numbers[i]);
    print_message("\n o %.17g %.17g %.17g d %.17g %.17g %.17g t %.17g %.17g\n expected", ray->origin.x,
                  ray->origin.y, ray->origin.z, ray->direction.x, ray->direction.y, ray->direction.z,
                  ray->t_min, ray->t_max);
    for (int i = 0; i < e->count; i++) print_message(" %.17g%s", e->t[i], e->optional[i] ? "?" : "");
    print_message("\n got     ");
    for (size_t i = 0; i < count; i++) print_message(" %.17g", hits[i].t);
    print_message("\n");
}

// The largest error in ulp of hits[next…] as the crossings expected from number i on, in the way that is
// kindest to the optional ones; INFINITY when there is no way.
static double compare(const expected *e, int i, const sag_hit *hits, size_t next, size_t count) {
    if (i == e->count) return next == count ? 0 : INFINITY;
    double skipped = e->optional[i] ? compare(e, i + 1, hits, next, count) : INFINITY;
    if (next == count) return skipped;
    return fmin(skipped, fmax(ulps_between(hits[next].t, e->t[i]), compare(e, i + 1, hits, next + 1, count)));
}

static void check_subject(const quadric_subject *subject) {
    rng r = rng_make(20260101 + (uint64_t)subject->name[0]);
    quadric_truth truth;
    quadric_truth_init(&truth);
    size_t rays = soak(1000000), found = 0, wrong = 0;
    double worst = 0;
    for (size_t i = 0; i < rays; i += RAYS_PER_SHAPE) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        any_quadric shape;
        sag_error error;
        memset(&shape, 0, sizeof shape);
        subject->make(&r, size, &shape, &truth);
        if (subject->validate(&shape, &error) != SAG_OK) fail_msg("%s", error.message);
        for (int k = 0; k < RAYS_PER_SHAPE; k++) {
            sag_ray ray = quadric_subject_ray(&r, subject, &shape, size);
            expected e = quadric_truth_solve(&truth, &ray);
            sag_hit hits[8], first = {0};
            size_t count = subject->crossings(&shape, &ray, hits, 8);
            bool hit = subject->hit(&shape, &ray, &first);
            double ulps = compare(&e, 0, hits, 0, count);
            bool agree = hit == (count > 0) && subject->occluded(&shape, &ray) == hit &&
                         (!hit || (first.t == hits[0].t && first.primitive == hits[0].primitive));
            if (!(ulps <= 4) || !agree) {
                if (wrong++ < 5) explain(subject, &shape, &ray, &e, hits, count);
            }
            if (ulps > worst && isfinite(ulps)) worst = ulps;
            found += count;
        }
    }
    quadric_truth_clear(&truth);
    print_message("%-14s %8zu rays %8zu crossings, largest error of t %.2f ulp\n", subject->name, rays, found,
                  worst);
    assert_int_equal(wrong, 0);
}

static void crossings_are_the_roots(void **state) {
    (void)state;
    for (size_t i = 0; i < quadric_subject_count; i++) check_subject(&quadric_subjects[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(crossings_are_the_roots)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
