// SPDX-License-Identifier: MIT
// The general quadric by ten coefficients. The box's three slabs are three intervals of t; a root is kept
// where it lies in all of them. The equation may be multiplied by anything but 0, so the coefficients are
// brought near 1 by a power of two where they are far from it.
#include "shapes/quadric_area.h"
#include "shapes/quadric_solve.h"
#include "shapes/sweep.h"
#include <limits.h>
#include <string.h>

static bool is_usable(const sag_quadric *s) { return sag_quadric_validate(s, NULL) == SAG_OK; }

static bool has_surface(const sag_quadric *s) {
    for (int i = 0; i < 9; i++)
        if (s->coefficients[i] != 0) return true;
    return false;
}

static void exact(const void *shape, sagi_quadric_exact *q) {
    const double *c = shape;
    for (int i = 0; i < 3; i++) {
        q->square[i] = sagi_real_from(c[i]);
        q->cross[i] = sagi_real_from(c[5 - i]);
        q->linear[i] = sagi_real_from(c[6 + i]);
    }
    q->constant = sagi_real_from(c[9]);
}

static int degree(int i) { return i < 6 ? 2 : i < 9 ? 1 : 0; }
static int max_int(int a, int b) { return a > b ? a : b; }

// `c` gets the scaled coefficients and is what the form refers to.
static sagi_quadric_form form_of(const sag_quadric *s, double c[10]) {
    double size = fmax(sag_max_component(sag_abs(s->clip.min)), sag_max_component(sag_abs(s->clip.max))),
           most = 0;
    int exponent = sagi_size_exponent(size);
    for (int i = 0; i < 10; i++) most = fmax(most, fabs(s->coefficients[i]));
    if (exponent == 0 && sagi_size_exponent(most) == 0) {
        memcpy(c, s->coefficients, 10 * sizeof *c);
    } else {
        int highest = INT_MIN;
        for (int i = 0; i < 10; i++)
            if (s->coefficients[i] != 0)
                highest = max_int(highest, ilogb(s->coefficients[i]) + degree(i) * exponent);
        for (int i = 0; i < 10; i++) c[i] = ldexp(s->coefficients[i], degree(i) * exponent - highest);
    }
    return (sagi_quadric_form){
        .square = {{c[0], 0}, {c[1], 0}, {c[2], 0}},
        .cross = {{c[5], 0}, {c[4], 0}, {c[3], 0}},
        .linear = {{c[6], 0}, {c[7], 0}, {c[8], 0}},
        .constant = {c[9], 0},
        .exponent = exponent,
        .mixed = c[3] != 0 || c[4] != 0 || c[5] != 0 || c[6] != 0 || c[7] != 0,
        .exact = exact,
        .shape = c,
    };
}

sag_status sag_quadric_validate(const sag_quadric *s, sag_error *error) {
    char field[32] = "coefficients[0]";
    for (int i = 0; i < 10; i++) {
        field[13] = (char)('0' + i);
        if (!isfinite(s->coefficients[i]))
            return sagi_invalid(error, "quadric", field, s->coefficients[i], "must be finite");
    }
    sag_status status = sagi_check_point(error, "quadric", "clip.min", s->clip.min);
    if (status == SAG_OK) status = sagi_check_point(error, "quadric", "clip.max", s->clip.max);
    if (status != SAG_OK) return status;
    if (sag_box3_is_empty(&s->clip))
        return sagi_invalid3(error, "quadric", "clip.max", s->clip.max,
                             "is below clip.min: the box is empty");
    if (has_surface(s)) return SAG_OK;
    return sagi_invalid(error, "quadric", "coefficients[0]", s->coefficients[0],
                        "and the eight after it are all 0: there is no surface");
}

sag_box3 sag_quadric_bounds(const sag_quadric *s) { return is_usable(s) ? s->clip : sag_box3_empty(); }

// Narrows [enter, leave] to where one coordinate is between low and high.
static void narrow(double o, double d, double low, double high, double *enter, double *leave) {
    if (d == 0) {
        if (!(o >= low && o <= high)) *leave = -INFINITY;
        return;
    }
    double t0 = (low - o) / d, t1 = (high - o) / d;
    *enter = fmax(*enter, fmin(t0, t1)), *leave = fmin(*leave, fmax(t0, t1));
}

static void collect(const sag_quadric *s, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(s)) return;
    double enter = ray->t_min, leave = ray->t_max, c[10];
    const sag_vec3 o = ray->origin, d = ray->direction, lo = s->clip.min, hi = s->clip.max;
    narrow(o.x, d.x, lo.x, hi.x, &enter, &leave);
    narrow(o.y, d.y, lo.y, hi.y, &enter, &leave);
    narrow(o.z, d.z, lo.z, hi.z, &enter, &leave);
    if (!(enter <= leave)) return;
    sagi_quadric_form form = form_of(s, c);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    for (int i = 0; i < spans.count; i++) {
        double ends[2] = {spans.enter[i], spans.leave[i]};
        for (int k = 0; k < 2; k++)
            if (isfinite(ends[k]) && ends[k] >= enter && ends[k] <= leave)
                sagi_crossings_add(list, ends[k], 0, 0, 0);
    }
}

bool sag_quadric_hit(const sag_quadric *s, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(s, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_quadric_occluded(const sag_quadric *s, const sag_ray *ray) {
    sagi_crossings list;
    collect(s, ray, &list);
    return list.count > 0;
}

size_t sag_quadric_crossings(const sag_quadric *s, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list;
    collect(s, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

// At constant z the surface's line runs along (−n.y, n.x), turning φ by (x n.x + y n.y)/ρ² a step; at
// constant φ a step up goes out by −n.z/n·(x, y)/ρ.
static void texture(const sag_quadric *s, sag_surface *surface) {
    sag_vec3 p = surface->position, n = surface->geometric_normal;
    double height = s->clip.max.z - s->clip.min.z, out = p.x * n.x + p.y * n.y;
    double turn = SAGI_TWO_PI * (p.x * p.x + p.y * p.y) / out;
    surface->u = sagi_sweep_angle(p.x, p.y) / SAGI_TWO_PI;
    surface->v = height > 0 ? (p.z - s->clip.min.z) / height : 0;
    surface->dpdu = sag_vec3_make(-turn * n.y, turn * n.x, 0);
    surface->dpdv = sag_vec3_make(-height * n.z * p.x / out, -height * n.z * p.y / out, height);
}

void sag_quadric_surface(const sag_quadric *s, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    double c[10];
    sagi_quadric_form form = form_of(s, c);
    sagi_quadric_place_hit(&form, ray, hit->t, surface);
    texture(s, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_quadric_area(const sag_quadric *s) {
    double area = is_usable(s) ? sagi_quadric_area(s) : 0;
    return area > 0 ? area : 0; // NaN: the numbers are beyond the integration
}

bool sag_quadric_sample(const sag_quadric *s, sag_vec2 random, sag_surface *surface) {
    sag_vec3 point;
    double c[10];
    if (!is_usable(s) || !sagi_quadric_sample_point(s, random, &point)) return false;
    sagi_quadric_form form = form_of(s, c);
    sagi_quadric_place_point(&form, point, surface);
    texture(s, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

bool sag_quadric_contains(const sag_quadric *s, sag_vec3 p) {
    const sag_vec3 lo = s->clip.min, hi = s->clip.max;
    bool in_box = p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y && p.z <= hi.z;
    if (!in_box || !is_usable(s)) return false;
    double c[10];
    sagi_quadric_form form = form_of(s, c);
    return sagi_quadric_sign(&form, p) <= 0;
}
