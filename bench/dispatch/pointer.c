// SPDX-License-Identifier: MIT
// A pointer in each object to the functions of its class, as C++'s virtual functions have it. It stands in
// sagi_item.child, which only instances use: the scenes here have none (main.c).
#include "dispatch.h"
#include "shapes/shape.h"
#define SAGI_KERNEL_NAME dispatch_pointer
#define SAGI_KERNEL_OTHER_LIST
#include "kernel/kernel.inl"

static __attribute__((noinline)) bool list(question asked, level *here, const sagi_bvh_reference *refs,
                                           uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const sagi_item *item = &here->world->items[refs[i].geometry];
        local_ray at = {.item = NULL};
        const sag_ray *ray = sees(here, item) ? local(here, item, &at) : NULL;
        if (ray == NULL) continue;
        const sagi_shape_class *class = (const void *)item->child;
        sag_hit hits[SAGI_MAX_CROSSINGS];
        size_t found = asked == ANY       ? (size_t) class->occluded(item->shape, ray)
                       : asked == CLOSEST ? (size_t) class->hit(item->shape, ray, hits)
                                          : class->crossings(item->shape, ray, hits, SAGI_MAX_CROSSINGS);
        if (asked == ANY && found > 0) return here->search->found = true;
        for (size_t k = 0; k < found && k < SAGI_MAX_CROSSINGS; k++)
            if (accept(asked, here, refs[i].geometry, hits[k].primitive, hits[k].t, hits[k].u, hits[k].v))
                return true;
    }
    return false;
}
