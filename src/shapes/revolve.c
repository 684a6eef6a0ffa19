// SPDX-License-Identifier: MIT
#include "shapes/revolve.h"
#include <math.h>

// The Gauss–Legendre rule of ten points on [−1, 1], half of it (Abramowitz & Stegun, table 25.4).
static const double nodes[5] = {0.14887433898163122, 0.43339539412924719, 0.67940956829902441,
                                0.86506336668898451, 0.97390652851717172};
static const double weights[5] = {0.29552422471475287, 0.26926671930999636, 0.21908636251598204,
                                  0.14945134915058059, 0.06667134430868814};

// What is under the root, Q(h) = p h² + 2 q h + r; never negative but for rounding.
static double integrand(const sagi_profile *c, double h) {
    double rho2 = (c->alpha * h + c->beta) * h + c->gamma, slope = c->alpha * h + c->beta / 2;
    return sqrt(fmax(0, rho2 + slope * slope));
}

static double gauss(const sagi_profile *c, double low, double high) {
    double middle = low / 2 + high / 2, half = high / 2 - low / 2, sum = 0;
    for (int i = 0; i < 5; i++)
        sum += weights[i] * (integrand(c, middle - half * nodes[i]) + integrand(c, middle + half * nodes[i]));
    return half * sum;
}

// √Q is smooth but near the vertex of Q, where it may turn as sharply as |h − vertex|. Away from the vertex
// the panels double in size, as the distance does: ten points see each of them as equally smooth.
static double away_from(const sagi_profile *c, double vertex, double far) {
    double sum = 0, reach = far - vertex;
    for (int i = 0; i < 52; i++, reach /= 2) sum += gauss(c, vertex + reach / 2, vertex + reach);
    return fabs(sum) + fabs(gauss(c, vertex, vertex + reach));
}

double sagi_profile_area(const sagi_profile *c, double low, double high) {
    double p = c->alpha * (1 + c->alpha), q = c->beta / 2 * (1 + c->alpha),
           vertex = p != 0 ? -q / p : INFINITY;
    if (vertex > low && vertex < high) return away_from(c, vertex, low) + away_from(c, vertex, high);
    double width = high - low, distance = fmin(fabs(vertex - low), fabs(vertex - high));
    if (!(distance < 4 * width)) return gauss(c, low, high);
    double near = fabs(vertex - low) < fabs(vertex - high) ? low : high, far = near == low ? high : low;
    return away_from(c, near, far);
}

// Newton's method kept inside a bracket that bisection shrinks.
double sagi_profile_invert(const sagi_profile *c, double low, double high, double fraction) {
    double whole = sagi_profile_area(c, low, high), h = low + fraction * (high - low);
    double from = low, before = 0, left = low, right = high;
    for (int i = 0; i < 60; i++) {
        // Only the piece since the last place is integrated anew.
        double area =
            h >= from ? before + sagi_profile_area(c, from, h) : before - sagi_profile_area(c, h, from);
        double excess = area - fraction * whole;
        if (fabs(excess) <= 1e-15 * whole) break;
        if (excess > 0)
            right = h;
        else
            left = h;
        from = h, before = area;
        h -= excess / integrand(c, h);
        if (!(h > left && h < right)) h = left / 2 + right / 2;
    }
    return h;
}
