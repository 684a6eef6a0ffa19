// SPDX-License-Identifier: MIT
// The first step of triangle_solve.h, where its derivation stands. It comes in two forms that do the same
// operations in the same order, so that the bits of an answer do not depend on which of them it went through:
// for one ray and triangle, vectors of three being vectors of the machine; and for four, each number being
// such a vector, of which each lane is a ray and a triangle of its own.
//
// What says that a step was good enough is, in full, in sagi_triangle_refine; usual and good are bounds of
// those bounds, of far fewer operations, and what they do not pass is asked again there. With A = |a − o|₁, E
// the longer edge in the maximum norm, k = E²/|D| and g = |d|₁ k ≤ 2¹⁰ (usual), and all errors in units of u:
// S(x) ≤ 2.01 |x|₁ E², so D is good to 14.3 g |D|, and what n·P has lost by cancellation is, over |D|, at most
// 4.3u (A + |t₀ d|₁) k ≤ 4.3u |P|₁ k + 8.7u g |t₀|, as A ≤ |P|₁ + |t₀ d|₁. Where the weights are good |P|₁ is
// at most 330 E, for 21 |P|₁ E ≤ 2¹¹ |n|. With 2⁻²⁰ E ≤ |t d|₁ ≤ 2³⁶ E that is less than 2⁻¹¹ |t| in an error
// of t, and than 0.08 E in one of Q; 15g + 11 < 2¹⁵ goes with the step. So t is good to
// 9.2 S(P)/|D| + 2¹⁵ |step| + 2⁻¹¹ |t|, and 1.8 |t| leaves room for the last; Q to 6.01 |P|₁ + 0.08 E +
// |d|₁ times that.
//
// Wants REAL; MASK, what a comparison of REALs gives; ABS of a REAL; STEP(name); and these:
// STEP(vec3), of three REALs, and STEP(sub), mul, scale, abs, turn (y z x), largest (of the three),
// product_error (what a REAL times a vector has lost), sum2 and sum4 (of each of so many vectors, (x + y) +
// z), sum2_turned (the same of (y, z, x)).

typedef struct STEP(pair) {
    STEP(vec3) o, d, a, b, c;
} STEP(pair);

typedef struct STEP(step) {
    STEP(vec3) ao, ab, ac, turned_ab, turned_ac, plus, minus, m, n, s, p;
    REAL far, size, square, d1, denominator, inverse, estimate, step;
    REAL p_sum, p1, n_square;
    REAL t, u, v; // not yet confined
} STEP(step);

// A first estimate of t.
SAGI_INLINE void STEP(estimate)(const STEP(pair) * of, STEP(step) * s) {
    s->ao = STEP(sub)(of->a, of->o), s->ab = STEP(sub)(of->b, of->a), s->ac = STEP(sub)(of->c, of->a);
    s->turned_ab = STEP(turn)(s->ab), s->turned_ac = STEP(turn)(s->ac);
    s->plus = STEP(mul)(s->ab, s->turned_ac), s->minus = STEP(mul)(s->turned_ab, s->ac);
    s->m = STEP(sub)(s->plus, s->minus), s->n = STEP(turn)(s->m);
    REAL sum[4];
    STEP(sum4)(STEP(mul)(s->ao, s->n), STEP(mul)(of->d, s->n), STEP(abs)(s->ao), STEP(abs)(of->d), sum);
    s->far = sum[2];
    s->d1 = sum[3];
    s->size = STEP(largest)(STEP(max)(STEP(abs)(s->ab), STEP(abs)(s->ac)));
    s->square = s->size * s->size;
    s->denominator = sum[1];
    s->inverse = 1.0 / sum[1];
    s->estimate = sum[0] * s->inverse;
}

// Newton's step, then the weights.
SAGI_INLINE void STEP(improve)(const STEP(pair) * of, STEP(step) * s) {
    // Σ|x_i| s_i is the sum of the absolute values of all products in x · n; 2⁻¹⁰⁰ is for underflow.
    REAL tiny = 0x1p-100 * s->square;
    s->s = STEP(raise)(STEP(turn)(STEP(add)(STEP(abs)(s->plus), STEP(abs)(s->minus))), tiny);
    STEP(vec3) ao = s->ao, way = STEP(scale)(s->estimate, of->d);
    STEP(vec3) way_error = STEP(product_error)(s->estimate, of->d, way), back = STEP(sub)(ao, of->a);
    STEP(vec3) ao_error = STEP(sub)(STEP(sub)(of->a, STEP(sub)(ao, back)), STEP(add)(of->o, back));
    s->p = STEP(add)(STEP(sub)(ao, way), STEP(sub)(ao_error, way_error));
    STEP(vec3) p_size = STEP(abs)(s->p);
    REAL sum[4];
    STEP(sum4)(STEP(mul)(s->n, s->p), STEP(mul)(p_size, s->s), p_size, STEP(mul)(s->n, s->n), sum);
    s->step = sum[0] * s->inverse;
    s->p_sum = sum[1], s->p1 = sum[2], s->n_square = sum[3];
    s->t = s->estimate + s->step;
}
SAGI_INLINE void STEP(weigh)(const STEP(pair) * of, STEP(step) * s) {
    STEP(vec3) q = STEP(sub)(STEP(scale)(s->step, of->d), s->p), turned = STEP(turn)(q);
    STEP(vec3) q_ac = STEP(sub)(STEP(mul)(q, s->turned_ac), STEP(mul)(turned, s->ac));
    STEP(vec3) ab_q = STEP(sub)(STEP(mul)(s->ab, turned), STEP(mul)(s->turned_ab, q));
    REAL inverse = 1.0 / s->n_square, sum[2];
    STEP(sum2_turned)(STEP(mul)(q_ac, s->m), STEP(mul)(ab_q, s->m), sum); // (of the cross products with n)
    s->u = sum[0] * inverse, s->v = sum[1] * inverse;
}

// Whether magnitudes and the angle are such that the bounds below hold.
SAGI_INLINE MASK STEP(usual)(const STEP(step) * s) {
    return (s->size >= 0x1p-200) & (s->size <= 0x1p199) & (s->d1 >= 0x1p-62) & (s->d1 <= 0x1p64) &
           (s->d1 * (s->square * ABS(s->inverse)) <= 0x1p10);
}

// Whether t is certainly out of range.
SAGI_INLINE MASK STEP(outside)(const STEP(step) * s, REAL t_min, REAL t_max) {
    REAL reach = s->far + ABS(s->estimate) * s->d1;
    REAL margin = 0x1p-48 * (reach * (s->square * ABS(s->inverse)) + ABS(s->estimate));
    return (s->estimate + margin < t_min) | (s->estimate - margin > t_max);
}

// Whether t and the weights are certainly good enough.
SAGI_INLINE MASK STEP(good)(const STEP(step) * s) {
    REAL t = ABS(s->t), length = t * s->d1;
    REAL t_error = 9.4 * s->p_sum * ABS(s->inverse) + 0x1p15 * ABS(s->step);
    REAL weight_error = 43 * s->square + 3.5 * s->size * (6.1 * s->p1 + t_error * s->d1);
    return (length >= 0x1p-20 * s->size) & (length <= 0x1p36 * s->size) & (t_error <= 1.8 * t) &
           (weight_error * weight_error <= 0x1p22 * s->n_square);
}

#undef REAL
#undef MASK
#undef STEP
#undef ABS
