// SPDX-License-Identifier: MIT
// sag_add_X for every shape: typed doors to sag_add_shape.
#include <sagitta/scene.h>

uint32_t sag_add_plane(sag_scene *scene, const sag_plane *plane) {
    return sag_add_shape(scene, SAG_SHAPE_PLANE, plane);
}
uint32_t sag_add_disk(sag_scene *scene, const sag_disk *disk) {
    return sag_add_shape(scene, SAG_SHAPE_DISK, disk);
}
uint32_t sag_add_rectangle(sag_scene *scene, const sag_rectangle *rectangle) {
    return sag_add_shape(scene, SAG_SHAPE_RECTANGLE, rectangle);
}
uint32_t sag_add_polygon(sag_scene *scene, const sag_polygon *polygon) {
    return sag_add_shape(scene, SAG_SHAPE_POLYGON, polygon);
}
uint32_t sag_add_sphere(sag_scene *scene, const sag_sphere *sphere) {
    return sag_add_shape(scene, SAG_SHAPE_SPHERE, sphere);
}
uint32_t sag_add_ellipsoid(sag_scene *scene, const sag_ellipsoid *ellipsoid) {
    return sag_add_shape(scene, SAG_SHAPE_ELLIPSOID, ellipsoid);
}
uint32_t sag_add_cylinder(sag_scene *scene, const sag_cylinder *cylinder) {
    return sag_add_shape(scene, SAG_SHAPE_CYLINDER, cylinder);
}
uint32_t sag_add_cone(sag_scene *scene, const sag_cone *cone) {
    return sag_add_shape(scene, SAG_SHAPE_CONE, cone);
}
uint32_t sag_add_paraboloid(sag_scene *scene, const sag_paraboloid *paraboloid) {
    return sag_add_shape(scene, SAG_SHAPE_PARABOLOID, paraboloid);
}
uint32_t sag_add_hyperboloid(sag_scene *scene, const sag_hyperboloid *hyperboloid) {
    return sag_add_shape(scene, SAG_SHAPE_HYPERBOLOID, hyperboloid);
}
uint32_t sag_add_hyperboloid2(sag_scene *scene, const sag_hyperboloid2 *hyperboloid2) {
    return sag_add_shape(scene, SAG_SHAPE_HYPERBOLOID2, hyperboloid2);
}
uint32_t sag_add_quadric(sag_scene *scene, const sag_quadric *quadric) {
    return sag_add_shape(scene, SAG_SHAPE_QUADRIC, quadric);
}
uint32_t sag_add_box(sag_scene *scene, const sag_box *box) {
    return sag_add_shape(scene, SAG_SHAPE_BOX, box);
}
uint32_t sag_add_oriented_box(sag_scene *scene, const sag_oriented_box *oriented_box) {
    return sag_add_shape(scene, SAG_SHAPE_ORIENTED_BOX, oriented_box);
}
uint32_t sag_add_polyhedron(sag_scene *scene, const sag_polyhedron *polyhedron) {
    return sag_add_shape(scene, SAG_SHAPE_POLYHEDRON, polyhedron);
}
uint32_t sag_add_capsule(sag_scene *scene, const sag_capsule *capsule) {
    return sag_add_shape(scene, SAG_SHAPE_CAPSULE, capsule);
}
uint32_t sag_add_triangle(sag_scene *scene, const sag_triangle *triangle) {
    return sag_add_shape(scene, SAG_SHAPE_TRIANGLE, triangle);
}
uint32_t sag_add_bilinear_patch(sag_scene *scene, const sag_bilinear_patch *bilinear_patch) {
    return sag_add_shape(scene, SAG_SHAPE_BILINEAR_PATCH, bilinear_patch);
}
uint32_t sag_add_torus(sag_scene *scene, const sag_torus *torus) {
    return sag_add_shape(scene, SAG_SHAPE_TORUS, torus);
}
uint32_t sag_add_spheres(sag_scene *scene, const sag_spheres *spheres) {
    return sag_add_shape(scene, SAG_SHAPE_SPHERES, spheres);
}
uint32_t sag_add_mesh(sag_scene *scene, const sag_mesh *mesh) {
    return sag_add_shape(scene, SAG_SHAPE_MESH, mesh);
}
uint32_t sag_add_user(sag_scene *scene, const sag_user *user) {
    return sag_add_shape(scene, SAG_SHAPE_USER, user);
}
