// SPDX-License-Identifier: MIT
// The nearest crossings of four rays and a sphere each: the steps of sphere_solve.h, every number being a
// vector of which each lane is a ray and a sphere of its own. The operations are those of sagi_sphere_first
// in the same order, and so are the bits of the answers; what that does not settle is asked there.
#ifndef SAGI_SHAPES_SPHERE_FOUR_H
#define SAGI_SHAPES_SPHERE_FOUR_H

#include "shapes/sphere_solve.h"
#include "shapes/triangle_solve.h"

typedef struct sagi_sphere_four {
    const sag_ray *ray[4];
    sagi_d4 at[4]; // centre and radius of each
    sagi_d4 t;     // what is found
} sagi_sphere_four;

typedef struct sagi_sphere_lines {
    sagi_d4 o[3], d[3], c[3]; // by coordinate
    sagi_d4 l[3], radius;
} sagi_sphere_lines;

// sagi_sphere_solve, the nearest only, for those in `lanes` (bit 0 is the first); returns those that have
// one. Of others t is left with anything, and so is the ray of those that are not asked for.
static inline uint32_t sagi_sphere_solve4(sagi_sphere_four *four, uint32_t lanes) {
    sagi_d4 row[2][4], unused;
    for (int i = 0; i < 4; i++) { // a ray begins with origin, direction, t_min, t_max
        const char *ray = (const char *)four->ray[i];
        row[0][i] = sagi_d4_load(ray), row[1][i] = sagi_d4_load(ray + sizeof(sagi_d4));
    }
    sagi_sphere_lines line;
    const sagi_d4x3 o = sagi_d4_columns(row[0], &line.d[0]), others = sagi_d4_columns(row[1], &unused);
    const sagi_d4x3 c = sagi_d4_columns(four->at, &line.radius);
    line.o[0] = o.x, line.o[1] = o.y, line.o[2] = o.z, line.d[1] = others.x, line.d[2] = others.y;
    line.c[0] = c.x, line.c[1] = c.y, line.c[2] = c.z;
    const sagi_d4 t_min = others.z, t_max = unused;
    // sagi_sphere_first.
    sagi_d4 dd[3], ld[3], square[3];
    for (int i = 0; i < 3; i++) {
        sagi_d4 l = line.l[i] = line.o[i] - line.c[i];
        dd[i] = line.d[i] * line.d[i], ld[i] = l * line.d[i], square[i] = l * l;
    }
    const sagi_d4 a = dd[0] + dd[1] + dd[2], b = ld[0] + ld[1] + ld[2],
                  ll = square[0] + square[1] + square[2];
    const sagi_d4 rr = line.radius * line.radius, away = ll - rr, size = ll + rr, d2 = b * b - a * away;
    const sagi_d4 away_error = 8 * SAGI_EPSILON * size, d2_error = 32 * SAGI_EPSILON * a * size;
    sagi_l4 good = sagi_d4_above(a, 0x1p-120) & sagi_d4_below(a, 0x1p120) & sagi_d4_above(rr, 0x1p-200) &
                   sagi_d4_below(size, 0x1p250);
    good &= sagi_d4_at_most(sagi_d4_fill(0), t_min) & sagi_d4_less(away_error, away) & sagi_d4_below(b, 0) &
            sagi_d4_less(64 * d2_error, d2);
    sagi_d4 t = (-b - sagi_d4_sqrt(d2)) * (1 / a);

    const sagi_d4 rr_low = sagi_d4_product_error(line.radius, line.radius, rr);
    sagi_d4 slope[3], width[3], reach[3], rest[3];
    for (int i = 0; i < 3; i++) {
        const sagi_d4 l = line.l[i], l_low = sagi_sum_error(line.o[i], -line.c[i], l);
        const sagi_d4 td = t * line.d[i], td_low = sagi_d4_product_error(t, line.d[i], td);
        const sagi_d4 p = l + td, p_low = sagi_sum_error(l, td, p), low = p_low + (l_low + td_low);
        square[i] = p * p, rest[i] = sagi_d4_product_error(p, p, square[i]) + low * (2 * p + low);
        reach[i] = sagi_d4_abs(l) + sagi_d4_abs(td), width[i] = sagi_d4_abs(p), slope[i] = p * line.d[i];
    }
    const sagi_d4 xz = square[0] + square[2], yr = square[1] + -rr, sum = xz + yr;
    const sagi_d4 xz_low = (rest[0] + rest[2]) + sagi_sum_error(square[0], square[2], xz);
    const sagi_d4 yr_low = (rest[1] + -rr_low) + sagi_sum_error(square[1], -rr, yr);
    const sagi_d4 value = sum + ((xz_low + yr_low) + sagi_sum_error(xz, yr, sum));
    const sagi_d4 s = slope[0] + slope[1] + slope[2], ss = s * s, value_size = sagi_d4_abs(value);
    const sagi_d4 value_error =
        0x1p-98 * ((width[0] + width[1] + width[2]) * (reach[0] + reach[1] + reach[2]) + rr);
    const sagi_d4 half = -0.5 / s, newton = value * half;
    const sagi_d4 step = newton + newton * (newton * (a * half));
    t += step;
    good &= sagi_d4_below(s, 0) & sagi_d4_at_most(0x1p-40 * a * (rr + value_size), ss);
    good &= sagi_d4_at_most(a * (value_size + value_error), ss * 0x1p-16);
    good &= sagi_d4_at_most(1.5 * value_error * half + sagi_d4_abs(step) * 0x1p-29, SAGI_EPSILON * t);
    good &= sagi_d4_at_most(t_min, t) & sagi_d4_at_most(t, t_max);
    four->t = t;
    uint32_t found = lanes & sagi_d4_signs((sagi_d4)good);
    for (uint32_t left = lanes & ~found; __builtin_expect(left != 0, 0); left &= left - 1) {
        const int i = __builtin_ctz(left);
        double roots[2];
        if (sagi_sphere_solve(four->at[i], four->ray[i], four->ray[i]->t_max, true, roots) == 0) continue;
        four->t[i] = roots[0];
        found |= 1U << i;
    }
    return found;
}

#endif
