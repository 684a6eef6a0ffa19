// SPDX-License-Identifier: MIT
#include "support/shape_solid.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include "support/random_shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const sag_shape_kind kinds[] = {
    SAG_SHAPE_PLANE,       SAG_SHAPE_SPHERE, SAG_SHAPE_ELLIPSOID,    SAG_SHAPE_CYLINDER,
    SAG_SHAPE_CONE,        SAG_SHAPE_BOX,    SAG_SHAPE_ORIENTED_BOX, SAG_SHAPE_POLYHEDRON,
    SAG_SHAPE_HYPERBOLOID, SAG_SHAPE_TORUS,  SAG_SHAPE_CAPSULE,      SAG_SHAPE_MESH,
};

static void add_part(rng *r, shape_solid *k, double size, const shape_solid *smaller) {
    sag_affine map;
    uint32_t id;
    if (smaller != NULL && rng_one_in(r, 4)) {
        random_place(r, size, &map);
        id = sag_add_instance(k->scene, smaller->scene, &map);
        k->shown[id] = smaller;
    } else {
        random_shape shape;
        sag_shape_kind kind = kinds[rng_below(r, sizeof kinds / sizeof *kinds)];
        do random_shape_make(r, kind, size, &shape);
        while (sagi_shape_classes[kind].validate(&shape.as, NULL) != SAG_OK ||
               sagi_shape_flaw(kind, &shape.as) != NULL);
        id = sag_add_shape(k->scene, kind, &shape.as);
        if (random_place(r, size, &map)) sag_geometry_set_transform(k->scene, id, &map);
    }
    k->steps[k->step_count++] = (sag_solid_step){SAG_SOLID_PART, id};
}

// A random tree of `parts` parts.
static void add_tree(rng *r, shape_solid *k, double size, uint32_t parts, const shape_solid *smaller) {
    uint32_t operands = 0;
    while (parts > 0 && (parts > 1 || operands > 0)) {
        uint32_t some = operands == 0 ? 1 + rng_below(r, parts - 1) : 1 + rng_below(r, parts);
        add_tree(r, k, size, some, smaller);
        parts -= some, operands++;
    }
    if (operands == 0)
        add_part(r, k, size, smaller);
    else
        k->steps[k->step_count++] =
            (sag_solid_step){(sag_solid_operation)(SAG_SOLID_UNION + rng_below(r, 4)), operands};
}

void shape_solid_make(rng *r, sag_context *context, shape_solid *k, double size, const shape_solid *smaller) {
    memset(k, 0, sizeof *k);
    k->scene = sag_scene_create(context);
    add_tree(r, k, size, 1 + rng_below(r, SHAPE_SOLID_PARTS), smaller);
    sag_error error = {0};
    assert_int_equal(sag_scene_set_solid(k->scene, &(sag_solid){k->steps, k->step_count}, &error), SAG_OK);
    assert_int_equal(sag_scene_commit(k->scene, &error), SAG_OK);
}
