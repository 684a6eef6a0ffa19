// SPDX-License-Identifier: MIT
// The cone: base of the given radius at z = 0, apex at z = height. With ζ = z − height,
//
//     F = height² (x² + y²) − radius² ζ².
//
// {F ≤ 0} has two nappes, ζ ≤ 0 and ζ ≥ 0, that touch in the apex; the shape is on the first. Which nappe a
// span of the ray is in needs no comparison with the apex, where rounding could let a bit of the other nappe
// through. A span between two roots crosses no apex plane but in the apex itself, so its middle tells. A span
// without end goes up or down with the sign of d.z.
#include "math/elementary.h"
#include "shapes/axial.h"
#include "shapes/outline.h"

static bool is_usable(const sag_cone *c) { return sag_cone_validate(c, NULL) == SAG_OK; }

static void exact(const void *shape, sagi_quadric_exact *q) {
    const double *size = shape; // radius, height
    sagi_real hh = sagi_real_scale(sagi_real_from(size[1]), size[1]);
    sagi_real rr = sagi_real_scale(sagi_real_from(size[0]), -size[0]);
    *q = (sagi_quadric_exact){.square = {hh, hh, rr}};
}

// `size` gets the scaled radius and height and is what the form refers to.
static sagi_quadric_form form_of(const sag_cone *c, double size[2]) {
    int exponent = sagi_size_exponent(fmax(c->radius, c->height));
    size[0] = exponent == 0 ? c->radius : ldexp(c->radius, -exponent);
    size[1] = exponent == 0 ? c->height : ldexp(c->height, -exponent);
    sagi_dd hh = sagi_two_prod(size[1], size[1]);
    return (sagi_quadric_form){
        .square = {hh, hh, sagi_dd_neg(sagi_two_prod(size[0], size[0]))},
        .center = {0, 0, c->height},
        .exponent = exponent,
        .exact = exact,
        .shape = size,
    };
}

sag_status sag_cone_validate(const sag_cone *c, sag_error *error) {
    sag_status status = sagi_check_positive(error, "cone", "radius", c->radius);
    if (status == SAG_OK) status = sagi_check_positive(error, "cone", "height", c->height);
    if (status == SAG_OK) status = sagi_sweep_validate(error, "cone", c->phi_max_rad);
    if (status == SAG_OK) status = sagi_check_closed(error, "cone", c->closed, c->phi_max_rad);
    return status;
}

sag_box3 sag_cone_bounds(const sag_cone *c) {
    if (!is_usable(c)) return sag_box3_empty();
    return sagi_box3_round_out(sagi_sweep_bounds(c->phi_max_rad, c->radius, 0, c->height), 4);
}

// Whether a span is in the nappe below the apex.
static bool is_below(const sag_cone *c, const sag_ray *ray, double enter, double leave) {
    double up = ray->direction.z;
    if (leave == INFINITY) return up < 0;
    if (enter == -INFINITY) return up > 0;
    return sagi_ray_coordinate(ray->origin.z, c->height, enter * 0.5 + leave * 0.5, up).hi <= 0;
}

// A span without ends is one whose ends the solver did not look for as they are behind the ray, or a ray that
// runs in the surface itself, through the apex. There the nappe ends.
static void end_at_apex(const sag_cone *c, const sag_ray *ray, double *enter, double *leave) {
    if (*enter != -INFINITY || *leave != INFINITY || ray->direction.z == 0) return;
    double t = (c->height - ray->origin.z) / ray->direction.z;
    *(ray->direction.z < 0 ? enter : leave) = t;
}

static void collect(const sag_cone *c, const sag_ray *ray, sagi_crossings *list) {
    list->count = 0;
    if (!sag_ray_is_valid(ray) || !is_usable(c)) return;
    double size[2];
    sagi_quadric_form form = form_of(c, size);
    sagi_spans all = sagi_quadric_spans(&form, ray), below = {0};
    for (int i = 0; i < all.count; i++) {
        end_at_apex(c, ray, &all.enter[i], &all.leave[i]);
        if (!is_below(c, ray, all.enter[i], all.leave[i])) continue;
        below.enter[below.count] = all.enter[i];
        below.leave[below.count++] = all.leave[i];
    }
    sagi_axial_collect(&below, 0, INFINITY, c->closed, ray, list);
    if (!c->closed) sagi_axial_sweep(c->phi_max_rad, ray, list);
}

bool sagi_cone_outline(const sag_cone *c, sagi_outline *p) {
    if (!c->closed || !is_usable(c)) return false;
    double size[2];
    const sagi_quadric_form form = form_of(c, size);
    if (!sagi_outline_make(&form, 0, INFINITY, p)) return false;
    p->below = true;
    return true;
}

bool sag_cone_hit(const sag_cone *c, const sag_ray *ray, sag_hit *hit) {
    sagi_crossings list;
    collect(c, ray, &list);
    return sagi_crossings_first(&list, hit);
}

bool sag_cone_occluded(const sag_cone *c, const sag_ray *ray) {
    sagi_crossings list;
    collect(c, ray, &list);
    return list.count > 0;
}

size_t sag_cone_crossings(const sag_cone *c, const sag_ray *ray, sag_hit *hits, size_t capacity) {
    sagi_crossings list;
    collect(c, ray, &list);
    return sagi_crossings_write(&list, hits, capacity);
}

// The normal's z is positive everywhere; but the gradient vanishes in the apex and is turned around above it,
// where rounding may put a point.
static void face_up(sag_surface *surface) {
    sag_vec3 *n = &surface->geometric_normal;
    if (n->z == 0) *n = sag_vec3_make(0, 0, 1);
    n->z = fabs(n->z);
}

// The lines from the base to the apex are the v lines: dp/dv points along one, height up and inward by
// radius.
static void texture(const sag_cone *c, sag_surface *surface) {
    sag_vec3 p = surface->position;
    double sweep = sagi_sweep_end(c->phi_max_rad), rho = sagi_hypot(p.x, p.y);
    surface->u = sagi_sweep_angle(p.x, p.y) / sweep;
    surface->v = p.z / c->height;
    surface->dpdu = sag_vec3_make(-sweep * p.y, sweep * p.x, 0);
    surface->dpdv = sag_vec3_make(-c->radius * (p.x / rho), -c->radius * (p.y / rho), c->height);
}

void sag_cone_surface(const sag_cone *c, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    double size[2];
    sagi_quadric_form form = form_of(c, size);
    if (hit->primitive == SAGI_CAP_LOW)
        sagi_cap_surface(0, c->radius, -1, ray, hit->t, surface);
    else {
        sagi_quadric_place_hit(&form, ray, hit->t, surface);
        sagi_axial_clamp(&form, 0, c->height, surface);
        face_up(surface);
        texture(c, surface);
    }
    sagi_surface_finish(surface, ray, hit);
}

static double side_area(const sag_cone *c) {
    return sagi_sweep_end(c->phi_max_rad) / 2 * c->radius * sagi_hypot(c->radius, c->height);
}

static double cap_area(const sag_cone *c) { return c->closed ? SAGI_PI * c->radius * c->radius : 0; }

double sag_cone_area(const sag_cone *c) { return is_usable(c) ? side_area(c) + cap_area(c) : 0; }

// The area from the apex down grows with the square of the distance.
bool sag_cone_sample(const sag_cone *c, sag_vec2 random, sag_surface *surface) {
    double area = sag_cone_area(c);
    if (!(area > 0 && isfinite(area))) return false;
    bool side = sagi_choose(&random.x, side_area(c) / area);
    if (side) {
        double size[2], down = sqrt(random.x), phi = sagi_sweep_end(c->phi_max_rad) * random.y;
        double rho = c->radius * down;
        sagi_quadric_form form = form_of(c, size);
        sag_vec3 p = {rho * sagi_cos(phi), rho * sagi_sin(phi), c->height - c->height * down};
        sagi_quadric_place_point(&form, p, surface);
        face_up(surface);
        texture(c, surface);
    } else {
        sagi_cap_sample(0, c->radius, -1, random, surface);
    }
    sagi_surface_finish_sample(surface, side ? SAGI_CURVED : SAGI_CAP_LOW);
    return true;
}

bool sag_cone_contains(const sag_cone *c, sag_vec3 point) {
    if (!c->closed || !is_usable(c) || !sag_is_finite(point)) return false;
    double size[2];
    sagi_quadric_form form = form_of(c, size);
    return point.z >= 0 && point.z <= c->height && sagi_quadric_sign(&form, point) <= 0;
}

double sag_cone_volume(const sag_cone *c) { return is_usable(c) ? cap_area(c) * c->height / 3 : 0; }

sag_vec3 sag_cone_closest_point(const sag_cone *c, sag_vec3 point) {
    sag_vec3 side = sagi_axial_closest(c->radius, 0, 0, c->height, c->phi_max_rad, point);
    if (!c->closed) return side;
    return sagi_nearer(point, side, sagi_axial_closest(0, 0, c->radius, 0, 0, point));
}
