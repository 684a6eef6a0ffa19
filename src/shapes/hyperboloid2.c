// SPDX-License-Identifier: MIT
// The hyperboloid of two sheets z²/c² − (x² + y²)/a² = 1, multiplied out:
//
//     F = c² (x² + y²) − a² z² + a² c²  ≤ 0 inside either sheet.
//
// Nothing of it is in −c < z < c, so a plane of z_min or z_max in that gap is moved to the middle of it,
// where it cuts nothing and leaves no doubt at the vertex.
#include "math/elementary.h"
#include "shapes/axial.h"
#include "shapes/revolve.h"

// The range of z that a sheet has: from `low` to `high`, empty when low ≥ high.
typedef struct zone {
    double low, high;
} zone;

static zone upper(const sag_hyperboloid2 *s) { return (zone){fmax(s->z_min, s->c), s->z_max}; }
static zone lower(const sag_hyperboloid2 *s) { return (zone){s->z_min, fmin(s->z_max, -s->c)}; }
static bool is_there(zone z) { return z.low < z.high; }

static bool is_usable(const sag_hyperboloid2 *s) { return sag_hyperboloid2_validate(s, NULL) == SAG_OK; }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const double *size = shape; // a, c
    sagi_real aa = sagi_real_scale(sagi_real_from(size[0]), size[0]);
    sagi_real cc = sagi_real_scale(sagi_real_from(size[1]), size[1]);
    *q = (sagi_quadric_exact){.square = {cc, cc, sagi_real_neg(aa)}, .constant = sagi_real_mul(aa, cc)};
}

// `size` gets the scaled a and c and is what the form refers to.
static sagi_quadric_form form_of(const sag_hyperboloid2 *s, double size[2]) {
    int exponent = sagi_size_exponent(fmax(s->a, s->c));
    size[0] = exponent == 0 ? s->a : ldexp(s->a, -exponent);
    size[1] = exponent == 0 ? s->c : ldexp(s->c, -exponent);
    sagi_dd aa = sagi_two_prod(size[0], size[0]), cc = sagi_two_prod(size[1], size[1]);
    return (sagi_quadric_form){
        .square = {cc, cc, sagi_dd_neg(aa)},
        .constant = sagi_dd_mul(aa, cc),
        .exponent = exponent,
        .exact = exact,
        .shape = size,
    };
}

sag_status sag_hyperboloid2_validate(const sag_hyperboloid2 *s, sag_error *error) {
    sag_status status = sagi_check_positive(error, "hyperboloid2", "a", s->a);
    if (status == SAG_OK) status = sagi_check_positive(error, "hyperboloid2", "c", s->c);
    if (status == SAG_OK) status = sagi_check_interval(error, "hyperboloid2", s->z_min, s->z_max);
    if (status == SAG_OK) status = sagi_sweep_validate(error, "hyperboloid2", s->phi_max_rad);
    if (status == SAG_OK) status = sagi_check_closed(error, "hyperboloid2", s->closed, s->phi_max_rad);
    if (status != SAG_OK || is_there(upper(s)) || is_there(lower(s))) return status;
    return sag_error_set(
        error, SAG_ERROR_GEOMETRY,
        "hyperboloid2: z_min %.17g, z_max %.17g leave nothing: the sheets begin at c = %.17g", s->z_min,
        s->z_max, s->c);
}

// ρ at height z, |z| ≥ c.
static double radius_at(const sag_hyperboloid2 *s, double z) {
    double beyond = fabs(z) - s->c;
    return beyond > 0 ? s->a * sqrt(beyond / s->c * ((fabs(z) + s->c) / s->c)) : 0;
}

sag_box3 sag_hyperboloid2_bounds(const sag_hyperboloid2 *s) {
    if (!is_usable(s)) return sag_box3_empty();
    zone up = upper(s), down = lower(s);
    double low = is_there(down) ? down.low : up.low, high = is_there(up) ? up.high : down.high;
    double radius =
        fmax(is_there(up) ? radius_at(s, up.high) : 0, is_there(down) ? radius_at(s, down.low) : 0);
    return sagi_box3_round_out(sagi_sweep_bounds(s->phi_max_rad, radius, low, high), 16);
}

static void collect(const sag_hyperboloid2 *s, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(s)) return;
    double size[2];
    sagi_quadric_form form = form_of(s, size);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    double low = fabs(s->z_min) <= s->c ? 0 : s->z_min, high = fabs(s->z_max) <= s->c ? 0 : s->z_max;
    sagi_axial_collect(&spans, low, high, s->closed, ray, list);
    if (!s->closed) sagi_axial_sweep(s->phi_max_rad, ray, list);
}

bool sag_hyperboloid2_hit(const sag_hyperboloid2 *s, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(s, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_hyperboloid2_occluded(const sag_hyperboloid2 *s, const sag_ray *ray) {
    sagi_crossings list;
    collect(s, ray, &list);
    return list.count > 0;
}

size_t sag_hyperboloid2_crossings(const sag_hyperboloid2 *s, const sag_ray *ray, sag_hit *hits,
                                  size_t capacity) {
    sagi_crossings list;
    collect(s, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

// ρ ρ' = a² z/c², so dp/dz = (x, y) ρ'/ρ and 1.
static void texture(const sag_hyperboloid2 *s, sag_surface *surface) {
    sag_vec3 p = surface->position;
    double sweep = sagi_sweep_end(s->phi_max_rad), height = s->z_max - s->z_min;
    double growth = height * (s->a / s->c) * (s->a / s->c) * p.z / (p.x * p.x + p.y * p.y);
    surface->u = sagi_sweep_angle(p.x, p.y) / sweep;
    surface->v = (p.z - s->z_min) / height;
    surface->dpdu = sag_vec3_make(-sweep * p.y, sweep * p.x, 0);
    surface->dpdv = sag_vec3_make(growth * p.x, growth * p.y, height);
}

void sag_hyperboloid2_surface(const sag_hyperboloid2 *s, const sag_ray *ray, const sag_hit *hit,
                              sag_surface *surface) {
    double size[2];
    sagi_quadric_form form = form_of(s, size);
    if (hit->primitive == SAGI_CAP_LOW)
        sagi_cap_surface(s->z_min, radius_at(s, s->z_min), -1, ray, hit->t, surface);
    else if (hit->primitive == SAGI_CAP_HIGH)
        sagi_cap_surface(s->z_max, radius_at(s, s->z_max), 1, ray, hit->t, surface);
    else {
        sagi_quadric_place_hit(&form, ray, hit->t, surface);
        sagi_axial_clamp(&form, s->z_min, s->z_max, surface);
        texture(s, surface);
    }
    sagi_surface_finish(surface, ray, hit);
}

// ρ² = (a/c)² (z − c)(z + c), in h = |z| − c: α h² + 2 α c h.
static sagi_profile profile_of(const sag_hyperboloid2 *s) {
    double alpha = (s->a / s->c) * (s->a / s->c);
    return (sagi_profile){alpha, 2 * alpha * s->c, 0};
}

// The area of one sheet's part, its z counted away from the origin.
static double sheet_area(const sag_hyperboloid2 *s, zone z, double sign) {
    if (!is_there(z)) return 0;
    sagi_profile profile = profile_of(s);
    double from = fmin(sign * z.low, sign * z.high) - s->c, to = fmax(sign * z.low, sign * z.high) - s->c;
    return sagi_sweep_end(s->phi_max_rad) * sagi_profile_area(&profile, from, to);
}

static double cap_area(const sag_hyperboloid2 *s, double z) {
    double r = radius_at(s, z);
    return s->closed ? SAGI_PI * r * r : 0;
}

double sag_hyperboloid2_area(const sag_hyperboloid2 *s) {
    if (!is_usable(s)) return 0;
    return sheet_area(s, upper(s), 1) + sheet_area(s, lower(s), -1) + cap_area(s, s->z_min) +
           cap_area(s, s->z_max);
}

static void sample_sheet(const sag_hyperboloid2 *s, zone z, double sign, sag_vec2 random,
                         sag_surface *surface) {
    double size[2];
    sagi_quadric_form form = form_of(s, size);
    sagi_profile profile = profile_of(s);
    double from = fmin(sign * z.low, sign * z.high) - s->c, to = fmax(sign * z.low, sign * z.high) - s->c;
    double at = sign * (s->c + sagi_profile_invert(&profile, from, to, random.x));
    double rho = radius_at(s, at), phi = sagi_sweep_end(s->phi_max_rad) * random.y;
    sagi_quadric_place_point(&form, sag_vec3_make(rho * sagi_cos(phi), rho * sagi_sin(phi), at), surface);
    texture(s, surface);
}

bool sag_hyperboloid2_sample(const sag_hyperboloid2 *s, sag_vec2 random, sag_surface *surface) {
    if (!is_usable(s)) return false;
    double up = sheet_area(s, upper(s), 1), down = sheet_area(s, lower(s), -1);
    double low = cap_area(s, s->z_min), high = cap_area(s, s->z_max), area = up + down + low + high;
    if (!(area > 0 && isfinite(area))) return false;
    uint32_t primitive = SAGI_CURVED;
    if (sagi_choose(&random.x, up / area)) {
        sample_sheet(s, upper(s), 1, random, surface);
    } else if (sagi_choose(&random.x, down / (down + low + high))) {
        sample_sheet(s, lower(s), -1, random, surface);
    } else if (sagi_choose(&random.x, low / (low + high))) {
        sagi_cap_sample(s->z_min, radius_at(s, s->z_min), -1, random, surface);
        primitive = SAGI_CAP_LOW;
    } else {
        sagi_cap_sample(s->z_max, radius_at(s, s->z_max), 1, random, surface);
        primitive = SAGI_CAP_HIGH;
    }
    sagi_surface_finish_sample(surface, primitive);
    return true;
}

bool sag_hyperboloid2_contains(const sag_hyperboloid2 *s, sag_vec3 point) {
    if (!s->closed || !is_usable(s) || !sag_is_finite(point)) return false;
    double size[2];
    sagi_quadric_form form = form_of(s, size);
    return point.z >= s->z_min && point.z <= s->z_max && sagi_quadric_sign(&form, point) <= 0;
}

// ∫ π ρ² dh = π α (h³/3 + c h²).
static double sheet_volume(const sag_hyperboloid2 *s, zone z, double sign) {
    if (!is_there(z)) return 0;
    double from = fmin(sign * z.low, sign * z.high) - s->c, to = fmax(sign * z.low, sign * z.high) - s->c;
    double alpha = (s->a / s->c) * (s->a / s->c);
    return SAGI_PI * alpha * (to - from) * ((to * to + to * from + from * from) / 3 + s->c * (to + from));
}

double sag_hyperboloid2_volume(const sag_hyperboloid2 *s) {
    if (!s->closed || !is_usable(s)) return 0;
    return sheet_volume(s, upper(s), 1) + sheet_volume(s, lower(s), -1);
}
