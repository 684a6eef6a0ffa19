// SPDX-License-Identifier: MIT
// The quartic to 400 bits, from the bottom up: the root of f''' is given by its coefficients; with the roots
// of one derivative as places, those of the next are found by the signs at them. A place where the next is 0
// as well is a multiple root of it, and is known as exactly as a simple root of the derivative below, which
// is what makes tangents come out right. "0" is below 2⁻³⁰⁰ of the terms' magnitudes: roots are settled to
// 2⁻¹⁸⁰ of the interval, at a double root f rises with the square of the distance, and arithmetic is good to
// 2⁻³⁹⁰.
#include "math/quartic.h"
#include <math.h>

#define MOST    12
#define SETTLED 0x1p-180
#define ZERO    0x1p-300

typedef struct polynomial {
    int degree;
    sagi_real c[5];
    double size; // of its terms in the interval
} polynomial;

static sagi_real value_of(const polynomial *p, sagi_real x) {
    sagi_real y = p->c[p->degree];
    for (int k = p->degree - 1; k >= 0; k--) y = sagi_real_add(sagi_real_mul(y, x), p->c[k]);
    return y;
}

static polynomial derivative_of(const polynomial *p) {
    polynomial d = {.degree = p->degree - 1};
    for (int k = 1; k <= p->degree; k++) d.c[k - 1] = sagi_real_scale(p->c[k], k);
    return d;
}

static void set_size(polynomial *p, double reach) {
    p->size = 0;
    for (int k = p->degree; k >= 0; k--) p->size = p->size * reach + fabs(sagi_real_to_double(&p->c[k]));
}

static int sign_at(const polynomial *p, sagi_real x) {
    sagi_real y = value_of(p, x);
    double size = fabs(sagi_real_to_double(&y));
    return size <= ZERO * p->size ? 0 : sagi_real_sign(&y);
}

// About where the sign changes between a and b, by halving in doubles: a start for the long arithmetic.
static double guess_between(const polynomial *p, double a, double b, int sign_a) {
    for (int i = 0; i < 50; i++) {
        double x = 0.5 * (a + b), y = 0;
        for (int k = p->degree; k >= 0; k--) y = y * x + sagi_real_to_double(&p->c[k]);
        if ((y > 0) == (sign_a > 0))
            a = x;
        else
            b = x;
    }
    return 0.5 * (a + b);
}

// The root between a and b, where the signs are `sign_a` and its opposite.
static sagi_real bracketed_root(const polynomial *p, sagi_real a, sagi_real b, int sign_a, double reach) {
    polynomial slope = derivative_of(p);
    sagi_real x = sagi_real_from(guess_between(p, sagi_real_to_double(&a), sagi_real_to_double(&b), sign_a));
    if (sagi_real_compare(x, a) <= 0 || sagi_real_compare(x, b) >= 0)
        x = sagi_real_scale(sagi_real_add(a, b), 0.5);
    sagi_real gap = sagi_real_sub(b, a);
    double width = sagi_real_to_double(&gap);
    for (int i = 0; i < 1000; i++) {
        sagi_real y = value_of(p, x);
        int sign = sagi_real_sign(&y);
        if (sign == 0) break;
        if (sign == sign_a)
            a = x;
        else
            b = x;
        sagi_real next = sagi_real_sub(x, sagi_real_div(y, value_of(&slope, x)));
        gap = sagi_real_sub(b, a);
        double now = sagi_real_to_double(&gap);
        bool slow = i % 3 == 2 && now > 0.5 * width;
        if (i % 3 == 2) width = now;
        if (slow || sagi_real_compare(next, a) <= 0 || sagi_real_compare(next, b) >= 0)
            next = sagi_real_scale(sagi_real_add(a, b), 0.5);
        sagi_real step = sagi_real_sub(next, x);
        x = next;
        if (fabs(sagi_real_to_double(&step)) <= SETTLED * reach) break;
    }
    return x;
}

// The roots of p in [places[0], places[count − 1]], where the places between the ends are the roots of its
// derivative. Multiple roots once, or, when `twice`, twice if p does not change its sign there.
static int roots_between(const polynomial *p, const sagi_real *places, int count, bool twice, double reach,
                         sagi_real *roots) {
    int signs[MOST], n = 0, before = 0; // before: the last sign that was not 0
    for (int i = 0; i < count; i++) signs[i] = sign_at(p, places[i]);
    for (int i = 0; i < count && n < MOST - 2; i++) {
        if (i > 0 && signs[i - 1] * signs[i] < 0)
            roots[n++] = bracketed_root(p, places[i - 1], places[i], signs[i - 1], reach);
        if (signs[i] == 0 && !(i > 0 && signs[i - 1] == 0)) {
            int after = 0;
            for (int k = i; k < count && after == 0; k++) after = signs[k];
            roots[n++] = places[i];
            if (twice && before == after) roots[n++] = places[i];
        }
        if (signs[i] != 0) before = signs[i];
    }
    return n;
}

int sagi_quartic_roots_real(const sagi_real c[5], double low, double high, sagi_real roots[4]) {
    polynomial levels[5] = {{0}}; // levels[k]: the derivative of degree k
    double reach = fmax(fabs(low), fabs(high));
    levels[4] = (polynomial){.degree = 4, .c = {c[0], c[1], c[2], c[3], c[4]}};
    for (int k = 3; k >= 1; k--) levels[k] = derivative_of(&levels[k + 1]);
    sagi_real places[MOST] = {{0}}, found[MOST] = {{0}};
    int count = 0;
    for (int k = 1; k <= 4; k++) {
        set_size(&levels[k], reach);
        places[0] = sagi_real_from(low);
        for (int i = 0; i < count; i++) places[i + 1] = found[i];
        places[count + 1] = sagi_real_from(high);
        count = roots_between(&levels[k], places, count + 2, k == 4, reach, found);
    }
    if (count > 4) count = 4;
    for (int i = 0; i < count; i++) roots[i] = found[i];
    return count;
}

bool sagi_quartic_polish_real(const sagi_real c[5], double size, double guess, sagi_real *root) {
    polynomial p = {.degree = 4, .c = {c[0], c[1], c[2], c[3], c[4]}}, slope = derivative_of(&p);
    sagi_real x = sagi_real_from(guess);
    for (int i = 0; i < 12; i++) {
        sagi_real y = value_of(&p, x);
        if (sagi_real_sign(&y) == 0) break;
        sagi_real step = sagi_real_div(y, value_of(&slope, x));
        x = sagi_real_sub(x, step);
        double length = fabs(sagi_real_to_double(&step));
        if (!(fabs(sagi_real_to_double(&x) - guess) <= 1e-6 * size) || (i == 11 && length > 0x1p-300 * size))
            return false;
        if (length <= 0x1p-190 * size) { // the next step would be below 2⁻³⁶⁰
            *root = x;
            y = value_of(&p, x);
            *root = sagi_real_sub(x, sagi_real_div(y, value_of(&slope, x)));
            return true;
        }
    }
    *root = x;
    return true;
}
