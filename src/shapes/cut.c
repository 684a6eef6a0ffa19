// SPDX-License-Identifier: MIT
// Ray and plane: (o + t d − q)·n = 0, so t = N/D with N = (q − o)·n and D = d·n.
//
// Three tiers. In double, with u = 2⁻⁵³: each term of N is off by u for the difference and u for the product,
// the two sums add 2u at most, so |N̂ − N| ≤ 4u(1 + O(u)) Σ|nᵢ||qᵢ − oᵢ| and |D̂ − D| ≤ 3u(1 + O(u)) Σ|nᵢ dᵢ|;
// we take 5u and 4u. The quotient's interval outside [t_min, t_max] is a certain miss. In double-double both
// errors are below 2⁻¹⁰² of the same sums (differences are exact): good enough for t while they stay below
// 2⁻⁵⁶ of N and D. Else both are expanded exactly: N has at most 12 components and D 6; D = 0 exactly is a
// ray along the plane, and of a compressed expansion the two leading components hold more than 100 bits.
#include "shapes/cut.h"
#include "math/expansion.h"

double sagi_power_scale(sag_vec3 v) {
    double largest = sag_max_component(sag_abs(v));
    if ((largest >= 0x1p-100 && largest <= 0x1p250) || !(largest > 0) || isinf(largest)) return 1;
    int exponent = ilogb(largest);
    return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

bool sagi_cut_ratio(sagi_dd numerator, double numerator_error, sagi_dd denominator, double denominator_error,
                    sagi_cut *cut) {
    double n = fabs(numerator.hi), d = fabs(denominator.hi);
    if (!(numerator_error <= 0x1p-56 * n && denominator_error <= 0x1p-56 * d && d > 0)) return false;
    cut->t = sagi_dd_div(numerator, denominator);
    double magnitude = fabs(cut->t.hi);
    // Relative errors add; the quotient's own is some 2⁻¹⁰⁰.
    cut->error = n > 0 ? magnitude * 1.001 * (numerator_error / n + denominator_error / d + 0x1p-99) : 0;
    return true;
}

static sagi_dd leading(const sagi_real *a) {
    if (a->count == 0) return (sagi_dd){0, 0};
    return (sagi_dd){a->terms[a->count - 1], a->count > 1 ? a->terms[a->count - 2] : 0};
}

sagi_cut sagi_cut_real(sagi_real numerator, sagi_real denominator) {
    sagi_real t = sagi_real_div(numerator, denominator);
    sagi_cut cut = {.t = leading(&t)};
    cut.error = 0x1p-100 * fabs(cut.t.hi);
    return cut;
}

// (a − b)·n as an expansion of at most 12 components.
static int expand_offset(sag_vec3 a, sag_vec3 b, sag_vec3 n, double *h) {
    double sum[12], term[4], diff[2];
    int count = 0;
    for (int axis = 0; axis < 3; axis++) {
        int two = sagi_expansion_from_diff(sag_component(a, axis), sag_component(b, axis), diff);
        int four = sagi_expansion_scale(two, diff, sag_component(n, axis), term);
        int m = sagi_expansion_sum(count, h, four, term, sum);
        for (count = 0; count < m; count++) h[count] = sum[count];
    }
    return count;
}

// The two leading components; the rest is below 2⁻¹⁰⁴ of them.
static sagi_dd leading_two(int count, const double *expansion) {
    double h[12];
    int n = sagi_expansion_compress(count, expansion, h);
    return (sagi_dd){n > 0 ? h[n - 1] : 0, n > 1 ? h[n - 2] : 0};
}

static bool cut_exactly(sag_vec3 n, sag_vec3 q, sag_vec3 o, sag_vec3 d, sagi_cut *cut) {
    double num[12], den[12];
    int num_count = expand_offset(q, o, n, num);
    int den_count = expand_offset(d, (sag_vec3){0, 0, 0}, n, den);
    if (den_count == 0) return false;
    cut->t = sagi_dd_div(leading_two(num_count, num), leading_two(den_count, den));
    cut->error = 0x1p-98 * fabs(cut->t.hi);
    return true;
}

bool sagi_cut_outside(double num, double num_error, double den, double den_error, const sag_ray *ray) {
    if (den < 0) den = -den, num = -num;
    double low = den - den_error, high = (den + den_error) * (1 + 0x1p-50);
    if (!(low > 0)) return false;
    // The smallest and largest values the quotient can have, rounded outward.
    double least = num - num_error, most = num + num_error;
    least = least > 0 ? least / high : least / low;
    most = most > 0 ? most / low : most / high;
    return least - 0x1p-51 * fabs(least) > ray->t_max || most + 0x1p-51 * fabs(most) < ray->t_min;
}

bool sagi_cut_plane(sag_vec3 normal, sag_vec3 point, const sag_ray *ray, sagi_cut *cut) {
    double normal_scale = sagi_power_scale(normal), t_scale = sagi_power_scale(ray->direction);
    sag_vec3 n = sag_scale(normal, normal_scale), d = sag_scale(ray->direction, t_scale);
    sag_vec3 w = sag_sub(point, ray->origin);
    double num = sag_dot(w, n), num_size = sag_dot(sag_abs(w), sag_abs(n));
    double den = sag_dot(d, n), den_size = sag_dot(sag_abs(d), sag_abs(n));
    if (t_scale == 1 &&
        sagi_cut_outside(num, 5 * SAGI_EPSILON * num_size, den, 4 * SAGI_EPSILON * den_size, ray))
        return false;
    sagi_dd3 n_dd = sagi_dd3_from(n);
    sagi_dd num_dd = sagi_dot_dd(sagi_dd3_from_diff(point, ray->origin), n_dd);
    sagi_dd den_dd = sagi_dot_dd(sagi_dd3_from(d), n_dd);
    if (!sagi_cut_ratio(num_dd, 0x1p-102 * num_size, den_dd, 0x1p-102 * den_size, cut) &&
        !cut_exactly(n, point, ray->origin, d, cut))
        return false;
    cut->t.hi *= t_scale, cut->t.lo *= t_scale, cut->error *= t_scale;
    return sagi_in_range(ray, cut->t.hi);
}

int sagi_plane_side(sag_vec3 normal, sag_vec3 point, sag_vec3 p) {
    sag_vec3 n = sag_scale(normal, sagi_power_scale(normal)), w = sag_sub(p, point);
    double side = sag_dot(w, n), size = sag_dot(sag_abs(w), sag_abs(n));
    if (fabs(side) > 5 * SAGI_EPSILON * size) return side > 0 ? 1 : -1;
    double h[12];
    return sagi_expansion_sign(expand_offset(p, point, n, h), h);
}

double sagi_plane_offset(sag_vec3 normal, sag_vec3 point, sag_vec3 p) {
    double h[12];
    int count = expand_offset(p, point, normal, h);
    return leading_two(count, h).hi;
}

static double coordinate_at(double o, double d, sagi_cut cut, double *error) {
    sagi_dd step = sagi_two_prod_any(cut.t.hi, d);
    step = sagi_fast_two_sum(step.hi, step.lo + cut.t.lo * d);
    sagi_dd p = sagi_dd_add_double(step, o);
    *error = 2 * (SAGI_EPSILON * fabs(p.hi) + 0x1p-102 * (fabs(o) + fabs(step.hi)) + fabs(d) * cut.error);
    return p.hi;
}

void sagi_point_at(const sag_ray *ray, sagi_cut cut, sag_vec3 *position, sag_vec3 *position_error) {
    const sag_vec3 *o = &ray->origin, *d = &ray->direction;
    position->x = coordinate_at(o->x, d->x, cut, &position_error->x);
    position->y = coordinate_at(o->y, d->y, cut, &position_error->y);
    position->z = coordinate_at(o->z, d->z, cut, &position_error->z);
}

// The quick test's error of (q − o)·n is 5u Σ|nᵢ||qᵢ − oᵢ|. Moved by Σ|nᵢ|eᵢ along the unit n (spawn.h) the
// true value is at least that, so eᵢ = 8u|qᵢ − pᵢ| more than makes up for it.
void sagi_clear_plane(sag_vec3 point, sag_surface *surface) {
    surface->position_error =
        sag_madd(surface->position_error, 8 * SAGI_EPSILON, sag_abs(sag_sub(surface->position, point)));
}

// A unit normal has Σ|nᵢ| ≥ 1.
void sagi_clear_distance(double distance, sag_surface *surface) {
    sag_vec3 e = surface->position_error;
    surface->position_error = sag_vec3_make(e.x + distance, e.y + distance, e.z + distance);
}
