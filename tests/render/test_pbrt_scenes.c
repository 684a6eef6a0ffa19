// SPDX-License-Identifier: MIT
// Scenes in the manner of those that others made for pbrt-v4 (tests/scenes): every one loads, and is
// rendered, without a word. Then the same scenes broken by chance: whatever is in a file, there is a message
// or a picture, never a crash, never memory that is not given back. SAGITTA_SOAK multiplies how many.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sagitta/image.h>

#include "support/scene_files.h"
#include "support/scene_text.h"

#define MAX_FILES 32
typedef struct file {
    char name[64];
    char *bytes;
    size_t size;
} file;
static file files[MAX_FILES];
static size_t file_count;

static void read_file(const char *name) {
    char path[512];
    snprintf(path, sizeof path, SAGITTA_SCENES "/%s", name);
    FILE *in = fopen(path, "rb");
    assert_non_null(in);
    file *f = &files[file_count++];
    snprintf(f->name, sizeof f->name, "%s", name);
    f->bytes = calloc(1, (1 << 16) + 1);
    f->size = fread(f->bytes, 1, 1 << 16, in);
    fclose(in);
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const file *)a)->name, ((const file *)b)->name);
}

// Reads the scenes, and copies them to where they are broken.
static int setup(void **state) {
    if (scene_setup(state) != 0) return 1;
    scene_copy_files();
    DIR *folder = opendir(SAGITTA_SCENES);
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;)
        if (entry->d_name[0] != '.' && file_count < MAX_FILES) read_file(entry->d_name);
    closedir(folder);
    qsort(files, file_count, sizeof *files, by_name);
    return 0;
}

static int teardown(void **state) {
    for (size_t i = 0; i < file_count; i++) free(files[i].bytes);
    return scene_teardown(state);
}

static bool is_scene(const file *f) { return strstr(f->bytes, "WorldBegin") != NULL; }

// Loads a file and renders a few pixels of it; false with the error.
static bool show(const char *name, sag_error *error) {
    scene_warnings[0] = '\0';
    scene_warning_count = 0;
    sag_world *world = sag_world_create(scene_context);
    memset(error, 0, sizeof *error);
    sag_status status = sag_world_load(world, scene_path(name), error);
    sag_settings *settings = sag_world_settings(world);
    if (status == SAG_OK) { // what the file says of these would take too long
        settings->film.width = settings->film.height = 6;
        settings->samples_per_pixel = 1;
        if (settings->max_depth > 5) settings->max_depth = 5;
        memset(settings->film.crop_window, 0, sizeof settings->film.crop_window);
        memset(settings->film.pixel_bounds, 0, sizeof settings->film.pixel_bounds);
        sag_render *render = sag_render_create(world, error);
        status = render ? sag_render_run(render, NULL, NULL, error) : error->status;
        sag_render_destroy(render);
    }
    sag_world_destroy(world);
    return status == SAG_OK;
}

static void load_without_a_word(void **state) {
    (void)state;
    size_t shown = 0;
    for (size_t i = 0; i < file_count; i++) {
        if (!is_scene(&files[i])) continue;
        sag_error error;
        if (!show(files[i].name, &error))
            fail_msg("%s:%d:%d: %s", error.file, error.line, error.column, error.message);
        // What is missing yet is named; anything else is a fault.
        for (const char *line = scene_warnings; *line; line = strchr(line, '\n') + 1) {
            const char *const end = strchr(line, '\n'), *const reason = strstr(line, "not supported");
            if (!reason || reason > end) fail_msg("%s", scene_warnings);
        }
        shown++;
    }
    assert_true(shown >= 10);
}

// ---- broken scenes

static uint32_t random_state;
static uint32_t next_random(uint32_t below) {
    random_state ^= random_state << 13, random_state ^= random_state >> 17, random_state ^= random_state << 5;
    return random_state % (below ? below : 1);
}

static const char *const pieces[] = {"[",
                                     "]",
                                     "\"",
                                     " ",
                                     "\n",
                                     "#",
                                     "\\",
                                     "1e999",
                                     "-",
                                     "nan",
                                     "-inf",
                                     "0",
                                     "1e-320",
                                     "1e38",
                                     "-1",
                                     "4294967295",
                                     "2147483648",
                                     "1e20",
                                     "0.5",
                                     "true",
                                     "\"float radius\" 0 ",
                                     "\"integer indices\" [9 9 9] ",
                                     "\"integer levels\" 2 ",
                                     "\"rgb L\" [1e30 0 1e-30] ",
                                     "\"float power\" 5 ",
                                     "\"float roughness\" -1 ",
                                     "\"texture alpha\" \"leaf\" ",
                                     "AttributeBegin ",
                                     "AttributeEnd ",
                                     "TransformEnd ",
                                     "ObjectBegin \"x\" ",
                                     "ObjectEnd ",
                                     "ObjectInstance \"plant\" ",
                                     "WorldBegin ",
                                     "Shape ",
                                     "Shape \"sphere\" ",
                                     "ReverseOrientation ",
                                     "Scale 1e-30 1e30 1 ",
                                     "Scale 1e-200 1 1 ",
                                     "Rotate 1e300 1 0 0 ",
                                     "Translate 1e30 0 0 ",
                                     "ActiveTransform EndTime ",
                                     "Include \"cage.pbrt\" ",
                                     "Import \"cage.pbrt\" ",
                                     "Include \"compact.pbrt\" ",
                                     "AreaLightSource \"diffuse\" ",
                                     "MediumInterface \"a\" ",
                                     "Material \"dielectric\" \"spectrum eta\" [1 2 3 4] ",
                                     "LightSource \"infinite\" \"string filename\" \"leaf.ply\" ",
                                     "LightSource \"infinite\" \"blackbody L\" 1e-5 ",
                                     "Attribute \"shape\" \"float alpha\" 0.5 ",
                                     "ColorSpace \"rec2020\" ",
                                     "Option \"seed\" 5 ",
                                     "SolidBegin \"difference\" ",
                                     "SolidEnd ",
                                     "CoordSysTransform \"camera\" "};

// One change: bytes, pieces of this file or another, numbers, the end.
static size_t change(char *text, size_t size, size_t room, const file *other) {
    const size_t at = next_random((uint32_t)size), span = next_random(24) % (size - at);
    const char *piece = pieces[next_random(sizeof pieces / sizeof *pieces)];
    size_t length = strlen(piece);
    switch (next_random(8)) {
    case 0: text[at] = (char)next_random(256); return size;
    case 1: text[at] ^= (char)(1 << next_random(8)); return size;
    case 2: memmove(text + at, text + at + span, size - at - span); return size - span;
    case 3: return at + 1;
    case 4: // a span of another file
        length = next_random(200) % other->size;
        piece = other->bytes + next_random((uint32_t)(other->size - length));
        break;
    case 5: // a digit
        for (size_t i = at; i < size; i++)
            if (text[i] >= '0' && text[i] <= '9') return text[i] = "0123456789.-e"[next_random(13)], size;
        return size;
    default: break;
    }
    if (size + length > room) return size;
    memmove(text + at + length, text + at, size - at);
    memcpy(text + at, piece, length);
    return size + length;
}

static void break_scenes(void **state) {
    (void)state;
    const char *soak = getenv("SAGITTA_SOAK");
    const int rounds = 400 * (soak && atoi(soak) > 0 ? atoi(soak) : 1);
    const size_t room = 1 << 17;
    char *text = malloc(room);
    size_t before, after;
    sag_context_memory(scene_context, &before, NULL);
    int good = 0;
    for (int round = 0; round < rounds; round++) {
        random_state = 2654435761u * (uint32_t)(round + 1) | 1;
        const file *f = &files[next_random((uint32_t)file_count)],
                   *other = &files[next_random((uint32_t)file_count)];
        memcpy(text, f->bytes, f->size);
        size_t size = f->size;
        for (uint32_t k = 1 + next_random(4); k-- > 0;) size = change(text, size, room, other);
        scene_write(f->name, text, size);
        sag_error error;
        // A file that is no scene is broken within the scenes that use it.
        const char *const name = is_scene(f)                         ? f->name
                                 : strcmp(f->name, "cage.pbrt") == 0 ? "subdivided.pbrt"
                                 : strcmp(f->name, "leaf.ply") == 0  ? "shapes.pbrt"
                                                                     : "instances.pbrt";
        if (getenv("SAGITTA_TELL")) print_message("%d %s\n", round, f->name);
        if (show(name, &error))
            good++;
        else if (!error.message[0] || error.line < 0)
            fail_msg("round %d, %s: no message", round, f->name);
        scene_write(f->name, f->bytes, f->size);
        sag_context_memory(scene_context, &after, NULL);
        if (before != after) fail_msg("round %d, %s: %zu bytes are left", round, f->name, after - before);
    }
    assert_true(good > 0 && good < rounds);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(load_without_a_word),
        cmocka_unit_test(break_scenes),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
