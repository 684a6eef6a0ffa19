// SPDX-License-Identifier: MIT
#include "support/quadric_subjects.h"

#define RN MPFR_RNDN

// q[i] = k · x · x
static void set_square(quadric_truth *w, int i, int k, double x) {
    mpfr_set_d(w->q[i], x, RN);
    mpfr_mul_d(w->q[i], w->q[i], x, RN);
    mpfr_mul_si(w->q[i], w->q[i], k, RN);
}

static double random_sweep(rng *r) { return rng_uniform(r, 0.1, 6.2); }

static void make_sphere(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_sphere s = {.radius = rng_uniform(r, 0.2, 1) * size};
    if (!rng_one_in(r, 3)) s.center = rng_vec3(r, (rng_one_in(r, 4) ? 1000 : 2) * size);
    quadric_truth_reset(w);
    w->center = s.center;
    for (int i = 0; i < 3; i++) mpfr_set_si(w->q[i], 1, RN);
    set_square(w, 9, -1, s.radius);
    if (rng_one_in(r, 3)) {
        s.z_min = rng_uniform(r, -1.2, 0.3) * s.radius;
        s.z_max = rng_uniform(r, 0.31, 1.2) * s.radius;
        w->lo[2] = s.z_min, w->hi[2] = s.z_max;
    }
    if (rng_one_in(r, 3)) s.phi_max_rad = w->phi_max = random_sweep(r);
    any->sphere = s;
}

#define VERBS(X)                                                                                             \
    static sag_status X##_validate(const void *s, sag_error *e) { return sag_##X##_validate(s, e); }         \
    static sag_box3 X##_bounds(const void *s) { return sag_##X##_bounds(s); }                                \
    static bool X##_hit(const void *s, const sag_ray *r, sag_hit *h) { return sag_##X##_hit(s, r, h); }      \
    static bool X##_occluded(const void *s, const sag_ray *r) { return sag_##X##_occluded(s, r); }           \
    static size_t X##_crossings(const void *s, const sag_ray *r, sag_hit *h, size_t n) {                     \
        return sag_##X##_crossings(s, r, h, n);                                                              \
    }                                                                                                        \
    static void X##_surface(const void *s, const sag_ray *r, const sag_hit *h, sag_surface *out) {           \
        sag_##X##_surface(s, r, h, out);                                                                     \
    }                                                                                                        \
    static double X##_area(const void *s) { return sag_##X##_area(s); }                                      \
    static bool X##_sample(const void *s, sag_vec2 v, sag_surface *o) { return sag_##X##_sample(s, v, o); }  \
    static bool X##_contains(const void *s, sag_vec3 p) { return sag_##X##_contains(s, p); }

VERBS(sphere)

#define SUBJECT(X)                                                                                           \
    {                                                                                                        \
#X, make_##X, X##_validate, X##_bounds, X##_hit, X##_occluded, X##_crossings, X##_surface, X##_area, \
            X##_sample, X##_contains                                                                         \
    }

const quadric_subject quadric_subjects[] = {
    SUBJECT(sphere),
};
const size_t quadric_subject_count = sizeof quadric_subjects / sizeof *quadric_subjects;

static sag_vec3 in_box(rng *r, const sag_box3 *box) {
    return sag_vec3_make(rng_uniform(r, box->min.x, box->max.x), rng_uniform(r, box->min.y, box->max.y),
                         rng_uniform(r, box->min.z, box->max.z));
}

static sag_vec3 random_length(rng *r, sag_vec3 d) {
    switch (rng_below(r, 6)) {
    case 0: return sag_scale(sag_normalize(d), rng_log_uniform(r, 1e-250, 1e250));
    case 1: return sag_scale(sag_normalize(d), rng_log_uniform(r, 1e-9, 1e9));
    case 2: return d;
    default: return sag_normalize(d);
    }
}

sag_ray quadric_subject_ray(rng *r, const quadric_subject *subject, const any_quadric *shape, double size) {
    sag_box3 box = subject->bounds(shape);
    sag_vec3 target = in_box(r, &box), origin, direction;
    switch (rng_below(r, 5)) {
    case 0: origin = in_box(r, &box); break;
    case 1: origin = sag_madd(target, rng_log_uniform(r, 1, 1e9) * size, rng_direction(r)); break;
    default: origin = sag_madd(target, rng_uniform(r, 0, 5) * size, rng_direction(r)); break;
    }
    direction = sag_sub(target, origin);
    if (rng_one_in(r, 6)) { // along an axis or in a coordinate plane, aligned to the shape
        if (rng_one_in(r, 2)) direction.x = 0, origin.x = rng_one_in(r, 2) ? target.x : 0;
        if (rng_one_in(r, 2)) direction.y = 0, origin.y = rng_one_in(r, 2) ? target.y : 0;
        if (rng_one_in(r, 2)) direction.z = 0, origin.z = rng_one_in(r, 2) ? target.z : 0;
    }
    if (!(sag_length(direction) > 0)) direction.x = size;
    sag_ray ray = sag_ray_make(origin, direction);
    sag_hit hit;
    sag_surface surface;
    if (rng_one_in(r, 5) && subject->hit(shape, &ray, &hit)) {
        subject->surface(shape, &ray, &hit, &surface);
        sag_vec3 tangent = sag_cross(surface.geometric_normal, rng_direction(r));
        if (rng_one_in(r, 2)) { // grazing, more or less
            tangent = sag_madd(tangent, rng_double(r, -60, -2), surface.geometric_normal);
            origin = sag_madd(surface.position, rng_log_uniform(r, 1e-3, 1e6) * size, tangent);
            ray = sag_ray_make(origin, sag_sub(surface.position, origin));
        } else { // from the surface, to either side
            ray = sag_ray_make(surface.position, rng_one_in(r, 2) ? tangent : rng_direction(r));
        }
        if (!(sag_length(ray.direction) > 0)) ray.direction.x = size;
    }
    if (rng_one_in(r, 3)) ray.t_min = -INFINITY;
    ray.direction = random_length(r, ray.direction);
    if (rng_one_in(r, 6)) ray.t_max = rng_uniform(r, 0, 4) * size / sag_max_component(sag_abs(ray.direction));
    return ray;
}
