// SPDX-License-Identifier: MIT
// The torus: everything but the solver (torus_solve.c). Around the axis by φ and around the tube by ψ,
//     x = (R + r cos ψ) cos φ,   y = (R + r cos ψ) sin φ,   z = r sin ψ,
// the area element is r |R + r cos ψ| dφ dψ. On the inner sheet of a spindle R + r cos ψ < 0, so φ there is
// that of the opposite side.
//
// Sampling inverts the cumulative area in ψ. Between the angles where R + r cos ψ changes its sign (±β, cos β
// = −R/r; β = π for a ring) the integral is R ψ + r sin ψ: increasing on the outer sheet |ψ| ≤ β, decreasing
// on the inner one. Both are monotone, so bisection with Newton's steps inverts them.
#include "shapes/torus.h"
#include "math/elementary.h"
#include "shapes/sphere.h"
#include "shapes/sweep.h"
#include "shapes/validate.h"

static bool is_usable(const sag_torus *torus) {
    return torus->major_radius >= 0 && torus->minor_radius > 0 && sagi_is_coordinate(torus->major_radius) &&
           sagi_is_coordinate(torus->minor_radius);
}

static bool is_spindle(const sag_torus *torus) { return torus->major_radius < torus->minor_radius; }

static int find(const sag_torus *torus, const sag_ray *ray, int most, double t[4]) {
    if (!sag_ray_is_valid(ray) || !is_usable(torus)) return 0;
    // With R = 0 the two sheets are one sphere: every root would be double.
    if (torus->major_radius == 0)
        return sagi_sphere_crossings((sag_vec3){0, 0, 0}, torus->minor_radius, ray, t);
    sagi_cut cuts[4];
    int count = sagi_torus_crossings(torus, ray, most, cuts);
    for (int i = 0; i < count; i++) t[i] = cuts[i].t.hi;
    return count;
}

sag_status sag_torus_validate(const sag_torus *torus, sag_error *error) {
    if (!(torus->major_radius >= 0 && sagi_is_coordinate(torus->major_radius)))
        return sagi_invalid(error, "torus", "major_radius", torus->major_radius,
                            "must not be negative and at most 2^100");
    return sagi_check_positive(error, "torus", "minor_radius", torus->minor_radius);
}

sag_box3 sag_torus_bounds(const sag_torus *torus) {
    if (!is_usable(torus)) return sag_box3_empty();
    double reach = torus->major_radius + torus->minor_radius, r = torus->minor_radius;
    return sagi_box3_round_out((sag_box3){{-reach, -reach, -r}, {reach, reach, r}}, 1);
}

bool sag_torus_hit(const sag_torus *torus, const sag_ray *ray, sag_hit *hit) {
    double t[4];
    if (find(torus, ray, 1, t) == 0) return false;
    *hit = sagi_hit_make(t[0], 0, 0, 0);
    return true;
}

bool sag_torus_occluded(const sag_torus *torus, const sag_ray *ray) {
    double t[4];
    return find(torus, ray, 1, t) > 0;
}

size_t sag_torus_crossings(const sag_torus *torus, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    double t[4];
    sagi_crossings list = {0};
    int count = find(torus, ray, 4, t);
    for (int i = 0; i < count; i++) sagi_crossings_add(&list, t[i], 0, 0, 0);
    return sagi_crossings_write(&list, hits, capacity);
}

// Whether a point of a spindle is on its inner sheet rather than its outer one.
static bool is_inner(const sag_torus *torus, double rho, double z) {
    if (!is_spindle(torus)) return false;
    double outer = sagi_hypot(rho - torus->major_radius, z), inner = sagi_hypot(rho + torus->major_radius, z);
    return fabs(inner - torus->minor_radius) < fabs(outer - torus->minor_radius);
}

// Normal, texture coordinates and derivatives from the directions: (c, s) of φ, and (cos ψ, sin ψ) by (a, b).
static void finish(const sag_torus *torus, double c, double s, double a, double b, sag_surface *surface) {
    double length = sagi_hypot(a, b);
    if (length > 0)
        a /= length, b /= length;
    else // where a horn torus' tube closes on the axis: its inner side
        a = -1, b = 0;
    surface->geometric_normal = sag_normalize((sag_vec3){a * c, a * s, b});
    surface->u = sagi_sweep_angle(c, s) / SAGI_TWO_PI;
    surface->v = sagi_sweep_angle(a, b) / SAGI_TWO_PI;
    double ring = SAGI_TWO_PI * (torus->major_radius + torus->minor_radius * a);
    double tube = SAGI_TWO_PI * torus->minor_radius;
    surface->dpdu = (sag_vec3){-ring * s, ring * c, 0};
    surface->dpdv = (sag_vec3){-tube * b * c, -tube * b * s, tube * a};
}

// The same at surface->position, ρ − R being worked out in double-double.
static void finish_at_position(const sag_torus *torus, sag_surface *surface) {
    sag_vec3 p = surface->position;
    sagi_dd rho = sagi_dd_sqrt(sagi_dd_add(sagi_two_prod(p.x, p.x), sagi_two_prod(p.y, p.y)));
    double c = rho.hi > 0 ? p.x / rho.hi : 1, s = rho.hi > 0 ? p.y / rho.hi : 0;
    if (is_inner(torus, rho.hi, p.z)) c = -c, s = -s, rho = sagi_dd_neg(rho);
    finish(torus, c, s, sagi_dd_add_double(rho, -torus->major_radius).hi, p.z, surface);
}

void sag_torus_surface(const sag_torus *torus, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    if (torus->major_radius == 0) {
        sagi_sphere_place((sag_vec3){0, 0, 0}, torus->minor_radius, ray, hit->t, surface);
    } else {
        sagi_point_at(ray, sagi_torus_refine(torus, ray, hit->t), &surface->position,
                      &surface->position_error);
        // Where the surface is tilted its height changes with the rounding of the other coordinates; the
        // whole reach' rounding in each keeps a spawned ray clear of that and of a coordinate that is 0.
        double least = 4 * SAGI_EPSILON * torus->minor_radius;
        sag_vec3 e = surface->position_error;
        surface->position_error = (sag_vec3){e.x + least, e.y + least, e.z + least};
    }
    finish_at_position(torus, surface);
    sagi_surface_finish(surface, ray, hit);
}

// ψ where the outer sheet ends.
static double sheet_end(const sag_torus *torus) {
    return is_spindle(torus) ? sagi_acos(-torus->major_radius / torus->minor_radius) : SAGI_PI;
}

// ∫ (R + r cos ψ) dψ from 0.
static double cumulative(const sag_torus *torus, double psi) {
    return torus->major_radius * psi + torus->minor_radius * sagi_sin(psi);
}

double sag_torus_area(const sag_torus *torus) {
    if (!is_usable(torus)) return 0;
    double end = sheet_end(torus), outer = 2 * cumulative(torus, end);
    double inner = 2 * (cumulative(torus, end) - cumulative(torus, SAGI_PI));
    // With R = 0 both sheets are the same sphere, which counts once.
    if (torus->major_radius == 0) inner = 0;
    return SAGI_TWO_PI * torus->minor_radius * (outer + inner);
}

// ψ in [low, high] where the cumulative area, monotone there, has the value `target`.
static double invert(const sag_torus *torus, double low, double high, double target) {
    bool rising = cumulative(torus, high) > cumulative(torus, low);
    double psi = 0.5 * (low + high);
    for (int i = 0; i < 60; i++) {
        double error = cumulative(torus, psi) - target;
        if ((error < 0) == rising)
            low = psi;
        else
            high = psi;
        double next = psi - error / (torus->major_radius + torus->minor_radius * sagi_cos(psi));
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - psi) <= 0x1p-52) return next;
        psi = next;
    }
    return psi;
}

bool sag_torus_sample(const sag_torus *torus, sag_vec2 random, sag_surface *surface) {
    if (!is_usable(torus)) return false;
    double end = sheet_end(torus), outer = cumulative(torus, end);
    double inner = torus->major_radius == 0 ? 0 : outer - cumulative(torus, SAGI_PI); // of half a turn each
    // By symmetry the sign of ψ is the first choice, the sheet the second.
    double at = 2 * random.y, sign = at < 1 ? 1 : -1, psi;
    at = (at < 1 ? at : at - 1) * (outer + inner);
    if (at < outer || !(inner > 0))
        psi = invert(torus, 0, end, fmin(at, outer));
    else
        psi = invert(torus, end, SAGI_PI, fmax(outer - (at - outer), cumulative(torus, SAGI_PI)));
    double phi = random.x * SAGI_TWO_PI, a = sagi_cos(psi), b = sign * sagi_sin(psi), c = sagi_cos(phi),
           s = sagi_sin(phi);
    double ring = torus->major_radius + torus->minor_radius * a;
    surface->position = (sag_vec3){ring * c, ring * s, torus->minor_radius * b};
    double error = 16 * SAGI_EPSILON * (torus->major_radius + torus->minor_radius);
    surface->position_error = (sag_vec3){error, error, error};
    finish(torus, c, s, a, b, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}

bool sag_torus_contains(const sag_torus *torus, sag_vec3 p) {
    if (!is_usable(torus) || !sag_is_finite(p)) return false;
    // ρ in double-double: (ρ − R)² + z² ≤ r² as a comparison of nearly exact numbers.
    double scale = ldexp(1, -ilogb(torus->major_radius + torus->minor_radius));
    double x = p.x * scale, y = p.y * scale, z = p.z * scale, r = torus->minor_radius * scale;
    if (!(fabs(x) < 4 && fabs(y) < 4 && fabs(z) < 4)) return false;
    sagi_dd rho = sagi_dd_sqrt(sagi_dd_add(sagi_two_prod(x, x), sagi_two_prod(y, y)));
    sagi_dd away = sagi_dd_add_double(rho, -torus->major_radius * scale);
    sagi_dd distance2 = sagi_dd_add(sagi_dd_mul(away, away), sagi_two_prod(z, z));
    return sagi_dd_sub(distance2, sagi_two_prod(r, r)).hi <= 0;
}

double sag_torus_volume(const sag_torus *torus) {
    if (!is_usable(torus)) return 0;
    // Pappus for a ring: 2πR · πr². The outer sheet of a spindle, turned about the axis: ∫ π x² dz, z = r sin
    // ψ, = 2π ∫₀^β (R + r cos ψ)² r cos ψ dψ, less what lies beyond the axis, which β leaves out.
    double major = torus->major_radius, r = torus->minor_radius, b = sheet_end(torus);
    double s = sagi_sin(b), c = sagi_cos(b);
    // ∫ cos = s, ∫ cos² = (b + s c)/2, ∫ cos³ = s − s³/3
    double integral = major * major * s + major * r * (b + s * c) + r * r * (s - s * s * s / 3);
    return SAGI_TWO_PI * r * integral;
}

sag_vec3 sag_torus_closest_point(const sag_torus *torus, sag_vec3 p) {
    double rho = sagi_hypot(p.x, p.y), c = rho > 0 ? p.x / rho : 1, s = rho > 0 ? p.y / rho : 0;
    double major = torus->major_radius, r = torus->minor_radius;
    // In the half-plane of p: towards the near circle, or, for a spindle, perhaps the far one's inner sheet.
    double best = INFINITY;
    sag_vec3 nearest = p;
    for (int side = 1; side >= (is_spindle(torus) ? -1 : 1); side -= 2) {
        double dx = rho - side * major, length = sagi_hypot(dx, p.z);
        double ux = length > 0 ? dx / length : side, uz = length > 0 ? p.z / length : 0;
        double x = side * major + r * ux, z = r * uz;
        double distance = sagi_hypot(x - rho, z - p.z);
        if (distance < best) best = distance, nearest = (sag_vec3){x * c, x * s, z};
    }
    return nearest;
}
