// SPDX-License-Identifier: MIT
// How far a shape reaches in a direction n: the largest n·p of its points p (its support function). The box
// of a turned shape follows from that, along axis i with n the i-th row of the map, and is mostly a good deal
// smaller than the box of its turned box. A disk of radius r about the z axis at height z reaches r s + z n.z
// with s = √(n.x² + n.y²), and so
//
//     cylinder, cone, hyperboloid   the farther of their two ends: none bulges beyond the hull of these
//     paraboloid                    ρ = R w, z = Z w² (w from w₀ to 1): R s w + n.z Z w², a parabola in w
//     ellipsoid, torus              c·n + √Σ(rᵢnᵢ)²;  R s + r |n|
//
// Each value has a handful of roundings, relative to the sizes summed up beside it.
#include "shapes/reach.h"
#include "shapes/common.h"

static double greater(double a, double b) { return a > b ? a : b; }

static double disk(double radius, double z, double s, double up) { return radius * s + z * up; }

static double paraboloid(const sag_paraboloid *p, double s, double up) {
    const double slope = p->radius * s, bend = up * p->z_max;
    double least = sqrt(p->z_min / p->z_max), w = 1;
    if (bend < 0 && slope < -2 * bend) w = greater(slope / (-2 * bend), least);
    return slope * w + bend * w * w;
}

bool sagi_shape_reach(sag_shape_kind kind, const void *shape, sag_vec3 n, double *reach) {
    const double s = sqrt(n.x * n.x + n.y * n.y), up = n.z;
    if (kind == SAG_SHAPE_CYLINDER) {
        const sag_cylinder *c = shape;
        *reach = greater(disk(c->radius, c->z_min, s, up), disk(c->radius, c->z_max, s, up));
    } else if (kind == SAG_SHAPE_CONE) {
        const sag_cone *c = shape;
        *reach = greater(disk(c->radius, 0, s, up), c->height * up);
    } else if (kind == SAG_SHAPE_PARABOLOID) {
        *reach = paraboloid(shape, s, up);
    } else if (kind == SAG_SHAPE_HYPERBOLOID) {
        const sag_hyperboloid *h = shape;
        const double r1 = sqrt(h->p1.x * h->p1.x + h->p1.y * h->p1.y),
                     r2 = sqrt(h->p2.x * h->p2.x + h->p2.y * h->p2.y);
        *reach = greater(disk(r1, h->p1.z, s, up), disk(r2, h->p2.z, s, up));
    } else if (kind == SAG_SHAPE_ELLIPSOID) {
        const sag_ellipsoid *e = shape;
        *reach = sag_dot(e->center, n) + sag_length(sag_mul(e->radii, n));
    } else if (kind == SAG_SHAPE_TORUS) {
        const sag_torus *t = shape;
        *reach = t->major_radius * s + t->minor_radius * sag_length(n);
    } else {
        return false;
    }
    return true;
}

sag_box3 sagi_shape_turned_box(sag_shape_kind kind, const void *shape, const sag_box3 *own,
                               const sag_affine *map) {
    const sag_box3 turned = sag_affine_box(map, own);
    double low[3] = {turned.min.x, turned.min.y, turned.min.z},
           high[3] = {turned.max.x, turned.max.y, turned.max.z};
    const sag_vec3 a = sag_abs(own->min), b = sag_abs(own->max);
    const sag_vec3 size = {greater(a.x, b.x), greater(a.y, b.y), greater(a.z, b.z)};
    for (int i = 0; i < 3; i++) {
        const double *row = map->m[i];
        const sag_vec3 n = {row[0], row[1], row[2]};
        double up, down;
        if (!sagi_shape_reach(kind, shape, n, &up) || !sagi_shape_reach(kind, shape, sag_neg(n), &down))
            return turned;
        const double magnitude =
            fabs(row[3]) + sag_dot(sag_abs(n), size) + sag_max_component(size) * sag_length(n);
        // Products of which bits could be lost to underflow, or that overflow, are left to the other box.
        if (!(magnitude > 0x1p-400 && magnitude < 0x1p400) || !(sag_dot(n, n) > 0x1p-400)) continue;
        const double doubt = 0x1p-47 * magnitude;
        if (row[3] - down - doubt > low[i]) low[i] = row[3] - down - doubt;
        if (row[3] + up + doubt < high[i]) high[i] = row[3] + up + doubt;
    }
    return (sag_box3){{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}
