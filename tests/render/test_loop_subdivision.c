// SPDX-License-Identifier: MIT
// Loop's subdivision: symmetric cages have limits that can be worked out, a plane stays a plane, many levels
// and few end on the same surface, and no cage, however broken, does harm.
#include "formats/loop_subdivision.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

static sagi_mesh_data mesh_of(const double *positions, uint32_t vertex_count, const uint32_t *triangles,
                              uint32_t triangle_count) {
    sagi_mesh_data m = {.context = scene_context, .vertex_count = vertex_count};
    m.positions_f64 = sag_allocate(scene_context, 3 * vertex_count * sizeof(double));
    memcpy(m.positions_f64, positions, 3 * vertex_count * sizeof(double));
    for (uint32_t i = 0; i < triangle_count; i++)
        assert_true(sagi_mesh_data_add(&m, triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]));
    return m;
}

static sagi_mesh_data divided(sagi_mesh_data *cage, uint32_t levels, uint32_t borders_wanted) {
    sagi_mesh_data out = {.context = scene_context};
    uint32_t borders;
    assert_true(sagi_loop_subdivide(cage, levels, &out, &borders));
    assert_int_equal(borders, borders_wanted);
    uint64_t count = cage->triangle_count;
    for (uint32_t i = 0; i < levels; i++) count *= 4;
    assert_int_equal(out.triangle_count, count);
    for (size_t i = 0; i < 3 * count; i++) assert_true(out.triangles[i] < out.vertex_count);
    return out;
}

static const double octahedron[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
static const uint32_t octahedron_sides[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                              2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

// The vertices of an octahedron have four neighbours, whose mean is the centre: β = 3/32, so the limit weight
// is 1/(4 + 4) = 1/8 and a vertex ends at 1/2 of where it was, at all levels alike.
static void octahedron_has_its_limit(void **state) {
    (void)state;
    sagi_mesh_data cage = mesh_of(octahedron, 6, octahedron_sides, 8);
    for (uint32_t levels = 0; levels < 5; levels++) {
        sagi_mesh_data m = divided(&cage, levels, 0);
        assert_int_equal(m.vertex_count, m.triangle_count / 2 + 2); // Euler
        for (size_t i = 0; i < 6; i++)
            for (size_t k = 0; k < 3; k++) {
                assert_true(fabs(m.positions_f64[3 * i + k] - octahedron[3 * i + k] / 2) < 1e-14);
                assert_true(fabs((double)m.normals[3 * i + k] + octahedron[3 * i + k]) < 1e-6);
            }
        for (size_t i = 0; i < m.vertex_count; i++) { // inward as pbrt's, and no surprise between
            const double *q = m.positions_f64 + 3 * i;
            const float *n = m.normals + 3 * i;
            const double r = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
            assert_true(r > 0.28 && r < 0.51);
            assert_true(((double)n[0] * q[0] + (double)n[1] * q[1] + (double)n[2] * q[2]) / r < -0.9);
        }
        sagi_mesh_data_clear(&m);
    }
    sagi_mesh_data_clear(&cage);
}

// A vertex of any level stays where it is on the limit surface when the level is divided again, and so does
// its normal. (Not on a border, where pbrt's weight of 1/5 is not quite that of the limit.)
static void levels_agree(void **state) {
    (void)state;
    const double tetrahedron[12] = {0, 0, 0, 2, 0.1, 0, 0.3, 1.7, 0, 0.4, 0.5, 1.9};
    const uint32_t closed[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    sagi_mesh_data cage = mesh_of(tetrahedron, 4, closed, 4);
    sagi_mesh_data coarse = divided(&cage, 2, 0), fine = divided(&cage, 4, 0);
    for (size_t i = 0; i < coarse.vertex_count; i++)
        for (size_t k = 0; k < 3; k++) {
            assert_true(fabs(coarse.positions_f64[3 * i + k] - fine.positions_f64[3 * i + k]) < 1e-13);
            assert_true(fabs((double)coarse.normals[3 * i + k] - (double)fine.normals[3 * i + k]) < 1e-5);
        }
    sagi_mesh_data_clear(&cage), sagi_mesh_data_clear(&coarse), sagi_mesh_data_clear(&fine);
}

// A flat sheet with vertices of all kinds stays flat, its corners are cut, and every normal is the same.
static void planes_stay_planes(void **state) {
    (void)state;
    enum { N = 6 };
    double positions[3 * N * N];
    uint32_t triangles[6 * (N - 1) * (N - 1)], count = 0;
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) {
            double *q = positions + 3 * (N * j + i);
            q[0] = i + 0.1 * ((i * 7 + j * 3) % 5), q[1] = j + 0.1 * ((i * 3 + j * 5) % 7), q[2] = 3;
        }
    for (uint32_t j = 0; j + 1 < N; j++)
        for (uint32_t i = 0; i + 1 < N; i++) {
            const uint32_t a = N * j + i, b = a + 1, c = a + N, d = c + 1, flip = (i * 3 + j) % 2;
            const uint32_t two[6] = {a, b, flip ? c : d, flip ? b : a, d, c};
            memcpy(triangles + 3 * count, two, sizeof two);
            count += 2;
        }
    sagi_mesh_data cage = mesh_of(positions, N * N, triangles, count), m = divided(&cage, 3, 0);
    for (size_t i = 0; i < m.vertex_count; i++) {
        assert_true(fabs(m.positions_f64[3 * i + 2] - 3) < 1e-13);
        assert_true((double)m.normals[3 * i + 2] < -0.999999);
    }
    sagi_mesh_data_clear(&cage), sagi_mesh_data_clear(&m);
}

// Edges of three triangles, triangles turned against their neighbours, corners that are the same, vertices of
// no triangle: told, and never a walk that does not end.
static void broken_cages(void **state) {
    (void)state;
    const double book[15] = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0};
    const uint32_t three[9] = {0, 1, 2, 1, 0, 3, 0, 1, 4}, turned[6] = {0, 1, 2, 0, 1, 3};
    sagi_mesh_data cage = mesh_of(book, 5, three, 3), m = divided(&cage, 2, 1);
    sagi_mesh_data_clear(&cage), sagi_mesh_data_clear(&m);
    cage = mesh_of(book, 5, turned, 2), m = divided(&cage, 2, 1);
    sagi_mesh_data_clear(&cage), sagi_mesh_data_clear(&m);
    uint32_t random = 1;
    for (int round = 0; round < 300; round++) {
        double positions[30];
        uint32_t triangles[60], borders;
        for (int i = 0; i < 30; i++) positions[i] = (random = random * 1664525u + 1013904223u) >> 20;
        const uint32_t count = 1 + round % 20;
        for (uint32_t i = 0; i < 3 * count; i++)
            triangles[i] = ((random = random * 1664525u + 1013904223u) >> 16) % (3 + (uint32_t)round % 8);
        cage = mesh_of(positions, 10, triangles, count);
        sagi_mesh_data out = {.context = scene_context};
        assert_true(sagi_loop_subdivide(&cage, 3, &out, &borders));
        for (size_t i = 0; i < 3 * (size_t)out.triangle_count; i++)
            assert_true(out.triangles[i] < out.vertex_count);
        sagi_mesh_data_clear(&cage), sagi_mesh_data_clear(&out);
    }
}

#define CAGE                                                                                                 \
    "\"point3 P\" [1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1] \"integer indices\" "                             \
    "[0 2 4 2 1 4 1 3 4 3 0 4 2 0 5 1 2 5 3 1 5 0 3 5]"

static void in_a_scene(void **state) {
    (void)state;
    sag_world *world = scene_load_good("WorldBegin\nShape \"loopsubdiv\" " CAGE);
    assert_int_equal(scene_warning_count, 0);
    assert_true(fabs(scene_shoot(world, 0, 0, -5, 0, 0, 1) - 4.5) < 1e-9);
    const void *mesh;
    assert_int_equal(sag_geometry_get(sag_world_scene(world), 0, NULL, &mesh), SAG_OK);
    assert_int_equal(((const sag_mesh *)mesh)->triangle_count, 8 * 64); // three levels, as pbrt
    sag_world_destroy(world);
    world = scene_load_good(
        "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 0 1 0 0 0 1 0 "
        "0 0 1] \"integer indices\" [0 1 2 0 1 3] \"point2 uv\" [0 0 1 0 0 1 1 1]");
    assert_int_equal(scene_warning_count, 2);
    assert_non_null(strstr(scene_warnings, ":2:1: warning: Shape \"loopsubdiv\": its \"N\" and \"uv\""));
    assert_non_null(strstr(scene_warnings, "1 edges of more than two triangles"));
    sag_world_destroy(world);
    scene_fails("WorldBegin\nShape \"loopsubdiv\" \"integer levels\" -1 " CAGE, 2, 20, "levels -1");
    scene_fails("WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 30 " CAGE, 2, 20, "30 levels make more");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(octahedron_has_its_limit),
        cmocka_unit_test(levels_agree),
        cmocka_unit_test(planes_stay_planes),
        cmocka_unit_test(broken_cages),
        cmocka_unit_test(in_a_scene),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
