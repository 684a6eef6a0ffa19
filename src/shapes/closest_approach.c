// SPDX-License-Identifier: MIT
// Where two rays come closest.
//
// The square of the distance |w + t_b d_b − t_a d_a|², w = o_b − o_a, is a convex quadratic in (t_a, t_b), to
// be minimised over the rectangle of the two ranges. Without the ranges the common perpendicular gives it:
// with n = d_a × d_b,
//
//     t_a = (w × d_b) · n / n²,    t_b = (w × d_a) · n / n².
//
// (The textbook's a c − b² for n² cancels when the rays are nearly parallel; the cross product does not.) If
// that is inside the rectangle it is the answer; else the minimum lies on the rectangle's boundary, since the
// function is convex: on each side one parameter is fixed and the other is that of the nearest point on a
// line, clamped. The best of the four sides is it. (Ericson, Real-Time Collision Detection, §5.1.9, clamps
// in turn to the same end.) Parallel rays are at the same distance wherever they run side by side.
//
// Directions and w are brought to the order of 1 by powers of two, so that nothing over- or underflows.
#include "shapes/common.h"
#include "shapes/vector_expansion.h"

// The two rays in scaled units: true t = t · 2^(w_exponent − d_exponent).
typedef struct problem {
    sag_vec3 d_a, d_b, w;
    double a_min, a_max, b_min, b_max;
} problem;

static double clamp(double t, double low, double high) {
    t = t > low ? t : low;
    return t < high ? t : high;
}

static double distance_square(const problem *p, double t_a, double t_b) {
    sag_vec3 way = sag_madd(sag_madd(p->w, t_b, p->d_b), -t_a, p->d_a);
    return sag_dot(way, way);
}

// The t_b nearest to the point at t_a, and the other way round.
static double b_nearest(const problem *p, double t_a) {
    sag_vec3 to = sag_sub(sag_scale(p->d_a, t_a), p->w);
    return clamp(sag_dot(to, p->d_b) / sag_dot(p->d_b, p->d_b), p->b_min, p->b_max);
}
static double a_nearest(const problem *p, double t_b) {
    sag_vec3 to = sag_madd(p->w, t_b, p->d_b);
    return clamp(sag_dot(to, p->d_a) / sag_dot(p->d_a, p->d_a), p->a_min, p->a_max);
}

typedef struct pair {
    double a, b, square;
} pair;

static void consider(const problem *p, double t_a, double t_b, pair *best) {
    double square = distance_square(p, t_a, t_b);
    if (square < best->square || (square == best->square && t_a < best->a)) *best = (pair){t_a, t_b, square};
}

static pair on_boundary(const problem *p) {
    pair best = {0, 0, INFINITY};
    const double a_ends[2] = {p->a_min, p->a_max}, b_ends[2] = {p->b_min, p->b_max};
    for (int i = 0; i < 2; i++) {
        if (isfinite(a_ends[i])) consider(p, a_ends[i], b_nearest(p, a_ends[i]), &best);
        if (isfinite(b_ends[i])) consider(p, a_nearest(p, b_ends[i]), b_ends[i], &best);
    }
    return best;
}

// t_b = t_a · ratio + shift where the two run side by side; t_a runs through what both ranges allow.
static pair of_parallel(const problem *p) {
    double square = sag_dot(p->d_b, p->d_b);
    double ratio = sag_dot(p->d_a, p->d_b) / square, shift = -sag_dot(p->w, p->d_b) / square;
    double first = (p->b_min - shift) / ratio, last = (p->b_max - shift) / ratio;
    if (ratio < 0) {
        double swap = first;
        first = last;
        last = swap;
    }
    double low = fmax(first, p->a_min), high = fmin(last, p->a_max);
    if (!(low <= high)) return on_boundary(p);
    double t_a = isfinite(low) ? low : clamp(0, low, high);
    return (pair){t_a, clamp(t_a * ratio + shift, p->b_min, p->b_max), 0};
}

static bool are_parallel(sag_vec3 a, sag_vec3 b) {
    sagi_expansion3 x = sagi_expansion3_from(a), y = sagi_expansion3_from(b);
    sagi_expansion3_normalize(&x);
    sagi_expansion3_normalize(&y);
    sagi_expansion3 n = sagi_expansion3_cross(&x, &y);
    return n.count[0] + n.count[1] + n.count[2] == 0;
}

static pair solve(const problem *p, bool parallel) {
    if (parallel) return of_parallel(p);
    sag_vec3 n = sag_cross(p->d_a, p->d_b);
    double square = sag_dot(n, n);
    double t_a = sag_dot(sag_cross(p->w, p->d_b), n) / square;
    double t_b = sag_dot(sag_cross(p->w, p->d_a), n) / square;
    if (t_a >= p->a_min && t_a <= p->a_max && t_b >= p->b_min && t_b <= p->b_max) return (pair){t_a, t_b, 0};
    return on_boundary(p);
}

static int exponent_of(sag_vec3 a) {
    double largest = sag_max_component(sag_abs(a));
    return largest > 0 ? ilogb(largest) : 0;
}

static sag_vec3 scaled_down(sag_vec3 a, int exponent) {
    return sag_vec3_make(ldexp(a.x, -exponent), ldexp(a.y, -exponent), ldexp(a.z, -exponent));
}

bool sag_ray_ray_closest(const sag_ray *a, const sag_ray *b, sag_closest_approach *result) {
    if (!sag_ray_is_valid(a) || !sag_ray_is_valid(b)) return false;
    // Halves, so that the difference of the farthest origins does not overflow.
    sag_vec3 w = sag_sub(sag_scale(b->origin, 0.5), sag_scale(a->origin, 0.5));
    int a_exponent = exponent_of(a->direction), b_exponent = exponent_of(b->direction);
    int w_exponent = exponent_of(w);
    int a_scale = a_exponent - w_exponent - 1, b_scale = b_exponent - w_exponent - 1;
    problem p = {.d_a = scaled_down(a->direction, a_exponent),
                 .d_b = scaled_down(b->direction, b_exponent),
                 .w = scaled_down(w, w_exponent),
                 .a_min = ldexp(a->t_min, a_scale),
                 .a_max = ldexp(a->t_max, a_scale),
                 .b_min = ldexp(b->t_min, b_scale),
                 .b_max = ldexp(b->t_max, b_scale)};
    bool parallel = are_parallel(a->direction, b->direction);
    pair best = solve(&p, parallel);
    result->parallel = parallel;
    result->t_a = clamp(ldexp(best.a, -a_scale), a->t_min, a->t_max);
    result->t_b = clamp(ldexp(best.b, -b_scale), b->t_min, b->t_max);
    result->a = sag_ray_at(a, result->t_a);
    result->b = sag_ray_at(b, result->t_b);
    sag_vec3 way = sag_madd(sag_madd(p.w, best.b, p.d_b), -best.a, p.d_a);
    result->distance = ldexp(sag_length(way), w_exponent + 1);
    return true;
}
