// SPDX-License-Identifier: MIT
// The table of shapes: what the scene, the solids and the tests need to know of every kind, without knowing
// the kind. The hot path does not come here: it switches on the kind (src/kernel). Adding a shape:
// docs/adding-a-shape.md.
#ifndef SAGI_SHAPES_SHAPE_H
#define SAGI_SHAPES_SHAPE_H

#include <sagitta/shapes.h>

// The cold functions of one kind, with the meaning said in shapes.h. `shape` points to that kind's struct.
typedef struct sagi_shape_class {
    const char *name;
    size_t struct_bytes;
    sag_status (*validate)(const void *shape, sag_error *error);
    sag_box3 (*bounds)(const void *shape);
    bool (*hit)(const void *shape, const sag_ray *ray, sag_hit *hit);
    bool (*occluded)(const void *shape, const sag_ray *ray);
    size_t (*crossings)(const void *shape, const sag_ray *ray, sag_hit *hits, size_t capacity);
    void (*surface)(const void *shape, const sag_ray *ray, const sag_hit *hit, sag_surface *surface);
    double (*area)(const void *shape);
    bool (*sample)(const void *shape, sag_vec2 random, sag_surface *surface);
    bool (*contains)(const void *shape, sag_vec3 point);          // NULL: not closed
    double (*volume)(const void *shape);                          // NULL: not closed
    sag_vec3 (*closest_point)(const void *shape, sag_vec3 point); // NULL: not offered
} sagi_shape_class;

#define SAGI_SHAPE_KIND_COUNT (SAG_SHAPE_INSTANCE + 1)

// Indexed by sag_shape_kind; SAG_SHAPE_INSTANCE's entry has a name only.
extern const sagi_shape_class sagi_shape_classes[SAGI_SHAPE_KIND_COUNT];

#endif
