// SPDX-License-Identifier: MIT
// Saved and loaded scenes: the same bits for every query, nothing lost; and a file that is cut, damaged,
// foreign or of another version is an error that says where.
#include "base/checksum.h"
#include "scene/file.h"
#include "support/context.h"
#include "support/failing_allocator.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include "support/saved.h"
#include "support/shape_solid.h"
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[64] = "/tmp/sagitta-save-XXXXXX";

static int set_up(void **state) { return mkdtemp(folder) == NULL || setup(state) != 0; }
static int tear_down(void **state) { return rmdir(folder) != 0 || teardown(state) != 0; }

static const char *in_folder(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static uint32_t files_in_folder(void) {
    uint32_t count = 0;
    DIR *d = opendir(folder);
    for (struct dirent *e; (e = readdir(d)) != NULL;) count += e->d_name[0] != '.' || strlen(e->d_name) > 2;
    closedir(d);
    return count;
}

static void checksum_is_xxh64(void **state) {
    (void)state;
    const char *text = "Nobody inspects the spammish repetition";
    assert_true(sagi_checksum(NULL, 0) == 0xEF46DB3751D8E999u);
    assert_true(sagi_checksum("a", 1) == 0xD24EC4F1A98C6E5Bu);
    assert_true(sagi_checksum("abc", 3) == 0x44BC2CF5AD770999u);
    assert_true(sagi_checksum(text, strlen(text)) == 0xFBCEA83C8A378BF1u);
}

static void assert_same_stats(const sag_scene *a, const sag_scene *b) {
    sag_scene_stats x, y;
    sag_scene_get_stats(a, &x), sag_scene_get_stats(b, &y);
    x.build_seconds = y.build_seconds = 0;
    x.memory_bytes = y.memory_bytes = 0; // a table may be larger than it has to be
    assert_memory_equal(&x, &y, sizeof x);
}

static void check_round_trip(uint64_t seed, uint32_t count, int levels, double size) {
    rng r = rng_make(seed);
    sag_error error;
    sag_scene *scene = random_nested_scene(&r, context, count, levels, size), *loaded = NULL;
    assert_int_equal(sag_scene_set_quality(scene, (sag_quality)(seed % 3)), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    assert_true(file.count > 0);
    if (saved_read(context, file.bytes, file.count, &loaded, &error) != SAG_OK) fail_msg("%s", error.message);
    assert_same_stats(scene, loaded);
    assert_same_answers(scene, loaded, &r, 100, size);
    saved again = saved_from(loaded, NULL, NULL);
    assert_true(again.count == file.count && memcmp(again.bytes, file.bytes, file.count) == 0);
    // Both can be changed, and committed again.
    rng one = r, two = r;
    for (int i = 0; i < 3; i++) {
        sag_shape_kind kind = (sag_shape_kind)rng_below(&r, SAG_SHAPE_USER);
        assert_int_equal(random_scene_add(&one, scene, kind, size),
                         random_scene_add(&two, loaded, kind, size));
    }
    assert_int_equal(sag_geometry_remove(scene, 0), sag_geometry_remove(loaded, 0));
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(loaded, NULL), SAG_OK);
    assert_same_stats(scene, loaded);
    assert_same_answers(scene, loaded, &r, 50, size);
    saved_free(&file), saved_free(&again);
    sag_scene_destroy(scene), sag_scene_destroy(loaded);
}

static void same_bits_for_every_query(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 6; seed++) check_round_trip(seed, 45, (int)(seed % 4), 1);
    check_round_trip(7, 60, 2, 1e-9);
    check_round_trip(8, 60, 2, 1e9);
    check_round_trip(9, 4, SAG_MAX_INSTANCE_DEPTH, 1);
}

// Solids of everything, several levels of them, with a part that is not there: the tree and the meshes' own
// trees come back.
static void solids(void **state) {
    (void)state;
    rng r = rng_make(41);
    for (int i = 0; i < 30; i++) {
        shape_solid solid[3], *last = NULL;
        for (int k = 0; k < 3; k++) shape_solid_make(&r, context, &solid[k], 1, last), last = &solid[k];
        for (int k = 0; k < 3; k += 2) {
            uint32_t part = rng_below(&r, sagi_scene_snapshot(solid[k].scene)->count);
            sag_geometry_set_enabled(solid[k].scene, part, rng_one_in(&r, 2));
            sag_scene_set_quality(solid[k].scene, (sag_quality)(i % 3));
            assert_int_equal(sag_scene_commit(solid[k].scene, NULL), SAG_OK);
        }
        sag_scene *scene = sag_scene_create(context), *loaded = NULL;
        for (int k = 0; k < 6; k++) {
            sag_affine map;
            random_place(&r, 2, &map);
            sag_add_instance(scene, solid[k % 3].scene, &map);
        }
        random_scene_add(&r, scene, SAG_SHAPE_MESH, 1);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        const sag_scene *saved_ones[2] = {scene, solid[2].scene};
        for (int k = 0; k < 2; k++) {
            sag_error error;
            saved file = saved_from(saved_ones[k], NULL, NULL);
            if (saved_read(context, file.bytes, file.count, &loaded, &error) != SAG_OK)
                fail_msg("%s", error.message);
            assert_same_stats(saved_ones[k], loaded);
            assert_same_answers(saved_ones[k], loaded, &r, 60, 1);
            saved again = saved_from(loaded, NULL, NULL);
            assert_true(again.count == file.count && memcmp(again.bytes, file.bytes, file.count) == 0);
            // Committed again it is still the solid.
            sag_geometry_set_mask(loaded, 0, 0);
            assert_int_equal(sag_scene_commit(loaded, NULL), SAG_OK);
            assert_same_answers(saved_ones[k], loaded, &r, 20, 1);
            saved_free(&file), saved_free(&again);
            sag_scene_destroy(loaded);
        }
        sag_scene_destroy(scene);
        for (int k = 0; k < 3; k++) sag_scene_destroy(solid[k].scene);
    }
}

static void empty_scene(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context), *loaded = NULL;
    sag_status status;
    sag_error error;
    saved none = saved_from(scene, &status, &error);
    assert_int_equal(status, SAG_ERROR_STATE);
    saved_free(&none);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, &status, &error);
    assert_int_equal(saved_read(context, file.bytes, file.count, &loaded, &error), SAG_OK);
    assert_same_stats(scene, loaded);
    saved_free(&file);
    sag_scene_destroy(scene), sag_scene_destroy(loaded);
}

static bool counting(void *user, const void *data, size_t bytes) {
    (void)data;
    *(size_t *)user += bytes;
    return true;
}

// A loaded scene goes on where the saved one was: a commit takes over what has not changed.
static void loaded_scenes_keep_their_trees(void **state) {
    (void)state;
    rng r = rng_make(10);
    test_mesh meshes[3];
    sag_scene *scene = sag_scene_create(context), *loaded = NULL;
    for (int i = 0; i < 3; i++) {
        meshes[i] = test_mesh_sphere(3);
        test_mesh_move(&meshes[i], 1, rng_vec3(&r, 2), 0.01, &r);
        uint32_t id = sag_add_mesh(scene, &meshes[i].mesh);
        sag_geometry_set_update(scene, id, (sag_update)i);
    }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    assert_int_equal(saved_read(context, file.bytes, file.count, &loaded, NULL), SAG_OK);
    for (int step = 0; step < 3; step++) {
        test_mesh_move(&meshes[2], 1, sag_vec3_make(0, 0, 0), 0.05, &r);
        assert_int_equal(sag_geometry_set_shape(scene, 2, SAG_SHAPE_MESH, &meshes[2].mesh, NULL), SAG_OK);
        assert_int_equal(sag_geometry_set_shape(loaded, 2, SAG_SHAPE_MESH, &meshes[2].mesh, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        assert_int_equal(sag_scene_commit(loaded, NULL), SAG_OK);
        // The same file says: the same trees, one of them refitted.
        saved one = saved_from(scene, NULL, NULL), two = saved_from(loaded, NULL, NULL);
        assert_true(one.count == two.count && memcmp(one.bytes, two.bytes, one.count) == 0);
        assert_true(loaded->cell->current->groups[2].is_refitted);
        saved_free(&one), saved_free(&two);
    }
    for (int i = 0; i < 3; i++) test_mesh_free(&meshes[i]);
    saved_free(&file);
    sag_scene_destroy(scene), sag_scene_destroy(loaded);
}

// Ten thousand instances of one scene cost ten thousand entries, not ten thousand scenes.
static void shared_scenes_are_written_once(void **state) {
    (void)state;
    rng r = rng_make(3);
    sag_scene *child = random_scene(&r, context, 200, 1), *parent = sag_scene_create(context);
    size_t child_bytes = 0, bytes = 0;
    assert_int_equal(sag_scene_write(child, counting, &child_bytes, NULL), SAG_OK);
    for (int i = 0; i < 10000; i++) {
        sag_affine map = sag_affine_translate(rng_vec3(&r, 1000));
        sag_add_instance(parent, child, &map);
    }
    assert_int_equal(sag_scene_commit(parent, NULL), SAG_OK);
    assert_int_equal(sag_scene_write(parent, counting, &bytes, NULL), SAG_OK);
    assert_true(bytes < child_bytes + 10000 * 400);
    sag_scene_destroy(child), sag_scene_destroy(parent);
}

static sag_box3 user_bounds(void *user, uint32_t primitive) {
    (void)user, (void)primitive;
    return (sag_box3){{-1, -1, -1}, {1, 1, 1}};
}
static void user_crossings(void *user, const uint32_t *primitives, size_t count, const sag_ray *ray,
                           sag_user_report *report) {
    (void)user, (void)primitives, (void)count, (void)ray, (void)report;
}
static void user_surface(void *user, const sag_ray *ray, const sag_hit *hit, sag_surface *surface) {
    (void)user, (void)ray, (void)hit, (void)surface;
}

static void callbacks_cannot_be_saved(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    sag_add_user(scene, &(sag_user){1, NULL, user_bounds, user_crossings, user_surface});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_error error = {0};
    assert_int_equal(sag_scene_save(scene, in_folder("user"), &error), SAG_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "geometry 1"));
    assert_int_equal(files_in_folder(), 0);
    sag_scene_destroy(scene);
}

static void files_appear_whole_or_not(void **state) {
    (void)state;
    rng r = rng_make(4);
    sag_scene *scene = random_nested_scene(&r, context, 30, 1, 1), *loaded = NULL;
    sag_error error = {0};
    char path[128];
    snprintf(path, sizeof path, "%s", in_folder("scene.sag"));
    assert_int_equal(sag_scene_save(scene, path, &error), SAG_OK);
    assert_int_equal(sag_scene_save(scene, path, &error), SAG_OK); // over the first
    assert_int_equal(files_in_folder(), 1);
    assert_int_equal(sag_scene_load(context, path, &loaded, &error), SAG_OK);
    assert_same_answers(scene, loaded, &r, 50, 1);
    sag_scene_destroy(loaded);
    loaded = NULL;
    // Cut, or with something after its end.
    struct stat about;
    assert_int_equal(stat(path, &about), 0);
    assert_int_equal(truncate(path, about.st_size - 1), 0);
    assert_int_equal(sag_scene_load(context, path, &loaded, &error), SAG_ERROR_FORMAT);
    assert_string_equal(error.file, path);
    assert_int_equal(truncate(path, about.st_size + 1), 0);
    assert_int_equal(sag_scene_load(context, path, &loaded, &error), SAG_ERROR_FORMAT);
    unlink(path);
    assert_int_equal(sag_scene_load(context, path, &loaded, &error), SAG_ERROR_IO);
    assert_string_equal(error.file, path);
    assert_int_equal(sag_scene_load(context, folder, &loaded, &error), SAG_ERROR_IO);
    assert_int_equal(sag_scene_save(scene, "/no/such/folder/scene.sag", &error), SAG_ERROR_IO);
    assert_string_equal(error.file, "/no/such/folder/scene.sag");
    assert_int_equal(mkdir(path, 0777), 0); // a folder is in the way
    assert_int_equal(sag_scene_save(scene, path, &error), SAG_ERROR_IO);
    assert_int_equal(files_in_folder(), 1);
    rmdir(path);
    assert_int_equal(sag_scene_load(context, "/dev/null", &loaded, &error), SAG_ERROR_FORMAT);
    assert_null(loaded);
    // A link stays a link, a device a device.
    char link[128];
    snprintf(link, sizeof link, "%s", in_folder("link.sag"));
    assert_int_equal(sag_scene_save(scene, path, &error), SAG_OK);
    assert_int_equal(symlink(path, link), 0);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(sag_scene_save(scene, path, &error), SAG_OK);
    assert_int_equal(sag_scene_save(scene, link, &error), SAG_OK);
    assert_true(lstat(link, &about) == 0 && S_ISLNK(about.st_mode));
    assert_int_equal(sag_scene_load(context, link, &loaded, &error), SAG_OK);
    sag_scene_destroy(loaded);
    unlink(link), unlink(path);
    assert_int_equal(sag_scene_save(scene, "/dev/null", &error), SAG_OK);
    assert_true(stat("/dev/null", &about) == 0 && S_ISCHR(about.st_mode));
    if (access("/dev/full", W_OK) == 0) {
        assert_int_equal(sag_scene_save(scene, "/dev/full", &error), SAG_ERROR_IO);
        assert_string_equal(error.file, "/dev/full");
    }
    assert_int_equal(sag_scene_save(scene, NULL, &error), SAG_ERROR_ARGUMENT);
    assert_int_equal(sag_scene_load(context, NULL, &loaded, &error), SAG_ERROR_ARGUMENT);
    sag_scene_destroy(scene);
}

static bool has_mesh(const sag_scene *scene) {
    const sagi_snapshot *s = sagi_scene_snapshot(scene);
    for (uint32_t i = 0; i < s->count; i++)
        if (s->items[i].kind == SAG_SHAPE_MESH) return true;
    return false;
}

static saved small_file(void) {
    rng r = rng_make(5);
    sag_scene *scene = random_nested_scene(&r, context, 9, 1, 1);
    random_scene_add(&r, scene, SAG_SHAPE_MESH, 1);
    random_scene_add(&r, scene, SAG_SHAPE_SPHERES, 1);
    random_scene_add(&r, scene, SAG_SHAPE_POLYGON, 1);
    random_scene_add(&r, scene, SAG_SHAPE_POLYHEDRON, 1);
    shape_solid solid; // of a mesh and more
    do shape_solid_make(&r, context, &solid, 1, NULL);
    while (!has_mesh(solid.scene) && (sag_scene_destroy(solid.scene), true));
    sag_add_instance(scene, solid.scene, NULL);
    sag_scene_destroy(solid.scene);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene);
    return file;
}

static void cut_anywhere(void **state) {
    (void)state;
    saved file = small_file();
    sag_scene *scene = NULL;
    sag_error error = {0};
    for (size_t length = 0; length < file.count; length++) {
        assert_int_equal(saved_read(context, file.bytes, length, &scene, &error), SAG_ERROR_FORMAT);
        assert_non_null(strstr(error.message, "byte "));
    }
    assert_int_equal(saved_read(context, file.bytes, file.count, &scene, &error), SAG_OK);
    sag_scene_destroy(scene);
    saved_free(&file);
}

static void any_bit_flipped(void **state) {
    (void)state;
    saved file = small_file();
    sag_scene *scene = NULL;
    sag_error error = {0};
    for (size_t bit = 0; bit < 8 * file.count; bit += 11) { // in most bytes one
        file.bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        assert_int_equal(saved_read(context, file.bytes, file.count, &scene, &error), SAG_ERROR_FORMAT);
        file.bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    assert_null(scene);
    saved_free(&file);
}

static void foreign_files(void **state) {
    (void)state;
    saved file = small_file();
    sag_scene *scene = NULL;
    sag_error error = {0};
    sagi_file_head *head = (void *)file.bytes, kept = *head;
    unsigned char text[256];
    memset(text, 'x', sizeof text);
    assert_int_equal(saved_read(context, text, sizeof text, &scene, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "not a saved scene"));
    head->version++;
    saved_seal(&file);
    assert_int_equal(saved_read(context, file.bytes, file.count, &scene, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "version 5"));
    *head = kept;
    head->byte_order = 0x04030201;
    saved_seal(&file);
    assert_int_equal(saved_read(context, file.bytes, file.count, &scene, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "byte order"));
    *head = kept;
    head->bytes = UINT64_MAX; // nothing of that size is allocated
    head->scene_count = UINT32_MAX;
    saved_seal(&file);
    assert_int_equal(saved_read(context, file.bytes, file.count, &scene, &error), SAG_ERROR_FORMAT);
    assert_null(scene);
    saved_free(&file);
}

// No byte after the end is asked for: another scene may follow in the same stream.
static void scenes_in_a_row(void **state) {
    (void)state;
    saved file = small_file();
    saved two = {.count = 2 * file.count, .bytes = malloc(2 * file.count)};
    memcpy(two.bytes, file.bytes, file.count);
    memcpy(two.bytes + file.count, file.bytes, file.count);
    sag_scene *scene = NULL;
    sag_error error;
    assert_int_equal(saved_read(context, two.bytes, two.count, &scene, &error), SAG_OK);
    sag_scene_destroy(scene);
    saved_free(&file), saved_free(&two);
}

static bool refuse(void *user, const void *data, size_t bytes) {
    (void)data, (void)bytes;
    size_t *left = user;
    return (*left)-- > 0;
}

static void callback_that_fails(void **state) {
    (void)state;
    rng r = rng_make(6);
    sag_scene *scene = random_scene(&r, context, 20, 1);
    for (size_t calls = 0;; calls++) {
        size_t left = calls;
        sag_error error = {0};
        sag_status status = sag_scene_write(scene, refuse, &left, &error);
        if (status == SAG_OK) break;
        assert_int_equal(status, SAG_ERROR_IO);
        assert_non_null(strstr(error.message, "byte "));
    }
    sag_scene_destroy(scene);
}

static void memory_ends_anywhere(void **state) {
    (void)state;
    saved file = small_file();
    for (size_t k = 0;; k++) {
        failing_allocator books = {.fail_at = k};
        sag_context_options options = {.allocator = failing_allocator_make(&books), .thread_count = 1};
        sag_context *own = sag_context_create(&options);
        sag_scene *scene = NULL;
        bool done = false;
        if (own != NULL) {
            sag_status status = saved_read(own, file.bytes, file.count, &scene, NULL);
            if (status != SAG_OK) assert_int_equal(status, SAG_ERROR_MEMORY);
            if (status == SAG_OK) {
                saved again = saved_from(scene, &status, NULL);
                if (status != SAG_OK) assert_int_equal(status, SAG_ERROR_MEMORY);
                done = status == SAG_OK;
                saved_free(&again);
            }
        }
        sag_scene_destroy(scene);
        sag_context_destroy(own);
        failing_allocator_assert_empty(&books);
        if (done) break;
    }
    saved_free(&file);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(checksum_is_xxh64),
        cmocka_unit_test(same_bits_for_every_query),
        cmocka_unit_test(solids),
        cmocka_unit_test(empty_scene),
        cmocka_unit_test(shared_scenes_are_written_once),
        cmocka_unit_test(loaded_scenes_keep_their_trees),
        cmocka_unit_test(callbacks_cannot_be_saved),
        cmocka_unit_test(files_appear_whole_or_not),
        cmocka_unit_test(cut_anywhere),
        cmocka_unit_test(any_bit_flipped),
        cmocka_unit_test(foreign_files),
        cmocka_unit_test(scenes_in_a_row),
        cmocka_unit_test(callback_that_fails),
        cmocka_unit_test(memory_ends_anywhere),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
