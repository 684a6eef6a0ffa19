// SPDX-License-Identifier: MIT
// Which shapes bound a volume.
//
// Most kinds say it themselves. A quadric's box clips it and adds no faces, so it is closed when its surface
// stays clear of the box. Then the quadric's value f has one sign on all six faces. On a face, a rectangle, f
// is of second degree in two variables: its least and greatest values lie at a corner, at the vertex of the
// parabola that it is along an edge, or where its gradient within the face is 0. Those places are tried. A
// value there that is not well away from 0 counts as 0: near the box, which roots are within it would be
// decided by rounding, and a line might enter without leaving.
//
// Where a line begins. A line of finite length beyond every crossing is out of a bounded shape. A plane (the
// half-space behind it) and a polyhedron may be unbounded, but both are convex: two crossings are the way in
// and the way out, one is the way out if the face's normal n and the direction d have n·d > 0, which is
// decided exactly, and with none the line is in or out for good, as its origin is.
//
// The lens of a spindle torus is convex and within the body, so a line through it crosses outer sheet, inner,
// inner and outer. Four crossings may also be of the outer sheet alone, twice through the body; then the
// middle between the second and the third is not in the lens. Where that cannot be told for certain the two
// are all but at one place, and it does not matter.
#include "shapes/closed.h"
#include "math/elementary.h"
#include "shapes/cut.h"
#include "shapes/sweep.h"

static const char not_closed[] = "is not closed: set .closed";
static const char no_volume[] = "is a surface that bounds no volume";

static const char *flaw_of_sphere(const sag_sphere *s) {
    if (!sagi_sweep_is_full(s->phi_max_rad)) return "is only a part: set .phi_max_rad to 0";
    if (s->z_min == 0 && s->z_max == 0) return NULL;
    return s->z_min <= -s->radius && s->z_max >= s->radius ? NULL : "is cut open: set .z_min and .z_max to 0";
}

// The quadric's value at p, 0 where it cannot be told from 0; and the sum of its terms' sizes.
static double value_at(const double c[10], const double p[3]) {
    const double terms[10] = {c[0] * p[0] * p[0],     c[1] * p[1] * p[1],
                              c[2] * p[2] * p[2],     2 * c[3] * p[0] * p[1],
                              2 * c[4] * p[0] * p[2], 2 * c[5] * p[1] * p[2],
                              2 * c[6] * p[0],        2 * c[7] * p[1],
                              2 * c[8] * p[2],        c[9]};
    double sum = 0, size = 0;
    for (int i = 0; i < 10; i++) sum += terms[i], size += fabs(terms[i]);
    return fabs(sum) > 0x1p-40 * size ? sum : 0;
}

// A face: coordinate k is p[k] on it.
typedef struct face {
    const double *c, *low, *high;
    double p[3];
    bool positive, negative, zero; // values found
} face;

static void look_at(face *f) {
    double value = value_at(f->c, f->p);
    f->positive |= value > 0, f->negative |= value < 0, f->zero |= !(value != 0);
}

// ∂f/∂pᵢ = 2 (Σⱼ Aᵢⱼ pⱼ + bᵢ).
static double second(const double c[10], int i, int j) { return i == j ? c[i] : c[2 + i + j]; }
static double slope(const face *f, int i) {
    double sum = f->c[6 + i];
    for (int j = 0; j < 3; j++) sum += second(f->c, i, j) * f->p[j];
    return sum;
}

// Moves to the vertex of the parabola along coordinate i, if it is on the face, and looks there.
static void look_along(face *f, int i) {
    double from = f->p[i], to = from - slope(f, i) / second(f->c, i, i);
    if (!(to > f->low[i] && to < f->high[i])) return;
    f->p[i] = to;
    look_at(f);
    f->p[i] = from;
}

static void look_inside(face *f, int i, int j) {
    double a = second(f->c, i, i), b = second(f->c, i, j), d = second(f->c, j, j), g, h;
    f->p[i] = f->low[i], f->p[j] = f->low[j];
    g = slope(f, i), h = slope(f, j);
    f->p[i] += (b * h - d * g) / (a * d - b * b);
    f->p[j] += (b * g - a * h) / (a * d - b * b);
    if (f->p[i] > f->low[i] && f->p[i] < f->high[i] && f->p[j] > f->low[j] && f->p[j] < f->high[j])
        look_at(f);
}

static void look_over_face(face *f, int k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    look_inside(f, i, j);
    for (int corner = 0; corner < 4; corner++) {
        f->p[i] = (corner & 1 ? f->high : f->low)[i];
        f->p[j] = (corner & 2 ? f->high : f->low)[j];
        look_at(f);
        look_along(f, i);
        look_along(f, j);
    }
}

static const char *flaw_of_quadric(const sag_quadric *s) {
    const double low[3] = {s->clip.min.x, s->clip.min.y, s->clip.min.z};
    const double high[3] = {s->clip.max.x, s->clip.max.y, s->clip.max.z};
    face f = {.c = s->coefficients, .low = low, .high = high};
    for (int k = 0; k < 3; k++)
        for (int side = 0; side < 2; side++) {
            f.p[k] = side == 0 ? low[k] : high[k];
            look_over_face(&f, k);
        }
    return !f.zero && f.positive != f.negative
               ? NULL
               : "is cut by its .clip, or touches it: only a quadric well inside its box is closed";
}

const char *sagi_shape_flaw(sag_shape_kind kind, const void *shape) {
    switch (kind) {
    case SAG_SHAPE_PLANE:
    case SAG_SHAPE_ELLIPSOID:
    case SAG_SHAPE_BOX:
    case SAG_SHAPE_ORIENTED_BOX:
    case SAG_SHAPE_POLYHEDRON:
    case SAG_SHAPE_CAPSULE:
    case SAG_SHAPE_TORUS: return NULL;
    case SAG_SHAPE_SPHERE: return flaw_of_sphere(shape);
    case SAG_SHAPE_CYLINDER: return ((const sag_cylinder *)shape)->closed ? NULL : not_closed;
    case SAG_SHAPE_CONE: return ((const sag_cone *)shape)->closed ? NULL : not_closed;
    case SAG_SHAPE_PARABOLOID: return ((const sag_paraboloid *)shape)->closed ? NULL : not_closed;
    case SAG_SHAPE_HYPERBOLOID: return ((const sag_hyperboloid *)shape)->closed ? NULL : not_closed;
    case SAG_SHAPE_HYPERBOLOID2: return ((const sag_hyperboloid2 *)shape)->closed ? NULL : not_closed;
    case SAG_SHAPE_QUADRIC: return flaw_of_quadric(shape);
    case SAG_SHAPE_DISK:
    case SAG_SHAPE_RECTANGLE:
    case SAG_SHAPE_POLYGON:
    case SAG_SHAPE_TRIANGLE:
    case SAG_SHAPE_BILINEAR_PATCH: return no_volume;
    case SAG_SHAPE_SPHERES: return "is many bodies: add its spheres one by one";
    case SAG_SHAPE_USER: return "is a shape of the user's own, of which nobody knows whether it is closed";
    case SAG_SHAPE_MESH:
    case SAG_SHAPE_INSTANCE: break;
    }
    return NULL;
}

static sag_ray whole_line(const sag_ray *ray) {
    sag_ray line = *ray;
    line.t_min = -INFINITY, line.t_max = INFINITY;
    return line;
}

static bool leaves(sag_vec3 normal, const sag_ray *ray) {
    return sagi_plane_side(normal, sag_vec3_make(0, 0, 0), ray->direction) > 0;
}

bool sagi_shape_begins_inside(sag_shape_kind kind, const void *shape, const sag_ray *ray) {
    if (kind != SAG_SHAPE_PLANE && kind != SAG_SHAPE_POLYHEDRON) return false;
    const sag_ray line = whole_line(ray);
    sag_hit hits[2];
    if (kind == SAG_SHAPE_PLANE) {
        const sag_plane *plane = shape;
        return sag_plane_hit(plane, &line, hits) ? leaves(plane->normal, ray)
                                                 : sag_plane_contains(plane, ray->origin);
    }
    const sag_polyhedron *p = shape;
    size_t count = sag_polyhedron_crossings(p, &line, hits, 2);
    if (count == 0) return sag_polyhedron_contains(p, ray->origin);
    return count == 1 && leaves(p->planes[hits[0].primitive].normal, ray);
}

size_t sagi_torus_leave_outer(const sag_torus *torus, const sag_ray *ray, sag_hit *hits, size_t count) {
    double major = torus->major_radius, minor = torus->minor_radius;
    if (count < 4 || !(major < minor)) return count;
    sag_vec3 p = sag_madd(ray->origin, 0.5 * hits[1].t + 0.5 * hits[2].t, ray->direction);
    if (!(sagi_hypot(sagi_hypot(p.x, p.y) + major, p.z) < minor)) return count;
    hits[1] = hits[3];
    return 2;
}
