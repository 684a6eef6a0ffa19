// SPDX-License-Identifier: MIT
// Affine maps: making, applying and multiplying them.
#include "math/elementary.h"
#include "math/map.h"

sag_affine sag_affine_identity(void) { return sag_affine_scale(sag_vec3_make(1, 1, 1)); }

bool sag_affine_is_identity(const sag_affine *a) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            if (!(a->m[i][j] == (i == j))) return false;
    return true;
}

sag_affine sag_affine_translate(sag_vec3 offset) {
    return (sag_affine){{{1, 0, 0, offset.x}, {0, 1, 0, offset.y}, {0, 0, 1, offset.z}}};
}

sag_affine sag_affine_scale(sag_vec3 factors) {
    return (sag_affine){{{factors.x, 0, 0, 0}, {0, factors.y, 0, 0}, {0, 0, factors.z, 0}}};
}

// Sine and cosine, exact for multiples of a right angle. No double is π/2, so "is a multiple" means: within
// the few roundings that a conversion from degrees makes, relative to the angle. The sine there is less than
// that off; the cosine of what was meant is 0.
static void sine_cosine(double angle_rad, double *sine, double *cosine) {
    const double half_pi = 1.57079632679489661923;
    double quarters = rint(angle_rad / half_pi);
    if (fabs(angle_rad - quarters * half_pi) <= 4 * 0x1p-53 * fabs(angle_rad) && fabs(quarters) < 0x1p50) {
        int quarter = (int)fmod(quarters, 4);
        if (quarter < 0) quarter += 4;
        *sine = quarter == 1 ? 1 : quarter == 3 ? -1 : 0;
        *cosine = quarter == 0 ? 1 : quarter == 2 ? -1 : 0;
        return;
    }
    *sine = sagi_sin(angle_rad);
    *cosine = sagi_cos(angle_rad);
}

// Rodrigues: R = nnᵀ + cos(1 − nnᵀ) + sin [n]×, with the diagonal written n² + (1 − n²) cos so that a turn
// about a coordinate axis leaves that axis exactly where it is.
sag_affine sag_affine_rotate(double angle_rad, sag_vec3 axis) {
    sag_vec3 n = sag_normalize(axis);
    if (n.x == 0 && n.y == 0 && n.z == 0) return sag_affine_identity();
    double s, c;
    sine_cosine(angle_rad, &s, &c);
    double k = 1 - c;
    return (sag_affine){{
        {n.x * n.x + (1 - n.x * n.x) * c, n.x * n.y * k - n.z * s, n.x * n.z * k + n.y * s, 0},
        {n.x * n.y * k + n.z * s, n.y * n.y + (1 - n.y * n.y) * c, n.y * n.z * k - n.x * s, 0},
        {n.x * n.z * k - n.y * s, n.y * n.z * k + n.x * s, n.z * n.z + (1 - n.z * n.z) * c, 0},
    }};
}

sag_affine sag_affine_from_columns(sag_vec3 x, sag_vec3 y, sag_vec3 z, sag_vec3 origin) {
    return (sag_affine){{{x.x, y.x, z.x, origin.x}, {x.y, y.y, z.y, origin.y}, {x.z, y.z, z.z, origin.z}}};
}

sag_affine sag_affine_along(sag_vec3 from, sag_vec3 to) {
    sag_vec3 axis = sag_sub(to, from);
    if (!sag_is_finite(axis))
        axis = sag_sub(sag_scale(to, 0.5), sag_scale(from, 0.5)); // the difference overflowed
    sag_vec3 z = sag_normalize(axis), x, y;
    if (z.x == 0 && z.y == 0 && z.z == 0) z.z = 1;
    sag_frame(z, &x, &y);
    return sag_affine_from_columns(x, y, z, from);
}

sag_affine sag_affine_multiply(const sag_affine *a, const sag_affine *b) {
    sag_affine r;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            r.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j] +
                        (j == 3 ? a->m[i][3] : 0);
    return r;
}

sag_vec3 sag_affine_point(const sag_affine *a, sag_vec3 p) { return sagi_affine_point(a, p); }
sag_vec3 sag_affine_vector(const sag_affine *a, sag_vec3 v) { return sagi_affine_vector(a, v); }

sag_vec3 sag_affine_transposed(const sag_affine *a, sag_vec3 n) {
    return sag_vec3_make(a->m[0][0] * n.x + a->m[1][0] * n.y + a->m[2][0] * n.z,
                         a->m[0][1] * n.x + a->m[1][1] * n.y + a->m[2][1] * n.z,
                         a->m[0][2] * n.x + a->m[1][2] * n.y + a->m[2][2] * n.z);
}
