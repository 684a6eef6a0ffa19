// SPDX-License-Identifier: MIT
// Inverse and determinant of affine maps, by Cramer's rule in exact arithmetic: M⁻¹ = adj(M)/det(M).
//
// The rows and then the columns of M are first brought near 1 by powers of two, M = 2^r · N · 2^c, which is
// exact, so that no product over- or underflows whatever the scales: M⁻¹ = 2^−c · N⁻¹ · 2^−r. The determinant
// and the cofactors of N are exact expansions, so "singular" means singular, and each element of the inverse,
// rounded once, is within an ulp of the true one.
#include "math/affine_inverse.h"
#include "math/dd.h"
#include "math/expansion.h"
#include <string.h>

typedef struct balanced {
    double n[3][3];
    int row[3], column[3]; // exponents: M[i][j] = N[i][j] · 2^(row[i] + column[j])
} balanced;

// False when M is not finite or a row or column is zero.
static bool balance(const sag_affine *a, balanced *b) {
    for (int i = 0; i < 3; i++) {
        double largest = 0;
        for (int j = 0; j < 3; j++) {
            if (!isfinite(a->m[i][j])) return false;
            largest = fmax(largest, fabs(a->m[i][j]));
        }
        if (largest == 0) return false;
        b->row[i] = ilogb(largest);
    }
    for (int j = 0; j < 3; j++) {
        int largest = -10000;
        for (int i = 0; i < 3; i++) {
            if (a->m[i][j] == 0) continue;
            int exponent = ilogb(a->m[i][j]) - b->row[i];
            if (exponent > largest) largest = exponent;
        }
        if (largest == -10000) return false;
        b->column[j] = largest;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) b->n[i][j] = scalbn(a->m[i][j], -b->row[i] - b->column[j]);
    return true;
}

// The cofactor of N[i][j]: the 2×2 determinant of the other rows and columns, taken in cyclic order so that
// the sign comes out right. At most 4 components.
static int cofactor(const balanced *b, int i, int j, double h[4]) {
    int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    double p[2], q[2];
    int np = sagi_expansion_from_product(b->n[i1][j1], b->n[i2][j2], p);
    int nq = sagi_expansion_from_product(b->n[i1][j2], b->n[i2][j1], q);
    return sagi_expansion_diff(np, p, nq, q, h);
}

// Along the first row. At most 24 components.
static int determinant(const balanced *b, double h[24]) {
    int count = 0;
    for (int j = 0; j < 3; j++) {
        double c[4], term[8], sum[24];
        int nc = cofactor(b, 0, j, c);
        int nt = sagi_expansion_scale(nc, c, b->n[0][j], term);
        count = sagi_expansion_sum(count, h, nt, term, sum);
        memcpy(h, sum, (size_t)count * sizeof *h);
    }
    return count;
}

// An expansion's two leading doubles.
static sagi_dd leading(int count, const double *expansion) {
    double c[24];
    int n = sagi_expansion_compress(count, expansion, c);
    return (sagi_dd){n > 0 ? c[n - 1] : 0, n > 1 ? c[n - 2] : 0};
}

double sag_affine_determinant(const sag_affine *a) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!isfinite(a->m[i][j])) return NAN;
    balanced b;
    if (!balance(a, &b)) return 0;
    double h[24];
    sagi_dd d = leading(determinant(&b, h), h);
    return scalbn(d.hi, b.row[0] + b.row[1] + b.row[2] + b.column[0] + b.column[1] + b.column[2]);
}

bool sagi_affine_has_inverse(const sag_affine *a) {
    sag_affine inverse;
    return sagi_affine_quick_sign(a) != 0 || sag_affine_inverse(a, &inverse);
}

bool sag_affine_inverse(const sag_affine *a, sag_affine *inverse) {
    balanced b;
    if (!balance(a, &b)) return false;
    double h[24];
    int count = determinant(&b, h);
    if (count == 0) return false;
    sagi_dd d = leading(count, h);
    sag_affine r;
    for (int j = 0; j < 3; j++) {
        // Row j of the inverse, and of −M⁻¹t: there t is brought to the same scale, 2^−row, as N's rows.
        sagi_dd moved = {0, 0};
        for (int i = 0; i < 3; i++) {
            double c[4];
            sagi_dd element = sagi_dd_div(leading(cofactor(&b, i, j, c), c), d);
            r.m[j][i] = scalbn(element.hi, -b.column[j] - b.row[i]);
            moved = sagi_dd_add(moved, sagi_dd_mul_double(element, scalbn(a->m[i][3], -b.row[i])));
        }
        r.m[j][3] = moved.hi == 0 ? 0 : scalbn(-moved.hi, -b.column[j]);
        for (int i = 0; i < 4; i++)
            if (!isfinite(r.m[j][i])) return false;
    }
    *inverse = r;
    return true;
}
