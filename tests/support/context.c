// SPDX-License-Identifier: MIT
#include "support/context.h"
#include "support/guarded_memory.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

sag_context *context;

int setup(void **state) {
    (void)state;
    context = sag_context_create(&(sag_context_options){.allocator = guarded_if_asked()});
    return context == NULL;
}
int teardown(void **state) {
    (void)state;
    sag_context_destroy(context);
    return 0;
}

sag_scene *scene_of(const sag_mesh *mesh) {
    sag_scene *scene = sag_scene_create(context);
    sag_add_mesh(scene, mesh);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}
