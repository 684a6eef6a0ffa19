// SPDX-License-Identifier: MIT
#include "support/closed_shape.h"
#include <string.h>

static const sag_shape_kind kinds[14] = {SAG_SHAPE_SPHERE,     SAG_SHAPE_BOX,         SAG_SHAPE_ORIENTED_BOX,
                                         SAG_SHAPE_POLYHEDRON, SAG_SHAPE_CYLINDER,    SAG_SHAPE_CONE,
                                         SAG_SHAPE_PARABOLOID, SAG_SHAPE_HYPERBOLOID, SAG_SHAPE_HYPERBOLOID2,
                                         SAG_SHAPE_QUADRIC,    SAG_SHAPE_CAPSULE,     SAG_SHAPE_TORUS,
                                         SAG_SHAPE_MESH,       SAG_SHAPE_ELLIPSOID};

// A multiple of size/4 in [low, high] sizes.
static double step(rng *r, double size, int low, int high) {
    return (low * 4 + (int)rng_below(r, (uint32_t)(4 * (high - low) + 1))) * 0.25 * size;
}
static double extent(rng *r, double size) { return (double)(1 + rng_below(r, 4)) * 0.25 * size; }
sag_vec3 lattice_point(rng *r, double size) {
    double x = step(r, size, -1, 1), y = step(r, size, -1, 1), z = step(r, size, -1, 1);
    return (sag_vec3){x, y, z};
}
static sag_vec3 extents(rng *r, double size) {
    double x = extent(r, size), y = extent(r, size), z = extent(r, size);
    return (sag_vec3){x, y, z};
}

// An ellipsoid about c by its ten coefficients, in a clip that holds it.
static void make_quadric(rng *r, sag_vec3 c, sag_vec3 radii, bool skew, sag_quadric *q) {
    double a = 1 / (radii.x * radii.x), b = 1 / (radii.y * radii.y), f = 1 / (radii.z * radii.z);
    double d = skew ? rng_uniform(r, -0.4, 0.4) * sqrt(a * b) : 0;
    double e = skew ? rng_uniform(r, -0.4, 0.4) * sqrt(a * f) : 0;
    sag_vec3 m = {a * c.x + d * c.y + e * c.z, d * c.x + b * c.y, e * c.x + f * c.z};
    *q = (sag_quadric){.coefficients = {a, b, f, d, e, 0, -m.x, -m.y, -m.z, sag_dot(m, c) - 1}};
    sag_vec3 reach = sag_scale(radii, 4);
    q->clip = (sag_box3){sag_sub(c, reach), sag_add(c, reach)};
}

// The cube of a mesh: six quads of two triangles.
static void make_cube(sag_vec3 min, sag_vec3 size, random_shape *s) {
    static const uint32_t faces[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    for (int i = 0; i < 8; i++) {
        s->doubles[3 * i] = min.x + (i & 1 ? size.x : 0);
        s->doubles[3 * i + 1] = min.y + (i & 2 ? size.y : 0);
        s->doubles[3 * i + 2] = min.z + (i & 4 ? size.z : 0);
    }
    memcpy(s->indices, faces, sizeof faces);
    s->as.mesh = (sag_mesh){
        .positions_f64 = s->doubles, .triangles = s->indices, .vertex_count = 8, .triangle_count = 12};
}

// A box of which perhaps a corner is cut, by its planes.
static void make_wedge(rng *r, sag_vec3 min, sag_vec3 size, random_shape *s) {
    sag_vec3 max = sag_add(min, size);
    for (int i = 0; i < 3; i++) {
        sag_vec3 n = {i == 0, i == 1, i == 2};
        s->planes[2 * i] = (sag_half_space){sag_neg(n), -sag_component(min, i)};
        s->planes[2 * i + 1] = (sag_half_space){n, sag_component(max, i)};
    }
    s->planes[6] = (sag_half_space){{1, 1, rng_one_in(r, 2)}, max.x + max.y};
    s->planes[6].offset -= 0.5 * size.x, s->planes[6].offset += s->planes[6].normal.z * max.z;
    s->as.polyhedron = (sag_polyhedron){s->planes, rng_one_in(r, 2) ? 6 : 7};
}

static void lattice_shape(rng *r, double size, random_shape *s) {
    sag_vec3 at = lattice_point(r, size), wide = extents(r, size), half = sag_scale(wide, 0.5);
    double radius = extent(r, size), low = step(r, size, -1, 0), high = low + extent(r, size);
    switch (s->kind) {
    case SAG_SHAPE_PLANE: {
        sag_vec3 n = {0, 0, 0};
        *(rng_one_in(r, 2) ? &n.x : rng_one_in(r, 2) ? &n.y : &n.z) = rng_one_in(r, 2) ? 1 : -1;
        s->as.plane = (sag_plane){.point = at, .normal = n};
        break;
    }
    case SAG_SHAPE_SPHERE: s->as.sphere = (sag_sphere){.center = at, .radius = radius}; break;
    case SAG_SHAPE_ELLIPSOID: s->as.ellipsoid = (sag_ellipsoid){at, wide}; break;
    case SAG_SHAPE_ORIENTED_BOX:
        s->as.oriented_box = (sag_oriented_box){at, {{half.x, 0, 0}, {0, half.y, 0}, {0, 0, half.z}}};
        break;
    case SAG_SHAPE_POLYHEDRON: make_wedge(r, at, wide, s); break;
    case SAG_SHAPE_CYLINDER: s->as.cylinder = (sag_cylinder){radius, low, high, 0, true}; break;
    case SAG_SHAPE_CONE: s->as.cone = (sag_cone){radius, wide.z, 0, true}; break;
    case SAG_SHAPE_PARABOLOID:
        s->as.paraboloid = (sag_paraboloid){radius, 0, extent(r, size), 0, true};
        break;
    case SAG_SHAPE_HYPERBOLOID:
        s->as.hyperboloid = (sag_hyperboloid){{radius, 0, low}, {0.5 * radius, half.y, high}, 0, true};
        break;
    case SAG_SHAPE_HYPERBOLOID2:
        s->as.hyperboloid2 = (sag_hyperboloid2){radius, 0.25 * size, -size, size, 0, true};
        break;
    case SAG_SHAPE_QUADRIC: make_quadric(r, at, wide, false, &s->as.quadric); break;
    case SAG_SHAPE_CAPSULE: s->as.capsule = (sag_capsule){at, lattice_point(r, size), half.x}; break;
    case SAG_SHAPE_TORUS: s->as.torus = (sag_torus){radius, 0.5 * radius}; break;
    case SAG_SHAPE_MESH: make_cube(at, wide, s); break;
    case SAG_SHAPE_BOX:
    case SAG_SHAPE_DISK:
    case SAG_SHAPE_RECTANGLE:
    case SAG_SHAPE_POLYGON:
    case SAG_SHAPE_TRIANGLE:
    case SAG_SHAPE_BILINEAR_PATCH:
    case SAG_SHAPE_SPHERES:
    case SAG_SHAPE_USER:
    case SAG_SHAPE_INSTANCE:
        s->kind = SAG_SHAPE_BOX;
        s->as.box = (sag_box){at, sag_add(at, wide)};
        break;
    }
}

void closed_shape_make(rng *r, double size, bool lattice, random_shape *s) {
    sag_shape_kind kind = rng_one_in(r, 15) ? SAG_SHAPE_PLANE : kinds[rng_below(r, 14)];
    if (lattice) {
        s->kind = kind;
        lattice_shape(r, size, s);
        return;
    }
    random_shape_make(r, kind, size, s);
    if (kind == SAG_SHAPE_SPHERE) s->as.sphere.phi_max_rad = 0;
    if (kind == SAG_SHAPE_CYLINDER) s->as.cylinder.phi_max_rad = 0, s->as.cylinder.closed = true;
    if (kind == SAG_SHAPE_CONE) s->as.cone.phi_max_rad = 0, s->as.cone.closed = true;
    if (kind == SAG_SHAPE_PARABOLOID) s->as.paraboloid.phi_max_rad = 0, s->as.paraboloid.closed = true;
    if (kind == SAG_SHAPE_HYPERBOLOID) s->as.hyperboloid.phi_max_rad = 0, s->as.hyperboloid.closed = true;
    if (kind == SAG_SHAPE_HYPERBOLOID2) s->as.hyperboloid2.phi_max_rad = 0, s->as.hyperboloid2.closed = true;
    if (kind == SAG_SHAPE_MESH) s->as.mesh.one_sided = false;
    if (kind == SAG_SHAPE_QUADRIC) {
        sag_vec3 radii = {rng_uniform(r, 0.2, 1) * size, rng_uniform(r, 0.2, 1) * size,
                          rng_uniform(r, 0.2, 1) * size};
        make_quadric(r, rng_vec3(r, size), radii, true, &s->as.quadric);
    }
}

void closed_shape_copy(random_shape *to, const random_shape *from) {
    *to = *from;
    if (to->kind == SAG_SHAPE_POLYHEDRON) to->as.polyhedron.planes = to->planes;
    if (to->kind == SAG_SHAPE_MESH) {
        to->as.mesh.triangles = to->indices;
        if (to->as.mesh.positions_f32) to->as.mesh.positions_f32 = to->floats;
        if (to->as.mesh.positions_f64) to->as.mesh.positions_f64 = to->doubles;
        if (to->as.mesh.normals_f32) to->as.mesh.normals_f32 = to->floats + 32;
    }
}
