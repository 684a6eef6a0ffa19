// SPDX-License-Identifier: MIT
// The ring: a level segment swept around z. In plan the segment is w + r e, |r| running between the ends, w ⊥
// e the point of its line nearest to the axis: at the radius ρ it is where r = ±√(ρ² − w²). Where the segment
// passes w, the two sides sweep the same part of the plane; it counts as one surface there, and the place
// nearer to p₁ that is in the sweep gives u and v. The normal is +z.
#include "math/elementary.h"
#include "shapes/hyperboloid.h"

// s along the segment = at + r·per, r the signed distance from the line's foot; foot2 = w².
typedef struct plan {
    double at, per, foot2;
} plan;

static plan plan_of(const sag_hyperboloid *h) {
    double dx = h->p2.x - h->p1.x, dy = h->p2.y - h->p1.y, length = sagi_hypot(dx, dy);
    double ex = dx / length, ey = dy / length, off = h->p1.x * ey - h->p1.y * ex;
    return (plan){-(h->p1.x * ex + h->p1.y * ey) / length, 1 / length, off * off};
}

// The place along the segment of the point (x, y) of the plane; −1 when it is not in the swept part.
static double place_of(const sag_hyperboloid *h, double x, double y) {
    plan p = plan_of(h);
    double rho1 = sagi_hypot(h->p1.x, h->p1.y), rho2 = sagi_hypot(h->p2.x, h->p2.y), rho = sagi_hypot(x, y);
    double r = sqrt(fmax(0, rho * rho - p.foot2)), end = sagi_sweep_end(h->phi_max_rad);
    bool passes_foot = p.at > 0 && p.at < 1;
    if (!(rho <= fmax(rho1, rho2)) || (passes_foot ? rho * rho < p.foot2 : rho < fmin(rho1, rho2))) return -1;
    double sides[2] = {p.at - r * p.per, p.at + r * p.per};
    for (int i = 0; i < 2; i++) {
        // The end that rho is certain to be between may be missed by a rounding.
        double s = fmin(fmax(sides[i], 0), 1);
        if (!(fabs(s - sides[i]) <= 0x1p-40)) continue;
        if (sagi_hyperboloid_angle(h, s, x, y) <= end) return s;
    }
    return -1;
}

void sagi_ring_collect(const sag_hyperboloid *h, const sag_ray *ray, sagi_crossings *list) {
    if (ray->direction.z == 0) return;
    double t = (h->p1.z - ray->origin.z) / ray->direction.z;
    if (!isfinite(t) || !sagi_in_range(ray, t)) return;
    double x = sagi_ray_coordinate(ray->origin.x, 0, t, ray->direction.x).hi;
    double y = sagi_ray_coordinate(ray->origin.y, 0, t, ray->direction.y).hi;
    if (place_of(h, x, y) >= 0) sagi_crossings_add(list, t, 0, 0, SAGI_CURVED);
}

void sagi_ring_place(const sag_hyperboloid *h, sag_vec3 point, sag_surface *surface) {
    double reach = fabs(point.x) + fabs(point.y) + fabs(h->p1.z), blur = 4 * SAGI_EPSILON;
    surface->position = sag_vec3_make(point.x, point.y, h->p1.z);
    surface->position_error = sag_vec3_make(blur * fabs(point.x), blur * fabs(point.y), SAGI_EPSILON * reach);
    surface->geometric_normal = sag_vec3_make(0, 0, 1);
}

void sagi_ring_surface(const sag_hyperboloid *h, const sag_ray *ray, const sag_hit *hit,
                       sag_surface *surface) {
    double x = sagi_ray_coordinate(ray->origin.x, 0, hit->t, ray->direction.x).hi;
    double y = sagi_ray_coordinate(ray->origin.y, 0, hit->t, ray->direction.y).hi;
    sagi_ring_place(h, sag_vec3_make(x, y, h->p1.z), surface);
    sagi_hyperboloid_texture(h, fmax(place_of(h, x, y), 0), surface);
}

// The part of [0, 1] that is swept once, from s0 to s1: all of it, or where the foot is passed its longer
// side.
static void swept_part(const sag_hyperboloid *h, const plan *p, double *s0, double *s1) {
    *s0 = 0, *s1 = 1;
    if (!(p->at > 0 && p->at < 1)) return;
    if (sagi_hypot(h->p1.x, h->p1.y) > sagi_hypot(h->p2.x, h->p2.y))
        *s1 = p->at;
    else
        *s0 = p->at;
}

// ρ dρ = r dr.
double sagi_ring_area(const sag_hyperboloid *h) {
    plan p = plan_of(h);
    double s0, s1;
    swept_part(h, &p, &s0, &s1);
    double r0 = (s0 - p.at) / p.per, r1 = (s1 - p.at) / p.per;
    return sagi_sweep_end(h->phi_max_rad) / 2 * fabs(r1 - r0) * fabs(r1 + r0);
}

double sagi_ring_invert(const sag_hyperboloid *h, double fraction) {
    plan p = plan_of(h);
    double s0, s1;
    swept_part(h, &p, &s0, &s1);
    double r0 = (s0 - p.at) / p.per, r1 = (s1 - p.at) / p.per;
    double r = sqrt(fmax(0, r0 * r0 + fraction * (r1 - r0) * (r1 + r0)));
    return fmin(fmax(p.at + copysign(r, r0 + r1) * p.per, 0), 1);
}
