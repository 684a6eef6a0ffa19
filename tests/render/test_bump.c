// SPDX-License-Identifier: MIT
// Bump maps against the normals of truly displaced surfaces, normal maps against the directions they hold,
// and surfaces that are there in part.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on
#include "render/bump.h"
#include "support/picture.h"
#include "support/random.h"

static sag_vec3 random_vector(rng *r) {
    const double x = rng_uniform(r, -1, 1), y = rng_uniform(r, -1, 1), z = rng_uniform(r, -1, 1);
    return (sag_vec3){x, y, z};
}

// The displacement 0.3 u + 0.2 v − 0.1 u v, of a plane with any coordinates.
static sag_texture_id saddle(sag_world *world) {
    const sag_texture texture = {.kind = SAG_TEXTURE_BILERP,
                                 .is_number = true,
                                 .b.value = {0.2, 0, 0},
                                 .c.value = {0.3, 0, 0},
                                 .d.value = {0.4, 0, 0}};
    return sag_world_add_texture(world, &texture);
}

static sag_surface plane(rng *r) {
    sag_surface surface = {.position = random_vector(r), .dpdu = random_vector(r), .dpdv = random_vector(r)};
    surface.u = rng_uniform(r, -2, 2), surface.v = rng_uniform(r, -2, 2);
    surface.geometric_normal = sag_normalize(sag_cross(surface.dpdu, surface.dpdv));
    if (rng_one_in(r, 2)) surface.geometric_normal = sag_neg(surface.geometric_normal);
    surface.shading_normal = surface.geometric_normal;
    return surface;
}

static void bumps_are_the_displaced_surface(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_world *world = sag_world_create(context);
    const sag_input displacement = {.texture = saddle(world)};
    rng r = rng_make(1);
    for (int i = 0; i < 3000; i++) {
        const sag_surface surface = plane(&r);
        if (sag_length(sag_cross(surface.dpdu, surface.dpdv)) < 0.05) continue;
        const sag_vec3 n = surface.shading_normal;
        sagi_spot at;
        sagi_spot_at(&at, &surface);
        if (i % 2) at.dudx = 1e-7, at.dvdy = 1e-5; // the step is the footprint's
        const sagi_shading_frame frame = sagi_bumped_frame(world, &displacement, &surface, NULL, &at);
        const sag_vec3 u = sag_madd(surface.dpdu, 0.3 - 0.1 * surface.v, n);
        const sag_vec3 v = sag_madd(surface.dpdv, 0.2 - 0.1 * surface.u, n);
        sag_vec3 truth = sag_normalize(sag_cross(u, v));
        if (sag_dot(truth, n) < 0) truth = sag_neg(truth);
        assert_true(sag_length(sag_sub(frame.normal, truth)) < 1e-6);
        assert_true(fabs(sag_dot(frame.tangent, frame.normal)) < 1e-6);
    }
    // All of it moved alike is as it was.
    const sag_texture constant = {.is_number = true, .a.value = {3, 3, 3}};
    const sag_input level = {.texture = sag_world_add_texture(world, &constant)};
    const sag_surface surface = plane(&r);
    sagi_spot at;
    sagi_spot_at(&at, &surface);
    const sagi_shading_frame frame = sagi_bumped_frame(world, &level, &surface, NULL, &at);
    assert_true(sag_length(sag_sub(frame.normal, surface.shading_normal)) < 1e-12);
    sag_world_destroy(world);
    sag_context_destroy(context);
}

// On what is curved, bumps as high as a third of the radius: the normal of the surface that is moved by
// 0.3 u + 0.2 v − 0.1 u v, by differences of its points. The curvature was left out once.
static void bumps_on_curved_things_are_the_displaced_surface(void **state) {
    (void)state;
    studio s = studio_open(1);
    const sag_cylinder cylinder = {.radius = 0.7, .z_min = -2, .z_max = 2};
    const uint32_t ids[] = {sag_add_sphere(s.scene, &(sag_sphere){.radius = 1.5}),
                            sag_add_cylinder(s.scene, &cylinder),
                            sag_add_torus(s.scene, &(sag_torus){.major_radius = 2, .minor_radius = 0.6})};
    const sag_affine turned = {{{0.8, -0.6, 0, 1}, {0.6, 0.8, 0, 2}, {0, 0, 1, 3}}};
    for (int i = 0; i < 3; i++)
        assert_int_equal(sag_geometry_set_transform(s.scene, ids[i], &turned), SAG_OK);
    const sag_input displacement = {.texture = saddle(s.world)};
    rng r = rng_make(7);
    for (int shape = 0, met = 0; shape < 3; shape++, met = 0) {
        for (int i = 0; i < 3; i++) sag_geometry_set_enabled(s.scene, ids[i], i == shape);
        assert_int_equal(sag_scene_commit(s.scene, NULL), SAG_OK);
        for (int tries = 0; tries < 4000 && met < 300; tries++) {
            const sag_vec3 middle = {1, 2, 3};
            sag_ray ray = sag_ray_make(sag_madd(middle, 4, sag_normalize(random_vector(&r))), middle);
            ray.direction = sag_sub(sag_madd(middle, 1.5, random_vector(&r)), ray.origin);
            sag_hit hit;
            if (!sag_intersect(s.scene, &ray, &hit)) continue;
            sag_surface at, beside;
            sag_surface_at(s.scene, &ray, &hit, &at);
            if (sag_dot(ray.direction, at.geometric_normal) > -0.3 * sag_length(ray.direction)) continue;
            sag_vec3 moved[3];
            bool near_seam = false;
            for (int k = 0; k < 3; k++) {
                sag_ray near = ray;
                const sag_vec3 step = k == 1 ? at.dpdu : at.dpdv;
                if (k) near.origin = sag_madd(near.origin, 1e-5, step);
                assert_true(sag_intersect(s.scene, &near, &hit));
                sag_surface_at(s.scene, &near, &hit, &beside);
                const double height = 0.3 * beside.u + 0.2 * beside.v - 0.1 * beside.u * beside.v;
                moved[k] = sag_madd(beside.position, height, beside.shading_normal);
                near_seam |= fabs(beside.u - at.u) + fabs(beside.v - at.v) > 0.1;
            }
            if (near_seam) continue;
            met++;
            sag_vec3 truth =
                sag_normalize(sag_cross(sag_sub(moved[1], moved[0]), sag_sub(moved[2], moved[0])));
            if (sag_dot(truth, at.geometric_normal) < 0) truth = sag_neg(truth);
            const sagi_origin origin = {s.scene, &ray, &hit, false};
            sag_intersect(s.scene, &ray, &hit);
            sagi_spot spot;
            sagi_spot_at(&spot, &at);
            const sagi_shading_frame frame = sagi_bumped_frame(s.world, &displacement, &at, &origin, &spot);
            assert_true(sag_length(sag_sub(frame.normal, truth)) < 2e-3);
        }
        assert_true(met >= 250);
    }
    studio_close(&s);
}

// Where a mesh of a scene file has normals, pbrt-v4's ∂p/∂v is across the normal and ∂p/∂u, and as long as
// that; where it has none, the coordinates' own. A floor of 4 × 1 with a ramp up v: its slope, seen by light
// from straight above, is the cosine.
static void bumps_on_meshes_are_as_in_pbrt(void **state) {
    (void)state;
    for (int smooth = 0; smooth < 2; smooth++) {
        studio s = studio_open(1);
        const float points[] = {-2, 0, 0, 2, 0, 0, 2, 1, 0, -2, 1, 0}, uv[] = {0, 0, 1, 0, 1, 1, 0, 1};
        const float up[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
        const uint32_t corners[] = {0, 1, 2, 0, 2, 3};
        const sag_mesh mesh = {.positions_f32 = points,
                               .texcoords_f32 = uv,
                               .normals_f32 = smooth ? up : NULL,
                               .triangles = corners,
                               .vertex_count = 4,
                               .triangle_count = 2};
        assert_int_equal(sag_add_mesh(s.scene, &mesh), 0);
        assert_int_equal(sag_scene_commit(s.scene, NULL), SAG_OK);
        const sag_texture ramp = {
            .kind = SAG_TEXTURE_BILERP, .is_number = true, .b.value = {2, 0, 0}, .d.value = {2, 0, 0}};
        const sag_input displacement = {.texture = sag_world_add_texture(s.world, &ramp)};
        const sag_vec3 from = {0.3, 0.4, 1}, down = {0, 0, -1};
        const sag_ray ray = sag_ray_make(from, down);
        sag_hit hit;
        sag_surface at;
        assert_true(sag_intersect(s.scene, &ray, &hit));
        sag_surface_at(s.scene, &ray, &hit, &at);
        sagi_spot spot;
        sagi_spot_at(&spot, &at);
        const sagi_origin origin = {s.scene, &ray, &hit, smooth == 1};
        const sagi_shading_frame frame = sagi_bumped_frame(s.world, &displacement, &at, &origin, &spot);
        assert_true(fabs(frame.normal.z - 1 / sqrt(1 + (smooth ? 0.25 : 4))) < 1e-6);
        studio_close(&s);
    }
}

static sag_picture_id one_direction(sag_world *world, sag_context *context, sag_vec3 direction) {
    sag_image image = {0};
    assert_int_equal(sag_image_create(context, 1, 1, 3, &image, NULL), SAG_OK);
    image.pixels[0] = (float)(direction.x / 2 + 0.5), image.pixels[1] = (float)(direction.y / 2 + 0.5);
    image.pixels[2] = (float)(direction.z / 2 + 0.5);
    const sag_picture_id id = sag_world_add_picture(world, &image);
    assert_int_not_equal(id, 0);
    return id;
}

static void normals_are_the_pictures(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_world *world = sag_world_create(context);
    rng r = rng_make(2);
    for (int i = 0; i < 500; i++) {
        sag_vec3 direction = random_vector(&r);
        direction.z = fabs(direction.z) + 0.1;
        direction = sag_normalize(direction);
        const sagi_mipmap *normals = sagi_world_picture(world, one_direction(world, context, direction));
        sag_surface surface = plane(&r);
        // Normals between vertices lean away from the triangle's.
        surface.shading_normal = sag_normalize(sag_madd(surface.geometric_normal, 0.3, random_vector(&r)));
        const sag_vec3 n = surface.shading_normal;
        sagi_spot at;
        sagi_spot_at(&at, &surface);
        const sagi_shading_frame frame = sagi_mapped_frame(normals, &surface, &at);
        const sag_vec3 s = sag_normalize(sag_madd(surface.dpdu, -sag_dot(surface.dpdu, n), n)),
                       t = sag_cross(n, s);
        assert_true(fabs(sag_length(frame.normal) - 1) < 1e-12);
        const double side = sag_dot(frame.normal, surface.geometric_normal) < 1e-3 ? 0 : 1;
        if (side == 0 ||
            sag_dot(sag_madd(sag_madd(sag_scale(s, direction.x), direction.y, t), direction.z, n),
                    surface.geometric_normal) < 0)
            continue; // turned over
        assert_true(fabs(sag_dot(frame.normal, s) - direction.x) < 1e-6);
        assert_true(fabs(sag_dot(frame.normal, t) - direction.y) < 1e-6);
        assert_true(fabs(sag_dot(frame.normal, n) - direction.z) < 1e-6);
    }
    sag_world_destroy(world);
    sag_context_destroy(context);
}

static void nonsense_leaves_the_surface_as_it_is(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sag_world *world = sag_world_create(context);
    sag_texture texture = {.kind = SAG_TEXTURE_BILERP, .is_number = true, .c.value = {INFINITY, 0, 0}};
    const sag_input displacement = {.texture = sag_world_add_texture(world, &texture)};
    rng r = rng_make(3);
    const sag_surface surface = plane(&r);
    sagi_spot at;
    sagi_spot_at(&at, &surface);
    sagi_shading_frame frame = sagi_bumped_frame(world, &displacement, &surface, NULL, &at);
    assert_true(sag_length(sag_sub(frame.normal, surface.shading_normal)) == 0);
    const sag_vec3 nothing = {0, 0, 0};
    frame =
        sagi_mapped_frame(sagi_world_picture(world, one_direction(world, context, nothing)), &surface, &at);
    assert_true(sag_length(sag_sub(frame.normal, surface.shading_normal)) == 0);
    sag_world_destroy(world);
    sag_context_destroy(context);
}

// A floor lit from above at a point, seen at a point, its normal turned by 30° toward the light: the cosine
// grows.
static void bumps_change_the_light(void **state) {
    (void)state;
    const double tilt = 0.5235987755982988;
    double seen[2];
    for (int bumped = 0; bumped < 2; bumped++) {
        studio s = studio_open(1);
        s.settings->integrator = SAG_INTEGRATOR_DIRECT;
        const sag_vec3 eye = {2, 3, 6}, target = {0, 0, 0};
        studio_aim_point(&s, eye, target);
        sag_world_add_light(s.world,
                            &(sag_light){.kind = SAG_LIGHT_POINT, .color = {7, 7, 7}, .from = {3, 4, 0}});
        const sag_vec3 turned = {sin(tilt), 0, cos(tilt)};
        sag_material material = {.reflectance.value = {0.5, 0.5, 0.5}};
        if (bumped) material.normal_map = one_direction(s.world, s.context, turned);
        const sag_plane floor_plane = {.normal = {0, 1, 0}, .s = {1, 0, 0}, .t = {0, 0, -1}};
        const uint32_t geometry = sag_add_plane(s.scene, &floor_plane);
        sag_world_set_appearance(s.world, s.scene, geometry,
                                 &(sag_appearance){.material = studio_material(&s, material)});
        seen[bumped] = studio_measure(&s).mean;
        studio_close(&s);
    }
    // The light stands at 4/5 over the floor; u goes along x, to which the normal leans.
    assert_true(fabs(seen[1] / seen[0] - (0.8 * cos(tilt) + 0.6 * sin(tilt)) / 0.8) < 1e-3);
}

// A disk of constant alpha between the camera and a white sky, or between a lamp and the floor.
static sag_appearance partly_there(studio *s, double alpha) {
    const sag_texture texture = {.is_number = true, .a.value = {alpha, 0, 0}};
    const sag_appearance look = {.material = studio_material(s, (sag_material){.kind = SAG_MATERIAL_DIFFUSE}),
                                 .alpha.texture = sag_world_add_texture(s->world, &texture)};
    return look;
}

static void alpha_is_the_share_that_is_there(void **state) {
    (void)state;
    const double alphas[] = {-1, 0, 0.25, 0.7, 1, 2};
    for (int i = 0; i < 6; i++) {
        const double gone = 1 - fmin(fmax(alphas[i], 0), 1);
        studio s = studio_open(2);
        s.settings->samples_per_pixel = 64;
        sag_world_add_light(s.world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
        uint32_t disk = sag_add_disk(s.scene, &(sag_disk){.normal = {0, 0, 1}, .radius = 50});
        sag_appearance look = partly_there(&s, alphas[i]);
        sag_world_set_appearance(s.world, s.scene, disk, &look);
        // A second one behind it: rays that pass go on by chance of their own.
        disk = sag_add_disk(s.scene, &(sag_disk){.center = {0, 0, -1}, .normal = {0, 0, 1}, .radius = 50});
        sag_world_set_appearance(s.world, s.scene, disk, &look);
        const studio_mean m = studio_measure(&s);
        assert_true(fabs(m.mean - gone * gone) <= 5 * m.deviation + 1e-3);
        if (gone == 0 || gone == 1) assert_true(m.most - m.least < 1e-2);
        studio_close(&s);
    }
}

static void shadows_are_as_thick_as_alpha(void **state) {
    (void)state;
    double seen[2];
    for (int shaded = 0; shaded < 2; shaded++) {
        studio s = studio_open(1);
        s.settings->integrator = SAG_INTEGRATOR_DIRECT;
        sag_add_plane(s.scene, &(sag_plane){.normal = {0, 0, 1}});
        sag_world_add_light(
            s.world, &(sag_light){.kind = SAG_LIGHT_POINT, .color = {700, 700, 700}, .from = {30, 0, 30}});
        const uint32_t disk =
            sag_add_disk(s.scene, &(sag_disk){.center = {15, 0, 15}, .normal = {1, 0, 1}, .radius = 9});
        const sag_appearance look = partly_there(&s, shaded ? 0.3 : 0);
        sag_world_set_appearance(s.world, s.scene, disk, &look);
        seen[shaded] = studio_measure(&s).mean;
        studio_close(&s);
    }
    assert_true(fabs(seen[1] / seen[0] - 0.7) < 0.02);
}

// A triangle without texture coordinates of its own.
static void corners_of_meshes_are_as_in_pbrt(void **state) {
    (void)state;
    static const double corners[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0};
    static const uint32_t indices[] = {0, 1, 2};
    const sag_mesh mesh = {
        .positions_f64 = corners, .triangles = indices, .vertex_count = 3, .triangle_count = 1};
    for (int square = 0; square < 2; square++) {
        studio s = studio_open(1);
        s.settings->integrator = SAG_INTEGRATOR_UV;
        const sag_vec3 eye = {0.5, 0, 8}, target = {0.5, 0, 0};
        studio_aim_point(&s, eye, target);
        const uint32_t triangle = sag_add_mesh(s.scene, &mesh);
        sag_world_set_appearance(s.world, s.scene, triangle, &(sag_appearance){.square_uv = square});
        // (x + 1)/2 = u and (y + 1)/2 = v of the square; β = u − v.
        assert_true(fabs(studio_measure(&s).mean - (square ? 0.75 : 0.25)) < 1e-6);
        studio_close(&s);
    }
}

static void threads_see_the_same_holes(void **state) {
    (void)state;
    sag_image pictures[2];
    studio studios[2];
    for (int i = 0; i < 2; i++) {
        studios[i] = studio_open(i ? 2 : 1);
        studio *s = &studios[i];
        sag_world_add_light(s->world, &(sag_light){.kind = SAG_LIGHT_INFINITE, .color = {1, 1, 1}});
        const uint32_t disk = sag_add_disk(s->scene, &(sag_disk){.normal = {0, 0, 1}, .radius = 50});
        const sag_appearance look = partly_there(s, 0.5);
        sag_world_set_appearance(s->world, s->scene, disk, &look);
        pictures[i] = studio_render(s, NULL);
    }
    assert_true(same_picture(&pictures[0], &pictures[1]));
    for (int i = 0; i < 2; i++) {
        sag_image_clear(studios[i].context, &pictures[i]);
        studio_close(&studios[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bumps_are_the_displaced_surface),
        cmocka_unit_test(bumps_on_curved_things_are_the_displaced_surface),
        cmocka_unit_test(bumps_on_meshes_are_as_in_pbrt),
        cmocka_unit_test(normals_are_the_pictures),
        cmocka_unit_test(nonsense_leaves_the_surface_as_it_is),
        cmocka_unit_test(bumps_change_the_light),
        cmocka_unit_test(alpha_is_the_share_that_is_there),
        cmocka_unit_test(shadows_are_as_thick_as_alpha),
        cmocka_unit_test(corners_of_meshes_are_as_in_pbrt),
        cmocka_unit_test(threads_see_the_same_holes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
