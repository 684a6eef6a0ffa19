// SPDX-License-Identifier: MIT
// The smallest use of libsagitta: what does this ray hit?  cc first_ray.c $(pkg-config --cflags --libs
// sagitta)
#include <sagitta/sagitta.h>
#include <stdio.h>

int main(void) {
    sag_context *context = sag_context_create(NULL); // all cores, the best instruction set, libc's malloc
    sag_scene *scene = sag_scene_create(context);
    sag_add_plane(scene, &(sag_plane){.point = {0, 0, 0}, .normal = {0, 1, 0}});
    sag_add_sphere(scene, &(sag_sphere){.center = {0, 1, 0}, .radius = 1});

    sag_error error;
    if (sag_scene_commit(scene, &error) != SAG_OK) return fprintf(stderr, "%s\n", error.message), 1;

    sag_ray ray = sag_ray_make(sag_vec3_make(0, 1, -5), sag_vec3_make(0, 0, 1)); // t from 0 to infinity
    sag_hit hit;
    if (sag_intersect(scene, &ray, &hit)) printf("geometry %u at t = %g\n", hit.geometry, hit.t);

    sag_scene_destroy(scene);
    sag_context_destroy(context);
    return 0;
}
