// SPDX-License-Identifier: MIT
// Each solid as its steps, and at the end the table of formulas. Radii are 1 where nothing else is said.
#include "support/known_solids.h"
#include "support/meshes.h"
#include <string.h>

#define PI 3.14159265358979323846

typedef struct builder {
    sag_scene *scene;
    sag_solid_step steps[512];
    uint32_t count;
} builder;

static builder begin(sag_context *context) { return (builder){.scene = sag_scene_create(context)}; }
static void part(builder *b, uint32_t id) { b->steps[b->count++] = (sag_solid_step){SAG_SOLID_PART, id}; }
static void step(builder *b, sag_solid_operation operation, uint32_t operands) {
    b->steps[b->count++] = (sag_solid_step){operation, operands};
}
static sag_scene *end(builder *b) {
    sag_solid solid = {b->steps, b->count};
    if (sag_scene_set_solid(b->scene, &solid, NULL) != SAG_OK) abort();
    if (sag_scene_commit(b->scene, NULL) != SAG_OK) abort();
    return b->scene;
}

static void ball(builder *b, double x, double y, double z, double radius) {
    part(b, sag_add_sphere(b->scene, &(sag_sphere){.center = {x, y, z}, .radius = radius}));
}
static void box(builder *b, sag_vec3 min, sag_vec3 max) {
    part(b, sag_add_box(b->scene, &(sag_box){min, max}));
}
static void cube(builder *b, double half) {
    box(b, (sag_vec3){-half, -half, -half}, (sag_vec3){half, half, half});
}
// Behind the plane through `point`.
static void half_space(builder *b, sag_vec3 point, sag_vec3 normal) {
    part(b, sag_add_plane(b->scene, &(sag_plane){.point = point, .normal = normal}));
}
// From (0, 0, −half) to (0, 0, half), then turned to an axis (0 x, 1 y, 2 z) and moved.
static void rod(builder *b, int axis, double radius, double half, sag_vec3 offset) {
    uint32_t id = sag_add_cylinder(b->scene, &(sag_cylinder){radius, -half, half, 0, true});
    sag_vec3 to = {axis == 0, axis == 1, axis == 2};
    sag_affine map = sag_affine_along((sag_vec3){0, 0, 0}, to), move = sag_affine_translate(offset);
    map = sag_affine_multiply(&move, &map);
    sag_geometry_set_transform(b->scene, id, &map);
    part(b, id);
}
static void ring(builder *b, double major, double minor) {
    part(b, sag_add_torus(b->scene, &(sag_torus){major, minor}));
}
static const sag_vec3 zero = {0, 0, 0};

static sag_scene *bicylinder(sag_context *c) {
    builder b = begin(c);
    rod(&b, 0, 1, 2, zero), rod(&b, 1, 1, 2, zero), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *tricylinder(sag_context *c) {
    builder b = begin(c);
    for (int i = 0; i < 3; i++) rod(&b, i, 1, 2, zero);
    step(&b, SAG_SOLID_INTERSECTION, 3);
    return end(&b);
}
static sag_scene *bicylinder_without_ball(sag_context *c) {
    builder b = begin(c);
    rod(&b, 0, 1, 2, zero), rod(&b, 1, 1, 2, zero), step(&b, SAG_SOLID_INTERSECTION, 2);
    ball(&b, 0, 0, 0, 1), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *cap(sag_context *c) { // of height 0.4
    builder b = begin(c);
    ball(&b, 0, 0, 0, 1), half_space(&b, (sag_vec3){0, 0, 0.6}, (sag_vec3){0, 0, -1});
    step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *two_balls(sag_context *c, sag_solid_operation operation) { // 1 apart
    builder b = begin(c);
    ball(&b, -0.5, 0, 0, 1), ball(&b, 0.5, 0, 0, 1), step(&b, operation, 2);
    return end(&b);
}
static sag_scene *lens(sag_context *c) { return two_balls(c, SAG_SOLID_INTERSECTION); }
static sag_scene *peanut(sag_context *c) { return two_balls(c, SAG_SOLID_UNION); }
static sag_scene *lune(sag_context *c) { return two_balls(c, SAG_SOLID_DIFFERENCE); }
static sag_scene *xor_of_balls(sag_context *c) { return two_balls(c, SAG_SOLID_XOR); }
static sag_scene *half_torus(sag_context *c) {
    builder b = begin(c);
    ring(&b, 1, 0.4), half_space(&b, zero, (sag_vec3){1, 0, 0}), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *quarter_torus(sag_context *c) {
    builder b = begin(c);
    ring(&b, 1, 0.4), half_space(&b, zero, (sag_vec3){1, 0, 0}), half_space(&b, zero, (sag_vec3){0, -1, 0});
    step(&b, SAG_SOLID_INTERSECTION, 3);
    return end(&b);
}
static sag_scene *sliced_torus(sag_context *c) {
    builder b = begin(c);
    ring(&b, 1, 0.4), half_space(&b, zero, (sag_vec3){0, 0, 1}), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *box_without_ball(sag_context *c) {
    builder b = begin(c);
    cube(&b, 1), ball(&b, 0, 0, 0, 0.8), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *die(sag_context *c) {
    builder b = begin(c);
    cube(&b, 1), ball(&b, 0, 0, 0, 1.2), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *pierced_cube(sag_context *c) {
    builder b = begin(c);
    cube(&b, 1), ball(&b, 0, 0, 0, 1.2), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *napkin_ring(sag_context *c) {
    builder b = begin(c);
    ball(&b, 0, 0, 0, 1), rod(&b, 2, 0.6, 2, zero), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *viviani(sag_context *c) {
    builder b = begin(c);
    ball(&b, 0, 0, 0, 1), rod(&b, 2, 0.5, 2, (sag_vec3){0.5, 0, 0}), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static void cone(builder *b, double radius, double height, const sag_affine *map) {
    uint32_t id = sag_add_cone(b->scene, &(sag_cone){radius, height, 0, true});
    if (map) sag_geometry_set_transform(b->scene, id, map);
    part(b, id);
}
static sag_scene *frustum(sag_context *c) {
    builder b = begin(c);
    cone(&b, 1, 2, NULL), half_space(&b, (sag_vec3){0, 0, 1}, (sag_vec3){0, 0, 1});
    step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *tube(sag_context *c) { // the ends of both coincide
    builder b = begin(c);
    rod(&b, 0, 1, 1, zero), rod(&b, 0, 0.7, 1, zero), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *xor_of_boxes(sag_context *c) {
    builder b = begin(c);
    box(&b, (sag_vec3){-1.5, -1.5, -1.5}, (sag_vec3){0.5, 0.5, 0.5});
    box(&b, (sag_vec3){-0.5, -0.5, -0.5}, (sag_vec3){1.5, 1.5, 1.5}), step(&b, SAG_SOLID_XOR, 2);
    return end(&b);
}
static sag_scene *hollow_ball(sag_context *c) {
    builder b = begin(c);
    ball(&b, 0, 0, 0, 1), ball(&b, 0, 0, 0, 0.8), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static void mesh(builder *b, test_mesh *m) {
    part(b, sag_add_mesh(b->scene, &m->mesh));
    test_mesh_free(m);
}
static sag_scene *mesh_without_corner(sag_context *c) { // faces coincide with the mesh's
    builder b = begin(c);
    test_mesh m = test_mesh_cube();
    mesh(&b, &m), box(&b, zero, (sag_vec3){1, 1, 1}), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *half_mesh(sag_context *c) {
    builder b = begin(c);
    test_mesh m = test_mesh_sphere(2);
    mesh(&b, &m), half_space(&b, zero, (sag_vec3){0.3, -0.5, 0.9}), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *bowl_without_cone(sag_context *c) { // base and rim coincide
    builder b = begin(c);
    part(&b, sag_add_paraboloid(b.scene, &(sag_paraboloid){1, 0, 1, 0, true}));
    sag_affine down = {{{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 1}}};
    cone(&b, 1, 1, &down), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *egg_shell(sag_context *c) {
    builder b = begin(c);
    part(&b, sag_add_ellipsoid(b.scene, &(sag_ellipsoid){{0, 0, 0}, {1, 0.8, 0.6}}));
    part(&b, sag_add_ellipsoid(b.scene, &(sag_ellipsoid){{0, 0, 0}, {0.5, 0.4, 0.3}}));
    step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *half_capsule(sag_context *c) { // cut along
    builder b = begin(c);
    part(&b, sag_add_capsule(b.scene, &(sag_capsule){{-0.6, 0, 0}, {0.6, 0, 0}, 0.4}));
    half_space(&b, zero, (sag_vec3){0, 1, 1}), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *half_brick(sag_context *c) {
    builder b = begin(c);
    sag_oriented_box brick = {{0, 0, 0}, {{0.6, 0.6, 0}, {-0.3, 0.3, 0}, {0, 0, 0.5}}};
    part(&b, sag_add_oriented_box(b.scene, &brick));
    half_space(&b, zero, (sag_vec3){0.2, 0.5, -0.7}), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *bored_hyperboloid(sag_context *c) { // ρ² = (1 + z²)/2 for |z| ≤ 1
    builder b = begin(c);
    part(&b, sag_add_hyperboloid(b.scene, &(sag_hyperboloid){{1, 0, -1}, {0, 1, 1}, 0, true}));
    rod(&b, 2, 0.5, 1, zero), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *reuleaux(sag_context *c) { // of edge 1
    builder b = begin(c);
    double s = sqrt(0.125);
    ball(&b, s, s, s, 1), ball(&b, s, -s, -s, 1), ball(&b, -s, s, -s, 1), ball(&b, -s, -s, s, 1);
    step(&b, SAG_SOLID_INTERSECTION, 4);
    return end(&b);
}
static sag_scene *linked_rings(sag_context *c) {
    builder b = begin(c);
    uint32_t first = sag_add_torus(b.scene, &(sag_torus){1, 0.3}), second;
    second = sag_add_torus(b.scene, &(sag_torus){1, 0.3});
    sag_affine left = sag_affine_translate((sag_vec3){-0.5, 0, 0});
    sag_affine right = {{{1, 0, 0, 0.5}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    sag_geometry_set_transform(b.scene, first, &left), sag_geometry_set_transform(b.scene, second, &right);
    part(&b, first), part(&b, second), step(&b, SAG_SOLID_UNION, 2);
    return end(&b);
}
// Menger's sponge of edge 2, of two steps: bars through the whole cube, whose faces coincide.
static sag_scene *sponge(sag_context *c) {
    builder b = begin(c);
    cube(&b, 1);
    uint32_t bars = 0;
    for (int level = 0; level < 2; level++)
        for (int i = 0; i < (level ? 9 : 1); i++)
            for (int axis = 0; axis < 3; axis++, bars++) {
                double half = level ? 1.0 / 9 : 1.0 / 3, u = (i % 3 - 1) * 2.0 / 3 * level,
                       v = (i / 3 - 1) * 2.0 / 3 * level;
                sag_vec3 low = {u - half, v - half, -1.25}, high = {u + half, v + half, 1.25};
                if (axis == 1)
                    low = (sag_vec3){low.z, low.x, low.y}, high = (sag_vec3){high.z, high.x, high.y};
                if (axis == 2)
                    low = (sag_vec3){low.y, low.z, low.x}, high = (sag_vec3){high.y, high.z, high.x};
                box(&b, low, high);
            }
    step(&b, SAG_SOLID_UNION, bars), step(&b, SAG_SOLID_DIFFERENCE, 2);
    return end(&b);
}
static sag_scene *grid_of_balls(sag_context *c) { // 343 of radius 0.1
    builder b = begin(c);
    for (int i = 0; i < 343; i++)
        ball(&b, 0.25 * (i % 7 - 3), 0.25 * (i / 7 % 7 - 3), 0.25 * (i / 49 - 3), 0.1);
    step(&b, SAG_SOLID_UNION, 343);
    return end(&b);
}
static sag_scene *onion(sag_context *c) { // shells by exclusive or
    builder b = begin(c);
    for (int i = 1; i <= 8; i++) ball(&b, 0, 0, 0, 0.125 * i);
    step(&b, SAG_SOLID_XOR, 8);
    return end(&b);
}
static sag_scene *truncated_octahedron(sag_context *c) { // a cube and |x| + |y| + |z| ≤ 1.5
    builder b = begin(c);
    sag_half_space planes[8];
    for (int i = 0; i < 8; i++)
        planes[i] = (sag_half_space){{i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1}, 1.5};
    cube(&b, 1), part(&b, sag_add_polyhedron(b.scene, &(sag_polyhedron){planes, 8}));
    step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *stretched_lens(sag_context *c) { // an instance of a solid
    builder b = begin(c);
    sag_scene *child = lens(c);
    sag_affine map = sag_affine_scale((sag_vec3){1.5, 0.5, -0.75});
    part(&b, sag_add_instance(b.scene, child, &map));
    sag_scene_destroy(child);
    return end(&b);
}
static sag_scene *hoof(sag_context *c) { // 0 ≤ z ≤ x within the cylinder
    builder b = begin(c);
    rod(&b, 2, 1, 2, zero), half_space(&b, zero, (sag_vec3){0, 0, -1});
    half_space(&b, zero, (sag_vec3){-1, 0, 1}), step(&b, SAG_SOLID_INTERSECTION, 3);
    return end(&b);
}
static sag_scene *sector(sag_context *c) { // of a ball: half angle atan ¾
    builder b = begin(c);
    sag_affine up = {{{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 2}}}; // apex at 0
    ball(&b, 0, 0, 0, 1), cone(&b, 1.5, 2, &up), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}
static sag_scene *two_sheets(sag_context *c) { // z² − ρ² ≥ 1/16, |z| ≤ 1; the caps lie in the cube's faces
    builder b = begin(c);
    part(&b, sag_add_hyperboloid2(b.scene, &(sag_hyperboloid2){0.25, 0.25, -1, 1, 0, true}));
    cube(&b, 1), step(&b, SAG_SOLID_INTERSECTION, 2);
    return end(&b);
}

size_t known_solids(known_solid *list, size_t capacity) {
    const double l = PI * 5 / 12, cap2 = PI * 0.04 * 3.4 / 3; // the lens; a cap of 0.2 of the ball of 1.2
    const double slant = sqrt(1.25), bowl = PI / 6 * (sqrt(125) - 1);
    test_mesh m = test_mesh_sphere(2);
    const double mesh_volume = sag_mesh_volume(&m.mesh);
    test_mesh_free(&m);
    const known_solid table[] = {
        {"Steinmetz' solid of two cylinders", bicylinder, 1.42, 16.0 / 3, 16},
        {"Steinmetz' solid of three cylinders", tricylinder, 1.3, 8 * (2 - sqrt(2)), 24 * (2 - sqrt(2))},
        {"two cylinders without their ball", bicylinder_without_ball, 1.42, 16.0 / 3 - PI * 4 / 3,
         16 + 4 * PI},
        {"cap of a ball", cap, 1, PI * 0.16 * 2.6 / 3, 2 * PI * 0.4 + PI * 0.64},
        {"lens of two balls", lens, 1, l, 2 * PI},
        {"union of two balls", peanut, 1.5, PI * 8 / 3 - l, 6 * PI},
        {"ball without a ball", lune, 1.5, PI * 4 / 3 - l, 4 * PI},
        {"exclusive or of two balls", xor_of_balls, 1.5, PI * 8 / 3 - 2 * l, 8 * PI},
        {"half a torus", half_torus, 1.4, PI * PI * 0.16, 2 * PI * PI * 0.4 + 2 * PI * 0.16},
        {"quarter of a torus", quarter_torus, 1.4, PI * PI * 0.08, PI * PI * 0.4 + 2 * PI * 0.16},
        {"torus sliced flat", sliced_torus, 1.4, PI * PI * 0.16, 2 * PI * PI * 0.4 + 4 * PI * 0.4},
        {"box without a ball", box_without_ball, 1.74, 8 - PI * 4 / 3 * 0.512, 24 + 4 * PI * 0.64},
        {"die", die, 1.2, PI * 4 / 3 * 1.728 - 6 * cap2, 4 * PI * 1.44 - 12 * PI * 0.24 + 6 * PI * 0.44},
        {"cube pierced by a ball", pierced_cube, 1.74, 8 - PI * 4 / 3 * 1.728 + 6 * cap2,
         24 - 6 * PI * 0.44 + 4 * PI * 1.44 - 12 * PI * 0.24},
        {"napkin ring", napkin_ring, 1, PI * 4.096 / 6, 2 * PI * 1.6 * 1.6},
        {"Viviani's body", viviani, 1, PI * 2 / 3 - 8.0 / 9, 2 * PI},
        {"frustum of a cone", frustum, 1.15, PI * 7 / 12, PI * (1.25 + 1.5 * slant)},
        {"tube", tube, 1.42, 2 * PI * 0.51, 4 * PI * 1.7 + 2 * PI * 0.51},
        {"exclusive or of two boxes", xor_of_boxes, 2.6, 14, 48},
        {"hollow ball", hollow_ball, 1, PI * 4 / 3 * 0.488, 4 * PI * 1.64},
        {"mesh without a corner", mesh_without_corner, 1.74, 7, 24},
        {"half a mesh", half_mesh, 1, 0.5 * mesh_volume, 0},
        {"paraboloid without a cone", bowl_without_cone, 1.42, PI / 6, bowl + PI * sqrt(2)},
        {"ellipsoid without an ellipsoid", egg_shell, 1, PI * 4 / 3 * 0.48 * 7 / 8, 0},
        {"half a capsule", half_capsule, 1, PI * (0.096 + 0.064 * 2 / 3),
         2 * PI * 0.4 * 0.6 + 2 * PI * 0.16 + 0.96 + PI * 0.16},
        {"half an oblique brick", half_brick, 1.1, 0.72, 0},
        {"bored hyperboloid", bored_hyperboloid, 1.42, PI * (4.0 / 3 - 0.5), 0},
        {"Reuleaux' tetrahedron", reuleaux, 0.62, (3 * sqrt(2) - 49 * PI + 162 * atan(sqrt(2))) / 12,
         8 * PI - 18 * acos(1.0 / 3)},
        {"two linked rings", linked_rings, 1.8, 4 * PI * PI * 0.09, 8 * PI * PI * 0.3},
        {"Menger's sponge", sponge, 1.74, 8 * 400.0 / 729, 4 * (2 * 400.0 / 81 + 4 * 64.0 / 81)},
        {"grid of balls", grid_of_balls, 1.42, 343 * PI * 0.004 / 3, 343 * PI * 0.04},
        {"shells by exclusive or", onion, 1, PI * 4 / 3 * (512 - 343 + 216 - 125 + 64 - 27 + 8 - 1) / 512,
         4 * PI * 204 / 64},
        {"truncated octahedron", truncated_octahedron, 1.2, 4, 3 + 6 * sqrt(3)},
        {"lens stretched", stretched_lens, 0.9, l * 0.5625, 0},
        {"hoof of a cylinder", hoof, 1.42, 2.0 / 3, 2 + PI / 2 * (1 + sqrt(2))},
        {"sector of a ball", sector, 1, PI * 2 / 3 * 0.2, PI * 0.4 + PI * 0.6},
        {"hyperboloid of two sheets", two_sheets, 1.4, PI * 0.5625, 0},
    };
    size_t count = sizeof table / sizeof *table;
    for (size_t i = 0; i < count && i < capacity; i++) list[i] = table[i];
    return count;
}
