// SPDX-License-Identifier: MIT
// A polygon with holes seen flat: its area, uniform points of it, whether its boundary crosses itself.
//
// If every loop is turned so that the inside lies on its left, the length of the inside on the line at y is a
// plain sum over the edges that cross it, L(y) = Σ s_e x_e(y), s_e = 1 for an edge that runs up and −1 for
// one that runs down; and the area below y is the sum of each edge's own trapezoid. No sorting, no
// triangulation, no memory. How a loop is to be turned: it bounds the inside from within when an even number
// of the other loops are around it.
//
// A uniform point: y where the area below it is random.x of the whole (the area below is a rising function of
// y: bisection), then x where the length to the left of it is random.y of L(y) (rising as well). Both to the
// last bit of the coordinates, in time 110 times the number of points. (Inversion of the marginal and the
// conditional distribution; PBR 4th ed. §2.4.)
#include "shapes/common.h"
#include "shapes/polygon.h"

sag_vec2 sagi_polygon_flatten(sag_vec3 p, int dropped_axis) {
    return dropped_axis == 0   ? (sag_vec2){p.y, p.z}
           : dropped_axis == 1 ? (sag_vec2){p.z, p.x}
                               : (sag_vec2){p.x, p.y};
}

// A stretch of positions: one loop.
typedef struct loop {
    uint32_t first, size;
} loop;

static sag_vec2 point_at(const sag_polygon *s, uint32_t i, int axis) {
    return sagi_polygon_flatten(s->positions[i], axis);
}

static double signed_area(const sag_polygon *s, loop l, int axis) {
    sag_vec2 origin = point_at(s, l.first, axis), last = point_at(s, l.first + 1, axis);
    double sum = 0;
    for (uint32_t i = 2; i < l.size; i++) {
        sag_vec2 next = point_at(s, l.first + i, axis);
        sum += (last.x - origin.x) * (next.y - origin.y) - (last.y - origin.y) * (next.x - origin.x);
        last = next;
    }
    return 0.5 * sum;
}

static int sign(double a) { return (a > 0) - (a < 0); }

// 1 inside, −1 outside, 0 on the loop; exact. Crossings of the line y = p.y to the right of p.
static int locate(const sag_polygon *s, loop l, int axis, sag_vec2 p) {
    bool inside = false;
    for (uint32_t i = l.first; i < l.first + l.size; i++) {
        sag_vec2 a = point_at(s, i, axis), b = point_at(s, sagi_polygon_next(i, l.first, l.size), axis);
        int turn = sign(sag_triangle_signed_area_2d(a, b, p));
        bool within =
            fmin(a.x, b.x) <= p.x && p.x <= fmax(a.x, b.x) && fmin(a.y, b.y) <= p.y && p.y <= fmax(a.y, b.y);
        if (turn == 0 && within) return 0;
        bool up = a.y <= p.y && p.y < b.y, down = b.y <= p.y && p.y < a.y;
        if ((up && turn > 0) || (down && turn < 0)) inside = !inside;
    }
    return inside ? 1 : -1;
}

// Whether loop `outer` is around loop `l`: by the first point of l that is not on it.
static bool is_around(const sag_polygon *s, loop outer, loop l, int axis) {
    for (uint32_t i = l.first; i < l.first + l.size; i++) {
        int where = locate(s, outer, axis, point_at(s, i, axis));
        if (where != 0) return where > 0;
    }
    return false;
}

// 1 or −1: which way the loop must be run through for the inside to be on the left.
static double orientation(const sag_polygon *s, loop l, int axis) {
    bool odd = false;
    loop other = {0, 0};
    for (uint32_t k = 0; k < s->loop_count; k++, other.first += other.size) {
        other.size = s->loop_sizes[k];
        if (other.first != l.first && is_around(s, other, l, axis)) odd = !odd;
    }
    return (signed_area(s, l, axis) < 0) != odd ? -1 : 1;
}

double sagi_polygon_flat_area(const sag_polygon *s, int axis) {
    double sum = 0;
    loop l = {0, 0};
    for (uint32_t k = 0; k < s->loop_count; k++, l.first += l.size) {
        l.size = s->loop_sizes[k];
        sum += orientation(s, l, axis) * signed_area(s, l, axis);
    }
    return fmax(sum, 0);
}

// What one edge adds to the area below y: ∫ x dy along it, as far as y. (Coordinates are relative to the
// polygon's first point.)
static double trapezoid(sag_vec2 a, sag_vec2 b, double y) {
    double from = fmin(a.y, y), to = fmin(b.y, y);
    if (a.y == b.y) return 0;
    double slope = (b.x - a.x) / (b.y - a.y);
    double x_from = a.x + slope * (from - a.y), x_to = a.x + slope * (to - a.y);
    return 0.5 * (x_from + x_to) * (to - from);
}

// What one edge adds to the length of the inside left of x on the line at y: s_e min(x_e, x). As many edges
// run up as down, so s_e (min(x_e, x) − x) does as well, which spares edges beyond x; without a limit, s_e
// x_e.
static double left_part(sag_vec2 a, sag_vec2 b, double y, double x) {
    bool up = a.y <= y && y < b.y, down = b.y <= y && y < a.y;
    if (!up && !down) return 0;
    double at = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    double length = isinf(x) ? at : fmin(at - x, 0);
    return up ? length : -length;
}

typedef double edge_function(sag_vec2 a, sag_vec2 b, double y, double x);

static double below(sag_vec2 a, sag_vec2 b, double y, double x) {
    (void)x;
    return trapezoid(a, b, y);
}

static double sum_over_edges(const sag_polygon *s, int axis, edge_function *f, double y, double x) {
    sag_vec2 origin = point_at(s, 0, axis);
    double sum = 0;
    loop l = {0, 0};
    for (uint32_t k = 0; k < s->loop_count; k++, l.first += l.size) {
        l.size = s->loop_sizes[k];
        double part = 0;
        for (uint32_t i = l.first; i < l.first + l.size; i++) {
            sag_vec2 a = point_at(s, i, axis), b = point_at(s, sagi_polygon_next(i, l.first, l.size), axis);
            part += f((sag_vec2){a.x - origin.x, a.y - origin.y}, (sag_vec2){b.x - origin.x, b.y - origin.y},
                      y, x);
        }
        sum += orientation(s, l, axis) * part;
    }
    return sum;
}

sag_vec2 sagi_polygon_flat_sample(const sag_polygon *s, int axis, sag_vec2 random) {
    sag_vec2 origin = point_at(s, 0, axis), low = {0, 0}, high = {0, 0};
    for (uint32_t i = 0; i < s->position_count; i++) {
        sag_vec2 p = point_at(s, i, axis);
        low = (sag_vec2){fmin(low.x, p.x - origin.x), fmin(low.y, p.y - origin.y)};
        high = (sag_vec2){fmax(high.x, p.x - origin.x), fmax(high.y, p.y - origin.y)};
    }
    sag_vec2 p = {0, 0};
    double target = random.x * sum_over_edges(s, axis, below, high.y, 0);
    for (int i = 0; i < 55; i++) {
        p.y = 0.5 * (low.y + high.y);
        if (sum_over_edges(s, axis, below, p.y, 0) <= target)
            low.y = p.y;
        else
            high.y = p.y;
    }
    target = random.y * sum_over_edges(s, axis, left_part, p.y, INFINITY);
    for (int i = 0; i < 55; i++) {
        p.x = 0.5 * (low.x + high.x);
        if (sum_over_edges(s, axis, left_part, p.y, p.x) <= target)
            low.x = p.x;
        else
            high.x = p.x;
    }
    return (sag_vec2){p.x + origin.x, p.y + origin.y};
}

static bool cross(sag_vec2 a, sag_vec2 b, sag_vec2 c, sag_vec2 d) {
    if (fmax(a.x, b.x) < fmin(c.x, d.x) || fmax(c.x, d.x) < fmin(a.x, b.x)) return false;
    if (fmax(a.y, b.y) < fmin(c.y, d.y) || fmax(c.y, d.y) < fmin(a.y, b.y)) return false;
    return sign(sag_triangle_signed_area_2d(a, b, c)) * sign(sag_triangle_signed_area_2d(a, b, d)) < 0 &&
           sign(sag_triangle_signed_area_2d(c, d, a)) * sign(sag_triangle_signed_area_2d(c, d, b)) < 0;
}

// The end of the edge that starts at position i.
static uint32_t end_of(const sag_polygon *s, uint32_t i) {
    loop l = {0, s->loop_sizes[0]};
    for (uint32_t k = 1; i >= l.first + l.size; k++) {
        l.first += l.size;
        l.size = s->loop_sizes[k];
    }
    return sagi_polygon_next(i, l.first, l.size);
}

bool sagi_polygon_crosses_itself(const sag_polygon *s, int axis, uint32_t edges[2]) {
    for (uint32_t i = 0; i < s->position_count; i++) {
        sag_vec2 a = point_at(s, i, axis), b = point_at(s, end_of(s, i), axis);
        loop l = {0, 0};
        for (uint32_t k = 0; k < s->loop_count; k++, l.first += l.size) {
            l.size = s->loop_sizes[k];
            for (uint32_t j = l.first > i ? l.first : i + 1; j < l.first + l.size; j++) {
                sag_vec2 c = point_at(s, j, axis);
                sag_vec2 d = point_at(s, sagi_polygon_next(j, l.first, l.size), axis);
                if (!cross(a, b, c, d)) continue;
                edges[0] = i;
                edges[1] = j;
                return true;
            }
        }
    }
    return false;
}
