// SPDX-License-Identifier: MIT
// The sphere |o + t d − c| = r, the hot one: the stages of quadric_solve.c written out for it. With l = o −
// c,
//
//     a t² + 2 b t + c = 0,   a = d·d,   b = l·d,   c = l·l − r²,   D = b² − a c.
//
// Error bounds, with u = 2⁻⁵³: l has one rounding in each coordinate; so |b| is off by at most 5u|l||d| (by
// Cauchy and Schwarz the terms' magnitudes sum to at most |l||d|), l·l by 5u l², c by 6u(l² + r²), a by 3u a;
// in D, b² is off by 12u a l² and a c by 11u a (l² + r²): 24u a (l² + r²) in all. The code takes 8u and 32u.
//
// D ≥ 64 · 32u a (l² + r²) holds up to about 10⁶ radii away; farther out, and for grazing rays, the general
// solver moves the origin to the point of closest approach.
//
// It stands here for the kernels, where an error-free product takes two operations in place of 17; its bits
// are the same everywhere. Coordinates are the lanes of a vector, and the fourth lane is the radius, which
// goes through all that happens to l (with a direction of 0), so that its square comes with theirs.
#ifndef SAGI_SHAPES_SPHERE_SOLVE_H
#define SAGI_SHAPES_SPHERE_SOLVE_H

#include "math/dd.h"
#include "math/simd.h"
#include "shapes/common.h"
#include "shapes/sphere.h"
#include <stddef.h>

// By the general solver: the crossings in range; returns how many.
int sagi_sphere_solve_generally(sag_vec3 center, double radius, const sag_ray *ray, double t_max,
                                double t[2]);

// What a solution needs of the ray. The origin's fourth lane is 2r, so that that of l is r.
typedef struct sagi_sphere_line {
    sagi_d4 origin, direction, center;
    double a;
} sagi_sphere_line;

// F at t in about twice the working precision (the compensated dot product of T. Ogita, S. Rump & S. Oishi,
// "Accurate Sum and Dot Product", SISC 26(6), 2005), with an error bound; *b becomes ½ dF/dt there. The point
// is kept as high + low in each coordinate; low is below 2u of |l| + |t d| and known to 2u of itself, the
// squares of the high parts are summed exactly but for their low parts' roundings.
SAGI_INLINE sagi_d4 sagi_sum_error(sagi_d4 a, sagi_d4 b, sagi_d4 sum) { // sagi_two_sum
    sagi_d4 bb = sum - a;
    return (a - (sum - bb)) + (b - bb);
}

SAGI_INLINE double sagi_sphere_residual(const sagi_sphere_line *line, double t, double *b, double *error) {
    sagi_d4 minus = -line->center, time = sagi_d4_fill(t);
    sagi_d4 l = line->origin + minus, l_low = sagi_sum_error(line->origin, minus, l);
    sagi_d4 td = time * line->direction, td_low = sagi_d4_product_error(time, line->direction, td);
    sagi_d4 p = l + td, p_low = sagi_sum_error(l, td, p);
    sagi_d4 low = p_low + (l_low + td_low);
    sagi_d4 square = p * p, square_low = sagi_d4_product_error(p, p, square);
    sagi_d4 rest = square_low + low * (2 * p + low);
    sagi_d4 reach = sagi_d4_abs(l) + sagi_d4_abs(td), size = sagi_d4_abs(p), slope = p * line->direction;
    double high_sum = -square[3], low_sum = -square_low[3];
    for (int i = 0; i < 3; i++) {
        sagi_dd next = sagi_two_sum(high_sum, square[i]);
        high_sum = next.hi;
        low_sum += next.lo + rest[i];
    }
    *b = slope[0] + slope[1] + slope[2];
    *error = 0x1p-98 * ((size[0] + size[1] + size[2]) * (reach[0] + reach[1] + reach[2]) + square[3]);
    return high_sum + low_sum;
}

// As `polish` in quadric_solve.c: makes the root certain to an ulp, or certainly out of range.
SAGI_INLINE bool sagi_sphere_polish(const sagi_sphere_line *line, double t_min, double t_max, double sign,
                                    double *root) {
    double t = *root, a = line->a, rr = line->center[3] * line->center[3];
    for (int i = 0; i < 3; i++) {
        double b, value_error, value = sagi_sphere_residual(line, t, &b, &value_error);
        double size = fabs(b);
        // b's own error, 5u|p||d|, is small beside it where b² ≥ 2⁻⁴⁰ a p², and p² is r² + F.
        if (!(b * sign > 0) || !(b * b >= 0x1p-40 * a * (rr + fabs(value)))) return false;
        if (!(a * (fabs(value) + value_error) <= b * b * 0.25)) return false;
        double step = -value / (b + copysign(sqrt(b * b - a * value), b));
        double error = 0.75 * value_error / size + fabs(step) * 0x1p-29;
        t += step;
        if (error <= SAGI_EPSILON * fabs(t) || t + error < t_min || t - error > t_max) {
            *root = t;
            return true;
        }
    }
    return false;
}

// The first crossing where the ray begins outside and comes closer, so that t₀ = (−b − √D)/a, and where one
// step makes it certain to an ulp; so it is mostly. Then whether it is in range is the caller's question.
// False: it is not to be told so simply, if there is one.
//
// The chain of operations is kept short: 1/a and 1/b are at hand by the time they are wanted; F is summed in
// pairs, (x² + z²) + (y² − r²), each sum with its exact error; and of the root of a s² + 2 b s + F, with
// x = a F/b², only −F/2b · (1 + x/4 + x²/8 + …) two terms are taken: the rest, where x ≤ 2⁻¹⁶, is 2⁻³⁴ of it;
// b's own error may be 2⁻³⁰·⁷, and 2⁻²⁹ stands for all.
SAGI_INLINE bool sagi_sphere_first(sagi_d4 at, const sag_ray *ray, double *root) {
    const sagi_l4 three = {-1, -1, -1, 0}, sign = {0, INT64_MIN, 0, 0};
    const sagi_d4 origin =
        sagi_d4_select(three, sagi_d4_load((const char *)ray + offsetof(sag_ray, origin)), at + at);
    const sagi_d4 d =
        (sagi_d4)(three & (sagi_l4)sagi_d4_load((const char *)ray + offsetof(sag_ray, direction)));
    const sagi_d4 l = origin - at, squares = l * l;
    const double a = sagi_d4_sum3(d * d), b = sagi_d4_sum3(l * d), ll = sagi_d4_sum3(squares);
    const double rr = squares[3], c = ll - rr, size = ll + rr, d2 = b * b - a * c;
    const bool usual = a > 0x1p-120 && a < 0x1p120 && rr > 0x1p-200 && size < 0x1p250;
    const double c_error = 8 * SAGI_EPSILON * size, d2_error = 32 * SAGI_EPSILON * a * size;
    if (!(usual && ray->t_min >= 0 && c > c_error && b < 0 && d2 > 64 * d2_error)) return false;
    double t = (-b - sqrt(d2)) * (1 / a);

    // As in sagi_sphere_residual.
    const sagi_d4 time = sagi_d4_fill(t), l_low = sagi_sum_error(origin, -at, l);
    const sagi_d4 td = time * d, td_low = sagi_d4_product_error(time, d, td);
    const sagi_d4 p = l + td, p_low = sagi_sum_error(l, td, p), low = p_low + (l_low + td_low);
    const sagi_d4 square = p * p, square_low = sagi_d4_product_error(p, p, square);
    const sagi_d4 rest = square_low + low * (2 * p + low);
    const double slope = sagi_d4_sum3(p * d), reach = sagi_d4_sum3(sagi_d4_abs(l) + sagi_d4_abs(td));
    const double width = sagi_d4_sum3(sagi_d4_abs(p));
    const sagi_d4 other = (sagi_d4)((sagi_l4)sagi_d4_turn(square) ^ sign), pair = square + other;
    const sagi_d4 pair_low =
        (rest + (sagi_d4)((sagi_l4)sagi_d4_turn(rest) ^ sign)) + sagi_sum_error(square, other, pair);
    const sagi_dd sum = sagi_two_sum(sagi_d4_first(pair), pair[1]);
    const double value = sum.hi + ((sagi_d4_first(pair_low) + pair_low[1]) + sum.lo);
    const double value_error = 0x1p-98 * (width * reach + rr), value_size = fabs(value);

    const double half = -0.5 / slope, ss = slope * slope, newton = value * half;
    const double step = newton + newton * (newton * (a * half));
    t += step;
    *root = t;
    return slope < 0 && ss >= 0x1p-40 * a * (rr + value_size) &&
           a * (value_size + value_error) <= ss * 0x1p-16 &&
           1.5 * value_error * half + fabs(step) * 0x1p-29 <= SAGI_EPSILON * t;
}

// The crossings in [ray->t_min, t_max] in order, or only the first one: returns how many were written. `at`
// is the centre and the radius; the ray's own t_max is not looked at.
SAGI_INLINE int sagi_sphere_solve(sagi_d4 at, const sag_ray *ray, double t_max, bool nearest, double t[2]) {
    const sagi_l4 three = {-1, -1, -1, 0};
    const double t_min = ray->t_min, radius = at[3];
    double first = 0;
    const bool known = sagi_sphere_first(at, ray, &first);
    if (known && first > t_max) return 0;
    if (known && nearest && first >= t_min) return t[0] = first, 1;
    sagi_sphere_line line;
    line.center = at;
    line.origin = sagi_d4_select(three, sagi_d4_load((const char *)ray + offsetof(sag_ray, origin)), at + at);
    line.direction =
        (sagi_d4)(three & (sagi_l4)sagi_d4_load((const char *)ray + offsetof(sag_ray, direction)));
    sagi_d4 l = line.origin - at, dd = line.direction * line.direction, ld = l * line.direction,
            square = l * l;
    double a = dd[0] + dd[1] + dd[2], b = ld[0] + ld[1] + ld[2], ll = square[0] + square[1] + square[2];
    double rr = square[3], c = ll - rr, size = ll + rr, d2 = b * b - a * c;
    // Out of these ranges products might over- or underflow.
    bool usual = a > 0x1p-120 && a < 0x1p120 && rr > 0x1p-200 && size < 0x1p250;
    double c_error = 8 * SAGI_EPSILON * size, d2_error = 32 * SAGI_EPSILON * a * size;
    if (usual && d2 < -d2_error) return 0;
    const bool forward = t_min >= 0;
    // Outside and going away: b > 0 is certain where b² > (5u)² a l².
    if (usual && forward && c > c_error && b > 0 && b * b > 0x1p-100 * a * ll) return 0;
    if (usual && d2 > 64 * d2_error) {
        line.a = a;
        double root = sqrt(d2), q = -(b + copysign(root, b));
        double ta = q / a, tb = c / q, slack = root * 0x1p-5 / a;
        double t0 = ta < tb ? ta : tb, t1 = ta < tb ? tb : ta;
        if (t0 - slack > t_max || t1 + slack < t_min) return 0;
        int count = 0;
        bool near = !(t0 + slack < t_min) && !(forward && c < -c_error), certain = true;
        if (near) {
            certain = known || sagi_sphere_polish(&line, t_min, t_max, -1, &t0);
            if (known) t0 = first;
            if (certain && t0 >= t_min && t0 <= t_max && !isinf(t0)) t[count++] = t0;
            if (certain && nearest && count == 1) return 1;
        }
        if (certain && t1 - slack > t_max) return count;
        if (certain && sagi_sphere_polish(&line, t_min, t_max, 1, &t1)) {
            if (t1 >= t_min && t1 <= t_max && !isinf(t1)) t[count++] = t1;
            return count;
        }
    }
    return sagi_sphere_solve_generally(sag_vec3_make(at[0], at[1], at[2]), radius, ray, t_max, t);
}

#endif
