// SPDX-License-Identifier: MIT
// A solid as the tests know it: the parts with their regions (region.h), the steps, and from them both the
// truth about a point and the library's solid. Parts may be models in turn.
#ifndef TESTS_SUPPORT_SOLID_MODEL_H
#define TESTS_SUPPORT_SOLID_MODEL_H

#include "support/random_shape.h"
#include "support/region.h"
#include <sagitta/solid.h>

typedef struct solid_model solid_model;

typedef struct model_part {
    random_shape shape;
    shape_region region;
    solid_model *child; // not NULL: an instance of this instead of a shape
    bool mapped, disabled;
    sag_affine map, back; // to the solid's space, and the inverse in doubles
    inverse_map inverse;
    uint32_t id;    // in the scene
    uint32_t state; // where its membership is among the states of the model; a child's own states follow it
} model_part;

enum { MODEL_MAX_STEPS = 4096 };

struct solid_model {
    uint32_t part_count, step_count;
    model_part *parts[MODEL_MAX_STEPS];    // in the order of the steps
    sag_solid_step steps[MODEL_MAX_STEPS]; // the number of a part is that in parts[]
    uint32_t state_count;
    sag_scene *scene; // committed
};

// NULL when memory is short.
solid_model *solid_model_create(void);
// Appends a part, and a step that names it. The caller fills its shape (which random_shape_make or hand did
// in place) or child.
model_part *solid_model_add(solid_model *model);
void solid_model_map(model_part *part, const sag_affine *map);
void solid_model_step(solid_model *model, sag_solid_operation operation, uint32_t operands);
// After all of it: makes the regions, and the scene with its parts added in random order. The status and
// message are the commit's.
sag_status solid_model_finish(solid_model *model, sag_context *context, rng *r, sag_error *error);
// With its children.
void solid_model_destroy(solid_model *model);

// Whether the spot is in the solid; states[state_count] become those of the parts. Exact where it matters and
// can be.
membership solid_model_at(const solid_model *model, const spot *at, membership *states);
// The value of the tree for states that are known.
membership solid_model_value(const solid_model *model, const membership *states);

typedef struct model_crossing {
    double t;
    uint32_t state; // of the part
    uint32_t primitive;
} model_crossing;

// The crossings of the whole line of the ray with all parts by the shapes' own functions, sorted: for placing
// questions, not for answering them. *list grows (realloc). `mapped` parts' t are those of the mapped ray.
size_t solid_model_crossings(const solid_model *model, const sag_ray *ray, model_crossing **list,
                             size_t *capacity);

// The part that a path of instances from the model's scene on and a geometry name, its state in *state;
// NULL: none.
const model_part *solid_model_find(const solid_model *model, const uint32_t *path, uint32_t depth,
                                   uint32_t geometry, uint32_t *state);
// The state of the shape to which the rule of solid.h gives the boundary between two sets of states;
// UINT32_MAX: nothing changes.
uint32_t solid_model_owner(const solid_model *model, const membership *before, const membership *after);

#endif
