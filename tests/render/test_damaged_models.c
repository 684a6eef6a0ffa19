// SPDX-License-Identifier: MIT
// Models and their materials that Assimp fell over, as it reads them here: found by damaging whole ones.
#define _DEFAULT_SOURCE // mkdtemp
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <sagitta/render.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/context.h"

// Assimp 5.2 loses some kilobytes when it refuses a damaged file: not ours to mend, and not to hide our own
// leaks.
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void); // NOLINT: its name
const char *__lsan_default_suppressions(void) { return "leak:libassimp\n"; }

static char folder[64] = "/tmp/sagitta-models-XXXXXX";

static const char *in_folder(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int set_up(void **state) { return mkdtemp(folder) == NULL || setup(state) != 0; }
static int tear_down(void **state) {
    static const char *const names[] = {"m.obj", "m.mtl", "m.glb", "m.gltf"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) unlink(in_folder(names[i]));
    return rmdir(folder) != 0 || teardown(state) != 0;
}

static void write_file(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(in_folder(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static sag_status load(const char *name, sag_error *error) {
    sag_world *world = sag_world_create(context);
    memset(error, 0, sizeof *error);
    const sag_status status = sag_world_load(world, in_folder(name), error);
    sag_world_destroy(world);
    if (status != SAG_OK) assert_true(error->message[0] != 0 && error->file[0] != 0);
    return status;
}

// What stands in an MTL file before its first material belongs to none: it was written to address 0. And
// files cut anywhere, empty ones too.
static void materials_without_a_name(void **state) {
    (void)state;
    static const char mtl[] =
        "\xef\xbb\xbf# x\n\tnewmtl a\nKd 0.2 0.4 0.6\nmap_Kd none.png\nnewmtl b\nNi 1.4\nd 0.1\n";
    static const char *const heads[] = {"Kd 1 0 0\nillum 2\n", "map_Kd a.png\nd 0.5\n",
                                        "Ns 3\r\nNi 2\r\nbump b.png\r\n", ""};
    static const char model[] =
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n";
    write_file("m.obj", model, sizeof model - 1);
    for (size_t cut = 0; cut < sizeof mtl; cut++)
        for (size_t h = 0; h < 4; h++) {
            char text[sizeof mtl + 64];
            sag_error error;
            const int length = snprintf(text, sizeof text, "%s%.*s", heads[h], (int)cut, mtl);
            write_file("m.mtl", text, (size_t)length);
            const sag_status status = load("m.obj", &error);
            if (h < 3 && cut == sizeof mtl - 1 && status != SAG_ERROR_IO && status != SAG_OK)
                fail_msg("%s", error.message);
        }
}

// Binary glTF of which a chunk claims four gigabytes: they were asked for, and filled.
static void chunks_beyond_the_end(void **state) {
    (void)state;
    static const char first[] = "glTF\2\0\0\0\34\0\0\0\0\0\0\xf5JSON{\"a\":1} ";
    static const char second[] = "glTF\2\0\0\0\50\0\0\0\10\0\0\0JSON{\"a\":1} \0\0\0\xf5"
                                 "BIN\0abcd";
    sag_error error;
    write_file("m.glb", first, sizeof first - 1);
    assert_int_equal(load("m.glb", &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "not that of"));
    write_file("m.glb", second, sizeof second - 1);
    assert_int_equal(load("m.glb", &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "not that of"));
}

// A triangle: 36 bytes of corners, which also are its joints and weights, 6 of indices.
#define TRIANGLE(attributes, node, sparse, rest)                                                             \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"                             \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0" attributes "},\"indices\":1}]}],"         \
    "\"buffers\":[{\"byteLength\":44%s}],"                                                                   \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],"  \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"" sparse "},"      \
    "{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"},"                             \
    "{\"bufferView\":0,\"componentType\":5121,\"count\":3,\"type\":\"VEC4\"}],\"nodes\":[{\"mesh\":0" node   \
    "},{}]" rest "}\n"
#define SPARSE(count, at)                                                                                    \
    TRIANGLE("", "",                                                                                         \
             ",\"sparse\":{\"count\":" count                                                                 \
             ",\"indices\":{\"bufferView\":1,\"componentType\":5123},\"values\":{\"bufferView\":0" at "}}",  \
             "")

// The same as a file of text and as a binary one.
static sag_status load_gltf(const char *format, sag_error *error) {
    static const char inside[] = ",\"uri\":\"data:application/octet-stream;base64,"
                                 "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=\"";
    static const struct {
        float corners[9];
        uint16_t indices[4];
    } buffer = {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2, 0}};
    char text[2048], binary[2048];
    snprintf(text, sizeof text, format, inside);
    write_file("m.gltf", text, strlen(text));
    char *const json = binary + 20;
    size_t length = (size_t)snprintf(json, sizeof binary - 20, format, "");
    while (length % 4 != 0) json[length++] = ' ';
    const size_t all = 20 + length + 8 + sizeof buffer;
    const uint32_t head[] = {0x46546C67, 2, (uint32_t)all, (uint32_t)length, 0x4E4F534A},
                   chunk[] = {sizeof buffer, 0x004E4942};
    memcpy(binary, head, sizeof head), memcpy(json + length, chunk, sizeof chunk);
    memcpy(json + length + sizeof chunk, &buffer, sizeof buffer);
    write_file("m.glb", binary, all);
    const sag_status status = load("m.glb", error);
    assert_int_equal(load("m.gltf", error), status);
    return status;
}

// Joints that the skin does not have: their bones were written to all the same.
static void joints_beyond_the_skin(void **state) {
    (void)state;
    sag_error error;
    assert_int_equal(load_gltf(TRIANGLE(",\"JOINTS_0\":2,\"WEIGHTS_0\":2", ",\"skin\":0", "",
                                        ",\"skins\":[{\"joints\":[1]}]"),
                               &error),
                     SAG_OK);
}

// Sparse accessors of more elements than their buffer views hold: what lies behind was read.
static void sparse_beyond_the_view(void **state) {
    (void)state;
    sag_error error;
    assert_int_equal(load_gltf(SPARSE("3", ""), &error), SAG_OK);
    static const char *const texts[] = {SPARSE("4", ""),
                                        SPARSE("300000", ""),
                                        SPARSE("-1", ""),
                                        SPARSE("\"x\"", ""),
                                        SPARSE("1", ",\"byteOffset\":28"),
                                        SPARSE("3", ",\"byteOffset\":1e300")};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        assert_int_equal(load_gltf(texts[i], &error), SAG_ERROR_FORMAT);
        if (strstr(error.message, "accessors[0].sparse") == NULL) fail_msg("%zu: %s", i, error.message);
    }
}

// What is not JSON is told with its place.
static void no_json(void **state) {
    (void)state;
    static const char text[] = "{\"asset\":\n  {\"version\" \"2.0\"}}\n";
    sag_error error;
    write_file("m.gltf", text, sizeof text - 1);
    assert_int_equal(load("m.gltf", &error), SAG_ERROR_FORMAT);
    assert_int_equal(error.line, 2);
    assert_int_equal(error.column, 14);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_without_a_name),
        cmocka_unit_test(chunks_beyond_the_end),
        cmocka_unit_test(joints_beyond_the_skin),
        cmocka_unit_test(sparse_beyond_the_view),
        cmocka_unit_test(no_json),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
