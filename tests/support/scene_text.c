// SPDX-License-Identifier: MIT
#include "support/scene_text.h"
#include "support/failing_allocator.h"
#include "support/guarded_memory.h"
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

static char folder[64];
sag_context *scene_context;
char scene_warnings[16384];
int scene_warning_count;

static void on_log(void *user, sag_log_level level, const char *message) {
    (void)user, (void)level;
    const size_t length = strlen(scene_warnings);
    snprintf(scene_warnings + length, sizeof scene_warnings - length, "%s\n", message);
    scene_warning_count++;
}

int scene_setup(void **state) {
    (void)state;
    strcpy(folder, "/tmp/sagitta-pbrt-XXXXXX");
    const sag_context_options options = {.log = on_log, .thread_count = 1, .allocator = guarded_if_asked()};
    scene_context = sag_context_create(&options);
    return mkdtemp(folder) && scene_context ? 0 : 1;
}

int scene_teardown(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    sag_context_destroy(scene_context);
    return system(command);
}

const char *scene_path(const char *name) {
    static char paths[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(paths[next], sizeof paths[next], "%s/%s", folder, name);
    return paths[next];
}

void scene_write(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(scene_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

sag_status scene_load(const char *text, sag_world **world, sag_error *error) {
    scene_write("scene.pbrt", text, strlen(text));
    scene_warnings[0] = '\0';
    scene_warning_count = 0;
    *world = sag_world_create(scene_context);
    memset(error, 0, sizeof *error);
    return sag_world_load(*world, scene_path("scene.pbrt"), error);
}

sag_world *scene_load_good(const char *text) {
    sag_world *world;
    sag_error error;
    if (scene_load(text, &world, &error) != SAG_OK)
        fail_msg("%s:%d:%d: %s", error.file, error.line, error.column, error.message);
    if (sag_scene_commit(sag_world_scene(world), &error) != SAG_OK) fail_msg("%s", error.message);
    return world;
}

void scene_fails(const char *text, int line, int column, const char *what) {
    sag_world *world;
    sag_error error;
    size_t before, after;
    sag_context_memory(scene_context, &before, NULL);
    if (scene_load(text, &world, &error) == SAG_OK) fail_msg("loaded: %s", text);
    if (error.line != line || error.column != column || !strstr(error.message, what))
        fail_msg("%d:%d: %s\nwanted %d:%d: %s\nfor %s", error.line, error.column, error.message, line, column,
                 what, text);
    assert_non_null(strstr(error.file, "scene.pbrt"));
    sag_world_destroy(world);
    sag_context_memory(scene_context, &after, NULL);
    assert_int_equal(before, after);
}

double scene_shoot(sag_world *world, double ox, double oy, double oz, double dx, double dy, double dz) {
    const sag_ray ray = sag_ray_make(sag_vec3_make(ox, oy, oz), sag_vec3_make(dx, dy, dz));
    sag_hit hit;
    return sag_intersect(sag_world_scene(world), &ray, &hit) ? hit.t : NAN;
}

void scene_near(double got, double wanted) {
    if (!(fabs(got - wanted) <= 1e-12 * fmax(1, fabs(wanted)))) fail_msg("%.17g, not %.17g", got, wanted);
}

void scene_fails_without_memory(const char *text) {
    scene_write("memory.pbrt", text, strlen(text));
    for (size_t k = 0;; k++) {
        failing_allocator books = {.fail_at = k};
        const sag_context_options options = {.allocator = failing_allocator_make(&books), .thread_count = 1};
        sag_context *small = sag_context_create(&options);
        sag_world *world = small ? sag_world_create(small) : NULL;
        sag_error error = {0};
        const sag_status status =
            world ? sag_world_load(world, scene_path("memory.pbrt"), &error) : SAG_ERROR_MEMORY;
        if (status != SAG_OK && status != SAG_ERROR_MEMORY) fail_msg("allocation %zu: %s", k, error.message);
        sag_world_destroy(world);
        sag_context_destroy(small);
        failing_allocator_assert_empty(&books);
        if (status == SAG_OK) break;
    }
}
