// SPDX-License-Identifier: MIT
// B. Carlson, "Numerical computation of real or complex elliptic integrals", Numerical Algorithms 10, 1995:
// the duplication theorem brings the three arguments together, by a factor of four a step, then a short
// series does.
#include "shapes/carlson.h"
#include <math.h>

#define CLOSE 0x1p-9 // the series' first neglected term is of sixth order: below 2⁻⁵⁴ times a small factor

static double largest(double a, double b, double c) { return fmax(fabs(a), fmax(fabs(b), fabs(c))); }

// R_F(x, y, z) = ½ ∫₀^∞ dt / √((t + x)(t + y)(t + z))
static double carlson_rf(double x, double y, double z) {
    for (int i = 0; i < 600; i++) {
        double mean = (x + y + z) / 3;
        double dx = 1 - x / mean, dy = 1 - y / mean, dz = 1 - z / mean;
        if (largest(dx, dy, dz) < CLOSE) {
            double e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
            return (1 - e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44) / sqrt(mean);
        }
        double rx = sqrt(x), ry = sqrt(y), rz = sqrt(z), step = rx * ry + ry * rz + rz * rx;
        x = (x + step) / 4, y = (y + step) / 4, z = (z + step) / 4;
    }
    return 0;
}

// R_D(x, y, z) = 3/2 ∫₀^∞ dt / (√((t + x)(t + y)) (t + z)^{3/2})
static double carlson_rd(double x, double y, double z) {
    double sum = 0, factor = 1;
    for (int i = 0; i < 600; i++) {
        double mean = (x + y + 3 * z) / 5;
        double dx = 1 - x / mean, dy = 1 - y / mean, dz = 1 - z / mean;
        if (largest(dx, dy, dz) < CLOSE) {
            double ea = dx * dy, eb = dz * dz, ec = ea - eb, ed = ea - 6 * eb, ee = ed + 2 * ec;
            double series = 1 + ed * (-3.0 / 14 + 9.0 / 88 * ed - 9.0 / 52 * dz * ee) +
                            dz * (ee / 6 + dz * (-9.0 / 22 * ec + dz * 3.0 / 26 * ea));
            return 3 * sum + factor * series / (mean * sqrt(mean));
        }
        double rx = sqrt(x), ry = sqrt(y), rz = sqrt(z), step = rx * ry + ry * rz + rz * rx;
        sum += factor / (rz * (z + step));
        factor /= 4;
        x = (x + step) / 4, y = (y + step) / 4, z = (z + step) / 4;
    }
    return 0;
}

// 2 R_G = z R_F − (x − z)(y − z) R_D/3 + √(xy/z): with z the middle one every term is positive.
double sagi_carlson_rg(double x, double y, double z) {
    double low = fmin(x, fmin(y, z)), high = fmax(x, fmax(y, z));
    double middle = fmax(fmin(x, y), fmin(fmax(x, y), z));
    if (!(middle > 0)) return sqrt(high) / 2;
    return (middle * carlson_rf(low, high, middle) +
            (middle - low) * (high - middle) * carlson_rd(low, high, middle) / 3 +
            sqrt(low * (high / middle))) /
           2;
}
