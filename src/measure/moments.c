// SPDX-License-Identifier: MIT
// Moments of a body, moved and turned about.
//
// Kept are the volume V, the centre c = ∫ x dV / V and the second moments about it, C = ∫ (x − c)(x − c)ᵀ dV:
// central ones lose nothing when the body is far from the origin. From raw sums F = ∫ x dV and S = ∫ x xᵀ dV
// about some point near the body:
//
//     c = F/V,   C = S − F Fᵀ/V.
//
// An affine map x ↦ M x + s multiplies dV by |det M| and takes differences to M times themselves, so
//
//     V' = |det M| V,   c' = M c + s,   C' = |det M| M C Mᵀ:
//
// exact for shears and unequal scalings too, which is why C is kept and not the inertia tensor
// J = ∫ (|r|² 1 − r rᵀ) dV = tr(C) 1 − C, that has no such rule. (Mirtich, "Fast and Accurate Computation of
// Polyhedral Mass Properties", J. Graphics Tools 1(2), 1996; Blow & Binstock, "How to find the inertia tensor
// of a 3D solid body", 2004.)
//
// Principal moments are J's eigenvalues, found by Jacobi's rotations: each makes one pair of elements off the
// diagonal zero, and all of them vanish quadratically (Golub & Van Loan, "Matrix Computations", §8.5).
#include "math/elementary.h"
#include "measure/measure.h"

// Rows and columns of the six second moments.
static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};

sagi_moments sagi_moments_from_raw(const sagi_raw_moments *raw, sag_vec3 origin) {
    const double *m = raw->m, volume = m[0];
    if (!(volume < 0 || volume > 0)) return (sagi_moments){.center = origin};
    const double c[3] = {m[1] / volume, m[2] / volume, m[3] / volume};
    sagi_moments result = {.volume = volume, .center = sag_add(origin, sag_vec3_make(c[0], c[1], c[2]))};
    for (int k = 0; k < 6; k++) result.central[k] = m[4 + k] - c[row[k]] * m[1 + column[k]];
    return result;
}

static void to_matrix(const double central[6], double matrix[3][3]) {
    for (int k = 0; k < 6; k++) matrix[row[k]][column[k]] = matrix[column[k]][row[k]] = central[k];
}

sagi_moments sagi_moments_map(const sagi_moments *moments, const sag_affine *map) {
    const double scale = fabs(sag_affine_determinant(map));
    sagi_moments result = {.volume = scale * moments->volume,
                           .center = sag_affine_point(map, moments->center)};
    double c[3][3], half[3][3]; // C and M C
    to_matrix(moments->central, c);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            half[i][j] = map->m[i][0] * c[0][j] + map->m[i][1] * c[1][j] + map->m[i][2] * c[2][j];
    for (int k = 0; k < 6; k++) {
        const double *a = half[row[k]], *b = map->m[column[k]];
        result.central[k] = scale * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    }
    return result;
}

void sagi_moments_inertia(const sagi_moments *moments, double inertia[3][3]) {
    const double *c = moments->central;
    to_matrix(c, inertia);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inertia[i][j] = -inertia[i][j];
    inertia[0][0] = c[1] + c[2], inertia[1][1] = c[0] + c[2], inertia[2][2] = c[0] + c[1];
}

// Makes a[p][q] zero; the columns of v are turned with it.
static void rotate(double a[3][3], double v[3][3], int p, int q) {
    if (a[p][q] == 0) return;
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = copysign(1, theta) / (fabs(theta) + sagi_hypot(1, theta));
    const double cosine = 1 / sqrt(1 + t * t), sine = t * cosine;
    const int r = 3 - p - q;
    const double apq = a[p][q], arp = a[r][p], arq = a[r][q];
    a[p][p] -= t * apq, a[q][q] += t * apq;
    a[p][q] = a[q][p] = 0;
    a[r][p] = a[p][r] = cosine * arp - sine * arq;
    a[r][q] = a[q][r] = sine * arp + cosine * arq;
    for (int i = 0; i < 3; i++) {
        const double vp = v[i][p], vq = v[i][q];
        v[i][p] = cosine * vp - sine * vq;
        v[i][q] = sine * vp + cosine * vq;
    }
}

// So that a larger component is positive: an axis has no sign of its own.
static sag_vec3 turned(sag_vec3 v) {
    const sag_vec3 size = sag_abs(v);
    const double largest = size.x >= size.y && size.x >= size.z ? v.x : size.y >= size.z ? v.y : v.z;
    return largest < 0 ? sag_neg(v) : v;
}

void sagi_symmetric_eigen(const double matrix[3][3], double values[3], sag_vec3 vectors[3]) {
    double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, largest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) largest = fmax(largest, fabs(matrix[i][j]));
    int exponent = 0;
    if (largest > 0 && isfinite(largest)) frexp(largest, &exponent); // so that no quotient overflows
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) a[i][j] = ldexp(matrix[i][j], -exponent);
    for (int sweep = 0; sweep < 12; sweep++) rotate(a, v, 0, 1), rotate(a, v, 0, 2), rotate(a, v, 1, 2);
    int order[3] = {0, 1, 2};
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && a[order[j]][order[j]] < a[order[j - 1]][order[j - 1]]; j--) {
            const int swap = order[j];
            order[j] = order[j - 1], order[j - 1] = swap;
        }
    for (int i = 0; i < 3; i++) {
        values[i] = ldexp(a[order[i]][order[i]], exponent);
        vectors[i] = turned(sag_vec3_make(v[0][order[i]], v[1][order[i]], v[2][order[i]]));
    }
    vectors[2] = sag_cross(vectors[0], vectors[1]);
}
