// SPDX-License-Identifier: MIT
#include "math/determinant.h"

double sagi_determinant(sag_vec3 a, sag_vec3 b, sag_vec3 c, double *error) {
    sag_vec3 p = {b.y * c.z, b.z * c.x, b.x * c.y}, q = {b.z * c.y, b.x * c.z, b.y * c.x};
    double permanent = fabs(a.x) * (fabs(p.x) + fabs(q.x)) + fabs(a.y) * (fabs(p.y) + fabs(q.y)) +
                       fabs(a.z) * (fabs(p.z) + fabs(q.z));
    *error = 11 * 0x1p-53 * permanent; // 10u P and the rounding of P itself
    return a.x * (p.x - q.x) + a.y * (p.y - q.y) + a.z * (p.z - q.z);
}

static sagi_dd minor_dd(sagi_dd a, sagi_dd b, sagi_dd c, sagi_dd d) {
    return sagi_dd_sub(sagi_dd_mul(a, b), sagi_dd_mul(c, d));
}

sagi_dd sagi_determinant_dd(sagi_dd3 a, sagi_dd3 b, sagi_dd3 c, double *error) {
    sagi_determinant(sagi_dd3_round(a), sagi_dd3_round(b), sagi_dd3_round(c), error);
    *error *= 0x1p-51; // from 11·2⁻⁵³ P to above 2⁻¹⁰¹ P
    sagi_dd x = sagi_dd_mul(a.x, minor_dd(b.y, c.z, b.z, c.y));
    sagi_dd y = sagi_dd_mul(a.y, minor_dd(b.z, c.x, b.x, c.z));
    sagi_dd z = sagi_dd_mul(a.z, minor_dd(b.x, c.y, b.y, c.x));
    return sagi_dd_add(sagi_dd_add(x, y), z);
}

static sagi_real real_from_dd(sagi_dd a) { return sagi_real_add(sagi_real_from(a.hi), sagi_real_from(a.lo)); }

static sagi_real minor_real(sagi_dd a, sagi_dd b, sagi_dd c, sagi_dd d) {
    return sagi_real_sub(sagi_real_mul(real_from_dd(a), real_from_dd(b)),
                         sagi_real_mul(real_from_dd(c), real_from_dd(d)));
}

sagi_real sagi_determinant_real(sagi_dd3 a, sagi_dd3 b, sagi_dd3 c) {
    sagi_real x = sagi_real_mul(real_from_dd(a.x), minor_real(b.y, c.z, b.z, c.y));
    sagi_real y = sagi_real_mul(real_from_dd(a.y), minor_real(b.z, c.x, b.x, c.z));
    sagi_real z = sagi_real_mul(real_from_dd(a.z), minor_real(b.x, c.y, b.y, c.x));
    return sagi_real_add(sagi_real_add(x, y), z);
}

static double minor_accurate(double a, double b, double c, double d) {
    return sagi_dd_sub(sagi_two_prod(a, b), sagi_two_prod(c, d)).hi;
}

sag_vec3 sagi_cross_accurate(sag_vec3 a, sag_vec3 b) {
    return (sag_vec3){minor_accurate(a.y, b.z, a.z, b.y), minor_accurate(a.z, b.x, a.x, b.z),
                      minor_accurate(a.x, b.y, a.y, b.x)};
}

sagi_dd sagi_dot_dd(sagi_dd3 a, sagi_dd3 b) {
    return sagi_dd_add(sagi_dd_add(sagi_dd_mul(a.x, b.x), sagi_dd_mul(a.y, b.y)), sagi_dd_mul(a.z, b.z));
}

sagi_real sagi_dot_real(sagi_dd3 a, sagi_dd3 b) {
    sagi_real x = sagi_real_mul(real_from_dd(a.x), real_from_dd(b.x));
    sagi_real y = sagi_real_mul(real_from_dd(a.y), real_from_dd(b.y));
    sagi_real z = sagi_real_mul(real_from_dd(a.z), real_from_dd(b.z));
    return sagi_real_add(sagi_real_add(x, y), z);
}
