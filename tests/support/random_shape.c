// SPDX-License-Identifier: MIT
#include "support/random_shape.h"
#include "shapes/common.h"
#include "shapes/sphere.h"

static sag_vec3 point(rng *r, double size) { return rng_vec3(r, size); }
static double length(rng *r, double size) { return rng_uniform(r, 0.1, 1) * size; }
// No sweep half of the time, else some.
static double sweep(rng *r) { return rng_one_in(r, 2) ? 0 : rng_uniform(r, 0.5, 6); }

static void make_polygon(rng *r, double size, random_shape *s) {
    // A square around a square hole, in a coordinate plane, so that it is flat exactly.
    int axis = (int)rng_below(r, 3);
    double level = rng_uniform(r, -size, size);
    for (int i = 0; i < 8; i++) {
        double a = (i % 4 == 0 || i % 4 == 3 ? -1 : 1) * (i < 4 ? 0.8 : 0.3) * size;
        double b = (i % 4 < 2 ? -1 : 1) * (i < 4 ? 0.7 : 0.2) * size;
        s->points[i] = axis == 0   ? sag_vec3_make(level, a, b)
                       : axis == 1 ? sag_vec3_make(b, level, a)
                                   : sag_vec3_make(a, b, level);
    }
    s->loops[0] = s->loops[1] = 4;
    s->as.polygon = (sag_polygon){s->points, 8, s->loops, rng_one_in(r, 2) ? 2u : 1u};
    s->as.polygon.position_count = 4 * s->as.polygon.loop_count;
}

static void make_polyhedron(rng *r, double size, random_shape *s) {
    for (int i = 0; i < 6; i++) {
        sag_vec3 n = {i / 2 == 0, i / 2 == 1, i / 2 == 2};
        n = sag_add(i % 2 ? n : sag_neg(n), sag_scale(rng_direction(r), 0.2));
        s->planes[i] = (sag_half_space){n, length(r, 0.6 * size)};
    }
    s->as.polyhedron = (sag_polyhedron){s->planes, 6};
}

static void make_spheres(rng *r, double size, random_shape *s) {
    uint32_t count = 1 + rng_below(r, 20);
    for (uint32_t i = 0; i < 3 * count; i++) {
        s->doubles[i] = rng_uniform(r, -size, size);
        s->floats[i] = (float)s->doubles[i];
    }
    for (uint32_t i = 0; i < count; i++) s->floats[64 + i] = (float)length(r, 0.3 * size);
    s->as.spheres = (sag_spheres){.count = count, .radius = 0.2 * size};
    if (rng_one_in(r, 2))
        s->as.spheres.centers_f32 = s->floats;
    else
        s->as.spheres.centers_f64 = s->doubles;
    if (rng_one_in(r, 2)) s->as.spheres.radii_f32 = s->floats + 64;
}

// An octahedron with some noise.
static void make_mesh(rng *r, double size, random_shape *s) {
    static const double corner[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const uint32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                       2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    for (int i = 0; i < 18; i++) {
        s->doubles[i] = size * (corner[i] + rng_uniform(r, -0.2, 0.2));
        s->floats[i] = (float)s->doubles[i];
        s->floats[32 + i] = (float)corner[i];
    }
    for (int i = 0; i < 24; i++) s->indices[i] = faces[i];
    s->as.mesh = (sag_mesh){
        .triangles = s->indices, .vertex_count = 6, .triangle_count = 8, .one_sided = rng_one_in(r, 4)};
    if (rng_one_in(r, 2))
        s->as.mesh.positions_f32 = s->floats;
    else
        s->as.mesh.positions_f64 = s->doubles;
    if (rng_one_in(r, 2)) s->as.mesh.normals_f32 = s->floats + 32;
}

// A user's shape: spheres again, four doubles each.
static sag_box3 user_bounds(void *user, uint32_t primitive) {
    const double *d = (const double *)user + 4 * (size_t)primitive;
    return sagi_sphere_bounds(sag_vec3_make(d[0], d[1], d[2]), d[3]);
}
static void user_crossings(void *user, const uint32_t *primitives, size_t count, const sag_ray *ray,
                           sag_user_report *report) {
    for (size_t i = 0; i < count; i++) {
        const double *d = (const double *)user + 4 * (size_t)primitives[i];
        double t[2];
        int n = sagi_sphere_crossings(sag_vec3_make(d[0], d[1], d[2]), d[3], ray, t);
        for (int k = n - 1; k >= 0; k--) sag_user_report_hit(report, primitives[i], t[k], k, 0.5);
    }
}
static void user_surface(void *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    const double *d = (const double *)user + 4 * (size_t)hit->primitive;
    sagi_sphere_place(sag_vec3_make(d[0], d[1], d[2]), d[3], ray, hit->t, surface);
    sag_frame(surface->geometric_normal, &surface->dpdu, &surface->dpdv);
    surface->shading_normal = surface->geometric_normal;
}

static void make_user(rng *r, double size, random_shape *s) {
    uint32_t count = 1 + rng_below(r, 20);
    for (uint32_t i = 0; i < 4 * count; i++)
        s->doubles[i] = i % 4 == 3 ? length(r, 0.3 * size) : rng_uniform(r, -size, size);
    s->as.user = (sag_user){.primitive_count = count,
                            .user = s->doubles,
                            .bounds = user_bounds,
                            .crossings = user_crossings,
                            .surface = user_surface};
}

void random_shape_make(rng *r, sag_shape_kind kind, double size, random_shape *s) {
    double z0 = rng_uniform(r, -1, 0) * size, z1 = rng_uniform(r, 0.1, 1) * size;
    double phi = sweep(r);
    bool closed = phi == 0 && rng_one_in(r, 2);
    s->kind = kind;
    switch (kind) {
    case SAG_SHAPE_PLANE:
        s->as.plane = (sag_plane){.point = point(r, size), .normal = rng_direction(r)};
        break;
    case SAG_SHAPE_DISK:
        s->as.disk =
            (sag_disk){.center = point(r, size), .normal = rng_direction(r), .radius = length(r, size)};
        s->as.disk.inner_radius = rng_one_in(r, 2) ? 0 : 0.5 * s->as.disk.radius;
        s->as.disk.phi_max_rad = phi;
        break;
    case SAG_SHAPE_RECTANGLE:
        s->as.rectangle = (sag_rectangle){point(r, size), point(r, size), point(r, size)};
        break;
    case SAG_SHAPE_POLYGON: make_polygon(r, size, s); break;
    case SAG_SHAPE_SPHERE:
        s->as.sphere = (sag_sphere){.center = point(r, size), .radius = length(r, size), .phi_max_rad = phi};
        break;
    case SAG_SHAPE_ELLIPSOID:
        s->as.ellipsoid =
            (sag_ellipsoid){point(r, size), {length(r, size), length(r, size), length(r, size)}};
        break;
    case SAG_SHAPE_CYLINDER: s->as.cylinder = (sag_cylinder){length(r, size), z0, z1, phi, closed}; break;
    case SAG_SHAPE_CONE: s->as.cone = (sag_cone){length(r, size), length(r, size), phi, closed}; break;
    case SAG_SHAPE_PARABOLOID:
        s->as.paraboloid =
            (sag_paraboloid){length(r, size), rng_one_in(r, 2) ? 0 : 0.5 * z1, z1, phi, closed};
        break;
    case SAG_SHAPE_HYPERBOLOID:
        s->as.hyperboloid = (sag_hyperboloid){point(r, size), point(r, size), phi, closed};
        break;
    case SAG_SHAPE_HYPERBOLOID2:
        s->as.hyperboloid2 =
            (sag_hyperboloid2){length(r, size), length(r, 0.3 * size), -size, size, phi, closed};
        break;
    case SAG_SHAPE_QUADRIC:
        for (int i = 0; i < 10; i++)
            s->as.quadric.coefficients[i] = rng_uniform(r, -1, 1) * (i < 6 ? 1 : i < 9 ? size : size * size);
        s->as.quadric.clip = (sag_box3){{-size, -size, -size}, {size, size, size}};
        break;
    case SAG_SHAPE_BOX: {
        sag_vec3 min = point(r, size);
        sag_vec3 extent = {length(r, size), length(r, size), length(r, size)};
        s->as.box = (sag_box){min, sag_add(min, extent)};
        break;
    }
    case SAG_SHAPE_ORIENTED_BOX:
        s->as.oriented_box = (sag_oriented_box){
            point(r, size), {point(r, 0.5 * size), point(r, 0.5 * size), point(r, 0.5 * size)}};
        break;
    case SAG_SHAPE_POLYHEDRON: make_polyhedron(r, size, s); break;
    case SAG_SHAPE_CAPSULE:
        s->as.capsule = (sag_capsule){point(r, size), point(r, size), length(r, 0.5 * size)};
        break;
    case SAG_SHAPE_TRIANGLE:
        s->as.triangle = (sag_triangle){point(r, size), point(r, size), point(r, size), rng_one_in(r, 4)};
        break;
    case SAG_SHAPE_BILINEAR_PATCH:
        s->as.bilinear_patch =
            (sag_bilinear_patch){point(r, size), point(r, size), point(r, size), point(r, size)};
        break;
    case SAG_SHAPE_TORUS: s->as.torus = (sag_torus){length(r, size), length(r, 0.5 * size)}; break;
    case SAG_SHAPE_SPHERES: make_spheres(r, size, s); break;
    case SAG_SHAPE_MESH: make_mesh(r, size, s); break;
    case SAG_SHAPE_USER: make_user(r, size, s); break;
    case SAG_SHAPE_INSTANCE: break;
    }
}

bool random_place(rng *r, double size, sag_affine *map) {
    *map = sag_affine_identity();
    uint32_t choice = rng_below(r, 5);
    if (choice == 0) return false;
    sag_affine shift = sag_affine_translate(rng_vec3(r, size));
    if (choice > 1) {
        sag_affine turn = sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r));
        double s = rng_log_uniform(r, 0.3, 3);
        sag_vec3 scale = {s, s, s};
        if (choice == 3) scale.x = -s;
        if (choice == 4) scale = sag_vec3_make(s, rng_log_uniform(r, 0.3, 3), -rng_log_uniform(r, 0.3, 3));
        sag_affine stretch = sag_affine_scale(scale);
        *map = sag_affine_multiply(&turn, &stretch);
        if (choice == 4) {
            turn = sag_affine_rotate(rng_uniform(r, 0, 6), rng_direction(r));
            *map = sag_affine_multiply(map, &turn);
        }
    }
    *map = sag_affine_multiply(&shift, map);
    return true;
}
