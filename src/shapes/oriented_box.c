// SPDX-License-Identifier: MIT
// The parallelepiped center + Σ sᵢ aᵢ, |sᵢ| ≤ 1. With w = p − center and D = det(a₀, a₁, a₂), Cramer's rule
// gives sᵢ = det(w, aⱼ, aₖ)/D (i, j, k cyclic), so the face sᵢ = ±1 is the half-space
//     ±σ det(w, aⱼ, aₖ) ≤ |D|,   σ the sign of D:
// along the ray num = |D| ∓ σ det(o − c, aⱼ, aₖ) and den = ±σ det(d, aⱼ, aₖ), clipped exactly by clip.c.
#include "shapes/clip.h"
#include "shapes/validate.h"

// The box with its determinant.
typedef struct prepared {
    const sag_oriented_box *box;
    double det, det_error;
    int sign;
} prepared;

static sagi_dd3 axis_dd(const sag_oriented_box *box, int i) { return sagi_dd3_from(box->half_axes[i]); }

static bool prepare(const sag_oriented_box *box, prepared *p) {
    const sag_vec3 *a = box->half_axes;
    *p = (prepared){.box = box};
    p->det = sagi_determinant(a[0], a[1], a[2], &p->det_error);
    if (fabs(p->det) > p->det_error) {
        p->sign = p->det > 0 ? 1 : -1;
    } else {
        sagi_real exact = sagi_determinant_real(axis_dd(box, 0), axis_dd(box, 1), axis_dd(box, 2));
        p->sign = sagi_real_sign(&exact);
    }
    return p->sign != 0 && sagi_is_coordinate3(a[0]) && sagi_is_coordinate3(a[1]) &&
           sagi_is_coordinate3(a[2]) && sagi_is_coordinate3(box->center);
}

// +1 for the face s = 1 (odd), −1 for s = −1, times σ.
static int face_sign(const prepared *p, uint32_t face) { return face & 1 ? p->sign : -p->sign; }

static void quick(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_face *out) {
    const prepared *p = solid;
    int i = (int)face / 2, sign = face_sign(p, face);
    sag_vec3 aj = p->box->half_axes[(i + 1) % 3], ak = p->box->half_axes[(i + 2) % 3];
    double error, w = sagi_determinant(sag_sub(ray->origin, p->box->center), aj, ak, &error);
    out->num = fabs(p->det) - sign * w;
    out->num_error = p->det_error + error + SAGI_EPSILON * fabs(out->num);
    out->den = sign * sagi_determinant(ray->direction, aj, ak, &out->den_error);
}

static sagi_dd signed_dd(sagi_dd a, int sign) { return sign < 0 ? sagi_dd_neg(a) : a; }
static sagi_real signed_real(sagi_real a, int sign) { return sign < 0 ? sagi_real_neg(a) : a; }

static void accurate(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_dd *out) {
    const prepared *p = solid;
    int i = (int)face / 2, sign = face_sign(p, face);
    sagi_dd3 aj = axis_dd(p->box, (i + 1) % 3), ak = axis_dd(p->box, (i + 2) % 3);
    double det_error, error;
    sagi_dd det = sagi_determinant_dd(axis_dd(p->box, 0), axis_dd(p->box, 1), axis_dd(p->box, 2), &det_error);
    sagi_dd w = sagi_determinant_dd(sagi_dd3_from_diff(ray->origin, p->box->center), aj, ak, &error);
    out->num = sagi_dd_sub(signed_dd(det, p->sign), signed_dd(w, sign));
    out->num_error = det_error + error + 0x1p-104 * fabs(out->num.hi);
    out->den = signed_dd(sagi_determinant_dd(sagi_dd3_from(ray->direction), aj, ak, &out->den_error), sign);
}

static void exact(const void *solid, const sag_ray *ray, uint32_t face, sagi_clip_real *out) {
    const prepared *p = solid;
    int i = (int)face / 2, sign = face_sign(p, face);
    sagi_dd3 aj = axis_dd(p->box, (i + 1) % 3), ak = axis_dd(p->box, (i + 2) % 3);
    sagi_real det = sagi_determinant_real(axis_dd(p->box, 0), axis_dd(p->box, 1), axis_dd(p->box, 2));
    sagi_real w = sagi_determinant_real(sagi_dd3_from_diff(ray->origin, p->box->center), aj, ak);
    out->num = sagi_real_sub(signed_real(det, p->sign), signed_real(w, sign));
    out->den = signed_real(sagi_determinant_real(sagi_dd3_from(ray->direction), aj, ak), sign);
}

static sagi_clip_solid solid_of(const prepared *p) { return (sagi_clip_solid){p, 6, quick, accurate, exact}; }

static bool find(const sag_oriented_box *box, const sag_ray *ray, sagi_clip_span *span) {
    prepared p;
    if (!sag_ray_is_valid(ray) || !prepare(box, &p)) return false;
    const sagi_clip_solid solid = solid_of(&p);
    return sagi_clip_find(&solid, ray, span);
}

sag_status sag_oriented_box_validate(const sag_oriented_box *box, sag_error *error) {
    sag_status status = sagi_check_point(error, "oriented_box", "center", box->center);
    const char *names[3] = {"half_axes[0]", "half_axes[1]", "half_axes[2]"};
    for (int i = 0; i < 3 && status == SAG_OK; i++)
        status = sagi_check_direction(error, "oriented_box", names[i], box->half_axes[i]);
    prepared p;
    if (status == SAG_OK && !prepare(box, &p))
        return sagi_invalid3(error, "oriented_box", names[2], box->half_axes[2],
                             "must not be in the plane of the other two");
    return status;
}

sag_box3 sag_oriented_box_bounds(const sag_oriented_box *box) {
    if (sag_oriented_box_validate(box, NULL) != SAG_OK) return sag_box3_empty();
    sag_vec3 reach =
        sag_add(sag_add(sag_abs(box->half_axes[0]), sag_abs(box->half_axes[1])), sag_abs(box->half_axes[2]));
    reach = sag_scale(reach, 1 + 4 * SAGI_EPSILON);
    return sagi_box3_round_out((sag_box3){sag_sub(box->center, reach), sag_add(box->center, reach)}, 1);
}

bool sag_oriented_box_hit(const sag_oriented_box *box, const sag_ray *ray, sag_hit *hit) {
    sagi_clip_span span;
    if (!find(box, ray, &span)) return false;
    sagi_crossings list = sagi_clip_crossings(&span, ray);
    return sagi_crossings_first(&list, hit);
}

bool sag_oriented_box_occluded(const sag_oriented_box *box, const sag_ray *ray) {
    sag_hit hit;
    return sag_oriented_box_hit(box, ray, &hit);
}

size_t sag_oriented_box_crossings(const sag_oriented_box *box, const sag_ray *ray, sag_hit *hits,
                                  size_t capacity) {
    sagi_clip_span span;
    if (!find(box, ray, &span)) return 0;
    sagi_crossings list = sagi_clip_crossings(&span, ray);
    return sagi_crossings_write(&list, hits, capacity);
}

// One face as a parallelogram, in the order of its texture coordinates.
static sag_rectangle face_of(const sag_oriented_box *box, uint32_t face) {
    int i = (int)(face / 2) % 3;
    sag_vec3 ai = box->half_axes[i], aj = box->half_axes[(i + 1) % 3], ak = box->half_axes[(i + 2) % 3];
    sag_vec3 middle = sag_madd(box->center, face & 1 ? 1 : -1, ai);
    return (sag_rectangle){sag_sub(sag_sub(middle, aj), ak), sag_scale(aj, 2), sag_scale(ak, 2)};
}

static double clamp01(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

static void finish_face(const prepared *p, uint32_t face, sag_surface *surface) {
    const sag_vec3 *a = p->box->half_axes;
    int i = (int)(face / 2) % 3, j = (i + 1) % 3, k = (i + 2) % 3;
    sag_vec3 n = sagi_cross_accurate(a[j], a[k]), w = sag_sub(surface->position, p->box->center);
    double error;
    surface->geometric_normal = sag_normalize(sag_scale(n, face_sign(p, face)));
    const sagi_clip_solid solid = solid_of(p);
    sagi_clip_clear(&solid, face, surface);
    surface->dpdu = sag_scale(a[j], 2), surface->dpdv = sag_scale(a[k], 2);
    surface->u = clamp01(0.5 + 0.5 * sagi_determinant(w, a[k], a[i], &error) / p->det);
    surface->v = clamp01(0.5 + 0.5 * sagi_determinant(w, a[i], a[j], &error) / p->det);
}

void sag_oriented_box_surface(const sag_oriented_box *box, const sag_ray *ray, const sag_hit *hit,
                              sag_surface *surface) {
    sagi_clip_span span;
    prepared p;
    sagi_cut cut = {{hit->t, 0}, 2 * SAGI_EPSILON * fabs(hit->t)};
    if (find(box, ray, &span)) {
        if (span.enter_face == hit->primitive) cut = span.enter;
        if (span.leave_face == hit->primitive) cut = span.leave;
    }
    prepare(box, &p);
    sagi_point_at(ray, cut, &surface->position, &surface->position_error);
    finish_face(&p, hit->primitive, surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_oriented_box_area(const sag_oriented_box *box) {
    if (sag_oriented_box_validate(box, NULL) != SAG_OK) return 0;
    double area = 0;
    for (int i = 0; i < 3; i++)
        area += 8 * sag_length(sagi_cross_accurate(box->half_axes[i], box->half_axes[(i + 1) % 3]));
    return area;
}

bool sag_oriented_box_sample(const sag_oriented_box *box, sag_vec2 random, sag_surface *surface) {
    prepared p;
    if (!(sag_oriented_box_area(box) > 0) || !prepare(box, &p)) return false;
    // The first number picks a face by area and is stretched to be used again within it.
    double at = random.x * sag_oriented_box_area(box), area = 0;
    uint32_t face = 0;
    for (;; face++) {
        sag_rectangle f = face_of(box, face);
        area = sag_rectangle_area(&f);
        if (face == 5 || at < area) break;
        at -= area;
    }
    sag_rectangle f = face_of(box, face);
    sag_surface s;
    if (!sag_rectangle_sample(&f, (sag_vec2){clamp01(at / area), random.y}, &s)) return false;
    *surface = s;
    // The face's corner has three roundings of its own.
    sag_vec3 reach = sag_abs(box->center);
    for (int i = 0; i < 3; i++) reach = sag_add(reach, sag_abs(box->half_axes[i]));
    surface->position_error = sag_madd(surface->position_error, 8 * SAGI_EPSILON, reach);
    finish_face(&p, face, surface);
    sagi_surface_finish_sample(surface, face);
    return true;
}

bool sag_oriented_box_contains(const sag_oriented_box *box, sag_vec3 point) {
    prepared p;
    if (!sag_is_finite(point) || !prepare(box, &p)) return false;
    // num of every face, with the point for the origin, must not be negative.
    sag_ray ray = {.origin = point};
    for (uint32_t face = 0; face < 6; face++) {
        sagi_clip_face f;
        quick(&p, &ray, face, &f);
        if (f.num > f.num_error) continue;
        if (f.num < -f.num_error) return false;
        sagi_clip_real r;
        exact(&p, &ray, face, &r);
        if (sagi_real_sign(&r.num) < 0) return false;
    }
    return true;
}

double sag_oriented_box_volume(const sag_oriented_box *box) {
    const sag_vec3 *a = box->half_axes;
    double error;
    if (sag_oriented_box_validate(box, NULL) != SAG_OK) return 0;
    sagi_dd det = sagi_determinant_dd(sagi_dd3_from(a[0]), sagi_dd3_from(a[1]), sagi_dd3_from(a[2]), &error);
    return isfinite(det.hi) ? 8 * fabs(det.hi) : 0;
}

sag_vec3 sag_oriented_box_closest_point(const sag_oriented_box *box, sag_vec3 point) {
    sag_vec3 best = box->center;
    double best_distance = INFINITY;
    for (uint32_t face = 0; face < 6; face++) {
        sag_rectangle f = face_of(box, face);
        sag_vec3 q = sag_rectangle_closest_point(&f, point);
        double distance = sag_length(sag_sub(q, point));
        if (distance < best_distance) best = q, best_distance = distance;
    }
    return best;
}
