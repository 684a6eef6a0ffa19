// SPDX-License-Identifier: MIT
#include "support/triangle_rays.h"

static sag_vec3 blend(const triangle_ray *s, double u, double v) {
    return sag_madd(sag_madd(s->a, u, sag_sub(s->b, s->a)), v, sag_sub(s->c, s->a));
}

static sag_vec3 grid_point(rng *r, int cells, double step) {
    double x = (int)rng_below(r, (uint32_t)cells) - cells / 2;
    double y = (int)rng_below(r, (uint32_t)cells) - cells / 2;
    double z = (int)rng_below(r, (uint32_t)cells) - cells / 2;
    return sag_vec3_make(x * step, y * step, z * step);
}

static double jitter(rng *r) { return rng_one_in(r, 2) ? 0 : rng_double(r, -60, -40); }

// Triangles of any shape, rays aimed somewhere near; origins at any distance.
static void make_random(rng *r, double scale, triangle_ray *s) {
    sag_vec3 middle = rng_vec3(r, rng_one_in(r, 2) ? scale : scale * rng_log_uniform(r, 1, 1e6));
    s->a = sag_add(middle, rng_vec3(r, scale));
    s->b = sag_add(middle, rng_vec3(r, scale));
    s->c = sag_add(middle, rng_vec3(r, scale));
    double u = rng_uniform(r, -0.2, 1.1), v = rng_uniform(r, -0.2, 1.1);
    sag_vec3 target = blend(s, u, v);
    s->ray.origin = sag_madd(target, scale * rng_log_uniform(r, 1e-6, 1e6), rng_direction(r));
    s->ray.direction = sag_scale(sag_sub(target, s->ray.origin), rng_log_uniform(r, 1e-3, 1e3));
}

// On a coarse grid half of the lines meet an edge or a vertex exactly, many lie in the plane, and many
// triangles have no area.
static void make_grid(rng *r, double scale, triangle_ray *s) {
    double step = exp2(round(log2(scale)));
    s->a = grid_point(r, 5, step);
    s->b = grid_point(r, 5, step);
    s->c = grid_point(r, 5, step);
    s->ray.origin = grid_point(r, 7, step);
    s->ray.direction = grid_point(r, 5, 1);
}

// Aimed at a vertex, an edge, or just beside, as nearly as doubles can.
static void make_edge(rng *r, double scale, triangle_ray *s) {
    make_random(r, scale, s);
    double u = rng_one_in(r, 3) ? 0 : rng_unit(r);
    sag_vec3 target = sag_madd(s->a, u, sag_sub(s->b, s->a));
    s->ray.direction = sag_sub(target, s->ray.origin);
    s->ray.direction.x += s->ray.direction.x * jitter(r);
}

// Rays within roundings of the triangle's plane, needles, and triangles that are nearly flat.
static void make_grazing(rng *r, double scale, triangle_ray *s) {
    make_random(r, scale, s);
    if (rng_one_in(r, 2)) {
        double u = rng_unit(r), off = rng_double(r, -50, -20);
        s->c = sag_madd(blend(s, u, 0), off, rng_vec3(r, scale));
    }
    double u = rng_uniform(r, -3, 3), v = rng_uniform(r, -3, 3), off = rng_double(r, -60, -10);
    s->ray.origin = sag_madd(blend(s, u, v), off, rng_vec3(r, scale));
    u = rng_unit(r);
    s->ray.direction = sag_sub(blend(s, u, (1 - u) * rng_unit(r)), s->ray.origin);
}

// Parallel to an axis, as they come from cameras and scanners.
static void make_axis(rng *r, double scale, triangle_ray *s) {
    make_random(r, scale, s);
    uint32_t axis = rng_below(r, 3);
    double away = rng_double(r, -3, 3) * scale, u = rng_unit(r);
    sag_vec3 target = rng_one_in(r, 2) ? blend(s, u, (1 - u) * rng_unit(r)) : rng_one_in(r, 2) ? s->a : s->b;
    s->ray.direction = sag_vec3_make(axis == 0, axis == 1, axis == 2);
    if (rng_one_in(r, 2)) s->ray.direction = sag_neg(s->ray.direction);
    s->ray.origin = sag_madd(target, away, s->ray.direction);
}

// Starting on the triangle, or so near that t is lost in the cancellation.
static void make_on(rng *r, double scale, triangle_ray *s) {
    make_random(r, scale, s);
    double u = rng_unit(r);
    s->ray.origin = rng_one_in(r, 4) ? s->a : blend(s, u, (1 - u) * rng_unit(r));
    s->ray.origin.x += s->ray.origin.x * jitter(r);
    s->ray.direction = rng_direction(r);
}

// Directions and coordinates of extreme size, origins very far away.
static void make_extreme(rng *r, double scale, triangle_ray *s) {
    if (rng_one_in(r, 2))
        make_edge(r, scale, s);
    else
        make_grid(r, scale, s);
    sag_vec3 d = s->ray.direction;
    if (rng_one_in(r, 3)) s->ray.origin = sag_madd(s->ray.origin, -0x1p20, sag_scale(d, scale));
    int stretch = (int)rng_below(r, 1800) - 900;
    s->ray.direction = sag_vec3_make(ldexp(d.x, stretch), ldexp(d.y, stretch), ldexp(d.z, stretch));
    if (rng_one_in(r, 3)) { // everything moves to another scale
        double factor = exp2(rng_one_in(r, 2) ? -300 : 50);
        s->a = sag_scale(s->a, factor);
        s->b = sag_scale(s->b, factor);
        s->c = sag_scale(s->c, factor);
        s->ray.origin = sag_scale(s->ray.origin, factor);
    }
}

const triangle_ray_kind triangle_ray_kinds[TRIANGLE_RAY_KINDS] = {
    {"random", make_random, 400000},   {"grid", make_grid, 150000}, {"edge", make_edge, 150000},
    {"grazing", make_grazing, 120000}, {"axis", make_axis, 100000}, {"on", make_on, 80000},
    {"extreme", make_extreme, 60000}};
