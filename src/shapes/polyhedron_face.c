// SPDX-License-Identifier: MIT
// One face of an intersection of half-spaces nₘ·p ≤ cₘ, by clipping.
//
// On plane i let a be the axis where |nᵢ| is largest and x, y the two other coordinates (cyclic). The plane
// itself says pₐ = (cᵢ − nᵢₓ x − nᵢᵧ y)/nᵢₐ; put into half-space m and multiplied by |nᵢₐ| it becomes a line
// in x and y,
//     σ(nₘₓ nᵢₐ − nₘₐ nᵢₓ) x + σ(nₘᵧ nᵢₐ − nₘₐ nᵢᵧ) y ≤ σ(cₘ nᵢₐ − nₘₐ cᵢ),   σ = sign nᵢₐ,
// whose coefficients are 2×2 determinants of the numbers given: exact to 2⁻¹⁰⁴ in double-double. A square so
// large that it holds every vertex is cut by these lines one by one (Sutherland & Hodgman, "Reentrant Polygon
// Clipping", CACM 17(1), 1974). Vertices are remembered by the two lines that make them and worked out from
// those, not from the ends of an edge, so that the size of the first square costs no accuracy.
#include "shapes/polyhedron_face.h"

typedef struct line {
    sagi_dd a, b, c; // a x + b y ≤ c
} line;

typedef struct outline {
    int count;
    uint32_t edges[SAGI_FACE_MAX_VERTICES]; // the line from vertex k to vertex k + 1
    sagi_dd x[SAGI_FACE_MAX_VERTICES], y[SAGI_FACE_MAX_VERTICES];
} outline;

typedef struct face_plane {
    const sag_polyhedron *polyhedron;
    sag_vec3 normal;
    double offset, size; // size: half the first square's side
    int axis, x_axis, y_axis;
    int sign;
} face_plane;

static sagi_dd minor(double a, double b, double c, double d, int sign) {
    sagi_dd m = sagi_dd_sub(sagi_two_prod(a, b), sagi_two_prod(c, d));
    return sign < 0 ? sagi_dd_neg(m) : m;
}

// Lines 0 … plane_count − 1 come from the planes, the four after them are the sides of the first square.
static line line_of(const face_plane *f, uint32_t m) {
    uint32_t side = m - f->polyhedron->plane_count;
    const sagi_dd zero = {0, 0}, one = {1, 0}, minus = {-1, 0}, size = {f->size, 0};
    if (m >= f->polyhedron->plane_count)
        return side == 0   ? (line){zero, minus, size}
               : side == 1 ? (line){one, zero, size}
               : side == 2 ? (line){zero, one, size}
                           : (line){minus, zero, size};
    const sag_half_space *h = &f->polyhedron->planes[m];
    double na = sag_component(f->normal, f->axis), ma = sag_component(h->normal, f->axis);
    return (line){
        minor(sag_component(h->normal, f->x_axis), na, ma, sag_component(f->normal, f->x_axis), f->sign),
        minor(sag_component(h->normal, f->y_axis), na, ma, sag_component(f->normal, f->y_axis), f->sign),
        minor(h->offset, na, ma, f->offset, f->sign),
    };
}

static bool is_inside(const line *l, sagi_dd x, sagi_dd y) {
    // In double first: one rounding of each number, two products, two sums.
    double p = l->a.hi * x.hi, q = l->b.hi * y.hi, quick = p + q - l->c.hi;
    if (fabs(quick) > 8 * SAGI_EPSILON * (fabs(p) + fabs(q) + fabs(l->c.hi))) return quick < 0;
    sagi_dd ax = sagi_dd_mul(l->a, x), by = sagi_dd_mul(l->b, y);
    return sagi_dd_sub(sagi_dd_add(ax, by), l->c).hi <= 0;
}

// The point where two lines meet; false when they are parallel.
static bool meet(const line *l, const line *m, sagi_dd *x, sagi_dd *y) {
    sagi_dd det = sagi_dd_sub(sagi_dd_mul(l->a, m->b), sagi_dd_mul(m->a, l->b));
    if (!(det.hi < 0 || det.hi > 0)) return false;
    *x = sagi_dd_div(sagi_dd_sub(sagi_dd_mul(l->c, m->b), sagi_dd_mul(m->c, l->b)), det);
    *y = sagi_dd_div(sagi_dd_sub(sagi_dd_mul(l->a, m->c), sagi_dd_mul(m->a, l->c)), det);
    return true;
}

static void add_vertex(outline *o, uint32_t edge, sagi_dd x, sagi_dd y) {
    if (o->count == SAGI_FACE_MAX_VERTICES) return;
    o->edges[o->count] = edge, o->x[o->count] = x, o->y[o->count++] = y;
}

static void cut_outline(const face_plane *f, uint32_t m, const outline *from, outline *to) {
    line l = line_of(f, m);
    to->count = 0;
    for (int k = 0; k < from->count; k++) {
        int next = (k + 1) % from->count;
        bool in = is_inside(&l, from->x[k], from->y[k]),
             next_in = is_inside(&l, from->x[next], from->y[next]);
        if (in) add_vertex(to, from->edges[k], from->x[k], from->y[k]);
        if (in == next_in) continue;
        line edge = line_of(f, from->edges[k]);
        sagi_dd x = from->x[k], y = from->y[k];
        (void)meet(&edge, &l, &x, &y);
        add_vertex(to, in ? m : from->edges[k], x, y);
    }
}

// Half-spaces whose planes are parallel to the face's own: they keep all of it or nothing.
static bool keeps_parallel(const face_plane *f, const line *l, uint32_t plane, uint32_t m) {
    if (l->c.hi != 0) return l->c.hi > 0;
    // Coincident: the first of equal ones keeps the face; facing ones leave no room for a solid.
    double product =
        sag_component(f->normal, f->axis) * sag_component(f->polyhedron->planes[m].normal, f->axis);
    return product > 0 && plane < m;
}

static double largest_distance(const sag_polyhedron *polyhedron) {
    double largest = 0;
    for (uint32_t i = 0; i < polyhedron->plane_count; i++) {
        const sag_half_space *h = &polyhedron->planes[i];
        largest = fmax(largest, fabs(h->offset) / sag_max_component(sag_abs(h->normal)));
    }
    return largest > 0 ? largest : 1;
}

void sagi_polyhedron_face_find(const sag_polyhedron *polyhedron, uint32_t plane, sagi_polyhedron_face *face) {
    const sag_half_space *h = &polyhedron->planes[plane];
    sag_vec3 size = sag_abs(h->normal);
    face_plane f = {.polyhedron = polyhedron, .normal = h->normal, .offset = h->offset};
    f.axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    f.x_axis = (f.axis + 1) % 3, f.y_axis = (f.axis + 2) % 3;
    f.sign = sag_component(h->normal, f.axis) > 0 ? 1 : -1;
    f.size = 0x1p40 * largest_distance(polyhedron);
    face->count = 0, face->unbounded = false, face->far = f.size / 4;
    outline outlines[2];
    outlines[0].count = 0;
    int now = 0;
    const sagi_dd lo = {-f.size, 0}, hi = {f.size, 0};
    uint32_t n = polyhedron->plane_count;
    add_vertex(&outlines[0], n, lo, lo), add_vertex(&outlines[0], n + 1, hi, lo);
    add_vertex(&outlines[0], n + 2, hi, hi), add_vertex(&outlines[0], n + 3, lo, hi);
    for (uint32_t m = 0; m < n && outlines[now].count > 0; m++) {
        if (m == plane) continue;
        line l = line_of(&f, m);
        if (l.a.hi == 0 && l.b.hi == 0) {
            if (!keeps_parallel(&f, &l, plane, m)) return;
            continue;
        }
        cut_outline(&f, m, &outlines[now], &outlines[1 - now]);
        now = 1 - now;
    }
    const outline *o = &outlines[now];
    for (int k = 0; k < o->count; k++) {
        // Back on the plane: pₐ = (c − nₓ x − nᵧ y)/nₐ.
        sagi_dd ax = sagi_dd_mul_double(o->x[k], sag_component(f.normal, f.x_axis));
        sagi_dd by = sagi_dd_mul_double(o->y[k], sag_component(f.normal, f.y_axis));
        sagi_dd rest = sagi_dd_sub(sagi_dd_from(f.offset), sagi_dd_add(ax, by));
        double p[3];
        p[f.axis] = sagi_dd_div(rest, sagi_dd_from(sag_component(f.normal, f.axis))).hi;
        p[f.x_axis] = o->x[k].hi, p[f.y_axis] = o->y[k].hi;
        face->vertices[k] = (sag_vec3){p[0], p[1], p[2]};
        if (!(sag_max_component(sag_abs(face->vertices[k])) < face->far)) face->unbounded = true;
    }
    face->count = o->count;
}

double sagi_polyhedron_face_area(const sagi_polyhedron_face *face) {
    sag_vec3 sum = {0, 0, 0};
    for (int k = 2; k < face->count; k++)
        sum = sag_add(sum, sag_cross(sag_sub(face->vertices[k - 1], face->vertices[0]),
                                     sag_sub(face->vertices[k], face->vertices[0])));
    return sag_length(sum) / 2;
}
