// SPDX-License-Identifier: MIT
// The signs of polynomials at a point, first in doubles. Every value carries a bound of its error: that of a
// sum is the sum of the errors, that of a product |a|·eb + |b|·ea + ea·eb, and each rounding adds 2⁻⁵³ of the
// result. The bounds themselves are rounded; the last comparison leaves them 2⁻²⁰ of themselves for that.
#include "support/region.h"
#include <float.h>
#include <math.h>

#define U     0x1p-53
#define SLACK (1 + 0x1p-20)

static approx add(approx a, approx b) {
    double v = a.v + b.v;
    return (approx){v, a.e + b.e + U * fabs(v)};
}
static approx mul(approx a, approx b) {
    double v = a.v * b.v;
    return (approx){v, fabs(a.v) * b.e + fabs(b.v) * a.e + a.e * b.e + U * fabs(v) + DBL_MIN};
}
static approx minus(approx a, double b) { return add(a, (approx){-b, 0}); }
static int sign(approx a) {
    double bound = a.e * SLACK;
    return a.v > bound ? 1 : a.v < -bound ? -1 : 0;
}

spot spot_on(const sag_ray *ray, double t) {
    spot s = {.exact = true, .origin = ray->origin, .direction = ray->direction, .t = t};
    for (int i = 0; i < 3; i++) {
        double o = sag_component(ray->origin, i), d = sag_component(ray->direction, i), v = fma(t, d, o);
        s.x[i] = (approx){v, U * fabs(v) + DBL_MIN};
        s.reach[i] = fabs(o) + fabs(t * d);
    }
    return s;
}

spot spot_at(sag_vec3 point) {
    sag_ray ray = {.origin = point};
    return spot_on(&ray, 0);
}

spot spot_around(sag_vec3 point, double radius) {
    spot s = spot_at(point);
    s.exact = false;
    for (int i = 0; i < 3; i++) s.x[i].e += radius;
    return s;
}

void inverse_map_make(inverse_map *inverse, const sag_affine *map) {
    mpq_t m[3][4], adjoint[3][3], x, y, det;
    mpq_inits(x, y, det, NULL);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) mpq_init(m[i][j]), mpq_set_d(m[i][j], map->m[i][j]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) { // the cofactor of m[j][i]
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            mpq_init(adjoint[i][j]);
            mpq_mul(x, m[a][c], m[b][d]), mpq_mul(y, m[a][d], m[b][c]), mpq_sub(adjoint[i][j], x, y);
        }
    for (int j = 0; j < 3; j++) mpq_mul(x, m[0][j], adjoint[j][0]), mpq_add(det, det, x);
    for (int i = 0; i < 3; i++) {
        mpq_set_ui(y, 0, 1);
        for (int j = 0; j < 3; j++) {
            mpq_div(adjoint[i][j], adjoint[i][j], det);
            mpq_mul(x, adjoint[i][j], m[j][3]), mpq_sub(y, y, x);
            inverse->m[i][j] = mpq_get_d(adjoint[i][j]);
        }
        inverse->m[i][3] = mpq_get_d(y);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) mpq_clear(m[i][j]);
        for (int j = 0; j < 3; j++) mpq_clear(adjoint[i][j]);
    }
    mpq_clears(x, y, det, NULL);
}

spot spot_map(const inverse_map *inverse, const spot *from) {
    spot s = {.exact = false};
    for (int i = 0; i < 3; i++) {
        const double *row = inverse->m[i];
        double v = row[3], e = 0, reach = fabs(row[3]);
        for (int j = 0; j < 3; j++) {
            v += row[j] * from->x[j].v;
            e += fabs(row[j]) * from->x[j].e;
            reach += fabs(row[j]) * from->reach[j];
        }
        // Ours: 7 roundings and coefficients off by 2⁻⁵². The library's: the same again and some more.
        s.x[i] = (approx){v, e + 0x1p-46 * reach + DBL_MIN};
        s.reach[i] = reach;
    }
    return s;
}

// The order of a … j: which of x y z 1 are multiplied.
static const int first_of[10] = {0, 1, 2, 0, 0, 1, 0, 1, 2, 3};
static const int second_of[10] = {0, 1, 2, 1, 2, 2, 3, 3, 3, 3};

static int rule_sign(const rule *r, const spot *at) {
    approx x[4] = {
        minus(at->x[0], r->center.x), minus(at->x[1], r->center.y), minus(at->x[2], r->center.z), {1, 0}};
    approx sum = {0, 0};
    for (int i = 0; i < 10; i++) {
        if (!(r->used >> i & 1)) continue;
        double factor = i >= 3 && i < 9 ? 2 : 1;
        approx term = {factor * r->v[i], factor * 2 * U * fabs(r->v[i])};
        if (i < 9) term = mul(term, x[first_of[i]]);
        if (i < 6) term = mul(term, x[second_of[i]]);
        sum = add(sum, term);
    }
    return sign(sum);
}

// In when any clause has all its rules ≤ 0.
static membership all_clauses(const shape_region *region, int (*sign_of)(const rule *, const spot *),
                              const spot *at, membership on_surface) {
    membership any = MEMBER_OUT;
    uint32_t i = 0;
    for (uint32_t c = 0; c < region->clause_count; c++) {
        membership all = MEMBER_IN;
        for (; i < region->clause_end[c] && all != MEMBER_OUT; i++) {
            int s = sign_of(&region->rules[i], at);
            membership in = s < 0 ? MEMBER_IN : s > 0 ? MEMBER_OUT : on_surface;
            if (in < all) all = in;
        }
        i = region->clause_end[c];
        if (all == MEMBER_IN) return MEMBER_IN;
        if (all > any) any = all;
    }
    return any;
}

// With K = x² + y² + z² + R² − r²: within the tube when K ≤ 2Rρ, so when K ≤ 0 or K² ≤ 4R²ρ².
static membership torus_filter(const sag_torus *torus, const spot *at) {
    approx R = {torus->major_radius, 0}, r = {torus->minor_radius, 0}, four = {4, 0};
    approx rho = add(mul(at->x[0], at->x[0]), mul(at->x[1], at->x[1]));
    approx r2 = mul(r, r);
    approx k = add(add(rho, mul(at->x[2], at->x[2])), add(mul(R, R), (approx){-r2.v, r2.e}));
    approx right = mul(four, mul(mul(R, R), rho));
    int outside = sign(add(mul(k, k), (approx){-right.v, right.e})), positive = sign(k);
    if (positive < 0 || outside < 0) return MEMBER_IN;
    return positive > 0 && outside > 0 ? MEMBER_OUT : MEMBER_UNKNOWN;
}

membership region_filter(const shape_region *region, const spot *at) {
    if (region->torus) return torus_filter(region->torus, at);
    if (region->mesh) return region_mesh_filter(region, at);
    return all_clauses(region, rule_sign, at, MEMBER_UNKNOWN);
}

static void exact_coordinate(mpq_t out, const spot *at, int i) {
    mpq_t x;
    mpq_init(x);
    mpq_set_d(out, at->t), mpq_set_d(x, sag_component(at->direction, i)), mpq_mul(out, out, x);
    mpq_set_d(x, sag_component(at->origin, i)), mpq_add(out, out, x);
    mpq_clear(x);
}

static int rule_sign_exact(const rule *r, const spot *at) {
    mpq_t x[4], sum, term;
    mpq_inits(x[0], x[1], x[2], x[3], sum, term, NULL);
    for (int i = 0; i < 3; i++) {
        mpq_set_d(term, sag_component(r->center, i));
        exact_coordinate(x[i], at, i), mpq_sub(x[i], x[i], term);
    }
    mpq_set_ui(x[3], 1, 1);
    for (int i = 0; i < 10; i++) {
        if (!(r->used >> i & 1)) continue;
        mpq_mul(term, r->q[i], x[first_of[i]]), mpq_mul(term, term, x[second_of[i]]);
        if (i >= 3 && i < 9) mpq_mul_2exp(term, term, 1);
        mpq_add(sum, sum, term);
    }
    int s = mpq_sgn(sum);
    mpq_clears(x[0], x[1], x[2], x[3], sum, term, NULL);
    return s;
}

static membership torus_exact(const sag_torus *torus, const spot *at) {
    mpq_t rho, k, x, R;
    mpq_inits(rho, k, x, R, NULL);
    for (int i = 0; i < 3; i++) {
        exact_coordinate(x, at, i), mpq_mul(x, x, x);
        mpq_add(k, k, x);
        if (i < 2) mpq_add(rho, rho, x);
    }
    mpq_set_d(x, torus->minor_radius), mpq_mul(x, x, x), mpq_sub(k, k, x);
    mpq_set_d(R, torus->major_radius), mpq_mul(R, R, R), mpq_add(k, k, R);
    mpq_mul(rho, rho, R), mpq_mul_2exp(rho, rho, 2);
    mpq_mul(x, k, k);
    int outside = mpq_cmp(x, rho), positive = mpq_sgn(k);
    mpq_clears(rho, k, x, R, NULL);
    if (positive < 0 || outside < 0) return MEMBER_IN;
    return positive > 0 && outside > 0 ? MEMBER_OUT : MEMBER_UNKNOWN;
}

membership region_exact(const shape_region *region, const spot *at) {
    if (!at->exact) return MEMBER_UNKNOWN;
    if (region->torus) return torus_exact(region->torus, at);
    if (region->mesh) return region_mesh_exact(region, at);
    return all_clauses(region, rule_sign_exact, at, region->faces_belong ? MEMBER_IN : MEMBER_UNKNOWN);
}
