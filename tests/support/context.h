// SPDX-License-Identifier: MIT
// One context for a whole test program: setup and teardown go to cmocka_run_group_tests. With SAGITTA_GUARDED
// in the environment its memory is guarded_memory.h's.
#ifndef TESTS_SUPPORT_CONTEXT_H
#define TESTS_SUPPORT_CONTEXT_H

#include <sagitta/scene.h>

extern sag_context *context;
int setup(void **state);
int teardown(void **state);
// A committed scene of one mesh; the caller destroys it.
sag_scene *scene_of(const sag_mesh *mesh);

#endif
