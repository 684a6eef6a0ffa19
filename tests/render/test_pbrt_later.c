// SPDX-License-Identifier: MIT
// Meshes that are read later on all threads: the same scene, messages and errors as reading in order.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/scene_text.h"

typedef struct text {
    char *bytes;
    size_t length, room;
} text;

static void add(text *t, const char *format, ...) {
    char piece[512];
    va_list arguments;
    va_start(arguments, format);
    const size_t n = (size_t)vsnprintf(piece, sizeof piece, format, arguments);
    va_end(arguments);
    if (t->length + n + 1 > t->room) {
        t->room = 2 * (t->length + n + 1);
        t->bytes = realloc(t->bytes, t->room);
    }
    memcpy(t->bytes + t->length, piece, n + 1);
    t->length += n;
}

// A sheet of 2(n − 1)² triangles at height z. With a comment in each array nothing of it can wait.
static void add_sheet(text *t, int n, double z, bool waits) {
    const char *const begin = waits ? "[ " : "[ # now\n";
    add(t, "Shape \"trianglemesh\" \"point3 P\" %s", begin);
    for (int i = 0; i < n * n; i++)
        add(t, "%.*g %g\n\t%.9g ", i % 17, i % n + 0.1, (double)(i / n), z + 1e-3 * sin(i)); // NOLINT
    add(t, "]\n\"normal N\" %s", begin);
    for (int i = 0; i < n * n; i++) add(t, "%g 0 1\r\n", i % 7 * 0.1);
    add(t, "] \"point2 uv\" %s", begin);
    for (int i = 0; i < n * n; i++) add(t, "%d %.17g ", i, i / 3.0);
    add(t, "] \"integer indices\" %s", begin);
    for (int j = 0; j + 1 < n; j++)
        for (int i = 0; i + 1 < n; i++) {
            const int a = j * n + i;
            add(t, "%d %d %d  %d %d %d\n", a, a + 1, a + n, a + 1, a + n + 1, a + n);
        }
    add(t, "]\n");
}

static void write_ply(const char *name, int n) {
    text t = {0};
    add(&t,
        "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n",
        n);
    add(&t, "element face %d\nproperty list uchar int vertex_indices\nend_header\n", n - 2);
    for (int i = 0; i < n; i++) add(&t, "%d %d 0\n", i, i * i % 11);
    for (int i = 0; i + 2 < n; i++) add(&t, "3 %d %d %d\n", i, i + 1, i + 2);
    scene_write(name, t.bytes, t.length);
    free(t.bytes);
}

static text scene_of_all(bool waits) {
    text t = {0};
    add(&t, "WorldBegin\nShape \"sphere\" \"float radiu\" 3\n");
    add_sheet(&t, 120, 1, waits);
    add(&t, "ObjectBegin \"o\" Translate 0 0 9\n");
    add_sheet(&t, 30, 2, waits);
    add(&t, "Shape \"disk\" \"float radios\" 3 Shape \"plymesh\" \"string filename\" \"a.ply\" ObjectEnd\n");
    add(&t, "ObjectBegin \"p\" Shape \"plymesh\" \"string filename\" \"b.ply\" ObjectEnd\n");
    add(&t, "Translate 1 2 3 ObjectInstance \"o\" ObjectInstance \"p\" ReverseOrientation\n");
    for (int i = 0; i < 12; i++) {
        add(&t, "AttributeBegin Translate %d 0 0\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n", i);
        if (i % 3 == 0) add(&t, "Shape \"plymesh\" \"string filename\" \"%s.ply\"\n", i % 2 ? "a" : "b");
        add_sheet(&t, 5 + 9 * i, i, waits);
        add(&t, "Shape \"sphere\" \"float radius%d\" 1\nAttributeEnd\n", i);
    }
    return t;
}

static void hear(void *user, sag_log_level level, const char *message) {
    (void)level;
    text *const t = user;
    const char *const name = strrchr(message, '/'); // lines differ by the comments
    const char *const said = strstr(name ? name : message, "warning");
    add(t, "%s\n", said ? said : message);
}

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size) {
    const uint8_t *p = bytes;
    for (size_t i = 0; i < size; i++) hash = (hash ^ p[i]) * 1099511628211u;
    return hash;
}

// Of all there is in a scene, and its objects.
static uint64_t hash_of(sag_scene *scene) {
    uint64_t hash = 14695981039346656037u;
    sag_shape_kind kind;
    const void *shape;
    for (uint32_t id = 0; sag_geometry_get(scene, id, &kind, &shape) == SAG_OK; id++) {
        sag_affine placed;
        assert_int_equal(sag_geometry_get_transform(scene, id, &placed), SAG_OK);
        hash = hash_bytes(hash_bytes(hash, &kind, sizeof kind), &placed, sizeof placed);
        if (kind != SAG_SHAPE_MESH) continue;
        const sag_mesh *m = shape;
        const size_t n = m->vertex_count;
        hash = hash_bytes(hash, m->triangles, 3 * (size_t)m->triangle_count * sizeof(uint32_t));
        if (m->positions_f64) hash = hash_bytes(hash, m->positions_f64, 3 * n * sizeof(double));
        if (m->positions_f32) hash = hash_bytes(hash, m->positions_f32, 3 * n * sizeof(float));
        if (m->normals_f32) hash = hash_bytes(hash, m->normals_f32, 3 * n * sizeof(float));
        if (m->texcoords_f32) hash = hash_bytes(hash, m->texcoords_f32, 2 * n * sizeof(float));
    }
    return hash;
}

static uint64_t hash_with(const char *path, uint32_t threads, text *said) {
    const sag_context_options options = {.log = hear, .log_user = said, .thread_count = threads};
    sag_context *context = sag_context_create(&options);
    sag_world *world = sag_world_create(context);
    sag_error error = {0};
    if (sag_world_load(world, path, &error) != SAG_OK)
        fail_msg("%s:%d:%d: %s", error.file, error.line, error.column, error.message);
    assert_int_equal(sag_scene_commit(sag_world_scene(world), &error), SAG_OK);
    uint64_t hash = hash_of(sag_world_scene(world));
    for (uint32_t i = 0; sag_world_object(world, i); i++)
        hash = hash * 31 + hash_of(sag_world_object(world, i));
    sag_hit hit;
    for (int i = 0; i < 200; i++) { // the trees have what the scenes have
        const sag_ray ray =
            sag_ray_make(sag_vec3_make(i * 0.11, i % 14 * 0.9, -50), sag_vec3_make(0.001 * i, 0.01, 1));
        const double t = sag_intersect(sag_world_scene(world), &ray, &hit) ? hit.t : -1;
        hash = hash_bytes(hash, &t, sizeof t);
    }
    sag_world_destroy(world);
    sag_context_destroy(context);
    return hash;
}

static void same_for_all_threads(void **state) {
    (void)state;
    write_ply("a.ply", 50), write_ply("b.ply", 3000);
    text later = scene_of_all(true), now = scene_of_all(false), expected = {0};
    scene_write("later.pbrt", later.bytes, later.length);
    scene_write("now.pbrt", now.bytes, now.length);
    const uint64_t hash = hash_with(scene_path("now.pbrt"), 1, &expected);
    const uint32_t threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        text said = {0};
        assert_true(hash_with(scene_path("later.pbrt"), threads[i], &said) == hash);
        assert_string_equal(said.bytes, expected.bytes);
        free(said.bytes);
    }
    free(later.bytes), free(now.bytes), free(expected.bytes);
}

static void objects_have_their_meshes(void **state) {
    (void)state;
    text t = {0};
    add(&t, "WorldBegin ObjectBegin \"o\" Translate 0 0 5\n");
    add_sheet(&t, 30, 0, true);
    add(&t, "ObjectEnd Translate 10 0 0 ObjectInstance \"o\" Translate 0 0 1 ObjectInstance \"o\"");
    sag_world *world = scene_load_good(t.bytes);
    const double near = scene_shoot(world, 15.3, 5.3, 0, 0, 0, 1),
                 far = scene_shoot(world, 15.3, 5.3, 9, 0, 0, -1);
    assert_true(fabs(near - 5) < 2e-3 && fabs(far - 3) < 2e-3);
    sag_world_destroy(world);
    free(t.bytes);
}

// What is wrong with a mesh that waits comes before all that is wrong behind it, at its own place.
enum { THE_NUMBER = -1, THE_INDICES = -2 }; // columns that are found

static void errors_keep_their_order(void **state) {
    (void)state;
    write_ply("a.ply", 50);
    static const struct {
        const char *before, *inside, *after; // the sheet stands between; `inside` replaces a number of it
        int line, column;
        const char *what;
    } cases[] = {
        {"", NULL, "Oops", 3, 1, "unknown directive Oops"},
        {"Shape \"plymesh\" \"string filename\" \"none.ply\"", NULL, "Oops", 1, 28, "none.ply: cannot read"},
        {"Shape \"plymesh\" \"string filename\" \"none.ply\"", "x", "", 1, 28, "none.ply: cannot read"},
        {"Shape \"plymesh\" \"string filename\" \"a.ply\"", "12x", "Oops", 2, THE_NUMBER,
         "a number expected"},
        {"", "\"no\"", "Shape \"sphere\" \"float radius\" -1", 2, THE_NUMBER, "a number expected"},
        {"", "[", "", 2, THE_NUMBER, "a [ within [ ]"},
        {"", "", "", 2, THE_INDICES, "not a multiple of 3"},
        {"", "-1", "Shape \"plymesh\" \"string filename\" \"none.ply\"", 2, THE_INDICES,
         "is -1, but there are 400"},
        {"", "400", "", 2, THE_INDICES, "is 400, but there are 400 points"},
        {"", "0.5", "Oops", 2, THE_NUMBER, "0.5 is not an integer of 32 bits"},
        {"ObjectBegin \"o\"", "1e3", "ObjectEnd ObjectInstance \"o\" Oops", 2, THE_INDICES, "is 1000, but"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        text t = {0}, sheet = {0};
        add_sheet(&sheet, 20, 0, true);
        for (char *c = sheet.bytes; *c; c++)
            if (*c == '\n' || *c == '\r') *c = ' '; // a single line, as some programs write
        add(&t, "WorldBegin %s\n", cases[i].before);
        const char *const indices = strstr(sheet.bytes, "\"integer"), *const number =
                                                                          strstr(indices, " 399 ");
        const size_t first = (size_t)(number - sheet.bytes);
        text whole = {0};
        whole.bytes = malloc(whole.room = t.length + sheet.length + 256);
        whole.length = (size_t)sprintf(whole.bytes, "%s%.*s %s %s\n%s", t.bytes, (int)first, sheet.bytes,
                                       cases[i].inside ? cases[i].inside : "399", number + 5, cases[i].after);
        const int column = cases[i].column == THE_NUMBER    ? (int)first + 2
                           : cases[i].column == THE_INDICES ? (int)(indices - sheet.bytes) + 1
                                                            : cases[i].column;
        scene_fails(whole.bytes, cases[i].line, column, cases[i].what);
        free(t.bytes), free(sheet.bytes), free(whole.bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_for_all_threads),
        cmocka_unit_test(objects_have_their_meshes),
        cmocka_unit_test(errors_keep_their_order),
    };
    return cmocka_run_group_tests(tests, scene_setup, scene_teardown);
}
