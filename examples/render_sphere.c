// SPDX-License-Identifier: MIT
// A picture of a ball on a floor, lit by a lamp: the whole way from shapes to a file.
// cc render_sphere.c $(pkg-config --cflags --libs sagitta-render)
#include <sagitta/render.h>
#include <stdio.h>

int main(int argc, char **argv) {
    if (argc != 2) return fprintf(stderr, "usage: render_sphere OUT.png|OUT.pfm|OUT.exr\n"), 2;
    sag_context *context = sag_context_create(NULL);
    sag_world *world = sag_world_create(context);
    sag_scene *scene = sag_world_scene(world);

    // Shapes, and how they look: the floor keeps the default look, grey.
    sag_add_plane(scene, &(sag_plane){.normal = {0, 1, 0}});
    uint32_t ball = sag_add_sphere(scene, &(sag_sphere){.center = {0, 1, 0}, .radius = 1});
    uint32_t lamp = sag_add_sphere(scene, &(sag_sphere){.center = {-3, 5, 3}, .radius = 1});
    uint32_t red = sag_world_add_material(
        world, &(sag_material){.kind = SAG_MATERIAL_COATED_DIFFUSE, .reflectance.value = {0.8, 0.1, 0.1}});
    sag_world_set_appearance(world, scene, ball, &(sag_appearance){.material = red});
    sag_world_set_appearance(world, scene, lamp, &(sag_appearance){.emission = {20, 18, 15}});

    sag_settings *settings = sag_world_settings(world);
    sag_vec3 eye = {0, 2, 7}, target = {0, 1, 0}, up = {0, 1, 0};
    settings->camera.to_world = sag_camera_look_at(eye, target, up);
    settings->camera.fov_rad = 0.6;
    settings->film.width = 320, settings->film.height = 240;
    settings->samples_per_pixel = 16;
    settings->sampler = SAG_SAMPLER_ZSOBOL;

    sag_error error = {SAG_OK};
    sag_image image = {0};
    sag_render *render = sag_render_create(world, &error);
    bool done = render && sag_render_run(render, NULL, NULL, &error) == SAG_OK &&
                sag_render_get_image(render, &image, &error) == SAG_OK &&
                sag_image_write(context, &image, argv[1], &error) == SAG_OK;
    if (!done) fprintf(stderr, "%s\n", error.message);
    sag_image_clear(context, &image);
    sag_render_destroy(render);
    sag_world_destroy(world);
    sag_context_destroy(context);
    return done ? 0 : 1;
}
