// SPDX-License-Identifier: MIT
// The rarer steps on the way to t, u and v (triangle_solve.h): all of it in double-doubles, and expansions.
#include "shapes/triangle_solve.h"
#include "shapes/vector_expansion.h"

#if defined(__GNUC__)
#define SAGI_COLD __attribute__((noinline, cold))
#else
#define SAGI_COLD
#endif

static double norm1(sag_vec3 a) { return fabs(a.x) + fabs(a.y) + fabs(a.z); }
static double norm_max(sag_vec3 a) { return sagi_larger(sagi_larger(fabs(a.x), fabs(a.y)), fabs(a.z)); }

// Writes the answer when t, back in the caller's directions, is in range and a number: very short directions
// may put it beyond the doubles.
static bool accept(const sagi_triangle_ray *ray, double t_scaled, double beta, double gamma, double *t,
                   double *u, double *v) {
    double value = ray->exponent ? ldexp(t_scaled, -ray->exponent) : t_scaled;
    if (!(value >= ray->t_min && value <= ray->t_max) || isinf(value)) return false;
    *t = value;
    sagi_triangle_confine(beta, gamma, u, v);
    return true;
}

// Step 4.
static SAGI_COLD bool solve_exact(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                                  const sag_vec3 *c, double *t, double *u, double *v) {
    // Of a mesh that nobody checked (scene/check.c): exponents of what is not finite are no numbers to add.
    if (!sagi_triangle_is_finite(a, b, c)) return false;
    sagi_expansion3 d = sagi_expansion3_from(ray->d), ao = sagi_expansion3_from_diff(*a, ray->o);
    sagi_expansion3 ab = sagi_expansion3_from_diff(*b, *a), ac = sagi_expansion3_from_diff(*c, *a);
    // Each vector is its true value times 2 to the exponent here; quotients take the difference out again.
    int d_scale = sagi_expansion3_normalize(&d), ao_scale = sagi_expansion3_normalize(&ao);
    int ab_scale = sagi_expansion3_normalize(&ab), ac_scale = sagi_expansion3_normalize(&ac);
    sagi_expansion3 n = sagi_expansion3_cross(&ab, &ac), moment = sagi_expansion3_cross(&d, &ao);
    int n_scale = sagi_expansion3_normalize(&n), moment_scale = sagi_expansion3_normalize(&moment);

    double denominator[192], numerator[192];
    int m = sagi_expansion3_dot(&d, &n, denominator);
    if (m == 0) return false;
    int count = sagi_expansion3_dot(&ao, &n, numerator);
    double t_scaled = sagi_expansion_quotient(count, numerator, m, denominator, d_scale - ao_scale);
    int weight_scale = n_scale - ao_scale - moment_scale;
    count = sagi_expansion3_dot(&moment, &ac, numerator); // −e(c, a)
    double beta = -sagi_expansion_quotient(count, numerator, m, denominator, weight_scale + ab_scale);
    count = sagi_expansion3_dot(&moment, &ab, numerator); // e(a, b)
    double gamma = sagi_expansion_quotient(count, numerator, m, denominator, weight_scale + ac_scale);
    return accept(ray, t_scaled, beta, gamma, t, u, v);
}

// What steps 1 to 3 cannot do.
static SAGI_COLD bool solve_carefully(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                                      const sag_vec3 *c, double *t, double *u, double *v) {
    sag_vec3 way = sag_sub(*a, ray->o), edge1 = sag_sub(*b, *a), edge2 = sag_sub(*c, *a);
    double far = norm1(way) + 0x1p-300, size = sagi_larger(norm_max(edge1), norm_max(edge2));
    if (!(far <= 0x1p400 && size >= 0x1p-200 && size <= 0x1p200)) return solve_exact(ray, a, b, c, t, u, v);
    sagi_dd3 d = sagi_dd3_from(ray->d), ao = sagi_dd3_diff(*a, ray->o), ab = sagi_dd3_diff(*b, *a),
             ac = sagi_dd3_diff(*c, *a);
    sagi_dd3 n = sagi_dd3_cross(&ab, &ac), moment = sagi_dd3_cross(&d, &ao);
    sagi_dd denominator = sagi_dd3_dot(&d, &n), numerator = sagi_dd3_dot(&ao, &n);
    double square = size * size, unit = 0x1p-100;
    double denominator_error = unit * ray->d1 * square;
    if (!(denominator_error <= 0.5 * SAGI_EPSILON * fabs(denominator.hi) &&
          unit * far * square <= 0.5 * SAGI_EPSILON * fabs(numerator.hi) &&
          unit * ray->d1 * far * size + denominator_error <= 0x1p-50 * fabs(denominator.hi)))
        return solve_exact(ray, a, b, c, t, u, v);
    double beta = -sagi_dd_to_double(sagi_dd_div(sagi_dd3_dot(&moment, &ac), denominator));
    double gamma = sagi_dd_to_double(sagi_dd_div(sagi_dd3_dot(&moment, &ab), denominator));
    return accept(ray, sagi_dd_to_double(sagi_dd_div(numerator, denominator)), beta, gamma, t, u, v);
}

static sagi_d4 lanes_of(sag_vec3 a) { return sagi_d4_of(a.x, a.y, a.z, 0); }

bool sagi_triangle_solve(const sagi_triangle_ray *ray, const sag_vec3 *a, const sag_vec3 *b,
                         const sag_vec3 *c, double *t, double *u, double *v) {
    sagi_solve1_pair of = {lanes_of(ray->o), lanes_of(ray->d), lanes_of(*a), lanes_of(*b), lanes_of(*c)};
    sagi_solve1_step s;
    sagi_solve1_solve(&of, &s);
    bool good = sagi_solve1_good(&s);
    if (!good) sagi_solve1_again(&of, &s), good = sagi_solve1_good(&s);
    if (good || sagi_triangle_refine(&of, -INFINITY, INFINITY, &s) == SAGI_TRIANGLE_SOLVED)
        return accept(ray, s.t, s.u, s.v, t, u, v);
    return solve_carefully(ray, a, b, c, t, u, v);
}

bool sagi_triangle_solve_ray(const sag_ray *ray, double t_max, const sagi_d4 corner[3], double *t, double *u,
                             double *v) {
    sagi_triangle_ray prepared = sagi_triangle_prepare(ray);
    prepared.t_max = t_max;
    sag_vec3 a = sagi_d4_vec3(corner[0]), b = sagi_d4_vec3(corner[1]), c = sagi_d4_vec3(corner[2]);
    return sagi_triangle_solve(&prepared, &a, &b, &c, t, u, v);
}
