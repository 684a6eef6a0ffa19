// SPDX-License-Identifier: MIT
// The paraboloid F = z_max (x² + y²) − radius² z between two planes. A ray along the axis has no t² in F: one
// root.
//
// Area. With k = radius²/z_max the profile is ρ² = k z, so ρ ρ' = k/2 and
//     dA = φ ρ √(1 + ρ'²) dz = φ √(k z + k²/4) dz,   A = φ (2/3k) (w₁³ − w₀³),   w² = k z + k²/4,
// where w₁² − w₀² = k (z₁ − z₀) takes k out: A = φ (2/3) (z₁ − z₀) (w₁² + w₁w₀ + w₀²)/(w₁ + w₀). A uniform
// point has w³ = w₀³ + ξ (w₁³ − w₀³), and z = z₀ + (w² − w₀²)/k.
#include "math/elementary.h"
#include "shapes/axial.h"
#include "shapes/outline.h"

static bool is_usable(const sag_paraboloid *p) { return sag_paraboloid_validate(p, NULL) == SAG_OK; }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const double *size = shape; // radius, z_max
    sagi_real rr = sagi_real_scale(sagi_real_from(size[0]), -0.5 * size[0]), z = sagi_real_from(size[1]);
    *q = (sagi_quadric_exact){.square = {z, z}, .linear = {[2] = rr}};
}

// `size` gets the scaled radius and z_max and is what the form refers to.
static sagi_quadric_form form_of(const sag_paraboloid *p, double size[2]) {
    int exponent = sagi_size_exponent(fmax(p->radius, p->z_max));
    size[0] = exponent == 0 ? p->radius : ldexp(p->radius, -exponent);
    size[1] = exponent == 0 ? p->z_max : ldexp(p->z_max, -exponent);
    return (sagi_quadric_form){
        .square = {{size[1], 0}, {size[1], 0}},
        .linear = {[2] = sagi_two_prod(size[0], -0.5 * size[0])},
        .exponent = exponent,
        .exact = exact,
        .shape = size,
    };
}

sag_status sag_paraboloid_validate(const sag_paraboloid *p, sag_error *error) {
    sag_status status = sagi_check_positive(error, "paraboloid", "radius", p->radius);
    if (status == SAG_OK) status = sagi_check_interval(error, "paraboloid", p->z_min, p->z_max);
    if (status == SAG_OK && !(p->z_min >= 0))
        return sagi_invalid(error, "paraboloid", "z_min", p->z_min, "must not be negative");
    if (status == SAG_OK) status = sagi_sweep_validate(error, "paraboloid", p->phi_max_rad);
    if (status == SAG_OK) status = sagi_check_closed(error, "paraboloid", p->closed, p->phi_max_rad);
    return status;
}

sag_box3 sag_paraboloid_bounds(const sag_paraboloid *p) {
    if (!is_usable(p)) return sag_box3_empty();
    return sagi_box3_round_out(sagi_sweep_bounds(p->phi_max_rad, p->radius, p->z_min, p->z_max), 4);
}

static void collect(const sag_paraboloid *p, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(p)) return;
    double size[2];
    sagi_quadric_form form = form_of(p, size);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    // Nothing of the surface is below z = 0, so that plane need not cut it: no doubts at the vertex.
    sagi_axial_collect(&spans, p->z_min > 0 ? p->z_min : -INFINITY, p->z_max, p->closed, ray, list);
    if (!p->closed) sagi_axial_sweep(p->phi_max_rad, ray, list);
}

bool sagi_paraboloid_outline(const sag_paraboloid *p, sagi_outline *outline) {
    if (!p->closed || !is_usable(p)) return false;
    double size[2];
    const sagi_quadric_form form = form_of(p, size);
    return sagi_outline_make(&form, p->z_min > 0 ? p->z_min : -INFINITY, p->z_max, outline);
}

bool sag_paraboloid_hit(const sag_paraboloid *p, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(p, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_paraboloid_occluded(const sag_paraboloid *p, const sag_ray *ray) {
    sagi_crossings list;
    collect(p, ray, &list);
    return list.count > 0;
}

size_t sag_paraboloid_crossings(const sag_paraboloid *p, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list;
    collect(p, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

static double radius_at(const sag_paraboloid *p, double z) { return p->radius * sqrt(z / p->z_max); }

static void texture(const sag_paraboloid *p, sag_surface *surface) {
    sag_vec3 at = surface->position;
    double sweep = sagi_sweep_end(p->phi_max_rad), height = p->z_max - p->z_min;
    surface->u = sagi_sweep_angle(at.x, at.y) / sweep;
    surface->v = (at.z - p->z_min) / height;
    surface->dpdu = sag_vec3_make(-sweep * at.y, sweep * at.x, 0);
    surface->dpdv = sag_vec3_make(height * at.x / (2 * at.z), height * at.y / (2 * at.z), height);
}

void sag_paraboloid_surface(const sag_paraboloid *p, const sag_ray *ray, const sag_hit *hit,
                            sag_surface *surface) {
    double size[2];
    sagi_quadric_form form = form_of(p, size);
    if (hit->primitive == SAGI_CAP_LOW)
        sagi_cap_surface(p->z_min, radius_at(p, p->z_min), -1, ray, hit->t, surface);
    else if (hit->primitive == SAGI_CAP_HIGH)
        sagi_cap_surface(p->z_max, p->radius, 1, ray, hit->t, surface);
    else {
        sagi_quadric_place_hit(&form, ray, hit->t, surface);
        sagi_axial_clamp(&form, p->z_min, p->z_max, surface);
        texture(p, surface);
    }
    sagi_surface_finish(surface, ray, hit);
}

// w over k/2 for a wide one, over the radius for a tall one, so that nothing over- or underflows.
static double slant(const sag_paraboloid *p, double z) {
    double r = p->radius;
    return r > p->z_max ? sqrt(1 + 4 * (z / r) * (p->z_max / r))
                        : sqrt(z / p->z_max + r / p->z_max * (r / p->z_max) / 4);
}
static double side_area(const sag_paraboloid *p) {
    double r = p->radius, height = p->z_max - p->z_min, w0 = slant(p, p->z_min), w1 = slant(p, p->z_max);
    double size = r > p->z_max ? height / p->z_max * r * r / 2 : height * r;
    return sagi_sweep_end(p->phi_max_rad) * 2 / 3 * size * (w1 * w1 + w1 * w0 + w0 * w0) / (w1 + w0);
}

static double cap_area(const sag_paraboloid *p, double z) {
    double r = radius_at(p, z);
    return p->closed ? SAGI_PI * r * r : 0;
}

double sag_paraboloid_area(const sag_paraboloid *p) {
    return is_usable(p) ? side_area(p) + cap_area(p, p->z_min) + cap_area(p, p->z_max) : 0;
}

static void sample_side(const sag_paraboloid *p, sag_vec2 random, sag_surface *surface) {
    double size[2], k = p->radius * (p->radius / p->z_max);
    sagi_quadric_form form = form_of(p, size);
    double w0 = sqrt(k * p->z_min + k * k / 4), w1 = sqrt(k * p->z_max + k * k / 4);
    double w = sagi_cbrt(w0 * w0 * w0 + random.x * (w1 * w1 * w1 - w0 * w0 * w0));
    double z = fmin(fmax(p->z_min + (w - w0) * (w + w0) / k, p->z_min), p->z_max);
    double rho = radius_at(p, z), phi = sagi_sweep_end(p->phi_max_rad) * random.y;
    sagi_quadric_place_point(&form, sag_vec3_make(rho * sagi_cos(phi), rho * sagi_sin(phi), z), surface);
    texture(p, surface);
}

bool sag_paraboloid_sample(const sag_paraboloid *p, sag_vec2 random, sag_surface *surface) {
    double area = sag_paraboloid_area(p), low = cap_area(p, p->z_min), high = cap_area(p, p->z_max);
    if (!(area > 0 && isfinite(area))) return false;
    uint32_t primitive = SAGI_CURVED;
    if (sagi_choose(&random.x, side_area(p) / area)) {
        sample_side(p, random, surface);
    } else if (sagi_choose(&random.x, low / (low + high))) {
        sagi_cap_sample(p->z_min, radius_at(p, p->z_min), -1, random, surface);
        primitive = SAGI_CAP_LOW;
    } else {
        sagi_cap_sample(p->z_max, p->radius, 1, random, surface);
        primitive = SAGI_CAP_HIGH;
    }
    sagi_surface_finish_sample(surface, primitive);
    return true;
}

bool sag_paraboloid_contains(const sag_paraboloid *p, sag_vec3 point) {
    if (!p->closed || !is_usable(p) || !sag_is_finite(point)) return false;
    double size[2];
    sagi_quadric_form form = form_of(p, size);
    return point.z >= p->z_min && point.z <= p->z_max && sagi_quadric_sign(&form, point) <= 0;
}

// ∫ π ρ² dz, ρ² linear in z: the mean of the two caps times the height.
double sag_paraboloid_volume(const sag_paraboloid *p) {
    return is_usable(p) ? (cap_area(p, p->z_min) + cap_area(p, p->z_max)) / 2 * (p->z_max - p->z_min) : 0;
}
