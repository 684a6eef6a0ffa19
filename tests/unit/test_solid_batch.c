// SPDX-License-Identifier: MIT
// Batches and solids that are a mesh with parts cut out: every ray has the bits of the single call, whether
// it begins outside, inside, on a surface or in a cutter, and whatever else is in the scene; for every
// instruction set of this machine.
#include "base/cpu.h"
#include "shapes/common.h"
#include "support/batch_check.h"
#include "support/meshes.h"
#include <sagitta/sagitta.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 24, RAYS = SIDE * SIDE };

static sag_vec3 anywhere(rng *r, double size) {
    return sag_vec3_make(rng_uniform(r, -size, size), rng_uniform(r, -size, size),
                         rng_uniform(r, -size, size));
}

// A tile of a camera; chords; rays from within; rays along an axis through vertices.
static void make_rays(rng *r, int kind, const sag_scene *scene, sag_vec3 center, double size, sag_ray *rays) {
    const sag_vec3 eye = sag_add(center, sag_scale(sag_normalize(anywhere(r, 1)), 4 * size));
    for (size_t i = 0; i < RAYS; i++) {
        sag_vec3 o = eye, to = anywhere(r, size);
        const double x = (double)(i % SIDE) / SIDE * 2 - 1, y = (double)(i / SIDE) / SIDE * 2 - 1;
        if (kind == 0) {
            sag_vec3 right, up;
            sag_frame(sag_sub(center, eye), &right, &up);
            to = sag_madd(sag_scale(right, x * size), y * size, up);
        } else if (kind == 1) {
            o = sag_add(center, anywhere(r, 3 * size));
        } else if (kind == 2) {
            o = sag_add(center, anywhere(r, 0.6 * size));
        } else {
            o = sag_add(center, sag_vec3_make(x * size, y * size, 3 * size));
            to = sag_vec3_make(x * size, y * size, 0);
        }
        rays[i] = sag_ray_make(o, sag_sub(sag_add(center, to), o));
        if (kind == 1) rays[i].mask = rng_below(r, 4);
        sag_hit hit;
        if (!rng_one_in(r, 3) || !sag_intersect(scene, &rays[i], &hit)) continue;
        const double t[] = {hit.t, sagi_next_up(hit.t), sagi_next_down(hit.t), hit.t * (1 + 0x1p-50)};
        if (rng_one_in(r, 2))
            rays[i].t_max = t[rng_below(r, 4)];
        else
            rays[i].t_min = t[rng_below(r, 4)];
    }
}

// A mesh twice, the second time larger by some last bits: crossings come in pairs that count as none.
static test_mesh twice(test_mesh one) {
    const size_t vertices = one.mesh.vertex_count, triangles = one.mesh.triangle_count;
    one.positions = realloc(one.positions, 6 * vertices * sizeof *one.positions);
    one.triangles = realloc(one.triangles, 6 * triangles * sizeof *one.triangles);
    assert_true(one.positions != NULL && one.triangles != NULL);
    for (size_t i = 0; i < 3 * vertices; i++)
        one.positions[3 * vertices + i] = one.positions[i] * (i % 5 ? 1 + 0x1p-50 : 1 + 0x1p-40);
    for (size_t i = 0; i < 3 * triangles; i++)
        one.triangles[3 * triangles + i] = one.triangles[i] + (uint32_t)vertices;
    one.mesh.positions_f64 = one.positions, one.mesh.triangles = one.triangles;
    one.mesh.vertex_count *= 2, one.mesh.triangle_count *= 2;
    return one;
}

static sag_scene *make_solid(rng *r, sag_context *context, const test_mesh *mesh, uint32_t cutters,
                             int variant) {
    sag_scene *solid = sag_scene_create(context);
    sag_solid_step steps[80] = {{SAG_SOLID_PART, sag_add_mesh(solid, &mesh->mesh)}};
    for (uint32_t i = 0; i < cutters; i++) {
        const double *v = mesh->positions + 3 * (size_t)rng_below(r, (uint32_t)mesh->mesh.vertex_count);
        const sag_vec3 at = {v[0], v[1], v[2]};
        const double radius = rng_uniform(r, 0.02, 0.3);
        const sag_vec3 room = {radius, radius, radius};
        uint32_t id;
        if (variant != 1 || i % 4 == 0)
            id = sag_add_sphere(solid, &(sag_sphere){.center = at, .radius = radius});
        else if (i % 4 == 1)
            id = sag_add_box(solid, &(sag_box){sag_sub(at, room), sag_add(at, room)});
        else if (i % 4 == 2)
            id = sag_add_capsule(solid, &(sag_capsule){sag_sub(at, room), sag_add(at, room), 0.05});
        else
            id = sag_add_plane(
                solid, &(sag_plane){.point = sag_scale(at, 0.9), .normal = sag_normalize(sag_scale(at, -1))});
        steps[i + 1] = (sag_solid_step){SAG_SOLID_PART, id};
    }
    const uint32_t count = cutters + 1;
    steps[count] = (sag_solid_step){SAG_SOLID_DIFFERENCE, count};
    assert_int_equal(sag_scene_set_solid(solid, &(sag_solid){steps, count + 1}, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
    return solid;
}

static sag_affine somehow(rng *r, sag_vec3 to) {
    const sag_affine turn = sag_affine_rotate(rng_uniform(r, 0, 6), sag_normalize(anywhere(r, 1)));
    const sag_affine size = sag_affine_scale(
        sag_vec3_make(rng_uniform(r, 0.5, 1.5), rng_uniform(r, 0.5, 1.5) * (rng_one_in(r, 2) ? -1 : 1), 0.7));
    const sag_affine there = sag_affine_translate(to), turned = sag_affine_multiply(&turn, &size);
    return sag_affine_multiply(&there, &turned);
}

static void check_scene(rng *r, const sag_scene *scene, sag_vec3 center, double size, batch_counts *c) {
    static sag_ray rays[RAYS];
    for (int kind = 0; kind < 4; kind++) {
        make_rays(r, kind, scene, center, size, rays);
        batch_check(scene, rays, RAYS, c);
        for (size_t i = 0; i < RAYS; i++) rays[i].t_min = 0, rays[i].t_max = INFINITY;
        batch_check(scene, rays, RAYS, c);
    }
}

static void check_variant(sag_context *context, int variant, uint32_t cutters) {
    rng r = rng_make(31 + (uint64_t)variant + cutters);
    batch_counts c = {0};
    test_mesh mesh = variant == 3 ? test_mesh_torus(24, 16) : test_mesh_sphere(3);
    if (variant == 2) mesh = twice(mesh);
    sag_scene *solid = make_solid(&r, context, &mesh, cutters, variant), *one = sag_scene_create(context),
              *many = sag_scene_create(context);
    const sag_affine here = sag_affine_identity();
    assert_int_not_equal(sag_add_instance(one, solid, &here), SAG_INVALID_ID);
    assert_int_equal(sag_scene_commit(one, NULL), SAG_OK);
    const sag_vec3 away = {100, -30, 7}, none = {0, 0, 0};
    for (int i = 0; i < 6; i++) {
        const sag_affine to = somehow(&r, sag_add(away, anywhere(&r, 2)));
        const uint32_t id = sag_add_instance(many, i < 5 ? solid : one, &to);
        if (i == 3) assert_int_equal(sag_geometry_set_mask(many, id, 2), SAG_OK);
    }
    const uint32_t other = sag_add_mesh(many, &mesh.mesh);
    const sag_affine to = somehow(&r, away);
    assert_int_equal(sag_geometry_set_transform(many, other, &to), SAG_OK);
    assert_int_equal(sag_scene_commit(many, NULL), SAG_OK);
    check_scene(&r, solid, none, 1.2, &c);
    check_scene(&r, one, none, 1.2, &c);
    check_scene(&r, many, away, 3, &c);
    print_message("variant %d: met %zu, of these cut %zu, missed %zu\n", variant, c.met, c.flipped, c.missed);
    assert_true(c.met > 1000 && c.missed > 1000 && (c.flipped > 100 || variant == 2));
    sag_scene_destroy(many);
    sag_scene_destroy(one);
    sag_scene_destroy(solid);
    test_mesh_free(&mesh);
}

static void batches_answer_as_single_calls(void **state) {
    (void)state;
    for (int i = 0; i < SAGI_ISA_COUNT; i++) {
        sag_context *context =
            sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i), .thread_count = 1});
        if (context == NULL) continue;
        check_variant(context, 0, 12);
        check_variant(context, 1, 15);
        check_variant(context, 2, 7);
        check_variant(context, 3, 64);
        check_variant(context, 3, 65); // one more than are looked at together
        sag_context_destroy(context);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(batches_answer_as_single_calls)};
    return cmocka_run_group_tests_name("solid_batch", tests, NULL, NULL);
}
