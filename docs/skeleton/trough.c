// SPDX-License-Identifier: MIT
// The parabolic trough. A shape's file opens with its mathematics; then come the verbs, in the order of
// shapes.h.
//
// Crossings. F(p) = x² − 4fz is a quadric, so the common solver (shapes/quadric_solve.h) finds where the ray
// runs inside {F ≤ 0}, every end of such an interval being a crossing, to 2 ulp in t, with exact arithmetic
// behind it. What is left is to keep those with |x| ≤ half_width and |y| ≤ half_length, decided on
// coordinates that are good to a rounding however far away the ray began.
//
// Position and its error. x and y are those of the ray at t; z is taken from the equation, so the point is on
// the surface but for roundings. The error has to exceed two things: those roundings, some 4u|x| and 4u|z| (u
// = 2⁻⁵³), and the zone in which the solver's first stage, in doubles, cannot tell the side: |F| ≤ 16u(x² +
// 4f|z|) = 32u x² at the surface. With |∇F| = 2√(x² + 4f²) ≥ 2|x| that zone is at most 16u|x| thick.
// 32u·half_width covers both, and at the vertex line, where x = z = 0, keeps a spawned ray clear of it too; n
// has Σ|nᵢ| ≥ 1, so the offset along n is no less.
//
// Area. The arc from 0 to x is s(x) = x/2 √(1 + (x/2f)²) + f asinh(x/2f), the area 2 s(half_width) · 2
// half_length. Sampling inverts s by Newton's method: s is odd, convex for x > 0 and s' ≥ 1, so from the
// right end it falls monotonically to the root.
#include "trough.h"
#include "shapes/quadric_solve.h"
#include "shapes/validate.h"

static bool is_usable(const sag_trough *s) { return sag_trough_validate(s, NULL) == SAG_OK; }

static double height(const sag_trough *s, double x) { return x / (4 * s->focal_length) * x; }

sag_status sag_trough_validate(const sag_trough *s, sag_error *error) {
    sag_status status = sagi_check_positive(error, "trough", "focal_length", s->focal_length);
    if (status == SAG_OK) status = sagi_check_positive(error, "trough", "half_width", s->half_width);
    if (status == SAG_OK) status = sagi_check_positive(error, "trough", "half_length", s->half_length);
    if (status == SAG_OK && !sagi_is_coordinate(height(s, s->half_width)))
        return sagi_invalid(error, "trough", "half_width", s->half_width, "makes it higher than 2^100");
    return status;
}

sag_box3 sag_trough_bounds(const sag_trough *s) {
    if (!is_usable(s)) return sag_box3_empty();
    sag_box3 box = {{-s->half_width, -s->half_length, 0},
                    {s->half_width, s->half_length, height(s, s->half_width)}};
    return sagi_box3_round_out(box, 4);
}

// In the solver's coordinates y = p/2^e: y₀² + 2 l y₂ with l = −2f/2^e, a power of two that is exact.
static int exponent_of(const sag_trough *s) { return sagi_size_exponent(s->focal_length); }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const sag_trough *s = shape;
    *q = (sagi_quadric_exact){.square[0] = sagi_real_from(1)};
    q->linear[2] = sagi_real_from(ldexp(-2 * s->focal_length, -exponent_of(s)));
}

static bool holds(const sag_trough *s, const sag_ray *ray, double t) {
    double x = sagi_ray_coordinate(ray->origin.x, 0, t, ray->direction.x).hi;
    double y = sagi_ray_coordinate(ray->origin.y, 0, t, ray->direction.y).hi;
    return fabs(x) <= s->half_width && fabs(y) <= s->half_length;
}

static sagi_crossings collect(const sag_trough *s, const sag_ray *ray) {
    sagi_crossings list = {0};
    if (!sag_ray_is_valid(ray) || !is_usable(s)) return list;
    sagi_quadric_form form = {.exponent = exponent_of(s), .exact = exact, .shape = s};
    form.square[0] = sagi_dd_from(1);
    form.linear[2] = sagi_dd_from(ldexp(-2 * s->focal_length, -form.exponent));
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    for (int i = 0; i < spans.count; i++) {
        const double ends[2] = {spans.enter[i], spans.leave[i]};
        for (int k = 0; k < 2; k++)
            if (isfinite(ends[k]) && sagi_in_range(ray, ends[k]) && holds(s, ray, ends[k]))
                sagi_crossings_add(&list, ends[k], 0, 0, 0);
    }
    return list;
}

bool sag_trough_hit(const sag_trough *trough, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list = collect(trough, ray);
    return sagi_crossings_first(&list, hit);
}

bool sag_trough_occluded(const sag_trough *trough, const sag_ray *ray) {
    return collect(trough, ray).count > 0;
}

size_t sag_trough_crossings(const sag_trough *trough, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list = collect(trough, ray);
    return sagi_crossings_write(&list, hits, capacity);
}

static void place(const sag_trough *s, double x, double y, sag_surface *surface) {
    double slope = x / (2 * s->focal_length), error = 32 * SAGI_EPSILON * s->half_width;
    surface->position = sag_vec3_make(x, y, height(s, x));
    surface->position_error =
        sag_vec3_make(error, 2 * SAGI_EPSILON * fabs(y), error + 4 * SAGI_EPSILON * surface->position.z);
    surface->geometric_normal = sag_normalize(sag_vec3_make(-slope, 0, 1));
    surface->u = 0.5 + 0.5 * (x / s->half_width);
    surface->v = 0.5 + 0.5 * (y / s->half_length);
    surface->dpdu = sag_scale(sag_vec3_make(1, 0, slope), 2 * s->half_width);
    surface->dpdv = sag_vec3_make(0, 2 * s->half_length, 0);
}

void sag_trough_surface(const sag_trough *trough, const sag_ray *ray, const sag_hit *hit,
                        sag_surface *surface) {
    place(trough, sagi_ray_coordinate(ray->origin.x, 0, hit->t, ray->direction.x).hi,
          sagi_ray_coordinate(ray->origin.y, 0, hit->t, ray->direction.y).hi, surface);
    sagi_surface_finish(surface, ray, hit);
}

static double arc(double f, double x) {
    double slope = x / (2 * f);
    return x / 2 * sqrt(1 + slope * slope) + f * asinh(slope);
}

double sag_trough_area(const sag_trough *s) {
    return is_usable(s) ? 4 * arc(s->focal_length, s->half_width) * s->half_length : 0;
}

bool sag_trough_sample(const sag_trough *s, sag_vec2 random, sag_surface *surface) {
    if (!is_usable(s)) return false;
    double f = s->focal_length, side = 2 * random.x - 1, x = s->half_width;
    double wanted = fabs(side) * arc(f, x);
    for (int i = 0; i < 60; i++) { // some eight steps, quadratic at the end
        double slope = x / (2 * f), next = x - (arc(f, x) - wanted) / sqrt(1 + slope * slope);
        if (!(next < x)) break;
        x = next;
    }
    place(s, copysign(x > 0 ? x : 0, side), (2 * random.y - 1) * s->half_length, surface);
    sagi_surface_finish_sample(surface, 0);
    return true;
}
