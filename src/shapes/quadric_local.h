// SPDX-License-Identifier: MIT
// What the files of the quadrics' solver share: quadric_solve.c (doubles and double-doubles), quadric_exact.c
// (400 bits), quadric_place.c (positions).
#ifndef SAGI_SHAPES_QUADRIC_LOCAL_H
#define SAGI_SHAPES_QUADRIC_LOCAL_H

#include "shapes/quadric_solve.h"

#define SAGI_QUADRIC_EPSILON                                                                                 \
    (16 * SAGI_EPSILON)                 // error of a, b, c in doubles, relative to their magnitudes' sum
#define SAGI_QUADRIC_EPSILON_DD 0x1p-99 // error of F in double-double, relative to the same

// The ray in the form's coordinates: y = origin + τ·direction, τ = t·2^exponent.
typedef struct sagi_local_ray {
    sagi_dd origin[3];
    double direction[3];
    double t_min, t_max; // widened a little
    int exponent;
} sagi_local_ray;

// a t² + 2 b t + c with error bounds.
typedef struct sagi_polynomial {
    double a, b, c;
    double a_error, b_error, c_error;
} sagi_polynomial;

sagi_local_ray sagi_quadric_localise(const sagi_quadric_form *form, const sag_ray *ray);
// F at y in double-double, with its error bound; *slope gets ½ dF/dτ there in double, with its own.
double sagi_quadric_residual(const sagi_quadric_form *form, const sagi_dd y[3], const double d[3],
                             double *error, sagi_polynomial *slope);
// Everything with 400 bits, without looking at the range.
sagi_spans sagi_quadric_solve_exactly(const sagi_quadric_form *form, const sagi_local_ray *ray);

// Q v and |Q||v|.
static inline void sagi_quadric_apply(const sagi_quadric_form *f, const double v[3], double out[3],
                                      double magnitude[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = f->square[i].hi * v[i];
        magnitude[i] = fabs(out[i]);
    }
    if (!f->mixed) return;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double xj = f->cross[k].hi * v[j], xk = f->cross[j].hi * v[k];
        out[i] += xj + xk;
        magnitude[i] += fabs(xj) + fabs(xk);
    }
}

static inline sagi_spans sagi_spans_between(double t0, double t1) {
    return (sagi_spans){1, {t0, INFINITY}, {t1, INFINITY}};
}

static inline sagi_spans sagi_spans_everywhere(bool inside) {
    return (sagi_spans){inside, {-INFINITY, INFINITY}, {INFINITY, INFINITY}};
}

// The intervals between two roots (a > 0) or beyond them (a < 0).
static inline sagi_spans sagi_spans_of_roots(double t0, double t1, bool between) {
    if (between) return sagi_spans_between(t0, t1);
    return (sagi_spans){2, {-INFINITY, t1}, {t0, INFINITY}};
}

static inline sagi_spans sagi_spans_of_line(double t, bool rising) {
    return rising ? sagi_spans_between(-INFINITY, t) : sagi_spans_between(t, INFINITY);
}

#endif
