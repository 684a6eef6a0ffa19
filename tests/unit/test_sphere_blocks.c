// SPDX-License-Identifier: MIT
// Blocks of spheres: they hold what the set says, and what their float test is certain of is so. Sets made to
// be mean (all sizes in one, nested, all but the same, far from the origin) are asked by rays that come
// within a few of the grid's steps of a sphere's edge or whose range ends there; every bit must be what
// asking the spheres one by one gives, by every instruction set.
#include "base/cpu.h"
#include "kernel/block.h"
#include "scene/scene.h"
#include "shapes/spheres.h"
#include "support/random.h"
// clang-format off
#include <stdarg.h>
#include <setjmp.h>
#include <stdio.h>
#include <cmocka.h>
// clang-format on

enum { COUNT = 60, MODELS = 7 };

typedef struct model {
    double centers[3 * COUNT];
    float narrow[3 * COUNT], radii[COUNT];
    sag_spheres set;
    double size; // of the whole
    sag_vec3 middle;
} model;

static void put(model *m, uint32_t i, sag_vec3 center, double radius) {
    m->centers[3 * i] = center.x, m->centers[3 * i + 1] = center.y, m->centers[3 * i + 2] = center.z;
    for (int k = 0; k < 3; k++) m->narrow[3 * i + (uint32_t)k] = (float)m->centers[3 * i + (uint32_t)k];
    m->radii[i] = (float)radius;
}

static void make(model *m, rng *r, int which) {
    double scale = rng_one_in(r, 2) ? 1 : rng_log_uniform(r, 1e-9, 1e9);
    m->middle = rng_one_in(r, 2) ? sag_vec3_make(0, 0, 0) : rng_vec3(r, scale * rng_log_uniform(r, 1, 1e6));
    m->size = scale;
    for (uint32_t i = 0; i < COUNT; i++) {
        sag_vec3 c = rng_vec3(r, scale);
        double radius = scale * rng_uniform(r, 0.02, 0.3);
        switch (which) {
        case 0: break;
        case 1: radius = scale * rng_log_uniform(r, 1e-9, 1); break; // all sizes in one
        case 2: // nested, a few of the grid's steps apart
            c = rng_vec3(r, scale * 0x1p-15);
            radius = scale * (1 + rng_uniform(r, -1, 1) * 0x1p-13);
            break;
        case 3: c = sag_vec3_make(0, 0, 0), radius = scale * (1 + i % 4); break; // the same many times
        case 4: // pairs that all but coincide
            if (i % 2 == 1) {
                c = sag_vec3_make(m->centers[3 * i - 3], m->centers[3 * i - 2], m->centers[3 * i - 1]);
                c = sag_madd(sag_sub(c, m->middle), scale * rng_log_uniform(r, 0x1p-22, 0x1p-12),
                             rng_direction(r));
                radius = (double)m->radii[i - 1];
            }
            break;
        case 5: // touching in a row
            c = sag_vec3_make(scale * 0.25 * i, 0, 0), radius = scale * 0.125;
            break;
        default: // a few huge ones around tiny ones
            radius = scale * (i % 8 == 0 ? rng_uniform(r, 1, 2) : rng_log_uniform(r, 1e-6, 1e-2));
            break;
        }
        put(m, i, sag_add(m->middle, c), radius);
    }
    m->set = (sag_spheres){.centers_f64 = m->centers, .radii_f32 = m->radii, .count = COUNT};
    if (rng_one_in(r, 3)) m->set.centers_f64 = NULL, m->set.centers_f32 = m->narrow;
}

// What the set says of sphere j stands in the block.
static void check_sphere(const sagi_world *w, const sagi_block *block, uint32_t j, const sagi_bvh_node *node,
                         int child) {
    const double steps = ldexp(1, block->exponent);
    const double origin[3] = {w->origin.x, w->origin.y, w->origin.z};
    sag_vec3 v;
    double radius;
    const sagi_bvh_reference number = sagi_block_reference(block, j);
    const sag_sphere *lone = w->items[number.geometry].shape;
    if (block->geometry == SAGI_LONE_SPHERES)
        v = lone->center, radius = lone->radius;
    else
        assert_true(sagi_spheres_get(w->items[number.geometry].shape, number.primitive, &v, &radius));
    const double c[3] = {v.x, v.y, v.z};
    assert_true(fabs(radius * w->scale * steps - sagi_sphere_row(block, 3)[j]) <= SAGI_GRID_ERROR);
    for (uint32_t k = 0; k < 3; k++) {
        uint64_t base = block->base >> (k * SAGI_GRID_BASE_BITS);
        double zero = (double)(base & ((1u << SAGI_GRID_BASE_BITS) - 1)) * 0x1p-20 - 1;
        double at = (c[k] - origin[k]) * w->scale;
        assert_true(fabs((at - zero) * steps - sagi_sphere_row(block, k)[j]) <= SAGI_GRID_ERROR);
        assert_true((double)node->plane[k][child] <= at - radius * w->scale * (1 - 0x1p-50));
        assert_true((double)node->plane[3 + k][child] >= at + radius * w->scale * (1 - 0x1p-50));
    }
}

static void check_leaves(const sag_scene *scene, uint32_t count) {
    const sagi_world *w = &sagi_scene_snapshot(scene)->world;
    uint32_t seen = 0;
    for (uint32_t n = 0; n < w->tree.node_count; n++)
        for (int i = 0; i < SAGI_BVH_WIDTH; i++) {
            const sagi_bvh_node *node = &w->tree.nodes[n];
            if (!(node->plane[0][i] <= node->plane[3][i]) || !sagi_bvh_is_leaf(node->child[i])) continue;
            const sagi_block *leaf = sagi_leaf(&w->tree, node->child[i]);
            assert_int_equal(leaf->kind, SAGI_BLOCK_SPHERES);
            for (uint32_t j = 0; j < leaf->count; j++) check_sphere(w, leaf, j, node, i);
            for (uint32_t j = leaf->count; j < sagi_sphere_row_length(leaf->count); j++)
                assert_true(sagi_sphere_row(leaf, 3)[j] == 0 && sagi_sphere_primitives(leaf)[j] == 0);
            seen += leaf->count;
        }
    assert_int_equal(seen, count);
}

static sag_ray mean_ray(rng *r, const model *m) {
    sag_vec3 c;
    double radius;
    sagi_spheres_get(&m->set, rng_below(r, COUNT), &c, &radius);
    sag_vec3 origin = sag_add(m->middle, rng_vec3(r, m->size * 2));
    if (rng_one_in(r, 8)) origin = sag_madd(c, m->size * rng_log_uniform(r, 10, 1e7), rng_direction(r));
    if (rng_one_in(r, 4)) origin = sag_madd(c, radius * rng_uniform(r, 0, 1), rng_direction(r));
    double near = rng_log_uniform(r, 0x1p-24, 0x1p-6) * (rng_one_in(r, 2) ? 1 : -1);
    if (rng_one_in(r, 4)) origin = sag_madd(c, radius * (rng_one_in(r, 2) ? 1 : 1 + near), rng_direction(r));
    // Past the centre, at a distance of about the radius or anywhere within it.
    sag_vec3 side = sag_cross(sag_sub(c, origin), rng_direction(r));
    double length = sag_length(side);
    double off = rng_one_in(r, 3) ? radius * rng_unit(r) : radius * (1 + near);
    if (length > 0 && isfinite(length)) c = sag_madd(c, off / length, side);
    sag_ray ray = sag_ray_make(origin, sag_sub(c, origin));
    if (rng_one_in(r, 16)) ray.direction = rng_direction(r);
    if (rng_one_in(r, 8)) ray.direction.y = 0;
    double stretch = rng_one_in(r, 2) ? 1 : rng_log_uniform(r, 1e-6, 1e6);
    ray.direction = sag_scale(ray.direction, stretch);
    return ray;
}

// Lets the ray begin or end about a crossing, or exactly there.
static void cut(rng *r, const model *m, sag_ray *ray) {
    sag_hit hits[2 * COUNT];
    size_t count = sag_spheres_crossings(&m->set, ray, hits, 2 * COUNT);
    if (count == 0) return;
    double reach = m->size * rng_log_uniform(r, 0x1p-26, 0x1p-8) / sag_length(ray->direction);
    double t = hits[rng_below(r, (uint32_t)count)].t;
    if (!rng_one_in(r, 4)) t += rng_one_in(r, 2) ? reach : -reach;
    if (rng_one_in(r, 2))
        ray->t_min = t;
    else
        ray->t_max = t;
    if (rng_one_in(r, 4)) ray->t_max = ray->t_min + 2 * reach;
}

// The set as geometries of their own.
static void add_lone_spheres(sag_scene *scene, const model *m) {
    for (uint32_t i = 0; i < COUNT; i++) {
        sag_sphere s = {.radius = 1};
        sagi_spheres_get(&m->set, i, &s.center, &s.radius);
        assert_int_equal(sag_add_sphere(scene, &s), i);
    }
}

// The same but for the way a hit names the sphere.
static void compare_lone(const model *m, const sag_scene *scene, const sag_ray *ray) {
    sag_hit expected[2 * COUNT], hits[2 * COUNT], first, nearest;
    size_t count = sag_spheres_crossings(&m->set, ray, expected, 2 * COUNT);
    bool met = sag_spheres_hit(&m->set, ray, &first);
    assert_int_equal(sag_intersect_all(scene, ray, hits, 2 * COUNT), count);
    for (size_t i = 0; i < count; i++)
        assert_true(hits[i].t == expected[i].t && hits[i].geometry == expected[i].primitive &&
                    hits[i].primitive == 0);
    assert_int_equal(sag_occluded(scene, ray), met);
    assert_int_equal(sag_intersect(scene, ray, &nearest), met);
    if (met)
        assert_true(nearest.t == first.t && nearest.geometry == first.primitive && nearest.primitive == 0);
}

static void compare(const model *m, const sag_scene *scene, const sag_ray *ray) {
    sag_hit expected[2 * COUNT], hits[2 * COUNT], first, nearest;
    size_t count = sag_spheres_crossings(&m->set, ray, expected, 2 * COUNT);
    bool met = sag_spheres_hit(&m->set, ray, &first);
    assert_int_equal(met, count > 0);
    assert_int_equal(sag_intersect_all(scene, ray, hits, 2 * COUNT), count);
    for (size_t i = 0; i < count; i++)
        assert_true(hits[i].t == expected[i].t && hits[i].primitive == expected[i].primitive);
    assert_int_equal(sag_occluded(scene, ray), met);
    assert_int_equal(sag_intersect(scene, ray, &nearest), met);
    if (met) assert_true(nearest.t == first.t && nearest.primitive == first.primitive);
}

static void blocks_answer_as_their_spheres_do(void **state) {
    (void)state;
    rng r = rng_make(71);
    sag_context *contexts[SAGI_ISA_COUNT];
    for (int i = 0; i < SAGI_ISA_COUNT; i++)
        contexts[i] =
            sag_context_create(&(sag_context_options){.isa = sagi_isa_name((sagi_isa)i), .thread_count = 1});
    for (size_t round = 0, n = soak(4 * MODELS); round < n; round++) {
        model m;
        make(&m, &r, (int)(round % MODELS));
        sag_scene *scenes[SAGI_ISA_COUNT] = {NULL}, *lone[SAGI_ISA_COUNT] = {NULL};
        for (int i = 0; i < SAGI_ISA_COUNT; i++) {
            if (contexts[i] == NULL) continue;
            scenes[i] = sag_scene_create(contexts[i]);
            sag_add_spheres(scenes[i], &m.set);
            assert_int_equal(sag_scene_commit(scenes[i], NULL), SAG_OK);
            check_leaves(scenes[i], COUNT);
            lone[i] = sag_scene_create(contexts[i]);
            add_lone_spheres(lone[i], &m);
            assert_int_equal(sag_scene_commit(lone[i], NULL), SAG_OK);
            check_leaves(lone[i], COUNT);
        }
        for (int k = 0; k < 1000; k++) {
            sag_ray ray = mean_ray(&r, &m);
            if (k % 2 == 1) cut(&r, &m, &ray);
            for (int i = 0; i < SAGI_ISA_COUNT; i++)
                if (scenes[i] != NULL)
                    k % 4 < 2 ? compare(&m, scenes[i], &ray) : compare_lone(&m, lone[i], &ray);
        }
        for (int i = 0; i < SAGI_ISA_COUNT; i++) sag_scene_destroy(scenes[i]), sag_scene_destroy(lone[i]);
    }
    for (int i = 0; i < SAGI_ISA_COUNT; i++) sag_context_destroy(contexts[i]);
}

// Spheres that are not there are dropped and reported; a set with a transform stands in lists.
static void sets_are_sorted_out(void **state) {
    (void)state;
    rng r = rng_make(72);
    model m;
    sag_context *context = sag_context_create(NULL);
    make(&m, &r, 0);
    m.set.centers_f64 = m.centers, m.set.centers_f32 = NULL;
    m.centers[3] = NAN, m.centers[7] = INFINITY, m.centers[11] = 0x1p101;
    m.radii[4] = 0, m.radii[5] = -1, m.radii[6] = NAN;
    sag_scene *scene = sag_scene_create(context);
    sag_scene_stats stats;
    sag_add_spheres(scene, &m.set);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    sag_scene_get_stats(scene, &stats);
    assert_true(stats.dropped_not_finite == 6 && stats.primitive_count == COUNT - 6);
    check_leaves(scene, COUNT - 6);
    for (int i = 0; i < 1000; i++) {
        sag_ray ray = mean_ray(&r, &m);
        compare(&m, scene, &ray);
    }
    sag_affine move = sag_affine_translate(sag_vec3_make(1, 2, 3));
    assert_int_equal(sag_geometry_set_transform(scene, 0, &move), SAG_OK);
    assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
    const sagi_bvh *tree = &sagi_scene_snapshot(scene)->world.tree;
    for (int i = 0; i < SAGI_BVH_WIDTH; i++)
        if (tree->nodes[0].child[i] & SAGI_BVH_LEAF)
            assert_int_equal(sagi_leaf(tree, tree->nodes[0].child[i])->kind, SAGI_BLOCK_REFERENCES);
    sag_scene_destroy(scene);
    sag_context_destroy(context);
}

// Masks are a geometry's own, and a sphere that is cut or placed, or a neighbour of another kind, stands in
// lists: answers are those of the spheres that the ray sees.
static void lone_spheres_keep_their_masks(void **state) {
    (void)state;
    rng r = rng_make(73);
    model m;
    sag_context *context = sag_context_create(NULL);
    make(&m, &r, 0);
    for (int mixed = 0; mixed < 2; mixed++) {
        sag_scene *scene = sag_scene_create(context);
        add_lone_spheres(scene, &m);
        for (uint32_t i = 0; i < COUNT; i++) sag_geometry_set_mask(scene, i, 1U << i % 3);
        const double far = 100 * (m.size + sag_length(m.middle));
        if (mixed) // out of all rays' way, but a neighbour to the tree
            sag_add_box(scene, &(sag_box){{far, far, far}, {2 * far, 2 * far, 2 * far}});
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        for (int k = 0; k < 3000; k++) {
            sag_ray ray = mean_ray(&r, &m);
            ray.mask = 1 + rng_below(&r, 7);
            ray.t_max = ray.t_min + 20 * m.size / sag_length(ray.direction);
            sag_hit hit, best = {.t = INFINITY}, of_one;
            for (uint32_t i = 0; i < COUNT; i++) {
                sag_sphere s = {.radius = 1};
                sagi_spheres_get(&m.set, i, &s.center, &s.radius);
                if ((ray.mask >> i % 3 & 1) == 0 || !sag_sphere_hit(&s, &ray, &of_one)) continue;
                if (of_one.t < best.t) best = of_one, best.geometry = i;
            }
            const bool met = isfinite(best.t);
            assert_int_equal(sag_intersect(scene, &ray, &hit), met);
            assert_int_equal(sag_occluded(scene, &ray), met);
            if (met) assert_true(hit.t == best.t && hit.geometry == best.geometry);
        }
        sag_scene_destroy(scene);
    }
    sag_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(blocks_answer_as_their_spheres_do),
                                       cmocka_unit_test(lone_spheres_keep_their_masks),
                                       cmocka_unit_test(sets_are_sorted_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
