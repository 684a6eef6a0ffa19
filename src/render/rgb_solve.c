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
// steps at its sides.
//
// Nothing but + − · / and √ is used, which are the same on every machine: so are the tables made with it.
#include "colorspace.h"

#include <math.h>
#include <stddef.h>

#define LARGEST 200.0

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

// x, y, z of the white light that is reflected at each step.
typedef struct basis {
    int count;
    double weights[SAGI_WAVELENGTH_COUNT][3];
} basis;

static void make_basis(const sagi_color_space *space, int step, basis *b) {
    double norm = 0;
    b->count = (SAGI_WAVELENGTH_COUNT - 1) / step + 1;
    for (int i = 0; i < b->count; i++)
        for (int k = 0; k < 3; k++) b->weights[i][k] = 0;
    for (int i = 0; i < SAGI_WAVELENGTH_COUNT; i++) {
        const double light = (double)space->illuminant[i], part = (double)(i % step) / step;
        norm += (double)sagi_cie_xyz[i][1] * light;
        for (int k = 0; k < 3; k++) {
            const double weight = (double)sagi_cie_xyz[i][k] * light;
            b->weights[i / step][k] += weight * (1 - part);
            if (part > 0) b->weights[i / step + 1][k] += weight * part;
        }
    }
    for (int i = 0; i < b->count; i++)
        for (int k = 0; k < 3; k++) b->weights[i][k] /= norm;
}

// XYZ of the reflectance c and its derivatives.
static void integrate(const basis *b, const double c[3], double xyz[3], double by_c[3][3]) {
    double sum[3] = {0, 0, 0}, moment[3][3] = {{0}};
    for (int i = 0; i < b->count; i++) {
        const double t = i / (b->count - 1.0), p = (c[0] * t + c[1]) * t + c[2];
        const double over = 1 / sqrt(1 + p * p), s = 0.5 + 0.5 * p * over, slope = 0.5 * over * over * over;
        for (int k = 0; k < 3; k++) {
            const double w = b->weights[i][k] * slope;
            sum[k] += b->weights[i][k] * s;
            moment[k][2] += w, moment[k][1] += w * t, moment[k][0] += w * t * t;
        }
    }
    for (int k = 0; k < 3; k++) {
        xyz[k] = sum[k];
        for (int j = 0; j < 3; j++) by_c[k][j] = moment[k][j];
    }
}

static double distance2(const double a[3], const double b[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

void sagi_color_solve(const sagi_color_space *space, int step_nm, const double rgb[3], double c[3]) {
    basis b;
    make_basis(space, step_nm, &b);
    double target_xyz[3], target[3], xyz[3], lab[3], slopes[3][3], by_c[3][3];
    sagi_matrix_apply(space->to_xyz, rgb, target_xyz);
    to_lab(space, target_xyz, target, NULL);
    integrate(&b, c, xyz, by_c);
    to_lab(space, xyz, lab, slopes);
    double distance = distance2(lab, target);
    // Below that floats cannot tell.
    for (int i = 0; i < 25 && distance > 1e-11; i++) {
        double jacobian[3][3], inverse[3][3], step[3], difference[3];
        sagi_matrix_multiply(slopes, by_c, jacobian);
        if (!sagi_matrix_invert(jacobian, inverse)) return;
        for (int k = 0; k < 3; k++) difference[k] = target[k] - lab[k];
        sagi_matrix_apply(inverse, difference, step);
        double next[3], next_distance = distance;
        bool nearer = false;
        for (int half = 0; half < 6 && !nearer; half++) {
            double largest = LARGEST;
            for (int k = 0; k < 3; k++) {
                next[k] = c[k] + step[k];
                step[k] /= 2;
                if (fabs(next[k]) > largest) largest = fabs(next[k]);
            }
            for (int k = 0; k < 3; k++) next[k] *= LARGEST / largest;
            integrate(&b, next, xyz, by_c);
            to_lab(space, xyz, lab, slopes);
            next_distance = distance2(lab, target);
            nearer = next_distance < distance;
        }
        if (!nearer) return;
        for (int k = 0; k < 3; k++) c[k] = next[k];
        distance = next_distance;
    }
}
