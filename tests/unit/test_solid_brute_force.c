// SPDX-License-Identifier: MIT
// Random solids against the plain way: all crossings of all parts, sorted, and the tree evaluated between
// them.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include "support/context.h"
#include "support/random_scene.h"
#include "support/random_solid.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define MAX_EVENTS 4096

typedef struct event {
    double t;
    uint32_t part;
} event;

typedef struct truth {
    uint32_t count;
    event at[MAX_EVENTS];
    bool begins_inside[RANDOM_SOLID_STEPS];
} truth;

static int compare(const void *a, const void *b) {
    const event *x = a, *y = b;
    return x->t != y->t ? (x->t < y->t ? -1 : 1) : x->part < y->part ? -1 : x->part > y->part;
}

static void find(const sagi_snapshot *s, const sag_ray *line, truth *all);

// The crossings of one part on the line.
static void find_part(const sagi_snapshot *s, uint32_t id, const sag_ray *line, truth *all) {
    const sagi_item *item = &s->items[id];
    sag_ray ray = item->place != NULL ? sag_ray_transform(&item->place->to_object, line) : *line;
    static sag_hit hits[MAX_EVENTS];
    size_t count;
    all->begins_inside[id] = false;
    if (item->kind == SAG_SHAPE_INSTANCE || item->kind == SAG_SHAPE_MESH) {
        const sagi_kernel *kernel = sagi_kernel_pick(SAGI_ISA_PORTABLE);
        count = kernel->crossings(item->child, &ray, item->kind == SAG_SHAPE_MESH, hits, MAX_EVENTS);
        if (item->kind == SAG_SHAPE_INSTANCE) { // its own answer, tested by itself
            sag_ray before = ray;
            before.t_max = before.t_min = count > 0 ? hits[0].t - 1 - fabs(hits[0].t) : 0;
            before.origin = sag_ray_at(&ray, before.t_min), before.t_min = 0, before.t_max = INFINITY;
            all->begins_inside[id] = kernel->crossings(item->child, &before, true, NULL, 0) % 2 == 1;
        }
    } else {
        count = sagi_shape_classes[item->kind].crossings(item->shape, &ray, hits, MAX_EVENTS);
        if (item->kind == SAG_SHAPE_TORUS) count = sagi_torus_leave_outer(item->shape, &ray, hits, count);
        all->begins_inside[id] = sagi_shape_begins_inside((sag_shape_kind)item->kind, item->shape, &ray);
    }
    for (size_t i = 0; i < count; i++) all->at[all->count++] = (event){hits[i].t, id};
}

static void find(const sagi_snapshot *s, const sag_ray *line, truth *all) {
    all->count = 0;
    for (uint32_t i = 0; i < s->count; i++) find_part(s, i, line, all);
    qsort(all->at, all->count, sizeof *all->at, compare);
}

static bool value(const sag_solid *tree, const bool *in) {
    bool stack[RANDOM_SOLID_STEPS];
    uint32_t height = 0;
    for (uint32_t i = 0; i < tree->step_count; i++) {
        sag_solid_step s = tree->steps[i];
        if (s.operation == SAG_SOLID_PART) {
            stack[height++] = in[s.number];
            continue;
        }
        const bool *operand = stack + (height -= s.number);
        uint32_t count = 0;
        for (uint32_t k = 0; k < s.number; k++) count += operand[k];
        bool v = s.operation == SAG_SOLID_UNION          ? count > 0
                 : s.operation == SAG_SOLID_INTERSECTION ? count == s.number
                 : s.operation == SAG_SOLID_DIFFERENCE   ? operand[0] && count == 1
                                                         : count % 2 == 1;
        stack[height++] = v;
    }
    return stack[0];
}

// The boundaries; groups as solid.h says. Returns how many.
static uint32_t boundaries(const sag_solid *tree, const truth *all, const sag_ray *ray, event *out) {
    bool in[RANDOM_SOLID_STEPS];
    memcpy(in, all->begins_inside, sizeof in);
    double reach = sag_max_component(sag_abs(ray->origin)) / sag_max_component(sag_abs(ray->direction));
    uint32_t count = 0;
    bool before = value(tree, in);
    for (uint32_t i = 0, end; i < all->count; i = end) {
        end = i;
        do in[all->at[end].part] ^= true, end++;
        while (end < all->count &&
               all->at[end].t - all->at[end - 1].t <= 0x1p-49 * (fabs(all->at[end - 1].t) + reach));
        bool after = value(tree, in);
        if (after != before)
            out[count++] = (event){all->at[i].t, end - i == 1 ? all->at[i].part : SAG_INVALID_ID};
        before = after;
    }
    return count;
}

static void check(const sag_scene *scene, const sag_solid *tree, sag_ray ray) {
    static truth all;
    static event wanted[MAX_EVENTS];
    static sag_hit hits[MAX_EVENTS];
    sag_ray line = ray;
    line.t_min = -INFINITY, line.t_max = INFINITY;
    find(sagi_scene_snapshot(scene), &line, &all);
    uint32_t count = boundaries(tree, &all, &ray, wanted), kept = 0;
    for (uint32_t i = 0; i < count; i++)
        if (wanted[i].t >= ray.t_min && wanted[i].t <= ray.t_max) wanted[kept++] = wanted[i];
    size_t found = sag_intersect_all(scene, &ray, hits, MAX_EVENTS);
    bool same = found == kept;
    for (uint32_t i = 0; same && i < kept; i++) {
        double slack = 0x1p-47 * (fabs(wanted[i].t) + sag_max_component(sag_abs(ray.origin)) /
                                                          sag_max_component(sag_abs(ray.direction)));
        same = fabs(hits[i].t - wanted[i].t) <= slack;
        if (same && wanted[i].part != SAG_INVALID_ID)
            same =
                hits[i].t == wanted[i].t &&
                (hits[i].instance_depth > 0 ? hits[i].instance_path[0] : hits[i].geometry) == wanted[i].part;
    }
    if (!same) {
        printf("wanted %u, found %zu\n", kept, found);
        for (uint32_t i = 0; i < all.count; i++) printf("  %.17g part %u\n", all.at[i].t, all.at[i].part);
        for (size_t i = 0; i < found; i++) printf("found %.17g part %u\n", hits[i].t, hits[i].geometry);
    }
    assert_true(same);
    sag_hit first;
    bool met = sag_intersect(scene, &ray, &first);
    assert_int_equal(met, found > 0);
    assert_int_equal(sag_occluded(scene, &ray), met);
    if (met) assert_memory_equal(&first, &hits[0], sizeof first);
}

static void random_solids(void **state) {
    (void)state;
    static sag_solid_step steps[RANDOM_SOLID_STEPS];
    rng r = rng_make(7);
    size_t n = soak(400);
    for (size_t i = 0; i < n; i++) {
        double size = rng_one_in(&r, 3) ? rng_log_uniform(&r, 1e-9, 1e9) : 1;
        uint32_t parts = 1 + rng_below(&r, i % 8 == 0 ? 100 : 12);
        sag_solid tree;
        sag_scene *solid =
            random_solid(&r, context, parts, i % 8 == 0 ? 0 : (int)(i % 3), size, steps, &tree);
        assert_non_null(solid);
        for (int k = 0; k < 100; k++) check(solid, &tree, random_scene_ray(&r, size));
        sag_scene_destroy(solid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_solids)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
