// SPDX-License-Identifier: MIT
// PLY files, as pbrt's Shape "plymesh" reads them: text and binary, whole and cut short.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/scene_text.h"

#define W "WorldBegin\n"

static sag_status load_ply(const void *bytes, size_t size, sag_world **world, sag_error *error) {
    scene_write("mesh.ply", bytes, size);
    return scene_load(W "Shape \"plymesh\" \"string filename\" \"mesh.ply\"", world, error);
}

static void ply_fails(const char *text, int line, int column, const char *what) {
    sag_world *world;
    sag_error error;
    if (load_ply(text, strlen(text), &world, &error) == SAG_OK) fail_msg("loaded: %s", text);
    if (error.line != line || error.column != column || !strstr(error.message, what))
        fail_msg("%d:%d: %s\nwanted %d:%d: %s\nfor %s", error.line, error.column, error.message, line, column,
                 what, text);
    assert_non_null(strstr(error.file, "mesh.ply"));
    sag_world_destroy(world);
}

#define PLY_HEAD                                                                                             \
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty "      \
    "float z\nproperty uchar red\n"                                                                          \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"

static void test_ply(void **state) {
    (void)state;
    const char *quad = PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2 3\n";
    sag_world *world;
    sag_error error;
    if (load_ply(quad, strlen(quad), &world, &error) != SAG_OK) fail_msg("%s", error.message);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    scene_near(scene_shoot(world, 0.75, 0.5, 2, 0, 0, -1), 2);
    scene_near(scene_shoot(world, 0.25, 0.5, 2, 0, 0, -1), 2);
    sag_world_destroy(world);
    // Blender 2.4 forgot the word "comment".
    static const char old[] =
        "ply\nformat ascii 1.0\nCreated by Blender3D 247\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_int_equal(load_ply(old, sizeof old - 1, &world, &error), SAG_OK);
    sag_world_destroy(world);
    const char *nan_vertex = PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\nnan 1 0 255\n4 0 1 2 3\n";
    assert_int_equal(load_ply(nan_vertex, strlen(nan_vertex), &world, &error), SAG_OK);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
    sag_scene_stats stats;
    sag_scene_get_stats(sag_world_scene(world), &stats);
    assert_true(stats.dropped_not_finite == 1 && stats.primitive_count == 1);
    sag_world_destroy(world);

    ply_fails("nope", 1, 1, "not a PLY file");
    ply_fails("ply\nformat ascii 1.0\n", 3, 1, "no end_header");
    ply_fails("ply\nformat binary_middle_endian 1.0\nend_header\n", 2, 1, "unknown format");
    ply_fails("ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", 3, 1, "NAME COUNT");
    ply_fails("ply\nformat ascii 1.0\nelement vertex 3\nproperty list float\nend_header\n", 4, 1,
              "property TYPE NAME");
    ply_fails("ply\nformat ascii 1.0\nwhat\nend_header\n", 3, 1, "unknown word");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 x 255\n0 1 0 255\n4 0 1 2 3\n", 14, 5, "a number expected");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2", 16, 8, "cut short");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 9 3\n", 16, 7,
              "index 9 is out of range: there are 4 vertices");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 -1 3\n", 16, 7,
              "no natural number");
    ply_fails(PLY_HEAD "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n2 0 1\n", 0, 0, "no triangles");
    ply_fails("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float "
              "y\nproperty float z\nend_header\n0 0 0",
              8, 6, "cut short");
}

// Binary in both byte orders, with doubles and every prefix of it.
static void test_binary_ply(void **state) {
    (void)state;
    for (int big = 0; big < 2; big++) {
        char bytes[1024];
        size_t size = (size_t)sprintf(
            bytes,
            "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty double x\nproperty double "
            "y\nproperty double z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n"
            "element face 1\nproperty list uchar uint vertex_indices\nproperty int "
            "face_indices\nend_header\n",
            big ? "big" : "little");
        const size_t header = size;
        const double positions[9] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0};
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                uint64_t bits;
                memcpy(&bits, &positions[3 * i + k], 8);
                for (int b = 0; b < 8; b++) bytes[size++] = (char)(bits >> (8 * (big ? 7 - b : b)));
            }
            memset(bytes + size, 0, 20);
            size += 20;
        }
        bytes[size++] = 3;
        for (int i = 0; i < 4; i++)
            for (int b = 0; b < 4; b++) bytes[size++] = (char)((b == (big ? 3 : 0)) ? i % 3 : 0);
        sag_world *world;
        sag_error error;
        if (load_ply(bytes, size, &world, &error) != SAG_OK) fail_msg("%s", error.message);
        assert_int_equal(sag_scene_commit(sag_world_scene(world), NULL), SAG_OK);
        scene_near(sag_scene_bounds(sag_world_scene(world)).max.x, 0.1); // not a float's 0.1
        sag_world_destroy(world);
        for (size_t cut = 0; cut < size; cut++) {
            assert_int_equal(load_ply(bytes, cut, &world, &error), SAG_ERROR_FORMAT);
            if (cut >= header) assert_non_null(strstr(error.message, "cut short"));
            sag_world_destroy(world);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ply),
        cmocka_unit_test(test_binary_ply),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
