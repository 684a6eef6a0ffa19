// SPDX-License-Identifier: MIT
// The first step of triangle_solve.h, where its derivation stands, for REAL: a double, or four in a vector,
// of which each lane is a ray and a triangle of its own. Either way the same operations in the same order, so
// the bits of a pair do not depend on which of the two it went through, nor on its neighbours. In three
// parts: after each there is something that may make the rest needless.
//
// Wants REAL, MASK (what a comparison of REALs gives), STEP(name), ABS, MAX and PRODUCT_ERROR(a, b, rounded
// a b).

typedef struct STEP(vec3) {
    REAL x, y, z;
} STEP(vec3);

// Ray and triangle. d1 is |d.x| + |d.y| + |d.z|.
typedef struct STEP(pair) {
    STEP(vec3) o, d, a, b, c;
    REAL d1, t_min, t_max;
} STEP(pair);

typedef struct STEP(step) {
    STEP(vec3) ao, ab, ac, n, s, p;
    REAL far, size, square, ao_sum, d_sum, p_sum, denominator_error, inverse, scale, division;
    REAL estimate, step, step_error;
    MASK usual;   // neither magnitudes nor the angle are such that doubles will not do
    MASK outside; // t is certainly out of range
    MASK near;    // step is as good as it has to be
    MASK good;    // and so is everything
    REAL t, u, v; // not yet confined
} STEP(step);

SAGI_INLINE STEP(vec3) STEP(sub)(STEP(vec3) a, STEP(vec3) b) {
    return (STEP(vec3)){a.x - b.x, a.y - b.y, a.z - b.z};
}
SAGI_INLINE STEP(vec3) STEP(scale)(REAL s, STEP(vec3) a) { return (STEP(vec3)){s * a.x, s * a.y, s * a.z}; }
SAGI_INLINE STEP(vec3) STEP(abs)(STEP(vec3) a) { return (STEP(vec3)){ABS(a.x), ABS(a.y), ABS(a.z)}; }
SAGI_INLINE REAL STEP(sum)(STEP(vec3) a) { return (a.x + a.y) + a.z; }
SAGI_INLINE REAL STEP(dot)(STEP(vec3) a, STEP(vec3) b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
// (a × b) · n
SAGI_INLINE REAL STEP(triple)(STEP(vec3) a, STEP(vec3) b, STEP(vec3) n) {
    STEP(vec3) cross = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return STEP(dot)(cross, n);
}
// The way from a − o = ao as rounded, exactly, less t d, exactly: but for the last rounding of each sum.
SAGI_INLINE REAL STEP(way_back)(REAL a, REAL o, REAL ao, REAL d, REAL t) {
    REAL way = t * d, way_error = PRODUCT_ERROR(t, d, way);
    REAL back = ao - a, ao_error = (a - (ao - back)) - (o + back);
    return (ao - way) + (ao_error - way_error);
}

// A first estimate of t.
SAGI_INLINE void STEP(estimate)(const STEP(pair) * of, STEP(step) * s) {
    const double eps = SAGI_EPSILON;
    STEP(vec3) ao = STEP(sub)(of->a, of->o), ab = STEP(sub)(of->b, of->a), ac = STEP(sub)(of->c, of->a);
    STEP(vec3) plus = {ab.y * ac.z, ab.z * ac.x, ab.x * ac.y};
    STEP(vec3) minus = {ab.z * ac.y, ab.x * ac.z, ab.y * ac.x};
    s->ao = ao, s->ab = ab, s->ac = ac, s->n = STEP(sub)(plus, minus);
    s->far = STEP(sum)(STEP(abs)(ao)) + 0x1p-300; // with the limits below, the bounds cover all underflow
    s->size = MAX(MAX(ABS(ab.x), ABS(ac.x)), MAX(MAX(ABS(ab.y), ABS(ac.y)), MAX(ABS(ab.z), ABS(ac.z))));
    s->usual = (s->far <= 0x1p400) & (s->size >= 0x1p-200) & (s->size <= 0x1p200);

    // Σ|x_i| s_i is the sum of the absolute values of all products in x · n; `tiny` is for underflow.
    s->square = s->size * s->size;
    REAL tiny = 0x1p-100 * s->square;
    s->s.x = (ABS(plus.x) + ABS(minus.x)) + tiny;
    s->s.y = (ABS(plus.y) + ABS(minus.y)) + tiny;
    s->s.z = (ABS(plus.z) + ABS(minus.z)) + tiny;
    REAL numerator = STEP(dot)(ao, s->n), denominator = STEP(dot)(of->d, s->n);
    s->ao_sum = STEP(dot)(STEP(abs)(ao), s->s) + 0x1p-300 * s->square;
    s->d_sum = STEP(dot)(STEP(abs)(of->d), s->s);
    s->denominator_error = (7.1 * eps) * s->d_sum;
    s->usual &= s->denominator_error <= 0x1p-10 * ABS(denominator);

    // The margin of 8u |t| makes sure that what is turned away here would be when rounded, too.
    s->inverse = 1.0 / denominator;
    s->estimate = numerator * s->inverse;
    s->scale = 1.01 * ABS(s->inverse);
    REAL error = ((8.1 * eps) * s->ao_sum + ABS(s->estimate) * s->denominator_error) * s->scale;
    REAL margin = error + (8 * eps) * ABS(s->estimate);
    s->outside = (s->estimate + margin < of->t_min) | (s->estimate - margin > of->t_max);
}

// Newton's step from there, and whether it is good enough.
SAGI_INLINE void STEP(improve)(const STEP(pair) * of, STEP(step) * s) {
    const double eps = SAGI_EPSILON;
    s->p.x = STEP(way_back)(of->a.x, of->o.x, s->ao.x, of->d.x, s->estimate);
    s->p.y = STEP(way_back)(of->a.y, of->o.y, s->ao.y, of->d.y, s->estimate);
    s->p.z = STEP(way_back)(of->a.z, of->o.z, s->ao.z, of->d.z, s->estimate);
    s->step = STEP(dot)(s->n, s->p) * s->inverse;
    s->p_sum = STEP(dot)(STEP(abs)(s->p), s->s);
    REAL cancelled = (2.1 * eps * eps) * (s->ao_sum + ABS(s->estimate) * s->d_sum);
    s->step_error = ((9.1 * eps) * s->p_sum + cancelled) * s->scale;
    s->division = s->denominator_error * s->scale + 5 * eps;
    s->near = s->step_error + ABS(s->step) * s->division <= (1.9 * eps) * ABS(s->estimate + s->step);
}

// t and the weights.
SAGI_INLINE void STEP(conclude)(const STEP(pair) * of, STEP(step) * s) {
    const double eps = SAGI_EPSILON;
    REAL error = s->step_error + ABS(s->step) * s->division;
    s->t = s->estimate + s->step;
    STEP(vec3) q = STEP(sub)(STEP(scale)(s->step, of->d), s->p);
    REAL q_error = (6 * eps) * STEP(sum)(STEP(abs)(s->p)) +
                   (2 * eps * eps) * (s->far + ABS(s->estimate) * of->d1) +
                   (error + (6 * eps) * ABS(s->step)) * of->d1;
    // Of u and v: 28u |Q| E + 14u E² for the roundings, 3.5 E times Q's error, over |n|; |Q| ≤ E.
    REAL weight_error = (42 * eps) * s->square + 3.5 * q_error * s->size;
    REAL n_square = STEP(dot)(s->n, s->n);
    s->good = (error <= (1.9 * eps) * ABS(s->t)) & (weight_error * weight_error <= 0x1p-84 * n_square);
    REAL inverse = 1.0 / n_square;
    s->u = STEP(triple)(q, s->ac, s->n) * inverse;
    s->v = STEP(triple)(s->ab, q, s->n) * inverse;
}

#undef REAL
#undef MASK
#undef STEP
#undef ABS
#undef MAX
#undef PRODUCT_ERROR
