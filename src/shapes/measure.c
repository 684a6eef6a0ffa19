// SPDX-License-Identifier: MIT
// Signed areas and barycentric coordinates.
//
// Everything rests on one number, twice the signed area of a triangle: (a − c) × (b − c) in the plane, the
// vector (b − a) × (c − a) in space. A barycentric weight is the quotient of two areas: that of the triangle
// with the vertex replaced by p, over that of the whole. Doubles give an area with an error below 4ε of the
// products' absolute sum (ε = 2⁻⁵³: differences, product, difference); where that is more than 2⁻⁴⁰ of the
// result, expansions give it to the last bit, so that no sign is ever wrong and a triangle counts as having
// no area only when it has none.
#include "math/real3.h"
#include "shapes/common.h"
#include "shapes/triangle.h"
#include "shapes/vector_expansion.h"

// value · 2^exponent: areas of tiny triangles lie below what a double holds.
typedef struct scaled {
    double value;
    int exponent;
} scaled;

static scaled area_2d_exact(sag_vec2 a, sag_vec2 b, sag_vec2 c) {
    sagi_expansion3 ac = sagi_expansion3_from_diff((sag_vec3){a.x, a.y, 0}, (sag_vec3){c.x, c.y, 0});
    sagi_expansion3 bc = sagi_expansion3_from_diff((sag_vec3){b.x, b.y, 0}, (sag_vec3){c.x, c.y, 0});
    int exponent = -sagi_expansion3_normalize(&ac) - sagi_expansion3_normalize(&bc);
    double h[16];
    int n = sagi_expansion3_cross_component(&ac, &bc, 2, h);
    return (scaled){sagi_expansion_estimate(n, h), exponent};
}

// Twice the signed area.
static scaled area_2d(sag_vec2 a, sag_vec2 b, sag_vec2 c) {
    double plus = (a.x - c.x) * (b.y - c.y), minus = (a.y - c.y) * (b.x - c.x);
    double sum = fabs(plus) + fabs(minus);
    if (sum >= 0x1p-900 && sum <= 0x1p900 && fabs(plus - minus) >= 0x1p-11 * sum)
        return (scaled){plus - minus, 0};
    return area_2d_exact(a, b, c);
}

// Rounded to a double, but never to 0 what is not 0.
static double unscaled(scaled a) {
    double value = ldexp(a.value, a.exponent);
    return value != 0 || !(a.value != 0) ? value : copysign(0x1p-1074, a.value);
}

static double quotient(scaled a, scaled b) {
    return unscaled((scaled){a.value / b.value, a.exponent - b.exponent});
}

bool sag_barycentric_1d(double p, double a, double b, double weights[2]) {
    double length = b - a;
    if (!isfinite(length) || length == 0 || !isfinite(p)) return false;
    weights[0] = (b - p) / length;
    weights[1] = (p - a) / length;
    return true;
}

bool sag_barycentric_2d(sag_vec2 p, sag_vec2 a, sag_vec2 b, sag_vec2 c, double weights[3]) {
    scaled whole = area_2d(a, b, c);
    if (!(whole.value < 0 || whole.value > 0) || !isfinite(p.x) || !isfinite(p.y)) return false;
    weights[0] = quotient(area_2d(p, b, c), whole);
    weights[1] = quotient(area_2d(a, p, c), whole);
    weights[2] = quotient(area_2d(a, b, p), whole);
    return true;
}

static double real_quotient(sagi_real a, sagi_real b) {
    sagi_real q = sagi_real_div(a, b);
    return sagi_real_to_double(&q);
}

// The differences brought to the order of 1, so that no square under- or overflows.
static sag_vec3 scaled_down(sag_vec3 a, int exponent) {
    return sag_vec3_make(ldexp(a.x, -exponent), ldexp(a.y, -exponent), ldexp(a.z, -exponent));
}

// With n = (b − a) × (c − a): the weight of b is ((p − a) × (c − a)) · n / n², that of c is ((b − a) × (p −
// a)) · n / n². Only the part of p − a in the plane counts, so p need not lie in it.
bool sag_barycentric_3d(sag_vec3 p, sag_vec3 a, sag_vec3 b, sag_vec3 c, double weights[3]) {
    sag_vec3 ab = sag_sub(b, a), ac = sag_sub(c, a), ap = sag_sub(p, a);
    double size = fmax(sag_max_component(sag_abs(ab)), sag_max_component(sag_abs(ac)));
    if (!sag_is_finite(ab) || !sag_is_finite(ac) || !sag_is_finite(ap) || !(size > 0)) return false;
    if (!sagi_triangle_has_area(&a, &b, &c)) return false;
    int exponent = ilogb(size);
    ab = scaled_down(ab, exponent), ac = scaled_down(ac, exponent), ap = scaled_down(ap, exponent);
    sag_vec3 n = sag_cross(ab, ac);
    double square = sag_dot(n, n);
    if (square > 0x1p-16) { // |n| > 2⁻⁸: its rounding, some 8 · 2⁻⁵³, is 2⁻⁴² of it at most
        weights[1] = sag_dot(sag_cross(ap, ac), n) / square;
        weights[2] = sag_dot(sag_cross(ab, ap), n) / square;
        weights[0] = 1 - weights[1] - weights[2];
        return true;
    }
    sagi_real3 x = sagi_real3_from_diff(b, a, exponent), y = sagi_real3_from_diff(c, a, exponent); // a needle
    sagi_real3 z = sagi_real3_from_diff(p, a, exponent), normal = sagi_real3_cross(&x, &y);
    sagi_real3 at_b = sagi_real3_cross(&z, &y), at_c = sagi_real3_cross(&x, &z);
    sagi_real whole = sagi_real3_dot(&normal, &normal), beta = sagi_real3_dot(&at_b, &normal);
    sagi_real gamma = sagi_real3_dot(&at_c, &normal);
    weights[1] = real_quotient(beta, whole);
    weights[2] = real_quotient(gamma, whole);
    weights[0] = real_quotient(sagi_real_sub(sagi_real_sub(whole, beta), gamma), whole);
    return true;
}

double sag_triangle_signed_area_2d(sag_vec2 a, sag_vec2 b, sag_vec2 c) {
    scaled twice = area_2d(a, b, c);
    twice.exponent--;
    return unscaled(twice);
}

double sag_triangle_area_2d(sag_vec2 a, sag_vec2 b, sag_vec2 c) {
    return fabs(sag_triangle_signed_area_2d(a, b, c));
}

double sag_triangle_area_3d(sag_vec3 a, sag_vec3 b, sag_vec3 c) {
    sag_vec3 unit;
    return 0.5 * sagi_triangle_normal(&a, &b, &c, &unit);
}

// The side by the sign of ((b − a) × (c − a)) · normal, exactly.
double sag_triangle_signed_area_3d(sag_vec3 a, sag_vec3 b, sag_vec3 c, sag_vec3 normal) {
    sagi_expansion3 ab = sagi_expansion3_from_diff(b, a), ac = sagi_expansion3_from_diff(c, a);
    sagi_expansion3 towards = sagi_expansion3_from(normal);
    sagi_expansion3_normalize(&ab);
    sagi_expansion3_normalize(&ac);
    sagi_expansion3_normalize(&towards);
    sagi_expansion3 n = sagi_expansion3_cross(&ab, &ac);
    sagi_expansion3_normalize(&n);
    double h[192];
    return sagi_expansion_sign(sagi_expansion3_dot(&n, &towards, h), h) * sag_triangle_area_3d(a, b, c);
}
