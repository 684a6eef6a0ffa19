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
        w->slab_center = s.center;
        w->lo[2] = s.z_min, w->hi[2] = s.z_max;
    }
    if (rng_one_in(r, 3)) s.phi_max_rad = w->phi_max = random_sweep(r);
    any->sphere = s;
}

// q[i] += k · x · y · z · w
static void add_product(quadric_truth *w, int i, double k, double x, double y, double z, double u) {
    mpfr_set_d(w->t, k, RN);
    mpfr_mul_d(w->t, w->t, x, RN), mpfr_mul_d(w->t, w->t, y, RN);
    mpfr_mul_d(w->t, w->t, z, RN), mpfr_mul_d(w->t, w->t, u, RN);
    mpfr_add(w->q[i], w->q[i], w->t, RN);
}

static void make_ellipsoid(rng *r, double size, any_quadric *any, quadric_truth *w) {
    double thin = rng_one_in(r, 3) ? 1e-6 : 0.2;
    sag_ellipsoid e = {.radii = {rng_uniform(r, 0.2, 1) * size, rng_log_uniform(r, thin, 1) * size,
                                 rng_log_uniform(r, thin, 1) * size}};
    if (rng_one_in(r, 2)) e.center = rng_vec3(r, 2 * size);
    quadric_truth_reset(w);
    w->center = e.center;
    sag_vec3 a = e.radii;
    add_product(w, 0, 1, a.y, a.y, a.z, a.z);
    add_product(w, 1, 1, a.x, a.x, a.z, a.z);
    add_product(w, 2, 1, a.x, a.x, a.y, a.y);
    add_product(w, 9, -1, a.x, a.x, a.y, a.y);
    mpfr_mul_d(w->q[9], w->q[9], a.z, RN), mpfr_mul_d(w->q[9], w->q[9], a.z, RN);
    any->ellipsoid = e;
}

// Closed in one of two cases; else swept in one of two.
static void open_or_closed(rng *r, quadric_truth *w, bool *closed, double *phi_max_rad) {
    w->closed = *closed = rng_one_in(r, 2);
    if (!*closed && rng_one_in(r, 2)) *phi_max_rad = w->phi_max = random_sweep(r);
}

static void make_cylinder(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_cylinder c = {.radius = rng_log_uniform(r, 1e-3, 1) * size};
    c.z_min = rng_uniform(r, -1, 0.3) * size, c.z_max = c.z_min + rng_log_uniform(r, 0.01, 2) * size;
    quadric_truth_reset(w);
    mpfr_set_si(w->q[0], 1, RN), mpfr_set_si(w->q[1], 1, RN);
    set_square(w, 9, -1, c.radius);
    w->lo[2] = c.z_min, w->hi[2] = c.z_max;
    open_or_closed(r, w, &c.closed, &c.phi_max_rad);
    any->cylinder = c;
}

static void make_cone(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_cone c = {.radius = rng_log_uniform(r, 1e-3, 1) * size, .height = rng_log_uniform(r, 1e-3, 1) * size};
    if (rng_one_in(r, 4)) c.height = c.radius; // rays at 45° run along its side
    quadric_truth_reset(w);
    set_square(w, 0, 1, c.height), set_square(w, 1, 1, c.height), set_square(w, 2, -1, c.radius);
    w->center.z = c.height;
    w->lo[2] = 0, w->hi[2] = c.height;
    open_or_closed(r, w, &c.closed, &c.phi_max_rad);
    any->cone = c;
}

static void make_paraboloid(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_paraboloid p = {.radius = rng_log_uniform(r, 1e-3, 1) * size,
                        .z_max = rng_log_uniform(r, 1e-3, 1) * size};
    if (rng_one_in(r, 2)) p.z_min = rng_uniform(r, 0, 0.9) * p.z_max;
    quadric_truth_reset(w);
    mpfr_set_d(w->q[0], p.z_max, RN), mpfr_set_d(w->q[1], p.z_max, RN);
    set_square(w, 8, -1, p.radius);
    mpfr_div_2ui(w->q[8], w->q[8], 1, RN);
    w->lo[2] = p.z_min > 0 ? p.z_min : -INFINITY, w->hi[2] = p.z_max;
    open_or_closed(r, w, &p.closed, &p.phi_max_rad);
    any->paraboloid = p;
}

static void make_hyperboloid(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_hyperboloid h = {.p1 = rng_vec3(r, size), .p2 = rng_vec3(r, size)};
    switch (rng_below(r, 6)) {
    case 0: h.p2.x = h.p1.x, h.p2.y = h.p1.y; break; // cylinder
    case 1: h.p2.x = h.p2.y = 0; break;              // cone
    case 2: h.p2.x = h.p1.x * (1 + 1e-9); break;
    default: break;
    }
    sag_vec3 p = h.p1, q = h.p2;
    quadric_truth_reset(w);
    mpfr_t dx, dy, dz, along, start;
    mpfr_inits2(TRUTH_BITS, dx, dy, dz, along, start, (mpfr_ptr)0);
    mpfr_set_d(dx, q.x, RN), mpfr_sub_d(dx, dx, p.x, RN);
    mpfr_set_d(dy, q.y, RN), mpfr_sub_d(dy, dy, p.y, RN);
    mpfr_set_d(dz, q.z, RN), mpfr_sub_d(dz, dz, p.z, RN);
    mpfr_mul_d(along, dx, p.x, RN), mpfr_mul_d(w->t, dy, p.y, RN), mpfr_add(along, along, w->t, RN);
    mpfr_set_d(start, p.x, RN), mpfr_mul_d(start, start, p.x, RN);
    mpfr_set_d(w->t, p.y, RN), mpfr_mul_d(w->t, w->t, p.y, RN), mpfr_add(start, start, w->t, RN);
    mpfr_sqr(w->q[0], dz, RN), mpfr_set(w->q[1], w->q[0], RN);
    mpfr_sqr(dx, dx, RN), mpfr_sqr(dy, dy, RN), mpfr_add(w->q[2], dx, dy, RN), mpfr_neg(w->q[2], w->q[2], RN);
    mpfr_mul(w->q[8], dz, along, RN), mpfr_neg(w->q[8], w->q[8], RN);
    mpfr_mul(w->q[9], w->q[0], start, RN), mpfr_neg(w->q[9], w->q[9], RN);
    mpfr_clears(dx, dy, dz, along, start, (mpfr_ptr)0);
    w->center.z = p.z;
    w->lo[2] = fmin(p.z, q.z), w->hi[2] = fmax(p.z, q.z);
    w->closed = h.closed = rng_one_in(r, 2);
    any->hyperboloid = h;
}

static void make_hyperboloid2(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_hyperboloid2 h = {.a = rng_log_uniform(r, 1e-2, 1) * size, .c = rng_log_uniform(r, 1e-2, 0.5) * size};
    h.z_min = rng_uniform(r, -1, 0.3) * size, h.z_max = rng_uniform(r, 1, 2) * h.c + fmax(h.z_min, 0) * 1.1;
    if (rng_one_in(r, 4)) h.z_max = rng_uniform(r, -0.5, 0.5) * h.c, h.z_min = -rng_uniform(r, 1.1, 5) * h.c;
    quadric_truth_reset(w);
    set_square(w, 0, 1, h.c), set_square(w, 1, 1, h.c), set_square(w, 2, -1, h.a);
    add_product(w, 9, 1, h.a, h.a, h.c, h.c);
    w->lo[2] = fabs(h.z_min) <= h.c ? 0 : h.z_min, w->hi[2] = fabs(h.z_max) <= h.c ? 0 : h.z_max;
    open_or_closed(r, w, &h.closed, &h.phi_max_rad);
    any->hyperboloid2 = h;
}

static void make_quadric(rng *r, double size, any_quadric *any, quadric_truth *w) {
    sag_quadric s = {.clip = {{-size, -size, -size}, {size, size, size}}};
    quadric_truth_reset(w);
    for (int i = 0; i < 10; i++) {
        int degree = i < 6 ? 2 : i < 9 ? 1 : 0;
        if (rng_one_in(r, 3)) continue;
        s.coefficients[i] = rng_uniform(r, -1, 1) / pow(size, degree);
        if (i == 9) s.coefficients[i] *= -0.3;
    }
    if (rng_one_in(r, 4)) // rank one: two planes or one, where half of all rays are nearly tangent
        for (int i = 1; i < 6; i++) s.coefficients[i] = i < 3 ? s.coefficients[0] : 0;
    if (s.coefficients[0] == 0) s.coefficients[0] = 1 / (size * size);
    for (int i = 0; i < 10; i++) mpfr_set_d(w->q[i], s.coefficients[i], RN);
    for (int i = 0; i < 3; i++) w->lo[i] = -size, w->hi[i] = size;
    any->quadric = s;
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
VERBS(ellipsoid)
VERBS(cylinder)
VERBS(cone)
VERBS(paraboloid)
VERBS(hyperboloid)
VERBS(hyperboloid2)
VERBS(quadric)

#define SUBJECT(X)                                                                                           \
    {                                                                                                        \
#X, make_##X, X##_validate, X##_bounds, X##_hit, X##_occluded, X##_crossings, X##_surface, X##_area, \
            X##_sample, X##_contains                                                                         \
    }

const quadric_subject quadric_subjects[] = {
    SUBJECT(sphere),     SUBJECT(ellipsoid),   SUBJECT(cylinder),     SUBJECT(cone),
    SUBJECT(paraboloid), SUBJECT(hyperboloid), SUBJECT(hyperboloid2), SUBJECT(quadric),
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
