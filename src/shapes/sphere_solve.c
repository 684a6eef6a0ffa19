// SPDX-License-Identifier: MIT
// The sphere: what sphere_solve.h does not settle goes to the general solver of quadrics; and whether a point
// is inside.
#include "shapes/sphere_solve.h"
#include "shapes/quadric_solve.h"

typedef struct sphere {
    sag_vec3 center;
    double radius; // scaled by 2^-exponent
} sphere;

static void exact(const void *shape, sagi_quadric_exact *q) {
    const sphere *s = shape;
    for (int i = 0; i < 3; i++) {
        q->square[i] = sagi_real_from(1);
        q->cross[i] = q->linear[i] = sagi_real_from(0);
    }
    q->constant = sagi_real_scale(sagi_real_from(s->radius), -s->radius);
}

static sagi_quadric_form form_of(sphere *s) {
    int exponent = sagi_size_exponent(s->radius);
    if (exponent != 0) s->radius = ldexp(s->radius, -exponent);
    return (sagi_quadric_form){
        .square = {{1, 0}, {1, 0}, {1, 0}},
        .constant = sagi_dd_neg(sagi_two_prod(s->radius, s->radius)),
        .center = s->center,
        .exponent = exponent,
        .exact = exact,
        .shape = s,
    };
}

int sagi_sphere_solve_generally(sag_vec3 center, double radius, const sag_ray *ray, double t_max,
                                double t[2]) {
    sphere s = {center, radius};
    sag_ray rest = *ray;
    rest.t_max = t_max;
    sagi_quadric_form form = form_of(&s);
    sagi_spans spans = sagi_quadric_spans(&form, &rest);
    int count = 0;
    if (spans.count == 0) return 0;
    if (sagi_in_range(&rest, spans.enter[0])) t[count++] = spans.enter[0];
    if (sagi_in_range(&rest, spans.leave[0])) t[count++] = spans.leave[0];
    return count;
}

bool sagi_sphere_hit(sag_vec3 center, double radius, const sag_ray *ray, double *t) {
    double roots[2];
    const sagi_d4 at = sagi_d4_of(center.x, center.y, center.z, radius);
    if (sagi_sphere_solve(at, ray, ray->t_max, true, roots) == 0) return false;
    *t = roots[0];
    return true;
}

int sagi_sphere_crossings(sag_vec3 center, double radius, const sag_ray *ray, double t[2]) {
    const sagi_d4 at = sagi_d4_of(center.x, center.y, center.z, radius);
    return sagi_sphere_solve(at, ray, ray->t_max, false, t);
}

bool sagi_sphere_contains(sag_vec3 center, double radius, sag_vec3 point) {
    sphere s = {center, radius};
    sagi_quadric_form form = form_of(&s);
    return sag_is_finite(point) && sagi_quadric_sign(&form, point) <= 0;
}
