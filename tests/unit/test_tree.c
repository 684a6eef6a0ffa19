// SPDX-License-Identifier: MIT
// The tree over boxes is well formed whatever the boxes: every primitive once, boxes enclosed, leaves of at
// most eight of one geometry, nodes well filled, no deeper than promised, and bit for bit the same for any
// number of threads.
#include "bvh/bvh.h"
#include "support/failing_allocator.h"
#include "support/random.h"
#include <stdlib.h>
#include <string.h>
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

// Leaves as the test's maker writes them: one unit for up to six primitives, then two.
typedef struct test_leaf {
    uint32_t count, zero;
    sagi_bvh_reference at[SAGI_BVH_MAX_LEAF];
} test_leaf;

// Odd geometries are tested one by one, even ones together.
static sagi_leaf_cost leaf_cost(const void *user, uint32_t geometry) {
    (void)user;
    if (geometry % 2 == 0) return (sagi_leaf_cost){.all = 1.2f};
    return (sagi_leaf_cost){.all = 0.5f, .each = 2};
}

static uint32_t leaf_units(const void *user, uint32_t geometry, uint32_t count) {
    (void)user, (void)geometry;
    return count <= 6 ? 1 : 2;
}

static void leaf_write(const void *user, const sagi_bvh_primitive *primitives, uint32_t count, void *at) {
    test_leaf leaf = {.count = count};
    assert_in_range(count, 1, SAGI_BVH_MAX_LEAF);
    for (uint32_t i = 0; i < count; i++)
        leaf.at[i] = (sagi_bvh_reference){primitives[i].geometry, primitives[i].primitive};
    size_t bytes = leaf_units(user, primitives[0].geometry, count) * SAGI_BVH_UNIT;
    for (size_t i = 0; i < bytes; i++) assert_int_equal(((const unsigned char *)at)[i], 0);
    memcpy(at, &leaf, sizeof leaf < bytes ? sizeof leaf : bytes);
}

static const sagi_bvh_options options = {.leaves = {NULL, leaf_cost, leaf_units, leaf_write}};

typedef void (*maker)(rng *r, uint32_t count, sagi_bvh_primitive *p);

static void set(sagi_bvh_primitive *p, int axis, double at, double size) {
    p->lo[axis] = (float)at, p->hi[axis] = (float)(at + size);
}

static void scattered(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) set(&p[i], k, rng_uniform(r, -1, 1), rng_uniform(r, 0, 0.01));
}

// A surface, as meshes are.
static void sheet(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    uint32_t side = 1;
    while (side * side < count) side++;
    for (uint32_t i = 0; i < count; i++) {
        double x = ((double)(i % side) + rng_unit(r)) / side, y = ((double)(i / side) + rng_unit(r)) / side;
        set(&p[i], 0, x, 1.0 / side), set(&p[i], 1, y, 1.0 / side), set(&p[i], 2, x * y, 0.5 / side);
    }
}

static void identical(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    (void)r;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) set(&p[i], k, 0.25, 0.5);
}

static void points(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) set(&p[i], k, rng_uniform(r, -1, 1), 0);
}

static void on_a_line(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    for (uint32_t i = 0; i < count; i++) {
        set(&p[i], 0, rng_uniform(r, -1, 1), 0.001);
        set(&p[i], 1, 0, 0), set(&p[i], 2, 0, 0);
    }
}

// Each half as far away as the one before: every cut takes off one, until depth runs out.
static void shrinking(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) set(&p[i], k, ldexp(rng_uniform(r, 0.5, 1), -(int)(i % 120)), 0);
}

// Every eighth box as large as everything.
static void large_and_small(rng *r, uint32_t count, sagi_bvh_primitive *p) {
    scattered(r, count, p);
    for (uint32_t i = 0; i < count; i += 8)
        for (int k = 0; k < 3; k++) set(&p[i], k, -1, 2);
}

static const struct {
    const char *name;
    maker make;
} kinds[] = {{"scattered", scattered},
             {"sheet", sheet},
             {"identical", identical},
             {"points", points},
             {"on a line", on_a_line},
             {"shrinking", shrinking},
             {"large and small", large_and_small}};
enum { KINDS = sizeof kinds / sizeof *kinds };

// One geometry; several in runs of 1 to 400, of both kinds; or each primitive one of its own that would like
// to be in a leaf with others. Primitives are numbered within each geometry.
typedef enum ownership { ONE, SEVERAL, ALL_APART } ownership;

static sagi_bvh_primitive *make(int kind, uint32_t count, ownership owners) {
    rng r = rng_make(count + (unsigned)kind);
    sagi_bvh_primitive *p = malloc(count * sizeof *p);
    assert_non_null(p);
    kinds[kind].make(&r, count, p);
    uint32_t geometry = 0, primitive = 0, left = owners == ONE ? count : 1;
    for (uint32_t i = 0; i < count; i++, left--) {
        if (left == 0) {
            geometry += owners == SEVERAL ? 1 : 2, primitive = 0;
            left = owners == ALL_APART || rng_one_in(&r, 2) ? 1 : (uint32_t)rng_uniform(&r, 1, 400);
        }
        p[i].geometry = geometry, p[i].primitive = primitive++;
    }
    return p;
}

static int by_name(const void *a, const void *b) {
    const sagi_bvh_primitive *p = a, *q = b;
    if (p->geometry != q->geometry) return p->geometry < q->geometry ? -1 : 1;
    return p->primitive < q->primitive ? -1 : p->primitive > q->primitive;
}

static bool encloses(const sagi_float_box *box, const float lo[3], const float hi[3]) {
    for (int k = 0; k < 3; k++)
        if (!(box->lo[k] <= lo[k] && hi[k] <= box->hi[k])) return false;
    return true;
}

typedef struct visit {
    uint32_t node, level;
    sagi_float_box box;
} visit;

typedef struct findings {
    uint32_t primitives, nodes, leaves, units, depth, mixed, children;
} findings;

// A leaf within a child's box. `all` is sorted by name; seen[] says who came up.
static void check_leaf(const sagi_bvh *tree, uint32_t child, const sagi_float_box *box,
                       const sagi_bvh_primitive *all, uint32_t count, bool *seen, findings *f) {
    uint32_t unit = sagi_bvh_unit(child);
    assert_true(unit < tree->unit_count);
    test_leaf leaf = {0};
    memcpy(&leaf, tree->leaves + unit * SAGI_BVH_UNIT, 8);
    assert_in_range(leaf.count, 1, SAGI_BVH_MAX_LEAF);
    memcpy(&leaf, tree->leaves + unit * SAGI_BVH_UNIT, 8 + leaf.count * sizeof *leaf.at);
    bool mixed = false;
    for (uint32_t i = 0; i < leaf.count; i++) {
        sagi_bvh_primitive key = {.geometry = leaf.at[i].geometry, .primitive = leaf.at[i].primitive};
        const sagi_bvh_primitive *p = bsearch(&key, all, count, sizeof *all, by_name);
        assert_non_null(p);
        assert_false(seen[p - all]);
        seen[p - all] = true;
        assert_true(encloses(box, p->lo, p->hi));
        mixed |= leaf.at[i].geometry != leaf.at[0].geometry;
    }
    f->mixed += mixed;
    f->primitives += leaf.count;
    f->leaves++;
    f->units += leaf.count <= 6 ? 1 : 2;
}

static findings check(const sagi_bvh *tree, const sagi_bvh_primitive *all, uint32_t count) {
    findings f = {0};
    bool *seen = calloc(count, sizeof *seen);
    assert_non_null(seen);
    visit stack[SAGI_BVH_STACK_SIZE] = {{0, 1, tree->box}};
    for (int waiting = 1; waiting > 0;) {
        visit v = stack[--waiting];
        assert_true(v.node < tree->node_count);
        const sagi_bvh_node *node = &tree->nodes[v.node];
        if (v.level > f.depth) f.depth = v.level;
        f.nodes++;
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            sagi_float_box box;
            for (int k = 0; k < 3; k++) box.lo[k] = node->plane[k][i], box.hi[k] = node->plane[3 + k][i];
            if (!(box.lo[0] <= box.hi[0])) {
                assert_true(box.lo[0] == INFINITY && box.hi[2] == -INFINITY);
                continue;
            }
            f.children++;
            assert_true(encloses(&v.box, box.lo, box.hi));
            if (sagi_bvh_is_leaf(node->child[i])) {
                check_leaf(tree, node->child[i], &box, all, count, seen, &f);
            } else {
                assert_true(waiting < SAGI_BVH_STACK_SIZE);
                const uint32_t number = sagi_bvh_number(node->child[i]);
                assert_int_equal(sagi_bvh_child_node(number), node->child[i]);
                stack[waiting++] = (visit){number, v.level + 1, box};
            }
        }
    }
    free(seen);
    assert_int_equal(f.primitives, count);
    assert_int_equal(f.nodes, tree->node_count);
    assert_int_equal(f.leaves, tree->leaf_count);
    assert_int_equal(f.units, tree->unit_count);
    assert_int_equal(f.depth, tree->depth);
    assert_true(f.depth <= SAGI_BVH_MAX_DEPTH);
    assert_true(tree->sah > 0);
    return f;
}

static sagi_bvh build(uint32_t threads, sagi_bvh_primitive *p, uint32_t count) {
    sagi_bvh tree;
    sag_context *context = sag_context_create(&(sag_context_options){.thread_count = threads});
    assert_non_null(context);
    assert_int_equal(sagi_bvh_build(context, &options, p, count, &tree), SAG_OK);
    sagi_bvh copy = tree; // so that it outlives the context
    size_t node_bytes = tree.node_count * sizeof *tree.nodes, leaf_bytes = tree.unit_count * SAGI_BVH_UNIT;
    copy.nodes = malloc(node_bytes), copy.leaves = malloc(leaf_bytes);
    assert_true(copy.nodes != NULL && copy.leaves != NULL);
    memcpy(copy.nodes, tree.nodes, node_bytes), memcpy(copy.leaves, tree.leaves, leaf_bytes);
    sagi_bvh_release(context, &tree);
    sag_context_destroy(context);
    return copy;
}

static void free_tree(sagi_bvh *tree) {
    free(tree->nodes);
    free(tree->leaves);
}

static void try(int kind, uint32_t count, ownership owners) {
    sagi_bvh_primitive *all = make(kind, count, owners), *work = make(kind, count, owners);
    sagi_bvh tree = build(1, work, count);
    qsort(all, count, sizeof *all, by_name);
    findings f = check(&tree, all, count);
    // Only where the depth cap ends it may a leaf be of several geometries.
    if (kinds[kind].make != shrinking || owners == ONE) assert_int_equal(f.mixed, 0);
    for (uint32_t threads = 2; threads <= 3; threads++) {
        sagi_bvh_primitive *again = make(kind, count, owners);
        sagi_bvh other = build(threads, again, count);
        assert_int_equal(other.node_count, tree.node_count);
        assert_int_equal(other.unit_count, tree.unit_count);
        assert_memory_equal(other.nodes, tree.nodes, tree.node_count * sizeof *tree.nodes);
        assert_memory_equal(other.leaves, tree.leaves, tree.unit_count * SAGI_BVH_UNIT);
        free_tree(&other);
        free(again);
    }
    free_tree(&tree);
    free(all);
    free(work);
}

static void trees_are_well_formed(void **state) {
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 8, 9, 64, 65, 1000, 20000};
    for (int kind = 0; kind < KINDS; kind++)
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
            for (ownership o = ONE; o <= ALL_APART; o++) try(kind, counts[i], o);
}

static void large_trees_are_well_formed(void **state) {
    (void)state;
    try(0, 150001, ONE);
    try(1, 200000, SEVERAL);
    try(2, 100000, ALL_APART);
}

// A surface's leaves are about half full even where boxes lie at random, and its nodes nearly full.
static void blocks_are_full(void **state) {
    (void)state;
    sagi_bvh_primitive *all = make(1, 100000, ONE), *work = make(1, 100000, ONE);
    sagi_bvh tree = build(1, work, 100000);
    findings f = check(&tree, all, 100000);
    assert_true(f.primitives > 0.45 * SAGI_BVH_MAX_LEAF * f.leaves);
    assert_true(f.children > 0.8 * SAGI_BVH_WIDTH * f.nodes);
    free_tree(&tree);
    free(all);
    free(work);
}

static void empty_tree(void **state) {
    (void)state;
    sag_context *context = sag_context_create(NULL);
    sagi_bvh tree;
    assert_int_equal(sagi_bvh_build(context, &options, NULL, 0, &tree), SAG_OK);
    assert_true(tree.nodes == NULL && tree.leaves == NULL && tree.node_count == 0);
    assert_true(tree.box.lo[0] > tree.box.hi[0]);
    sagi_bvh_release(context, &tree);
    sag_context_destroy(context);
}

// Out of memory at any point is an error and leaves nothing behind.
static void memory_may_fail(void **state) {
    (void)state;
    for (size_t k = 0;; k++) {
        failing_allocator f = {.fail_at = k};
        sag_context *c = sag_context_create(
            &(sag_context_options){.allocator = failing_allocator_make(&f), .thread_count = 2});
        bool done = false;
        if (c != NULL) {
            sagi_bvh_primitive *p = make(0, 70000, ALL_APART); // nodes are allocated twice
            sagi_bvh tree = {.depth = 77};
            sag_status status = sagi_bvh_build(c, &options, p, 70000, &tree);
            done = status == SAG_OK;
            if (done)
                sagi_bvh_release(c, &tree);
            else
                assert_true(status == SAG_ERROR_MEMORY && tree.depth == 77);
            free(p);
        }
        sag_context_destroy(c);
        failing_allocator_assert_empty(&f);
        if (done) break;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_well_formed), cmocka_unit_test(large_trees_are_well_formed),
        cmocka_unit_test(blocks_are_full),       cmocka_unit_test(empty_tree),
        cmocka_unit_test(memory_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
