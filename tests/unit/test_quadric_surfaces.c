// SPDX-License-Identifier: MIT
// Surface data of the shapes of second degree, at sizes from 1e-8 to 1e8: the position is on the surface, the
// normal is the gradient, dp/du and dp/dv are what u and v do; a ray spawned at a hit starts on the side it
// should, so it never meets the surface it leaves (after pbrt's Reintersect tests).
#include "support/quadric_subjects.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
// clang-format on

#define SHAPES 300
#define RAYS   20

typedef struct situation {
    const quadric_subject *subject;
    any_quadric shape;
    quadric_truth *truth;
    double size;
    sag_ray ray;
    sag_hit hit;
    sag_surface surface;
} situation;

// Calls `check` with many hits of every kind of shape.
static void for_hits(void (*check)(const situation *, rng *)) {
    quadric_truth truth;
    quadric_truth_init(&truth);
    for (size_t k = 0; k < quadric_subject_count; k++) {
        rng r = rng_make(7 + k);
        situation s = {.subject = &quadric_subjects[k], .truth = &truth};
        for (int i = 0; i < (int)soak(SHAPES); i++) {
            s.size = rng_log_uniform(&r, 1e-8, 1e8);
            memset(&s.shape, 0, sizeof s.shape);
            s.subject->make(&r, s.size, &s.shape, &truth);
            for (int j = 0; j < RAYS; j++) {
                sag_hit hits[8];
                s.ray = quadric_subject_ray(&r, s.subject, &s.shape, s.size);
                size_t count = s.subject->crossings(&s.shape, &s.ray, hits, 8);
                if (count == 0) continue;
                s.hit = hits[rng_below(&r, (uint32_t)count)];
                s.subject->surface(&s.shape, &s.ray, &s.hit, &s.surface);
                check(&s, &r);
            }
        }
    }
    quadric_truth_clear(&truth);
}

static void explain(const situation *s, double cosine) {
    const double *q = (const double *)&s->shape;
    sag_vec3 p = s->surface.position, e = s->surface.position_error, n = s->surface.geometric_normal;
    double relative;
    int sign = quadric_truth_sign(s->truth, p, &relative);
    print_message("%s of size %g: %.17g %.17g %.17g %.17g %.17g %.17g\n", s->subject->name, s->size, q[0],
                  q[1], q[2], q[3], q[4], q[5]);
    print_message("  o %g %g %g d %g %g %g t %.17g\n", s->ray.origin.x, s->ray.origin.y, s->ray.origin.z,
                  s->ray.direction.x, s->ray.direction.y, s->ray.direction.z, s->hit.t);
    print_message("  cosine %g at %.17g %.17g %.17g ± %g %g %g, normal %g %g %g, F %d %g\n", cosine, p.x, p.y,
                  p.z, e.x, e.y, e.z, n.x, n.y, n.z, sign, relative);
}

static void check_position(const situation *s, rng *r) {
    (void)r;
    const sag_surface *f = &s->surface;
    const sag_box3 box = s->subject->bounds(&s->shape);
    sag_vec3 e = f->position_error, p = f->position;
    double reach = sag_max_component(sag_abs(s->ray.origin)) +
                   fabs(s->hit.t) * sag_max_component(sag_abs(s->ray.direction)) + s->size;
    sag_vec3 off = sag_abs(sag_sub(p, sag_ray_at(&s->ray, s->hit.t)));
    // Within the rounding of the ray's own point, which may be far off along the surface for a grazing ray.
    assert_true(sag_max_component(off) <= 1e-14 * reach);
    assert_true(e.x >= 0 && e.y >= 0 && e.z >= 0);
    double far = 1e-14 * reach;
    assert_true(p.x >= box.min.x - far && p.y >= box.min.y - far && p.z >= box.min.z - far);
    assert_true(p.x <= box.max.x + far && p.y <= box.max.y + far && p.z <= box.max.z + far);
}

static void position_is_on_the_surface(void **state) {
    (void)state;
    for_hits(check_position);
}

static void check_frame(const situation *s, rng *r) {
    (void)r;
    const sag_surface *f = &s->surface;
    sag_vec3 n = f->geometric_normal;
    assert_true(fabs(sag_length(n) - 1) < 1e-15 * 4);
    assert_memory_equal(&f->shading_normal, &n, sizeof n);
    if (f->primitive == 0) {
        sag_vec3 truth = quadric_truth_normal(s->truth, f->position);
        bool apex = strcmp(s->subject->name, "cone") == 0 && f->v > 1 - 1e-9; // see cone.c
        if (sag_length(truth) > 0 && !apex && !(sag_dot(n, truth) > 1 - 1e-13)) explain(s, sag_dot(n, truth));
        if (sag_length(truth) > 0 && !apex) assert_true(sag_dot(n, truth) > 1 - 1e-13);
    } else {
        assert_true(n.x == 0 && n.y == 0 && n.z == (f->primitive == 1 ? -1 : 1));
    }
    double du = sag_length(f->dpdu), dv = sag_length(f->dpdv);
    assert_true(du > 0 && dv > 0 && isfinite(du) && isfinite(dv));
    assert_true(fabs(sag_dot(sag_scale(f->dpdu, 1 / du), n)) < 1e-9);
    assert_true(fabs(sag_dot(sag_scale(f->dpdv, 1 / dv), n)) < 1e-9);
    assert_true(f->u >= -1e-9 && f->u <= 1 + 1e-9);
    if (!(f->v >= -1e-9 && f->v <= 1 + 1e-9)) explain(s, f->v);
    assert_true(f->v >= -1e-9 && f->v <= 1 + 1e-9);
    assert_int_equal(f->side, sag_dot(s->ray.direction, n) > 0 ? SAG_SIDE_BACK : SAG_SIDE_FRONT);
    assert_int_equal(f->primitive, s->hit.primitive);
    assert_int_equal(f->geometry, SAG_INVALID_ID);
}

static void frame_is_the_gradients(void **state) {
    (void)state;
    for_hits(check_frame);
}

// A step of a hundred-thousandth along dp/du or dp/dv, dropped onto the surface along the normal, changes u
// or v by that and the other not at all, but for terms of second order.
static void check_derivatives(const situation *s, rng *r) {
    (void)r;
    const double step = 1e-5;
    const sag_surface *f = &s->surface;
    if (strcmp(s->subject->name, "quadric") == 0 && hypot(f->position.x, f->position.y) < 1e-3 * s->size)
        return;
    if (f->u < 0.02 || f->u > 0.98 || f->v < 0.02 || f->v > 0.98) return;
    for (int k = 0; k < 2; k++) {
        sag_vec3 along = k == 0 ? f->dpdu : f->dpdv, to = sag_madd(f->position, step, along);
        if (sag_length(along) < 1e-3 * s->size || sag_length(along) > 8 * s->size) continue;
        if (fabs(sag_length(along) - 1) < 1e-14)
            continue; // a frame in place of derivatives that do not exist
        sag_ray drop = sag_ray_make(to, f->geometric_normal);
        drop.t_min = -1e-2 * s->size, drop.t_max = 1e-2 * s->size;
        sag_hit hits[8];
        sag_surface g;
        size_t count = s->subject->crossings(&s->shape, &drop, hits, 8);
        for (size_t i = 0; i < count && i < 8; i++) {
            if (fabs(hits[i].t) > 10 * step * sag_length(along) || hits[i].primitive != f->primitive)
                continue;
            s->subject->surface(&s->shape, &drop, &hits[i], &g);
            double bend = 1 - sag_dot(g.geometric_normal, f->geometric_normal);
            if (bend > 1e-6) continue; // sharply curved: no difference quotient
            double du = g.u - f->u, dv = g.v - f->v;
            if (fabs(du) > 0.2) continue; // over the axis or the seam
            double error = fabs(du - (k == 0 ? step : 0)) + fabs(dv - (k == 1 ? step : 0));
            if (error > 0.1 * step) explain(s, bend);
            if (error > 0.1 * step)
                print_message("%s prim %u: d%s = %g: du %g dv %g\n", s->subject->name, f->primitive,
                              k ? "v" : "u", step, du, dv);
            assert_true(error <= 0.1 * step);
        }
    }
}

static void derivatives_are_what_u_and_v_do(void **state) {
    (void)state;
    for_hits(check_derivatives);
}

static bool is_convex(const char *name) {
    return strcmp(name, "sphere") == 0 || strcmp(name, "ellipsoid") == 0 || strcmp(name, "cylinder") == 0 ||
           strcmp(name, "cone") == 0 || strcmp(name, "paraboloid") == 0;
}

static void check_spawned(const situation *s, rng *r) {
    const sag_surface *f = &s->surface;
    sag_vec3 gradient = quadric_truth_normal(s->truth, f->position);
    double relative;
    quadric_truth_sign(s->truth, f->position, &relative);
    // An apex, a crease or a double plane has no two sides.
    if (strcmp(s->subject->name, "quadric") == 0 && (sag_length(gradient) == 0 || relative > 0.1)) return;
    for (int i = 0; i < 4; i++) {
        sag_vec3 w = rng_direction(r), n = f->geometric_normal;
        if (i == 3)
            w = sag_madd(sag_normalize(sag_cross(n, w)), rng_double(r, -55, -5), n); // along the surface
        double cosine = sag_dot(w, n);
        if (cosine == 0) continue;
        sag_ray spawned = sag_spawn_ray(f, w);
        if (f->primitive == 0 && f->v < 1 - 1e-9) { // beyond a cone's apex F is negative again
            int sign = quadric_truth_sign(s->truth, spawned.origin, NULL);
            if (sign != (cosine > 0 ? 1 : -1)) explain(s, cosine);
            assert_int_equal(sign, cosine > 0 ? 1 : -1);
        }
        sag_hit hits[8];
        size_t count = s->subject->crossings(&s->shape, &spawned, hits, 8);
        if (is_convex(s->subject->name) && cosine > 0) {
            // Open ones are met again only on the inside, by rays that come around the rim: not from outside.
            if (count != 0)
                explain(s, cosine),
                    print_message("%s: met again at %g %u\n  o %.17g %.17g %.17g d %.17g %.17g %.17g\n",
                                  s->subject->name, hits[0].t, hits[0].primitive, spawned.origin.x,
                                  spawned.origin.y, spawned.origin.z, w.x, w.y, w.z);
            assert_int_equal(count, 0);
        }
        // At a rim, or the apex, either side may be out.
        if (!s->truth->closed || f->v < 1e-9 || f->v > 1 - 1e-9) continue;
        if (count % 2 != (cosine < 0)) explain(s, cosine);
        assert_int_equal(count % 2, cosine > 0 ? 0 : 1);
    }
}

static void spawned_rays_leave(void **state) {
    (void)state;
    for_hits(check_spawned);
}

static void check_sample(const situation *s, rng *r) {
    sag_surface f;
    if (!s->subject->sample(&s->shape, rng_vec2(r), &f)) {
        assert_string_equal(s->subject->name, "quadric"); // a patch too small for its box
        return;
    }
    // A ray at the point from either side meets it there.
    sag_ray at =
        sag_ray_make(sag_madd(f.position, 1e-3 * s->size, f.geometric_normal), sag_neg(f.geometric_normal));
    sag_hit hits[8];
    size_t count = s->subject->crossings(&s->shape, &at, hits, 8);
    double nearest = INFINITY;
    for (size_t i = 0; i < count; i++) nearest = fmin(nearest, fabs(hits[i].t - 1e-3 * s->size));
    bool edge = f.u < 1e-6 || f.u > 1 - 1e-6 || f.v < 1e-6 || f.v > 1 - 1e-6;
    if (!(edge || nearest < 1e-9 * s->size)) {
        situation c = *s;
        c.surface = f;
        explain(&c, nearest);
        print_message("u %g v %g\n", f.u, f.v);
    }
    assert_true(edge || nearest < 1e-9 * s->size);
    assert_int_equal(f.side, SAG_SIDE_FRONT);
    assert_true(fabs(sag_length(f.geometric_normal) - 1) < 1e-14);
}

static void samples_are_on_the_surface(void **state) {
    (void)state;
    for_hits(check_sample);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(position_is_on_the_surface),      cmocka_unit_test(frame_is_the_gradients),
        cmocka_unit_test(derivatives_are_what_u_and_v_do), cmocka_unit_test(spawned_rays_leave),
        cmocka_unit_test(samples_are_on_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
