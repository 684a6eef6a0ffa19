// SPDX-License-Identifier: MIT
// Closed forms: which shapes have an inside, and the moments of those that do.
//
// An ellipsoid is the image of the unit ball, where ∫ xᵢ xⱼ dV = V/5 δᵢⱼ, under x ↦ B u: its second moments
// are C = V/5 · B Bᵀ. Likewise a parallelepiped of half axes H is that of the cube [−1, 1]³: C = V/3 · H Hᵀ.
//
// A quadric xᵀA x + 2 b·x + j = 0 with a definite A is the ellipsoid with centre x₀ = −A⁻¹b and
// B Bᵀ = k A⁻¹, k = −(x₀ᵀA x₀ + 2 b·x₀ + j): V = 4π/3 √(k³/det A), and √(k (A⁻¹)ᵢᵢ) is how far it reaches
// along axis i.
//
// A capsule of length L and radius r along z is a cylinder (V₁ = πr²L; z: L²/12, x: r²/4) and two halves of a
// ball (together V₂ = 4πr³/3), each with ∫z² about its flat side r²/5 and its centre of mass 3r/8 from there:
// moved out by L/2, z: r²/5 + 2 (3r/8)(L/2) + L²/4; x: r²/5.
//
// A polyhedron is cut in tetrahedra from a point near it to triangles of its faces; each adds its part with
// the sign of its orientation (mesh_moments.c has the formula).
#include "measure/measure.h"
#include "shapes/closed.h"
#include "shapes/polyhedron_face.h"
#include "shapes/shape.h"
#include "shapes/sweep.h"

// ---- which are closed

// The ellipsoid of a quadric: A⁻¹, the centre and k. False: it is none.
static bool ellipsoid_of(const sag_quadric *q, double inverse[3][3], sag_vec3 *center, double *level,
                         double *determinant) {
    const double *c = q->coefficients;
    const double sign = c[0] < 0 ? -1 : 1; // a negative definite A is the same surface
    const sag_affine a = {{{sign * c[0], sign * c[3], sign * c[4], 0},
                           {sign * c[3], sign * c[1], sign * c[5], 0},
                           {sign * c[4], sign * c[5], sign * c[2], 0}}};
    sag_affine back;
    const double minor = a.m[0][0] * a.m[1][1] - a.m[0][1] * a.m[1][0];
    *determinant = sag_affine_determinant(&a);
    // Sylvester's criterion.
    if (!(a.m[0][0] > 0 && minor > 0 && *determinant > 0) || !sag_affine_inverse(&a, &back)) return false;
    const sag_vec3 b = sag_vec3_make(sign * c[6], sign * c[7], sign * c[8]);
    *center = sag_neg(sag_affine_vector(&back, b));
    const sag_vec3 image = sag_affine_vector(&a, *center);
    *level = -(sag_dot(*center, image) + 2 * sag_dot(b, *center) + sign * c[9]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inverse[i][j] = back.m[i][j];
    return *level > 0 && isfinite(*level);
}

sag_body_state sagi_shape_state(sag_shape_kind kind, const void *shape) {
    if (kind == SAG_SHAPE_PLANE) return SAG_BODY_UNBOUNDED;
    if (kind == SAG_SHAPE_SPHERES) return SAG_BODY_CLOSED; // one body, of all of them
    if (kind == SAG_SHAPE_MESH || kind == SAG_SHAPE_INSTANCE) return SAG_BODY_OPEN;
    if (sagi_shape_flaw(kind, shape) != NULL) return SAG_BODY_OPEN;
    const sag_box3 box = sagi_shape_classes[kind].bounds(shape);
    return sag_is_finite(box.min) && sag_is_finite(box.max) ? SAG_BODY_CLOSED : SAG_BODY_UNBOUNDED;
}

// ---- moments

// A body whose C is `factor` times V times B Bᵀ, B's columns being the three vectors.
static sagi_moments from_axes(double volume, sag_vec3 center, double factor, const sag_vec3 axes[3]) {
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    sagi_moments m = {.volume = volume, .center = center};
    for (int k = 0; k < 6; k++) {
        double sum = 0;
        for (int i = 0; i < 3; i++) sum += sag_component(axes[i], row[k]) * sag_component(axes[i], column[k]);
        m.central[k] = factor * volume * sum;
    }
    return m;
}

static sagi_moments from_radii(double volume, sag_vec3 center, double factor, sag_vec3 radii) {
    const sag_vec3 axes[3] = {{radii.x, 0, 0}, {0, radii.y, 0}, {0, 0, radii.z}};
    return from_axes(volume, center, factor, axes);
}

static sagi_moments of_quadric(const sag_quadric *q) {
    double inverse[3][3], level, determinant;
    sag_vec3 center;
    if (!ellipsoid_of(q, inverse, &center, &level, &determinant)) return (sagi_moments){0};
    const double volume = 4 * SAGI_PI / 3 * level * sqrt(level / determinant), f = volume / 5 * level;
    return (sagi_moments){volume,
                          center,
                          {f * inverse[0][0], f * inverse[1][1], f * inverse[2][2], f * inverse[0][1],
                           f * inverse[0][2], f * inverse[1][2]}};
}

static sagi_moments of_capsule(const sag_capsule *c) {
    const sag_vec3 along = sag_sub(c->p1, c->p0);
    const double r = c->radius, length = sag_length(along);
    const double tube = SAGI_PI * r * r * length, ball = 4 * SAGI_PI / 3 * r * r * r;
    const double across = tube * r * r / 4 + ball * r * r / 5;
    const double lengthwise =
        tube * length * length / 12 + ball * (r * r / 5 + 3 * r * length / 8 + length * length / 4);
    sagi_moments m = {.volume = tube + ball, .central = {across, across, lengthwise}};
    sag_affine place = sag_affine_along(c->p0, c->p1);
    const sag_vec3 middle = sag_madd(c->p0, 0.5, along);
    if (!(length > 0)) place = sag_affine_identity();
    place.m[0][3] = middle.x, place.m[1][3] = middle.y, place.m[2][3] = middle.z;
    return sagi_moments_map(&m, &place);
}

static void add_tetrahedron(sagi_raw_moments *raw, sag_vec3 a, sag_vec3 b, sag_vec3 c) {
    const double six = fabs(sag_dot(a, sag_cross(b, c)));
    const double p[4][3] = {{a.x, a.y, a.z},
                            {b.x, b.y, b.z},
                            {c.x, c.y, c.z},
                            {a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z}};
    static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    raw->m[0] += six / 6;
    for (int i = 0; i < 3; i++) raw->m[1 + i] += six / 24 * p[3][i];
    for (int k = 0; k < 6; k++) {
        double sum = 0;
        for (int i = 0; i < 4; i++) sum += p[i][row[k]] * p[i][column[k]];
        raw->m[4 + k] += six / 120 * sum;
    }
}

// From one corner of the solid: it is convex, so every tetrahedron counts as positive.
static sagi_moments of_polyhedron(const sag_polyhedron *polyhedron) {
    sagi_raw_moments raw = {{0}};
    sag_vec3 apex = {0, 0, 0};
    bool has_apex = false;
    sagi_polyhedron_face face;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        sagi_polyhedron_face_find(polyhedron, i, &face);
        if (face.count < 3) continue;
        if (!has_apex) apex = face.vertices[0], has_apex = true;
        const sag_vec3 first = sag_sub(face.vertices[0], apex);
        for (int k = 1; k + 1 < face.count; k++)
            add_tetrahedron(&raw, first, sag_sub(face.vertices[k], apex),
                            sag_sub(face.vertices[k + 1], apex));
    }
    return sagi_moments_from_raw(&raw, apex);
}

// ρ² of the segment p1 p2 that turns about z, at the height z: of the point of the segment there.
static sagi_moments of_hyperboloid(const sag_hyperboloid *h) {
    const sag_vec3 low = h->p1.z < h->p2.z ? h->p1 : h->p2, high = h->p1.z < h->p2.z ? h->p2 : h->p1;
    double square[3];
    for (int i = 0; i < 3; i++) {
        const double s = 0.5 + 0.5 * sagi_revolution_nodes[i];
        const double x = (1 - s) * low.x + s * high.x, y = (1 - s) * low.y + s * high.y;
        square[i] = x * x + y * y;
    }
    return sagi_revolution_moments(low.z, high.z, square);
}

// One sheet, ρ² = a² (z/c − 1)(z/c + 1), between two heights that are both ≥ c or both ≤ −c.
static sagi_moments of_sheet(const sag_hyperboloid2 *h, double low, double high) {
    double square[3];
    for (int i = 0; i < 3; i++) {
        const double z = low + (0.5 + 0.5 * sagi_revolution_nodes[i]) * (high - low);
        square[i] = h->a * h->a * ((z - h->c) / h->c) * ((z + h->c) / h->c);
    }
    return sagi_revolution_moments(low, high, square);
}

static sagi_moments of_hyperboloid2(const sag_hyperboloid2 *h) {
    sagi_moments sum = {0};
    const double low = fmax(h->z_min, h->c), high = fmin(h->z_max, -h->c);
    if (h->z_max > low) sum = of_sheet(h, low, h->z_max);
    if (!(h->z_min < high)) return sum;
    const sagi_moments lower = of_sheet(h, h->z_min, high);
    return sum.volume > 0 ? sagi_revolution_sum(&lower, &sum) : lower;
}

bool sagi_shape_moments(sag_shape_kind kind, const void *shape, sagi_moments *moments) {
    switch (kind) {
    case SAG_SHAPE_SPHERE: {
        const sag_sphere *s = shape;
        *moments =
            from_radii(sag_sphere_volume(s), s->center, 0.2, sag_vec3_make(s->radius, s->radius, s->radius));
        return true;
    }
    case SAG_SHAPE_ELLIPSOID: {
        const sag_ellipsoid *e = shape;
        *moments = from_radii(sag_ellipsoid_volume(e), e->center, 0.2, e->radii);
        return true;
    }
    case SAG_SHAPE_BOX: {
        const sag_box *b = shape;
        const sag_vec3 half = sag_sub(sag_scale(b->max, 0.5), sag_scale(b->min, 0.5));
        *moments = from_radii(8 * half.x * half.y * half.z, sag_add(b->min, half), 1 / 3.0, half);
        return true;
    }
    case SAG_SHAPE_ORIENTED_BOX: {
        const sag_oriented_box *b = shape;
        *moments = from_axes(sag_oriented_box_volume(b), b->center, 1 / 3.0, b->half_axes);
        return true;
    }
    case SAG_SHAPE_CYLINDER: {
        const sag_cylinder *c = shape;
        const double square = c->radius * c->radius;
        *moments = sagi_revolution_moments(c->z_min, c->z_max, (const double[3]){square, square, square});
        return true;
    }
    case SAG_SHAPE_CONE: {
        const sag_cone *c = shape;
        double square[3];
        for (int i = 0; i < 3; i++) {
            const double rho = c->radius * (0.5 - 0.5 * sagi_revolution_nodes[i]);
            square[i] = rho * rho;
        }
        *moments = sagi_revolution_moments(0, c->height, square);
        return true;
    }
    case SAG_SHAPE_PARABOLOID: {
        const sag_paraboloid *p = shape;
        double square[3];
        for (int i = 0; i < 3; i++) {
            const double z = p->z_min + (0.5 + 0.5 * sagi_revolution_nodes[i]) * (p->z_max - p->z_min);
            square[i] = p->radius * p->radius * (z / p->z_max);
        }
        *moments = sagi_revolution_moments(p->z_min, p->z_max, square);
        return true;
    }
    case SAG_SHAPE_HYPERBOLOID: *moments = of_hyperboloid(shape); return true;
    case SAG_SHAPE_HYPERBOLOID2: *moments = of_hyperboloid2(shape); return true;
    case SAG_SHAPE_QUADRIC: *moments = of_quadric(shape); return true;
    case SAG_SHAPE_POLYHEDRON: *moments = of_polyhedron(shape); return true;
    case SAG_SHAPE_CAPSULE: *moments = of_capsule(shape); return true;
    case SAG_SHAPE_TORUS: *moments = sagi_torus_moments(shape); return true;
    case SAG_SHAPE_PLANE:
    case SAG_SHAPE_DISK:
    case SAG_SHAPE_RECTANGLE:
    case SAG_SHAPE_POLYGON:
    case SAG_SHAPE_TRIANGLE:
    case SAG_SHAPE_BILINEAR_PATCH:
    case SAG_SHAPE_SPHERES:
    case SAG_SHAPE_MESH:
    case SAG_SHAPE_USER:
    case SAG_SHAPE_INSTANCE: return false;
    }
    return false;
}
