// SPDX-License-Identifier: MIT
// The first crossings of four rays from one point and a torus, in doubles and double-doubles. torus_solve.c
// has the equation F and its quartic f(s) along a ray; every crossing it reports is the exact root rounded to
// nearest, so what is found here in another way has the same bits.
//
// 1. As there: the interval [low, high] of s in which a crossing can be. A ray without one misses.
// 2. From low, where f > 0, the ray walks up to the first root without ever passing one. At x let f(x) be at
//    least y > 0, f'(x) at least g and f''/2 nowhere below h < 0. Then f(x + s) ≥ y + gs + hs² for s ≥ 0,
//    which is positive up to
//        s = 2y / (√(g² − 4hy) − g) = (g + √(g² − 4hy)) / −2h,
//    and so far the ray may go. Near a root that is Newton's step but for its curvature's being another, so
//    it converges quadratically, from one side. (f''/2 = c₂ + 3c₃s + 6c₄s² ≥ c₂ − 3c₃²/8c₄. A lower bound of
//    the values in doubles: quartic.c has their errors, here taken at the far end of the interval.) A ray
//    that comes to high so has no crossing.
// 3. Where y is small, one step of Newton in double-double, as `polish` in torus_solve.c: where its bounds
// say that
//    the slope keeps its sign all the way, and that all numbers within its error round to the same double.
//
// What begins within the interval, is of unusual size or does not converge is "unknown".
#ifndef SAGI_SHAPES_TORUS_FOUR_H
#define SAGI_SHAPES_TORUS_FOUR_H

#include "math/dd_four.h"
#include "shapes/outline_four.h"

#define SAGI_TORUS_STEPS 16 // more are not taken

// What depends on the torus and the origin: lengths are multiplied by `shrink`, a power of two.
typedef struct sagi_torus_origin {
    double o[3], major, minor, t_min, shrink, grow;
    sagi_dd k;
    bool usual;
} sagi_torus_origin;

static inline sagi_torus_origin sagi_torus_origin_make(const sag_torus *torus, sag_vec3 at, double t_min) {
    sagi_torus_origin from = {.usual = false};
    const double whole = torus->major_radius + torus->minor_radius;
    if (!(whole > 0x1p-200 && whole < 0x1p200 && torus->major_radius > 0 && torus->minor_radius > 0))
        return from;
    const int exponent = ilogb(whole);
    const double shrink = ldexp(1, -exponent), o[3] = {at.x, at.y, at.z};
    from.shrink = shrink, from.grow = ldexp(1, exponent);
    from.usual = true;
    for (int i = 0; i < 3; i++) {
        from.o[i] = o[i] * shrink;
        if (!(fabs(from.o[i]) < 0x1p40)) from.usual = false;
    }
    from.major = torus->major_radius * shrink, from.minor = torus->minor_radius * shrink;
    from.t_min = t_min * shrink;
    from.k = sagi_dd_sub(sagi_two_prod(from.major, from.major), sagi_two_prod(from.minor, from.minor));
    if (!(from.minor > 0x1p-40 && fabs(from.t_min) < 0x1p60)) from.usual = false;
    return from;
}

typedef struct sagi_torus_line {
    sagi_d4 d[3], t0, low, high, t_max; // t = t₀ + s
    sagi_d4 c[5], sizes[5];
} sagi_torus_line;

SAGI_INLINE bool sagi_l4_any(sagi_l4 a) { return sagi_d4_signs((sagi_d4)a) != 0; }

// Steps 1: `localise`; returns those of the lanes that may have a crossing.
SAGI_INLINE sagi_l4 sagi_torus_localise4(const sagi_torus_origin *from, sagi_torus_line *l, sagi_l4 lanes) {
    const double reach = from->major + from->minor * 1.0625, height = from->minor * 1.0625;
    sagi_d4 od = sagi_d4_fill(0), dd = od, p[3], b = od, c = od;
    for (int i = 0; i < 3; i++) od += sagi_d4_fill(from->o[i]) * l->d[i], dd += l->d[i] * l->d[i];
    l->t0 = -od / dd;
    for (int i = 0; i < 3; i++) {
        p[i] = sagi_dd4_add_double(sagi_two_prod4(l->t0, l->d[i]), sagi_d4_fill(from->o[i])).hi;
        b += p[i] * l->d[i], c += p[i] * p[i];
    }
    sagi_d4 root = b * b + dd * (sagi_d4_fill(reach * reach) - c);
    lanes &= sagi_d4_above(root, 0);
    if (!sagi_l4_any(lanes)) return lanes;
    root = sagi_d4_sqrt(root);
    l->low = (-b - root) / dd, l->high = (-b + root) / dd;
    const sagi_l4 clipped = sagi_d4_above(sagi_d4_abs(l->d[2]) * (l->high - l->low), 0x1p-20 * height);
    const sagi_d4 up = sagi_d4_fill(height), top = (up - p[2]) / l->d[2], bottom = (-up - p[2]) / l->d[2];
    const sagi_d4 low = sagi_d4_max(sagi_d4_min(top, bottom), l->low),
                  high = sagi_d4_min(sagi_d4_max(top, bottom), l->high);
    const sagi_l4 aside = sagi_d4_above(sagi_d4_abs(p[2] + l->d[2] * l->low), height) &
                          sagi_d4_above(sagi_d4_abs(p[2] + l->d[2] * l->high), height);
    lanes &= clipped | ~aside;
    l->low = sagi_d4_select(clipped, low, l->low), l->high = sagi_d4_select(clipped, high, l->high);
    lanes &= sagi_d4_less(l->low, l->high);
    const sagi_d4 slack = 0x1p-18 * (l->high - l->low) + 0x1p-48 * sagi_d4_abs(l->t0);
    lanes &= ~(sagi_d4_below(l->t0 + l->high + slack, from->t_min) |
               sagi_d4_less(l->t_max, l->t0 + l->low - slack));
    if (!sagi_l4_any(lanes)) return lanes;

    // `set_quartic`.
    const sagi_d4 r4 = sagi_d4_fill(4 * from->major * from->major), k = sagi_d4_fill(from->k.hi);
    const sagi_d4 xd = p[0] * l->d[0], yd = p[1] * l->d[1], zd = p[2] * l->d[2];
    const sagi_d4 a2 = l->d[0] * l->d[0] + l->d[1] * l->d[1], c2 = p[0] * p[0] + p[1] * p[1], b2 = xd + yd;
    const sagi_d4 b2_size = sagi_d4_abs(xd) + sagi_d4_abs(yd), b_size = b2_size + sagi_d4_abs(zd);
    const sagi_d4 q = c + k, q_size = c + sagi_d4_abs(k);
    l->c[4] = l->sizes[4] = dd * dd;
    l->c[3] = 4 * dd * b, l->sizes[3] = 4 * dd * b_size;
    l->c[2] = 2 * dd * q + 4 * b * b - r4 * a2, l->sizes[2] = 2 * dd * q_size + 4 * b_size * b_size + r4 * a2;
    l->c[1] = 4 * b * q - 2 * r4 * b2, l->sizes[1] = 4 * b_size * q_size + 2 * r4 * b2_size;
    l->c[0] = q * q - r4 * c2, l->sizes[0] = q_size * q_size + r4 * c2;
    return lanes;
}

// Step 2. Leaves in *at where the walk ended; returns the lanes that came to a root, and takes from *lanes
// those that came to the end.
SAGI_INLINE sagi_l4 sagi_torus_walk4(const sagi_torus_line *l, sagi_l4 *lanes, sagi_d4 *at) {
    const sagi_d4 *c = l->c, far = sagi_d4_max(sagi_d4_abs(l->low), sagi_d4_abs(l->high));
    sagi_d4 error = l->sizes[4], slope_error = 4 * l->sizes[4];
    for (int k = 3; k >= 0; k--) error = error * far + l->sizes[k];
    for (int k = 3; k >= 1; k--) slope_error = slope_error * far + k * l->sizes[k];
    const sagi_d4 near = 0x1p-36 * error;
    error *= 0x1p-47, slope_error *= 0x1p-47;
    const sagi_d4 size = l->sizes[2] + l->sizes[3] * l->sizes[3] / l->sizes[4];
    sagi_d4 h = c[2] - 0.375 * c[3] * c[3] / c[4] - 0x1p-46 * size;
    h = sagi_d4_min(h, -0x1p-20 * size);
    sagi_d4 x = l->low;
    sagi_l4 left = *lanes, there = {0, 0, 0, 0};
    for (int i = 0; i < SAGI_TORUS_STEPS && sagi_l4_any(left); i++) {
        sagi_d4 y = c[4], g = sagi_d4_fill(0);
        for (int k = 3; k >= 0; k--) g = g * x + y, y = y * x + c[k];
        y -= error, g -= slope_error;
        const sagi_l4 ends = left & ~sagi_d4_less(near, y), rises = sagi_d4_above(g, 0);
        there |= ends, left &= ~ends;
        const sagi_d4 root = sagi_d4_sqrt(g * g - 4 * h * y);
        const sagi_d4 top = sagi_d4_select(rises, g + root, 2 * y),
                      bottom = sagi_d4_select(rises, -2 * h, root - g);
        const sagi_d4 next = x + top / bottom * (1 - 0x1p-40);
        x = sagi_d4_select(left, next, x);
        const sagi_l4 past = left & sagi_d4_less(l->high, x);
        *lanes &= ~past, left &= ~past;
    }
    *at = x;
    return there;
}

// Step 3. The lanes whose t is certain.
SAGI_INLINE sagi_l4 sagi_torus_polish4(const sagi_torus_origin *from, const sagi_torus_line *l, sagi_d4 s,
                                       sagi_d4 *result) {
    const sagi_dd4 none = {sagi_d4_fill(0), sagi_d4_fill(0)};
    sagi_dd4 t = sagi_two_sum4(l->t0, s), rho2 = none, norm2 = none;
    sagi_d4 pd = none.hi, rd = pd, dd = pd, size = pd, reach = pd;
    for (int i = 0; i < 3; i++) {
        const sagi_dd4 step = sagi_dd4_mul_double(t, l->d[i]);
        const sagi_dd4 p = sagi_dd4_add_double(step, sagi_d4_fill(from->o[i])), square = sagi_dd4_mul(p, p);
        norm2 = sagi_dd4_add(norm2, square);
        if (i < 2) rho2 = norm2, rd += p.hi * l->d[i];
        pd += p.hi * l->d[i], dd += l->d[i] * l->d[i];
        size += sagi_d4_abs(p.hi);
        reach = sagi_d4_max(reach, sagi_d4_abs(step.hi) + sagi_d4_fill(fabs(from->o[i])));
    }
    const sagi_dd r4 = sagi_two_prod(from->major, 4 * from->major);
    const sagi_dd4 q = sagi_dd4_add(norm2, sagi_dd4_fill(from->k)),
                   ring = sagi_dd4_mul(sagi_dd4_fill(sagi_dd_neg(r4)), rho2);
    const sagi_d4 f = sagi_dd4_add(sagi_dd4_mul(q, q), ring).hi;
    const sagi_d4 q_size = norm2.hi + sagi_d4_fill(from->major * from->major + from->minor * from->minor);
    const sagi_d4 r4_hi = sagi_d4_fill(r4.hi);
    const sagi_d4 f_error = 0x1p-98 * (q_size * q_size + r4_hi * rho2.hi) +
                            0x1p-100 * reach * (4 * q_size * size + 2 * r4_hi * size);
    const sagi_d4 slope = 4 * q.hi * pd - 2 * r4_hi * rd,
                  slope_error = 0x1p-47 * (4 * q_size + 2 * r4_hi) * size;
    const sagi_d4 bend = 8 * pd * pd + (4 * q_size + 2 * r4_hi) * dd;
    const sagi_d4 step = f / slope, length = sagi_d4_abs(step), steep = -slope;
    t = sagi_dd4_add_double(t, -step);
    sagi_l4 good = sagi_d4_less(2 * slope_error, steep) & sagi_d4_less(length * bend, 0x1p-3 * steep);
    const sagi_d4 error =
        1.001 * (2 * f_error + length * (slope_error + bend * length)) / steep + 0x1p-104 * sagi_d4_abs(t.hi);
    // (Rounding is monotone: both are t.hi where the larger is not more and the smaller not less.)
    good &= sagi_d4_at_most(t.hi + (t.lo + error), t.hi) & sagi_d4_at_most(t.hi, t.hi + (t.lo - error));
    *result = t.hi;
    return good;
}

// For those lanes: r->hit is where r->t is, r->unknown where to ask the torus itself.
SAGI_INLINE void sagi_torus_first4(const sagi_torus_origin *from, sagi_outline_four *r, sagi_l4 lanes) {
    sagi_d4 size[3];
    for (int i = 0; i < 3; i++) size[i] = sagi_d4_abs(r->d[i]);
    const sagi_d4 largest = sagi_d4_max(sagi_d4_max(size[0], size[1]), size[2]);
    // The error bounds have room for as much.
    sagi_l4 usual = sagi_d4_at_most(sagi_d4_fill(0.25), largest) & sagi_d4_at_most(largest, sagi_d4_fill(2));
    if (!from->usual) usual ^= usual;
    const sagi_l4 nothing = {0, 0, 0, 0};
    r->hit = nothing, r->primitive = sagi_d4_fill(0);
    r->unknown = lanes & ~usual;
    lanes &= usual;
    if (!sagi_l4_any(lanes)) return;
    sagi_torus_line l = {.d = {r->d[0], r->d[1], r->d[2]}, .t_max = r->t_max * sagi_d4_fill(from->shrink)};
    lanes = sagi_torus_localise4(from, &l, lanes);
    if (!sagi_l4_any(lanes)) return;
    const sagi_d4 slack = 0x1p-18 * (l.high - l.low) + 0x1p-48 * sagi_d4_abs(l.t0);
    const sagi_l4 ahead = sagi_d4_less(sagi_d4_max(sagi_d4_fill(from->t_min), slack), l.t0 + l.low - slack);
    r->unknown |= lanes & ~ahead;
    lanes &= ahead;
    sagi_d4 at, t;
    const sagi_l4 there = sagi_torus_walk4(&l, &lanes, &at);
    r->unknown |= lanes & ~there;
    lanes &= there;
    if (!sagi_l4_any(lanes)) return;
    const sagi_l4 certain = sagi_torus_polish4(from, &l, at, &t);
    r->unknown |= lanes & ~certain;
    r->hit = lanes & certain & sagi_d4_at_most(t, l.t_max);
    r->t = t * sagi_d4_fill(from->grow);
}

#endif
