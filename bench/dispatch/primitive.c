// SPDX-License-Identifier: MIT
// A switch for each reference, whatever stands beside it.
#include "dispatch.h"
#define SAGI_KERNEL_NAME dispatch_primitive
#define SAGI_KERNEL_OTHER_LIST
#include "kernel/kernel.inl"

static __attribute__((noinline)) bool list(question asked, level *here, const sagi_bvh_reference *refs,
                                           uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        sag_shape_kind kind = (sag_shape_kind)here->world->items[refs[i].geometry].kind;
        if (run(asked, here, kind, refs + i, 1)) return true;
    }
    return false;
}
