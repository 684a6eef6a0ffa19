// SPDX-License-Identifier: MIT
// In doubles f(x) by Horner's rule is off by at most 8u Σ|cₖ xᵏ| (u = 2⁻⁵³), its coefficients by 20u
// sizes[k]: 2⁻⁴⁷ Σ sizes[k]|x|ᵏ is more than twice both. The places where signs are taken are low, high, the
// root of f''', the roots of f'' and of f', as well as doubles know them. A place is good if |f| there
// exceeds that bound. If all are, no roots are missed: f' has only those roots, but for a pair that rounding
// hid near a root of f'', where f' is as small as its rounding; between such a pair f changes by less than
// its own bound, so it has the sign it has at the root of f'', which was looked at. The same goes for f'' and
// f'''.
#include "math/quartic.h"
#include <math.h>

#define UNCERTAIN 0x1p-47
#define MOST      10

static double horner(const double *c, int degree, double x) {
    double y = c[degree];
    for (int k = degree - 1; k >= 0; k--) y = y * x + c[k];
    return y;
}

// A root of the polynomial between a and b where its signs differ: Newton's steps, halving the bracket
// whenever they leave it or are slow.
static double bracketed_root(const double *c, int degree, double a, double b) {
    bool rising = horner(c, degree, a) < 0;
    double x = 0.5 * (a + b), width = b - a;
    for (int i = 0; i < 100; i++) {
        double y = c[degree], slope = 0;
        for (int k = degree - 1; k >= 0; k--) slope = slope * x + y, y = y * x + c[k];
        if (y == 0) return x;
        if ((y < 0) == rising)
            a = x;
        else
            b = x;
        double next = x - y / slope;
        bool slow = b - a > 0.5 * width && i % 3 == 2;
        if (i % 3 == 2) width = b - a;
        if (!(next > a && next < b) || slow) next = 0.5 * (a + b);
        if (fabs(next - x) <= 0x1p-52 * fabs(next) || next == a || next == b) return next;
        x = next;
    }
    return x;
}

static int add_sorted(double *list, int count, double x) {
    int i = count;
    for (; i > 0 && list[i - 1] > x; i--) list[i] = list[i - 1];
    list[i] = x;
    return count + 1;
}

// The places, in order, within (low, high), where f's sign is looked at.
static int places_of(const double c[5], double low, double high, double places[MOST]) {
    const double first[4] = {c[1], 2 * c[2], 3 * c[3], 4 * c[4]};
    double turns[5] = {low}, middle = -c[3] / (4 * c[4]); // the root of f'''
    int turn_count = 1, count = 0;
    // f''/2 = c₂ + 3c₃x + 6c₄x², about its middle: 6c₄(x − m)² + (c₂ + 3c₃m/2).
    double depth = -(c[2] + 1.5 * c[3] * middle) / (6 * c[4]);
    if (middle > low && middle < high) count = add_sorted(places, count, middle);
    if (depth > 0) {
        double inflections[2] = {middle - sqrt(depth), middle + sqrt(depth)};
        for (int i = 0; i < 2; i++) {
            if (!(inflections[i] > low && inflections[i] < high)) continue;
            turns[turn_count++] = inflections[i];
            count = add_sorted(places, count, inflections[i]);
        }
    }
    turns[turn_count++] = high;
    for (int i = 0; i + 1 < turn_count; i++) {
        bool below = horner(first, 3, turns[i]) < 0, next_below = horner(first, 3, turns[i + 1]) < 0;
        if (below == next_below) continue;
        count = add_sorted(places, count, bracketed_root(first, 3, turns[i], turns[i + 1]));
    }
    return count;
}

int sagi_quartic_brackets(const double c[5], const double sizes[5], double low, double high,
                          double brackets[4][2]) {
    double places[MOST];
    int count = places_of(c, low, high, places), root_count = 0;
    double before = low;
    bool inside = false; // f < 0
    for (int i = 0; i <= count; i++) {
        double x = i < count ? places[i] : high, y = i < count ? horner(c, 4, x) : 1;
        if (i < count && !(fabs(y) > UNCERTAIN * horner(sizes, 4, fabs(x)))) return -1;
        if ((y < 0) != inside) {
            if (root_count == 4) return -1;
            brackets[root_count][0] = before, brackets[root_count++][1] = x;
            inside = y < 0;
        }
        before = x;
    }
    return root_count;
}

double sagi_quartic_root(const double c[5], const double bracket[2]) {
    return bracketed_root(c, 4, bracket[0], bracket[1]);
}
