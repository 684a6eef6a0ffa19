// SPDX-License-Identifier: MIT
// Shapes that do not pass validate: rays miss them, boxes are empty, nothing is sampled, nothing crashes or
// hangs; whatever numbers stand in their fields. Of the shapes that are plain numbers.
#include "shapes/shape.h"
#include "support/random.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const sag_shape_kind kinds[] = {SAG_SHAPE_PLANE,       SAG_SHAPE_DISK,          SAG_SHAPE_RECTANGLE,
                                       SAG_SHAPE_BOX,         SAG_SHAPE_ORIENTED_BOX,  SAG_SHAPE_CAPSULE,
                                       SAG_SHAPE_TORUS,       SAG_SHAPE_SPHERE,        SAG_SHAPE_ELLIPSOID,
                                       SAG_SHAPE_CYLINDER,    SAG_SHAPE_CONE,          SAG_SHAPE_PARABOLOID,
                                       SAG_SHAPE_HYPERBOLOID, SAG_SHAPE_HYPERBOLOID2,  SAG_SHAPE_QUADRIC,
                                       SAG_SHAPE_TRIANGLE,    SAG_SHAPE_BILINEAR_PATCH};
static double odd_number(rng *r) {
    static const double odd[] = {0,     -0.0,   1,      -1,     NAN, INFINITY, -INFINITY, 0x1p101,
                                 1e308, -1e308, 5e-324, 1e-310, 0.5, 2,        3};
    return rng_one_in(r, 3) ? rng_uniform(r, -2, 2) : odd[rng_below(r, sizeof odd / sizeof *odd)];
}

// Whether the struct ends in a bool: closed, one_sided.
static bool ends_in_bool(sag_shape_kind kind) {
    return kind == SAG_SHAPE_CYLINDER || kind == SAG_SHAPE_CONE || kind == SAG_SHAPE_PARABOLOID ||
           kind == SAG_SHAPE_HYPERBOLOID || kind == SAG_SHAPE_HYPERBOLOID2 || kind == SAG_SHAPE_TRIANGLE;
}

static void invalid_shapes_are_missed(void **state) {
    (void)state;
    rng r = rng_make(61);
    size_t invalid = 0;
    for (int i = 0; i < 60000; i++) {
        sag_shape_kind kind = kinds[(size_t)i % (sizeof kinds / sizeof *kinds)];
        const sagi_shape_class *k = &sagi_shape_classes[kind];
        double numbers[16];
        for (size_t j = 0; j < k->struct_bytes / sizeof(double); j++)
            numbers[j] = rng_one_in(&r, 4) ? odd_number(&r) : rng_uniform(&r, 0.5, 2);
        bool flag = rng_one_in(&r, 2);
        if (ends_in_bool(kind)) memcpy(&numbers[k->struct_bytes / sizeof(double) - 1], &flag, sizeof flag);
        sag_ray ray = sag_ray_make(rng_vec3(&r, 3), rng_direction(&r));
        if (rng_one_in(&r, 4)) ray.origin.x = odd_number(&r), ray.direction.y = odd_number(&r);
        sag_hit hit;
        sag_surface s;
        bool found = k->hit(numbers, &ray, &hit);
        sag_box3 box = k->bounds(numbers);
        bool sampled = k->sample(numbers, (sag_vec2){rng_unit(&r), rng_unit(&r)}, &s);
        if (k->closest_point) k->closest_point(numbers, ray.origin);
        bool inside = k->contains && k->contains(numbers, ray.origin);
        double area = k->area(numbers), volume = k->volume ? k->volume(numbers) : 0;
        assert_true(area >= 0 && volume >= 0);
        if (found) k->surface(numbers, &ray, &hit, &s);
        sag_error error;
        if (k->validate(numbers, &error) == SAG_OK) {
            assert_false(sag_box3_is_empty(&box));
            continue;
        }
        invalid++;
        assert_true(strlen(error.message) > 10 && strncmp(error.message, k->name, strlen(k->name)) == 0);
        if (found || !sag_box3_is_empty(&box) || sampled)
            print_message("%s: %s %d %d %d\n", k->name, error.message, found, !sag_box3_is_empty(&box),
                          sampled);
        assert_false(found);
        assert_true(sag_box3_is_empty(&box));
        assert_false(sampled || inside);
        assert_true(area == 0 && volume == 0);
    }
    assert_true(invalid > 10000);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(invalid_shapes_are_missed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
