// SPDX-License-Identifier: MIT
// The capsule is the union of two balls and the cylinder between them. A convex set is met in one interval,
// and that of a union of overlapping pieces goes from the first entry to the last exit:
//     the balls |p − p₀| ≤ r, |p − p₁| ≤ r: sphere_solve.c;
//     the side, with w = p₁ − p₀ and y = p − p₀: (y·y)(w·w) − (y·w)² ≤ r² w·w, a quadric (quadric_solve.c)
//     whose entry or exit counts only where 0 ≤ y·w ≤ w·w; elsewhere it is inside a ball or outside the
//     capsule.
// A ball's crossing counts beyond its end of the segment and a little before it, so that at the seam rounding
// does not refuse a crossing to both; as the balls are parts of the capsule, one more of theirs never makes
// the first entry earlier or the last exit later than it is.
#include "math/determinant.h"
#include "math/elementary.h"
#include "shapes/quadric_solve.h"
#include "shapes/sphere.h"
#include "shapes/sweep.h"
#include "shapes/validate.h"

enum { SIDE = 0, BALL_0 = 1, BALL_1 = 2 };

typedef struct span {
    double enter, leave;
    uint32_t enter_part, leave_part;
} span;

static bool is_usable(const sag_capsule *capsule) {
    return capsule->radius > 0 && sagi_is_coordinate(capsule->radius) && sagi_is_coordinate3(capsule->p0) &&
           sagi_is_coordinate3(capsule->p1);
}

static bool is_ball(const sag_capsule *c) {
    return c->p0.x == c->p1.x && c->p0.y == c->p1.y && c->p0.z == c->p1.z;
}

static double size_of(const sag_capsule *c) {
    return fmax(c->radius, sag_max_component(sag_abs(sag_sub(c->p1, c->p0))));
}

static int exponent_of(const sag_capsule *c) { return sagi_size_exponent(size_of(c)); }

static sagi_dd axis_coordinate(double p1, double p0, int exponent) {
    sagi_dd w = sagi_two_sum(p1, -p0);
    return (sagi_dd){ldexp(w.hi, -exponent), ldexp(w.lo, -exponent)};
}

static void side_exact(const void *shape, sagi_quadric_exact *out) {
    const sag_capsule *c = shape;
    int e = exponent_of(c);
    const double p0[3] = {c->p0.x, c->p0.y, c->p0.z}, p1[3] = {c->p1.x, c->p1.y, c->p1.z};
    sagi_real w[3], squares[3];
    for (int i = 0; i < 3; i++) {
        sagi_dd wi = axis_coordinate(p1[i], p0[i], e);
        w[i] = sagi_real_add(sagi_real_from(wi.hi), sagi_real_from(wi.lo));
        squares[i] = sagi_real_mul(w[i], w[i]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out->square[i] = sagi_real_add(squares[j], squares[k]);
        out->cross[i] = sagi_real_neg(sagi_real_mul(w[j], w[k]));
        out->linear[i] = (sagi_real){0};
    }
    sagi_real r = sagi_real_from(ldexp(c->radius, -e));
    sagi_real ww = sagi_real_add(out->square[0], squares[0]);
    out->constant = sagi_real_neg(sagi_real_mul(sagi_real_mul(r, r), ww));
}

static sagi_quadric_form side_form(const sag_capsule *c) {
    sagi_quadric_form f = {.center = c->p0, .exponent = exponent_of(c), .mixed = true};
    f.exact = side_exact, f.shape = c;
    const double p0[3] = {c->p0.x, c->p0.y, c->p0.z}, p1[3] = {c->p1.x, c->p1.y, c->p1.z};
    sagi_dd w[3], squares[3];
    for (int i = 0; i < 3; i++) {
        w[i] = axis_coordinate(p1[i], p0[i], f.exponent);
        squares[i] = sagi_dd_mul(w[i], w[i]);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        f.square[i] = sagi_dd_add(squares[j], squares[k]);
        f.cross[i] = sagi_dd_neg(sagi_dd_mul(w[j], w[k]));
    }
    double r = ldexp(c->radius, -f.exponent);
    f.constant = sagi_dd_neg(sagi_dd_mul(sagi_two_prod(r, r), sagi_dd_add(f.square[0], squares[0])));
    return f;
}

static sag_vec3 from_p0(const sag_capsule *c, const sag_ray *ray, double t) {
    const sag_vec3 *o = &ray->origin, *d = &ray->direction;
    return (sag_vec3){sagi_ray_coordinate(o->x, c->p0.x, t, d->x).hi,
                      sagi_ray_coordinate(o->y, c->p0.y, t, d->y).hi,
                      sagi_ray_coordinate(o->z, c->p0.z, t, d->z).hi};
}

// Whether the crossing at t counts: one of the side between the ends, strictly, in double-double; one of a
// ball beyond its end or not too far from it.
static bool is_on_part(const sag_capsule *c, const sag_ray *ray, double t, uint32_t part) {
    if (!isfinite(t)) return false;
    const sag_vec3 *o = &ray->origin, *d = &ray->direction;
    sagi_dd3 w = sagi_dd3_from_diff(c->p1, c->p0);
    sagi_dd3 y = {sagi_ray_coordinate(o->x, c->p0.x, t, d->x), sagi_ray_coordinate(o->y, c->p0.y, t, d->y),
                  sagi_ray_coordinate(o->z, c->p0.z, t, d->z)};
    sagi_dd along = sagi_dot_dd(y, w), beyond = sagi_dd_sub(along, sagi_dot_dd(w, w));
    if (part == SIDE) return along.hi >= 0 && beyond.hi <= 0;
    // Roundings of t.
    double length = sag_length(sagi_dd3_round(w));
    double slack = 0x1p-44 * length * (length + c->radius + fabs(t) * sag_length(ray->direction));
    return part == BALL_0 ? along.hi <= slack : beyond.hi >= -slack;
}

static void consider(span *s, const sag_capsule *c, const sag_ray *ray, double t, bool enters,
                     uint32_t part) {
    if (!is_on_part(c, ray, t, part)) return;
    if (enters && !(s->enter <= t)) s->enter = t, s->enter_part = part;
    if (!enters && !(s->leave >= t)) s->leave = t, s->leave_part = part;
}

static void consider_ball(span *s, const sag_capsule *c, const sag_ray *ray, sag_vec3 center, uint32_t part) {
    double t[2];
    int count = sagi_sphere_crossings(center, c->radius, ray, t);
    for (int i = 0; i < count; i++) {
        // Of one crossing the slope says which it is.
        double slope = sag_dot(sag_madd(sag_sub(ray->origin, center), t[i], ray->direction), ray->direction);
        consider(s, c, ray, t[i], count == 2 ? i == 0 : slope < 0, part);
    }
}

// Whether the ray's line certainly stays away from the ball around the whole capsule, or the ray's range
// from that ball.
static bool certainly_misses(const sag_capsule *c, const sag_ray *ray) {
    sag_vec3 middle = sag_scale(sag_add(c->p0, c->p1), 0.5), w = sag_sub(ray->origin, middle);
    double reach = (sag_length(sag_sub(c->p1, c->p0)) / 2 + c->radius) * (1 + 0x1p-40);
    double dd = sag_dot(ray->direction, ray->direction), b = sag_dot(w, ray->direction);
    double cc = sag_dot(w, w), scale = sag_dot(middle, middle) + cc;
    if (!(dd > 0x1p-900 && dd < 0x1p900)) return false;
    double outside = cc - reach * reach;
    if (!(outside > 0x1p-45 * scale)) return false;
    if (ray->t_min >= 0 && b > 0x1p-45 * sqrt(scale * dd)) return true; // outside and going away
    return b * b < dd * outside - 0x1p-45 * dd * scale;
}

static span find(const sag_capsule *c, const sag_ray *ray) {
    span s = {.enter = NAN, .leave = NAN};
    if (!sag_ray_is_valid(ray) || !is_usable(c) || certainly_misses(c, ray)) return s;
    consider_ball(&s, c, ray, c->p0, BALL_0);
    if (is_ball(c)) return s;
    consider_ball(&s, c, ray, c->p1, BALL_1);
    sagi_quadric_form form = side_form(c);
    sagi_spans side = sagi_quadric_spans(&form, ray);
    if (side.count == 0) return s;
    consider(&s, c, ray, side.enter[0], true, SIDE);
    consider(&s, c, ray, side.leave[0], false, SIDE);
    if (isinf(side.enter[0]) && isinf(side.leave[0])) {
        // Along the axis: in by one ball, out by the other. (Along the side itself both are tangents.)
        bool forward = sag_dot(ray->direction, sag_sub(c->p1, c->p0)) > 0;
        if (s.enter_part != (forward ? BALL_0 : BALL_1)) s.enter = NAN;
        if (s.leave_part != (forward ? BALL_1 : BALL_0)) s.leave = NAN;
    }
    return s;
}

static sagi_crossings crossings_of(const sag_capsule *capsule, const sag_ray *ray) {
    sagi_crossings list = {0};
    span s = find(capsule, ray);
    if (sagi_in_range(ray, s.enter)) sagi_crossings_add(&list, s.enter, 0, 0, s.enter_part);
    if (sagi_in_range(ray, s.leave)) sagi_crossings_add(&list, s.leave, 0, 0, s.leave_part);
    return list;
}

sag_status sag_capsule_validate(const sag_capsule *capsule, sag_error *error) {
    sag_status status = sagi_check_point(error, "capsule", "p0", capsule->p0);
    if (status == SAG_OK) status = sagi_check_point(error, "capsule", "p1", capsule->p1);
    if (status == SAG_OK) status = sagi_check_positive(error, "capsule", "radius", capsule->radius);
    return status;
}

sag_box3 sag_capsule_bounds(const sag_capsule *capsule) {
    if (!is_usable(capsule)) return sag_box3_empty();
    return sag_box3_union(sagi_sphere_bounds(capsule->p0, capsule->radius),
                          sagi_sphere_bounds(capsule->p1, capsule->radius));
}

bool sag_capsule_hit(const sag_capsule *capsule, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list = crossings_of(capsule, ray);
    return sagi_crossings_first(&list, hit);
}

bool sag_capsule_occluded(const sag_capsule *capsule, const sag_ray *ray) {
    return crossings_of(capsule, ray).count > 0;
}

size_t sag_capsule_crossings(const sag_capsule *capsule, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list = crossings_of(capsule, ray);
    return sagi_crossings_write(&list, hits, capacity);
}

// The axis frame: z along the capsule (the z axis for a ball), x and y of sag_frame.
typedef struct frame {
    sag_vec3 x, y, z;
    double length;
} frame;

static frame frame_of(const sag_capsule *c) {
    sag_vec3 w = sag_sub(c->p1, c->p0);
    frame f = {.z = is_ball(c) ? (sag_vec3){0, 0, 1} : sag_normalize(w), .length = sag_length(w)};
    sag_frame(f.z, &f.x, &f.y);
    return f;
}

// Texture coordinates and derivatives from the normal and the height above p0 along the axis. Along a
// meridian of a ball ρ² + h² = r², so dρ/dh = −h/ρ.
static void texture(const sag_capsule *c, const frame *f, uint32_t part, double height,
                    sag_surface *surface) {
    sag_vec3 n = surface->geometric_normal;
    double nx = sag_dot(n, f->x), ny = sag_dot(n, f->y), rho = sagi_hypot(nx, ny);
    double whole = f->length + 2 * c->radius;
    surface->u = sagi_sweep_angle(nx, ny) / SAGI_TWO_PI;
    surface->v = fmax(0, fmin((height + c->radius) / whole, 1));
    sag_vec3 radial = sag_add(sag_scale(f->x, nx / rho), sag_scale(f->y, ny / rho));
    surface->dpdu = sag_scale(sag_cross(f->z, radial), SAGI_TWO_PI * c->radius * rho);
    double slope = part == SIDE ? 0 : -sag_dot(n, f->z) / rho;
    surface->dpdv = sag_scale(sag_madd(f->z, slope, radial), whole);
}

// A point of the side near p0 + y, y from double-doubles.
static void place_on_side(const sag_capsule *c, const frame *f, sag_vec3 y, sag_surface *surface) {
    double height = sag_dot(y, f->z);
    sag_vec3 radial = sag_normalize(sag_madd(y, -height, f->z));
    if (sagi_is_zero3(radial)) radial = f->x; // so thin that y is on the axis
    sag_vec3 offset = sag_madd(sag_scale(radial, c->radius), height, f->z);
    surface->position = sag_add(c->p0, offset);
    surface->geometric_normal = radial;
    // height and axis are good to a few u of the offset's length, radial and the sums likewise; 32u as for
    // the sphere leaves the filter of the quadric behind as well.
    double error = 32 * SAGI_EPSILON * (c->radius + fabs(height));
    sag_vec3 p = sag_scale(sag_abs(surface->position), 2 * SAGI_EPSILON);
    surface->position_error = (sag_vec3){p.x + error, p.y + error, p.z + error};
}

void sag_capsule_surface(const sag_capsule *capsule, const sag_ray *ray, const sag_hit *hit,
                         sag_surface *surface) {
    frame f = frame_of(capsule);
    sag_vec3 y = from_p0(capsule, ray, hit->t);
    if (hit->primitive == SIDE)
        place_on_side(capsule, &f, y, surface);
    else
        sagi_sphere_place(hit->primitive == BALL_0 ? capsule->p0 : capsule->p1, capsule->radius, ray, hit->t,
                          surface);
    texture(capsule, &f, hit->primitive, sag_dot(y, f.z), surface);
    sagi_surface_finish(surface, ray, hit);
}

double sag_capsule_area(const sag_capsule *capsule) {
    if (!is_usable(capsule)) return 0;
    return 2 * SAGI_PI * capsule->radius * (frame_of(capsule).length + 2 * capsule->radius);
}

// By Archimedes the area between two heights is 2πr times their distance on the balls as on the side, so the
// height along the whole capsule is uniform.
bool sag_capsule_sample(const sag_capsule *capsule, sag_vec2 random, sag_surface *surface) {
    if (!is_usable(capsule)) return false;
    frame f = frame_of(capsule);
    double r = capsule->radius, phi = random.x * SAGI_TWO_PI;
    double height = random.y * (f.length + 2 * r) - r;
    sag_vec3 radial = sag_add(sag_scale(f.x, sagi_cos(phi)), sag_scale(f.y, sagi_sin(phi)));
    uint32_t part = height < 0 ? BALL_0 : height > f.length ? BALL_1 : SIDE;
    sag_vec3 y = sag_madd(sag_scale(radial, r), height, f.z);
    if (part != SIDE) {
        sag_vec3 end = part == BALL_0 ? (sag_vec3){0, 0, 0} : sag_sub(capsule->p1, capsule->p0);
        double z = (part == BALL_0 ? height : height - f.length) / r, rho = sqrt(fmax(0, 1 - z * z));
        sag_vec3 n = sag_normalize(sag_madd(sag_scale(radial, rho), z, f.z));
        surface->geometric_normal = n;
        surface->position = sag_add(capsule->p0, sag_madd(end, r, n));
        double error = 32 * SAGI_EPSILON * (r + f.length);
        sag_vec3 p = sag_scale(sag_abs(surface->position), 2 * SAGI_EPSILON);
        surface->position_error = (sag_vec3){p.x + error, p.y + error, p.z + error};
    } else {
        place_on_side(capsule, &f, y, surface);
    }
    texture(capsule, &f, part, height, surface);
    sagi_surface_finish_sample(surface, part);
    return true;
}

// The point of the segment nearest to p.
static sag_vec3 on_segment(const sag_capsule *c, sag_vec3 p) {
    sag_vec3 w = sag_sub(c->p1, c->p0);
    double s = is_ball(c) ? 0 : sag_dot(sag_sub(p, c->p0), w) / sag_dot(w, w);
    return s >= 1 ? c->p1 : sag_madd(c->p0, s > 0 ? s : 0, w);
}

bool sag_capsule_contains(const sag_capsule *capsule, sag_vec3 point) {
    if (!is_usable(capsule) || !sag_is_finite(point)) return false;
    if (sagi_sphere_contains(capsule->p0, capsule->radius, point)) return true;
    if (sagi_sphere_contains(capsule->p1, capsule->radius, point)) return true;
    return sag_length(sag_sub(point, on_segment(capsule, point))) <= capsule->radius;
}

double sag_capsule_volume(const sag_capsule *capsule) {
    if (!is_usable(capsule)) return 0;
    double r = capsule->radius;
    return SAGI_PI * r * r * (frame_of(capsule).length + 4 * r / 3);
}

sag_vec3 sag_capsule_closest_point(const sag_capsule *capsule, sag_vec3 point) {
    sag_vec3 on_axis = on_segment(capsule, point), away = sag_sub(point, on_axis);
    if (sagi_is_zero3(away)) { // on the axis every direction across is as near
        frame f = frame_of(capsule);
        away = f.x;
    }
    return sag_madd(on_axis, capsule->radius, sag_normalize(away));
}
