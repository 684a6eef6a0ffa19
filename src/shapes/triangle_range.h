// SPDX-License-Identifier: MIT
// Whether a ray's line meets the plane of a triangle certainly outside the ray's range: the question of
// nearly every ray that leaves a surface, which begins so near to its own triangle that floats do not tell.
//
// For any time t₀, with P = a − o − t₀ d, n = (b − a) × (c − a) and D = d · n,
//
//     n · P = D (t − t₀):
//
// its sign and D's say on which side of t₀ the plane is met. With u = 2⁻⁵³ and S(x) the sum of the absolute
// values of all products in x · n, in doubles D is off by 7.1u S(d) (so many roundings lie on a path), and
// n · P by 7.1u S(P) and what P itself is off by: u (1.01 |a − o| + 1.01 |t₀ d| + |P|), at most
// u (2.1 |P| + 2.1 |t₀ d|), in S. A product that underflows is off by 2⁻¹⁰⁷⁵; where that may matter, S and
// the bounds have smallest numbers of their own. (Much larger than the smallest there are: what is subnormal
// takes processors long, and the triangles of walls have a 0 in n.) NaN and infinite numbers are certain of
// nothing.
//
// That the true t is out of range is not enough: the one that triangle_solve.h hands out is off by up to 4
// ulp, 8u |t|, and an answer must not depend on who was asked. So t has to be beyond t₀ by more than that,
// too.
//
// P is the way from the point that the ray has at t₀: so the bound for a ray that ends on a lamp does not
// grow with the way to it, but by the rounding of that point.
#ifndef SAGI_SHAPES_TRIANGLE_RANGE_H
#define SAGI_SHAPES_TRIANGLE_RANGE_H

#include "shapes/triangle_solve.h"

// The range is the ray's, with another t_max. The corners' fourth places hold anything.
SAGI_INLINE bool sagi_triangle_is_beyond(const sag_ray *ray, double t_max, const sagi_d4 corner[3]) {
    const double eps = SAGI_EPSILON;
    const sagi_d4 o = sagi_d4_load((const char *)ray + offsetof(sag_ray, origin));
    const sagi_d4 d = sagi_d4_load((const char *)ray + offsetof(sag_ray, direction));
    const sagi_d4 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const sagi_d4 plus = sagi_solve1_turn_back(ab) * ac, minus = ab * sagi_solve1_turn_back(ac);
    const sagi_d4 n = plus - minus; // (y z x), as what follows
    const sagi_d4 products = (sagi_d4_abs(plus) + sagi_d4_abs(minus)) + sagi_d4_fill(0x1p-900);
    const sagi_d4 turned_d = sagi_solve1_turn(d), way = sagi_solve1_turn(corner[0] - o);
    const sagi_d4 p = way - sagi_d4_fill(ray->t_min) * turned_d;
    double sum[4];
    sagi_solve1_sum4(n * turned_d, products * sagi_d4_abs(turned_d), n * p, products * sagi_d4_abs(p), sum);
    const double d_sum = sum[1] + 0x1p-1020, size = fabs(sum[0]), turn = copysign(1, sum[0]);
    if (!(size > (8 * eps) * d_sum)) return false;
    const double low = fabs(ray->t_min) * eps;
    if (turn * sum[2] < -((11 * eps) * sum[3] + low * (2.5 * d_sum + 8.5 * size) + 0x1p-1000 * (1 + size)))
        return true;
    if (t_max == INFINITY) return false;
    const sagi_d4 q = way - sagi_d4_fill(t_max) * turned_d;
    const double high = fabs(t_max) * eps, q_sum = sagi_solve1_sum(products * sagi_d4_abs(q));
    return turn * sagi_solve1_sum(n * q) >
           (11 * eps) * q_sum + high * (2.5 * d_sum + 8.5 * size) + 0x1p-1000 * (1 + size);
}

#endif
