// SPDX-License-Identifier: MIT
// Cutting a triangle at planes, conservatively.
//
// The corners given are within ε = 2⁻⁵² of the true ones, and so is the triangle, point by point: if a true
// point lies between the planes, its counterpart in the triangle given lies between planes moved outward by
// ε. We cut the triangle given, taken for exact, at planes moved by SLACK = 2⁻⁴⁸ (c ± 2⁻⁴⁸ errs by 2⁻⁵³), so
// what is cut off has no true point between the planes. An edge a b meets the plane c where
//     r = (c − aₓ)/(bₓ − aₓ) ∈ [0, 1],   y = a_y + r (b_y − a_y).
// With u = 2⁻⁵³, r errs by 3u r, the product by 5u |b_y − a_y| ≤ 10u in all, the sum by 2u: y is off by less
// than 12u + ε < 2⁻⁴⁸. The box of all these points, widened by SLACK and rounded outward to floats, holds the
// part; along the axis it ends at the planes themselves.
#include "bvh/clip.h"

#define SLACK 0x1p-48

typedef struct double_box {
    double lo[3], hi[3];
} double_box;

static void extend(double_box *box, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        box->lo[k] = p[k] < box->lo[k] ? p[k] : box->lo[k];
        box->hi[k] = p[k] > box->hi[k] ? p[k] : box->hi[k];
    }
}

// The point where an edge crosses a plane, if it does.
static void extend_by_crossing(double_box *box, const double a[3], const double b[3], int axis, double c) {
    if ((a[axis] < c) == (b[axis] < c)) return;
    double r = (c - a[axis]) / (b[axis] - a[axis]), p[3];
    for (int k = 0; k < 3; k++) p[k] = a[k] + r * (b[k] - a[k]);
    p[axis] = c;
    extend(box, p);
}

void sagi_clip_triangle(const double corner[3][3], int axis, float lo, float hi, sagi_float_box *box) {
    double least = (double)lo - SLACK, most = (double)hi + SLACK;
    double_box part = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < 3; i++) {
        const double *a = corner[i], *b = corner[(i + 1) % 3];
        if (a[axis] >= least && a[axis] <= most) extend(&part, a);
        extend_by_crossing(&part, a, b, axis, least);
        extend_by_crossing(&part, a, b, axis, most);
    }
    box->lo[axis] = sagi_float_max(box->lo[axis], lo), box->hi[axis] = sagi_float_min(box->hi[axis], hi);
    for (int k = 0; k < 3; k++) {
        box->lo[k] = sagi_float_max(box->lo[k], sagi_float_down(part.lo[k] - SLACK));
        box->hi[k] = sagi_float_min(box->hi[k], sagi_float_up(part.hi[k] + SLACK));
    }
}
