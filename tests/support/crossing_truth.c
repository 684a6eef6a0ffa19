// SPDX-License-Identifier: MIT
#include "support/crossing_truth.h"

static long double ulp_of(long double x) {
    double d = fabs((double)x);
    return nextafter(d, INFINITY) - d;
}

void crossing_truth_add(crossing_truth *truth, const sag_ray *ray, long double t) {
    long double slack = 5 * ulp_of(t);
    if (t < ray->t_min - slack || t > ray->t_max + slack || truth->count == 8 || !isfinite((double)t)) return;
    bool optional = (t < ray->t_min + slack || t > ray->t_max - slack);
    // 0 is exact, and so is what side of it a number is on.
    if (t >= 0 && ray->t_min == 0) optional = t > ray->t_max - slack;
    if (t < 0 && ray->t_min == 0) return;
    int i = truth->count++;
    for (; i > 0 && truth->t[i - 1] > t; i--)
        truth->t[i] = truth->t[i - 1], truth->optional[i] = truth->optional[i - 1];
    truth->t[i] = t, truth->optional[i] = optional;
}

void crossing_truth_add_fraction(crossing_truth *truth, const sag_ray *ray, mpq_t t) {
    static mpq_t rest; // mpq_get_d cuts off; a second piece makes up for that
    static bool ready;
    if (!ready) mpq_init(rest), ready = true;
    double high = mpq_get_d(t);
    if (!isfinite(high)) return;
    mpq_set_d(rest, high);
    mpq_sub(rest, t, rest);
    long double value = (long double)high + mpq_get_d(rest);
    if (value == 0 && mpq_sgn(t) != 0) value = mpq_sgn(t) * 0x1p-1074L;
    crossing_truth_add(truth, ray, value);
}

static double compare(const crossing_truth *truth, int i, const sag_hit *hits, size_t next, size_t count) {
    if (i == truth->count) return next == count ? 0 : INFINITY;
    double skipped = truth->optional[i] ? compare(truth, i + 1, hits, next, count) : INFINITY;
    if (next == count) return skipped;
    long double off = fabsl(hits[next].t - truth->t[i]) / ulp_of(truth->t[i]);
    return fmin(skipped, fmax((double)off, compare(truth, i + 1, hits, next + 1, count)));
}

double crossing_truth_compare(const crossing_truth *truth, const sag_hit *hits, size_t count) {
    return compare(truth, 0, hits, 0, count);
}
