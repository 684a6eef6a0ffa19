// SPDX-License-Identifier: MIT
// A solid: a cube within a ball, minus a hole along x. What a ray meets is the boundary of what is left.
// cc solid.c $(pkg-config --cflags --libs sagitta)
#include <sagitta/sagitta.h>
#include <stdio.h>

int main(void) {
    sag_context *context = sag_context_create(NULL);

    // The parts are geometries of a scene, the steps say how they make one solid: (cube ∩ ball) − hole.
    sag_scene *bead = sag_scene_create(context);
    uint32_t cube = sag_add_box(bead, &(sag_box){{-1, -1, -1}, {1, 1, 1}});
    uint32_t ball = sag_add_sphere(bead, &(sag_sphere){.radius = 1.25});
    uint32_t hole = sag_add_capsule(bead, &(sag_capsule){{-2, 0, 0}, {2, 0, 0}, 0.5});
    const sag_solid_step steps[] = {
        {SAG_SOLID_PART, cube}, {SAG_SOLID_PART, ball},    {SAG_SOLID_INTERSECTION, 2},
        {SAG_SOLID_PART, hole}, {SAG_SOLID_DIFFERENCE, 2},
    };
    sag_error error = {SAG_OK};
    sag_scene_set_solid(bead, &(sag_solid){steps, 5}, &error);
    if (sag_scene_commit(bead, &error) != SAG_OK) return fprintf(stderr, "%s\n", error.message), 1;

    // It is placed like any scene, as often as wanted.
    sag_scene *scene = sag_scene_create(context);
    for (int i = 0; i < 2; i++) {
        sag_affine where = sag_affine_translate(sag_vec3_make(0, 0, 4 * i));
        sag_add_instance(scene, bead, &where);
    }
    if (sag_scene_commit(scene, &error) != SAG_OK) return fprintf(stderr, "%s\n", error.message), 1;

    // Every boundary along a ray through the middle: faces of the cube, and of the hole, which are flipped.
    sag_ray ray = sag_ray_make(sag_vec3_make(0, 0, -5), sag_vec3_make(0, 0, 1));
    sag_hit hits[16];
    size_t count = sag_intersect_all(scene, &ray, hits, 16);
    const char *const names[] = {[0] = "cube", [1] = "ball", [2] = "hole"};
    for (size_t i = 0; i < count; i++) {
        sag_surface surface;
        sag_surface_at(scene, &ray, &hits[i], &surface);
        printf("bead %u: %s at t = %g, %s%s\n", hits[i].instance_path[0], names[hits[i].geometry], hits[i].t,
               surface.side == SAG_SIDE_FRONT ? "entering" : "leaving", hits[i].flipped ? ", cut" : "");
    }

    // The same as intervals: how much of the ray is within material, for mass, thickness or attenuation.
    sag_span spans[8];
    count = sag_scene_spans(scene, &ray, spans, 8);
    double length = 0;
    for (size_t i = 0; i < count; i++) length += spans[i].leave.t - spans[i].enter.t;
    printf("%zu intervals, %g in all\n", count, length);

    sag_scene_destroy(scene);
    sag_scene_destroy(bead);
    sag_context_destroy(context);
    return 0;
}
