// SPDX-License-Identifier: MIT
// Area of a bilinear patch, and uniform points of it.
//
// The area element |dp/du × dp/dv| = |n + u n_u + v n_v| is the root of a quadratic in u for each v, so the
// inner integral is elementary: with N = n + v n_v, A = |n_u|², s = u + N·n_u/A and h = |N × n_u| / |n_u|,
//
//     ∫ √(A s² + h²) ds = ½ (s √(A s² + h²) + h²/√A · asinh(√A s / h)).
//
// Where n_u is much smaller than N the two ends' difference would cancel; the integrand is then nearly
// constant and Gauss's rule is exact. The outer integral is done by Gauss's rule of eight points on intervals
// that are halved until both halves agree with the whole: seldom more than once, but a folded patch has a
// kink.
//
// A uniform point: v where the area up to v is random.x of the whole, then u where the inner integral up to u
// is random.y of it; both by Newton's method, whose derivative is at hand, held in a bracket.
#include "shapes/bilinear.h"

static const double gauss_x[4] = {0.18343464249564980494, 0.52553240991632898582, 0.79666647741362673959,
                                  0.96028985649753623168};
static const double gauss_w[4] = {0.36268378337836198297, 0.31370664587788728734, 0.22238103445337447054,
                                  0.10122853629037625915};

sagi_bilinear_frame sagi_bilinear_make_frame(const sag_bilinear_patch *s) {
    sagi_bilinear_frame f = {.u_edge = sag_sub(s->p10, s->p00), .v_edge = sag_sub(s->p01, s->p00)};
    f.twist = sag_sub(sag_sub(s->p11, s->p01), f.u_edge);
    f.n = sag_cross(f.u_edge, f.v_edge);
    f.n_u = sag_cross(f.u_edge, f.twist);
    f.n_v = sag_cross(f.twist, f.v_edge);
    return f;
}

static double length(sag_vec3 a) {
    double largest = sag_max_component(sag_abs(a));
    return largest > 0 ? largest * sag_length(sag_scale(a, 1 / largest)) : 0;
}

static double element(const sagi_bilinear_frame *f, double u, double v) {
    return length(sag_madd(sag_madd(f->n, u, f->n_u), v, f->n_v));
}

static double antiderivative(double a, double s, double h) {
    double root = sqrt(a * a * s * s + h * h), tail = h > 0 ? h * h / a * asinh(a * s / h) : 0;
    return 0.5 * (s * root + tail);
}

// ∫ over u from 0 to u at v.
static double strip(const sagi_bilinear_frame *f, double u, double v) {
    sag_vec3 n = sag_madd(f->n, v, f->n_v);
    double a = length(f->n_u), size = length(n);
    if (!(a > 0x1p-10 * size)) {
        double sum = 0;
        for (int i = 0; i < 4; i++)
            sum += gauss_w[i] *
                   (element(f, 0.5 * u * (1 - gauss_x[i]), v) + element(f, 0.5 * u * (1 + gauss_x[i]), v));
        return 0.5 * u * sum;
    }
    sag_vec3 along = sag_scale(f->n_u, 1 / a);
    double shift = sag_dot(n, along) / a, h = length(sag_cross(n, along));
    return antiderivative(a, u + shift, h) - antiderivative(a, shift, h);
}

static double gauss(const sagi_bilinear_frame *f, double from, double to) {
    double middle = 0.5 * (from + to), half = 0.5 * (to - from), sum = 0;
    for (int i = 0; i < 4; i++)
        sum +=
            gauss_w[i] * (strip(f, 1, middle - half * gauss_x[i]) + strip(f, 1, middle + half * gauss_x[i]));
    return half * sum;
}

// The area between two v. The intervals that wait are ever shorter halves, so their number is the depth.
static double area_between(const sagi_bilinear_frame *f, double from, double to) {
    enum { DEPTH = 40 };
    struct {
        double from, to, value;
    } stack[DEPTH + 1];
    int top = 0, halvings = 0; // the bound on halvings is for areas that are not numbers
    double sum = 0, whole = gauss(f, from, to), tolerance = 1e-13 * fabs(whole);
    stack[0].from = from, stack[0].to = to, stack[0].value = whole;
    while (top >= 0) {
        double a = stack[top].from, b = stack[top].to, middle = 0.5 * (a + b);
        double left = gauss(f, a, middle), right = gauss(f, middle, b);
        if (!(fabs(left + right - stack[top].value) > tolerance) || top == DEPTH || ++halvings > 2000) {
            sum += left + right;
            top--;
            continue;
        }
        stack[top].from = middle, stack[top].value = right;
        top++;
        stack[top].from = a, stack[top].to = middle, stack[top].value = left;
    }
    return sum;
}

double sagi_bilinear_area(const sagi_bilinear_frame *f) { return area_between(f, 0, 1); }

sag_vec2 sagi_bilinear_sample(const sagi_bilinear_frame *f, double area, sag_vec2 random) {
    double target = random.x * area, low = 0, high = 1, v = random.x, reached = 0, at = 0;
    for (int i = 0; i < 60; i++) {
        reached += area_between(f, at, v);
        at = v;
        if (reached <= target)
            low = v;
        else
            high = v;
        double next = v - (reached - target) / strip(f, 1, v);
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - v) <= 0x1p-50) break;
        v = next;
    }
    double row = random.y * strip(f, 1, v), u = random.y;
    low = 0, high = 1;
    for (int i = 0; i < 60; i++) {
        double left = strip(f, u, v);
        if (left <= row)
            low = u;
        else
            high = u;
        double next = u - (left - row) / element(f, u, v);
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - u) <= 0x1p-50) break;
        u = next;
    }
    return (sag_vec2){u, v};
}
