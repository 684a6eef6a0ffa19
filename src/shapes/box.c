// SPDX-License-Identifier: MIT
// The axis-aligned box by slabs: along axis i the ray is between the faces from (aᵢ − oᵢ)/dᵢ to (bᵢ − oᵢ)/dᵢ
// (a the face it meets first), so inside the box from t_in = maxᵢ to t_out = minᵢ, if t_in ≤ t_out. A ray
// along an axis (dᵢ = 0) is inside that slab everywhere or nowhere; the slab is closed.
//
// Each quotient has two roundings, of the difference and of the division, so it is within 2u(1 + u) relative
// of the true t (u = 2⁻⁵³), which is at most 2 ulp; and equal faces give equal t, whatever the box. When t_in
// and t_out are closer than those errors the quotients are compared exactly: (aᵢ − oᵢ)/dᵢ ≤ (bⱼ − oⱼ)/dⱼ ⇔
// (aᵢ − oᵢ) dⱼ ≤ (bⱼ − oⱼ) dᵢ up to the sign of dᵢ dⱼ, with eight exact components. A ray that only touches
// an edge or vertex has t_in = t_out: it enters and leaves at one t, two crossings.
#include "math/expansion.h"
#include "shapes/cut.h"
#include "shapes/validate.h"

typedef struct slabs {
    double near_t, far_t;
    uint32_t near_face, far_face; // 2·axis + (0 at min, 1 at max)
} slabs;

static bool is_valid(const sag_box *box) {
    return box->min.x < box->max.x && box->min.y < box->max.y && box->min.z < box->max.z &&
           sagi_is_coordinate3(box->min) && sagi_is_coordinate3(box->max);
}

// The product of the magnitudes of an expansion of two components and a double, times 2^shift; exact. The
// factors are brought near 1 first, so that nothing underflows.
static int scaled_product(int count, double *e, double f, int shift, double *h) {
    int e_exponent = ilogb(e[count - 1]);
    double sign = e[count - 1] < 0 ? -1 : 1;
    for (int i = 0; i < count; i++) e[i] = sign * ldexp(e[i], -e_exponent);
    return sagi_expansion_scale(count, e, ldexp(fabs(f), shift - ilogb(f)), h);
}

// The sign of (a − o)/d − (b − p)/e: exact. d and e are not 0.
static int compare_quotients(double a, double o, double d, double b, double p, double e) {
    double left[2], right[2], left_product[4], right_product[4], h[8];
    int left_count = sagi_expansion_from_diff(a, o, left),
        right_count = sagi_expansion_from_diff(b, p, right);
    int left_sign = sagi_expansion_sign(left_count, left) * (d > 0 ? 1 : -1);
    int right_sign = sagi_expansion_sign(right_count, right) * (e > 0 ? 1 : -1);
    if (left_sign != right_sign) return left_sign > right_sign ? 1 : -1;
    if (left_sign == 0) return 0;
    // Both have one sign: compare (a − o) e with (b − p) d, by their exponents if these are far apart.
    int left_exponent = ilogb(left[left_count - 1]) + ilogb(e);
    int right_exponent = ilogb(right[right_count - 1]) + ilogb(d);
    int shift = right_exponent - left_exponent, sign = shift > 3 ? -1 : 1;
    if (shift >= -3 && shift <= 3) {
        left_count = scaled_product(left_count, left, e, 0, left_product);
        right_count = scaled_product(right_count, right, d, shift, right_product);
        sign = sagi_expansion_sign(
            sagi_expansion_diff(left_count, left_product, right_count, right_product, h), h);
    }
    return sign * left_sign;
}

// Whether every slab is entered before any is left.
static bool overlap_exactly(const sag_box *box, const sag_ray *ray) {
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double di = sag_component(ray->direction, i), dj = sag_component(ray->direction, j);
            if (i == j || di == 0 || dj == 0) continue;
            double enter = sag_component(di > 0 ? box->min : box->max, i);
            double leave = sag_component(dj > 0 ? box->max : box->min, j);
            if (compare_quotients(enter, sag_component(ray->origin, i), di, leave,
                                  sag_component(ray->origin, j), dj) > 0)
                return false;
        }
    }
    return true;
}

// False when no part of the box is in the ray's range; the two t still have to be looked at one by one.
static bool find(const sag_box *box, const sag_ray *ray, slabs *s) {
    if (!sag_ray_is_valid(ray) || !is_valid(box)) return false;
    *s = (slabs){.near_t = -INFINITY, .far_t = INFINITY};
    for (uint32_t axis = 0; axis < 3; axis++) {
        int i = (int)axis;
        double lo = sag_component(box->min, i), hi = sag_component(box->max, i);
        double o = sag_component(ray->origin, i), d = sag_component(ray->direction, i);
        if (d == 0) {
            if (o < lo || o > hi) return false;
            continue;
        }
        double t0 = ((d > 0 ? lo : hi) - o) / d, t1 = ((d > 0 ? hi : lo) - o) / d;
        if (t0 > s->near_t) s->near_t = t0, s->near_face = 2 * axis + (d < 0);
        if (t1 < s->far_t) s->far_t = t1, s->far_face = 2 * axis + (d > 0);
    }
    // 2u for each quotient, doubled; and the smallest normal number for quotients that underflow.
    double error = 4 * SAGI_EPSILON * (fabs(s->near_t) + fabs(s->far_t)) + 0x1p-1022;
    if (s->near_t - s->far_t > error) return false;
    if (s->far_t < ray->t_min || s->near_t > ray->t_max || !(s->near_t < INFINITY)) return false;
    if (!(s->far_t - s->near_t > error)) {
        if (!overlap_exactly(box, ray)) return false;
        if (s->near_t > s->far_t) s->near_t = s->far_t; // equal but for rounding
    }
    return true;
}

sag_status sag_box_validate(const sag_box *box, sag_error *error) {
    sag_status status = sagi_check_point(error, "box", "min", box->min);
    if (status == SAG_OK) status = sagi_check_point(error, "box", "max", box->max);
    if (status != SAG_OK || is_valid(box)) return status;
    return sag_error_set(
        error, SAG_ERROR_GEOMETRY,
        "box: min (%.17g, %.17g, %.17g) must be below max (%.17g, %.17g, %.17g) on each axis", box->min.x,
        box->min.y, box->min.z, box->max.x, box->max.y, box->max.z);
}

sag_box3 sag_box_bounds(const sag_box *box) {
    if (!is_valid(box)) return sag_box3_empty();
    return (sag_box3){box->min, box->max};
}

bool sag_box_hit(const sag_box *box, const sag_ray *ray, sag_hit *hit) {
    slabs s;
    if (!find(box, ray, &s)) return false;
    bool touch = s.near_t == s.far_t && s.far_face < s.near_face; // of equal t the first in number
    if (sagi_in_range(ray, s.near_t))
        *hit = sagi_hit_make(s.near_t, 0, 0, touch ? s.far_face : s.near_face);
    else if (sagi_in_range(ray, s.far_t))
        *hit = sagi_hit_make(s.far_t, 0, 0, s.far_face);
    else
        return false;
    return true;
}

bool sag_box_occluded(const sag_box *box, const sag_ray *ray) {
    slabs s;
    return find(box, ray, &s) && (sagi_in_range(ray, s.near_t) || sagi_in_range(ray, s.far_t));
}

size_t sag_box_crossings(const sag_box *box, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    slabs s;
    if (!find(box, ray, &s)) return 0;
    sagi_crossings list = {0};
    if (sagi_in_range(ray, s.near_t)) sagi_crossings_add(&list, s.near_t, 0, 0, s.near_face);
    if (sagi_in_range(ray, s.far_t)) sagi_crossings_add(&list, s.far_t, 0, 0, s.far_face);
    return sagi_crossings_write(&list, hits, capacity);
}

static double *coordinate(sag_vec3 *v, int axis) { return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z; }

// Normal, texture coordinates and derivatives of a point on a face; position[axis] is set to the face.
static void finish_face(const sag_box *box, uint32_t face, sag_surface *surface) {
    int axis = (int)(face / 2) % 3, ju = (axis + 1) % 3, jv = (axis + 2) % 3;
    sag_vec3 size = sag_sub(box->max, box->min), zero = {0, 0, 0};
    *coordinate(&surface->position, axis) = sag_component(face & 1 ? box->max : box->min, axis);
    // The face is where it is exactly; one rounding of the axis' magnitude lets a spawned ray leave it.
    *coordinate(&surface->position_error, axis) =
        2 * SAGI_EPSILON * fmax(fabs(sag_component(box->min, axis)), fabs(sag_component(box->max, axis)));
    surface->geometric_normal = surface->dpdu = surface->dpdv = zero;
    *coordinate(&surface->geometric_normal, axis) = face & 1 ? 1 : -1;
    *coordinate(&surface->dpdu, ju) = sag_component(size, ju);
    *coordinate(&surface->dpdv, jv) = sag_component(size, jv);
    sag_vec3 from_min = sag_sub(surface->position, box->min);
    surface->u = sag_component(from_min, ju) / sag_component(size, ju);
    surface->v = sag_component(from_min, jv) / sag_component(size, jv);
}

static double clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }

static sag_vec3 clamp_to(const sag_box *box, sag_vec3 p) {
    return (sag_vec3){clamp(p.x, box->min.x, box->max.x), clamp(p.y, box->min.y, box->max.y),
                      clamp(p.z, box->min.z, box->max.z)};
}

void sag_box_surface(const sag_box *box, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    int axis = (int)(hit->primitive / 2) % 3;
    double d = sag_component(ray->direction, axis);
    double face = sag_component(hit->primitive & 1 ? box->max : box->min, axis);
    sagi_cut cut = {{hit->t, 0}, 4 * SAGI_EPSILON * fabs(hit->t)};
    if (d != 0) {
        double scale = sagi_power_scale(ray->direction); // so that no product overflows
        cut.t = sagi_dd_div(sagi_two_sum(face, -sag_component(ray->origin, axis)), sagi_dd_from(d * scale));
        cut.t.hi *= scale, cut.t.lo *= scale;
        cut.error = 0x1p-98 * fabs(cut.t.hi);
    }
    sagi_point_at(ray, cut, &surface->position, &surface->position_error);
    surface->position = clamp_to(box, surface->position); // the true point is in the box
    finish_face(box, hit->primitive, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_box_area(const sag_box *box) {
    if (!is_valid(box)) return 0;
    sag_vec3 e = sag_sub(box->max, box->min);
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
}

bool sag_box_sample(const sag_box *box, sag_vec2 random, sag_surface *surface) {
    if (!(sag_box_area(box) > 0)) return false;
    // The first number picks a face by area and is stretched to be used again within it.
    sag_vec3 e = sag_sub(box->max, box->min);
    double areas[3] = {e.y * e.z, e.z * e.x, e.x * e.y};
    double at = random.x * 2 * (areas[0] + areas[1] + areas[2]);
    uint32_t face = 0;
    while (face < 5 && at >= areas[face / 2]) at -= areas[face / 2], face++;
    double first = clamp(at / areas[face / 2], 0, 1);
    int axis = (int)face / 2, ju = (axis + 1) % 3, jv = (axis + 2) % 3;
    surface->position = box->min;
    *coordinate(&surface->position, ju) += first * sag_component(e, ju);
    *coordinate(&surface->position, jv) += random.y * sag_component(e, jv);
    surface->position = clamp_to(box, surface->position);
    surface->position_error = sag_scale((sag_vec3){fmax(fabs(box->min.x), fabs(box->max.x)),
                                                   fmax(fabs(box->min.y), fabs(box->max.y)),
                                                   fmax(fabs(box->min.z), fabs(box->max.z))},
                                        4 * SAGI_EPSILON);
    finish_face(box, face, surface);
    sagi_surface_finish_sample(surface, face);
    return true;
}

bool sag_box_contains(const sag_box *box, sag_vec3 p) {
    return is_valid(box) && p.x >= box->min.x && p.x <= box->max.x && p.y >= box->min.y &&
           p.y <= box->max.y && p.z >= box->min.z && p.z <= box->max.z;
}

double sag_box_volume(const sag_box *box) {
    if (!is_valid(box)) return 0;
    sag_vec3 e = sag_sub(box->max, box->min);
    return e.x * e.y * e.z;
}

sag_vec3 sag_box_closest_point(const sag_box *box, sag_vec3 point) {
    sag_vec3 nearest = clamp_to(box, point);
    if (!sag_box_contains(box, point)) return nearest;
    // From inside: straight to the nearest face.
    double best = INFINITY, target = 0;
    int best_axis = 0;
    for (int axis = 0; axis < 3; axis++) {
        double p = sag_component(point, axis), lo = sag_component(box->min, axis),
               hi = sag_component(box->max, axis);
        double distance = fmin(p - lo, hi - p);
        if (distance < best) best = distance, best_axis = axis, target = p - lo < hi - p ? lo : hi;
    }
    *coordinate(&nearest, best_axis) = target;
    return nearest;
}
