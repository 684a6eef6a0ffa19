// SPDX-License-Identifier: MIT
// Faults that shapes once had, each by name: rays whose numbers are at the ends of the doubles, equal t,
// points where a formula divides by zero.
#include "shapes/shape.h"
#include "support/random_shape.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static bool is_good(const sag_surface *s) {
    return sag_is_finite(s->position) && sag_is_finite(s->position_error) && sag_is_finite(s->dpdu) &&
           sag_is_finite(s->dpdv) && isfinite(s->u) && isfinite(s->v) &&
           fabs(sag_length(s->geometric_normal) - 1) < 1e-9;
}

// Directions so short that t overflows: spheres, boxes and tori reported t = ∞ and a NaN for the position.
// Directions so long that the exact product t·d overflowed inside: every shape gave NaN positions.
static void hits_of_extreme_directions_have_surfaces(void **state) {
    (void)state;
    static const double lengths[] = {1e-310, 1e-300, 1e-150, 1e150, 1e300, 1e306};
    rng r = rng_make(71);
    size_t hits = 0;
    for (int i = 0; i < 6000; i++) {
        random_shape s;
        random_shape_make(&r, (sag_shape_kind)(i % SAG_SHAPE_INSTANCE), 1, &s);
        const sagi_shape_class *k = &sagi_shape_classes[s.kind];
        sag_vec3 origin = rng_vec3(&r, 2), direction = sag_normalize(sag_sub(rng_vec3(&r, 0.7), origin));
        sag_ray ray = sag_ray_make(origin, sag_scale(direction, lengths[rng_below(&r, 6)]));
        if (rng_one_in(&r, 2)) ray.t_min = -INFINITY;
        sag_hit hit, all[SAG_SHAPE_INSTANCE];
        bool found = k->hit(&s.as, &ray, &hit);
        size_t count = k->crossings(&s.as, &ray, all, 8);
        assert_int_equal(found, k->occluded(&s.as, &ray));
        assert_int_equal(found, count > 0);
        for (size_t j = 0; j < count && j < 8; j++) {
            sag_surface surface;
            k->surface(&s.as, &ray, &all[j], &surface);
            assert_true(isfinite(all[j].t) && is_good(&surface));
            hits++;
        }
    }
    assert_true(hits > 1000);
}

// A ray that touches a rim or an edge has two crossings at one t. hit must be the first of them as a scene
// orders them, by primitive; it was the one that happened to be found first.
static void hit_is_the_first_of_equal_t(void **state) {
    (void)state;
    const sag_box box = {{0, 0, 0}, {1, 1, 1}};
    const sag_cylinder cylinder = {.radius = 1, .z_max = 1, .closed = true};
    const struct {
        sag_shape_kind kind;
        const void *shape;
        sag_ray ray;
    } cases[] = {
        {SAG_SHAPE_BOX, &box, sag_ray_make((sag_vec3){1, 2, 0.5}, (sag_vec3){-1, -1, 0})},
        {SAG_SHAPE_BOX, &box, sag_ray_make((sag_vec3){-1, 0, 0.5}, (sag_vec3){1, 1, 0})},
        {SAG_SHAPE_CYLINDER, &cylinder, sag_ray_make((sag_vec3){2, 0, -1}, (sag_vec3){-1, 0, 1})},
        {SAG_SHAPE_CYLINDER, &cylinder, sag_ray_make((sag_vec3){2, 0, 1}, (sag_vec3){-1, 0, -1})},
        {SAG_SHAPE_CYLINDER, &cylinder, sag_ray_make((sag_vec3){0, 0, -1}, (sag_vec3){1, 0, 1})},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const sagi_shape_class *k = &sagi_shape_classes[cases[i].kind];
        sag_hit hit, all[4];
        assert_true(k->hit(cases[i].shape, &cases[i].ray, &hit));
        size_t count = k->crossings(cases[i].shape, &cases[i].ray, all, 4);
        assert_int_equal(count, 2);
        assert_true(hit.t == all[0].t && hit.primitive == all[0].primitive);
        if (all[0].t == all[1].t) assert_true(all[0].primitive < all[1].primitive);
    }
}

// Where the tube of a horn torus closes on the axis the normal was 0/0.
static void horn_torus_has_a_normal_at_its_middle(void **state) {
    (void)state;
    const sag_torus horn = {1, 1};
    sag_ray ray = sag_ray_make((sag_vec3){0.5, 0.25, 2}, (sag_vec3){-0.5, -0.25, -2});
    sag_hit hits[4];
    size_t count = sag_torus_crossings(&horn, &ray, hits, 4);
    for (size_t i = 0; i < count; i++) {
        sag_surface s;
        sag_torus_surface(&horn, &ray, &hits[i], &s);
        assert_true(is_good(&s));
    }
    assert_true(count > 0);
}

// From 1e12 sizes away the rounding of t is 1e-4 sizes: the point of a polygon was that far beside the ray.
static void polygon_is_met_where_the_ray_is(void **state) {
    (void)state;
    static const sag_vec3 corners[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    static const uint32_t loop[1] = {4};
    const sag_polygon square = {corners, 4, loop, 1};
    rng r = rng_make(72);
    for (int i = 0; i < 200; i++) {
        sag_vec3 target = rng_vec3(&r, 0.9), direction = rng_direction(&r);
        if (fabs(direction.z) < 0.1) continue;
        target.z = 0;
        sag_ray ray = sag_ray_make(sag_madd(target, 1e12, direction), sag_neg(direction));
        sag_hit hit;
        sag_surface s;
        if (!sag_polygon_hit(&square, &ray, &hit)) continue;
        sag_polygon_surface(&square, &ray, &hit, &s);
        long double t = -(long double)ray.origin.z / ray.direction.z;
        assert_true(fabs(s.position.x - (double)(ray.origin.x + t * ray.direction.x)) < 1e-6);
        assert_true(fabs(s.position.y - (double)(ray.origin.y + t * ray.direction.y)) < 1e-6);
    }
}

// A sample of a capsule so thin that doubles cannot tell it from its axis had the normal 0.
static void needle_capsule_has_a_normal(void **state) {
    (void)state;
    const sag_capsule needle = {{-7e28, 6e28, -6e28}, {1, 2, 3}, 1e-3};
    for (int i = 0; i < 50; i++) {
        sag_surface s;
        assert_true(sag_capsule_sample(&needle, (sag_vec2){i / 50.0, i / 51.0}, &s));
        assert_true(is_good(&s));
    }
}

// Areas whose parts over- or underflow were NaN, and so were the samples of a box without area.
static void areas_at_the_ends_of_the_doubles(void **state) {
    (void)state;
    const sag_paraboloid wide = {.radius = 1e25, .z_max = 1e-150}, tall = {.radius = 1e-170, .z_max = 1e25};
    double disk = 3.14159265358979323846 * 1e50;
    assert_true(fabs(sag_paraboloid_area(&wide) / disk - 1) < 1e-12);
    double side = 3.14159265358979323846 * 4 / 3 * 1e-145; // a parabola's arc is a line nearly
    assert_true(fabs(sag_paraboloid_area(&tall) / side - 1) < 1e-12);
    const sag_box speck = {{0, 0, 0}, {1e-200, 1e-200, 1e-200}};
    sag_surface s;
    assert_false(sag_box_sample(&speck, (sag_vec2){0.5, 0.5}, &s));
}

// A ray in a closed cone's surface, along a line from apex to base, met the base alone and never entered.
static void cone_is_left_as_often_as_entered_along_its_side(void **state) {
    (void)state;
    const sag_cone cone = {.radius = 0.5, .height = 0.5, .closed = true};
    sag_ray ray = {{-0.125, 0, 0.625}, {1, 0, -1}, -INFINITY, INFINITY, 0};
    sag_hit hits[4];
    for (int i = 0; i < 8; i++) {
        if (i == 2) ray.origin = (sag_vec3){0.125, 0, 0.375}; // on it
        if (i == 4) ray.origin = (sag_vec3){1, 0, -0.5};      // below
        if (i == 6) ray.origin = (sag_vec3){0, 0, 0.5};       // the apex
        size_t count = sag_cone_crossings(&cone, &ray, hits, 4);
        assert_true(count % 2 == 0);
        for (size_t k = 0; k < count; k++) {
            double z = ray.origin.z + hits[k].t * ray.direction.z;
            assert_true(z == (hits[k].primitive == 0 ? 0.5 : 0));
        }
        ray.direction = sag_neg(ray.direction);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hits_of_extreme_directions_have_surfaces),
        cmocka_unit_test(hit_is_the_first_of_equal_t),
        cmocka_unit_test(horn_torus_has_a_normal_at_its_middle),
        cmocka_unit_test(needle_capsule_has_a_normal),
        cmocka_unit_test(polygon_is_met_where_the_ray_is),
        cmocka_unit_test(areas_at_the_ends_of_the_doubles),
        cmocka_unit_test(cone_is_left_as_often_as_entered_along_its_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
