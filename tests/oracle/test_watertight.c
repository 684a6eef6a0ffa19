// SPDX-License-Identifier: MIT
// Closed meshes do not leak: a line that passes through vertices, edges and faces crosses them evenly often,
// a ray from inside oddly often. The rays go through the points exactly: origins and directions are chosen so
// that the doubles are exact, not merely near.
#include "support/context.h"
#include "support/mesh_file.h"
#include "support/meshes.h"
#include <math.h>
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static sag_vec3 vertex(const sag_mesh *m, uint32_t i) {
    if (m->positions_f64)
        return sag_vec3_make(m->positions_f64[3 * i], m->positions_f64[3 * i + 1],
                             m->positions_f64[3 * i + 2]);
    return sag_vec3_make(m->positions_f32[3 * i], m->positions_f32[3 * i + 1], m->positions_f32[3 * i + 2]);
}

// The line through `point` in a random direction, exactly: the direction has 20 bits a coordinate and is
// scaled by a power of two so that the sum with the point is exact for positions of float precision.
static sag_ray line_through(rng *r, sag_vec3 point, double size) {
    int exponent;
    frexp(size, &exponent);
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = ldexp((double)rng_below(r, 1 << 20) - (1 << 19), exponent - 19);
    if (rng_one_in(r, 6)) d[rng_below(r, 3)] = 0;
    if (rng_one_in(r, 12)) d[rng_below(r, 3)] = 0;
    sag_ray ray =
        sag_ray_make(point, sag_vec3_make(d[0], d[1], d[2] != 0 || d[1] != 0 || d[0] != 0 ? d[2] : size));
    // The origin stays at the point, or moves along the line by whole directions.
    int away = (int)rng_below(r, 3);
    ray.origin = sag_madd(ray.origin, -away, ray.direction);
    ray.t_min = -INFINITY;
    return ray;
}

typedef struct tally {
    size_t rays, leaks;
} tally;

static void check_even(const sag_scene *scene, const sag_ray *ray, tally *t) {
    sag_hit hits[64];
    size_t count = sag_intersect_all(scene, ray, hits, 64);
    t->rays++;
    t->leaks += count % 2;
    for (size_t i = 1; i < count && i < 64; i++) { // no triangle twice, in order
        assert_true(hits[i - 1].t <= hits[i].t);
        assert_false(hits[i - 1].t == hits[i].t && hits[i - 1].primitive == hits[i].primitive);
    }
    sag_hit first;
    assert_int_equal(sag_intersect(scene, ray, &first), count > 0);
    if (count > 0) assert_memory_equal(&first.t, &hits[0].t, sizeof first.t);
    assert_int_equal(sag_occluded(scene, ray), count > 0);
}

// Lines through the vertices, edges and middle of every face, or of about `faces` of them when there are
// more.
static void check_mesh(const char *name, const sag_mesh *mesh, size_t faces, uint64_t seed) {
    rng r = rng_make(seed);
    sag_scene *scene = scene_of(mesh);
    sag_box3 box = sag_scene_bounds(scene);
    double size = sag_max_component(sag_sub(box.max, box.min));
    tally t = {0, 0};
    uint32_t step = mesh->triangle_count > faces ? (uint32_t)(mesh->triangle_count / faces) : 1;
    for (uint32_t i = rng_below(&r, step); i < mesh->triangle_count; i += step) {
        sag_vec3 p[3];
        for (int k = 0; k < 3; k++) p[k] = vertex(mesh, mesh->triangles[3 * (size_t)i + k]);
        for (int k = 0; k < 3; k++) {
            sag_ray ray = line_through(&r, p[k], size);
            check_even(scene, &ray, &t);
            ray = line_through(&r, sag_scale(sag_add(p[k], p[(k + 1) % 3]), 0.5), size);
            check_even(scene, &ray, &t);
            // along the edge itself, and from the vertex of one face to that of another
            ray.origin = p[k], ray.direction = sag_sub(p[(k + 1) % 3], p[k]);
            if (sag_length(ray.direction) > 0) check_even(scene, &ray, &t);
            ray.direction = sag_sub(vertex(mesh, rng_below(&r, mesh->vertex_count)), p[k]);
            if (sag_length(ray.direction) > 0) check_even(scene, &ray, &t);
        }
        sag_vec3 middle = sag_scale(sag_add(p[0], sag_add(p[1], p[2])), 1.0 / 3);
        sag_ray ray = line_through(&r, middle, size);
        check_even(scene, &ray, &t);
    }
    printf("%s: %u triangles, %zu lines, %zu leaks\n", name, mesh->triangle_count, t.rays, t.leaks);
    assert_int_equal(t.leaks, 0);
    sag_scene_destroy(scene);
}

static void generated(void **state) {
    (void)state;
    rng r = rng_make(1);
    for (int scale = -9; scale <= 9; scale += 3) {
        double s = pow(10, scale);
        test_mesh m = test_mesh_sphere(3);
        test_mesh_move(&m, s, sag_scale(rng_direction(&r), 3 * s), 0, &r);
        check_mesh("sphere", &m.mesh, m.mesh.triangle_count, 2);
        test_mesh_free(&m);
        m = test_mesh_torus(40, 30);
        test_mesh_move(&m, s, sag_scale(rng_direction(&r), 3 * s), 0.01, &r);
        check_mesh("torus", &m.mesh, m.mesh.triangle_count, 3);
        test_mesh_free(&m);
    }
    test_mesh cube = test_mesh_cube();
    for (uint64_t seed = 0; seed < 40; seed++) check_mesh("cube", &cube.mesh, 12, seed);
    test_mesh_free(&cube);
}

// Embree's verify.cpp, WatertightTest: a sphere far from the origin, rays from its middle; not one may get
// out (Embree allows 2e-5). And the lines through the middle and the vertices.
static void embree_watertight(void **state) {
    (void)state;
    rng r = rng_make(4);
    test_mesh m = test_mesh_sphere(4);
    sag_vec3 center = {148376, 1234, -223423};
    test_mesh_move(&m, 2, center, 0, &r);
    float *positions = malloc(3 * (size_t)m.mesh.vertex_count * sizeof *positions);
    for (uint32_t i = 0; i < 3 * m.mesh.vertex_count; i++) positions[i] = (float)m.positions[i];
    m.mesh.positions_f32 = positions, m.mesh.positions_f64 = NULL;
    sag_scene *scene = scene_of(&m.mesh);
    size_t leaks = 0, count = soak(200000);
    for (size_t i = 0; i < count; i++) {
        sag_vec3 o = sag_add(center, rng_vec3(&r, 0.5));
        sag_vec3 target = vertex(&m.mesh, rng_below(&r, m.mesh.vertex_count));
        sag_ray ray = sag_ray_make(o, i % 2 ? rng_direction(&r) : sag_sub(target, o));
        sag_hit hit;
        leaks += !sag_intersect(scene, &ray, &hit) || sag_count_crossings(scene, &ray) != 1;
    }
    printf("embree-watertight: %zu rays, %zu leaks\n", count, leaks);
    assert_int_equal(leaks, 0);
    sag_scene_destroy(scene);
    free(positions);
    test_mesh_free(&m);
}

// The meshes beside the project that are closed.
static void scanned(void **state) {
    (void)state;
    static const char *const names[] = {"stanford-bunny.obj", "spot.obj",      "suzanne.obj", "teapot.obj",
                                        "fandisk.obj",        "nefertiti.obj", "dragon.ply"};
    size_t checked = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        mesh_file f;
        if (!mesh_file_load(names[i], &f)) continue;
        sag_mesh_report report;
        assert_int_equal(sag_mesh_check(context, &f.mesh, &report, NULL), SAG_OK);
        if (report.closed)
            check_mesh(names[i], &f.mesh, soak(4000), 5), checked++;
        else
            printf("%s is not closed\n", names[i]);
        mesh_file_free(&f);
    }
    if (checked == 0) skip();
}

// tinybvh-168: a grid of rays at the dragon. Between an entry and an exit no ray may slip through: every
// count is even, and a ray whose neighbours all hit deep inside the silhouette hits.
static void tinybvh_168(void **state) {
    (void)state;
    mesh_file f;
    if (!mesh_file_load("dragon.ply", &f)) skip();
    sag_scene *scene = scene_of(&f.mesh);
    sag_box3 box = sag_scene_bounds(scene);
    sag_vec3 extent = sag_sub(box.max, box.min);
    size_t leaks = 0;
    int n = 200;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            sag_vec3 o = {box.min.x + extent.x * i / n, box.min.y + extent.y * j / n, box.max.z + extent.z};
            sag_ray ray = sag_ray_make(o, sag_vec3_make(0, 0, -1));
            leaks += sag_count_crossings(scene, &ray) % 2;
        }
    assert_int_equal(leaks, 0);
    sag_scene_destroy(scene);
    mesh_file_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(generated),
        cmocka_unit_test(embree_watertight),
        cmocka_unit_test(scanned),
        cmocka_unit_test(tinybvh_168),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
