// SPDX-License-Identifier: MIT
// sag_scene_spans on solids: random trees of random closed shapes, solids within solids, several of them in a
// scene, against the tree evaluated anew between every two crossings of the parts.
#include "scene/scene.h"
#include "shapes/closed.h"
#include "shapes/shape.h"
#include "support/context.h"
#include "support/meshes.h"
#include "support/random_shape.h"
#include "support/span_truth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MAX_PARTS  8
#define MAX_EVENTS 256

static const sag_shape_kind kinds[] = {
    SAG_SHAPE_PLANE,       SAG_SHAPE_SPHERE, SAG_SHAPE_ELLIPSOID,    SAG_SHAPE_CYLINDER,
    SAG_SHAPE_CONE,        SAG_SHAPE_BOX,    SAG_SHAPE_ORIENTED_BOX, SAG_SHAPE_POLYHEDRON,
    SAG_SHAPE_HYPERBOLOID, SAG_SHAPE_TORUS,  SAG_SHAPE_CAPSULE,      SAG_SHAPE_MESH,
};

// A solid and what it was made of.
typedef struct known_solid {
    sag_scene *scene;
    sag_solid_step steps[2 * MAX_PARTS];
    uint32_t step_count;
    const struct known_solid *shown[MAX_PARTS]; // by parts that are instances
} known_solid;

static void add_part(rng *r, known_solid *k, double size, const known_solid *smaller) {
    sag_affine map;
    uint32_t id;
    if (smaller != NULL && rng_one_in(r, 4)) {
        random_place(r, size, &map);
        id = sag_add_instance(k->scene, smaller->scene, &map);
        k->shown[id] = smaller;
    } else {
        random_shape shape;
        sag_shape_kind kind = kinds[rng_below(r, sizeof kinds / sizeof *kinds)];
        do random_shape_make(r, kind, size, &shape);
        while (sagi_shape_classes[kind].validate(&shape.as, NULL) != SAG_OK ||
               sagi_shape_flaw(kind, &shape.as) != NULL);
        id = sag_add_shape(k->scene, kind, &shape.as);
        if (random_place(r, size, &map)) sag_geometry_set_transform(k->scene, id, &map);
    }
    k->steps[k->step_count++] = (sag_solid_step){SAG_SOLID_PART, id};
}

// A random tree of `parts` parts.
static void add_tree(rng *r, known_solid *k, double size, uint32_t parts, const known_solid *smaller) {
    uint32_t operands = 0;
    while (parts > 0 && (parts > 1 || operands > 0)) {
        uint32_t some = operands == 0 ? 1 + rng_below(r, parts - 1) : 1 + rng_below(r, parts);
        add_tree(r, k, size, some, smaller);
        parts -= some, operands++;
    }
    if (operands == 0)
        add_part(r, k, size, smaller);
    else
        k->steps[k->step_count++] =
            (sag_solid_step){(sag_solid_operation)(SAG_SOLID_UNION + rng_below(r, 4)), operands};
}

static void make_solid(rng *r, known_solid *k, double size, const known_solid *smaller) {
    memset(k, 0, sizeof *k);
    k->scene = sag_scene_create(context);
    add_tree(r, k, size, 1 + rng_below(r, MAX_PARTS), smaller);
    sag_error error = {0};
    assert_int_equal(sag_scene_set_solid(k->scene, &(sag_solid){k->steps, k->step_count}, &error), SAG_OK);
    assert_int_equal(sag_scene_commit(k->scene, &error), SAG_OK);
}

static bool value_of(const known_solid *k, const bool in[MAX_PARTS]) {
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
static bool boundaries(span_truth *w, const known_solid *k, const sag_ray *line, sag_hit *out, size_t *count,
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
        known_solid solids[3], *last = NULL;
        for (int k = 0; k < 3; k++) make_solid(&r, &solids[k], 1, last), last = &solids[k];
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
            line.t_min = -INFINITY;
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
