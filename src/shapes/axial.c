// SPDX-License-Identifier: MIT
// What the shapes that stand on the z axis share. The solid is the set {F ≤ 0} between two planes, so the
// part of a ray inside it is the intersection of intervals of t: the spans of {F ≤ 0} with the span between
// the planes. Whatever the rounding, an intersection of intervals has two ends or none: a ray through the rim
// enters as often as it leaves. An open surface keeps the ends that are roots, by the same comparisons, so an
// open and a closed shape agree on where the rim is: where the root and the plane's t, each within 2 ulp,
// cross over.
#include "shapes/axial.h"
#include "math/elementary.h"

static void add(sagi_crossings *list, const sag_ray *ray, double t, uint32_t primitive) {
    if (isfinite(t) && sagi_in_range(ray, t)) sagi_crossings_add(list, t, 0, 0, primitive);
}

void sagi_axial_collect(const sagi_spans *spans, double z_min, double z_max, bool closed, const sag_ray *ray,
                        sagi_crossings *list) {
    if (spans->count == 0) return;
    const sagi_axial_cut c = sagi_cut_slab(z_min, z_max, ray->origin.z, ray->direction.z);
    for (int i = 0; i < spans->count; i++) {
        double enter = spans->enter[i], leave = spans->leave[i];
        if (closed) {
            bool capped_in = c.enter > enter, capped_out = c.leave < leave;
            double in = capped_in ? c.enter : enter, out = capped_out ? c.leave : leave;
            if (!(in <= out)) continue;
            add(list, ray, in, capped_in ? c.enter_cap : SAGI_CURVED);
            add(list, ray, out, capped_out ? c.leave_cap : SAGI_CURVED);
        } else {
            if (enter >= c.enter && enter <= c.leave) add(list, ray, enter, SAGI_CURVED);
            if (leave >= c.enter && leave <= c.leave) add(list, ray, leave, SAGI_CURVED);
        }
    }
}

void sagi_axial_sweep(double phi_max_rad, const sag_ray *ray, sagi_crossings *list) {
    if (sagi_sweep_is_full(phi_max_rad)) return;
    int kept = 0;
    for (int i = 0; i < list->count; i++)
        if (sagi_sweep_holds(phi_max_rad, sag_vec3_make(0, 0, 0), ray, list->at[i].t))
            list->at[kept++] = list->at[i];
    list->count = kept;
}

void sagi_axial_clamp(const sagi_quadric_form *form, double z_min, double z_max, sag_surface *surface) {
    sag_vec3 *p = &surface->position;
    double z = p->z < z_min ? z_min : p->z > z_max ? z_max : p->z, rho = sagi_hypot(p->x, p->y);
    if (z == p->z) return;
    p->z = z;
    if (!(rho > 0)) return;
    // F = s ρ² + (what z makes of it).
    double h = ldexp(z - form->center.z, -form->exponent);
    double rest = (form->square[2].hi * h + 2 * form->linear[2].hi) * h + form->constant.hi;
    double scale = ldexp(sqrt(fmax(0, -rest / form->square[0].hi)), form->exponent) / rho;
    p->x *= scale, p->y *= scale;
}

void sagi_cap_place(double z, double radius, double up, double x, double y, sag_surface *surface) {
    double rho = sagi_hypot(x, y), blur = 4 * SAGI_EPSILON;
    surface->position = sag_vec3_make(x, y, z);
    // z is exact; its error only lets a spawned ray start clear of underflow where z is 0.
    surface->position_error =
        sag_vec3_make(blur * fabs(x), blur * fabs(y), SAGI_EPSILON * (radius + fabs(z)));
    surface->geometric_normal = sag_vec3_make(0, 0, up);
    surface->u = sagi_sweep_angle(x, y) / SAGI_TWO_PI;
    surface->v = radius > 0 ? 1 - rho / radius : 0; // a hyperboloid may end in a point on the axis
    surface->dpdu = sag_vec3_make(-SAGI_TWO_PI * y, SAGI_TWO_PI * x, 0);
    surface->dpdv = sag_vec3_make(-radius * (x / rho), -radius * (y / rho), 0);
}

void sagi_cap_surface(double z, double radius, double up, const sag_ray *ray, double t,
                      sag_surface *surface) {
    sagi_cap_place(z, radius, up, sagi_ray_coordinate(ray->origin.x, 0, t, ray->direction.x).hi,
                   sagi_ray_coordinate(ray->origin.y, 0, t, ray->direction.y).hi, surface);
}

void sagi_cap_sample(double z, double radius, double up, sag_vec2 random, sag_surface *surface) {
    double rho = radius * sqrt(random.x), phi = SAGI_TWO_PI * random.y;
    sagi_cap_place(z, radius, up, rho * sagi_cos(phi), rho * sagi_sin(phi), surface);
}

bool sagi_choose(double *random, double fraction) {
    bool chosen = *random < fraction;
    *random = chosen ? *random / fraction : (*random - fraction) / (1 - fraction);
    if (!(*random < 1)) *random = 1 - SAGI_EPSILON;
    return chosen;
}

// At the angle Δ from the point's own, the distance² to (R, z) is (R − ρ cos Δ)² + (ρ sin Δ)² + (z − pz)²:
// the nearest angle of the sweep first, then the nearest point of the segment to (ρ cos Δ, pz).
sag_vec3 sagi_axial_closest(double rho0, double z0, double rho1, double z1, double phi_max_rad,
                            sag_vec3 point) {
    double end = sagi_sweep_end(phi_max_rad), own = sagi_sweep_angle(point.x, point.y);
    double rho = sagi_hypot(point.x, point.y), phi = own, x = rho;
    if (own > end) {
        double past = own - end, before = SAGI_TWO_PI - own;
        phi = past < before ? end : 0;
        x = rho * sagi_cos(fmin(past, before));
    }
    double dr = rho1 - rho0, dz = z1 - z0;
    double s = ((x - rho0) * dr + (point.z - z0) * dz) / (dr * dr + dz * dz);
    s = s > 0 ? fmin(s, 1) : 0;
    double r = s == 1 ? rho1 : rho0 + s * dr, z = s == 1 ? z1 : z0 + s * dz;
    if (own <= end && rho > 0) return sag_vec3_make(r * (point.x / rho), r * (point.y / rho), z);
    return sag_vec3_make(r * sagi_cos(phi), r * sagi_sin(phi), z);
}

sag_vec3 sagi_nearer(sag_vec3 point, sag_vec3 a, sag_vec3 b) {
    sag_vec3 pa = sag_sub(a, point), pb = sag_sub(b, point);
    return sag_dot(pb, pb) < sag_dot(pa, pa) ? b : a;
}
