// SPDX-License-Identifier: MIT
// The equations of the closed shapes as they stand in the public headers, multiplied out so that every
// coefficient is a sum of products of the shape's own numbers and so exact in fractions.
#include "support/region.h"
#include <stdlib.h>

// q[i] of the rule += the product of the factors.
static void put_factors(rule *r, int i, const double *factors, size_t count) {
    mpq_t product, x;
    mpq_inits(product, x, NULL);
    mpq_set_ui(product, 1, 1);
    for (size_t k = 0; k < count; k++) mpq_set_d(x, factors[k]), mpq_mul(product, product, x);
    mpq_add(r->q[i], r->q[i], product);
    mpq_clears(product, x, NULL);
}
#define PUT(rule, i, ...)                                                                                    \
    put_factors(rule, i, (const double[]){__VA_ARGS__}, sizeof(const double[]){__VA_ARGS__} / sizeof(double))

typedef struct maker {
    shape_region *region;
    uint32_t count;
} maker;

static rule *next(maker *m, sag_vec3 center) {
    rule *r = &m->region->rules[m->count++];
    for (int i = 0; i < 10; i++) mpq_init(r->q[i]);
    r->center = center;
    m->region->clause_end[m->region->clause_count - 1] = m->count;
    return r;
}
static void next_clause(maker *m) { m->region->clause_end[m->region->clause_count++] = m->count; }

// factor·xᵢ ≤ bound, and such a pair.
static void half(maker *m, int axis, double factor, double bound) {
    rule *r = next(m, (sag_vec3){0, 0, 0});
    PUT(r, 6 + axis, factor, 0.5), PUT(r, 9, -bound);
}
static void slab(maker *m, int axis, double low, double high) {
    half(m, axis, -1, -low), half(m, axis, 1, high);
}
static void slabs(maker *m, sag_vec3 min, sag_vec3 max) {
    for (int i = 0; i < 3; i++) slab(m, i, sag_component(min, i), sag_component(max, i));
}

static void ball(maker *m, sag_vec3 center, double radius) {
    rule *r = next(m, center);
    for (int i = 0; i < 3; i++) PUT(r, i, 1);
    PUT(r, 9, -radius, radius);
}

// Σ (xᵢ/rᵢ)² ≤ 1, by the product of the r².
static void ellipsoid(maker *m, const sag_ellipsoid *e) {
    rule *r = next(m, e->center);
    const double a = e->radii.x, b = e->radii.y, c = e->radii.z;
    PUT(r, 0, b, c, b, c), PUT(r, 1, a, c, a, c), PUT(r, 2, a, b, a, b), PUT(r, 9, -a, b, c, a, b, c);
}

// |sᵢ| ≤ 1 where sᵢ det = x·(aⱼ × aₖ).
static void oriented_box(maker *m, const sag_oriented_box *box) {
    for (int k = 0; k < 6; k++) {
        const sag_vec3 *axes = box->half_axes;
        sag_vec3 own = axes[k / 2], u = axes[(k / 2 + 1) % 3], v = axes[(k / 2 + 2) % 3];
        rule *r = next(m, box->center);
        for (int i = 0; i < 3; i++) {
            int a = (i + 1) % 3, b = (i + 2) % 3;
            double ua = sag_component(u, a), ub = sag_component(u, b), va = sag_component(v, a),
                   vb = sag_component(v, b), s = k % 2 ? 0.5 : -0.5, o = sag_component(own, i);
            PUT(r, 6 + i, ua, vb, s), PUT(r, 6 + i, -ub, va, s);
            PUT(r, 9, ua, vb, o), PUT(r, 9, -ub, va, o);
        }
        if (mpq_sgn(r->q[9]) > 0) mpq_neg(r->q[9], r->q[9]);
    }
}

static void polyhedron(maker *m, const sag_polyhedron *p) {
    for (uint32_t i = 0; i < p->plane_count; i++) {
        rule *r = next(m, (sag_vec3){0, 0, 0});
        for (int k = 0; k < 3; k++) PUT(r, 6 + k, sag_component(p->planes[i].normal, k), 0.5);
        PUT(r, 9, -p->planes[i].offset);
    }
}

static void plane(maker *m, const sag_plane *p) {
    rule *r = next(m, p->point);
    for (int k = 0; k < 3; k++) PUT(r, 6 + k, sag_component(p->normal, k), 0.5);
}

// What all figures of rotation around z begin with: factor·(x² + y²).
static rule *round_rule(maker *m, double factor) {
    rule *r = next(m, (sag_vec3){0, 0, 0});
    PUT(r, 0, factor), PUT(r, 1, factor);
    return r;
}

// h²(x² + y²) ≤ r²(h − z)².
static void cone(maker *m, const sag_cone *c) {
    rule *r = next(m, (sag_vec3){0, 0, 0});
    PUT(r, 0, c->height, c->height), PUT(r, 1, c->height, c->height), PUT(r, 2, -c->radius, c->radius);
    PUT(r, 8, c->radius, c->radius, c->height), PUT(r, 9, -c->radius, c->radius, c->height, c->height);
    slab(m, 2, 0, c->height);
}

// The radius at z is |z (C − A) + (z₂ A − z₁ C)|/|z₂ − z₁| with A, C the ends' x y.
static void hyperboloid(maker *m, const sag_hyperboloid *h) {
    rule *r = next(m, (sag_vec3){0, 0, 0});
    const double z1 = h->p1.z, z2 = h->p2.z;
    for (int i = 0; i < 2; i++) {
        PUT(r, i, z2, z2), PUT(r, i, -2, z2, z1), PUT(r, i, z1, z1);
        const double a = sag_component(h->p1, i), c = sag_component(h->p2, i);
        PUT(r, 2, -c, c), PUT(r, 2, 2, a, c), PUT(r, 2, -a, a);
        PUT(r, 8, -c, z2, a), PUT(r, 8, c, z1, c), PUT(r, 8, a, z2, a), PUT(r, 8, -a, z1, c);
        PUT(r, 9, -z2, a, z2, a), PUT(r, 9, 2, z2, a, z1, c), PUT(r, 9, -z1, c, z1, c);
    }
    slab(m, 2, fmin(z1, z2), fmax(z1, z2));
}

// c²(x² + y²) − a² z² + a² c² ≤ 0.
static void hyperboloid2(maker *m, const sag_hyperboloid2 *h) {
    rule *r = next(m, (sag_vec3){0, 0, 0});
    PUT(r, 0, h->c, h->c), PUT(r, 1, h->c, h->c), PUT(r, 2, -h->a, h->a), PUT(r, 9, h->a, h->a, h->c, h->c);
    slab(m, 2, h->z_min, h->z_max);
}

// Two balls, and between them |w|²·D − (w·d)² ≤ r² D with d the axis, D = d·d, w from the first end.
static void capsule(maker *m, const sag_capsule *c) {
    ball(m, c->p0, c->radius), next_clause(m);
    ball(m, c->p1, c->radius);
    if (c->p0.x == c->p1.x && c->p0.y == c->p1.y && c->p0.z == c->p1.z) return;
    next_clause(m);
    rule *side = next(m, c->p0), *low = next(m, c->p0), *high = next(m, c->p0);
    for (int i = 0; i < 3; i++) {
        double a = sag_component(c->p0, i), b = sag_component(c->p1, i);
        PUT(low, 6 + i, a, 0.5), PUT(low, 6 + i, -b, 0.5);
        PUT(high, 6 + i, b, 0.5), PUT(high, 6 + i, -a, 0.5);
        PUT(high, 9, -b, b), PUT(high, 9, 2, a, b), PUT(high, 9, -a, a); // −D
        for (int k = 0; k < 3; k++) PUT(side, k, b, b), PUT(side, k, -2, a, b), PUT(side, k, a, a);
        for (int k = i; k < 3; k++) { // −(w·d)²
            double e = sag_component(c->p0, k), f = sag_component(c->p1, k);
            int at = k == i ? i : i + k + 2;
            PUT(side, at, -b, f), PUT(side, at, b, e), PUT(side, at, a, f), PUT(side, at, -a, e);
        }
        PUT(side, 9, -c->radius, c->radius, b, b), PUT(side, 9, 2, c->radius, c->radius, a, b);
        PUT(side, 9, -c->radius, c->radius, a, a);
    }
}

static void mesh(shape_region *out, const sag_mesh *m) {
    sag_box3 box = sag_box3_empty();
    out->mesh = m;
    for (uint32_t i = 0; i < m->vertex_count; i++)
        box = sag_box3_extend(box, m->positions_f64
                                       ? (sag_vec3){m->positions_f64[3 * i], m->positions_f64[3 * i + 1],
                                                    m->positions_f64[3 * i + 2]}
                                       : (sag_vec3){m->positions_f32[3 * i], m->positions_f32[3 * i + 1],
                                                    m->positions_f32[3 * i + 2]});
    out->mesh_center = sag_scale(sag_add(box.min, box.max), 0.5);
    out->mesh_size = sag_max_component(sag_sub(box.max, box.min));
}

static void put_shape(maker *m, sag_shape_kind kind, const void *shape) {
    const sag_vec3 zero = {0, 0, 0};
    if (kind == SAG_SHAPE_SPHERE) {
        const sag_sphere *s = shape;
        ball(m, s->center, s->radius);
    } else if (kind == SAG_SHAPE_ELLIPSOID) {
        ellipsoid(m, shape);
    } else if (kind == SAG_SHAPE_BOX) {
        const sag_box *b = shape;
        slabs(m, b->min, b->max);
    } else if (kind == SAG_SHAPE_ORIENTED_BOX) {
        oriented_box(m, shape);
    } else if (kind == SAG_SHAPE_POLYHEDRON) {
        polyhedron(m, shape);
    } else if (kind == SAG_SHAPE_PLANE) {
        plane(m, shape);
    } else if (kind == SAG_SHAPE_CYLINDER) {
        const sag_cylinder *c = shape;
        rule *r = round_rule(m, 1);
        PUT(r, 9, -c->radius, c->radius), slab(m, 2, c->z_min, c->z_max);
    } else if (kind == SAG_SHAPE_CONE) {
        cone(m, shape);
    } else if (kind == SAG_SHAPE_PARABOLOID) {
        const sag_paraboloid *p = shape;
        rule *r = round_rule(m, p->z_max);
        PUT(r, 8, -p->radius, p->radius, 0.5), slab(m, 2, p->z_min, p->z_max);
    } else if (kind == SAG_SHAPE_HYPERBOLOID) {
        hyperboloid(m, shape);
    } else if (kind == SAG_SHAPE_HYPERBOLOID2) {
        hyperboloid2(m, shape);
    } else if (kind == SAG_SHAPE_QUADRIC) {
        const sag_quadric *q = shape;
        rule *r = next(m, zero);
        for (int i = 0; i < 10; i++) put_factors(r, i, &q->coefficients[i], 1);
        slabs(m, q->clip.min, q->clip.max);
    } else if (kind == SAG_SHAPE_CAPSULE) {
        capsule(m, shape);
    }
}

void region_make(shape_region *region, sag_shape_kind kind, const void *shape) {
    *region = (shape_region){.clause_count = 1};
    region->faces_belong =
        kind == SAG_SHAPE_BOX || kind == SAG_SHAPE_ORIENTED_BOX || kind == SAG_SHAPE_POLYHEDRON;
    if (kind == SAG_SHAPE_TORUS) region->torus = shape;
    if (kind == SAG_SHAPE_MESH) mesh(region, shape);
    size_t room = kind == SAG_SHAPE_POLYHEDRON ? ((const sag_polyhedron *)shape)->plane_count : 8;
    region->rules = calloc(room, sizeof *region->rules);
    if (!region->rules) abort();
    maker m = {region, 0};
    put_shape(&m, kind, shape);
    for (uint32_t i = 0; i < m.count; i++)
        for (int k = 0; k < 10; k++) {
            rule *r = &region->rules[i];
            r->v[k] = mpq_get_d(r->q[k]);
            if (mpq_sgn(r->q[k])) r->used |= 1u << k;
        }
}

void region_clear(shape_region *region) {
    uint32_t count = region->clause_end[region->clause_count - 1];
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 10; k++) mpq_clear(region->rules[i].q[k]);
    free(region->rules);
    region->rules = NULL;
}
