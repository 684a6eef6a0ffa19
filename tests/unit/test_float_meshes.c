// SPDX-License-Identifier: MIT
// A mesh of floats answers with the bits of the same mesh given as doubles, though its hits mostly come from
// what its blocks say (kernel/corners.h) and those of the other from the vertices: at scales down to
// the least floats, next to the coordinate planes and on them, flat, with denormal numbers and −0; one-sided,
// twice at one place, cut, within others and beside something huge; after it has moved, and when it was
// saved; for single rays and for batches, whose rays begin below the root; for every instruction set of this
// machine.
#include "base/cpu.h"
#include "support/context.h"
#include "support/meshes.h"
#include "support/saved.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 256, TILE = 16 };

typedef struct pair {
    test_mesh mesh; // of numbers that are floats
    float *floats;
} pair;

static sag_mesh floats_of(const pair *p) {
    sag_mesh mesh = p->mesh.mesh;
    mesh.positions_f32 = p->floats, mesh.positions_f64 = NULL;
    return mesh;
}

static void round_positions(pair *p) {
    const size_t count = 3 * (size_t)p->mesh.mesh.vertex_count;
    for (size_t i = 0; i < count; i++)
        p->floats[i] = (float)p->mesh.positions[i], p->mesh.positions[i] = (double)p->floats[i];
}

// A torus of about this size, perhaps far from 0, with some numbers made odd.
static pair make(rng *r, double scale) {
    pair p = {.mesh = test_mesh_torus(24 + rng_below(r, 40), 12 + rng_below(r, 20))};
    const double away = rng_log_uniform(r, 1e-3, 1e4);
    const sag_vec3 offset =
        rng_one_in(r, 3) ? sag_vec3_make(0, 0, 0) : sag_scale(rng_vec3(r, 1), away * scale);
    test_mesh_move(&p.mesh, scale, offset, rng_one_in(r, 2) ? 0.1 : 0, r);
    const size_t count = 3 * (size_t)p.mesh.mesh.vertex_count;
    p.floats = malloc(count * sizeof *p.floats);
    assert_non_null(p.floats);
    const uint32_t how = rng_below(r, 8);
    for (size_t i = 0; i < count; i++) {
        double *x = &p.mesh.positions[i];
        if (how == 0 && rng_one_in(r, 4)) *x = rng_one_in(r, 2) ? 0.0 : -0.0;
        if (how == 1 && rng_one_in(r, 4)) *x = ldexp((double)rng_below(r, 1000) - 500, -149);
        if (how == 2 && i % 3 == 1) *x = p.mesh.positions[1];
        if (how == 3 && i % 3 == 2) *x *= 1e-12;
        if (how == 4 && i % 3 == 0) *x = -0.0;
        if (how == 5) *x = nearbyint(*x / scale * 8) / 8 * scale;
        if (how == 6 && rng_one_in(r, 50)) *x *= 1e-3;
    }
    round_positions(&p);
    return p;
}

static void give_up(pair *p) {
    free(p->floats);
    test_mesh_free(&p->mesh);
}

static sag_scene *scene_with(sag_context *c, uint32_t kind, sag_mesh mesh, double scale) {
    sag_scene *scene = sag_scene_create(c);
    assert_non_null(scene);
    mesh.one_sided = kind == 1;
    const uint32_t id = sag_add_mesh(scene, &mesh);
    assert_true(id != SAG_INVALID_ID);
    if (kind == 2) sag_scene_set_quality(scene, SAG_QUALITY_HIGH);
    if (kind == 3) sag_add_mesh(scene, &mesh);
    if (kind == 4) sag_geometry_set_mask(scene, sag_add_mesh(scene, &mesh), 2);
    if (kind == 5) sag_geometry_set_update(scene, id, SAG_UPDATE_REFIT);
    if (kind == 6) {
        const sag_sphere huge = {.center = {1e3 * scale, 0, 0}, .radius = 1e2 * scale};
        sag_add_sphere(scene, &huge);
    }
    if (kind == 7) {
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        sag_scene *outer = sag_scene_create(c);
        assert_non_null(outer);
        sag_affine turned = {{{0, -1, 0, scale}, {1, 0, 0, 0}, {0, 0, 0.5, 0}}};
        sag_add_instance(outer, scene, NULL);
        sag_add_instance(outer, scene, &turned);
        sag_scene_destroy(scene);
        scene = outer;
    }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    return scene;
}

static void aim(rng *r, const pair *p, double scale, sag_ray *rays) {
    for (size_t i = 0; i < RAYS; i += TILE) {
        const double *v = &p->mesh.positions[3 * (size_t)rng_below(r, p->mesh.mesh.vertex_count)];
        const sag_vec3 at = {v[0], v[1], v[2]};
        const sag_vec3 eye = sag_madd(at, scale * rng_log_uniform(r, 0.01, 30), rng_direction(r));
        const bool alike = !rng_one_in(r, 4);
        const double wide = scale * rng_log_uniform(r, 1e-4, 1);
        const double length = rng_one_in(r, 2) ? 1 : 1 / scale;
        const uint32_t mask = rng_one_in(r, 4) ? 2 : ~0U;
        for (size_t j = 0; j < TILE; j++) {
            const sag_vec3 from = alike ? eye : sag_madd(at, scale, rng_direction(r));
            const sag_vec3 to = sag_madd(at, rng_one_in(r, 8) ? 0 : wide, rng_vec3(r, 1));
            rays[i + j] = sag_ray_make(from, sag_scale(sag_sub(to, from), length));
            rays[i + j].mask = mask;
        }
    }
}

static size_t assert_alike(const sag_scene *a, const sag_scene *b, const sag_ray *rays) {
    static sag_hit of_a[RAYS], of_b[RAYS];
    static bool dark_a[RAYS], dark_b[RAYS];
    size_t met = 0;
    memset(of_a, 0xA5, sizeof of_a), memset(of_b, 0xA5, sizeof of_b);
    sag_intersect_batch(a, rays, of_a, RAYS), sag_intersect_batch(b, rays, of_b, RAYS);
    sag_occluded_batch(a, rays, dark_a, RAYS), sag_occluded_batch(b, rays, dark_b, RAYS);
    assert_memory_equal(of_a, of_b, sizeof of_a);
    assert_memory_equal(dark_a, dark_b, sizeof dark_a);
    for (size_t i = 0; i < RAYS; i++) {
        sag_hit one, other;
        memset(&one, 0xA5, sizeof one), memset(&other, 0xA5, sizeof other);
        const bool found = sag_intersect(a, &rays[i], &one);
        assert_true(found == sag_intersect(b, &rays[i], &other));
        assert_true(found == sag_occluded(a, &rays[i]) && found == dark_a[i]);
        assert_true(found == (of_a[i].t < INFINITY));
        if (!found) continue;
        assert_memory_equal(&one, &other, sizeof one);
        assert_memory_equal(&one, &of_a[i], sizeof one);
        met++;
    }
    return met;
}

static void check_saved(sag_context *c, const sag_scene *scene, const sag_ray *rays) {
    sag_status status;
    sag_scene *again;
    saved file = saved_from(scene, &status, NULL);
    assert_int_equal(status, SAG_OK);
    assert_int_equal(saved_read(c, file.bytes, file.count, &again, NULL), SAG_OK);
    assert_alike(scene, again, rays);
    sag_scene_destroy(again);
    saved_free(&file);
}

// Moves vertices within the scene's old units, or out of them.
static void check_moved(sag_scene *a, sag_scene *b, pair *p, double scale, rng *r) {
    static sag_ray rays[RAYS];
    const double by = scale * (rng_one_in(r, 3) ? 100 : 0.01);
    const size_t count = 3 * (size_t)p->mesh.mesh.vertex_count;
    for (size_t i = 0; i < count; i++) p->mesh.positions[i] += rng_uniform(r, -by, by);
    round_positions(p);
    const sag_mesh floats = floats_of(p);
    assert_int_equal(sag_geometry_set_shape(a, 0, SAG_SHAPE_MESH, &floats, NULL), SAG_OK);
    assert_int_equal(sag_geometry_set_shape(b, 0, SAG_SHAPE_MESH, &p->mesh.mesh, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(a, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(b, NULL), SAG_OK);
    aim(r, p, scale, rays);
    assert_alike(a, b, rays);
}

static void floats_have_the_bits_of_doubles(void **state) {
    (void)state;
    static sag_ray rays[RAYS];
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_context *c = sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i)});
        if (c == NULL) continue;
        rng r = rng_make(23);
        size_t met = 0;
        const size_t rounds = soak(8);
        for (size_t round = 0; round < rounds; round++) {
            const double scale = rng_one_in(&r, 2) ? 1 : rng_log_uniform(&r, 1e-38, 1e24);
            const uint32_t kind = (uint32_t)(round % 8);
            pair p = make(&r, scale);
            sag_scene *a = scene_with(c, kind, floats_of(&p), scale);
            sag_scene *b = scene_with(c, kind, p.mesh.mesh, scale);
            for (int k = 0; k < 4; k++) {
                aim(&r, &p, scale, rays);
                met += assert_alike(a, b, rays);
            }
            if (kind != 7) check_moved(a, b, &p, scale, &r);
            aim(&r, &p, scale, rays);
            check_saved(c, a, rays);
            sag_scene_destroy(a), sag_scene_destroy(b);
            give_up(&p);
        }
        assert_true(met > rounds * RAYS);
        sag_context_destroy(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(floats_have_the_bits_of_doubles)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
