// SPDX-License-Identifier: MIT
// The scene against brute force: every query must give, bit for bit, what asking every shape one after the
// other gives, for random scenes of every kind of shape, placed and in nested instances, seen through masks.
#include "shapes/shape.h"
#include "support/random_shape.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SHAPES   24
#define SCENES   3 // the last holds instances of those before it
#define MAX_HITS 4096

// What was put into a scene, to be asked one by one.
typedef struct member {
    random_shape shape;
    uint32_t child; // SAG_INVALID_ID: a shape, else the number of a scene
    bool placed;
    sag_affine map, back;
    uint32_t mask;
} member;

typedef struct model {
    sag_scene *scenes[SCENES];
    member *members[SCENES];
    uint32_t counts[SCENES];
} model;

typedef struct answers {
    sag_hit *hits;
    size_t count;
    uint32_t path_length, path[SAG_MAX_INSTANCE_DEPTH];
} answers;

static void note(answers *a, uint32_t geometry, sag_hit hit) {
    hit.geometry = geometry;
    hit.instance_depth = a->path_length;
    for (uint32_t i = 0; i < SAG_MAX_INSTANCE_DEPTH; i++)
        hit.instance_path[i] = i < a->path_length ? a->path[i] : SAG_INVALID_ID;
    assert_true(a->count < MAX_HITS);
    a->hits[a->count++] = hit;
}

// A placed mesh: its vertices moved; mirrored, its triangles turned round, and the weights in the hits too.
static void ask_mesh(answers *a, uint32_t id, const member *m, const sag_ray *ray) {
    const sag_mesh *from = &m->shape.as.mesh;
    double positions[18];
    uint32_t triangles[24];
    bool mirrored = sag_affine_determinant(&m->map) < 0;
    for (uint32_t i = 0; i < 6; i++) {
        sag_vec3 p = from->positions_f32
                         ? sag_vec3_make(from->positions_f32[3 * i], from->positions_f32[3 * i + 1],
                                         from->positions_f32[3 * i + 2])
                         : sag_vec3_make(from->positions_f64[3 * i], from->positions_f64[3 * i + 1],
                                         from->positions_f64[3 * i + 2]);
        p = sag_affine_point(&m->map, p);
        positions[3 * i] = p.x, positions[3 * i + 1] = p.y, positions[3 * i + 2] = p.z;
    }
    for (uint32_t i = 0; i < 24; i++)
        triangles[i] = from->triangles[i % 3 == 0 || !mirrored ? i : i % 3 == 1 ? i + 1 : i - 1];
    sag_mesh moved = {.positions_f64 = positions,
                      .triangles = triangles,
                      .vertex_count = 6,
                      .triangle_count = 8,
                      .one_sided = from->one_sided};
    sag_hit hits[16];
    size_t count = sag_mesh_crossings(&moved, ray, hits, 16);
    for (size_t i = 0; i < count; i++) {
        double u = hits[i].u;
        if (mirrored) hits[i].u = hits[i].v, hits[i].v = u;
        note(a, id, hits[i]);
    }
}

static void ask_all(const model *all, uint32_t scene, const sag_ray *ray, answers *a) {
    for (uint32_t i = 0; i < all->counts[scene]; i++) {
        const member *m = &all->members[scene][i];
        if (m->mask != 0 && ray->mask != 0 && (m->mask & ray->mask) == 0) continue;
        if (m->child == SAG_INVALID_ID && m->shape.kind == SAG_SHAPE_MESH && m->placed) {
            ask_mesh(a, i, m, ray);
            continue;
        }
        sag_ray local = m->placed ? sag_ray_transform(&m->back, ray) : *ray;
        if (m->child != SAG_INVALID_ID) {
            a->path[a->path_length++] = i;
            ask_all(all, m->child, &local, a);
            a->path_length--;
            continue;
        }
        sag_hit hits[64];
        size_t count = sagi_shape_classes[m->shape.kind].crossings(&m->shape.as, &local, hits, 64);
        for (size_t k = 0; k < count; k++) note(a, i, hits[k]);
    }
}

static int compare(const void *x, const void *y) {
    const sag_hit *a = x, *b = y;
    if (a->t != b->t) return a->t < b->t ? -1 : 1;
    for (uint32_t i = 0; i < a->instance_depth && i < b->instance_depth; i++)
        if (a->instance_path[i] != b->instance_path[i])
            return a->instance_path[i] < b->instance_path[i] ? -1 : 1;
    if (a->instance_depth != b->instance_depth) return a->instance_depth < b->instance_depth ? -1 : 1;
    if (a->geometry != b->geometry) return a->geometry < b->geometry ? -1 : 1;
    return a->primitive < b->primitive ? -1 : a->primitive > b->primitive;
}

static void assert_same(const sag_hit *a, const sag_hit *b) {
    assert_true(memcmp(&a->t, &b->t, sizeof a->t) == 0);
    assert_int_equal(a->geometry, b->geometry);
    assert_int_equal(a->primitive, b->primitive);
    assert_int_equal(a->instance_depth, b->instance_depth);
    assert_memory_equal(a->instance_path, b->instance_path, sizeof a->instance_path);
}

// Adds a random shape; some random shapes are not valid (a tetrahedron of half-spaces may be empty), then
// another is tried.
static void add_shape(rng *r, model *all, uint32_t scene, sag_shape_kind kind, double size) {
    member *m = &all->members[scene][all->counts[scene]];
    do random_shape_make(r, kind, size, &m->shape);
    while (sagi_shape_classes[kind].validate(&m->shape.as, NULL) != SAG_OK);
    m->child = SAG_INVALID_ID;
    m->placed = random_place(r, 2 * size, &m->map) && !sag_affine_is_identity(&m->map);
    if (m->placed) assert_true(sag_affine_inverse(&m->map, &m->back));
    uint32_t id = sag_add_shape(all->scenes[scene], kind, &m->shape.as);
    assert_int_equal(id, all->counts[scene]);
    if (m->placed) assert_int_equal(sag_geometry_set_transform(all->scenes[scene], id, &m->map), SAG_OK);
    m->mask = rng_one_in(r, 3) ? rng_below(r, 8) : 0;
    assert_int_equal(sag_geometry_set_mask(all->scenes[scene], id, m->mask), SAG_OK);
    all->counts[scene]++;
}

static void add_instance(rng *r, model *all, uint32_t scene, uint32_t child, double size) {
    member *m = &all->members[scene][all->counts[scene]];
    m->child = child;
    m->placed = random_place(r, 3 * size, &m->map) && !sag_affine_is_identity(&m->map);
    if (m->placed) assert_true(sag_affine_inverse(&m->map, &m->back));
    uint32_t id = sag_add_instance(all->scenes[scene], all->scenes[child], &m->map);
    assert_int_equal(id, all->counts[scene]);
    m->mask = rng_one_in(r, 3) ? rng_below(r, 8) : 0;
    assert_int_equal(sag_geometry_set_mask(all->scenes[scene], id, m->mask), SAG_OK);
    all->counts[scene]++;
}

static void make_model(rng *r, sag_context *context, double size, bool planes, model *all) {
    for (uint32_t s = 0; s < SCENES; s++) {
        all->scenes[s] = sag_scene_create(context);
        assert_int_equal(sag_scene_set_quality(all->scenes[s], (sag_quality)rng_below(r, 3)), SAG_OK);
        all->members[s] = calloc(SHAPES, sizeof *all->members[s]);
        all->counts[s] = 0;
        for (uint32_t i = 0; i < SHAPES - 2 * s; i++) {
            // every kind in turn, so that each is there
            sag_shape_kind kind = (sag_shape_kind)((i + s * 7) % SAG_SHAPE_INSTANCE);
            if (kind == SAG_SHAPE_PLANE && !planes) kind = SAG_SHAPE_TORUS;
            add_shape(r, all, s, kind, size);
        }
        for (uint32_t c = 0; c < s; c++) {
            add_instance(r, all, s, c, size);
            add_instance(r, all, s, c, size);
        }
        sag_error error;
        assert_int_equal(sag_scene_commit(all->scenes[s], &error), SAG_OK);
    }
}

static void free_model(model *all) {
    for (uint32_t s = 0; s < SCENES; s++) { // children first: the parents keep what they need
        sag_scene_destroy(all->scenes[s]);
        free(all->members[s]);
    }
}

static sag_ray random_ray(rng *r, double size) {
    double far = rng_one_in(r, 4) ? rng_log_uniform(r, 1, 1e9) : 6;
    sag_vec3 origin = rng_vec3(r, far * size), target = rng_vec3(r, 5 * size);
    sag_ray ray = sag_ray_make(origin, sag_scale(sag_sub(target, origin), rng_log_uniform(r, 1e-3, 1e3)));
    if (rng_one_in(r, 5)) { // along an axis
        ray.direction = (sag_vec3){0, 0, 0};
        double *d[3] = {&ray.direction.x, &ray.direction.y, &ray.direction.z};
        *d[rng_below(r, 3)] = rng_one_in(r, 2) ? 1 : -1;
        ray.origin = rng_vec3(r, 6 * size);
    }
    if (rng_one_in(r, 8)) ray.direction.x = ray.direction.x * 1e-18;
    if (rng_one_in(r, 3)) ray.t_min = -INFINITY;
    if (rng_one_in(r, 3)) ray.t_max = rng_uniform(r, 0, 2) * 6 * size / sag_length(ray.direction);
    if (ray.t_max < ray.t_min) ray.t_max = ray.t_min;
    ray.mask = rng_one_in(r, 2) ? 0 : 1 + rng_below(r, 7);
    return ray;
}

static void check_ray(const model *all, uint32_t scene, const sag_ray *ray, sag_hit *expected,
                      sag_hit *found) {
    answers a = {.hits = expected};
    ask_all(all, scene, ray, &a);
    qsort(expected, a.count, sizeof *expected, compare);
    const sag_scene *s = all->scenes[scene];
    sag_hit hit;
    assert_int_equal(sag_intersect(s, ray, &hit), a.count > 0);
    if (a.count > 0) assert_same(&hit, &expected[0]);
    assert_int_equal(sag_occluded(s, ray), a.count > 0);
    assert_int_equal(sag_count_crossings(s, ray), a.count);
    size_t capacities[3] = {MAX_HITS, a.count / 2, 1};
    for (int c = 0; c < 3; c++) {
        assert_int_equal(sag_intersect_all(s, ray, found, capacities[c]), a.count);
        for (size_t i = 0; i < a.count && i < capacities[c]; i++) assert_same(&found[i], &expected[i]);
    }
}

static void check_models(uint64_t seed, size_t models, size_t rays, double size, bool planes) {
    rng r = rng_make(seed);
    sag_context *context = sag_context_create(NULL);
    sag_hit *expected = malloc(MAX_HITS * sizeof *expected), *found = malloc(MAX_HITS * sizeof *found);
    for (size_t m = 0; m < models; m++) {
        model all;
        make_model(&r, context, size, planes, &all);
        for (size_t i = 0; i < rays; i++) {
            sag_ray ray = random_ray(&r, size);
            for (uint32_t s = 0; s < SCENES; s++) check_ray(&all, s, &ray, expected, found);
        }
        free_model(&all);
    }
    free(expected), free(found);
    sag_context_destroy(context);
}

static void brute_force_at_one(void **state) {
    (void)state;
    check_models(1, soak(20), 40, 1, true);
}
static void brute_force_without_planes(void **state) {
    (void)state;
    check_models(2, soak(20), 40, 1, false);
}
static void brute_force_small(void **state) {
    (void)state;
    check_models(3, soak(8), 40, 1e-9, false);
}
static void brute_force_large(void **state) {
    (void)state;
    check_models(4, soak(8), 40, 1e9, false);
}

static void table_has_no_hole(void **state) {
    (void)state;
    for (int kind = 0; kind < SAGI_SHAPE_KIND_COUNT; kind++) {
        const sagi_shape_class *c = &sagi_shape_classes[kind];
        assert_non_null(c->name);
        if (kind == SAG_SHAPE_INSTANCE) continue;
        assert_true(c->struct_bytes > 0 && c->struct_bytes <= sizeof((random_shape *)0)->as);
        assert_true(c->validate && c->bounds && c->hit && c->occluded && c->crossings && c->surface);
        assert_true(c->area && c->sample);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_has_no_hole),          cmocka_unit_test(brute_force_at_one),
        cmocka_unit_test(brute_force_without_planes), cmocka_unit_test(brute_force_small),
        cmocka_unit_test(brute_force_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
