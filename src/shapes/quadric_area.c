// SPDX-License-Identifier: MIT
// The area of {F = 0} in a box. Lines parallel to one axis k, spread evenly over the box's face, meet a patch
// dA |n_k| dA times as often as they are dense (n the unit normal). With the weight |n_k|, and n₀² + n₁² +
// n₂² = 1, the three directions together count each patch once:
//
//     A = Σ_k ∬ Σ_crossings |n_k| du dv.
//
// The integrand is between 0 and 1 and goes to 0 where the surface turns away from the line, so there is no
// case to tell apart and nothing that blows up. Along v, at fixed u, the places where it is not smooth are
// known: where two crossings merge (the discriminant, a quadratic in v) or leave the box (F on the face, two
// quadratics in v). Between them v = m − h cos θ makes the square-root ends smooth. Along u the halves are
// compared and halved again.
//
// Sampling takes a face with probability ∝ its area, a line and one of its two crossings at random: a patch
// gets Σ|n_k| dA, and keeping it with probability 1/Σ|n_k| ≥ 1/√3 makes that dA.
#include "shapes/quadric_area.h"
#include "math/elementary.h"
#include "shapes/stream.h"

#define PI        3.14159265358979323846
#define TRIES     20000
#define PANELS    400
#define TOLERANCE 1e-9

// Gauss–Legendre, ten points on [−1, 1], half of it (Abramowitz & Stegun, table 25.4).
static const double nodes[5] = {0.14887433898163122, 0.43339539412924719, 0.67940956829902441,
                                0.86506336668898451, 0.97390652851717172};
static const double weights[5] = {0.29552422471475287, 0.26926671930999636, 0.21908636251598204,
                                  0.14945134915058059, 0.06667134430868814};

// The quadric seen along axis w, with the other two in order: F = ww w² + uu u² + vv v² + 2(uv uv + uw uw +
// vw vw + u1 u + v1 v + w1 w) + one.
typedef struct view {
    double ww, uu, vv, uv, uw, vw, u1, v1, w1, one;
    double low[3], high[3]; // of u, v, w
} view;

static view view_along(const sag_quadric *quadric, int w) {
    const double *q = quadric->coefficients;
    const sag_vec3 lo = quadric->clip.min, hi = quadric->clip.max;
    const double square[3] = {q[0], q[1], q[2]}, cross[3] = {q[5], q[4], q[3]},
                 linear[3] = {q[6], q[7], q[8]};
    int u = (w + 1) % 3, v = (w + 2) % 3;
    return (view){
        .ww = square[w],
        .uu = square[u],
        .vv = square[v],
        .uv = cross[w],
        .uw = cross[v],
        .vw = cross[u],
        .u1 = linear[u],
        .v1 = linear[v],
        .w1 = linear[w],
        .one = q[9],
        .low = {sag_component(lo, u), sag_component(lo, v), sag_component(lo, w)},
        .high = {sag_component(hi, u), sag_component(hi, v), sag_component(hi, w)},
    };
}

// The real roots of a x² + 2 b x + c in order.
static int quadratic(double a, double b, double c, double roots[2]) {
    double d = b * b - a * c;
    if (!(d >= 0)) return 0;
    double q = -(b + copysign(sqrt(d), b));
    double first = q / a, second = c / q;
    int count = 0;
    if (isfinite(first)) roots[count++] = first;
    if (isfinite(second)) roots[count++] = second;
    if (count == 2 && roots[0] > roots[1]) roots[0] = second, roots[1] = first;
    return count;
}

// The crossings of the line at (u, v), within the box.
static int crossings(const view *s, double u, double v, double w[2]) {
    double roots[2];
    int count = 0,
        all = quadratic(s->ww, s->uw * u + s->vw * v + s->w1,
                        (s->uu * u + 2 * (s->uv * v + s->u1)) * u + (s->vv * v + 2 * s->v1) * v + s->one,
                        roots);
    for (int i = 0; i < all; i++)
        if (roots[i] >= s->low[2] && roots[i] <= s->high[2]) w[count++] = roots[i];
    return count;
}

// The half gradient as u, v, w.
static sag_vec3 gradient(const view *s, double u, double v, double w) {
    return sag_vec3_make(s->uu * u + s->uv * v + s->uw * w + s->u1, s->uv * u + s->vv * v + s->vw * w + s->v1,
                         s->uw * u + s->vw * v + s->ww * w + s->w1);
}

static double integrand(const view *s, double u, double v) {
    double w[2], sum = 0;
    int count = crossings(s, u, v, w);
    for (int i = 0; i < count; i++) sum += fabs(sag_normalize(gradient(s, u, v, w[i])).z);
    return sum;
}

static void add_break(double at, const view *s, double *breaks, int *count) {
    if (!(at > s->low[1] && at < s->high[1])) return;
    int i = (*count)++;
    for (; i > 0 && breaks[i - 1] > at; i--) breaks[i] = breaks[i - 1];
    breaks[i] = at;
}

static void add_breaks(double a, double b, double c, const view *s, double *breaks, int *count) {
    double roots[2];
    int n = quadratic(a, b, c, roots);
    for (int i = 0; i < n; i++) add_break(roots[i], s, breaks, count);
}

// ∫ over v of the smooth pieces at this u.
static double along_v(const view *s, double u) {
    double breaks[8];
    int count = 0;
    // c(u, v) = vv v² + 2 cv v + c0 and b(u, v) = vw v + b0 of the line's polynomial in w.
    double b0 = s->uw * u + s->w1, cv = s->uv * u + s->v1, c0 = (s->uu * u + 2 * s->u1) * u + s->one;
    add_breaks(s->vw * s->vw - s->ww * s->vv, s->vw * b0 - s->ww * cv, b0 * b0 - s->ww * c0, s, breaks,
               &count);
    for (int face = 0; face < 2; face++) {
        double w = face == 0 ? s->low[2] : s->high[2];
        add_breaks(s->vv, cv + s->vw * w, c0 + (2 * b0 + s->ww * w) * w, s, breaks, &count);
    }
    double sum = 0, from = s->low[1];
    for (int i = 0; i <= count; i++) {
        double to = i < count ? breaks[i] : s->high[1], middle = from / 2 + to / 2, half = to / 2 - from / 2;
        for (int part = 0; part < 4 && half > 0; part++)
            for (int k = 0; k < 10; k++) {
                double node = k < 5 ? nodes[k] : -nodes[k - 5], theta = PI / 4 * (part + 0.5 + 0.5 * node);
                sum += PI / 8 * weights[k % 5] * half * sagi_sin(theta) *
                       integrand(s, u, middle - half * sagi_cos(theta));
            }
        from = to;
    }
    return sum;
}

static double panel(const view *s, double from, double to) {
    double middle = from / 2 + to / 2, half = to / 2 - from / 2, sum = 0;
    for (int i = 0; i < 5; i++)
        sum += weights[i] * (along_v(s, middle - half * nodes[i]) + along_v(s, middle + half * nodes[i]));
    return sum * half;
}

typedef struct piece {
    double from, to, sum;
} piece;

// The pieces wait on a stack; each is accepted or halved.
static double along_u(const view *s) {
    piece stack[48];
    double total = 0, scale = (s->high[0] - s->low[0]) * (s->high[1] - s->low[1]);
    int depth = 1, budget = PANELS;
    stack[0] = (piece){s->low[0], s->high[0], panel(s, s->low[0], s->high[0])};
    while (depth > 0) {
        piece p = stack[--depth];
        double middle = p.from / 2 + p.to / 2, left = panel(s, p.from, middle),
               right = panel(s, middle, p.to);
        bool good = fabs(left + right - p.sum) <= TOLERANCE * scale;
        if (good || depth + 2 > 48 || --budget < 0) {
            total += left + right;
        } else {
            stack[depth++] = (piece){p.from, middle, left};
            stack[depth++] = (piece){middle, p.to, right};
        }
    }
    return total;
}

double sagi_quadric_area(const sag_quadric *quadric) {
    double area = 0;
    for (int axis = 0; axis < 3; axis++) {
        view s = view_along(quadric, axis);
        area += along_u(&s);
    }
    return area;
}

bool sagi_quadric_sample_point(const sag_quadric *quadric, sag_vec2 random, sag_vec3 *point) {
    sag_vec3 size = sag_sub(quadric->clip.max, quadric->clip.min);
    const double face[3] = {size.y * size.z, size.z * size.x, size.x * size.y};
    double all = face[0] + face[1] + face[2];
    sagi_stream stream = sagi_stream_of(random);
    for (int i = 0; i < TRIES; i++) {
        double pick = sagi_stream_unit(&stream) * all;
        int axis = pick < face[0] ? 0 : pick < face[0] + face[1] ? 1 : 2;
        bool second = sagi_stream_bits(&stream) >> 63;
        view s = view_along(quadric, axis);
        double u = s.low[0] + random.x * (s.high[0] - s.low[0]),
               v = s.low[1] + random.y * (s.high[1] - s.low[1]);
        double w[2], keep = sagi_stream_unit(&stream);
        int count = crossings(&s, u, v, w);
        if (second < count) {
            sag_vec3 n = sag_abs(sag_normalize(gradient(&s, u, v, w[second])));
            if (keep * (n.x + n.y + n.z) <= 1) {
                double at[3];
                at[(axis + 1) % 3] = u, at[(axis + 2) % 3] = v, at[axis] = w[second];
                *point = sag_vec3_make(at[0], at[1], at[2]);
                return true;
            }
        }
        random.x = sagi_stream_unit(&stream), random.y = sagi_stream_unit(&stream);
    }
    return false;
}
