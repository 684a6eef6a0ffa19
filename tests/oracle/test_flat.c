// SPDX-License-Identifier: MIT
// Disk, rectangle, oriented box and polyhedron against exact fractions (GMP), at sizes from 1e-9 to 1e9:
// whether they are hit and where. All their decisions are signs of polynomials in the numbers given.
#include "support/adversarial.h"
#include "support/fractions.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define RAYS       1000000
#define PER_SHAPE  25
#define MOST_FACES 12

typedef struct any_flat {
    sag_disk disk;
    sag_rectangle rectangle;
    sag_oriented_box oriented_box;
    sag_polyhedron polyhedron;
    sag_half_space planes[MOST_FACES];
    sag_vec3 points[16];
    uint32_t point_count;
    sag_vec3 center;
} any_flat;

typedef struct scratch {
    fraction3 o, d, a, b, c, n;
    mpq_t num, den, x, y;
    fraction_clip clip;
} scratch;

typedef struct subject {
    const char *name;
    void (*make)(rng *r, double size, any_flat *shape);
    void (*solve)(scratch *s, const any_flat *shape, const sag_ray *ray, crossing_truth *truth);
    size_t (*crossings)(const any_flat *shape, const sag_ray *ray, sag_hit *hits, size_t capacity);
} subject;

static void make_disk(rng *r, double size, any_flat *f) {
    sag_vec3 s = rng_vec3(r, 1), v = rng_vec3(r, 1);
    if (rng_one_in(r, 2)) s = (sag_vec3){1, 0, 0}, v = (sag_vec3){0, 1, 0};
    sag_disk disk = {.center = f->center, .normal = sag_cross(s, v), .radius = size};
    if (rng_one_in(r, 2)) disk.inner_radius = size * rng_unit(r);
    // Points of both rims: rays at them end within rounding of the rim.
    sag_vec3 n = sag_normalize(disk.normal), x, y;
    sag_frame(n, &x, &y);
    for (int i = 0; i < 16; i++) {
        double phi = i < 4 ? i * 1.57079632679489661923 : rng_uniform(r, 0, 6.28),
               rho = i & 1 ? disk.radius : disk.inner_radius;
        f->points[i] = sag_madd(sag_madd(disk.center, rho * cos(phi), x), rho * sin(phi), y);
    }
    f->point_count = 16, f->disk = disk;
}

// ρ² against r² at the ray's cut with the plane: (D w + N d)² against r² D².
static int compare_radius(scratch *s, double radius) {
    mpq_set_ui(s->y, 0, 1);
    for (int i = 0; i < 3; i++) {
        mpq_mul(s->b[i], s->d[i], s->num), mpq_mul(s->x, s->a[i], s->den);
        mpq_sub(s->b[i], s->b[i], s->x);
    }
    fraction3_dot(s->y, s->b, s->b);
    mpq_set_d(s->x, radius);
    mpq_mul(s->x, s->x, s->den), mpq_mul(s->x, s->x, s->x);
    return mpq_cmp(s->y, s->x);
}

static void solve_disk(scratch *s, const any_flat *f, const sag_ray *ray, crossing_truth *truth) {
    const sag_disk *disk = &f->disk;
    fraction3_set_diff(s->a, disk->center, ray->origin);
    fraction3_set(s->n, disk->normal);
    fraction3_dot(s->num, s->a, s->n), fraction3_dot(s->den, s->d, s->n);
    if (mpq_sgn(s->den) == 0 || compare_radius(s, disk->radius) > 0) return;
    if (compare_radius(s, disk->inner_radius) < 0) return;
    mpq_div(s->num, s->num, s->den);
    crossing_truth_add_fraction(truth, ray, s->num);
}

static size_t cross_disk(const any_flat *f, const sag_ray *ray, sag_hit *hits, size_t n) {
    return sag_disk_crossings(&f->disk, ray, hits, n);
}

static void make_rectangle(rng *r, double size, any_flat *f) {
    sag_vec3 e = rng_vec3(r, size), g = rng_vec3(r, size);
    if (rng_one_in(r, 3)) e = (sag_vec3){size, 0, 0}, g = (sag_vec3){0, size * rng_unit(r) + size, 0};
    if (rng_one_in(r, 8)) g = sag_madd(sag_scale(e, 0.7), 1e-6, g); // a thin one
    f->rectangle = (sag_rectangle){f->center, e, g};
    for (int i = 0; i < 16; i++) {
        double u = (i & 3) < 2 ? (i & 1) : rng_unit(r), v = (i >> 2) < 2 ? (i >> 2 & 1) : rng_unit(r);
        f->points[i] = sag_madd(sag_madd(f->center, u, e), v, g);
    }
    f->point_count = 16;
}

static void determinant(mpq_t out, scratch *s, fraction3 a, fraction3 b, fraction3 c) {
    fraction3_cross(s->n, b, c);
    fraction3_dot(out, a, s->n);
}

static bool in_unit_interval(mpq_t value, mpq_t den) {
    int sign = mpq_sgn(den);
    return mpq_sgn(value) * sign >= 0 && mpq_cmp(value, den) * sign <= 0;
}

static void solve_rectangle(scratch *s, const any_flat *f, const sag_ray *ray, crossing_truth *truth) {
    fraction3_set(s->a, f->rectangle.edge_u), fraction3_set(s->b, f->rectangle.edge_v);
    fraction3_set_diff(s->c, ray->origin, f->rectangle.corner);
    determinant(s->den, s, s->a, s->b, s->d);
    if (mpq_sgn(s->den) == 0) return;
    determinant(s->x, s, s->c, s->b, s->d), determinant(s->y, s, s->a, s->c, s->d);
    if (!in_unit_interval(s->x, s->den) || !in_unit_interval(s->y, s->den)) return;
    determinant(s->num, s, s->a, s->b, s->c);
    mpq_div(s->num, s->num, s->den), mpq_neg(s->num, s->num);
    crossing_truth_add_fraction(truth, ray, s->num);
}

static size_t cross_rectangle(const any_flat *f, const sag_ray *ray, sag_hit *hits, size_t n) {
    return sag_rectangle_crossings(&f->rectangle, ray, hits, n);
}

static void make_oriented_box(rng *r, double size, any_flat *f) {
    sag_oriented_box *box = &f->oriented_box;
    box->center = f->center;
    for (int k = 0; k < 3; k++) box->half_axes[k] = rng_vec3(r, size);
    if (rng_one_in(r, 4))
        box->half_axes[0] = (sag_vec3){0, -size, size}, box->half_axes[1] = (sag_vec3){0, size, size},
        box->half_axes[2] = (sag_vec3){size, 0, 0};
    if (rng_one_in(r, 8)) box->half_axes[2] = sag_scale(box->half_axes[2], 1e-5);
    for (int k = 0; k < 16; k++) {
        sag_vec3 p = box->center;
        for (int i = 0; i < 3; i++)
            p = sag_madd(p, k < 8 || i != k % 3 ? (k >> i & 1 ? 1 : -1) : rng_uniform(r, -1, 1),
                         box->half_axes[i]);
        f->points[k] = p;
    }
    f->point_count = 16;
}

static void solve_oriented_box(scratch *s, const any_flat *f, const sag_ray *ray, crossing_truth *truth) {
    const sag_vec3 *axes = f->oriented_box.half_axes;
    fraction3_set_diff(s->c, ray->origin, f->oriented_box.center);
    fraction_clip_reset(&s->clip);
    for (int i = 0; i < 3; i++) {
        fraction3_set(s->a, axes[(i + 1) % 3]), fraction3_set(s->b, axes[(i + 2) % 3]);
        fraction3_cross(s->n, s->a, s->b);
        fraction3_set(s->a, axes[i]);
        fraction3_dot(s->x, s->a, s->n); // D
        fraction3_dot(s->y, s->c, s->n), fraction3_dot(s->den, s->d, s->n);
        mpq_abs(s->x, s->x);
        mpq_sub(s->num, s->x, s->y), fraction_clip_by(&s->clip, s->num, s->den);
        mpq_add(s->num, s->x, s->y), mpq_neg(s->den, s->den), fraction_clip_by(&s->clip, s->num, s->den);
    }
    fraction_clip_add(&s->clip, ray, truth);
}

static size_t cross_oriented_box(const any_flat *f, const sag_ray *ray, sag_hit *hits, size_t n) {
    return sag_oriented_box_crossings(&f->oriented_box, ray, hits, n);
}

static void make_polyhedron(rng *r, double size, any_flat *f) {
    uint32_t n = 4 + rng_below(r, MOST_FACES - 3);
    for (uint32_t k = 0; k < n; k++) {
        sag_vec3 d = rng_one_in(r, 3)
                         ? (sag_vec3){(double)rng_below(r, 3) - 1, (double)rng_below(r, 3) - 1, 1}
                         : rng_direction(r);
        if (rng_one_in(r, 2)) d = sag_scale(d, -1);
        f->planes[k] =
            (sag_half_space){d, sag_dot(d, f->center) + sag_length(d) * size * rng_uniform(r, 0.3, 1)};
    }
    f->polyhedron = (sag_polyhedron){f->planes, n};
    // Points (nearly) on two planes: their edges' lines.
    for (int k = 0; k < 16; k++) {
        sag_half_space g = f->planes[rng_below(r, n)], h = f->planes[rng_below(r, n)];
        sag_vec3 p = sag_add(f->center, rng_vec3(r, size));
        for (int i = 0; i < 40; i++) {
            p = sag_madd(p, (g.offset - sag_dot(g.normal, p)) / sag_dot(g.normal, g.normal), g.normal);
            p = sag_madd(p, (h.offset - sag_dot(h.normal, p)) / sag_dot(h.normal, h.normal), h.normal);
        }
        f->points[k] = p;
    }
    f->point_count = 16;
}

static void solve_polyhedron(scratch *s, const any_flat *f, const sag_ray *ray, crossing_truth *truth) {
    fraction_clip_reset(&s->clip);
    for (uint32_t k = 0; k < f->polyhedron.plane_count; k++) {
        fraction3_set(s->n, f->planes[k].normal);
        fraction3_dot(s->x, s->n, s->o), fraction3_dot(s->den, s->n, s->d);
        mpq_set_d(s->num, f->planes[k].offset), mpq_sub(s->num, s->num, s->x);
        fraction_clip_by(&s->clip, s->num, s->den);
    }
    fraction_clip_add(&s->clip, ray, truth);
}

static size_t cross_polyhedron(const any_flat *f, const sag_ray *ray, sag_hit *hits, size_t n) {
    return sag_polyhedron_crossings(&f->polyhedron, ray, hits, n);
}

static const subject subjects[4] = {
    {"disk", make_disk, solve_disk, cross_disk},
    {"rectangle", make_rectangle, solve_rectangle, cross_rectangle},
    {"oriented_box", make_oriented_box, solve_oriented_box, cross_oriented_box},
    {"polyhedron", make_polyhedron, solve_polyhedron, cross_polyhedron},
};

static void check_ray(scratch *s, const subject *what, const any_flat *shape, const sag_ray *ray,
                      size_t *found, size_t *wrong, double *worst) {
    crossing_truth truth = {0};
    sag_hit hits[4];
    fraction3_set(s->o, ray->origin), fraction3_set(s->d, ray->direction);
    what->solve(s, shape, ray, &truth);
    size_t count = what->crossings(shape, ray, hits, 4);
    double ulps = crossing_truth_compare(&truth, hits, count);
    *found += count;
    if (!(ulps <= 4) && (*wrong)++ < 5)
        print_message("%s: ray %a %a %a  %a %a %a  [%a, %a]: %zu found, %d expected, %.2f ulp\n", what->name,
                      ray->origin.x, ray->origin.y, ray->origin.z, ray->direction.x, ray->direction.y,
                      ray->direction.z, ray->t_min, ray->t_max, count, truth.count, ulps);
    if (ulps > *worst && isfinite(ulps)) *worst = ulps;
}

static void check_subject(scratch *s, const subject *what) {
    rng r = rng_make(301);
    size_t rays = soak(RAYS), found = 0, wrong = 0;
    double worst = 0;
    for (size_t i = 0; i < rays; i += PER_SHAPE) {
        double size = rng_log_uniform(&r, 1e-9, 1e9);
        any_flat shape = {.center = rng_one_in(&r, 3) ? (sag_vec3){0, 0, 0}
                                                      : rng_vec3(&r, size * rng_log_uniform(&r, 1, 1e3))};
        what->make(&r, size, &shape);
        adversary hard = {shape.center, size, shape.points, shape.point_count};
        for (int k = 0; k < PER_SHAPE; k++) {
            sag_ray ray = adversarial_ray(&r, &hard);
            check_ray(s, what, &shape, &ray, &found, &wrong, &worst);
        }
    }
    print_message("%-12s %zu rays, %zu crossings, wrong decisions %zu, largest error of t %.2f ulp\n",
                  what->name, rays, found, wrong, worst);
    assert_int_equal(wrong, 0);
}

static void crossings_are_exact(void **state) {
    (void)state;
    scratch s;
    fraction3_init(s.o), fraction3_init(s.d), fraction3_init(s.a), fraction3_init(s.b), fraction3_init(s.c);
    fraction3_init(s.n), mpq_inits(s.num, s.den, s.x, s.y, NULL), fraction_clip_init(&s.clip);
    for (int i = 0; i < 4; i++) check_subject(&s, &subjects[i]);
    fraction3_clear(s.o), fraction3_clear(s.d), fraction3_clear(s.a), fraction3_clear(s.b),
        fraction3_clear(s.c);
    fraction3_clear(s.n), mpq_clears(s.num, s.den, s.x, s.y, NULL), fraction_clip_clear(&s.clip);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(crossings_are_exact)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
