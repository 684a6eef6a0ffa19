// SPDX-License-Identifier: MIT
// Files that somebody made to do harm: every checksum is right, the numbers are not. Loading may say no, or
// yes; but then no query may leave its memory or go on for ever. (What shows it is a run with the address
// sanitizer, and that the test ends.)
#include "kernel/corners.h"
#include "scene/file.h"
#include "support/context.h"
#include "support/hostile.h"
#include "support/meshes.h"
#include "support/random_scene.h"
#include "support/saved.h"
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static saved make_file(uint64_t seed, uint32_t count) {
    rng r = rng_make(seed);
    sag_scene *scene = random_nested_scene(&r, context, count, 1, 1);
    saved file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene);
    assert_true(file.count > 0);
    return file;
}

static saved some_file(uint64_t seed) { return make_file(seed, seed == 1 ? 12 : 44); }

// Any words of any section, one or some at a time.
static void any_word(void **state) {
    (void)state;
    rng r = rng_make(11);
    hostile_words(&r, context, some_file, 2, (uint32_t)soak(1000));
}

// The numbers that lead somewhere: children of nodes and the leaves' first bytes.
static void any_child(void **state) {
    (void)state;
    rng r = rng_make(12);
    saved file = make_file(3, 88), copy = file;
    copy.bytes = malloc(file.count);
    for (size_t i = 0; i < soak(700); i++) {
        memcpy(copy.bytes, file.bytes, file.count);
        uint32_t scene = rng_below(&r, 2);
        place nodes = hostile_find(&copy, SAGI_FILE_NODES, scene),
              leaves = hostile_find(&copy, SAGI_FILE_LEAVES, scene);
        if (rng_one_in(&r, 2)) {
            sagi_bvh_node *n = (void *)(copy.bytes + nodes.at);
            uint32_t *child =
                &n[rng_below(&r, (uint32_t)(nodes.bytes / sizeof *n))].child[rng_below(&r, SAGI_BVH_WIDTH)];
            uint32_t number = rng_below(&r, 40);
            uint32_t other = rng_one_in(&r, 2) ? sagi_bvh_child_leaf(number) : sagi_bvh_child_node(number);
            *child = rng_one_in(&r, 2) ? hostile_word(&r, *child) : other;
        } else {
            uint32_t *words =
                (void *)(copy.bytes + leaves.at +
                         rng_below(&r, (uint32_t)(leaves.bytes / SAGI_BVH_UNIT)) * SAGI_BVH_UNIT);
            uint32_t at = rng_below(&r, 8);
            words[at] = rng_one_in(&r, 2) ? hostile_word(&r, words[at]) : rng_below(&r, 16);
        }
        hostile_try(&r, context, &copy);
    }
    saved_free(&copy), saved_free(&file);
}

// Vertices and normals of any numbers under a tree that takes them for others.
static void any_position(void **state) {
    (void)state;
    rng r = rng_make(18);
    sag_scene *scene = sag_scene_create(context);
    for (int i = 0; i < 30; i++) random_scene_add(&r, scene, SAG_SHAPE_MESH, 1);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL), copy = file;
    sag_scene_destroy(scene);
    copy.bytes = malloc(file.count);
    for (size_t i = 0; i < soak(300); i++) {
        memcpy(copy.bytes, file.bytes, file.count);
        for (size_t at = sizeof(sagi_file_head); at < file.count;) {
            const sagi_file_section *s = (const void *)(copy.bytes + at);
            uint32_t *words = (void *)(copy.bytes + (at += sizeof *s));
            for (uint32_t k = 0; s->tag == SAGI_FILE_ARRAY && s->part < 2 && k < s->bytes / 4; k++)
                if (rng_one_in(&r, 20)) words[k] = hostile_word(&r, words[k]);
            at += (s->bytes + 63) / 64 * 64;
        }
        assert_true(hostile_try(&r, context, &copy));
    }
    saved_free(&copy), saved_free(&file);
}

static saved mesh_file_in_memory(void) {
    rng r = rng_make(13);
    sag_scene *scene = sag_scene_create(context);
    for (int i = 0; i < 40; i++) random_scene_add(&r, scene, SAG_SHAPE_MESH, 1);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene);
    return file;
}

// A child that is a node, or a leaf, of the file's only scene.
static uint32_t *some_child(saved *file, bool leaf) {
    place nodes = hostile_find(file, SAGI_FILE_NODES, 0);
    sagi_bvh_node *n = (void *)(file->bytes + nodes.at);
    for (size_t k = 0; k < nodes.bytes / sizeof *n; k++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++)
            if (n[k].plane[0][i] <= n[k].plane[3][i] && sagi_bvh_is_leaf(n[k].child[i]) == leaf)
                return &n[k].child[i];
    fail();
    return NULL;
}

static void assert_refused(saved *file) {
    rng r = rng_make(14);
    assert_false(hostile_try(&r, context, file));
    saved_free(file);
}

static void tree_in_circles(void **state) {
    (void)state;
    saved file = mesh_file_in_memory();
    *some_child(&file, true) = 0; // the root
    assert_refused(&file);
    file = mesh_file_in_memory();
    *some_child(&file, true) = *some_child(&file, false); // a node with two parents
    assert_refused(&file);
    file = mesh_file_in_memory();
    *some_child(&file, false) = 0;
    assert_refused(&file);
}

// A chain of more levels than a traversal has room for: each node has one child.
static void tree_too_deep(void **state) {
    (void)state;
    for (uint32_t levels = SAGI_BVH_MAX_DEPTH; levels <= SAGI_BVH_MAX_DEPTH + 1; levels++) {
        rng r = rng_make(15);
        saved file = mesh_file_in_memory();
        place scene = hostile_find(&file, SAGI_FILE_SCENE, 0),
              nodes = hostile_find(&file, SAGI_FILE_NODES, 0);
        sagi_file_scene *d = (void *)(file.bytes + scene.at);
        sagi_bvh_node chain[SAGI_BVH_MAX_DEPTH + 1];
        for (uint32_t n = 0; n < levels; n++)
            for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
                for (int k = 0; k < 3; k++)
                    chain[n].plane[k][i] = i == 0 ? -1 : INFINITY,
                    chain[n].plane[3 + k][i] = i == 0 ? 1 : -INFINITY;
                chain[n].child[i] = i > 0 ? 0 : n + 1 < levels ? sagi_bvh_child_node(n + 1) : SAGI_BVH_LEAF;
            }
        // The file again, with the chain for its nodes.
        size_t bytes = levels * sizeof *chain, rest = nodes.at + (nodes.bytes + 63) / 64 * 64;
        saved made = {.bytes = calloc(1, file.count + bytes + 64)};
        sagi_file_group *g = (void *)(file.bytes + hostile_find(&file, SAGI_FILE_GROUPS, 0).at);
        d->node_count = d->depth = g->node_count = g->depth = levels, d->leaf_count = g->leaf_count = 1;
        memcpy(made.bytes, file.bytes, nodes.at);
        ((sagi_file_section *)(void *)(made.bytes + nodes.at) - 1)->bytes = bytes;
        memcpy(made.bytes + nodes.at, chain, bytes);
        size_t end = nodes.at + (bytes + 63) / 64 * 64;
        memcpy(made.bytes + end, file.bytes + rest, file.count - rest);
        made.count = end + file.count - rest;
        ((sagi_file_head *)(void *)made.bytes)->bytes = made.count;
        assert_int_equal(hostile_try(&r, context, &made), levels == SAGI_BVH_MAX_DEPTH);
        saved_free(&made), saved_free(&file);
    }
}

static void leaf_beyond_the_end(void **state) {
    (void)state;
    saved file = mesh_file_in_memory();
    uint32_t units = (uint32_t)(hostile_find(&file, SAGI_FILE_LEAVES, 0).bytes / SAGI_BVH_UNIT);
    *some_child(&file, true) = SAGI_BVH_LEAF | (units - 1); // begins inside, ends outside, or in the middle
    assert_refused(&file);
    file = mesh_file_in_memory();
    *some_child(&file, true) = SAGI_BVH_LEAF | units;
    assert_refused(&file);
}

static void triangle_that_is_not_there(void **state) {
    (void)state;
    saved file = mesh_file_in_memory();
    sagi_triangle_block *block = (void *)(file.bytes + hostile_find(&file, SAGI_FILE_LEAVES, 0).at);
    block->primitive[0] = 8;
    assert_refused(&file);
    file = mesh_file_in_memory();
    block = (void *)(file.bytes + hostile_find(&file, SAGI_FILE_LEAVES, 0).at);
    block->head.geometry = 40;
    assert_refused(&file);
}

// What stands beyond a block's count is 0.
static void triangle_beyond_the_count(void **state) {
    (void)state;
    for (int what = 0; what < 3; what++) {
        rng r = rng_make(18);
        saved file = mesh_file_in_memory();
        const place nodes = hostile_find(&file, SAGI_FILE_NODES, 0),
                    leaves = hostile_find(&file, SAGI_FILE_LEAVES, 0);
        const sagi_bvh_node *n = (const void *)(file.bytes + nodes.at);
        sagi_triangle_block *block = NULL;
        for (size_t k = 0; k < nodes.bytes / sizeof *n && block == NULL; k++)
            for (int i = 0; i < SAGI_BVH_WIDTH && block == NULL; i++) {
                if (!(n[k].plane[0][i] <= n[k].plane[3][i]) || !sagi_bvh_is_leaf(n[k].child[i])) continue;
                block = (void *)(file.bytes + leaves.at + sagi_bvh_unit(n[k].child[i]) * SAGI_BVH_UNIT);
                if (block->head.kind != SAGI_BLOCK_TRIANGLES || block->head.count == SAGI_BVH_WIDTH)
                    block = NULL;
            }
        assert_non_null(block);
        if (what == 0) block->rest[SAGI_BVH_WIDTH - 1] = SAGI_REST_EXACT;
        if (what == 1) block->primitive[SAGI_BVH_WIDTH - 1] = 1;
        assert_int_equal(hostile_try(&r, context, &file), what == 2); // else nothing is wrong
        saved_free(&file);
    }
}

// Five times a sphere in one block, with them the same set moved.
static sagi_block *sphere_file_in_memory(saved *file) {
    const float centers[15] = {0};
    const sag_spheres set = {.centers_f32 = centers, .radius = 0.4, .count = 5};
    const sag_affine move = sag_affine_translate(sag_vec3_make(100, 0, 0));
    sag_scene *scene = sag_scene_create(context);
    sag_add_spheres(scene, &set);
    sag_geometry_set_transform(scene, sag_add_spheres(scene, &set), &move);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    *file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene);
    place leaves = hostile_find(file, SAGI_FILE_LEAVES, 0);
    for (size_t at = leaves.at; at < leaves.at + leaves.bytes; at += SAGI_BVH_UNIT) {
        sagi_block *block = (void *)(file->bytes + at);
        if (block->kind == SAGI_BLOCK_SPHERES && block->count == 5) return block;
    }
    fail();
    return NULL;
}

static void sphere_that_is_not_there(void **state) {
    (void)state;
    for (int what = 0; what < 8; what++) {
        rng r = rng_make(16);
        saved file;
        sagi_block *block = sphere_file_in_memory(&file);
        uint32_t *primitive = (uint32_t *)(void *)(block + 1) + 2 * SAGI_BVH_WIDTH;
        assert_ptr_equal(primitive, sagi_sphere_primitives(block));
        switch (what) {
        case 0: primitive[4] = 5; break;
        case 1: primitive[7] = 1; break; // beyond count
        case 2: block->geometry = 1; break;
        case 3: block->geometry = 2; break;
        case 4: block->exponent = SAGI_GRID_MAX_EXPONENT + 1; break;
        case 5: block->base |= (uint64_t)1 << 63; break;
        case 6: block->count = 9; break;
        default: break; // nothing is wrong
        }
        assert_int_equal(hostile_try(&r, context, &file), what == 7);
        saved_free(&file);
    }
}

// Five spheres that are geometries of their own in one block, with a box and a moved sphere.
static void lone_sphere_that_is_not_there(void **state) {
    (void)state;
    for (int what = 0; what < 6; what++) {
        rng r = rng_make(17);
        const sag_affine move = sag_affine_translate(sag_vec3_make(100, 0, 0));
        sag_scene *scene = sag_scene_create(context);
        for (int i = 0; i < 5; i++) sag_add_sphere(scene, &(sag_sphere){.radius = 0.4 + 1e-5 * i});
        sag_add_box(scene, &(sag_box){{90, 0, 0}, {91, 1, 1}});
        sag_geometry_set_transform(scene, sag_add_sphere(scene, &(sag_sphere){.radius = 1}), &move);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        saved file = saved_from(scene, NULL, NULL);
        sag_scene_destroy(scene);
        const place leaves = hostile_find(&file, SAGI_FILE_LEAVES, 0);
        sagi_block *block = NULL;
        for (size_t at = leaves.at; at < leaves.at + leaves.bytes && block == NULL; at += SAGI_BVH_UNIT) {
            sagi_block *here = (void *)(file.bytes + at);
            if (here->kind == SAGI_BLOCK_SPHERES && here->count == 5) block = here;
        }
        assert_non_null(block);
        assert_int_equal(block->geometry, SAGI_LONE_SPHERES);
        uint32_t *primitive = (uint32_t *)(void *)(block + 1) + 2 * SAGI_BVH_WIDTH;
        switch (what) {
        case 0: primitive[4] = 5; break; // a box
        case 1: primitive[4] = 6; break; // placed
        case 2: primitive[4] = 7; break;
        case 3: primitive[7] = 1; break; // beyond count
        case 4: block->geometry = 0; break;
        default: break; // nothing is wrong
        }
        assert_int_equal(hostile_try(&r, context, &file), what == 5);
        saved_free(&file);
    }
}

static void index_out_of_range(void **state) {
    (void)state;
    saved file = mesh_file_in_memory();
    for (size_t at = sizeof(sagi_file_head); at < file.count;) {
        sagi_file_section *s = (void *)(file.bytes + at);
        at += sizeof *s;
        if (s->tag == SAGI_FILE_ARRAY && s->part == 3) *(uint32_t *)(void *)(file.bytes + at) = 6;
        at += (s->bytes + 63) / 64 * 64;
    }
    assert_refused(&file);
}

static void shape_that_is_not_valid(void **state) {
    (void)state;
    sag_scene *scene = sag_scene_create(context);
    sag_add_sphere(scene, &(sag_sphere){.radius = 1});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene);
    sagi_file_geometry *g = (void *)(file.bytes + hostile_find(&file, SAGI_FILE_GEOMETRIES, 0).at);
    g->number[3] = -1;
    saved_seal(&file);
    sag_error error = {0};
    assert_int_equal(saved_read(context, file.bytes, file.count, &scene, &error), SAG_ERROR_FORMAT);
    assert_non_null(strstr(error.message, "geometry 0: sphere: radius -1"));
    saved_free(&file);
}

// What a group says of itself must be so: the next commit goes by it.
static void groups_that_lie(void **state) {
    (void)state;
    rng r = rng_make(17);
    test_mesh meshes[3];
    sag_scene *scene = sag_scene_create(context);
    for (int i = 0; i < 3; i++) {
        meshes[i] = test_mesh_sphere(2);
        test_mesh_move(&meshes[i], 1, rng_vec3(&r, 2), 0.01, &r);
        sag_geometry_set_update(scene, sag_add_mesh(scene, &meshes[i].mesh), SAG_UPDATE_REFIT);
        test_mesh_free(&meshes[i]);
    }
    random_scene_add(&r, scene, SAG_SHAPE_SPHERE, 1);
    sag_add_plane(scene, &(sag_plane){.normal = {0, 0, 1}});
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL), copy = file;
    sag_scene_destroy(scene);
    copy.bytes = malloc(file.count);
    place groups = hostile_find(&file, SAGI_FILE_GROUPS, 0);
    uint32_t count = (uint32_t)(groups.bytes / sizeof(sagi_file_group)), refused = 0;
    assert_int_equal(count, 4);
    for (size_t i = 0; i < soak(400); i++) {
        memcpy(copy.bytes, file.bytes, file.count);
        sagi_file_group *g = (void *)(copy.bytes + groups.at);
        uint32_t *word = (uint32_t *)&g[rng_below(&r, count)] + rng_below(&r, 6);
        *word = rng_one_in(&r, 2) ? hostile_word(&r, *word)
                                  : ((uint32_t *)&g[rng_below(&r, count)])[rng_below(&r, 6)];
        if (rng_one_in(&r, 4)) {
            sagi_file_group first = g[0];
            uint32_t other = rng_below(&r, count);
            g[0] = g[other], g[other] = first;
        }
        refused += !hostile_try(&r, context, &copy);
    }
    assert_true(refused > soak(400) / 4);
    saved_free(&copy), saved_free(&file);
}

// An instance may only show what came before it.
static void instances_in_circles(void **state) {
    (void)state;
    saved file = make_file(16, 12);
    place table = hostile_find(&file, SAGI_FILE_GEOMETRIES, 1);
    sagi_file_geometry *g = (void *)(file.bytes + table.at);
    g[table.bytes / sizeof *g - 1].child = 1;
    assert_refused(&file);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_word),
        cmocka_unit_test(any_child),
        cmocka_unit_test(any_position),
        cmocka_unit_test(tree_in_circles),
        cmocka_unit_test(tree_too_deep),
        cmocka_unit_test(leaf_beyond_the_end),
        cmocka_unit_test(sphere_that_is_not_there),
        cmocka_unit_test(lone_sphere_that_is_not_there),
        cmocka_unit_test(triangle_that_is_not_there),
        cmocka_unit_test(triangle_beyond_the_count),
        cmocka_unit_test(index_out_of_range),
        cmocka_unit_test(shape_that_is_not_valid),
        cmocka_unit_test(groups_that_lie),
        cmocka_unit_test(instances_in_circles),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
