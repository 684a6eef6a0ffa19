// SPDX-License-Identifier: MIT
// The first step of triangle_solve.h, where its derivation stands. It comes in two forms that do the same
// operations in the same order, so that the bits of an answer do not depend on which of them it went through:
// for one ray and triangle, vectors of three being vectors of the machine; and for four, each number being
// such a vector, of which each lane is a ray and a triangle of its own.
//
// Cross products want one factor's coordinates turned by one place. Those of edges are turned back (z x y),
// those of d and P forwards (y z x): then (b − a) × (c − a) comes out as (y z x), as d and P stand, and d × P
// as (z x y), as the edges do, and none of the products below turns anything again.
//
// When it is good enough. All errors in units of u; E the longer edge in the maximum norm, |·|₁ the sum of
// the absolute values, k = E²/|D|, g = |d|₁ k. S(x) ≤ 2.01 |x|₁ E² and |D| ≤ 2.01 |d|₁ E², so g ≥ 0.49. As
// the line pierces the triangle, the projection of a is no farther from a than the edges are long, so |P|₁
// ≤ 3.1 E, with 2³⁸u E for the roundings of t₀ and more than enough left. Let 2⁻²⁰ E ≤ |t d|₁ ≤ 2³⁶ E and g
// ≤ 40.
//  * n · P has lost 9.1 S(P), and 4.3u (3.1E + 2|t₀ d|₁) E² by cancellation, which over |D| is at most
//    13.4u g E/|d|₁ + 8.6u g |t₀| < 2⁻²⁰ |t| + 2⁻⁴⁰ |step|. D is good to 7.1 S(d) ≤ 14.3 g |D|; its
//    reciprocal and a product take 2.1 more. So t, less its last rounding, is good to
//        9.2 S(P)/|D| + (14.4g + 2.2) |step| + 2⁻²⁰ |t|;
//    with a little more for the rounding of the bound itself, 2.8 |t| leaves 3.81 |t| in all, less than 4
//    ulp.
//  * The products of M = d × P have lost 4.1 |dᵢ Pⱼ|, those with an edge four more, so that M · (c − a) is
//    good to 8.2 |d|₁ |P|₁ E ≤ 25.5 g |D|; cancellation in P is below 0.1 g |D|. A weight is at most 1, so D
//    and its reciprocal take 14.3g + 2.1 ≤ 18.6 g: in all 45g ≤ 1800, and 2048 is 2⁻⁴².
// The first step is about as long as the triangle, and 14.4g times that is too much where the ray is not much
// longer. From the t that it gave the step is next to nothing; P is then the way from the hit to a, for which
// all of the above holds.
// Underflow: with E ≥ 2⁻²⁰⁰ and |d|₁ ≥ 2⁻⁶² every product that matters is far from it, as |t D| is at least
// 2⁻²⁶ E³. Overflow makes an inf or a NaN of n, so of t, which then is not good.
//
// When t is certainly out of range. A ray that leaves a triangle has its t next to 0 there, which is never
// good in the sense above, but is, nearly always, certainly less than t_min. All of the above holds but for
// the lower bound of |t d|₁, so that cancellation keeps its own terms; with g ≤ 40 these are below
//     13.4u g E/|d|₁ + 8.6u g |t₀| < 2⁻⁴³ E/|d|₁ + 2⁻⁴⁴ (|t| + |step|).
// A product that underflows is off by 2⁻¹⁰⁷⁴, which with E ≥ 2⁻²⁰⁰ is nothing beside the first of them. Twice
// these and 4 |t| leave room for the roundings of t, of the bound and of the comparison.
//
// Wants REAL; MASK, what LESS and AT_MOST of two REALs give, and BOTH and EITHER of two; ALL, a REAL from a
// number; ABS of a REAL; STEP(name);
// and these: STEP(vec3), of three REALs, and STEP(add), sub, mul, max, scale, abs, turn (y z x), turn_back
// (z x y), largest (of the three), product_error (what a REAL times a vector has lost), sum ((x + y) + z) and
// sum4 (of each of four vectors).

typedef struct STEP(pair) {
    STEP(vec3) o, d, a, b, c;
} STEP(pair);

typedef struct STEP(step) {
    STEP(vec3) n, products; // (y z x)
    REAL size, d1, inverse, grazing, step, p_sum;
    REAL t, u, v; // u and v not yet confined
} STEP(step);

// P for t₀.
SAGI_INLINE STEP(vec3) STEP(way_back)(const STEP(pair) * of, STEP(vec3) ao, REAL t0) {
    STEP(vec3) way = STEP(scale)(t0, of->d), way_error = STEP(product_error)(t0, of->d, way);
    STEP(vec3) back = STEP(sub)(ao, of->a);
    STEP(vec3) ao_error = STEP(sub)(STEP(sub)(of->a, STEP(sub)(ao, back)), STEP(add)(of->o, back));
    return STEP(add)(STEP(sub)(ao, way), STEP(sub)(ao_error, way_error));
}

SAGI_INLINE void STEP(solve)(const STEP(pair) * of, STEP(step) * s) {
    STEP(vec3) ao = STEP(sub)(of->a, of->o), ab = STEP(sub)(of->b, of->a), ac = STEP(sub)(of->c, of->a);
    STEP(vec3) turned_ab = STEP(turn_back)(ab), turned_ac = STEP(turn_back)(ac), turned_d = STEP(turn)(of->d);
    STEP(vec3) plus = STEP(mul)(turned_ab, ac), minus = STEP(mul)(ab, turned_ac), n = STEP(sub)(plus, minus);
    REAL denominator = STEP(sum)(STEP(mul)(n, turned_d));
    s->inverse = 1.0 / denominator;
    STEP(vec3) d_size = STEP(abs)(of->d);
    s->d1 = STEP(sum)(d_size);
    s->size = STEP(largest)(STEP(max)(STEP(abs)(ab), STEP(abs)(ac)));
    s->grazing = s->d1 * (s->size * s->size * ABS(s->inverse));

    STEP(vec3) unit = STEP(scale)(1.0 / STEP(sum)(STEP(mul)(of->d, of->d)), of->d);
    REAL t0 = STEP(sum)(STEP(mul)(ao, unit));
    STEP(vec3) p = STEP(way_back)(of, ao, t0), turned_p = STEP(turn)(p);
    STEP(vec3) m = STEP(sub)(STEP(mul)(turned_d, p), STEP(mul)(of->d, turned_p)); // −(d × P)
    s->n = n;
    s->products = STEP(add)(STEP(abs)(plus), STEP(abs)(minus));
    REAL sum[4];
    STEP(sum4)
    (STEP(mul)(n, turned_p), STEP(mul)(s->products, STEP(abs)(turned_p)), STEP(mul)(m, turned_ac),
     STEP(mul)(m, turned_ab), sum);
    s->step = sum[0] * s->inverse;
    s->p_sum = sum[1];
    s->t = t0 + s->step;
    s->u = sum[2] * s->inverse, s->v = sum[3] * -s->inverse;
}

// The same step from the t that it gave; the weights stay.
SAGI_INLINE void STEP(again)(const STEP(pair) * of, STEP(step) * s) {
    STEP(vec3) turned_p = STEP(turn)(STEP(way_back)(of, STEP(sub)(of->a, of->o), s->t));
    s->step = STEP(sum)(STEP(mul)(s->n, turned_p)) * s->inverse;
    s->p_sum = STEP(sum)(STEP(mul)(s->products, STEP(abs)(turned_p)));
    s->t = s->t + s->step;
}

// What t may be off by, in u, less cancellation and its last rounding.
SAGI_INLINE REAL STEP(t_error)(const STEP(step) * s) {
    return 9.4 * (s->p_sum * ABS(s->inverse)) + (14.6 * s->grazing + 4.0) * ABS(s->step);
}

// Whether all of this holds for the step.
SAGI_INLINE MASK STEP(usual)(const STEP(step) * s) {
    return BOTH(BOTH(BOTH(AT_MOST(ALL(0x1p-200), s->size), AT_MOST(s->size, ALL(0x1p199))),
                     BOTH(AT_MOST(ALL(0x1p-62), s->d1), AT_MOST(s->d1, ALL(0x1p64)))),
                BOTH(AT_MOST(s->grazing, ALL(40.0)), AT_MOST(ABS(s->t) * s->d1, 0x1p36 * s->size)));
}

// Whether t and the weights are certainly good enough.
SAGI_INLINE MASK STEP(good)(const STEP(step) * s) {
    REAL t = ABS(s->t);
    return BOTH(STEP(usual)(s),
                BOTH(AT_MOST(STEP(t_error)(s), 2.8 * t), AT_MOST(0x1p-20 * s->size, t * s->d1)));
}

// Whether t is certainly less than t_min or more than t_max.
SAGI_INLINE MASK STEP(beyond)(const STEP(step) * s, REAL t_min, REAL t_max) {
    REAL t = ABS(s->t), cancelled = 0x1p-42 * (s->size / s->d1 + t + ABS(s->step));
    REAL margin = SAGI_EPSILON * (1.01 * STEP(t_error)(s) + 4.0 * t + cancelled);
    return BOTH(STEP(usual)(s), EITHER(LESS(s->t + margin, t_min), LESS(t_max, s->t - margin)));
}

#undef REAL
#undef MASK
#undef BOTH
#undef EITHER
#undef ALL
#undef LESS
#undef AT_MOST
#undef STEP
#undef ABS
