// SPDX-License-Identifier: MIT
// A reflectance for a colour (Jakob & Hanika, "A Low-Dimensional Function Space for Efficient Spectral
// Upsampling", Computer Graphics Forum 38(2), 2019). Of all spectra that look the same one is taken of the
// form
//     s(λ) = ½ + p/(2 √(1 + p²)),   p = c₀ t² + c₁ t + c₂,   t = (λ − 360)/470:
// between 0 and 1, smooth, with one bump or dip: what nature's colours are like. Its colour under the space's
// white,
//     XYZ(c) = Σ s(λ) (x, y, z)(λ) I(λ)/Σ y I,
// is made the wanted one by Gauss and Newton's method. As the paper does, distance is taken in CIELAB, where
// the residual's direction matters only for colours that no reflectance has: those nearest the primaries of
// wide spaces. Steps are halved until they lead nearer, and c is kept within ±200: from there on s is a box.
//
// Between the steps of the integral s is taken as linear: the light of each nanometre is shared among the
// steps at its sides. Steps of 5 nm lead near: there their derivatives are as good as the true ones, and what
// the sum over all nanometres still lacks is made up for with them (the chord method). Where that does not
// lead to the colour, all is done again with the true sum.
//
// Nothing but + − · / and √ is used, which are the same on every machine: so are the tables made with it.
#include "colorspace.h"

#include <math.h>
#include <stddef.h>

#define LARGEST 200.0
#define CLOSE   1e-11 // squared, of Lab; below that floats cannot tell
#define GOOD    1e-9  // and that is 1/30,000 of what eyes can

// By Halley's iteration from 1: cubic convergence, and x is in (0.008, 3).
static double cube_root(double x) {
    double y = 1;
    for (int i = 0; i < 7; i++) y = y * (y * y * y + 2 * x) / (2 * y * y * y + x);
    return y;
}

// CIELAB's f and its slope.
static double lab_curve(double x, double *slope) {
    const double delta = 6.0 / 29;
    if (x > delta * delta * delta) {
        const double root = cube_root(x);
        *slope = 1 / (3 * root * root);
        return root;
    }
    *slope = 1 / (3 * delta * delta);
    return x * *slope + 4.0 / 29;
}

// Lab of an XYZ and, where asked for, the matrix of its derivatives.
static void to_lab(const sagi_color_space *space, const double xyz[3], double lab[3], double slopes[3][3]) {
    double f[3], slope[3];
    for (int k = 0; k < 3; k++) {
        f[k] = lab_curve(xyz[k] / space->white[k], &slope[k]);
        slope[k] /= space->white[k];
    }
    lab[0] = 116 * f[1] - 16, lab[1] = 500 * (f[0] - f[1]), lab[2] = 200 * (f[1] - f[2]);
    if (!slopes) return;
    const double m[3][3] = {
        {0, 116 * slope[1], 0}, {500 * slope[0], -500 * slope[1], 0}, {0, 200 * slope[1], -200 * slope[2]}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) slopes[i][k] = m[i][k];
}

static void make_basis(const sagi_color_space *space, int step, sagi_color_basis *b) {
    double norm = 0;
    b->count = (SAGI_WAVELENGTH_COUNT - 1) / step + 1;
    for (int i = 0; i < b->count; i++) b->at[i] = (sagi_color_sums){0, 0, 0, i / (b->count - 1.0)};
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const double light = (double)space->illuminant[i], part = (double)(i % step) / step;
        norm += (double)sagi_cie_xyz[i][1] * light;
        for (int k = 0; k < 3; k++) {
            const double weight = (double)sagi_cie_xyz[i][k] * light;
            b->at[i / step][k] += weight * (1 - part);
            if (part > 0) b->at[i / step + 1][k] += weight * part;
        }
    }
    for (int i = 0; i < b->count; i++)
        for (int k = 0; k < 3; k++) b->at[i][k] /= norm;
}

// XYZ of the reflectance c and its derivatives.
static void integrate(const sagi_color_basis *b, const double c[3], double xyz[3], double by_c[3][3]) {
    sagi_color_sums sum = {0, 0, 0, 0}, by_0 = sum, by_1 = sum, by_2 = sum;
    for (int i = 0; i < b->count; i++) {
        const sagi_color_sums weights = b->at[i];
        const double t = weights[3], p = (c[0] * t + c[1]) * t + c[2];
        const double over = 1 / sqrt(1 + p * p), s = 0.5 + 0.5 * p * over, slope = 0.5 * over * over * over;
        const sagi_color_sums w = weights * slope;
        sum += weights * s;
        by_2 += w, by_1 += w * t, by_0 += w * t * t;
    }
    for (int k = 0; k < 3; k++) {
        xyz[k] = sum[k];
        by_c[k][0] = by_0[k], by_c[k][1] = by_1[k], by_c[k][2] = by_2[k];
    }
}

// XYZ of the reflectance c alone.
static void sum_up(const sagi_color_basis *b, const double c[3], double xyz[3]) {
    sagi_color_sums sum = {0, 0, 0, 0};
    for (int i = 0; i < b->count; i++) {
        const double t = b->at[i][3], p = (c[0] * t + c[1]) * t + c[2];
        sum += b->at[i] * (0.5 + 0.5 * p / sqrt(1 + p * p));
    }
    for (int k = 0; k < 3; k++) xyz[k] = sum[k];
}

static double distance2(const double a[3], const double b[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

// A place on the way to a colour.
typedef struct place {
    double lab[3], by_c[3][3]; // the colour there, and its derivatives
    double distance;           // squared, from the wanted one
} place;

static void look(const sagi_color_space *space, const sagi_color_basis *b, const double c[3],
                 const double target[3], place *at) {
    double xyz[3], by_c[3][3], slopes[3][3];
    integrate(b, c, xyz, by_c);
    to_lab(space, xyz, at->lab, slopes);
    sagi_matrix_multiply(slopes, by_c, at->by_c);
    at->distance = distance2(at->lab, target);
}

// The step that the derivatives at a place say leads from `lab` to the target.
static bool step_from(const place *at, const double lab[3], const double target[3], double step[3]) {
    double inverse[3][3], difference[3];
    if (!sagi_matrix_invert(at->by_c, inverse)) return false;
    for (int k = 0; k < 3; k++) difference[k] = target[k] - lab[k];
    sagi_matrix_apply(inverse, difference, step);
    return true;
}

// Gauss and Newton's method from c. False when it stops before it is there.
static bool approach(const sagi_color_space *space, const sagi_color_basis *b, const double target[3],
                     double c[3], place *at) {
    look(space, b, c, target, at);
    for (int i = 0; i < 25 && at->distance > CLOSE; i++) {
        double step[3], next[3];
        if (!step_from(at, at->lab, target, step)) return false;
        place there = *at;
        bool nearer = false;
        for (int half = 0; half < 6 && !nearer; half++) {
            double largest = LARGEST;
            for (int k = 0; k < 3; k++) {
                next[k] = c[k] + step[k];
                step[k] /= 2;
                if (fabs(next[k]) > largest) largest = fabs(next[k]);
            }
            for (int k = 0; k < 3; k++) next[k] *= LARGEST / largest;
            look(space, b, next, target, &there);
            nearer = there.distance < at->distance;
        }
        if (!nearer) return false;
        for (int k = 0; k < 3; k++) c[k] = next[k];
        *at = there;
    }
    return at->distance <= CLOSE;
}

void sagi_color_solver_init(sagi_color_solver *solver, const sagi_color_space *space, int step_nm) {
    solver->space = space;
    make_basis(space, step_nm, &solver->fine);
    make_basis(space, 5, &solver->rough);
}

void sagi_color_solve(const sagi_color_solver *solver, const double rgb[3], double c[3]) {
    const sagi_color_space *const space = solver->space;
    double xyz[3], target[3], lab[3], near[3] = {c[0], c[1], c[2]}, step[3];
    place at;
    sagi_matrix_apply(space->to_xyz, rgb, xyz);
    to_lab(space, xyz, target, NULL);
    bool leads = approach(space, &solver->rough, target, near, &at);
    for (int i = 0; i < 5 && leads; i++) {
        sum_up(&solver->fine, near, xyz);
        to_lab(space, xyz, lab, NULL);
        if (distance2(lab, target) <= GOOD) {
            for (int k = 0; k < 3; k++) c[k] = near[k];
            return;
        }
        leads = step_from(&at, lab, target, step);
        for (int k = 0; k < 3 && leads; k++) near[k] += step[k], leads = fabs(near[k]) <= LARGEST;
    }
    // The colour has no such reflectance, or one that is all steps.
    approach(space, &solver->fine, target, c, &at);
}
