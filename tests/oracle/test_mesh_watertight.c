// SPDX-License-Identifier: MIT
// Closed meshes do not leak: a ray through any vertex, any point of an edge or any centroid crosses them as
// often as a surface without cracks. Every line crosses a closed surface an even number of times, as often
// against the normals as along them; a ray from inside an odd number of times; and of the triangles around a
// vertex seen from a point inside a star-shaped mesh exactly one takes the ray. Guards embree #181, #188,
// #381, #387 and the set-up of its own verify.cpp (WatertightTest: the sphere at (148376, 1234, −223423)),
// where two misses in 100,000 are allowed; trimesh #1496 and #2317 (a box's edges counted twice); pbrt's
// Triangle.Watertight.
#include "support/meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static size_t ray_count, leak_count;

static sag_vec3 vertex(const sag_mesh *m, uint32_t i) {
    return sag_vec3_make(m->positions_f64[3 * i], m->positions_f64[3 * i + 1], m->positions_f64[3 * i + 2]);
}

// A line: crossings to and fro must balance.
static void check_line(const sag_mesh *m, sag_vec3 origin, sag_vec3 direction) {
    sag_ray ray = {.origin = origin, .direction = direction, .t_min = -INFINITY, .t_max = INFINITY};
    if (!sag_ray_is_valid(&ray)) return;
    sag_mesh front = *m;
    front.one_sided = true;
    size_t all = sag_mesh_crossings(m, &ray, NULL, 0), entering = sag_mesh_crossings(&front, &ray, NULL, 0);
    ray_count++;
    leak_count += all != 2 * entering;
}

// A ray from inside a star-shaped mesh: out once.
static void check_star(const sag_mesh *m, sag_vec3 inside, sag_vec3 target) {
    sag_ray ray = sag_ray_make(inside, sag_sub(target, inside));
    ray_count++;
    leak_count += sag_mesh_crossings(m, &ray, NULL, 0) != 1;
}

static void check_parity(const sag_mesh *m, sag_vec3 inside, sag_vec3 target) {
    sag_ray ray = sag_ray_make(inside, sag_sub(target, inside));
    ray_count++;
    leak_count += sag_mesh_crossings(m, &ray, NULL, 0) % 2 != 1;
}

typedef void check_function(const sag_mesh *, sag_vec3, sag_vec3);

static void check_targets(const sag_mesh *m, sag_vec3 from, check_function *check, rng *r) {
    for (uint32_t i = 0; i < m->vertex_count; i++) check(m, from, vertex(m, i));
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        sag_vec3 p[3];
        for (int k = 0; k < 3; k++) p[k] = vertex(m, m->triangles[3 * i + (uint32_t)k]);
        for (int k = 0; k < 3; k++) {
            sag_vec3 edge = sag_sub(p[(k + 1) % 3], p[k]);
            check(m, from, sag_madd(p[k], 0.5, edge));
            check(m, from, sag_madd(p[k], rng_unit(r), edge));
        }
        check(m, from, sag_scale(sag_add(sag_add(p[0], p[1]), p[2]), 1.0 / 3));
    }
}

// A line through every vertex, edge and centroid from a point anywhere, in units of the mesh's size.
static void line_from(const sag_mesh *m, sag_vec3 from, sag_vec3 target) {
    check_line(m, from, sag_sub(target, from));
}

static void finish(const char *name) {
    printf("%-44s %8zu rays, %zu leaks\n", name, ray_count, leak_count);
    assert_int_equal(leak_count, 0);
    ray_count = leak_count = 0;
}

static void all_checks(test_mesh *t, const char *name, bool star, sag_vec3 inside, double size, rng *r) {
    check_targets(&t->mesh, inside, star ? check_star : check_parity, r);
    for (size_t i = 0, n = soak(2); i < n; i++) {
        sag_vec3 from = sag_madd(inside, size * rng_log_uniform(r, 0.1, 1e5), rng_direction(r));
        check_targets(&t->mesh, from, line_from, r);
    }
    finish(name);
    test_mesh_free(t);
}

static void test_spheres(void **state) {
    (void)state;
    rng r = rng_make(1);
    test_mesh t = test_mesh_sphere(3);
    all_checks(&t, "sphere of 1,280", true, (sag_vec3){0, 0, 0}, 1, &r);
    t = test_mesh_sphere(3);
    test_mesh_move(&t, 1, (sag_vec3){148376, 1234, -223423}, 0, &r);
    all_checks(&t, "embree-watertight: sphere far off", true, (sag_vec3){148376, 1234, -223423}, 1, &r);
    t = test_mesh_sphere(2);
    test_mesh_move(&t, 1e-9, (sag_vec3){1e-3, -2e-3, 3e-3}, 0.05, &r);
    all_checks(&t, "rough sphere of a nanometre", true, (sag_vec3){1e-3, -2e-3, 3e-3}, 1e-9, &r);
    t = test_mesh_sphere(2);
    test_mesh_move(&t, 1e9, (sag_vec3){1e11, 0, -1e10}, 0.05, &r);
    all_checks(&t, "embree-416: sphere of 1e9 at 1e11", true, (sag_vec3){1e11, 0, -1e10}, 1e9, &r);
}

static void test_torus(void **state) {
    (void)state;
    rng r = rng_make(2);
    test_mesh t = test_mesh_torus(24, 16);
    all_checks(&t, "torus of 768", false, (sag_vec3){1, 0, 0}, 1, &r);
    t = test_mesh_torus(24, 16);
    test_mesh_move(&t, 1, (sag_vec3){0, 0, 0}, 0.05, &r);
    all_checks(&t, "rough torus of 768", false, (sag_vec3){1, 0, 0}, 1, &r);
}

// On small integers nearly every line meets vertices and edges exactly, runs along edges, lies in faces.
static void test_ties(void **state) {
    (void)state;
    rng r = rng_make(3);
    test_mesh t = test_mesh_cube();
    for (int ox = -3; ox <= 3; ox++)
        for (int oy = -3; oy <= 3; oy++)
            for (int oz = -3; oz <= 3; oz++)
                for (int d = 0; d < 125; d++) {
                    sag_vec3 direction = {d % 5 - 2, d / 5 % 5 - 2, d / 25 - 2}, origin = {ox, oy, oz};
                    check_line(&t.mesh, origin, direction);
                    if (abs(ox) + abs(oy) + abs(oz) != 0) continue;
                    if (sag_dot(direction, direction) > 0) check_star(&t.mesh, origin, direction);
                }
    finish("trimesh-1496: cube on the integer grid");
    test_mesh_free(&t);

    t = test_mesh_sphere(2); // rounded to a grid of eighths: many coplanar and some folded faces
    for (uint32_t i = 0; i < 3 * t.mesh.vertex_count; i++) t.positions[i] = round(8 * t.positions[i]);
    for (size_t i = 0, n = soak(20000); i < n; i++) {
        sag_vec3 o = {(int)rng_below(&r, 25) - 12, (int)rng_below(&r, 25) - 12, (int)rng_below(&r, 25) - 12};
        sag_vec3 d = {(int)rng_below(&r, 7) - 3, (int)rng_below(&r, 7) - 3, (int)rng_below(&r, 7) - 3};
        check_line(&t.mesh, o, d);
    }
    finish("sphere on the integer grid");
    test_mesh_free(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_spheres), cmocka_unit_test(test_torus),
                                       cmocka_unit_test(test_ties)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
