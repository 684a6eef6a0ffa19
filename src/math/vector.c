// SPDX-License-Identifier: MIT
// The vector functions that are more than a line.
#include "math/map.h"

// Where the sum of squares would overflow or underflow, the vector is first brought near 1 by a power of two,
// which is exact.
sag_vec3 sag_normalize(sag_vec3 a) {
    double squared = sag_dot(a, a);
    if (!sagi_square_is_safe(squared)) {
        double largest = sag_max_component(sag_abs(a));
        if (largest == 0) return a;
        int exponent = isfinite(largest) ? ilogb(largest) : 0; // of an infinite vector comes NaN
        a = sag_vec3_make(scalbn(a.x, -exponent), scalbn(a.y, -exponent), scalbn(a.z, -exponent));
        squared = sag_dot(a, a);
    }
    double length = sqrt(squared);
    return sag_vec3_make(a.x / length, a.y / length, a.z / length);
}

void sag_frame(sag_vec3 n, sag_vec3 *s, sag_vec3 *t) { sagi_frame(n, s, t); }
