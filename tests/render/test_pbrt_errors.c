// SPDX-License-Identifier: MIT
// Wrong pbrt scenes: what is wrong is told with file, line and column, and no text, however broken, crashes
// the reader.
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

#include <zlib.h>

#include "support/scene_text.h"

#define W   "WorldBegin\n"
#define FOG "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" "

static void test_errors_have_their_place(void **state) {
    (void)state;
    scene_fails("", 1, 1, "without WorldBegin");
    scene_fails("Foo", 1, 1, "unknown directive Foo");
    scene_fails(W "  # a comment\n   Bar \"x\"\n", 3, 4, "unknown directive Bar");
    scene_fails(W "Shape \"sphere\"\n  \"float radius\" [ 1 \n", 3, 18, "never closed");
    scene_fails(W "Shape \"sphere\" \"float radius\" [ 1 \nShape \"disk\"", 2, 31, "never closed");
    scene_fails(W "Shape \"sphere", 2, 7, "no closing quote");
    scene_fails(W "Shape \"sphere\" \"float radius\" \"two\"", 2, 31, "a number expected");
    scene_fails(W "Shape \"sphere\" \"float radius\" [1 [2]]", 2, 34, "a [ within");
    scene_fails(W "Shape \"sphere\" \"float radius\" [1 2]", 2, 16, "2 numbers, not 1");
    scene_fails(W "Shape \"sphere\" \"float radius\"", 2, 16, "has no value");
    scene_fails(W "Shape \"sphere\" \"string radius\" \"1\"", 2, 16, "of type string here, float expected");
    scene_fails(W "Shape \"sphere\" \"flaot radius\" 1", 2, 16, "unknown parameter type \"flaot\"");
    scene_fails(W "Shape \"sphere\" \"radius\" 1", 2, 16, "\"type name\"");
    scene_fails(W "Shape \"sphere\" \"float radius\" 1x", 2, 31, "a number expected");
    scene_fails(W "Shape \"sphere\" \"float radius\" -1", 2, 1, "radius");
    scene_fails(W "Shape \"spheer\"", 2, 1, "unknown shape \"spheer\"");
    scene_fails(W "Shape 5", 2, 7, "a string expected after Shape");
    scene_fails(W "Shape", 2, 1, "a string expected after Shape");
    scene_fails(W "\n\"float radius\" 1", 3, 1, "a directive expected");
    scene_fails(W "Translate 1 2", 2, 1, "3 numbers expected");
    scene_fails(W "Translate 1 2 x", 2, 15, "3 numbers expected");
    scene_fails(W "Translate 1 2 inf", 2, 15, "finite");
    scene_fails(W "Scale 0 1 1", 2, 1, "Scale by 0");
    scene_fails(W "Rotate 5 0 0 0", 2, 1, "axis");
    scene_fails(W "LookAt 0 0 0 0 1 0 0 1 0", 2, 1, "up vector");
    scene_fails(W "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0]", 2, 41, "16 numbers");
    scene_fails(W "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 1]", 2, 44, "before the ]");
    scene_fails(W "Transform [0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1]", 2, 1, "singular");
    scene_fails(W "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]", 2, 1, "projective");
    scene_fails(W "AttributeBegin\nTransformBegin\nAttributeEnd", 2, 1, "never closed by AttributeEnd");
    scene_fails(W "AttributeBegin\nObjectBegin \"a\"\nAttributeEnd", 4, 1, "ObjectBegin of line 3 is open");
    scene_fails(W "ObjectEnd", 2, 1, "ObjectEnd without ObjectBegin");
    scene_fails(W "WorldEnd", 2, 1, "unknown directive WorldEnd: a pbrt-v4 scene ends with its file");
    scene_fails(W "Shape \"sphere\" \"color radius\" 1", 2, 16,
                "unknown parameter type \"color\": pbrt-v4 calls");
    scene_fails(W FOG FOG, 2, 49, "a medium \"m\" already");
    scene_fails(W "MediumInterface \"fog\" \"\"", 2, 1, "never made");
    scene_fails(W "MakeNamedMedium \"m\"", 2, 1, "\"string type\" is missing");
    scene_fails(W FOG "\"float g\" 1", 2, 1, "g is in (-1, 1)");
    scene_fails("Option \"speed\" 3", 1, 1, "unknown option \"speed\"");
    scene_fails("Option \"forcediffuse\" 3", 1, 23, "true or false expected");
    scene_fails("Option \"seed\" \"3\"", 1, 15, "an integer expected");
    scene_fails("Option \"rendercoordsys\" 3", 1, 25, "a string expected");
    scene_fails(W "  AttributeBegin", 2, 3, "never closed by AttributeEnd");
    scene_fails(W "ObjectBegin \"a\"", 2, 1, "never closed by ObjectEnd");
    scene_fails(W "ObjectBegin \"a\" ObjectBegin \"b\"", 2, 17, "within an object");
    scene_fails(W "ObjectBegin \"a\" ObjectEnd ObjectBegin \"a\"", 2, 27, "already");
    scene_fails(W "ObjectInstance \"a\"", 2, 1, "there is no object \"a\"");
    scene_fails(W "NamedMaterial \"a\"", 2, 1, "there is no material \"a\"");
    scene_fails(W "Material \"matte\"", 2, 1, "unknown material \"matte\"");
    scene_fails(W "MakeNamedMaterial \"a\"", 2, 1, "\"string type\" is missing");
    scene_fails(W "Material \"diffuse\" \"texture reflectance\" \"t\"", 2, 20, "there is no texture \"t\"");
    scene_fails(W "Material \"diffuse\" \"rgb reflectance\" [1 2]", 2, 20, "3 numbers");
    scene_fails(W "Material \"conductor\" \"spectrum eta\" \"metal-Xx\"", 2, 22, "no spectrum and no file");
    scene_fails(W "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"none.png\"", 2, 32,
                "none.png: cannot read: No such file");
    scene_fails(W "Texture \"t\" \"vector\" \"constant\"", 2, 1, "\"float\" or \"spectrum\"");
    scene_fails(W "LightSource \"lamp\"", 2, 1, "unknown light");
    scene_fails(W "LightSource \"distant\" \"point3 from\" [0 0 1] \"point3 to\" [0 0 1]", 2, 1,
                "same point");
    scene_fails(W "Camera \"perspective\"", 2, 1, "Camera after WorldBegin");
    scene_fails("Shape \"sphere\"", 1, 1, "Shape before WorldBegin");
    scene_fails("Camera \"perspective\" \"float fov\" 180 " W, 1, 22, "fov 180");
    scene_fails("Camera \"fisheye\" " W, 1, 1, "unknown camera");
    scene_fails("Film \"rgb\" \"integer xresolution\" 100000 " W, 1, 1, "100000×720");
    scene_fails("Film \"rgb\" \"integer xresolution\" 1.5 " W, 1, 34, "not an integer");
    scene_fails("Sampler \"halton\" \"integer pixelsamples\" 0 " W, 1, 1, "0 samples");
    scene_fails("Sampler \"zsobol\" \"integer pixelsamples\" 1000000000 " W, 1, 1,
                "1000000000 samples in a pixel");
    scene_fails("Film \"rgb\" \"integer xresolution\" 0 " W, 1, 1, "0×720");
    scene_fails("Film \"rgb\" \"integer xresolution\" 1000000 \"integer yresolution\" 1000000 " W, 1, 1,
                "1000000×");
    scene_fails(W
                "Texture \"t\" \"float\" \"constant\" Texture \"t\" \"spectrum\" \"constant\"\nTexture \"t\" "
                "\"float\" \"constant\"",
                3, 1, "a float texture \"t\" already");
    scene_fails(
        W "MakeNamedMaterial \"m\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"m\" \"string type\" "
          "\"diffuse\"",
        3, 1, "a material \"m\" already");
    scene_fails("Sampler \"halton\" \"string randomization\" \"fastowen\" " W, 1, 18, "randomization");
    scene_fails("Film \"rgb\" \"float cropwindow\" [ 0.5 0.5 0 1 ] " W, 1, 12, "with pixels between");
    scene_fails("Film \"rgb\" \"integer pixelbounds\" [ 5000 6000 0 9 ] " W, 1, 12, "with pixels between");
    scene_fails("Film \"rgb\" \"float maxcomponentvalue\" -1 " W, 1, 12, "maxcomponentvalue -1");
    scene_fails("Camera \"spherical\" \"string mapping\" \"cube\" " W, 1, 20, "unknown mapping");
    scene_fails(W "Include \"none.pbrt\"", 2, 1, "none.pbrt: cannot read: No such file");
    scene_fails(W "Include \"scene.pbrt\"", 2, 1, "includes itself");
    scene_fails(W "Import \"scene.pbrt\"", 2, 1, "includes itself");
    scene_fails(W "Shape \"plymesh\" \"string filename\" \"none.ply\"", 2, 17,
                "none.ply: cannot read: No such file");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]", 2,
                53, "indices[2] is 3, but there are 3 points");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 -1]", 2,
                53, "indices[2] is -1");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1]", 2, 53,
                "not a multiple of 3");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" []", 2, 53,
                "no faces");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 0]", 2, 1,
                "\"integer indices\" are missing");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1]", 2, 22, "not a multiple of 3");
    scene_fails(W "Shape \"trianglemesh\"", 2, 1, "\"point3 P\" is missing");
    scene_fails(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]", 2, 53,
                "1 of \"N\" for 3 of \"P\"");
    scene_fails(W "Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer loops\" [4]", 2, 48,
                "the loops have 4 points");
    scene_fails(W "Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 1]", 2, 1, "polygon");
    scene_fails(W "Shape \"torus\" \"float minorradius\" 0", 2, 1, "torus");
    scene_fails(W "Shape \"quadric\"", 2, 1, "ten numbers");
    scene_fails(W "\x01\x02\x03", 2, 1, "no text");
    // What the renderer would refuse later, when the place is forgotten, or silently replace.
    scene_fails(W "LightSource \"point\" \"rgb I\" [-1 0 0]", 2, 1, "negative");
    scene_fails(W "AreaLightSource \"diffuse\" \"float scale\" -3", 2, 1, "negative");
    scene_fails(W "LightSource \"spot\" \"float coneangle\" 0", 2, 20, "coneangle 0");
    scene_fails(W "LightSource \"spot\" \"point3 from\" [0 0 1]", 2, 1, "same point");
    scene_fails(W "Material \"dielectric\" \"float eta\" -1.5", 2, 23, "index of refraction");
    scene_fails("Camera \"perspective\" \"float lensradius\" -1", 1, 22, "radius -1");
    scene_fails("Camera \"perspective\" \"float screenwindow\" [0 0 0 0]", 1, 22, "room between");
}

// As other programs and pbrt itself write: a byte order mark, Option with a plain name. What is given twice,
// or dropped, is named.
static void test_marks_options_and_repetitions(void **state) {
    (void)state;
    sag_world_destroy(
        scene_load_good("\xef\xbb\xbfOption \"seed\" 3\nOption \"bool disable-pixel_Jitter\" [ true ]\n" W
                        "Shape \"sphere\" \"float radius\" 2 \"float radius\" 1"));
    assert_int_equal(scene_warning_count, 2);
    assert_non_null(strstr(scene_warnings, "scene.pbrt:2:1: warning: Option \"disablepixeljitter\" has no"));
    assert_non_null(
        strstr(scene_warnings, ":4:16: warning: Shape \"sphere\": \"radius\" is given again: the last one"));
    sag_world_destroy(
        scene_load_good(W "AttributeEnd TransformBegin Material \"diffuse\" AttributeEnd\nTransformEnd"));
    assert_int_equal(scene_warning_count, 3);
    assert_non_null(strstr(scene_warnings, ":2:1: warning: AttributeEnd without AttributeBegin: ignored"));
    assert_non_null(
        strstr(scene_warnings, ":2:14: warning: TransformBegin is AttributeBegin by another name"));
    assert_non_null(strstr(scene_warnings, ":3:1: warning: TransformEnd without TransformBegin: ignored"));
    scene_fails("Option \"seed\"", 1, 14, "no value");
    scene_fails("Option \"seed\" [3 4]", 1, 18, "] expected");
    scene_fails(W "LightSource \"infinite\" \"string filename\" \"nowhere.exr\"", 2, 24,
                "nowhere.exr: cannot read");
    sag_world_destroy(
        scene_load_good(W "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 nan 0 1e31 0 0] "
                          "\"integer indices\" [0 1 2 0 1 3 0 1 4]"));
    assert_int_equal(scene_warning_count, 1);
    assert_non_null(
        strstr(scene_warnings, ":2:1: warning: Shape \"trianglemesh\": triangles with a vertex that is NaN"));
    assert_non_null(strstr(scene_warnings, "2 of 3"));
    sag_world_destroy(
        scene_load_good("Camera \"environment\"\n" W
                        "LightSource \"spot\" \"float coneangle\" 4\n" // pbrt takes it with its delta of 5
                        "Material \"diffuse\" \"rgb reflectance\" [2 0 0]\n"
                        "Shape \"spheres\" \"point3 P\" [0 0 0 nan 0 0 1 1 1] \"float radii\" [1 1 -1]"));
    assert_int_equal(scene_warning_count, 2);
    assert_non_null(
        strstr(scene_warnings, ":4:1: warning: Material \"diffuse\": the reflectance 2 0 0 is cut off"));
    assert_non_null(strstr(scene_warnings, "left out: 2 of 3"));
}

static void test_included_files(void **state) {
    (void)state;
    const char *part = "Translate 0 0 5\nShape \"sphere\"\n", *bad = "\n  Oops\n", *open = "AttributeBegin\n";
    scene_write("part.pbrt", part, strlen(part));
    scene_write("bad.pbrt", bad, strlen(bad));
    scene_write("open.pbrt", open, strlen(open));
    gzFile gz = gzopen(scene_path("zipped.pbrt.gz"), "wb");
    gzputs(gz, part);
    gzclose(gz);
    sag_world *world = scene_load_good(W "Include \"part.pbrt\" Shape \"sphere\" \"float radius\" 2");
    scene_near(scene_shoot(world, 0, 0, 0, 0, 0, 1), 3); // the translation stays
    sag_world_destroy(world);
    world = scene_load_good(W "Import \"part.pbrt\" Shape \"sphere\" \"float radius\" 2");
    scene_near(scene_shoot(world, 0, 0, -9, 0, 0, 1), 7); // and does not
    sag_world_destroy(world);
    world = scene_load_good(W "Include \"zipped.pbrt.gz\"");
    scene_near(scene_shoot(world, 0, 0, 0, 0, 0, 1), 4);
    sag_world_destroy(world);
    sag_error error;
    assert_int_equal(scene_load(W "Include \"bad.pbrt\"", &world, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.file, "/bad.pbrt"));
    assert_true(error.line == 2 && error.column == 3);
    sag_world_destroy(world);
    assert_int_equal(scene_load(W "Include \"open.pbrt\"\nAttributeEnd", &world, &error), SAG_OK);
    sag_world_destroy(world);
    assert_int_equal(scene_load(W "Import \"open.pbrt\"\nAttributeEnd", &world, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.file, "/open.pbrt"));
    sag_world_destroy(world);
    for (int i = 0; i < 80; i++) { // a chain longer than the bound
        char name[32], text[64];
        snprintf(name, sizeof name, "chain%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"chain%d.pbrt\"\n", i + 1);
        scene_write(name, text, strlen(text));
    }
    assert_int_equal(scene_load(W "Include \"chain0.pbrt\"", &world, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "64 deep"));
    sag_world_destroy(world);
}

// Bytes that are no text, names without end, and gzip data that would fill the memory: told at once.
static void test_what_is_no_scene(void **state) {
    (void)state;
    sag_world *world;
    sag_error error;
    static const char zero[] = "WorldBegin\nShape \"sph\0ere\"";
    scene_write("zero.pbrt", zero, sizeof zero - 1);
    world = sag_world_create(scene_context);
    assert_int_equal(sag_world_load(world, scene_path("zero.pbrt"), &error), SAG_ERROR_FORMAT);
    assert_true(error.line == 2 && error.column == 11 && strstr(error.message, "zero byte"));
    sag_world_destroy(world);
    const size_t length = 1000000;
    char *text = malloc(length + 64);
    for (int quoted = 0; quoted < 2; quoted++) {
        const size_t begin = (size_t)sprintf(text, quoted ? W "Shape \"" : W);
        memset(text + begin, 'x', length);
        strcpy(text + begin + length, quoted ? "\"" : "");
        scene_fails(text, 2, quoted ? 7 : 1, quoted ? "longer than" : "no text");
    }
    const size_t zeros = (size_t)96 << 20;
    gzFile gz = gzopen(scene_path("bomb.pbrt.gz"), "wb9");
    memset(text, ' ', length);
    for (size_t done = 0; done < zeros; done += length) gzwrite(gz, text, (unsigned)length);
    gzclose(gz);
    free(text);
    world = sag_world_create(scene_context);
    assert_int_equal(sag_world_load(world, scene_path("bomb.pbrt.gz"), &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "and more: no scene does"));
    sag_world_destroy(world);
}

static void test_deep_nesting(void **state) {
    (void)state;
    char textures[8192] = W "Texture \"t0\" \"float\" \"constant\"\n";
    for (int i = 1; i < 60; i++)
        sprintf(textures + strlen(textures), "Texture \"t%d\" \"float\" \"scale\" \"texture tex\" \"t%d\"\n",
                i, i - 1);
    sag_world *deep;
    sag_error error;
    assert_int_equal(scene_load(textures, &deep, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "nest too deep"));
    sag_world_destroy(deep);
    const int depth = 10000;
    char *text = malloc(64 + (size_t)depth * 64), *p = text;
    p += sprintf(p, W);
    for (int i = 0; i < depth; i++) p += sprintf(p, "AttributeBegin Translate 0 0 1\n");
    p += sprintf(p, "Shape \"sphere\"\n");
    for (int i = 0; i < depth; i++) p += sprintf(p, "AttributeEnd\n");
    sag_world *world = scene_load_good(text);
    scene_near(scene_shoot(world, 0, 0, 0, 0, 0, 1), depth - 1);
    sag_world_destroy(world);
    free(text);
}

// Whatever allocation fails, it is an error code and nothing leaks.
static void test_out_of_memory(void **state) {
    (void)state;
    const char *text = W "Attribute \"shape\" \"float radius\" 2 ObjectBegin \"o\" Shape \"sphere\" "
                         "ObjectEnd ObjectInstance \"o\"\n"
                         "Texture \"t\" \"float\" \"constant\" Material \"diffuse\" AttributeBegin "
                         "LightSource \"point\" AttributeEnd\n"
                         "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1 0 0 1 "
                         "0 0 1] Shape \"plymesh\" \"string "
                         "filename\" \"four.ply\" Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    const char *quad =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    scene_write("four.ply", quad, strlen(quad));
    scene_fails_without_memory(text);
}

// Texts made from a good one by chance: never a crash, never memory that is not given back.
static void test_broken_texts(void **state) {
    (void)state;
    const char *good =
        "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" [45] Film \"rgb\" \"integer "
        "xresolution\" 10\n"
        "Sampler \"stratified\" \"integer xsamples\" 2 PixelFilter \"triangle\" Integrator \"path\" "
        "\"integer maxdepth\" 3\n" W
        "Attribute \"shape\" \"float radius\" 2 AttributeBegin Translate 1 2 3 Rotate 45 0 1 0 Scale 1 2 3\n"
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] Material \"diffuse\" \"texture "
        "reflectance\" \"t\"\n"
        "AreaLightSource \"diffuse\" \"blackbody L\" 5000 \"float power\" 10 Shape \"sphere\" AttributeEnd # "
        "comment\n"
        "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 "
        "2] ObjectEnd ObjectInstance \"o\"\n"
        "MakeNamedMaterial \"m\" \"string type\" \"conductor\" \"spectrum eta\" [400 1 700 2] NamedMaterial "
        "\"m\" ReverseOrientation\n"
        "Shape \"polygon\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer loops\" 3 Shape \"torus\" Shape "
        "\"spheres\" \"point3 P\" [1 2 3]\n"
        "LightSource \"spot\" \"rgb I\" [1 1 1] \"point3 to\" [0 0 1] CoordinateSystem \"c\" "
        "CoordSysTransform \"c\" Include \"part.pbrt\"\n";
    static const char *const pieces[] = {"[",
                                         "]",
                                         "\"",
                                         " ",
                                         "\n",
                                         "1e999",
                                         "-",
                                         "nan",
                                         "\"float radius\"",
                                         "\"integer indices\" [9]",
                                         "AttributeBegin ",
                                         "AttributeEnd ",
                                         "ObjectEnd ",
                                         "WorldBegin ",
                                         "Shape ",
                                         "\\",
                                         "#",
                                         "0",
                                         "1e-320",
                                         "true",
                                         "\"bool closed\" true "};
    const size_t length = strlen(good);
    char *text = malloc(2 * length + 4096);
    uint32_t random = 2026;
    size_t before, after;
    sag_context_memory(scene_context, &before, NULL);
    for (int round = 0; round < 2000; round++) {
        strcpy(text, good);
        for (int change = 0; change < 1 + round % 4; change++) {
            random = random * 1664525u + 1013904223u;
            const size_t n = strlen(text), at = (random >> 8) % n, what = (random >> 4) % 4;
            random = random * 1664525u + 1013904223u;
            const size_t span = (random >> 8) % 20 % (n - at);
            const char *piece = pieces[(random >> 12) % (sizeof pieces / sizeof *pieces)];
            if (what == 0) {
                memmove(text + at, text + at + span, n - at - span + 1);
            } else if (what == 1) {
                text[at] = (char)(random >> 16) ? (char)(random >> 16) : ' ';
            } else if (what == 2 && n + strlen(piece) < 2 * length) {
                memmove(text + at + strlen(piece), text + at, n - at + 1);
                memcpy(text + at, piece, strlen(piece));
            } else {
                text[at + 1] = '\0';
            }
        }
        sag_world *world;
        sag_error error;
        if (scene_load(text, &world, &error) != SAG_OK && (error.message[0] == '\0' || error.line < 0))
            fail_msg("no message for %s", text);
        sag_world_destroy(world);
    }
    sag_context_memory(scene_context, &after, NULL);
    assert_int_equal(before, after);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_have_their_place),
        cmocka_unit_test(test_marks_options_and_repetitions),
        cmocka_unit_test(test_what_is_no_scene),
        cmocka_unit_test(test_included_files),
        cmocka_unit_test(test_deep_nesting),
        cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_broken_texts),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
