// SPDX-License-Identifier: MIT
// One of the two places that list the shapes (the other is the switch in src/kernel): the typed table of cold
// functions.
#include "shapes/shape.h"

// A shape's functions take its own struct; the table's take void pointers. These wrap one in the other,
// without casts.
#define SHAPE(X)                                                                                             \
    static sag_status X##_validate(const void *s, sag_error *error) { return sag_##X##_validate(s, error); } \
    static sag_box3 X##_bounds(const void *s) { return sag_##X##_bounds(s); }                                \
    static bool X##_hit(const void *s, const sag_ray *r, sag_hit *h) { return sag_##X##_hit(s, r, h); }      \
    static bool X##_occluded(const void *s, const sag_ray *r) { return sag_##X##_occluded(s, r); }           \
    static size_t X##_crossings(const void *s, const sag_ray *r, sag_hit *h, size_t capacity) {              \
        return sag_##X##_crossings(s, r, h, capacity);                                                       \
    }                                                                                                        \
    static void X##_surface(const void *s, const sag_ray *r, const sag_hit *h, sag_surface *out) {           \
        sag_##X##_surface(s, r, h, out);                                                                     \
    }                                                                                                        \
    static double X##_area(const void *s) { return sag_##X##_area(s); }                                      \
    static bool X##_sample(const void *s, sag_vec2 random, sag_surface *out) {                               \
        return sag_##X##_sample(s, random, out);                                                             \
    }
#define CONTAINS(X)                                                                                          \
    static bool X##_contains(const void *s, sag_vec3 p) { return sag_##X##_contains(s, p); }
#define VOLUME(X)                                                                                            \
    static double X##_volume(const void *s) { return sag_##X##_volume(s); }
#define CLOSEST(X)                                                                                           \
    static sag_vec3 X##_closest_point(const void *s, sag_vec3 p) { return sag_##X##_closest_point(s, p); }

// clang-format off
SHAPE(plane)           CONTAINS(plane)        VOLUME(plane)        CLOSEST(plane)
SHAPE(disk)                                                        CLOSEST(disk)
SHAPE(rectangle)                                                   CLOSEST(rectangle)
SHAPE(polygon)                                                     CLOSEST(polygon)
SHAPE(sphere)          CONTAINS(sphere)       VOLUME(sphere)       CLOSEST(sphere)
SHAPE(ellipsoid)       CONTAINS(ellipsoid)    VOLUME(ellipsoid)    CLOSEST(ellipsoid)
SHAPE(cylinder)        CONTAINS(cylinder)     VOLUME(cylinder)     CLOSEST(cylinder)
SHAPE(cone)            CONTAINS(cone)         VOLUME(cone)         CLOSEST(cone)
SHAPE(paraboloid)      CONTAINS(paraboloid)   VOLUME(paraboloid)
SHAPE(hyperboloid)     CONTAINS(hyperboloid)  VOLUME(hyperboloid)
SHAPE(hyperboloid2)    CONTAINS(hyperboloid2) VOLUME(hyperboloid2)
SHAPE(quadric)         CONTAINS(quadric)
SHAPE(box)             CONTAINS(box)          VOLUME(box)          CLOSEST(box)
SHAPE(oriented_box)    CONTAINS(oriented_box) VOLUME(oriented_box) CLOSEST(oriented_box)
SHAPE(polyhedron)      CONTAINS(polyhedron)   VOLUME(polyhedron)   CLOSEST(polyhedron)
SHAPE(capsule)         CONTAINS(capsule)      VOLUME(capsule)      CLOSEST(capsule)
SHAPE(triangle)                                                    CLOSEST(triangle)
SHAPE(bilinear_patch)
SHAPE(torus)           CONTAINS(torus)        VOLUME(torus)        CLOSEST(torus)
SHAPE(spheres)         CONTAINS(spheres)                           CLOSEST(spheres)
SHAPE(mesh)            CONTAINS(mesh)         VOLUME(mesh)         CLOSEST(mesh)
SHAPE(user)

#define VERBS(X)                                                                                          \
    .name = #X, .struct_bytes = sizeof(sag_##X), .validate = X##_validate, .bounds = X##_bounds,          \
    .hit = X##_hit, .occluded = X##_occluded, .crossings = X##_crossings, .surface = X##_surface,         \
    .area = X##_area, .sample = X##_sample

const sagi_shape_class sagi_shape_classes[SAGI_SHAPE_KIND_COUNT] = {
    [SAG_SHAPE_PLANE] = {VERBS(plane), .contains = plane_contains, .volume = plane_volume, .closest_point = plane_closest_point},
    [SAG_SHAPE_DISK] = {VERBS(disk), .closest_point = disk_closest_point},
    [SAG_SHAPE_RECTANGLE] = {VERBS(rectangle), .closest_point = rectangle_closest_point},
    [SAG_SHAPE_POLYGON] = {VERBS(polygon), .closest_point = polygon_closest_point},
    [SAG_SHAPE_SPHERE] = {VERBS(sphere), .contains = sphere_contains, .volume = sphere_volume, .closest_point = sphere_closest_point},
    [SAG_SHAPE_ELLIPSOID] = {VERBS(ellipsoid), .contains = ellipsoid_contains, .volume = ellipsoid_volume, .closest_point = ellipsoid_closest_point},
    [SAG_SHAPE_CYLINDER] = {VERBS(cylinder), .contains = cylinder_contains, .volume = cylinder_volume, .closest_point = cylinder_closest_point},
    [SAG_SHAPE_CONE] = {VERBS(cone), .contains = cone_contains, .volume = cone_volume, .closest_point = cone_closest_point},
    [SAG_SHAPE_PARABOLOID] = {VERBS(paraboloid), .contains = paraboloid_contains, .volume = paraboloid_volume},
    [SAG_SHAPE_HYPERBOLOID] = {VERBS(hyperboloid), .contains = hyperboloid_contains, .volume = hyperboloid_volume},
    [SAG_SHAPE_HYPERBOLOID2] = {VERBS(hyperboloid2), .contains = hyperboloid2_contains, .volume = hyperboloid2_volume},
    [SAG_SHAPE_QUADRIC] = {VERBS(quadric), .contains = quadric_contains},
    [SAG_SHAPE_BOX] = {VERBS(box), .contains = box_contains, .volume = box_volume, .closest_point = box_closest_point},
    [SAG_SHAPE_ORIENTED_BOX] = {VERBS(oriented_box), .contains = oriented_box_contains, .volume = oriented_box_volume, .closest_point = oriented_box_closest_point},
    [SAG_SHAPE_POLYHEDRON] = {VERBS(polyhedron), .contains = polyhedron_contains, .volume = polyhedron_volume, .closest_point = polyhedron_closest_point},
    [SAG_SHAPE_CAPSULE] = {VERBS(capsule), .contains = capsule_contains, .volume = capsule_volume, .closest_point = capsule_closest_point},
    [SAG_SHAPE_TRIANGLE] = {VERBS(triangle), .closest_point = triangle_closest_point},
    [SAG_SHAPE_BILINEAR_PATCH] = {VERBS(bilinear_patch)},
    [SAG_SHAPE_TORUS] = {VERBS(torus), .contains = torus_contains, .volume = torus_volume, .closest_point = torus_closest_point},
    [SAG_SHAPE_SPHERES] = {VERBS(spheres), .contains = spheres_contains, .closest_point = spheres_closest_point},
    [SAG_SHAPE_MESH] = {VERBS(mesh), .contains = mesh_contains, .volume = mesh_volume, .closest_point = mesh_closest_point},
    [SAG_SHAPE_USER] = {VERBS(user)},
    [SAG_SHAPE_INSTANCE] = {.name = "instance"},
};
// clang-format on

const char *sag_shape_kind_name(sag_shape_kind kind) {
    return (unsigned)kind < SAGI_SHAPE_KIND_COUNT ? sagi_shape_classes[kind].name : "unknown";
}
