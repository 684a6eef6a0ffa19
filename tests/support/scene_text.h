// SPDX-License-Identifier: MIT
// Scene texts for tests of the loader: written to a folder of their own, loaded, or expected to fail at a
// place. One program, one context; scene_setup and scene_teardown go to cmocka_run_group_tests.
#ifndef TESTS_SUPPORT_SCENE_TEXT_H
#define TESTS_SUPPORT_SCENE_TEXT_H

#include <sagitta/render.h>

extern sag_context *scene_context;
// What the loader said since the last scene_load: its lines, and how many.
extern char scene_warnings[16384];
extern int scene_warning_count;

int scene_setup(void **state);
int scene_teardown(void **state);
// The path of a name in the folder; good for four calls.
const char *scene_path(const char *name);
void scene_write(const char *name, const void *bytes, size_t size);
// Loads a text into a new world, as scene.pbrt in the folder.
sag_status scene_load(const char *text, sag_world **world, sag_error *error);
// The same for a text that must load; its scene is committed.
sag_world *scene_load_good(const char *text);
// The text must fail at this place with this in its message, and give all memory back.
void scene_fails(const char *text, int line, int column, const char *what);
// The text must load, or fail for want of memory and leak none, whichever allocation fails.
void scene_fails_without_memory(const char *text);
// t of the first hit along a ray of the loaded scene; NAN for a miss.
double scene_shoot(sag_world *world, double ox, double oy, double oz, double dx, double dy, double dz);
// Equal to 1e-12.
void scene_near(double got, double wanted);

#endif
