// SPDX-License-Identifier: MIT
// What stands in a scene's leaves is what the meshes say: every triangle once, its corners on the block's
// grid within SAGI_GRID_ERROR, its box within the child's; at any place and scale, for floats and doubles,
// under mirroring maps, and for triangles tiny beside the scene.
#include "kernel/block.h"
#include "scene/scene.h"
#include "shapes/mesh.h"
#include "support/context.h"
#include "support/meshes.h"
#include <stdlib.h>
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

static void check_triangle(const sagi_world *w, sagi_triangle_block *block, uint32_t j,
                           const sagi_bvh_node *node, int child) {
    const sagi_item *item = &w->items[block->head.geometry];
    const double steps = ldexp(1, block->head.exponent);
    const double origin[3] = {w->origin.x, w->origin.y, w->origin.z};
    sag_vec3 p[3];
    sagi_mesh_triangle(item->shape, block->primitive[j], p);
    for (int i = 0; i < 3; i++) {
        const sag_vec3 *v = &p[i == 0 ? 0 : item->mirrored ? 3 - i : i];
        const double c[3] = {v->x, v->y, v->z};
        for (int k = 0; k < 3; k++) {
            uint64_t base = block->head.base >> (k * SAGI_GRID_BASE_BITS);
            double zero = (double)(base & ((1u << SAGI_GRID_BASE_BITS) - 1)) * 0x1p-20 - 1;
            double true_at = (c[k] - origin[k]) * w->scale;
            assert_true(fabs((true_at - zero) * steps - *sagi_block_corner(block, i, k, (int)j)) <=
                        SAGI_GRID_ERROR);
            assert_true((double)node->plane[k][child] <= true_at);
            assert_true(true_at <= (double)node->plane[3 + k][child]);
        }
    }
}

// Checks all leaves; returns how many triangles there are.
static uint64_t check_leaves(const sag_scene *scene) {
    const sagi_world *w = &sagi_scene_snapshot(scene)->world;
    uint64_t triangles = 0;
    for (uint32_t n = 0; n < w->tree.node_count; n++) {
        const sagi_bvh_node *node = &w->tree.nodes[n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!(node->plane[0][i] <= node->plane[3][i]) || !sagi_bvh_is_leaf(node->child[i])) continue;
            const sagi_block *leaf = sagi_leaf(&w->tree, node->child[i]);
            if (leaf->kind != SAGI_BLOCK_TRIANGLES) continue;
            sagi_triangle_block *block = (void *)(uintptr_t)leaf;
            for (uint32_t j = 0; j < SAGI_BVH_WIDTH; j++) {
                if (j < leaf->count)
                    check_triangle(w, block, j, node, i);
                else
                    for (int k = 0; k < 9; k++)
                        assert_int_equal(*sagi_block_corner(block, k / 3, k % 3, (int)j), 0);
            }
            triangles += leaf->count;
        }
    }
    return triangles;
}

static sag_scene *commit(sag_scene *scene) {
    sag_error error;
    assert_int_equal(sag_scene_commit(scene, &error), SAG_OK);
    return scene;
}

static void corners_are_on_the_grid(void **state) {
    (void)state;
    rng r = rng_make(8);
    for (int round = 0; round < 40; round++) {
        test_mesh mesh = test_mesh_torus(40, 30);
        double scale = rng_log_uniform(&r, 1e-9, 1e9);
        sag_vec3 offset = sag_scale(rng_vec3(&r, 1), scale * rng_log_uniform(&r, 1e-3, 1e6));
        test_mesh_move(&mesh, scale, offset, round % 2 ? 0.3 : 0, &r);
        sag_scene *scene = scene_of(&mesh.mesh);
        sag_scene_stats stats;
        sag_scene_get_stats(scene, &stats);
        assert_true(check_leaves(scene) == stats.primitive_count);
        sag_scene_destroy(scene);
        test_mesh_free(&mesh);
    }
}

// Floats, and triangles of all sizes down to nothing beside the whole.
static void small_triangles_stay_within(void **state) {
    (void)state;
    enum { COUNT = 600 };
    rng r = rng_make(9);
    float positions[9 * COUNT];
    uint32_t triangles[3 * COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        double size = rng_log_uniform(&r, 1e-20, 1), shift = rng_log_uniform(&r, 1e-20, 1);
        sag_vec3 middle = sag_scale(rng_direction(&r), shift);
        for (uint32_t k = 0; k < 3; k++) {
            sag_vec3 p = sag_madd(middle, size, rng_direction(&r));
            positions[9 * i + 3 * k] = (float)p.x;
            positions[9 * i + 3 * k + 1] = (float)p.y;
            positions[9 * i + 3 * k + 2] = (float)p.z;
            triangles[3 * i + k] = 3 * i + k;
        }
    }
    const sag_mesh mesh = {.positions_f32 = positions,
                           .vertex_count = 3 * COUNT,
                           .triangles = triangles,
                           .triangle_count = COUNT};
    sag_scene *scene = scene_of(&mesh);
    sag_scene_stats stats;
    sag_scene_get_stats(scene, &stats);
    assert_true(check_leaves(scene) == stats.primitive_count);
    assert_true(stats.primitive_count + stats.dropped_degenerate == COUNT);
    sag_scene_destroy(scene);
}

// Bad triangles among good ones are counted and left out, of floats as of doubles.
static void bad_triangles_are_left_out(void **state) {
    (void)state;
    enum { COUNT = 9000 };
    float *positions = malloc(9 * COUNT * sizeof *positions);
    double *doubles = malloc(9 * COUNT * sizeof *doubles);
    uint32_t *triangles = malloc(3 * COUNT * sizeof *triangles);
    assert_true(positions != NULL && doubles != NULL && triangles != NULL);
    rng r = rng_make(10);
    uint64_t not_finite = 0, no_area = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        float *p = positions + 9 * (size_t)i;
        for (int k = 0; k < 9; k++) p[k] = (float)rng_uniform(&r, -1, 1);
        for (uint32_t k = 0; k < 3; k++) triangles[3 * i + k] = 3 * i + k;
        if (i < COUNT / 2) continue; // chunks without bad ones as well
        switch (rng_below(&r, 40)) {
        case 0: p[rng_below(&r, 9)] = NAN, not_finite++; break;
        case 1: p[rng_below(&r, 9)] = -INFINITY, not_finite++; break;
        case 2: p[rng_below(&r, 9)] = 0x1p101f, not_finite++; break;
        case 3:
            for (int k = 0; k < 3; k++) p[3 + k] = p[k];
            no_area++;
            break;
        case 4:
            for (int k = 0; k < 3; k++) p[k] = 1, p[3 + k] = 2, p[6 + k] = 4;
            no_area++;
            break;
        default: break;
        }
    }
    for (int k = 0; k < 9 * COUNT; k++) doubles[k] = (double)positions[k];
    for (int wide = 0; wide < 2; wide++) {
        const sag_mesh mesh = {.positions_f32 = wide ? NULL : positions,
                               .positions_f64 = wide ? doubles : NULL,
                               .vertex_count = 3 * COUNT,
                               .triangles = triangles,
                               .triangle_count = COUNT};
        sag_scene *scene = scene_of(&mesh);
        sag_scene_stats stats;
        sag_scene_get_stats(scene, &stats);
        assert_true(stats.dropped_not_finite == not_finite && stats.dropped_degenerate == no_area);
        assert_true(stats.primitive_count == COUNT - not_finite - no_area);
        assert_true(check_leaves(scene) == stats.primitive_count);
        sag_scene_destroy(scene);
    }
    free(positions);
    free(doubles);
    free(triangles);
}

// A mirrored mesh beside a plain one: blocks are of one of them, and the mirrored one's corners change
// places.
static void blocks_are_of_one_mesh(void **state) {
    (void)state;
    test_mesh mesh = test_mesh_sphere(4);
    sag_scene *scene = sag_scene_create(context);
    sag_affine mirror = sag_affine_scale(sag_vec3_make(-1, 1, 1.5));
    sag_add_mesh(scene, &mesh.mesh);
    assert_int_equal(sag_geometry_set_transform(scene, sag_add_mesh(scene, &mesh.mesh), &mirror), SAG_OK);
    commit(scene);
    assert_true(sagi_scene_snapshot(scene)->items[1].mirrored);
    assert_true(check_leaves(scene) == 2 * (uint64_t)mesh.mesh.triangle_count);
    sag_scene_destroy(scene);
    test_mesh_free(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_are_on_the_grid),
        cmocka_unit_test(small_triangles_stay_within),
        cmocka_unit_test(bad_triangles_are_left_out),
        cmocka_unit_test(blocks_are_of_one_mesh),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
