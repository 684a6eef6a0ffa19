// SPDX-License-Identifier: MIT
// Ray and torus. Without a root the torus (ρ − R)² + z² = r² is
//     F(p) = (|p|² + K)² − 4R²(x² + y²) = 0,   K = R² − r²,
// which is [(ρ − R)² + z² − r²] [(ρ + R)² + z² − r²]: the second factor is the inner sheet of a spindle, and
// positive everywhere for a ring. F > 0 outside, < 0 within the tube, and > 0 again in the lens of a spindle,
// so all sheets are roots of one quartic.
//
// 1. Everything is scaled by powers of two (R + r and the direction near 1), and the ray's parameter moved to
//    the point nearest the center, t = t₀ + s with p₀ = o + t₀ d in double-double: a far origin loses
//    nothing. The slab |z| ≤ r and the sphere |p| ≤ R + r, each r/16 larger, give an interval of s at whose
//    ends F is certainly positive; most rays that miss end here. In it
//        |p|² = A s² + 2B s + C,   x² + y² = a s² + 2b s + c
//    make the quartic's coefficients.
// 2. quartic.c brackets its roots in doubles, or says that it cannot tell how many there are.
// 3. Newton with F in double-double: its error is below 2⁻⁹⁸ of M = (|p|²sum + |K|)² + 4R²ρ², which over |F'|
//    bounds that of t. Enough for a root out of range, or for all numbers that t may be to round to the same
//    double: done. So t is the exact root rounded to nearest, however it was found (torus_four.h).
// 4. For a start on the surface, t near 0, that error is too much beside t. But of f₀ + f₁t + f₂t² + …, the
//    same quartic about the origin, only f₀ = F(o) cancels: with f₀ to 400 bits and the rest in double-double
//    Newton gives t to all its bits; and f₀ = 0 is a start exactly on the surface, t = 0. (OpenMC #1933,
//    #2053: setting f₀ to 0 below 1e-10 is wrong for some R.)
// 5. Else, near tangents, 400 bits throughout: Newton from the guess, or step 2 again. |t| below 2⁻²⁵⁰ is 0.
#include "math/quartic.h"
#include "shapes/torus.h"

typedef struct local {
    sagi_dd p[3]; // p₀
    double o[3], d[3], t0;
    double major, minor;
    sagi_dd k;
    double t_min, t_max;
    int exponent; // t = local t · 2^exponent
    double c[5], sizes[5];
    double low, high; // of s
} local;

// ilogb, ldexp and fmax without a call where exponents are ordinary: products with a power of two are what
// ldexp gives, rounded the same way where they are subnormal.
static inline double power_of_two(int exponent) {
    const union {
        uint64_t bits;
        double value;
    } u = {.bits = (uint64_t)(exponent + 1023) << 52};
    return u.value;
}
static inline double scaled(double x, int exponent) {
    return exponent > -1000 && exponent < 1000 ? x * power_of_two(exponent) : ldexp(x, exponent);
}
static inline int binary_exponent(double x) {
    const union {
        double value;
        uint64_t bits;
    } u = {.value = x};
    const int exponent = (int)(u.bits >> 52 & 2047);
    return exponent > 0 && exponent < 2047 ? exponent - 1023 : ilogb(x);
}
static inline double greatest_of(double a, double b) { return a > b ? a : b; }

static void clip(double *low, double *high, double a, double b) {
    const double near = a < b ? a : b, far = a < b ? b : a;
    *low = near > *low ? near : *low, *high = far < *high ? far : *high;
}

// The interval of s near the torus; false when it is empty.
static bool set_interval(local *l, double aa, double b, double c) {
    double reach = l->major + l->minor * 1.0625, height = l->minor * 1.0625;
    // A s² + 2B s + C = reach², with B nearly 0 by the choice of t₀.
    double rest = reach * reach - c, root = b * b + aa * rest;
    if (!(root > 0)) return false;
    root = sqrt(root);
    l->low = (-b - root) / aa, l->high = (-b + root) / aa;
    double z = l->p[2].hi, dz = l->d[2];
    if (fabs(dz) * (l->high - l->low) > 0x1p-20 * height)
        clip(&l->low, &l->high, (-height - z) / dz, (height - z) / dz);
    else if (fabs(z + dz * l->low) > height && fabs(z + dz * l->high) > height)
        return false;
    return l->low < l->high;
}

static void set_quartic(local *l, double aa, double b, double c) {
    double x = l->p[0].hi, y = l->p[1].hi, dx = l->d[0], dy = l->d[1];
    double k = l->k.hi, r4 = 4 * l->major * l->major;
    double a2 = dx * dx + dy * dy, b2 = x * dx + y * dy, c2 = x * x + y * y;
    double b_size = fabs(x * dx) + fabs(y * dy) + fabs(l->p[2].hi * l->d[2]);
    double q = c + k, q_size = c + fabs(k);
    l->c[4] = aa * aa;
    l->c[3] = 4 * aa * b;
    l->c[2] = 2 * aa * q + 4 * b * b - r4 * a2;
    l->c[1] = 4 * b * q - 2 * r4 * b2;
    l->c[0] = q * q - r4 * c2;
    l->sizes[4] = l->c[4];
    l->sizes[3] = 4 * aa * b_size;
    l->sizes[2] = 2 * aa * q_size + 4 * b_size * b_size + r4 * a2;
    l->sizes[1] = 4 * b_size * q_size + 2 * r4 * (fabs(x * dx) + fabs(y * dy));
    l->sizes[0] = q_size * q_size + r4 * c2;
}

// False when the ray certainly misses the neighbourhood of the torus.
static bool localise(const sag_torus *torus, const sag_ray *ray, local *l) {
    const double o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    int size = binary_exponent(torus->major_radius + torus->minor_radius);
    int length = binary_exponent(greatest_of(fabs(d[0]), greatest_of(fabs(d[1]), fabs(d[2]))));
    double shrink = scaled(1, -size), od = 0, dd = 0;
    for (int i = 0; i < 3; i++) {
        l->o[i] = o[i] * shrink, l->d[i] = scaled(d[i], -length);
        od += l->o[i] * l->d[i], dd += l->d[i] * l->d[i];
    }
    l->major = torus->major_radius * shrink, l->minor = torus->minor_radius * shrink;
    l->k = sagi_dd_sub(sagi_two_prod(l->major, l->major), sagi_two_prod(l->minor, l->minor));
    l->exponent = size - length;
    l->t_min = scaled(ray->t_min, -l->exponent), l->t_max = scaled(ray->t_max, -l->exponent);
    l->t0 = -od / dd;
    if (!isfinite(l->t0)) return false;
    double b = 0, c = 0;
    for (int i = 0; i < 3; i++) {
        l->p[i] = sagi_dd_add_double(sagi_two_prod(l->t0, l->d[i]), l->o[i]);
        b += l->p[i].hi * l->d[i], c += l->p[i].hi * l->p[i].hi;
    }
    if (!set_interval(l, dd, b, c)) return false;
    // Rounded to no less than a whole torus of slack, a range elsewhere ends it.
    double slack = 0x1p-18 * (l->high - l->low) + 0x1p-48 * fabs(l->t0);
    if (l->t0 + l->high + slack < l->t_min || l->t0 + l->low - slack > l->t_max) return false;
    set_quartic(l, dd, b, c);
    return true;
}

// F and its derivatives along the ray.
typedef struct value {
    double f, f_error;         // by double-double
    double slope, slope_error; // F'
    double bend;               // a bound of |F''|
} value;

static value value_at(const local *l, sagi_dd t) {
    sagi_dd rho2 = {0, 0}, norm2 = {0, 0};
    double pd = 0, rd = 0, dd = 0, size = 0, reach = 0;
    for (int i = 0; i < 3; i++) {
        sagi_dd step = sagi_dd_mul_double(t, l->d[i]), p = sagi_dd_add_double(step, l->o[i]);
        sagi_dd square = sagi_dd_mul(p, p);
        norm2 = sagi_dd_add(norm2, square);
        if (i < 2) rho2 = sagi_dd_add(rho2, square), rd += p.hi * l->d[i];
        pd += p.hi * l->d[i], dd += l->d[i] * l->d[i];
        size += fabs(p.hi), reach = greatest_of(reach, fabs(step.hi) + fabs(l->o[i]));
    }
    sagi_dd q = sagi_dd_add(norm2, l->k), r4 = sagi_two_prod(l->major, 4 * l->major);
    double q_size = norm2.hi + l->major * l->major + l->minor * l->minor;
    value v = {.f = sagi_dd_sub(sagi_dd_mul(q, q), sagi_dd_mul(r4, rho2)).hi};
    // p itself is off by 2⁻¹⁰³ of |o| + |t d|, which may be much more than |p|.
    v.f_error = 0x1p-98 * (q_size * q_size + r4.hi * rho2.hi) +
                0x1p-100 * reach * (4 * q_size * size + 2 * r4.hi * size);
    v.slope = 4 * q.hi * pd - 2 * r4.hi * rd;
    v.slope_error = 0x1p-47 * (4 * q_size + 2 * r4.hi) * size;
    v.bend = 8 * pd * pd + (4 * q_size + 2 * r4.hi) * dd;
    return v;
}

typedef enum outcome { FOUND, OUT_OF_RANGE, NOT_CERTAIN } outcome;

// Whether every number within `left` of t, a little more than its bound, rounds to t.hi.
static bool rounds_surely(sagi_dd t, double left) {
    left += 0x1p-104 * fabs(t.hi);
    return t.hi + (t.lo + left) == t.hi && t.hi + (t.lo - left) == t.hi;
}

// Newton in double-double from t; with any_range the range is not looked at.
static outcome polish(const local *l, sagi_dd t, bool any_range, sagi_cut *cut) {
    for (int i = 0; i < 8; i++) {
        value v = value_at(l, t);
        double slope = fabs(v.slope), step = v.f / v.slope, length = fabs(step);
        if (!(slope > 2 * v.slope_error)) return NOT_CERTAIN;
        t = sagi_dd_add_double(t, -step);
        // Newton's theorem needs the slope to change little over the step; then what is left is the square
        // of the step times F''/F', and what F and F' were off.
        if (!(length * v.bend < 0x1p-3 * slope)) return NOT_CERTAIN;
        double left = (2 * v.f_error + length * (v.slope_error + v.bend * length)) / slope;
        if (!any_range && (t.hi + left < l->t_min || t.hi - left > l->t_max)) return OUT_OF_RANGE;
        if (left <= 0x1p-54 * fabs(t.hi) && (any_range || rounds_surely(t, left))) {
            *cut = (sagi_cut){t, left};
            return FOUND;
        }
    }
    return NOT_CERTAIN;
}

static sagi_real real_square(sagi_real a) { return sagi_real_mul(a, a); }

// The quartic in s to 400 bits.
static void real_quartic(const local *l, sagi_real c[5]) {
    sagi_real zero = {0}, a2 = zero, b2 = zero, c2 = zero, a3 = zero, b3 = zero, c3 = zero;
    for (int i = 0; i < 3; i++) {
        sagi_real d = sagi_real_from(l->d[i]);
        sagi_real p = sagi_real_add(sagi_real_scale(d, l->t0), sagi_real_from(l->o[i]));
        a3 = sagi_real_add(a3, real_square(d));
        b3 = sagi_real_add(b3, sagi_real_mul(p, d));
        c3 = sagi_real_add(c3, real_square(p));
        if (i == 1) a2 = a3, b2 = b3, c2 = c3;
    }
    sagi_real major = sagi_real_from(l->major), minor = sagi_real_from(l->minor);
    sagi_real k = sagi_real_sub(real_square(major), real_square(minor));
    sagi_real q = sagi_real_add(c3, k), r4 = sagi_real_scale(real_square(major), 4);
    c[4] = real_square(a3);
    c[3] = sagi_real_scale(sagi_real_mul(a3, b3), 4);
    c[2] = sagi_real_sub(
        sagi_real_add(sagi_real_scale(sagi_real_mul(a3, q), 2), sagi_real_scale(real_square(b3), 4)),
        sagi_real_mul(r4, a2));
    c[1] = sagi_real_sub(sagi_real_scale(sagi_real_mul(b3, q), 4), sagi_real_scale(sagi_real_mul(r4, b2), 2));
    c[0] = sagi_real_sub(real_square(q), sagi_real_mul(r4, c2));
}

// F(o) to 400 bits, as its two leading parts.
static sagi_dd value_at_origin(const local *l) {
    sagi_real norm2 = {0}, rho2 = {0};
    for (int i = 0; i < 3; i++) {
        sagi_real o = sagi_real_from(l->o[i]);
        norm2 = sagi_real_add(norm2, sagi_real_scale(o, l->o[i]));
        if (i == 1) rho2 = norm2;
    }
    sagi_real major2 = sagi_real_scale(sagi_real_from(l->major), l->major);
    sagi_real minor2 = sagi_real_scale(sagi_real_from(l->minor), l->minor);
    sagi_real q = sagi_real_add(norm2, sagi_real_sub(major2, minor2));
    sagi_real f = sagi_real_sub(real_square(q), sagi_real_scale(sagi_real_mul(major2, rho2), 4));
    return sagi_cut_real(f, sagi_real_from(1)).t;
}

// The quartic about the origin, f[0] to all its bits, and the magnitudes of the others' terms.
static void set_local_quartic(const local *l, sagi_dd f[5], double sizes[5]) {
    const sagi_dd3 o = {{l->o[0], 0}, {l->o[1], 0}, {l->o[2], 0}},
                   d = {{l->d[0], 0}, {l->d[1], 0}, {l->d[2], 0}};
    const sagi_dd3 flat_o = {o.x, o.y, {0, 0}}, flat_d = {d.x, d.y, {0, 0}};
    sagi_dd aa = sagi_dot_dd(d, d), b = sagi_dot_dd(o, d), a2 = sagi_dot_dd(flat_d, flat_d);
    sagi_dd b2 = sagi_dot_dd(flat_o, flat_d), r4 = sagi_two_prod(l->major, 4 * l->major);
    sagi_dd q = sagi_dd_add(sagi_dot_dd(o, o), l->k);
    f[0] = value_at_origin(l);
    f[1] = sagi_dd_sub(sagi_dd_mul_double(sagi_dd_mul(b, q), 4), sagi_dd_mul_double(sagi_dd_mul(r4, b2), 2));
    f[2] = sagi_dd_add(sagi_dd_mul_double(sagi_dd_mul(aa, q), 2), sagi_dd_mul_double(sagi_dd_mul(b, b), 4));
    f[2] = sagi_dd_sub(f[2], sagi_dd_mul(r4, a2));
    f[3] = sagi_dd_mul_double(sagi_dd_mul(aa, b), 4);
    f[4] = sagi_dd_mul(aa, aa);
    double od = sqrt(aa.hi * sagi_dot_dd(o, o).hi);
    double q_size = sagi_dot_dd(o, o).hi + l->major * l->major + l->minor * l->minor;
    sizes[0] = fabs(f[0].hi);
    sizes[1] = od * (4 * q_size + 2 * r4.hi);
    sizes[2] = aa.hi * (2 * q_size + r4.hi) + 4 * od * od;
    sizes[3] = 4 * aa.hi * od, sizes[4] = f[4].hi;
}

// Newton for a root near t = 0.
static outcome polish_near_origin(const local *l, double guess, sagi_cut *cut) {
    sagi_dd f[5], t = {guess, 0};
    double sizes[5];
    set_local_quartic(l, f, sizes);
    if (f[0].hi == 0 && fabs(f[1].hi) > 0x1p-40 * sizes[1]) {
        *cut = (sagi_cut){{0, 0}, 0};
        return FOUND;
    }
    for (int i = 0; i < 12; i++) {
        sagi_dd y = f[4], slope = {0, 0};
        double error = sizes[4], reach = fabs(t.hi);
        for (int k = 3; k >= 0; k--) {
            slope = sagi_dd_add(sagi_dd_mul(slope, t), y);
            y = sagi_dd_add(sagi_dd_mul(y, t), f[k]);
            error = error * reach + sizes[k];
        }
        double step = y.hi / slope.hi, length = fabs(step),
               bend = 2 * sizes[2] + 6 * sizes[3] + 12 * sizes[4];
        t = sagi_dd_add_double(t, -step);
        double change = length * bend / fabs(slope.hi) + 0x1p-45; // of the slope over the step
        if (!(change < 0x1p-3 && fabs(slope.hi) > 0x1p-40 * sizes[1])) return NOT_CERTAIN;
        double left = 0x1p-98 * error / fabs(slope.hi) + length * change;
        if (left <= 0x1p-54 * fabs(t.hi) && rounds_surely(t, left)) {
            *cut = (sagi_cut){t, left};
            return FOUND;
        }
    }
    return NOT_CERTAIN;
}

static sagi_cut cut_at(const local *l, sagi_real s) {
    sagi_cut cut = sagi_cut_real(sagi_real_add(s, sagi_real_from(l->t0)), sagi_real_from(1));
    if (fabs(cut.t.hi) < 0x1p-250) cut.t = (sagi_dd){0, 0};
    return cut;
}

// In range, and not beyond the doubles in the ray's own units.
static bool is_kept(const local *l, double t) {
    return t >= l->t_min && t <= l->t_max && isfinite(scaled(t, l->exponent));
}

static int solve_exactly(const local *l, int most, sagi_cut cuts[4]) {
    sagi_real c[5], roots[4];
    real_quartic(l, c);
    int n = sagi_quartic_roots_real(c, l->low, l->high, roots), count = 0;
    for (int i = 0; i < n && count < most; i++) {
        sagi_cut cut = cut_at(l, roots[i]);
        if (is_kept(l, cut.t.hi)) cuts[count++] = cut;
    }
    return count;
}

static int solve(const local *l, int most, sagi_cut cuts[4]) {
    double brackets[4][2], slack = 0x1p-18 * (l->high - l->low) + 0x1p-48 * fabs(l->t0), reach = 0;
    for (int i = 0; i < 3; i++) reach = greatest_of(reach, fabs(l->o[i]));
    int n = reach < 0x1p45 ? sagi_quartic_brackets(l->c, l->sizes, l->low, l->high, brackets) : -1;
    int count = 0;
    if (n < 0) return solve_exactly(l, most, cuts);
    for (int i = 0; i < n && count < most; i++) {
        // What lies in a bracket out of range need not be known better; nor what comes after enough.
        if (l->t0 + brackets[i][1] + slack < l->t_min || l->t0 + brackets[i][0] - slack > l->t_max) continue;
        const double root = sagi_quartic_root(l->c, brackets[i]), t = l->t0 + root;
        if (t + slack < l->t_min || t - slack > l->t_max) continue;
        outcome found = polish(l, sagi_two_sum(l->t0, root), false, &cuts[count]);
        if (found == NOT_CERTAIN && fabs(t) < 0x1p-20 * (l->high - l->low))
            found = polish_near_origin(l, t, &cuts[count]);
        if (found == NOT_CERTAIN) {
            sagi_real c[5], s;
            real_quartic(l, c);
            if (!sagi_quartic_polish_real(c, l->high - l->low, root, &s)) return solve_exactly(l, most, cuts);
            cuts[count] = cut_at(l, s), found = FOUND;
        }
        count += found == FOUND && is_kept(l, cuts[count].t.hi);
    }
    return count;
}

static void scale_back(sagi_cut *cut, int exponent) {
    cut->t.hi = scaled(cut->t.hi, exponent), cut->t.lo = scaled(cut->t.lo, exponent);
    cut->error = scaled(cut->error, exponent);
}

int sagi_torus_crossings(const sag_torus *torus, const sag_ray *ray, int most, sagi_cut cuts[4]) {
    local l;
    if (!localise(torus, ray, &l)) return 0;
    int count = solve(&l, most, cuts);
    for (int i = 0; i < count; i++) scale_back(&cuts[i], l.exponent);
    return count;
}

sagi_cut sagi_torus_refine(const sag_torus *torus, const sag_ray *ray, double t) {
    local l;
    sagi_cut cut;
    if (localise(torus, ray, &l) && polish(&l, (sagi_dd){ldexp(t, -l.exponent), 0}, true, &cut) == FOUND) {
        scale_back(&cut, l.exponent);
        if (fabs(cut.t.hi - t) <= 0x1p-50 * fabs(t)) return cut;
    }
    return (sagi_cut){{t, 0}, 0x1p-52 * fabs(t)};
}
