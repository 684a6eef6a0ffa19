// SPDX-License-Identifier: MIT
// A batch answers every ray with the bits of the single call, whatever its neighbours are: rays from one
// point in nearly one direction, which share their walk, rays like them but for a few, and rays that have
// nothing in common; for every instruction set of this machine.
#include "base/cpu.h"
#include "support/context.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 96 };

static void assert_same(const sag_scene *scene, const sag_ray *rays, size_t count) {
    static sag_hit hits[MOST];
    static bool dark[MOST];
    memset(hits, 0xA5, sizeof hits);
    sag_intersect_batch(scene, rays, hits, count);
    sag_occluded_batch(scene, rays, dark, count);
    for (size_t i = 0; i < count; i++) {
        sag_hit hit;
        memset(&hit, 0xA5, sizeof hit);
        if (sag_intersect(scene, &rays[i], &hit)) {
            assert_memory_equal(&hit, &hits[i], sizeof hit);
        } else {
            assert_true(hits[i].t == INFINITY);
            assert_int_equal(hits[i].geometry, SAG_INVALID_ID);
        }
        assert_int_equal(sag_occluded(scene, &rays[i]), dark[i]);
    }
}

// A picture's tile, `side` pixels wide, of a pinhole camera at `eye`, looking at `target`. Some tiles look
// along an axis, so that signs change within, or exactly at the target, so that rays meet vertices.
static void camera(rng *r, sag_vec3 eye, sag_vec3 target, double pixel, size_t side, sag_ray *rays,
                   size_t count) {
    sag_vec3 forward = sag_sub(target, eye), right, up;
    if (!(sag_length(forward) > 0)) forward = sag_vec3_make(0, 0, -1);
    sag_frame(forward, &right, &up);
    double step = pixel * sag_length(forward), shift = rng_one_in(r, 2) ? 0 : 0.5;
    bool unit = rng_one_in(r, 2);
    for (size_t i = 0; i < count; i++) {
        double x = (double)(i % side) - (double)(side / 2) + shift, y = (double)(i / side) - 2 + shift;
        sag_vec3 d = sag_madd(sag_madd(forward, step * x, right), step * y, up);
        rays[i] = sag_ray_make(eye, unit ? sag_normalize(d) : d);
    }
}

// Makes some rays, or all of them, unlike the others.
static void disturb(rng *r, sag_ray *rays, size_t count, double size) {
    const double odd[] = {NAN, INFINITY, -INFINITY, 0, -0.0, 1e-310, 1e300, -1e-200};
    switch (rng_below(r, 12)) {
    case 0:
        for (size_t i = 0; i < count; i++)
            if (rng_one_in(r, 8)) rays[i] = random_scene_ray(r, size);
        break;
    case 1: rays[rng_below(r, (uint32_t)count)].direction.y = odd[rng_below(r, 8)]; break;
    case 2: rays[rng_below(r, (uint32_t)count)].origin.z = odd[rng_below(r, 8)]; break;
    case 3: rays[rng_below(r, (uint32_t)count)].t_min = odd[rng_below(r, 8)]; break;
    case 4: rays[rng_below(r, (uint32_t)count)].t_max = odd[rng_below(r, 8)]; break;
    case 5:
        for (size_t i = 0; i < count; i++) rays[i].mask = 1 + rng_below(r, 3);
        break;
    case 6:
        for (size_t i = 0; i < count; i++) rays[i].mask = 2;
        break;
    case 7: { // all end, or begin, about where they meet something
        double t = sag_length(rays[0].origin) / sag_length(rays[0].direction) * rng_uniform(r, 0.3, 1.2);
        for (size_t i = 0; i < count; i++)
            if (rng_bits(r) % 64 != 0) rays[i].t_max = t;
        break;
    }
    case 8: {
        double t = sag_length(rays[0].origin) / sag_length(rays[0].direction) * rng_uniform(r, 0.3, 1.2);
        for (size_t i = 0; i < count; i++) rays[i].t_min = t;
        break;
    }
    case 9:
        for (size_t i = 0; i < count; i++)
            rays[i].direction = sag_scale(rays[i].direction, rng_one_in(r, 2) ? 1e-200 : 1e-3);
        break;
    default: break;
    }
}

static sag_vec3 vertex_of(rng *r, const sag_mesh *mesh) {
    const double *p = &mesh->positions_f64[3 * (size_t)rng_below(r, mesh->vertex_count)];
    return sag_vec3_make(p[0], p[1], p[2]);
}

// Eyes: far and near, very far, on the mesh itself.
static void compare(const sag_scene *scene, const sag_mesh *mesh, double size, size_t rounds, uint64_t seed) {
    rng r = rng_make(seed);
    static sag_ray rays[MOST];
    for (size_t round = 0; round < rounds; round++) {
        sag_vec3 target = rng_one_in(&r, 2) ? vertex_of(&r, mesh) : rng_vec3(&r, size);
        double away = rng_one_in(&r, 4) ? rng_log_uniform(&r, 1, 1e9) : rng_uniform(&r, 1, 5);
        sag_vec3 eye = sag_madd(target, away * size, rng_direction(&r));
        if (rng_one_in(&r, 6)) eye = sag_vec3_make(target.x, target.y, away * size);
        if (rng_one_in(&r, 8)) eye = vertex_of(&r, mesh);
        size_t count = rng_one_in(&r, 2) ? MOST : 1 + rng_below(&r, 40);
        camera(&r, eye, target, rng_log_uniform(&r, 1e-6, 0.1), rng_one_in(&r, 2) ? 4 : 16, rays, count);
        disturb(&r, rays, count, size);
        assert_same(scene, rays, count);
    }
}

// The scenes, all of a mesh of a thousand triangles about as large as 1.
enum scene_kind {
    ALONE,
    ONE_SIDED,
    CUT,       // a high quality tree, whose blocks may hold a triangle twice
    TWICE,     // the same mesh at the same place: ties
    MIRRORED,  // one-sided, and a second one that only some rays see
    WITH_FLAT, // above a plane without bounds
    WITH_REST, // with spheres in between
    INSTANCED,
    SCENE_KINDS
};

static void add(sag_context *c, sag_scene *scene, enum scene_kind kind, sag_mesh mesh) {
    const sag_affine turned = {{{-1, 0, 0, 0.25}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    if (kind == ONE_SIDED || kind == MIRRORED) mesh.one_sided = true;
    uint32_t id = sag_add_mesh(scene, &mesh);
    if (kind == CUT) sag_scene_set_quality(scene, SAG_QUALITY_HIGH);
    if (kind == TWICE) sag_add_mesh(scene, &mesh);
    if (kind == MIRRORED) {
        sag_geometry_set_transform(scene, id, &turned);
        sag_geometry_set_mask(scene, sag_add_mesh(scene, &mesh), 2);
    }
    if (kind == WITH_FLAT) {
        sag_plane floor = {.point = {0, -0.5, 0}, .normal = {0, 1, 0}};
        sag_add_plane(scene, &floor);
    }
    for (int i = 0; i < 20 && kind == WITH_REST; i++) {
        sag_sphere sphere = {.center = {0.1 * i - 1, 0.3, 1}, .radius = 0.2};
        sag_add_sphere(scene, &sphere);
    }
    if (kind == INSTANCED) {
        sag_scene *child = sag_scene_create(c);
        assert_non_null(child);
        add(c, child, ALONE, mesh);
        sag_affine aside = sag_affine_translate(sag_vec3_make(0.5, 1.5, 0));
        sag_add_instance(scene, child, &aside);
        sag_scene_destroy(child);
    }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
}

static void compare_all(sag_context *c, size_t rounds) {
    rng r = rng_make(7);
    for (int k = 0; k < 3; k++) {
        test_mesh mesh = k == 0 ? test_mesh_sphere(3) : k == 1 ? test_mesh_torus(30, 18) : test_mesh_cube();
        test_mesh_move(&mesh, 1, sag_vec3_make(0, 0, 0), k == 1 ? 0.2 : 0, &r);
        for (int kind = 0; kind < SCENE_KINDS; kind++) {
            sag_scene *scene = sag_scene_create(c);
            assert_non_null(scene);
            add(c, scene, (enum scene_kind)kind, mesh.mesh);
            compare(scene, &mesh.mesh, 1, rounds, (uint64_t)(k * SCENE_KINDS + kind));
            sag_scene_destroy(scene);
        }
        test_mesh_free(&mesh);
    }
}

static void test_batches_have_the_bits_of_single_calls(void **state) {
    (void)state;
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_context *c = sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i)});
        if (c == NULL) continue;
        compare_all(c, soak(i == SAGI_ISA_PORTABLE ? 40 : 120));
        sag_context_destroy(c);
    }
}

// Tiles so wide, seen from so far, that they hold hundreds of triangles: packets are given up, and their rays
// begin at a front (kernel/front.inl), with ranges, masks and lengths of all kinds.
static void compare_coarse(const sag_scene *scene, const sag_mesh *mesh, size_t rounds, uint64_t seed) {
    rng r = rng_make(seed);
    static sag_ray rays[MOST];
    for (size_t round = 0; round < rounds; round++) {
        const sag_vec3 target = vertex_of(&r, mesh);
        const sag_vec3 eye = sag_madd(target, rng_uniform(&r, 4, 20), rng_direction(&r));
        camera(&r, eye, target, rng_uniform(&r, 0.004, 0.012), 4, rays, MOST);
        disturb(&r, rays, MOST, 1);
        assert_same(scene, rays, MOST);
    }
}

static void test_batches_of_large_meshes(void **state) {
    (void)state;
    rng r = rng_make(11);
    test_mesh mesh = test_mesh_torus(240, 160);
    test_mesh_move(&mesh, 1, sag_vec3_make(0, 0, 0), 0.003, &r);
    const enum scene_kind kinds[] = {ALONE, MIRRORED, WITH_FLAT, INSTANCED};
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_context *c = sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i)});
        if (c == NULL) continue;
        for (int kind = 0; kind < 4; kind++) {
            sag_scene *scene = sag_scene_create(c);
            assert_non_null(scene);
            add(c, scene, kinds[kind], mesh.mesh);
            compare_coarse(scene, &mesh.mesh, soak(i == SAGI_ISA_PORTABLE ? 5 : 15), (uint64_t)kind);
            sag_scene_destroy(scene);
        }
        sag_context_destroy(c);
    }
    test_mesh_free(&mesh);
}

// Shapes of all kinds with transforms, masks and instances.
static void test_batches_in_mixed_scenes(void **state) {
    (void)state;
    rng r = rng_make(3);
    static sag_ray rays[MOST];
    for (int s = 0; s < 4; s++) {
        sag_scene *scene =
            s < 2 ? random_scene(&r, context, 60, 1) : random_nested_scene(&r, context, 30, 2, 1);
        assert_non_null(scene);
        for (size_t round = 0; round < soak(60); round++) {
            camera(&r, rng_vec3(&r, 6), rng_vec3(&r, 2), 1e-2, 4, rays, MOST);
            if (rng_one_in(&r, 3))
                for (size_t i = 0; i < MOST; i++) rays[i] = random_scene_ray(&r, 1);
            disturb(&r, rays, MOST, 1);
            assert_same(scene, rays, MOST);
        }
        sag_scene_destroy(scene);
    }
}

static void test_empty_scenes_and_batches(void **state) {
    (void)state;
    rng r = rng_make(5);
    sag_ray rays[40];
    camera(&r, sag_vec3_make(0, 0, 5), sag_vec3_make(0.1, 0.2, 0), 1e-3, 4, rays, 40);
    sag_scene *scene = sag_scene_create(context);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    for (size_t count = 0; count <= 40; count++) assert_same(scene, rays, count);
    sag_scene_destroy(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_batches_have_the_bits_of_single_calls),
        cmocka_unit_test(test_batches_of_large_meshes),
        cmocka_unit_test(test_batches_in_mixed_scenes),
        cmocka_unit_test(test_empty_scenes_and_batches),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
