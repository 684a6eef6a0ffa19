// SPDX-License-Identifier: MIT
// One switch for each run of references of one kind: a loop in every case.
#include "dispatch.h"
#define SAGI_KERNEL_NAME dispatch_run
#define SAGI_KERNEL_OTHER_LIST
#include "kernel/kernel.inl"

// leaf.inl's single_run, its loop around one verb.
#define LOOP(X)                                                                                              \
    for (uint32_t i = 0; i < count; i++) {                                                                   \
        const sagi_item *item = &here->world->items[refs[i].geometry];                                       \
        local_ray at = {.item = NULL};                                                                       \
        const sag_ray *ray = sees(here, item) ? local(here, item, &at) : NULL;                               \
        if (ray == NULL) continue;                                                                           \
        const void *shape = item->shape;                                                                     \
        sag_hit hits[SAGI_MAX_CROSSINGS];                                                                    \
        size_t found = ASK(X);                                                                               \
        if (asked == ANY && found > 0) return here->search->found = true;                                    \
        for (size_t k = 0; k < found && k < SAGI_MAX_CROSSINGS; k++)                                         \
            if (accept(asked, here, refs[i].geometry, hits[k].primitive, hits[k].t, hits[k].u, hits[k].v))   \
                return true;                                                                                 \
    }                                                                                                        \
    return false

static inline bool loops(question asked, level *here, sag_shape_kind kind, const sagi_bvh_reference *refs,
                         uint32_t count) {
    switch (kind) {
    case SAG_SHAPE_PLANE: LOOP(plane);
    case SAG_SHAPE_DISK: LOOP(disk);
    case SAG_SHAPE_RECTANGLE: LOOP(rectangle);
    case SAG_SHAPE_POLYGON: LOOP(polygon);
    case SAG_SHAPE_SPHERE: LOOP(sphere);
    case SAG_SHAPE_ELLIPSOID: LOOP(ellipsoid);
    case SAG_SHAPE_CYLINDER: LOOP(cylinder);
    case SAG_SHAPE_CONE: LOOP(cone);
    case SAG_SHAPE_PARABOLOID: LOOP(paraboloid);
    case SAG_SHAPE_HYPERBOLOID: LOOP(hyperboloid);
    case SAG_SHAPE_HYPERBOLOID2: LOOP(hyperboloid2);
    case SAG_SHAPE_QUADRIC: LOOP(quadric);
    case SAG_SHAPE_BOX: LOOP(box);
    case SAG_SHAPE_ORIENTED_BOX: LOOP(oriented_box);
    case SAG_SHAPE_POLYHEDRON: LOOP(polyhedron);
    case SAG_SHAPE_CAPSULE: LOOP(capsule);
    case SAG_SHAPE_TRIANGLE: LOOP(triangle);
    case SAG_SHAPE_BILINEAR_PATCH: LOOP(bilinear_patch);
    case SAG_SHAPE_TORUS: LOOP(torus);
    case SAG_SHAPE_MESH:
    case SAG_SHAPE_SPHERES:
    case SAG_SHAPE_USER:
    case SAG_SHAPE_INSTANCE: break;
    }
    return run(asked, here, kind, refs, count);
}

static __attribute__((noinline)) bool list(question asked, level *here, const sagi_bvh_reference *refs,
                                           uint32_t count) {
    for (uint32_t i = 0, n; i < count; i += n) {
        uint8_t kind = here->world->items[refs[i].geometry].kind;
        for (n = 1; i + n < count && here->world->items[refs[i + n].geometry].kind == kind; n++) {
        }
        if (loops(asked, here, (sag_shape_kind)kind, refs + i, n)) return true;
    }
    return false;
}
