// SPDX-License-Identifier: MIT
// What stands in a scene's leaves is what the meshes say: every triangle once, its corners on the block's
// grid within SAGI_GRID_ERROR, exactly its vertices where it says so, its box within the child's; at any
// place and scale, for floats and doubles, under mirroring maps, and for triangles tiny beside the scene.
#include "kernel/corners.h"
#include "scene/scene.h"
#include "shapes/mesh.h"
#include "support/context.h"
#include "support/meshes.h"
#include <stdlib.h>
#include <string.h>
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

// Corners by the block alone are the mesh's vertices, bit by bit. They are not there for doubles.
static void check_exact_corners(const sagi_world *w, const sagi_triangle_block *block, uint32_t j) {
    static const sagi_rest_constants constants = SAGI_REST_CONSTANTS;
    const sag_mesh *mesh = w->items[block->head.geometry].shape;
    assert_non_null(mesh->positions_f32);
    sagi_fine_grid grid = {.origin = {w->origin.x, w->origin.y, w->origin.z},
                           .step = ldexp(1, -(block->head.exponent + SAGI_REST_BITS)),
                           .unit = 1 / w->scale};
    for (int k = 0; k < 3; k++) {
        const uint64_t base = block->head.base >> (k * SAGI_GRID_BASE_BITS);
        grid.zero[k] = (double)(base & ((1u << SAGI_GRID_BASE_BITS) - 1)) * 0x1p-20 - 1;
    }
    sagi_d4 corner[3];
    sagi_exact_corners(&constants, block, j, &grid, corner);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t vertex = mesh->triangles[3 * (size_t)block->primitive[j] + (size_t)i];
            const double p = (double)mesh->positions_f32[3 * (size_t)vertex + (size_t)k], q = corner[i][k];
            assert_memory_equal(&p, &q, sizeof p);
        }
}

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

// What a block says of its edges' length is that of the longest.
static void check_edges(sagi_triangle_block *block) {
    int longest = 0;
    for (int j = 0; j < block->head.count; j++)
        for (int i = 1; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                const int edge = *sagi_block_corner(block, i, k, j) - *sagi_block_corner(block, 0, k, j);
                longest = abs(edge) > longest ? abs(edge) : longest;
            }
    assert_int_equal(block->head.edge, longest >> 8);
}

// How many triangles there are in leaves, and how many of them with exact corners.
typedef struct leaf_counts {
    uint64_t triangles, exact;
} leaf_counts;

static leaf_counts counted_leaves(const sag_scene *scene) {
    const sagi_world *w = &sagi_scene_snapshot(scene)->world;
    leaf_counts counts = {0, 0};
    for (uint32_t n = 0; n < w->tree.node_count; n++) {
        const sagi_bvh_node *node = &w->tree.nodes[n];
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            if (!(node->plane[0][i] <= node->plane[3][i]) || !sagi_bvh_is_leaf(node->child[i])) continue;
            const sagi_block *leaf = sagi_leaf(&w->tree, node->child[i]);
            if (leaf->kind != SAGI_BLOCK_TRIANGLES) continue;
            sagi_triangle_block *block = (void *)(uintptr_t)leaf;
            check_edges(block);
            for (uint32_t j = 0; j < SAGI_BVH_WIDTH; j++) {
                if (j < leaf->count) {
                    check_triangle(w, block, j, node, i);
                } else {
                    for (int k = 0; k < 9; k++)
                        assert_int_equal(*sagi_block_corner(block, k / 3, k % 3, (int)j), 0);
                    assert_true(block->rest[j] == 0);
                }
                if (!sagi_has_exact_corners(block, j)) continue;
                check_exact_corners(w, block, j);
                counts.exact++;
            }
            counts.triangles += leaf->count;
        }
    }
    return counts;
}

// Checks all leaves; returns how many triangles there are.
static uint64_t check_leaves(const sag_scene *scene) { return counted_leaves(scene).triangles; }

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

// Rays onto the same triangles, once of floats and once of doubles, hit the same, bit by bit.
static void hit_alike(const sag_scene *a, const sag_scene *b, sag_vec3 middle, rng *r) {
    uint32_t hits = 0;
    for (int i = 0; i < 10000; i++) {
        const sag_vec3 from = sag_madd(middle, 2, rng_direction(r)),
                       to = sag_madd(middle, 0.4, rng_direction(r));
        const sag_ray ray = sag_ray_make(from, sag_sub(to, from));
        sag_hit of_a = {.t = 0}, of_b = {.t = 0};
        const bool found = sag_intersect(a, &ray, &of_a);
        assert_true(found == sag_intersect(b, &ray, &of_b));
        if (found) assert_memory_equal(&of_a, &of_b, sizeof of_a);
        hits += found;
    }
    assert_true(hits > 1500);
}

// A scan, whose vertices are floats, has exact corners where coordinates are not near 0, which with a height
// of 3 is everywhere; in doubles it has none.
static void scans_have_exact_corners(void **state) {
    (void)state;
    rng r = rng_make(11);
    for (int round = 0; round < 2; round++) {
        const sag_vec3 middle = sag_vec3_make(1, -2, round == 0 ? 3 : 0.1);
        test_mesh mesh = test_mesh_torus(200, 150);
        test_mesh_move(&mesh, 0.37, middle, 0.001, &r);
        float *positions = malloc(3 * (size_t)mesh.mesh.vertex_count * sizeof *positions);
        assert_non_null(positions);
        for (size_t i = 0; i < 3 * (size_t)mesh.mesh.vertex_count; i++)
            positions[i] = (float)mesh.positions[i], mesh.positions[i] = (double)positions[i];
        sag_mesh floats = mesh.mesh;
        floats.positions_f32 = positions, floats.positions_f64 = NULL;
        sag_scene *of_floats = scene_of(&floats), *of_doubles = scene_of(&mesh.mesh);
        const leaf_counts narrow = counted_leaves(of_floats), wide = counted_leaves(of_doubles);
        assert_true(narrow.triangles == wide.triangles && wide.exact == 0);
        assert_true(round == 0 ? narrow.exact == narrow.triangles
                               : narrow.exact < narrow.triangles && narrow.exact > narrow.triangles / 2);
        hit_alike(of_floats, of_doubles, middle, &r);
        sag_scene_destroy(of_floats), sag_scene_destroy(of_doubles);
        free(positions);
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

// The same meshes, of floats, of doubles and mirrored, written by every kernel that this machine has: the
// same bytes.
static void every_kernel_writes_the_same_blocks(void **state) {
    (void)state;
    static const char *const names[] = {"portable", "sse42", "avx2", "avx512", "neon"};
    rng r = rng_make(12);
    test_mesh mesh = test_mesh_torus(90, 70);
    test_mesh_move(&mesh, 3.7, sag_vec3_make(2, -1, 0.1), 0.01, &r);
    const size_t count = 3 * (size_t)mesh.mesh.vertex_count;
    float *positions = malloc(count * sizeof *positions);
    assert_non_null(positions);
    for (size_t i = 0; i < count; i++) positions[i] = (float)mesh.positions[i];
    sag_mesh floats = mesh.mesh;
    floats.positions_f32 = positions, floats.positions_f64 = NULL;
    const sag_affine mirror = sag_affine_scale(sag_vec3_make(-1, 1.3, 0.7));
    size_t length = 0;
    void *blocks = NULL;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        sag_context *own = sag_context_create(&(sag_context_options){.isa = names[i]});
        if (own == NULL) continue;
        sag_scene *scene = sag_scene_create(own);
        sag_add_mesh(scene, &floats), sag_add_mesh(scene, &mesh.mesh);
        assert_int_equal(sag_geometry_set_transform(scene, sag_add_mesh(scene, &floats), &mirror), SAG_OK);
        commit(scene);
        const sagi_bvh *tree = &sagi_scene_snapshot(scene)->world.tree;
        const size_t bytes = (size_t)tree->unit_count * SAGI_BVH_UNIT;
        if (i == 0) {
            length = bytes, blocks = malloc(bytes);
            assert_non_null(blocks);
            memcpy(blocks, tree->leaves, bytes);
        }
        assert_true(bytes == length);
        assert_memory_equal(blocks, tree->leaves, bytes);
        sag_scene_destroy(scene);
        sag_context_destroy(own);
    }
    free(blocks);
    free(positions);
    test_mesh_free(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_are_on_the_grid),     cmocka_unit_test(scans_have_exact_corners),
        cmocka_unit_test(small_triangles_stay_within), cmocka_unit_test(bad_triangles_are_left_out),
        cmocka_unit_test(blocks_are_of_one_mesh),      cmocka_unit_test(every_kernel_writes_the_same_blocks),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
