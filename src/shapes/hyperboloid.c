// SPDX-License-Identifier: MIT
// The segment p₁ p₂ swept around z. At the height z the segment is at p₁ + s (p₂ − p₁), s = (z − z₁)/Δz, so
// with ζ = z − z₁ and multiplied by Δz²
//
//     F = Δz² (x² + y²) − (Δx² + Δy²) ζ² − 2 Δz (x₁Δx + y₁Δy) ζ − Δz² (x₁² + y₁²):
//
// a hyperboloid of one sheet; a cylinder where Δx = Δy = 0; a cone where the segment's line meets the axis. A
// level segment (Δz = 0) sweeps a flat ring and has its own file (hyperboloid_ring.c).
//
// The differences Δ are exact as double-doubles, the coefficients good to some 2⁻¹⁰³ but for the one of ζ,
// whose two products may cancel. Its error is relative to them; by 2|x₁Δx Δz ζ| ≤ x₁²Δz² + Δx²ζ² it is
// covered by the other terms' magnitudes, which is what the solver's bounds are relative to.
#include "shapes/hyperboloid.h"
#include "math/elementary.h"
#include "shapes/outline.h"

static bool is_usable(const sag_hyperboloid *h) { return sag_hyperboloid_validate(h, NULL) == SAG_OK; }

static bool has_extent(const sag_hyperboloid *h) {
    bool on_axis = h->p1.x == 0 && h->p1.y == 0 && h->p2.x == 0 && h->p2.y == 0;
    bool same = h->p1.x == h->p2.x && h->p1.y == h->p2.y && h->p1.z == h->p2.z;
    return !on_axis && !same;
}

static bool is_ring(const sag_hyperboloid *h) { return h->p1.z == h->p2.z; }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const sag_hyperboloid *h = shape;
    sagi_real x1 = sagi_real_from(h->p1.x), y1 = sagi_real_from(h->p1.y);
    sagi_real dx = sagi_real_from_diff(h->p2.x, h->p1.x), dy = sagi_real_from_diff(h->p2.y, h->p1.y);
    sagi_real dz = sagi_real_from_diff(h->p2.z, h->p1.z), zz = sagi_real_mul(dz, dz);
    sagi_real across = sagi_real_add(sagi_real_mul(dx, dx), sagi_real_mul(dy, dy));
    sagi_real along = sagi_real_add(sagi_real_mul(x1, dx), sagi_real_mul(y1, dy));
    sagi_real start = sagi_real_add(sagi_real_mul(x1, x1), sagi_real_mul(y1, y1));
    *q = (sagi_quadric_exact){
        .square = {zz, zz, sagi_real_neg(across)},
        .linear = {[2] = sagi_real_neg(sagi_real_mul(dz, along))},
        .constant = sagi_real_neg(sagi_real_mul(zz, start)),
    };
}

static sag_vec3 scaled(sag_vec3 p, int exponent) {
    return sag_vec3_make(ldexp(p.x, exponent), ldexp(p.y, exponent), ldexp(p.z, exponent));
}

// `own` gets the scaled segment and is what the form refers to. It starts at the end nearer to the axis:
// where that is a cone's apex, ζ counts from there and nothing cancels near it.
static sagi_quadric_form form_of(const sag_hyperboloid *h, sag_hyperboloid *own) {
    sag_vec3 between = sag_abs(sag_sub(h->p2, h->p1));
    double rho1 = sagi_hypot(h->p1.x, h->p1.y), rho2 = sagi_hypot(h->p2.x, h->p2.y);
    int exponent = sagi_size_exponent(fmax(sag_max_component(between), fmax(rho1, rho2)));
    *own = rho2 < rho1 ? (sag_hyperboloid){.p1 = h->p2, .p2 = h->p1}
                       : (sag_hyperboloid){.p1 = h->p1, .p2 = h->p2};
    double base = own->p1.z;
    if (exponent != 0) own->p1 = scaled(own->p1, -exponent), own->p2 = scaled(own->p2, -exponent);
    sag_vec3 p = own->p1, q = own->p2;
    sagi_dd dx = sagi_two_sum(q.x, -p.x), dy = sagi_two_sum(q.y, -p.y), dz = sagi_two_sum(q.z, -p.z);
    sagi_dd zz = sagi_dd_mul(dz, dz);
    sagi_dd across = sagi_dd_add(sagi_dd_mul(dx, dx), sagi_dd_mul(dy, dy));
    sagi_dd along = sagi_dd_add(sagi_dd_mul_double(dx, p.x), sagi_dd_mul_double(dy, p.y));
    sagi_dd start = sagi_dd_add(sagi_two_prod(p.x, p.x), sagi_two_prod(p.y, p.y));
    return (sagi_quadric_form){
        .square = {zz, zz, sagi_dd_neg(across)},
        .linear = {[2] = sagi_dd_neg(sagi_dd_mul(dz, along))},
        .constant = sagi_dd_neg(sagi_dd_mul(zz, start)),
        .center = {0, 0, base},
        .exponent = exponent,
        .exact = exact,
        .shape = own,
    };
}

sag_status sag_hyperboloid_validate(const sag_hyperboloid *h, sag_error *error) {
    sag_status status = sagi_check_point(error, "hyperboloid", "p1", h->p1);
    if (status == SAG_OK) status = sagi_check_point(error, "hyperboloid", "p2", h->p2);
    if (status == SAG_OK) status = sagi_sweep_validate(error, "hyperboloid", h->phi_max_rad);
    if (status == SAG_OK) status = sagi_check_closed(error, "hyperboloid", h->closed, h->phi_max_rad);
    if (status != SAG_OK) return status;
    if (!has_extent(h))
        return sagi_invalid3(error, "hyperboloid", "p2", h->p2, "equals p1 or lies on the z axis with it");
    if (h->closed && is_ring(h))
        return sagi_invalid(error, "hyperboloid", "p2.z", h->p2.z,
                            "equals p1.z: a flat ring cannot be closed");
    return SAG_OK;
}

sag_box3 sag_hyperboloid_bounds(const sag_hyperboloid *h) {
    if (!is_usable(h)) return sag_box3_empty();
    double radius = fmax(sagi_hypot(h->p1.x, h->p1.y), sagi_hypot(h->p2.x, h->p2.y));
    // A sweep counts from the segment's own angle, which turns along it: the full disk is the box taken.
    return sagi_box3_round_out(sagi_sweep_bounds(0, radius, fmin(h->p1.z, h->p2.z), fmax(h->p1.z, h->p2.z)),
                               4);
}

// φ of (x, y) counted from the segment's point at s.
double sagi_hyperboloid_angle(const sag_hyperboloid *h, double s, double x, double y) {
    double px = (1 - s) * h->p1.x + s * h->p2.x, py = (1 - s) * h->p1.y + s * h->p2.y;
    return sagi_sweep_angle(px * x + py * y, px * y - py * x);
}

static double place_along(const sag_hyperboloid *h, double z) { return (z - h->p1.z) / (h->p2.z - h->p1.z); }

static bool is_swept(const sag_hyperboloid *h, const sag_ray *ray, double t) {
    double x = sagi_ray_coordinate(ray->origin.x, 0, t, ray->direction.x).hi;
    double y = sagi_ray_coordinate(ray->origin.y, 0, t, ray->direction.y).hi;
    double zeta = sagi_ray_coordinate(ray->origin.z, h->p1.z, t, ray->direction.z).hi;
    double s = zeta / (h->p2.z - h->p1.z);
    return sagi_hyperboloid_angle(h, s, x, y) <= sagi_sweep_end(h->phi_max_rad);
}

static void collect(const sag_hyperboloid *h, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(h)) return;
    if (is_ring(h)) {
        sagi_ring_collect(h, ray, list);
        return;
    }
    sag_hyperboloid own;
    sagi_quadric_form form = form_of(h, &own);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    sagi_axial_collect(&spans, fmin(h->p1.z, h->p2.z), fmax(h->p1.z, h->p2.z), h->closed, ray, list);
    if (sagi_sweep_is_full(h->phi_max_rad) || h->closed) return;
    int kept = 0;
    for (int i = 0; i < list->count; i++)
        if (is_swept(h, ray, list->at[i].t)) list->at[kept++] = list->at[i];
    list->count = kept;
}

bool sagi_hyperboloid_outline(const sag_hyperboloid *h, sagi_outline *p) {
    if (!h->closed || !is_usable(h) || is_ring(h)) return false;
    sag_hyperboloid own;
    const sagi_quadric_form form = form_of(h, &own);
    return sagi_outline_make(&form, fmin(h->p1.z, h->p2.z), fmax(h->p1.z, h->p2.z), p);
}

bool sag_hyperboloid_hit(const sag_hyperboloid *h, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(h, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_hyperboloid_occluded(const sag_hyperboloid *h, const sag_ray *ray) {
    sagi_crossings list;
    collect(h, ray, &list);
    return list.count > 0;
}

size_t sag_hyperboloid_crossings(const sag_hyperboloid *h, const sag_ray *ray, sag_hit *hits,
                                 size_t capacity) {
    sagi_crossings list;
    collect(h, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

// The segment turned by φ is the line of constant u through the point: dp/dv is p₂ − p₁ turned so. At the
// place s the turn takes the segment's (px, py) to (x, y), so cos φ = (px x + py y)/ρ², sin φ = (px y − py
// x)/ρ².
void sagi_hyperboloid_texture(const sag_hyperboloid *h, double s, sag_surface *surface) {
    sag_vec3 p = surface->position, between = sag_sub(h->p2, h->p1);
    double sweep = sagi_sweep_end(h->phi_max_rad), phi = sagi_hyperboloid_angle(h, s, p.x, p.y);
    surface->u = phi / sweep;
    surface->v = s;
    surface->dpdu = sag_vec3_make(-sweep * p.y, sweep * p.x, 0);
    surface->dpdv = sag_vec3_make(between.x * sagi_cos(phi) - between.y * sagi_sin(phi),
                                  between.x * sagi_sin(phi) + between.y * sagi_cos(phi), between.z);
}

// The end of the segment that a cap closes.
static sag_vec3 end_of(const sag_hyperboloid *h, uint32_t cap) {
    bool first = (cap == SAGI_CAP_LOW) == (h->p1.z < h->p2.z);
    return first ? h->p1 : h->p2;
}

void sag_hyperboloid_surface(const sag_hyperboloid *h, const sag_ray *ray, const sag_hit *hit,
                             sag_surface *surface) {
    if (hit->primitive != SAGI_CURVED) {
        sag_vec3 end = end_of(h, hit->primitive);
        sagi_cap_surface(end.z, sagi_hypot(end.x, end.y), hit->primitive == SAGI_CAP_LOW ? -1 : 1, ray,
                         hit->t, surface);
    } else if (is_ring(h)) {
        sagi_ring_surface(h, ray, hit, surface);
    } else {
        sag_hyperboloid own;
        sagi_quadric_form form = form_of(h, &own);
        sagi_quadric_place_hit(&form, ray, hit->t, surface);
        sagi_axial_clamp(&form, fmin(h->p1.z, h->p2.z), fmax(h->p1.z, h->p2.z), surface);
        sagi_hyperboloid_texture(h, place_along(h, surface->position.z), surface);
    }
    sagi_surface_finish(surface, ray, hit);
}

// ρ² = x₁² + y₁² + 2 s (x₁Δx + y₁Δy) + s² (Δx² + Δy²) in η = s |Δz|.
static sagi_profile profile_of(const sag_hyperboloid *h) {
    sag_vec3 p = h->p1, d = sag_sub(h->p2, h->p1);
    double height = fabs(d.z);
    return (sagi_profile){(d.x / height) * (d.x / height) + (d.y / height) * (d.y / height),
                          2 * (p.x * (d.x / height) + p.y * (d.y / height)), p.x * p.x + p.y * p.y};
}

static double side_area(const sag_hyperboloid *h) {
    if (is_ring(h)) return sagi_ring_area(h);
    sagi_profile profile = profile_of(h);
    return sagi_sweep_end(h->phi_max_rad) * sagi_profile_area(&profile, 0, fabs(h->p2.z - h->p1.z));
}

static double cap_area(const sag_hyperboloid *h, sag_vec3 p) {
    return h->closed ? SAGI_PI * (p.x * p.x + p.y * p.y) : 0;
}

double sag_hyperboloid_area(const sag_hyperboloid *h) {
    return is_usable(h) ? side_area(h) + cap_area(h, h->p1) + cap_area(h, h->p2) : 0;
}

static void sample_side(const sag_hyperboloid *h, sag_vec2 random, sag_surface *surface) {
    double s, phi = sagi_sweep_end(h->phi_max_rad) * random.y;
    if (is_ring(h)) {
        s = sagi_ring_invert(h, random.x);
    } else {
        sagi_profile profile = profile_of(h);
        double height = fabs(h->p2.z - h->p1.z);
        s = sagi_profile_invert(&profile, 0, height, random.x) / height;
    }
    double x = (1 - s) * h->p1.x + s * h->p2.x, y = (1 - s) * h->p1.y + s * h->p2.y;
    sag_vec3 p = {x * sagi_cos(phi) - y * sagi_sin(phi), x * sagi_sin(phi) + y * sagi_cos(phi),
                  (1 - s) * h->p1.z + s * h->p2.z};
    if (is_ring(h)) {
        sagi_ring_place(h, p, surface);
    } else {
        sag_hyperboloid own;
        sagi_quadric_form form = form_of(h, &own);
        sagi_quadric_place_point(&form, p, surface);
    }
    sagi_hyperboloid_texture(h, s, surface);
}

bool sag_hyperboloid_sample(const sag_hyperboloid *h, sag_vec2 random, sag_surface *surface) {
    if (!is_usable(h)) return false;
    double side = side_area(h), one = cap_area(h, h->p1), two = cap_area(h, h->p2), area = side + one + two;
    if (!(area > 0 && isfinite(area))) return false;
    uint32_t primitive = SAGI_CURVED;
    if (sagi_choose(&random.x, side / area)) {
        sample_side(h, random, surface);
    } else {
        bool first = sagi_choose(&random.x, one / (one + two)), low = first == (h->p1.z < h->p2.z);
        sag_vec3 end = first ? h->p1 : h->p2;
        sagi_cap_sample(end.z, sagi_hypot(end.x, end.y), low ? -1 : 1, random, surface);
        primitive = low ? SAGI_CAP_LOW : SAGI_CAP_HIGH;
    }
    sagi_surface_finish_sample(surface, primitive);
    return true;
}

bool sag_hyperboloid_contains(const sag_hyperboloid *h, sag_vec3 point) {
    if (!h->closed || !is_usable(h) || is_ring(h) || !sag_is_finite(point)) return false;
    sag_hyperboloid own;
    sagi_quadric_form form = form_of(h, &own);
    return point.z >= fmin(h->p1.z, h->p2.z) && point.z <= fmax(h->p1.z, h->p2.z) &&
           sagi_quadric_sign(&form, point) <= 0;
}

// π |Δz| ∫ ρ² ds: with ends a, b of the segment's plan, (a·a + a·b + b·b)/3.
double sag_hyperboloid_volume(const sag_hyperboloid *h) {
    if (!h->closed || !is_usable(h)) return 0;
    sag_vec3 a = h->p1, b = h->p2;
    double aa = a.x * a.x + a.y * a.y, ab = a.x * b.x + a.y * b.y, bb = b.x * b.x + b.y * b.y;
    return SAGI_PI / 3 * fabs(b.z - a.z) * (aa + ab + bb);
}
