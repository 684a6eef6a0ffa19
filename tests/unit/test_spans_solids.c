// SPDX-License-Identifier: MIT
// sag_scene_spans on solids: random trees of random closed shapes, solids within solids, several of them in a
// scene, against the tree evaluated anew between every two crossings of the parts.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include "support/context.h"
#include "support/meshes.h"
#include "support/random_shape.h"
#include "support/shape_solid.h"
#include "support/span_truth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MAX_PARTS  SHAPE_SOLID_PARTS
#define MAX_EVENTS 256

static bool value_of(const shape_solid *k, const bool in[MAX_PARTS]) {
    bool stack[2 * MAX_PARTS];
    uint32_t height = 0;
    for (uint32_t i = 0; i < k->step_count; i++) {
        sag_solid_step s = k->steps[i];
        if (s.operation == SAG_SOLID_PART) {
            stack[height++] = in[s.number];
            continue;
        }
        uint32_t count = 0, n = s.number;
        for (uint32_t j = 0; j < n; j++) count += stack[height - n + j];
        bool first = stack[height -= n], value = count > 0;
        if (s.operation == SAG_SOLID_INTERSECTION) value = count == n;
        if (s.operation == SAG_SOLID_DIFFERENCE) value = first && count == 1;
        if (s.operation == SAG_SOLID_XOR) value = count % 2 == 1;
        stack[height++] = value;
    }
    return stack[0];
}

typedef struct event {
    sag_hit hit;
    uint32_t part;
} event;

static int by_t(const void *x, const void *y) {
    const event *a = x, *b = y;
    return a->hit.t < b->hit.t ? -1 : a->hit.t > b->hit.t;
}

// The boundaries of a solid on the whole line, and whether it begins inside. False where crossings are so
// close to each other that they might count as one.
static bool boundaries(span_truth *w, const shape_solid *k, const sag_ray *line, sag_hit *out, size_t *count,
                       bool *inside) {
    const sagi_snapshot *s = sagi_scene_snapshot(k->scene);
    event *events = malloc(MAX_EVENTS * sizeof *events);
    bool in[MAX_PARTS] = {false}, clear = true;
    size_t n = 0;
    for (uint32_t id = 0; id < s->count; id++) {
        sag_hit hits[MAX_EVENTS];
        size_t found = 0;
        const sagi_item *item = &s->items[id];
        sag_ray local = item->place != NULL ? sag_ray_transform(&item->place->to_object, line) : *line;
        if (item->kind == SAG_SHAPE_INSTANCE) {
            w->path[w->depth++] = id;
            clear &= boundaries(w, k->shown[id], &local, hits, &found, &in[id]);
            w->path[--w->depth] = SAG_INVALID_ID;
        } else {
            sag_mesh mesh;
            const void *shape = item->shape;
            if (item->kind == SAG_SHAPE_MESH)
                mesh = *(const sag_mesh *)shape, mesh.one_sided = false, shape = &mesh;
            found = sagi_shape_classes[item->kind].crossings(shape, &local, hits, MAX_EVENTS);
            if (item->kind == SAG_SHAPE_TORUS) found = sagi_torus_leave_outer(shape, &local, hits, found);
            in[id] = sagi_shape_begins_inside((sag_shape_kind)item->kind, shape, &local);
            for (size_t i = 0; i < found; i++) hits[i] = span_truth_hit(w, id, hits[i]), hits[i].flipped = 0;
        }
        assert_true(n + found <= MAX_EVENTS);
        for (size_t i = 0; i < found; i++) events[n++] = (event){hits[i], id};
    }
    qsort(events, n, sizeof *events, by_t);
    double reach = sag_max_component(sag_abs(line->origin)) / sag_max_component(sag_abs(line->direction));
    bool value = *inside = value_of(k, in);
    *count = 0;
    for (size_t i = 0; i < n; i++) {
        double t = events[i].hit.t;
        clear &= i == 0 || t - events[i - 1].hit.t > 0x1p-46 * (fabs(t) + reach);
        bool entering = in[events[i].part] = !in[events[i].part], now = value_of(k, in);
        if (now == value) continue;
        out[*count] = events[i].hit;
        out[(*count)++].flipped ^= entering != now;
        value = now;
    }
    free(events);
    return clear;
}

static sag_ray random_ray(rng *r, double size) {
    sag_vec3 origin = rng_vec3(r, 4 * size), target = rng_vec3(r, 2 * size);
    sag_ray ray = sag_ray_make(origin, sag_scale(sag_sub(target, origin), rng_log_uniform(r, 1e-3, 1e3)));
    double whole = 8 * size / sag_length(ray.direction);
    if (rng_one_in(r, 3)) ray.t_min = rng_one_in(r, 2) ? -INFINITY : rng_uniform(r, -1, 1) * whole;
    if (rng_one_in(r, 3)) ray.t_max = fmax(ray.t_min, rng_uniform(r, -1, 1) * whole);
    if (rng_one_in(r, 10)) ray.t_max = ray.t_min = rng_uniform(r, -1, 1) * whole;
    return ray;
}

static void random_solids(void **state) {
    (void)state;
    rng r = rng_make(31);
    static span_truth w;
    size_t spans = 0, unclear = 0, rays = 0;
    for (size_t i = 0; i < soak(60); i++) {
        shape_solid solids[3], *last = NULL;
        for (int k = 0; k < 3; k++) shape_solid_make(&r, context, &solids[k], 1, last), last = &solids[k];
        sag_scene *scene = sag_scene_create(context);
        sag_affine map[4];
        const sag_sphere ball = {.radius = 1};
        for (int k = 0; k < 4; k++) {
            random_place(&r, 1, &map[k]);
            if (k < 3) sag_add_instance(scene, solids[k].scene, &map[k]);
        }
        sag_add_sphere(scene, &ball);
        assert_int_equal(sag_scene_commit(scene, NULL), SAG_OK);
        for (int n = 0; n < 60; n++) {
            sag_ray ray = random_ray(&r, 1), line = ray;
            sag_hit hits[MAX_EVENTS];
            size_t count;
            bool inside, clear = true;
            line.t_min = -INFINITY, line.t_max = INFINITY;
            span_truth_begin(&w, &ray);
            for (uint32_t k = 0; k < 3; k++) {
                const sagi_place *place = sagi_scene_snapshot(scene)->items[k].place;
                sag_ray local = place != NULL ? sag_ray_transform(&place->to_object, &line) : line;
                w.path[0] = k, w.depth = 1;
                clear &= boundaries(&w, &solids[k], &local, hits, &count, &inside);
                span_truth_add(&w, SAG_INVALID_ID, hits, count, inside);
            }
            w.path[0] = SAG_INVALID_ID, w.depth = 0;
            count = sag_sphere_crossings(&ball, &line, hits, 2);
            for (size_t k = 0; k < count; k++) hits[k] = span_truth_hit(&w, 3, hits[k]);
            span_truth_add(&w, 3, hits, count, false);
            rays++, unclear += !clear;
            if (!clear) continue;
            span_truth_assert(&w, scene, &r);
            spans += w.count;
            // The solid by itself, not as an instance.
            span_truth_begin(&w, &ray);
            if (!boundaries(&w, &solids[2], &line, hits, &count, &inside)) continue;
            span_truth_add(&w, SAG_INVALID_ID, hits, count, inside);
            span_truth_assert(&w, solids[2].scene, &r);
        }
        sag_scene_destroy(scene);
        for (int k = 0; k < 3; k++) sag_scene_destroy(solids[k].scene);
    }
    assert_true(spans > rays / 2 && unclear < rays / 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_solids)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
