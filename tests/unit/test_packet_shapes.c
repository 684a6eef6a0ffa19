// SPDX-License-Identifier: MIT
// Rays from one eye in nearly one direction share their walk, also where they meet spheres and exact shapes
// (src/kernel/packet*.inl): every answer has the bits of the single call, for every instruction set of this
// machine. Eyes are far and near, inside of shapes and on their surfaces; pixels are fine and coarse; shapes
// touch, coincide and hide each other.
#include "base/cpu.h"
#include "support/batch_check.h"
#include "support/context.h"
#include "support/random_scene.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 64 };

// Tiles of 4 × 4 pixels, four of them.
static void camera(rng *r, sag_vec3 eye, sag_vec3 target, double pixel, sag_ray *rays) {
    sag_vec3 forward = sag_sub(target, eye), right, up;
    if (!(sag_length(forward) > 0)) forward = sag_vec3_make(0.3, 0.2, -1);
    sag_frame(forward, &right, &up);
    const double step = pixel * sag_length(forward);
    const bool unit = rng_one_in(r, 2);
    const double t = rng_uniform(r, 0.5, 1.5) * (unit ? sag_length(forward) : 1);
    const bool begins = rng_one_in(r, 8), ends = !begins && rng_one_in(r, 8);
    const uint32_t mask = rng_one_in(r, 8) ? 1 + rng_below(r, 3) : 0;
    for (int i = 0; i < RAYS; i++) {
        const double x = i % 4 + 4 * (i / 16 % 2) - 3.5, y = i / 4 % 4 + 4 * (i / 32) - 3.5;
        sag_vec3 d = sag_madd(sag_madd(forward, step * x, right), step * y, up);
        rays[i] = sag_ray_make(eye, unit ? sag_normalize(d) : d);
        rays[i].mask = mask;
        if (begins) rays[i].t_min = t;
        if (ends) rays[i].t_max = t;
    }
}

// Looks at the scene of about this size from many places; `places` are points of interest in it.
static void look(const sag_scene *scene, rng *r, const sag_vec3 *places, uint32_t count, double size,
                 size_t rounds) {
    sag_ray rays[RAYS];
    for (size_t round = 0; round < rounds; round++) {
        const sag_vec3 target = rng_one_in(r, 3) ? rng_vec3(r, size) : places[rng_below(r, count)];
        const double away = rng_one_in(r, 6) ? rng_log_uniform(r, 1, 1e7) : rng_uniform(r, 0.5, 6);
        sag_vec3 eye = sag_madd(target, away * size, rng_direction(r));
        if (rng_one_in(r, 6)) eye = places[rng_below(r, count)];
        if (rng_one_in(r, 8)) eye = sag_madd(target, size, sag_vec3_make(0, 0, 1));
        camera(r, eye, target, rng_log_uniform(r, 1e-7, 0.03), rays);
        batch_check(scene, rays, RAYS, &(batch_counts){0});
    }
}

typedef enum scene_kind { LONE_SPHERES, SETS, SURFACES, EVERYTHING, SCENE_KINDS } scene_kind;

static sag_vec3 add_sphere(rng *r, sag_scene *scene, double size) {
    sag_sphere sphere = {.center = rng_vec3(r, size), .radius = rng_log_uniform(r, 1e-3, 0.5) * size};
    const uint32_t id = sag_add_sphere(scene, &sphere);
    if (rng_one_in(r, 6)) sag_geometry_set_mask(scene, id, 1 + rng_below(r, 3));
    if (rng_one_in(r, 4)) { // one that touches it, or is the same
        sag_sphere other = sphere;
        if (rng_one_in(r, 2)) other.center.x += sphere.radius + (other.radius = sphere.radius * 0.25);
        sag_add_sphere(scene, &other);
    }
    return rng_one_in(r, 2) ? sphere.center : sag_madd(sphere.center, sphere.radius, rng_direction(r));
}

// Those that packets have ways of their own for, mostly.
static sag_vec3 add_surface(rng *r, sag_scene *scene, double size) {
    const double s = rng_log_uniform(r, 0.02, 0.6) * size;
    const sag_vec3 at = rng_vec3(r, size);
    uint32_t id = SAG_INVALID_ID;
    switch (rng_below(r, 6)) {
    case 0:
        id = sag_add_torus(scene,
                           &(sag_torus){.major_radius = s, .minor_radius = s * rng_uniform(r, 0.05, 1.3)});
        break;
    case 1:
        id = sag_add_cone(scene, &(sag_cone){.radius = s, .height = 2 * s, .closed = !rng_one_in(r, 4)});
        break;
    case 2:
        id = sag_add_cylinder(
            scene, &(sag_cylinder){.radius = s, .z_min = -s, .z_max = 0.5 * s, .closed = !rng_one_in(r, 4)});
        break;
    case 3:
        id = sag_add_paraboloid(scene,
                                &(sag_paraboloid){.radius = s, .z_max = s, .closed = !rng_one_in(r, 4)});
        break;
    case 4:
        id = sag_add_hyperboloid(scene, &(sag_hyperboloid){.p1 = {0.4 * s, -0.5 * s, -s},
                                                           .p2 = {0.4 * s, 0.5 * s, s},
                                                           .closed = !rng_one_in(r, 4)});
        break;
    default: id = sag_add_ellipsoid(scene, &(sag_ellipsoid){.radii = {s, 0.7 * s, 0.4 * s}}); break;
    }
    assert_int_not_equal(id, SAG_INVALID_ID);
    sag_affine map = sag_affine_translate(at);
    if (!rng_one_in(r, 4))
        map = sag_affine_multiply(
            &map, &(sag_affine){{{0.36, 0.48, -0.8, 0}, {-0.8, 0.6, 0, 0}, {0.48, 0.64, 0.6, 0}}});
    if (rng_one_in(r, 6)) map.m[0][1] += 0.3;
    if (!rng_one_in(r, 8)) sag_geometry_set_transform(scene, id, &map);
    if (rng_one_in(r, 6)) sag_geometry_set_mask(scene, id, 1 + rng_below(r, 3));
    return sag_madd(at, rng_uniform(r, 0, 1) * s, rng_direction(r));
}

static uint32_t fill(rng *r, sag_scene *scene, scene_kind kind, double size, sag_vec3 *places) {
    enum { COUNT = 40 };
    static float centers[3 * COUNT], radii[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        places[i] = rng_vec3(r, size);
        if (kind == LONE_SPHERES || (kind == EVERYTHING && i % 3 == 0))
            places[i] = add_sphere(r, scene, size);
        if (kind == SURFACES || (kind == EVERYTHING && i % 3 == 1)) places[i] = add_surface(r, scene, size);
        if (kind == EVERYTHING && i % 3 == 2)
            random_scene_add(r, scene, (sag_shape_kind)rng_below(r, SAG_SHAPE_MESH), size);
        const double at[3] = {places[i].x, places[i].y, places[i].z};
        for (int k = 0; k < 3; k++) centers[3 * i + (uint32_t)k] = (float)at[k];
        radii[i] = (float)(rng_log_uniform(r, 1e-3, 0.5) * size);
    }
    if (kind == SETS || kind == EVERYTHING) {
        const sag_spheres set = {.centers_f32 = centers, .radii_f32 = radii, .count = COUNT};
        assert_int_not_equal(sag_add_spheres(scene, &set), SAG_INVALID_ID);
    }
    return COUNT;
}

static void test_packets_meet_shapes_as_single_rays_do(void **state) {
    (void)state;
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_context *c = sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i)});
        if (c == NULL) continue;
        rng r = rng_make(11);
        for (size_t round = 0; round < soak(24); round++) {
            const scene_kind kind = (scene_kind)(round % SCENE_KINDS);
            const double size = round % 5 == 4 ? rng_log_uniform(&r, 1e-9, 1e9) : 1;
            sag_vec3 places[64];
            sag_scene *scene = sag_scene_create(c);
            assert_non_null(scene);
            const uint32_t count = fill(&r, scene, kind, size, places);
            assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
            look(scene, &r, places, count, size, i == SAGI_ISA_PORTABLE ? 12 : 60);
            sag_scene_destroy(scene);
        }
        sag_context_destroy(c);
    }
}

// All rays begin within a sphere: the second crossing is the one that counts.
static void test_a_camera_within_a_dome(void **state) {
    (void)state;
    rng r = rng_make(12);
    sag_ray rays[RAYS];
    sag_scene *scene = sag_scene_create(context);
    assert_non_null(scene);
    sag_add_sphere(scene, &(sag_sphere){.radius = 100});
    for (int i = 0; i < 20; i++)
        sag_add_sphere(scene, &(sag_sphere){.center = rng_vec3(&r, 20), .radius = rng_uniform(&r, 0.1, 3)});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (size_t round = 0; round < soak(200); round++) {
        camera(&r, rng_vec3(&r, 50), rng_vec3(&r, 20), 1e-3, rays);
        batch_check(scene, rays, RAYS, &(batch_counts){0});
    }
    sag_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_packets_meet_shapes_as_single_rays_do),
        cmocka_unit_test(test_a_camera_within_a_dome),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
