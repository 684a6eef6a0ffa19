// SPDX-License-Identifier: MIT
#include "shapes/vector_expansion.h"
#include "math/dd.h"
#include <math.h>

int sagi_expansion3_normalize(sagi_expansion3 *a) {
    double largest = 0;
    for (int i = 0; i < 3; i++)
        if (a->count[i] > 0) largest = fmax(largest, fabs(a->terms[i][a->count[i] - 1]));
    if (!(largest > 0)) return 0;
    int exponent = 450 - ilogb(largest);
    for (int i = 0; i < 3; i++) {
        int kept = 0;
        for (int k = 0; k < a->count[i]; k++) {
            double scaled = ldexp(a->terms[i][k], exponent);
            if (fabs(scaled) >= 0x1p-485) a->terms[i][kept++] = scaled;
        }
        a->count[i] = kept;
    }
    return exponent;
}

sagi_expansion3 sagi_expansion3_from(sag_vec3 a) {
    return (sagi_expansion3){.count = {a.x != 0, a.y != 0, a.z != 0}, .terms = {{a.x}, {a.y}, {a.z}}};
}

sagi_expansion3 sagi_expansion3_from_diff(sag_vec3 a, sag_vec3 b) {
    sagi_expansion3 r;
    r.count[0] = sagi_expansion_from_diff(a.x, b.x, r.terms[0]);
    r.count[1] = sagi_expansion_from_diff(a.y, b.y, r.terms[1]);
    r.count[2] = sagi_expansion_from_diff(a.z, b.z, r.terms[2]);
    return r;
}

int sagi_expansion3_cross_component(const sagi_expansion3 *a, const sagi_expansion3 *b, int i, double *h) {
    double plus[64], minus[64];
    int j = (i + 1) % 3, k = (i + 2) % 3;
    int n = sagi_expansion_product(a->count[j], a->terms[j], b->count[k], b->terms[k], plus);
    int m = sagi_expansion_product(a->count[k], a->terms[k], b->count[j], b->terms[j], minus);
    return sagi_expansion_diff(n, plus, m, minus, h);
}

sagi_expansion3 sagi_expansion3_cross(const sagi_expansion3 *a, const sagi_expansion3 *b) {
    sagi_expansion3 r;
    for (int i = 0; i < 3; i++) r.count[i] = sagi_expansion3_cross_component(a, b, i, r.terms[i]);
    return r;
}

int sagi_expansion3_dot(const sagi_expansion3 *a, const sagi_expansion3 *b, double *h) {
    double x[64], y[64], z[64], xy[128];
    int nx = sagi_expansion_product(a->count[0], a->terms[0], b->count[0], b->terms[0], x);
    int ny = sagi_expansion_product(a->count[1], a->terms[1], b->count[1], b->terms[1], y);
    int nz = sagi_expansion_product(a->count[2], a->terms[2], b->count[2], b->terms[2], z);
    int n = sagi_expansion_sum(nx, x, ny, y, xy);
    return sagi_expansion_sum(n, xy, nz, z, h);
}

// The two leading components of an expansion, brought to the order of 1; *exponent is what was taken out.
static sagi_dd leading(int count, const double *expansion, int *exponent) {
    double small[192];
    *exponent = 0;
    int n = sagi_expansion_compress(count, expansion, small);
    if (n == 0) return sagi_dd_from(0);
    *exponent = ilogb(small[n - 1]);
    return (sagi_dd){ldexp(small[n - 1], -*exponent), n > 1 ? ldexp(small[n - 2], -*exponent) : 0};
}

double sagi_expansion_quotient(int n_count, const double *n, int d_count, const double *d, int exponent) {
    int n_exponent, d_exponent;
    sagi_dd numerator = leading(n_count, n, &n_exponent), denominator = leading(d_count, d, &d_exponent);
    double q = sagi_dd_to_double(sagi_dd_div(numerator, denominator));
    return ldexp(q, exponent + n_exponent - d_exponent);
}
