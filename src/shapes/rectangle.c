// SPDX-License-Identifier: MIT
// The parallelogram corner + u e + v f. With w = o − corner, Cramer's rule on w + t d = u e + v f gives
//     D = det(e, f, d),   u = det(w, f, d)/D,   v = det(e, w, d)/D,   t = −det(e, f, w)/D,
// D = 0 being a ray along the plane. Inside means 0 ≤ u, v ≤ 1, so four signs of determinants (u ≤ 1 is the
// sign of D − det(w, f, d)); each is decided by its double value where that is beyond its error bound, else
// to 400 bits, which is exact for coordinates of ordinary range. t is worked out in double-double.
#include "shapes/cut.h"
#include "shapes/validate.h"

typedef struct solution {
    sagi_cut cut;
    double u, v;
} solution;

static bool is_usable(const sag_rectangle *rectangle) {
    return sagi_is_coordinate3(rectangle->corner) && sagi_is_coordinate3(rectangle->edge_u) &&
           sagi_is_coordinate3(rectangle->edge_v);
}

// The sign of the determinant.
static int sign_of(double value, double error, sagi_dd3 a, sagi_dd3 b, sagi_dd3 c) {
    if (fabs(value) > error) return value > 0 ? 1 : -1;
    sagi_real exact = sagi_determinant_real(a, b, c);
    return sagi_real_sign(&exact);
}

// Whether 0 ≤ det(a, b, c)/D ≤ 1, D having the sign s ≠ 0; D = det(x, y, z).
static bool in_unit_interval(sagi_dd3 a, sagi_dd3 b, sagi_dd3 c, int s, double den, double den_error,
                             sagi_dd3 x, sagi_dd3 y, sagi_dd3 z, double *ratio) {
    double error, value = sagi_determinant(sagi_dd3_round(a), sagi_dd3_round(b), sagi_dd3_round(c), &error);
    *ratio = fmax(0, fmin(value / den, 1));
    if (s * value < -error) return false;
    double rest = den - value, rest_error = error + den_error + SAGI_EPSILON * fabs(rest);
    if (s * rest < -rest_error) return false;
    if (s * value > error && s * rest > rest_error) return true;
    if (s * sign_of(value, error, a, b, c) < 0) return false;
    if (s * rest > rest_error) return true;
    sagi_real exact = sagi_real_sub(sagi_determinant_real(x, y, z), sagi_determinant_real(a, b, c));
    return s * sagi_real_sign(&exact) >= 0;
}

static bool find(const sag_rectangle *rectangle, const sag_ray *ray, solution *out) {
    if (!sag_ray_is_valid(ray) || !is_usable(rectangle)) return false;
    double scale = sagi_power_scale(ray->direction);
    sagi_dd3 e = sagi_dd3_from(rectangle->edge_u), f = sagi_dd3_from(rectangle->edge_v);
    sagi_dd3 d = sagi_dd3_from(sag_scale(ray->direction, scale));
    sagi_dd3 w = sagi_dd3_from_diff(ray->origin, rectangle->corner);
    double den_error, num_error, den, num;
    den = sagi_determinant(sagi_dd3_round(d), rectangle->edge_u, rectangle->edge_v, &den_error);
    num = -sagi_determinant(sagi_dd3_round(w), rectangle->edge_u, rectangle->edge_v, &num_error);
    if (scale == 1 && sagi_cut_outside(num, num_error, den, den_error, ray)) return false;
    int s = sign_of(den, den_error, d, e, f);
    if (s == 0 || !isfinite(num)) return false;
    if (!in_unit_interval(w, f, d, s, den, den_error, e, f, d, &out->u)) return false;
    if (!in_unit_interval(e, w, d, s, den, den_error, e, f, d, &out->v)) return false;
    sagi_dd num_dd = sagi_dd_neg(sagi_determinant_dd(w, e, f, &num_error));
    sagi_dd den_dd = sagi_determinant_dd(d, e, f, &den_error);
    if (!sagi_cut_ratio(num_dd, num_error, den_dd, den_error, &out->cut))
        out->cut =
            sagi_cut_real(sagi_real_neg(sagi_determinant_real(w, e, f)), sagi_determinant_real(d, e, f));
    out->cut.t.hi *= scale, out->cut.t.lo *= scale, out->cut.error *= scale;
    return sagi_in_range(ray, out->cut.t.hi) && isfinite(out->cut.t.hi);
}

sag_status sag_rectangle_validate(const sag_rectangle *rectangle, sag_error *error) {
    sag_status status = sagi_check_point(error, "rectangle", "corner", rectangle->corner);
    if (status == SAG_OK) status = sagi_check_direction(error, "rectangle", "edge_u", rectangle->edge_u);
    if (status == SAG_OK) status = sagi_check_direction(error, "rectangle", "edge_v", rectangle->edge_v);
    if (status == SAG_OK && sagi_is_zero3(sagi_cross_accurate(rectangle->edge_u, rectangle->edge_v)))
        return sagi_invalid3(error, "rectangle", "edge_v", rectangle->edge_v,
                             "must not be parallel to edge_u");
    return status;
}

sag_box3 sag_rectangle_bounds(const sag_rectangle *rectangle) {
    if (sag_rectangle_validate(rectangle, NULL) != SAG_OK) return sag_box3_empty();
    sag_vec3 c = rectangle->corner, e = rectangle->edge_u, f = rectangle->edge_v;
    sag_box3 box = sag_box3_extend(sag_box3_empty(), c);
    box = sag_box3_extend(box, sag_add(c, e));
    box = sag_box3_extend(box, sag_add(c, f));
    box = sag_box3_extend(box, sag_add(sag_add(c, e), f));
    // Each corner is rounded by at most 2u of a partial sum, which may exceed the result.
    sag_vec3 slack = sag_scale(sag_add(sag_abs(c), sag_add(sag_abs(e), sag_abs(f))), 4 * SAGI_EPSILON);
    return sagi_box3_round_out((sag_box3){sag_sub(box.min, slack), sag_add(box.max, slack)}, 1);
}

bool sag_rectangle_hit(const sag_rectangle *rectangle, const sag_ray *ray, sag_hit *hit) {
    solution s;
    if (!find(rectangle, ray, &s)) return false;
    *hit = sagi_hit_make(s.cut.t.hi, s.u, s.v, 0);
    return true;
}

bool sag_rectangle_occluded(const sag_rectangle *rectangle, const sag_ray *ray) {
    solution s;
    return find(rectangle, ray, &s);
}

size_t sag_rectangle_crossings(const sag_rectangle *rectangle, const sag_ray *ray, sag_hit *hits,
                               size_t capacity) {
    sag_hit hit;
    if (!sag_rectangle_hit(rectangle, ray, &hit)) return 0;
    if (capacity > 0) hits[0] = hit;
    return 1;
}

static void finish(const sag_rectangle *rectangle, double u, double v, sag_surface *surface) {
    sag_vec3 n = sagi_cross_accurate(rectangle->edge_u, rectangle->edge_v);
    surface->geometric_normal = sag_normalize(n);
    double error; // of det(w, e, f), which is the distance from the plane times |n|
    sagi_determinant(sag_sub(surface->position, rectangle->corner), rectangle->edge_u, rectangle->edge_v,
                     &error);
    sagi_clear_distance(1.5 * error / sag_length(n), surface);
    surface->dpdu = rectangle->edge_u, surface->dpdv = rectangle->edge_v;
    surface->u = u, surface->v = v;
}

void sag_rectangle_surface(const sag_rectangle *rectangle, const sag_ray *ray, const sag_hit *hit,
                           sag_surface *surface) {
    solution s;
    if (!find(rectangle, ray, &s)) s.cut = (sagi_cut){{hit->t, 0}, 2 * SAGI_EPSILON * fabs(hit->t)};
    sagi_point_at(ray, s.cut, &surface->position, &surface->position_error);
    finish(rectangle, hit->u, hit->v, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_rectangle_area(const sag_rectangle *rectangle) {
    double area = sag_length(sagi_cross_accurate(rectangle->edge_u, rectangle->edge_v));
    return area > 0 && is_usable(rectangle) ? area : 0;
}

bool sag_rectangle_sample(const sag_rectangle *rectangle, sag_vec2 random, sag_surface *surface) {
    if (!(sag_rectangle_area(rectangle) > 0)) return false;
    sag_vec3 e = rectangle->edge_u, f = rectangle->edge_v, c = rectangle->corner;
    surface->position = sag_madd(sag_madd(c, random.x, e), random.y, f);
    // Two products and two sums.
    surface->position_error =
        sag_scale(sag_add(sag_abs(c), sag_add(sag_abs(e), sag_abs(f))), 6 * SAGI_EPSILON);
    finish(rectangle, random.x, random.y, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

static sag_vec3 nearest_on_segment(sag_vec3 a, sag_vec3 along, sag_vec3 point) {
    double s = sag_dot(sag_sub(point, a), along) / sag_dot(along, along);
    return sag_madd(a, fmax(0, fmin(s, 1)), along);
}

sag_vec3 sag_rectangle_closest_point(const sag_rectangle *rectangle, sag_vec3 point) {
    sag_vec3 c = rectangle->corner, e = rectangle->edge_u, f = rectangle->edge_v, w = sag_sub(point, c);
    sag_vec3 n = sagi_cross_accurate(e, f);
    double nn = sag_dot(n, n);
    double u = sag_dot(sag_cross(w, f), n) / nn, v = sag_dot(sag_cross(e, w), n) / nn;
    if (u >= 0 && u <= 1 && v >= 0 && v <= 1) return sag_madd(sag_madd(c, u, e), v, f);
    // Outside: on the nearest of the four edges.
    sag_vec3 best = nearest_on_segment(c, e, point);
    const sag_vec3 candidates[3] = {nearest_on_segment(c, f, point),
                                    nearest_on_segment(sag_add(c, f), e, point),
                                    nearest_on_segment(sag_add(c, e), f, point)};
    for (int i = 0; i < 3; i++) {
        sag_vec3 to_best = sag_sub(best, point), to_new = sag_sub(candidates[i], point);
        if (sag_dot(to_new, to_new) < sag_dot(to_best, to_best)) best = candidates[i];
    }
    return best;
}
