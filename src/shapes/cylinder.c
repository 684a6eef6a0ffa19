// SPDX-License-Identifier: MIT
// The cylinder F = x² + y² − r² between two planes. A ray parallel to the axis has no t² and no t in F: it is
// inside for all t or for none, and meets only the caps.
#include "math/elementary.h"
#include "shapes/axial.h"
#include "shapes/outline.h"

static bool is_usable(const sag_cylinder *c) { return sag_cylinder_validate(c, NULL) == SAG_OK; }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const double *radius = shape;
    *q = (sagi_quadric_exact){.square = {sagi_real_from(1), sagi_real_from(1)}};
    q->constant = sagi_real_scale(sagi_real_from(*radius), -*radius);
}

// `radius` gets the scaled radius and is what the form refers to.
static sagi_quadric_form form_of(const sag_cylinder *c, double *radius) {
    int exponent = sagi_size_exponent(c->radius);
    *radius = exponent == 0 ? c->radius : ldexp(c->radius, -exponent);
    return (sagi_quadric_form){
        .square = {{1, 0}, {1, 0}},
        .constant = sagi_dd_neg(sagi_two_prod(*radius, *radius)),
        .exponent = exponent,
        .exact = exact,
        .shape = radius,
    };
}

sag_status sag_cylinder_validate(const sag_cylinder *c, sag_error *error) {
    sag_status status = sagi_check_positive(error, "cylinder", "radius", c->radius);
    if (status == SAG_OK) status = sagi_check_interval(error, "cylinder", c->z_min, c->z_max);
    if (status == SAG_OK) status = sagi_sweep_validate(error, "cylinder", c->phi_max_rad);
    if (status == SAG_OK) status = sagi_check_closed(error, "cylinder", c->closed, c->phi_max_rad);
    return status;
}

sag_box3 sag_cylinder_bounds(const sag_cylinder *c) {
    if (!is_usable(c)) return sag_box3_empty();
    return sagi_box3_round_out(sagi_sweep_bounds(c->phi_max_rad, c->radius, c->z_min, c->z_max), 4);
}

static void collect(const sag_cylinder *c, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(c)) return;
    double radius;
    sagi_quadric_form form = form_of(c, &radius);
    sagi_spans spans = sagi_quadric_spans(&form, ray);
    sagi_axial_collect(&spans, c->z_min, c->z_max, c->closed, ray, list);
    if (!c->closed) sagi_axial_sweep(c->phi_max_rad, ray, list);
}

bool sagi_cylinder_outline(const sag_cylinder *c, sagi_outline *p) {
    if (!c->closed || !is_usable(c)) return false;
    double radius;
    const sagi_quadric_form form = form_of(c, &radius);
    return sagi_outline_make(&form, c->z_min, c->z_max, p);
}

bool sag_cylinder_hit(const sag_cylinder *c, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(c, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_cylinder_occluded(const sag_cylinder *c, const sag_ray *ray) {
    sagi_crossings list;
    collect(c, ray, &list);
    return list.count > 0;
}

size_t sag_cylinder_crossings(const sag_cylinder *c, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list;
    collect(c, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

static void texture(const sag_cylinder *c, sag_surface *surface) {
    sag_vec3 p = surface->position;
    double sweep = sagi_sweep_end(c->phi_max_rad), height = c->z_max - c->z_min;
    surface->u = sagi_sweep_angle(p.x, p.y) / sweep;
    surface->v = (p.z - c->z_min) / height;
    surface->dpdu = sag_vec3_make(-sweep * p.y, sweep * p.x, 0);
    surface->dpdv = sag_vec3_make(0, 0, height);
}

void sag_cylinder_surface(const sag_cylinder *c, const sag_ray *ray, const sag_hit *hit,
                          sag_surface *surface) {
    double radius;
    sagi_quadric_form form = form_of(c, &radius);
    if (hit->primitive == SAGI_CAP_LOW)
        sagi_cap_surface(c->z_min, c->radius, -1, ray, hit->t, surface);
    else if (hit->primitive == SAGI_CAP_HIGH)
        sagi_cap_surface(c->z_max, c->radius, 1, ray, hit->t, surface);
    else {
        sagi_quadric_place_hit(&form, ray, hit->t, surface);
        sagi_axial_clamp(&form, c->z_min, c->z_max, surface);
        texture(c, surface);
    }
    sagi_surface_finish(surface, ray, hit);
}

static double side_area(const sag_cylinder *c) {
    return sagi_sweep_end(c->phi_max_rad) * c->radius * (c->z_max - c->z_min);
}

static double cap_area(const sag_cylinder *c) { return c->closed ? SAGI_PI * c->radius * c->radius : 0; }

double sag_cylinder_area(const sag_cylinder *c) { return is_usable(c) ? side_area(c) + 2 * cap_area(c) : 0; }

bool sag_cylinder_sample(const sag_cylinder *c, sag_vec2 random, sag_surface *surface) {
    double area = sag_cylinder_area(c);
    if (!(area > 0 && isfinite(area))) return false;
    uint32_t primitive = SAGI_CURVED;
    if (sagi_choose(&random.x, side_area(c) / area)) {
        double radius, phi = sagi_sweep_end(c->phi_max_rad) * random.y;
        sagi_quadric_form form = form_of(c, &radius);
        double z = c->z_min + random.x * (c->z_max - c->z_min);
        sagi_quadric_place_point(
            &form, sag_vec3_make(c->radius * sagi_cos(phi), c->radius * sagi_sin(phi), z), surface);
        texture(c, surface);
    } else if (sagi_choose(&random.x, 0.5)) {
        sagi_cap_sample(c->z_min, c->radius, -1, random, surface);
        primitive = SAGI_CAP_LOW;
    } else {
        sagi_cap_sample(c->z_max, c->radius, 1, random, surface);
        primitive = SAGI_CAP_HIGH;
    }
    sagi_surface_finish_sample(surface, primitive);
    return true;
}

bool sag_cylinder_contains(const sag_cylinder *c, sag_vec3 point) {
    if (!c->closed || !is_usable(c) || !sag_is_finite(point)) return false;
    double radius;
    sagi_quadric_form form = form_of(c, &radius);
    return point.z >= c->z_min && point.z <= c->z_max && sagi_quadric_sign(&form, point) <= 0;
}

double sag_cylinder_volume(const sag_cylinder *c) {
    return is_usable(c) ? cap_area(c) * (c->z_max - c->z_min) : 0;
}

sag_vec3 sag_cylinder_closest_point(const sag_cylinder *c, sag_vec3 point) {
    sag_vec3 best = sagi_axial_closest(c->radius, c->z_min, c->radius, c->z_max, c->phi_max_rad, point);
    if (!c->closed) return best;
    best = sagi_nearer(point, best, sagi_axial_closest(0, c->z_min, c->radius, c->z_min, 0, point));
    return sagi_nearer(point, best, sagi_axial_closest(0, c->z_max, c->radius, c->z_max, 0, point));
}
