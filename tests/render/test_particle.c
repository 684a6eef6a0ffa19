// SPDX-License-Identifier: MIT
// Light followed from the lamps makes the picture that paths from the camera make: of every light, camera and
// filter, with shading normals, alpha and rough glass; to the same bits on any number of threads.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/job.h"
#include "support/picture.h"

#include <math.h>
#include <stdlib.h>

#define SIZE  24u
#define BLOCK 8u
#define RUNS  6 // pictures, for the variance of blocks

typedef enum lamp {
    BALL,
    SQUARE,
    TWO_SIDED,
    POINT,
    SPOT,
    STRETCHED,
    DISTANT,
    SKY,
    PICTURE,
    PORTAL,
    PROJECTOR,
    GONIO,
    LAMPS
} lamp;

static sag_image gradient(sag_context *context, uint32_t size) {
    sag_image image;
    sag_error error;
    assert_int_equal(sag_image_create(context, size, size, 3, &image, &error), SAG_OK);
    for (uint32_t i = 0; i < size * size; i++)
        for (uint32_t k = 0; k < 3; k++)
            image.pixels[3 * i + k] = (float)(0.2 + (i % size) * 0.1 + (i / size == 3 ? 4 : 0));
    return image;
}

static void add_lamp(studio *s, lamp which) {
    sag_light light = {.color = {20, 20, 20}, .from = {1, 3, 2}, .to = {0, 0, 0}};
    uint32_t id;
    switch (which) {
    case BALL:
        id = sag_add_sphere(s->scene, &(sag_sphere){.center = {1, 2, 1}, .radius = 0.3});
        sag_world_set_appearance(s->world, s->scene, id, &(sag_appearance){.emission = {9, 9, 9}});
        return;
    case SQUARE:
    case TWO_SIDED:
        id = sag_add_rectangle(s->scene, &(sag_rectangle){{-1, 2.5, -1}, {2, 0, 0}, {0, 0, 1}});
        sag_world_set_appearance(
            s->world, s->scene, id,
            &(sag_appearance){.emission = {3, 3, 3}, .two_sided = which == TWO_SIDED, .flip = false});
        return;
    case POINT: light.kind = SAG_LIGHT_POINT; break;
    case SPOT: light.kind = SAG_LIGHT_SPOT, light.cone_rad = 0.5, light.cone_delta_rad = 0.2; break;
    case STRETCHED:
        light.kind = SAG_LIGHT_SPOT, light.cone_rad = 0.5, light.cone_delta_rad = 0.2;
        light.to_world = (sag_affine){{{1, 0.3, 0, 0}, {0, 2, 0, 0}, {0.5, 0, 1, 0}}};
        break;
    case DISTANT: light.kind = SAG_LIGHT_DISTANT, light.color = (sag_rgb){2, 2, 2}; break;
    case SKY: light.kind = SAG_LIGHT_SKY, light.color = (sag_rgb){1, 1, 1}; break;
    case PICTURE:
        light.kind = SAG_LIGHT_INFINITE, light.color = (sag_rgb){1, 1, 1};
        light.image = gradient(s->context, 8);
        break;
    case PORTAL: { // with a roof over half of it
        sag_add_box(s->scene, &(sag_box){{0, 2.6, -3}, {9, 2.7, 3}});
        const sag_vec3 corners[4] = {{-1, 2.2, -1}, {1, 2.2, -1}, {1, 2.2, 1}, {-1, 2.2, 1}};
        light.kind = SAG_LIGHT_INFINITE, light.color = (sag_rgb){5, 5, 5}, light.has_portal = true;
        for (int i = 0; i < 4; i++) light.portal[i] = corners[i];
        break;
    }
    case PROJECTOR:
        light.kind = SAG_LIGHT_PROJECTION, light.image = gradient(s->context, 8), light.fov_rad = 0.7;
        light.to_world = sag_camera_look_at(light.from, light.to, (sag_vec3){0, 1, 0});
        break;
    case GONIO: light.kind = SAG_LIGHT_GONIOMETRIC, light.image = gradient(s->context, 8); break;
    case LAMPS: break;
    }
    assert_int_not_equal(sag_world_add_light(s->world, &light), 0);
}

// Three walls and a ball, all diffuse.
static studio furnish(lamp which) {
    studio s = studio_open(0);
    s.in_color = true;
    s.settings->film.width = s.settings->film.height = SIZE;
    s.settings->max_depth = 3;
    s.settings->camera.fov_rad = 0.7;
    studio_aim(&s, (sag_vec3){0, 1.5, 6}, (sag_vec3){0, 0.8, 0});
    const uint32_t red = studio_material(&s, (sag_material){.reflectance.value = {0.7, 0.3, 0.2}});
    sag_add_box(s.scene, &(sag_box){{-2, -0.1, -2}, {2, 0, 2}});
    sag_add_box(s.scene, &(sag_box){{-2, 0, -2.1}, {2, 2, -2}});
    const uint32_t ball = sag_add_sphere(s.scene, &(sag_sphere){.center = {-0.4, 0.6, 0}, .radius = 0.6});
    sag_world_set_appearance(s.world, s.scene, ball, &(sag_appearance){.material = red});
    add_lamp(&s, which);
    return s;
}

typedef struct blocks {
    double mean[SIZE / BLOCK * SIZE / BLOCK], variance[SIZE / BLOCK * SIZE / BLOCK];
} blocks;

static blocks measure(studio *s, sag_integrator_kind integrator, uint32_t samples) {
    enum { COUNT = SIZE / BLOCK * SIZE / BLOCK };
    blocks b = {{0}, {0}};
    s->settings->integrator = integrator;
    s->settings->samples_per_pixel = samples;
    for (int run = 0; run < RUNS; run++) {
        s->settings->seed = (uint64_t)run + 1;
        sag_image image = studio_render(s, NULL);
        double sum[COUNT] = {0};
        for (uint32_t y = 0; y < SIZE; y++)
            for (uint32_t x = 0; x < SIZE; x++) {
                const float *p = &image.pixels[3 * (y * SIZE + x)];
                sum[y / BLOCK * (SIZE / BLOCK) + x / BLOCK] +=
                    (double)(p[0] + 1.3F * p[1] + 0.7F * p[2]) / (BLOCK * BLOCK);
            }
        for (int i = 0; i < COUNT; i++) b.mean[i] += sum[i] / RUNS, b.variance[i] += sum[i] * sum[i] / RUNS;
        sag_image_clear(s->context, &image);
    }
    for (int i = 0; i < COUNT; i++)
        b.variance[i] = fmax(b.variance[i] - b.mean[i] * b.mean[i], 0) / (RUNS - 1);
    return b;
}

// Blocks' means differ by no more than chance (Welch's t of 2·6 pictures: |t| > 8 is rarer than 1e-5), and
// the whole picture's by no more than `share`.
static void agree(studio *s, uint32_t samples, double share) {
    const blocks a = measure(s, SAG_INTEGRATOR_PATH, samples),
                 b = measure(s, SAG_INTEGRATOR_LIGHTPATH, 2 * samples);
    double sums[2] = {0, 0};
    for (unsigned i = 0; i < SIZE / BLOCK * SIZE / BLOCK; i++) {
        const double sigma = sqrt(a.variance[i] + b.variance[i]) + 1e-4;
        if (!(fabs(a.mean[i] - b.mean[i]) <= 8 * sigma))
            print_message("camera %d, block %u: %g, %g ± %g\n", (int)s->settings->camera.kind, i, a.mean[i],
                          b.mean[i], sigma);
        assert_true(fabs(a.mean[i] - b.mean[i]) <= 8 * sigma);
        sums[0] += a.mean[i], sums[1] += b.mean[i];
    }
    if (!(fabs(sums[0] - sums[1]) <= share * sums[0])) print_message("%g, %g\n", sums[0], sums[1]);
    assert_true(sums[0] > 0 && fabs(sums[0] - sums[1]) <= share * sums[0]);
}

static void every_light_agrees(void **state) {
    (void)state;
    for (int which = 0; which < LAMPS; which++) {
        studio s = furnish((lamp)which);
        // What is seen behind all things is no particle's.
        if (which == SKY || which == PICTURE || which == PORTAL)
            studio_aim(&s, (sag_vec3){0, 1.2, 3}, (sag_vec3){0, 0.5, 0}), s.settings->camera.fov_rad = 0.5;
        agree(&s, 16, 0.06);
        studio_close(&s);
    }
}

static void every_camera_agrees(void **state) {
    (void)state;
    for (int kind = 0; kind < 6; kind++) {
        studio s = furnish(SQUARE);
        sag_camera *camera = &s.settings->camera;
        s.settings->film.filter = (sag_filter_kind)(kind % 5);
        switch (kind) {
        case 0: camera->lens_radius = 0.1, camera->focal_distance = 5; break;
        case 1: camera->kind = SAG_CAMERA_ORTHOGRAPHIC; break;
        case 2:
            camera->kind = SAG_CAMERA_ORTHOGRAPHIC;
            camera->lens_radius = 0.1, camera->focal_distance = 5;
            break;
        case 3: camera->kind = SAG_CAMERA_ENVIRONMENT; break;
        case 4: camera->kind = SAG_CAMERA_EQUAL_AREA, s.settings->film.filter = SAG_FILTER_BOX; break;
        case 5: { // neither rigid nor of one scale
            const sag_affine bent = {{{-2, 0.3, 0, 0}, {0, 1.5, 0.2, 0}, {0, 0, 1.2, 0}}};
            camera->to_world = sag_affine_multiply(&camera->to_world, &bent);
            camera->lens_radius = 0.05;
            s.settings->film.filter = SAG_FILTER_GAUSSIAN;
            break;
        }
        default: break;
        }
        if (kind == 3 || kind == 4) studio_aim(&s, (sag_vec3){0.6, 0.9, 0.8}, (sag_vec3){0, 0.5, 0});
        agree(&s, 16, 0.06);
        studio_close(&s);
    }
}

// Within a ball that shines inside, particles show every pixel of a picture of all around as bright as the
// ball is, the rim's too, where wide filters reach beyond the film (they were darker); and all of it together
// to less than 1 %: nothing but the lamp's direct way to the camera is there.
static void a_lamp_all_around_is_as_bright_everywhere(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        studio s = studio_open(2);
        s.settings->camera.kind = kind ? SAG_CAMERA_EQUAL_AREA : SAG_CAMERA_ENVIRONMENT;
        studio_aim(&s, (sag_vec3){0, 0, 0}, (sag_vec3){0.3, 0.2, -1});
        s.settings->film.width = s.settings->film.height = 16;
        s.settings->film.filter = SAG_FILTER_BOX;
        s.settings->film.filter_radius_x = s.settings->film.filter_radius_y = 2.5;
        s.settings->integrator = SAG_INTEGRATOR_LIGHTPATH;
        s.settings->samples_per_pixel = 4000;
        s.settings->max_depth = 0;
        const uint32_t ball = sag_add_sphere(s.scene, &(sag_sphere){.radius = 3});
        sag_world_set_appearance(s.world, s.scene, ball,
                                 &(sag_appearance){.emission = {1, 1, 1}, .two_sided = true});
        sag_image image = studio_render(&s, NULL);
        double sum = 0;
        for (int i = 0; i < 16 * 16; i++) {
            const double value = (double)image.pixels[3 * i];
            if (!(fabs(value - 1) < 0.15)) print_message("camera %d, pixel %d: %g\n", kind, i, value);
            assert_true(fabs(value - 1) < 0.15);
            sum += value / (16 * 16);
        }
        // Near the poles of longitudes few particles bring much.
        assert_true(fabs(sum - 1) < 0.008);
        sag_image_clear(s.context, &image);
        studio_close(&s);
    }
}

// A rough pane of glass and a veil with holes in the way, a lacquered ball of few triangles with round
// normals.
static void every_surface_agrees(void **state) {
    (void)state;
    studio s = furnish(BALL);
    const uint32_t glass = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_DIELECTRIC,
                                                              .eta.value = {1.5, 1.5, 1.5},
                                                              .roughness_u.value = {0.5, 0, 0},
                                                              .roughness_v.value = {0.5, 0, 0}});
    const uint32_t pane = sag_add_box(s.scene, &(sag_box){{0.5, 0.1, 1}, {1.5, 1, 1.2}});
    sag_world_set_appearance(s.world, s.scene, pane, &(sag_appearance){.material = glass});
    const sag_texture holes = {
        .kind = SAG_TEXTURE_CHECKERBOARD, .b.value = {1, 1, 1}, .mapping = {.u_scale = 9, .v_scale = 9}};
    const uint32_t veil =
        sag_add_rectangle(s.scene, &(sag_rectangle){{-1.5, 0, 0.8}, {0.8, 0, 0}, {0, 0.8, 0}});
    sag_world_set_appearance(s.world, s.scene, veil,
                             &(sag_appearance){.alpha.texture = sag_world_add_texture(s.world, &holes)});
    static const double corners[] = {0, 1, 0, 0, 0, 1, 1, 0, 0, 0, -1, 0, -1, 0, 0, 0, 0, -1};
    static const float normals[] = {0, 1, 0, 0, 0, 1, 1, 0, 0, 0, -1, 0, -1, 0, 0, 0, 0, -1};
    static const uint32_t faces[] = {0, 1, 2, 0, 2, 5, 0, 5, 4, 0, 4, 1, 3, 2, 1, 3, 5, 2, 3, 4, 5, 3, 1, 4};
    const uint32_t gem = sag_add_mesh(s.scene, &(sag_mesh){.positions_f64 = corners,
                                                           .normals_f32 = normals,
                                                           .triangles = faces,
                                                           .vertex_count = 6,
                                                           .triangle_count = 8});
    const sag_affine place = {{{0.5, 0, 0, 1.2}, {0, 0.5, 0, 0.5}, {0, 0, 0.5, -0.8}}};
    sag_geometry_set_transform(s.scene, gem, &place);
    const uint32_t paint = studio_material(&s, (sag_material){.kind = SAG_MATERIAL_COATED_DIFFUSE,
                                                              .reflectance.value = {0.3, 0.5, 0.6},
                                                              .roughness_u.value = {0.4, 0, 0},
                                                              .roughness_v.value = {0.4, 0, 0}});
    sag_world_set_appearance(s.world, s.scene, gem, &(sag_appearance){.material = paint});
    s.settings->max_depth = 6;
    agree(&s, 48, 0.05);
    studio_close(&s);
}

static void threads_change_no_bit(void **state) {
    (void)state;
    sag_image first = {0};
    static const uint32_t threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        studio s = furnish(BALL);
        studio_close(&s);
        s = studio_open(threads[i]);
        studio_furnish(&s);
        s.settings->integrator = SAG_INTEGRATOR_LIGHTPATH;
        s.settings->film.filter = SAG_FILTER_MITCHELL; // negative in part
        sag_image image = studio_render(&s, NULL);
        if (i == 0)
            first = image;
        else
            assert_true(same_picture(&first, &image));
        if (i > 0) sag_image_clear(s.context, &image);
        if (i == 0) {
            // It outlives its studio.
            float *copy = malloc((size_t)image.width * image.height * 3 * sizeof *copy);
            assert_non_null(copy);
            for (size_t k = 0; k < (size_t)image.width * image.height * 3; k++) copy[k] = image.pixels[k];
            sag_image_clear(s.context, &image);
            first.pixels = copy;
        }
        studio_close(&s);
    }
    free(first.pixels);
}

// A part of the film is the part of the picture, but for noise.
static void a_crop_is_as_bright(void **state) {
    (void)state;
    studio s = furnish(SQUARE);
    s.settings->integrator = SAG_INTEGRATOR_LIGHTPATH;
    s.settings->samples_per_pixel = 64;
    sag_image whole = studio_render(&s, NULL);
    s.settings->film.pixel_bounds[0] = 4, s.settings->film.pixel_bounds[1] = 20;
    s.settings->film.pixel_bounds[2] = 8, s.settings->film.pixel_bounds[3] = 24;
    sag_image part = studio_render(&s, NULL);
    double sums[2] = {0, 0};
    for (uint32_t y = 0; y < 16; y++)
        for (uint32_t x = 0; x < 16; x++) {
            sums[0] += (double)whole.pixels[3 * ((y + 8) * SIZE + x + 4)];
            sums[1] += (double)part.pixels[3 * (y * 16 + x)];
        }
    assert_true(fabs(sums[0] - sums[1]) < 0.05 * sums[0]);
    sag_image_clear(s.context, &whole);
    sag_image_clear(s.context, &part);
    studio_close(&s);
}

// maxcomponentvalue is of what reaches one pixel by one of its samples, not of a path from a lamp, which
// carries a picture's light: there it left the picture black.
static void bright_paths_are_no_fireflies(void **state) {
    (void)state;
    studio s = furnish(SQUARE);
    s.settings->integrator = SAG_INTEGRATOR_LIGHTPATH;
    s.settings->samples_per_pixel = 16;
    double sums[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        s.settings->film.max_component = i ? 50 : 0;
        sag_image image = studio_render(&s, NULL);
        for (uint32_t k = 0; k < SIZE * SIZE * 3; k++) sums[i] += (double)image.pixels[k];
        sag_image_clear(s.context, &image);
    }
    assert_true(sums[0] > 0 && fabs(sums[1] - sums[0]) < 0.01 * sums[0]);
    studio_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_light_agrees),
        cmocka_unit_test(every_camera_agrees),
        cmocka_unit_test(every_surface_agrees),
        cmocka_unit_test(a_lamp_all_around_is_as_bright_everywhere),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(a_crop_is_as_bright),
        cmocka_unit_test(bright_paths_are_no_fireflies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
