// SPDX-License-Identifier: MIT
#include "shape_properties.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define MOST_CROSSINGS 16

static sag_vec3 in_ball(rng *r, const shape_case *c, double radii) {
    return sag_madd(c->center, radii * c->radius * cbrt(rng_unit(r)), rng_direction(r));
}

sag_ray shape_random_ray(rng *r, const shape_case *c) {
    double far = rng_one_in(r, 8) ? rng_log_uniform(r, 1, 1e6) : 2;
    sag_vec3 origin = in_ball(r, c, far), target = in_ball(r, c, 1);
    sag_vec3 direction = sag_sub(target, origin);
    if (rng_one_in(r, 8)) { // along an axis
        sag_vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        uint32_t axis = rng_below(r, 3);
        double offset = rng_uniform(r, -3, 3) * c->radius;
        direction = sag_scale(axes[axis], rng_one_in(r, 2) ? -1 : 1);
        origin = sag_madd(target, offset, direction);
    }
    if (rng_one_in(r, 8)) direction = sag_scale(direction, rng_log_uniform(r, 1e-20, 1e20));
    sag_ray ray = sag_ray_make(origin, direction);
    if (rng_one_in(r, 4)) ray.t_min = -INFINITY;
    if (rng_one_in(r, 8)) ray.t_min = rng_unit(r) / sag_length(direction), ray.t_max = ray.t_min * 3;
    return ray;
}

static bool same_hit(const sag_hit *a, const sag_hit *b) {
    return a->t == b->t && a->u == b->u && a->v == b->v && a->primitive == b->primitive;
}

static void check_verbs_of(const shape_case *c, const sag_ray *ray) {
    const sagi_shape_class *k = c->kind;
    sag_hit all[MOST_CROSSINGS], hit, one;
    size_t count = k->crossings(c->shape, ray, all, MOST_CROSSINGS);
    assert_true(count <= MOST_CROSSINGS);
    bool is_hit = k->hit(c->shape, ray, &hit);
    assert_int_equal(is_hit, count > 0);
    assert_int_equal(k->occluded(c->shape, ray), count > 0);
    assert_int_equal(k->crossings(c->shape, ray, NULL, 0), count);
    if (count == 0) return;
    assert_true(same_hit(&hit, &all[0]));
    assert_int_equal(k->crossings(c->shape, ray, &one, 1), count);
    assert_true(same_hit(&one, &all[0]));
    for (size_t i = 0; i < count; i++) {
        assert_true(all[i].t >= ray->t_min && all[i].t <= ray->t_max);
        assert_int_equal(all[i].geometry, SAG_INVALID_ID);
        assert_int_equal(all[i].instance_depth, 0);
        if (i > 0) assert_true(all[i].t >= all[i - 1].t);
        // A range that starts at a crossing has it, one that starts beyond has the next.
        sag_ray part = *ray;
        part.t_min = all[i].t;
        assert_true(k->hit(c->shape, &part, &hit) && hit.t == all[i].t);
        part.t_max = all[i].t;
        assert_true(k->hit(c->shape, &part, &hit) && hit.t == all[i].t);
        if (i + 1 < count && all[i + 1].t > all[i].t) {
            part.t_min = nextafter(all[i].t, INFINITY), part.t_max = ray->t_max;
            assert_true(k->hit(c->shape, &part, &hit) && hit.t == all[i + 1].t);
        }
        if (i == 0 && all[0].t > ray->t_min) {
            part.t_min = ray->t_min, part.t_max = nextafter(all[0].t, -INFINITY);
            assert_false(k->hit(c->shape, &part, &hit));
        }
    }
    // A direction of another length: the same crossings, t scaled.
    sag_ray scaled = *ray;
    scaled.direction = sag_scale(ray->direction, 0x1p30);
    scaled.t_min = ray->t_min * 0x1p-30, scaled.t_max = ray->t_max * 0x1p-30;
    assert_int_equal(k->crossings(c->shape, &scaled, all, MOST_CROSSINGS), count);
    assert_true(k->hit(c->shape, ray, &hit));
    assert_true(all[0].t * 0x1p30 == hit.t);
}

void check_verbs(const shape_case *c, rng *r, size_t count) {
    size_t hits = 0;
    for (size_t i = 0; i < count; i++) {
        sag_ray ray = shape_random_ray(r, c);
        check_verbs_of(c, &ray);
        hits += c->kind->occluded(c->shape, &ray);
    }
    assert_true(hits > 0); // the rays did test something
}

static bool within(double a, double b, double error) { return fabs(a - b) <= error; }

static void check_surface(const shape_case *c, const sag_ray *ray, const sag_hit *hit) {
    sag_surface s;
    c->kind->surface(c->shape, ray, hit, &s);
    sag_vec3 p = sag_ray_at(ray, hit->t), e = s.position_error;
    // The point at the rounded t is off by t's 4 ulp and the roundings of the sum.
    sag_vec3 slack =
        sag_scale(sag_add(sag_abs(ray->origin), sag_abs(sag_scale(ray->direction, hit->t))), 0x1p-49);
    // A position brought back to the surface may trade an error in one coordinate for one in another.
    assert_true(sag_length(sag_sub(p, s.position)) <= sag_length(e) + sag_length(slack));
    double scale = sag_length(s.position) + c->radius;
    assert_true(e.x >= 0 && e.y >= 0 && e.z >= 0);
    assert_true(e.x + e.y + e.z <= 0x1p-44 * scale);
    assert_true(within(sag_length(s.geometric_normal), 1, 1e-15));
    assert_true(within(sag_length(s.shading_normal), 1, 1e-15));
    sag_side side = sag_dot(ray->direction, s.geometric_normal) > 0 ? SAG_SIDE_BACK : SAG_SIDE_FRONT;
    assert_int_equal(s.side, side);
    assert_int_equal(s.primitive, hit->primitive);
    sag_vec3 across = sag_normalize(sag_cross(s.dpdu, s.dpdv));
    assert_true(within(sag_length(across), 1, 1e-15));
    assert_true(fabs(sag_dot(across, s.geometric_normal)) > 1 - 1e-9);
    sag_box3 box = c->kind->bounds(c->shape);
    assert_true(p.x >= box.min.x - slack.x && p.x <= box.max.x + slack.x);
    assert_true(p.y >= box.min.y - slack.y && p.y <= box.max.y + slack.y);
    assert_true(p.z >= box.min.z - slack.z && p.z <= box.max.z + slack.z);
}

void check_surfaces(const shape_case *c, rng *r, size_t count) {
    for (size_t i = 0; i < count; i++) {
        sag_ray ray = shape_random_ray(r, c);
        sag_hit hits[MOST_CROSSINGS];
        size_t n = c->kind->crossings(c->shape, &ray, hits, MOST_CROSSINGS);
        for (size_t j = 0; j < n; j++) check_surface(c, &ray, &hits[j]);
    }
}

static void check_leaving(const shape_case *c, const sag_surface *s, sag_vec3 direction) {
    double cosine = sag_dot(direction, s->geometric_normal);
    sag_ray ray = sag_spawn_ray(s, direction);
    sag_hit hits[MOST_CROSSINGS];
    size_t n = c->kind->crossings(c->shape, &ray, hits, MOST_CROSSINGS);
    if (c->leaving == LEAVING_FLAT || (c->leaving == LEAVING_CONVEX && cosine > 0)) assert_int_equal(n, 0);
    if (c->leaving == LEAVING_CONVEX && cosine < 0) assert_int_equal(n, 1);
    if (c->leaving == LEAVING_ANY && fabs(cosine) > 0.5 && n > 0)
        assert_true(hits[0].t > 1e3 * sag_length(s->position_error));
}

void check_spawned(const shape_case *c, rng *r, size_t count) {
    for (size_t i = 0; i < count; i++) {
        sag_ray ray = shape_random_ray(r, c);
        sag_hit hits[MOST_CROSSINGS];
        size_t n = c->kind->crossings(c->shape, &ray, hits, MOST_CROSSINGS);
        for (size_t j = 0; j < n; j++) {
            sag_surface s;
            c->kind->surface(c->shape, &ray, &hits[j], &s);
            for (int k = 0; k < 4; k++) check_leaving(c, &s, rng_direction(r));
        }
    }
}

void check_bad_rays(const shape_case *c) {
    sag_vec3 o = {c->center.x, c->center.y, c->center.z - 3 * c->radius}, d = {0, 0, 1};
    const double bad[3] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 8; j++) {
            sag_ray ray = sag_ray_make(o, d);
            double *fields[8] = {&ray.origin.x,    &ray.origin.y,    &ray.origin.z, &ray.direction.x,
                                 &ray.direction.y, &ray.direction.z, &ray.t_min,    &ray.t_max};
            if (j >= 6 && i > 0) continue; // an infinite range is a good one
            *fields[j] = bad[i];
            sag_hit hit = {.t = 42};
            assert_false(c->kind->hit(c->shape, &ray, &hit));
            assert_true(hit.t == 42); // untouched on a miss
            assert_false(c->kind->occluded(c->shape, &ray));
            assert_int_equal(c->kind->crossings(c->shape, &ray, NULL, 0), 0);
        }
    }
    sag_ray still = sag_ray_make(o, (sag_vec3){0, 0, 0}), turned = sag_ray_make(o, d);
    turned.t_min = 2, turned.t_max = 1;
    assert_false(c->kind->occluded(c->shape, &still));
    assert_false(c->kind->occluded(c->shape, &turned));
}

// A line through the ball, uniform among all lines that meet it.
static sag_ray random_line(rng *r, const shape_case *c) {
    sag_vec3 d = rng_direction(r), s, t;
    sag_frame(d, &s, &t);
    double rho = c->radius * sqrt(rng_unit(r)), phi = rng_uniform(r, 0, 2 * 3.14159265358979323846);
    sag_ray ray = sag_ray_make(sag_madd(sag_madd(c->center, rho * cos(phi), s), rho * sin(phi), t), d);
    ray.t_min = -INFINITY;
    return ray;
}

// One of 48 bins: octant of the ball by six directions of the normal.
static int bin_of(const shape_case *c, const sag_surface *s) {
    // Not quite about the center, where flat shapes and faces would fall between the bins.
    sag_vec3 middle = sag_madd(c->center, c->radius, (sag_vec3){0.11, 0.07, 0.05});
    sag_vec3 w = sag_sub(s->position, middle), n = s->geometric_normal;
    int octant = (w.x > 0) + 2 * (w.y > 0) + 4 * (w.z > 0);
    double x = fabs(n.x), y = fabs(n.y), z = fabs(n.z);
    int side = x >= y && x >= z ? n.x > 0 : y >= z ? 2 + (n.y > 0) : 4 + (n.z > 0);
    return octant * 6 + side;
}

void check_area_and_samples(const shape_case *c, rng *r, size_t count) {
    size_t crossed = 0, of_lines[48] = {0}, of_samples[48] = {0};
    double squares = 0;
    for (size_t i = 0; i < count; i++) {
        sag_ray ray = random_line(r, c);
        sag_hit hits[MOST_CROSSINGS];
        size_t n = c->kind->crossings(c->shape, &ray, hits, MOST_CROSSINGS);
        crossed += n, squares += (double)(n * n);
        for (size_t j = 0; j < n; j++) {
            sag_surface s;
            c->kind->surface(c->shape, &ray, &hits[j], &s);
            of_lines[bin_of(c, &s)]++;
        }
    }
    // A line that meets the ball crosses a surface of area A within it A/(2πR²) times on average.
    double mean = (double)crossed / (double)count, variance = squares / (double)count - mean * mean;
    double expected = c->kind->area(c->shape) / (2 * 3.14159265358979323846 * c->radius * c->radius);
    assert_true(fabs(mean - expected) <= 5 * sqrt(variance / (double)count));
    for (size_t i = 0; i < crossed; i++) {
        sag_surface s;
        assert_true(c->kind->sample(c->shape, rng_vec2(r), &s));
        assert_int_equal(s.side, SAG_SIDE_FRONT);
        of_samples[bin_of(c, &s)]++;
    }
    double chi2 = 0;
    int degrees = -1;
    for (int i = 0; i < 48; i++) {
        double a = (double)of_lines[i], b = (double)of_samples[i];
        if (a + b > 0) chi2 += (a - b) * (a - b) / (a + b), degrees++;
    }
    // The crossings of one line are not independent, so up to twice the variance; five sigma of that.
    assert_true(chi2 < 2 * (degrees + 5 * sqrt(2.0 * degrees + 1)));
}

void check_volume(const shape_case *c, rng *r, size_t count) {
    double sum = 0, squares = 0;
    for (size_t i = 0; i < count; i++) {
        sag_ray ray = random_line(r, c);
        sag_hit hits[MOST_CROSSINGS];
        size_t n = c->kind->crossings(c->shape, &ray, hits, MOST_CROSSINGS);
        double inside = 0;
        for (size_t j = 0; j + 1 < n; j++) {
            double middle = hits[j].t + (hits[j + 1].t - hits[j].t) * rng_uniform(r, 0.1, 0.9);
            if (hits[j + 1].t - hits[j].t <= 1e-9 * c->radius) continue;
            bool in = c->kind->contains(c->shape, sag_ray_at(&ray, middle));
            if (n == 2) assert_true(in);
            if (in) inside += hits[j + 1].t - hits[j].t;
        }
        if (n > 0) {
            assert_false(c->kind->contains(c->shape, sag_ray_at(&ray, hits[0].t - 1e-3 * c->radius)));
            assert_false(c->kind->contains(c->shape, sag_ray_at(&ray, hits[n - 1].t + 1e-3 * c->radius)));
        }
        sum += inside, squares += inside * inside;
    }
    // The mean chord over all lines through the ball is V/(πR²).
    double mean = sum / (double)count, variance = squares / (double)count - mean * mean;
    double expected = c->kind->volume(c->shape) / (3.14159265358979323846 * c->radius * c->radius);
    assert_true(fabs(mean - expected) <= 5 * sqrt(variance / (double)count));
}

void check_closest_point(const shape_case *c, rng *r, size_t count) {
    for (size_t i = 0; i < count; i++) {
        sag_vec3 p = in_ball(r, c, 2), q = c->kind->closest_point(c->shape, p);
        double distance = sag_length(sag_sub(q, p)), slack = 1e-12 * (sag_length(c->center) + c->radius);
        for (int j = 0; j < 20; j++) {
            sag_surface s;
            if (!c->kind->sample(c->shape, rng_vec2(r), &s)) break;
            assert_true(sag_length(sag_sub(s.position, p)) >= distance - slack);
        }
        // The nearest point is its own nearest point.
        sag_vec3 again = c->kind->closest_point(c->shape, q);
        assert_true(sag_length(sag_sub(again, q)) <= 100 * slack);
    }
}
