// SPDX-License-Identifier: MIT
// The first step of triangle_solve.h, where its derivation stands. It comes in two forms that do the same
// operations in the same order, so that the bits of an answer do not depend on which of them it went through:
// for one ray and triangle, vectors of three being vectors of the machine; and for four, each number being
// such a vector, of which each lane is a ray and a triangle of its own.
//
// Wants REAL; MASK, what a comparison of REALs gives; ABS of a REAL; STEP(name); and these:
// STEP(vec3), of three REALs, and STEP(sub), mul, scale, abs, turn (y z x), largest (of the three),
// product_error (what a REAL times a vector has lost), sum2 and sum4 (of each of so many vectors, (x + y) +
// z).

typedef struct STEP(pair) {
    STEP(vec3) o, d, a, b, c;
} STEP(pair);

typedef struct STEP(step) {
    STEP(vec3) ao, ab, ac, n, s, p;
    REAL far, size, square, d1, ao_sum, d_sum, p_sum, p1, n_square;
    REAL denominator_error, inverse, scale, division, estimate, step;
    REAL error;   // of t, less the last rounding
    REAL t, u, v; // not yet confined
} STEP(step);

// A first estimate of t. False where the magnitudes or the angle are such that doubles will not do.
SAGI_INLINE MASK STEP(estimate)(const STEP(pair) * of, STEP(step) * s) {
    STEP(vec3) ao = STEP(sub)(of->a, of->o), ab = STEP(sub)(of->b, of->a), ac = STEP(sub)(of->c, of->a);
    STEP(vec3) plus = STEP(mul)(ab, STEP(turn)(ac)), minus = STEP(mul)(STEP(turn)(ab), ac);
    STEP(vec3) n = STEP(turn)(STEP(sub)(plus, minus)), ao_size = STEP(abs)(ao), d_size = STEP(abs)(of->d);
    s->ao = ao, s->ab = ab, s->ac = ac, s->n = n;
    REAL sum[4];
    STEP(sum2)(ao_size, d_size, sum);
    s->far = sum[0] + 0x1p-300; // with the limits below, the bounds cover all underflow
    s->d1 = sum[1];
    s->size = STEP(largest)(STEP(max)(STEP(abs)(ab), STEP(abs)(ac)));

    // Σ|x_i| s_i is the sum of the absolute values of all products in x · n; `tiny` is for underflow.
    s->square = s->size * s->size;
    REAL tiny = 0x1p-100 * s->square;
    s->s = STEP(raise)(STEP(turn)(STEP(add)(STEP(abs)(plus), STEP(abs)(minus))), tiny);
    STEP(sum4)(STEP(mul)(ao, n), STEP(mul)(of->d, n), STEP(mul)(ao_size, s->s), STEP(mul)(d_size, s->s), sum);
    REAL numerator = sum[0], denominator = sum[1];
    s->ao_sum = sum[2] + 0x1p-300 * s->square;
    s->d_sum = sum[3];
    s->denominator_error = (7.1 * SAGI_EPSILON) * s->d_sum;
    s->inverse = 1.0 / denominator;
    s->estimate = numerator * s->inverse;
    s->scale = 1.01 * ABS(s->inverse);
    return (s->far <= 0x1p400) & (s->size >= 0x1p-200) & (s->size <= 0x1p200) &
           (s->denominator_error <= 0x1p-10 * ABS(denominator));
}

// Whether t is certainly out of range. The margin of 8u |t| makes sure that it would be when rounded, too.
SAGI_INLINE MASK STEP(outside)(const STEP(step) * s, REAL t_min, REAL t_max) {
    const double eps = SAGI_EPSILON;
    REAL error = ((8.1 * eps) * s->ao_sum + ABS(s->estimate) * s->denominator_error) * s->scale;
    REAL margin = error + (8 * eps) * ABS(s->estimate);
    return (s->estimate + margin < t_min) | (s->estimate - margin > t_max);
}

// With s->step, good to `step_error`: t, and whether that is good enough.
SAGI_INLINE MASK STEP(take)(STEP(step) * s, REAL step_error) {
    s->error = step_error + ABS(s->step) * s->division;
    s->t = s->estimate + s->step;
    return s->error <= (1.9 * SAGI_EPSILON) * ABS(s->t);
}

// Newton's step, and whether it is good enough.
SAGI_INLINE MASK STEP(improve)(const STEP(pair) * of, STEP(step) * s) {
    const double eps = SAGI_EPSILON;
    STEP(vec3) ao = s->ao, way = STEP(scale)(s->estimate, of->d);
    STEP(vec3) way_error = STEP(product_error)(s->estimate, of->d, way), back = STEP(sub)(ao, of->a);
    STEP(vec3) ao_error = STEP(sub)(STEP(sub)(of->a, STEP(sub)(ao, back)), STEP(add)(of->o, back));
    s->p = STEP(add)(STEP(sub)(ao, way), STEP(sub)(ao_error, way_error));
    STEP(vec3) p_size = STEP(abs)(s->p);
    REAL sum[4];
    STEP(sum4)(STEP(mul)(s->n, s->p), STEP(mul)(p_size, s->s), p_size, STEP(mul)(s->n, s->n), sum);
    s->step = sum[0] * s->inverse;
    s->p_sum = sum[1], s->p1 = sum[2], s->n_square = sum[3];
    REAL cancelled = (2.1 * eps * eps) * (s->ao_sum + ABS(s->estimate) * s->d_sum);
    s->division = s->denominator_error * s->scale + 5 * eps;
    return STEP(take)(s, ((9.1 * eps) * s->p_sum + cancelled) * s->scale);
}

// The weights, and whether they are good enough.
SAGI_INLINE MASK STEP(conclude)(const STEP(pair) * of, STEP(step) * s) {
    const double eps = SAGI_EPSILON;
    STEP(vec3) q = STEP(sub)(STEP(scale)(s->step, of->d), s->p);
    STEP(vec3) turned = STEP(turn)(q);
    STEP(vec3) q_ac = STEP(sub)(STEP(mul)(q, STEP(turn)(s->ac)), STEP(mul)(turned, s->ac));
    STEP(vec3) ab_q = STEP(sub)(STEP(mul)(s->ab, turned), STEP(mul)(STEP(turn)(s->ab), q));
    REAL inverse = 1.0 / s->n_square, sum[2];
    STEP(sum2)(STEP(mul)(STEP(turn)(q_ac), s->n), STEP(mul)(STEP(turn)(ab_q), s->n), sum);
    s->u = sum[0] * inverse, s->v = sum[1] * inverse;
    REAL q_error = (6 * eps) * s->p1 + (2 * eps * eps) * (s->far + ABS(s->estimate) * s->d1) +
                   (s->error + (6 * eps) * ABS(s->step)) * s->d1;
    // Of u and v: 28u |Q| E + 14u E² for the roundings, 3.5 E times Q's error, over |n|; |Q| ≤ E.
    REAL weight_error = (42 * eps) * s->square + 3.5 * q_error * s->size;
    return weight_error * weight_error <= 0x1p-84 * s->n_square;
}

#undef REAL
#undef MASK
#undef STEP
#undef ABS
