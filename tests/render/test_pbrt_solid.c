// SPDX-License-Identifier: MIT
// SolidBegin … SolidEnd in scene files: what is read stands where it should, under any block, transform and
// object; what cannot be a part of a solid is an error with its place.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/world.h"
#include "support/scene_text.h"

#define W "WorldBegin\n"

// The crossings of a ray along +z through (x, y): a solid's boundary, from z = −50.
static void crosses(const char *text, double x, double y, size_t count, const double *wanted) {
    sag_world *world = scene_load_good(text);
    const sag_ray ray = sag_ray_make(sag_vec3_make(x, y, -50), sag_vec3_make(0, 0, 1));
    sag_hit hits[16];
    const size_t found = sag_intersect_all(sag_world_scene(world), &ray, hits, 16);
    if (found != count) fail_msg("%zu crossings, not %zu, of\n%s", found, count, text);
    for (size_t i = 0; i < count; i++) {
        if (!(fabs(hits[i].t - 50 - wanted[i]) < 1e-9))
            fail_msg("crossing %zu at %.17g, not %g, of\n%s", i, hits[i].t - 50, wanted[i], text);
        sag_surface surface; // normals point out of the solid
        sag_surface_at(sag_world_scene(world), &ray, &hits[i], &surface);
        assert_true((surface.geometric_normal.z < 0) == (i % 2 == 0));
    }
    if (scene_warning_count) fail_msg("%s of\n%s", scene_warnings, text);
    sag_world_destroy(world);
}
#define CROSSES(text, x, y, ...)                                                                             \
    crosses(text, x, y, sizeof((const double[]){__VA_ARGS__}) / sizeof(double), (const double[]){__VA_ARGS__})

#define BOX(lower, upper) " Shape \"box\" \"point3 min\" [-1 -1 " lower "] \"point3 max\" [1 1 " upper "]\n"
#define BALL              " Shape \"sphere\" \"float radius\" 0.5\n"

static void test_operations(void **state) {
    (void)state;
    CROSSES(W "SolidBegin \"union\"" BOX("0", "2") BOX("1", "3") "SolidEnd", 0.1, 0.1, 0, 3);
    CROSSES(W "SolidBegin \"intersection\"" BOX("0", "2") BOX("1", "3") "SolidEnd", 0.1, 0.1, 1, 2);
    CROSSES(W "SolidBegin \"difference\"" BOX("0", "2") BOX("1", "3") "SolidEnd", 0.1, 0.1, 0, 1);
    CROSSES(W "SolidBegin \"xor\"" BOX("0", "2") BOX("1", "3") "SolidEnd", 0.1, 0.1, 0, 1, 2, 3);
    CROSSES(W "SolidBegin \"union\"" BOX("0", "2") "SolidEnd", 0.1, 0.1, 0, 2); // one operand
    CROSSES(W "SolidBegin \"difference\"" BOX("0", "9") BOX("1", "2") BOX("4", "5") "SolidEnd", 0.1, 0.1, 0,
            1, 2, 4, 5, 9);
    // Nested: (0…9 − (2…7 − 4…5)) ∪ 20…21
    CROSSES(W "SolidBegin \"union\" SolidBegin \"difference\"" BOX("0", "9") "SolidBegin \"difference\"" BOX(
                "2", "7") BOX("4", "5") "SolidEnd SolidEnd" BOX("20", "21") "SolidEnd",
            0.1, 0.1, 0, 2, 4, 5, 7, 9, 20, 21);
    // Several solids, one beside a plain shape.
    CROSSES(W "SolidBegin \"difference\"" BOX("0", "2")
                BOX("1", "3") "SolidEnd SolidBegin \"xor\"" BOX("5", "6") "SolidEnd" BOX("8", "9"),
            0.1, 0.1, 0, 1, 5, 6, 8, 9);
}

static void test_transforms_and_blocks(void **state) {
    (void)state;
    // Blocks within and around; what is in a solid does not leak.
    CROSSES(W "AttributeBegin Translate 0 0 10 Scale 1 1 2 SolidBegin \"difference\"" BOX(
                "0", "2") "AttributeBegin Translate 0 0 1" BALL
                          "AttributeEnd Translate 0 0 7 SolidEnd AttributeEnd" BOX("0", "1"),
            0, 0, 0, 1, 10, 11, 13, 14);
    CROSSES(W "Translate 0 0 10 SolidBegin \"union\" TransformBegin Translate 0 0 5" BALL "TransformEnd" BALL
              "SolidEnd",
            0, 0, 9.5, 10.5, 14.5, 15.5);
    // Transforms that are set and not multiplied are the world's.
    CROSSES(W "Translate 0 0 10 SolidBegin \"union\" Identity" BALL
              "Transform [1 0 0 0  0 1 0 0  0 0 1 0  0 0 3 1]" BALL "SolidEnd",
            0, 0, -0.5, 0.5, 2.5, 3.5);
    CROSSES(W "Translate 0 0 10 CoordinateSystem \"here\" Translate 0 0 10 SolidBegin \"union\" "
              "CoordSysTransform \"here\"" BALL "Translate 0 0 4 CoordinateSystem \"there\" SolidEnd "
              "CoordSysTransform \"there\" SolidBegin \"xor\"" BALL "SolidEnd",
            0, 0, 9.5, 10.5, 13.5, 14.5);
    // Faces that touch far from the origin, too, leave neither gap nor sliver.
    CROSSES(
        W "Translate 1e6 3e7 0.1 SolidBegin \"union\" AttributeBegin Translate 0 0 0.3" BOX(
            "0", "0.7") "AttributeEnd AttributeBegin Translate 0 0 1" BOX("0", "1") "AttributeEnd SolidEnd",
        1e6, 3e7, 0.4, 2.1);
}

static void test_objects(void **state) {
    (void)state;
    static const char dice[] = W "ObjectBegin \"die\" Translate 0 0 1 SolidBegin \"difference\"" BOX("0", "4")
        BOX("1", "2") "SolidEnd ObjectEnd\nObjectInstance \"die\" Translate 0 0 10 ObjectInstance \"die\"";
    CROSSES(dice, 0.1, 0.1, 1, 2, 3, 5, 11, 12, 13, 15);
    // An object that is a solid is placed without an object around it.
    sag_world *world = scene_load_good(dice);
    const sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, -50), sag_vec3_make(0, 0, 1));
    sag_hit hit;
    assert_true(sag_intersect(sag_world_scene(world), &ray, &hit) && hit.instance_depth == 1);
    sag_world_destroy(world);
    // As an operand: a solid, and the union of shapes and solids. Its open cylinders get caps.
    CROSSES(W "ObjectBegin \"die\" Translate 0 0 1 SolidBegin \"difference\"" BOX("0", "4") BOX(
                "1", "2") "SolidEnd ObjectEnd SolidBegin \"intersection\"" BOX("-9", "4") "Translate 0 0 -1 "
                                                                                          "ObjectInstance "
                                                                                          "\"die\" SolidEnd",
            0.1, 0.1, 0, 1, 2, 4);
    CROSSES(W "ObjectBegin \"o\"" BOX(
                "0", "2") "Translate 0 0 4 Shape \"cylinder\" SolidBegin \"union\" "
                          "Translate 0 0 3" BALL "SolidEnd ObjectEnd\nSolidBegin \"difference\"" BOX(
                              "-9", "19") "ObjectInstance \"o\" Translate 0 0 10 ObjectInstance \"o\" "
                                          "SolidEnd",
            0, 0, -9, 0, 2, 3, 5, 6.5, 7.5, 10, 12, 13, 15, 16.5, 17.5, 19);
    // In an object, an operand that is another.
    CROSSES(W "ObjectBegin \"a\"" BALL "ObjectEnd ObjectBegin \"b\" SolidBegin \"difference\"" BOX(
                "0", "4") "Translate 0 0 2 ObjectInstance \"a\" SolidEnd ObjectEnd Translate 0 0 1 "
                          "ObjectInstance \"b\"",
            0, 0, 1, 2.5, 3.5, 5);
}

// What is small is written out, what is large is an instance: either way it is the same solid.
static void test_large_objects(void **state) {
    (void)state;
    for (int count = 4000; count <= 5000; count += 1000) {
        const size_t size = (size_t)count * 32 + 1024;
        char *text = malloc(size);
        assert_non_null(text);
        size_t length = (size_t)snprintf(text, size,
                                         W "ObjectBegin \"balls\" Shape \"spheres\" \"float radius\" "
                                           "0.25 \"point3 P\" [ 0 0 1");
        for (int i = 0; i < count; i++)
            length += (size_t)snprintf(text + length, size - length, "\n%d 1 2", i % 500);
        snprintf(text + length, size - length,
                 "] ObjectEnd\nObjectBegin \"more\" SolidBegin \"union\" Translate 0 0 2 ObjectInstance "
                 "\"balls\" SolidEnd ObjectEnd\nSolidBegin \"difference\"" BOX(
                     "0", "4") "ObjectInstance \"balls\" ObjectInstance \"more\" SolidEnd");
        CROSSES(text, 0, 0, 0, 0.75, 1.25, 2.75, 3.25, 4);
        free(text);
    }
}

// Each kind of body: the ray enters once and leaves once.
static void test_bodies(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double enter, leave;
    } bodies[] = {
        {"\"sphere\"", -1, 1},
        {"\"ellipsoid\" \"vector3 radii\" [1 2 3]", -3, 3},
        {"\"box\"", -1, 1},
        {"\"orientedbox\" \"vector3 halfaxes\" [1 0 0 0 1 0 0 0 2]", -2, 2},
        {"\"polyhedron\" \"float planes\" [1 0 0 1 -1 0 0 1 0 1 0 1 0 -1 0 1 0 0 1 1 0 0 -1 3]", -3, 1},
        {"\"capsule\" \"point3 p0\" [0 0 0] \"point3 p1\" [0 0 2] \"float radius\" 0.5", -0.5, 2.5},
        {"\"cylinder\"", -1, 1},
        {"\"cone\" \"float height\" 2", 0, 2},
        {"\"paraboloid\"", 0, 1},
        {"\"hyperboloid\" \"point3 p1\" [1 0 -1] \"point3 p2\" [1 0 1]", -1, 1},
        {"\"hyperboloid2\" \"float zmin\" 0.5", 1, 2},
        {"\"quadric\" \"float coefficients\" [1 1 1 0 0 0 0 0 0 -1] \"point3 min\" [-2 -2 -2] \"point3 max\" "
         "[2 2 2]",
         -1, 1},
        {"\"spheres\" \"point3 P\" [0 0 0 0 0 1] \"float radii\" [1 1]", -1, 2},
        {"\"trianglemesh\" \"point3 P\" [-2 -2 0 2 -2 0 0 2 0 0 0 2] \"integer indices\" [0 2 1 0 1 3 1 2 3 "
         "2 "
         "0 3]",
         0, 2},
    };
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        char text[512];
        snprintf(text, sizeof text, W "SolidBegin \"union\"\nShape %s\nSolidEnd", bodies[i].text);
        CROSSES(text, 0, 0, bodies[i].enter, bodies[i].leave);
        // The same, found to be inside out: everything outside it within a ball.
        snprintf(text, sizeof text,
                 W "SolidBegin \"difference\" Shape \"sphere\" \"float radius\" 8\nShape %s\nSolidEnd",
                 bodies[i].text);
        CROSSES(text, 0, 0, -8, bodies[i].enter, bodies[i].leave, 8);
    }
    CROSSES(W "SolidBegin \"union\" Shape \"torus\" SolidEnd", 1, 0, -0.25, 0.25);
    // A plane is all that lies behind it.
    CROSSES(W
            "SolidBegin \"intersection\" Shape \"sphere\" Shape \"plane\" \"normal normal\" [0 0 1] SolidEnd",
            0, 0, -1, 0);
    CROSSES(W "SolidBegin \"difference\" Shape \"sphere\" Shape \"plane\" \"normal normal\" [0 0 1] SolidEnd",
            0, 0, 0, 1);
}

static void test_errors(void **state) {
    (void)state;
    scene_fails(W "SolidEnd", 2, 1, "SolidEnd without SolidBegin");
    scene_fails(W "SolidBegin \"minus\"", 2, 1, "unknown operation \"minus\"");
    scene_fails(W "SolidBegin", 2, 1, "a string expected");
    scene_fails(W "SolidBegin \"union\"\nSolidEnd", 2, 1, "empty");
    scene_fails(W "SolidBegin \"union\"" BALL " SolidBegin \"xor\"\nSolidEnd SolidEnd", 3, 2, "empty");
    scene_fails(W " SolidBegin \"union\"\n" BALL, 2, 2, "this SolidBegin is never closed by SolidEnd");
    scene_fails(W "AttributeBegin\nSolidBegin \"union\"\n" BALL "AttributeEnd", 5, 1,
                "SolidBegin of line 3 is open");
    scene_fails(W "SolidBegin \"union\" AttributeBegin\n" BALL "SolidEnd", 4, 1,
                "AttributeBegin of line 2 is open");
    scene_fails(W "SolidBegin \"union\"\n ObjectBegin \"a\"", 3, 2, "within a solid");
    scene_fails(W "SolidBegin \"union\"\n LightSource \"point\"", 3, 2, "within a solid");
    scene_fails(W "SolidBegin \"union\"\n ObjectInstance \"a\"", 3, 2, "there is no object");
    scene_fails(W "ObjectBegin \"a\" SolidBegin \"union\"\n ObjectInstance \"a\"", 3, 2, "not finished");
    scene_fails("SolidBegin \"union\"", 1, 1, "before WorldBegin");
    static const struct {
        const char *text, *what;
    } open[] = {
        {"\"disk\"", "no inside"},
        {"\"rectangle\"", "no inside"},
        {"\"triangle\" \"point3 P\" [0 0 0 1 0 0 0 1 0]", "no inside"},
        {"\"polygon\" \"point3 P\" [0 0 0 1 0 0 0 1 0]", "no inside"},
        {"\"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]", "no inside"},
        {"\"sphere\" \"float zmax\" 0.5", "zmin or zmax"},
        {"\"sphere\" \"float phimax\" 90", "part of its sweep"},
        {"\"cylinder\" \"float phimax\" 90", "phi_max"},
        {"\"curve\"", "not supported"},
        {"\"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]", "not closed"},
        {"\"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] \"integer indices\" [0 2 1 0 1 3 1 2 3]",
         "not closed"},
        {"\"quadric\" \"float coefficients\" [1 1 -1 0 0 0 0 0 0 -1]", "closed"},
        {"\"hyperboloid\" \"point3 p1\" [1 0 0] \"point3 p2\" [2 0 0]", "closed"},
        {"\"spheres\" \"point3 P\" [0 0 nan]", "none of the spheres"},
    };
    for (size_t i = 0; i < sizeof open / sizeof *open; i++) {
        char text[512];
        snprintf(text, sizeof text, W "SolidBegin \"difference\"\n" BALL "  Shape %s\nSolidEnd",
                 open[i].text);
        scene_fails(text, 4, 3, open[i].what);
    }
    // In an object: the place is the instance's, the message has the shape's line.
    scene_fails(W "ObjectBegin \"a\"\n" BALL
                  "Shape \"disk\" ObjectEnd\nSolidBegin \"union\"\n ObjectInstance \"a\"",
                6, 2, "its disk of line 4 has no inside");
    scene_fails(W "ObjectBegin \"a\" ObjectEnd\nSolidBegin \"union\"\n ObjectInstance \"a\"", 4, 2,
                "is empty");
    scene_fails(W "ObjectBegin \"a\"\n  Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ObjectEnd\n"
                  "SolidBegin \"union\" ObjectInstance \"a\" SolidEnd",
                3, 3, "not closed");
}

static void test_looks(void **state) {
    (void)state;
    sag_world *world = scene_load_good(
        W "MakeNamedMaterial \"red\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"blue\" \"string type\" "
          "\"diffuse\"\nTexture \"t\" \"float\" \"checkerboard\"\n"
          "NamedMaterial \"red\" SolidBegin \"difference\"" BOX(
              "0", "4") "NamedMaterial \"blue\" "
                        "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] Translate 0 0 4 ReverseOrientation "
                        "Shape \"sphere\" \"texture alpha\" \"t\" SolidEnd Translate 0 0 9" BALL);
    assert_int_equal(scene_warning_count, 1);
    assert_non_null(strstr(scene_warnings, "\"alpha\" of a solid's part is not supported"));
    const sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, -5), sag_vec3_make(0, 0, 1));
    sag_hit hits[4];
    assert_int_equal(sag_intersect_all(sag_world_scene(world), &ray, hits, 4), 4);
    // The box's face has the box's material, what the ball has cut the ball's, the ball behind again the
    // first.
    const uint32_t materials[] = {1, 2, 1, 1};
    for (int i = 0; i < 4; i++) {
        sag_surface surface;
        sag_surface_at(sag_world_scene(world), &ray, &hits[i], &surface);
        const sagi_appearance *look = sagi_appearance_of(world, &surface);
        assert_non_null(look);
        assert_int_equal(look->look.material, materials[i]);
        assert_true((look->look.emission.b == 3) == (i == 1));
        assert_true(look->look.alpha.texture == 0);
    }
    sag_world_destroy(world);
}

// The k-th allocation fails, for every k: an error, no leak.
static void test_out_of_memory(void **state) {
    (void)state;
    static const char text[] = W
        "ObjectBegin \"a\"" BALL "Shape \"cylinder\" SolidBegin \"union\"" BALL "SolidEnd ObjectEnd\n"
        "SolidBegin \"difference\"" BOX("0", "4") "ObjectInstance \"a\" SolidBegin \"xor\" Shape \"spheres\" "
                                                  "\"point3 P\" [0 0 0 0 0 1] SolidEnd SolidEnd";
    scene_fails_without_memory(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_operations), cmocka_unit_test(test_transforms_and_blocks),
        cmocka_unit_test(test_objects),    cmocka_unit_test(test_large_objects),
        cmocka_unit_test(test_bodies),     cmocka_unit_test(test_errors),
        cmocka_unit_test(test_looks),      cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
