// SPDX-License-Identifier: MIT
// The quick way to the first crossing of closed quadrics says what the shape's own verb says, to the bit, or
// that it does not know; and it mostly knows.
#include "shapes/outline.h"
#include "support/random.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

typedef struct subject {
    sag_shape_kind kind;
    union {
        sag_cylinder cylinder;
        sag_cone cone;
        sag_paraboloid paraboloid;
        sag_hyperboloid hyperboloid;
        sag_ellipsoid ellipsoid;
    } shape;
    double size;
} subject;

static const sag_shape_kind kinds[] = {SAG_SHAPE_CYLINDER, SAG_SHAPE_CONE, SAG_SHAPE_PARABOLOID,
                                       SAG_SHAPE_HYPERBOLOID, SAG_SHAPE_ELLIPSOID};

static subject make(rng *r, sag_shape_kind kind) {
    subject s = {.kind = kind, .size = rng_one_in(r, 2) ? 1 : rng_log_uniform(r, 1e-9, 1e9)};
    const double a = s.size * rng_log_uniform(r, 0.1, 1), b = s.size * rng_log_uniform(r, 0.1, 1);
    const double low = s.size * rng_uniform(r, -1, 0), high = s.size * rng_uniform(r, 0.1, 1);
    if (kind == SAG_SHAPE_CYLINDER)
        s.shape.cylinder = (sag_cylinder){.radius = a, .z_min = low, .z_max = high, .closed = true};
    else if (kind == SAG_SHAPE_CONE)
        s.shape.cone = (sag_cone){.radius = a, .height = b, .closed = true};
    else if (kind == SAG_SHAPE_PARABOLOID)
        s.shape.paraboloid = (sag_paraboloid){
            .radius = a, .z_min = rng_one_in(r, 2) ? 0 : high / 3, .z_max = high, .closed = true};
    else if (kind == SAG_SHAPE_HYPERBOLOID)
        s.shape.hyperboloid = (sag_hyperboloid){
            .p1 = {a, -b, low}, .p2 = {rng_one_in(r, 2) ? a : 0.3 * a, b, high}, .closed = true};
    else
        s.shape.ellipsoid = (sag_ellipsoid){rng_vec3(r, s.size), {a, b, high}};
    return s;
}

static bool hit_by_verb(const subject *s, const sag_ray *ray, sag_hit *hit) {
    const void *shape = &s->shape;
    if (s->kind == SAG_SHAPE_CYLINDER) return sag_cylinder_hit(shape, ray, hit);
    if (s->kind == SAG_SHAPE_CONE) return sag_cone_hit(shape, ray, hit);
    if (s->kind == SAG_SHAPE_PARABOLOID) return sag_paraboloid_hit(shape, ray, hit);
    if (s->kind == SAG_SHAPE_HYPERBOLOID) return sag_hyperboloid_hit(shape, ray, hit);
    return sag_ellipsoid_hit(shape, ray, hit);
}

static sag_ray random_ray(rng *r, const subject *s) {
    sag_ray ray = sag_ray_make(rng_vec3(r, s->size * 2), rng_direction(r));
    if (rng_one_in(r, 4)) ray.origin = rng_vec3(r, s->size * rng_log_uniform(r, 1, 1e6));
    if (!rng_one_in(r, 4)) ray.direction = sag_sub(rng_vec3(r, s->size), ray.origin);
    if (rng_one_in(r, 16)) ray.direction.z = 0;
    if (rng_one_in(r, 16)) ray.direction.x = ray.direction.y = 0;
    if (rng_one_in(r, 16)) ray.origin = rng_vec3(r, s->size * 0.3); // inside, often
    return ray;
}

static void quick_way_is_the_verb(void **state) {
    (void)state;
    rng r = rng_make(91);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        size_t known = 0, hits = 0, misses = 0, asked = 0;
        for (size_t n = 0, end = soak(2000); n < end; n++) {
            const subject s = make(&r, kinds[k]);
            sagi_outline outline;
            if (!sagi_shape_outline(s.kind, &s.shape, &outline)) continue; // not of the usual size
            for (int i = 0; i < 20; i++) {
                sag_ray ray = random_ray(&r, &s);
                sag_hit hit;
                // The range may begin or end at a crossing, or next to it.
                if (rng_one_in(&r, 2) && hit_by_verb(&s, &ray, &hit)) {
                    const double t =
                        rng_one_in(&r, 2)
                            ? hit.t
                            : hit.t * (1 + rng_uniform(&r, -1, 1) * rng_log_uniform(&r, 1e-16, 1));
                    if (rng_one_in(&r, 2) && t > 0)
                        ray.t_max = t;
                    else
                        ray.t_min = t;
                }
                double t = NAN;
                uint32_t primitive = 9;
                if (!sag_ray_is_valid(&ray)) continue;
                asked++;
                const sagi_first first = sagi_outline_first(&outline, &ray, &t, &primitive);
                const bool met = hit_by_verb(&s, &ray, &hit);
                known += first != SAGI_FIRST_UNKNOWN;
                if (first == SAGI_FIRST_NONE) assert_false(met), misses++;
                if (first != SAGI_FIRST_HIT) continue;
                hits++;
                assert_true(met && hit.t == t && hit.primitive == primitive);
            }
        }
        assert_true(known > asked / 4 && hits > asked / 20 && misses > asked / 20);
    }
}

static void others_have_none(void **state) {
    (void)state;
    sagi_outline outline;
    const sag_cylinder open = {.radius = 1, .z_min = 0, .z_max = 1};
    const sag_hyperboloid ring = {.p1 = {1, 0, 0}, .p2 = {2, 0, 0}};
    const sag_sphere ball = {.radius = 1};
    const sag_ellipsoid tiny = {.radii = {1e-300, 1e-300, 1e-300}};
    assert_false(sagi_shape_outline(SAG_SHAPE_CYLINDER, &open, &outline));
    assert_false(sagi_shape_outline(SAG_SHAPE_HYPERBOLOID, &ring, &outline));
    assert_false(sagi_shape_outline(SAG_SHAPE_SPHERE, &ball, &outline));
    assert_false(sagi_shape_outline(SAG_SHAPE_ELLIPSOID, &tiny, &outline));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(quick_way_is_the_verb),
                                       cmocka_unit_test(others_have_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
