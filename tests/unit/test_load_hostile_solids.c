// SPDX-License-Identifier: MIT
// Files of solids that somebody made to do harm (test_load_hostile.c): trees that are none, parts that are
// not there, twice there or not closed, boxes and meshes' own trees that lead elsewhere.
#include "kernel/block.h"
#include "support/context.h"
#include "support/hostile.h"
#include "support/meshes.h"
#include "support/random_shape.h"
#include "support/shape_solid.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

// Two solids, the one a part of the other, and a scene that shows both.
static saved random_file(uint64_t seed) {
    rng r = rng_make(seed);
    shape_solid small, large;
    sag_affine map;
    shape_solid_make(&r, context, &small, 1, NULL);
    shape_solid_make(&r, context, &large, 1, &small);
    sag_scene *scene = sag_scene_create(context);
    for (int i = 0; i < 4; i++) {
        random_place(&r, 1, &map);
        sag_add_instance(scene, i % 2 ? small.scene : large.scene, &map);
    }
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene), sag_scene_destroy(small.scene), sag_scene_destroy(large.scene);
    assert_true(file.count > 0);
    return file;
}

static void any_word(void **state) {
    (void)state;
    rng r = rng_make(51);
    hostile_words(&r, context, random_file, 10, (uint32_t)soak(1500));
}

#define SPHERES 20u

// Ids 0 … 19: spheres, 20: a closed cylinder, 21: a mesh; less those from 10 on.
static saved plain_file(void) {
    test_mesh mesh = test_mesh_sphere(2);
    sag_scene *scene = sag_scene_create(context);
    sag_solid_step steps[SPHERES + 4];
    uint32_t n = 0;
    for (uint32_t i = 0; i < SPHERES; i++)
        sag_add_sphere(scene, &(sag_sphere){.center = {0.3 * i, 0.1 * (i % 3), 0}, .radius = 0.3});
    sag_add_cylinder(scene, &(sag_cylinder){.radius = 0.1, .z_min = -1, .z_max = 1, .closed = true});
    sag_add_mesh(scene, &mesh.mesh);
    for (uint32_t i = 0; i < 10; i++) steps[n++] = (sag_solid_step){SAG_SOLID_PART, i};
    steps[n++] = (sag_solid_step){SAG_SOLID_UNION, 10};
    for (uint32_t i = 10; i < SPHERES + 2; i++) steps[n++] = (sag_solid_step){SAG_SOLID_PART, i};
    steps[n++] = (sag_solid_step){SAG_SOLID_DIFFERENCE, SPHERES + 2 - 10 + 1};
    assert_int_equal(sag_scene_set_solid(scene, &(sag_solid){steps, n}, NULL), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    saved file = saved_from(scene, NULL, NULL);
    sag_scene_destroy(scene);
    test_mesh_free(&mesh);
    return file;
}

typedef void (*change)(saved *file);

static sagi_file_step *steps_of(const saved *file) {
    return (void *)(file->bytes + hostile_find(file, SAGI_FILE_SOLID, 0).at);
}
static sagi_file_geometry *geometries_of(const saved *file) {
    return (void *)(file->bytes + hostile_find(file, SAGI_FILE_GEOMETRIES, 0).at);
}
// A part's reference in the solid's tree, which is the last of the file.
static sagi_bvh_reference *reference_of(const saved *file, uint32_t number) {
    place last = {0, 0};
    for (size_t at = sizeof(sagi_file_head); at < file->count;) {
        const sagi_file_section *s = (const void *)(file->bytes + at);
        at += sizeof *s;
        if (s->tag == SAGI_FILE_LEAVES) last = (place){at, s->bytes};
        at += (s->bytes + 63) / 64 * 64;
    }
    for (size_t at = last.at; at < last.at + last.bytes;) {
        sagi_reference_block *block = (void *)(file->bytes + at);
        if (number < block->head.count) return &block->reference[number];
        number -= block->head.count;
        at += (sagi_block_bytes(SAGI_BLOCK_REFERENCES, block->head.count) + SAGI_BVH_UNIT - 1) /
              SAGI_BVH_UNIT * SAGI_BVH_UNIT;
    }
    fail();
    return NULL;
}

static void nothing(saved *file) { (void)file; }
static void no_operation(saved *file) { steps_of(file)[10].operation = SAG_SOLID_XOR + 1; }
static void large_operation(saved *file) { steps_of(file)[10].operation = 0x80000001u; }
static void too_many_operands(saved *file) { steps_of(file)[10].number = 11; }
static void too_few_operands(saved *file) { steps_of(file)[10].number = 9; }
static void no_operands(saved *file) { steps_of(file)[10].number = 0; }
static void part_of_no_number(saved *file) { steps_of(file)[3].number = SPHERES + 2; }
static void part_twice(saved *file) { steps_of(file)[3].number = 4; }
static void part_in_place_of_operation(saved *file) { steps_of(file)[10].operation = SAG_SOLID_PART; }
static void open_part(saved *file) { geometries_of(file)[SPHERES].flag = 0; }
static void clipped_part(saved *file) { geometries_of(file)[2].number[5] = 0.1; }
static void lost_part(saved *file) { memset(&geometries_of(file)[2], 0, sizeof(sagi_file_geometry)); }
static void reference_twice(saved *file) { *reference_of(file, 3) = *reference_of(file, 4); }
static void reference_to_nothing(saved *file) { reference_of(file, 3)->geometry = SPHERES + 2; }
static void reference_beyond_one(saved *file) { reference_of(file, 3)->primitive = 1; }
static void other_block(saved *file) {
    sagi_reference_block *block = (void *)((unsigned char *)reference_of(file, 0) - sizeof(sagi_block));
    assert_int_equal(block->head.kind, SAGI_BLOCK_REFERENCES);
    block->head.kind = SAGI_BLOCK_TRIANGLES, block->head.geometry = SPHERES + 1;
}
// Of the mesh, whose own scene comes before the solid's tree.
static void mesh_in_circles(saved *file) {
    place nodes = hostile_find(file, SAGI_FILE_NODES, 0);
    sagi_bvh_node *n = (void *)(file->bytes + nodes.at);
    assert_true(nodes.bytes > sizeof *n);
    n[1].child[0] = 0;
}
static void mesh_of_two(saved *file) {
    place groups = hostile_find(file, SAGI_FILE_GROUPS, 0);
    sagi_file_section *head = (sagi_file_section *)(void *)(file->bytes + groups.at - sizeof *head);
    assert_int_equal(head->geometry, SPHERES + 1);
    head->geometry = SPHERES;
}

static void told_apart(void **state) {
    (void)state;
    static const change changes[] = {
        no_operation,         large_operation, too_many_operands, too_few_operands,           no_operands,
        part_of_no_number,    part_twice,      open_part,         part_in_place_of_operation, clipped_part,
        reference_to_nothing, reference_twice, other_block,       reference_beyond_one,       mesh_in_circles,
        mesh_of_two,          lost_part};
    rng r = rng_make(52);
    saved file = plain_file(), copy = file;
    copy.bytes = malloc(file.count);
    for (size_t i = 0; i <= sizeof changes / sizeof *changes; i++) {
        memcpy(copy.bytes, file.bytes, file.count);
        (i == 0 ? nothing : changes[i - 1])(&copy);
        assert_int_equal(hostile_try(&r, context, &copy), i == 0);
    }
    saved_free(&copy), saved_free(&file);
}

// An instance that shows a scene which is no solid.
static void part_that_shows_a_scene(void **state) {
    (void)state;
    rng r = rng_make(53);
    sag_scene *ball = sag_scene_create(context), *solid = sag_scene_create(context);
    const sag_solid_step step = {SAG_SOLID_PART, 0};
    sag_add_sphere(ball, &(sag_sphere){.radius = 1});
    sag_scene_set_solid(ball, &(sag_solid){&step, 1}, NULL);
    assert_int_equal(sag_scene_commit(ball, NULL), SAG_OK);
    sag_add_instance(solid, ball, NULL);
    sag_scene_set_solid(solid, &(sag_solid){&step, 1}, NULL);
    assert_int_equal(sag_scene_commit(solid, NULL), SAG_OK);
    saved file = saved_from(solid, NULL, NULL);
    assert_true(hostile_try(&r, context, &file));
    // Without its steps the first is an ordinary scene.
    place scene = hostile_find(&file, SAGI_FILE_SCENE, 0), steps = hostile_find(&file, SAGI_FILE_SOLID, 0);
    ((sagi_file_scene *)(void *)(file.bytes + scene.at))->step_count = 0;
    size_t from = steps.at - sizeof(sagi_file_section), end = steps.at + (steps.bytes + 63) / 64 * 64;
    memmove(file.bytes + from, file.bytes + end, file.count - end);
    file.count -= end - from;
    ((sagi_file_head *)(void *)file.bytes)->bytes = file.count;
    assert_false(hostile_try(&r, context, &file));
    saved_free(&file);
    sag_scene_destroy(ball), sag_scene_destroy(solid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_word),
        cmocka_unit_test(told_apart),
        cmocka_unit_test(part_that_shows_a_scene),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
