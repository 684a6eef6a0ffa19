// SPDX-License-Identifier: MIT
// Where geometries stand.
//
// How much an affine map stretches: |M v|² = vᵀ(MᵀM)v, so the stretches lie between the square roots of the
// least and greatest eigenvalue of the symmetric S = MᵀM. Jacobi's rotations make S diagonal; what remains
// off the diagonal bounds the error (Gershgorin's circles). Before that M is scaled by a power of two, so
// that no square overflows.
#include "scene/scene.h"

#include "math/affine_inverse.h"

// One Jacobi rotation that makes s[p][q] zero (Golub & Van Loan, "Matrix Computations", §8.5).
static void rotate(double s[3][3], int p, int q) {
    if (s[p][q] == 0) return;
    double theta = (s[q][q] - s[p][p]) / (2 * s[p][q]);
    double t = copysign(1, theta) / (fabs(theta) + sqrt(1 + theta * theta));
    double c = 1 / sqrt(1 + t * t), sine = t * c;
    int r = 3 - p - q;
    double spq = s[p][q], srp = s[r][p], srq = s[r][q];
    s[p][p] -= t * spq, s[q][q] += t * spq;
    s[p][q] = s[q][p] = 0;
    s[r][p] = s[p][r] = c * srp - sine * srq;
    s[r][q] = s[q][r] = sine * srp + c * srq;
}

void sagi_affine_stretch(const sag_affine *a, double *least, double *most, bool *similarity) {
    double largest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) largest = fmax(largest, fabs(a->m[i][j]));
    int exponent;
    frexp(largest, &exponent);
    double s[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            s[i][j] = 0;
            for (int k = 0; k < 3; k++)
                s[i][j] += ldexp(a->m[k][i], -exponent) * ldexp(a->m[k][j], -exponent);
        }
    for (int sweep = 0; sweep < 12; sweep++) rotate(s, 0, 1), rotate(s, 0, 2), rotate(s, 1, 2);
    double off = 2 * (fabs(s[0][1]) + fabs(s[0][2]) + fabs(s[1][2]));
    double low = fmin(s[0][0], fmin(s[1][1], s[2][2])), high = fmax(s[0][0], fmax(s[1][1], s[2][2]));
    off += 0x1p-46 * high; // the roundings: a dozen of them an element, each 2⁻⁵³ of the largest
    *least = ldexp(sqrt(fmax(low - off, 0)), exponent);
    *most = ldexp(sqrt(high + off), exponent);
    *similarity = high - low <= 0x1p-40 * high;
}

bool sagi_place_make(const sag_affine *to_scene, sagi_place *place) {
    sagi_place p = {.to_scene = *to_scene};
    if (!sag_affine_inverse(to_scene, &p.to_object)) return false;
    p.mirrored = sagi_affine_is_mirror(to_scene);
    sagi_affine_stretch(to_scene, &p.stretch_min, &p.stretch_max, &p.similarity);
    *place = p;
    return true;
}
