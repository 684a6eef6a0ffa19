// SPDX-License-Identifier: MIT
// The ellipsoid Σ (yᵢ/rᵢ)² = 1, y = p − center, multiplied out so that its coefficients are products of the
// radii:
//
//     F = (r₁r₂ y₀)² + (r₂r₀ y₁)² + (r₀r₁ y₂)² − (r₀r₁r₂)².
//
// Area. The map y = r·n from the unit sphere stretches area by J(n) = |(r₁r₂ n₀, r₂r₀ n₁, r₀r₁ n₂)|; its mean
// over the sphere is Carlson's R_G of the squares (NIST DLMF 19.33.1). A point of the sphere kept with
// probability J/max J is uniform on the ellipsoid; at least half of them are kept, whatever the radii.
#include "math/elementary.h"
#include "shapes/carlson.h"
#include "shapes/outline.h"
#include "shapes/quadric_solve.h"
#include "shapes/sphere.h"
#include "shapes/stream.h"
#include "shapes/sweep.h"

static bool is_usable(const sag_ellipsoid *e) { return sag_ellipsoid_validate(e, NULL) == SAG_OK; }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const sag_vec3 *r = shape;
    sagi_real xx = sagi_real_scale(sagi_real_from(r->x), r->x),
              yy = sagi_real_scale(sagi_real_from(r->y), r->y);
    sagi_real zz = sagi_real_scale(sagi_real_from(r->z), r->z), xy = sagi_real_mul(xx, yy);
    *q = (sagi_quadric_exact){
        .square = {sagi_real_mul(yy, zz), sagi_real_mul(zz, xx), xy},
        .constant = sagi_real_neg(sagi_real_mul(xy, zz)),
    };
}

// `radii` gets the scaled radii and is what the form refers to.
static sagi_quadric_form form_of(const sag_ellipsoid *e, sag_vec3 *radii) {
    int exponent = sagi_size_exponent(sag_max_component(e->radii));
    *radii = e->radii;
    if (exponent != 0)
        *radii = sag_vec3_make(ldexp(e->radii.x, -exponent), ldexp(e->radii.y, -exponent),
                               ldexp(e->radii.z, -exponent));
    sagi_dd xx = sagi_two_prod(radii->x, radii->x), yy = sagi_two_prod(radii->y, radii->y);
    sagi_dd zz = sagi_two_prod(radii->z, radii->z), xy = sagi_dd_mul(xx, yy);
    return (sagi_quadric_form){
        .square = {sagi_dd_mul(yy, zz), sagi_dd_mul(zz, xx), xy},
        .constant = sagi_dd_neg(sagi_dd_mul(xy, zz)),
        .center = e->center,
        .exponent = exponent,
        .exact = exact,
        .shape = radii,
    };
}

sag_status sag_ellipsoid_validate(const sag_ellipsoid *e, sag_error *error) {
    sag_status status = sagi_check_point(error, "ellipsoid", "center", e->center);
    if (status == SAG_OK) status = sagi_check_positive(error, "ellipsoid", "radii.x", e->radii.x);
    if (status == SAG_OK) status = sagi_check_positive(error, "ellipsoid", "radii.y", e->radii.y);
    if (status == SAG_OK) status = sagi_check_positive(error, "ellipsoid", "radii.z", e->radii.z);
    return status;
}

sag_box3 sag_ellipsoid_bounds(const sag_ellipsoid *e) {
    if (!is_usable(e)) return sag_box3_empty();
    return sagi_box3_round_out((sag_box3){sag_sub(e->center, e->radii), sag_add(e->center, e->radii)}, 1);
}

static void collect(const sag_ellipsoid *e, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(e)) return;
    sag_vec3 radii;
    sagi_quadric_form form = form_of(e, &radii);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    if (spans.count == 0) return;
    if (sagi_in_range(ray, spans.enter[0])) sagi_crossings_add(list, spans.enter[0], 0, 0, 0);
    if (sagi_in_range(ray, spans.leave[0])) sagi_crossings_add(list, spans.leave[0], 0, 0, 0);
}

bool sagi_ellipsoid_outline(const sag_ellipsoid *e, sagi_outline *p) {
    if (!is_usable(e)) return false;
    sag_vec3 radii;
    const sagi_quadric_form form = form_of(e, &radii);
    return sagi_outline_make(&form, -INFINITY, INFINITY, p);
}

bool sag_ellipsoid_hit(const sag_ellipsoid *e, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(e, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_ellipsoid_occluded(const sag_ellipsoid *e, const sag_ray *ray) {
    sagi_crossings list;
    collect(e, ray, &list);
    return list.count > 0;
}

size_t sag_ellipsoid_crossings(const sag_ellipsoid *e, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list;
    collect(e, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

// The unit sphere's, stretched.
static void texture(const sag_ellipsoid *e, sag_surface *surface) {
    sag_vec3 y = sag_sub(surface->position, e->center), r = e->radii;
    sagi_sphere_texture(sag_vec3_make(y.x / r.x, y.y / r.y, y.z / r.z), surface);
    surface->dpdu = sag_mul(surface->dpdu, r);
    surface->dpdv = sag_mul(surface->dpdv, r);
}

void sag_ellipsoid_surface(const sag_ellipsoid *e, const sag_ray *ray, const sag_hit *hit,
                           sag_surface *surface) {
    sag_vec3 radii;
    sagi_quadric_form form = form_of(e, &radii);
    sagi_quadric_place_hit(&form, ray, hit->t, surface);
    texture(e, surface);
    sagi_surface_finish(surface, ray, hit);
}

// r₁r₂, r₂r₀, r₀r₁.
static sag_vec3 faces(sag_vec3 r) { return sag_vec3_make(r.y * r.z, r.z * r.x, r.x * r.y); }

double sag_ellipsoid_area(const sag_ellipsoid *e) {
    if (!is_usable(e)) return 0;
    sag_vec3 f = faces(e->radii);
    return 4 * SAGI_PI * sagi_carlson_rg(f.x * f.x, f.y * f.y, f.z * f.z);
}

bool sag_ellipsoid_sample(const sag_ellipsoid *e, sag_vec2 random, sag_surface *surface) {
    double area = sag_ellipsoid_area(e);
    if (!(area > 0 && isfinite(area))) return false;
    sag_vec3 f = faces(e->radii), n;
    double most = sag_max_component(f);
    sagi_stream stream = sagi_stream_of(random);
    for (int i = 0; i < 1000; i++) {
        double z = 2 * random.x - 1, rho = sqrt(fmax(0, (1 - z) * (1 + z))), phi = SAGI_TWO_PI * random.y;
        n = sag_vec3_make(rho * sagi_cos(phi), rho * sagi_sin(phi), z);
        if (sagi_stream_unit(&stream) * most <= sag_length(sag_mul(f, n))) break;
        random.x = sagi_stream_unit(&stream), random.y = sagi_stream_unit(&stream);
    }
    sag_vec3 radii;
    sagi_quadric_form form = form_of(e, &radii);
    sagi_quadric_place_point(&form, sag_add(e->center, sag_mul(e->radii, n)), surface);
    texture(e, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

bool sag_ellipsoid_contains(const sag_ellipsoid *e, sag_vec3 point) {
    if (!is_usable(e) || !sag_is_finite(point)) return false;
    sag_vec3 radii;
    sagi_quadric_form form = form_of(e, &radii);
    return sagi_quadric_sign(&form, point) <= 0;
}

double sag_ellipsoid_volume(const sag_ellipsoid *e) {
    return is_usable(e) ? SAGI_PI * 4 / 3 * e->radii.x * e->radii.y * e->radii.z : 0;
}

// The nearest point x to y has y − x = s g, g the gradient at x: xᵢ = rᵢ² yᵢ/(rᵢ² + s), where s is the
// largest root of h(s) = Σ (rᵢ yᵢ/(rᵢ² + s))² − 1. h falls from +∞ at s = −min rᵢ², so bisection finds it (D.
// Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013). In units of the
// least radius squared and counted from the pole: s = (σ − 1) r², σ > 0. A point in the plane across the
// shortest axis may lie so far inside that h has no root; then σ = 0, and what the others leave of Σ (xᵢ/rᵢ)²
// = 1 goes to that axis.
sag_vec3 sag_ellipsoid_closest_point(const sag_ellipsoid *e, sag_vec3 point) {
    const double r[3] = {e->radii.x, e->radii.y, e->radii.z};
    const double y[3] = {point.x - e->center.x, point.y - e->center.y, point.z - e->center.z};
    int least = r[0] <= r[1] && r[0] <= r[2] ? 0 : r[1] <= r[2] ? 1 : 2;
    double excess[3], pull[3], low = 0, high = 0, x[3], used = 0;
    for (int i = 0; i < 3; i++) {
        double k = r[i] / r[least];
        excess[i] = (k - 1) * (k + 1);
        pull[i] = k * (fabs(y[i]) / r[least]);
        high += pull[i];
    }
    low = pull[least];
    for (int i = 0; i < 1100; i++) {
        double sigma = low / 2 + high / 2, sum = 0;
        if (!(sigma > low && sigma < high)) break;
        for (int k = 0; k < 3; k++) sum += (pull[k] / (excess[k] + sigma)) * (pull[k] / (excess[k] + sigma));
        if (sum > 1)
            low = sigma;
        else
            high = sigma;
    }
    for (int i = 0; i < 3; i++) {
        double below = excess[i] + high;
        x[i] = i == least || !(below > 0) ? 0 : y[i] * ((excess[i] + 1) / below);
        used += (x[i] / r[i]) * (x[i] / r[i]);
    }
    x[least] = copysign(r[least] * sqrt(fmax(0, 1 - used)), y[least]);
    return sag_vec3_make(e->center.x + x[0], e->center.y + x[1], e->center.z + x[2]);
}
