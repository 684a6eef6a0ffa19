// SPDX-License-Identifier: MIT
// The user-defined shape: a row of unit balls made by callbacks beside the library's own spheres.
#include "support/shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define COUNT 200

typedef struct balls {
    bool backwards; // report in the opposite order
    bool noisy;     // report rubbish as well
} balls;

static sag_sphere ball(uint32_t i) { return (sag_sphere){.center = {3.0 * i, 0, 0}, .radius = 1}; }

static sag_box3 ball_bounds(void *user, uint32_t i) {
    (void)user;
    if (i == 7) return sag_box3_empty(); // dropped
    if (i == 8) return (sag_box3){{NAN, 0, 0}, {1, 1, 1}};
    sag_sphere s = ball(i);
    return sag_sphere_bounds(&s);
}

static void ball_crossings(void *user, const uint32_t *primitives, size_t count, const sag_ray *ray,
                           sag_user_report *report) {
    const balls *b = user;
    sag_ray line = *ray;
    line.t_min = -INFINITY, line.t_max = INFINITY; // the library drops what is out of range
    for (size_t k = 0; k < count; k++) {
        uint32_t i = primitives[b->backwards ? count - 1 - k : k];
        sag_sphere s = ball(i);
        sag_hit hits[2];
        size_t n = sag_sphere_crossings(&s, &line, hits, 2);
        for (size_t j = 0; j < n; j++) sag_user_report_hit(report, i, hits[n - 1 - j].t, 0.25, 0.5);
        if (b->noisy)
            sag_user_report_hit(report, i, NAN, 0, 0), sag_user_report_hit(report, i, INFINITY, 0, 0);
    }
}

static void ball_surface(void *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    (void)user;
    sag_sphere s = ball(hit->primitive);
    sag_sphere_surface(&s, ray, hit, surface);
}

static void same_as_spheres(void **state) {
    (void)state;
    balls plain = {0}, odd = {true, true};
    sag_user a = {COUNT, &plain, ball_bounds, ball_crossings, ball_surface}, b = a;
    b.user = &odd;
    assert_int_equal(sag_user_validate(&a, NULL), SAG_OK);
    sag_box3 box = sag_user_bounds(&a);
    assert_true(box.min.x <= -1 && box.max.x >= 3 * (COUNT - 1) + 1);
    rng r = rng_make(51);
    for (int i = 0; i < 300; i++) {
        sag_vec3 o = {rng_uniform(&r, -10, 610), rng_uniform(&r, -2, 2), rng_uniform(&r, -2, 2)};
        sag_ray ray = sag_ray_make(o, (sag_vec3){rng_uniform(&r, -1, 1), rng_uniform(&r, -0.01, 0.01),
                                                 rng_uniform(&r, -0.01, 0.01)});
        sag_hit all[2 * COUNT], first[3], hit;
        size_t count = 0;
        for (uint32_t k = 0; k < COUNT; k++) {
            sag_sphere s = ball(k);
            if (k != 7 && k != 8) count += sag_sphere_crossings(&s, &ray, NULL, 0);
        }
        assert_int_equal(sag_user_crossings(&a, &ray, all, 2 * COUNT), count);
        for (size_t k = 1; k < count; k++) assert_true(all[k - 1].t <= all[k].t);
        assert_int_equal(sag_user_crossings(&b, &ray, first, 3), count);
        for (size_t k = 0; k < count && k < 3; k++)
            assert_true(first[k].t == all[k].t && first[k].primitive == all[k].primitive &&
                        first[k].v == 0.5);
        assert_int_equal(sag_user_hit(&b, &ray, &hit), count > 0);
        assert_int_equal(sag_user_occluded(&a, &ray), count > 0);
        if (count == 0) continue;
        assert_true(hit.t == all[0].t && hit.primitive == all[0].primitive);
        sag_surface s;
        sag_user_surface(&a, &ray, &hit, &s);
        assert_true(s.geometry == SAG_INVALID_ID && s.primitive == hit.primitive);
    }
}

// Equal t: the lower primitive, whatever the order of the reports.
static sag_box3 unit_bounds(void *user, uint32_t i) {
    (void)user, (void)i;
    return (sag_box3){{0, 0, 0}, {1, 1, 1}};
}
static void tied_crossings(void *user, const uint32_t *primitives, size_t count, const sag_ray *ray,
                           sag_user_report *report) {
    (void)ray;
    const bool *backwards = user;
    for (size_t k = 0; k < count; k++) {
        double limit = sag_user_report_hit(report, primitives[*backwards ? count - 1 - k : k], 2, 0, 0);
        assert_true(limit <= ray->t_max);
    }
}
static void bare_surface(void *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    (void)user, (void)hit;
    surface->position = sag_ray_at(ray, 2);
    surface->geometric_normal = (sag_vec3){0, 3, 0};
}

static void ties_and_defaults(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        bool backwards = i == 1;
        sag_user user = {5, &backwards, unit_bounds, tied_crossings, bare_surface};
        sag_ray ray = sag_ray_make((sag_vec3){0, 4, 1}, (sag_vec3){0, -1, 0});
        sag_hit hit, hits[4];
        assert_true(sag_user_hit(&user, &ray, &hit));
        assert_int_equal(hit.primitive, 0);
        assert_int_equal(sag_user_crossings(&user, &ray, hits, 4), 5);
        for (uint32_t k = 0; k < 4; k++) assert_int_equal(hits[k].primitive, k);
        sag_surface s;
        sag_user_surface(&user, &ray, &hit, &s);
        assert_true(s.position_error.y == 0x1p-48 * 2 && s.geometric_normal.y == 1 &&
                    s.shading_normal.y == 1);
        assert_true(s.side == SAG_SIDE_FRONT && sag_length(s.dpdu) > 0);
        ray.t_max = 1;
        assert_false(sag_user_hit(&user, &ray, &hit));
        assert_true(sag_user_area(&user) == 0 && !sag_user_sample(&user, (sag_vec2){0, 0}, &s));
    }
}

static void messages(void **state) {
    (void)state;
    sag_error error;
    sag_user user = {1, NULL, unit_bounds, NULL, bare_surface};
    assert_int_equal(sag_user_validate(&user, &error), SAG_ERROR_GEOMETRY);
    assert_string_equal(error.message, "user: crossings is NULL");
    sag_ray ray = sag_ray_make((sag_vec3){0, 4, 1}, (sag_vec3){0, -1, 0});
    assert_false(sag_user_occluded(&user, &ray));
    sag_box3 box = sag_user_bounds(&user);
    assert_true(sag_box3_is_empty(&box));
    bool backwards = false;
    sag_user good = {5, &backwards, unit_bounds, tied_crossings, bare_surface};
    shape_case c = {&sagi_shape_classes[SAG_SHAPE_USER], &good, {0, 0, 0}, 1, LEAVING_ANY};
    check_bad_rays(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_as_spheres),
        cmocka_unit_test(ties_and_defaults),
        cmocka_unit_test(messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
