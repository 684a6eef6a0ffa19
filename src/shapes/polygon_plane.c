// SPDX-License-Identifier: MIT
// The plane of a polygon and where a line meets it.
//
// Newell's rule: the normal is N = Σ (p_i − p_0) × (p_{i+1} − p_0) over the first loop, twice its vector
// area; for points that are not quite in a plane the best plane's. The plane goes through the centroid m of
// the loop's points. So
//
//     t = (m − o) · N / (d · N) = Σ (p_i − o) · N / (k d · N),    k the number of points.
//
// Both are worked out in double-doubles from exact differences: each product and sum is good to 7 · 2⁻¹⁰⁶, a
// chain of k sums to 2⁻¹⁰³ (k + 5) of the absolute values' sum. Where cancellation leaves less than a quarter
// of an ulp certain (an origin in the plane, a ray along it, a polygon like a needle) 400-bit reals do it
// again. Everything is scaled by powers of two to the polygon's size first.
#include "math/real3.h"
#include "shapes/common.h"
#include "shapes/polygon.h"

bool sagi_polygon_is_readable(const sag_polygon *s) {
    if (!s->positions || !s->loop_sizes || s->loop_count == 0) return false;
    uint64_t total = 0;
    for (uint32_t l = 0; l < s->loop_count; l++) {
        if (s->loop_sizes[l] < 3) return false;
        total += s->loop_sizes[l];
    }
    if (total != s->position_count) return false;
    for (uint32_t i = 0; i < s->position_count; i++)
        if (!sag_is_finite(s->positions[i]) ||
            !(sag_max_component(sag_abs(s->positions[i])) <= SAG_MAX_COORDINATE))
            return false;
    return true;
}

static sagi_dd scaled_diff(double a, double b, int exponent) {
    sagi_dd d = sagi_two_sum(a, -b);
    return (sagi_dd){ldexp(d.hi, -exponent), ldexp(d.lo, -exponent)};
}

static void difference(sag_vec3 a, sag_vec3 b, int exponent, sagi_dd out[3]) {
    out[0] = scaled_diff(a.x, b.x, exponent);
    out[1] = scaled_diff(a.y, b.y, exponent);
    out[2] = scaled_diff(a.z, b.z, exponent);
}

bool sagi_polygon_make_plane(const sag_polygon *s, sagi_polygon_plane *plane) {
    uint32_t count = s->loop_sizes[0];
    double size = 0;
    for (uint32_t i = 1; i < count; i++)
        size = fmax(size, sag_max_component(sag_abs(sag_sub(s->positions[i], s->positions[0]))));
    if (!(size > 0)) return false;
    int exponent = ilogb(size);
    *plane = (sagi_polygon_plane){.scale_exponent = exponent, .size = ldexp(size, -exponent)};
    sagi_dd last[3] = {{0, 0}, {0, 0}, {0, 0}};
    for (uint32_t i = 1; i < count; i++) {
        sagi_dd next[3];
        difference(s->positions[i], s->positions[0], exponent, next);
        for (int k = 0; k < 3; k++) {
            int x = (k + 1) % 3, y = (k + 2) % 3;
            sagi_dd plus = sagi_dd_mul(last[x], next[y]), minus = sagi_dd_mul(last[y], next[x]);
            plane->normal[k] = sagi_dd_add(plane->normal[k], sagi_dd_sub(plus, minus));
            plane->sum += fabs(plus.hi) + fabs(minus.hi);
            plane->middle[k] = sagi_dd_add(plane->middle[k], next[k]);
        }
        for (int k = 0; k < 3; k++) last[k] = next[k];
    }
    for (int k = 0; k < 3; k++) plane->middle[k] = sagi_dd_div(plane->middle[k], sagi_dd_from(count));
    plane->unit = sag_normalize(sag_vec3_make(plane->normal[0].hi, plane->normal[1].hi, plane->normal[2].hi));
    return sag_dot(plane->unit, plane->unit) > 0;
}

static sagi_dd dot(const sagi_dd a[3], const sagi_dd b[3]) {
    return sagi_dd_add(sagi_dd_add(sagi_dd_mul(a[0], b[0]), sagi_dd_mul(a[1], b[1])),
                       sagi_dd_mul(a[2], b[2]));
}

static double sum_of(const sagi_dd a[3]) { return fabs(a[0].hi) + fabs(a[1].hi) + fabs(a[2].hi); }

// The scales of the origin and the direction: to the order of 1 as well.
static int exponent_of(sag_vec3 a) {
    double largest = sag_max_component(sag_abs(a));
    return largest > 0 ? ilogb(largest) : 0;
}

static sagi_real3 real_normal(const sag_polygon *s, int exponent) {
    sagi_real3 normal = {{0}, {0}, {0}};
    sagi_real3 last = sagi_real3_from_diff(s->positions[1], s->positions[0], exponent);
    for (uint32_t i = 2; i < s->loop_sizes[0]; i++) {
        sagi_real3 next = sagi_real3_from_diff(s->positions[i], s->positions[0], exponent);
        sagi_real3 area = sagi_real3_cross(&last, &next);
        normal = sagi_real3_add(&normal, &area);
        last = next;
    }
    return normal;
}

static double plane_t_real(const sag_polygon *s, const sagi_polygon_plane *plane, const sag_ray *ray,
                           int o_exponent, int d_exponent) {
    sagi_real3 normal = real_normal(s, plane->scale_exponent), way = {{0}, {0}, {0}};
    for (uint32_t i = 0; i < s->loop_sizes[0]; i++) {
        sagi_real3 one = sagi_real3_from_diff(s->positions[i], ray->origin, o_exponent);
        way = sagi_real3_add(&way, &one);
    }
    sagi_real3 d = sagi_real3_from_diff(ray->direction, (sag_vec3){0, 0, 0}, d_exponent);
    sagi_real denominator = sagi_real_scale(sagi_real3_dot(&d, &normal), s->loop_sizes[0]);
    if (sagi_real_sign(&denominator) == 0) return NAN;
    sagi_real q = sagi_real_div(sagi_real3_dot(&way, &normal), denominator);
    return ldexp(sagi_real_to_double(&q), o_exponent - d_exponent);
}

double sagi_polygon_plane_t(const sag_polygon *s, const sagi_polygon_plane *plane, const sag_ray *ray) {
    int d_exponent = exponent_of(ray->direction);
    int o_exponent = exponent_of(sag_sub(s->positions[0], ray->origin));
    if (o_exponent < plane->scale_exponent) o_exponent = plane->scale_exponent;
    sagi_dd way[3], d[3];
    difference(s->positions[0], ray->origin, o_exponent, way);
    difference(ray->direction, (sag_vec3){0, 0, 0}, d_exponent, d);
    for (int k = 0; k < 3; k++) {
        int shift = plane->scale_exponent - o_exponent;
        sagi_dd middle = {ldexp(plane->middle[k].hi, shift), ldexp(plane->middle[k].lo, shift)};
        way[k] = sagi_dd_add(way[k], middle);
    }
    sagi_dd numerator = dot(way, plane->normal), denominator = dot(d, plane->normal);
    double unit = 0x1p-103 * (s->loop_sizes[0] + 5.0) * plane->sum;
    double way_sum = sum_of(way) + 2; // and what the middle's own sum may have cancelled
    if (!(unit * way_sum <= 0x1p-55 * fabs(numerator.hi) &&
          unit * sum_of(d) <= 0x1p-55 * fabs(denominator.hi)))
        return plane_t_real(s, plane, ray, o_exponent, d_exponent);
    return ldexp(sagi_dd_to_double(sagi_dd_div(numerator, denominator)), o_exponent - d_exponent);
}

double sagi_polygon_deviation(const sag_polygon *s, const sagi_polygon_plane *plane) {
    double largest = 0;
    const sagi_dd unit[3] = {{plane->unit.x, 0}, {plane->unit.y, 0}, {plane->unit.z, 0}};
    for (uint32_t i = 0; i < s->position_count; i++) {
        sagi_dd way[3];
        difference(s->positions[i], s->positions[0], plane->scale_exponent, way);
        for (int k = 0; k < 3; k++) way[k] = sagi_dd_sub(way[k], plane->middle[k]);
        largest = fmax(largest, fabs(dot(way, unit).hi));
    }
    return ldexp(largest, plane->scale_exponent);
}
