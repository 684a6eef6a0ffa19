// SPDX-License-Identifier: MIT
#include "support/random_scene.h"
#include "shapes/shape.h"
#include <sagitta/solid.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define MAX_HITS 256

uint32_t random_scene_add(rng *r, sag_scene *scene, sag_shape_kind kind, double size) {
    random_shape shape;
    sag_affine map;
    do random_shape_make(r, kind, size, &shape);
    while (sagi_shape_classes[kind].validate(&shape.as, NULL) != SAG_OK);
    uint32_t id = sag_add_shape(scene, kind, &shape.as);
    if (id == SAG_INVALID_ID) return id;
    if (random_place(r, 2 * size, &map)) sag_geometry_set_transform(scene, id, &map);
    sag_geometry_set_mask(scene, id, rng_one_in(r, 3) ? rng_below(r, 8) : 0);
    sag_geometry_set_user_data(scene, id, rng_bits(r));
    sag_geometry_set_face_forward(scene, id, rng_one_in(r, 3));
    return id;
}

static void add_many(rng *r, sag_scene *scene, uint32_t count, double size) {
    for (uint32_t i = 0; i < count; i++)
        random_scene_add(r, scene, (sag_shape_kind)(i % SAG_SHAPE_USER), size);
    if (count > 3) sag_geometry_remove(scene, 2);
}

static sag_scene *committed(sag_scene *scene) {
    if (sag_scene_commit(scene, NULL) == SAG_OK) return scene;
    sag_scene_destroy(scene);
    return NULL;
}

sag_scene *random_scene(rng *r, sag_context *context, uint32_t count, double size) {
    sag_scene *scene = sag_scene_create(context);
    if (scene == NULL) return NULL;
    add_many(r, scene, count, size);
    return committed(scene);
}

sag_scene *random_nested_scene(rng *r, sag_context *context, uint32_t count, int levels, double size) {
    sag_scene *below[SAG_MAX_INSTANCE_DEPTH + 1] = {NULL}, *scene = NULL;
    for (int level = 0; level <= levels; level++) {
        scene = sag_scene_create(context);
        if (scene == NULL) break;
        add_many(r, scene, count, size);
        for (int i = 0; level > 0 && i < 3; i++) { // two of the scene below, one of the lowest
            sag_affine map;
            sag_scene *child = below[i < 2 ? level - 1 : 0];
            sag_add_instance(scene, child, random_place(r, 2 * size, &map) ? &map : NULL);
        }
        scene = below[level] = committed(scene);
        if (scene == NULL) break;
    }
    for (int level = 0; level <= levels; level++)
        if (below[level] != scene) sag_scene_destroy(below[level]);
    return scene;
}

sag_ray random_scene_ray(rng *r, double size) {
    double far = rng_one_in(r, 4) ? rng_log_uniform(r, 1, 1e6) : 6;
    sag_vec3 origin = rng_vec3(r, far * size), target = rng_vec3(r, 3 * size);
    sag_ray ray = sag_ray_make(origin, sag_scale(sag_sub(target, origin), rng_log_uniform(r, 1e-3, 1e3)));
    if (rng_one_in(r, 6)) ray.direction.x = ray.direction.y = 0;
    if (rng_one_in(r, 3)) ray.t_min = -INFINITY;
    if (rng_one_in(r, 3)) ray.t_max = rng_uniform(r, 0, 2) * 6 * size / sag_length(ray.direction);
    if (ray.t_max < ray.t_min) ray.t_max = ray.t_min;
    ray.mask = rng_one_in(r, 2) ? 0 : 1 + rng_below(r, 7);
    return ray;
}

static void assert_same_surfaces(const sag_surface *a, const sag_surface *b) {
    assert_memory_equal(&a->position, &b->position, sizeof a->position);
    assert_memory_equal(&a->position_error, &b->position_error, sizeof a->position_error);
    assert_memory_equal(&a->geometric_normal, &b->geometric_normal, sizeof a->geometric_normal);
    assert_memory_equal(&a->shading_normal, &b->shading_normal, sizeof a->shading_normal);
    assert_memory_equal(&a->dpdu, &b->dpdu, sizeof a->dpdu);
    assert_memory_equal(&a->dpdv, &b->dpdv, sizeof a->dpdv);
    assert_true(a->u == b->u && a->v == b->v && a->side == b->side && a->geometry == b->geometry);
    assert_true(a->primitive == b->primitive && a->user_data == b->user_data);
}

static void assert_same_hits(const sag_hit *a, const sag_hit *b) {
    assert_memory_equal(&a->t, &b->t, sizeof a->t);
    assert_memory_equal(&a->u, &b->u, sizeof a->u);
    assert_memory_equal(&a->v, &b->v, sizeof a->v);
    assert_int_equal(a->geometry, b->geometry);
    assert_int_equal(a->primitive, b->primitive);
    assert_int_equal(a->flipped, b->flipped);
    assert_int_equal(a->instance_depth, b->instance_depth);
    assert_memory_equal(a->instance_path, b->instance_path, sizeof a->instance_path);
}

static void compare_ray(const sag_scene *a, const sag_scene *b, const sag_ray *ray) {
    sag_hit x[MAX_HITS], y[MAX_HITS], first;
    size_t count = sag_intersect_all(a, ray, x, MAX_HITS);
    assert_int_equal(sag_intersect_all(b, ray, y, MAX_HITS), count);
    bool met = sag_intersect(a, ray, &first);
    assert_int_equal(sag_occluded(a, ray), met);
    assert_int_equal(sag_occluded(b, ray), met);
    for (size_t i = 0; i < count && i < MAX_HITS; i++) {
        sag_surface s, t;
        assert_same_hits(&x[i], &y[i]);
        sag_surface_at(a, ray, &x[i], &s);
        sag_surface_at(b, ray, &y[i], &t);
        assert_same_surfaces(&s, &t);
    }
    sag_span in_a[16], in_b[16];
    count = sag_scene_spans(a, ray, in_a, 16);
    assert_int_equal(sag_scene_spans(b, ray, in_b, 16), count);
    for (size_t i = 0; i < count && i < 16; i++) {
        assert_same_hits(&in_a[i].enter, &in_b[i].enter);
        assert_same_hits(&in_a[i].leave, &in_b[i].leave);
    }
    sag_hit other;
    assert_int_equal(sag_intersect(b, ray, &other), met);
    if (met) assert_same_hits(&first, &other);
}

// A camera's rays, as a batch in one scene and one by one in the other.
static void compare_batches(const sag_scene *a, const sag_scene *b, rng *r, double size) {
    sag_ray rays[64];
    sag_hit hits[64], hit;
    sag_vec3 eye = rng_vec3(r, 5 * size), side = sag_scale(rng_direction(r), 0.3 * size);
    sag_vec3 up = sag_scale(rng_direction(r), 0.3 * size), at = rng_vec3(r, size);
    for (int i = 0; i < 64; i++) {
        sag_vec3 target = sag_madd(sag_madd(at, i % 8 - 4, side), i / 8 - 4, up);
        rays[i] = sag_ray_make(eye, sag_sub(target, eye));
    }
    sag_intersect_batch(a, rays, hits, 64);
    for (int i = 0; i < 64; i++) {
        bool met = sag_intersect(b, &rays[i], &hit);
        assert_int_equal(hits[i].geometry != SAG_INVALID_ID, met);
        if (met) assert_same_hits(&hits[i], &hit);
    }
}

void assert_same_answers(const sag_scene *a, const sag_scene *b, rng *r, size_t rays, double size) {
    sag_box3 x = sag_scene_bounds(a), y = sag_scene_bounds(b);
    assert_memory_equal(&x, &y, sizeof x);
    compare_batches(a, b, r, size);
    for (size_t i = 0; i < rays; i++) {
        sag_ray ray = random_scene_ray(r, size);
        compare_ray(a, b, &ray);
        if (i % 4 != 0) continue;
        sag_vec3 point = rng_vec3(r, 4 * size);
        assert_int_equal(sag_contains(a, point), sag_contains(b, point));
        sag_closest c, d;
        bool found = sag_closest_point(a, point, INFINITY, &c);
        assert_int_equal(sag_closest_point(b, point, INFINITY, &d), found);
        if (!found) continue;
        assert_memory_equal(&c.point, &d.point, sizeof c.point);
        assert_true(c.geometry == d.geometry && c.primitive == d.primitive);
        assert_true(c.instance_depth == d.instance_depth);
    }
}
