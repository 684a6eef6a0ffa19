// SPDX-License-Identifier: MIT
// The steps of quadric_solve.c, in line for it and for the kernels (outline.h), where an error-free product
// takes two operations in place of 17. Their bits are the same everywhere.
#ifndef SAGI_SHAPES_QUADRIC_STEPS_H
#define SAGI_SHAPES_QUADRIC_STEPS_H

#include "shapes/quadric_local.h"

#define SAGI_QUADRIC_FARTHEST 0x1p200 // beyond that many sizes of the shape b² may overflow: a miss
#define SAGI_QUADRIC_GUARD    64      // D must be this many times its error for the roots to be good guesses

static inline void sagi_quadric_square_term(const sagi_quadric_form *f, const double d[3],
                                            sagi_polynomial *p) {
    double qd[3], magnitude[3];
    sagi_quadric_apply(f, d, qd, magnitude);
    p->a = qd[0] * d[0] + qd[1] * d[1] + qd[2] * d[2];
    p->a_error = SAGI_QUADRIC_EPSILON *
                 (magnitude[0] * fabs(d[0]) + magnitude[1] * fabs(d[1]) + magnitude[2] * fabs(d[2]));
}

// b and c at the point y, itself good to one rounding in each coordinate.
static inline void sagi_quadric_expand(const sagi_quadric_form *f, const double y[3], const double d[3],
                                       sagi_polynomial *p) {
    double g[3], magnitude[3];
    sagi_quadric_apply(f, y, g, magnitude);
    double b = 0, b_sum = 0, c = f->constant.hi, c_sum = fabs(c);
    for (int i = f->mixed ? 0 : 2; i < 3; i++) {
        double l = f->linear[i].hi;
        g[i] += l;
        magnitude[i] += fabs(l);
        c += l * y[i];
        c_sum += fabs(l * y[i]);
    }
    for (int i = 0; i < 3; i++) {
        b += g[i] * d[i];
        b_sum += magnitude[i] * fabs(d[i]);
        c += g[i] * y[i];
        c_sum += magnitude[i] * fabs(y[i]);
    }
    p->b = b, p->c = c;
    p->b_error = SAGI_QUADRIC_EPSILON * b_sum, p->c_error = SAGI_QUADRIC_EPSILON * c_sum;
}

static inline double sagi_quadric_discriminant(const sagi_polynomial *p, double *error) {
    double bb = p->b * p->b, ac = p->a * p->c;
    *error = (2 * fabs(p->b) + p->b_error) * p->b_error + fabs(p->c) * p->a_error +
             (fabs(p->a) + p->a_error) * p->c_error + 4 * SAGI_EPSILON * (bb + fabs(ac));
    return bb - ac;
}

// F at y in double-double, with its error bound; p->b gets ½ dF/dτ there in double, with its own.
static inline double sagi_quadric_value(const sagi_quadric_form *f, const sagi_dd y[3], const double d[3],
                                        double *error, sagi_polynomial *p) {
    double b = 0, b_sum = 0, sum = fabs(f->constant.hi);
    sagi_dd value = f->constant;
    for (int i = 0; i < 3; i++) {
        sagi_dd g = sagi_dd_mul(f->square[i], y[i]);
        double magnitude = fabs(g.hi);
        if (f->mixed) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            sagi_dd gj = sagi_dd_mul(f->cross[k], y[j]), gk = sagi_dd_mul(f->cross[j], y[k]);
            g = sagi_dd_add(g, sagi_dd_add(gj, gk));
            magnitude += fabs(gj.hi) + fabs(gk.hi);
        }
        double half = g.hi;
        if (f->mixed || i == 2) {
            half += f->linear[i].hi;
            b_sum += fabs(f->linear[i].hi * d[i]);
            magnitude += 2 * fabs(f->linear[i].hi);
            g = sagi_dd_add(g, (sagi_dd){2 * f->linear[i].hi, 2 * f->linear[i].lo});
        }
        value = sagi_dd_add(value, sagi_dd_mul(g, y[i]));
        sum += magnitude * fabs(y[i].hi);
        b += half * d[i];
        b_sum += magnitude * fabs(d[i]);
    }
    p->b = b, p->b_error = SAGI_QUADRIC_EPSILON * b_sum;
    *error = SAGI_QUADRIC_EPSILON_DD * sum;
    return value.hi;
}

// Improves the root *t, at which b must have the given sign, until it is certain to half an ulp before the
// last rounding, or certainly out of range. False when it cannot be.
static inline bool sagi_quadric_polish(const sagi_quadric_form *form, const sagi_local_ray *ray,
                                       const sagi_polynomial *whole, double sign, double *root) {
    double t = *root;
    for (int i = 0; i < 4; i++) {
        sagi_dd y[3];
        for (int k = 0; k < 3; k++) y[k] = sagi_dd_add(ray->origin[k], sagi_two_prod(t, ray->direction[k]));
        sagi_polynomial p;
        double value_error, value = sagi_quadric_value(form, y, ray->direction, &value_error, &p);
        double size = fabs(p.b);
        if (!(p.b * sign > 0) || !(p.b_error <= size * 0x1p-6)) return false;
        if (!((fabs(whole->a) + whole->a_error) * (fabs(value) + value_error) <= p.b * p.b * 0.25))
            return false;
        double step = -value / (p.b + copysign(sqrt(p.b * p.b - whole->a * value), p.b));
        double wide = fabs(step);
        double error = 0.75 * value_error / size + wide * (1.4 * p.b_error / size + SAGI_QUADRIC_EPSILON) +
                       0.75 * wide * wide * whole->a_error / size;
        t += step;
        bool certain = error <= SAGI_EPSILON * fabs(t) || t + error < ray->t_min || t - error > ray->t_max;
        if (!certain) continue;
        *root = t;
        return true;
    }
    return false;
}

#endif
