// SPDX-License-Identifier: MIT
#include "support/random_solid.h"
#include "shapes/closed.h"
#include "shapes/shape.h"

uint32_t random_solid_steps(rng *r, uint32_t parts, sag_solid_step steps[RANDOM_SOLID_STEPS]) {
    uint32_t count = 0, height = 0, next = 0;
    while (next < parts || height > 1) {
        bool enough =
            height >= 2 && (next == parts || count - next > RANDOM_SOLID_STEPS / 4 || rng_one_in(r, 3));
        if (next < parts && !enough) {
            steps[count++] = (sag_solid_step){SAG_SOLID_PART, next++};
            height++;
            continue;
        }
        sag_solid_operation operation = (sag_solid_operation)(SAG_SOLID_UNION + rng_below(r, 4));
        uint32_t most = height < 5 ? height : 5, operands = 2 + (most > 2 ? rng_below(r, most - 1) : 0);
        if (count + 2 > RANDOM_SOLID_STEPS - 2 * (parts - next)) operands = height;
        if (operands > height) operands = height;
        steps[count++] = (sag_solid_step){operation, operands};
        height -= operands - 1;
    }
    return count;
}

static uint32_t add_part(rng *r, sag_scene *scene, double size) {
    random_shape shape;
    for (;;) {
        sag_shape_kind kind = (sag_shape_kind)rng_below(r, SAG_SHAPE_USER);
        random_shape_make(r, kind, size, &shape);
        if (sagi_shape_classes[kind].validate(&shape.as, NULL) != SAG_OK) continue;
        if (kind != SAG_SHAPE_MESH && sagi_shape_flaw(kind, &shape.as) != NULL) continue;
        return sag_add_shape(scene, kind, &shape.as);
    }
}

sag_scene *random_solid(rng *r, sag_context *context, uint32_t parts, int levels, double size,
                        sag_solid_step *steps, sag_solid *tree) {
    sag_solid_step own[RANDOM_SOLID_STEPS];
    if (steps == NULL) steps = own;
    sag_scene *scene = sag_scene_create(context);
    for (uint32_t i = 0; i < parts; i++) {
        sag_affine map;
        bool moved = random_place(r, size, &map);
        if (levels > 0 && rng_one_in(r, 4)) {
            sag_scene *below = random_solid(r, context, 1 + parts / 2, levels - 1, size, NULL, NULL);
            if (below != NULL) sag_add_instance(scene, below, moved ? &map : NULL);
            sag_scene_destroy(below);
            continue;
        }
        uint32_t id = add_part(r, scene, size);
        if (moved) sag_geometry_set_transform(scene, id, &map);
    }
    sag_solid all = {steps, random_solid_steps(r, parts, steps)};
    sag_error error;
    if (sag_scene_set_solid(scene, &all, &error) != SAG_OK || sag_scene_commit(scene, &error) != SAG_OK) {
        sag_scene_destroy(scene);
        return NULL;
    }
    if (tree != NULL) *tree = all;
    return scene;
}
