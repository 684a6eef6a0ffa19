// SPDX-License-Identifier: MIT
#include "support/adversarial.h"

static sag_vec3 near_point(rng *r, const adversary *a, double sizes) {
    return sag_add(a->center, rng_vec3(r, sizes * a->size));
}

static sag_vec3 special(rng *r, const adversary *a) { return a->points[rng_below(r, a->point_count)]; }

// One double up or down. From 0 a step of 2⁻⁸⁰ sizes instead: t must not be too small for a double.
static double nudge(rng *r, const adversary *a, double x) {
    uint32_t choice = rng_below(r, 4);
    if (x == 0 && choice < 2) return (choice == 0 ? 0x1p-80 : -0x1p-80) * a->size;
    return choice == 0 ? nextafter(x, INFINITY) : choice == 1 ? nextafter(x, -INFINITY) : x;
}

static sag_vec3 axis(rng *r) {
    sag_vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    sag_vec3 d = axes[rng_below(r, 3)];
    return rng_one_in(r, 2) ? sag_neg(d) : d; // with zeros of either sign
}

sag_ray adversarial_ray(rng *r, const adversary *a) {
    double far = rng_one_in(r, 4) ? rng_log_uniform(r, 1, 1e9) : 2;
    sag_vec3 o = near_point(r, a, far), target = near_point(r, a, 1);
    sag_vec3 p = special(r, a), q = special(r, a), d;
    switch (rng_below(r, 10)) {
    case 0: // at a special point
        d = sag_sub(p, o);
        break;
    case 1: // along an axis
        d = axis(r), o = sag_madd(target, rng_uniform(r, -3, 3) * a->size, d);
        break;
    case 2: // along an axis through the coordinates of special points
        d = axis(r), o = (sag_vec3){nudge(r, a, p.x), nudge(r, a, q.y), nudge(r, a, p.z)};
        o = sag_madd(o, rng_below(r, 3) * a->size * rng_uniform(r, -2, 2), d);
        break;
    case 3: // from a special point
        o = (sag_vec3){nudge(r, a, p.x), nudge(r, a, p.y), nudge(r, a, p.z)}, d = rng_direction(r);
        break;
    case 4: // from one special point to another, from before it, or beside it
        d = sag_sub(q, p), o = sag_madd(p, -(double)rng_below(r, 3), d);
        o = (sag_vec3){nudge(r, a, o.x), nudge(r, a, o.y), nudge(r, a, o.z)};
        if (sag_dot(d, d) == 0) d = axis(r);
        break;
    case 5: // a denormal or zero part of the direction
        d = sag_sub(target, o);
        *(rng_one_in(r, 2) ? &d.x : rng_one_in(r, 2) ? &d.y : &d.z) = rng_one_in(r, 2) ? -0.0 : 0x1p-1060;
        break;
    case 6: // by whole steps of the exact diagonal, so that edges are met exactly
        d = (sag_vec3){rng_one_in(r, 2) ? 1 : -1, rng_one_in(r, 2) ? 1 : -1, rng_one_in(r, 3) ? 0 : 1};
        o = sag_madd(p, -rng_double(r, 0, 3) * a->size, d);
        break;
    default: d = sag_sub(target, o);
    }
    if (sag_dot(d, d) == 0) d = axis(r);
    if (rng_one_in(r, 8)) d = sag_scale(d, ldexp(1, (int)rng_below(r, 400) - 200));
    sag_ray ray = sag_ray_make(o, d);
    if (rng_one_in(r, 3)) ray.t_min = -INFINITY;
    if (rng_one_in(r, 8)) {
        double t = 2 * rng_unit(r) * a->size / sag_length(d);
        ray.t_min = t * rng_uniform(r, -1, 1), ray.t_max = t;
    }
    return ray;
}
